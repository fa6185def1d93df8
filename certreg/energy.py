"""Potential energy of the virtual springs: the maximum-likelihood objective, exactly.

V_p(q) = sum w |y - mean|^2 + sum w |x - mean|^2 - 2 q^T K q / |q|^2 at the best translation, and
M |c|^2 more where the source's centre of mass is c away from the target's [Yang2020, V_p].
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.so3 import davenport_matrix, quadratic_form, rotation_matrix, squared_norm

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.moments import ExactMoments
    from certreg.so3 import Vector3


def alignment(moments: ExactMoments, q: Sequence[int]) -> Fraction:
    """q^T K q / |q|^2 = tr(R(q)^T C), for an integer quaternion q other than zero."""
    davenport = davenport_matrix(moments.cross)
    return Fraction(quadratic_form(davenport, q), squared_norm(q)) * moments.cross_unit


def potential_energy(moments: ExactMoments, q: Sequence[int]) -> Fraction:
    """V_p at rotation R(q) and the best translation: sum of w |y - R x - t|^2, minimised over t."""
    return moments.spread - 2 * alignment(moments, q)


def best_translation(moments: ExactMoments, q: Sequence[int]) -> Vector3[Fraction]:
    """The translation mean(y) - R(q) mean(x): the minimiser of the objective at fixed rotation."""
    norm = squared_norm(q)
    x, y = moments.source_centroid, moments.target_centroid
    rotated = [
        sum((a * b for a, b in zip(row, x, strict=True)), start=Fraction(0))
        for row in rotation_matrix(q)
    ]
    return (y[0] - rotated[0] / norm, y[1] - rotated[1] / norm, y[2] - rotated[2] / norm)


def translation_energy(
    moments: ExactMoments, q: Sequence[int], translation: Sequence[Fraction]
) -> Fraction:
    """M |t - best t|^2: what a translation adds to the energy at rotation R(q)."""
    best = best_translation(moments, q)
    offset = [a - b for a, b in zip(translation, best, strict=True)]
    return moments.total_weight * sum((d * d for d in offset), start=Fraction(0))
