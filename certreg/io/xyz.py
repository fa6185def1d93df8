"""Chemical .xyz files: a count, a comment, then `symbol x y z` a line. Standard library only.

Element symbols are no labels: many atoms share one. What stands behind z is ignored. A second
frame of a trajectory is more rows than declared, and refused.
"""

from __future__ import annotations

import re
from array import array
from itertools import chain
from typing import TYPE_CHECKING

from certreg.io.streams import COUNT, Place, count, number

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SYMBOL = re.compile(r"[A-Za-z][A-Za-z0-9_+*'-]*")  # no number: x y z i behind a count is refused


def chemical(lines: Iterator[str]) -> tuple[str | None, Iterator[str]]:
    """The count that a chemical file begins with, if it does, and the lines as they were."""
    first = next(lines, "")
    declared = first.strip() if COUNT.fullmatch(first.strip()) else None
    return declared, chain([first], lines)


def chemical_points(lines: Iterator[str], file: Path, declared: str) -> tuple[array[float], int]:
    """The coordinates of a chemical file, from its first line on, and its number of columns."""
    expected, coordinates, width = count(Place(file, 1), declared), array("d"), 0
    for line, text in enumerate(lines, 1):
        words, place = text.split(), Place(file, line)
        if line <= 2 or not words:
            continue
        width = width or len(words)
        if len(coordinates) == 3 * expected:
            what = f"more than the {expected} points of line 1: give one frame only"
            raise place.refusal(what, limit=expected)
        if len(words) < 4 or len(words) != width or not SYMBOL.fullmatch(words[0]):
            what = "not 'symbol x y z' with as many columns as the rows above: mend it"
            raise place.refusal(what, value=text.strip())
        coordinates.extend(number(place, word) for word in words[1:4])
    if len(coordinates) != 3 * expected or not coordinates:
        held = len(coordinates) // 3
        what = f"declares {expected} points, the file holds {held}"
        raise Place(file, 1).refusal(
            f"{what}: give at least one, and the true count", value=held, limit=expected
        )
    return coordinates, width
