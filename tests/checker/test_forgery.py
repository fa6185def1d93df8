"""No forged certificate is accepted, none crashes the checker, each is refused quickly.

A mutated certificate may be accepted only if it is true: `certificates.holds` decides that by
definitions, in other arithmetic and without any code of the checker.
"""

from __future__ import annotations

import base64
import copy
import json
import random
import struct
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

import certificates as oracle
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from samples import examples

checker = import_module("certreg.verify")
SECONDS, MEMORY = 2.0, 200 * 10**6

GENERIC = oracle.produce(*oracle.random_problem(seed=7, n=6))
CERTIFICATES = [
    GENERIC,
    *(
        oracle.produce(source, target, pattern=pattern)
        for pattern, source, target in (
            oracle.PATTERNS[name] for name in ("octahedron", "mirrored octahedron", "antipodes")
        )
    ),
]
PATHS = [
    *[(name,) for name in GENERIC if name != "about"],
    *[(name, part) for name in ("claims", "optimality", "problem") for part in GENERIC[name]],
    *[("pose", k) for k in range(4)],
    *[("claims", name, k) for name in ("gap", "sin2_half_angle") for k in range(2)],
    *[("claims", name, k) for name in ("pattern", "unstable") for k in range(4)],
    *[("optimality", name, k) for name in ("delta", "mu") for k in range(2)],
]


def replaced(certificate, path, value):
    certificate = copy.deepcopy(certificate)
    part = certificate
    for step in path[:-1]:
        part = part[step]
    part[path[-1]] = value
    return certificate


def at(certificate, path):
    for step in path:
        certificate = certificate[step]
    return certificate


def outcome_of(content: bytes):
    """The checker's answer, which comes in time and is whole."""
    start = time.process_time()
    outcome = checker.check(content)
    assert time.process_time() - start < SECONDS
    assert outcome.verified == (outcome.reason == "") == bool(outcome.theorems)
    assert outcome.reason.isascii()
    assert len(outcome.reason) < 300
    return outcome


def is_refused(content: bytes) -> bool:
    return not outcome_of(content).verified


def is_refused_or_true(certificate) -> bool:
    return is_refused(oracle.dump(certificate)) or oracle.holds(certificate)


@pytest.mark.parametrize("certificate", CERTIFICATES)
def test_the_certificates_to_be_forged_are_accepted_themselves(certificate):
    assert oracle.holds(certificate)
    assert outcome_of(oracle.dump(certificate)).verified


