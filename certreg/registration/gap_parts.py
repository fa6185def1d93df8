"""A pose beside a problem whose scale is free, or that has no translation: how it is read and told.

With a = tr(R^T C), g(a) the objective at the best scale and translation for a rotation, and W that
at its own scale and the best translation, the objective of a pose (s, R, t) exceeds the minimum by

    [g(a) - g(l1)]  +  [W(s, a) - g(a)]  +  [objective - W(s, a)]:

what the rotation costs, then the scale, then the translation. None of them is negative, each is
zero where its part is the best one, and each is known exactly, but for l1, which is proved to lie
between bounds, and the root of the symmetric scale.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import double_above
from certreg.registration.outlying import independent_rows
from certreg.registration.units import unit_words
from certreg.results import Absent, Brief

if TYPE_CHECKING:
    from certreg.certificate.bounds import ExactPose
    from certreg.geometry.given import GivenPose
    from certreg.objective.isotropic import Isotropic
    from certreg.registration.result import Registration


UNSCALED = 1e-12  # off 1: what the rounding of a rotation makes of its scale
NOT_SCALED = Absent("the scale is not free")


@dataclass(frozen=True, slots=True, kw_only=True)
class GapParts(Brief):
    """What the rotation, the scale and the translation of a pose cost; exact upper bounds, >= 0.

    In objective units, rotation with the certificate's gap: together they are not less than what
    the objective exceeds the minimum by.
    """

    rotation: Fraction
    scale: Fraction
    translation: Fraction

    @property
    def doubles(self) -> tuple[float, float, float]:
        """The same as doubles, rounded up."""
        return double_above(self.rotation), double_above(self.scale), double_above(self.translation)

    @property
    def words(self) -> str:
        """Which share of the gap each part has, in a sentence."""
        total = self.rotation + self.scale + self.translation
        if not total:
            return ""
        parts = {"scale": self.scale, "rotation": self.rotation, "translation": self.translation}
        told = [f"{_percent(part / total)} from the {name}" for name, part in parts.items()]
        return f" Of what it costs above the minimum, {told[0]}, {told[1]}, {told[2]}."


def gap_parts(objective: Isotropic, gap: Fraction, pose: ExactPose) -> GapParts | None:
    """The parts of a pose's gap; None where the scale is not free.

    gap: what the energy of the certified rotation may be above the minimum.
    """
    scaling, q = objective.scaling, pose.quaternion
    if scaling is None:
        return None
    apart = objective.translation_energy(q, pose.translation, pose.scale)
    shifted = apart / scaling.divisor(pose.scale)
    turned, best = objective.energy(q), objective.optimum
    lost = scaling.lost(objective.alignment(q), objective.alignment(best))
    centred = objective.energy_at(q, apart, pose.scale) - shifted
    return GapParts(
        rotation=max(Fraction(0), lost) + gap,
        scale=max(Fraction(0), centred - turned),
        translation=shifted,
    )


def read_for(registration: Registration, given: GivenPose) -> GivenPose:
    """A pose as the problem's are: with its scale apart where one is free, else within a matrix.

    Raises InvalidProblemError for a translation where the problem has none.
    """
    translation, alone = given.translation, given.translation is None
    if translation is not None and not registration.problem.motion.translations:
        if translation.any():
            shift = translation.tolist()
            raise InvalidProblemError(
                f"the problem is of rotations alone, and the pose has the translation {shift}: "
                "give its rotation, or state the problem without rotation_only (--rotation-only)",
                array="translation",
                value=shift,
                limit=0.0,
            )
        given = replace(given, translation=None)
    if registration.solution.objective.scaling is None:
        return given.scaled_within()
    if given.scale is not None or (alone and not is_scaled(given)):
        return given
    return replace(given, scale=1.0)


def is_scaled(given: GivenPose) -> bool:
    """Whether a pose has a scale other than 1, apart or in its matrix."""
    return abs((given.scaled_apart().scale or 0.0) - 1.0) > UNSCALED


def _percent(share: Fraction) -> str:
    """A share in per cent, never rounded up to 100 nor down to 0."""
    percent = 100.0 * float(share)
    if 0.0 < percent < 0.1:
        return "under 0.1 %"
    return "over 99.9 %" if percent >= 99.9 and share != 1 else f"{percent:.3g} %"


def unit_of(registration: Registration) -> str | None:
    """The unit of length that would explain the scale, as a question; None where none does.

    Of noise in either cloud, see `scale_between`; of fewer pairs than tell it, nothing.
    """
    objective, problem = registration.solution.objective, registration.problem
    scaling = objective.scaling
    if scaling is None or not scaling.target:
        return None
    alignment = objective.alignment(objective.optimum)
    explained = alignment**2 / (scaling.source * scaling.target)
    degrees = problem.motion.degrees(3 * independent_rows(problem))
    return unit_words(alignment / scaling.source, explained, degrees)
