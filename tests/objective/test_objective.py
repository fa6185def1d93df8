"""The objective of a problem: one form in every ring, and Davenport's matrix made once."""

from __future__ import annotations

import sys
from fractions import Fraction
from importlib import import_module
from operator import mul
from typing import Any

import casadi
import numpy as np
import pytest
import strategies
import sympy
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.polynomials import multiplier_system

import certreg
from certreg.equilibrium.batch import solve_many
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.geometry.constraints import homogeneous
from certreg.geometry.so3 import (
    angle_between,
    davenport_matrix,
    quadratic_form,
    rotation_matrix,
    squared_norm,
)
from certreg.objective.isotropic import Isotropic
from certreg.objective.scaling import SymmetricScaling
from certreg.problem.moments import exact_moments

checker_module = import_module("certreg.verify")  # the name of the function, too
Q = (2, -1, 3, 5)
CHART = (1, 2, 3, 4)
TOP_CALLS = 3  # of Davenport's matrix in one run: of the objective, of Horn, of the checker


def objective_of(problem) -> Isotropic:
    return Isotropic(exact_moments(problem))


def energy_at(problem, q, translation):
    """Sum of w |y - R x - t|^2 over the points, in fractions."""
    norm, rows = squared_norm(q), rotation_matrix(q)
    total = Fraction(0)
    for x, y, w in zip(problem.source, problem.target, problem.weights, strict=True):
        for row, t, there in zip(rows, translation, y, strict=True):
            moved = sum(Fraction(a) * Fraction(b) for a, b in zip(row, x.tolist(), strict=True))
            total += Fraction(w) * (Fraction(there) - moved / norm - t) ** 2
    return total


@pytest.mark.slow
@given(strategies.problems())
def test_form_value_energy_and_best_translation_say_the_same(problem):
    objective, isotropic = objective_of(problem), Isotropic(exact_moments(problem))
    norm = squared_norm(Q)
    value = objective.value(Q)
    form = quadratic_form(objective.form(), homogeneous(rotation_matrix(Q), unit=norm))
    energy = objective.unit * Fraction(value, norm**2)

    assert form == value
    assert energy == isotropic.energy(Q)
    assert energy == energy_at(problem, Q, objective.best_translation(Q))


@pytest.mark.slow
@settings(max_examples=25)
@given(strategies.problems(), st.tuples(*[st.integers(-9, 9)] * 4).filter(any))
def test_a_loss_is_the_share_of_the_range_of_energies_above_the_least(problem, q):
    objective = Isotropic(exact_moments(problem))
    best, worst = (objective.energy(objective.quaternions[k]) for k in (0, -1))
    share = (objective.energy(q) - best) / (worst - best) if worst > best else 0

    assert objective.relative_loss(q) == pytest.approx(float(share), rel=1e-9, abs=1e-12)


def test_the_angle_to_an_equilibrium_is_that_between_rotations():
    objective = objective_of(strategies.random_problem(np.random.default_rng(2), noise=0.5))
    here = unit_double(Q)
    for k, q in enumerate(objective.quaternions):
        assert objective.angle_to(k, Q) == pytest.approx(angle_between(here, unit_double(q)))
    assert objective.angle_to_optimum(Q) == objective.angle_to(0, Q)


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda specimen: specimen.name)
def test_the_angle_to_a_continuum_is_that_to_its_nearest_member(specimen):
    """Members are unit combinations of the vectors: the nearest is the projection of q."""
    objective, q = objective_of(specimen.problem), unit_double(Q)
    for k, space in enumerate(objective.eigenspaces.spaces):
        vectors = np.array([unit_double(v) for v in space.vectors])
        nearest = vectors.T @ (vectors @ q)
        away = angle_between(q, nearest / np.linalg.norm(nearest))

        assert objective.angle_to(k, Q) == pytest.approx(away, abs=1e-12)


@settings(max_examples=25)
@given(strategies.problems())
def test_the_size_is_the_largest_entry_or_the_spread_or_a_unit(problem):
    objective = Isotropic(exact_moments(problem))
    moments = objective.moments
    largest = moments.cross_unit * max(abs(e) for row in objective.davenport for e in row)

    assert objective.size == (largest or moments.spread or moments.cross_unit) > 0


