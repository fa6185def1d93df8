"""Vertices of .stl files, binary or of text: each place once, in the order in which it comes first.

A file of triangles repeats every corner; corners at the same place, bit for bit, are one vertex.
"""

from __future__ import annotations

import io
import struct
from array import array
from itertools import repeat
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from certreg.io.cloud import Cloud
from certreg.io.npy import points_of_columns
from certreg.io.streams import held_bytes, number, refused, rows_of_words
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

HEADER, FACET = 80, np.dtype([("corners", "<f4", (4, 3)), ("more", "<u2")])  # a normal, 3 corners
LINES = ("facet", "outer", "vertex", "vertex", "vertex", "endloop", "endfacet")
WIDTHS = {"facet": 5, "outer": 2, "vertex": 4, "endloop": 1, "endfacet": 1}


def parse_stl(stream: BinaryIO, file: Path) -> Cloud:
    """The vertices; a file is binary where its size is that of the facets that it declares."""
    held = held_bytes(stream, file)
    content = stream.read(held)
    declared = struct.unpack_from("<I", content, HEADER)[0] if held >= HEADER + 4 else None
    if declared is not None and held == HEADER + 4 + declared * FACET.itemsize:
        facets = np.frombuffer(content, FACET, declared, HEADER + 4)
        corners = facets["corners"][:, 1:].reshape(-1, 3)
    elif content[:5].lower() == b"solid":
        corners = _of_text(content, file)
    else:
        facets = "no number of" if declared is None else str(declared)
        raise refused(
            file,
            f"declares {facets} triangles, the file holds {held} bytes: it is "
            "truncated or corrupt; save it again",
            value=held,
            limit=declared,
        )
    if len(corners) == 0:
        raise refused(file, "no triangles: is it empty?", value=0, limit=1)
    points = points_of_columns(file, list(corners.T))
    first = np.sort(np.unique(points, axis=0, return_index=True)[1])
    note = f"{len(first)} vertices of {len(points) // 3} triangles"
    return Cloud(path=file, points=points[first], notes=(note,))


def _of_text(content: bytes, file: Path) -> NDArray[np.float64]:
    """All corners of a file of text, whose statements come in their order, one a line."""
    corners, expected = array("d"), iter(())
    ended = False
    for place, words in rows_of_words(io.BytesIO(content), file, 1):
        key = words[0].lower()
        if place.line == 1 or (ended and key == "solid"):
            ended = False
            continue
        if key == "endsolid" and next(expected, None) is None and not ended:
            ended = True
            continue
        wanted = next(expected, None)
        if wanted is None and key == "facet" and not ended:
            wanted, expected = LINES[0], iter(LINES[1:])
        if key != wanted or len(words) != WIDTHS[key]:
            what = f"'{shown(' '.join(words)[:60])}' where '{wanted or 'facet or endsolid'}' comes"
            raise place.refusal(f"{what}: mend the line", value=key, limit=wanted)
        if key == "vertex":
            corners.extend(map(number, repeat(place), words[1:]))
    if not ended:
        raise refused(
            file, "the last line is not endsolid: it is truncated; save it again", column="endsolid"
        )
    return np.array(corners).reshape(-1, 3)
