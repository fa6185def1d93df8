"""A registration with wrong pairs as a person reads it in a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration import FitCode, bound_words
from certreg.report.consensus_fit import (
    fit_verdict,
    further_lines,
    kinds_words,
    rmse_words,
)
from certreg.report.consensus_reach import reach_line
from certreg.report.lines import number, uncertainty_lines
from certreg.report.remedies import ADVICE, causes, remedies
from certreg.report.scaled_consensus import scale_lines, witness_scale_lines

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.registration import ConsensusRegistration, FitWarning, TruncatedRegistration

TOLD_SECOND = 4  # pairs: any three of equal lengths fit
SHOWN_ROWS = 8
HARDER = "give more --effort to search and to prove harder, or smaller bounds if those are true"


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


def warnings_of(result: ConsensusRegistration | TruncatedRegistration, said: str = "") -> list[str]:
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


def warning_notes(result: ConsensusRegistration | TruncatedRegistration) -> list[str]:
    """The warnings on a card."""
    return [f"Warning: {one.text}" for one in result.warnings]


def pair_remedies(result: ConsensusRegistration | TruncatedRegistration) -> list[str]:
    """What may help against the warnings of pairs."""
    return [f"{one.remedy}." for one in _untold(result)]


def _untold(result: ConsensusRegistration | TruncatedRegistration) -> list[FitWarning]:
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
