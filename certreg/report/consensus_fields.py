"""A registration with wrong pairs as a JSON document: a result, and what is proved of the pairs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.report.pairs_document import pairs_document
from certreg.report.scaled_consensus import scale_fields

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.registration.consensus import ConsensusRegistration
    from certreg.report.encoding import Document

NO_SECOND = "no other motion was found that meets three of the other pairs"


def consensus_document(
    result: ConsensusRegistration,
    certificate_path: str | None = None,
    *,
    notes: Sequence[str] = (),
) -> Document:
    """As `result_document` of the least squares over the met pairs, with `consensus`."""
    return pairs_document(
        result,
        certificate_path,
        notes=notes,
        rows=result.found.met,
        own={
            "consensus": {
                "lower": result.lower,
                "upper": result.upper,
                "labels_unique": result.labels_unique,
                "labels": list(result.labels),
                "second": None if result.second is None else {"size": result.second},
                "headline": result.headline,
                "warnings": [one.text for one in result.pair_warnings],
                **scale_fields(result),
            }
        },
        reasons={} if result.second is not None else {"consensus.second": NO_SECOND},
    )
