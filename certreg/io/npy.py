"""Arrays from and to .npy files: header and size must agree, and no pickle is ever run."""

from __future__ import annotations

import io
import math
import tokenize
import warnings
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from certreg.errors import InvalidFileError
from certreg.files import write_atomically
from certreg.io.streams import held_bytes, reading
from certreg.problem import as_doubles
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

NOT_NPY = (  # what numpy raises for headers that it cannot read
    EOFError,
    MemoryError,
    RecursionError,
    SyntaxError,
    TypeError,
    ValueError,
    tokenize.TokenError,
)


def read_array(file: Path) -> NDArray[np.float64]:
    """The finite doubles of a .npy file, of any shape. Raises InvalidFileError."""
    with reading(file) as stream:
        return parse_array(stream, file)


def parse_array(stream: BinaryIO, file: Path) -> NDArray[np.float64]:
    """The finite doubles of a .npy file, of any shape."""
    return doubles(file, parse_npy(stream, file))


def parse_npy(stream: BinaryIO, file: Path) -> NDArray[Any]:
    """The real numbers of a .npy file, as they are."""
    start = stream.tell()
    try:
        shape, dtype = read_header(stream, file)
        declared = math.prod(shape) * dtype.itemsize
        held = held_bytes(stream, file)
        if declared != held:
            message = (
                f"{shown(file)}: the header declares {declared} bytes of data, the file holds "
                f"{held}: it is truncated or corrupt; save it again"
            )
            raise InvalidFileError(message)
        stream.seek(start)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # as in read_header
            return cast("NDArray[Any]", np.load(stream, allow_pickle=False))
    except NOT_NPY as error:
        raise not_npy(file, error) from error


def read_header(stream: BinaryIO, file: Path) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Shape and type of real numbers in a .npy file; the stream is left at the data.

    Raises InvalidFileError, and what is in NOT_NPY.
    """
    version = np.lib.format.read_magic(stream)
    reader = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }.get(version)
    if reader is None:
        message = f"{shown(file)}: npy version {version} is not known: save it again with numpy"
        raise InvalidFileError(message)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a header of Python 2 is read right all the same
        shape, _, dtype = reader(stream)
    if dtype.kind not in "fiu":
        message = f"{shown(file)}: holds {shown(dtype)}, not real numbers: save float64"
        raise InvalidFileError(message)
    return tuple(map(int, shape)), dtype


def not_npy(file: Path, error: BaseException) -> InvalidFileError:
    """The refusal of a file that numpy cannot read."""
    what = f"is not a .npy file ({shown(str(error)[:80])})"
    return InvalidFileError(f"{shown(file)}: {what}: save it with numpy.save")


def write_array(file: Path, array: NDArray[np.float64]) -> None:
    """Write a .npy file, whole or not at all."""
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    write_atomically(file, buffer.getvalue())


def doubles(file: Path, array: NDArray[Any]) -> NDArray[np.float64]:
    """Real numbers as doubles, refused where a value is not finite or would change."""
    converted, kept = as_doubles(array)
    kept &= np.isfinite(converted)
    if not kept.all():
        row = int(np.argwhere(~kept)[0][0]) if array.ndim else 0
        raise _not_kept(file, row, np.atleast_1d(array)[row].tolist())
    return converted


def points_of_columns(file: Path, columns: Sequence[NDArray[Any]]) -> NDArray[np.float64]:
    """Columns x, y, z of any real types as points (N, 3), refused as in `doubles`."""
    converted, kept = zip(*map(as_doubles, columns), strict=True)
    points = np.column_stack(converted)
    whole = np.logical_and.reduce(kept) & np.isfinite(points).all(axis=1)
    if not whole.all():
        row = int(np.argmin(whole))
        raise _not_kept(file, row, [column[row].item() for column in columns])
    return points


def _not_kept(file: Path, row: int, values: object) -> InvalidFileError:
    return InvalidFileError(
        f"{shown(file)}: row {row} (counting from 0) is {shown(values)}: every value must be "
        "finite and held by a double; remove or round it, in both clouds alike"
    )
