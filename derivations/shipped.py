"""Shipped exact code, run on polynomials: what it decides on, not a copy of its formula.

The checker decides in integers and fractions. Its functions are a few lines of arithmetic followed
by a decision; here the same compiled code is run with polynomials for numbers and the decision
replaced, so that a claim can be made about the very expression that is decided. What stands in for
a part of the code knows for which arguments it does, and raises UnmodelledError for any other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations_with_replacement
from types import CodeType, FunctionType
from typing import Any

import sympy

from certreg.verify import (
    CheckedSprings,
    coefficients,
    davenport,
    proves_basin,
    proves_level,
)

from .notation import scalar
from .rings import flat, ring_of

UNIT = scalar("unit")  # of K: the checker holds K / unit in integers
NORM_INVERSE = scalar("norm_inverse")  # of |q|^2
ALL = 13  # unknowns of the energy of general springs: t, R by columns, 1
_LEFT = [*combinations_with_replacement(range(3, ALL), 2)]  # of a form without t, by rows
TWO_POWER = scalar("two_power")  # the power of two of the angular velocity's exponent


class UnmodelledError(ValueError):
    """Shipped code asks of a replacement what it does not stand for: nothing is proved of it."""


def modelled(condition: object, what: str) -> None:
    """Nothing if the condition holds; otherwise UnmodelledError."""
    if not condition:
        raise UnmodelledError(what)


def rerouted(function: Callable[..., Any], **names: Any) -> Callable[..., Any]:
    """The same compiled function, but the given names of its module (or built in) replaced."""
    code: Any = function.__code__
    unknown = set(names) - _names_in(code)
    modelled(not unknown, f"{function.__name__} does not use {sorted(unknown)}")
    known, given = {**function.__globals__, **names}, function.__defaults__
    return FunctionType(code, known, function.__name__, given)


def _names_in(code: CodeType) -> set[str]:
    """The global names of a function and of the functions and comprehensions within."""
    inner = (_names_in(const) for const in code.co_consts if isinstance(const, CodeType))
    return set(code.co_names).union(*inner)


class Exponent:
    """An integer of which only its power of two is taken: it has no arithmetic."""


class Bound:
    """A number that is only compared with, once: it keeps what is asked to be greater."""

    def __init__(self, ring: Any) -> None:
        self.ring, self.greater, self.met = ring, ring.zero, False

    def __lt__(self, greater: Any) -> bool:
        modelled(_is_element(self.ring, greater), f"{greater!r} is no polynomial")
        modelled(not self.met, "a second comparison")
        self.greater, self.met = greater, True
        return True


def fraction_over(norm: Any) -> Callable[[Any, Any], Any]:
    """`Fraction` of a polynomial, over an integer or over this norm, of inverse `NORM_INVERSE`."""
    inverse = norm.ring.from_expr(NORM_INVERSE)

    def quotient(number: Any, divisor: Any) -> Any:
        modelled(_is_element(norm.ring, number), f"{number!r} is no polynomial")
        if type(divisor) is int:
            return number * norm.ring.domain_new(Fraction(1, divisor))
        modelled(divisor == norm, f"a division by {divisor}, which is not {norm}")
        return number * inverse

    return quotient


def _is_element(ring: Any, value: Any) -> bool:
    return getattr(value, "ring", None) == ring


def checked_davenport(C: Any) -> Any:
    """The checker's own Davenport matrix of a symbolic C (3x3), 4x4."""
    ring = ring_of(flat(C))
    return _expressions(davenport(_elements(ring, C)))


def checked_coefficients(C: Any, chart: Any) -> Any:
    """The checker's 10x10 matrix of quadratic forms, of a symbolic C (3x3) and chart (4)."""
    ring = ring_of([*flat(C), *chart])
    return _expressions(coefficients(_elements(ring, C), _row(ring, chart)))


def checked_matrix(K: Any, q: Any, level: Any, mu: Any) -> Any:
    """The 4x4 matrix whose definiteness `certreg.verify.proves_level` decides.

    K is given over `UNIT`, the level over 1/|q|^2.
    """
    ring, seen = ring_of([*flat(K), *q, level, mu, UNIT]), []
    decide = rerouted(proves_level, definite=lambda matrix, _: seen.append(matrix))
    unit, raised, along = (ring.from_expr(sympy.sympify(x)) for x in (UNIT, level, mu))
    decided = decide(_elements(ring, K), unit, _row(ring, q), raised, along)
    modelled(len(seen) == 1 and decided is None, "more than one definiteness decides")
    return _expressions(seen[0])


