"""Small graphs of pairs, all of them: what a rule strikes, and whether it strikes too much.

A set of vertices is an integer, vertex i its bit i; a graph is the list of the neighbours of each.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, product

from certreg.verify import Thinning

SIZE = 5  # 1024 graphs
EVERY = (1 << SIZE) - 1
LOOKS = 1000  # more than the checker takes at such graphs
Graph = Sequence[int]
Rule = Callable[[Graph, int, int], int]  # the graph, the vertices left, K; those left then


def graphs() -> Iterator[list[int]]:
    """All graphs with the vertices 0, ..., SIZE - 1."""
    places = list(combinations(range(SIZE), 2))
    for chosen in product((False, True), repeat=len(places)):
        yield graph([place for place, there in zip(places, chosen, strict=True) if there])


def graph(edges: Sequence[tuple[int, int]], size: int = SIZE) -> list[int]:
    """The graph with these edges."""
    near = [0] * size
    for i, j in edges:
        near[i] |= 1 << j
        near[j] |= 1 << i
    return near


def members(vertices: int) -> list[int]:
    """The vertices of a set, ascending."""
    return [i for i in range(vertices.bit_length()) if vertices >> i & 1]


def is_clique(near: Graph, vertices: int) -> bool:
    """Whether any two of the vertices are neighbours."""
    return all(vertices & ~(near[i] | 1 << i) == 0 for i in members(vertices))


def lost(rule: Rule) -> tuple[int, int]:
    """How many cliques of at least K vertices a rule damages, and how many vertices it strikes.

    Of all graphs, for K = 3, 4, 5.
    """
    damaged = struck = 0
    for near, K in product(graphs(), (3, 4, 5)):
        gone = EVERY & ~rule(near, EVERY, K)
        struck += gone.bit_count()
        if gone:
            sets = (s for s in range(1, EVERY + 1) if s & gone and s.bit_count() >= K)
            damaged += sum(is_clique(near, s) for s in sets)
    return damaged, struck


def kept(near: Graph, alive: int, K: int, steps: Sequence[object] = ()) -> int:
    """What the checker leaves of a graph after steps without groups: rows are not looked at.

    Raises certreg.verify.RefusalError for a step that strikes too much.
    """
    rows = [[0]] * len(near)
    return Thinning(rows, [*near], alive, K, [LOOKS]).after([*steps])


def thinned(near: Graph, alive: int, strikes: Callable[[int, int], bool]) -> int:
    """The vertices left if one after another is struck that is said to be, of those that are left.

    strikes: of a vertex and its neighbours that are left.
    """
    while True:
        gone = next((i for i in members(alive) if strikes(i, near[i] & alive)), None)
        if gone is None:
            return alive
        alive &= ~(1 << gone)
