"""One form of the energy for springs of every kind, against sums over the points in fractions."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from strategies import ZOO, Specimen

from certreg.exact.dyadic import power_of_two
from certreg.geometry.constraints import homogeneous
from certreg.geometry.so3 import dot, rotation_matrix, squared_norm
from certreg.objective import quartics as forms
from certreg.objective.isotropic import Isotropic
from certreg.objective.quartics import quartic_of_form
from certreg.objective.springs import Springs
from certreg.problem.motion import Motion
from certreg.problem.problem import RegistrationProblem
from certreg.problem.stiffness import SPRUNG, spring_moments_of

if TYPE_CHECKING:
    from certreg.objective.form import Form


QUATERNIONS = ((1, 0, 0, 0), (2, -1, 3, 5), (0, 1, 1, 0), (-7, 3, 0, 11))
LOWER = ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))
RNG = np.random.default_rng(5)
OFFSET = np.array([3.0, 0.0, -1.0])
SOURCE, TARGET = OFFSET + RNG.normal(size=(2, 6, 3))
FACTORS = RNG.normal(size=(6, 6))
WEIGHTS = np.arange(1.0, 7.0)
MOTIONS = RNG.integers(-9, 9, size=(3, 12))  # vec M and t: no rotations, and no best translations


def energy_at(unit: float, factors: Any, z: list[Any]) -> Fraction:
    """The sum of |L^T (y - M x - t)|^2."""
    total = Fraction(0)
    for x, y, entries in zip(unit * SOURCE, unit * TARGET, factors, strict=True):
        off = [
            Fraction(y[i]) - sum(z[1 + 3 * j + i] * Fraction(x[j]) for j in range(3)) - z[10 + i]
            for i in range(3)
        ]
        pulled = [Fraction(0)] * 3
        for (row, column), entry in zip(LOWER, entries, strict=True):
            pulled[column] += Fraction(entry) * off[row]
        total += squared_norm(pulled)
    return total


def point_factors() -> Any:
    return np.outer(WEIGHTS, [1.0, 0.0, 1.0, 0.0, 0.0, 1.0])


def springs(unit: float, factors: Any = FACTORS) -> Form:
    given = RegistrationProblem(unit * SOURCE, unit * TARGET, factors=factors)
    return Springs.of(given).joint_form


def points(unit: float, **motion: Any) -> Form:
    given = RegistrationProblem(unit * SOURCE, unit * TARGET, weights=WEIGHTS**2, **motion)
    return Isotropic.of(given).joint_form


def z_of(motion: Any, unit: float = 1.0) -> list[Any]:
    move = [int(entry) for entry in motion]
    return [1, *move[:9], *(entry * Fraction(unit) for entry in move[9:])]


@pytest.mark.parametrize("unit", [1.0, 1e-3, 2.0**-300, 2.0**300])
@pytest.mark.parametrize("motion", MOTIONS)
def test_the_form_is_the_energy_of_every_motion(unit: float, motion: Any):
    z = z_of(motion, unit)

    assert springs(unit).energy(z) == energy_at(unit, FACTORS, z)
    for model in ({}, {"scale": "asymmetric"}):
        assert points(unit, **model).energy(z) == energy_at(unit, point_factors(), z)
    assert points(unit) == springs(unit, point_factors())


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("units", [(1.0, 1.0), (1.0, 2.0**-60), (1e9, 1e-9)])
def test_the_form_of_several_data_is_the_sum_of_theirs(units: tuple[float, float], motion: Any):
    one, other, z = points(units[0]), springs(units[1]), z_of(motion)
    both = one + other

    assert both.energy(z) == one.energy(z) + other.energy(z)
    assert both == other + one


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_the_quartic_of_the_form_is_that_of_one_weight_per_pair(specimen: Specimen):
    """Of weights that are no powers of two; with and without the translation's offset."""
    source, target = OFFSET + np.array(specimen.source), np.array(specimen.target)
    for weight in (1.0, 0.3):
        given = RegistrationProblem(source, target, weights=np.full(len(source), weight))
        objective = Isotropic.of(given)
        form = objective.joint_form.restricted(Motion())
        ratio = form.unit / objective.unit
        quartic = [ratio * c for c in quartic_of_form(form.rows)]

        assert quartic == list(quartic_of_form(objective.form()))
        for q in QUATERNIONS:
            norm = squared_norm(q)
            r = homogeneous(rotation_matrix(q), unit=norm)
            assert forms.value(quartic, q) == objective.value(q)
            assert forms.gradient(quartic, q) == objective.gradient(q)
            assert forms.hessian(quartic, q) == objective.hessian(q)
            assert form.best_translation(r, norm) == objective.best_translation(q)
            rounded = [float(entry) for entry in objective.best_translation(q)]
            assert objective.rounded_translation(q) == rounded
            off = (Fraction(1, 3), Fraction(-2), Fraction(5, 7))
            more = form.translation_energy(off, r, norm)
            assert objective.translation_energy(q, off) == more


