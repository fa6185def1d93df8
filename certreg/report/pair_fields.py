"""A JSON document of pairs that may be wrong: that of the least squares over some, and of all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

from certreg.report.document import WORST, result_document
from certreg.report.fields import warning_fields
from certreg.report.parts import labelled
from certreg.results import Absent

if TYPE_CHECKING:
    from certreg.registration.labelled import (
        ConsensusRegistration,
        LabelledRegistration,
        TruncatedRegistration,
    )
    from certreg.registration.result import Registration
    from certreg.report.encoding import Document

NO_SECOND = "no other motion was found that meets three of the other pairs"


def document_of(
    result: Registration | LabelledRegistration,
    certificate_path: str | None = None,
    *,
    notes: Sequence[str] = (),
) -> Document:
    """Of least squares, or of pairs that may be wrong; notes: on how the clouds were read."""
    pairs = labelled(result)
    stated = result_document if pairs is None else pairs_document
    return stated(cast("Any", result), certificate_path, notes=notes)


def pairs_document(
    result: LabelledRegistration, certificate_path: str | None = None, *, notes: Sequence[str] = ()
) -> Document:
    """As `result_document` of the least squares over the pairs within, and what is proved of all.

    `n`, `digest`, `theorems`, `certificate` and `residuals` are of all pairs, `fit.warnings` of
    these and of the least squares.
    """
    document = result_document(result.fit, certificate_path, notes=[*notes, *result.notes])
    residuals, rows = result.residuals, result.inliers.tolist()
    worst = residuals.argsort()[::-1][:WORST].tolist()
    for one in document["fit"]["worst"]:
        one["row"] = rows[one["row"]]
    document["fit"]["warnings"] = warning_fields(result.warnings)
    own, reasons = _sought(result)
    others = {name: why for name, why in document["reasons"].items() if name not in own}
    return {
        **document,
        "n": result.problem.n,
        **own,
        "residuals": [{"row": row, "distance": float(residuals[row])} for row in worst],
        "digest": result.problem.digest(),
        "theorems": list(result.verdict.theorems),
        "timings_ms": {name: 1e3 * value for name, value in result.timings.items()},
        "reasons": {**others, **reasons},
    }


def _sought(result: LabelledRegistration) -> tuple[Document, dict[str, str]]:
    """What was sought, the most pairs or the least cost, and reasons of nulls in it."""
    own: Document = {}
    reasons = dict[str, str]()
    if isinstance(result.most, Absent):
        reasons["consensus"] = result.most.reason
    else:
        own["consensus"] = _most(result.most)
        if result.most.second is None:
            reasons["consensus.second"] = NO_SECOND
    if not isinstance(result.least, Absent):
        own["truncated"] = _least(result.least)
        if result.certificate is None:
            reasons["certificate"] = reasons["truncated.gap"] = result.verdict.words
    return own, reasons


def _most(result: ConsensusRegistration) -> Document:
    return {
        "lower": result.lower,
        "upper": result.upper,
        "labels_unique": result.labels_unique,
        "labels": list(result.labels),
        "second": None if result.second is None else {"size": result.second},
        "headline": result.headline,
        "warnings": [one.text for one in result.pair_warnings],
        **_scales(result),
    }


def _scales(result: ConsensusRegistration) -> Document:
    """Ranges of scales, [low, high]; high is null where there is no end; none of a fixed scale."""
    interval, some = result.scale_interval, result.undecided_scales
    ranges = [[low, None if math.isinf(high) else high] for low, high in some]
    return {"scale_interval": list(interval), "undecided_scales": ranges} if interval else {}


def _least(result: TruncatedRegistration) -> Document:
    return {
        "cost": result.cost,
        "gap": result.gap,
        "labels": list(result.labels),
        "labels_unique": result.labels_unique,
        "unique": result.unique,
        "headline": result.headline,
    }
