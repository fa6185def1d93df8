"""Clouds to files, every double as it is."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically
from certreg.io.labels import csv_field
from certreg.io.npy import write_array
from certreg.io.ply import write_ply
from certreg.io.streams import refused
from certreg.problem.arrays import contiguous, row_blocks
from certreg.verify import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Motion = Callable[[NDArray[np.float64]], NDArray[np.float64]]

WRITTEN_FORMATS = (".csv", ".txt", ".ply", ".npy")


def write_cloud(
    path: str | os.PathLike[str],
    points: NDArray[np.float64],
    labels: tuple[str, ...] | None,
    *,
    move: Motion | None = None,
) -> None:
    """Write a cloud as .csv (labels kept), .txt, .ply or .npy, every double as it is.

    move: takes points (k, 3) to where they are to be written, if not where they are. That is done
    block by block: mapped points stay in their file.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in WRITTEN_FORMATS:
        what = f"the format {shown(suffix) or '(none)'} cannot be written"
        raise refused(
            file, f"{what}: use {' '.join(WRITTEN_FORMATS)}", value=suffix, limit=WRITTEN_FORMATS
        )
    pieces = _written(file, points, move)
    if suffix == ".npy":
        write_array(file, pieces, len(points))
    elif suffix == ".ply":
        write_ply(file, pieces, len(points))
    else:
        _write_text(file, pieces, labels)


def _written(
    file: Path, points: NDArray[np.float64], move: Motion | None
) -> Iterator[NDArray[np.float64]]:
    """The points, block by block, in doubles. Raises InvalidFileError where one is not finite."""
    for rows in row_blocks(len(points)):
        part = contiguous(points, rows)
        with np.errstate(over="ignore", invalid="ignore"):  # it is refused in one line
            part = part if move is None else move(part)
        finite = np.isfinite(part).all(axis=1)
        if not finite.all():
            row = int(np.argmin(finite))
            raise InvalidFileError(
                f"{file}: row {rows.start + row} (counting from 0) would be {part[row].tolist()}, "
                "beyond the doubles: change the unit of length",
                path=file,
                row=rows.start + row,
                value=part[row].tolist(),
            )
        yield part


def _write_text(
    file: Path, pieces: Iterable[NDArray[np.float64]], labels: tuple[str, ...] | None
) -> None:
    comma = file.suffix.lower() == ".csv"
    rows = ((",".join if comma else " ".join)(map(repr, row)) for p in pieces for row in p.tolist())
    if comma and labels is not None:
        names = [_quoted(file, label) for label in labels]
        rows = (f"{name},{row}" for name, row in zip(names, rows, strict=True))
    top = ["x,y,z" if labels is None else "label,x,y,z"] if comma else []
    write_atomically(file, (f"{row}\n".encode() for row in chain(top, rows)))


def _quoted(file: Path, label: str) -> str:
    """A label as a field of a .csv file; refused where the reader would not give it back."""
    kept = label == label.strip() and "\n\ufeff" not in label
    kept = kept and label == label.encode(errors="ignore").decode()
    if not kept or len(label) >= csv.field_size_limit():  # PLAIN may come before it
        raise InvalidFileError(
            f"{file}: the label '{shown(label)}' cannot be written: use labels of Unicode text "
            "without spaces at their ends",
            path=file,
            column="label",
            value=label,
        )
    field = csv_field(label)
    return f'"{field}"' if field.startswith("\ufeff") else field  # or it would be a mark of order
