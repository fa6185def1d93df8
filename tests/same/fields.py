"""Which fields differ between two records, by how much, and whether that is what was stated.

A table states which fields may change and how far a number of each other field may move; a field
that it does not name may do neither. `make same` and `make golden` have a table each.
"""

from __future__ import annotations

import math
import tomllib
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

BEYOND = "BEYOND ITS BOUND"  # the verdict that is a failure

Values = dict[str, list[Any]]


@dataclass(frozen=True)
class Stated:
    """What may become of some fields, and why.

    names: as in the table, where * stands for anything. paths: of these files alone. where: of
    documents in which one of these fields differs, too; of all, if there is none. changes: whatever
    it was, it may be something else. Else a float may move by `absolute`, or by `share` of the
    largest magnitude that the fields `of` have in that document; its own, if there is none. either
    sign: of a vector that is known up to its sign, the magnitudes are compared.
    """

    names: tuple[str, ...]
    reason: str
    paths: tuple[str, ...] = ("*",)
    where: tuple[str, ...] = ()
    changes: bool = False
    share: float = 0.0
    absolute: float = 0.0
    of: tuple[str, ...] = ()
    either_sign: bool = False

    def __str__(self) -> str:
        where = f"where {' or '.join(self.where)} differs, " if self.where else ""
        if self.changes:
            return f"{where}may change"
        kinds = (
            (self.share, f"{self.share:.1e} of {' or '.join(self.of) or 'its size'}"),
            (self.absolute, f"{self.absolute:.1e}"),
        )
        sign = ", either sign" * self.either_sign
        return f"{where}at most {' or '.join(words for bound, words in kinds if bound)}{sign}"

    def fits(self, path: str, name: str, base: Values, head: Values) -> bool:
        """Whether this is about a field of a document in a file."""
        return (
            any(_is_like(name, pattern) for pattern in self.names)
            and any(_is_like(path, pattern) for pattern in self.paths)
            and (not self.where or any(not _same(base, head, other) for other in self.where))
        )


@dataclass(frozen=True)
class Bounds:
    """Everything that is stated: of fields, the first that fits; of files, which may be gone."""

    fields: tuple[Stated, ...] = ()
    gone: Mapping[str, str] = field(default_factory=dict)

    def of(self, path: str, name: str, base: Values, head: Values) -> Stated | None:
        return next((each for each in self.fields if each.fits(path, name, base, head)), None)

    def reason_gone(self, path: str) -> str | None:
        """Why a file of this path may be gone."""
        return next((self.gone[each] for each in self.gone if _is_like(path, each)), None)


@dataclass
class Field:
    """All differences of one field, over all documents for which the same is stated.

    new, gone: the values that only the head or only the base holds. words: sentences that are not
    the same, which nobody judges, unless `words_decide`: then they are other values. other: values
    of another truth, word, type or exact number. moved: the floats that are not the same; `largest`
    is the largest difference of them, `share` the same as a part of the magnitude that its bound is
    a share of. beyond: how many of them all are not as stated.
    """

    name: str
    stated: Stated | None = None
    words_decide: bool = False
    files: set[str] = field(default_factory=set)
    new: int = 0
    gone: int = 0
    words: int = 0
    other: int = 0
    moved: int = 0
    largest: float = 0.0
    share: float = 0.0
    beyond: int = 0
    example: str = ""

    def __str__(self) -> str:
        kinds = ("new", "gone", "words", "other")
        told = [f"{count} {kind}" for kind in kinds if (count := getattr(self, kind))]
        share = f", a share of {self.share:.1e}" if math.isfinite(self.share) else ""
        moved = f"{self.moved} moved by {self.largest:.1e}{share}, at most"
        told += [moved] * bool(self.moved)
        return f"{self.name}: {', '.join(told)}, in {len(self.files)} files"

    @property
    def verdict(self) -> str:
        if self.beyond:
            return BEYOND
        if self.gone + self.other or (self.moved and self._may_change):
            return "changed as stated"
        if self.moved:
            return "within its bound"
        return "new" if self.new else "other words"

    def add(self, path: str, base: Values, head: Values) -> None:
        """Count what differs of the field in a document of a file."""
        before, after = base.get(self.name, []), head.get(self.name, [])
        counted = self.beyond
        self.files.add(path)
        if not before:
            self.new += len(after)
        elif not self.words_decide and _is_prose(self.name, before, after):
            self.words += 1
        elif not after:
            self.gone += len(before)
            self.beyond += 0 if self._may_change else len(before)
        else:
            self._hold(before, after, self._size(base, head))
        if self.beyond > counted and not self.example:
            self.example = f"{path}: {_short(before)} was, {_short(after)} is"

    @property
    def _may_change(self) -> bool:
        return self.stated is not None and self.stated.changes

    def _hold(self, before: list[Any], after: list[Any], size: float) -> None:
        """Values beside values; those of a longer list are other ones."""
        others = abs(len(before) - len(after))
        for old, new in zip(before, after, strict=False):
            if isinstance(old, float) and isinstance(new, float):
                self._move(old, new, size)
            else:
                others += repr(old) != repr(new)  # 3 is not 3.0, nor is 1 true
        self.other += others
        self.beyond += 0 if self._may_change else others

    def _move(self, old: float, new: float, size: float) -> None:
        if old == new or (math.isnan(old) and math.isnan(new)):
            return
        if self.stated is not None and self.stated.either_sign:
            old, new = abs(old), abs(new)
        move = abs(old - new) if math.isfinite(old) and math.isfinite(new) else math.inf
        share = move / size if size else math.inf
        self.moved += 1
        self.largest, self.share = max(self.largest, move), max(self.share, share)
        if self._may_change:
            return
        absolute, part = (self.stated.absolute, self.stated.share) if self.stated else (0.0, 0.0)
        self.beyond += move > absolute and share > part

    def _size(self, base: Values, head: Values) -> float:
        """The largest magnitude of the numbers that a share is taken of."""
        names = (self.stated.of if self.stated else ()) or (self.name,)
        numbers = [
            abs(value)
            for name in names
            for value in (*base.get(name, []), *head.get(name, []))
            if isinstance(value, float) and math.isfinite(value)
        ]
        return max(numbers, default=0.0)


