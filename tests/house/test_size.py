"""How much code there is: statements of its syntax trees, which long lines do not make fewer.

Generated files are not counted. The numbers fall; a commit that adds a capability may raise them,
and says so.
"""

from __future__ import annotations

import ast
from pathlib import Path

from syntax import nodes

import certreg

PACKAGE = Path(certreg.__file__).parent
MOST_STATEMENTS = 34_074
MOST_FILES = 317


def written() -> list[Path]:
    """The files of the package that were written by hand."""
    files = (path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py"))
    return [path for path in files if "generated" not in str(path)]


def statements(text: str) -> int:
    return sum(isinstance(node, ast.stmt) for node in nodes(text))


def test_there_are_no_more_statements_and_files_than_there_were():
    files = written()
    counts = {str(path): statements((PACKAGE / path).read_text("utf-8")) for path in files}
    largest = sorted(counts, key=counts.__getitem__, reverse=True)[:10]

    assert sum(counts.values()) <= MOST_STATEMENTS, {name: counts[name] for name in largest}
    assert len(files) <= MOST_FILES


def test_statements_on_one_line_are_counted_each():
    assert statements("if a:\n    b = 1; c = 2\nelse: d()\n") == 4
