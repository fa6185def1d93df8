"""Certificates by cones where squares fail, and what the checker refuses of them.

    make rates NAME=cone_certificates ARGS="[INSTANCES]"

Choi and Lam's springs with random planes; six planes and three lines, tied; local minima offered as
optima; forgeries; hostile sizes. A part of it is in the tests.
"""

from __future__ import annotations

import copy
import json
import random
import sys
import time
from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
import spring_families
from exact_springs import choi_lam, perturbed, two_optima

from certreg.certificate.cones import ConeProof, cones_body
from certreg.certificate.envelope import Certificate
from certreg.certificate.squares import sos_body
from certreg.exact.dyadic import Dyadic
from certreg.geometry.so3 import dot, squared_norm
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.optimum import find_optimum

if TYPE_CHECKING:
    from certreg.certificate.cones import SpringsConesBody
    from certreg.exact.spaces import IntegerQuaternion


checker = import_module("certreg.verify")
INSTANCES = 100
FORGERIES = 10  # for each instance that is asked for
FORGED = ("plane 7", "plane 20", "perturbed", "plane 6", "two optima", "choi-lam", "mixed 6")
SECONDS = 30.0  # of the checker, whatever it is given


@dataclass(frozen=True, eq=False)
class Proved:
    """A problem, its local minima, and the certificate by cones as a document.

    seconds: CPU of producing it from the minima. unique_by_squares: what these prove.
    """

    problem: RegistrationProblem
    objective: Springs
    minima: tuple[IntegerQuaternion, ...]
    document: Any
    seconds: float
    unique_by_squares: bool

    @property
    def unique(self) -> bool | None:
        return self.document["claims"]["unique"] if self.document else None


def document_of(problem: RegistrationProblem, body: SpringsConesBody) -> dict[str, Any]:
    """The certificate as JSON has it."""
    certificate = Certificate(
        n=problem.n, digest=problem.digest(), inline=problem.data_bytes(), body=body
    )
    return json.loads(certificate.to_json())


def proved(problem: RegistrationProblem) -> Proved:
    """What cones prove of a problem."""
    objective = Springs.of(problem)
    found = find_optimum(objective)
    squares = sos_body(objective, found)
    begun = time.process_time()
    body = cones_body(objective, found.minima).body
    seconds = time.process_time() - begun
    return Proved(
        problem=problem,
        objective=objective,
        minima=found.minima,
        document=None if body is None else document_of(problem, body),
        seconds=seconds,
        unique_by_squares=squares is not None and bool(squares.claims.unique),
    )


@cache
def case(name: str, seed: int) -> Proved:
    """Of `perturbed`, `choi-lam`, `two optima` or a family with its size, as `plane 6`."""
    if name in ("perturbed", "choi-lam", "two optima"):
        made = {"choi-lam": choi_lam, "two optima": two_optima}.get(name)
        return proved(made() if made else perturbed(seed))
    family, n = name.split()
    noise = 0.0 if name in ("plane 6", "line 3") else 0.1
    family = family.replace("flat", "plane")
    made = spring_families.instance(spring_families.Cell(family, int(n), noise), seed)
    if name == "flat 9":  # a wall: a continuum of optima
        normals = np.tile([0.48, 0.64, 0.6], (9, 1))
        return proved(RegistrationProblem(made.source, made.target, normals=normals))
    return proved(RegistrationProblem(**spring_families.statement(made)))


def outcome_of(document: dict[str, Any]) -> Any:
    """The checker's answer, which comes in time."""
    begun = time.process_time()
    outcome = checker.check(json.dumps(document).encode())
    assert time.process_time() - begun < SECONDS
    assert outcome.verified == (outcome.reason == "")
    return outcome


# Rates -------------------------------------------------------------------------------------------


def perturbed_rates(count: int) -> str:
    """Choi and Lam's springs with random planes: unique by cones, by squares; CPU time."""
    cases = [case("perturbed", seed) for seed in range(count)]
    unique = sum(c.unique is True and outcome_of(c.document).verified for c in cases if c.document)
    squares = sum(c.unique_by_squares for c in cases)
    median = 1e3 * float(np.median([c.seconds for c in cases]))
    return f"unique by cones {unique}, by squares {squares} of {count}; median {median:.1f} ms"


