"""Critical lines of a quartic in boxes: each with one line, simple, proved in ball arithmetic.

In a chart q_k = 1 the critical lines are the zeros of three polynomials in the three other entries,
F_i(q) - F_k(q) q_i, since l = F_k(q). Their Jacobian is F_ij - F_kj q_i, less F_k on the diagonal.
The quartic is rounded to the bits of the arithmetic, and its balls hold what was cut off.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

from flint import acb, acb_mat, arb, arb_mat, ctx

from certreg.equilibrium.krawczyk import (
    Balls,
    Reality,
    RootBox,
    are_distinct,
    kind_of,
    proved_root,
    tightened,
)
from certreg.equilibrium.line_set import BITS, critical_of
from certreg.exact.balls import fixed_point, negative_eigenvalues, orthonormal
from certreg.geometry.so3 import body_frame, squared_norm
from certreg.objective.quartics import MONOMIALS, PAIR_PLACE, PAIRS
from certreg.results import Guarantee

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.equilibrium.critical_set import Critical
    from certreg.objective.normalisation import LevelledExactly
    from certreg.objective.springs import Springs

GUARD_BITS = 16  # of a coefficient, beyond those of the arithmetic
PAIR_BITS = 64  # where to begin with a line that is not real: its box only has to be apart
REAL_BITS = 256  # with a real one: of its box numbers are told
MOST_BITS = 2048  # for roots as near as 1e-300
CUBES = tuple(combinations_with_replacement(range(4), 3))
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


class BallQuartic:
    """First and second derivatives of a quartic of integers, in balls."""

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

    def curvature(self, q: Sequence[arb]) -> arb_mat:
        """E^T F'' E - 4 F I at q, 3x3: 4 |q|^4 times the Hessian in rotation angle."""
        entries = self.hessian(q, arb_mat)
        second = arb_mat(
            [[entries[PAIR_PLACE[min(i, j), max(i, j)]] for j in range(4)] for i in range(4)]
        )
        frame, along = arb_mat([list(row) for row in body_frame(tuple(q))]), arb_mat(4, 1, list(q))
        value = (along.transpose() * second * along)[0, 0] / 3  # Euler: 12 F = q^T F'' q
        return frame.transpose() * second * frame - value * arb_mat(3, 3, 1)

    def level(self, q: Sequence[arb]) -> arb:
        """F / |q|^4 at q, of the levelled quartic."""
        first = self.gradient(q, arb_mat).entries()
        along = sum((g * c for g, c in zip(first, q, strict=True)), arb(0))
        return along / (4 * squared_norm(list(q)) ** 2)

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

    def __init__(self, quartic: BallQuartic, chart: int) -> None:
        self.quartic, self._chart = quartic, chart
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
        first = self.quartic.gradient(q, kind).entries()
        last = first[self._chart]
        return kind(3, 1, [first[i] - last * q[i] for i in self._others])

    def jacobian(self, x: Balls) -> Balls:
        """An enclosure of F_ij - F_kj q_i - F_k d_ij."""
        q, kind, k = self.completed(x.entries()), kind_of(x), self._chart
        second = self.quartic.hessian(q, kind)
        row = [second[PAIR_PLACE[min(j, k), max(j, k)]] for j in range(4)]
        value = sum((h * c for h, c in zip(row, q, strict=True)), row[0] * 0) / 3  # Euler: F_k
        return kind(
            3,
            3,
            [
                second[PAIR_PLACE[min(i, j), max(i, j)]] - row[j] * q[i] - (value if i == j else 0)
                for i in self._others
                for j in self._others
            ],
        )


def boxed(quartic: BallQuartic, q: Sequence[complex], *, real: bool) -> BoxedLine | None:
    """A box near a quaternion with one critical line, which is real, or is not.

    None means not proved, not disproved.
    """
    system = LineBalls(quartic, max(range(4), key=lambda k: abs(q[k])))
    kind, bits = (arb_mat, REAL_BITS) if real else (acb_mat, PAIR_BITS)
    while bits <= MOST_BITS:
        box = proved_root(system, system.start(q, kind), start_bits=bits, max_bits=MOST_BITS)
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
    real = [_as_box(line.quaternion) for line in lines if line.is_real]
    other = [line.quaternion for line in lines if not line.is_real]
    conjugates = [_as_box(tuple(entry.conjugate() for entry in q)) for q in other]
    return are_distinct(real) and are_distinct([*map(_as_box, other), *conjugates])


def index_of(line: BoxedLine) -> int | None:
    """The index of a real line, proved: its Hessian is not singular, since the line is simple."""
    bits = line.box.bits
    while bits <= MOST_BITS:
        with ctx.workprec(bits):
            index = negative_eigenvalues(line.system.quartic.curvature(line.quaternion))
        if index is not None:
            return index
        line, bits = line.within(bits), 2 * bits
    return None


def critical_at(
    objective: Springs, q: tuple[arb, ...], index: int | None, bits: int = BITS
) -> Critical:
    """The component of a proved line, told to so many bits, at the working precision."""
    (unit,) = orthonormal([q], 1)
    vector = [fixed_point(entry, bits) for entry in unit]
    return critical_of(objective, vector, index, Guarantee.ENCLOSED)


def _as_box(q: tuple[Any, ...]) -> RootBox:
    return RootBox(coordinates=q, bits=0)


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
