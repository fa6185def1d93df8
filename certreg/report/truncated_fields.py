"""A registration by truncated squares as a JSON document: a result, and what is proved of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.report.pairs_document import pairs_document

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.registration.truncated import TruncatedRegistration
    from certreg.report.encoding import Document

NO_COUNT = (
    "the least truncated cost was sought, not the most pairs: what is proved is in `truncated`"
)


def truncated_document(
    result: TruncatedRegistration,
    certificate_path: str | None = None,
    *,
    notes: Sequence[str] = (),
) -> Document:
    """As `result_document` of the least squares over the pairs within, with `truncated`."""
    reasons = {"consensus": NO_COUNT}
    if result.certificate is None:
        reasons |= dict.fromkeys(("certificate", "truncated.gap"), result.verdict.words)
    return pairs_document(
        result,
        certificate_path,
        notes=notes,
        rows=result.rows.tolist(),
        own={
            "truncated": {
                "cost": result.cost,
                "gap": result.gap,
                "labels": list(result.labels),
                "labels_unique": result.labels_unique,
                "unique": result.unique,
                "headline": result.headline,
            }
        },
        reasons=reasons,
    )
