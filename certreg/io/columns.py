"""What the columns of a table are: x, y, z by any of their usual names, labels, noise, the rest.

Easting is x, northing is y, a height is z, wherever they stand: a table in the order N, E, H is no
left-handed cloud. Two columns that could both be x are refused.

Tables separated by semicolons are as spreadsheets write them where the comma is decimal. `1,234` is
one and a quarter in one country and a thousand in another. So commas in numbers are read as decimal
only where some number of the file shows that they are: `1,5` groups no thousands.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, NamedTuple, Protocol, TypeVar

from certreg.io.labels import IDENTIFIERS
from certreg.io.streams import NUMBER, Place, number, refused
from certreg.verify import shown

if TYPE_CHECKING:
    from array import array
    from pathlib import Path


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
class Points:
    """A cloud from a text file: 3n coordinates row by row, the rows' labels, columns left out.

    identifiers: the labels, or else what a column left out calls the points, if there is one.
    sigma, weights: of the columns `sigma` and `weight`. notes: what the user should know.
    """

    coordinates: array[float]
    labels: tuple[str, ...] | None
    ignored: tuple[str, ...]
    identifiers: tuple[str, ...] | None = None
    sigma: array[float] | None = None
    weights: array[float] | None = None
    notes: tuple[str, ...] = ()


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


Numbers = TypeVar("Numbers")
Read_co = TypeVar("Read_co", covariant=True)
REMEDY = "keep one of them, or give --sigma, --weights or --ignore-weights"


class Noisy(Protocol[Read_co]):
    """A cloud that was read; numbers of its rows, None where it has none."""

    @property
    def sigma(self) -> Read_co | None:
        """Standard deviations."""
        ...

    @property
    def weights(self) -> Read_co | None:
        """Weights."""
        ...


class ColumnNoise(NamedTuple, Generic[Numbers]):
    """Standard deviations, weights, or neither, one for each pair; and what to tell the user."""

    sigma: Numbers | None
    weights: Numbers | None
    notes: tuple[str, ...]


def noise_of_columns(
    source: Noisy[Numbers], target: Noisy[Numbers], files: tuple[Path, Path]
) -> ColumnNoise[Numbers]:
    """The one column of both clouds, already paired, that says how sure a pair is.

    Two of them are refused: which one holds, or whether both add up, no file says. Raises
    InvalidFileError.
    """
    sides = zip((source, target), files, strict=True)
    found = [
        (name, numbers, file)
        for cloud, file in sides
        for name, numbers in (("sigma", cloud.sigma), ("weight", cloud.weights))
        if numbers is not None
    ]
    if not found:
        return ColumnNoise(None, None, ())
    if len(found) > 1:
        stated = " and ".join(f"{name} of {shown(file)}" for name, _, file in found)
        raise refused(
            found[1][2], f"columns {stated}: which one holds? {REMEDY}", column=found[1][0]
        )
    ((name, numbers, file),) = found
    note = f"{shown(file)}: column {name} is used as "
    if name == "sigma":
        note += "the standard deviation of each pair (--ignore-weights: leave it)"
        return ColumnNoise(numbers, None, (note,))
    note += "the weight of each pair (--ignore-weights: leave it)"
    return ColumnNoise(None, numbers, (note,))


GROUPED = re.compile(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}")  # 1,234: perhaps a thousand


def separated_by_semicolons(first: str) -> bool:
    """Whether the first row of a table is one of semicolons, not of commas."""
    if len(_fields(first, ";")) < 3:
        return False
    fields = _fields(first, ",")  # `1,5;2,5;3,5` has two numbers between its commas, never three
    numbers = sum(NUMBER.fullmatch(field) is not None for field in fields)
    return numbers < 3 and axes_of(fields) is None


def _fields(line: str, separator: str) -> list[str]:
    try:
        row = next(csv.reader([line], delimiter=separator), list[str]())
    except csv.Error:
        return []
    return [field.strip().lower() for field in row]


class DecimalCommas:
    """Numbers whose commas, if there are any, are found to be decimal or are refused."""

    def __init__(self) -> None:
        self._comma: tuple[Place, str] | None = None  # the first number with one
        self._point: tuple[Place, str] | None = None
        self._decimal = False

    def number(self, place: Place, text: str) -> float:
        """The double nearest to a decimal number with a point or a comma."""
        text = text.strip(" \t")
        if "," not in text:
            if "." in text:
                self._point = self._point or (place, text)
            return number(place, text)
        self._comma = self._comma or (place, text)
        if text.count(",") > 1 or not NUMBER.fullmatch(text.replace(",", ".")):
            raise place.refusal(
                f"'{shown(text)}' is not a number: write plain decimal numbers, without groups",
                value=text,
            )
        self._decimal = self._decimal or not GROUPED.fullmatch(text)
        return number(place, text.replace(",", "."))

    def require_decimal(self) -> None:
        """That the commas met were decimal beyond doubt. Raises InvalidFileError."""
        if self._comma is None:
            return
        place, text = self._comma
        if self._point is not None:
            there, other = self._point
            words = f"'{shown(text)}' here and '{shown(other)}' in line {there.line}: is the comma "
            raise place.refusal(words + "decimal? Write decimal points", value=text)
        if not self._decimal:
            point, thousand = text.replace(",", "."), text.replace(",", "")
            raise place.refusal(
                f"'{shown(text)}': is it {point} or {thousand}? Write decimal points", value=text
            )

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know."""
        return () if self._comma is None else ("decimal commas",)


def notes_on(path: Path, notes: tuple[str, ...], ignored: tuple[str, ...]) -> list[str]:
    """What the user should know of how a file was read, and of columns that were not."""
    told = [f"{shown(path)}: {', '.join(notes)}"] if notes else []
    if ignored:
        hint = " (only `label` pairs rows)" if path.suffix.lower() == ".csv" else ""
        told.append(f"{shown(path)}: not used: {shown(', '.join(ignored))}{hint}")
    return told
