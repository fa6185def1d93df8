"""Arrays in, of whatever library: points by duck typing, and their exact doubles.

No library is imported to recognise its objects. What is ambiguous is refused, with what to type.
"""

from __future__ import annotations

import mmap
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]

BLOCK_POINTS = 1 << 16  # read at a time: 3.5 MB; a share of a second, for Ctrl-C
ATTRIBUTES = ("xyz", "points", "vertices")  # in this order: `points` of laspy are raw records
AXES = ("x", "y", "z")
CHANGED = "the file of a mapped array was changed while it was read: state the problem anew"
WORDS = 160  # of another library's error: its first line, and not all of a long one


def cloud_array(cloud: Any, name: str) -> NDArray[Any]:
    """An array (N, 3), N >= 1, of real numbers of any type, not copied if it is one."""
    array = _frame_points(cloud, name) if data_frame(cloud) else real_numbers(_held(cloud), name)
    if array.ndim != 2 or array.shape[1] != 3:
        remedy = remedy_of_shape(array.shape, name)
        raise InvalidProblemError(
            f"{name} has shape {array.shape}: expected (N, 3), one point per row{remedy}",
            array=name,
            value=array.shape,
        )
    if len(array) == 0:
        raise InvalidProblemError(
            f"{name} has no points: at least one correspondence is needed",
            array=name,
            value=0,
            limit=1,
        )
    return array


def remedy_of_shape(shape: tuple[int, ...], name: str) -> str:
    """What makes points (N, 3) of an array that is none, to end a message; empty where unknown."""
    if len(shape) == 2 and shape[1] == 2:
        return f"; of points in the plane give np.pad({name}, ((0, 0), (0, 1)))"
    if len(shape) == 2 and shape[0] == 3:
        return f"; transpose it: {name}.T"
    if len(shape) == 2 and shape[1] == 4:
        return f"; of homogeneous coordinates give {name}[:, :3] / {name}[:, 3:]"
    return ""


def data_frame(given: Any) -> bool:
    """Whether this is a table with named columns, of pandas, polars or their like."""
    return hasattr(given, "columns") and hasattr(given, "to_numpy")


def _held(cloud: Any) -> Any:
    """What an object holds as its points; the object itself where it is an array of its own."""
    array: Any = cloud
    if isinstance(cloud, np.ndarray) or hasattr(cloud, "dims"):  # of xarray: names are coordinates
        return array
    for attribute in ATTRIBUTES:
        held = getattr(cloud, attribute, None)
        if callable(held) and callable(getattr(cloud, "covs", None)):  # small_gicp: x, y, z, 1
            return real_numbers(held(), attribute)[:, :3]
        if held is not None and not callable(held):
            return held
    tensors = getattr(cloud, "point", None)  # a point cloud of tensors, of Open3D
    return getattr(tensors, "positions", cloud)


def _frame_points(frame: Any, name: str) -> NDArray[Any]:
    """The columns x, y, z of a data frame, or its three columns where they have no names."""
    columns = named_columns(frame, name, (AXES,))
    if columns is not None and columns.shape[1] == len(AXES):
        return columns
    names = list(frame.columns)
    stated = ", ".join(map(str, names))[:WORDS]
    raise InvalidProblemError(
        f"{name} is a data frame with the columns {stated}: which are x, y, z? Rename them so, or "
        "let certreg.pair(source, target) read them",
        array=name,
        value=names,
    )


def named_columns(frame: Any, name: str, wanted: Iterable[tuple[str, ...]]) -> NDArray[Any] | None:
    """The columns of a data frame with the first of these names, or all where none has a name."""
    names: list[Any] = list(frame.columns)
    plain = [one.strip().lower() if isinstance(one, str) else one for one in names]
    for those in wanted:
        if all(plain.count(one) == 1 for one in those):
            chosen = [names[plain.index(one)] for one in those]
            return np.column_stack([real_numbers(frame[column], name) for column in chosen])
    unnamed = not any(isinstance(one, str) for one in names)
    return real_numbers(frame.to_numpy(), name) if unnamed else None


def real_numbers(values: Any, name: str) -> NDArray[Any]:
    """The values as an array of real numbers of any type, not copied if they are one."""
    if np.ma.isMaskedArray(values):
        raise InvalidProblemError(
            f"{name} is a masked array: drop the masked rows from both clouds first", array=name
        )
    try:
        plain = hasattr(values, "__array__") or not callable(getattr(values, "numpy", None))
        array = np.asarray(values if plain else values.numpy())
    except (ValueError, TypeError, RuntimeError) as error:
        words = (str(error).splitlines() or [type(error).__name__])[0][:WORDS]
        raise InvalidProblemError(
            f"{name} is not an array of numbers: {words}{_remedy(values, name)}", array=name
        ) from error
    if array.dtype.kind not in "fiu":
        hint = f"; convert it first, as by {name}.astype(float)" if array.dtype.kind in "OV" else ""
        raise InvalidProblemError(
            f"{name} has entries of type {array.dtype}: expected real numbers{hint}",
            array=name,
            value=array.dtype,
        )
    return array


def per_point(values: Any, name: str, n: int) -> NDArray[Any]:
    """One number for each of n points, (n,), or (1,) that stands for all, as `real_numbers`."""
    array = real_numbers(values, name)
    if array.shape not in {(), (n,)}:
        raise InvalidProblemError(
            f"{name} has shape {array.shape}: expected one number, or ({n},), one per point",
            array=name,
            value=array.shape,
            limit=(n,),
        )
    return array.reshape(-1)


