"""Polynomial systems as other programs read them: SymPy, Singular, msolve, PHCpack.

Exact everywhere but for PHCpack, which computes in doubles: there the coefficients of each
polynomial are divided by a power of two so that the largest is near 1, and rounded once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy  # pyright: ignore[reportMissingTypeStubs]

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from .polynomials import Monomial, PolynomialSystem


def as_sympy(system: PolynomialSystem) -> list[Any]:
    """The polynomials as `sympy.Poly` over the integers, in `system.variables`."""
    library: Any = sympy
    symbols = library.symbols(system.variables)
    return [
        library.Poly.from_dict(dict(polynomial), *symbols, domain=library.ZZ)
        for polynomial in system.polynomials
    ]


def as_singular(system: PolynomialSystem, name: str = "I") -> str:
    """Commands for Singular: a ring over Q in degree reverse lexicographic order, and the ideal."""
    variables = ",".join(system.variables)
    body = ",\n  ".join(_sum(system, p) for p in system.polynomials)
    return f"ring r = 0,({variables}),dp;\nideal {name} =\n  {body};\n"


def as_msolve(system: PolynomialSystem) -> str:
    """An input file for msolve: variables, characteristic 0, polynomials."""
    body = ",\n".join(_sum(system, p) for p in system.polynomials)
    return f"{','.join(system.variables)}\n0\n{body}\n"


def as_phcpack(system: PolynomialSystem) -> str:
    """An input file for PHCpack (`phc -b`): the numbers of equations and unknowns, polynomials."""
    equations, unknowns = len(system.polynomials), len(system.variables)
    head = str(equations) if equations == unknowns else f"{equations} {unknowns}"
    body = "".join(f"{_sum(system, _rounded(p))};\n" for p in system.polynomials)
    return f"{head}\n{body}"


def _sum(system: PolynomialSystem, polynomial: Mapping[Monomial, Any]) -> str:
    terms = [_term(system, monomial, c) for monomial, c in polynomial.items()]
    return "".join(terms).removeprefix("+") or "0"  # Singular takes no sign + in front


def _term(system: PolynomialSystem, monomial: Monomial, coefficient: float) -> str:
    pairs = zip(system.variables, monomial, strict=True)
    powers = "*".join(v if e == 1 else f"{v}^{e}" for v, e in pairs if e)
    if abs(coefficient) == 1 and powers:
        return f"{coefficient:+}"[0] + powers
    return f"{coefficient:+}*{powers}" if powers else f"{coefficient:+}"


def value_unit(C: Sequence[Sequence[int]]) -> int:
    """A power of two of the size of K(C): the `unit` of a multiplier system for doubles."""
    return 1 << max(abs(entry) for row in C for entry in row).bit_length()


def _rounded(polynomial: Mapping[Monomial, int]) -> dict[Monomial, float]:
    """The polynomial over a power of two, in doubles: a factor does not move its roots."""
    unit = 1 << max((abs(c).bit_length() for c in polynomial.values()), default=0)
    return {monomial: c / unit for monomial, c in polynomial.items()}
