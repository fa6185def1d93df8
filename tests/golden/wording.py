"""What differs in words, told by kind: thousands of files differ in a few ways."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from documents import NUMBERS, read_words

if TYPE_CHECKING:
    from collections.abc import Iterable

    from comparison import Difference

COMMAND = re.compile(r"\A\$ (?:python -m )?(certreg|verify\.py|python)(?: ([a-z]+)(?=\s))?")
DIGEST = re.compile(r"\b[0-9a-f]{32,}\b")
SHOWN = 88  # characters of an example


@dataclass
class Kind:
    """Files of one kind whose words differ: lines that came and went, numbers in them apart.

    numbers: files in which nothing but numbers and digests of such lines differs. came, went: the
    lines, numbers masked, and in how many files. only_now, only_then: files of one record alone.
    """

    name: str
    files: int = 0
    numbers: int = 0
    only_now: int = 0
    only_then: int = 0
    came: Counter[str] = field(default_factory=Counter)
    went: Counter[str] = field(default_factory=Counter)

    def __str__(self) -> str:
        told = [f"{self.files} files differ"] * bool(self.files)
        told += [f"{self.numbers} of them in numbers or digests alone"] * bool(self.numbers)
        told += [f"{self.only_now} files are new"] * bool(self.only_now)
        told += [f"{self.only_then} files are gone"] * bool(self.only_then)
        lines = [f"{self.name}: {', '.join(told)}"]
        for sign, seen in (("-", self.went), ("+", self.came)):
            if seen:
                (line, count), *_ = seen.most_common(1)
                many = f"{len(seen)} kinds of lines, most often ({count} files)"
                lines.append(f"  {sign} {many}: {line[:SHOWN]}")
        return "\n".join(lines)

    def add(self, difference: Difference) -> None:
        """Count what differs in the words of a file."""
        if difference.base is None or difference.head is None:
            self.only_now += difference.base is None
            self.only_then += difference.head is None
            return
        base, head = (read_words(text) for text in (difference.base, difference.head))
        if base == head:
            return
        before, after = (Counter(map(_masked, text.splitlines())) for text in (base, head))
        self.files += 1
        self.numbers += before == after
        self.went.update((before - after).keys())
        self.came.update((after - before).keys())


def changed_words(differences: Iterable[Difference]) -> tuple[Kind, ...]:
    """What differs in words, by kinds of files."""
    found = dict[str, Kind]()
    for difference in differences:
        name = _kind(difference)
        found.setdefault(name, Kind(name)).add(difference)
    rows = (kind for _, kind in sorted(found.items()))
    return tuple(kind for kind in rows if kind.files or kind.only_now or kind.only_then)


def _kind(difference: Difference) -> str:
    """What a recorded file is: what a command printed, or files of one suffix."""
    text = difference.head if difference.head is not None else difference.base
    if "/files/" not in difference.path:
        told = COMMAND.match(text or "")
        return f"printed by {' '.join(filter(None, told.groups()))}" if told else "printed"
    name = difference.path.removesuffix(".txt").rpartition("/")[2]
    return f"files .{name.rpartition('.')[2]}"


def _masked(line: str) -> str:
    return NUMBERS.sub("#", DIGEST.sub("#", line)).strip()
