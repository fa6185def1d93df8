"""Theorems speak of what their inequalities are about, and no data is theirs unsaid.

One law for all kinds: where weights, factors or bounds are 2^40 times as large, 1.1e12, and the
certificate is what it is then, a printed number is another. Else a reader of VERIFIED would not see
what it is worth.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
import struct
from importlib import import_module
from typing import TYPE_CHECKING, Any

import pytest
from bounds_boundaries import bounds_cases, of_bounds
from commands import certreg as certreg_command
from test_vectors import MANIFEST, VECTORS

import certreg

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

checker = import_module("certreg.verify")
UP = 40  # bits
Certificate = dict[str, Any]
ACCEPTED = [each["file"] for each in MANIFEST if each["verdict"] == "VERIFIED"]
CONSENSUS = {"consensus", "consensus-similarity"}
each_accepted = pytest.mark.parametrize("name", ACCEPTED)


def loaded(name: str) -> Certificate:
    return json.loads((VECTORS / name).read_bytes())


def theorems(certificate: Certificate) -> tuple[str, ...]:
    outcome = checker.check(json.dumps(certificate).encode())
    assert outcome.verified, outcome.reason
    return outcome.theorems


def numbers(sentences: tuple[str, ...]) -> list[str]:
    """What is printed of numbers, without digests."""
    words = re.sub(r"\b[0-9a-f]{64}\b", "", "\n".join(sentences))
    return re.findall(r"\d[\d.]*(?:e[+-]?\d+)?", words)


def raised(pair: list[int] | None, by: int) -> list[int] | None:
    return None if pair is None else [pair[0], pair[1] + by]


def parts_of(certificate: Certificate) -> dict[str, tuple[int, int]]:
    """Places of the numbers that are no coordinates: the first, and one after the last."""
    n, kind = certificate["problem"]["n"], certificate["kind"]
    if kind.startswith("springs"):
        return {"factors": (6 * n, 12 * n)}
    if certificate.get("springs"):
        return {"bounds": (6 * n, 7 * n), "factors": (7 * n, 13 * n)}
    weights = {"weights": (6 * n, 7 * n)}
    if kind == "truncated-rotation":
        return {"bounds": (7 * n, 8 * n)}  # weights are 1
    return {**weights, "bounds": (7 * n, 8 * n)} if kind in CONSENSUS else weights


def with_larger(certificate: Certificate, part: str) -> Certificate:
    """The same certificate of data of which a part is 2^UP times as large: a claim no longer."""
    first, last = parts_of(certificate)[part]
    content = base64.b64decode(certificate["problem"]["data"])
    start = content.index(b"\0") + 9
    doubles = list(struct.unpack(f"<{(len(content) - start) // 8}d", content[start:]))
    doubles[first:last] = [2.0**UP * k for k in doubles[first:last]]
    content = content[:start] + struct.pack(f"<{len(doubles)}d", *doubles)
    problem = {
        "data": base64.b64encode(content).decode(),
        "digest": hashlib.sha256(content).hexdigest(),
        "n": certificate["problem"]["n"],
    }
    return certificate | {"problem": problem}


def isotropic(certificate: Certificate, by: int = UP) -> Certificate:
    """Energies are in the unit of the weights."""
    energies = {"claims": ("gap", "sdp_gap"), "optimality": ("delta", "mu")}
    energies |= {"sdp": ("nu",), "radius": ("separation",)}
    larger = {
        name: certificate[name] | {k: raised(certificate[name].get(k), by) for k in keys}
        for name, keys in energies.items()
        if certificate.get(name)
    }
    if certificate["kind"] == "similarity":
        larger["claims"].pop("sdp_gap")
    return certificate | larger


def of_springs(certificate: Certificate) -> Certificate:
    """Energies are in the unit of W = L L^T."""
    claims, proof, by = dict(certificate["claims"]), dict(certificate["proof"]), 2 * UP
    for name in ("gap", "second"):
        if name in claims:
            claims[name] = raised(claims[name], by)
    if "unit" in proof:
        proof["unit"] += by
    elif "mu" in proof:
        caps = proof["caps"]
        proof["mu"] = raised(proof["mu"], by)
        proof["caps"] = [k + by * (at % 6 == 5) for at, k in enumerate(caps)]
    return certificate | {"claims": claims, "proof": proof}


def of_fit(certificate: Certificate, part: str) -> Certificate:
    """The least squares of the pairs that the witness meets, with larger weights or factors."""
    fit = certificate["fit"]
    if fit is None:
        return certificate
    fit = of_springs(fit) if part == "factors" else isotropic(fit)
    own = fit_digest(certificate)
    return certificate | {"fit": fit | {"problem": fit["problem"] | {"digest": own}}}


def fit_digest(certificate: Certificate) -> str:
    """Of the pairs that the witness meets, as the checker binds them."""
    stated = checker.parse(json.dumps(certificate).encode())
    rows, e = checker.SUMS[stated.prefix][1](checker.bound_doubles(stated, None), stated.n)
    one = certificate["witness"].get("factor", [1, 0])
    scaled, low = rows, e
    if one != [1, 0]:
        scale = checker._dyadic(*one)
        s, t = scale.as_integer_ratio()
        scaled, low = checker.scaled(rows, s, t), e - t.bit_length() + 1
    met = stated.met(scaled, low)
    spans = ((0, 1, 2), (3, 4, 5), range(8, 14) if certificate.get("springs") else (6,))
    doubles = [float(rows[i][k]) * 2.0**e for span in spans for i in met for k in span]
    fit = checker.parse(json.dumps(certificate["fit"]).encode())
    content = fit.prefix + struct.pack(f"<Q{len(doubles)}d", len(met), *doubles)
    return hashlib.sha256(content).hexdigest()


ADAPTED: dict[str, Callable[[Certificate], Certificate]] = {
    **dict.fromkeys(("isotropic", "similarity"), isotropic),
    **dict.fromkeys(("springs-sos", "springs-cones", "springs-list"), of_springs),
    "count": lambda certificate: certificate,
}


def adapted(certificate: Certificate, part: str) -> Certificate:
    """A certificate of the data with a larger part that the checker accepts."""
    larger = with_larger(certificate, part)
    if part == "bounds":
        return of_bounds(larger)
    if certificate["kind"] in CONSENSUS:
        return of_fit(larger, part)
    return ADAPTED[certificate["kind"]](larger)


@pytest.mark.slow
@pytest.mark.one_in(3)
@each_accepted
def test_weights_factors_and_bounds_change_a_printed_number_where_a_theorem_rests_on_them(name):
    good = loaded(name)
    before = theorems(good)
    for part in parts_of(good):
        after = theorems(adapted(good, part))
        rests = part == "bounds" or good["kind"] not in CONSENSUS or good["fit"] is not None

        assert (numbers(after) != numbers(before)) == rests, part


def test_the_law_is_asked_of_every_kind_and_every_part():
    asked = {(loaded(name)["kind"], part) for name in ACCEPTED for part in parts_of(loaded(name))}

    assert {kind for kind, _ in asked} == set(checker.KINDS)
    assert {part for _, part in asked} == {"weights", "factors", "bounds"}


def test_the_bound_of_a_consensus_is_about_the_pose_that_its_fit_names():
    """The least squares are 43 degrees from it, and nothing bounds that: so they are not named."""
    words = theorems(loaded("accept-consensus-springs-reach-of-the-pose.json"))
    (reach,) = [told for told in words if "has its rotation within" in told]

    assert reach.endswith("degrees of R, that of the pose below.")
    assert "No angle is bounded: nothing is proved of how far R is from an optimum." in words
    assert not [told for told in words if re.search("of (that of )?the least squares[.]", told)]
    assert [told[:24] for told in words[words.index(reach) :]].index("The certified rotation R") > 0


@pytest.mark.parametrize("case", bounds_cases(), ids=lambda case: case.name)
def test_what_bounds_are_worth_is_said_beside_the_size_of_the_clouds(case):
    assert case.passes(checker)


def test_a_certificate_with_more_undecided_pairs_than_asked_for_is_refused(capsys):
    """By the checker alone, in Python and by the command; inside and outside: `bounds_cases`."""
    path = VECTORS / "accept-consensus-undecided.json"
    for most, answer in ((2, "VERIFIED"), (1, "REFUSED: undecided pairs: 2; asked for: 1")):
        code = checker.main([f"--max-undecided={most}", str(path)])
        alone = capsys.readouterr().out
        asked = certreg_command("verify", path, "--max-undecided", most)
        verdict = certreg.verify(path, max_undecided=most)

        assert code == asked.code == (0 if answer == "VERIFIED" else 1)
        assert alone.endswith(f"{answer}\n")
        assert asked.out.endswith(f"{answer}\n")
        assert verdict.proved == (code == 0)


@pytest.mark.parametrize("text", ["-1", "x", "nan", "1.5"])
def test_a_number_of_undecided_pairs_that_is_none_is_wrong_usage(text):
    asked = certreg_command("verify", VECTORS / "accept-truncated.json", f"--max-undecided={text}")

    assert asked.code == 2
    assert checker.main([f"--max-undecided={text}", "x.json"]) == 2


def test_lines_are_held_to_how_many_pairs_may_be_undecided(tmp_path: Path):
    many = tmp_path / "many.jsonl"
    names = ("accept-truncated.json", "accept-consensus-undecided.json")
    many.write_bytes(b"".join((VECTORS / name).read_bytes() for name in names))
    asked = certreg_command("verify", many, "--max-undecided", "1")

    assert asked.code == 1
    assert asked.out == (
        "line 2: REFUSED: undecided pairs: 2; asked for: 1\n1 of 2 certificates VERIFIED\n"
    )
    assert certreg_command("verify", many, "--max-undecided", "2").code == 0