def checked_alignment(K: Any, J: Any, p: Any, omega: Any) -> Any:
    """What `certreg.verify.proves_basin` asks to be greater than the level.

    The inverse of |p|^2 is `NORM_INVERSE`; omega (3) is an integer vector times `TWO_POWER`.
    """
    ring = ring_of([*flat(K), *flat(J), *p, *omega, NORM_INVERSE, TWO_POWER])
    row, own, bound = _row(ring, p), Exponent(), Bound(ring)

    def power(number: object, exponent: object) -> Any:
        modelled(number == 1 and exponent is own, f"{number!r} times the power of {exponent!r}")
        return ring.from_expr(TWO_POWER)

    decide = rerouted(proves_basin, Fraction=fraction_over(_norm(row)), _dyadic=power)
    velocity = [*_row(ring, omega), own]
    decided = decide(_elements(ring, K), _elements(ring, J), bound, row, velocity)
    modelled(decided is True and bound.met, "more than one comparison decides")
    return bound.greater.as_expr()


class Pivoted:
    """A polynomial that elimination takes for a positive integer, and that notes what it meets.

    Products, differences and exact quotients; a quotient with a remainder is an ArithmeticError.
    Whoever asks for its sign is told that it is positive, and is remembered.
    """

    def __init__(self, value: Any, met: list[Any]) -> None:
        self.value, self.met = value, met

    def __mul__(self, other: Pivoted | int) -> Pivoted:
        factor = other.value if isinstance(other, Pivoted) else other
        return Pivoted(self.value * factor, self.met)

    def __sub__(self, other: Pivoted) -> Pivoted:
        return Pivoted(self.value - other.value, self.met)

    def __floordiv__(self, other: Pivoted | int) -> Pivoted:
        divisor = other.value if isinstance(other, Pivoted) else self.value.ring(other)
        quotient, rest = divmod(self.value, divisor)
        if rest:
            raise ArithmeticError(f"{divisor} leaves the remainder {rest}")
        return Pivoted(quotient, self.met)

    def __gt__(self, zero: int) -> bool:
        return not self <= zero

    def __le__(self, zero: int) -> bool:
        modelled(type(zero) is int and zero == 0, f"a comparison with {zero!r}")
        self.met.append(self.value.as_expr())
        return False


class Entry(Pivoted):
    """The same, with sums, integer multiples and a quotient with the last pivot."""

    def __add__(self, other: Entry | int) -> Entry:
        return Entry(self.value + (other.value if isinstance(other, Entry) else other), self.met)

    __radd__ = __add__

    def __mul__(self, other: Pivoted | int) -> Entry:
        return Entry(super().__mul__(other).value, self.met)

    __rmul__ = __mul__

    def __sub__(self, other: Pivoted) -> Entry:
        return Entry(super().__sub__(other).value, self.met)

    def __floordiv__(self, other: Pivoted | int) -> Entry:
        return Entry(super().__floordiv__(other).value, self.met)

    def __rtruediv__(self, one: int) -> Any:
        modelled(one == 1, f"{one!r} over a pivot")
        return self.value.as_expr()

    def __truediv__(self, other: int) -> Any:
        return self.value.as_expr() / other


def eliminated_springs(H: Any) -> tuple[list[Any], Any]:
    """What `certreg.verify.CheckedSprings.of` leaves of a form in symbols: entries, and over what.

    The form is of t, which stands first, and at most ten unknowns: others have zeros. Entries of
    what is left are by rows from the diagonal on. No pivot is taken to be zero. What the checker
    finds besides, of the lever, is left out.
    """
    ring, size = ring_of(flat(H)), H.rows
    met: list[Any] = []
    filled = sympy.zeros(ALL)
    filled[:size, :size] = H
    rows = upper([[Entry(e, met) for e in row] for row in _elements(ring, filled)])
    places = [at for at, pair in enumerate(_LEFT) if max(pair) < size]
    left = rerouted(
        vars(CheckedSprings)["of"].__func__,
        _quartic_terms=lambda: {at: {at: 1} for at in places},
        _dyadic=lambda number, _: number,
        Fraction=lambda *_: Entry(ring.zero, met),
    )
    form, over, free, *_ = left(lambda *parts: parts, rows, 0, moves=True)
    modelled(free == 0, "a pivot that is zero")
    return [entry.value.as_expr() for entry in form], over


def pivots_of(elimination: Callable[[Any], bool], matrix: Any) -> list[Any]:
    """The pivots whose sign an elimination asks for, of a symbolic square matrix."""
    ring = ring_of(flat(matrix))
    met: list[Any] = []
    elimination([[Pivoted(e, met) for e in row] for row in _elements(ring, matrix)])
    return met


def upper(rows: Sequence[Sequence[Any]]) -> list[list[Any]]:
    """The rows of a symmetric matrix from the diagonal on, as the checker's elimination takes."""
    return [list(row[i:]) for i, row in enumerate(rows)]


def _norm(row: Sequence[Any]) -> Any:
    return sum((entry * entry for entry in row[1:]), row[0] * row[0])


def _elements(ring: Any, matrix: Any) -> list[list[Any]]:
    return [_row(ring, row) for row in sympy.Matrix(matrix).tolist()]


def _row(ring: Any, entries: Any) -> list[Any]:
    return [ring.from_expr(sympy.sympify(entry)) for entry in entries]


def _expressions(rows: Sequence[Sequence[Any]]) -> Any:
    return sympy.Matrix([[entry.as_expr() for entry in row] for row in rows])
