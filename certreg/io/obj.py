"""Vertices of .obj files, in their order. Standard library only.

Colours behind x, y, z are left out; what is declared around the vertices is known by its keyword or
refused. Faces and lines must speak of vertices that are there: so a file that was cut shows.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterator
from typing import TYPE_CHECKING

from certreg.io.columns import Points
from certreg.io.streams import Place, number
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

CORNER = re.compile(r"(-?[1-9][0-9]{0,17})(/(-?[1-9][0-9]{0,17})?){0,2}")  # v, v/vt, v//vn, v/vt/vn
CORNERED = {"f", "l", "p"}
PASSED_OVER = {"vt", "vn", "g", "o", "s", "usemtl", "mtllib"}


def parse_obj(lines: Iterator[str], file: Path) -> Points:
    """The vertices, and what is in the file beside them."""
    coordinates, others, last = array("d"), dict[str, None](), (0, Place(file, 1))
    for place, words in _statements(lines, file):
        key = words[0]
        if key == "v":
            others |= _vertex(place, words[1:], coordinates)
            continue
        if key in CORNERED:
            last = max(last, (_largest(place, words[1:], len(coordinates) // 3), place))
        elif key not in PASSED_OVER:
            raise place.refusal(
                f"'{shown(key)}' is not expected in a mesh of points and faces: mend the line",
                value=key,
            )
        others[key] = None
    n = len(coordinates) // 3
    if n == 0:
        raise Place(file, 1).refusal("no vertices: give lines 'v x y z'", value=0, limit=1)
    if last[0] > n:
        raise last[1].refusal(
            f"names vertex {last[0]}, the file holds {n}: it is truncated; save it again",
            value=last[0],
            limit=n,
        )
    return Points(coordinates, None, tuple(others))


def _statements(lines: Iterator[str], file: Path) -> Iterator[tuple[Place, list[str]]]:
    """Place and words of each line that says something."""
    for k, text in enumerate(lines, 1):
        line = text.partition("#")[0].strip()
        if line.endswith("\\"):
            raise Place(file, k).refusal(
                "the line goes on behind '\\': write each statement in one line"
            )
        if line:
            yield Place(file, k), line.split()


def _vertex(place: Place, words: list[str], coordinates: array[float]) -> dict[str, None]:
    """Add a vertex; what stands behind its coordinates. A fourth number is a weight, which is 1."""
    if len(words) not in {3, 4, 6, 7}:
        raise place.refusal(
            f"{len(words)} numbers of a vertex: give 'v x y z'", value=len(words), limit=3
        )
    values = [number(place, word) for word in words]
    if len(values) in {4, 7} and values[3] != 1:
        raise place.refusal(
            f"a vertex of weight {words[3]}: divide x, y, z by it, and leave it out",
            value=values[3],
            limit=1,
        )
    coordinates.extend(values[:3])
    return {} if len(values) == 3 else {"numbers behind x, y, z": None}


def _largest(place: Place, corners: list[str], held: int) -> int:
    """The largest number of a vertex that a face or a line names; -1 is the last one so far."""
    largest = 0
    for corner in corners:
        match = CORNER.fullmatch(corner)
        if match is None or int(match[1]) < -held:
            raise place.refusal(
                f"'{shown(corner)}' names no vertex: mend the line, or save the file again",
                value=corner,
            )
        largest = max(largest, int(match[1]))
    return largest
