"""What is proved of labels, as a person reads it, as a JSON document, and as a card."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from certreg.registration.label_assessment import KeptPairs, LabelsVerdict, TruncatedLabels
from certreg.report.cards import Card
from certreg.report.encoding import Document, encoded
from certreg.report.pairs import pair_facts
from certreg.results import Absent, present

LABELS_SCHEMA = "certreg-labels/1"
TRUNCATED_SCHEMA = "certreg-truncated-labels/1"
NO_WITNESS = Absent("no motion was found that meets all of them")


def labels_summary(kept: KeptPairs | TruncatedLabels) -> str:
    """The result of `assess` of labels, readable."""
    lines = [kept.headline, "", *(f"  {name:18}{words}" for name, words in _facts(kept))]
    return "\n".join(lines)


def labels_card(kept: KeptPairs | TruncatedLabels) -> str:
    """The headline and the numbers of pairs."""
    good = kept.verdict is LabelsVerdict.CONSISTENT
    return Card(headline=kept.headline, notes=(), good=good, facts=_facts(kept)).html()


def _facts(kept: KeptPairs | TruncatedLabels) -> list[tuple[str, str]]:
    """The labels; then the most pairs and a motion, or the best rotation and its proof."""
    labelled = ("labelled inliers", str(len(kept.rows)))
    if (optimum := present(kept.optimum)) is not None:
        pairs, *others = pair_facts(optimum)
        proved = [(name if name != "labels" else "proved labels", words) for name, words in others]
        return [pairs, labelled, *proved]
    return [*_counted(cast("KeptPairs", kept), labelled)]


def _counted(kept: KeptPairs, labelled: tuple[str, str]) -> Iterator[tuple[str, str]]:
    witness = kept.witness
    yield "correspondences", str(kept.problem.n)
    yield labelled
    yield "the most", f"{kept.lower} found, at most {kept.upper} (proved)"
    if witness is not None:
        yield "a motion: wxyz", " ".join(map(repr, witness.quaternion_wxyz.tolist()))
        yield "its translation", " ".join(map(repr, witness.translation.tolist()))


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


def truncated_labels_document(kept: TruncatedLabels) -> Document:
    """As `certreg-truncated-labels/1`."""
    optimum = kept.optimum
    return encoded(
        {
            "schema": TRUNCATED_SCHEMA,
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
