"""Two records held against each other: what differs, and what of that is meant."""

from __future__ import annotations

import difflib
import re
import tomllib
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

MEANT = Path(__file__).parent / "meant.toml"


@dataclass(frozen=True)
class Meant:
    """A difference that is meant: of files whose name fits, what is found is not compared.

    path: a pattern as of a shell, of the path within the record. found: a regular expression; what
    it matches is taken out of both sides. reason: why the change is an improvement.
    """

    path: str
    found: str
    reason: str

    def fits(self, path: str) -> bool:
        return fnmatchcase(path, self.path)


@dataclass(frozen=True)
class Difference:
    """A file of the record that is not the same; None stands for a file that is not there."""

    path: str
    base: str | None
    head: str | None

    def without(self, meant: Meant) -> Difference:
        """What remains of it where a change is meant."""
        if not meant.fits(self.path):
            return self
        sides = (re.sub(meant.found, "", text or "") for text in (self.base, self.head))
        return Difference(self.path, *sides)

    def differs_in(self, meant: Meant) -> bool:
        """Whether what the entry speaks of is not the same on both sides."""
        matches = (
            [match.group() for match in re.finditer(meant.found, text or "")]
            for text in (self.base, self.head)
        )
        return meant.fits(self.path) and next(matches) != next(matches)

    @property
    def is_none(self) -> bool:
        return self.base == self.head

    @property
    def diff(self) -> str:
        """The two texts as a diff."""
        if self.base is None or self.head is None:
            return f"{'+++ head' if self.base is None else '--- base'}/{self.path}: only here\n"
        names = f"base/{self.path}", f"head/{self.path}"
        sides = self.base.split("\n"), self.head.split("\n")
        return "\n".join([*difflib.unified_diff(*sides, *names, n=2, lineterm=""), ""])


@dataclass(frozen=True)
class Comparison:
    """The outcome: differences that nobody meant, and entries of the list that met none."""

    files: int
    unmeant: tuple[Difference, ...]
    unmet: tuple[Meant, ...]


def compare(base: Path, head: Path, meant: Sequence[Meant] = ()) -> Comparison:
    """Two folders that `record.py` wrote, held against each other."""
    unmeant, met = list[Difference](), set[Meant]()
    for difference in differences(base, head):
        met.update(each for each in meant if difference.differs_in(each))
        if not reduce(Difference.without, meant, difference).is_none:
            unmeant.append(difference)
    return Comparison(
        files=len(_files(base) | _files(head)),
        unmeant=tuple(unmeant),
        unmet=tuple(each for each in meant if each not in met),
    )


def differences(base: Path, head: Path) -> Iterator[Difference]:
    """Every file that is in one record only, or not the same in both."""
    for path in sorted(_files(base) | _files(head)):
        difference = Difference(path, _text(base / path), _text(head / path))
        if not difference.is_none:
            yield difference


def read_meant(path: Path = MEANT) -> tuple[Meant, ...]:
    """The list of differences that are meant."""
    entries = tomllib.loads(path.read_text("utf-8")).get("meant", [])
    return tuple(Meant(**entry) for entry in entries)


def _text(path: Path) -> str | None:
    return path.read_bytes().decode(errors="backslashreplace") if path.is_file() else None


def _files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
