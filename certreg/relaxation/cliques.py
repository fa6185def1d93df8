"""Which pairs of points agree with each other, and sets of rows that all do.

Two rows may lie within their bounds at one pose only if the lengths between their points differ by
no more than both bounds together. Rows of one pose are a clique of that graph: large cliques are
where poses with many rows begin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from certreg.relaxation.paired_rows import PairedRows, Rows

    Graph = NDArray[np.bool_]

ROUNDING = 1e-9  # of the bounds: an edge on the boundary is kept
BLOCK = 1 << 18  # entries of the graph that are computed at a time: they stay in the cache
FIT_STEPS = 32  # of an enumeration, and two a row: what it takes to see whether a clique fits
SAMPLED = 512  # rows by which triangles are counted where there are more


def consistency(pairs: PairedRows) -> Graph:
    """(N, N): which rows agree in the length between them. No row agrees with itself."""
    count = len(pairs)
    graph = np.empty((count, count), dtype=bool)
    height = max(1, BLOCK // count)
    for first in range(0, count, height):
        rows = slice(first, first + height)
        lengths = [_lengths(points, rows) for points in (pairs.source, pairs.target)]
        slack = (1.0 + ROUNDING) * (pairs.bounds[rows, np.newaxis] + pairs.bounds)
        graph[rows] = np.abs(lengths[0] - lengths[1]) <= slack
    np.fill_diagonal(graph, val=False)
    return graph


def _lengths(points: NDArray[np.float64], rows: slice) -> NDArray[np.float64]:
    squares = sum((axis[rows, np.newaxis] - axis) ** 2 for axis in points)
    return np.sqrt(squares)


def core(graph: Graph, degree: int) -> Rows:
    """The rows that are left when rows with fewer neighbours left than `degree` are taken away."""
    rows = np.arange(len(graph))
    part = graph
    while len(rows):
        kept = np.count_nonzero(part, axis=1) >= degree
        if kept.all():
            break
        rows, part = rows[kept], part[np.ix_(kept, kept)]
    return rows


def greedy_clique(graph: Graph, row: int) -> Rows:
    """A clique that holds a row: the neighbour of most that are left is taken, again and again."""
    clique = [row]
    rows = np.flatnonzero(graph[row])
    part = graph[np.ix_(rows, rows)]
    links = part.astype(np.float32)
    counts = links.sum(axis=1)
    left = np.ones(len(rows), dtype=bool)
    while left.any():
        best = int(np.where(left, counts, -1.0).argmax())
        clique.append(int(rows[best]))
        gone = np.flatnonzero(left & ~part[best])
        left &= part[best]
        counts -= links[gone].sum(axis=0)  # each row goes once
    return np.sort(np.array(clique))


def triangles(graph: Graph, rng: np.random.Generator) -> NDArray[np.float32]:
    """How many triangles each row is of, (N,), up to a factor; of a large graph by a sample."""
    links = graph.astype(np.float32)
    some = links
    if len(graph) > SAMPLED:
        some = links[:, rng.choice(len(graph), SAMPLED, replace=False)]
    return np.einsum("ij,ij->i", links @ some, some)


@dataclass(slots=True, eq=False)
class CliqueSearch:
    """All cliques of some size, as far as the steps last.

    steps: left; below 0 the last enumeration is not complete.
    """

    steps: int

    def of_size(self, graph: Graph, size: int) -> Iterator[list[int]]:
        """Each clique of `size` rows once, without recursion: it may have a thousand."""
        order = np.argsort(graph.sum(axis=1), kind="stable")  # poor rows first: short branches
        packed = np.packbits(graph[np.ix_(order, order)], axis=1, bitorder="little")
        neighbours = [int.from_bytes(row.tobytes(), "little") for row in packed]
        path: list[int] = []
        left = [(1 << len(graph)) - 1]  # after each row of the path: which rows may follow
        while left:
            self.steps -= 1
            if self.steps < 0:
                return
            missing = size - len(path)
            if left[-1].bit_count() < missing:
                left.pop()
                if path:
                    path.pop()
                continue
            first = (left[-1] & -left[-1]).bit_length() - 1
            left[-1] ^= 1 << first
            if missing == 1:
                self.steps -= FIT_STEPS + 2 * size
                yield order[[*path, first]].tolist()
                continue
            path.append(first)
            left.append(left[-1] & neighbours[first])
