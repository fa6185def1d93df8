"""Results as plain sentences and a small table: what a person reads in a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.report.equilibria import rests_beside
from certreg.report.lines import (
    explained_words,
    margin_words,
    method_lines,
    number,
    rmse_words,
    status_lines,
    uncertainty_lines,
    untested_lines,
    warnings,
)
from certreg.report.parts import listed
from certreg.report.remedies import ADVICE, remedies, why_warned
from certreg.report.robustness import robustness_words
from certreg.report.scale import BIAS, scale_lines
from certreg.report.springs import springs_words

if TYPE_CHECKING:
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.registration.result import Registration


NOT_LISTED_WORDS = "the proof needs none of them; see `certreg equilibria`"


def registration_summary(registration: Registration) -> str:
    """The result of `certify`, readable: the lines of its parts, as far as they are there."""
    own, status = listed(registration), status_lines(registration)
    springs, rmse = springs_words(registration), number(registration.rmse)
    lines = [
        *status,
        *(f"{ADVICE}{words}" for words in remedies(registration)),
        "",
        f"  correspondences   {registration.problem.n}",
        *scale_lines(registration),
        *([f"  springs           {springs}, kept as given"] if springs else []),
        *place_lines(registration.pose),
        *uncertainty_lines(registration),
        f"  RMSE              {rmse}  ({rmse_words(registration)})",
        *([] if own is None else _fit_lines(own)),
        *method_lines(registration),
        *(f"  warning           {words}" for words in warnings(registration, status[0])),
        *_list_lines(own),
    ]
    return "\n".join(lines)


def place_lines(pose: Pose | Similarity) -> list[str]:
    """Rotation and translation, with all digits."""
    return [
        f"  rotation (wxyz)   {' '.join(map(repr, pose.quaternion_wxyz.tolist()))}",
        f"  translation       {' '.join(map(repr, pose.translation.tolist()))}",
    ]


def _fit_lines(registration: Registration) -> list[str]:
    """How much is explained, how near the next equilibrium is, how far points may be off."""
    fit, equilibria = registration.fit, registration.equilibria
    margin = [] if registration.problem.scale in BIAS else [margin_words(equilibria)]
    return [
        f"  explained         {explained_words(fit)}{why_warned(fit)}",
        *untested_lines(fit),
        *(f"  ambiguity margin  {words}" for words in margin),
        f"  robustness        {robustness_words(registration)}",
    ]


def _list_lines(registration: Registration | None) -> list[str]:
    """All equilibria, or where they are to be found."""
    if registration is None:
        return [f"  equilibria        not listed here: {NOT_LISTED_WORDS}"]
    return ["", *rests_beside(registration).table()]
