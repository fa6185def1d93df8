"""The critical rotations of general springs, as a method lists them, among 40 complex lines."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.equilibrium.critical_set import Completeness, Critical, CriticalSet
from certreg.equilibrium.line_ranks import at_most_forty, infinitely_many
from certreg.results import Guarantee

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.objective.springs import Springs


LINES = 40
REAL_LINES = 4  # of one weight per pair
BITS = 192  # of a quaternion that is told: 57 digits
ROTATION_GROUP = tuple(tuple(int(i == j) for i in range(4)) for j in range(4))


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
    objective: Springs, vector: Sequence[int], index: int | None, guarantee: Guarantee
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
