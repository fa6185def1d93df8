"""The objective of springs that are matrices, against sums over the points in fractions."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import prod

import numpy as np
import pytest

from certreg.geometry.constraints import homogeneous
from certreg.geometry.so3 import dot, quadratic_form, rotation_matrix, squared_norm
from certreg.objective import quartics
from certreg.objective.isotropic import Isotropic
from certreg.objective.levelling import levelled_exactly, norm_fourth
from certreg.objective.quartics import MONOMIALS
from certreg.objective.springs import FARTHEST, FARTHEST_OF_FIVE, Springs
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

QUATERNIONS = ((1, 0, 0, 0), (2, -1, 3, 5), (0, 1, 1, 0), (-7, 3, 0, 11))
KINDS = {"plane": 1, "line": 2, "full": 3}
SIDES = ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))


def factors_of(rng, n, kind):
    """Lower triangular factors of rank 1, 2, 3: that many columns, the others zero."""
    factors = rng.normal(size=(n, 6))
    columns = np.array([column for _, column in SIDES])
    factors[:, columns >= KINDS[kind]] = 0.0
    return factors


def data(kind, n=6, seed=5, scale=1.0, offset=0.0):
    rng = np.random.default_rng(seed)
    source, target = (scale * rng.normal(size=(n, 3)) + offset for _ in range(2))
    return source, target, factors_of(rng, n, kind)


def problem_of(source, target, factors):
    return RegistrationProblem(source, target, factors=factors)


def planes(normals):
    """The factors of planes with these normals."""
    rows = np.zeros((len(normals), 6))
    rows[:, [0, 1, 3]] = normals
    return rows


def energy_at(source, target, factors, q, translation):
    """Sum of |L^T (y - R x - t)|^2 over the points, in fractions."""
    norm, rows = squared_norm(q), rotation_matrix(q)
    total = Fraction(0)
    for x, y, entries in zip(source.tolist(), target.tolist(), factors.tolist(), strict=True):
        moved = [sum(a * Fraction(b) for a, b in zip(row, x, strict=True)) / norm for row in rows]
        rest = [Fraction(b) - m - t for b, m, t in zip(y, moved, translation, strict=True)]
        L = dict(zip(SIDES, map(Fraction, entries), strict=True))
        for column in range(3):
            total += sum(L[row, column] * rest[row] for row in range(column, 3)) ** 2
    return total


@pytest.mark.one_in(4)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("scale", "offset"), [(1.0, 0.0), (1e-3, 1e8), (1e150, 0.0)])
def test_value_form_and_energy_are_the_least_sum_over_the_points_exactly(kind, scale, offset):
    points = data(kind, scale=scale, offset=offset)
    springs = Springs.of(problem_of(*points))
    for q in QUATERNIONS:
        norm, best = squared_norm(q), springs.best_translation(q)
        energy = energy_at(*points, q, best)
        form = quadratic_form(springs.form(), homogeneous(rotation_matrix(q), unit=norm))

        assert springs.energy(q) == energy
        assert springs.unit * Fraction(form, norm**2) == energy
        assert springs.unit * Fraction(springs.value(q), norm**2) == energy
        for shift in ((1, 0, 0), (1, -2, 3)):
            moved = [t + Fraction(scale) * s for t, s in zip(best, shift, strict=True)]
            more = springs.translation_energy(q, moved)
            assert more > 0
            assert energy_at(*points, q, moved) == energy + more


def test_a_wall_leaves_two_shifts_and_the_turn_about_its_normal():
    source, target, _ = data("plane")
    factors = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 0.0], (len(source), 1))
    factors[:, 3] = 2.0  # L = (0, 0, 2)^T
    springs = Springs.of(problem_of(source, target, factors))

    assert springs.free_translations == ((1, 0, 0), (0, 1, 0))
    assert springs.symmetry == ((0, 0, 1, 0, 0, 0),)
    for q in QUATERNIONS:
        best = springs.best_translation(q)
        assert springs.energy(q) == energy_at(source, target, factors, q, best)
        moved = [best[0] + 1, best[1] - 2, best[2]]
        assert springs.translation_energy(q, moved) == 0
        for row, t, k in zip(rotation_matrix(q), best[:2], range(2), strict=False):
            middle = [sum(map(Fraction, source[:, j])) / len(source) for j in range(3)]
            assert dot(row, middle) / squared_norm(q) + t == middle[k]


def test_isotropic_springs_have_the_energy_of_their_weights():
    source, target, _ = data("full")
    roots = np.arange(1.0, 7.0)
    factors = np.outer(roots, [1.0, 0.0, 1.0, 0.0, 0.0, 1.0])
    springs = Springs.of(problem_of(source, target, factors))
    isotropic = Isotropic(exact_moments(RegistrationProblem(source, target, weights=roots**2)))

    assert springs.isotropic_like
    assert not Springs.of(problem_of(*data("full"))).isotropic_like
    assert springs.symmetry == ()
    of_weights = quartics.quartic_of_form(isotropic.form())
    assert [springs.unit * c for c in springs.quartic] == [isotropic.unit * c for c in of_weights]
    for q in QUATERNIONS:
        assert springs.energy(q) == isotropic.energy(q)
        assert springs.best_translation(q) == isotropic.best_translation(q)


@pytest.mark.parametrize("kind", KINDS)
def test_no_two_energies_are_further_apart_than_the_oscillation(kind):
    springs = Springs.of(problem_of(*data(kind, n=20)))
    energies = [springs.energy(q) for q in product((-2, -1, 0, 1, 2), repeat=4) if any(q)]

    assert max(energies) - min(energies) <= springs.oscillation
    assert springs.oscillation <= 3 * (max(energies) - min(energies))


@pytest.mark.parametrize("kind", KINDS)
def test_the_variance_over_all_rotations_is_that_of_both_parts(kind):
    springs = Springs.of(problem_of(*data(kind)))
    terms = list(zip(quartics.MONOMIALS, springs.quartic, strict=True))
    mean = sum(c * sphere_mean(m) for m, c in terms)
    square = sum(c * d * sphere_mean((*m, *n)) for m, c in terms for n, d in terms)
    linear, even = springs.part_sizes

    assert springs.unit**2 * (square - mean**2) == linear / 3 + even / 5


def sphere_mean(factors):
    """The mean of a product of coordinates over the unit sphere in four dimensions."""
    exponents = [factors.count(k) for k in range(4)]
    if any(e % 2 for e in exponents):
        return 0
    above = prod(prod(range(1, e, 2)) for e in exponents)
    return Fraction(above, prod(range(4, 4 + len(factors), 2)))


def test_no_two_rotations_are_farther_apart_than_said_nor_in_what_they_do_to_tensors():
    """norm(R - I)^2 = 6 - 2 tr R; of symmetric traceless S -> R S R^T it is 10 - 2 trace.

    That trace is (tr R)^2 / 2 + tr(R R) / 2 - 1. A cosine of -1/4 is that of no rational rotation.
    """
    linear, even = [], []
    for q in product(range(6), repeat=4):
        if any(q):
            R = np.array(rotation_matrix(q), dtype=object) * Fraction(1, squared_norm(q))
            linear.append(6 - 2 * R.trace())
            even.append(10 - (R.trace() ** 2 + (R @ R).trace() - 2))

    assert max(linear) == FARTHEST
    assert FARTHEST_OF_FIVE - Fraction(1, 1000) < max(even) < FARTHEST_OF_FIVE


def test_the_oscillation_is_exact_where_two_singular_values_are_equal_and_one_is_zero():
    corners = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    factors = np.tile([1.0, 0.0, 1.0, 0.0, 0.0, 1.0], (4, 1))
    springs = Springs.of(problem_of(corners, corners, factors))

    assert springs.energy((1, 0, 0, 0)) == 0
    assert springs.energy((0, 0, 0, 1)) == 16
    assert 16 <= springs.oscillation < 16 + Fraction(1, 2**50)


def test_the_oscillation_holds_where_energies_have_no_linear_part():
    """f = tr(W R X R^T), W = diag(4, 1, 0), X = diag(4, 2, 0): from 18 down to 2."""
    points = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [1, 0, 0], [-1, 0, 0]])
    factors = np.tile([2.0, 0.0, 1.0, 0.0, 0.0, 0.0], (6, 1))
    springs = Springs.of(problem_of(points, 0.0 * points, factors))
    energies = [springs.energy(q) for q in product((-1, 0, 1), repeat=4) if any(q)]

    assert (min(energies), max(energies)) == (2, 18)
    assert 16 <= springs.oscillation <= 32
    square = Fraction(25, 2) * springs.part_sizes[1]
    assert square <= springs.oscillation**2 < square * (1 + Fraction(1, 2**50))


def test_the_oscillation_holds_where_both_parts_add_up():
    """Two points, W = diag(1, 0, 4): over all rotations 20, of one part alone 17 at most."""
    points = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    factors = np.tile([1.0, 0.0, 0.0, 0.0, 0.0, 2.0], (4, 1))
    springs = Springs.of(problem_of(points, 1.5 * points, factors))
    energies = [springs.energy(q) for q in product((-1, 0, 1), repeat=4) if any(q)]
    linear, even = springs.part_sizes

    assert max(energies) - min(energies) == 20
    assert max(8 * linear, Fraction(25, 2) * even) < 17**2
    assert 20 <= springs.oscillation <= 34


AXES = np.eye(3)
CLOUD = np.array(
    [[1.0, 2, 0], [-2, 1, 3], [0, -1, 2], [3, 0, -1], [1, 1, 1], [-1, 2, -3], [2, -3, 1]]
)
LINES = {(1.0, 0, 0): [0.0, 0, 1, 0, 0, 1], (0, 0, 1.0): [1.0, 0, 1, 0, 0, 0]}  # I - d d^T


@pytest.mark.parametrize(
    ("name", "source", "factors", "free", "symmetries"),
    [
        ("one wall", CLOUD, planes([AXES[2]] * 7), 2, 1),
        ("two wall directions", CLOUD, planes([AXES[k % 2] for k in range(7)]), 1, 0),
        ("corner", CLOUD, planes([AXES[k % 3] for k in range(7)]), 0, 0),
        ("collinear points", np.outer(range(7), [1, 2, 2]), [[1.0, 0, 1, 0, 0, 1]] * 7, 0, 2),
        ("two lines", CLOUD[:2], list(LINES.values()), 0, 2),
        ("five planes", CLOUD[:5], planes(CLOUD[2:]), 0, 0),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_free_shifts_and_symmetries_of_degenerate_configurations(
    name, source, factors, free, symmetries
):
    target = source @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]).T + [1.0, 2, 3]
    springs = Springs.of(problem_of(source, target, factors))

    assert len(springs.free_translations) == free, name
    assert len(springs.symmetry) == symmetries, name
    for shift in springs.free_translations:
        assert all(dot(row, shift) == 0 for row in springs.joint_form.stiffness)
    for turn in springs.symmetry:
        assert energy_is_constant_along(springs, turn)


def energy_is_constant_along(springs, turn):
    """Whether the derivative of F along q -> a q + q b is zero at some quaternions."""
    a, b = np.array(turn[:3], dtype=object), np.array(turn[3:], dtype=object)
    for q in QUATERNIONS:
        moved = quaternion_product([0, *a], q) + quaternion_product(q, [0, *b])
        change = dot(springs.gradient(q), moved.tolist())
        if change != 0:
            return False
    return True


def quaternion_product(p, q):
    (a, b, c, d), (w, x, y, z) = p, q
    return np.array(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ],
        dtype=object,
    )


def test_derivatives_are_those_of_the_value():
    springs = Springs.of(problem_of(*data("line")))
    q = (3, -1, 2, 5)
    gradient, hessian = springs.gradient(q), springs.hessian(q)

    assert sum(a * b for a, b in zip(gradient, q, strict=True)) == 4 * springs.value(q)
    for k in range(4):
        image = sum(a * b for a, b in zip(hessian[k], q, strict=True))
        assert image == 3 * gradient[k]
        by = [Fraction(a) + (i == k) * Fraction(1, 1 << 400) for i, a in enumerate(q)]
        assert abs((springs.value(by) - springs.value(q)) * 2**400 / gradient[k] - 1) < 2**-300


def test_a_levelled_quartic_is_the_quartic_less_its_mean():
    """Means over unit quaternions: 3/24 of w^4, 1/24 of w^2 x^2, 0 of all other monomials."""
    quartic = [7 * k * k % 23 - 11 for k in range(35)]
    even = {m: 3 if len(set(m)) == 1 else 1 for m in MONOMIALS if m[0] == m[1] and m[2] == m[3]}
    level = Fraction(sum(e * even.get(m, 0) for m, e in zip(MONOMIALS, quartic, strict=True)), 24)
    found = levelled_exactly(quartic)

    assert found.level == level
    for q in QUATERNIONS:
        less = quartics.value(quartic, q) - level * squared_norm(q) ** 2
        assert found.value(q) == 24 * less
        assert found.scale * quartics.value([Fraction(e) for e in found.rest], q) == less
    assert 0.5 <= max(abs(found.rest)) < 1.0


def test_a_quartic_is_constant_where_it_is_its_mean_and_nowhere_near():
    constant = [int(times) for times in norm_fourth()]

    assert levelled_exactly(constant).is_constant
    assert levelled_exactly([10**30 * times for times in constant]).is_constant
    for place in range(35):
        near = [10**30 * times + (k == place) for k, times in enumerate(constant)]
        assert not levelled_exactly(near).is_constant
