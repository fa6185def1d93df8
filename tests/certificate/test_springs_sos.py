"""Certificates of general springs by sums of squares: made, checked, and refused where forged."""

from __future__ import annotations

import json
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from exact_springs import choi_lam
from springs_certified import certified

from certreg.certificate import blockwise, bounds, checking, cones
from certreg.certificate.bounds import ExactPose
from certreg.certificate.squares import require_near, sos_body
from certreg.errors import InvalidProblemError
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.optimum import find_optimum
from certreg.verify import RefusalError, spring_moments

checker: Any = import_module("certreg.verify")
# Whose results may be None, and are not here.
spring_pose_bounds: Any = bounds.spring_pose_bounds
springs_certificate: Any = cones.springs_certificate
verify: Any = checking.verify
SCHEMAS = Path(checker.__file__).parent / "report" / "schemas"
CELLS = [
    ("plane", 7, 0.1),
    ("plane", 20, 0.1),
    ("line", 4, 0.1),
    ("aniso", 3, 0.1),
    ("mixed", 6, 0.1),
    ("wall", 20, 0.1),
]


def document(case):
    return json.loads(case.certificate.to_json())


def answer(doc, clouds=None):
    return checker.check(json.dumps(doc).encode(), clouds)


def sums_of(problem):
    return checker.spring_moments(
        problem.data_bytes()[len(checker.SpringsStatement.prefixes[0]) + 8 :], problem.n
    )


def test_a_certificate_has_the_form_of_its_schema():
    schema = json.loads((SCHEMAS / "certreg-springs-sos-1.json").read_bytes())
    validator = jsonschema.Draft202012Validator(schema)
    doc = document(certified("plane", 20, 0.1))

    validator.validate(doc)
    validator.validate(
        {**doc, "radius": {"both": [1, 0], "sin_half_angle": [1, -4], "target": [1, 0]}}
    )
    for name, value in (("gram", [1] * 20), ("mu", -1), ("symmetry", [1, 2]), ("unit", None)):
        assert not validator.is_valid({**doc, "proof": {**doc["proof"], name: value}})


def test_beside_its_data_a_certificate_is_below_a_kilobyte():
    doc = document(certified("plane", 20, 0.1))
    doc["problem"]["data"] = None

    assert len(json.dumps(doc, sort_keys=True, indent=1)) <= 1024


@pytest.mark.parametrize("cell", CELLS, ids=str)
def test_the_checker_and_the_objective_have_the_same_quartic(cell):
    case = certified(*cell)
    springs = checker.CheckedSprings.of(*sums_of(case.problem))

    ours = [c * springs.unit for c in springs.F]
    assert ours == [c * case.objective.unit for c in case.objective.quartic]


@pytest.mark.parametrize(("scale", "shift"), [(1.0, 0.0), (1e-12, 0.0), (1e12, 0.0), (1.0, 1e8)])
def test_the_sums_are_those_of_exact_fractions(scale, shift):
    rng = np.random.default_rng(5)
    x, y = scale * rng.standard_normal((2, 5, 3)) + shift
    L = rng.standard_normal((5, 6)) * 10.0 ** rng.integers(-30, 30, (5, 1))
    L[2:4, [2, 4, 5]] = 0.0
    problem = RegistrationProblem(x, y, factors=L)
    R = [
        [Fraction(2, 3), Fraction(-1, 3), Fraction(2, 3)],
        [Fraction(2, 3), Fraction(2, 3), Fraction(-1, 3)],
    ]
    R.append([Fraction(-1, 3), Fraction(2, 3), Fraction(2, 3)])
    t = [Fraction(1, 3), Fraction(-5), Fraction(7, 11)]
    total = Fraction(0)
    for p, q, row in zip(x.tolist(), y.tolist(), L.tolist(), strict=True):
        r = [
            Fraction(q[i]) - sum(R[i][j] * Fraction(p[j]) for j in range(3)) - t[i]
            for i in range(3)
        ]
        a, b, c, d, e, f = map(Fraction, row)
        total += (
            (a * r[0] + b * r[1] + d * r[2]) ** 2 + (c * r[1] + e * r[2]) ** 2 + (f * r[2]) ** 2
        )
    H, e = sums_of(problem)
    z = [*t, *(R[i][j] for j in range(3) for i in range(3)), Fraction(1)]
    value = sum(
        z[i] * z[i + j] * entry * (1 + (j > 0))
        for i, row in enumerate(H)
        for j, entry in enumerate(row)
    )

    assert value * Fraction(2) ** e == total


