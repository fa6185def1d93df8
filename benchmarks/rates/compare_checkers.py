"""The trusted checker of two commits, asked the same; ARGS: COMMIT [COUNT].

    make rates NAME=compare_checkers ARGS="BASE [COUNT]"

All vectors and so many mutated certificates of both kinds (20,000) must get the same verdict, the
same reason and the same sentences from `certreg/verify.py` of the commit BASE and of this checkout;
sentences on what a certificate is worth are compared where both have them.
"""

from __future__ import annotations

import base64
import collections
import copy
import json
import random
import subprocess
import sys
import time
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import certificates as oracle

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

ROOT = Path(__file__).resolve().parents[2]
VECTORS = ROOT / "vectors"
COUNT = 20_000
Certificate = Any  # what JSON can hold


# --- Mutated certificates -------------------------------------------------------------------------

STRANGE = (
    *(None, True, False, 0, 1, -1, 2, 4, 0.5, 1e300, "", "x", [], {}, [1], [[]], [0, 0], [1, 0]),
    *([1, 0, 0, 0], [0, 0, 0, 0], [1, 1, 1, 1], [4], [1, 32768], [1, -32768], [1, 32769], 10**40),
    *(
        2**61 - 1,
        2**64,
        2**64 - 59,
        [1, 2**70],
        [10**4200, 1],
        {"nu": [9, 9]},
        "isotropic",
        "count",
    ),
)
BYTES = (
    b"",
    b"0",
    b"9",
    b"-",
    b",",
    b"[",
    b"]",
    b"{",
    b'"',
    b" ",
    b"null",
    b"\xff",
    b"e5",
    b".0",
    b"9" * 4301,
)


def originals() -> list[Certificate]:
    """Certificates of both kinds, true and forged: the vectors, and random ones with all claims."""
    found = [json.loads(path.read_bytes()) for path in sorted(VECTORS.glob("*-*.json"))]
    for seed in range(60):  # of so many other kinds are the vectors
        made = oracle.produce(*oracle.random_problem(seed, n=4 + seed % 6, noise=0.2))
        made["basin"] = {"quaternion": made["pose"], "angular_velocity": [1, -2, 1, -30]}
        made["claims"]["basin"] = True
        found += [made, made | {"problem": made["problem"] | {"data": None}}]
        kept = {name: made[name] for name in ("about", "format", "problem")}
        proof = {"chart": [1, 2, 4, 8], "modulus": 2**61 - 1}
        found.append(kept | {"kind": "count", "claims": {"at_most": 4}, "proof": proof})
    return found


def mutated(certificates: list[Certificate], rng: random.Random) -> bytes:
    """A certificate with up to three changes, or its bytes with some."""
    certificate = copy.deepcopy(rng.choice(certificates))
    for _ in range(rng.choice((0, 1, 1, 1, 2, 3))):
        change = rng.choice((_entry, _entry, _entry, _key, _part, _points))
        certificate = change(certificate, certificates, rng)
    text = bytearray(json.dumps(certificate, sort_keys=rng.random() < 0.8).encode())
    if rng.random() < 0.15:
        for _ in range(rng.randint(1, 3)):
            start = rng.randrange(len(text) + 1)
            text[start : start + rng.randint(0, 3)] = rng.choice(BYTES)
    return bytes(text if rng.random() < 0.98 else text[: rng.randrange(len(text))])


