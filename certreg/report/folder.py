"""The folder that `certify --out` and `demo` write: certificate, result, pose."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError
from certreg.files import write_atomically
from certreg.report.document import dumps, result_document

if TYPE_CHECKING:
    import os

    from certreg.pipeline import Registration

CERTIFICATE, RESULT, POSE = "certificate.json", "result.json", "pose.txt"


def write_folder(registration: Registration, folder: str | os.PathLike[str]) -> Path | None:
    """Write the files of a registration; the path of the certificate, None if there is none.

    Each file is written under a temporary name and renamed. Raises InvalidFileError.
    """
    place = Path(folder)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{place}: cannot be made a folder ({error.strerror}): choose another place"
        raise InvalidFileError(message) from error
    path = None
    if registration.certificate is not None:
        path = place / CERTIFICATE
        registration.certificate.save(path)
    else:  # one of an earlier run must not stand beside a result that it does not prove
        (place / CERTIFICATE).unlink(missing_ok=True)
    document = result_document(registration, None if path is None else str(path))
    write_atomically(place / RESULT, (dumps(document) + "\n").encode())
    rows = registration.pose.T_target_source.tolist()
    text = "\n".join(" ".join(map(repr, row)) for row in rows) + "\n"
    write_atomically(place / POSE, text.encode())
    return path