def minimal_rates(name: str, count: int, *, checked: int) -> str:
    """Minimal problems: how many have a proved gap, how many claim to be unique."""
    cases = [case(name, seed) for seed in range(count)]
    gaps = sum(c.document is not None for c in cases)
    said = Counter(c.unique for c in cases)
    good = sum(outcome_of(c.document).verified for c in cases[:checked] if c.document)
    shares = [float(outcome_of(c.document).worth.share) for c in cases[:checked] if c.document]
    accepted = f"{good} of {checked} accepted, share {max(shares):.0e}"
    return f"gap {gaps} of {count}, unique {dict(said)}; {accepted}"


# Minima that are not optimal ---------------------------------------------------------------------


def spurious(count: int) -> list[tuple[Proved, IntegerQuaternion]]:
    """Local minima above the optimum, of six planes with noise and of `perturbed`."""
    found: list[tuple[Proved, IntegerQuaternion]] = []
    for seed in range(20 * count):
        made = case("plane 7" if seed % 2 else "perturbed", seed)
        least = made.objective.energy(made.minima[0])
        found += [(made, q) for q in made.minima[1:] if made.objective.energy(q) > least]
        if len(found) >= count:
            break
    return found[:count]


def lies(made: Proved, q: IntegerQuaternion) -> list[dict[str, Any]]:
    """Certificates of a local minimum as if there were no other: all that would be tried."""
    proof = ConeProof.of(made.objective, [q])
    return [document_of(made.problem, proof.body(attempt)) for attempt in proof.attempts()]


def spurious_rates(count: int) -> str:
    """How many local minima are refused, and left for the optimum by the producer."""
    offered = spurious(count)
    refused = sum(not any(outcome_of(lie).verified for lie in lies(*one)) for one in offered)
    left = 0
    for made, q in offered:
        body = cones_body(made.objective, [q]).body
        left += body is not None and _sine(body.quaternion, made.minima[0]) < Fraction(1, 10**12)
    return f"{refused} of {len(offered)} refused; {left} times the optimum is found from there"


def _sine(p: IntegerQuaternion, q: IntegerQuaternion) -> Fraction:
    """sin^2 of half the angle between two rotations."""
    return 1 - Fraction(dot(p, q) ** 2, squared_norm(p) * squared_norm(q))


# Forgeries ---------------------------------------------------------------------------------------


def forged(made: Proved, rng: random.Random) -> dict[str, Any]:
    """The certificate with one thing changed."""
    document = copy.deepcopy(made.document)
    assert document is not None
    claims, proof = document["claims"], document["proof"]
    caps = [proof["caps"][k : k + 6] for k in range(0, len(proof["caps"]), 6)]
    what = rng.choice(["gap", "sin2_half_angle", "mu", "cap", "caps", "pose", "unique", "symmetry"])
    if what in ("gap", "sin2_half_angle", "mu"):
        part = proof if what == "mu" else claims
        part[what] = _scaled(part[what] or [1, -40], rng)
    elif what == "cap" and caps:
        k = rng.randrange(len(caps))
        caps[k][4:] = _scaled(caps[k][4:], rng)
    elif what == "cap" or (what == "caps" and not caps):
        caps.append([*rng.choice(made.minima), rng.getrandbits(20), rng.randrange(-60, 10)])
    elif what == "caps" and rng.random() < 0.5:
        caps.pop(rng.randrange(len(caps)))
    elif what == "caps":
        k = rng.randrange(len(caps))
        caps[k][:4] = rng.choice([_near(caps[k][:4], rng), list(rng.choice(made.minima))])
    elif what == "pose":
        proof["pose"] = rng.choice([_near(proof["pose"], rng), list(rng.choice(made.minima))])
        if rng.random() < 0.5 and caps:
            caps[0][:4] = proof["pose"]
    elif what == "unique":
        claims["unique"] = rng.choice([True, False, None])
    else:
        proof["symmetry"] = [rng.randrange(-1, 2) for _ in range(6)]
        claims["unique"] = False
    proof["caps"] = [entry for cap in caps for entry in cap]
    return document


