"""The critical rotations of general springs, as a method lists them, among 40 complex lines.

How many critical lines a quartic can have at most is proved by ranks of integer matrices.
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

import enum
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations, combinations_with_replacement
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import library
from certreg.equilibrium.critical_set import Completeness, Critical, CriticalSet
from certreg.objective.quartics import MONOMIALS
from certreg.results import Guarantee

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Table = NDArray[Any]
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs


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
REAL_LINES = 4  # of one weight per pair
BITS = 192  # of a quaternion that is told: 57 digits
ROTATION_GROUP = tuple(tuple(int(i == j) for i in range(4)) for j in range(4))


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


class Finiteness(enum.Enum):
    """What is proved of the number of critical lines; the value is the sentence for the user."""

    FORTY = "There are at most 40 critical lines, complex ones included: proved by two ranks."
    FOUR = (
        "The energy is that of one weight per pair, and no turn leaves it as it is: there are "
        "exactly four equilibria, and infinitely many complex critical lines beside them."
    )
    CONSTANT = "The energy is the same at every rotation: every rotation is an equilibrium."
    SYMMETRIC = (
        "There are infinitely many equilibria: turns that leave the energy as it is carry an "
        "equilibrium along a circle of them."
    )
    COMPLEX = (
        "There are infinitely many complex critical lines, proved by a rank over the rationals; "
        "whether infinitely many of them are rotations is not decided."
    )
    UNDECIDED = "Whether there are finitely many equilibria is not decided."


@dataclass(frozen=True, slots=True, kw_only=True)
class LineSet(CriticalSet):
    """Critical rotations of general springs, with what is known of the complex lines beside them.

    finiteness: of the critical lines. pairs: of conjugate lines, no rotations, that were proved to
    be apart. tied: how many of the first components may be the best: 1 where the first is proved
    to be; 0 where that is not decided.
    """

    finiteness: Finiteness
    pairs: int
    tied: int

    @property
    def separated(self) -> int:
        """Real components that are one equilibrium each, proved."""
        return sum(part.guarantee is not Guarantee.NUMERICAL for part in self.components)

    @property
    def count_complex(self) -> int | None:
        """40 where all lines are known to be apart; else None."""
        return LINES if self.completeness is Completeness.LINES else None

    @property
    def stable(self) -> int:
        """How many listed components are known to be of index 0."""
        return self.indices.count(0)


def finiteness_of(objective: Springs) -> Finiteness:
    """What can be proved of the number of critical lines: by coefficients, symmetry, ranks.

    A one-parameter group of turns q -> a q + q b that leaves F as it is carries critical lines
    to critical lines. If |a| and |b| differ it moves every rotation. If not, it is conjugation by
    turns about an axis, up to a fixed rotation; then the half turns about axes orthogonal to that
    one are a circle of critical rotations: at each the opposite turn about its own axis leaves it,
    turns both directions across the circle round, and so leaves no slope.

    Where F = |q|^2 q^T M q, as of one weight per pair, the critical rotations are the eigenvectors
    of M, and a turn within the space of an eigenvalue that repeats leaves F as it is: without
    symmetry all four differ.
    """
    if objective.oscillation == 0:
        return Finiteness.CONSTANT
    if objective.symmetry:
        return Finiteness.SYMMETRIC
    if objective.isotropic_like:
        return Finiteness.FOUR
    if at_most_forty(objective.quartic) is not None:
        return Finiteness.FORTY
    if infinitely_many(objective.quartic) is not None:
        return Finiteness.COMPLEX
    return Finiteness.UNDECIDED


def line_set(  # noqa: PLR0913 - what is known of the lines, by name
    method: str,
    components: Sequence[Critical],
    *,
    finiteness: Finiteness,
    pairs: int,
    tied: int,
    bits: int = BITS,
    why: str = "",
) -> LineSet:
    """The list: complete where 40 lines are apart and there are no more, else in doubt.

    why: in words, what became of lines that are missing.
    """
    found = sum(part.guarantee is not Guarantee.NUMERICAL for part in components) + 2 * pairs
    completeness = None
    if finiteness is Finiteness.FORTY and found == LINES:
        completeness = Completeness.LINES
    elif finiteness is Finiteness.FOUR and len(components) == found == REAL_LINES:
        completeness = Completeness.SPECTRAL
    complete = completeness is not None
    return LineSet(
        method=method,
        components=tuple(components),
        bits=bits,
        completeness=completeness,
        doubt=None if complete else f"{finiteness.value} {_apart_words(found, finiteness)}{why}",
        finiteness=finiteness,
        pairs=pairs,
        tied=tied if complete else 0,
    )


def critical_of(
    objective: Isotropic | Springs, vector: Sequence[int], index: int | None, guarantee: Guarantee
) -> Critical:
    """The component at a unit quaternion in fixed point, its first entry above 0."""
    sign = next(1 if entry > 0 else -1 for entry in vector if entry)
    w, x, y, z = (sign * entry for entry in vector)
    return Critical(
        quaternion=(w, x, y, z),
        span=((w, x, y, z),),
        value=objective.energy((w, x, y, z)),
        index=index,
        guarantee=guarantee,
    )


def constant_set(method: str, objective: Springs) -> LineSet:
    """Every rotation."""
    identity = (1, 0, 0, 0)
    whole = Critical(
        quaternion=identity,
        span=tuple(tuple(entry << BITS for entry in row) for row in ROTATION_GROUP),
        value=objective.energy(identity),
        index=0,
        guarantee=Guarantee.EXACT,
    )
    return LineSet(
        method=method,
        components=(whole,),
        bits=BITS,
        completeness=Completeness.CONSTANT,
        finiteness=Finiteness.CONSTANT,
        pairs=0,
        tied=1,
    )


def _apart_words(found: int, finiteness: Finiteness) -> str:
    if finiteness is Finiteness.FORTY:
        return (
            f"{found} of them were proved to be apart from all others; the other {LINES - found} "
            "meet in multiple ones, or so nearly that they could not be told apart."
        )
    if not found:
        return "None was proved to be isolated."
    return f"{found} lines, complex ones included, were proved to be isolated."