@pytest.mark.parametrize("unit", [2.0**-9, 3.0, 2.0**9])
def test_the_least_range_is_that_of_the_cross_covariance_of_the_clouds(unit: float):
    """|K|^2 = 4 |C|^2: so (2 F)^2 is 16 |C|^2, and a free scale is told the square of K's norm."""
    source = np.array([(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 1, 3), (1, 1, 1)]) * unit
    target = np.array([(0, 1, 0), (2, 0, 1), (0, 2, 5), (1, 1, 3), (0, 0, 1)]) * unit
    moments = exact_moments(certreg.RegistrationProblem(source, target))
    x, y = ([[Fraction(e) for e in row] for row in cloud.T.tolist()] for cloud in (source, target))
    cross = [sum(map(mul, a, b)) - sum(a) * sum(b) / 5 for a in x for b in y]
    squares = sum(entry**2 for entry in cross)
    free = Isotropic(moments, SymmetricScaling(Fraction(4), Fraction(9)))

    assert Isotropic(moments).least_range_squared == 16 * squares
    assert free.least_range_squared == 4 * (4 * squares)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_the_value_is_the_same_in_every_ring(specimen):
    objective = objective_of(specimen.problem)
    exact, symbols = objective.value(Q), sympy.symbols("w x y z")
    unknown: Any = casadi.SX.sym("q", 4)
    evaluate = casadi.Function("F", [unknown], [objective.value(casadi.vertsplit(unknown))])

    assert objective.value(tuple(map(Fraction, Q))) == exact
    assert objective.value(tuple(map(float, Q))) == pytest.approx(float(exact), rel=1e-12)
    assert sympy.expand(objective.value(symbols)).subs(dict(zip(symbols, Q, strict=True))) == exact
    assert float(evaluate(Q)) == pytest.approx(float(exact), rel=1e-12)
    with ctx.workprec(200):
        assert objective.value(tuple(map(arb, Q))) == exact


def derivative(function, q, k: int) -> Fraction:
    """Of a polynomial of degree four at most in the k-th number: exact by five points."""
    at = [function([e + (i == k) * step for i, e in enumerate(q)]) for step in (-2, -1, 1, 2)]
    return Fraction(at[0] - 8 * at[1] + 8 * at[2] - at[3], 12)


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_gradient_and_hessian_are_the_derivatives_at_a_point(specimen):
    objective = objective_of(specimen.problem)
    gradient, hessian = objective.gradient(Q), objective.hessian(Q)

    assert [derivative(objective.value, Q, k) for k in range(4)] == list(gradient)
    for i, row in enumerate(hessian):
        of_row = [derivative(lambda q, i=i: objective.gradient(q)[i], Q, k) for k in range(4)]
        assert of_row == list(row)


@pytest.mark.slow
@settings(max_examples=25)
@given(strategies.problems())
def test_the_form_is_a_symmetric_matrix_of_ten(problem):
    form = objective_of(problem).form()

    assert [len(row) for row in form] == [10] * 10
    assert [tuple(column) for column in zip(*form, strict=True)] == list(form)


@pytest.mark.slow
@settings(max_examples=25)
@given(strategies.problems())
def test_residuals_and_energies_of_eigenvectors_are_those_of_their_definitions(problem):
    objective = Isotropic(exact_moments(problem))
    unit, norm = objective.moments.cross_unit, squared_norm(Q)
    image = [unit * sum(a * b for a, b in zip(row, Q, strict=True)) for row in objective.davenport]
    value = sum(a * b for a, b in zip(image, Q, strict=True)) / norm
    square = sum((a - value * b) ** 2 for a, b in zip(image, Q, strict=True)) / norm
    found = objective.eigenspaces

    assert objective.squared_residual(Q) == square
    for q, space in zip(objective.quaternions, found.spaces, strict=True):
        energy = objective.energy_of_eigenvalue(space.value, found.bits)
        assert abs(energy - objective.energy(q)) <= objective.size / 10**20


# Their values at a point are compared for the whole zoo, above; symbols take long.
SYMBOLIC = [
    pytest.param(specimen, id=specimen.name, marks=[pytest.mark.long] if k % 8 else [])
    for k, specimen in enumerate(strategies.ZOO)
]


