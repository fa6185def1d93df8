"""The documents within what was recorded: their fields, and the words around them."""

from __future__ import annotations

import json
import re
from collections import Counter, defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from same import fields

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from comparison import Difference
    from same.fields import Bounds, Field, Values

BOUNDS = Path(__file__).parent / "bounds.toml"

CODE = re.compile(r"\A\$ .*\nexit code (-?\d+)\n")  # as record.py writes it
CALL = re.compile(r"\A\$ python (\w+)")  # of public_calls.py, which prints a value a line
TOLD = re.compile(r"(?m)^([\w. -]+): (?=[\[{\"])")
NUMBERS = re.compile(r"[-+]?(?:\d[\d,]*)?\.?\d+(?:e[-+]?\d+)?")


def read_documents(text: str) -> dict[str, dict[str, list[Any]]]:
    """Of each document in the text of a file, the values by the names of the fields.

    Places within lists have no names. The documents are named by their numbers; the values of a
    call from Python by what is told with them, and each part of such a value by its place. The exit
    code of a step is a document of its own.
    """
    found = dict[str, dict[str, list[Any]]]()
    if ended := CODE.match(text):
        found["step"] = {"exit code": [int(ended[1])]}
    if called := CALL.match(text):
        for name, value in _told(text):
            leaves = _leaves_of_a_call(value, f"{called[1]}()")
            found[name] = _gathered(leaves)
        return found
    for number, document in enumerate(_documents(text)[0]):
        found[str(number)] = _gathered(_leaves(document))
    if plain := _plain_numbers(text):
        found["numbers"] = plain
    return found


def read_words(text: str) -> str:
    """The text without its documents and the values of calls."""
    if CALL.match(text):
        return TOLD.sub("", "\n".join(line for line in text.split("\n") if not TOLD.match(line)))
    return _documents(text)[1]


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


def _told(text: str) -> Iterator[tuple[str, Any]]:
    """The lines of a call: a name, and its value; a name that comes again with its number."""
    times = Counter[str]()
    for line in text.split("\n"):
        if start := TOLD.match(line):
            times[start[1]] += 1
            yield f"{start[1]} {times[start[1]]}", json.loads(line[start.end() :])


def _plain_numbers(text: str) -> dict[str, list[Any]]:
    """Of a file that is nothing but rows of numbers, these: clouds and poses as written."""
    lines = [line for line in text.split("\n") if line]
    words = [re.split(r"[ ,]+", line) for line in lines]
    try:
        return (
            {"rows of numbers[]": [float(word) for row in words for word in row]} if lines else {}
        )
    except ValueError:
        return {}


def _gathered(leaves: Iterator[tuple[str, Any]]) -> dict[str, list[Any]]:
    values = defaultdict[str, list[Any]](list)
    for name, value in leaves:
        values[name].append(value)
    return dict(values)


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _leaves(part, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list):
        for part in value:
            yield from _leaves(part, f"{name}[]")
    else:
        yield name, value


def _leaves_of_a_call(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """The same, but a list whose parts are not alike is a record: its parts have places."""
    if isinstance(value, list) and len({_depth(part) for part in value}) > 1:
        for place, part in enumerate(value):
            yield from _leaves_of_a_call(part, f"{name}[{place}]")
    elif isinstance(value, list):
        for part in value:
            yield from _leaves_of_a_call(part, f"{name}[]")
    else:
        yield from _leaves(value, name)


def _depth(value: Any) -> int:
    """How deep lists are nested in a value."""
    return 1 + max(map(_depth, value), default=0) if isinstance(value, list) else 0


def changed_fields(
    differences: Iterable[Difference], bounds: Bounds | None = None
) -> tuple[Field, ...]:
    """The fields that differ, of documents in both records and of new ones in files of both."""
    return fields.changed_fields(_read_sides(differences), bounds)


def _read_sides(differences: Iterable[Difference]) -> Iterator[tuple[str, Values, Values]]:
    for difference in differences:
        if difference.base is None or difference.head is None:
            continue
        base, head = read_documents(difference.base), read_documents(difference.head)
        for place in (place for place in {**base, **head} if place in head):
            yield difference.path, base.get(place, {}), head[place]


def gone_files(differences: Iterable[Difference], bounds: Bounds) -> dict[str | None, list[str]]:
    """The files of which a document, or all, is in the base alone, by the reason that is stated.

    Those that nobody stated stand under None.
    """
    found = defaultdict[str | None, list[str]](list)
    for difference in differences:
        sides = (read_documents(text or "") for text in (difference.base, difference.head))
        if difference.head is None or next(sides).keys() - next(sides).keys():
            found[bounds.reason_gone(difference.path)].append(difference.path)
    return dict(found)
