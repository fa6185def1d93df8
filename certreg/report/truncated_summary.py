"""A registration by truncated squares as a person reads it, in a terminal and in a notebook."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration import at_most
from certreg.report.cards import Card
from certreg.report.consensus_summary import counted_labels
from certreg.report.remedies import ADVICE
from certreg.report.summary import number

if TYPE_CHECKING:
    from certreg.registration import TruncatedRegistration

HARDER = "give more --effort to search further, or other bounds if pairs are near to theirs"


def truncated_summary(result: TruncatedRegistration) -> str:
    """The result of `certify` with truncated squares, readable."""
    facts = [f"  {name:<17} {value}" for name, value in truncated_facts(result)]
    advice = [] if result.labels_unique else [f"{ADVICE}{HARDER}."]
    return "\n".join([result.headline, *advice, "", *facts])


def truncated_card(result: TruncatedRegistration) -> str:
    """The same as a card."""
    good = result.labels_unique and result.unique
    return Card(
        headline=result.headline, notes=(), good=good, facts=tuple(truncated_facts(result))
    ).html()


def truncated_facts(result: TruncatedRegistration) -> list[tuple[str, str]]:
    """The numbers beside the headline, by name, that of pairs first."""
    rmse = result.fit.rmse
    gap = (
        "no bound is proved"
        if result.gap is None
        else f"less than {at_most(result.gap, 2)} (proved)"
    )
    return [
        ("correspondences", str(result.problem.n)),
        ("truncated cost", f"{result.cost:.9g}"),
        ("above the least", gap),
        ("labels", counted_labels(result.labels)),
        ("rotation (wxyz)", " ".join(map(repr, result.pose.quaternion_wxyz.tolist()))),
        ("RMSE within", "beyond doubles" if rmse is None else number(rmse)),
    ]
