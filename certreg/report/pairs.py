"""What is said of pairs that may be wrong: in a terminal, on a card, and before the page's rest."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.certificate.bounds import ExactPose, angle_from
from certreg.exact.decimals import as_given, at_most
from certreg.exact.dyadic import degrees_above
from certreg.problem.motion import ROTATION, TRANSLATION
from certreg.problem.support import Loss
from certreg.registration.misfits import FitCode, FitWarning
from certreg.registration.pair_words import bound_words, ranges_words
from certreg.report.cards import Card
from certreg.report.lines import (
    MEANS,
    RMSE_WORDS,
    UNMET,
    explained_words,
    method_lines,
    number,
    uncertainty_lines,
    verdict_words,
)
from certreg.report.parts import listed
from certreg.report.remedies import ADVICE, causes, remedies
from certreg.report.robustness import robustness_words
from certreg.report.scale import BIAS
from certreg.report.springs import springs_words
from certreg.results import Absent, Limits, present

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.registration.labelled import ConsensusRegistration, LabelledRegistration
    from certreg.registration.result import Registration

    Facts = Iterator[tuple[str, str]]

TOLD_SECOND = 4  # pairs: any three of equal lengths fit
SHOWN_ROWS = 8
DISTANCES = "of the least squares alone: a bound is on the distance of two points"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sought:
    """How labels are spoken of, by what was sought; {n}: so many pairs are within.

    everywhere: where they hold. turn: to which rotations an angle is proved, digits: of that angle.
    harder: what to do where some are undecided. right, best: what is not claimed.
    """

    everywhere: str
    turn: str
    digits: int
    harder: str
    right: str
    best: str


MOST = Sought(
    everywhere="in every motion that brings {n} within",
    turn="that of any motion that brings these {n} within",
    digits=7,
    harder="give more --effort to search and to prove harder, or smaller bounds if those are true",
    right="that an inlier is a right pair: only that every motion that meets as many meets it, too",
    best="how many pairs the other motion meets: a search found it, and none is proved to be best",
)
LEAST = Sought(
    everywhere="at every optimum",
    turn="any optimum",
    digits=2,
    harder="give more --effort to search further, or other bounds if pairs are near to theirs",
    right="that an inlier is a right pair: only that every optimum has it within its bound",
    best="that the rotation is close to the truth: only that its truncated cost is near the least",
)
SOUGHT = {Loss.CONSENSUS: MOST, Loss.TRUNCATED: LEAST}


def sought(result: LabelledRegistration) -> Sought:
    """How its labels are spoken of."""
    return SOUGHT[result.problem.loss.kind]


def pairs_summary(result: LabelledRegistration) -> str:
    """The result of `certify` with bounds on residuals, readable."""
    fit = result.fit
    verdict, *further = fit_verdict(fit)
    return "\n".join(
        [
            result.headline,
            *limit_words(result),
            *(f"{ADVICE}{words}" for words in pair_remedies(result)),
            "",
            *_lines(_labelled(result)),
            *_lines(_others(result)),
            *_lines([("least squares", f"of these {len(result.inliers)}: {verdict}")]),
            *_lines(("", words) for words in (*further, *causes(fit))),
            *_lines(("", f"{ADVICE}{words}") for words in remedies(fit)),
            *_lines(_placed(result)),
            *uncertainty_lines(fit),
            *_lines(_fitted(result)),
            *(method_lines(fit) if listed(fit) else []),
            *_lines(("warning", words) for words in warnings_of(result, verdict)),
        ]
    )


def pairs_card(result: LabelledRegistration) -> str:
    """The headline, what is proved of labels and angle, the pose of the least squares."""
    return Card(
        headline=result.headline,
        notes=[f"Warning: {one.text}" for one in result.warnings],
        good=result.good,
        facts=pair_facts(result),
    ).html()


def pair_facts(result: LabelledRegistration) -> list[tuple[str, str]]:
    """The numbers beside the headline, by name, that of pairs first, that of labels third."""
    placed = [fact for fact in _placed(result) if fact[0]]
    return [*_labelled(result), *placed, ("proved angle", _angle(result)), ("RMSE", _rmse(result))]


def _lines(facts: Iterable[tuple[str, str]]) -> Iterator[str]:
    return (f"  {name:<17} {words}" for name, words in facts)


def _labelled(result: LabelledRegistration) -> Facts:
    """How many pairs there are, and what is proved of them, or of the cost."""
    most, least = present(result.most), present(result.least)
    yield "correspondences", str(result.problem.n)
    if most is not None:
        yield "within bounds", f"{most.lower} found, at most {most.upper} (proved)"
    if least is not None:
        gap = least.gap
        yield "truncated cost", f"{least.cost:.9g}"
        told = "no bound is proved" if gap is None else f"less than {at_most(gap, 2)} (proved)"
        yield "above the least", told
    yield "labels", counted_labels(result.labels)


def _others(result: LabelledRegistration) -> Facts:
    """Another motion, where one fits more than a few; what kind of springs there are."""
    most = present(result.most)
    if most is not None and (most.second or 0) >= TOLD_SECOND:
        yield "another motion", f"fits {most.second} of the other pairs (found, not proved)"
    if (kinds := kinds_words(result.fit)) is not None:
        yield "springs", kinds


def _placed(result: LabelledRegistration) -> Facts:
    """The pose, and what is proved of its scale where that is free."""
    pose: Any = result.pose
    turn, shift = map(_numbers, (pose.quaternion_wxyz, pose.translation))
    if (bias := BIAS.get(result.problem.scale)) is not None:
        yield "scale", f"{pose.scale!r}  ({result.problem.scale.value}; target over source)"
        yield from (("", words) for words in (bias, *scale_sentences(result)))
    rows = ((ROTATION, ("rotation (wxyz)", turn)), (TRANSLATION, ("translation", shift)))
    yield from result.problem.motion.entries(rows)


def _fitted(result: LabelledRegistration) -> Facts:
    """How far pairs are off, and how far the rotation may be."""
    yield "RMSE", _rmse(result)
    yield "largest residual", number(float(result.residuals[result.inliers].max()))
    if (most := present(result.most)) is not None:
        yield from _witness(most)
    yield "proved angle", _angle(result)
    if result.fit.robustness is not None:
        yield "robustness", f"of the least squares: {robustness_words(result.fit)}"


def _witness(result: ConsensusRegistration) -> Facts:
    """Where the least-squares pose leaves its own set, the motion that meets it."""
    broken, witness = result.broken, result.witness
    if not broken:
        return
    rows = result.names.counted(broken[:SHOWN_ROWS], len(broken))
    yield "", f"of {rows}: beyond the bound at the least-squares pose, though one"
    yield "", f"motion brings all {result.lower} within, the witness:"
    yield "  its rotation", _numbers(witness.quaternion_wxyz)
    yield "  its translation", _numbers(witness.translation)
    if result.scale_interval is not None:
        scaled: Any = witness
        yield "  its scale", repr(scaled.scale)


def _numbers(values: Any) -> str:
    return " ".join(map(repr, values.tolist()))


def _rmse(result: LabelledRegistration) -> str:
    """The RMSE, and what it is of."""
    fit = result.fit
    told = f"; explained {explained_words(fit.fit)}" if listed(fit) else f", {RMSE_WORDS}"
    return f"{number(fit.rmse)}  (of these {len(result.inliers)}{told})"


def _angle(result: LabelledRegistration) -> str:
    """How far the rotations that are sought may be, proved, or why that is open."""
    degrees = turned_degrees(result)
    if isinstance(degrees, Absent):
        return f"not bounded: {degrees.reason}"
    return f"at most {degrees} degrees from this rotation to {turn_words(result)}"


def turn_words(result: LabelledRegistration) -> str:
    """To which rotations an angle is proved."""
    return sought(result).turn.format(n=len(result.inliers))


def turned_degrees(result: LabelledRegistration) -> str | Absent:
    """A bound on the angle from the rotation to all that are sought; why there is none.

    A certificate bounds the turn from a rotation of its own. The one that is shown is rounded to
    doubles and, in a report of a certificate, computed anew: what lies between is added.
    """
    turn, digits = result.turn, sought(result).digits
    told = turn and degrees_from(result.pose, turn.certified, turn.sin2, digits=digits)
    return told or Absent(result.unbounded)


def degrees_from(
    pose: Pose | Similarity, certified: Sequence[int], sin2: Fraction, *, digits: int
) -> str | None:
    """A bound on the angle from a pose to rotations near a certified one; None: 180 degrees.

    certified: its quaternion, of any length. sin2: above sin^2 of half of their angle to that.
    """
    own = ExactPose.of_doubles(pose.quaternion_wxyz, pose.translation).quaternion
    angle = angle_from(certified, own, sin2)
    return None if angle >= math.pi else at_most(degrees_above(angle), digits)


def scale_sentences(result: LabelledRegistration) -> Iterator[str]:
    """Between which scales all motions are that meet as many pairs, and what is left open."""
    most = present(result.most)
    if most is None or most.scale_interval is None:
        return
    within = ranges_words([most.scale_interval])
    yield f"Every motion that brings these {most.lower} within has a scale {within}."
    if most.undecided_scales:
        where = ranges_words(most.undecided_scales)
        yield f"With scales {where} it is not proved which {most.lower} are met."


def kinds_words(fit: Registration) -> str | None:
    """What kind of springs the pairs have that are met, and what for; None where they weigh."""
    kinds = springs_words(fit)
    return f"{kinds}, {DISTANCES}" if kinds else None


def fit_verdict(fit: Registration) -> list[str]:
    """Its headline, and what the springs leave undetermined."""
    said = verdict_words(fit)
    return said[:1] if listed(fit) else said


def warnings_of(result: LabelledRegistration, said: str = "") -> list[str]:
    """What is true of bounds, data and least squares, and should not be overlooked.

    said: what stands above, besides the headline.
    """
    fit = [one.text for one in result.fit.fit.warnings if one.text not in said]
    return [*(one.text for one in _untold(result)), *result.problem.notes, *result.notes, *fit]


def pair_remedies(result: LabelledRegistration) -> list[str]:
    """What may help where labels are undecided, and against the warnings of pairs."""
    harder = [] if result.labels_unique else [sought(result).harder]
    return [f"{words}." for words in (*harder, *(one.remedy for one in _untold(result)))]


def _untold(result: LabelledRegistration) -> list[FitWarning]:
    """Warnings of pairs, but for a bound that the headline has the width of."""
    wide = bound_words(result.problem) in result.headline
    told = result.pair_warnings
    return [one for one in told if not (wide and one.code is FitCode.WIDE_BOUND)]


def counted_labels(labels: Sequence[str]) -> str:
    """How many pairs have each label.

    >>> counted_labels(["inlier", "outlier", "outlier"])
    '1 inlier, 2 outliers, 0 undecided'
    """
    counts = {word: labels.count(word) for word in ("inlier", "outlier")}
    named = (f"{count} {word}{'s' * (count != 1)}" for word, count in counts.items())
    return f"{', '.join(named)}, {labels.count('undecided')} undecided"


def limit_words(result: LabelledRegistration) -> list[str]:
    """Within which limits a cost is called certified, where they are not met, or not the usual."""
    least, limits = present(result.least), result.fit.limits
    if least is None or not least.labels_unique or (least.certified and limits == Limits()):
        return []
    angle = f" and {as_given(limits.max_angle)} radians of the optimum" if least.unique else ""
    lead = MEANS if least.certified else UNMET
    return [f"{lead} within {as_given(limits.max_gap)} of the range of costs{angle}."]
