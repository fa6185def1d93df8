"""General springs of two clouds in correspondence: from columns of the target, files, or memory.

A spring stands in the frame of the target, so each row of springs is one of the target, and goes
where the row goes when labels or pairs bring it elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg._loading import late
from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.io.standard_input import is_standard_input
from certreg.io.streams import refused
from certreg.problem.spring_rows import held_rows, require_not_of_source
from certreg.results import Brief
from certreg.verify import shown

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from certreg.io import spring_tables
    from certreg.io.pairing import Pair
    from certreg.io.spring_tables import SpringTable
else:
    spring_tables = late("certreg.io.spring_tables")

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
        message = f"springs is {unknown[0]!r}: give one of {', '.join(OF_COLUMNS)}"
        raise InvalidProblemError(message, array="springs", value=unknown[0])
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
        table = spring_tables.read_spring_table(path, kind)
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
        message = f"standard input is read once: give a file, or {kind} in one of their own"
        raise InvalidFileError(message, path=Path(target), column=kind)
    try:
        return spring_tables.read_spring_table(Path(target), kind)
    except InvalidFileError as error:
        here = not is_standard_input(source) and spring_tables.columns_of(
            spring_tables.titles_of(Path(source)), kind
        )
        if error.column is None or not here:
            raise
        message = f"{shown(source)}: has {kind}, the target has none: {TURNS}"
        raise InvalidFileError(message, path=Path(source), column=error.column) from error


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
            rows[kind] = _rows_of_pairs(
                spring_tables.read_spring_table(Path(values), kind), kind, pair
            )
            continue
        require_not_of_source(values, *clouds, kind)
        rows[kind] = values if pair.target_rows is None else _taken(values, kind, pair)
    return rows


def _taken(values: Any, kind: str, pair: Pair) -> Any:
    array, n = held_rows(values, kind), pair.sizes[1]
    if len(array) != n:
        message = f"{kind} has shape {array.shape}: expected {n} rows, one per row of the target"
        raise InvalidProblemError(message, array=kind, value=array.shape, limit=n)
    taken = getattr(values, "of_rows", None)  # with what it notes
    return array[pair.target_rows] if taken is None else taken(pair.target_rows)
