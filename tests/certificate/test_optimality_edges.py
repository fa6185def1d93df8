"""What a Davenport matrix proves, just inside and just outside of each inequality.

K of these points is diag(12, 0, -4, -8): the optimum is the identity, with v = 12.
"""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.certificate.isotropic import (
    FIRST_STEP_BITS,
    MULTIPLIER_BITS,
    STEPS,
    RotationState,
    _bits_tell,
    _radius,
    multiplier_gap,
    proved_multiplier,
    proves_basin,
    proves_multiplier,
    proves_optimality,
)
from certreg.exact.dyadic import Dyadic, dyadic_above
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

LITTLE = Fraction(1, 10**30)
IDENTITY, TURNED = (1, 0, 0, 0), (0, 1, 0, 0)
AXES = np.concatenate([np.eye(3), -np.eye(3)])


def objective_of(*lengths: float) -> Isotropic:
    return Isotropic(exact_moments(RegistrationProblem(AXES, AXES * lengths)))


OBJECTIVE = objective_of(3.0, 2.0, 1.0)


@pytest.mark.parametrize("lengths", [(3.0, 2.0, 1.0), (1.0, 2.0, 3.0), (2.0, 3.0, 1.0)])
@pytest.mark.parametrize("bits", [4, 256])
@pytest.mark.parametrize("delta", [LITTLE, Fraction(1, 3), Fraction(1)])
def test_a_maximum_is_proved_up_to_the_gap_of_eigenvalues(
    delta: Fraction, bits: int, lengths: tuple[float, ...]
):
    objective, axis = objective_of(*lengths), lengths.index(3.0)
    turned = (0, axis == 0, axis == 1, axis == 2)

    def proves(mu: Fraction, delta: Fraction, q: tuple[int, ...] = IDENTITY) -> bool:
        return proves_optimality(objective, q, mu, delta, bits=bits)

    assert proves(Fraction(0), delta)
    assert proves(12 + delta - LITTLE, delta)
    assert not proves(12 + delta, delta)
    assert not proves(Fraction(12), Fraction(0))
    assert not proves(Fraction(11), -LITTLE)
    assert not proves(Fraction(0), 12 - delta, turned)
    assert not proves(Fraction(0), Fraction(12), turned)
    assert proves(Fraction(0), 12 + delta, tuple(5 * entry for entry in turned))


def test_off_its_axis_a_quaternion_costs_what_it_loses():
    """K of (1, 0), (0, 1) is diag(12, 0): v = 6 at q = (1, 1), so that delta > 6 without mu.

    With mu it is (delta - mu/2 - 6) (delta - mu/2 + 6) > (mu/2)^2: delta > 2 + sqrt(40) at 4.
    """
    q = (1, 1, 0, 0)

    assert proves_optimality(OBJECTIVE, q, Fraction(0), 6 + LITTLE)
    assert not proves_optimality(OBJECTIVE, q, Fraction(0), Fraction(6))
    assert proves_optimality(OBJECTIVE, q, Fraction(4), Fraction(8325, 1000))
    assert not proves_optimality(OBJECTIVE, q, Fraction(4), Fraction(8324, 1000))


def test_leading_bits_tell_where_four_units_are_left():
    def told(*diagonal: int, bits: int = 4) -> bool:
        return _bits_tell([[d * (i == j) for j in range(4)] for i, d in enumerate(diagonal)], bits)

    assert told(240, 240, 240, 5 << 4)
    assert not told(240, 240, 240, (5 << 4) - 1)
    assert not told(15, 15, 15, 15)
    assert told(31, 31, 31, 31)
    assert not told(31, 31, 31, 31, bits=5)


def test_a_multiplier_is_proved_above_the_largest_eigenvalue_alone():
    assert proves_multiplier(OBJECTIVE, 12 + LITTLE)
    assert not proves_multiplier(OBJECTIVE, Fraction(12))
    assert not proves_multiplier(OBJECTIVE, 12 - LITTLE)
    assert multiplier_gap(OBJECTIVE, IDENTITY, Dyadic(mantissa=13, exponent=0)) == 2
    assert multiplier_gap(OBJECTIVE, TURNED, Dyadic(mantissa=13, exponent=0)) == 26


