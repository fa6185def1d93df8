"""Whether a notation is one: what it says of a letter can be had for any data.

A hypothesis whose standing is NOTATION is printed as setting, not as an assumption. So each of its
equations must be solvable for a letter of its own: linear, with a coefficient that is not zero; of
odd degree, monic; or k^2 = e with e >= 0. Signs are read off the terms. Its letter occurs in no
other hypothesis, but in notations that come after it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy

from .hypothesis import Condition, Hypothesis, Standing
from .rings import polynomials, rational, symbols_of

Symbols = frozenset[sympy.Symbol]


def no_notation(hypotheses: Sequence[Hypothesis]) -> str:
    """Why a notation among the hypotheses of a claim may be an assumption; empty if none may."""
    for number, h in enumerate(hypotheses):
        if h.standing is not Standing.NOTATION:
            continue
        before = [
            o
            for k, o in enumerate(hypotheses)
            if (k < number or o.standing is not Standing.NOTATION) and not _roots_sign(o, h)
        ]
        elsewhere = Symbols().union(*(o.symbols for o in before if o is not h))
        if h.form in {Condition.NONNEGATIVE, Condition.POSITIVE}:
            if not any(_roots_sign(h, other) for other in hypotheses):
                return f"the notation {h.says!r} is not solved for a letter"
            continue
        letters = _letters(h, hypotheses)
        if letters is None:
            return f"the notation {h.says!r} is not solved for a letter"
        if shared := sorted(letters & elsewhere, key=str):
            return (
                f"{shared[0]}, for which the notation {h.says!r} is solved, occurs in another one"
            )
    return ""


def _roots_sign(h: Hypothesis, root: Hypothesis) -> bool:
    """Whether it says of k that it is not negative, where the other says k^2 = e."""
    own = {root.lead[0]} if root.lead is not None and root.lead[1] == 2 else set[Any]()
    return (
        h.form is Condition.NONNEGATIVE
        and root.standing is Standing.NOTATION
        and set(h.values) == own
    )


def _letters(h: Hypothesis, hypotheses: Sequence[Hypothesis]) -> Symbols | None:
    """The letters for which the equations of a notation are solved; None if they are not."""
    if h.form is Condition.INVERTIBLE:
        positive = h.generators and all(_is_above(v, hypotheses, h) for v in polynomials(h.values))
        return frozenset(h.solves) if positive and h.columns == 1 else None
    if h.lead is not None:
        symbol, power = h.lead
        rest = polynomials([symbol**power - h.values[0]])[0]
        even = power == 2 and _is_above(rest, hypotheses, h, strictly=False)
        free = symbol not in symbols_of(rest) and len(h.values) == 1
        return frozenset({symbol}) if free and (power % 2 == 1 or even) else None
    found: dict[Any, sympy.Symbol] = {}
    for value in dict.fromkeys(h.values):
        symbol = next((s for s in h.solves if _is_linear(value, s, h, hypotheses)), None)
        if symbol is None or symbol in found.values():
            return None
        found[value] = symbol
    letters = frozenset(found.values())
    others = all(letters & value.free_symbols == {symbol} for value, symbol in found.items())
    return letters if others else None


def _is_linear(
    value: Any, symbol: sympy.Symbol, h: Hypothesis, hypotheses: Sequence[Hypothesis]
) -> bool:
    if symbol not in value.free_symbols:
        return False
    coefficient = sympy.diff(value, symbol)
    if symbol in coefficient.free_symbols:
        return False
    (above, below) = polynomials([coefficient, -coefficient])
    return _is_above(above, hypotheses, h) or _is_above(below, hypotheses, h)


def _is_above(
    element: Any, hypotheses: Sequence[Hypothesis], h: Hypothesis, *, strictly: bool = True
) -> bool:
    """Whether each term of a polynomial is nonnegative, and one positive if it is so strictly."""
    standing = [o for o in hypotheses if o is not h and o.standing is not Standing.CASE]
    above = {v for o in standing if o.form is Condition.POSITIVE for v in o.values}
    least = above | {v for o in standing if o.form is Condition.NONNEGATIVE for v in o.values}
    above |= {root for root in least if any(_is_root(root, o) for o in standing)}
    one = not strictly
    for powers, coefficient in element.terms():
        named = [(s, p) for s, p in zip(element.ring.symbols, powers, strict=True) if p]
        if rational(coefficient) < 0 or any(p % 2 and s not in least for s, p in named):
            return False
        one |= all(s in above for s, _ in named)
    return one


def _is_root(symbol: Any, h: Hypothesis) -> bool:
    """Whether the hypothesis says symbol^2 = e with e > 0, by the signs of its terms."""
    if h.lead != (symbol, 2):
        return False
    (rest,) = polynomials([symbol**2 - h.values[0]])
    constant = any(not any(powers) for powers, _ in rest.terms())
    return constant and all(
        rational(coefficient) > 0 and not any(p % 2 for p in powers)
        for powers, coefficient in rest.terms()
    )
