"""How often the code asks which kind it has: what composes does not ask.

Asked is by `isinstance` or a pattern of classes of problems, results, objectives and bodies of
certificates; by comparing with a member of an enumeration of kinds; by an attribute or a key that
says the kind, under whatever name; by how many numbers a motion finds, and what it lacks; by
whether a table has a word for the scale. The table of what is supported answers for all, and is
not counted.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from syntax import nodes

import certreg

if TYPE_CHECKING:
    from collections.abc import Iterator


PACKAGE = Path(certreg.__file__).parent
ANSWERS = ("problem/support.py", "verify.py")  # the table; and the checker, which shares no code
CLASSES = re.compile(
    r"(Problem|Registration|Body|Trajectory|Equilibria|Equilibrium|Similarity|Solution|Witness"
    r"|Assessment|Labels|Motion|Pairs)$"
    r"|^(Isotropic|Springs|Squares|Consensus|Truncated|Breaking)$"
)
ENUMERATIONS = {"Loss", "Scale", "Structure", "Kind"}
ATTRIBUTES = {"factors", "rotation_only", "scaled", "free", "divides", "rigid", "matrices"}
FOUND = {"translations", "scales"}  # of a motion: whether it shifts, whether it scales
MOST = 52  # now; it only falls


def named(node: ast.AST) -> Iterator[str]:
    """The classes that a second argument of `isinstance` or a pattern names."""
    for part in ast.walk(node):
        if isinstance(part, ast.Attribute):
            yield part.attr
        elif isinstance(part, ast.Name):
            yield part.id


def of_a_kind(node: ast.AST) -> bool:
    """Whether this is a member of an enumeration of kinds, or a collection of some."""
    return any(
        isinstance(part, ast.Attribute)
        and isinstance(part.value, ast.Name)
        and part.value.id in ENUMERATIONS
        for part in ast.walk(node)
    )


def asks(node: ast.AST) -> bool:
    """Whether this asks which kind there is."""
    match node:
        case ast.Call(func=ast.Name(id="isinstance" | "issubclass"), args=[_, classes]):
            return any(CLASSES.search(name) for name in named(classes))
        case ast.MatchClass(cls=of):
            return any(CLASSES.search(name) for name in named(of))
        case (
            ast.Compare(left=ast.Attribute(attr="scale"), ops=[ast.In() | ast.NotIn()])
            | ast.Call(func=ast.Attribute(attr="get"), args=[ast.Attribute(attr="scale"), *_])
            | ast.Call(func=ast.Attribute(attr="lacking"))
            | ast.Subscript(slice=ast.Constant(value="rotation_only"))
        ):
            return True
        case ast.Compare(left=left, comparators=others):
            return any(map(of_a_kind, (left, *others)))
        case ast.Attribute(value=of, attr=name, ctx=ast.Load()):
            motion = getattr(of, "attr", getattr(of, "id", None)) == "motion"
            return name in ATTRIBUTES or (motion and name in FOUND)
        case _:
            return False


def asked() -> Counter[str]:
    """So often each file asks."""
    files = {str(path.relative_to(PACKAGE)): path for path in PACKAGE.rglob("*.py")}
    return Counter(
        name
        for name, path in files.items()
        if name not in ANSWERS
        for node in nodes(path.read_text("utf-8"))
        if asks(node)
    )


def test_no_more_is_asked_than_was():
    found = asked()

    assert sum(found.values()) <= MOST, found.most_common(20)


def test_each_way_to_ask_is_seen():
    text = """
if isinstance(problem, RegistrationProblem | Path): ...
if problem.scale is Scale.NONE or loss in (Loss.SQUARES, Loss.BREAKING): ...
if problem.scaled and problem.factors is None and not problem.rotation_only: ...
match body:
    case SimilarityBody(): ...
if isinstance(problem, str) or scale == 1.0: ...
problem.scaled = True
if problem.motion.scales or motion.translations or scale.free or run.scales: ...
if problem.scale in BIAS or WORDS.get(motion.scale) or motion.arguments["rotation_only"]: ...
if motion.lacking(WORDS) or WORDS.get(name) or name in WORDS: ...
"""
    assert sum(map(asks, nodes(text))) == 1 + 2 + 3 + 1 + 3 + 3 + 1
