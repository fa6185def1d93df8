"""What is proved of labels, as a person reads it, as a JSON document, and as a card."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration.label_assessment import LabelsVerdict
from certreg.report.cards import Card
from certreg.report.encoding import Document, encoded
from certreg.results import Absent

if TYPE_CHECKING:
    from certreg.registration.label_assessment import KeptPairs

LABELS_SCHEMA = "certreg-labels/1"
NO_WITNESS = Absent("no motion was found that meets all of them")


def labels_summary(kept: KeptPairs) -> str:
    """The result of `assess` of labels, readable."""
    lines = [kept.headline, "", *(f"  {name:18}{words}" for name, words in _facts(kept))]
    return "\n".join(lines)


def _facts(kept: KeptPairs) -> tuple[tuple[str, str], ...]:
    witness = kept.witness
    facts = (
        ("correspondences", str(kept.problem.n)),
        ("labelled inliers", str(len(kept.rows))),
        ("the most", f"{kept.lower} found, at most {kept.upper} (proved)"),
    )
    if witness is None:
        return facts
    return (
        *facts,
        ("a motion: wxyz", " ".join(map(repr, witness.quaternion_wxyz.tolist()))),
        ("its translation", " ".join(map(repr, witness.translation.tolist()))),
    )


def labels_card(kept: KeptPairs) -> str:
    """The headline and the numbers of pairs."""
    good = kept.verdict is LabelsVerdict.CONSISTENT
    return Card(headline=kept.headline, notes=(), good=good, facts=_facts(kept)).html()


def labels_document(kept: KeptPairs) -> Document:
    """As `certreg-labels/1`."""
    witness = kept.witness
    return encoded(
        {
            "schema": LABELS_SCHEMA,
            "n": kept.problem.n,
            "digest": kept.problem.digest(),
            "labels": {
                "verdict": kept.verdict.value,
                "headline": kept.headline,
                "inliers": list(kept.rows),
                "refuted": list(kept.motion.refuted),
                "lower": kept.lower,
                "upper": kept.upper,
                "unique": kept.unique,
                "witness": NO_WITNESS
                if witness is None
                else {
                    "quaternion_wxyz": witness.quaternion_wxyz,
                    "translation": witness.translation,
                },
            },
        }
    )
