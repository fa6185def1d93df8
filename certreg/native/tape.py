"""Straight-line C read as a tape: the list of its operations, which Python runs one by one.

The generated C knows nine forms of a statement: a value is loaded, stored, or is a number, a sum, a
difference, a product, a quotient, a negative or a root of others. Loads and stores cost nothing
here: a tape remembers which value stands where.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from operator import add, mul, sub
from typing import Any

import numpy as np

_FUNCTION = re.compile(
    r"^CERTREG_LINKAGE void (\w+)\(\n(.*?)\)\n\{\n(.*?)^\}$", re.DOTALL | re.MULTILINE
)
_PORT = re.compile(r"(const )?CERTREG_REAL (\w+)\[(\d+)\]")
_DECLARED = re.compile(r"  CERTREG_REAL [^;]*;")
_STATEMENT = re.compile(r"  (\w+(?:\[\d+\])?)=(.*);")
_NUMBER = re.compile(r"CERTREG_CONSTANT\((.*)\)")
_BINARY = re.compile(r"\((\w+)([-+*/])(\w+)\)")
_UNARY = re.compile(r"(\(-|CERTREG_SQRT\()(\w+)\)")


def _root(value: Any, _: Any) -> Any:
    return math.sqrt(value) if type(value) is float else np.sqrt(value)  # np.float64 has infinity


_OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "+": add,
    "-": sub,
    "*": mul,
    "/": lambda left, right: left / right,
}


@dataclass(frozen=True, slots=True)
class Tape:
    """The operations of one function, over values numbered in the order in which they appear.

    First come the entries of all arguments, then `numbers`, then the value of each operation.
    results: for each result the numbers of its entries.
    """

    numbers: tuple[float, ...]
    operations: tuple[tuple[Callable[[Any, Any], Any], int, int], ...]
    results: tuple[tuple[int, ...], ...]

    def run(self, arguments: Sequence[Sequence[Any]]) -> list[list[Any]]:
        """The results, of numbers or of arrays. Raises what Python's arithmetic raises."""
        values = [entry for argument in arguments for entry in argument]
        values += self.numbers
        for operation, left, right in self.operations:
            values.append(operation(values[left], values[right]))
        return [[values[place] for place in result] for result in self.results]


def tapes_of(source: str) -> Iterator[tuple[str, Tape]]:
    """Each function of a generated C file, by name. Raises ValueError for C of another form."""
    for name, ports, body in _FUNCTION.findall(source):
        yield name, _tape(_PORT.findall(ports), body.splitlines())


def _tape(ports: Sequence[tuple[str, str, str]], lines: Sequence[str]) -> Tape:
    inputs = [f"{name}[{k}]" for const, name, size in ports for k in range(int(size)) if const]
    written = [found[1] for line in lines if (found := _NUMBER.search(line))]
    numbers = list(dict.fromkeys(["-1.", *written]))  # before the first operation
    place = {entry: k for k, entry in enumerate([*inputs, *numbers])}
    operations: list[tuple[Callable[[Any, Any], Any], int, int]] = []
    for line in lines:
        if _DECLARED.fullmatch(line):
            continue
        target, expression = _matched(_STATEMENT, line)
        number = _NUMBER.fullmatch(expression)
        known = place.get(number[1] if number else expression)
        if known is None:
            known = len(inputs) + len(numbers) + len(operations)
            operations.append(_operation(expression, place))
        place[target] = known
    results = [
        [place[f"{name}[{k}]"] for k in range(int(n))] for const, name, n in ports if not const
    ]
    return Tape(tuple(map(float, numbers)), tuple(operations), tuple(map(tuple, results)))


def _operation(
    expression: str, place: dict[str, int]
) -> tuple[Callable[[Any, Any], Any], int, int]:
    binary = _BINARY.fullmatch(expression)
    if binary is not None:
        left, sign, right = binary.groups()
        return _OPERATIONS[sign], place[left], place[right]
    kind, only = _matched(_UNARY, expression)
    if kind == "(-":
        return mul, place["-1."], place[only]  # exact, also of zeros
    return _root, place[only], place[only]


def _matched(form: re.Pattern[str], text: str) -> tuple[str, ...]:
    found = form.fullmatch(text)
    if found is None:
        raise ValueError(f"no statement of generated C: {text!r}")
    return found.groups()
