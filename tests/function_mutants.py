"""Mutants of the functions that return a proved bound or a proof flag, by operators on their code.

`tests/proved_functions.py` lists the functions; `make rates NAME=mutants` judges all mutants. Each
operator changes one place: a constant by 1, the strictness of an inequality, == and !=, the
direction of a rounding, a sign, min or max, a conjunct. Where a function names numbers of its
module, one of them is changed at that place. `mutants.change` puts a mutant in the place of the
code.
"""

from __future__ import annotations

import ast
import tomllib
from collections import Counter
from copy import deepcopy
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from mutants import ROOT, Mutant

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
}
OPPOSITES = {
    "above": "below",
    "upper": "lower",
    "ceil": "floor",
    "max": "min",
    "maximum": "minimum",
    "most": "least",
    "all": "any",
    "CEILING": "FLOOR",
}
OPPOSITES |= {other: one for one, other in OPPOSITES.items()}
ROUNDERS = frozenset(
    f"{what}_{way}"
    for what in ("dyadic", "double", "at", "angle", "root", "rational_root", "dyadic_root")
    for way in ("above", "below", "most", "least")
)
WORDS = frozenset(
    {
        "ROUND_CEILING",
        "ROUND_FLOOR",
        "ceil",
        "floor",
        "max",
        "min",
        "maximum",
        "minimum",
        "all",
        "any",
    }
)
DIRECTIONS = ROUNDERS | WORDS

REASONS = tomllib.loads((ROOT / "tests" / "equivalent_mutants.toml").read_text("utf-8"))
NO_FAULTS = {
    f"certreg/{module}.py:{what}": reason
    for module, rows in REASONS.items()
    for what, reason in rows.items()
}
# Mutants that are no faults, and constants of which no mutant is one, each with its reason.
EQUIVALENT = {name: reason for name, reason in NO_FAULTS.items() if name.count(":") > 1}
FREE_CONSTANTS = {name: reason for name, reason in NO_FAULTS.items() if name.count(":") == 1}


@dataclass(frozen=True, slots=True)
class Change:
    """What stands in the place of a part of a function, and what it is called."""

    at: ast.expr
    new: ast.expr

    @property
    def says(self) -> str:
        """The part before and after."""
        return f"{ast.unparse(self.at)} -> {ast.unparse(self.new)}"


def mutants_of(file: str, name: str, tests: tuple[str, ...] = ()) -> list[Mutant]:
    """All mutants of a function or method; equal changes are numbered."""
    text = (ROOT / file).read_text("utf-8")
    lines = text.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line.encode()))
    data = text.encode()
    module = ast.parse(text)
    function = function_named(module, name)
    begin, end = _span(starts, function)
    named = {
        constant: value
        for constant, value in constants(module).items()
        if f"{file}:{constant}" not in FREE_CONSTANTS
    }
    seen, found = Counter[str](), list[Mutant]()
    for change in changes(function, named):
        seen[change.says] += 1
        number = f" ({seen[change.says]})" if seen[change.says] > 1 else ""
        first, last = _span(starts, change.at)
        new = b"(" + ast.unparse(change.new).encode() + b")"
        mutated = (data[begin:first] + new + data[last:end]).decode()
        says = f"{file}:{name}: {change.says}{number}"
        found.append(Mutant(says, file, data[begin:end].decode(), mutated, tests))
    return found


def function_named(tree: ast.AST, name: str) -> ast.FunctionDef:
    """The function or method of a module with this qualified name; LookupError if there is none."""
    for part in name.split("."):
        inside = [n for n in ast.iter_child_nodes(tree) if getattr(n, "name", None) == part]
        if not inside:
            raise LookupError(f"there is no {name}")
        tree = inside[-1]  # of overloads the last one
    return cast("ast.FunctionDef", tree)


def _span(starts: list[int], node: ast.expr | ast.FunctionDef) -> tuple[int, int]:
    """Where a node stands in the bytes of its file."""
    assert node.end_lineno is not None
    assert node.end_col_offset is not None
    first = starts[node.lineno - 1] + node.col_offset
    return first, starts[node.end_lineno - 1] + node.end_col_offset


def constants(module: ast.Module) -> dict[str, ast.expr]:
    """The numbers that a module names, alone or in tuples and mappings."""
    found: dict[str, ast.expr] = {}
    for node in module.body:
        match node:
            case (
                ast.Assign(targets=[ast.Name(name)], value=value)
                | ast.AnnAssign(target=ast.Name(name), value=ast.expr() as value)
            ) if _is_of_numbers(value):
                found[name] = value
            case _:
                pass
    return found


def _is_of_numbers(value: ast.expr) -> bool:
    leaves = [n for n in ast.walk(value) if isinstance(n, ast.Constant | ast.Name)]
    return all(
        n.id == "Fraction" if isinstance(n, ast.Name) else isinstance(n.value, int | float)
        for n in leaves
    )