def test_a_proposal_moves_out_until_it_is_proved():
    first = 12 * Fraction(1, 2**FIRST_STEP_BITS)
    good, just_below = Fraction(25, 2), 12 - first / 2
    last = 4 ** (STEPS - 1) * first

    assert proved_multiplier(OBJECTIVE, good) == dyadic_above(good, MULTIPLIER_BITS)
    assert proved_multiplier(OBJECTIVE, just_below) == dyadic_above(
        just_below + first, MULTIPLIER_BITS
    )
    assert proved_multiplier(OBJECTIVE, 12 - 3 * first) == dyadic_above(12 + first, MULTIPLIER_BITS)
    assert proved_multiplier(OBJECTIVE, 12 - last * Fraction(99, 100)) is not None
    assert proved_multiplier(OBJECTIVE, 12 - last * Fraction(101, 100)) is None
    assert proved_multiplier(OBJECTIVE, Fraction(-5)) is None


def test_a_multiplier_is_proved_even_where_the_quaternion_is_far_from_the_optimum():
    lower: Any = SimpleNamespace(
        size=OBJECTIVE.size,
        optimum=TURNED,
        alignment=OBJECTIVE.alignment,
        moments=OBJECTIVE.moments,
        davenport=OBJECTIVE.davenport,
    )
    first = 12 * Fraction(1, 2**FIRST_STEP_BITS)
    for proposal in (Fraction(37, 3), 12 - first / 2):
        nu = proved_multiplier(lower, proposal)
        assert nu is not None
        assert nu == proved_multiplier(OBJECTIVE, proposal)
        assert nu.value > max(Fraction(12), proposal)


class Wrong(Isotropic):
    """With a separation that is twice the true one."""

    def eigenvalue_difference(self, first: int, second: int) -> Fraction:
        return 2 * super().eigenvalue_difference(first, second)


def test_a_radius_needs_an_angle_a_question_and_a_separation_that_is_proved():
    angle = Dyadic(mantissa=1, exponent=-40)
    made = _radius(OBJECTIVE, angle, 5.0)

    assert made is not None
    assert made.separation is not None
    assert 12 * (1 - Fraction(1, 2**22)) < made.separation.value < 12
    assert _radius(OBJECTIVE, None, 5.0) is None
    assert _radius(OBJECTIVE, angle, None) is None
    assert _radius(Wrong(OBJECTIVE.moments), angle, 5.0) is None


def test_a_multiplier_equal_to_the_maximum_is_refused_and_one_of_nothing_is_found():
    nothing = objective_of(0.0, 0.0, 0.0)
    nu = proved_multiplier(nothing, Fraction(-5))

    assert nu is not None
    assert nu.value == nothing.size / 2**FIRST_STEP_BITS


def state(
    q: tuple[int, int, int, int], a: int = 0, b: int = 0, c: int = 0, *, exponent: int = 0
) -> RotationState:
    return RotationState(quaternion=q, angular_velocity=(a, b, c, exponent))


def test_a_basin_is_proved_below_the_energy_of_the_next_equilibrium():
    """omega^T J omega / 4 = 4 (1 + 4 + 9) / 4 for this J = 4 I."""
    moving = state(IDENTITY, 1, 2, 3)
    level = Fraction(12 - 14)

    assert not proves_basin(OBJECTIVE, moving, level)
    assert proves_basin(OBJECTIVE, moving, level - LITTLE)
    slow = state(IDENTITY, 1, 2, 3, exponent=-1)
    assert not proves_basin(OBJECTIVE, slow, 12 - Fraction(14, 4))
    assert proves_basin(OBJECTIVE, slow, 12 - Fraction(14, 4) - LITTLE)
    turned = state((0, 2, 0, 0))
    assert proves_basin(OBJECTIVE, turned, -LITTLE)
    assert not proves_basin(OBJECTIVE, turned, Fraction(0))


def test_no_basin_is_proved_of_a_body_on_a_line_or_of_no_rotation():
    line = RegistrationProblem(AXES * (1.0, 0.0, 0.0), AXES)

    assert not proves_basin(Isotropic(exact_moments(line)), state(IDENTITY), Fraction(-99))
    assert not proves_basin(OBJECTIVE, state((0, 0, 0, 0)), Fraction(-99))
