"""Results that were given for certificates: what they are, and where the certificates are.

The checker refuses them by itself, whatever is said here.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.verify import shown

if TYPE_CHECKING:
    import os

# As results are written: on one line in a list's, else not.
RESULT = re.compile(rb'\s*\{\s*"schema"\s*:\s*"(certreg-result/\d+)"')
HEAD = 256  # bytes of a file that are looked at
FOLDER = "certificates"  # beside the results of a list


def why_no_certificate(reason: str, content: bytes) -> str:
    """The reason of a refusal, in words that say so where the content is a result."""
    found = RESULT.match(content[:HEAD])
    if found is None:
        return reason
    return (
        f"this is a result ({found[1].decode()}), not a certificate: give the certificate.json "
        "that certify --out wrote beside it"
    )


def why_no_certificates(path: str | os.PathLike[str]) -> str | None:
    """Why no line of a file is a certificate, where its first is a result; else None."""
    try:
        if not Path(path).is_file():  # of a pipe nothing is taken away, for one nobody waits
            return None
        with Path(path).open("rb") as file:
            found = RESULT.match(file.read(HEAD))
    except (OSError, ValueError):  # which the checker tells
        return None
    if found is None:
        return None
    beside = Path(path).parent / FOLDER
    place = shown(beside) if beside.is_dir() else f"the folder {FOLDER} that batch wrote"
    return (
        f"these are results ({found[1].decode()}), not certificates: give one of the files in "
        f"{place}, one for each pair"
    )
