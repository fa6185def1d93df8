"""The checker on cones: each inequality just inside and outside, and what is never accepted."""

from __future__ import annotations

import base64
import copy
import json
import math
from fractions import Fraction
from functools import cache
from importlib import import_module
from itertools import product
from typing import Any

import numpy as np
import pytest
import spring_families
from exact_springs import LEAST, RANGE, choi_lam, perturbed, two_optima

from certreg.certificate.cones import cones_body
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.optimum import find_optimum

checker = import_module("certreg.verify")
HAIR = Fraction(1, 2**20)
BITS = 40  # of a rounded number


def document(problem: RegistrationProblem, body: Any) -> dict[str, Any]:
    data = base64.b64encode(problem.data_bytes()).decode()
    return {
        "about": {},
        "format": "certreg-certificate/1",
        "kind": body.KIND,
        "problem": {"data": data, "digest": problem.digest(), "n": problem.n},
        **body.to_fields(),
    }


@cache
def objective_of(name: str) -> Springs:
    return Springs.of(problem_of(name))


@cache
def problem_of(name: str) -> RegistrationProblem:
    if name == "choi-lam":
        return choi_lam()
    if name == "two optima":
        return two_optima()
    if name == "perturbed":
        return perturbed(3)
    family, n = name.split()
    cell = spring_families.Cell(family, int(n), 0.0 if int(n) == 6 else 0.1)
    return RegistrationProblem(**spring_families.statement(spring_families.instance(cell, 1)))


@cache
def minima_of(name: str) -> tuple[Any, ...]:
    return find_optimum(objective_of(name)).minima


@cache
def made(name: str) -> dict[str, Any]:
    proposal = cones_body(objective_of(name), minima_of(name))
    assert proposal.body is not None, proposal.words
    return document(problem_of(name), proposal.body)


def changed(name: str, **entries: Any) -> dict[str, Any]:
    """With other entries of claims or proof."""
    copied = copy.deepcopy(made(name))
    for entry, value in entries.items():
        part = copied["claims"] if entry in copied["claims"] else copied["proof"]
        assert entry in part
        part[entry] = value.pair if isinstance(value, Dyadic) else value
    return copied


def outcome_of(certificate: dict[str, Any]) -> Any:
    return checker.check(json.dumps(certificate).encode())


def reason(certificate: dict[str, Any]) -> str:
    outcome = outcome_of(certificate)
    assert outcome.verified == (outcome.reason == "")
    return outcome.reason


NAMES = ("choi-lam", "perturbed", "plane 6", "plane 7", "plane 20")


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("name", NAMES)
def test_what_the_producer_proposes_is_accepted(name):
    outcome = outcome_of(made(name))

    assert (outcome.verified, outcome.reason) == (True, "")
    assert outcome.worth.share < Fraction(1, 10**12)
    unique = made(name)["claims"]["unique"]
    assert unique is (True if name in ("perturbed", "plane 7", "plane 20") else None)
    assert (outcome.worth.angle is not None) == bool(unique)


@pytest.mark.slow
def test_of_choi_and_lam_the_gap_is_proved_and_nothing_else():
    outcome = outcome_of(made("choi-lam"))

    assert LEAST - outcome.worth.minimum < Fraction(RANGE) / 10**12
    assert (
        "The rotation of the global optimum is unique or not: that is undecided."
        in outcome.theorems
    )
    assert "claims.unique" in reason(changed("choi-lam", unique=True))
    assert "unique" in reason(changed("choi-lam", unique=False)) or "cap" in reason(
        changed("choi-lam", unique=False)
    )


# Each inequality ---------------------------------------------------------------------------------


def own_cap(name: str, quaternion: Any, gap: Fraction, curvature: Fraction, mu: Fraction) -> Any:
    caps = [*quaternion, *dyadic_below(curvature, BITS).pair]
    return changed(
        name,
        pose=list(quaternion),
        caps=caps,
        gap=dyadic_above(gap, BITS),
        mu=dyadic_below(mu, BITS),
        sin2_half_angle=None,
        unique=None,
    )


