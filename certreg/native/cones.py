"""Whether a form of degree four in four variables is positive outside of caps, by native/cones.c.

Where there is no compiled code NumPy cuts the same cones in the same integers, level by level.
"""

from __future__ import annotations

import ctypes
import enum
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement, product
from math import factorial
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.library import library_if_any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.native.library import Library

Array = Any  # NDArray
MONOMIALS = tuple(combinations_with_replacement(range(4), 4))
PLACE: dict[tuple[int, ...], int] = {monomial: k for k, monomial in enumerate(MONOMIALS)}
VERTICES = [PLACE[(k,) * 4] for k in range(4)]
EDGES = tuple(combinations(range(4), 2))
ORTHANTS = tuple((1, *signs[::-1]) for signs in product((1, -1), repeat=3))  # bit k: e_(k+1)
COEFFICIENT_BITS = 60  # two of them and the bend of three fit in 64
MOST_CUTS, ROUND = 128, 8  # as in cones.h, cones.c
INSIDE = 1 - 2.0**-20  # the same: of a cap's sine
CHUNK = 1 << 14  # cones looked at together: some 10 MB


class ConesEnding(enum.Enum):
    """How a search ended, in the order of the enum of cones.h."""

    POSITIVE = "positive outside of the caps"
    NOT_POSITIVE = "not positive at a point outside of the caps"
    BUDGET = "more cones than allowed"
    DEEP = "a cone became too small for these integers"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConeSearch:
    """What a search found: a proposal, of integers of 60 bits and caps in doubles.

    seen: cones looked at. deepest: cuts of the smallest one. vertex: where the form is not
    positive, if that is how it ended.
    """

    ending: ConesEnding
    seen: int
    deepest: int
    vertex: tuple[float, ...] | None = None


class _Search(ctypes.Structure):
    _fields_ = (
        ("orthants", ctypes.c_void_p),
        ("caps", ctypes.c_void_p),
        ("cap_count", ctypes.c_int64),
        ("budget", ctypes.c_int64),
        ("seen", ctypes.c_int64),
        ("deepest", ctypes.c_int64),
        ("vertex", ctypes.c_double * 4),
    )


def search_cones(quartic: Sequence[int], caps: NDArray[np.float64], *, budget: int) -> ConeSearch:
    """Look for a cover by cones on each of which the form is positive, or which lie in a cap.

    quartic: its 35 coefficients, without multinomials. caps: (k, 5), a unit vector each and the
    squared sine of the angle that the cap reaches to.
    """
    orthants = bernstein_on_orthants(quartic)
    caps = np.ascontiguousarray(caps, dtype=float).reshape(-1, 5)
    library = library_if_any()
    if library is None:
        return search_by_level(orthants, caps, budget)
    return search_compiled(library, orthants, caps, budget)


def search_compiled(library: Library, orthants: Array, caps: Array, budget: int) -> ConeSearch:
    """By native/cones.c; orthants: contiguous, as of `bernstein_on_orthants`."""
    search = _Search(orthants.ctypes.data, caps.ctypes.data, len(caps), budget)
    number: int = library.handle.certreg_cones(ctypes.byref(search))
    ending = list(ConesEnding)[number]
    vertex = tuple(search.vertex) if ending is ConesEnding.NOT_POSITIVE else None
    return ConeSearch(ending=ending, seen=search.seen, deepest=search.deepest, vertex=vertex)


