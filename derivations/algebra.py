"""Exact checks: polynomial identities, explicit combinations, positivity, finite facts.

Expressions are SymPy polynomials in symbols, or nested sequences or matrices of them. They are
multiplied out in a ring of sparse polynomials over the rationals; anything else than a polynomial
(a square root, a quotient, a float) is a TypeError: introduce a symbol and say what it satisfies.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import sympy
from sympy.polys.domains import QQ
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyElement, PolyRing

from certreg.results import Ruling, Verdict

from .kernel import Kind, Step

Entries = Any  # a SymPy expression, a number, or nested sequences or matrices of them


@dataclass(frozen=True, slots=True)
class Relation:
    """An equation that holds by hypothesis: `lead`^`power` equals `value`, free of the lead."""

    lead: sympy.Symbol
    power: int
    value: Any

    @property
    def vanishing(self) -> Any:
        """lead^power - value."""
        return self.lead**self.power - self.value


@dataclass(frozen=True, slots=True)
class Square:
    """The square of a real expression: nonnegative."""

    base: Any


@dataclass(frozen=True, slots=True)
class Given:
    """An expression that is nonnegative by hypothesis, which `because` names."""

    value: Any
    because: str


def identity(says: str, left: Entries, right: Entries) -> Step:
    """The step that two expressions, entry by entry, are the same polynomial."""
    a, b = flat(left), flat(right)
    if len(a) != len(b):
        raise ValueError(f"{len(a)} entries against {len(b)}: {says}")
    ring = ring_of([*a, *b])
    differences = [_polynomial(ring, x) - _polynomial(ring, y) for x, y in zip(a, b, strict=True)]
    terms = sum(len(_polynomial(ring, x)) for x in a)
    return _step(says, Kind.IDENTITY, differences, f"{_count(len(a), 'entry')}, {_terms(terms)}")


def modulo(says: str, left: Entries, right: Entries, relations: Sequence[Relation]) -> Step:
    """The step that two expressions agree where the relations hold.

    The cofactors are proposed by polynomial division and then multiplied out: the division itself
    need not be believed.
    """
    a, b = flat(left), flat(right)
    if len(a) != len(b):
        raise ValueError(f"{len(a)} entries against {len(b)}: {says}")
    vanishing = [relation.vanishing for relation in relations]
    ring = ring_of([*a, *b, *vanishing], first=[relation.lead for relation in relations])
    generators = [_polynomial(ring, g) for g in vanishing]
    remainders: list[PolyElement] = []
    used = 0
    for x, y in zip(a, b, strict=True):
        difference = _polynomial(ring, x) - _polynomial(ring, y)
        cofactors = difference.div(generators)[0] if difference else [ring.zero] * len(generators)
        for cofactor, generator in zip(cofactors, generators, strict=True):
            difference = difference - cofactor * generator
        remainders.append(difference)
        used += sum(map(len, cofactors))
    evidence = f"{_count(len(a), 'entry')}, cofactors of {_terms(used)} multiplied out"
    return _step(says, Kind.COMBINATION, remainders, evidence)


def combination(says: str, element: Any, terms: Iterable[tuple[Any, Any]]) -> Step:
    """The step that an expression is the sum of cofactor * generator, which vanish by hypothesis.

    Membership in the ideal of the generators, with explicit cofactors that are multiplied out.
    """
    pairs = [(sympy.sympify(c), sympy.sympify(g)) for c, g in terms]
    element = sympy.sympify(element)
    ring = ring_of([element, *(e for pair in pairs for e in pair)])
    rest = _polynomial(ring, element)
    for cofactor, generator in pairs:
        rest = rest - _polynomial(ring, cofactor) * _polynomial(ring, generator)
    return _step(says, Kind.COMBINATION, [rest], f"{_count(len(pairs), 'cofactor')} multiplied out")


def contraction(cofactors: Entries, generators: Entries) -> list[tuple[Any, Any]]:
    """The pairs of entries whose products sum to tr(cofactors^T generators)."""
    return list(zip(flat(cofactors), flat(generators), strict=True))


def nonnegative(says: str, element: Any, terms: Iterable[Sequence[Any]]) -> Step:
    """The step that an expression is a sum of products of nonnegative factors.

    A factor is a nonnegative rational number, a `Square`, or `Given` by a hypothesis.
    """
    products = [list(term) for term in terms]
    factors = [factor for product in products for factor in product]
    values = [_nonnegative_value(factor) for factor in factors]
    element = sympy.sympify(element)
    ring = ring_of([element, *values])
    rest = _polynomial(ring, element)
    for product in products:
        part = ring.one
        for factor in product:
            part = part * _polynomial(ring, _nonnegative_value(factor))
        rest = rest - part
    hypotheses = sorted({factor.because for factor in factors if isinstance(factor, Given)})
    evidence = _count(len(products), "nonnegative product")
    if hypotheses:
        evidence += "; nonnegative by hypothesis: " + ", ".join(hypotheses)
    return _step(says, Kind.POSITIVITY, [rest], evidence)


def facts(says: str, found: Sequence[Any], expected: Sequence[Any]) -> Step:
    """The step that values computed exactly (integers, fractions, words) are as told."""
    if len(found) != len(expected) or not found:
        raise ValueError(f"{len(found)} facts against {len(expected)}: {says}")
    for value in (*found, *expected):
        if isinstance(value, (float, sympy.Float)):
            raise TypeError(f"a floating-point number proves nothing: {says}")
    wrong = [(a, b) for a, b in zip(found, expected, strict=True) if a != b]
    if wrong:
        words = f"found {wrong[0][0]!r}, expected {wrong[0][1]!r}"
        return Step(says=says, kind=Kind.FACTS, verdict=_refuted(words))
    return Step(says=says, kind=Kind.FACTS, verdict=_proved(f"{_count(len(found), 'fact')}"))


def quoted(says: str, *, source: str) -> Step:
    """A step that rests on a theorem of the literature; said to be so wherever it is shown."""
    verdict = Verdict(ruling=Ruling.INCONCLUSIVE, words=f"quoted from {source}, not proved here")
    return Step(says=says, kind=Kind.QUOTED, verdict=verdict)


def flat(entries: Entries) -> list[Any]:
    """The scalars of nested sequences or matrices, row by row."""
    if isinstance(entries, sympy.MatrixBase):
        return [entries[k] for k in range(len(entries))]
    if isinstance(entries, (list, tuple)):
        return [scalar for entry in entries for scalar in flat(entry)]
    return [sympy.sympify(entries)]


def ring_of(expressions: Iterable[Any], first: Sequence[sympy.Symbol] = ()) -> PolyRing:
    """The ring Q[symbols] of all symbols in the expressions, lexicographic, `first` in front."""
    symbols: set[sympy.Symbol] = set()
    for expression in expressions:
        symbols |= getattr(expression, "free_symbols", set())
    rest = sorted(symbols - set(first), key=lambda s: s.name)
    return PolyRing([*first, *rest], QQ, lex) if symbols or first else PolyRing(["unused"], QQ, lex)


def _polynomial(ring: PolyRing, expression: Any) -> PolyElement:
    expression = sympy.sympify(expression)
    if expression.has(sympy.Float):
        raise TypeError(f"a floating-point number proves nothing: {expression}")
    try:
        return ring.from_expr(expression)
    except ValueError as error:
        raise TypeError(f"not a polynomial with rational coefficients: {expression}") from error


def _nonnegative_value(factor: Any) -> Any:
    if isinstance(factor, Square):
        return sympy.sympify(factor.base) ** 2
    if isinstance(factor, Given):
        return sympy.sympify(factor.value)
    number = sympy.sympify(factor)
    if not (number.is_Rational and number >= 0):
        raise TypeError(f"nobody said why {factor} is nonnegative")
    return number


def _step(says: str, kind: Kind, rests: Sequence[PolyElement], evidence: str) -> Step:
    wrong = [rest for rest in rests if rest]
    if wrong:
        rest = str(wrong[0].as_expr())
        short = rest if len(rest) < 100 else rest[:97] + "..."
        words = f"{len(wrong)} of {len(rests)} entries leave a rest, the first {short}"
        return Step(says=says, kind=kind, verdict=_refuted(words))
    return Step(says=says, kind=kind, verdict=_proved(evidence))


def _proved(words: str) -> Verdict:
    return Verdict(ruling=Ruling.PROVED, words=words)


def _refuted(words: str) -> Verdict:
    return Verdict(ruling=Ruling.REFUTED, words=words)


def _count(number: int, noun: str) -> str:
    plural = noun[:-1] + "ies" if noun.endswith("y") else noun + "s"
    return f"{number} {noun if number == 1 else plural}"


def _terms(number: int) -> str:
    return _count(number, "term")
