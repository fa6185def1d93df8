"""A registration with wrong pairs as a card in a notebook."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.report.cards import Card
from certreg.report.consensus_summary import counted_labels, warning_notes
from certreg.report.lines import number
from certreg.report.scaled_consensus import scale_facts

if TYPE_CHECKING:
    from certreg.registration.consensus import ConsensusRegistration


def consensus_card(result: ConsensusRegistration) -> str:
    """The headline, the numbers of pairs, and the pose of the least squares over the met ones."""
    labels, pose = result.labels, result.pose
    rmse = result.fit.rmse
    return Card(
        headline=result.headline,
        notes=warning_notes(result),
        good=result.good,
        facts=(
            ("within bounds", f"{result.lower} found, at most {result.upper} (proved)"),
            ("labels", counted_labels(labels)),
            *scale_facts(result),
            ("rotation (wxyz)", " ".join(map(repr, pose.quaternion_wxyz.tolist()))),
            ("translation", " ".join(map(repr, pose.translation.tolist()))),
            ("RMSE", "beyond doubles" if rmse is None else number(rmse)),
        ),
    ).html()