def changed_fields(
    documents: Iterable[tuple[str, Values, Values]],
    bounds: Bounds | None = None,
    *,
    words_decide: bool = False,
) -> tuple[Field, ...]:
    """The fields that differ, by their names, each held to what is stated.

    Of each document where it stands, and its fields in the base and in the head.
    """
    found = dict[tuple[str, Stated | None], Field]()
    stated = bounds or Bounds()
    for path, base, head in documents:
        for name in (name for name in {**base, **head} if not _same(base, head, name)):
            entry = stated.of(path, name, base, head)
            row = found.setdefault((name, entry), Field(name, entry, words_decide))
            row.add(path, base, head)
    return tuple(sorted(found.values(), key=lambda row: (row.name, str(row.stated))))


def read_fields(document: Any) -> Values:
    """The values of a JSON document by the names of its fields; places within lists have none.

    An empty list or object is a value, too: what stands in it later is no new field.
    """
    values = defaultdict[str, list[Any]](list)
    for name, value in _leaves(document):
        values[name].append(value)
    return dict(values)


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict) and value:
        for key, part in value.items():
            yield from _leaves(part, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list):
        for part in value:
            yield from _leaves(part, f"{name}[]")
        if not value:
            yield f"{name}[]", []
    else:
        yield name, value


def read_bounds(path: Path) -> Bounds:
    """The table of what may change, and how far numbers may move."""
    table = tomllib.loads(path.read_text("utf-8"))
    lists = ("names", "paths", "where", "of")
    fields = tuple(
        Stated(**{**entry, **{key: tuple(entry[key]) for key in lists if key in entry}})
        for entry in table.get("field", [])
    )
    gone = {entry["path"]: entry["reason"] for entry in table.get("gone", [])}
    return Bounds(fields, gone)


def _same(base: Values, head: Values, name: str) -> bool:
    """Whether a field is the same; the sign of a zero is no difference."""
    before, after = base.get(name, []), head.get(name, [])
    return len(before) == len(after) and all(
        repr(old) == repr(new) or (isinstance(old, float) and isinstance(new, float) and old == new)
        for old, new in zip(before, after, strict=True)
    )


def _is_prose(name: str, before: Sequence[Any], after: Sequence[Any]) -> bool:
    """Whether a field is told in sentences, on both sides, or says why another has no value."""
    if ".reasons." in f".{name}":
        return True
    told = [value for value in (*before, *after) if value is not None]
    sentences = all(isinstance(value, str) and " " in value for value in told)
    return bool(told and after) and sentences


def _is_like(name: str, pattern: str) -> bool:
    """Whether a name fits a pattern in which * is anything, and brackets are themselves."""
    first, *parts = pattern.split("*")
    if not parts:
        return name == pattern
    if not (name.startswith(first) and name.endswith(parts[-1])):
        return False
    rest = name[len(first) : len(name) - len(parts[-1])]
    if len(name) < len(first) + len(parts[-1]):
        return False
    for part in parts[:-1]:
        found = rest.find(part)
        if found < 0:
            return False
        rest = rest[found + len(part) :]
    return True


def _short(values: Sequence[Any], length: int = 60) -> str:
    text = repr(values[0] if len(values) == 1 else list(values))
    return text if len(text) <= length else f"{text[:length]}..."
