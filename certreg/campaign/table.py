"""Tables of results: CSV, a second CSV that says what its columns are, and Parquet if asked for."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg._loading import library
from certreg.io.atomic import write_atomically, written_atomically
from certreg.io.labels import csv_field

if TYPE_CHECKING:
    from pathlib import Path

SUMMARY, PARQUET, COLUMNS = "summary.csv", "summary.parquet", "columns.csv"
Block = list[list[Any]]  # some rows, column by column


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table; `kind` is int, float or str, and a missing value is None."""

    name: str
    kind: type
    unit: str
    meaning: str


def write_table(
    folder: Path, columns: Sequence[Column], blocks: Iterable[Block], *, parquet: bool
) -> None:
    """Write the blocks as `summary.csv`, the columns as `columns.csv`; `summary.parquet` if asked.

    One block is held at a time. Raises InvalidFileError, MissingToolError.
    """
    if parquet:
        require_parquet()
    described = [["column", "unit", "meaning"], *([c.name, c.unit, c.meaning] for c in columns)]
    write_atomically(folder / COLUMNS, csv_bytes(described))
    with ExitStack() as stack:
        stream = stack.enter_context(written_atomically(folder / SUMMARY))
        stream.write(csv_bytes([[column.name for column in columns]]))
        keep = stack.enter_context(_parquet(folder / PARQUET, columns)) if parquet else None
        for block in blocks:
            stream.write(csv_bytes(zip(*block, strict=True)))
            if keep is not None:
                keep(block)


def require_parquet() -> None:
    """That Parquet can be written. Raises MissingToolError."""
    library("pyarrow.parquet", "--parquet")


def csv_bytes(rows: Iterable[Iterable[Any]]) -> bytes:
    """Rows as CSV; a number is the shortest that reads back the same, a text never a formula."""
    return "".join(",".join(map(_field, row)) + "\n" for row in rows).encode()


def records_bytes(rows: Iterable[dict[str, Any]]) -> bytes:
    """Rows of the same fields as CSV with a header; nothing where a value is None."""
    listed = list(rows)
    return csv_bytes([listed[0], *(row.values() for row in listed)])


def _field(value: Any) -> str:
    if isinstance(value, str):
        return csv_field(value)
    return "" if value is None else str(value)


@contextmanager
def _parquet(path: Path, columns: Sequence[Column]) -> Generator[Callable[[Block], None]]:
    """Keeps blocks in a file of Parquet, whose fields carry unit and meaning."""
    writers = library("pyarrow.parquet", "--parquet")
    arrow = library("pyarrow", "--parquet")
    types: dict[type, Any] = {int: arrow.int64(), float: arrow.float64(), str: arrow.string()}
    fields = [
        arrow.field(c.name, types[c.kind], metadata={"unit": c.unit, "meaning": c.meaning})
        for c in columns
    ]
    schema = arrow.schema(fields)

    def keep(block: Block) -> None:
        arrays = [arrow.array(c, type=f.type) for c, f in zip(block, fields, strict=True)]
        writer.write_batch(arrow.record_batch(arrays, schema=schema))

    with written_atomically(path) as stream, writers.ParquetWriter(stream, schema) as writer:
        yield keep