def least_curvature(name: str, q: Any) -> float:
    """Of the Hessian in rotation angle, in doubles: an oracle by differences of exact energies."""
    objective, h = objective_of(name), 1e-4
    unit = np.array([float(entry) for entry in q]) / math.sqrt(sum(float(e) ** 2 for e in q))
    w, x, y, z = unit
    frame = np.array([[-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]])

    def energy(turn: Any) -> float:
        moved = unit + np.tan(h * np.linalg.norm(turn) / 2) * (turn @ frame) / max(
            np.linalg.norm(turn), 1e-300
        )
        return float(objective.energy([int(entry * 2.0**60) for entry in moved]))

    basis, centre = np.eye(3), energy(np.zeros(3))
    table = [
        [
            (energy(a + b) - energy(a - b) - energy(b - a) + energy(-a - b)) / (4 * h * h)
            if a is not b
            else (energy(a) - 2 * centre + energy(-a)) / (h * h)
            for b in basis
        ]
        for a in basis
    ]
    return float(np.linalg.eigvalsh(np.array(table))[0])


def test_a_cap_whose_curvature_is_too_large_is_refused():
    q = minima_of("plane 20")[0]
    least = Fraction(least_curvature("plane 20", q))
    gap, mu = Fraction(1, 10**9), Fraction(0)

    inside = own_cap("plane 20", q, gap, least * (1 - Fraction(1, 1000)), mu)
    outside = own_cap("plane 20", q, gap, least * (1 + Fraction(1, 1000)), mu)

    assert reason(inside) == ""
    assert reason(outside) == "a cap's curvature is not proved"


def rough(name: str) -> tuple[Any, Fraction]:
    """A pose of 20 bits, and the square of the slope there, by the definition."""
    q = tuple(entry >> 77 for entry in minima_of(name)[0])
    objective, norm = objective_of(name), sum(entry**2 for entry in q)
    w, x, y, z = q
    gradient = objective.gradient(q)
    frame = ((-x, w, z, -y), (-y, -z, w, x), (-z, y, -x, w))  # q times i, j, k
    along = [sum(a * b for a, b in zip(e, gradient, strict=True)) for e in frame]
    return q, sum(Fraction(a, 2 * norm**2) ** 2 for a in along) * objective.unit**2


def test_delta_exceeds_the_square_of_the_slope_over_the_curvature():
    q, slope = rough("plane 20")
    curvature = Fraction(made_curvature("plane 20"))
    mu = curvature / 2
    least = slope / (curvature - mu)

    assert slope > 0
    assert reason(own_cap("plane 20", q, least * (1 + HAIR), curvature, mu)) == ""
    refused = own_cap("plane 20", q, least * (1 - HAIR), curvature, mu)
    assert reason(refused) == "a cap proves too little"


def made_curvature(name: str) -> Fraction:
    return Dyadic.of_pair(made(name)["proof"]["caps"][4:6]).value


@pytest.mark.slow
def test_in_another_cap_the_objective_stays_above_the_level():
    """Six planes: several minima whose energies are 0, but for rounding; mu lifts the level."""
    body = made("plane 6")["proof"]
    assert len(body["caps"]) >= 12
    raised = changed("plane 6", mu=Dyadic(mantissa=1, exponent=-80))

    assert reason(made("plane 6")) == ""
    assert reason(raised) == "a cap proves too little"


@pytest.mark.slow
def test_without_its_cap_a_tied_minimum_is_found():
    caps = made("plane 6")["proof"]["caps"]

    assert reason(changed("plane 6", caps=caps[:6])) != ""
    assert reason(changed("plane 6", caps=caps[6:])) != ""


@pytest.mark.parametrize("name", ["perturbed", "plane 7", "plane 20"])
def test_a_growth_that_is_too_large_is_refused(name):
    """mu is at most the curvature; twelve times what was proved is more than there is."""
    mu = Dyadic.of_pair(made(name)["proof"]["mu"])
    more = Dyadic(mantissa=12 * mu.mantissa, exponent=mu.exponent)

    assert reason(changed(name, mu=more)) in (
        "a cap proves too little",
        "at a rotation outside of the caps the objective is too small",
    )


def test_claims_follow_from_the_proved_growth_alone():
    gap, sin2, mu = (
        Dyadic.of_pair(made("plane 20")[part][entry])
        for part, entry in (("claims", "gap"), ("claims", "sin2_half_angle"), ("proof", "mu"))
    )
    least = gap.value / mu.value

    assert reason(changed("plane 20", sin2_half_angle=dyadic_above(least, 60))) == ""
    below = dyadic_below(least * (1 - HAIR), 60)
    assert "sin2_half_angle" in reason(changed("plane 20", sin2_half_angle=below))
    assert sin2.value >= least


