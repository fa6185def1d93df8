"""Files that other programs wrote are read as they were meant, and refused where they are cut."""

from __future__ import annotations

import io
import struct
import sys
from pathlib import Path

import numpy as np
import pytest
from commands import certreg

from certreg.errors import CertregError, InvalidFileError, MissingToolError
from certreg.io import optional
from certreg.io.clouds import FORMATS, parse_cloud, read_cloud
from certreg.io.text import TEXT_FORMATS, read_points

DATA = Path(__file__).parent / "data"
POINTS = np.array(
    [
        [-15.394, -4.793, -3.408],
        [-12.083, -6.024, -2.05],
        [-8.755, -4.221, -2.089],
        [-5.521, -6.154, -2.454],
        [-2.839, -3.498, -2.175],
    ]
)
FLOATS = {"open3d.pcd", "open3d.stl", "trimesh.stl", "pye57.e57"}  # which hold no doubles
FILES = sorted(file.name for file in DATA.iterdir() if file.suffix != ".md")
LABELS = tuple(f"A:{residue}:CA" for residue in ("17", "18", "19", "20A", "21"))


def expected(name: str):
    return POINTS.astype(np.float32).astype(float) if name in FLOATS else POINTS


def read_or_skip(name: str):
    if name == "pye57.e57":
        pytest.importorskip("pye57", reason="pye57 is large, and no part of the test environment")
    return read_cloud(DATA / name)


SLOW = {"laspy.laz": [pytest.mark.slow]}  # it takes a process


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", [pytest.param(n, marks=SLOW.get(n, [])) for n in FILES])
def test_a_file_of_another_program_holds_its_points(name: str):
    read = read_or_skip(name)

    if name.startswith("laspy"):  # steps of 0.001 from an offset, in doubles
        assert np.abs(read.points - POINTS).max() <= 4e-15
    else:
        assert read.points.tolist() == expected(name).tolist()


def test_every_format_has_a_file_of_another_program_or_is_our_own():
    own = {".csv", ".txt", ".asc", ".npy", ".npz"}  # .npy: NumPy's, in every test

    assert {Path(name).suffix for name in FILES} | own == set(FORMATS)


@pytest.mark.parametrize("name", ["gemmi.pdb", "gemmi.cif"])
def test_carbon_alphas_are_named_and_what_was_chosen_is_told(name: str):
    """Calcium is none; of two places the more occupied; of two models the first."""
    read = read_cloud(DATA / name)

    assert read.labels == read.identifiers == LABELS
    assert read.notes == (
        "5 Cα atoms, 11 other atoms not used",
        "the first of 2 models (save another one alone to read it)",
        "of 1 with alternative places, the most occupied one",
    )


def test_both_formats_of_a_molecule_pair_by_their_atoms(tmp_path: Path):
    shuffled = tmp_path / "shuffled.csv"
    rows = [
        f"{label},{x},{y},{z}" for label, (x, y, z) in zip(LABELS, POINTS.tolist(), strict=True)
    ]
    shuffled.write_text("\n".join(["label,x,y,z", *rows[::-1]]) + "\n", encoding="utf-8")
    runs = [
        certreg("equilibria", DATA / name, shuffled, "--json")
        for name in ("gemmi.pdb", "gemmi.cif")
    ]

    assert [run.code for run in runs] == [0, 0]
    best = [run.document["equilibria"]["components"][0] for run in runs]
    assert best[0]["rmse"] < 1e-6
    assert best[0] == best[1]


def test_a_spreadsheet_of_a_surveyor_is_read_with_its_noise():
    read = read_cloud(DATA / "pandas.csv")

    assert read.sigma is not None
    assert read.sigma.tolist() == [0.5, 0.25, 1.0, 2.0, 0.5]
    assert read.notes == ("x=E, y=N, z=H", "decimal commas")
    assert read.identifiers == ("A17", "A18", "A19", "A20", "A21")


@pytest.mark.parametrize("name", [name for name in FILES if Path(name).suffix in TEXT_FORMATS])
def test_the_checker_reads_the_same_without_numpy(name: str):
    read, other = read_points(DATA / name), read_cloud(DATA / name)

    assert read.coordinates.tolist() == other.points.ravel().tolist()
    assert (read.labels, read.notes) == (other.labels, other.notes)


