"""A JSON document of pairs that may be wrong: that of the least squares over some, and of all."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.report.document import WORST, result_document
from certreg.report.fields import warning_fields
from certreg.report.parts import costed, counted
from certreg.report.scaled_consensus import scale_fields

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.registration.labelled import ConsensusRegistration, TruncatedRegistration
    from certreg.report.encoding import Document
    from certreg.report.parts import Labelled

NO_SECOND = "no other motion was found that meets three of the other pairs"
NO_COUNT = (
    "the least truncated cost was sought, not the most pairs: what is proved is in `truncated`"
)


def pairs_document(
    result: Labelled, certificate_path: str | None = None, *, notes: Sequence[str] = ()
) -> Document:
    """As `result_document` of the least squares over the pairs within, and what is proved of all.

    `n`, `digest`, `theorems`, `certificate` and `residuals` are of all pairs, `fit.warnings` of
    these and of the least squares.
    """
    document = result_document(result.fit, certificate_path, notes=[*notes, *result.notes])
    most, least = counted(result), costed(result)
    own: Document = {}
    reasons, rows = dict[str, str](), result.inliers.tolist()
    if most is not None:
        own = {"consensus": _consensus(most)}
        reasons = {} if most.second is not None else {"consensus.second": NO_SECOND}
    if least is not None:
        own, rows, reasons = (
            {"truncated": _truncated(least)},
            least.inliers.tolist(),
            _missing(least),
        )
    residuals = result.residuals
    worst = residuals.argsort()[::-1][:WORST].tolist()
    for one in document["fit"]["worst"]:
        one["row"] = rows[one["row"]]
    document["fit"]["warnings"] = warning_fields(result.warnings)
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


def _consensus(result: ConsensusRegistration) -> Document:
    return {
        "lower": result.lower,
        "upper": result.upper,
        "labels_unique": result.labels_unique,
        "labels": list(result.labels),
        "second": None if result.second is None else {"size": result.second},
        "headline": result.headline,
        "warnings": [one.text for one in result.pair_warnings],
        **scale_fields(result),
    }


def _truncated(result: TruncatedRegistration) -> Document:
    return {
        "cost": result.cost,
        "gap": result.gap,
        "labels": list(result.labels),
        "labels_unique": result.labels_unique,
        "unique": result.unique,
        "headline": result.headline,
    }


def _missing(result: TruncatedRegistration) -> dict[str, str]:
    """Reasons of nulls beside those of the least squares."""
    names = () if result.certificate is not None else ("certificate", "truncated.gap")
    return {"consensus": NO_COUNT, **dict.fromkeys(names, result.verdict.words)}
