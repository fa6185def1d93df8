"""A file of bounds on residuals: a number for each row of the source, paired as the rows are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.io.npy import read_array
from certreg.io.streams import refused
from certreg.io.text import read_numbers
from certreg.problem.arrays import first_row

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.io.pairing import Pair


def read_bounds(path: Path, pair: Pair) -> NDArray[np.float64]:
    """The bounds of the pairs, from .npy or from text with one number a line.

    Raises InvalidFileError where the file cannot be read, holds another number of them or one that
    bounds nothing.
    """
    npy = path.suffix.lower() == ".npy"
    numbers = read_array(path) if npy else np.array(read_numbers(path), dtype=np.float64)
    n = pair.sizes[0]
    if numbers.shape != (n,):
        held = f"{len(numbers)} bounds" if numbers.ndim == 1 else f"an array {numbers.shape}"
        raise refused(
            path,
            f"holds {held}, the source has {n} rows: give one bound for each of them",
            value=numbers.shape,
            limit=n,
        )
    row = first_row(numbers, lambda block: ~((block > 0) & np.isfinite(block)))
    if row is not None:
        value = numbers[row].item()
        raise refused(
            path,
            f"bound {row} (counting from 0) is {value}: a bound must be finite and "
            "> 0, in the unit of the clouds",
            row=row,
            value=value,
            limit=0.0,
        )
    return numbers if pair.source_rows is None else numbers[pair.source_rows]
