"""The syntax of sources, parsed once in a session for all tests that read the code."""

from __future__ import annotations

import ast
from functools import cache


@cache
def tree(source: str) -> ast.Module:
    return ast.parse(source)


@cache
def nodes(source: str) -> tuple[ast.AST, ...]:
    """All nodes of the tree, as `ast.walk` finds them."""
    return tuple(ast.walk(tree(source)))
