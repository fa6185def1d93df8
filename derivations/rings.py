"""Expressions as sparse polynomials over the rationals, and their values at rational points."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import islice
from typing import Any

import sympy
from sympy.polys.domains import QQ
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyElement, PolyRing

RATIONALS = frozenset(map(type, map(sympy.Rational, (0, 1, -1, 2, "1/2", "2/3"))))
SUMS_AND_PRODUCTS = frozenset({sympy.Add, sympy.Mul})

Entries = Any  # a SymPy expression, a number, or nested sequences or matrices of them


def flat(entries: Entries) -> list[Any]:
    """The scalars of nested sequences or matrices, row by row."""
    if isinstance(entries, sympy.MatrixBase):
        return [entries[k] for k in range(len(entries))]
    if isinstance(entries, (list, tuple)):
        return [scalar for entry in entries for scalar in flat(entry)]
    return [sympy.sympify(entries)]


NODES = 45  # of one side of an equation that is shown: about a line


def is_short(expression: Any) -> bool:
    """Whether an expression has few nodes; it is not counted further than that."""
    return sum(1 for _ in islice(sympy.preorder_traversal(expression), NODES + 1)) <= NODES


def ring_of(expressions: Iterable[Any], first: Sequence[sympy.Symbol] = ()) -> PolyRing:
    """The ring Q[symbols] of all symbols in the expressions, lexicographic, `first` in front."""
    symbols: set[sympy.Symbol] = set()
    for expression in expressions:
        symbols |= getattr(expression, "free_symbols", set())
    rest = sorted(symbols - set(first), key=lambda s: s.name)
    return PolyRing([*first, *rest], QQ, lex) if symbols or first else PolyRing(["unused"], QQ, lex)


def polynomial(ring: PolyRing, expression: Any) -> PolyElement:
    """The expression multiplied out; TypeError for anything but a rational polynomial.

    Its symbols are real, and nothing else is known of them: SymPy takes the root of p^2 for p where
    a symbol is declared positive.
    """
    return _multiplied_out(ring, sympy.sympify(expression))


@lru_cache(maxsize=10_000)  # a control repeats most steps of the proof that it mutates
def _multiplied_out(ring: PolyRing, expression: sympy.Expr) -> PolyElement:
    _check_nodes(expression)
    try:
        return ring.from_expr(expression)
    except ValueError as error:
        raise TypeError(f"not a polynomial with rational coefficients: {expression}") from error


def _check_nodes(expression: sympy.Expr) -> None:
    """Nothing but sums, products, powers with natural exponents, rationals and real symbols."""
    left: list[Any] = [expression]
    while left:
        node = left.pop()
        if isinstance(node, sympy.Float):
            raise TypeError(f"a floating-point number proves nothing: {expression}")
        if isinstance(node, sympy.Symbol):
            if type(node) is not sympy.Symbol or node != sympy.Symbol(node.name, real=True):
                raise TypeError(f"{node} is not a real symbol of which nothing else is known")
        elif type(node) in SUMS_AND_PRODUCTS or _is_power(node):
            left.extend(node.args)
        elif type(node) not in RATIONALS:
            raise TypeError(f"not a polynomial with rational coefficients: {expression}")


def _is_power(node: Any) -> bool:
    return type(node) is sympy.Pow and isinstance(node.exp, sympy.Integer) and node.exp >= 0


def polynomials(expressions: Sequence[Any]) -> list[PolyElement]:
    """The expressions multiplied out, in a ring of their own."""
    ring = ring_of(map(sympy.sympify, expressions))
    return [polynomial(ring, expression) for expression in expressions]


def symbols_of(element: PolyElement) -> set[sympy.Symbol]:
    """The symbols that occur in a polynomial, without those of its ring that do not."""
    occur = element.degrees() if element else ()
    return {symbol for symbol, degree in zip(element.ring.symbols, occur, strict=False) if degree}


@dataclass(frozen=True, slots=True)
class Surd:
    """The number a + b sqrt(n) with n > 0 no square, whose sign is decided exactly."""

    a: Fraction | int
    b: Fraction | int
    n: int

    def __add__(self, other: Any) -> Surd:
        a, b = (other.a, other.b) if isinstance(other, Surd) else (other, 0)
        return Surd(self.a + a, self.b + b, self.n)

    def __mul__(self, other: Any) -> Surd:
        a, b = (other.a, other.b) if isinstance(other, Surd) else (other, 0)
        return Surd(self.a * a + self.b * b * self.n, self.a * b + self.b * a, self.n)

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, power: int) -> Surd:
        return self if power == 1 else self * self ** (power - 1)

    def __bool__(self) -> bool:
        return bool(self.a or self.b)

    def __gt__(self, other: int) -> bool:
        a = self.a - other
        if a * self.b >= 0:
            return a > 0 or self.b > 0
        return (a * a > self.b * self.b * self.n) == (a > 0)

    def __ge__(self, other: int) -> bool:
        return self > other or not self + -other


def value_at(element: PolyElement, point: Mapping[sympy.Symbol, Any]) -> Any:
    """The value of a polynomial where its symbols have these values; KeyError if one has none."""
    total: Any = 0
    symbols = element.ring.symbols
    for powers, coefficient in element.terms():
        term: Any = _plain(rational(coefficient))
        for symbol, power in zip(symbols, powers, strict=True):
            if power:
                term *= _plain(point[symbol]) ** power
                if not term:
                    break
        total += term
    return total if isinstance(total, Surd) else Fraction(total)


def _plain(value: Any) -> Any:
    """The same number; most are integers, which are reckoned with ten times faster."""
    if isinstance(value, Surd):
        return value
    return value.numerator if value.denominator == 1 else value


def rational(coefficient: Any) -> Fraction:
    """A coefficient of a polynomial as a fraction."""
    return Fraction(int(coefficient.numerator), int(coefficient.denominator))
