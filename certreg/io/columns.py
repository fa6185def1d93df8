"""What the columns of a table are: x, y, z by any of their usual names, labels, noise, the rest.

Easting is x, northing is y, a height is z, wherever they stand: a table in the order N, E, H is no
left-handed cloud. Two columns that could both be x are refused.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.io.labels import IDENTIFIERS
from certreg.verify import shown

if TYPE_CHECKING:
    from certreg.io.streams import Place

GRID = ({"e", "east", "easting", "eastings"}, {"n", "north", "northing", "northings"})
HEIGHTS = {"h", "height", "elev", "elevation", "alt", "altitude", "u", "up"}
NOISE = ("sigma", "weight")
LABEL = "label"
UNIT = re.compile(r"(.*\S)\s*[\[(]([^\])]*)[\])]")  # Easting (m), X [mm]
RENAME = (
    "rename three of them to x, y and z, or to Easting, Northing and Elevation (and the one that "
    "names the points to label)"
)


@dataclass(frozen=True, slots=True)
class Columns:
    """Where in a row stands what; None: nowhere.

    names: of all columns. called: what names the points, a label or not. noise: those of NOISE.
    """

    names: tuple[str, ...]
    axes: tuple[int, int, int]
    label: int | None
    called: int | None
    noise: dict[str, int]
    notes: tuple[str, ...] = ()

    @property
    def ignored(self) -> tuple[str, ...]:
        """The names of the columns that are not read."""
        read = {*self.axes, self.label, *self.noise.values()}
        return tuple(name for k, name in enumerate(self.names) if k not in read)


def columns_in_order(width: int, *, labelled: bool = False) -> Columns:
    """Columns without a header: x, y, z first, or behind a label."""
    first = int(labelled)
    top = ("label", "x", "y", "z") if labelled else ("x", "y", "z")
    names = (*top, *(f"column {k}" for k in range(len(top) + 1, width + 1)))
    label = 0 if labelled else None
    return Columns(names, (first, first + 1, first + 2), label, label, {})


def named_columns(place: Place, header: list[str], *, noise: bool) -> Columns:
    """The columns that a header names, in any order and case.

    noise: whether a column `sigma` or `weight` is read. Raises InvalidFileError.
    """
    full = [name.strip().lower() for name in header]
    names, units = zip(*(_without_unit(name) for name in full), strict=True)
    axes = axes_of(names)
    repeated = [name for name in (LABEL, *(NOISE if noise else ())) if names.count(name) > 1]
    if axes is None or repeated:
        raise place.refusal(_unclear(names, full, repeated), value=full)
    if len({units[axis] for axis in axes}) > 1:
        stated = ", ".join(full[axis] for axis in axes)
        raise place.refusal(f"x, y, z are in several units ({shown(stated)}): give one", value=full)
    called = next((names.index(name) for name in (LABEL, *IDENTIFIERS) if name in names), None)
    title = [header[axis].strip() for axis in axes]
    mapped = ", ".join(f"{a}={shown(name)}" for a, name in zip("xyz", title, strict=True))
    return Columns(
        tuple(full),
        axes,
        names.index(LABEL) if LABEL in names else None,
        called,
        {name: names.index(name) for name in NOISE if noise and name in names},
        () if [names[axis] for axis in axes] == ["x", "y", "z"] else (mapped,),
    )


def axes_of(names: tuple[str, ...] | list[str]) -> tuple[int, int, int] | None:
    """The columns x, y, z; None where one is missing or two could be meant.

    Columns of just these names go before all others. The two of the plane are of one kind.

    >>> axes_of(["point", "n", "e", "h"])
    (2, 1, 3)
    """
    plain = [_places(names, {axis}) for axis in "xyz"]
    if [len(places) for places in plain] == [1, 1, 1]:
        return plain[0][0], plain[1][0], plain[2][0]
    grid = [_places(names, kinds) for kinds in GRID]
    heights = _places(names, HEIGHTS | {"z"})
    planes = [plane for plane in (plain[:2], grid) if any(plane)]
    if len(planes) != 1 or [len(places) for places in (*planes[0], heights)] != [1, 1, 1]:
        return None
    (x,), (y,) = planes[0]
    return x, y, heights[0]


def _places(names: tuple[str, ...] | list[str], kinds: set[str]) -> list[int]:
    return [k for k, name in enumerate(names) if name in kinds]


def _without_unit(name: str) -> tuple[str, str]:
    """A name as tables spell it, `point_id` for `Point ID`, and the unit in brackets behind it."""
    match = UNIT.fullmatch(name)
    bare, unit = (match[1], match[2].strip()) if match else (name, "")
    return re.sub(r"[ .]+", "_", bare.rstrip(".")), unit


def _unclear(names: tuple[str, ...], full: list[str], repeated: list[str]) -> str:
    """Why a header does not say what x, y and z are, and what to do."""
    if len(full) < 3:
        return "fewer than three columns: give x, y, z, separated by commas or semicolons"
    if repeated:
        return f"two columns are named {repeated[0]}: keep one"
    stated = shown(", ".join(full))
    known = {"x": {"x"} | GRID[0], "y": {"y"} | GRID[1], "z": {"z"} | HEIGHTS}
    missing = [axis for axis, kinds in known.items() if not _places(names, kinds)]
    if missing:
        return f"the header ({stated}) names no column {', '.join(missing)}: {RENAME}"
    return f"the header ({stated}) does not say which columns are x, y, z: {RENAME}"