def test_forms_of_the_proof_that_are_nonsense_are_refused():
    caps = made("plane 20")["proof"]["caps"]
    for entries in (
        {"pose": [0, 0, 0, 0]},
        {"mu": Dyadic(mantissa=-1, exponent=-40)},
        {"gap": Dyadic(mantissa=0, exponent=0)},
        {"gap": Dyadic(mantissa=-1, exponent=0)},
        {"caps": caps[:5]},
        {"caps": caps * 13},
        {"caps": [0, 0, 0, 0, *caps[4:]]},
        {"caps": [entry << 300 for entry in caps[:4]] + caps[4:]},
        {"caps": [*caps[:4], -caps[4], caps[5]]},
        {"caps": [*caps[:4], 0, 0]},
        {"caps": [*caps[:4], 1, 10**6]},
        {"caps": None},
        {"symmetry": [1, 0, 0, 0, 0, 0], "unique": False},
    ):
        assert reason(changed("plane 20", **entries)) != ""


# Ties --------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_two_optima_of_exact_numbers_are_seen_to_be_tied():
    outcome, proof = outcome_of(made("two optima")), made("two optima")["proof"]

    assert (
        "The rotation of the global optimum is NOT unique: other rotations have the same objective."
        in (outcome.theorems)
    )
    assert made("two optima")["claims"]["unique"] is False
    assert "claims.unique" in reason(changed("two optima", unique=True))
    assert reason(changed("two optima", unique=None)) == ""
    assert reason(changed("two optima", caps=proof["caps"][:6])) != ""
    assert "mu = 0" in reason(changed("two optima", mu=Dyadic(mantissa=1, exponent=-200)))


def test_a_rotation_that_is_nearly_tied_is_not_taken_for_a_tie():
    """The other cap off its centre by 2^-40: its objective is larger, and no tie is seen."""
    w, x, y, z, *curvature = made("two optima")["proof"]["caps"][6:]
    moved = [w, x, y + (w + x >> 40), z, *curvature]
    caps = made("two optima")["proof"]["caps"][:6]

    assert reason(changed("two optima", caps=[*caps, *moved], unique=None)) == (
        "a cap proves too little"
    )
    assert reason(changed("two optima", caps=[*caps, *moved])) == "a cap proves too little"


@pytest.mark.slow
def test_an_optimum_is_not_tied_with_itself():
    """Exact planes through exact points: the identity is stationary, and the only optimum."""
    points = np.random.default_rng(1).integers(-4, 5, size=(12, 3)).astype(float)
    problem = RegistrationProblem(points, points, normals=np.tile(np.eye(3), (4, 1)))
    body: Any = cones_body(Springs.of(problem), [(1, 0, 0, 0)]).body
    alone = document(problem, body)
    alone["claims"] |= {"unique": False, "sin2_half_angle": None}
    alone["proof"]["mu"] = [0, 0]

    assert len(alone["proof"]["caps"]) == 6
    assert reason(alone) == "claims.unique is not proved"


def test_one_rotation_by_two_quaternions_is_no_tie():
    caps = made("plane 20")["proof"]["caps"]
    again = [*[-entry for entry in caps[:4]], *caps[4:]]

    assert reason(changed("plane 20", caps=[*caps, *again])) == ""
    assert reason(changed("plane 20", caps=[*caps, *again], unique=False)) != ""


# The parts ---------------------------------------------------------------------------------------


def springs_of(quartic: Any, unit: Fraction) -> Any:
    """What the checker makes of data, of which here two numbers are of matter."""
    found = checker.CheckedSprings.__new__(checker.CheckedSprings)
    for name, value in (("F", [*quartic]), ("unit", unit)):
        object.__setattr__(found, name, value)
    return found


def random_quartic(seed: int) -> list[int]:
    return [int(entry) for entry in np.random.default_rng(seed).normal(size=35) * 2.0**40]


def values(quartic: Any, points: Any) -> Any:
    monomials = [np.prod([points[:, k] for k in m], axis=0) for m in checker.QUARTICS]
    return np.array(quartic, dtype=float) @ np.array(monomials)


