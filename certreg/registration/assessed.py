"""What is known of a pose that was judged."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.registration.findings import GOOD, JudgedEnergies, SigmaDistance
from certreg.results import Absent, Explained, PoseVerdict, Presented

if TYPE_CHECKING:
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.registration.convention_errors import Slip
    from certreg.registration.fit import Fit
    from certreg.registration.gap_parts import GapParts


@dataclass(frozen=True, slots=True, kw_only=True)
class Assessment(Explained, Presented):
    """What is known of a given pose.

    Attributes
    ----------
    verdict, headline, words
        The verdict; with what is proved and what speaks against it; what else is to be said of it,
        in a sentence or two.
    optimum, optimum_objective, optimum_rmse
        The certified pose beside the judged one, and what the optimum costs itself, not rounded;
        where it is not unique, nearest the identity, to 1e-4 radians.
    fit
        What the optimum is worth as a fit: a pose can be optimal and the fit poor.
    objective, rmse
        At the pose; None where it is no rotation, or beyond the doubles.
    gap_lower, gap_upper, gap_share
        Proved bounds on objective - minimum; None where it is no rotation. The share: gap_upper
        over the range of energies; None where that is zero, too.
    gap_parts
        What of it comes from the rotation, the scale and the translation; None where the scale is
        not free.
    rounding_cost
        What rounding the numbers of the optimal pose to doubles can cost.
    angle_to_optimum, angle_upper
        Radians, to the nearest optimum, computed; proved, rounded up; None where the optimum is not
        unique.
    shift_upper
        How far at most the pose puts the source's weighted centre from where every optimum puts it;
        proved, rounded up; None where nothing of it is proved.
    nearest_index, nearest_angle
        Morse index of the nearest component of equilibria; radians.
    sigma_distance
        How far the pose is from the optimum in standard deviations; None without sigma.
    slip
        The usual slip that explains a bad verdict, if any does: without it the pose is optimal.
    green
        Whether its card is: that of a pose that is optimal to rounding, with nothing against it.
    energies
        All that are told, exactly; None where it is no rotation.
    absent
        Why an attribute is None, by its name.
    """

    verdict: PoseVerdict
    headline: str
    words: str
    optimum: Pose | Similarity
    optimum_objective: float | None
    optimum_rmse: float | None
    fit: Fit
    objective: float | None = None
    rmse: float | None = None
    gap_lower: float | None = None
    gap_upper: float | None = None
    gap_share: float | None = None
    gap_parts: GapParts | None = None
    rounding_cost: float | None = None
    angle_upper: float | None = None
    shift_upper: float | None = None
    angle_to_optimum: float | None = None
    nearest_index: int | None = None
    nearest_angle: float | None = None
    sigma_distance: SigmaDistance | None = None
    slip: Slip | None = None
    green: bool = False
    energies: JudgedEnergies | None = None

    def __repr__(self) -> str:
        if self.angle_to_optimum is None:
            return f"<Assessment: {self.verdict.value}>"
        away = math.degrees(self.angle_to_optimum)
        return f"<Assessment: {self.verdict.value}; {away:.6g} degrees from the optimum>"

    @property
    def hint(self) -> str | None:
        """The slip in a sentence; None without one."""
        return None if self.slip is None else self.slip.words

    @property
    def unexplained(self) -> str | None:
        """That no slip explains a bad verdict, in a sentence; None where one does."""
        slip = self.stated("slip")
        judged = self.verdict in (*GOOD, PoseVerdict.BOUNDED)
        if judged or not isinstance(slip, Absent):
            return None
        return f"{slip.reason[0].upper()}{slip.reason[1:]}."
