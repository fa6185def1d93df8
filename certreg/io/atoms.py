"""Cα atoms of proteins, whatever file they stood in, with labels chain:residue:atom.

Of several models the first is taken, of several places of an atom the most occupied one, each with
a note. An insertion code is part of the residue: A:52A:CA is not A:52:CA.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, NamedTuple

from certreg.io.streams import number, refused
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from certreg.io.streams import Place


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


class CarbonAlphas(NamedTuple):
    """Coordinates, labels and what the user should know."""

    coordinates: array[float]
    labels: tuple[str, ...]
    notes: tuple[str, ...]


def carbon_alphas(atoms: Iterable[Atom], file: Path) -> CarbonAlphas:
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
            words = f"atom {shown(atom.label)} comes again: is it the file of one molecule?"
            raise atom.place.refusal(words, column="atom", value=atom.label)
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
    return CarbonAlphas(coordinates, tuple(kept), tuple(notes))
