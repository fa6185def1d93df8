"""The folder that `certify --out` writes of a registration with wrong pairs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError
from certreg.io.atomic import remedy_of, write_together
from certreg.io.labels import csv_field
from certreg.io.row_values import PAIR_COLUMNS
from certreg.registration.truncated import TruncatedRegistration
from certreg.report.consensus_fields import consensus_document
from certreg.report.document import dumps, pose_document
from certreg.report.file_names import (
    CERTIFICATE,
    FIT,
    POSE,
    REPORT,
    RESULT,
    SURE_POSE,
    TRAJECTORY,
)
from certreg.report.pages import html_page, report_on
from certreg.report.truncated_fields import truncated_document

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from certreg.registration.consensus import ConsensusRegistration
    from certreg.report.encoding import Document


def wrong_pairs_document(
    result: ConsensusRegistration | TruncatedRegistration,
    certificate_path: str | None = None,
    *,
    notes: Sequence[str] = (),
) -> Document:
    """The JSON of either."""
    if isinstance(result, TruncatedRegistration):
        return truncated_document(result, certificate_path, notes=notes)
    return consensus_document(result, certificate_path, notes=notes)


def write_wrong_pairs(
    result: ConsensusRegistration | TruncatedRegistration,
    folder: str | os.PathLike[str],
    *,
    notes: Sequence[str] = (),
) -> Path | None:
    """Write the files, all or none; the path of the certificate. Raises InvalidFileError."""
    place = Path(folder)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{place}: cannot be made a folder ({error.strerror}): {remedy_of(error)}"
        raise InvalidFileError(message, path=place) from error
    path = place / CERTIFICATE
    proof = result.certificate
    document = wrong_pairs_document(result, None if proof is None else str(path), notes=notes)
    rows = result.pose.T_target_source.tolist()
    contents = {
        **({} if proof is None else {CERTIFICATE: proof.to_json()}),
        RESULT: (dumps(document) + "\n").encode(),
        POSE: ("\n".join(" ".join(map(repr, row)) for row in rows) + "\n").encode(),
        SURE_POSE: (dumps(pose_document(result.fit)) + "\n").encode(),
        FIT: fit_table(result).encode(),
    }
    if proof is not None:
        contents[REPORT] = html_page(report_on(result))
    write_together(
        {place / name: content for name, content in contents.items()},
        obsolete=[
            place / name for name in (CERTIFICATE, REPORT, TRAJECTORY) if name not in contents
        ],
    )
    return None if proof is None else path


def fit_table(result: ConsensusRegistration | TruncatedRegistration) -> str:
    """A line for each pair: its residual at the pose, its bound, and what is proved of it."""
    names = result.names
    columns = (result.residuals.tolist(), result.problem.bounds.tolist(), result.labels)
    lines = (
        f"{row},{csv_field(names.label(row) or '')},{residual!r},{bound!r},{word}\n"
        for row, (residual, bound, word) in enumerate(zip(*columns, strict=True))
    )
    return f"{','.join(PAIR_COLUMNS)}\n" + "".join(lines)
