"""Roots and critical lines in boxes: each holds exactly one, simple, proved in ball arithmetic.

For F(x) = 0, a point x, an approximate inverse Y of F'(x) and a box X around x, the Krawczyk set
x - Y F(x) + (I - Y F'(X)) (X - x) encloses every root in X; if it lies in the interior of X, then X
holds exactly one root, and it is a simple one [Krawczyk1969], [Moore1977]. In real arithmetic the
root is real. In complex arithmetic a coordinate whose imaginary part is not zero anywhere in the
box proves the root not to be real. False means not proved, not disproved.

Where a box is not mapped into itself, the same is done with twice the bits. As many disjoint boxes
as there are roots at most are a complete list.

In a chart q_k = 1 the critical lines are the zeros of three polynomials in the three other entries,
F_i(q) - F_k(q) q_i, since l = F_k(q). Their Jacobian is F_ij - F_kj q_i, less F_k on the diagonal.
The quartic is rounded to the bits of the arithmetic, and its balls hold what was cut off.
"""

from __future__ import annotations

import enum
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations, combinations_with_replacement
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from flint import acb, acb_mat, arb, arb_mat, ctx

from certreg.equilibrium.line_set import BITS, critical_of
from certreg.errors import ContradictionError
from certreg.exact.balls import fixed_point, negative_eigenvalues, orthonormal, radius_bits, sign
from certreg.geometry.so3 import body_frame, squared_norm
from certreg.objective.quartics import MONOMIALS, PAIR_PLACE, PAIRS
from certreg.results import Guarantee

if TYPE_CHECKING:
    from certreg.equilibrium.critical_set import Critical
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.normalisation import LevelledExactly
    from certreg.objective.springs import Springs


START_BITS = 128  # costs as much as 64, and the boxes are as small as 1e-30
REFINEMENTS = 12  # Newton steps at one precision: 2^-4 to 2^-2048 takes nine
INFLATION = 4  # of Newton's step to the box: what is left is quadratic in the step
Balls = Any  # arb_mat or acb_mat: real or complex balls
GUARD_BITS = 16  # of a coefficient, beyond those of the arithmetic
PAIR_BITS = 64  # where to begin with a line that is not real: its box only has to be apart
REAL_BITS = 256  # with a real one: of its box numbers are told
MOST_BITS = 2048  # for relative gaps down to 1e-300
CUBES = tuple(combinations_with_replacement(range(4), 3))


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
    system: BallSystem, start: Balls, *, start_bits: int = START_BITS, max_bits: int = MOST_BITS
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


def are_distinct(lines: Sequence[tuple[Any, ...]]) -> bool:
    """Whether quaternions of balls (4,), each in a chart of its own, hold different lines.

    Two lines differ iff a 2x2 minor is not zero. False means not proved, not disproved.
    """
    return all(
        any(bool(p[i] * q[j] - p[j] * q[i] != 0) for i, j in combinations(range(4), 2))
        for p, q in combinations(lines, 2)
    )


Table = Any  # arb_mat or acb_mat


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BoxedLine:
    """A box with one critical line, in the chart where entry `chart` is 1."""

    system: LineBalls
    box: RootBox

    @property
    def is_real(self) -> bool:
        """Whether the line is; of balls that are complex it is proved that it is not."""
        return self.box.reality is Reality.REAL

    @property
    def quaternion(self) -> tuple[Any, ...]:
        """The four entries, balls; one is 1."""
        return self.system.completed(self.box.coordinates)

    def within(self, bits: int) -> BoxedLine:
        """The same line in a box of radius below 2^-bits."""
        return BoxedLine(system=self.system, box=tightened(self.system, self.box, bits))