def changes(function: ast.FunctionDef, named: Mapping[str, ast.expr]) -> Iterator[Change]:
    """Each change of one place, in the order of the text; named: the numbers of the module."""
    for statement in function.body:
        for node in _expressions(statement):
            yield from (Change(node, new) for new in _variants(node))
            if isinstance(node, ast.Name) and node.id in named:
                yield from (Change(node, new) for new in _other_constants(named[node.id]))


def _expressions(node: ast.AST) -> Iterator[ast.expr]:
    """What decides: no messages, no annotations, no numbers of columns."""
    if isinstance(node, ast.Raise | ast.JoinedStr | ast.pattern):
        return
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return  # a docstring
    if isinstance(node, ast.expr):
        yield node
    for field, value in ast.iter_fields(node):
        if field in {"annotation", "returns", "decorator_list"}:
            continue
        if isinstance(node, ast.Subscript) and field == "slice":
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _expressions(child)


def _variants(node: ast.expr) -> Iterator[ast.expr]:
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            yield from _other_numbers(value)
        case ast.Compare():
            yield from _other_comparisons(node)
        case ast.BoolOp():
            yield from _other_conjunctions(node)
        case ast.BinOp() | ast.UnaryOp():
            yield from _other_signs(node)
        case ast.Name() | ast.Attribute():
            yield from _other_directions(node)
        case _:
            return


def _other_signs(node: ast.BinOp | ast.UnaryOp) -> Iterator[ast.expr]:
    """Another sign; or another rounding of a quotient of integers."""
    match node:
        case ast.BinOp(op=ast.Add()):
            yield ast.BinOp(node.left, ast.Sub(), node.right)
        case ast.BinOp(op=ast.Sub()):
            yield ast.BinOp(node.left, ast.Add(), node.right)
        case ast.BinOp(op=ast.FloorDiv() | ast.RShift()):
            yield _negated(ast.BinOp(_negated(node.left), node.op, node.right))
        case ast.UnaryOp(
            op=ast.USub(), operand=ast.BinOp(op=ast.FloorDiv() | ast.RShift()) as quotient
        ):
            yield _rounded_down(quotient)
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield node.operand
        case _:
            return


def _other_directions(node: ast.Name | ast.Attribute) -> Iterator[ast.expr]:
    match node:
        case ast.Name(id=name) if name in DIRECTIONS:
            yield ast.Name(_opposite(name))
        case ast.Attribute(attr=name) if name in DIRECTIONS:
            yield ast.Attribute(node.value, _opposite(name))
        case ast.Attribute(attr="inf"):
            yield _negated(node)
        case _:
            return


def _other_numbers(value: float) -> Iterator[ast.Constant]:
    if isinstance(value, int):
        yield from (ast.Constant(value + 1), ast.Constant(value - 1))
    else:
        yield from (
            (ast.Constant(2 * value), ast.Constant(value / 2)) if value else (ast.Constant(1.0),)
        )


def _other_constants(value: ast.expr) -> Iterator[ast.expr]:
    """The same with another number in one place."""
    for i, number in enumerate(_numbers(value)):
        for other in _other_numbers(cast("float", number.value)):
            new = deepcopy(value)
            _numbers(new)[i].value = other.value
            yield new


def _numbers(value: ast.AST) -> list[ast.Constant]:
    """The numbers of a constant, but keys of a mapping and the base of a power."""
    match value:
        case ast.Constant():
            return [value]
        case ast.Dict(values=parts):
            pass
        case ast.BinOp(op=ast.Pow() | ast.LShift(), right=exponent):
            parts = [exponent]
        case _:
            parts = ast.iter_child_nodes(value)
    return [number for part in parts for number in _numbers(part)]


def _other_comparisons(node: ast.Compare) -> Iterator[ast.expr]:
    for i, op in enumerate(node.ops):
        other = COMPARISONS.get(type(op))
        if other is not None:
            ops = [*node.ops[:i], other(), *node.ops[i + 1 :]]
            yield ast.Compare(node.left, ops, node.comparators)


def _other_conjunctions(node: ast.BoolOp) -> Iterator[ast.expr]:
    yield ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values)
    for i in range(len(node.values)):
        rest = [*node.values[:i], *node.values[i + 1 :]]
        yield rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest)


def _negated(node: ast.expr) -> ast.expr:
    """The node with the other sign."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return node.operand
    return ast.UnaryOp(ast.USub(), node)


def _rounded_down(node: ast.BinOp) -> ast.expr:
    """a // b of the -a // b of -(-a // b), which rounds up; a may be shifted."""
    match node.left:
        case ast.BinOp(op=ast.LShift() as shift, left=ast.UnaryOp(op=ast.USub()) as left):
            return ast.BinOp(ast.BinOp(left.operand, shift, node.left.right), node.op, node.right)
        case ast.UnaryOp(op=ast.USub(), operand=left):
            return ast.BinOp(left, node.op, node.right)
        case _:
            return node


def _opposite(name: str) -> str:
    """The name of what rounds, or selects, the other way."""
    head, _, way = name.rpartition("_")
    return f"{head}_{OPPOSITES[way]}" if head else OPPOSITES[way]
