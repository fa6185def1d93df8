"""Docstrings of this project are prose: here they become reStructuredText that autodoc can set.

Nothing in them is markup but `code` in backticks. Of what is public they have numpydoc's sections,
underlined, with a name and its indented description for each argument or error. Elsewhere a line
`name, name: ...` with its indented continuation describes arguments or fields. An indented block is
an equation or a piece of text to be kept as it is, and `>>>` begins an example (the tests run it).
"""

from __future__ import annotations

import re
from itertools import groupby
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

NAMES = re.compile(r"([A-Za-z_]\w*(?:, [A-Za-z_]\w*)*)(?: \([^()]*\))?: (?=\S)")
CODE = re.compile(r"`([^`]+)`")
MARKUP = re.compile(r"([\\*|_`])")


def marked_up(lines: list[str]) -> list[str]:
    """The docstring as reStructuredText."""
    blocks = [
        list(group) for filled, group in groupby(lines, key=lambda x: bool(x.strip())) if filled
    ]
    result = list[str]()
    for block in blocks:
        result += ["", *_block(block)]
    return [*result, ""]


def _block(block: list[str]) -> list[str]:
    if len(block) > 1 and set(block[1]) == {"-"}:
        return [f".. rubric:: {block[0]}", "", *_section(block[2:])]
    if block[0].lstrip().startswith(">>>"):
        return block
    if all(line.startswith("    ") for line in block):
        return ["::", "", *block]
    result, fields = list[str](), False
    for line in block:
        names = NAMES.match(line)
        if names:
            result += [] if fields or not result else [""]
            result.append(f":{escaped(names[1])}: {escaped(line[names.end() :])}")
            fields = True
        elif fields and line.startswith(" "):
            result.append(f"    {escaped(line.strip())}")
        else:
            result += [""] if fields else []
            result.append(escaped(line))
            fields = False
    return result


def _section(lines: list[str]) -> list[str]:
    if not lines or lines[0].startswith(">>>"):  # an example may stand below an empty line
        return lines
    return [
        f"    {escaped(line.strip())}" if line.startswith(" ") else f"``{line}``" for line in lines
    ]


def escaped(text: str) -> str:
    """Prose with nothing in it that reStructuredText would take for markup, but code."""
    pieces = CODE.split(text)
    pieces[::2] = [MARKUP.sub(r"\\\1", words) for words in pieces[::2]]
    pieces[1::2] = [f"``{code}``" for code in pieces[1::2]]
    return _separated(pieces)


def _separated(pieces: list[str]) -> str:
    """Joined so that code that touches a word is still seen as code."""
    joined = pieces[0]
    for code, words in zip(pieces[1::2], pieces[2::2], strict=True):
        before = "" if not joined or joined[-1] in " (" else "\\ "
        after = "" if not words or words[0] in " .,;:)!?" else "\\ "
        joined += f"{before}{code}{after}{words}"
    return joined


def _process(
    app: Sphinx, what: str, name: str, found: object, options: object, lines: list[str]
) -> None:
    del app, what, name, found, options
    lines[:] = marked_up(lines)


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", _process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
