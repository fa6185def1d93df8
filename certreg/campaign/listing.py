"""The list of pairs of a campaign.

It is a .csv file whose header names what each row gives. `source` and `target` are files of
clouds, relative to the list; `name` (or `label`) is what the results call the pair, else pair-1,
pair-2, ...; `sigma`, `weights`, `pairs`, `match`, `damping`, `scale`, `springs` (several kinds with
blanks between them), the files of springs, `max_residual`, `objective` and `effort` are as the
options of `certreg certify`, `rotation_only` is yes or no; a field is empty where there is nothing
to say.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg.errors import InvalidFileError
from certreg.io.row_values import read_bounds
from certreg.io.streams import Place, number, reading, refused
from certreg.io.text import parse_rows
from certreg.problem.support import BOUNDED
from certreg.verify import shown

if TYPE_CHECKING:
    from certreg.io.pairing import Pair

NEEDED = ("source", "target")
MOST_SHOWN = 120  # letters of a header: a line of a message
SPRING_FILES = ("normals", "directions", "covariances", "information", "factors")
MODEL = ("scale", "rotation_only")
BOUNDS = ("max_residual", "objective", "effort")
OF_A_PAIR = ("name", "sigma", "weights", "pairs", "match", "damping", *MODEL, *BOUNDS)
COLUMNS = (*NEEDED, *OF_A_PAIR, "springs", *SPRING_FILES)
LIKENESS = 0.75  # of difflib, from 0 to 1: a name so like one that is read was meant to be it
MAX_LIST_BYTES = 1 << 30


@dataclass(frozen=True, slots=True, kw_only=True)
class PairRow:
    """A row of a list, as it is written: nothing is read or checked yet.

    place: name of the list and line. fault: why the row cannot be used, if it cannot.
    """

    number: int  # from 0
    place: Place
    name: str
    fields: dict[str, str]  # of COLUMNS; empty ones are left out
    fault: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Listing:
    """A list of pairs: the bytes of the file, how many rows it has, columns that are not read."""

    path: Path
    content: bytes
    count: int
    ignored: tuple[str, ...]

    @property
    def digest(self) -> str:
        """SHA-256 of the file."""
        return hashlib.sha256(self.content).hexdigest()

    def rows(self) -> Iterator[PairRow]:
        """The rows, one after the other; a row whose name stands before is at fault."""
        header, rows = _headed(Path(self.path.name), self.content)
        first: dict[str, str] = {}
        for count, (place, values) in enumerate(rows, 1):
            fields = dict(zip(header, map(str.strip, values), strict=False))
            fields = {key: value for key, value in fields.items() if key in COLUMNS and value}
            name = fields.pop("name", f"pair-{count}")
            fault = None
            if len(values) != len(header):
                fault = f"{len(values)} columns, not {len(header)}: mend the row"
            elif name in first:
                fault = f"the name '{shown(name)}' is that of {first[name]}, too: give another"
            first.setdefault(name, f"line {place.line}")
            yield PairRow(number=count - 1, place=place, name=name, fields=fields, fault=fault)


def read_listing(path: Path) -> Listing:
    """The list in a file. Raises InvalidFileError: file, place, remedy."""
    if path.suffix.lower() != ".csv":
        raise refused(
            path,
            "a list of pairs is a .csv file with columns source and target",
            value=path.suffix,
            limit=".csv",
        )
    with reading(path) as stream:
        content = stream.read(MAX_LIST_BYTES + 1)
    if len(content) > MAX_LIST_BYTES:
        raise refused(
            path,
            f"more than {MAX_LIST_BYTES} bytes: give several smaller lists",
            limit=MAX_LIST_BYTES,
        )
    header, rows = _headed(path, content)
    count = sum(1 for _ in rows)
    if count == 0:
        raise refused(path, "lists no pairs: add rows below the header", value=0, limit=1)
    ignored = tuple(name for name in header if name not in COLUMNS)
    _require_unlike(path, header, ignored)
    return Listing(path=path.resolve(), content=content, count=count, ignored=ignored)


def _require_unlike(path: Path, header: list[str], ignored: tuple[str, ...]) -> None:
    """That no column that is not read is a misspelt one that is: `sigm` must not go unread."""
    absent = [name for name in COLUMNS if name not in header]
    for name in ignored:
        meant = get_close_matches(name, absent, n=1, cutoff=LIKENESS)
        if meant:
            raise refused(
                path,
                f"column '{shown(name)}' is not known: did you mean '{meant[0]}'? "
                "Rename it, or give it another name if it is not to be read",
                column=name,
                limit=meant[0],
            )


def _headed(path: Path, content: bytes) -> tuple[list[str], Iterator[tuple[Place, list[str]]]]:
    """The names of the columns, and the rows below, with their places."""
    rows = parse_rows(io.BytesIO(content), path)
    place, first = next(rows, (None, list[str]()))
    names = [name.strip().lower() for name in first]
    if "name" not in names:
        names = ["name" if name == "label" else name for name in names]
    lacking = [name for name in NEEDED if name not in names]
    wrong = lacking + [name for name in COLUMNS if names.count(name) > 1]
    if wrong:
        header = f"the header ({shown(', '.join(first)[:MOST_SHOWN])}) names"
        fault = f"{header} {wrong[0]} more than once: name each column once"
        if lacking:
            lacks = f"{header} no {' and no '.join(lacking)}" if first else "there is no header"
            fault = f"{lacks}: name the columns with the files of the two clouds source and target"
        raise InvalidFileError(
            f"{place or shown(path)}: {fault}",
            path=path,
            line=None if place is None else place.line,
            column=wrong[0],
        )
    return names, rows


def bounds_file(row: PairRow) -> str | None:
    """The file that a row names as its bounds; None for a number, or nothing."""
    text = row.fields.get("max_residual")
    return None if text is None or _number(row, text) is not None else text


def fault_of_bounds(row: PairRow) -> str | None:
    """Why what a row says of wrong pairs does not go together, if it does not."""
    fields = row.fields
    beside = [name for name in ("objective", "effort") if name in fields]
    if beside and "max_residual" not in fields:
        return f"{beside[0]} goes with max_residual: give that, too"
    if fields.get("objective") not in {None, *BOUNDED}:
        return f"objective is '{shown(fields['objective'])}': write {' or '.join(BOUNDED)}"
    return None


def asked_of_bounds(row: PairRow, folder: Path, pair: Pair) -> dict[str, Any]:
    """The arguments of `certify` that a row gives, beside its problem; none without a bound."""
    text = row.fields.get("max_residual")
    if text is None:
        return {}
    file = bounds_file(row)
    if file is not None and not (folder / file).is_file():
        what = f"'{shown(file)}' is neither a number nor a file"
        raise row.place.at("max_residual").refusal(f"{what}: give one", value=file)
    asked = {
        "max_residual": _number(row, text) if file is None else read_bounds(folder / file, pair),
        "objective": row.fields.get("objective"),
    }
    effort = row.fields.get("effort")
    return asked if effort is None else asked | {"effort": number(row.place.at("effort"), effort)}


def _number(row: PairRow, text: str) -> float | None:
    try:
        return number(row.place.at("max_residual"), text)
    except InvalidFileError:
        return None
