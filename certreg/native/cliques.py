"""Cliques of graphs whose rows are bits, by native/cliques.c.

All raise MissingLibraryError where there is no compiled code.
"""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.library import WRONG_PAIRS, little_library_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.native.bitset_graph import BitRows

    Rows = NDArray[np.int64]


def triangles(near: BitRows, alive: int) -> Rows:
    """Twice how many triangles each row is of, (n,), among those that are alive, as bits."""
    library = little_library_for(WRONG_PAIRS)
    counts = np.zeros(len(near), dtype=np.int64)
    mask = _words(near, alive)
    library.handle.certreg_triangles(*_given(near, mask), ctypes.c_void_p(counts.ctypes.data))
    return counts


def greedy_clique(near: BitRows, alive: int, row: int) -> Rows:
    """A clique that holds a row: the neighbour of most that are left is taken, again and again."""
    library = little_library_for(WRONG_PAIRS)
    masks, numbers = _words(near, alive, 0), np.empty((2, len(near) + 1), dtype=np.int64)
    numbers[0, 0] = row
    taken: int = library.handle.certreg_greedy_clique(
        *_given(near, masks),
        ctypes.c_int64(row),
        ctypes.c_void_p(numbers.ctypes.data + numbers.itemsize),
        ctypes.c_void_p(numbers[1].ctypes.data),
        ctypes.c_void_p(masks[1].ctypes.data),
    )
    return np.sort(numbers[0, : taken + 1])


class _Search(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_int64) for name in ("words", "size", "depth", "steps", "dear")),
        *((name, ctypes.c_void_p) for name in ("near", "left", "path")),
    )


class CliqueEnumeration:
    """All cliques of a size, of all rows of the graph, some at a time.

    dear: the steps of a clique, beside those of the search.
    """

    def __init__(self, near: BitRows, size: int, steps: int, dear: int) -> None:
        self._handle = little_library_for(WRONG_PAIRS).handle
        self._near, self._size = near, size
        self._left = np.empty((size, near.words.shape[1]), dtype=np.uint64)
        self._left[0] = _words(near, (1 << len(near)) - 1)
        self._path = np.empty(size, dtype=np.int64)
        places = [array.ctypes.data for array in (near.words, self._left, self._path)]
        self._state = _Search(near.words.shape[1], size, 0, steps, dear, *places)

    @property
    def steps(self) -> int:
        """Those left; below 0 the enumeration has ended before all were found."""
        return self._state.steps

    def some(self, most: int) -> Rows:
        """The next cliques, (up to so many, size); none: there are no more, or steps."""
        found = np.empty((most, self._size), dtype=np.int64)
        count: int = self._handle.certreg_cliques(
            ctypes.byref(self._state), ctypes.c_int64(most), ctypes.c_void_p(found.ctypes.data)
        )
        return found[:count]


def _words(near: BitRows, *masks: int) -> NDArray[np.uint64]:
    size = 8 * near.words.shape[1]
    content = b"".join([mask.to_bytes(size, "little") for mask in masks])
    return np.frombuffer(bytearray(content), dtype=np.uint64).reshape(len(masks), -1)


def _given(near: BitRows, masks: NDArray[np.uint64]) -> list[Any]:
    """What the functions in C begin with."""
    words, place = near.words, ctypes.c_void_p
    return [ctypes.c_int64(words.shape[1]), place(words.ctypes.data), place(masks.ctypes.data)]
