"""Instances: rational points at which hypotheses hold and a statement does not.

Found by trying small integers, putting right what hypotheses ask, and evaluated exactly: the search
proposes, the evaluation decides.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, product
from typing import Any

import sympy

from .hypothesis import Condition, Hypothesis, Point, Standing
from .rings import Surd, rational
from .steps import Asserted

TRIES = 300  # points; the claims of the book need fewer than 160


@dataclass(frozen=True, slots=True, kw_only=True)
class Instance:
    """A point at which a step's statement is false, and the value that shows it."""

    point: tuple[tuple[sympy.Symbol, Fraction], ...]
    value: Fraction
    wanted: str

    @property
    def words(self) -> str:
        """The point, without the symbols that are zero, and the value."""
        told = [f"{symbol} = {value}" for symbol, value in self.point if value]
        if len(told) < len(self.point):
            told.append("all else 0" if told else "zero")
        if not told:
            return f"everywhere: {self.value}, not {self.wanted}"
        at = ", ".join(told)
        return f"at {at}: {self.value}, not {self.wanted}"


def counterexample(
    asserted: Asserted,
    hypotheses: Sequence[Hypothesis],
    violated: Hypothesis | None = None,
    *,
    first: Mapping[sympy.Symbol, Any],
) -> Instance | None:
    """An instance of the hypotheses at which what is asserted is false; None if none was found.

    violated: a hypothesis that shall not hold there. first: a point to try before all others.
    """
    held = _in_force(asserted, hypotheses, violated)
    symbols = asserted.symbols.union(*(h.symbols for h in held))
    if violated is not None:
        symbols |= violated.symbols
    told: Point = dict.fromkeys(symbols, Fraction(0))
    told |= {symbol: Fraction(value) for symbol, value in first.items()}
    proposed = [told] if first and (_hold(held, told) or _solve(held, told)) else []
    for point in chain(proposed, _points(sorted(symbols, key=str), held, violated)):
        if not _hold(held, point):
            continue
        wrong = asserted.wrong_at(point)
        if wrong is None or not all(h.holds_at(point) for h in held):
            continue
        if violated is None or violated.fails_at(point):
            return _instance(asserted, violated, point, wrong)
    return None


def witness(hypotheses: Sequence[Hypothesis], first: Mapping[sympy.Symbol, Any]) -> Point | None:
    """A point at which all the hypotheses hold, decided exactly; None if none was found.

    first: a point to try before all others; then the hypotheses' examples, then small numbers.
    """
    symbols = frozenset[sympy.Symbol]().union(*(h.symbols for h in hypotheses))
    proposed = [first, *(h.example for h in hypotheses if h.example)]
    points: list[Any] = [
        dict.fromkeys(symbols, Fraction(0))
        | {s: v if isinstance(v, Surd) else Fraction(v) for s, v in told.items()}
        for told in proposed
    ]
    drawn = _points(sorted(symbols, key=str), hypotheses, None)
    for point in chain(points, drawn):
        if all(h.holds_at(point) for h in hypotheses):
            return point
    return None


def _hold(held: Sequence[Hypothesis], point: Point) -> bool:
    return all(hypothesis.values_hold(point) for hypothesis in held)


def _instance(
    asserted: Asserted, violated: Hypothesis | None, point: Point, wrong: Fraction
) -> Instance:
    symbols = asserted.symbols | (violated.symbols if violated else frozenset[sympy.Symbol]())
    shown = tuple((s, point[s]) for s in sorted(symbols, key=str))
    return Instance(point=shown, value=wrong, wanted=asserted.sense.value)


def _in_force(
    asserted: Asserted, hypotheses: Sequence[Hypothesis], violated: Hypothesis | None
) -> list[Hypothesis]:
    """The hypotheses on the symbols of a step: those that it names, and those in force everywhere.

    Of hypotheses with the same words, said of several frames, those that the step names.
    """
    named = asserted.named
    words = {h.says for h in named} | ({violated.says} if violated else set())
    held = [h for h in named if h is not violated]
    symbols = asserted.symbols.union(*(h.symbols for h in held))
    everywhere = [
        h
        for h in hypotheses
        if h.standing is not Standing.CASE and h not in named and h.says not in words
    ]
    for _ in everywhere:  # until nothing is added
        for h in everywhere:
            if h not in held and h.symbols & symbols:
                held.append(h)
                symbols |= h.symbols
    order = {h: k for k, h in enumerate(hypotheses)}
    return sorted(held, key=lambda h: order.get(h, len(order)))


def _points(
    symbols: Sequence[sympy.Symbol], held: Sequence[Hypothesis], violated: Hypothesis | None
) -> Iterator[Point]:
    """Points of small numbers, changed so that the hypotheses hold, where that can be done."""
    draws = _draws()
    for trial in range(TRIES):
        choices = [next(draws) for _ in symbols]
        point: Point = {
            symbol: Fraction((draw % 2, draw % 3 - 1, draw % 7 - 3)[trial % 3])
            for symbol, draw in zip(symbols, choices, strict=True)
        }
        if trial < TRIES // 2:
            flat = violated is not None and violated.form is Condition.INVERTIBLE
            point |= {s: v for s, v in _of_a_body(draws, flat=flat).items() if s in point}
        if violated is not None:
            _break(violated, point, trial)
        for hypothesis in held:
            _prepare(hypothesis, point)
        if _solve(held, point):
            yield point


