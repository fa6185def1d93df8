"""Which fields differ between two records, and by how much: a diff of many files hides it."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from comparison import Difference

NUMBER = re.compile(r"[-+]?\b\d+(?:\.\d+)?(?:e[-+]?\d+)?\b")


@dataclass
class Field:
    """All differences of one field, over all files that hold it.

    new, gone, other: the values that only the head or only the base holds, and those of another
    word, truth or exact number. moved: the floats that are not the same; `largest` is the largest
    difference of them, `share` the same as a part of the largest magnitude in that document.
    """

    name: str
    files: set[str] = field(default_factory=set)
    new: int = 0
    gone: int = 0
    other: int = 0
    moved: int = 0
    largest: float = 0.0
    share: float = 0.0

    def __str__(self) -> str:
        counts = ((self.new, "new"), (self.gone, "gone"), (self.other, "other"))
        told = [f"{count} {word}" for count, word in counts if count]
        moved = f"{self.moved} moved by {self.largest:.1e}, a share of {self.share:.1e}, at most"
        told += [moved] * bool(self.moved)
        return f"{self.name}: {', '.join(told)}, in {len(self.files)} files"

    def add(self, path: str, base: list[Any], head: list[Any]) -> None:
        """Count what differs of the field in a document of a file."""
        if repr(base) == repr(head):  # 3 is not 3.0, nor is 1 true
            return
        self.files.add(path)
        self.new += max(len(head) - len(base), 0)
        self.gone += max(len(base) - len(head), 0)
        numbers = [abs(value) for value in (*base, *head) if _is_float(value)]
        for before, after in zip(base, head, strict=False):
            if _is_float(before) and _is_float(after):
                self.moved += before != after
                self.largest = max(self.largest, abs(before - after))
                self.share = max(self.share, abs(before - after) / (max(numbers) or 1.0))
            else:
                self.other += (type(before), before) != (type(after), after)


def changed_fields(differences: Iterable[Difference]) -> tuple[Field, ...]:
    """The fields that differ, by their names: those of JSON, then the lines of all other text.

    A line of text is a field by its words; "numbers in text" are those of lines of the same words.
    """
    found = dict[str, Field]()
    for difference in differences:
        sides = (_parts(text or "") for text in (difference.base, difference.head))
        for base, head in zip_longest(*sides, fillvalue=dict[str, list[Any]]()):
            for name in {**base, **head}:
                row = found.setdefault(name, Field(name))
                row.add(difference.path, base.get(name, []), head.get(name, []))
    return tuple(row for _, row in sorted(found.items()) if row.files)


def _parts(text: str) -> list[dict[str, list[Any]]]:
    """Of the text of a file, then of each document in it, the values by the names of the fields.

    Places within lists have no names.
    """
    documents, rest = _documents(text)
    parts = [defaultdict[str, list[Any]](list) for _ in (rest, *documents)]
    for line in rest.splitlines():
        words = NUMBER.sub("#", line)
        parts[0][f"text: {words}"].append(True)
        parts[0][f"numbers in text: {words}"] += map(float, NUMBER.findall(line))
    for values, document in zip(parts[1:], documents, strict=True):
        for name, value in _leaves(document):
            values[name].append(value)
    return [dict(values) for values in parts]


def _documents(text: str) -> tuple[list[Any], str]:
    """The JSON documents that stand in a text, from the beginning of a line on, and the rest."""
    decoder, documents, rest, place = json.JSONDecoder(), list[Any](), list[str](), 0
    for start in re.finditer(r"(?m)^\{", text):
        if start.start() < place:
            continue
        try:
            document, end = decoder.raw_decode(text, start.start())
        except ValueError:
            continue
        rest.append(text[place : start.start()])
        documents.append(document)
        place = end
    return documents, "".join([*rest, text[place:]])


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _leaves(part, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list):
        for part in value:
            yield from _leaves(part, f"{name}[]")
    else:
        yield name, value


def _is_float(value: Any) -> bool:
    return isinstance(value, float)
