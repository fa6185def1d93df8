r"""The moment functional: sums over a cloud with any number of points.

Every energy, force and torque is a sum over the points of a polynomial of degree at most two in
the coordinates of one correspondence. Such a sum depends on the cloud through finitely many
numbers only: it is linear in the monomials, and the sums of the monomials are the moments. So a
claim for every N is a claim about the linear functional below, a polynomial identity.

The source is taken about its centroid, and so is the target: the paper's \tilde x and \bar y = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import sympy

from .notation import Array, Matrix, entry, matrix, scalar, symmetric, vector


@dataclass(frozen=True)
class MomentCloud:
    """The centred correspondences (x, y) of a cloud of any size, through its moments.

    mass M = sum m; source_scatter S2 = sum m x x^T; target_scatter T2 = sum m y y^T;
    cross C = sum m y x^T. sum m x = sum m y = 0: both clouds are centred.
    """

    x: Array = field(default_factory=lambda: vector("x"))
    y: Array = field(default_factory=lambda: vector("y"))
    mass: Any = field(default_factory=lambda: scalar("M"))
    source_scatter: Array = field(default_factory=lambda: symmetric("S"))
    target_scatter: Array = field(default_factory=lambda: symmetric("T"))
    cross: Array = field(default_factory=lambda: matrix("C"))

    @cached_property
    def inertia(self) -> Array:
        """J = tr(S2) I - S2."""
        return inertia_of(self.source_scatter)

    def total(self, of_a_point: Any) -> Any:
        """The sum over the points of m times a polynomial in x and y, entry by entry.

        Raises ValueError for a polynomial of degree above two in the coordinates.
        """
        if isinstance(of_a_point, sympy.MatrixBase):
            return of_a_point.applyfunc(self.total)
        point = [*self.x, *self.y]
        terms = _terms(sympy.sympify(of_a_point), tuple(point))
        return sum((c * self._moment(powers) for powers, c in terms), start=sympy.Integer(0))

    def _moment(self, powers: tuple[int, ...]) -> Any:
        at = [k for k, power in enumerate(powers) for _ in range(power)]
        match at:
            case []:
                return self.mass
            case [_]:
                return sympy.Integer(0)
            case [a, b] if b < 3:
                return self.source_scatter[a, b]
            case [a, b] if a >= 3:
                return self.target_scatter[a - 3, b - 3]
            case [a, b]:
                return self.cross[b - 3, a]
            case _:
                raise ValueError(f"a moment of degree {len(at)}: only sums up to degree two exist")


@dataclass(frozen=True)
class PointCloud:
    """N points written out: masses m_i, sources x_i and targets y_i, all symbols.

    Not centred: the centred points are x_i - mean, with the mean written as sum m x / M, so that
    sums of centred points carry one factor 1/M (`mass_inverse`, a symbol) each.
    """

    masses: tuple[Any, ...]
    sources: tuple[Array, ...]
    targets: tuple[Array, ...]

    @classmethod
    def of_size(cls, n: int) -> PointCloud:
        """A cloud of n points, everything symbolic."""
        return cls(
            masses=tuple(entry("m", i) for i in range(1, n + 1)),
            sources=tuple(vector(f"x{i}") for i in range(1, n + 1)),
            targets=tuple(vector(f"y{i}") for i in range(1, n + 1)),
        )

    @property
    def mass(self) -> Any:
        """M, the sum of the masses."""
        return sum(self.masses)

    def total(self, values: Any) -> Any:
        """The sum over the points of m_i times values[i]."""
        return sum(
            (m * value for m, value in zip(self.masses, values, strict=True)),
            start=0 * values[0],
        )

    def centred(self, points: tuple[Array, ...], mass_inverse: Any) -> list[Array]:
        """The points about their weighted mean."""
        mean = self.total(points) * mass_inverse
        return [point - mean for point in points]


def inertia_of(scatter: Any) -> Array:
    """tr(S) I - S."""
    scatter = Matrix(scatter)
    return scatter.trace() * sympy.eye(3) - scatter


@lru_cache(maxsize=4096)  # proofs and their controls take the same sums
def _terms(
    of_a_point: sympy.Expr, point: tuple[sympy.Symbol, ...]
) -> tuple[tuple[tuple[int, ...], sympy.Expr], ...]:
    """The powers of the coordinates and their coefficients."""
    return tuple(sympy.Poly(of_a_point, *point).terms())
