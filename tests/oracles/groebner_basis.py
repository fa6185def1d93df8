"""The readable reference: SymPy's Groebner basis of all equations in the nine entries of R.

Hundreds of times slower than the quaternion chart and without components, but one call of a
textbook algorithm on the equations as they stand. Exact over the rationals.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy  # pyright: ignore[reportMissingTypeStubs]

from .exports import as_sympy
from .systems import rotation_system

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .polynomials import Monomial


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationIdeal:
    """What a Groebner basis in degree reverse lexicographic order tells of the solutions R.

    basis: `sympy.Poly`. dimension, degree: of the complex variety; components of lower dimension
    do not count in the degree. Where the dimension is 0, the degree is that of the quotient ring:
    the number of solutions with multiplicity.
    """

    basis: tuple[Any, ...]
    dimension: int
    degree: int


def rotation_ideal(C: Sequence[Sequence[int]]) -> RotationIdeal:
    """The ideal of the equilibria of an integer 3x3 matrix C in the nine entries of R.

    >>> ideal = rotation_ideal(((3, 0, 0), (0, 2, 0), (0, 0, 1)))
    >>> ideal.dimension, ideal.degree
    (0, 4)
    """
    library: Any = sympy
    polynomials = as_sympy(rotation_system(C))
    found = library.groebner(polynomials, *polynomials[0].gens, order="grevlex", domain=library.QQ)
    leading = [tuple(p.monoms(order="grevlex")[0]) for p in found.polys]
    dimension, degree = dimension_and_degree(leading, len(polynomials[0].gens))
    return RotationIdeal(basis=tuple(found.polys), dimension=dimension, degree=degree)


def dimension_and_degree(leading: Sequence[Monomial], variables: int) -> tuple[int, int]:
    """Dimension and degree of an ideal from the leading monomials of its Groebner basis.

    The Hilbert series is N(t) / (1 - t)^n; where N = (1 - t)^k Q with Q(1) other than 0, the
    dimension is n - k and the degree is Q(1).

    >>> dimension_and_degree([(2, 0), (1, 1)], 2)  # a line and an embedded point
    (1, 1)
    """
    numerator = _hilbert_numerator(list(leading))
    dimension = variables
    while sum(numerator) == 0:
        quotient, carry = list[int](), 0  # division by 1 - t: partial sums
        for coefficient in numerator:
            carry += coefficient
            quotient.append(carry)
        numerator, dimension = quotient, dimension - 1
    return dimension, sum(numerator)


def _hilbert_numerator(monomials: list[Monomial]) -> list[int]:
    """N(t) of a monomial ideal: that without its last generator m, less t^deg m N(ideal : m)."""
    minimal = _minimal(monomials)
    if not minimal:
        return [1]
    *rest, last = minimal
    quotient = [tuple(max(a - b, 0) for a, b in zip(m, last, strict=True)) for m in rest]
    without, beyond = _hilbert_numerator(rest), [0] * sum(last) + _hilbert_numerator(quotient)
    length = max(len(without), len(beyond))
    padded = (part + [0] * (length - len(part)) for part in (without, beyond))
    return [a - b for a, b in zip(*padded, strict=True)]


def _minimal(monomials: list[Monomial]) -> list[Monomial]:
    """The generators that no other divides."""
    distinct = sorted(set(monomials), key=lambda m: (sum(m), m))
    kept: list[Monomial] = []
    for m in distinct:
        if not any(all(a <= b for a, b in zip(k, m, strict=True)) for k in kept):
            kept.append(m)
    return kept
