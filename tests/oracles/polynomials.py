"""Polynomial systems with integer coefficients, and the one of eigenvectors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

Monomial = tuple[int, ...]  # exponents
Polynomial = dict[Monomial, int]

QUATERNION = ("w", "x", "y", "z")


@dataclass(frozen=True, slots=True, kw_only=True)
class PolynomialSystem:
    """Polynomials with integer coefficients, to be zero together.

    polynomials: for each the coefficient, never 0, of each monomial; a monomial is the tuple of the
        exponents of `variables`.
    """

    variables: tuple[str, ...]
    polynomials: tuple[Mapping[Monomial, int], ...]

    def evaluate(self, point: Sequence[Any]) -> list[Any]:
        """The values at a point of integers, balls, or of any other ring."""
        return [
            sum(c * _power_product(point, monomial) for monomial, c in polynomial.items())
            for polynomial in self.polynomials
        ]


def multiplier_system(
    K: Sequence[Sequence[int]], chart: Sequence[int] = (1, 0, 0, 0), *, unit: int = 1
) -> PolynomialSystem:
    """K q = unit l q and chart . q = 1: five equations in (w, x, y, z, l), as many as unknowns.

    The six torques are the minors of [q, K q]: for q other than 0 they vanish iff an l exists. Then
    unit l = chart . K q, the critical value q^T K q / |q|^2; a unit of the size of K keeps l near 1
    for programs that compute in doubles. Solutions with chart . q = 0 are missed.
    """
    rows = [
        collected(
            [*((exponents((k,), 5), c) for k, c in enumerate(row)), (exponents((j, 4), 5), -unit)]
        )
        for j, row in enumerate(K)
    ]
    norm = [(exponents((k,), 5), c) for k, c in enumerate(chart)]
    rows.append(collected([*norm, ((0,) * 5, -1)]))
    return PolynomialSystem(variables=(*QUATERNION, "l"), polynomials=tuple(rows))


def exponents(factors: Sequence[int], variables: int) -> Monomial:
    """The product of some variables, named by number, as a monomial in so many."""
    return tuple(sum(f == k for f in factors) for k in range(variables))


def collected(terms: Iterable[tuple[Monomial, int]]) -> Polynomial:
    """The polynomial that is the sum of the terms."""
    total: Polynomial = {}
    for monomial, coefficient in terms:
        total[monomial] = total.get(monomial, 0) + coefficient
    return {monomial: coefficient for monomial, coefficient in total.items() if coefficient}


def _power_product(point: Sequence[Any], monomial: Monomial) -> Any:
    product: Any = 1
    for value, exponent in zip(point, monomial, strict=True):
        for _ in range(exponent):
            product = product * value
    return product