class BallForm(ABC):
    """A form F on quaternions, of even degree, by its derivatives in balls."""

    degree: ClassVar[int]

    @abstractmethod
    def gradient(self, q: Sequence[Any], kind: Any) -> Table:
        """4x1."""

    @abstractmethod
    def hessian(self, q: Sequence[Any], kind: Any) -> list[Any]:
        """The ten second derivatives in the order of PAIRS."""

    def curvature(self, q: Sequence[arb]) -> arb_mat:
        """E^T F'' E less the slope along q, 3x3: 4 |q|^4 times the Hessian in rotation angle.

        Of a quadratic form |q|^2 times that.
        """
        entries = self.hessian(q, arb_mat)
        second = arb_mat(
            [[entries[PAIR_PLACE[min(i, j), max(i, j)]] for j in range(4)] for i in range(4)]
        )
        frame, along = arb_mat([list(row) for row in body_frame(tuple(q))]), arb_mat(4, 1, list(q))
        slope = (along.transpose() * second * along)[0, 0] / (self.degree - 1)  # Euler
        return frame.transpose() * second * frame - slope * arb_mat(3, 3, 1)

    def level(self, q: Sequence[arb]) -> arb:
        """F at the unit quaternion of q."""
        first = self.gradient(q, arb_mat).entries()
        along = sum((g * c for g, c in zip(first, q, strict=True)), arb(0))
        return along / (self.degree * squared_norm(list(q)) ** (self.degree // 2))


class BallMatrix(BallForm):
    """q^T A q / 2: its critical lines are the eigenlines of A."""

    degree = 2

    def __init__(self, matrix: arb_mat) -> None:
        self._matrix = matrix

    def gradient(self, q: Sequence[Any], kind: Any) -> Table:
        """A q, 4x1."""
        return kind(self._matrix) * kind(4, 1, list(q))

    def hessian(self, q: Sequence[Any], kind: Any) -> list[Any]:
        """The ten entries of A in the order of PAIRS."""
        del q
        entries = kind(self._matrix)
        return [entries[pair] for pair in PAIRS]


class BallQuartic(BallForm):
    """A quartic of integers, levelled."""

    degree = 4

    def __init__(self, levelled: LevelledExactly) -> None:
        self._levelled = levelled
        self._tables: dict[tuple[int, Any], tuple[Table, Table]] = {}

    def gradient(self, q: Sequence[Any], kind: Any) -> Table:
        """4x1."""
        squares = [q[i] * q[j] for i, j in PAIRS]
        cubes = [squares[PAIR_PLACE[rest[:2]]] * q[rest[2]] for rest in CUBES]
        return self._rounded(kind)[0] * kind(len(CUBES), 1, cubes)

    def hessian(self, q: Sequence[Any], kind: Any) -> list[Any]:
        """The ten second derivatives in the order of PAIRS."""
        squares = kind(len(PAIRS), 1, [q[i] * q[j] for i, j in PAIRS])
        return (self._rounded(kind)[1] * squares).entries()

    def _rounded(self, kind: Any) -> tuple[Table, Table]:
        """The coefficients of the derivatives, 4x20 and 10x10, at the working precision."""
        key = (ctx.prec, kind)
        if key not in self._tables:
            short = self._levelled.shortened(ctx.prec + GUARD_BITS)
            radius = 0 if short is self._levelled else 1  # what is cut off is below 1
            balls = [arb(entry, radius) * arb((1, -short.bits)) for entry in short.integers]
            first, second = _derivative_terms()
            self._tables[key] = (
                kind([[times * balls[place] for place, times in row] for row in first]),
                kind([[times * balls[place] for place, times in row] for row in second]),
            )
        return self._tables[key]


class LineBalls:
    """The three equations of critical lines with q_chart = 1, for balls of either kind."""

    def __init__(self, form: BallForm, chart: int) -> None:
        self.form, self._chart = form, chart
        self._others = tuple(k for k in range(4) if k != chart)

    def completed(self, x: Sequence[Any]) -> tuple[Any, ...]:
        """All four entries."""
        one = acb(1) if isinstance(x[0], acb) else arb(1)
        return (*x[: self._chart], one, *x[self._chart :])

    def start(self, q: Sequence[complex], kind: Any) -> Balls:
        """The point of the chart on the line of a quaternion."""
        along = [q[k] / q[self._chart] for k in self._others]
        if kind is arb_mat:
            return arb_mat(3, 1, [entry.real for entry in along])
        return acb_mat(3, 1, [acb(entry.real, entry.imag) for entry in along])

    def values(self, x: Balls) -> Balls:
        """An enclosure of F_i - F_k q_i."""
        q, kind = self.completed(x.entries()), kind_of(x)
        first = self.form.gradient(q, kind).entries()
        last = first[self._chart]
        return kind(3, 1, [first[i] - last * q[i] for i in self._others])

    def jacobian(self, x: Balls) -> Balls:
        """An enclosure of F_ij - F_kj q_i - F_k d_ij."""
        q, kind, k = self.completed(x.entries()), kind_of(x), self._chart
        second = self.form.hessian(q, kind)
        row = [second[PAIR_PLACE[min(j, k), max(j, k)]] for j in range(4)]
        value = sum((h * c for h, c in zip(row, q, strict=True)), row[0] * 0)
        value /= self.form.degree - 1  # Euler: F_k
        return kind(
            3,
            3,
            [
                second[PAIR_PLACE[min(i, j), max(i, j)]] - row[j] * q[i] - (value if i == j else 0)
                for i in self._others
                for j in self._others
            ],
        )


def boxed(form: BallForm, q: Sequence[complex], *, real: bool) -> BoxedLine | None:
    """A box near a quaternion with one critical line, which is real, or is not.

    None means not proved, not disproved.
    """
    system = LineBalls(form, max(range(4), key=lambda k: abs(q[k])))
    kind, bits = (arb_mat, REAL_BITS) if real else (acb_mat, PAIR_BITS)
    while bits <= MOST_BITS:
        box = proved_root(system, system.start(q, kind), start_bits=bits)
        if box is None:
            return None
        if box.reality is not Reality.UNKNOWN:
            return BoxedLine(system=system, box=box)
        bits = 2 * box.bits
    return None


def all_different(lines: Sequence[BoxedLine]) -> bool:
    """Whether boxes, and the conjugates of those that are not real, hold different lines.

    False means not proved, not disproved.
    """
    real = [line.quaternion for line in lines if line.is_real]
    other = [line.quaternion for line in lines if not line.is_real]
    conjugates = [tuple(entry.conjugate() for entry in q) for q in other]
    return are_distinct(real) and are_distinct([*other, *conjugates])


def index_of(line: BoxedLine) -> int | None:
    """The index of a real line, proved: its Hessian is not singular, since the line is simple."""
    bits = line.box.bits
    while bits <= MOST_BITS:
        with ctx.workprec(bits):
            index = negative_eigenvalues(line.system.form.curvature(line.quaternion))
        if index is not None:
            return index
        line, bits = line.within(bits), 2 * bits
    return None


def critical_at(
    objective: Isotropic | Springs, q: tuple[arb, ...], index: int | None, bits: int = BITS
) -> Critical:
    """The component of a proved line, told to so many bits, at the working precision.

    An entry whose ball holds 0 counts as 0: rounding decides no sign of a quaternion.
    """
    (unit,) = orthonormal([q], 1)
    vector = [fixed_point(entry, bits) if sign(entry) else 0 for entry in unit]
    return critical_of(objective, vector, index, Guarantee.ENCLOSED)


@cache
def _derivative_terms() -> tuple[tuple[tuple[tuple[int, int], ...], ...], ...]:
    """Of F_i by the monomials of degree 3, of F_ij by those of degree 2: coefficient, factor."""
    places: dict[tuple[int, ...], int] = {m: place for place, m in enumerate(MONOMIALS)}

    def row(by: tuple[int, ...], rests: Sequence[tuple[int, ...]]) -> tuple[tuple[int, int], ...]:
        found: list[tuple[int, int]] = []
        for rest in rests:
            whole, times = list(rest), 1
            for variable in by:
                whole.append(variable)
                times *= whole.count(variable)
            found.append((places[tuple(sorted(whole))], times))
        return tuple(found)

    return (
        tuple(row((i,), CUBES) for i in range(4)),
        tuple(row(pair, PAIRS) for pair in PAIRS),
    )