def sphere(count: int) -> Any:
    points = np.random.default_rng(5).normal(size=(count, 4))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def test_the_spread_is_at_least_that_of_many_rotations():
    points = sphere(500)
    difference = [(m == (0,) * 4) - (m == (1,) * 4) for m in checker.QUARTICS]  # from -1 to 1
    assert checker.spread(springs_of(difference, Fraction(3))) == 6
    for quartic in [*map(random_quartic, range(10)), *np.eye(35, dtype=int).tolist()]:
        springs = springs_of(quartic, Fraction(1))
        found = values(quartic, points)

        assert checker.spread(springs) >= Fraction(float(found.max() - found.min())) * (1 - HAIR)


@pytest.mark.parametrize(("level", "proved"), [(1e-7, True), (-1e-7, False), (0, False)])
def test_cones_decide_on_the_sign_of_a_form_that_is_no_sum_of_squares(level, proved):
    names = {(0, 0, 0, 0): 1, (1, 1, 2, 2): 1, (2, 2, 3, 3): 1, (1, 1, 3, 3): 1, (0, 1, 2, 3): -4}
    form = [
        int((names.get(m, 0) + level * k) * 2**40)
        for m, k in zip(checker.QUARTICS, checker.SQUARE, strict=True)
    ]
    if proved:
        checker.prove_positive(form, [])
    else:
        with pytest.raises(checker.RefusalError):
            checker.prove_positive(form, [])


def test_a_form_that_is_zero_at_a_vertex_is_not_positive():
    form = [0] * 35
    for k, j in product(range(1, 4), range(4)):  # (x^2 + y^2 + z^2) |q|^2
        form[checker.QUARTICS.index(tuple(sorted((k, k, j, j))))] += 1

    with pytest.raises(checker.RefusalError, match="outside of the caps"):
        checker.prove_positive(form, [])


def test_the_radius_of_a_cap_is_its_curvature_over_the_spread(monkeypatch):
    ratios, cap_of = list[Fraction](), checker.cap_of
    monkeypatch.setattr(
        checker, "cap_of", lambda c, ratio: ratios.append(ratio) or cap_of(c, ratio)
    )
    objective = objective_of("plane 20")
    width = checker.spread(springs_of(objective.quartic, objective.unit))

    assert reason(made("plane 20")) == ""
    assert ratios == [made_curvature("plane 20") / width]


def test_all_orthants_are_covered():
    """A form that is negative in a small cap about any sign pattern is refused."""
    for signs in product((1, -1), repeat=4):
        u = [entry * sign for entry, sign in zip((5, 7, 11, 13), signs, strict=True)]
        form = checker.growth_form([0] * 35, u, Fraction(1, 100), Fraction(-1))

        with pytest.raises(checker.RefusalError, match="outside of the caps"):
            checker.prove_positive(form, [])


def test_a_cap_holds_what_is_within_its_radius_and_its_mirror_image():
    cap = checker.cap_of([3, 0, 0, 4], Fraction(1, 2))  # an angle of 1/32 to the quaternion
    u = np.array([0.6, 0.0, 0.0, 0.8])
    across = np.array([0.0, 0.8, -0.6, 0.0])
    inside, outside = (
        [int(e * 2.0**50) for e in math.cos(a) * u + math.sin(a) * across]
        for a in (0.999 / 32, 1.001 / 32)
    )

    assert checker.holds(cap, [inside])
    assert checker.holds(cap, [[-e for e in inside]] * 2)
    assert not checker.holds(cap, [inside, [-e for e in inside]])
    assert not checker.holds(cap, [inside, outside])
    assert not checker.holds(cap, [outside, inside])


def test_the_slope_and_the_curvature_are_those_of_the_energy_along_turns():
    q = (3, -1, 2, 5)
    objective = objective_of("plane 20")
    springs = springs_of(objective.quartic, objective.unit)
    least = Fraction(least_curvature("plane 20", minima_of("plane 20")[0]))
    best = minima_of("plane 20")[0]

    assert checker.local(springs, best, least * Fraction(999, 1000)) < Fraction(1, 10**30)
    with pytest.raises(checker.RefusalError, match="curvature"):
        checker.local(springs, best, least * Fraction(1001, 1000))
    with pytest.raises(checker.RefusalError, match="curvature"):
        checker.local(springs, q, least)


def test_the_budget_ends_in_a_refusal(monkeypatch):
    monkeypatch.setattr(checker, "CONES_MAX", 50)

    assert reason(made("plane 20")) == "more than 50 cones are needed"


def test_cones_that_become_too_thin_end_in_a_refusal(monkeypatch):
    monkeypatch.setattr(checker, "CUTS_MAX", 9)

    assert reason(made("plane 20")) == "the gap is too small for these cones"
