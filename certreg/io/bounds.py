"""A file of bounds on residuals: a number for each row of the source, paired as the rows are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.npy import read_array
from certreg.io.text import read_numbers

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.io.clouds import Pair


def read_bounds(path: Path, pair: Pair, n: int) -> NDArray[np.float64]:
    """The bounds of n pairs, from .npy or from text with one number a line.

    Raises InvalidFileError where the file cannot be read or holds another number of them.
    """
    npy = path.suffix.lower() == ".npy"
    numbers = read_array(path) if npy else np.array(read_numbers(path), dtype=np.float64)
    rows = pair.source_rows
    few = numbers.ndim != 1 or len(numbers) != n
    if few if rows is None else numbers.ndim != 1 or len(numbers) <= int(rows.max()):
        message = (
            f"{path}: holds an array of shape {numbers.shape}: give one bound per row of the source"
        )
        raise InvalidFileError(message, path=path, value=numbers.shape, limit=n)
    return numbers if rows is None else numbers[rows]