def _draws() -> Iterator[int]:
    """Numbers of little pattern, the same in every run."""
    state = 12345
    while True:
        state = (state * 1103515245 + 12345) % 2**31
        yield state >> 16


def _of_a_body(draws: Iterator[int], *, flat: bool) -> Point:
    """The moments of four points of mass one, about their means; inertia, damping and step size.

    So that an instance is a body and no mere assignment of numbers to letters. flat: the points
    lie on a line.
    """
    points = [[Fraction(next(draws) % 3 - 1) for _ in range(6)] for _ in range(3)]
    if flat:
        points = [[p[0], *[Fraction(0)] * 2, *p[3:]] for p in points]
    points.append([-sum(column, start=Fraction(0)) for column in zip(*points, strict=True)])
    total = [[sum(p[i] * p[j] for p in points) for j in range(6)] for i in range(6)]
    trace = total[0][0] + total[1][1] + total[2][2]
    found: dict[str, Any] = {"M": 4, "mu": 1 + next(draws) % 2, "h": 1 + next(draws) % 2}
    found |= {f"m_{k}": 1 + next(draws) % 2 for k in range(1, 6)}
    for i, j in product(range(3), repeat=2):
        place = f"{i + 1}{j + 1}"
        found[f"C_{place}"] = total[3 + i][j]
        found |= {f"S_{place}": total[i][j], f"T_{place}": total[3 + i][3 + j]}
        found[f"J_{place}"] = (trace if i == j else 0) - total[i][j]
    return {sympy.Symbol(name, real=True): Fraction(value) for name, value in found.items()}


def _break(violated: Hypothesis, point: Point, trial: int) -> None:
    """A number that shall be positive is zero, or -1 in every second try."""
    if violated.form in {Condition.POSITIVE, Condition.NONNEGATIVE}:
        strict = violated.form is Condition.POSITIVE
        for value in violated.values:
            if isinstance(value, sympy.Symbol):
                point[value] = Fraction(0 if strict and trial % 2 == 0 else -1)
    elif violated.form is Condition.NONZERO:
        point |= {value: Fraction(0) for value in violated.values if value in point}
    elif violated.form is Condition.INVERTIBLE and violated.standing is not Standing.NOTATION:
        row = violated.values[: violated.columns]
        point |= {value: Fraction(0) for value in row if value in point}


def _prepare(hypothesis: Hypothesis, point: Point) -> None:
    if hypothesis.prepare is not None:
        point |= {s: Fraction(v) for s, v in hypothesis.prepare(point).items()}
    elif hypothesis.form in {Condition.POSITIVE, Condition.NONNEGATIVE}:
        least = 1 if hypothesis.form is Condition.POSITIVE else 0
        for value in hypothesis.values:
            if isinstance(value, sympy.Symbol):
                point[value] = max(abs(point[value]), Fraction(least))


def _solve(held: Sequence[Hypothesis], point: Point) -> bool:
    """Solve the hypotheses that are linear in some symbols for these; False if that fails."""
    unknowns = list(dict.fromkeys(s for h in held for s in h.solves))
    if not unknowns:
        return True
    rows = [
        row for h in held if h.solves for row in (_row(e, unknowns, point) for e in h.equations)
    ]
    if any(row is None for row in rows):
        return False
    solved = _eliminated([row for row in rows if row is not None], unknowns, point)
    if solved is None:
        return False
    point |= solved
    return True


def _row(equation: Any, unknowns: Sequence[sympy.Symbol], point: Point) -> list[Fraction] | None:
    """The coefficients of the unknowns and the constant; None if it is not linear in them."""
    row = [Fraction(0)] * (len(unknowns) + 1)
    at = {symbol: unknowns.index(symbol) for symbol in equation.ring.symbols if symbol in unknowns}
    for powers, coefficient in equation.terms():
        term, place = rational(coefficient), len(unknowns)
        for symbol, power in zip(equation.ring.symbols, powers, strict=True):
            if not power:
                continue
            if symbol in at:
                if power > 1 or place != len(unknowns):
                    return None
                place = at[symbol]
            else:
                term *= point[symbol] ** power
        row[place] += term
    return row


def _eliminated(
    rows: list[list[Fraction]], unknowns: Sequence[sympy.Symbol], point: Point
) -> Point | None:
    """The unknowns by elimination, those that remain free as they were; None if none solve it."""
    pivots: list[tuple[int, list[Fraction]]] = []
    for row in rows:
        for column, pivot in pivots:
            factor = row[column]
            if factor:
                row[:] = [a - factor * b for a, b in zip(row, pivot, strict=True)]
        column = next((k for k, entry in enumerate(row[:-1]) if entry), None)
        if column is None:
            if row[-1]:
                return None
            continue
        lead = row[column]
        pivots.append((column, [entry / lead for entry in row]))
    found: Point = {symbol: point[symbol] for symbol in unknowns}
    for column, row in reversed(pivots):
        rest = sum((row[k] * found[s] for k, s in enumerate(unknowns) if k != column), row[-1])
        found[unknowns[column]] = -rest
    return found