def shortest(name: str) -> int:
    """Below how many bytes a file is surely cut: text may lose its last digits and stay text."""
    content = (DATA / name).read_bytes()
    cut_shows = {".pdb", ".stl", ".las", ".ply", ".pcd", ".pts"}
    if Path(name).suffix in cut_shows:
        return len(content.rstrip()) - 6
    return 0


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", [n for n in FILES if n != "pye57.e57" and shortest(n)])
def test_a_file_that_was_cut_is_refused(name: str):
    content = (DATA / name).read_bytes()
    for held in range(0, shortest(name), max(1, len(content) // 97)):
        try:
            read = parse_cloud(io.BytesIO(content[:held]), Path(name))
        except InvalidFileError as error:
            refusal = str(error)
        else:  # the first model is whole
            assert b"ENDMDL" in content[:held]
            assert read.points.tolist() == POINTS.tolist()
            continue
        assert refusal.startswith(name)
        assert refusal.isprintable()


@pytest.mark.slow  # each takes a process
@pytest.mark.parametrize(
    "way", ["chunks", *(pytest.param(way, marks=pytest.mark.long) for way in ("cut", "points"))]
)
def test_packed_points_that_were_cut_or_lie_are_refused_without_their_memory(way):
    """For so many chunks lazrs reserves 27 GB, and ends the process in which it unpacks."""
    content = (DATA / "laspy.laz").read_bytes()
    (table,) = struct.unpack_from("<q", content, 469)
    broken = {
        "cut": content[:-9],
        "chunks": content[: table + 4] + b"\xff\xff\xff\x6f" + content[table + 8 :],
        "points": content[:480] + b"\xff" * 40 + content[520:],
    }
    with pytest.raises(InvalidFileError, match=r"^a\.laz: cannot be read"):
        parse_cloud(io.BytesIO(broken[way]), Path("a.laz"))


BROKEN: dict[str, tuple[str, bytes, bytes, str]] = {
    "a shifted row": ("gemmi.pdb", b"-15.394", b" -15.394", "line 6: .* columns 31 to 54"),
    "no number": ("gemmi.pdb", b"-15.394", b"-15.abc", "is not a coordinate"),
    "NaN": ("gemmi.pdb", b"-15.394", b"    nan", "is not a coordinate"),
    "an open model": ("gemmi.pdb", b"ENDMDL", b"REMARK", "not closed"),
    "a residue": ("gemmi.pdb", b"LEU A  19 ", b"LEU A  xx ", "is not a residue number"),
    "one atom again": ("gemmi.pdb", b"LEU A  19 ", b"LEU A  17 ", "A:17:CA comes again"),
    "no protein": ("gemmi.pdb", b" CA ", b" CB ", "no Cα atoms: give a protein"),
    "NaN in cif": ("gemmi.cif", b"-15.394", b"nan", "atom 2: 'nan' is not a number"),
    "a word in cif": ("gemmi.cif", b"-15.394", b"x", "atom 2: 'x' is not a number"),
    "an open loop": ("gemmi.cif", b" -15.394", b"", "is not a .cif file"),
    "a count too large": ("open3d.pts", b"5\r\n", b"6\n", "line 1: declares 6 points"),
    "a huge count": ("open3d.pts", b"5\r\n", b"9" * 18 + b"\n", "declares 999999999999999999"),
    "a vertex of two": ("trimesh.obj", b"-15.39400000", b"", "line 2: 2 numbers"),
    "a word in obj": ("trimesh.obj", b"-15.39400000", b"x", "line 2: 'x' is not a number"),
    "a weight": ("trimesh.obj", b"-3.40800000", b"-3.4 2", "a vertex of weight 2"),
    "a missing vertex": ("trimesh.obj", b"f 3 4 5", b"f 3 4 6", "names vertex 6, the file holds 5"),
    "no corner": ("trimesh.obj", b"f 3 4 5", b"f 3 4 0", "'0' names no vertex"),
    "a curve": ("trimesh.obj", b"f 3 4 5", b"curv 0 1 2", "'curv' is not expected"),
    "a facet too few": ("trimesh.stl", b"\x03\0\0\0", b"\x04\0\0\0", "declares 4 triangles"),
    "huge facets": ("trimesh.stl", b"\x03\0\0\0", b"\xff\xff\xff\xff", "4294967295 triangles"),
    "a word in stl": ("trimesh-ascii.stl", b"-15.394", b"x", "'x' is not a number"),
    "a loop of two": ("trimesh-ascii.stl", b"vertex -12.083 -6.024 -2.05\n", b"", "'vertex' comes"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_of_another_program_is_refused_with_the_place(name: str):
    file, part, other, words = BROKEN[name]
    content = (DATA / file).read_bytes()
    assert part in content
    with pytest.raises(InvalidFileError, match=words) as caught:
        parse_cloud(io.BytesIO(content.replace(part, other)), Path(file))

    assert str(caught.value).startswith(file)
    assert str(caught.value).isprintable()


def test_vertices_of_triangles_come_in_the_order_of_the_file():
    corners = ["9 0 0", "1 2 3", "5 5 5", "9 0 0", "5 5 5", "0 0 1"]
    facets = [
        "facet normal 0 0 1\nouter loop\n"
        + "".join(f"vertex {corner}\n" for corner in corners[k : k + 3])
        + "endloop\nendfacet\n"
        for k in (0, 3)
    ]
    text = "solid a\n" + "".join(facets) + "endsolid a\n"
    read = parse_cloud(io.BytesIO(text.encode()), Path("a.stl"))
    upper = parse_cloud(io.BytesIO(text.upper().encode()), Path("a.STL"))

    assert read.points.tolist() == [[9, 0, 0], [1, 2, 3], [5, 5, 5], [0, 0, 1]]
    assert upper.points.tolist() == read.points.tolist()
    assert read.notes == ("4 vertices of 2 triangles",)


def test_no_more_points_are_asked_for_than_a_file_of_las_can_hold():
    content = bytearray((DATA / "laspy.las").read_bytes())
    content[107:111] = b"\xff\xff\xff\xff"
    with pytest.raises(InvalidFileError, match=r"declares 4294967295 points, \d+ bytes of at most"):
        parse_cloud(io.BytesIO(content), Path("a.las"))


LAS_FIELDS = {  # offset and bytes in the header: what is there may not be more than the file holds
    "records": (100, b"\xff\xff\xff\xff"),
    "begin of the points": (96, b"\xff\xff\xff\x7f"),
    "header size": (94, b"\xff\xff"),
    "points": (107, b"\xff\xff\xff\xff"),
    "length of a point": (105, b"\xff\xff"),
    "format of points": (104, b"\x7f"),
    "version": (24, b"\x09\x09"),
    "a scale of NaN": (131, b"\0\0\0\0\0\0\xf8\x7f"),
}


@pytest.mark.parametrize("name", LAS_FIELDS)
def test_a_header_of_las_that_lies_is_refused(name: str):
    content = bytearray((DATA / "laspy.las").read_bytes())
    at, value = LAS_FIELDS[name]
    content[at : at + len(value)] = value
    with pytest.raises(InvalidFileError, match=r"^a\.las"):
        parse_cloud(io.BytesIO(content), Path("a.las"))


@pytest.mark.parametrize(
    ("file", "library", "words"),
    [
        ("a.las", "laspy", r"pip install 'laspy\[lazrs\]' \(extra `files`\), .*: pdal translate"),
        ("a.laz", "laspy", r"pip install 'laspy\[lazrs\]' \(extra `files`\), .*: pdal translate"),
        ("a.e57", "pye57", r"pip install pye57 \(extra `files`\), or convert it: CloudCompare -S"),
        ("a.cif", "gemmi", r"pip install gemmi \(extra `files`\), .*: gemmi convert .*a\.pdb"),
    ],
)
def test_a_missing_library_is_one_line_that_names_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file: str, library: str, words: str
):
    monkeypatch.setitem(sys.modules, library, None)  # as if it were not installed
    (tmp_path / file).write_bytes(b"any")
    with pytest.raises(MissingToolError, match=words) as caught:
        read_cloud(tmp_path / file)
    run = certreg("equilibria", tmp_path / file, tmp_path / file)

    assert caught.value.tool == library
    assert (run.code, run.out, run.err.count("\n")) == (2, "", 1)


@pytest.mark.parametrize("suffix", optional.WORDS)
def test_a_format_that_is_not_read_names_a_converter(suffix: str):
    file = Path(f"a cloud{suffix}")
    with pytest.raises(CertregError, match="is not known: convert it: ") as caught:
        read_cloud(file)

    assert "a cloud" in str(caught.value).partition("convert it")[2]
