"""A registration with wrong pairs as a JSON document: a result, and what is proved of the pairs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.report.document import result_document
from certreg.report.scaled_consensus import scale_fields
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.registration import ConsensusRegistration
    from certreg.report.encoding import Document

WORST = 10  # residuals in a result: the whole list is one call away
NO_SECOND = Absent("no other motion was found that meets three of the other pairs")


def consensus_document(
    result: ConsensusRegistration,
    certificate_path: str | None = None,
    *,
    notes: Sequence[str] = (),
) -> Document:
    """As `result_document` of the least squares over the met pairs, with `consensus`.

    `n`, `digest`, `theorems`, `certificate` and `residuals` are of all pairs.
    """
    document = result_document(result.fit, certificate_path, notes=notes)
    residuals = result.residuals
    worst = residuals.argsort()[::-1][:WORST].tolist()
    rows = result.found.met
    for one in document["fit"]["worst"]:
        one["row"] = rows[one["row"]]
        one.pop("label", None)
        if (label := result.names.label(one["row"])) is not None:
            one["label"] = label
    reasons = {
        name: why
        for name, why in document["reasons"].items()
        if name not in {"consensus", "certificate"}
    }
    if certificate_path is None:
        reasons["certificate"] = document["reasons"]["certificate"]
    if result.second is None:
        reasons["consensus.second"] = NO_SECOND.reason
    return {
        **document,
        "n": result.problem.n,
        "consensus": {
            "lower": result.lower,
            "upper": result.upper,
            "labels_unique": result.labels_unique,
            "labels": list(result.labels),
            "second": None if result.second is None else {"size": result.second},
            "headline": result.headline,
            **scale_fields(result),
        },
        "residuals": [{"row": row, "distance": float(residuals[row])} for row in worst],
        "digest": result.problem.digest(),
        "theorems": list(result.verdict.theorems),
        "timings_ms": {name: 1e3 * value for name, value in result.timings.items()},
        "reasons": reasons,
    }
