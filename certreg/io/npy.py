"""Arrays from and to .npy files: header and size must agree, and no pickle is ever run."""

from __future__ import annotations

import io
import math
import tokenize
import warnings
from collections.abc import Iterable, Sequence
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically
from certreg.io.streams import held_bytes, large_file, reading, refused, require_held
from certreg.problem.arrays import as_doubles, mapped_file, row_blocks
from certreg.verify import shown

if TYPE_CHECKING:
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


class Header(NamedTuple):
    """What a header declares; `fortran`: column after column."""

    shape: tuple[int, ...]
    fortran: bool
    dtype: np.dtype[Any]


def read_array(file: Path) -> NDArray[np.float64]:
    """The finite doubles of a .npy file, of any shape. Raises InvalidFileError."""
    with reading(file) as stream:
        return parse_array(stream, file)


def parse_array(stream: BinaryIO, file: Path) -> NDArray[np.float64]:
    """The finite doubles of a .npy file, of any shape."""
    return doubles(file, parse_npy(stream, file))


def parse_npy(stream: BinaryIO, file: Path) -> NDArray[Any]:
    """The real numbers of a .npy file, as they are; those of a large one stay there if floating."""
    start = stream.tell()
    try:
        header = read_header(stream, file)
        declared = math.prod(header.shape) * header.dtype.itemsize
        mapped = large_file(stream, file) if is_float(header.dtype) else None
        first = stream.tell()
        held = held_bytes(stream, file) if mapped is None else len(mapped) - first
        require_held(file, declared, held)
        if mapped is not None:
            order = "F" if header.fortran else "C"
            return np.ndarray(header.shape, header.dtype, mapped, first, order=order)
        stream.seek(start)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # as in read_header
            return np.load(stream, allow_pickle=False)
    except NOT_NPY as error:
        raise not_npy(file, error) from error


def is_float(dtype: np.dtype[Any]) -> bool:
    """Whether all values of a type, NaN and infinities aside, are doubles."""
    return dtype.kind == "f" and dtype.itemsize <= 8


def read_header(stream: BinaryIO, file: Path) -> Header:
    """Shape, order and type of real numbers in a .npy file; the stream is left at the data.

    Raises InvalidFileError, and what is in NOT_NPY.
    """
    version = np.lib.format.read_magic(stream)
    reader = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }.get(version)
    if reader is None:
        raise refused(
            file, f"npy version {version} is not known: save it again with numpy", value=version
        )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a header of Python 2 is read right all the same
        shape, fortran, dtype = reader(stream)
    if dtype.kind not in "fiu":
        raise refused(file, f"holds {shown(dtype)}, not real numbers: save float64", value=dtype)
    return Header(tuple(map(int, shape)), bool(fortran), dtype)


def not_npy(file: Path, error: BaseException) -> InvalidFileError:
    """The refusal of a file that numpy cannot read."""
    what = f"is not a .npy file ({shown(str(error)[:80])})"
    return InvalidFileError(f"{shown(file)}: {what}: save it with numpy.save", path=file)


def write_array(file: Path, pieces: Iterable[NDArray[np.float64]], n: int) -> None:
    """Write n points (N, 3) that come in pieces to a .npy file, whole or not at all."""
    top = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": (n, 3)}
    np.lib.format.write_array_header_1_0(top, header)
    doubles = (piece.astype("<f8", copy=False).tobytes() for piece in pieces)
    write_atomically(file, chain([top.getvalue()], doubles))


def doubles(file: Path, array: NDArray[Any]) -> NDArray[np.float64]:
    """Real numbers as doubles, refused where a value is not finite or would change.

    Those that are mapped from a file stay there, as doubles or floats.
    """
    if mapped_file(array) is not None:
        return _finite(file, array)
    converted, kept = as_doubles(array)
    kept &= np.isfinite(converted)
    if not kept.all():
        row = int(np.argwhere(~kept)[0][0]) if array.ndim else 0
        raise _not_kept(file, row, np.atleast_1d(array)[row].tolist())
    return converted


def points_of_columns(file: Path, columns: Sequence[NDArray[Any]]) -> NDArray[np.float64]:
    """Columns x, y, z of any real types as points (N, 3), refused as in `doubles`.

    Those that are mapped from a file and stand evenly in its rows stay there.
    """
    points = side_by_side(columns)
    if points is not None:
        return _finite(file, points)
    converted, kept = zip(*map(as_doubles, columns), strict=True)
    points = np.column_stack(converted)
    whole = np.logical_and.reduce(kept) & np.isfinite(points).all(axis=1)
    if not whole.all():
        row = int(np.argmin(whole))
        raise _not_kept(file, row, [column[row].item() for column in columns])
    return points


def side_by_side(columns: Sequence[NDArray[Any]]) -> NDArray[Any] | None:
    """Columns of a mapped file as the points (N, 3) that they are there, if they are."""
    x = columns[0]
    apart = {b.ctypes.data - a.ctypes.data for a, b in pairwise(columns)}
    alike = {column.dtype for column in columns} == {x.dtype} and is_float(x.dtype)
    if mapped_file(x) is None or not alike or len(apart) != 1:
        return None
    strides = (x.strides[0], *apart)
    return np.lib.stride_tricks.as_strided(x, (len(x), 3), strides, writeable=False)


def _finite(file: Path, array: NDArray[Any]) -> NDArray[Any]:
    """A mapped array, looked through block by block."""
    for rows in row_blocks(len(array)):
        finite = np.isfinite(array[rows])
        if not finite.all():
            row = rows.start + int(np.argwhere(~finite)[0][0])
            raise _not_kept(file, row, array[row].tolist())
    return array


def _not_kept(file: Path, row: int, values: object) -> InvalidFileError:
    return InvalidFileError(
        f"{shown(file)}: row {row} (counting from 0) is {shown(values)}: every value must be "
        "finite and held by a double; remove or round it, in both clouds alike",
        path=file,
        row=row,
        value=values,
    )
