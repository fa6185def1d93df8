"""Cα atoms of .cif files (mmCIF), by gemmi's parser; chains and residues as authors name them.

Only the texts are gemmi's: numbers are read as everywhere in certreg.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.atoms import Atom, carbon_alphas
from certreg.io.cloud import Cloud
from certreg.io.optional import optional_library
from certreg.io.streams import MAX_TEXT_BYTES, Place, refused
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

CONVERTER = "gemmi convert {file} {stem}.pdb"
CATEGORY = "_atom_site."
NEEDED = ("auth_asym_id", "auth_seq_id", "label_atom_id", "type_symbol")
PLACES = ("Cartn_x", "Cartn_y", "Cartn_z")
OPTIONAL = ("pdbx_PDB_ins_code", "label_alt_id", "occupancy", "pdbx_PDB_model_num")
UNCERTAIN = re.compile(r"\([0-9]+\)")  # 1.234(5)
NOTHING = {"?", "."}


def parse_cif(stream: BinaryIO, file: Path) -> Cloud:
    """The Cα atoms of the first model of the only block that has atoms."""
    cif = optional_library("gemmi", file, CONVERTER).cif
    content = stream.read(MAX_TEXT_BYTES + 1)
    if len(content) > MAX_TEXT_BYTES:
        raise refused(
            file,
            f"more than {MAX_TEXT_BYTES} bytes are too many: is it a molecule?",
            limit=MAX_TEXT_BYTES,
        )
    try:
        document = cif.read_string(content.decode("utf-8"))
    except (ValueError, RuntimeError) as error:
        raise refused(
            file, f"is not a .cif file ({shown(str(error)[:80])}): save it again"
        ) from error
    found = carbon_alphas(_atoms(document, cif, file), file)
    points = np.array(found.coordinates).reshape(-1, 3)
    return Cloud(
        path=file, points=points, labels=found.labels, identifiers=found.labels, notes=found.notes
    )


def _atoms(document: Any, cif: Any, file: Path) -> Iterator[Atom]:
    tags = [*NEEDED, *PLACES, *(f"?{name}" for name in OPTIONAL)]
    tables = [block.find(CATEGORY, tags) for block in document]
    tables = [table for table in tables if len(table)]
    if len(tables) != 1:
        what = f"{len(tables)} blocks with {CATEGORY}Cartn_x and names of atoms: give one"
        raise InvalidFileError(f"{shown(file)}: {what}", path=file, value=len(tables), limit=1)
    (table,) = tables
    for k, row in enumerate(table, 1):
        texts = [
            "" if not row.has(i) or row[i] in NOTHING else cif.as_string(row[i])
            for i in range(len(tags))
        ]
        chain, residue, name, element, x, y, z, insertion, alternative, occupancy, model = texts
        yield Atom(
            place=Place(file, k, f"atom {k}"),
            model=model,
            chain=chain,
            residue=residue + insertion,
            name=name,
            element=element.upper(),
            alternative=alternative,
            occupancy=UNCERTAIN.sub("", occupancy),
            position=(UNCERTAIN.sub("", x), UNCERTAIN.sub("", y), UNCERTAIN.sub("", z)),
        )
