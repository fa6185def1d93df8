"""What to do about what is said against a pose, and why it is said though much is explained.

Plain sentences, of what may help and no more. A module of its own, since text, page and card all
say them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration.ambiguity import ambiguous_words, narrow_words
from certreg.registration.headlines import is_loose
from certreg.registration.misfits import FitCode
from certreg.report.sentences import begun

if TYPE_CHECKING:
    from certreg.registration.fit import Fit
    from certreg.registration.result import Registration


ADVICE = "What to do: "  # before a remedy in text; a page sets it apart
GIVE_SIGMA = "give sigma, which may rule the other pose out; or "
TELL_APART = "add pairs off the axis of the turn to the other pose: they may tell the two apart"
WIDEN = (
    "check the pairs: a few wrong ones are enough for the other pose to fit better; or add pairs "
    "off the axis of the turn to the other pose: they may widen the margin"
)
SINGLE_OUT = "add pairs off the line, plane or symmetry of these: they may single one pose out"
ACROSS = "add pairs with springs across what is undetermined: they may single one pose out"
FIX_TURN = "add pairs farther from that axis: they may fix the turn about it"
WHY_BOTH = {  # a warning, and half of the target's spread or more explained
    FitCode.SCALE: "",  # what is explained is told to be with the best scale
    FitCode.OUTLIER_ROWS: ": most rows fit, the warning is of the others",
    FitCode.SHUFFLED: "; in another order the rows explain more",
    FitCode.MIRRORED: "; a mirror image explains more",
    FitCode.CHI2: "; the residuals are small beside the spread, and large beside sigma",
}
MUCH = 0.5  # explained: less needs no excuse


def causes(registration: Registration) -> list[str]:
    """Why there are remedies, in sentences, but for what a headline and warnings say themselves."""
    equilibria = registration.equilibria
    if equilibria is None:
        return []
    if (ambiguity := equilibria.classification.ambiguity) is not None:
        return [f"Not unique: {ambiguity.value}."]
    narrow = None if is_loose(registration) else narrow_words(equilibria)
    words = ambiguous_words(equilibria) or narrow
    return [] if words is None else [f"{begun(words).removesuffix('.')}."]


def remedies(registration: Registration) -> list[str]:
    """A sentence for each warning of the fit, and a rotation that is hardly fixed, or not."""
    problem, equilibria = registration.problem, registration.equilibria
    told = [one.remedy for one in registration.fit.warnings]
    if equilibria is not None and equilibria.nearly_ambiguous:
        other = problem.motion.options  # of these no noise rules a pose out
        helpful = not (other or problem.noise_given or told)  # nor where pairs are wrong
        told.append(f"{GIVE_SIGMA if helpful else ''}{TELL_APART}")
    elif registration.unique and is_loose(registration):
        told.append(FIX_TURN)
    elif equilibria is not None and registration.unique and equilibria.narrow:
        told.append(WIDEN)
    elif (registration.unique is False or registration.solution.weak_shifts) and not told:
        told.append(ACROSS if equilibria is None else SINGLE_OUT)
    return [f"{words}." for words in told]


def why_warned(fit: Fit) -> str:
    """Why a fit is warned of that explains much: to be added to how much; empty where it is not."""
    if fit.explained is None or fit.explained < MUCH:
        return ""
    return next((words for code, words in WHY_BOTH.items() if code in fit.codes), "")
