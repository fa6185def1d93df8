"""What is said of pairs that may be wrong: in a terminal, on a card, and before the page's rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.exact.decimals import as_given, at_most
from certreg.registration.misfits import FitCode
from certreg.registration.pair_words import bound_words
from certreg.report.cards import Card
from certreg.report.consensus_fit import fit_verdict, further_lines, kinds_words, rmse_words
from certreg.report.consensus_reach import degrees_from, reach_line
from certreg.report.lines import MEANS, UNMET, explained_words, number, uncertainty_lines
from certreg.report.parts import costed, counted
from certreg.report.remedies import ADVICE, causes, remedies
from certreg.report.scaled_consensus import scale_facts, scale_lines, witness_scale_lines
from certreg.results import Limits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.registration.labelled import ConsensusRegistration, TruncatedRegistration
    from certreg.registration.misfits import FitWarning
    from certreg.report.parts import Labelled

TOLD_SECOND = 4  # pairs: any three of equal lengths fit
SHOWN_ROWS = 8
HARDER = "give more --effort to search and to prove harder, or smaller bounds if those are true"
FURTHER = "give more --effort to search further, or other bounds if pairs are near to theirs"


def pairs_card(result: Labelled) -> str:
    """The headline, the numbers of pairs, and the pose of the least squares over those within."""
    most, least = counted(result), costed(result)
    facts = [] if least is None else truncated_facts(least)
    facts += [] if most is None else _counted_facts(most)
    return Card(
        headline=result.headline,
        notes=[f"Warning: {one.text}" for one in result.warnings],
        good=result.good,
        facts=facts,
    ).html()


def _counted_facts(result: ConsensusRegistration) -> list[tuple[str, str]]:
    pose, rmse = result.pose, result.fit.rmse
    return [
        ("within bounds", f"{result.lower} found, at most {result.upper} (proved)"),
        ("labels", counted_labels(result.labels)),
        *scale_facts(result),
        ("rotation (wxyz)", " ".join(map(repr, pose.quaternion_wxyz.tolist()))),
        ("translation", " ".join(map(repr, pose.translation.tolist()))),
        ("RMSE", "beyond doubles" if rmse is None else number(rmse)),
    ]


def consensus_summary(result: ConsensusRegistration) -> str:
    """The result of `certify` with bounds on residuals, readable."""
    fit, pose, labels = result.fit, result.pose, result.labels
    found, undecided = result.lower, labels.count("undecided")
    rmse = "beyond doubles" if fit.rmse is None else number(fit.rmse)
    kinds, (verdict, *further) = kinds_words(result), fit_verdict(fit)
    largest = float(result.residuals[result.inliers].max())
    lines = [
        result.headline,
        *([f"{ADVICE}{HARDER}."] if undecided else []),
        *(f"{ADVICE}{words}" for words in pair_remedies(result)),
        "",
        f"  correspondences   {result.problem.n}",
        f"  within bounds     {found} found, at most {result.upper} (proved)",
        f"  labels            {counted_labels(labels)}",
        *_second(result),
        *([] if kinds is None else [f"  springs           {kinds}"]),
        f"  least squares     of these {found}: {verdict}",
        *(f"                    {words}" for words in (*further, *causes(fit))),
        *(f"                    {ADVICE}{words}" for words in remedies(fit)),
        *scale_lines(result),
        f"  rotation (wxyz)   {' '.join(map(repr, pose.quaternion_wxyz.tolist()))}",
        f"  translation       {' '.join(map(repr, pose.translation.tolist()))}",
        *uncertainty_lines(fit),
        f"  RMSE              {rmse}  ({rmse_words(result)})",
        f"  largest residual  {number(largest)}",
        *_broken(result),
        reach_line(result),
        *further_lines(fit),
        *(f"  warning           {words}" for words in warnings_of(result, verdict)),
    ]
    return "\n".join(lines)


def warnings_of(result: Labelled, said: str = "") -> list[str]:
    """What is true of bounds, data and least squares, and should not be overlooked.

    said: what stands above, besides the headline.
    """
    fit = [one.text for one in result.fit.fit.warnings if one.text not in said]
    return [
        *(one.text for one in _untold(result)),
        *result.problem.notes,
        *result.notes,
        *fit,
    ]


def pair_remedies(result: Labelled) -> list[str]:
    """What may help against the warnings of pairs."""
    return [f"{one.remedy}." for one in _untold(result)]


def _untold(result: Labelled) -> list[FitWarning]:
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


def _second(result: ConsensusRegistration) -> list[str]:
    if result.second is None or result.second < TOLD_SECOND:
        return []
    return [f"  another motion    fits {result.second} of the other pairs (found, not proved)"]


def _broken(result: ConsensusRegistration) -> list[str]:
    """Where the least-squares pose leaves its own set, the motion that meets it."""
    broken = result.broken
    if not broken:
        return []
    rows = result.names.counted(broken[:SHOWN_ROWS], len(broken))
    witness = result.witness
    return [
        f"                    of {rows}: beyond the bound at the least-squares pose, though one",
        f"                    motion brings all {result.lower} within, the witness:",
        f"    its rotation    {' '.join(map(repr, witness.quaternion_wxyz.tolist()))}",
        f"    its translation {' '.join(map(repr, witness.translation.tolist()))}",
        *witness_scale_lines(result),
    ]


def truncated_summary(result: TruncatedRegistration) -> str:
    """The result of `certify` with truncated squares, readable."""
    facts = [f"  {name:<17} {value}" for name, value in truncated_facts(result)]
    advice = [f"{ADVICE}{words}" for words in truncated_remedies(result)]
    verdict, *_ = fit_verdict(result.fit)
    fit = [
        f"  {'least squares':<17} of these {len(result.inliers)}: {verdict}",
        *uncertainty_lines(result.fit),
        *further_lines(result.fit),
    ]
    warned = [f"  {'warning':<17} {words}" for words in warnings_of(result)]
    return "\n".join(
        [result.headline, *truncated_causes(result), *advice, "", *facts, *fit, *warned]
    )


def truncated_causes(result: TruncatedRegistration) -> list[str]:
    """Why less is proved than may be asked for, in sentences."""
    limits = result.fit.limits
    within = f"within {as_given(limits.max_gap)} of the range of costs"
    angle = f" and {as_given(limits.max_angle)} radians of the optimum" if result.unique else ""
    if result.labels_unique and not result.certified:
        return [f"{UNMET} {within}{angle}.", *causes(result.fit)]
    asked = [f"{MEANS} {within}{angle}."] if result.certified and limits != Limits() else []
    return [*asked, *causes(result.fit)]


def truncated_remedies(result: TruncatedRegistration) -> list[str]:
    """What may help."""
    harder = [] if result.labels_unique else [f"{FURTHER}."]
    return [*harder, *pair_remedies(result), *remedies(result.fit)]


def truncated_facts(result: TruncatedRegistration) -> list[tuple[str, str]]:
    """The numbers beside the headline, by name, that of pairs first."""
    rmse = result.fit.rmse
    gap, turn = "no bound is proved", f"not bounded: {why_unbounded(result)}"
    if result.gap is not None:
        gap = f"less than {at_most(result.gap, 2)} (proved)"
    if (degrees := optimum_degrees(result)) is not None:
        turn = f"every optimum is within {degrees} degrees of this rotation (proved)"
    return [
        ("correspondences", str(result.problem.n)),
        ("truncated cost", f"{result.cost:.9g}"),
        ("above the least", gap),
        ("labels", counted_labels(result.labels)),
        ("rotation (wxyz)", " ".join(map(repr, result.pose.quaternion_wxyz.tolist()))),
        ("proved angle", turn),
        ("RMSE within", "beyond doubles" if rmse is None else number(rmse)),
        ("explained", explained_words(result.fit.fit)),
    ]


def optimum_degrees(result: TruncatedRegistration) -> str | None:
    """A proved bound on the angle from the rotation to every optimum; None where there is none."""
    body = None if result.certificate is None else result.certificate.body
    sin2 = None if body is None else body.claims.sin2_half_angle
    if body is None or sin2 is None:
        return None
    return degrees_from(result.pose, body.quaternion, sin2.value, digits=2)


def why_unbounded(result: TruncatedRegistration) -> str:
    """Why no bound on that angle is proved."""
    ambiguity = result.fit.equilibria.classification.ambiguity
    if result.certificate is None:
        return "nothing is proved"
    if not result.labels_unique:
        return "with labels undecided, another optimum may have other pairs within their bounds"
    if ambiguity is not None:
        return f"of the pairs within their bounds, {ambiguity.value}"
    return "the pairs within their bounds hardly tell this rotation from another"
