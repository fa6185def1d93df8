"""At most four equilibria, by the rank of one 10x10 integer matrix, proved modulo a prime.

The six torque quadratics and the four products q_i (a . q) are ten quadratic forms in q, which has
ten quadratic monomials. If their coefficients have rank ten, every quadratic monomial is a
combination of them. So on the solutions with a . q = 1 every q_i q_j is linear in q, the quotient
ring is spanned by the four q_i, and there are at most four solutions, complex ones and
multiplicities included; and a solution with a . q = 0 has all q_i q_j = 0, it is none. The rank is
ten over Q if it is ten modulo any prime: a determinant that is not zero modulo p is not zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg._loading import library
from certreg.equilibrium.torques import COLUMNS, torque_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.equilibrium.torques import Table

CHARTS = 13  # four lines lie in at most 4 * 3 = 12 hyperplanes (1, t, t^2, t^3)
PRIMES = (2**61 - 1,)  # divides a determinant by accident once in 10^18


@dataclass(frozen=True, slots=True, kw_only=True)
class RankProof:
    """A chart a and a prime with which the ten quadratic forms are seen to be independent."""

    chart: tuple[int, int, int, int]
    prime: int


def macaulay_matrix(C: Sequence[Sequence[int]], chart: Sequence[int]) -> Table:
    """10x10: the torque quadratics, then q_i (chart . q), in the monomials `COLUMNS`."""
    products = [[0] * len(COLUMNS) for _ in range(4)]
    for column, (i, j) in enumerate(COLUMNS):
        products[i][column] = chart[j]
        products[j][column] = chart[i]
    return [*torque_table(C), *products]


def at_most_four(C: Sequence[Sequence[int]]) -> RankProof | None:
    """A proof that C has at most four equilibria; None where the solutions form a continuum.

    None means not proved, not disproved; it would be wrong once in 10^17 problems.
    """
    flint = library("flint", "the proof that there are at most four equilibria")
    for t in range(CHARTS):
        chart = (1, t, t * t, t**3)
        entries = [entry for row in macaulay_matrix(C, chart) for entry in row]
        for prime in PRIMES:
            if flint.nmod_mat(10, 10, [entry % prime for entry in entries], prime).rank() == 10:
                return RankProof(chart=chart, prime=prime)
    return None
