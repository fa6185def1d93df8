"""A registration by truncated squares as a person reads it, in a terminal and in a notebook."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.exact import as_given, at_most
from certreg.report.cards import Card
from certreg.report.consensus_fit import fit_verdict, further_lines
from certreg.report.consensus_reach import degrees_from
from certreg.report.consensus_summary import (
    counted_labels,
    pair_remedies,
    warning_notes,
    warnings_of,
)
from certreg.report.lines import MEANS, UNMET, explained_words, number, uncertainty_lines
from certreg.report.remedies import ADVICE, causes, remedies
from certreg.results import Limits

if TYPE_CHECKING:
    from certreg.registration import TruncatedRegistration

HARDER = "give more --effort to search further, or other bounds if pairs are near to theirs"


def truncated_summary(result: TruncatedRegistration) -> str:
    """The result of `certify` with truncated squares, readable."""
    facts = [f"  {name:<17} {value}" for name, value in truncated_facts(result)]
    advice = [f"{ADVICE}{words}" for words in truncated_remedies(result)]
    verdict, *_ = fit_verdict(result.fit)
    fit = [
        f"  {'least squares':<17} of these {len(result.rows)}: {verdict}",
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
    harder = [] if result.labels_unique else [f"{HARDER}."]
    return [*harder, *pair_remedies(result), *remedies(result.fit)]


def truncated_card(result: TruncatedRegistration) -> str:
    """The same as a card."""
    return Card(
        headline=result.headline,
        notes=warning_notes(result),
        good=result.good,
        facts=tuple(truncated_facts(result)),
    ).html()


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