def _scaled(pair: list[int], rng: random.Random) -> list[int]:
    factor = rng.choice([0, -1, 1.0 - 1e-6, 1.0 + 1e-6, 0.5, 0.9, 1.1, 2, 10, 2.0**-30, 2.0**30])
    return [int(pair[0] * factor * 2**40), pair[1] - 40]


def _near(q: list[int], rng: random.Random) -> list[int]:
    size = max(map(abs, q)).bit_length()
    moved = [entry + rng.getrandbits(max(size - rng.choice([2, 8, 30, 60]), 1)) for entry in q]
    return rng.choice([moved, [-entry for entry in q], [rng.randrange(-9, 10) for _ in q]])


def is_true(document: dict[str, Any], made: Proved) -> bool:
    """Whether the claims hold, as far as the local minima that are known can tell."""
    claims, q = document["claims"], tuple(document["proof"]["pose"])
    least = min(made.objective.energy(m) for m in made.minima)
    gap = made.objective.energy(q) - least < Dyadic.of_pair(claims["gap"]).value
    unique = claims["unique"] is None or claims["unique"] == made.unique
    angle = claims["sin2_half_angle"] is None or (
        _sine(q, made.minima[0]) <= Dyadic.of_pair(claims["sin2_half_angle"]).value
    )
    return gap and unique and angle


def forgery_rates(count: int, names: tuple[str, ...] = FORGED, seed: int = 1) -> str:
    """Accepted and refused forgeries; an accepted one that is false is an error."""
    rng, said = random.Random(seed), Counter[str]()
    for k in range(count):
        made = case(names[k % len(names)], k % 3)
        document = forged(made, rng)
        outcome = outcome_of(document)
        if outcome.verified and not is_true(document, made):
            raise AssertionError(json.dumps(document))
        said["accepted, and true" if outcome.verified else outcome.reason] += 1
    return "\n    ".join(
        [f"{count} forgeries", *[f"{n} {words}" for words, n in said.most_common()]]
    )


def hostile_rates() -> str:
    """Certificates that cost as much as they can: the longest time, and why they are refused."""
    digits = 10**4200
    tiny = {"gap": [1, -110], "mu": [0, 0], "sin2_half_angle": None, "unique": None}
    caps = (case("plane 20", 0).document or {})["proof"]["caps"]
    changes: list[tuple[str, dict[str, Any]]] = [
        ("flat 9", {**tiny, "caps": [], "gap": [1, -40], "symmetry": None}),
        ("plane 6", {**tiny, "caps": []}),
        ("choi-lam", {**tiny, "caps": [10**70, 10**70 + 3, 3, 5, 1, -900] * 12}),
        ("plane 20", {**tiny, "caps": [*caps[:4], 1, -32768] * 12}),
        ("plane 20", {"pose": [digits, 1, 1, 1]}),
        ("plane 20", {"caps": [digits, 1, 1, 1, *caps[4:]]}),
        ("plane 20", {"mu": [digits, -32768], "gap": [digits, 32768]}),
    ]
    told: list[str] = []
    for name, change in changes:
        document = copy.deepcopy(case(name, 0).document or {})
        for entry, value in change.items():
            document["claims" if entry in document["claims"] else "proof"][entry] = value
        begun = time.process_time()
        reason = outcome_of(document).reason or "accepted"
        told.append(f"{time.process_time() - begun:.1f} s: {reason}")
    return "\n    ".join(["", *told])


def main() -> int:
    """Print all rates."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else INSTANCES
    for name, rates in (
        ("Choi and Lam, perturbed", lambda: perturbed_rates(count)),
        ("six planes", lambda: minimal_rates("plane 6", count, checked=count // 5)),
        ("three lines", lambda: minimal_rates("line 3", count, checked=count // 5)),
        ("spurious minima", lambda: spurious_rates(count)),
        ("forgeries", lambda: forgery_rates(FORGERIES * count)),
        ("hostile", hostile_rates),
    ):
        sys.stdout.write(f"{name}: {rates()}\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
