"""The points of many problems, one after another, as loops in C take them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.problem.arrays import ATTRIBUTES, cloud_array, finite_doubles, real_numbers
from certreg.problem.row_labels import require_same_labels
from certreg.problem.support import NEUTRAL, PREFIXES
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ManyPairs(Brief):
    """Many problems: finite doubles, copied, and which rows are whose.

    source, target: (rows, 3); weights: (rows,), not negative, in each problem one above 0.
    sizes: (count,), the numbers of points. starts: (count, 3), the first rows of each problem in
        source, target and weights, where problems may share rows.
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    weights: NDArray[np.float64]
    sizes: NDArray[np.int64]
    starts: NDArray[np.int64]

    @classmethod
    def of(cls, sources: Any, targets: Any, weights: Any = None) -> ManyPairs:
        """Problems as `certreg.certify_many` takes them.

        Raises InvalidProblemError, which names the problem, counted from 0.
        """
        listed = _listed(sources, 2), _listed(targets, 2)
        pairs = zip(*listed, strict=False) if all(listed) else [(sources, targets)]
        for source, target in pairs:
            require_same_labels(source, target=target)
        forms = "(count, N, 3), or a list of (N, 3)"
        x, y = _rows_of(sources, "sources", 2, forms), _rows_of(targets, "targets", 2, forms)
        sizes = _common_sizes(x, y)
        w = _weights(1.0 if weights is None else weights, sizes)
        sizes = np.broadcast_to(sizes, max(len(sizes), len(w.sizes)))
        starts = [np.broadcast_to(part.starts, len(sizes)) for part in (x, y, w)]
        return cls(
            source=x.rows,
            target=y.rows,
            weights=w.rows,
            sizes=sizes,
            starts=np.column_stack(starts),
        )

    def __len__(self) -> int:
        return len(self.sizes)

    def of_one(self, number: int) -> tuple[NDArray[np.float64], ...]:
        """Source, target and weights of one problem."""
        size, (x, y, w) = self.sizes[number], self.starts[number]
        return self.source[x : x + size], self.target[y : y + size], self.weights[w : w + size]

    def data_bytes(self, number: int) -> bytes:
        """The bytes that state one problem, as those of a `RegistrationProblem`."""
        head = PREFIXES[NEUTRAL] + int(self.sizes[number]).to_bytes(8, "little")
        rows = (part.astype("<f8", copy=False).tobytes() for part in self.of_one(number))
        return b"".join((head, *rows))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Rows:
    """Rows of all problems, or of one that stands for all."""

    rows: NDArray[np.float64]
    sizes: NDArray[np.int64]

    @property
    def starts(self) -> NDArray[np.int64]:
        return np.cumsum(self.sizes) - self.sizes


def _listed(given: Sequence[Any] | NDArray[Any], depth: int) -> Sequence[Any]:
    """What is given one by one, in arrays so deep or in objects that hold points; else nothing."""
    if not isinstance(given, list | tuple) or not given:
        return ()
    held = any(hasattr(given[0], name) for name in (*ATTRIBUTES, "point", "columns"))
    return given if held or np.ndim(given[0]) == depth else ()


def _rows_of(given: Any, name: str, depth: int, forms: str) -> _Rows:
    """Points, in arrays two deep, or weights, in arrays one deep: of each problem, or of all."""
    listed = _listed(given, depth)
    if listed:
        read = cloud_array if depth == 2 else real_numbers
        return _joined([read(one, f"{name}[{k}]") for k, one in enumerate(listed)], name)
    array = real_numbers(given, name)
    array = array[np.newaxis] if array.ndim == depth else array
    if array.ndim != depth + 1 or array.shape[2:] not in {(), (3,)} or 0 in array.shape:
        raise InvalidProblemError(
            f"{name} have the shape {array.shape}: give {forms}", array=name, value=array.shape
        )
    sizes = np.full(len(array), array.shape[1], dtype=np.int64)
    return _Rows(rows=_finite(array.reshape(-1, *array.shape[2:]), sizes, name), sizes=sizes)


def _weights(given: Any, sizes: NDArray[np.int64]) -> _Rows:
    """Those of each problem, or of all; a number is that of as many points as the largest has."""
    if not _listed(given, 1) and np.ndim(given) == 0:
        given, sizes = np.broadcast_to(np.asarray(given), sizes.max()), np.array([sizes.max()])
    found = _rows_of(given, "weights", 1, "(count, N), (N,) or a number")
    counts = {len(found.sizes), len(sizes)} - {1}
    if len(counts) > 1 or (found.sizes != sizes).any():
        raise InvalidProblemError(
            f"weights are of {_shape(found.sizes)}, the clouds of {_shape(sizes)}",
            array="weights",
            value=len(found.sizes),
            limit=len(sizes),
        )
    return _counting(found)


def _counting(found: _Rows) -> _Rows:
    """Weights if they are not negative, and in each problem one counts."""
    least = np.minimum.reduceat(found.rows, found.starts)
    most = np.maximum.reduceat(found.rows, found.starts)
    wrong = (least < 0.0) | (most <= 0.0)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InvalidProblemError(
            f"the weights of problem {k} are not all >= 0, or all are zero",
            array="weights",
            instance=k,
            limit=0.0,
        )
    return found


def _joined(each: list[NDArray[Any]], name: str) -> _Rows:
    """Arrays one after another; of types that doubles do not hold, one is checked at a time."""
    sizes = np.array([len(one) for one in each], dtype=np.int64)
    if not sizes.all():
        k = int(np.argmin(sizes))
        raise InvalidProblemError(
            f"{name}[{k}] has no rows: at least one correspondence is needed",
            array=name,
            instance=k,
            value=0,
            limit=1,
        )
    doubles = [
        one if one.dtype == np.float64 else finite_doubles(one, f"{name}[{k}]")
        for k, one in enumerate(each)
    ]
    return _Rows(rows=_finite(np.concatenate(doubles), sizes, name), sizes=sizes)


def _finite(rows: NDArray[Any], sizes: NDArray[np.int64], name: str) -> NDArray[np.float64]:
    """Finite doubles, in memory. Raises InvalidProblemError, which names the problem."""
    try:
        return np.ascontiguousarray(finite_doubles(rows, name), dtype=np.float64)
    except InvalidProblemError as error:
        ends = np.cumsum(sizes)
        k = int(np.searchsorted(ends, error.row or 0, side="right"))
        finite_doubles(rows[ends[k] - sizes[k] : ends[k]], f"{name}[{k}]")
        raise


def _common_sizes(x: _Rows, y: _Rows) -> NDArray[np.int64]:
    """The sizes of all problems, the same in both clouds."""
    if len({len(x.sizes), len(y.sizes)} - {1}) > 1:
        raise InvalidProblemError(
            f"sources are of {len(x.sizes)} problems, targets of {len(y.sizes)}",
            array="targets",
            value=len(y.sizes),
            limit=len(x.sizes),
        )
    sizes, others = np.broadcast_arrays(x.sizes, y.sizes)
    if (sizes != others).any():
        k = int(np.argmax(sizes != others))
        raise InvalidProblemError(
            f"problem {k} has {sizes[k]} source points and {others[k]} target points: "
            "row i pairs with row i",
            array="targets",
            instance=k,
            value=int(others[k]),
            limit=int(sizes[k]),
        )
    return sizes


def _shape(sizes: NDArray[np.int64]) -> str:
    least, most = sizes.min(), sizes.max()
    points = f"{least}" if least == most else f"{least} to {most}"
    return f"{len(sizes)} problems of {points} points"
