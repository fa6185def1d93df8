"""Roots proved in ball arithmetic: each box holds exactly one root, and which are real.

For F(x) = 0, a point x, an approximate inverse Y of F'(x) and a box X around x, the Krawczyk set
x - Y F(x) + (I - Y F'(X)) (X - x) encloses every root in X; if it lies in the interior of X, then X
holds exactly one root, and it is a simple one [Krawczyk1969], [Moore1977]. In real arithmetic the
root is real. In complex arithmetic a coordinate whose imaginary part is not zero anywhere in the
box proves the root not to be real. False means not proved, not disproved.

Where a box is not mapped into itself, the same is done with twice the bits. As many disjoint boxes
as there are roots at most are a complete list. A module of its own: nothing is known here of what
is solved.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any, Protocol

from flint import acb, acb_mat, arb, arb_mat, ctx

from certreg.errors import ContradictionError
from certreg.exact.balls import radius_bits

if TYPE_CHECKING:
    from collections.abc import Sequence

START_BITS = 128  # costs as much as 64, and the boxes are as small as 1e-30
MAX_BITS = 2048  # for relative gaps down to 1e-300
REFINEMENTS = 12  # Newton steps at one precision: 2^-4 to 2^-2048 takes nine
INFLATION = 4  # of Newton's step to the box: what is left is quadratic in the step
Balls = Any  # arb_mat or acb_mat: real or complex balls


class BallSystem(Protocol):
    """n polynomials in n unknowns, in balls."""

    def values(self, x: Balls, /) -> Balls:
        """An enclosure (n x 1) of the values on a box (n x 1)."""
        ...

    def jacobian(self, x: Balls, /) -> Balls:
        """An enclosure (n x n) of the derivatives; row: polynomial, column: unknown."""
        ...


class Reality(enum.Enum):
    """Whether a root is real; the value is the word for it."""

    REAL = "real"
    NOT_REAL = "not real"
    UNKNOWN = "not decided"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RootBox:
    """A box that holds exactly one root, proved.

    coordinates: balls, all real (arb) or all complex (acb). bits: the precision that it took.
    """

    coordinates: tuple[Any, ...]
    bits: int

    @property
    def reality(self) -> Reality:
        """Whether the root is real: a box of real balls holds a real one."""
        if all(isinstance(ball, arb) for ball in self.coordinates):
            return Reality.REAL
        if any(bool(ball.imag != 0) for ball in self.coordinates):
            return Reality.NOT_REAL
        return Reality.UNKNOWN


def proved_root(
    system: BallSystem, start: Balls, *, start_bits: int = START_BITS, max_bits: int = MAX_BITS
) -> RootBox | None:
    """A box near `start` (n x 1, exact) that holds exactly one root of the system.

    With ever more bits, until Krawczyk's condition holds. None means not proved, not disproved: no
    simple root was found near enough.
    """
    bits, x = start_bits, start
    while bits <= max_bits:
        with ctx.workprec(bits):
            for _ in range(REFINEMENTS):
                try:
                    inverse = system.jacobian(x).inv().mid()
                except ZeroDivisionError:
                    break  # singular as far as these bits tell
                step = inverse * system.values(x)
                box = _krawczyk(system, x, inverse, step)
                if box is not None:
                    return RootBox(coordinates=tuple(box.entries()), bits=bits)
                x = (x - step).mid()
        bits *= 2
    return None


def tightened(system: BallSystem, box: RootBox, bits: int) -> RootBox:
    """The same root in a box whose radii are below 2^-bits."""
    start = 2 * max(bits, box.bits)
    while max(radius_bits(ball) for ball in box.coordinates) >= -bits:
        middle = kind_of(box.coordinates[0])(
            len(box.coordinates), 1, [ball.mid() for ball in box.coordinates]
        )
        smaller = proved_root(system, middle, start_bits=start, max_bits=4 * start)
        if smaller is None:  # it holds with more bits whatever held with fewer
            raise ContradictionError(
                "a proved root was lost on the way to a smaller box",
                methods=("homotopy",),
                limit=bits,
            )
        box = smaller
    return box


def kind_of(balls: Any) -> Any:
    """arb_mat or acb_mat, for a matrix or a number of real or complex balls."""
    return arb_mat if isinstance(balls, arb_mat | arb) else acb_mat


def _krawczyk(system: BallSystem, x: Balls, inverse: Balls, step: Balls) -> Balls | None:
    """The Krawczyk set of a box around x, if the box holds it in its interior."""
    n, kind = x.nrows(), kind_of(x)
    size = max(ball.abs_upper() for ball in x.entries())
    least = (size if size > 0 else arb(1)) * arb(2) ** -(ctx.prec // 2)  # zero may be a root
    radius = (max(ball.abs_upper() for ball in step.entries()) * INFLATION + least).upper()
    side = arb(0, radius)
    offset = kind(n, 1, [side if kind is arb_mat else acb(side, side)] * n)
    box = x + offset
    image = x - step + (kind(n, n, 1) - inverse * system.jacobian(box)) * offset
    pairs = zip(box.entries(), image.entries(), strict=True)
    return image if all(outer.contains_interior(inner) for outer, inner in pairs) else None


def are_distinct(boxes: Sequence[RootBox]) -> bool:
    """Whether boxes of lines of quaternions, each in a chart of its own, hold different lines.

    Two lines differ iff a 2x2 minor is not zero. False means not proved, not disproved.
    """
    vectors = [box.coordinates[:4] for box in boxes]
    return all(
        any(bool(p[i] * q[j] - p[j] * q[i] != 0) for i, j in combinations(range(4), 2))
        for p, q in combinations(vectors, 2)
    )
