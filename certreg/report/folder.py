"""The folder that `certify --out` and `demo` write: certificate, result, pose, motion, report."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

from certreg.dynamics.trajectory import Record
from certreg.errors import InvalidFileError
from certreg.io.atomic import remedy_of, write_together
from certreg.io.labels import csv_field
from certreg.io.row_values import PAIR_COLUMNS
from certreg.report.document import dumps, pose_document
from certreg.report.file_names import (
    CERTIFICATE,
    FILES,
    FIT,
    POSE,
    REPORT,
    RESULT,
    SURE_POSE,
    TRAJECTORY,
)
from certreg.report.pages import html_page, report_on
from certreg.report.pair_fields import document_of
from certreg.report.parts import labelled
from certreg.report.residual_table import residual_table
from certreg.verify import INLINE_MAX

if TYPE_CHECKING:
    from certreg.registration.labelled import LabelledRegistration
    from certreg.registration.result import Registration


def write_folder(
    result: Registration | LabelledRegistration,
    folder: str | os.PathLike[str],
    *,
    notes: Sequence[str] = (),
) -> Path | None:
    """Write the files of a result; the path of the certificate, None if there is none.

    notes: on how the clouds were read.

    All are written under temporary names first. So a failure leaves the files of an earlier run as
    they were, or none of them: files of two problems never stand together. Raises InvalidFileError.
    """
    place = Path(folder)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidFileError(
            f"{place}: cannot be made a folder ({error.strerror}): {remedy_of(error)}", path=place
        ) from error
    path = place / CERTIFICATE if result.certificate is not None else None
    contents = _contents(result, None if path is None else str(path), notes)
    try:
        write_together(
            {place / name: contents[name] for name in FILES if name in contents},
            obsolete=[place / name for name in FILES if name not in contents],
        )
    except InvalidFileError as error:
        raise InvalidFileError(
            f"{place}: the files of this registration could not be written there: {error}",
            path=error.path or place,
        ) from error
    return path


def _contents(
    result: Registration | LabelledRegistration, path: str | None, notes: Sequence[str]
) -> dict[str, bytes | Iterator[bytes]]:
    """What each file holds; path: of the certificate."""
    pairs = labelled(result)
    contents: dict[str, bytes | Iterator[bytes]] = {}
    rows = result.pose.T_target_source.tolist()
    if pairs is not None:
        fit = pairs.fit
        contents[FIT] = _labels_table(pairs).encode()
    else:
        fit = cast("Registration", result)
        if fit.trajectory is not None:
            contents[TRAJECTORY] = Record.of(fit.problem, fit.trajectory).to_bytes()
        if fit.problem.n <= INLINE_MAX:  # as many as a certificate holds itself
            contents[FIT] = residual_table(fit)
    if result.certificate is not None:
        contents[CERTIFICATE] = result.certificate.to_json()
        contents[REPORT] = html_page(report_on(result))
    return {
        **contents,
        RESULT: (dumps(document_of(result, path, notes=notes)) + "\n").encode(),
        SURE_POSE: (dumps(pose_document(fit)) + "\n").encode(),
        POSE: ("\n".join(" ".join(map(repr, row)) for row in rows) + "\n").encode(),
    }


def _labels_table(result: LabelledRegistration) -> str:
    """A line for each pair: its residual at the pose, its bound, and what is proved of it."""
    names = result.names
    columns = (result.residuals.tolist(), result.problem.bounds.tolist(), result.labels)
    lines = (
        f"{row},{csv_field(names.label(row) or '')},{residual!r},{bound!r},{word}\n"
        for row, (residual, bound, word) in enumerate(zip(*columns, strict=True))
    )
    return f"{','.join(PAIR_COLUMNS)}\n" + "".join(lines)
