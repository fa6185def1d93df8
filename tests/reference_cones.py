"""Forms that are positive on cones, in Python's integers: the same cuts as native/cones.c."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import combinations, combinations_with_replacement, pairwise
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.cones import (
    MONOMIALS,
    ORTHANTS,
    ConeSearch,
    ConesEnding,
    bernstein_on_orthants,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    Integers = Sequence[int]
    Vertex = Sequence[float]
    Chosen = Callable[[Integers], Integers]

PLACE: dict[tuple[int, ...], int] = {monomial: k for k, monomial in enumerate(MONOMIALS)}
CORNERS = itemgetter(*(PLACE[(k,) * 4] for k in range(4)))
MOST_CUTS, ROUND = 192, 8  # as in cones.h, cones.c
INSIDE = 1 - 2.0**-20  # the same: of a cap's sine
EDGES = 6


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
    """As `search_cones`, cone by cone, in the same integers."""
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
