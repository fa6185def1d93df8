"""Whether a form of degree four in four variables is positive outside of caps, by native/cones.c.

Where there is no compiled code the same cones are cut in Python's integers, a hundred times slower.
"""

from __future__ import annotations

import ctypes
import enum
from dataclasses import dataclass
from functools import cache
from itertools import combinations, combinations_with_replacement, pairwise, product
from math import factorial, gcd, prod
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.library import little_library

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from certreg.native.library import Library

    Integers = Sequence[int]
    Vertex = Sequence[float]
    Chosen = Callable[[Integers], Integers]

MONOMIALS = tuple(combinations_with_replacement(range(4), 4))
PLACE: dict[tuple[int, ...], int] = {monomial: k for k, monomial in enumerate(MONOMIALS)}
CORNERS = itemgetter(*(PLACE[(k,) * 4] for k in range(4)))
OVER_MULTINOMIALS = [prod(factorial(m.count(k)) for k in range(4)) for m in MONOMIALS]  # 24 over
ORTHANTS = tuple((1, *signs[::-1]) for signs in product((1, -1), repeat=3))  # bit k: e_(k+1)
SIGNS = tuple(tuple(prod(signs[k] for k in m) for m in MONOMIALS) for signs in ORTHANTS)
COEFFICIENT_BITS = 124  # the bend of three fits in 128; as in the checker
WORD_BYTES = 16
MOST_CUTS, ROUND = 192, 8  # as in cones.h, cones.c
INSIDE = 1 - 2.0**-20  # the same: of a cap's sine
EDGES = 6


class ConesEnding(enum.Enum):
    """How a search ended, in the order of the enum of cones.h."""

    POSITIVE = "positive outside of the caps"
    NOT_POSITIVE = "not positive at a point outside of the caps"
    BUDGET = "more cones than allowed"
    DEEP = "a cone became too small"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConeSearch:
    """What a search found: a proposal, as caps and vertices are in doubles.

    seen: cones looked at. deepest: cuts of the smallest one. vertex: where the form is not
    positive, if that is how it ended.
    """

    ending: ConesEnding
    seen: int
    deepest: int
    vertex: tuple[float, ...] | None = None


class _Search(ctypes.Structure):
    _fields_ = (
        ("orthants", ctypes.c_char_p),
        ("caps", ctypes.c_void_p),
        ("cap_count", ctypes.c_int64),
        ("budget", ctypes.c_int64),
        ("seen", ctypes.c_int64),
        ("deepest", ctypes.c_int64),
        ("vertex", ctypes.c_double * 4),
    )


def search_cones(quartic: Integers, caps: NDArray[np.float64], *, budget: int) -> ConeSearch:
    """Look for a cover by cones on each of which the form is positive, or which lie in a cap.

    quartic: its 35 coefficients, without multinomials. caps: (k, 5), a unit vector each and the
    squared sine of the angle that the cap reaches to.
    """
    library = little_library()
    found = None if library is None else search_compiled(library, quartic, caps, budget)
    return found or search_in_python(quartic, caps, budget)


def search_compiled(
    library: Library, quartic: Integers, caps: NDArray[np.float64], budget: int
) -> ConeSearch | None:
    """By native/cones.c; None where it has no integers of 128 bits."""
    rows = bernstein_on_orthants(quartic)
    words = [entry.to_bytes(WORD_BYTES, "little", signed=True) for row in rows for entry in row]
    given = np.ascontiguousarray(caps, dtype=float).reshape(-1, 5)
    search = _Search(b"".join(words), given.ctypes.data, len(given), budget)
    number: int = library.handle.certreg_cones(ctypes.byref(search))
    if number == len(ConesEnding):
        return None
    ending = list(ConesEnding)[number]
    vertex = tuple(search.vertex) if ending is ConesEnding.NOT_POSITIVE else None
    return ConeSearch(ending=ending, seen=search.seen, deepest=search.deepest, vertex=vertex)


