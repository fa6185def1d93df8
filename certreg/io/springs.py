"""General springs of two clouds in correspondence: from columns of the target, files, or memory.

A spring stands in the frame of the target, so each row of springs is one of the target, and goes
where the row goes when labels or pairs bring it elsewhere. Columns have names: nx, ny, nz; dx, dy,
dz; cxx to czz, or xx to zz; l11 to l33; lx, ly, lz. A row whose cells are all empty, or NaN, has no
spring of this kind.
"""

from __future__ import annotations

import os
from array import array
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from math import nan
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from certreg._loading import found_late, late
from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.io.columns import LABEL
from certreg.io.labels import text_of_field
from certreg.io.streams import Place, is_standard_input, number, reading, refused
from certreg.io.text import COLUMN_FORMATS, titled_rows
from certreg.problem.arrays import as_doubles
from certreg.problem.attributes import SPRING_COLUMNS, held_rows, require_not_of_source
from certreg.results import Brief
from certreg.verify import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.io import npy
    from certreg.io.cloud import Cloud
    from certreg.io.pairing import Pair
else:
    npy = late("certreg.io.npy")


OF_COLUMNS = {"plane": "normals", "line": "directions", "full": "covariances"}
TURNS = (
    "they turn with the rotation that is sought, and a spring stands in the frame of the target: "
    "give those of TARGET, or swap the clouds and invert the pose"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringSource(Brief):
    """Where general springs are read from.

    columns: kinds of springs that columns of the target tell: "plane", "line", "full".
    files: tables and arrays with a row for each row of the target, by the argument of
        `RegistrationProblem` that they are.
    """

    columns: tuple[str, ...] = ()
    files: Mapping[str, Path] = field(default_factory=dict[str, Path])


NO_SPRINGS = SpringSource()


def read_springs(
    springs: SpringSource | str,
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    pair: Pair,
) -> tuple[dict[str, Any], Pair]:
    """The rows of each kind for each pair, by name, and the pair without notes on such columns.

    springs: or one kind of columns. source, target: the files of the pair. Raises InvalidFileError,
    and InvalidProblemError for another kind.
    """
    springs = SpringSource(columns=(springs,)) if isinstance(springs, str) else springs
    unknown = [name for name in springs.columns if name not in OF_COLUMNS]
    if unknown:
        raise InvalidProblemError(
            f"springs is {unknown[0]!r}: give one of {', '.join(OF_COLUMNS)}",
            array="springs",
            value=unknown[0],
        )
    rows: dict[str, Any] = {}
    for name in dict.fromkeys(springs.columns):
        kind = OF_COLUMNS[name]
        table = _of_target(kind, source, target)
        rows[kind] = _rows_of_pairs(table, kind, pair)
        pair = _using(pair, table.columns)
    for kind, path in springs.files.items():
        if kind in rows:
            raise refused(
                path, f"{kind} are given by columns of the target, too: give one", column=kind
            )
        if not is_standard_input(source) and _same_file(path, Path(source)):
            raise refused(
                path, f"is SOURCE: {kind} of the source are not used: {TURNS}", column=kind
            )
        table = read_spring_table(path, kind)
        rows[kind] = _rows_of_pairs(table, kind, pair)
        if not is_standard_input(target) and _same_file(path, Path(target)):
            pair = _using(pair, table.columns)
    return rows, pair


def _using(pair: Pair, columns: tuple[str, ...]) -> Pair:
    """The pair, of whose target these columns are used."""
    left = tuple(one for one in pair.target.ignored if one.strip().lower() not in columns)
    return replace(pair, target=replace(pair.target, ignored=left))


def _of_target(
    kind: str, source: str | os.PathLike[str], target: str | os.PathLike[str]
) -> SpringTable:
    if is_standard_input(target):
        raise InvalidFileError(
            f"standard input is read once: give a file, or {kind} in one of their own",
            path=Path(target),
            column=kind,
        )
    try:
        return read_spring_table(Path(target), kind)
    except InvalidFileError as error:
        here = not is_standard_input(source) and columns_of(titles_of(Path(source)), kind)
        if error.column is None or not here:
            raise
        raise InvalidFileError(
            f"{shown(source)}: has {kind}, the target has none: {TURNS}",
            path=Path(source),
            column=error.column,
        ) from error


def _same_file(one: Path, other: Path) -> bool:
    return one.exists() and other.exists() and one.samefile(other)


def _rows_of_pairs(table: SpringTable, kind: str, pair: Pair) -> Any:
    """A row for each pair: by label where both have labels, else as the rows of the target."""
    labels = pair.target.labels
    if labels is not None and table.labels is not None:
        return table.rows[_by_label(table, kind, labels)]
    n = pair.sizes[1]
    if len(table.rows) != n:
        raise refused(
            table.path,
            f"holds {len(table.rows)} rows of {kind}, the target has {n} "
            "points: give one row per row of the target",
            value=len(table.rows),
            limit=n,
        )
    return table.rows if pair.target_rows is None else table.rows[pair.target_rows]


def _by_label(table: SpringTable, kind: str, labels: tuple[str, ...]) -> list[int]:
    rows: dict[str, int] = {}
    for row, label in enumerate(table.labels or ()):
        if rows.setdefault(label, row) != row:
            raise refused(
                table.path,
                f"label '{shown(label)}' comes twice: give each one row",
                row=row,
                value=label,
            )
    missing = next((label for label in labels if label not in rows), None)
    if missing is not None:
        raise refused(
            table.path, f"has no {kind} for the label '{shown(missing)}': add a row", value=missing
        )
    return [rows[label] for label in labels]


def springs_of_pairs(
    given: Mapping[str, Any], clouds: tuple[Any, Any], pair: Pair
) -> dict[str, Any]:
    """Springs in memory, or in files, with a row for each row of the target: those of each pair.

    clouds: source and target, as the user gave them. Raises InvalidProblemError.
    """
    rows: dict[str, Any] = {}
    for kind, values in given.items():
        if values is None:
            continue
        if isinstance(values, str) or hasattr(values, "__fspath__"):
            rows[kind] = _rows_of_pairs(read_spring_table(Path(values), kind), kind, pair)
            continue
        require_not_of_source(values, *clouds, kind)
        rows[kind] = values if pair.target_rows is None else _taken(values, kind, pair)
    return rows


def _taken(values: Any, kind: str, pair: Pair) -> Any:
    array, n = held_rows(values, kind), pair.sizes[1]
    if len(array) != n:
        raise InvalidProblemError(
            f"{kind} has shape {array.shape}: expected {n} rows, one per row of the target",
            array=kind,
            value=array.shape,
            limit=n,
        )
    taken = getattr(values, "of_rows", None)  # with what it notes
    return array[pair.target_rows] if taken is None else taken(pair.target_rows)


CLOUDS: dict[str, Callable[[], Callable[..., Cloud]]] = {  # loaded when needed
    ".ply": found_late("certreg.io.ply", "parse_ply"),
    ".pcd": found_late("certreg.io.pcd", "parse_pcd"),
}
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
    if suffix not in {".npy", *CLOUDS, *COLUMN_FORMATS}:
        known = ", ".join(COLUMN_FORMATS)
        raise refused(
            path, f"{kind} are read from {known} with a header, .npy, .ply or .pcd", value=suffix
        )
    with reading(path) as stream:
        if suffix == ".npy":
            return _of_array(stream, path)
        return (_of_text if suffix in COLUMN_FORMATS else _of_cloud)(stream, path, kind)


def columns_of(titles: Iterable[str], kind: str) -> tuple[str, ...] | None:
    """The names of the columns of one kind, where all of them are there, once; else None."""
    plain = [title.strip().lower() for title in titles]
    for names in SPRING_COLUMNS[kind]:
        if all(plain.count(name) == 1 for name in names):
            return names
    return None


def _of_array(stream: BinaryIO, file: Path) -> SpringTable:
    rows = npy.parse_npy(stream, file)
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
    read = CLOUDS[file.suffix.lower()]()(stream, file, wanted | PCL.keys())
    held = {PCL.get(name, name): name for name in read.further}
    names = columns_of(held, kind)
    if names is None:
        raise refused(
            file,
            f"has no {kind} for its points: add {_wanted(kind)}",
            column=SPRING_COLUMNS[kind][0][0],
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
        raise place.refusal(
            f"the header ({shown(', '.join(titles))}) names no {kind}: add columns {_wanted(kind)}",
            column=SPRING_COLUMNS[kind][0][0],
            value=titles,
        )
    plain = [title.strip().lower() for title in titles]
    chosen = [plain.index(name) for name in names]
    label = plain.index(LABEL) if plain.count(LABEL) == 1 else None
    numbers, labels = array("d"), list[str]()
    for place, row in rows:
        if len(row) != len(titles):
            raise place.refusal(
                f"{len(row)} columns, not {len(titles)}: mend the row",
                value=len(row),
                limit=len(titles),
            )
        numbers.extend(_cells(place, [row[k] for k in chosen], names))
        if label is not None:
            labels.append(text_of_field(row[label].strip()))
    return SpringTable(
        path=file,
        rows=np.array(numbers, dtype=np.float64).reshape(-1, len(names)),
        labels=None if label is None else tuple(labels),
        columns=names,
    )


def _wanted(kind: str) -> str:
    return " or ".join(",".join(names) for names in SPRING_COLUMNS[kind])


def _cells(place: Place, texts: list[str], names: tuple[str, ...]) -> list[float]:
    """The numbers of a row; NaN where all cells are empty."""
    empty = [text.strip().lower() in ABSENT for text in texts]
    if all(empty):
        return [nan] * len(texts)
    if any(empty):
        name = names[empty.index(True)]
        raise place.refusal(
            f"{name} is empty, other cells of {', '.join(names)} are not: give all or none",
            column=name,
        )
    return [number(place, text) for text in texts]


def titles_of(path: Path) -> list[str]:
    """The names of the columns of a table that may be springs; none of another file."""
    suffix = path.suffix.lower()
    if suffix not in {*CLOUDS, *COLUMN_FORMATS}:
        return []
    with reading(path) as stream:
        if suffix in COLUMN_FORMATS:
            return titled_rows(stream, path)[1]
        wanted = frozenset(name for kind in SPRING_COLUMNS.values() for one in kind for name in one)
        further = CLOUDS[suffix]()(stream, path, wanted | PCL.keys()).further
        return [PCL.get(name, name) for name in further]