def _remedy(values: Any, name: str) -> str:
    """What to type for an array that does not let NumPy read it: on a GPU, or with gradients."""
    if hasattr(values, "detach"):  # of PyTorch; .double(), for NumPy has no bfloat16
        return f"; give {name}.detach().cpu().double().numpy()"
    if callable(getattr(values, "get", None)) and hasattr(values, "shape"):  # of CuPy
        return f"; give {name}.get()"
    return ""


def finite_doubles(array: NDArray[Any], name: str) -> NDArray[np.float64]:
    """The finite values of an array as doubles, -0.0 as 0.0: fresh, or mapped from a file as it is.

    Refused where a conversion would lose or invent something. In blocks: no second copy is made.
    """
    mapped = mapped_file(array) is not None
    kept = array if mapped else np.empty(array.shape)
    for rows in row_blocks(len(array)):
        doubles, same = as_doubles(array[rows])
        if not same.all():
            row = rows.start + int(np.argwhere(~same)[0][0])
            raise InvalidProblemError(
                f"{name} has entries of type {array.dtype} that no double holds exactly: "
                "round them yourself with .astype(float) if that is what you mean",
                array=name,
                row=row,
                value=array[row].tolist(),
            )
        finite = np.isfinite(doubles)
        if not finite.all():
            row = int(np.argwhere(~finite)[0][0])
            raise InvalidProblemError(
                f"{name} row {rows.start + row} (counting from 0) is {doubles[row].tolist()}: "
                "every value must be finite; remove the correspondence from both clouds",
                array=name,
                row=rows.start + row,
                value=doubles[row].tolist(),
            )
        if not mapped:
            np.add(doubles, 0.0, out=kept[rows])  # -0.0 + 0.0 is 0.0: one point, one digest
    return kept


def as_doubles(array: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """A copy of real numbers as doubles, and where it holds the same value (or the same NaN)."""
    with np.errstate(over="ignore", invalid="ignore"):
        doubles = array.astype(np.float64, order="C")  # astype always copies
        if array.dtype.kind == "f" and array.dtype.itemsize <= doubles.itemsize:
            return doubles, np.ones(doubles.shape, dtype=bool)
        back = doubles.astype(array.dtype)
    kept = (back == array) | (np.isnan(doubles) & np.isnan(array))
    if array.dtype.kind in "iu":  # beyond these bounds the cast back is undefined
        info = np.iinfo(array.dtype)
        kept &= doubles < 2.0 ** (info.bits - (info.min < 0))
    return doubles, kept


def mapped_file(array: NDArray[Any]) -> mmap.mmap | None:
    """The file of an array that was mapped for reading only; None for any other array.

    Through a map for reading only this process cannot change the array. The pages of the file that
    were read are the system's: it takes them back when memory is scarce.
    """
    owner: Any = array
    while type(owner) is np.ndarray:  # of most arrays that is all, and sooner done
        owner = owner.base
    while owner is not None and not isinstance(owner, mmap.mmap):
        base = owner.obj if isinstance(owner, memoryview) else getattr(owner, "base", None)
        owner = None if base is owner else base  # an array of Cython's names itself
    return owner if owner is not None and memoryview(owner).readonly else None


def row_blocks(n: int) -> Iterator[slice]:
    """The rows 0 to n in blocks of a size that is read at a time."""
    starts = range(0, n, BLOCK_POINTS)
    return (slice(first, min(first + BLOCK_POINTS, n)) for first in starts)


def contiguous(
    array: NDArray[np.float64], rows: slice, name: str | None = None, least: float = -np.inf
) -> NDArray[np.float64]:
    """Rows of an array of a problem as contiguous doubles, -0.0 as 0.0; `name` is for errors.

    A copy where the array is mapped from a file. Raises InvalidProblemError where the file holds a
    number that is not finite, or below the least: it did not, once.
    """
    if mapped_file(array) is None:
        return np.ascontiguousarray(array[rows])
    copied = array[rows].astype(np.float64, order="C")
    copied += 0.0  # -0.0 + 0.0 is 0.0: one point, one digest
    good = np.isfinite(copied) & (copied >= least)
    if not good.all():
        row = rows.start + int(np.argwhere(~good)[0][0])
        raise InvalidProblemError(
            CHANGED, array=name, row=row, value=copied[row - rows.start].tolist()
        )
    return copied


def first_row(
    array: NDArray[np.float64], wrong: Callable[[NDArray[np.float64]], NDArray[np.bool_]]
) -> int | None:
    """The first row where something is wrong, None if nowhere."""
    for rows in row_blocks(len(array)):
        faults = wrong(contiguous(array, rows))
        if faults.any():
            return rows.start + int(np.argmax(faults))
    return None


def lengths(rows: Reals) -> Reals:
    """(N,) of (N, k): infinite only where a length is beyond the doubles.

    Each row is divided by a power of two first, which changes no bit of its length.
    """
    exponents = np.frexp(np.abs(rows).max(axis=1))[1]
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        return np.ldexp(
            np.linalg.norm(np.ldexp(rows, -exponents[:, np.newaxis]), axis=1), exponents
        )


def apart(rows: Reals, others: Reals) -> Reals:
    """(N,), how far each row is from the other; infinite only beyond the doubles."""
    with np.errstate(over="ignore"):
        return lengths(others - rows)


def diameter(points: Reals) -> float:
    """The diagonal of the box around points, at least their diameter; infinite as above."""
    return float(apart(points.min(axis=0)[np.newaxis], points.max(axis=0)[np.newaxis])[0])
