"""The result of `certify` with a free scale, as a person reads it in a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.geometry.similarity import Similarity
from certreg.problem.motion import Scale
from certreg.registration.breathing import scaled_equilibria
from certreg.registration.scaled_poses import unit_of
from certreg.report.breathing import scaled_equilibria_words
from certreg.report.lines import (
    explained_words,
    method_lines,
    number,
    status_lines,
    uncertainty_lines,
    untested_lines,
)
from certreg.report.remedies import ADVICE, remedies, why_warned
from certreg.report.robustness import robustness_words

if TYPE_CHECKING:
    from certreg.registration.result import Registration

SCALE_ZERO = (
    "                    0: the clouds do not correspond (the cross-covariance is zero), so that "
    "the best fit is one point"
)
BIAS = {
    Scale.ASYMMETRIC: "noise in the source makes it too small; noise in the target does not",
    Scale.SYMMETRIC: "right where both clouds have the same relative noise, too large with noise "
    "in the target alone",
}


def scaled_summary(registration: Registration) -> str:
    """The result of `certify` where the scale is free, readable."""
    pose, problem = registration.pose, registration.problem
    scale = pose.scale if isinstance(pose, Similarity) else 1.0
    unit, fit = unit_of(registration), registration.fit
    return "\n".join(
        (
            *status_lines(registration),
            *(f"{ADVICE}{words}" for words in remedies(registration)),
            "",
            f"  correspondences   {problem.n}",
            f"  scale             {scale!r}  ({problem.scale.value}; target over source)",
            *([SCALE_ZERO] if scale == 0.0 else []),
            *([] if unit is None else [f"                    {unit}"]),
            f"                    {BIAS[problem.scale]}",
            f"  rotation (wxyz)   {' '.join(map(repr, pose.quaternion_wxyz.tolist()))}",
            f"  translation       {' '.join(map(repr, pose.translation.tolist()))}",
            *uncertainty_lines(registration),
            f"  RMSE              {number(registration.rmse)}  (weighted, unit of the target)",
            f"  explained         {explained_words(fit)}{why_warned(fit)}",
            *untested_lines(fit),
            f"  robustness        {robustness_words(registration)}",
            *method_lines(registration),
            "",
            scaled_equilibria_words(
                scaled_equilibria(registration.solution.objective, registration.equilibria)
            ),
        )
    )