@pytest.mark.slow
@pytest.mark.parametrize("specimen", SYMBOLIC)
def test_gradient_and_hessian_are_the_derivatives(specimen):
    objective, q = objective_of(specimen.problem), sympy.symbols("w x y z")
    value = sympy.expand(objective.value(q))
    gradient, hessian = objective.gradient(q), objective.hessian(q)

    for i in range(4):
        assert sympy.expand(gradient[i] - sympy.diff(value, q[i])) == 0
        for j in range(4):
            assert sympy.expand(hessian[i][j] - sympy.diff(value, q[i], q[j])) == 0


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_the_system_vanishes_where_the_gradient_is_radial_and_nowhere_near(specimen):
    objective = Isotropic(exact_moments(specimen.problem))
    system = multiplier_system(objective.davenport, CHART)
    size, bits = objective.largest_entry or 1, objective.eigenspaces.bits
    for vector, value in zip(objective.eigenvectors, objective.eigenvalues, strict=True):
        q = [Fraction(entry, 1 << bits) for entry in vector]
        reach = sum(a * b for a, b in zip(CHART, q, strict=True))
        if abs(reach) < Fraction(1, 1000):
            continue  # at infinity of this chart
        along = [entry / reach for entry in q]
        level = value / objective.moments.cross_unit
        residuals = [abs(r) / size for r in system.evaluate((*along, level))]
        gradient = objective.gradient(along)
        radial = [
            gradient[i] * along[j] - gradient[j] * along[i] for i in range(4) for j in range(i)
        ]
        scale = abs(objective.value(along)) + max(map(abs, gradient)) + 1
        assert max(residuals) < Fraction(1, 10**40)
        assert max(map(abs, radial)) < scale * Fraction(1, 10**40)
        assert max(map(abs, system.evaluate((*along, level + size)))) > 0


def counted(monkeypatch) -> dict[str, list[Any]]:
    """Calls of the two builders of Davenport's matrix, wherever they were imported."""
    calls: dict[str, list[Any]] = {"certreg": [], "checker": []}
    checkers = checker_module.davenport

    def built(C):
        calls["certreg"].append(C)
        return davenport_matrix(C)

    def checked(C):
        calls["checker"].append(C)
        return checkers(C)

    for name, module in list(sys.modules.items()):
        if name.startswith("certreg.") and getattr(module, "davenport_matrix", None) is not None:
            monkeypatch.setattr(module, "davenport_matrix", built)
    monkeypatch.setattr(checker_module, "davenport", checked)
    return calls


def is_of_the_moments(C, problem) -> bool:
    """Whether C is a multiple of the cross-covariance, and not some rotation."""
    known = np.array([[float(e) for e in row] for row in exact_moments(problem).cross])
    given = np.array([[float(e) for e in row] for row in C])
    known, given = known / np.linalg.norm(known), given / np.linalg.norm(given)
    return bool(np.allclose(known, given, atol=1e-9))


def test_one_run_makes_davenports_matrix_of_the_moments_three_times(monkeypatch):
    """Of the objective, of Horn's closed form in doubles, of the checker."""
    problem = strategies.random_problem(np.random.default_rng(5), noise=1.0)
    certreg.certify(problem)  # the relaxation is compiled once in a process, from symbols
    calls = counted(monkeypatch)
    certreg.certify(problem)
    ours = [C for C in calls["certreg"] if is_of_the_moments(C, problem)]

    assert len(calls["checker"]) == 1
    assert len(ours) + len(calls["checker"]) <= TOP_CALLS


def test_batches_and_register_build_no_objective_and_agree_with_it(monkeypatch):
    problem = strategies.random_problem(np.random.default_rng(6), noise=0.3)
    objective = Isotropic(exact_moments(problem))
    best = np.array(objective.quaternions[0], dtype=float)
    best /= np.linalg.norm(best)
    shift = [float(entry) for entry in objective.best_translation(objective.quaternions[0])]

    def forbidden(self, *_):
        raise AssertionError(self)

    monkeypatch.setattr(Isotropic, "__init__", forbidden)
    solved = solve_many(problem.source, problem.target[None])
    pose = certreg.register(problem.source, problem.target)

    assert abs(solved.quaternions[0, 0] @ best) == pytest.approx(1.0, abs=1e-14)
    assert abs(pose.quaternion_wxyz @ best) == pytest.approx(1.0, abs=1e-14)
    assert solved.translations[0, 0] == pytest.approx(shift, abs=1e-12)
    assert pose.translation == pytest.approx(shift, abs=1e-12)


@pytest.mark.parametrize(("here", "there"), [(0, 0), (5, 0), (0, 5), (-7, 3)])
def test_the_integer_spread_is_that_of_the_moments_in_whatever_units_the_clouds_are(here, there):
    cloud = np.array([[1.0, 0, 0], [0, 2, 0], [0, 0, 4], [1, 1, 1]])
    moments = exact_moments(
        certreg.RegistrationProblem(cloud * 2.0**here, cloud[::-1] * 2.0**there)
    )
    objective = Isotropic(moments)
    least = min(moments.source_exponent, moments.target_exponent)
    unit = Fraction(2) ** (moments.weight_exponent + 2 * least) / moments.mass

    assert objective.form()[0][0] * unit == moments.spread
