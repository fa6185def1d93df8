"""Exact checks: polynomial identities, explicit combinations, positivity, finite facts.

Expressions are SymPy polynomials in symbols, or nested sequences or matrices of them. They are
multiplied out in a ring of sparse polynomials over the rationals; anything else than a polynomial
(a square root, a quotient, a float) is a TypeError: introduce a symbol and say what it satisfies.
What vanishes and what is positive are parts of the claim's hypotheses, and nothing else is.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy

from certreg.results import Ruling, Verdict

from .hypothesis import Condition, Hypothesis, Part
from .rings import Entries, flat, polynomial, ring_of
from .steps import _SEAL, Asserted, Kind, Sense, Step

if TYPE_CHECKING:
    from sympy.polys.rings import PolyElement, PolyRing

Term = tuple[Any, Part]  # a cofactor and a generator


@dataclass(frozen=True, slots=True)
class Square:
    """The square of a real expression: nonnegative; of a part that is not zero: positive."""

    base: Any


def identity(says: str, left: Entries, right: Entries) -> Step:
    """The step that two expressions, entry by entry, are the same polynomial."""
    a, b = _paired(says, left, right)
    ring = ring_of([*a, *b])
    first = [polynomial(ring, x) for x in a]
    differences = [x - polynomial(ring, y) for x, y in zip(first, b, strict=True)]
    asserted = Asserted(
        sense=Sense.ZERO,
        values=tuple(d for d in differences if d),
        sides=tuple(zip(a, b, strict=True)),
    )
    evidence = f"{_count(len(a), 'entry')}, {_terms(sum(map(len, first)))}"
    return _step(says, Kind.IDENTITY, asserted, differences, evidence)


def modulo(says: str, left: Entries, right: Entries, hypotheses: Sequence[Hypothesis]) -> Step:
    """The step that two expressions agree where the equations of the hypotheses hold.

    The cofactors are proposed by polynomial division and then multiplied out: the division itself
    need not be believed.
    """
    a, b = _paired(says, left, right)
    vanishing = [hypothesis[0].value for hypothesis in hypotheses]
    leads = [h.lead[0] for h in hypotheses if _vanishing(h[0]) and h.lead is not None]
    if len(leads) < len(hypotheses):
        raise TypeError(f"a hypothesis that eliminates no symbol: {says}")
    ring = ring_of([*a, *b, *vanishing], first=leads)
    generators = [polynomial(ring, g) for g in vanishing]
    apart = [polynomial(ring, x) - polynomial(ring, y) for x, y in zip(a, b, strict=True)]
    remainders, cofactors = [], [_divided(ring, rest, generators) for rest in apart]
    for rest, factors in zip(apart, cofactors, strict=True):
        parts = [factor * generator for factor, generator in zip(factors, generators, strict=True)]
        remainders.append(rest - sum(parts, start=ring.zero))
    used = sum(len(factor) for factors in cofactors for factor in factors)
    leans = {h for factors in cofactors for h, f in zip(hypotheses, factors, strict=True) if f}
    asserted = Asserted(
        sense=Sense.ZERO,
        values=tuple(apart),
        named=frozenset(hypotheses),
        leans=frozenset(leans),
        sides=tuple(zip(a, b, strict=True)),
    )
    evidence = f"{_count(len(a), 'entry')}, cofactors of {_terms(used)} multiplied out"
    return _step(says, Kind.COMBINATION, asserted, remainders, evidence)


def _divided(ring: PolyRing, rest: PolyElement, generators: list[PolyElement]) -> list[PolyElement]:
    return rest.div(generators)[0] if rest else [ring.zero] * len(generators)


def combination(says: str, element: Any, terms: Iterable[Term]) -> Step:
    """The step that an expression is the sum of cofactor * generator, which vanish by hypothesis.

    Membership in the ideal of the generators, with explicit cofactors that are multiplied out.
    """
    pairs = [(sympy.sympify(c), _vanishing(part)) for c, part in terms]
    element = sympy.sympify(element)
    ring = ring_of([element, *(e for c, part in pairs for e in (c, sympy.sympify(part.value)))])
    value = polynomial(ring, element)
    shares: dict[Hypothesis, Any] = {part.hypothesis: ring.zero for _, part in pairs}
    for cofactor, part in pairs:
        product = polynomial(ring, cofactor) * polynomial(ring, part.value)
        shares[part.hypothesis] = shares[part.hypothesis] + product
    rest = value - sum(shares.values(), start=ring.zero)
    asserted = Asserted(
        sense=Sense.ZERO,
        values=(value,),
        named=frozenset(shares),
        leans=frozenset(h for h, share in shares.items() if share),
    )
    evidence = f"{_count(len(pairs), 'cofactor')} multiplied out"
    return _step(says, Kind.COMBINATION, asserted, [rest], evidence)


def _vanishing(part: Part) -> Part:
    if type(part) is not Part or not part.hypothesis.generators:
        raise TypeError(f"no hypothesis says that {part} vanishes")
    return part


def contraction(cofactors: Entries, hypothesis: Hypothesis) -> list[Term]:
    """The pairs of entries whose products sum to tr(cofactors^T generators)."""
    return list(zip(flat(cofactors), hypothesis.parts, strict=True))


def nonnegative(says: str, element: Any, terms: Iterable[Sequence[Any]]) -> Step:
    """The step that an expression is a sum of products of nonnegative factors.

    A factor is a nonnegative rational number, a `Square`, or part of a hypothesis that says so.
    """
    return _positivity(says, element, [list(term) for term in terms], strict=False)


def positive(says: str, element: Any, terms: Iterable[Sequence[Any]]) -> Step:
    """The step that an expression is such a sum, with one product whose factors are all positive.

    Positive are: positive numbers, parts of a hypothesis that says positive (not nonnegative), and
    squares of such parts, or of parts that are not zero by hypothesis.
    """
    return _positivity(says, element, [list(term) for term in terms], strict=True)


def _positivity(says: str, element: Any, products: list[list[Any]], *, strict: bool) -> Step:
    bases = [[_base(factor) for factor in product] for product in products]
    element = sympy.sympify(element)
    ring = ring_of([element, *(base for product in bases for base in product)])
    value = polynomial(ring, element)
    made = [_product(ring, *pair) for pair in zip(products, bases, strict=True)]
    rest = value - sum(made, start=ring.zero)
    present = [product for product, known in zip(products, made, strict=True) if known]
    above = [product for product in present if all(map(_is_positive, product))]
    above = above or _above_at_each_entry(present)
    named = {h for product in products for factor in product for h in _named(factor)}
    leans = {h for product in present for factor in product for h in _because(factor)}
    strictly = {h for h in named if strict and all(h in _all_named(p) for p in above)}
    asserted = Asserted(
        sense=Sense.POSITIVE if strict else Sense.NONNEGATIVE,
        values=(value,),
        named=frozenset(named),
        leans=frozenset(leans | strictly),
        strictly=frozenset(strictly),
    )
    evidence = _count(len(products), "nonnegative product")
    if named:
        words = sorted({h.says.removesuffix(".") for h in named})
        evidence += "; by hypothesis: " + "; ".join(words)
    kind = Kind.STRICT if strict else Kind.POSITIVITY
    if strict and not above:
        words = "no product of positive factors among them: it may be zero"
        return _sealed(says, kind, _refuted(words), asserted)
    return _step(says, kind, asserted, [rest], evidence)


def _product(ring: PolyRing, factors: list[Any], bases: list[Any]) -> PolyElement:
    """The product of factors; the base of a square is a polynomial before it is squared."""
    found = ring.one
    for factor, base in zip(factors, bases, strict=True):
        value = polynomial(ring, base)
        found = found * (value * value if isinstance(factor, Square) else value)
    return found


def _above_at_each_entry(products: list[list[Any]]) -> list[list[Any]]:
    """Products of which one is positive, whichever entry of a vector is not zero; none if not."""
    named = {h for product in products for factor in product for h in _named(factor)}
    for h in named:
        entries = [k for k, value in enumerate(h.values) if value != 0]
        if h.form is not Condition.NONZERO:
            continue
        above = [[p for p in products if all(_is_positive(f, h[k]) for f in p)] for k in entries]
        if above and all(above):
            return [product for some in above for product in some]
    return []


def _is_positive(factor: Any, entry: Part | None = None) -> bool:
    """Whether a hypothesis, or being a positive number, makes a factor positive, not only >= 0.

    entry: one that is not zero, of a vector.
    """
    if isinstance(factor, Square):
        if entry is not None and factor.base == entry:
            return True
        return isinstance(factor.base, Part) and _is_not_zero(factor.base.hypothesis)
    if isinstance(factor, Part):
        return factor.hypothesis.form is Condition.POSITIVE
    return bool(sympy.sympify(factor) > 0)


def _is_not_zero(hypothesis: Hypothesis) -> bool:
    """Whether each value of a hypothesis is not zero; entries of an invertible matrix may be."""
    if hypothesis.form is Condition.INVERTIBLE:
        return hypothesis.columns == 1
    return hypothesis.form is Condition.POSITIVE


def _named(factor: Any) -> list[Hypothesis]:
    part = factor.base if isinstance(factor, Square) else factor
    return [part.hypothesis] if isinstance(part, Part) else []


def _because(factor: Any) -> list[Hypothesis]:
    """The hypothesis by which a factor is not negative; a square needs none."""
    return [] if isinstance(factor, Square) else _named(factor)


def _all_named(product: Sequence[Any]) -> set[Hypothesis]:
    return {h for factor in product for h in _named(factor)}


def facts(says: str, found: Sequence[Any], expected: Sequence[Any]) -> Step:
    """The step that values computed exactly (integers, fractions, words) are as told."""
    if len(found) != len(expected) or not found:
        raise ValueError(f"{len(found)} facts against {len(expected)}: {says}")
    pairs = list(zip(found, expected, strict=True))
    wrong = [(a, b) for a, b in pairs if _exact(a, says) != _exact(b, says)]
    if wrong:
        words = f"found {wrong[0][0]!r}, expected {wrong[0][1]!r}"
        return _sealed(says, Kind.FACTS, _refuted(words))
    return _sealed(says, Kind.FACTS, _proved(f"{_count(len(found), 'fact')}"))


def _exact(value: Any, says: str) -> tuple[Any, ...]:
    """A value to be compared, with its type: numbers, words, None, enums, and tuples of these.

    Nothing else, and no subclass: its own comparison might say that it equals anything.
    """
    kind = type(value)
    if kind in {int, Fraction}:
        return "number", value
    if kind in {bool, str, type(None)}:
        return kind, value
    if kind in {tuple, list, frozenset}:
        entries = [_exact(entry, says) for entry in value]
        return kind, frozenset(entries) if kind is frozenset else tuple(entries)
    if isinstance(value, enum.Enum) and not isinstance(value, float | complex):
        return kind, id(value)
    nothing = "a floating-point number" if isinstance(value, float | sympy.Float) else kind.__name__
    raise TypeError(f"{nothing} proves nothing: {says}")


def refuting(says: str, found: Sequence[Any], told: Sequence[Any]) -> Step:
    """The step that values computed exactly are not as a false statement has them."""
    wrong = facts(says, found, told).verdict
    words = f"{wrong.words} by the statement" if not wrong.proved else "they are as stated"
    verdict = _refuted(words) if wrong.proved else _proved(words)
    return _sealed(says, Kind.FACTS, verdict)


_SIGNS = {
    Condition.POSITIVE: {1},
    Condition.NONNEGATIVE: {0, 1},
    Condition.VANISHES: {0},
    Condition.INVERTIBLE: {-1, 1},
}


def cases(
    says: str, branches: Sequence[Hypothesis], *, unless: Entries = (), whole: bool = False
) -> Step:
    """The step that one of several conditions always holds, unless all entries of a vector vanish.

    By their form: conditions on one expression, or its negative, that leave no sign out; with
    `unless`, that each of its entries is not zero; with `whole`, that a whole number is not
    negative, or is at most -1.
    """
    if any(len(b.values) != 1 or b.further is not None for b in branches) or not branches:
        raise TypeError(f"cases are conditions on one expression each: {says}")
    vector = [entry for entry in flat(unless) if entry != 0]
    ring = ring_of([*vector, *(branch.values[0] for branch in branches)])
    forms = [(branch.form, polynomial(ring, branch.values[0])) for branch in branches]
    if vector:
        words = "an entry of a vector that is not zero"
        nonzero = {value.monic() for form, value in forms if form is Condition.INVERTIBLE}
        covered = {polynomial(ring, entry).monic() for entry in vector} <= nonzero
    elif whole:
        words = "a whole number, or one less than its negative"
        covered = [form for form, _ in forms] == [Condition.NONNEGATIVE] * 2 and (
            forms[0][1] + forms[1][1] == -1
        )
    else:
        words = "every sign"
        covered = {sign for form, value in forms for sign in _signs(form, value, forms[0][1])} == {
            -1,
            0,
            1,
        }
    verdict = _proved(f"{_count(len(branches), 'case')}: {words}")
    if not covered:
        verdict = _refuted("they leave a case out")
    return Step(says=says, kind=Kind.CASES, verdict=verdict, covers=frozenset(branches), seal=_SEAL)


def _signs(form: Condition, value: PolyElement, first: PolyElement) -> set[int]:
    """The signs of the first expression at which a condition on this one holds; none if others."""
    if not value or value.monic() != first.monic():
        return set()
    side = 1 if value.LC * first.LC > 0 else -1
    return {side * sign for sign in _SIGNS[form]}


def quoted(says: str, *, theorem: str, source: str) -> Step:
    """A step that rests on a theorem of the literature; said to be so wherever it is shown."""
    verdict = Verdict(ruling=Ruling.INCONCLUSIVE, words=f"quoted from {source}, not proved here")
    return Step(says=says, kind=Kind.QUOTED, verdict=verdict, theorem=theorem, seal=_SEAL)


def _paired(says: str, left: Entries, right: Entries) -> tuple[list[Any], list[Any]]:
    a, b = flat(left), flat(right)
    if isinstance(left, sympy.MatrixBase) and isinstance(right, sympy.MatrixBase):
        (m, n), (k, o) = left.shape, right.shape
        if (m, n) != (k, o):
            raise ValueError(f"a matrix of {m}x{n} against {k}x{o}: {says}")
    if len(a) != len(b):
        raise ValueError(f"{len(a)} entries against {len(b)}: {says}")
    if not a:
        raise ValueError(f"nothing is compared: {says}")
    return a, b


def _base(factor: Any) -> Any:
    """The expression that is a factor, or whose square is one; TypeError if it may be negative."""
    if type(factor) is Square:
        base = factor.base
        return base.hypothesis.values[base.index] if type(base) is Part else sympy.sympify(base)
    if type(factor) is Part:
        if factor.hypothesis.form not in {Condition.POSITIVE, Condition.NONNEGATIVE}:
            raise TypeError(f"nobody said why {factor.value} is nonnegative")
        return sympy.sympify(factor.value)
    number = sympy.sympify(factor)
    if not (number.is_Rational and number >= 0):
        raise TypeError(f"nobody said why {factor} is nonnegative")
    return number


def _step(
    says: str, kind: Kind, asserted: Asserted, rests: Sequence[PolyElement], evidence: str
) -> Step:
    wrong = [rest for rest in rests if rest]
    verdict = _proved(evidence)
    if wrong:
        rest = str(wrong[0])
        short = rest if len(rest) < 100 else rest[:97] + "..."
        verdict = _refuted(f"{len(wrong)} of {len(rests)} entries leave a rest, the first {short}")
    return _sealed(says, kind, verdict, asserted)


def _sealed(says: str, kind: Kind, verdict: Verdict, asserted: Asserted | None = None) -> Step:
    return Step(says=says, kind=kind, verdict=verdict, asserted=asserted, seal=_SEAL)


def _proved(words: str) -> Verdict:
    return Verdict(ruling=Ruling.PROVED, words=words)


def _refuted(words: str) -> Verdict:
    return Verdict(ruling=Ruling.REFUTED, words=words)


def _count(number: int, noun: str) -> str:
    plural = noun[:-1] + "ies" if noun.endswith("y") else noun + "s"
    return f"{number} {noun if number == 1 else plural}"


def _terms(number: int) -> str:
    return _count(number, "term")