def test_a_certificate_is_refused_when_a_bit_of_its_data_changes():
    content = base64.b64decode(GENERIC["problem"]["data"])
    for bit in random.Random(1).sample(range(8 * len(content)), 300):
        changed = bytearray(content)
        changed[bit // 8] ^= 1 << bit % 8
        data = base64.b64encode(changed).decode()

        assert is_refused(oracle.dump(replaced(GENERIC, ("problem", "data"), data)))


def test_a_certificate_is_refused_when_a_digit_of_its_digest_changes():
    digest = GENERIC["problem"]["digest"]
    for k in range(64):
        other = digest[:k] + ("0" if digest[k] != "0" else "1") + digest[k + 1 :]
        assert is_refused(oracle.dump(replaced(GENERIC, ("problem", "digest"), other)))
    for other in (digest.upper(), digest[:-1], digest + "0", " " + digest, ""):
        assert is_refused(oracle.dump(replaced(GENERIC, ("problem", "digest"), other)))


@pytest.mark.slow
def test_a_certificate_of_other_points_is_refused_although_the_digest_is_theirs():
    """High bits of the mantissas and the sign: the optimum moves by more than the proved bound."""
    content = base64.b64decode(GENERIC["problem"]["data"])
    refused = 0
    for number in range(42):
        for bit in (44, 47, 50, 51, 63):
            changed = bytearray(content)
            changed[26 + 8 * number + bit // 8] ^= 1 << bit % 8
            refused += is_refused(oracle.dump(oracle.with_problem(GENERIC, bytes(changed))))
    assert refused == 42 * 5


@pytest.mark.parametrize("certificate", CERTIFICATES)
def test_permuted_points_are_refused_unless_the_certificate_is_true_of_them(certificate):
    n = certificate["problem"]["n"]
    content = base64.b64decode(certificate["problem"]["data"])
    numbers = np.frombuffer(content[26:], "<f8")
    for seed in range(20):
        order = np.random.default_rng(seed).permutation(n)
        target = numbers[3 * n : 6 * n].reshape(n, 3)[order]
        changed = oracle.problem_bytes(numbers[: 3 * n], target, numbers[6 * n :])
        assert is_refused_or_true(oracle.with_problem(certificate, changed))


@pytest.mark.slow
def test_a_changed_quaternion_is_refused_unless_it_is_near_enough():
    refused = list[bool]()
    for k in range(4):
        for power in range(0, 64, 2):
            for sign in (1, -1):
                value = GENERIC["pose"][k] + sign * 2**power
                changed = replaced(GENERIC, ("pose", k), value)
                refused.append(is_refused(oracle.dump(changed)))
                assert refused[-1] or oracle.holds(changed)
    for value in ([0, 0, 0, 0], [1, 0, 0, 0], GENERIC["pose"][::-1], GENERIC["pose"][:3]):
        assert is_refused(oracle.dump({**GENERIC, "pose": value}))
    assert sum(refused) > 200  # the others, changed in the last places, are true


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("certificate", CERTIFICATES)
@pytest.mark.parametrize("name", ["delta", "mu"])
def test_changed_bounds_are_refused_unless_they_are_true(certificate, name):
    m, e = certificate["optimality"][name]
    values = [[m, e + k] for k in range(-40, 41, 4)]
    values += [[k, e] for k in (-1, 0, 2, 3)] + [[(m << 60) + k, e - 60] for k in (-1, 1)]
    for value in values:
        assert is_refused_or_true(replaced(certificate, ("optimality", name), value))
        gap = [value[0], value[1] + 1]
        everything = replaced(
            replaced(certificate, ("optimality", name), value), ("claims", "gap"), gap
        )
        assert is_refused_or_true(replaced(everything, ("claims", "sin2_half_angle"), None))


@pytest.mark.parametrize("certificate", CERTIFICATES)
def test_claims_of_another_certificate_are_refused(certificate):
    for other in CERTIFICATES:
        if other is not certificate:
            assert is_refused(oracle.dump({**certificate, "claims": other["claims"]}))
            assert is_refused_or_true({**certificate, "pose": other["pose"]})
            assert is_refused_or_true({**certificate, "optimality": other["optimality"]})
            assert is_refused(oracle.dump({**certificate, "problem": other["problem"]}))


VALUES = [
    True, False, None, 0, 1, -1, 5, 1.0, 0.5, -0.0, 1e300, "", "1", "null", [], {}, [1], [[1, 2]],
    [1.0, 2], [True, 0], [1, None], ["1", 0], [0, 0], [1, 0, 0], [1, 10**9], [1, -(10**9)], [1, 1],
    {"m": 1, "e": 2}, 10**30, [2**62, -32769], [1] * 1000, [[]] * 4, "\u0000", "\ud800",
]  # fmt: skip
LITERALS = [
    b"NaN", b"Infinity", b"-Infinity", b"1e999", b"[NaN,0]", b"9" * 4301, b"-" + b"9" * 10**6,
    b"[1," + b"9" * 5000 + b"]", b"[" * 5000 + b"]" * 5000, b"[[1,2],[3,4]", b"01", b"1.", b"'a'",
    b"undefined", b"", b"0x10", b"[1,2,]", b"{}" * 2, b"[" * 10**5, b'{"a":' * 10**5, b"nul",
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("path", PATHS, ids=lambda path: ".".join(map(str, path)))
def test_any_other_value_in_any_place_is_refused_unless_it_is_true(path):
    for value in VALUES:
        if value == at(GENERIC, path) and type(value) is type(at(GENERIC, path)):
            continue
        forged = replaced(GENERIC, path, value)
        refused = is_refused(oracle.dump(forged))
        if not refused:
            assert path[0] in {"claims", "optimality"}
            assert oracle.holds(forged)
    mark = "\u2603 here"
    text = oracle.dump(replaced(GENERIC, path, mark))
    for literal in LITERALS:
        assert is_refused(text.replace(json.dumps(mark).encode(), literal))


def test_missing_and_additional_keys_are_refused():
    for path in PATHS:
        if isinstance(path[-1], str):
            forged = copy.deepcopy(GENERIC)
            del at(forged, path[:-1])[path[-1]]
            assert is_refused(oracle.dump(forged))
            forged = replaced(GENERIC, (*path[:-1], "more"), None)
            assert is_refused(oracle.dump(forged))
            forged = replaced(GENERIC, (*path[:-1], path[-1].upper()), None)
            assert is_refused(oracle.dump(forged))


def test_a_key_that_appears_twice_is_refused_even_in_about():
    text = oracle.dump(GENERIC)
    for key in (b'"gap"', b'"mu"', b'"n"', b'"pose"', b'"claims"', b'"made by"', b'"format"'):
        for value in (b"null", b"1", b"[1, 0]"):
            assert is_refused(text.replace(key, key + b":" + value + b"," + key))
    twice = text.replace(b'"gap"', b'"\\u0067ap": [1, -400], "gap"')  # the same key, escaped
    assert is_refused(twice)


def test_the_format_the_kind_and_the_parts_of_the_future_are_known_exactly():
    for name, values in {
        "format": ["certreg-certificate/2", "certreg-certificate/1 ", "", None, 1],
        "kind": ["anisotropic", "Isotropic", "", None, ["isotropic"]],
        "basin": [{}, [], False, 0, {"state": 1}],
        "sdp": [{}, [], False, 0, {"nu": [1, 2]}],
        "about": [None, [], "text", 1],
    }.items():
        for value in values:
            assert is_refused(oracle.dump({**GENERIC, name: value}))
    for name, values in {"basin": (True, [1, 0], 0), "sdp_gap": (True, False, [1, 0], 0)}.items():
        for value in values:
            assert is_refused(oracle.dump(replaced(GENERIC, ("claims", name), value)))


def test_another_number_of_points_is_refused():
    content = base64.b64decode(GENERIC["problem"]["data"])
    for n in (-1, 0, 5, 7, 6.0, "6", 2**31, 2**62, 2**63, 2**64 + 6, 10**100, 10**6 + 1):
        assert is_refused(oracle.dump(replaced(GENERIC, ("problem", "n"), n)))
        if isinstance(n, int) and 0 <= n < 2**64:  # with a digest that fits
            head = content[:18] + struct.pack("<Q", n)
            for changed in (head + content[26:], (head + content[26:])[: 26 + 56 * min(n, 6)]):
                forged = oracle.with_problem(GENERIC, changed)
                assert is_refused(oracle.dump(replaced(forged, ("problem", "n"), n)))
                assert is_refused(oracle.dump(forged))
    lengths = (content[1:], content[:-1], content[:-8], content + b"\0", content + b"\0" * 56)
    for changed in (b"", b"x" + content, *lengths):
        assert is_refused(oracle.dump(oracle.with_problem(GENERIC, changed)))
    for prefix in (b"certreg-problem/2\0", b"certreg-problem/1 ", b"\0" * 18):
        assert is_refused(oracle.dump(oracle.with_problem(GENERIC, prefix + content[18:])))


def test_base64_other_than_the_canonical_is_refused():
    certificate = oracle.produce(*oracle.random_problem(seed=7, n=7))  # four bits are left over
    for base in (GENERIC, certificate):
        good = base["problem"]["data"]
        padded = good.endswith("=")
        for data in (
            good + "=", good + "====", good + "AAAA", good + "\n", " " + good, good[:-1],
            good.rstrip("=") if padded else good + "==", good[:40] + "\n" + good[40:],
            good[:40] + "=" + good[41:], good[:40] + "-" + good[41:], good[:40] + "_" + good[41:],
            good[:40] + "\u0661" + good[41:], good[:40] + "\u00e9" + good[41:], "", "=" * len(good),
            good.replace("=", "\0"), good[::-1], good[:-4] + "====", "A" * len(good),
        ):  # fmt: skip
            if data != good:
                assert is_refused(oracle.dump(replaced(base, ("problem", "data"), data)))
    loose = certificate["problem"]["data"]
    assert loose.endswith("=")
    end = loose.rstrip("=")
    for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/":
        data = end[:-1] + letter + loose[len(end) :]
        if data != loose:  # some of these decode to the same bytes
            assert is_refused(oracle.dump(replaced(certificate, ("problem", "data"), data)))


EXTREMES = [np.nan, np.inf, -np.inf, 1.7e308, -1.7e308, 5e-324, 2.3e-308, 1e-200, 1e200, -0.0]


@pytest.mark.parametrize("extreme", EXTREMES)
def test_extreme_points_and_weights_are_refused_unless_the_certificate_is_true_of_them(extreme):
    numbers = np.frombuffer(base64.b64decode(GENERIC["problem"]["data"])[26:], "<f8").copy()
    for place in (
        0,
        5,
        17,
        18,
        30,
        36,
        41,
        slice(0, 36),
        slice(36, 42),
        slice(0, 42),
        slice(0, 42, 3),
    ):
        changed = numbers.copy()
        changed[place] = extreme
        content = oracle.PREFIX + struct.pack("<Q", 6) + changed.astype("<f8").tobytes()
        forged = oracle.with_problem(GENERIC, content)
        refused = is_refused(oracle.dump(forged))
        assert refused or oracle.holds(forged)
        assert refused or (extreme > 0 and place in {36, 41})


@pytest.mark.slow
def test_long_integers_and_far_exponents_are_refused_in_time():
    long = int("9" * 4299) if not hasattr(sys, "set_int_max_str_digits") else 10**4299 - 1
    for delta in (-32768, 0, 32768):
        for mu in (-32768, 0, 32768):
            optimality = {"delta": [long, delta], "mu": [long // 3, mu]}
            forged = {**GENERIC, "optimality": optimality, "pose": [long, -long, long - 2, 1]}
            assert is_refused(oracle.dump(forged))
    for exponent in (32769, -32769, 2**31, -(2**63), 10**4000):
        for path in (("optimality", "delta"), ("optimality", "mu"), ("claims", "gap")):
            assert is_refused(oracle.dump(replaced(GENERIC, path, [1, exponent])))


@pytest.mark.slow
def test_broken_text_is_refused():
    text = oracle.dump(GENERIC)
    for length in [*range(0, len(text), 7), len(text) - 1]:
        assert is_refused(text[:length])
    for content in (
        b"\xef\xbb\xbf" + text, text.decode().encode("utf-16"), text + text, text + b"x", text[1:],
        b"[" + text + b"]", text.replace(b":", b"="), text.replace(b'"', b"'"), text.upper(),
        text.replace(b'"made', b'"\xff'), text.replace(b'"made', b'"\xed\xa0\x80'),
        text.replace(b"{", b"["), b"\0" * 100, b"null", b"true", b"1", b'"x"', b"[]", b"{}",
        b"{" * 10**6, b"[" * 10**6, b"[" * 400_000, b'{"a":' * 10**5, b"1" * 10**7, b"-" * 10**6,
        b'"' + b"\\u0000" * 10**6, b"1e" + b"9" * 10**6,
    ):  # fmt: skip
        assert is_refused(content)


def test_what_stands_under_about_and_white_space_are_no_matter():
    for about in (
        {},
        {"n": 7, "claims": {"gap": [1, -4000]}, "x": [1.5, -2.5e-7, None, True, "\ud800"]},
        {"text": "\u0000\u001b[2J" * 100, "gap": 1e300},
    ):
        assert not is_refused(oracle.dump({**GENERIC, "about": about}))
    spaced = json.dumps(GENERIC, indent=7, sort_keys=False).encode()
    assert not is_refused(b"\n\t " + spaced + b"\r\n")
    assert not is_refused(json.dumps(GENERIC, separators=(",", ":")).encode())


def test_a_boolean_is_no_integer():
    """Python takes True for 1; these would be true certificates, were they well formed."""
    for path in (("claims", "pattern", 0), ("claims", "unstable", 1), ("optimality", "delta", 0)):
        assert at(GENERIC, path) == 1
        assert is_refused(oracle.dump(replaced(GENERIC, path, True)))
    assert is_refused(oracle.dump(replaced(GENERIC, ("claims", "unstable", 0), False)))
    assert is_refused(oracle.dump(replaced(GENERIC, ("claims", "unique"), 1)))
    pattern, source, target = oracle.PATTERNS["one point"]
    single = oracle.produce(source, target, pattern=pattern)
    assert not is_refused(oracle.dump(single))
    assert is_refused(oracle.dump(replaced(single, ("problem", "n"), True)))


def test_numbers_that_json_does_not_know_are_refused_even_in_about():
    text = oracle.dump(GENERIC)
    for name in (b"NaN", b"Infinity", b"-Infinity"):
        assert is_refused(text.replace(b'"the tests"', name))


def test_long_integers_are_refused_although_the_interpreter_would_convert_them():
    allowed = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(0)  # as Python before 3.11
    try:
        text = oracle.dump(GENERIC).replace(b'"the tests"', b"%s")
        assert not is_refused(text.replace(b"%s", b"9" * 4300))
        assert is_refused(text.replace(b"%s", b"9" * 4301))
        assert is_refused(text.replace(b"%s", b"9" * 10**7))
    finally:
        sys.set_int_max_str_digits(allowed)


def test_files_of_more_bytes_or_points_than_allowed_are_refused(monkeypatch, tmp_path):
    text, path = oracle.dump(GENERIC), tmp_path / "certificate.json"
    path.write_bytes(text + b" ")
    for name, enough in (("FILE_MAX", len(text)), ("INLINE_MAX", 6)):
        with monkeypatch.context() as limits:
            limits.setattr(checker, name, enough)
            assert not is_refused(text)
            assert checker.main([str(path)]) == (name == "FILE_MAX")
            limits.setattr(checker, name, enough - 1)
            assert is_refused(text)


@pytest.mark.slow
@given(st.binary(max_size=300))
@examples(300)
def test_random_bytes_are_refused(content):
    assert is_refused(content)


@pytest.mark.slow
@given(st.data())
@examples(300)
def test_random_edits_of_the_file_are_refused_unless_the_certificate_stays_true(data):
    text = bytearray(oracle.dump(GENERIC))
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        stop = start + data.draw(st.integers(0, 3))
        text[start:stop] = data.draw(
            st.one_of(st.binary(max_size=3), st.sampled_from([b"0", b"-", b"1", b"9", b",", b" "]))
        )

    if not is_refused(bytes(text)):
        assert oracle.holds(json.loads(text))


@pytest.mark.slow
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
        lambda inner: st.lists(inner, max_size=5) | st.dictionaries(st.text(max_size=5), inner),
        max_leaves=10,
    ),
    st.sampled_from(PATHS),
)
@examples(300)
def test_random_values_anywhere_are_refused_unless_the_certificate_stays_true(value, path):
    forged = replaced(GENERIC, path, value)

    if not is_refused(oracle.dump(forged)):
        assert oracle.holds(forged)


CHILD = """
import importlib.util, pathlib, resource, sys, time
resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[3]), int(sys.argv[3])))
spec = importlib.util.spec_from_file_location("verify", sys.argv[1])
sys.modules["verify"] = verify = importlib.util.module_from_spec(spec)
spec.loader.exec_module(verify)
for path in sorted(pathlib.Path(sys.argv[2]).iterdir()):
    start = time.process_time()
    outcome = verify.check(path.read_bytes())
    print(path.name, outcome.verified, time.process_time() - start, outcome.reason, sep="|")
"""


def hostile_files():
    """Files made to cost time or memory."""
    text, million = oracle.dump(GENERIC), 10**6
    mark = text.replace(b'"the tests"', b"%s")
    fillings = {
        "objects": b"[" + b",".join([b'{"a":0}'] * million) + b"]",
        "keys": b"{" + b",".join(b'"%d":0' % k for k in range(million)) + b"}",
        "floats": b"[" + b",".join([b"0.5"] * million) + b"]",
        "integers": b"[" + b",".join([b"9" * 5000] * 100) + b"]",
        "string": b'"' + b"x" * 10 * million + b"x",
        "escapes": b'"' + b"\\u0000" * 2 * million + b'"x',
        "nested": b"[" * million + b"]" * million,
        "nested objects": b'{"a":' * million + b"0" + b"}" * million,
        "number": b"9" * 10 * million,
        "fraction": b"0." + b"9" * 10 * million + b"x",
    }
    yield from ((name, mark.replace(b"%s", filling)) for name, filling in fillings.items())
    n = 10_000  # far magnitudes everywhere: long integers for a checker that lifts them at once
    wide = 10.0 ** np.random.default_rng(1).uniform(-300, 300, (n, 7))
    content = oracle.problem_bytes(wide[:, :3], wide[:, 3:6], wide[:, 6])
    yield "magnitudes", oracle.dump({**GENERIC, "problem": oracle.stated_problem(content, n)})
    forged = replaced(GENERIC, ("problem", "n"), 10**6)
    yield "length", oracle.dump(replaced(forged, ("problem", "data"), "A" * 10 * million))
    yield "spaces", text + b" " * 10 * million + b"x"
    yield "pattern", text.replace(b'"pattern": [', b'"pattern": [' + b"1," * 400_000)


@pytest.mark.slow
def test_hostile_files_are_refused_within_bounds_of_time_and_memory(tmp_path):
    names = set()
    for name, content in hostile_files():
        (tmp_path / name).write_bytes(content)
        names.add(name)
    command = [sys.executable, "-I", "-S", "-c", CHILD, checker.__file__, tmp_path, str(MEMORY)]

    done = subprocess.run(
        command, capture_output=True, text=True, check=False, timeout=60, encoding="utf-8"
    )

    assert done.stderr == ""
    lines = [line.split("|") for line in done.stdout.splitlines()]
    assert {line[0] for line in lines} == names
    for name, verified, seconds, reason in lines:
        assert verified == "False", name
        assert float(seconds) < SECONDS, name
        assert reason != "not enough memory", name


@pytest.mark.slow
def test_the_checker_says_so_when_the_memory_is_too_small(tmp_path):
    path = Path(tmp_path) / "big.json"
    path.write_bytes(oracle.dump({**GENERIC, "about": {"x": "y" * 30 * 10**6}}))
    command = [sys.executable, "-I", "-S", "-c", CHILD, checker.__file__, tmp_path, str(5 * 10**7)]

    done = subprocess.run(
        command, capture_output=True, text=True, check=False, timeout=60, encoding="utf-8"
    )

    assert done.stderr == "" or "MemoryError" in done.stderr.splitlines()[-1]  # reading the file
    assert "True" not in done.stdout
