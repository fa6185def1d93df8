"""Two records held against each other: what differs, and what of that is meant."""

from __future__ import annotations

import difflib
import re
import tomllib
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

MEANT = Path(__file__).parent / "meant.toml"
GONE, NEW = "- (the whole file)", "+ (the whole file)"


@dataclass(frozen=True)
class Meant:
    """A difference that is meant: changed lines, with their + or -, in files of these names.

    path: a pattern as of a shell, of the path within the record. lines: a regular expression, found
    in every such line. reason: why the change is an improvement.
    """

    path: str
    lines: str
    reason: str

    def covers(self, path: str, line: str) -> bool:
        return fnmatchcase(path, self.path) and re.search(self.lines, line) is not None


@dataclass(frozen=True)
class Difference:
    """A file of the record that is not the same: the lines that changed, and the diff to show."""

    path: str
    changed: tuple[str, ...]
    diff: str


@dataclass(frozen=True)
class Comparison:
    """The outcome: differences that nobody meant, and entries of the list that met none."""

    files: int
    unmeant: tuple[Difference, ...]
    unmet: tuple[Meant, ...]


def compare(base: Path, head: Path, meant: Sequence[Meant] = ()) -> Comparison:
    """Two folders that `record.py` wrote. A file of which every changed line is meant passes."""
    unmeant, met = list[Difference](), set[Meant]()
    for difference in differences(base, head):
        covering = {
            line: [each for each in meant if each.covers(difference.path, line)]
            for line in difference.changed
        }
        met.update(each for entries in covering.values() for each in entries)
        if not all(covering.values()):
            unmeant.append(difference)
    return Comparison(
        files=len(_files(base) | _files(head)),
        unmeant=tuple(unmeant),
        unmet=tuple(each for each in meant if each not in met),
    )


def differences(base: Path, head: Path) -> Iterator[Difference]:
    """Every file that is in one record only, or not the same in both."""
    here, there = _files(base), _files(head)
    for path in sorted(here | there):
        if path not in there:
            yield Difference(path, (GONE,), f"--- base/{path}\n{GONE}\n")
        elif path not in here:
            yield Difference(path, (NEW,), f"+++ head/{path}\n{NEW}\n")
        else:
            texts = (base / path).read_bytes(), (head / path).read_bytes()
            if texts[0] != texts[1]:
                yield _difference(path, *texts)


def read_meant(path: Path = MEANT) -> tuple[Meant, ...]:
    """The list of differences that are meant."""
    entries = tomllib.loads(path.read_text()).get("meant", [])
    return tuple(Meant(**entry) for entry in entries)


def _difference(path: str, base: bytes, head: bytes) -> Difference:
    old, new = (text.decode(errors="backslashreplace").split("\n") for text in (base, head))
    names = f"base/{path}", f"head/{path}"
    lines = list(difflib.unified_diff(old, new, *names, n=2, lineterm=""))
    changed = tuple(line for line in lines[2:] if line.startswith(("+", "-")))
    return Difference(path, changed, "\n".join(lines) + "\n")


def _files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
