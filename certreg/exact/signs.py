"""The signs of the eigenvalues of a symmetric integer matrix, counted exactly and without roots.

A real polynomial whose roots are all real has as many positive roots as its coefficients have
changes of sign (Descartes' rule, which is an equality there), and as many roots 0 as it has zeros
at its end. Proof: derivations, descartes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from certreg.exact.elimination import leverrier


@dataclass(frozen=True, slots=True, kw_only=True)
class RootSigns:
    """How many eigenvalues are positive, zero and negative, with their multiplicities."""

    positive: int
    zero: int
    negative: int


def characteristic(matrix: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """The coefficients of det(x I - A) of an integer matrix, from the highest power on.

    By the method of Faddeev and LeVerrier.
    """
    return (1, *[(-1) ** k * value for k, (value, _) in enumerate(leverrier(matrix), 1)])


def signs_of_roots(coefficients: Sequence[int]) -> RootSigns:
    """The signs of the roots of a polynomial whose roots are all real; its first is not 0."""
    degree, kept = len(coefficients) - 1, [c for c in coefficients if c]
    zero = next(k for k, c in enumerate(reversed(coefficients)) if c)
    positive = sum((a > 0) != (b > 0) for a, b in pairwise(kept))
    return RootSigns(positive=positive, zero=zero, negative=degree - zero - positive)


def signs_of_eigenvalues(matrix: Sequence[Sequence[int]]) -> RootSigns:
    """The signs of the eigenvalues of a symmetric integer matrix."""
    return signs_of_roots(characteristic(matrix))
