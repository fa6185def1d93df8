"""`{command}` runs a command line while the page is built and shows what it printed.

All commands of a page share a scratch folder that begins with the packaged files. An exit code
that is not the expected one stops the build. `{scratch} NAME` writes a file there and shows it.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.errors import ExtensionError
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 600  # seconds for one command: half a minute of a quiet machine, and many of a busy one
PYTHON = [sys.executable]
PROGRAMS = {"certreg": [*PYTHON, "-m", "certreg"], "python3": PYTHON, "cat": ["cat"], "ls": ["ls"]}


class Command(SphinxDirective):
    """A command line, executed, with what it printed on both streams.

    exit: the expected code, 0 unless told. show: the line numbers to show, as "1-8, 12"; the rest
    is marked as left out.
    """

    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar = {
        "exit": directives.nonnegative_int,
        "show": directives.unchanged,
    }

    def run(self) -> list[nodes.Node]:
        """Run the command and show it."""
        line = self.arguments[0]
        expected = self.options.get("exit", 0)
        done = executed(line, scratch_of(self.env.docname))
        if done.returncode != expected:
            raise ExtensionError(
                f"{self.env.docname}: `{line}` ended with {done.returncode}, not {expected}:\n"
                f"{done.stdout}"
            )
        shown = chosen(done.stdout.splitlines(), self.options.get("show"))
        text = "\n".join([f"$ {line}", *shown])
        block = nodes.literal_block(text, text, language="console")
        if not expected:
            return [block]
        note = nodes.paragraph(text=f"exit code {expected}", classes=["exit-code"])
        return [block, note]


class Scratch(SphinxDirective):
    """A file in the scratch folder of the page; its content is shown."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """Write the file and show it."""
        text = "\n".join(self.content)
        Path(scratch_of(self.env.docname), self.arguments[0]).write_text(text + "\n", "utf-8")
        name = nodes.caption("", "", nodes.literal(text=self.arguments[0]))
        block = nodes.literal_block(text, text, language="text")
        return [nodes.container("", name, block, classes=["literal-block-wrapper"])]


def executed(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """The finished process of a command line; both streams in `stdout`."""
    program, *arguments = shlex.split(line)
    if program not in PROGRAMS:
        raise ExtensionError(f"`{line}`: pages run {', '.join(PROGRAMS)} only")
    places = {"certreg/verify.py": str(ROOT / "certreg" / "verify.py")}
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1", "COLUMNS": "80"}
    return subprocess.run(  # noqa: S603  (the pages of this repository say what is run)
        [*PROGRAMS[program], *(places.get(word, word) for word in arguments)],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE,
        check=False,
        encoding="utf-8",
    )


def chosen(lines: list[str], which: str | None) -> list[str]:
    """The lines that are asked for, counted from 1, with [...] where some are left out."""
    if which is None:
        return lines
    shown, last = list[str](), 0
    for part in which.split(","):
        first, _, final = part.strip().partition("-")
        start, stop = int(first), int(final or first)
        if start > last + 1:
            shown.append("[...]")
        shown += lines[start - 1 : stop]
        last = stop
    return shown if last >= len(lines) else [*shown, "[...]"]


_folders: dict[str, Path] = {}


def scratch_of(page: str) -> Path:
    """The scratch folder of a page, with the packaged files in it."""
    if page not in _folders:
        folder = Path(tempfile.mkdtemp(prefix="certreg-docs-"))
        data = ROOT / "certreg" / "data"
        for packaged in sorted((*data.glob("*.csv"), *data.glob("*.txt"))):
            shutil.copy(packaged, folder)
        _folders[page] = folder
    return _folders[page]


def _forget(app: Sphinx, doctree: nodes.document) -> None:
    """A page has been read: its scratch folder goes."""
    folder = _folders.pop(app.env.docname, None)
    if folder is not None:
        shutil.rmtree(folder)
    del doctree


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_directive("command", Command)
    app.add_directive("scratch", Scratch)
    app.connect("doctree-read", _forget)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
