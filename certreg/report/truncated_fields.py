"""A registration by truncated squares as a JSON document: a result, and what is proved of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.report.document import result_document

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.registration import TruncatedRegistration
    from certreg.report.encoding import Document

WORST = 10  # residuals in a result: the whole list is one call away
NO_COUNT = (
    "the least truncated cost was sought, not the most pairs: what is proved is in `truncated`"
)


def truncated_document(
    result: TruncatedRegistration,
    certificate_path: str | None = None,
    *,
    notes: Sequence[str] = (),
) -> Document:
    """As `result_document` of the least squares over the pairs within, with `truncated`.

    `n`, `digest`, `theorems`, `certificate` and `residuals` are of all pairs.
    """
    document = result_document(result.fit, certificate_path, notes=notes)
    residuals = result.residuals
    worst = residuals.argsort()[::-1][:WORST].tolist()
    proof = result.certificate
    reasons = {**document["reasons"], "consensus": NO_COUNT}
    if certificate_path is not None:
        reasons.pop("certificate", None)
    if proof is None:
        reasons["truncated.gap"] = result.verdict.words
    rows = result.rows.tolist()
    for one in document["fit"]["worst"]:
        one["row"] = rows[one["row"]]
    return {
        **document,
        "n": result.problem.n,
        "truncated": {
            "cost": result.cost,
            "gap": result.gap,
            "labels": list(result.labels),
            "labels_unique": result.labels_unique,
            "unique": result.unique,
            "headline": result.headline,
        },
        "residuals": [{"row": row, "distance": float(residuals[row])} for row in worst],
        "certificate": certificate_path,
        "digest": result.problem.digest(),
        "theorems": list(result.verdict.theorems),
        "timings_ms": {name: 1e3 * value for name, value in result.timings.items()},
        "reasons": reasons,
    }
