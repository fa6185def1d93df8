"""Parts of a certificate's file: dataclasses whose fields are entries of JSON, and back.

All kinds are written and read by one derivation, from annotations, as `certreg.verify` reads its
statements. A field of this type is in the file

    bool, int, str, dict      itself; of an object nothing is read
    Dyadic                    [mantissa, exponent]
    tuple[int, ...]           a list of integers; tuple[int, int] of two, Annotated[tuple[int, ...],
                              lengths] of a number in these
    tuple[X, ...]             a list
    FilePart                  an object, of its fields by name
    FileRow                   a list, of its fields in order
    X | Y                     either; None is null

and whatever else stands there is misread: true is no integer, and no key is missing or too many.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import fields
from functools import cache
from itertools import chain, repeat
from operator import attrgetter, call
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    ClassVar,
    NamedTuple,
    Self,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from certreg.exact.dyadic import Dyadic
from certreg.results import Brief
from certreg.verify import EXPONENT_MAX, NODES_MAX

INTEGERS, PAIR = {int}, [int, int]  # true is of another type
APPLY: Any = call  # whose types say less
EVERY = range(NODES_MAX)  # length: a file has no longer list
REST = "*"  # the place of a field of a row whose entries end the list


class MisreadError(ValueError):
    """A value in a file is not what its field takes; the message says where, and what is taken.

    Which file, and what to give, is added by `Certificate.load`.
    """

    def __init__(self, fault: str, place: str = "") -> None:
        super().__init__(f"{place.lstrip('.') or 'the certificate'} {fault}")
        self.fault, self.place = fault, place

    def inside(self, place: str) -> MisreadError:
        """The same of a value within another."""
        return MisreadError(self.fault, place + self.place)


class FilePart(Brief):
    """A dataclass that is an object of a file.

    PLACES: of fields that do not stand under their names. "key"; "object.key", in an object that is
    null where all its entries are; "key?", left out where the field has its default.
    """

    __slots__ = ()
    PLACES: ClassVar[dict[str, str]] = {}

    def to_fields(self) -> Any:
        """The object, or the list, of the file."""
        return form_of(type(self)).write(self)

    @classmethod
    def from_fields(cls, given: object) -> Self:
        """The inverse of `to_fields`. Raises MisreadError."""
        return form_of(cls).read(given)


class FileRow(FilePart):
    """A dataclass that is a list of a file. PLACES: of its last field, if it is the REST."""

    __slots__ = ()


class FieldForm(NamedTuple):
    """How values of a type are written and read, and their class in JSON.

    nullable: reads what may be null, where an object may say that in its entries, too.
    """

    write: Callable[[Any], Any]
    read: Callable[[Any], Any]
    json: type
    nullable: Callable[[Any], Any] | None = None


class Entry(NamedTuple):
    """A field in an object or a list; left_out: its default, where it is left out then.

    name: "" of several fields, in an object within.
    """

    name: str
    form: FieldForm
    left_out: tuple[Any, ...] = ()


@cache
def form_of(hint: Any) -> FieldForm:
    """Of a type that this module lists. Raises TypeError for all others."""
    kind, parts = get_origin(hint) or hint, get_args(hint)
    if kind in PLAIN:
        return PLAIN[kind]
    if kind is Annotated:
        return _integers(parts[1])
    if kind in {Union, UnionType}:
        return _either(parts)
    if kind is tuple and {*parts} <= {int, ...}:
        return _integers(EVERY if ... in parts else (len(parts),))
    if kind is tuple and parts[1:] == (...,):
        return _several(form_of(parts[0]))
    if isinstance(kind, type) and issubclass(kind, FilePart):
        return (_list if issubclass(kind, FileRow) else _object)(kind, _entries_of(kind))
    raise TypeError(f"no entry of a file is {hint}: give the field a type that {__name__} lists")


def _entries_of(kind: Any) -> dict[str, Entry]:
    """Of a dataclass, by their keys; what its PLACES put into an object within is one of them."""
    hints, groups = get_type_hints(kind, include_extras=True), {"": dict[str, Entry]()}
    for field in fields(kind):
        hint, name = hints[field.name], field.name
        place, _, key = kind.PLACES.get(name, name).rpartition(".")
        form = form_of(get_args(hint)[0] if key == REST else hint)
        entry = Entry(name, form, (field.default,) if key.endswith("?") else ())
        groups.setdefault(place, {})[key.rstrip("?")] = entry
    own = groups.pop("")
    return own | {place: Entry("", _object(None, group)) for place, group in groups.items()}


def _object(kind: Any, entries: dict[str, Entry]) -> FieldForm:
    """Of an object; kind: the class of the part, None where these entries are of a larger one."""
    needed = {key for key, entry in entries.items() if not entry.left_out}
    reads = [(key, name, form.read, absent) for key, (name, form, absent) in entries.items()]

    def write(part: Any) -> dict[str, Any] | None:
        values = {
            key: form.write(value)
            for key, (name, form, left_out) in entries.items()
            if (value := getattr(part, name) if name else part) not in left_out
        }
        return None if kind is None and _is_null(values) else values

    def require_keys(given: Any) -> None:
        if given.__class__ is not dict:
            raise MisreadError("is not an object")
        if given.keys() != needed and not needed <= given.keys() <= entries.keys():
            keys = (key + "?" * (key not in needed) for key in sorted(entries))
            raise MisreadError(f"must have exactly the keys {' '.join(keys)}")

    def read(given: Any) -> Any:
        part: Any = dict.fromkeys(needed) if given is None and kind is None else given
        require_keys(part)
        values, key = dict[str, Any](), ""
        try:
            for key, name, read_entry, left_out in reads:
                value = part.get(key)
                if value is not None or not left_out:
                    found = read_entry(value)
                    values |= {name: found} if name else found
        except MisreadError as error:
            raise error.inside(f".{key}") from None
        return values if kind is None else kind(**values)

    def read_or_null(given: Any) -> Any:
        require_keys(given)
        return None if _is_null(given) else read(given)

    return FieldForm(write, read, dict, read_or_null)


def _is_null(given: dict[str, Any]) -> bool:
    """Whether all entries of an object are null: so is the object then, as for the checker."""
    return {*map(type, given.values())} == {NoneType}


def _list(kind: Any, entries: dict[str, Entry]) -> FieldForm:
    """Of a list of these entries, the last, if it is the REST, any number of times."""
    *first, last = entries.values()
    names, reads = zip(*((name, form.read) for name, form, _ in entries.values()), strict=True)
    more = REST in entries
    count = len(reads) - more

    def write(row: Any) -> list[Any]:
        found = [entry.form.write(getattr(row, entry.name)) for entry in first]
        ends = getattr(row, last.name)
        return [*found, *map(last.form.write, ends if more else (ends,))]

    def read(given: Any) -> Any:
        values = _read_each(given, chain(reads, repeat(last.form.read)), count, more=more)
        if more:
            values[count:] = [tuple(values[count:])]
        return kind(**dict(zip(names, values, strict=True)))

    return FieldForm(write, read, list)


def _several(form: FieldForm) -> FieldForm:
    def write(values: Iterable[Any]) -> list[Any]:
        return [*map(form.write, values)]

    def read(value: Any) -> tuple[Any, ...]:
        return tuple(_read_each(value, repeat(form.read), 0, more=True))

    return FieldForm(write, read, list)


def _read_each(
    value: Any, reads: Iterable[Callable[[Any], Any]], count: int, *, more: bool
) -> list[Any]:
    """The entries of a list of so many, or more."""
    if value.__class__ is not list or len(value) < count or (len(value) > count and not more):
        size = f" of {count}{' or more' * more} entries" if count else ""
        raise MisreadError(f"is not a list{size}")
    found = list[Any]()
    try:
        found.extend(map(APPLY, reads, value))
    except MisreadError as error:
        raise error.inside(f"[{len(found)}]") from None
    return found


def _either(hints: Sequence[Any]) -> FieldForm:
    """One of several types, told apart by the class of a value; else the first says what it is."""
    forms = {get_origin(hint) or hint: form_of(hint) for hint in hints}
    first, *_ = forms.values()
    writes = {kind: form.write for kind, form in forms.items()}
    reads = {form.json: form.read for form in forms.values()}
    if NoneType in forms and first.nullable is not None:
        reads[first.json] = first.nullable

    def write(value: Any) -> Any:
        return writes.get(value.__class__, first.write)(value)

    def read(value: Any) -> Any:
        return reads.get(value.__class__, first.read)(value)

    return FieldForm(write, read, first.json)


def _integers(lengths: Container[int]) -> FieldForm:
    def read(value: Any) -> tuple[int, ...]:
        if value.__class__ is list and len(value) in lengths and {*map(type, value)} <= INTEGERS:
            return tuple(value)
        raise MisreadError("is not a list of integers of the right length")

    return FieldForm(list, read, list)


def _itself(value: Any) -> Any:
    return value


def _plain(kind: type, words: str) -> FieldForm:
    def read(value: Any) -> Any:
        if value.__class__ is not kind:
            raise MisreadError(f"is not {words}")
        return value

    return FieldForm(_itself, read, kind)


def _dyadic(value: Any) -> Dyadic:
    if value.__class__ is list and [*map(type, value)] == PAIR:
        mantissa, exponent = value
        if -EXPONENT_MAX <= exponent <= EXPONENT_MAX:
            return Dyadic(mantissa=mantissa, exponent=exponent)
    raise MisreadError("is not a number [mantissa, exponent]")


PLAIN = {
    bool: _plain(bool, "true or false"),
    int: _plain(int, "an integer"),
    str: _plain(str, "a text"),
    dict: _plain(dict, "an object"),
    NoneType: _plain(NoneType, "null"),
    Dyadic: FieldForm(attrgetter("pair"), _dyadic, list),
}