@pytest.mark.parametrize("motion", MOTIONS)
def test_what_is_left_without_the_translation_is_the_least_over_it(motion: Any):
    """The derivative in t vanishes at the best one; shifts that nothing resists cost nothing."""
    wall = np.zeros((6, 6))
    wall[:, 3] = WEIGHTS  # springs along the third axis alone
    r = z_of(motion)[:10]
    for form, free in ((springs(1.0), ()), (springs(1.0, wall), ((1, 0, 0), (0, 1, 0)))):
        best = form.restricted(Motion()).best_translation([2 * entry for entry in r], 2)
        least = form.energy([*r, *best])
        value = sum(
            a * b * entry
            for a, row in zip(r, form.restricted(Motion()).rows, strict=True)
            for b, entry in zip(r, row, strict=True)
        )

        assert form.free_translations(Motion()) == free
        assert least == value * form.restricted(Motion()).unit
        for k in range(3):
            moved = [
                form.energy([*r, *(t + s * (i == k) for i, t in enumerate(best))]) for s in (1, -1)
            ]
            assert moved[0] == moved[1]
            assert (moved[0] == least) == (k < len(free))


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
@pytest.mark.parametrize("motion", [{}, {"rotation_only": True}])
def test_centred_sums_make_what_the_elimination_makes(specimen: Specimen, motion: Any):
    source, target = OFFSET + np.array(specimen.source), 0.3 * np.array(specimen.target)
    weights = np.arange(1.0, len(source) + 1.0)
    objective = Isotropic.of(RegistrationProblem(source, target, weights=weights, **motion))
    fast, slow = objective.reduced, objective.joint_form.restricted(Motion())

    assert fast.length_exponent == slow.length_exponent
    assert fast.stiffness == slow.stiffness
    assert fast.stiffness_unit == slow.stiffness_unit
    for ratio, one, other in (
        (slow.unit / fast.unit, fast.rows, slow.rows),
        (Fraction(fast.determinant, slow.determinant), fast.response, slow.response),
        (Fraction(fast.determinant, slow.determinant), fast.compliance, slow.compliance),
    ):
        assert [list(row) for row in one] == [[ratio * entry for entry in row] for row in other]


def test_a_translation_is_counted_in_the_units_of_the_form():
    form = points(2.0**-300)

    assert form.length_exponent < -300
    shifted = form.energy([0] * 10 + [power_of_two(-300), 0, 0])
    assert shifted == power_of_two(-600) * Fraction(int((WEIGHTS**2).sum()))


@pytest.mark.parametrize("motion", MOTIONS)
def test_without_a_translation_the_form_is_the_energy_of_the_motion_alone(motion: Any):
    """Of the very sums: those about the origin are others only beside a translation."""
    still = Motion(translations=0)
    r = z_of(motion)[:10]
    for form in (springs(1.0), points(1.0)):
        kept = form.restricted(still)
        value = sum(a * dot(row, r) for a, row in zip(r, kept.rows, strict=True))

        assert value * kept.unit == form.energy([*r, 0, 0, 0])
        assert kept.best_translation(r, 1) == (0, 0, 0)
        assert form.free_translations(still) == ()


def test_springs_without_a_translation_are_about_the_origin():
    still = Motion(translations=0)
    given = RegistrationProblem(SOURCE, TARGET, factors=FACTORS)
    about = spring_moments_of(SPRUNG.of(given), given.n, Motion(translations=0))
    whole, objective = Springs.of(given), Springs(about, still)

    assert objective.centre == (0, 0, 0)
    assert objective.free_translations == ()
    assert objective.reduced.rows == whole.joint_form.restricted(still).rows
    assert objective.mass_moments.mass == whole.mass_moments.mass
    for q in QUATERNIONS:
        assert objective.best_translation(q) == (0, 0, 0)
        assert objective.translation_energy(q, (Fraction(0),) * 3) == 0
        z = [
            Fraction(e, squared_norm(q))
            for row in zip(*rotation_matrix(q), strict=True)
            for e in row
        ]
        assert objective.energy(q) == energy_at(1.0, FACTORS, [1, *z, 0, 0, 0])
