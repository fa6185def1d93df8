"""Normals, directions, matrices of springs from the columns of a file, a row for each point.

The columns have names: nx, ny, nz; dx, dy, dz; cxx to czz, or xx to zz; l11 to l33; lx, ly, lz. A
row whose cells are all empty, or NaN, has no spring of this kind.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from math import nan
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from certreg.io.columns import LABEL
from certreg.io.labels import text_of_field
from certreg.io.npy import parse_npy
from certreg.io.pcd import parse_pcd
from certreg.io.ply import parse_ply
from certreg.io.streams import number, reading, refused
from certreg.io.text import titled_rows
from certreg.problem.arrays import as_doubles
from certreg.problem.spring_rows import SPRING_COLUMNS
from certreg.results import Brief
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.io.streams import Place

TABLES = (".csv", ".txt", ".xyz", ".asc", ".pts")
CLOUDS = {".ply": parse_ply, ".pcd": parse_pcd}
PCL = {f"normal_{axis}": f"n{axis}" for axis in "xyz"}  # as .pcd files call them
ABSENT = ("", "nan")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringTable(Brief):
    """Numbers of one kind of springs, (n, 3), (n, 6) or (n, 3, 3), NaN in rows that have none.

    labels: of the rows, where the file has them. columns: the names that were read.
    """

    path: Path
    rows: NDArray[np.float64]
    labels: tuple[str, ...] | None = None
    columns: tuple[str, ...] = ()


def read_spring_table(path: Path, kind: str) -> SpringTable:
    """One kind of springs from a table with a header, an array in .npy, a cloud in .ply or .pcd.

    kind: as `RegistrationProblem` calls it. Raises InvalidFileError: file, line, remedy.
    """
    suffix = path.suffix.lower()
    if suffix not in {".npy", *CLOUDS, *TABLES}:
        known = ", ".join(TABLES)
        raise refused(
            path, f"{kind} are read from {known} with a header, .npy, .ply or .pcd", value=suffix
        )
    with reading(path) as stream:
        if suffix == ".npy":
            return _of_array(stream, path)
        return (_of_text if suffix in TABLES else _of_cloud)(stream, path, kind)


def columns_of(titles: Iterable[str], kind: str) -> tuple[str, ...] | None:
    """The names of the columns of one kind, where all of them are there, once; else None."""
    plain = [title.strip().lower() for title in titles]
    for names in SPRING_COLUMNS[kind]:
        if all(plain.count(name) == 1 for name in names):
            return names
    return None


def _of_array(stream: BinaryIO, file: Path) -> SpringTable:
    rows = parse_npy(stream, file)
    if rows.ndim not in {2, 3}:
        raise refused(
            file, f"holds an array of shape {rows.shape}: save one row per point", value=rows.shape
        )
    doubles, kept = as_doubles(rows)
    if not kept.all():
        row = int(np.argwhere(~kept)[0][0])
        raise refused(
            file,
            f"row {row} (counting from 0) is held by no double: round it",
            row=row,
            value=rows[row].tolist(),
        )
    return SpringTable(path=file, rows=doubles)


def _of_cloud(stream: BinaryIO, file: Path, kind: str) -> SpringTable:
    """Of properties of the vertices of a .ply file, or of fields of a .pcd file."""
    wanted = frozenset(name for names in SPRING_COLUMNS[kind] for name in names)
    read = CLOUDS[file.suffix.lower()](stream, file, wanted | PCL.keys())
    held = {PCL.get(name, name): name for name in read.further}
    names = columns_of(held, kind)
    if names is None:
        wanted = " or ".join(",".join(one) for one in SPRING_COLUMNS[kind])
        raise refused(
            file, f"has no {kind} for its points: add {wanted}", column=SPRING_COLUMNS[kind][0][0]
        )
    columns = [np.asarray(read.further[held[name]]) for name in names]
    return SpringTable(
        path=file,
        rows=np.column_stack([as_doubles(column)[0] for column in columns]),
        labels=read.labels,
        columns=tuple(held[name] for name in names),
    )


def _of_text(stream: BinaryIO, file: Path, kind: str) -> SpringTable:
    place, titles, rows = titled_rows(stream, file)
    names = columns_of(titles, kind)
    if names is None:
        wanted = " or ".join(",".join(one) for one in SPRING_COLUMNS[kind])
        words = f"the header ({shown(', '.join(titles))}) names no {kind}: add columns {wanted}"
        raise place.refusal(words, column=SPRING_COLUMNS[kind][0][0], value=titles)
    plain = [title.strip().lower() for title in titles]
    chosen = [plain.index(name) for name in names]
    label = plain.index(LABEL) if plain.count(LABEL) == 1 else None
    numbers, labels = array("d"), list[str]()
    for place, row in rows:
        if len(row) != len(titles):
            words = f"{len(row)} columns, not {len(titles)}: mend the row"
            raise place.refusal(words, value=len(row), limit=len(titles))
        numbers.extend(_cells(place, [row[k] for k in chosen], names))
        if label is not None:
            labels.append(text_of_field(row[label].strip()))
    return SpringTable(
        path=file,
        rows=np.array(numbers, dtype=np.float64).reshape(-1, len(names)),
        labels=None if label is None else tuple(labels),
        columns=names,
    )


def _cells(place: Place, texts: list[str], names: tuple[str, ...]) -> list[float]:
    """The numbers of a row; NaN where all cells are empty."""
    empty = [text.strip().lower() in ABSENT for text in texts]
    if all(empty):
        return [nan] * len(texts)
    if any(empty):
        name = names[empty.index(True)]
        words = f"{name} is empty, other cells of {', '.join(names)} are not: give all or none"
        raise place.refusal(words, column=name)
    return [number(place, text) for text in texts]


def titles_of(path: Path) -> list[str]:
    """The names of the columns of a table that may be springs; none of another file."""
    suffix = path.suffix.lower()
    if suffix not in {*CLOUDS, *TABLES}:
        return []
    with reading(path) as stream:
        if suffix in TABLES:
            return titled_rows(stream, path)[1]
        wanted = frozenset(name for kind in SPRING_COLUMNS.values() for one in kind for name in one)
        further = CLOUDS[suffix](stream, path, wanted | PCL.keys()).further
        return [PCL.get(name, name) for name in further]
