"""What springs there are, what they leave undetermined, and how the best pose of them is proved."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.exact.dyadic import nearest_or_zero
from certreg.registration.loose_turns import axis_words
from certreg.registration.result import Method, Registration
from certreg.registration.weakly_constrained import weak_shift_words
from certreg.report.parts import sprung
from certreg.results import Absent

if TYPE_CHECKING:
    from certreg.registration.quartic import QuarticSolution

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


def springs_words(registration: Registration) -> str:
    """What kind of springs there are, and how many of each; empty where pairs weigh alone."""
    summary = registration.problem.springs
    if summary is None:
        return ""
    counts = [(summary.ranks[rank], word) for rank, word in RANKS.items() if summary.ranks[rank]]
    if len(counts) == 1:
        return NAMES[summary.kind]
    return ", ".join(f"{count} {word}{'s' * (count != 1)}" for count, word in counts)


def how_words(registration: Registration) -> str:
    """What proves the gap; empty where nothing is proved, or a closed form proves it."""
    own = sprung(registration)
    return "" if own is None or own.method is None else HOW[own.method]


def open_words(registration: Registration[QuarticSolution], said: str) -> list[str]:
    """What the springs leave open, in sentences, but for what is said already."""
    solution, unique = registration.solution, registration.unique
    free = solution.freedom
    turns, shifts = free.turn_words(), free.shift_words()
    weak = weak_shift_words(solution.weak_shifts)
    lines = [_sentence(words) for words in (turns, shifts, weak) if words and words not in said]
    if unique is False:
        lines.append(ONE_OF_MANY if turns or not free.translations else LEAST_SHIFT)
    if solution.unique_rotation is None:
        if unique is False and not turns:
            lines.append("Whether one rotation alone is optimal is not decided.")
        told = soft_words(registration), few_words(registration)
        lines += [_sentence(words) for words in told if words]
    return lines


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


def relaxation_words(registration: Registration[QuarticSolution]) -> str:
    """What the relaxation proposed, and how far its value is below where it is not tight."""
    solution, bounds = registration.solution, registration.bounds
    relaxation = solution.found.relaxation
    value, away = solution.relaxation_value, solution.angle_to_relaxation
    if value is None or isinstance(away, Absent):
        return f"no proposal: {relaxation.reason}"
    rank = f"rank {relaxation.rank}"
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
    if relaxation.rank != 1:
        return f"{rank}: it names no single rotation"
    return f"{rank}, {math.degrees(away):.1g} degrees from the optimum"


def _sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}."
