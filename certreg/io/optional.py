"""Libraries of the extra `files`, which read what certreg itself does not; converters for the rest.

What is missing is one line: the library, how to install it, and a command that does without.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from certreg._loading import library
from certreg.io.streams import refused
from certreg.verify import PIPES, shown

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.errors import InvalidFileError

CLOUDCOMPARE = "CloudCompare -SILENT -O {file} -C_EXPORT_FMT PLY -SAVE_CLOUDS"
MESH = """python -c 'import trimesh; trimesh.load("{file}", force="mesh").export("{stem}.ply")'"""
PDAL = "pdal translate {file} {stem}.ply"
WORDS = {  # of formats that are not read: what makes one of them that is
    **dict.fromkeys((".off", ".gltf", ".glb", ".dae", ".3mf"), MESH),
    **dict.fromkeys((".ptx", ".bin", ".fls", ".pcv", ".sbf", ".fbx", ".dxf", ".dp"), CLOUDCOMPARE),
    ".shp": CLOUDCOMPARE,
    ".bpf": PDAL,
    ".gpkg": PDAL,
    ".copc": PDAL,
    ".xlsx": "libreoffice --headless --convert-to csv {file}",
    ".xls": "libreoffice --headless --convert-to csv {file}",
    ".ods": "libreoffice --headless --convert-to csv {file}",
    ".ent": "cp {file} {stem}.pdb",
    ".mmcif": "cp {file} {stem}.cif",
    ".gz": "gunzip {file}",
    ".zip": "unzip {file}",
}


def converter(file: Path, line: str) -> str:
    """The command line that converts a file."""
    return line.format(file=shown(file), stem=shown(file.with_suffix("")))


def unknown_format(file: Path, formats: tuple[str, ...]) -> InvalidFileError:
    """The refusal of a format that is not read."""
    suffix = file.suffix.lower()
    what = f"the format {shown(file.suffix) or '(none)'} is not known"
    remedy = f"use one of {' '.join(formats)}"
    if str(file).startswith(PIPES):
        remedy = "pipe the cloud into the command and give - in its place"
    if suffix in WORDS:
        remedy = f"convert it: {converter(file, WORDS[suffix])}"
    return refused(file, f"{what}: {remedy}", value=file.suffix, limit=formats)


def optional_library(name: str, file: Path, line: str) -> Any:
    """A library of the extra `files`, loaded now. Raises MissingToolError.

    line: of a converter.
    """
    return library(name, f"{shown(file)}:", f", or convert it: {converter(file, line)}")
