"""The rotation of least energy of general springs, in floating point: a proposal.

The relaxation is asked first: where it is tight, its rotation is the optimum. Elsewhere, as with
the several exact optima of six planes, all 40 critical lines are tracked; the best local minimum
is the answer. Where lines are missing, or meet, a descent begins at each end. Only a certificate
says what it is worth.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.paths import CriticalLines, PathsOutcome, critical_lines
from certreg.equilibrium.quartics import FloatingQuartic, QuarticDescent, descended
from certreg.geometry.so3 import squared_norm
from certreg.objective.normalisation import LevelledExactly, levelled_exactly
from certreg.relaxation.quartic import QuarticRelaxation, relax_quartic
from certreg.relaxation.refining import POSE_BITS, newton, refined
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.exact.spaces import IntegerQuaternion
    from certreg.objective.springs import Springs

    Reals = NDArray[np.float64]

CRITICAL = 1e-20  # slope over the largest coefficient: beyond what doubles reach
TIGHT = 1e-6  # of the largest coefficient: value of the rotation less that of the relaxation
MOST_MINIMA = 20  # that are refined: half of 40 lines at most, as minima are; of a continuum some
FLAT = 1e-6  # of the largest curvature: a minimum that is nearly degenerate may seem to curve down
SAME_MINIMUM = 1e-5  # sine between quaternions: a descent is right to 1e-7 where curvature is weak
TIGHT_WORDS = "The relaxation is tight: it found one rotation whose energy is its own value."
CONSTANT_WORDS = "The energy is the same at every rotation: there is nothing to find."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found(Brief):
    """What was found of the optimum.

    quaternion: of the best local minimum, its length near 2^96, right to about 2^-96 where the
        Hessian is not singular.
    minima: the local minima that were met, the best first: all there are if `lines` says FOUND.
        Of a continuum some members. Where the relaxation is tight the optimum alone.
    relaxation: of the levelled quartic `levelled.rest`; value and Gram matrix are in its units.
    lines: the critical lines; None where the relaxation was enough.
    words: how it was found.
    """

    quaternion: IntegerQuaternion
    minima: tuple[IntegerQuaternion, ...]
    levelled: LevelledExactly
    relaxation: QuarticRelaxation
    lines: CriticalLines | None
    words: str


def find_optimum(objective: Springs, solver: str | None = None) -> Found:
    """The best rotation that is found, and how.

    solver: as in `relax_quartic`.
    """
    return optimum_of(objective.quartic, solver)


def optimum_of(quartic: Sequence[int], solver: str | None = None) -> Found:
    """The best minimum that is found of a quartic of 35 integer coefficients, and how."""
    levelled = levelled_exactly(quartic)
    relaxation = relax_quartic(levelled.rest, solver)
    start = relaxation.quaternion_wxyz
    if levelled.is_constant:
        identity = (1 << POSE_BITS, 0, 0, 0)
        return _found((identity,), levelled, relaxation, None, CONSTANT_WORDS)
    form = FloatingQuartic.of(levelled.rest)
    if start is not None and relaxation.rank == 1:
        optimum = _below(levelled, form, start)
        if _is_tight(levelled, relaxation, optimum):
            return _found((optimum,), levelled, relaxation, None, TIGHT_WORDS)
    lines = critical_lines(levelled.rest)
    starts = [*_starts(form, lines), *([] if start is None else [start])]
    ends = _apart(descended(form, np.array(starts)))
    minima = [refined(levelled, q.tolist()) for q in ends[:MOST_MINIMA]]
    minima.sort(key=lambda q: _exact_value(levelled, q))
    words = f"{lines.outcome.value} {_how_many(len(ends), lines)}"
    return _found(tuple(minima), levelled, relaxation, lines, words)


def _how_many(minima: int, lines: CriticalLines) -> str:
    """What the ends led to, in words."""
    several = f"the best of {minima} local minima" if minima > 1 else "the one local minimum"
    if lines.outcome is PathsOutcome.FOUND:
        return f"They led to {several}."
    return f"Descents from them led to {several} that were met."


def _found(
    minima: tuple[IntegerQuaternion, ...],
    levelled: LevelledExactly,
    relaxation: QuarticRelaxation,
    lines: CriticalLines | None,
    words: str,
) -> Found:
    return Found(
        quaternion=minima[0],
        minima=minima,
        levelled=levelled,
        relaxation=relaxation,
        lines=lines,
        words=words,
    )


def _below(levelled: LevelledExactly, form: FloatingQuartic, start: Reals) -> IntegerQuaternion:
    """The minimum near a start; descents in doubles help where Newton's method does not.

    It may end at the saddle between two minima that are near each other.
    """
    near = newton(levelled, start.tolist())
    if near.slope <= CRITICAL and _curves_up(form, near.quaternion):
        return near.quaternion
    return refined(levelled, descended(form, start[np.newaxis]).points[0].tolist())


def _curves_up(form: FloatingQuartic, q: IntegerQuaternion) -> bool:
    """Whether the Hessian at q is positive definite, as doubles see it."""
    unit = np.array([[entry / math.isqrt(squared_norm(q)) for entry in q]])
    curvatures = np.linalg.eigvalsh(form.curvatures(unit)[2][0])
    return bool(curvatures[0] > FLAT * np.abs(curvatures).max())


def _is_tight(
    levelled: LevelledExactly, relaxation: QuarticRelaxation, q: IntegerQuaternion
) -> bool:
    """Whether a rotation has the energy that the relaxation says is the least."""
    value = levelled.value(q) / (squared_norm(q) ** 2 << levelled.bits)
    return relaxation.value is not None and value - relaxation.value <= TIGHT


def _starts(form: FloatingQuartic, lines: CriticalLines) -> Reals:
    """Where minima may be: real ends that do not curve down, if all are there; else all ends."""
    if lines.outcome is not PathsOutcome.FOUND:
        return lines.points.real
    curvatures = np.linalg.eigvalsh(form.curvatures(lines.quaternions)[2])
    return lines.quaternions[curvatures[:, 0] > -FLAT * np.abs(curvatures).max()]


def _apart(ends: QuarticDescent) -> list[Reals]:
    """The ends of descents that differ, by ascending value."""
    apart: list[Reals] = []
    for q in ends.points[np.argsort(ends.values, kind="stable")]:
        if all(np.linalg.norm(q - (p @ q) * p) > SAME_MINIMUM for p in apart):
            apart.append(q)
    return apart


def _exact_value(levelled: LevelledExactly, q: IntegerQuaternion) -> Fraction:
    return Fraction(levelled.value(q), squared_norm(q) ** 2)