def _places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all entries within."""
    if isinstance(value, (dict, list)):
        for key in value if isinstance(value, dict) else range(len(value)):
            yield (*path, key)
            yield from _places(value[key], (*path, key))


def _holder(certificate: Certificate, path: tuple[Any, ...]) -> Any:
    for step in path[:-1]:
        certificate = certificate[step]
    return certificate


def _entry(certificate: Certificate, _: list[Certificate], rng: random.Random) -> Certificate:
    """Another value somewhere: near the old one or strange."""
    places = list(_places(certificate))
    if not places:
        return certificate
    path = rng.choice(places)
    holder = _holder(certificate, path)
    old = holder[path[-1]]
    if type(old) is int and rng.random() < 0.8:
        near = (old + 1, old - 1, -old, 2 * old, old // 2, old + rng.randint(-99, 99), old << 40)
        holder[path[-1]] = rng.choice((*near, old * rng.randint(2, 10**6), 0))
    elif isinstance(old, list) and rng.random() < 0.6:
        holder[path[-1]] = rng.choice((old[::-1], old[1:], [*old, 1], rng.sample(old, len(old))))
        if len(old) == 2 and all(type(x) is int for x in old):  # a dyadic, changed a little
            bits = rng.choice((1, 2, 10, 30, 60))
            holder[path[-1]] = [(old[0] << bits) + rng.choice((-1, 0, 1)), old[1] - bits]
    else:
        holder[path[-1]] = copy.deepcopy(rng.choice(STRANGE))
    return certificate


def _key(certificate: Certificate, _: list[Certificate], rng: random.Random) -> Certificate:
    """A key that is missing, unknown or called otherwise."""
    parts = [certificate] if isinstance(certificate, dict) else []
    parts += [part for part in (parts[0].values() if parts else ()) if isinstance(part, dict)]
    part = rng.choice(parts or [{}])
    if part:
        key = rng.choice(list(part))
        value = part[key]
        if rng.random() < 0.7:
            del part[key]
        if rng.random() < 0.6:
            part[rng.choice(("radius", "sdp", "basin", "pose", key.upper(), key + " "))] = value
    return certificate


def _part(certificate: Certificate, others: list[Certificate], rng: random.Random) -> Certificate:
    """A part of another certificate in the place of its own."""
    other = rng.choice(others)
    if isinstance(certificate, dict):
        name = rng.choice(list(other))
        certificate[name] = copy.deepcopy(other[name])
    return certificate


def _points(certificate: Certificate, others: list[Certificate], rng: random.Random) -> Certificate:
    """Data that are cut, longer, or of other bits; under their own digest or another."""
    del others
    problem: Any = certificate.get("problem") if isinstance(certificate, dict) else None
    data: Any = problem.get("data") if isinstance(problem, dict) else None
    if not isinstance(data, str) or len(data) < 8:
        return certificate
    if rng.random() < 0.2:
        start = rng.randrange(len(data))
        problem["data"] = data[:start] + rng.choice(("", "A", "=", "\n", "*")) + data[start + 1 :]
        return certificate
    try:
        content = bytearray(base64.b64decode(data))
    except ValueError:
        return certificate
    for _ in range(rng.choice((1, 1, 5))):
        place = rng.randrange(len(content))
        content[place] ^= 1 << rng.randrange(8)
    if rng.random() < 0.1:
        content = content[: rng.randrange(1, len(content))] + bytes(rng.choice((0, 8, 56)))
    certificate["problem"] = oracle.stated_problem(bytes(content), problem.get("n", 0))
    if rng.random() < 0.2:
        certificate["problem"]["digest"] = problem.get("digest")
    return certificate


# --- What is true ---------------------------------------------------------------------------------


def is_true(certificate: Certificate) -> bool:
    """Whether every claim of a well-formed certificate holds, by definitions."""
    content, n = base64.b64decode(certificate["problem"]["data"]), certificate["problem"]["n"]
    numbers = memoryview(content[26:]).cast("d").tolist()
    source, target = ([numbers[k + 3 * i :][:3] for i in range(n)] for k in (0, 3 * n))
    mass, C, S = oracle.exact_moments(source, target, numbers[6 * n :])
    K, trace = oracle.rotation_form(C), S[0][0] + S[1][1] + S[2][2]
    if certificate["kind"] == "count":
        four = oracle.multiplicities(K) == [1, 1, 1, 1] and certificate["claims"]["at_most"] >= 4
        return bool(four and mass)
    J = [[trace * (i == j) - S[i][j] for j in range(3)] for i in range(3)]
    return oracle.holds(certificate) and _dual_is_true(certificate, K) and _ends(certificate, K, J)


def _form(A: Any, v: list[int]) -> Fraction:
    return sum((A[i][j] * a * b for i, a in enumerate(v) for j, b in enumerate(v)), Fraction(0))


def _mean(A: Any, q: list[int]) -> Fraction:
    return _form(A, q) / sum(c * c for c in q)


def _dual_is_true(certificate: Certificate, K: Any) -> bool:
    told, gap = certificate["sdp"], certificate["claims"]["sdp_gap"]
    if not told or told["nu"] is None:
        return gap is None
    nu = told["nu"][0] * Fraction(2) ** told["nu"][1]
    above = oracle.positive_definite(
        [[nu * (i == j) - K[i][j] for j in range(4)] for i in range(4)]
    )
    exact = 2 * (nu - _mean(K, certificate["pose"]))
    return above and (gap is None or gap[0] * Fraction(2) ** gap[1] >= exact)


def _ends(certificate: Certificate, K: Any, J: Any) -> bool:
    """Whether the state lies in the basin, if that is claimed."""
    if not certificate["claims"]["basin"]:
        return True
    p, (*w, e) = (certificate["basin"][name] for name in ("quaternion", "angular_velocity"))
    (d, f), (m, g) = (certificate["optimality"][name] for name in ("delta", "mu"))
    level = _mean(K, certificate["pose"]) + d * Fraction(2) ** f - m * Fraction(2) ** g
    spin = _form(J, w) / 4 * Fraction(4) ** e
    return oracle.positive_definite(J) and any(p) and _mean(K, p) - spin > level


# --- The comparison -------------------------------------------------------------------------------


WORTH = (  # how the sentences begin that an older checker does not have, or only of small angles
    *("Sum of weights", "So the minimum", "This gap", "The range of energies is 0"),
    *("No angle is bounded", "Every global optimum is within"),
)
VOID = ": nothing."  # the end of a sentence on a dual bound that bounds nothing


class DifferentError(Exception):
    """Two checkers do not answer alike."""


def loaded(text: str, name: str) -> Any:
    """A checker with this text."""
    checker = ModuleType(name)
    sys.modules[name] = checker  # where a dataclass looks for its annotations
    exec(compile(text, name, "exec"), vars(checker))  # noqa: S102  (versions of the checker)
    return checker


def answer(checker: Any, content: bytes, clouds: Any) -> tuple[bool, tuple[str, ...], str]:
    """Verdict, sentences, reason."""
    outcome = checker.check(content, clouds)
    return outcome.verified, outcome.theorems, outcome.reason


def alike(one: tuple[bool, tuple[str, ...], str], other: tuple[bool, tuple[str, ...], str]) -> bool:
    """Whether two answers say the same, in all sentences that both checkers know."""
    lines = [[line.replace(VOID, ".") for line in each[1]] for each in (one, other)]
    both = tuple(start for start in WORTH if all(start in "\n".join(each) for each in lines))
    known = [
        [line for line in each if not line.startswith(WORTH) or line.startswith(both)]
        for each in lines
    ]
    return (one[0], known[0], one[2]) == (other[0], known[1], other[2])


def compare(base: Any, head: Any, contents: Iterator[bytes]) -> collections.Counter[str]:
    """How often each answer was given by both; DifferentError at the first that differs."""
    counts: collections.Counter[str] = collections.Counter()
    for content in contents:
        for clouds in (None, *CLOUDS[: len(content) % 7 == 0]):
            answers = [answer(checker, content, clouds) for checker in (base, head)]
            if not alike(*answers):
                raise DifferentError(f"{answers[0]}\n{answers[1]}\nof {content!r}")
            counts["VERIFIED" if answers[0][0] else answers[0][2].split("[")[0]] += 1
    return counts


def _some_clouds() -> list[Any]:
    source, target, weights = oracle.random_problem(0, n=4, noise=0.2)
    flat = [tuple(part.ravel().tolist()) for part in (source, target, weights)]
    return [import_module("certreg.verify").Clouds(*flat)]


CLOUDS = _some_clouds()


def main(base: str, count: int = COUNT) -> int:
    """Exit code 1 at the first difference."""
    show = ["git", "show", f"{base}:certreg/verify.py"]
    text = subprocess.run(
        show, capture_output=True, text=True, check=True, cwd=ROOT, encoding="utf-8"
    ).stdout
    old = loaded(text, "base_checker")
    new = loaded((ROOT / "certreg" / "verify.py").read_text(encoding="utf-8"), "head_checker")
    rng, certificates, start = random.Random(1), originals(), time.perf_counter()
    write: Callable[[str], object] = sys.stdout.write
    try:
        vectors = (path.read_bytes() for path in sorted(VECTORS.glob("*.json")))
        found = compare(old, new, vectors)
        found += compare(old, new, (mutated(certificates, rng) for _ in range(count)))
    except DifferentError as error:
        write(f"they differ:\n{error}\n")
        return 1
    for words, times in found.most_common():
        write(f"{times:6d}  {words}\n")
    write(f"{found.total()} questions, {len(found)} answers, all alike: ")
    write(f"{time.perf_counter() - start:.0f} s\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], *map(int, sys.argv[2:])))