def bernstein_on_orthants(quartic: Integers) -> list[list[int]]:
    """8 x 35: Bernstein coefficients on each orthant, over a common factor and rounded down."""
    common = [entry * factor for entry, factor in zip(quartic, OVER_MULTINOMIALS, strict=True)]
    shared = gcd(*quartic) or 1
    common = [entry // shared for entry in common]
    places = max(entry.bit_length() for entry in common) - COEFFICIENT_BITS
    common = [entry << max(-places, 0) for entry in common]
    return [
        [sign * entry >> max(places, 0) for sign, entry in zip(signs, common, strict=True)]
        for signs in SIGNS
    ]


@dataclass(frozen=True, slots=True)
class _Cone:
    """Bernstein coefficients, vertices, how often it was cut."""

    bernstein: Integers
    vertices: tuple[Vertex, ...]
    cuts: int


@dataclass(frozen=True, slots=True)
class _Edge:
    """Of an edge v_i, v_j: which means come next, and which are the coefficients of the halves.

    along: places of the coefficients of s_i^4, s_i^3 s_j, ..., s_j^4.
    """

    i: int
    j: int
    means: tuple[tuple[int, int], ...]
    without_j: Chosen
    without_i: Chosen
    along: tuple[int, ...]


def search_in_python(quartic: Integers, caps: NDArray[np.float64], budget: int) -> ConeSearch:
    """The same, cone by cone, in the same integers."""
    rows = bernstein_on_orthants(quartic)
    held = [tuple(row) for row in np.reshape(caps, (-1, 5)).tolist()]
    waiting = [_Cone(row, _corners(signs), 0) for row, signs in zip(rows, ORTHANTS, strict=True)]
    waiting.reverse()
    seen = deepest = 0
    while waiting:
        cone = waiting.pop()
        seen, deepest = seen + 1, max(deepest, cone.cuts)
        if seen > budget:
            return ConeSearch(ending=ConesEnding.BUDGET, seen=seen, deepest=deepest)
        if min(cone.bernstein) > 0 or any(_holds(cap, cone.vertices) for cap in held):
            continue
        for value, vertex in zip(CORNERS(cone.bernstein), cone.vertices, strict=True):
            if value <= 0 and not any(_holds(cap, (vertex,)) for cap in held):
                ending, point = ConesEnding.NOT_POSITIVE, tuple(vertex)
                return ConeSearch(ending=ending, seen=seen, deepest=deepest, vertex=point)
        if cone.cuts == MOST_CUTS:
            return ConeSearch(ending=ConesEnding.DEEP, seen=seen, deepest=deepest)
        waiting += _halves(cone)
    return ConeSearch(ending=ConesEnding.POSITIVE, seen=seen, deepest=deepest)


def _corners(signs: tuple[int, ...]) -> tuple[Vertex, ...]:
    return tuple([float(sign * (i == k)) for i in range(4)] for k, sign in enumerate(signs))


def _holds(cap: tuple[float, ...], vertices: tuple[Vertex, ...]) -> bool:
    """Whether all vertices lie in the cap, or all in its mirror image."""
    *centre, sine = cap
    side = 0.0
    for vertex in vertices:
        along = sum(a * b for a, b in zip(vertex, centre, strict=True))
        across = sum(
            (vertex[a] * centre[b] - vertex[b] * centre[a]) ** 2
            for a, b in combinations(range(4), 2)
        )
        side = side or along
        inside = across <= INSIDE * sine * sum(a * a for a in vertex)
        if not (inside and (along * side > 0 or len(vertices) == 1)):
            return False
    return True


def _halves(cone: _Cone) -> Iterator[_Cone]:
    """Both halves, cut at the edge along which the coefficients bend most; or which is due."""
    b, cuts = cone.bernstein, cone.cuts
    turn = cuts // ROUND % EDGES
    if cuts % ROUND != ROUND - 1:
        bends = [_bend([b[k] for k in edge.along]) for edge in _edges()]
        turn = bends.index(max(bends))
    edge = _edges()[turn]
    means = list(b)
    for first, second in edge.means:
        means.append((means[first] + means[second]) >> 1)
    ends = zip(cone.vertices[edge.i], cone.vertices[edge.j], strict=True)
    middle = [(a + b) / 2 for a, b in ends]
    for half, out in ((edge.without_j, edge.j), (edge.without_i, edge.i)):
        vertices = (*cone.vertices[:out], middle, *cone.vertices[out + 1 :])
        yield _Cone(half(means), vertices, cuts + 1)


def _bend(row: Integers) -> int:
    return max(abs(a - 2 * b + c) for a, b, c in zip(row[:-2], row[1:-1], row[2:], strict=True))


@cache
def _edges() -> tuple[_Edge, ...]:
    return tuple(_edge(i, j) for i, j in combinations(range(4), 2))


def _edge(i: int, j: int) -> _Edge:
    count = len(MONOMIALS)
    left, right, means = [0] * count, [0] * count, list[tuple[int, int]]()
    row: list[int] = []
    others = [k for k in range(4) if k not in (i, j)]
    for degree in range(5):
        for rest in combinations_with_replacement(others, 4 - degree):
            powers = [(i,) * (degree - k) + (j,) * k for k in range(degree + 1)]
            row = [PLACE[tuple(sorted(rest + some))] for some in powers]
            level = row
            for k in range(degree + 1):
                left[row[k]], right[row[degree - k]] = level[0], level[-1]
                first = count + len(means)
                means += pairwise(level)
                level = list(range(first, first + degree - k))
    chosen = itemgetter(*left), itemgetter(*right)
    return _Edge(i, j, tuple(means), *chosen, tuple(row))
