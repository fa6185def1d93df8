"""Graphs whose rows are bits, and rows struck from them, by native/agreement.c and thinning.c."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import cached_property
from certreg.native.library import WRONG_PAIRS, little_library_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Words = NDArray[np.uint64]

WORD_BITS = 64


@dataclass(frozen=True, eq=False)
class BitRows:
    """A symmetric graph: of each row its neighbours, as bits.

    words: (n, words of a row), low first. A row is no neighbour of itself.
    """

    words: Words

    @classmethod
    def of_table(cls, table: NDArray[np.bool_]) -> BitRows:
        """Of which rows are neighbours, (n, n)."""
        n = len(table)
        packed = np.zeros((n, 8 * max(1, -(-n // WORD_BITS))), dtype=np.uint8)
        bits = np.packbits(table, axis=1, bitorder="little")
        packed[:, : bits.shape[1]] = bits
        return cls(packed.view("<u8"))

    def of_rows(self, rows: NDArray[np.int64]) -> BitRows:
        """The part of some rows, ascending."""
        if len(rows) == len(self):
            return self
        return BitRows.of_table(self.table[np.ix_(rows, rows)])

    def with_edges(self, pairs: Sequence[tuple[int, int]]) -> BitRows:
        """The same with more edges."""
        words = self.words.copy()
        for pair in pairs:
            for row, other in (pair, pair[::-1]):
                words[row, other // WORD_BITS] |= np.uint64(1) << np.uint64(other % WORD_BITS)
        return BitRows(words)

    def __len__(self) -> int:
        return len(self.words)

    def __getitem__(self, row: int) -> int:
        return self.integers[row]

    @cached_property
    def integers(self) -> list[int]:
        """The neighbours of each row as bits of an integer."""
        content, size = self.words.tobytes(), 8 * self.words.shape[1]
        ends = range(0, len(content), size)
        return [int.from_bytes(content[k : k + size], "little") for k in ends]

    @cached_property
    def table(self) -> NDArray[np.bool_]:
        """(n, n), which rows are neighbours."""
        n, given = len(self), self.words.view(np.uint8)
        return np.unpackbits(given, axis=1, bitorder="little", count=n).view(bool)


@dataclass(frozen=True, slots=True, eq=False)
class Agreeing:
    """Rows that agree in the lengths between them, and those that doubles leave open."""

    near: BitRows
    doubtful: BitRows

    @property
    def open_pairs(self) -> list[tuple[int, int]]:
        """Those that doubles leave open, each once."""
        if not self.doubtful.words.any():
            return []
        return [(i, j) for i, j in np.argwhere(np.triu(self.doubtful.table)).tolist()]


def agreeing(
    source: NDArray[np.float64], target: NDArray[np.float64], bounds: NDArray[np.float64]
) -> Agreeing:
    """Of points (n, 3), (n, 3) and bounds (n,), whose fourth powers are doubles.

    Raises MissingLibraryError where there is no compiled code.
    """
    library, n = little_library_for(WRONG_PAIRS), len(bounds)
    count = max(1, -(-n // WORD_BITS))
    columns = np.zeros((7, count * WORD_BITS))
    columns[:3, :n], columns[3:6, :n], columns[6, :n] = source.T, target.T, bounds
    found = np.empty((2, n, count), dtype=np.uint64)
    places = [ctypes.c_void_p(array.ctypes.data) for array in (columns, *found)]
    library.handle.certreg_agreeing(ctypes.c_int64(n), ctypes.c_int64(count), *places)
    return Agreeing(*map(BitRows, found))


@dataclass(frozen=True, slots=True)
class OpenRow:
    """A row that falls if more than `spare` rows of the clique beside it must be left out.

    Itself, the others beside it and one row of each colour of its other neighbours, as these get
    them, are fewer than `least` then.
    """

    row: int
    spare: int


class _State(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_int64) for name in ("rows", "words", "least", "count")),
        *((name, ctypes.c_int64) for name in ("tried", "next", "spare")),
        *((name, ctypes.c_void_p) for name in ("near", "clique", "alive", "masks")),
        *((name, ctypes.c_void_p) for name in ("degrees", "failed", "order", "queue")),
    )


class Thinned:
    """Rows left of a graph of which each has `least` - 1 neighbours, by native/thinning.c."""

    def __init__(self, near: BitRows, alive: int, least: int, clique: int) -> None:
        """alive: the rows to begin with, as bits. clique: rows that colours do not strike.

        Raises MissingLibraryError where there is no compiled code.
        """
        handle = little_library_for(WRONG_PAIRS).handle
        n, words = near.words.shape
        size = 8 * words
        masks = [clique.to_bytes(size, "little"), alive.to_bytes(size, "little"), bytes(2 * size)]
        self._handle, self._words = handle, near.words
        self._masks = np.frombuffer(bytearray(b"".join(masks)), dtype=np.uint64)
        self._numbers = np.empty((5, n), dtype=np.int64)
        start, places = self._masks.ctypes.data, self._numbers.ctypes.data
        self._state = _State(
            *(n, words, least, *[0] * 4, self._words.ctypes.data),
            *(start + k * size for k in range(3)),
            *(places + 8 * k * n for k in range(4)),
        )
        self._pointer, self._given = ctypes.byref(self._state), near
        handle.certreg_thin(self._pointer)

    @property
    def near(self) -> BitRows:
        """The graph, without the pairs that were cut."""
        given = self._given
        return given if self._words is given.words else BitRows(self._words.copy())

    @property
    def alive(self) -> int:
        """The rows left, as bits."""
        words = self._state.words
        return int.from_bytes(self._masks[words : 2 * words].tobytes(), "little")

    def beside(self, row: int) -> int:
        """The neighbours of a row that are left, as bits."""
        words = self._state.words
        mask = self._words[row] & self._masks[words : 2 * words]
        return int.from_bytes(mask.tobytes(), "little")

    def strike(self, row: int) -> None:
        """Strikes a row, and then those with too few neighbours."""
        self._handle.certreg_strike(self._pointer, ctypes.c_int64(row))

    def cut(self, row: int, other: int) -> None:
        """Two neighbours are none any more; then rows with too few neighbours are struck."""
        if self._words is self._given.words:  # it is not this one's to be changed
            self._words = self._words.copy()
            self._state.near = self._words.ctypes.data
        self._handle.certreg_cut(self._pointer, ctypes.c_int64(row), ctypes.c_int64(other))

    def strike_by_colours(self) -> list[int]:
        """Strikes rows whose neighbours take fewer than `least` - 1 colours, until none falls.

        Those with few neighbours first; not those of the clique, nor where too few are left.
        """
        struck = self._numbers[4]
        place = ctypes.c_void_p(struck.ctypes.data)
        count: int = self._handle.certreg_strike_by_colours(self._pointer, place)
        return struck[:count].tolist()

    def open_rows(self) -> Iterator[OpenRow]:
        """Rows that fall if enough of the clique beside each must be left out.

        Those with few neighbours first, while enough are left; some may be struck on the way.
        """
        self._handle.certreg_begin(self._pointer)
        while (row := self._handle.certreg_next(self._pointer)) >= 0:
            yield OpenRow(row, self._state.spare)

    def colours(self, rows: int, most: int) -> int:
        """How many colours rows take, as bits, as neighbours have different ones; or most + 1."""
        words = self._state.words
        given = np.frombuffer(rows.to_bytes(8 * words, "little"), "<u8")
        self._masks[2 * words : 3 * words] = given
        return self._handle.certreg_colours(self._pointer, ctypes.c_int64(most))


def rows_of(mask: int) -> Iterator[int]:
    """The places of the ones."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def mask_of(rows: Sequence[int]) -> int:
    """The inverse of `rows_of`."""
    mask = 0
    for row in rows:
        mask |= 1 << row
    return mask


def colours(rows: int, near: Sequence[int], most: int) -> int:
    """How many colours the rows take, the lowest first; or one more than `most`.

    A colour is given to the lowest row without one, then to every later row that is no neighbour
    of those that have it. The checker colours alike, so that it finds no more.
    """
    count = 0
    while rows and count <= most:
        count += 1
        free = rows
        while free:
            low = free & -free
            rows ^= low
            free &= ~(near[low.bit_length() - 1] | low)
    return count
