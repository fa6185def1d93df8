"""A JSON document of pairs that may be wrong: that of the least squares over some, and of all."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.report.document import result_document
from certreg.report.fields import warning_fields

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from certreg.registration.consensus import ConsensusRegistration
    from certreg.registration.truncated import TruncatedRegistration
    from certreg.report.encoding import Document

WORST = 10  # residuals in a result: the whole list is one call away


def pairs_document(
    result: ConsensusRegistration | TruncatedRegistration,
    certificate_path: str | None,
    *,
    notes: Sequence[str],
    rows: Sequence[int],
    own: Document,
    reasons: Mapping[str, str],
) -> Document:
    """As `result_document` of the least squares over some rows, with fields of its own.

    `n`, `digest`, `theorems`, `certificate` and `residuals` are of all pairs, `fit.warnings` of
    these and of the least squares. reasons: of nulls beside those of the least squares.
    """
    document = result_document(result.fit, certificate_path, notes=[*notes, *result.notes])
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
