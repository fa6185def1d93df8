"""What points hold beside coordinates: in arrays, tables, objects of other libraries.

Of general springs one row per pair comes out: three numbers of a normal, a direction or a column
of L, six of a symmetric matrix or of L.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from certreg.errors import InvalidProblemError, UnusedNoiseWarning, UnusedSpringsWarning
from certreg.problem.arrays import (
    ATTRIBUTES,
    data_frame,
    finite_doubles,
    named_columns,
    real_numbers,
    row_blocks,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Rows = NDArray[np.float64]

SYMMETRIC = ("xx", "xy", "xz", "yy", "yz", "zz")
LOWER = ("l11", "l21", "l22", "l31", "l32", "l33")  # by rows
SPRING_COLUMNS = {  # of tables: the names that a kind may have, the widest first
    "normals": (("nx", "ny", "nz"),),
    "directions": (("dx", "dy", "dz"),),
    "covariances": (tuple(f"c{name}" for name in SYMMETRIC), SYMMETRIC),
    "information": (SYMMETRIC,),
    "factors": (LOWER, ("lx", "ly", "lz")),
}
SHAPES = {  # of the rows of arrays
    "normals": ((3,),),
    "directions": ((3,),),
    "covariances": ((3, 3), (6,)),
    "information": ((3, 3), (6,)),
    "factors": ((6,), (3,), (3, 3)),
}
HELD = {  # by objects: Open3D, trimesh, PyVista; small_gicp
    "normals": ("normals", "vertex_normals", "point_normals"),
    "covariances": ("covariances", "covs"),
}
NOISE_COLUMNS = {  # by the name of the column: that of the attribute, and what uses it
    "sigma": ("sigma", "sigma={}"),
    "weight": ("weights", "weights={}"),
}
ASYMMETRY = 1e-12  # of the largest entry of a matrix
SIX_OF_NINE = [0, 1, 2, 4, 5, 8]
MIRRORED_OF_NINE = [0, 3, 6, 4, 7, 8]
LOWER_OF_NINE = [0, 3, 4, 6, 7, 8]
ABOVE_OF_NINE = [1, 2, 5]
ALONE = (
    "the pair has no spring; remove it from both clouds (for a point spring give factors, too: 1, "
    "0, 1, 0, 0, 1 in this row, and NaN in the others)"
)
NOT_LOWER = "has entries above its diagonal: give a lower triangular L, as numpy.linalg.cholesky"
NOT_SYMMETRIC = "is not symmetric up to 1e-12 of its largest entry: give (W + W^T)/2"


class SpringArguments(TypedDict, total=False):
    """General springs, as in `RegistrationProblem`."""

    normals: Any
    directions: Any
    covariances: Any
    information: Any
    factors: Any


def require_known(given: Iterable[str], arguments: type[Mapping[str, Any]], function: str) -> None:
    """Nothing for arguments that a function takes; for another the TypeError that Python raises."""
    for name in given:
        if name not in arguments.__annotations__:
            raise TypeError(f"{function}() got an unexpected keyword argument {name!r}")


def held_rows(given: Any, name: str) -> NDArray[Any]:
    """The numbers of one kind of springs, as an array of one of the shapes of their kind.

    Raises InvalidProblemError where a cloud has none, or a table no such columns.
    """
    if data_frame(given):
        return _of_frame(given, name)
    held = held_by(given, name)
    if held is None and not isinstance(given, np.ndarray) and _is_cloud(given):
        raise InvalidProblemError(
            f"{name}: the cloud that was given has no {name}: give those of the target", array=name
        )
    array = real_numbers(given if held is None else held, name)
    if held is not None and array.shape[1:] in {(4,), (4, 4)}:  # small_gicp: a zero behind
        array = array[:, :3] if array.ndim == 2 else array[:, :3, :3]
    if held is not None and len(array) == 0:
        raise InvalidProblemError(
            f"{name}: the cloud that was given has none: estimate them first", array=name, value=0
        )
    return array


def held_by(given: Any, name: str) -> Any:
    """What an object has of this kind; None where it has no such attribute, or is an array."""
    return None if isinstance(given, np.ndarray) else _held(given, (name, *HELD.get(name, ())))


def _held(given: Any, attributes: tuple[str, ...]) -> Any:
    """The first of the attributes that an object has."""
    for attribute in attributes:
        held = getattr(given, attribute, None)
        if held is None:
            held = getattr(getattr(given, "point", None), attribute, None)  # tensors, of Open3D
        if held is not None:
            return held() if callable(held) else held
    return None


def warn_of_unused(target: Any, n: int, *, depth: int) -> None:
    """A warning where a target of n points holds springs that were not asked for.

    depth: how many calls are between the user and here. Of a table the columns are noted elsewhere.
    """
    kind = unused_springs(target, n)
    if kind is not None:
        words = (
            f"target has {kind}, which are not used: each pair is a point spring. {kind}=target "
            "uses them; give its points alone if points are meant"
        )
        warnings.warn(words, UnusedSpringsWarning, stacklevel=depth + 2)


def warn_of_unused_noise(source: Any, target: Any, *, depth: int) -> None:
    """A warning for each cloud that holds a sigma or weights, where none were given.

    depth: how many calls are between the user and here.
    """
    for cloud, which in ((source, "source"), (target, "target")):
        columns = () if isinstance(cloud, np.ndarray) else NOISE_COLUMNS.items()
        for name, (attribute, remedy) in columns:
            if (place := _place(cloud, name, attribute)) is not None:
                words = (
                    f"{which} has a column {name}, which is not used: all pairs count alike. "
                    f"{remedy.format(which + place)} uses it; give its points alone if "
                    "pairs count alike"
                )
                warnings.warn(words, UnusedNoiseWarning, stacklevel=depth + 2)


def _place(cloud: Any, name: str, attribute: str) -> str | None:
    """How Python reaches the column of this name; None where a cloud has none."""
    if data_frame(cloud):
        return f'["{name}"]' if name in list(cloud.columns) else None
    held = getattr(cloud, attribute, None)
    return f".{attribute}" if isinstance(held, np.ndarray) else None


def unused_springs(cloud: Any, n: int) -> str | None:
    """What kind of springs an object of n points holds; attributes that it may compute are left."""
    if isinstance(cloud, np.ndarray) or data_frame(cloud):
        return None
    for kind in ("normals", "covariances"):
        held = _held(cloud, (kind, *(("covs",) if kind == "covariances" else ())))
        if held is not None and len(held) == n:
            return kind
    return None


def _is_cloud(given: Any) -> bool:
    return any(hasattr(given, attribute) for attribute in (*ATTRIBUTES, "point"))


def _of_frame(frame: Any, name: str) -> NDArray[Any]:
    """The columns of a table that have the names of this kind, or all where none has a name."""
    columns = named_columns(frame, name, SPRING_COLUMNS[name])
    if columns is not None:
        return columns
    wanted = " or ".join(",".join(one) for one in SPRING_COLUMNS[name])
    raise InvalidProblemError(
        f"{name} is a data frame without the columns {wanted}: name them so",
        array=name,
        value=list(frame.columns),
    )


def require_not_of_source(given: Any, source: Any, target: Any, name: str) -> None:
    """That these are not what the source holds: in its frame they would turn with R."""
    if source is target or isinstance(source, np.ndarray) or data_frame(source):
        return
    own = held_by(source, name)
    same = given is source or given is own
    if not same and own is not None and given is not target:
        here, there = np.asarray(own), np.asarray(held_rows(given, name))
        same = here.size > 0 and np.array_equal(here, there)
        same = same and not np.array_equal(here, np.asarray(held_by(target, name)))
    if same:
        remedy = "give those of the target, or swap the clouds and invert the pose"
        if name == "covariances":
            remedy += "; of both sides: information=certreg.gicp_information(...)"
        raise InvalidProblemError(
            f"{name} are of the source: they turn with the rotation that is sought, and a spring "
            f"stands in the frame of the target; {remedy}",
            array=name,
        )


def checked_rows(
    array: NDArray[Any], kind: str, n: int, *, several: bool, called: str | None = None
) -> Rows:
    """(n, 3) or (n, 6) doubles, finite; zeros in rows of NaN, where several kinds are given.

    Of matrices (n, 3, 3) the six numbers. (n, 6) doubles that are mapped from a file stay there.
    called: in errors, if not by the kind. Raises InvalidProblemError with the row.
    """
    name = called or kind
    if array.shape[:1] != (n,) or array.shape[1:] not in SHAPES[kind]:
        forms = " or ".join(str((n, *shape)) for shape in SHAPES[kind])
        raise InvalidProblemError(
            f"{name} has shape {array.shape}: expected {forms}, one row per pair",
            array=name,
            value=array.shape,
            limit=n,
        )
    flat = array.reshape(n, -1)
    absent = absent_rows(flat)
    if absent.any() and not several:
        row = int(np.argmax(absent))
        raise InvalidProblemError(
            f"{name} row {row} (counting from 0) is NaN: {ALONE}",
            array=name,
            row=row,
            value=flat[row].tolist(),
        )
    rows = finite_doubles(np.where(absent[:, None], 0, flat) if absent.any() else flat, name)
    if rows.shape[1] == 9:
        return _lower(rows, name) if kind == "factors" else _symmetric(rows, name)
    return rows


def absent_rows(rows: NDArray[Any]) -> NDArray[np.bool_]:
    """(n,): where all numbers of a row are NaN."""
    if rows.dtype.kind != "f":
        return np.zeros(len(rows), dtype=bool)
    absent = np.empty(len(rows), dtype=bool)
    for part in row_blocks(len(rows)):
        absent[part] = np.isnan(rows[part]).all(axis=1)
    return absent


def _lower(rows: Rows, name: str) -> Rows:
    """Lower triangular matrices by l11, l21, l22, l31, l32, l33."""
    require(name, rows, ~any_of(rows[:, ABOVE_OF_NINE]), NOT_LOWER)
    return np.ascontiguousarray(rows[:, LOWER_OF_NINE])


def _symmetric(rows: Rows, name: str) -> Rows:
    """Symmetric matrices by xx, xy, xz, yy, yz, zz, the means of both sides."""
    upper, lower = rows[:, SIX_OF_NINE], rows[:, MIRRORED_OF_NINE]
    most = ASYMMETRY * np.abs(rows).max(axis=1)
    require(name, rows, ~any_of(np.abs(upper - lower) > most[:, np.newaxis]), NOT_SYMMETRIC)
    return upper / 2.0 + lower / 2.0


def require(
    name: str, rows: NDArray[Any], good: NDArray[np.bool_], words: str, start: int = 0
) -> None:
    """Raises InvalidProblemError for the first row that is not good: `words` say what it is.

    start: which row of the user's the first is.
    """
    if not good.all():
        k = int(np.argmin(good))
        raise InvalidProblemError(
            f"{name} row {start + k} (counting from 0) {words}",
            array=name,
            row=start + k,
            value=rows[k].tolist(),
        )


def any_of(rows: NDArray[Any]) -> NDArray[np.bool_]:
    """(k,): whether a row has an entry that is not zero (False)."""
    return np.logical_or.reduce(rows.astype(bool), axis=1)
