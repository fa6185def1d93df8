"""How many critical lines a quartic can have at most, by ranks of integer matrices.

The critical lines, complex q up to a factor with grad F(q) = l q, are the common zeros of the six
2x2 minors of [q, grad F(q)], forms of degree 4. Let I be their ideal, R the ring of polynomials in
q, and let h(d) = dim (R/I)_d: the monomials of degree d less the rank of the products of the minors
with the monomials of degree d - 4.

At most 40. Let l be a linear form with (I, l)_8 = R_8: the minors on the plane l = 0, in three
variables, times the 15 monomials of degree 4 in these, have rank 45. Then no line has l = 0, so
there are finitely many; and multiplication by l takes (R/I)_d onto (R/I)_(d+1) for all d >= 7, so
that h(d) <= h(7), and h(d) is the number of lines for large d, each counted with its multiplicity.
With h(7) = 40 there are at most 40. Modulo a prime a rank may only be smaller: what is proved
there, both ranks being lower bounds, is proved over Q. 40 lines lie in at most 120 of the planes
(1, t, t^2, t^3), so that 121 of them are enough if there are finitely many.

Infinitely many. The minors of a 2x4 matrix of forms that vanish in codimension 3, as many as there
are to expect, have the resolution of Eagon and Northcott [Eagon1962]: then h(d) = 40 for d >= 7. So
h(d) > 40 for any d >= 7 proves infinitely many complex lines. That needs a rank over Q to be small:
it is, where it is modulo so many primes that their product exceeds every minor [Hadamard1893].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from itertools import combinations, combinations_with_replacement
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.objective.quartics import MONOMIALS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Table = NDArray[Any]

LINES = 40
PLANES = 121  # 40 lines lie in at most 40 * 3 of them
# Eight times one is a machine integer; modulo one a rank is lost once in 10^14.
PRIMES = (2**55 - 55, 2**54 - 33)
DEGREE = 7  # from which on h is 40, if there are finitely many
HIGHEST = 10  # degree in which h is compared with 40
DOUBTFUL_PLANES = 3  # tried where h(7) is not 40 modulo a prime: no plane can help
PRIME_BITS = 62  # of the primes for ranks over Q
DEGREE_OF_MINORS = 4
ROWS = tuple(combinations(range(4), 2))  # of [q, grad F], for each minor


@dataclass(frozen=True, slots=True, kw_only=True)
class LineCount:
    """A proof that there are at most 40 critical lines: no one has plane . q = 0."""

    plane: tuple[int, int, int, int]
    prime: int


def at_most_forty(quartic: Sequence[int]) -> LineCount | None:
    """A proof that a quartic has at most 40 critical lines; None: not proved, not disproved.

    It fails where there are infinitely many, and else once in 10^14 quartics.
    """
    library("flint", "the proof that all equilibria are listed")
    for prime in PRIMES:
        minors = minors_modulo(quartic, prime)
        if _dimension(minors, DEGREE, prime) != LINES:
            continue
        for t in range(PLANES):
            if _misses(minors, t, prime):
                return LineCount(plane=plane(t), prime=prime)
            if t == DOUBTFUL_PLANES and _dimension(minors, DEGREE + 1, prime) != LINES:
                break
    return None


def infinitely_many(quartic: Sequence[int]) -> int | None:
    """A degree d with dim (R/I)_d > 40, which proves infinitely many complex critical lines.

    None: not proved, not disproved.
    """
    library("flint", "the proof that there are infinitely many equilibria")
    prime = PRIMES[0]
    minors = minors_modulo(quartic, prime)
    for degree in range(DEGREE, HIGHEST + 1):
        if _dimension(minors, degree, prime) > LINES:
            exact = _minors(np.array(quartic, dtype=object) // math.gcd(*quartic))
            most = len(forms(4, degree)) - LINES
            return degree if _rank_is_below(products(exact, degree), most) else None
    return None


def plane(t: int) -> tuple[int, int, int, int]:
    """The linear form with coefficients (1, t, t^2, t^3)."""
    return (1, t, t * t, t**3)


@cache
def forms(variables: int, degree: int) -> dict[tuple[int, ...], int]:
    """The monomials of a degree, by the variables in them, and their places."""
    found = combinations_with_replacement(range(variables), degree)
    return {monomial: place for place, monomial in enumerate(found)}


def _dimension(minors: Table, degree: int, prime: int) -> int:
    """The dimension of (R/I)_d, modulo a prime."""
    return len(forms(4, degree)) - _rank(products(minors, degree), prime)


def _misses(minors: Table, t: int, prime: int) -> bool:
    """Whether no critical line lies in a plane, proved modulo a prime."""
    restricted = minors.astype(object) @ _restriction(t) % prime if t else minors @ _restriction(0)
    table = products(restricted.astype(np.int64), 2 * DEGREE_OF_MINORS, variables=3)
    return _rank(table, prime) == table.shape[1]


def minors_modulo(quartic: Sequence[int], prime: int) -> Table:
    """(6, 35): the minors of [q, grad F] modulo one of `PRIMES`."""
    return _minors(np.array([entry % prime for entry in quartic])) % prime


def _minors(quartic: Table) -> Table:
    """(6, 35): the minors of [q, grad F], q_i F_j - q_j F_i, of 35 coefficients."""
    return minor_terms() @ quartic


@cache
def minor_terms() -> Table:
    """(6, 35, 35): how often each coefficient goes into each of a minor."""
    places = forms(4, DEGREE_OF_MINORS)
    terms = np.zeros((len(ROWS), len(MONOMIALS), len(MONOMIALS)), dtype=np.int64)
    for row, (i, j) in enumerate(ROWS):
        for factor, variable, sign in ((i, j, 1), (j, i, -1)):
            for place, monomial in enumerate(MONOMIALS):
                times, left = monomial.count(variable), list(monomial)
                if times:
                    left[left.index(variable)] = factor
                    terms[row, places[tuple(sorted(left))], place] += sign * times
    return terms


def products(minors: Table, degree: int, variables: int = 4) -> Table:
    """All products of six forms of degree 4 with the monomials that make a degree of them."""
    where, columns = product_places(variables, degree), len(forms(variables, degree))
    table = np.zeros((len(minors), where.shape[1], columns), dtype=minors.dtype)
    for m, to in enumerate(where):
        table[:, np.arange(len(to)), to] = minors[:, m, np.newaxis]
    return table.reshape(-1, columns)


@cache
def product_places(variables: int, degree: int) -> Table:
    """Where the product of a form of degree 4 with another stands among those of a degree."""
    places = forms(variables, degree)
    return np.array(
        [
            [places[tuple(sorted((*one, *other)))] for other in forms(variables, degree - 4)]
            for one in forms(variables, DEGREE_OF_MINORS)
        ]
    )


@cache
def _restriction(t: int) -> Table:
    """(35, 15): forms of degree 4 where q_0 = -(t q_1 + t^2 q_2 + t^3 q_3), in q_1, q_2, q_3."""
    places = forms(3, DEGREE_OF_MINORS)
    table = np.zeros((len(MONOMIALS), len(places)), dtype=object if t else np.int64)
    for row, monomial in enumerate(MONOMIALS):
        terms = {tuple(k - 1 for k in monomial if k): 1}
        for _ in range(monomial.count(0)):
            more: dict[tuple[int, ...], int] = {}
            for part, factor in terms.items():
                for k in range(3):
                    grown = tuple(sorted((*part, k)))
                    more[grown] = more.get(grown, 0) - factor * t ** (k + 1)
            terms = more
        for part, factor in terms.items():
            table[row, places[part]] += factor
    return table


def _rank(table: Table, prime: int) -> int:
    """Of residues modulo a prime."""
    flint = library("flint", "ranks")
    return flint.nmod_mat(*table.shape, table.ravel().tolist(), prime).rank()


def _rank_is_below(table: Table, least: int) -> bool:
    """Whether an integer matrix has a smaller rank than `least`, over Q: an exact answer.

    No minor of that size exceeds the product of as many row lengths; where all are zero modulo
    primes whose product is larger, they are zero.
    """
    flint = library("flint", "ranks over the rationals")
    lengths = sorted((sum(entry * entry for entry in row) for row in table), reverse=True)
    bits = sum(length.bit_length() for length in lengths[:least]) // 2 + 1
    whole = flint.fmpz_mat(*table.shape, table.ravel().tolist())
    candidate, found = 1 << PRIME_BITS, 0
    while found <= bits:
        candidate -= 1
        if not flint.fmpz(candidate).is_prime():
            continue
        if flint.nmod_mat(whole, candidate).rank() >= least:
            return False
        found += PRIME_BITS - 1
    return True
