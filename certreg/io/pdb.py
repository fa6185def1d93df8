"""Cα atoms of .pdb files. Standard library only: the columns of the format are fixed.

Numbers are read from their columns and from nowhere else; where a row was moved by a character, no
number is left in them, and it is refused. The last model must be closed, and END or ENDMDL stand
behind the last atom: what was cut shows.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from certreg.io.atoms import Atom, CarbonAlphas, carbon_alphas
from certreg.io.streams import Place
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

RECORDS = ("ATOM  ", "HETATM")
ENDS = {"END", "ENDMDL"}
COORDINATE = re.compile(r" *-?[0-9]{1,6}\.[0-9]+ *")
RESIDUE = re.compile(r"-?[0-9]+[A-Za-z]?")


def parse_pdb(lines: Iterator[str], file: Path) -> CarbonAlphas:
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
            words = f"'{shown(text)}' in columns 31 to 54 is not a coordinate: mend the columns"
            raise place.refusal(words, value=text)
    if not RESIDUE.fullmatch(residue):
        words = f"'{shown(residue)}' in columns 23 to 27 is not a residue number: mend the columns"
        raise place.refusal(words, value=residue)
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
