"""Which pairs of points agree with each other, and sets of rows that all do.

Two rows may lie within their bounds at one pose only if the lengths between their points differ by
no more than both bounds together. Rows of one pose are a clique of that graph: large cliques are
where poses with many rows begin.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.bitset_graph import BitRows, Thinned, agreeing, rows_of
from certreg.native.cliques import CliqueEnumeration, greedy_clique, triangles

if TYPE_CHECKING:
    from certreg.relaxation.paired_rows import PairedRows, Rows

FIT_STEPS = 32  # of an enumeration, and two a row: what it takes to see whether a clique fits


def consistency(pairs: PairedRows) -> BitRows:
    """Which rows agree in the length between them, or nearly so. No row agrees with itself."""
    found = agreeing(pairs.source.T, pairs.target.T, pairs.bounds)
    return BitRows(found.near.words | found.doubtful.words)


def core(near: BitRows, degree: int) -> int:
    """The rows, as bits, that are left once none has fewer neighbours left than `degree`."""
    return Thinned(near, (1 << len(near)) - 1, degree + 1, 0).alive


def greedy_cliques(near: BitRows, alive: int) -> Iterator[Rows]:
    """Large cliques, begun at rows of most triangles that are in no clique so far."""
    rows = np.array(list(rows_of(alive)), dtype=np.int64)
    covered = np.zeros(len(near), dtype=bool)
    for seed in rows[np.argsort(-triangles(near, alive)[rows], kind="stable")].tolist():
        if not covered[seed]:
            clique = greedy_clique(near, alive, seed)
            covered[clique] = True
            yield clique


@dataclass(slots=True, eq=False)
class CliqueSearch:
    """All cliques of some size, as far as the steps last.

    steps: left; below 0 the last enumeration is not complete.
    """

    steps: int

    def of_size(self, near: BitRows, alive: int, size: int, batch: int) -> Iterator[Rows]:
        """Each clique of `size` rows that are alive once, (up to `batch`, size) at a time."""
        rows = np.array(list(rows_of(alive)), dtype=np.int64)
        part = near.table[np.ix_(rows, rows)]
        order = np.argsort(part.sum(axis=1), kind="stable")  # poor rows first: short branches
        part = BitRows.of_table(part[np.ix_(order, order)])
        search = CliqueEnumeration(part, size, self.steps, FIT_STEPS + 2 * size)
        while len(found := search.some(batch)):
            self.steps = search.steps
            yield rows[order[found]]
        self.steps = search.steps
