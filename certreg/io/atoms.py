"""Molecules: Cα atoms of proteins, with labels chain:residue:atom; chemical .xyz files. No NumPy.

Of several models the first is taken, of several places of an atom the most occupied one, each with
a note. An insertion code is part of the residue: A:52A:CA is not A:52:CA.

In .pdb files numbers are read from their columns and from nowhere else; where a row was moved by a
character, no number is left in them, and it is refused. The last model must be closed, and END or
ENDMDL stand behind the last atom: what was cut shows.

A chemical .xyz file is a count, a comment, then `symbol x y z` a line. Element symbols are no
labels: many atoms share one. What stands behind z is ignored. A second frame of a trajectory is
more rows than declared, and refused.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterable, Iterator
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple

from certreg.io.columns import Points
from certreg.io.streams import COUNT, Place, count, number, refused
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path


class Atom(NamedTuple):
    """A row of a file of atoms; texts as they stand there, without blanks at their ends."""

    place: Place
    model: str
    chain: str
    residue: str  # its number and insertion code
    name: str
    element: str
    alternative: str  # of several places of an atom, which
    occupancy: str  # may be empty: 1
    position: tuple[str, str, str]

    @property
    def label(self) -> str:
        """What pairs it."""
        return f"{self.chain}:{self.residue}:{self.name}"


def carbon_alphas(atoms: Iterable[Atom], file: Path) -> Points:
    """The Cα atoms of the first model, in their order; every number of it is read and checked."""
    kept: dict[str, tuple[float, list[float]]] = {}
    places = set[tuple[str, str]]()
    models, several, others = dict[str, None](), set[str](), 0
    for atom in atoms:
        models[atom.model] = None
        position = [number(atom.place, text) for text in atom.position]
        if len(models) > 1:
            continue
        if atom.name != "CA" or atom.element != "C":
            others += 1
            continue
        occupancy = number(atom.place, atom.occupancy) if atom.occupancy else 1.0
        if (atom.label, atom.alternative) in places:
            raise atom.place.refusal(
                f"atom {shown(atom.label)} comes again: is it the file of one molecule?",
                column="atom",
                value=atom.label,
            )
        places.add((atom.label, atom.alternative))
        before = kept.get(atom.label)
        if before is not None:
            several.add(atom.label)
        if before is None or occupancy > before[0]:
            kept[atom.label] = occupancy, position
    if not kept:
        raise refused(
            file, "no Cα atoms: give a protein, or save the points as .csv", value=0, limit=1
        )
    notes = [f"{len(kept)} Cα atoms, {others} other atoms not used"]
    if len(models) > 1:
        notes.append(f"the first of {len(models)} models (save another one alone to read it)")
    if several:
        notes.append(f"of {len(several)} with alternative places, the most occupied one")
    coordinates = array("d", (x for _, position in kept.values() for x in position))
    return Points(coordinates, tuple(kept), (), tuple(kept), notes=tuple(notes))


RECORDS = ("ATOM  ", "HETATM")
ENDS = {"END", "ENDMDL"}
COORDINATE = re.compile(r" *-?[0-9]{1,6}\.[0-9]+ *")
RESIDUE = re.compile(r"-?[0-9]+[A-Za-z]?")


def parse_pdb(lines: Iterator[str], file: Path) -> Points:
    """The Cα atoms of the first model."""
    return carbon_alphas(_atoms(lines, file), file)


def _atoms(lines: Iterator[str], file: Path) -> Iterator[Atom]:
    """The atoms; records END and TER, MODEL and ENDMDL are checked on the way."""
    model, opened, ended, k = "", None, False, 0
    for k, raw in enumerate(lines, 1):
        line, place = raw.rstrip("\r\n"), Place(file, k)
        record = line[:6].ljust(6)
        ended = record.rstrip() in ENDS or (ended and record not in RECORDS)
        if record == "MODEL ":
            model = line[10:14].strip() or f"in line {k}"
            opened = place
        elif record == "ENDMDL":
            opened = None
        elif record in RECORDS:
            yield _atom(place, line, model)
    if opened is not None:
        raise opened.refusal("the model is not closed by ENDMDL: is the file truncated?")
    if not ended:
        raise Place(file, max(1, k)).refusal("no END behind the atoms: is the file truncated?")


def _atom(place: Place, line: str, model: str) -> Atom:
    """The atom of a row; columns as the format counts them, from 1: 13-16 name, 31-54 place."""
    position = line[30:38], line[38:46], line[46:54]
    residue = line[22:27].replace(" ", "")
    for text in position:
        if len(text) != 8 or not COORDINATE.fullmatch(text):
            raise place.refusal(
                f"'{shown(text)}' in columns 31 to 54 is not a coordinate: mend the columns",
                value=text,
            )
    if not RESIDUE.fullmatch(residue):
        raise place.refusal(
            f"'{shown(residue)}' in columns 23 to 27 is not a residue number: mend the columns",
            value=residue,
        )
    field = line[12:16]
    element = line[76:78].strip().upper() or ("C" if field.startswith(" C") else "")
    x, y, z = (text.strip() for text in position)
    return Atom(
        place=place,
        model=model,
        chain=line[21:22].strip(),
        residue=residue,
        name=field.strip(),
        element=element,
        alternative=line[16:17].strip(),
        occupancy=line[54:60].strip(),
        position=(x, y, z),
    )


SYMBOL = re.compile(r"[A-Za-z][A-Za-z0-9_+*'-]*")  # no number: x y z i behind a count is refused


def chemical(lines: Iterator[str]) -> tuple[str | None, Iterator[str]]:
    """The count that a chemical file begins with, if it does, and the lines as they were."""
    first = next(lines, "")
    declared = first.strip() if COUNT.fullmatch(first.strip()) else None
    return declared, chain([first], lines)


def chemical_points(lines: Iterator[str], file: Path, declared: str) -> Points:
    """The points of a chemical file, from its first line on, and what stands behind z."""
    expected, coordinates, width = count(Place(file, 1), declared), array("d"), 0
    for line, text in enumerate(lines, 1):
        words, place = text.split(), Place(file, line)
        if line <= 2 or not words:
            continue
        width = width or len(words)
        if len(coordinates) == 3 * expected:
            raise place.refusal(
                f"more than the {expected} points of line 1: give one frame only", limit=expected
            )
        if len(words) < 4 or len(words) != width or not SYMBOL.fullmatch(words[0]):
            raise place.refusal(
                "not 'symbol x y z' with as many columns as the rows above: mend it",
                value=text.strip(),
            )
        coordinates.extend(number(place, word) for word in words[1:4])
    if len(coordinates) != 3 * expected or not coordinates:
        held = len(coordinates) // 3
        what = f"declares {expected} points, the file holds {held}"
        raise Place(file, 1).refusal(
            f"{what}: give at least one, and the true count", value=held, limit=expected
        )
    return Points(coordinates, None, tuple(f"column {k}" for k in range(5, width + 1)))
