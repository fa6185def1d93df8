"""A registration on general springs as plain sentences: what a person reads in a terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.exact.decimals import as_given, at_most
from certreg.exact.dyadic import nearest_or_zero
from certreg.registration.headlines import headline_words, is_loose, proved_degrees, share_words
from certreg.registration.loose_turns import axis_words
from certreg.registration.result import Method
from certreg.registration.weakly_constrained import weak_shift_words
from certreg.report.lines import MEANS, UNMET, number
from certreg.report.remedies import ADVICE, FIX_TURN
from certreg.report.robustness import robustness_words
from certreg.report.uncertainty import uncertainty_rows
from certreg.results import Absent, Limits, Optimality

if TYPE_CHECKING:
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration


NAMES = {
    "plane": "planes",
    "line": "lines",
    "full": "full covariances",
    "mixed": "of several kinds",
}
ONE_OF_MANY = "The pose below is one of those that are as good."
LEAST_SHIFT = "The pose below is the one of them that moves the source's centre least."
COUNTS = ("none", "one", "two", "three", "four", "five", "six", "seven", "eight")
RANKS = {1: "plane", 2: "line", 3: "full spring"}
HOW = {
    Method.SQUARES: "a sum of squares of degree four",
    Method.CONES: "branch and bound on cones of quaternions",
    Method.ENERGY: "the energy itself, which is a sum of squares",
}
TIGHT = 1e-6  # of the range of energies: a relaxation that is this near is called tight
ACROSS = "add pairs with springs across what is undetermined: they may single one pose out"
RMSE_WORDS = "along the springs, unit of the clouds"
NOT_LISTED_WORDS = "the proof needs none of them; see `certreg equilibria`"


def spring_summary(registration: Registration[QuarticSolution]) -> str:
    """The result of `certify` for general springs, readable."""
    pose, status = registration.pose, spring_verdict_words(registration)
    return "\n".join(
        (
            *status,
            *_proved_lines(registration),
            *(f"{ADVICE}{words}" for words in spring_remedies(registration)),
            "",
            f"  correspondences   {registration.problem.n}",
            f"  springs           {springs_words(registration)}, kept as given",
            f"  rotation (wxyz)   {' '.join(map(repr, pose.quaternion_wxyz.tolist()))}",
            f"  translation       {' '.join(map(repr, pose.translation.tolist()))}",
            *_uncertainty_lines(registration),
            f"  RMSE              {number(registration.rmse)}  ({RMSE_WORDS})",
            f"  relaxation (SDP)  {relaxation_words(registration)}",
            *(f"  warning           {words}" for words in spring_warnings(registration, status[0])),
            f"  equilibria        not listed here: {NOT_LISTED_WORDS}",
        )
    )


def spring_verdict_words(registration: Registration[QuarticSolution]) -> list[str]:
    """What is proved of the pose: a headline, then what else must be said before any number."""
    lines = [headline_words(registration)]
    if registration.status is Optimality.NOT_CERTIFIED:
        return lines
    free = registration.solution.freedom
    said = lines[0]
    lines += [
        _sentence(words)
        for words in (free.turn_words(), free.shift_words(), weak_words(registration))
        if words and words not in said
    ]
    if registration.unique is False:
        lines.append(ONE_OF_MANY if free.turn_words() or not free.translations else LEAST_SHIFT)
    if registration.solution.unique_rotation is None:
        if registration.unique is False and not free.turn_words():
            lines.append("Whether one rotation alone is optimal is not decided.")
        told = soft_words(registration), few_words(registration)
        lines += [_sentence(words) for words in told if words]
    if registration.status is Optimality.BOUNDED or registration.limits != Limits():
        lines.append(_limit_words(registration))
    return lines


def weak_words(registration: Registration[QuarticSolution]) -> str:
    """Which shifts are hardly resisted; empty where none is."""
    return weak_shift_words(registration.solution.weak_shifts)


def soft_words(registration: Registration[QuarticSolution]) -> str:
    """Why it may not be decided which pose is optimal; empty where nothing is known of it."""
    axes = registration.solution.soft_axes
    if len(axes) == 3:
        return "the rotation is undetermined to first order: the energy does not curve at the pose"
    if len(axes):
        about = " and ".join(axis_words(axis) for axis in axes)
        return (
            f"rotation about the source's axis {about} is undetermined to first order: the energy "
            "does not curve there"
        )
    count = registration.solution.near_minima
    if count > 1:
        return f"{count} local minima were met that differ by no more than the proved gap"
    return ""


def few_words(registration: Registration[QuarticSolution]) -> str:
    """That there are too few springs for a pose that fits exactly; empty where there are enough.

    Where every residual L^T r is zero the Hessian is 2 J^T J, J their Jacobian, of a rank that is
    at most the sum of those of the springs. No more is said: five planes that cannot be met may
    single one pose out.
    """
    problem, needed = registration.problem, COUNTS[registration.problem.motion.parameters]
    if problem.degrees_of_freedom >= 0:
        return ""
    return (
        f"the ranks of the springs add up to {problem.observations} (a plane 1, a line 2, a full "
        f"spring 3): a pose that fits exactly needs {needed} at least to be determined to first "
        "order"
    )


def _limit_words(registration: Registration[QuarticSolution]) -> str:
    """What is called certified, where that is asked for or not reached."""
    limits, bounds = registration.limits, registration.bounds
    within = f"within {as_given(limits.max_gap)} of the range of energies"
    if registration.unique is None:
        if bounds is not None and bounds.meet(limits, unique=False):
            return f"Not called certified, though {within}: whether one pose is optimal is open."
        return f"{UNMET} {within}, and of whether one pose is optimal."
    angle = ""
    if registration.solution.unique_rotation:
        angle = f" and {as_given(limits.max_angle)} radians of the optimum"
    bounded = registration.status is Optimality.BOUNDED
    return f"{UNMET if bounded else MEANS} {within}{angle}."


def _proved_lines(registration: Registration[QuarticSolution]) -> list[str]:
    bounds = registration.bounds
    if registration.status is Optimality.NOT_CERTIFIED or bounds is None:
        return []
    gap = f"{at_most(bounds.greatest_gap)}, {share_words(bounds)}"
    lines = [f"  proved gap        objective - minimum <= {gap}, at the pose below"]
    degrees = proved_degrees(registration)
    if degrees is not None:
        which = "the optimum" if registration.solution.unique_rotation else "every optimum"
        lines.append(f"  proved angle      rotation (wxyz) within {degrees} degrees of {which}")
    if registration.robustness is not None:
        lines.append(f"  robustness        {robustness_words(registration)}")
    return [*lines, f"  proved by         {how_words(registration)}"]


def how_words(registration: Registration[QuarticSolution]) -> str:
    """What proves the gap; empty where nothing is proved."""
    method = registration.method
    return "" if method is None else HOW[method]


def springs_words(registration: Registration[QuarticSolution]) -> str:
    """What kind of springs there are, and how many of each."""
    summary = registration.problem.springs
    if summary is None:
        return ""
    counts = [(summary.ranks[rank], word) for rank, word in RANKS.items() if summary.ranks[rank]]
    if len(counts) == 1:
        return NAMES[summary.kind]
    return ", ".join(f"{count} {word}{'s' * (count != 1)}" for count, word in counts)


def relaxation_words(registration: Registration[QuarticSolution]) -> str:
    """What the relaxation proposed, and how far its value is below where it is not tight."""
    solution = registration.solution
    value, bounds, away = (
        solution.relaxation_value,
        registration.bounds,
        solution.angle_to_relaxation,
    )
    if value is None or isinstance(away, Absent):
        return f"no proposal: {solution.found.relaxation.reason}"
    rank = f"rank {solution.found.relaxation.rank}"
    below = solution.least - value
    span = 0.0 if bounds is None else math.sqrt(nearest_or_zero(bounds.least_range_squared))
    share = nearest_or_zero(below) / span if span else 0.0
    if share > TIGHT:
        of_it = nearest_or_zero(below / solution.least) if solution.least else 0.0
        beside = f"{100.0 * of_it:.3g} % of the objective below it, " if of_it else ""
        return (
            f"{rank}, not tight: its value is {beside}{100.0 * share:.3g} % of the range of "
            "energies (computed)"
        )
    if solution.found.relaxation.rank != 1:
        return f"{rank}: it names no single rotation"
    return f"{rank}, {math.degrees(away):.1g} degrees from the optimum"


def spring_remedies(registration: Registration[QuarticSolution]) -> list[str]:
    """What may help where something is said against the pose."""
    told = [one.remedy for one in registration.fit.warnings]
    if registration.unique and is_loose(registration):
        told.append(FIX_TURN)
    elif (registration.unique is False or registration.solution.weak_shifts) and not told:
        told.append(ACROSS)
    return [f"{words}." for words in told]


def spring_warnings(registration: Registration[QuarticSolution], headline: str) -> list[str]:
    """What is true of the data and should not be overlooked, and is not in the headline."""
    summary = registration.problem.springs
    notes = [] if summary is None else list(summary.notes)
    return notes + [one.text for one in registration.fit.warnings if one.text not in headline]


def _uncertainty_lines(registration: Registration[QuarticSolution]) -> list[str]:
    """The rows of `uncertainty_rows`, in ASCII."""
    rows = uncertainty_rows(registration)
    plain = ([part.replace("±", "+/-") for part in row] for row in rows)
    return [f"  {name:<17} {words}" for name, words in plain]


def _sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}."