@pytest.mark.parametrize("scale", [1.0, 1e9, 1e-9])
def test_a_certificate_of_many_points_is_checked_in_blocks_and_on_other_sums(scale, monkeypatch):
    case = certified("plane", 20, 0.1)
    problem = RegistrationProblem(
        scale * case.problem.source, case.problem.target / 3, factors=case.problem.factors
    )
    monkeypatch.setattr(
        blockwise, "row_blocks", lambda n: (slice(k, k + 7) for k in range(0, n, 7))
    )
    tables = [
        sums_of(problem),
        blockwise._added_moments(problem),
        blockwise._table_of_sums(problem),
    ]

    least = min(e for _, e in tables)
    first, *others = ([[k << e - least for k in row] for row in table] for table, e in tables)
    assert all(other == first for other in others)
    assert blockwise.check_in_blocks(case.certificate.to_json(), case.problem).verified
    assert blockwise.check_on_sums(case.certificate.to_json(), case.problem).verified


def test_blocks_of_other_exponents_are_added_up(monkeypatch):
    case = certified("plane", 20, 0.1)
    points = [case.problem.source * 2.0**k for k in (0, 40)]
    problem = RegistrationProblem(
        np.concatenate(points),
        np.concatenate(points[::-1]),
        factors=np.concatenate([case.problem.factors] * 2),
    )
    H, e = sums_of(problem)
    monkeypatch.setattr(checker, "BLOCK", 7)
    G, d = sums_of(problem)
    least = min(d, e)

    assert [[k << e - least for k in row] for row in H] == [
        [k << d - least for k in row] for row in G
    ]


def test_a_level_above_the_optimum_is_refused():
    case = certified("plane", 20, 0.1)
    doc = document(case)
    body = case.certificate.body
    value = case.objective.energy(body.quaternion) / Fraction(2) ** body.unit
    for level in (int(value) + 1, int(value) + 10**6):
        doc["proof"]["level"] = level

        assert "do not prove" in answer(doc).reason


@pytest.mark.parametrize("name", ["gap", "sin2_half_angle"])
def test_a_claim_holds_at_the_proved_bound_and_not_below(name):
    doc = document(certified("plane", 20, 0.1))
    mantissa, exponent = doc["claims"][name]
    doc["claims"][name] = [mantissa - 1, exponent]

    assert answer(doc).reason == f"claims.{name} is not proved"


def test_a_certificate_is_about_its_factors_alone():
    case = certified("plane", 20, 0.1)
    doc = document(case)
    doc["problem"]["data"] = None
    problem = case.problem
    flipped = problem.factors.copy()
    flipped[3, 1] = -flipped[3, 1]
    other = RegistrationProblem(problem.source, problem.target, factors=flipped)
    plain = RegistrationProblem(problem.source, problem.target)

    assert verify(json.dumps(doc).encode(), problem).proved
    assert "digest" in verify(json.dumps(doc).encode(), other).words
    assert "number of points" in verify(json.dumps(doc).encode(), plain).words
    bare = checker.Clouds(
        source=tuple(problem.source.ravel()), target=tuple(problem.target.ravel())
    )
    assert "springs are others, or not given" in answer(document(case), bare).reason


def test_an_objective_that_is_constant_is_certified_with_no_angle():
    points = np.array([[1.0, 2.0, 3.0]])
    problem = RegistrationProblem(points, 2 * points, factors=[[1.0, 0.0, 1.0, 0.0, 0.0, 1.0]])
    objective = Springs.of(problem)
    certificate = springs_certificate(problem, objective, find_optimum(objective))
    verdict = verify(certificate, problem)

    assert verdict.proved, verdict.words
    assert (verdict.worth.share, verdict.worth.angle) == (0, None)
    assert "The range of energies is 0: every rotation is optimal." in verdict.theorems
    assert certificate.body.claims.unique is False


def wall(normals):
    """Points of random planes with these normals alone."""
    rng = np.random.default_rng(3)
    x, rows = rng.standard_normal((2, 12, 3))
    rows = np.array(normals, dtype=float)[np.arange(12) % len(normals)]
    return RegistrationProblem(x, x @ np.diag([1.0, -1.0, -1.0]) + 0.01, normals=rows)