def bernstein_on_orthants(quartic: Sequence[int]) -> NDArray[np.int64]:
    """(8, 35): Bernstein coefficients on each orthant, over a power of two and rounded down."""
    common = [entry * (24 // _multinomial(m)) for entry, m in zip(quartic, MONOMIALS, strict=True)]
    places = max(entry.bit_length() for entry in common) - COEFFICIENT_BITS
    scaled = [entry << max(-places, 0) for entry in common]
    rows = [
        [
            int(np.prod([signs[k] for k in m])) * entry >> max(places, 0)
            for entry, m in zip(scaled, MONOMIALS, strict=True)
        ]
        for signs in ORTHANTS
    ]
    return np.array(rows, dtype=np.int64)


def _multinomial(monomial: tuple[int, ...]) -> int:
    counts = [factorial(monomial.count(k)) for k in range(4)]
    return factorial(4) // (counts[0] * counts[1] * counts[2] * counts[3])


def _rows(edge: tuple[int, int]) -> list[list[int]]:
    """Places of the coefficients along an edge, its second vertex with the powers 0, 1, ..."""
    i, j = edge
    others = [k for k in range(4) if k not in edge]
    return [
        [
            PLACE[tuple(sorted((*rest, *(i,) * (degree - power), *(j,) * power)))]
            for power in range(degree + 1)
        ]
        for degree in range(5)
        for rest in combinations_with_replacement(others, 4 - degree)
    ]


ROWS = tuple(_rows(edge) for edge in EDGES)  # the last row is of no other vertex


@dataclass(frozen=True, slots=True, eq=False)
class _Cones:
    """Some cones: Bernstein coefficients (k, 35), vertices (k, 4, 4), how often each was cut."""

    bernstein: Array
    vertices: Array
    cuts: Array

    def __len__(self) -> int:
        return len(self.cuts)

    def part(self, chosen: Array) -> _Cones:
        return _Cones(self.bernstein[chosen], self.vertices[chosen], self.cuts[chosen])

    @classmethod
    def joined(cls, parts: list[_Cones]) -> _Cones:
        return cls(
            np.concatenate([part.bernstein for part in parts]),
            np.concatenate([part.vertices for part in parts]),
            np.concatenate([part.cuts for part in parts]),
        )


def search_by_level(orthants: Array, caps: Array, budget: int) -> ConeSearch:
    """The same in NumPy; the last cones that were made are looked at first, many at a time."""
    vertices = np.array([np.diag(signs) for signs in ORTHANTS], dtype=float)
    waiting = [_Cones(orthants, vertices, np.zeros(len(ORTHANTS), dtype=np.int64))]
    seen = deepest = 0
    while waiting:
        cones = waiting.pop()
        seen, deepest = seen + len(cones), max(deepest, int(cones.cuts.max()))
        if seen > budget:
            return ConeSearch(ending=ConesEnding.BUDGET, seen=budget, deepest=deepest)
        cones = cones.part(cones.bernstein.min(axis=1) <= 0)
        inside, along = _inside(cones.vertices, caps)
        same = np.all(along * along[:, :1] > 0, axis=1)
        left = ~np.any(np.all(inside, axis=1) & same, axis=1)
        bare = (cones.bernstein[:, VERTICES] <= 0) & ~np.any(inside, axis=2) & left[:, np.newaxis]
        if bare.any():
            vertex = tuple(cones.vertices[tuple(np.argwhere(bare)[0])].tolist())
            ending = ConesEnding.NOT_POSITIVE
            return ConeSearch(ending=ending, seen=seen, deepest=deepest, vertex=vertex)
        cones = cones.part(left)
        if not len(cones):
            continue
        if int(cones.cuts.max()) == MOST_CUTS:
            return ConeSearch(ending=ConesEnding.DEEP, seen=seen, deepest=deepest)
        halves = _halves(cones)
        waiting += [halves.part(slice(k, k + CHUNK)) for k in range(0, len(halves), CHUNK)]
    return ConeSearch(ending=ConesEnding.POSITIVE, seen=seen, deepest=deepest)


def _inside(vertices: Array, caps: Array) -> tuple[Array, Array]:
    """(k, 4, caps): whether a vertex lies in a cap or its mirror image; its product with it."""
    centres, sines = caps[:, :4], caps[:, 4]
    along = vertices @ centres.T
    across = [
        vertices[..., a, None] * centres[:, b] - vertices[..., b, None] * centres[:, a]
        for a, b in EDGES
    ]
    squares = (vertices**2).sum(axis=2)[..., None]
    return np.sum(np.square(across), axis=0) <= INSIDE * sines * squares, along


def _halves(cones: _Cones) -> _Cones:
    """Both halves of each cone, cut at the edge along which the coefficients bend most."""
    ends = cones.bernstein[:, [rows[-1] for rows in ROWS]]
    bends: Array = np.abs(ends[..., :-2] - 2 * ends[..., 1:-1] + ends[..., 2:]).max(axis=2)
    turn: Array = bends.argmax(axis=1)
    due = cones.cuts % ROUND == ROUND - 1
    turn[due] = cones.cuts[due] // ROUND % len(EDGES)
    parts: list[_Cones] = []
    for k in range(len(EDGES)):
        some = cones.part(turn == k)
        if len(some):
            parts += _cut(some, k)
    return _Cones.joined(parts)


def _cut(cones: _Cones, edge: int) -> list[_Cones]:
    left, right = cones.bernstein.copy(), cones.bernstein.copy()
    for places in ROWS[edge]:
        b = cones.bernstein[:, places]
        for level, place in enumerate(places):
            left[:, place] = b[:, 0]
            right[:, places[len(places) - 1 - level]] = b[:, -1]
            b = (b[:, :-1] + b[:, 1:]) >> 1
    i, j = EDGES[edge]
    middle = (cones.vertices[:, i] + cones.vertices[:, j]) / 2
    without_j, without_i = cones.vertices.copy(), cones.vertices.copy()
    without_j[:, j] = without_i[:, i] = middle
    return [
        _Cones(left, without_j, cones.cuts + 1),
        _Cones(right, without_i, cones.cuts + 1),
    ]
