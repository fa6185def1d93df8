"""Every text that certreg reads or writes says its encoding: elsewhere UTF-8 is not the default."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from syntax import nodes

import certreg

PACKAGE = Path(certreg.__file__).parent
STATED = {"read_text": 0, "write_text": 1}  # which argument says it, where no name does


def unstated(source: str) -> list[int]:
    """The lines that leave the encoding of a text to the machine."""
    lines: list[int] = []
    for node in nodes(source):
        if not isinstance(node, ast.Call):
            continue
        named = {keyword.arg: keyword.value for keyword in node.keywords}
        word = getattr(node.func, "attr", getattr(node.func, "id", ""))
        short = word in STATED and len(node.args) <= STATED[word]
        process = getattr(named.get("text"), "value", None) is True
        if "encoding" not in named and (short or process):
            lines.append(node.lineno)
    return lines


@pytest.mark.slow
def test_no_text_is_read_or_written_in_the_encoding_of_the_machine():
    found = {
        path.name: lines
        for path in PACKAGE.rglob("*.py")
        if (lines := unstated(path.read_text("utf-8")))
    }

    assert found == {}


def test_an_unstated_encoding_is_seen():
    assert unstated("a.read_text()\na.read_text(errors='x')\na.write_text(b)\n") == [1, 2, 3]
    assert unstated("subprocess.run(c, text=True)") == [1]
    assert unstated("a.read_text('utf-8')\na.write_text(b, encoding='utf-8')\n") == []
