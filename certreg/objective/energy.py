"""Potential energy of the virtual springs: the maximum-likelihood objective, exactly.

V_p(q) = sum w |y - mean|^2 + sum w |x - mean|^2 - 2 q^T K q / |q|^2 at the best translation, and
M |c|^2 more where the source's centre of mass is c away from the target's [Yang2020, V_p].
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.exact import power_of_two
from certreg.geometry import (
    davenport_matrix,
    dot,
    quadratic_form,
    rotation_matrix,
    squared_norm,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.geometry import Vector3
    from certreg.problem import ExactMoments


def alignment(moments: ExactMoments, q: Sequence[int]) -> Fraction:
    """q^T K q / |q|^2 = tr(R(q)^T C), for an integer quaternion q other than zero."""
    davenport = davenport_matrix(moments.cross)
    unit = moments.cross_unit
    return Fraction(
        quadratic_form(davenport, q) * unit.numerator, squared_norm(q) * unit.denominator
    )


def potential_energy(moments: ExactMoments, q: Sequence[int]) -> Fraction:
    """V_p at rotation R(q) and the best translation: sum of w |y - R x - t|^2, minimised over t."""
    return moments.spread - 2 * alignment(moments, q)


def best_translation(moments: ExactMoments, q: Sequence[int]) -> Vector3[Fraction]:
    """The translation mean(y) - R(q) mean(x): the minimiser of the objective at fixed rotation."""
    norm = squared_norm(q)
    rotated = [dot(row, moments.source_sum) for row in rotation_matrix(q)]
    a, b = moments.source_exponent, moments.target_exponent
    common = min(a, b)
    unit = power_of_two(common) / (moments.mass * norm)
    x, y, z = (
        ((end * norm << (b - common)) - (moved << (a - common))) * unit
        for end, moved in zip(moments.target_sum, rotated, strict=True)
    )
    return (x, y, z)


def translation_energy(
    moments: ExactMoments, q: Sequence[int], translation: Sequence[Fraction]
) -> Fraction:
    """M |t - best t|^2: what a translation adds to the energy at rotation R(q)."""
    best = best_translation(moments, q)
    offset = [a - b for a, b in zip(translation, best, strict=True)]
    return moments.total_weight * sum((d * d for d in offset), start=Fraction(0))
