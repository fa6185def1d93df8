"""One covariance for springs of every kind and every motion, beside one in eighty digits.

The reference shares no code with it: the sum over the points as the motion changes the pose, its
second derivatives by differences of steps so small that nothing of them is seen in a double.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
import pytest
from laws.zoo import SQUARES, free, named

from certreg.geometry.so3 import rotation_matrix, squared_norm
from certreg.problem.motion import Scale

if TYPE_CHECKING:
    from laws.zoo import Specimen

DIGITS, STEP = 80, mpmath.mpf(10) ** -25  # of which a difference of second order leaves thirty


def covariance_by_differences(one: Specimen, place: Any) -> Any:
    """The inverse of half the second derivatives in (dt, phi) and a free scale."""
    q, shift, scale = place
    norm = squared_norm(q)
    turn = mpmath.matrix([[_real(Fraction(e, norm)) for e in row] for row in rotation_matrix(q)])
    shift, scale = mpmath.matrix([_real(entry) for entry in shift]), _real(scale)
    points = [
        (mpmath.matrix(x.tolist()), mpmath.matrix(y.tolist()), mpmath.matrix(W.tolist()))
        for x, y, W in zip(one.given.source, one.given.target, one.matrices, strict=True)
    ]

    def energy(move: list[Any]) -> Any:
        at, moved = shift + mpmath.matrix(move[:3]), turn * mpmath.expm(_cross(move[3:6]))
        apart = ((y - (scale + move[6]) * (moved * x) - at, W) for x, y, W in points)
        return mpmath.fsum((e.T * W * e)[0] for e, W in apart)

    rows = free(one)
    half = mpmath.matrix(len(rows))
    for (i, a), (j, b) in combinations_with_replacement(enumerate(rows), 2):
        total = mpmath.mpf(0)
        for u, v in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            move = [mpmath.mpf(0)] * 7
            move[a] += u * STEP
            move[b] += v * STEP
            total += u * v * energy(move)
        half[i, j] = half[j, i] = total / (8 * STEP**2)
    inverse, found = half**-1, np.zeros((7, 7))
    for i, a in enumerate(rows):
        for j, b in enumerate(rows):
            found[a, b] = float(inverse[i, j])
    return found if one.cell.scaled else found[:6, :6]


def _real(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


def _cross(v: list[Any]) -> Any:
    x, y, z = v
    return mpmath.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def is_near(found: Any, right: Any) -> bool:
    return bool(np.abs(np.array(found) - right).max() <= 1e-12 * np.abs(right).max())


UNTOLD = ("mixed", "rays")  # weights that differ so much stand for no noise
TOLD = [
    one
    for one in SQUARES
    if one.cell.scale is not Scale.SYMMETRIC and not one.name.startswith(UNTOLD)
]


@pytest.mark.slow
@pytest.mark.parametrize(**named(TOLD))
def test_it_is_that_of_the_sum_over_the_points(one: Specimen):
    objective = one.result.solution.objective
    q = one.result.certificate.body.quaternion
    place = q, objective.best_translation(q), objective.best_scale(q)
    with mpmath.workdps(DIGITS):
        right = covariance_by_differences(one, place)
    found = one.result.covariance
    right = right * (found.variance_factor if found.estimated else 1.0)
    told = [*found.translation_sigma, *found.rotation_sigma]
    levels, axes = np.linalg.eigh(right[3:6, 3:6])

    assert is_near(found.matrix, right)
    assert np.square(told) == pytest.approx(np.diag(right)[:6], rel=1e-13)
    assert found.loosest_sigma == pytest.approx(np.sqrt(levels[-1]), rel=1e-12)
    assert abs(found.loosest_axis @ axes[:, -1]) == pytest.approx(1.0, abs=1e-12)


def test_the_reference_sees_a_change_of_a_part_in_ten_to_the_twelfth():
    right, one = np.diag([4.0, 1.0]), np.eye(2)

    assert is_near(right + 3e-12 * one, right)
    assert not is_near(right + 5e-12 * one[::-1], right)
