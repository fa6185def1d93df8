"""SymPy expressions as CasADi functions, one operation for one operation.

Sums, products, integer powers and square roots become the same in CasADi, and equal subexpressions
are computed once. One rewriting: terms with equal numbers before them are added, then multiplied.
A module of its own: it knows SymPy and no C, and `emit` knows C and no SymPy.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import reduce
from operator import mul
from typing import Any

_Signed = tuple[Any, Any]  # whether it is to be subtracted, and a CasADi expression


@dataclass(frozen=True, slots=True, kw_only=True)
class Port:
    """A named vector argument or result: `entries` are SymPy symbols or expressions."""

    name: str
    entries: tuple[Any, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Definition:
    """A function to be generated: its name, one sentence about it, its arguments and results.

    named: intermediate values, each a symbol and an expression in arguments and earlier symbols;
    the results may use the symbols.
    """

    name: str
    says: str
    arguments: tuple[Port, ...]
    results: tuple[Port, ...]
    named: tuple[tuple[Any, Any], ...] = ()


def casadi_function(definition: Definition) -> Any:
    """The CasADi function of a definition.

    Raises TypeError for an expression that is no sum, product, power or square root of the
    arguments' symbols and rational numbers.
    """
    import casadi as module

    casadi: Any = module  # its stubs confuse its matrix types
    with _as_written(casadi):
        known: dict[Any, Any] = {}
        inputs: list[Any] = []
        for port in definition.arguments:
            column = casadi.SX.sym(port.name, len(port.entries))
            inputs.append(column)
            known.update({symbol: column[k] for k, symbol in enumerate(port.entries)})
        for symbol, value in definition.named:
            known[symbol] = _translated(value, known, casadi)
        outputs = [
            casadi.vertcat(*[_translated(entry, known, casadi) for entry in port.entries])
            for port in definition.results
        ]
        return casadi.Function(
            definition.name,
            inputs,
            casadi.cse(outputs),
            [port.name for port in definition.arguments],
            [port.name for port in definition.results],
        )


@contextmanager
def _as_written(casadi: Any) -> Generator[None]:
    """CasADi without its own rewriting, which turns one reciprocal into many divisions."""
    options = casadi.GlobalOptions
    before = options.getSimplificationOnTheFly()
    options.setSimplificationOnTheFly(False)
    try:
        yield
    finally:
        options.setSimplificationOnTheFly(before)


def _translated(expression: Any, known: dict[Any, Any], casadi: Any) -> Any:
    """The CasADi expression; `known` remembers what was translated before."""
    if expression in known:
        return known[expression]
    if expression.is_Rational:
        value = casadi.SX(int(expression.p))
        if expression.q != 1:
            value = casadi.SX(float(expression)) if _is_dyadic(expression) else value / expression.q
    elif expression.is_Add:
        value = _total(expression.args, known, casadi)
    elif expression.is_Mul:
        value = reduce(mul, [_translated(part, known, casadi) for part in expression.args])
    elif expression.is_Pow:
        value = _power(_translated(expression.base, known, casadi), expression.exp, casadi)
    else:
        raise TypeError(f"no arithmetic of the generated code: {expression}")
    known[expression] = value
    return value


def _is_dyadic(number: Any) -> bool:
    return int(number.q) & (int(number.q) - 1) == 0


def _total(terms: Sequence[Any], known: dict[Any, Any], casadi: Any) -> Any:
    """The sum of SymPy terms, those with equal coefficients in groups, multiplied once."""
    groups: dict[Any, list[_Signed]] = {}
    for term in terms:
        coefficient, rest = term.as_coeff_Mul()
        size = abs(coefficient)
        if rest == 1:  # a number is a term of its own
            size, rest = rest, size
        groups.setdefault(size, []).append((coefficient < 0, _translated(rest, known, casadi)))
    return _signed_value(
        _sum([_scaled(_sum(group), size, known, casadi) for size, group in groups.items()])
    )


def _scaled(term: _Signed, size: Any, known: dict[Any, Any], casadi: Any) -> _Signed:
    negative, value = term
    return negative, value if size == 1 else _translated(size, known, casadi) * value


def _sum(terms: list[_Signed]) -> _Signed:
    """The signed sum, begun with a positive term; negative where there is none."""
    negative = all(subtracted for subtracted, _ in terms)
    signed = sorted(((not negative and bool(s), term) for s, term in terms), key=lambda t: t[0])
    total = signed[0][1]
    for subtracted, term in signed[1:]:
        total = total - term if subtracted else total + term
    return negative, total


def _signed_value(term: _Signed) -> Any:
    negative, value = term
    return -value if negative else value


def _power(base: Any, exponent: Any, casadi: Any) -> Any:
    twice = 2 * exponent
    if not twice.is_Integer:
        raise TypeError(f"neither an integer power nor a square root: exponent {exponent}")
    root = base if exponent.is_Integer else casadi.sqrt(base)
    times = abs(int(exponent if exponent.is_Integer else twice))
    product = reduce(mul, [root] * times)
    return product if exponent > 0 else 1 / product


def port(name: str, entries: Sequence[Any]) -> Port:
    """A port from any sequence or matrix of entries, row by row."""
    return Port(name=name, entries=tuple(entries[k] for k in range(len(entries))))
