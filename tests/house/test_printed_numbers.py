"""A number that is printed as a bound goes through `at_most` or `at_least`, never to the nearest.

Of the checker: through its own `rounded`. Every other format of a number stands on a list below,
with what its last digit is worth.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

from syntax import nodes

import certreg

PACKAGE = Path(certreg.__file__).parent
COVERED = ("verify.py", "results.py", "problem", "registration", "report", "campaign", "cli", "io")
SPEC = re.compile(r"([gefn%]|\.\d+)$", re.IGNORECASE)
TEMPLATE = re.compile(r"\{[^{}:]*:[^{}]*[gefn%]\}", re.IGNORECASE)
PERCENT = re.compile(r"%[-+ #0]*[\d.*]*[gef]", re.IGNORECASE)
ROUNDERS = {"round", "around", "quantize", "format_float_positional", "format_float_scientific"}


def formats(source: str) -> list[str]:
    """What a module formats or rounds to the nearest: the value and how, as it is written."""
    return sorted({text for node in nodes(source) if (text := formatted(node)) is not None})


def formatted(node: ast.AST) -> str | None:
    """How a piece of syntax rounds; None where it does not."""
    if isinstance(node, ast.FormattedValue) and node.format_spec is not None:
        spec = ast.unparse(node.format_spec)[2:-1]
        loses = SPEC.search(spec) and not decimal_of_the_checker(node.value, spec)
        return f"{{{ast.unparse(node.value)}:{spec}}}" if loses else None
    if isinstance(node, ast.Call):
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        spec = name == "format" and isinstance(node.func, ast.Name) and len(node.args) > 1
        return ast.unparse(node) if name in ROUNDERS or spec else None
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod):
        text = getattr(node.left, "value", None)
        return ast.unparse(node) if isinstance(text, str) and PERCENT.search(text) else None
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return next(iter(TEMPLATE.findall(node.value)), None)
    return None


def decimal_of_the_checker(value: ast.expr, spec: str) -> bool:
    """Whether `rounded` of `verify.py` made the number, of no more digits than are printed."""
    if not (isinstance(value, ast.Call) and getattr(value.func, "id", "") == "rounded"):
        return False
    digits = getattr(value.args[1], "value", 0)
    return spec in {"g", f".{digits - 1}e"}