@pytest.mark.slow
def test_of_one_wall_a_gap_is_proved_and_the_optimum_proved_not_unique():
    problem = wall([[1, 2, 2]])
    objective = Springs.of(problem)
    certificate = springs_certificate(problem, objective, find_optimum(objective))
    verdict = verify(certificate, problem)

    assert verdict.proved, verdict.words
    assert "Independent directions of shifts that cost nothing: 2." in verdict.theorems
    assert any("NOT unique" in theorem for theorem in verdict.theorems)
    assert verdict.worth.share < 1e-6
    doc = json.loads(certificate.to_json())
    doc["claims"]["unique"] = True
    assert answer(doc).reason == "claims.unique is not proved"
    for turns in ([0] * 6, [1, 2, 2, 1, 2, 2], [1, 2, 3, 0, 0, 0], None):
        forged = json.loads(certificate.to_json())
        forged["proof"]["symmetry"] = turns
        assert answer(forged).reason == "claims.unique is not proved", turns


def test_where_the_relaxation_is_not_tight_its_own_gap_is_proved():
    problem = choi_lam()
    objective = Springs.of(problem)
    found = find_optimum(objective)
    body: Any = sos_body(objective, found)
    relaxed: Any = found.relaxation
    relaxation = found.levelled.scale * Fraction(relaxed.value) + found.levelled.level
    gap = objective.energy(found.quaternion) - relaxation * objective.unit

    assert gap > 2  # 64 w^4 + ... of which squares reach no more
    # The solver is right to 1e-8 of the range.
    assert abs(body.claims.gap.value - gap) < gap / 10**5


def test_a_pose_is_bounded_by_a_certificate_of_the_optimum():
    case = certified("plane", 20, 0.1)
    rng = np.random.default_rng(0)
    for _ in range(5):
        pose = ExactPose.of_doubles(rng.standard_normal(4), rng.standard_normal(3))
        bounds = spring_pose_bounds(case.objective, case.certificate.body, pose)
        q = np.array(pose.quaternion, dtype=float)
        u = np.array(case.certificate.body.quaternion, dtype=float)
        angle = 2 * np.arccos(min(1.0, abs(q @ u) / np.linalg.norm(q) / np.linalg.norm(u)))

        assert 0 < bounds.least_gap < bounds.greatest_gap
        assert bounds.greatest_gap - bounds.least_gap == case.certificate.body.gap
        assert angle - 1e-7 < bounds.angle_upper < angle + 1e-7
        assert bounds.share_upper > 0


def test_the_best_pose_is_within_the_gap():
    case = certified("plane", 20, 0.1)
    body = case.certificate.body
    best = ExactPose(
        quaternion=body.quaternion, translation=case.objective.best_translation(body.quaternion)
    )
    bounds = spring_pose_bounds(case.objective, body, best)

    assert bounds.least_gap == 0
    assert bounds.greatest_gap == body.gap
    assert bounds.share_upper < 1e-20
    assert bounds.angle_upper < 1e-12


@pytest.mark.parametrize("size", [-900, -700, 0, 700, 766, 768, 770, 822, 824, 826, 1000])
@pytest.mark.parametrize("least", [None, -1020, -718, -714, -700, 0])
def test_sizes_too_far_apart_are_refused_where_the_checker_takes_no_sums(size: int, least: Any):
    """Powers of two: of the coordinates, and of one beside them."""
    rng = np.random.default_rng(0)
    points, normals = np.ldexp(rng.uniform(0.5, 1.0, (8, 3)), size), rng.normal(size=(8, 3))
    if least is not None:
        points[3, 1] = np.ldexp(1.0, least)
    problem = RegistrationProblem(points, points, normals=normals)
    try:
        spring_moments(problem.data_bytes()[-96 * problem.n :], problem.n)
    except RefusalError:
        with pytest.raises(InvalidProblemError, match="in a unit in which they are nearer to 1"):
            require_near(problem)
    else:
        require_near(problem)


def test_clouds_that_are_too_large_are_refused_with_the_remedy():
    rng = np.random.default_rng(0)
    points, normals = 1e300 * rng.normal(size=(8, 3)), rng.normal(size=(8, 3))
    problem = RegistrationProblem(points, points, normals=normals)

    with pytest.raises(InvalidProblemError, match=r"numbers from \S+ to \S+e\+300"):
        springs_certificate(problem, Springs.of(problem), find_optimum(Springs.of(problem)))
