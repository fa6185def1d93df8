"""The folder that `certify --out` and `demo` write: certificate, result, pose, motion, report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from certreg.dynamics.trajectory import Record
from certreg.errors import InvalidFileError
from certreg.io.atomic import remedy_of, write_together
from certreg.report.document import dumps, pose_document, result_document
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
from certreg.report.residual_table import residual_table
from certreg.verify import INLINE_MAX

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator, Sequence

    from certreg.registration.result import Registration


def write_folder(
    registration: Registration, folder: str | os.PathLike[str], *, notes: Sequence[str] = ()
) -> Path | None:
    """Write the files of a registration; the path of the certificate, None if there is none.

    notes: on how the clouds were read.

    All are written under temporary names first. So a failure leaves the files of an earlier run as
    they were, or none of them: files of two problems never stand together. Raises InvalidFileError.
    """
    place = Path(folder)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{place}: cannot be made a folder ({error.strerror}): {remedy_of(error)}"
        raise InvalidFileError(message, path=place) from error
    path = place / CERTIFICATE if registration.certificate is not None else None
    document = result_document(registration, None if path is None else str(path), notes=notes)
    rows = registration.pose.T_target_source.tolist()
    contents: dict[str, bytes | Iterator[bytes]] = {
        RESULT: (dumps(document) + "\n").encode(),
        SURE_POSE: (dumps(pose_document(registration)) + "\n").encode(),
        POSE: ("\n".join(" ".join(map(repr, row)) for row in rows) + "\n").encode(),
    }
    trajectory = registration.trajectory
    if trajectory is not None:
        contents[TRAJECTORY] = Record.of(registration.problem, trajectory).to_bytes()
    if registration.problem.n <= INLINE_MAX:  # as many as a certificate holds itself
        contents[FIT] = residual_table(registration)
    if registration.certificate is not None:
        contents[CERTIFICATE] = registration.certificate.to_json()
        contents[REPORT] = html_page(report_on(registration))
    try:
        write_together(
            {place / name: contents[name] for name in FILES if name in contents},
            obsolete=[place / name for name in FILES if name not in contents],
        )
    except InvalidFileError as error:
        message = f"{place}: the files of this registration could not be written there: {error}"
        raise InvalidFileError(message, path=error.path or place) from error
    return path
