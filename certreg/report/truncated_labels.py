"""What is proved of labels of rotations: readable, as a JSON document, and as a card."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration.label_assessment import LabelsVerdict
from certreg.report.cards import Card
from certreg.report.encoding import Document, encoded
from certreg.report.truncated_summary import truncated_facts
from certreg.results import Absent

if TYPE_CHECKING:
    from certreg.registration.truncated_labels import TruncatedLabels

SCHEMA = "certreg-truncated-labels/1"


def truncated_labels_summary(kept: TruncatedLabels) -> str:
    """The result of `assess` of labels of rotations, readable."""
    lines = [kept.headline, "", *(f"  {name:<18}{words}" for name, words in _facts(kept))]
    return "\n".join(lines)


def _facts(kept: TruncatedLabels) -> list[tuple[str, str]]:
    """The labels, then the best rotation; what is proved of it is proved of all labels."""
    pairs, *others = truncated_facts(kept.optimum)
    proved = [(name if name != "labels" else "proved labels", words) for name, words in others]
    return [pairs, ("labelled inliers", str(len(kept.rows))), *proved]


def truncated_labels_card(kept: TruncatedLabels) -> str:
    """The headline and the facts."""
    good = kept.verdict is LabelsVerdict.CONSISTENT
    return Card(headline=kept.headline, notes=(), good=good, facts=tuple(_facts(kept))).html()


def truncated_labels_document(kept: TruncatedLabels) -> Document:
    """As `certreg-truncated-labels/1`."""
    optimum = kept.optimum
    return encoded(
        {
            "schema": SCHEMA,
            "n": optimum.problem.n,
            "digest": optimum.problem.digest(),
            "labels": {
                "verdict": kept.verdict.value,
                "headline": kept.headline,
                "inliers": list(kept.rows),
                "disproved": kept.disproved,
                "differing": list(kept.differing),
                "proved": list(optimum.labels),
            },
            "optimum": {
                "quaternion_wxyz": optimum.pose.quaternion_wxyz,
                "cost": optimum.cost,
                "gap": Absent(optimum.verdict.words) if optimum.gap is None else optimum.gap,
                "unique": optimum.unique,
            },
        }
    )
