"""What is compared of a file or a printed text: all but times and the places of this machine."""

from __future__ import annotations

import gzip
import hashlib
import io
import re
import zipfile
from base64 import b64decode
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

TIMES = (  # what is printed of them, and what is kept
    (r'"timings_ms": ?\{[^}]*\}', '"timings_ms": {}'),
    (r'"time_ms": ?[-+.e\d]+', '"time_ms": 0'),
    (r"(?m)^(  road .*index) +time +guarantee$", r"\1  time  guarantee"),
    (r" +\d+\.\d\d ms\b *", "  0 ms  "),
    (r"(?m)^(\S+ +[A-Z]+) +\d+\.\d\d s  ", r"\1  0 s  "),
    (r"(refuted.*), in \d+\.\d s", r"\1, in 0 s"),
    (r"[\d,]+ in [\d.]+ s: .* at work", "0 in 0 s"),
    # Of a scale that was not asked for, what every document says: it stands in no record.
    (r'\n *"scale": null,\n *"scale_interval": null,', ""),
    (r'"scale": null, "scale_interval": null, ', ""),
    (r'\s*"(pose\.)?scale(_interval)?": "the scale was not asked for",', ""),
    (r',\s*"(pose\.)?scale(_interval)?": "the scale was not asked for"', ""),
)
PACKED = r'(?<=<script id="certificate" type="text/plain">)[\w+/=]+'  # base64 of gzip
LONGEST = 2000  # characters of a line that is kept: a report carries its script and its motion


def stable_text(text: str, places: Mapping[str, str]) -> str:
    """The text without times; each of the places, a path, under the name given for it."""
    for path in sorted(places, key=len, reverse=True):
        text = text.replace(path, places[path])
    for pattern, kept in TIMES:
        text = re.sub(pattern, kept, text)
    return text


def stable_file(name: str, content: bytes, places: Mapping[str, str]) -> str:
    """What stands for a file in the record: its text, its arrays by their digests, or its own."""
    if name.endswith(".npz"):
        return arrays(content)
    try:
        text = stable_text(content.decode(), places)
    except UnicodeDecodeError:
        return f"{len(content)} bytes {digest(content)}\n"
    return readable(text) if name.endswith(".html") else text


def stable_name(name: str) -> str:
    """The name of a file in the record: a shard of a campaign without the digest in its own."""
    return re.sub(r"-[0-9a-f]{32}(?=\.\w+$)", "-DIGEST", name)


def arrays(content: bytes) -> str:
    """Name, type, shape and digest of each array of an .npz file, then that of the whole file."""
    lines = list[str]()
    try:
        with np.load(io.BytesIO(content)) as held:
            for name in held.files:
                array = held[name]
                lines.append(f"{name} {array.dtype} {array.shape} {digest(array.tobytes())}")
    except (ValueError, OSError, zipfile.BadZipFile) as error:
        lines.append(f"not read: {type(error).__name__}")
    return "\n".join([*lines, f"whole: {digest(content)}\n"])


def readable(page: str) -> str:
    """A page by elements, one a line, the certificate in it unpacked; long lines by a digest."""
    page = re.sub(PACKED, lambda packed: gzip.decompress(b64decode(packed[0])).decode(), page)
    lines = re.sub(r">(?=<)", ">\n", page).split("\n")
    return "\n".join(
        line
        if len(line) <= LONGEST
        else f"{line[:200]} ... {len(line)} characters {digest(line.encode())}"
        for line in lines
    )


def digest(content: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(content).hexdigest()
