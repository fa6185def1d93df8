"""What readers say in rare cases is said of the right file, row, column and number."""

from __future__ import annotations

import io
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from certreg.errors import InvalidFileError
from certreg.io import scans
from certreg.io.cloud import Cloud, RowNumbers
from certreg.io.clouds import parse_cloud
from certreg.io.columns import (
    DecimalCommas,
    named_columns,
    noise_of_columns,
    separated_by_semicolons,
)
from certreg.io.labels import (
    LABEL_CHARACTERS,
    LABEL_NODES,
    Match,
    are_short,
    require_same_order,
    rows_by_label,
    unused_labels_note,
)
from certreg.io.objects import pair
from certreg.io.pairing import require_same_rows
from certreg.io.pairs import parse_pairs, repeated_rows_note
from certreg.io.poses import of_array, parse_line
from certreg.io.problems import read_problem
from certreg.io.streams import MAX_LINE_BYTES, Place, lines, typed_number
from certreg.problem import arrays

if TYPE_CHECKING:
    from collections.abc import Callable

A, B = Path("a.csv"), Path("b.csv")


def cloud(content: str | bytes, name: str) -> Cloud:
    data = content.encode() if isinstance(content, str) else content
    return parse_cloud(io.BytesIO(data), Path(name))


def refused(call: Callable[[], object]) -> InvalidFileError:
    with pytest.raises(InvalidFileError) as caught:
        call()
    return caught.value


def test_the_row_beyond_a_cloud_is_told_with_the_last_one_that_it_has():
    error = refused(lambda: parse_pairs(io.BytesIO(b"0,0\n1,3\n"), Path("p.csv"), (9, 3)))

    assert str(error).endswith(
        "pair 1 (counting from 0) names row 3 of the target: its rows are 0 to 2"
    )
    assert (error.row, error.column, error.value, error.limit) == (1, "target", 3, 2)


def test_rows_of_either_side_that_come_again_are_counted_once_each():
    pairs = np.array([[0, 5], [0, 6], [0, 7], [1, 7], [2, 8], [3, 8]])
    (note,) = repeated_rows_note(Path("p.csv"), pairs)

    assert "1 row of the source and 2 of the target are in several pairs" in note


def test_the_first_pair_that_names_a_row_again_is_told():
    content = io.BytesIO(b"SOURCE,Target\n4,1\n2,3\n3,0\n2,2\n4,4\n")
    error = refused(lambda: parse_pairs(content, Path("p.csv"), (5, 5), one_to_one=True))

    assert (error.row, error.column, error.value) == (3, "source", 2)


FACES = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def test_faces_of_an_obj_file_may_count_back_to_its_first_vertex_and_no_further():
    assert len(cloud(f"{FACES}f -3 -2 -1\n", "a.obj").points) == 3
    assert "'-4' names no vertex" in str(refused(lambda: cloud(f"{FACES}f -4 -2 -1\n", "a.obj")))


def test_the_largest_vertex_that_any_face_names_must_be_there():
    error = refused(lambda: cloud(f"{FACES}f 1 2 5\nf 1 2 4\nf 1 2 3\n", "a.obj"))

    assert (error.line, error.value, error.limit) == (4, 5, 3)


@pytest.mark.parametrize("more", ["", " 0.1 0.2 0.3"])
def test_the_weight_of_a_vertex_must_be_one_also_before_colours(more: str):
    assert len(cloud(f"v 1 2 3 1{more}\n", "a.obj").points) == 1
    error = refused(lambda: cloud(f"v 1 2 3 2{more}\n", "a.obj"))
    assert (error.value, error.limit) == (2.0, 1)


def test_solid_within_a_triangle_is_no_beginning_of_another_solid():
    corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    facet = f"facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n"
    whole = f"solid a\n{facet}endsolid a\nsolid b\n{facet}endsolid b\n"
    assert cloud(whole, "a.stl").notes == ("3 vertices of 2 triangles",)
    for place in ("outer loop\n", "endfacet\n"):
        bent = whole.replace(place, f"{place}solid c\n", 1)
        assert "'solid c' where" in str(refused(lambda text=bent: cloud(text, "a.stl")))


CIF = """data_a
loop_
{}
ATOM CA c . A 1 . {} 2.0 3.0 {}
ATOM CA C . A 1 B 4.0 5.0 6.0 1.00
"""
CIF_TAGS = (
    "group_PDB label_atom_id type_symbol label_alt_id auth_asym_id auth_seq_id "
    "pdbx_PDB_ins_code Cartn_x Cartn_y Cartn_z occupancy"
)


def test_uncertain_digits_insertion_codes_and_small_letters_of_a_cif_file_are_read():
    pytest.importorskip("gemmi")
    tags = "\n".join(f"_atom_site.{tag}" for tag in CIF_TAGS.split())
    read = cloud(CIF.format(tags, "1.25(3)", "0.75(10)"), "a.cif")

    assert read.labels == ("A:1:CA", "A:1B:CA")
    assert read.points.tolist() == [[1.25, 2.0, 3.0], [4.0, 5.0, 6.0]]
    error = refused(lambda: cloud(CIF.format(tags, "far", "1.00"), "a.cif"))
    assert "a.cif, line 1, atom 1: " in str(error)


PDB = "ATOM      1  CA  ALA A{:>4}{}   {:8.3f}{:8.3f}{:8.3f}  1.00  0.00          {}"


def test_an_atom_behind_the_end_needs_an_end_of_its_own():
    first, second = (PDB.format(k, " ", 1.0, 2.0, 3.0, " C") for k in (1, 2))
    for content in (f"{first}\n{second}\nEND\n", f"{first}\nEND\nMASTER\n"):
        assert len(cloud(content, "a.pdb").points) in {1, 2}
    assert "no END behind the atoms" in str(
        refused(lambda: cloud(f"{first}\nEND\n{second}\n", "a.pdb"))
    )


def test_the_insertion_code_of_a_residue_is_part_of_its_label():
    rows = [PDB.format(52, code, 1.0, 2.0, 3.0, " C") for code in " A"]
    assert cloud("\n".join([*rows, "END", ""]), "a.pdb").labels == ("A:52:CA", "A:52A:CA")


def test_calcium_without_an_element_is_told_by_its_column():
    row = PDB.format(1, " ", 1.0, 2.0, 3.0, "")
    calcium = row.replace(" CA  ALA", "CA    CA")
    assert len(row) == len(calcium)
    content = "\n".join([row, calcium.replace("A   1", "A   2"), "END", ""])
    assert cloud(content, "a.pdb").labels == ("A:1:CA",)


def test_names_of_a_ply_file_are_whole_numbers_where_they_are_whole():
    header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float id\n"
    header += "".join(f"property double {axis}\n" for axis in "xyz")
    faces = (
        "element face 1\nproperty list uchar int vertex_indices\nelement edge 0\nproperty int v\n"
    )
    read = cloud(f"{header}{faces}end_header\n7 1 2 3\n7.5 4 5 6\n3 0 1 1\n", "a.ply")

    assert (read.identifiers, read.labels) == (("7", "7.5"), None)
    assert read.ignored == ("id", "face", "edge")


def test_a_label_names_points_before_any_other_name():
    """In .ply files as in tables; what the others hold is not used."""
    header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty int id\nproperty int label\n"
    header += "".join(f"property double {axis}\n" for axis in "xyz")
    read = cloud(f"{header}end_header\n7 8 1 2 3\n", "a.ply")
    assert (read.identifiers, read.labels, read.ignored) == (("8",), ("8",), ("id",))


def test_points_that_are_named_in_another_order_are_told_of_the_target():
    names = (("1", "2", "3"), ("1", "3", "2"))
    error = refused(lambda: require_same_order(*names, (A, B)))
    assert "a.csv and b.csv name the same points in another order: point 1" in str(error)
    assert "is '2' and '3': rename" in str(error)
    assert (error.path, error.row, error.value, error.limit) == (B, 1, "3", "2")


def test_commas_are_told_with_the_first_of_each_kind():
    def commas(*texts: str) -> str:
        numbers = DecimalCommas()
        for k, text in enumerate(texts, 1):
            numbers.number(Place(A, k), text)
        return str(refused(numbers.require_decimal))

    assert "line 1: '1,5' here and '2.5' in line 2" in commas("1,5", "2.5", "3,5", "4.5")
    assert "line 2: '1,250': is it 1.250 or 1250?" in commas("7", "1,250", "2,345")


@pytest.mark.parametrize(
    ("row", "semicolons"),
    [
        ("1,5;2,5;3,5", True),
        ("1;2;3", True),
        ("a;x;y;z", True),
        ("1,2,3;4", False),
        ("x,y,z,a;b;c", False),
        ("1,2,3,4;5;6", False),
        ("1,2;3,4;5,6", True),
        ("1,2,3;a;b", True),
    ],
)
def test_a_row_of_semicolons_has_fewer_than_three_numbers_between_commas(
    row: str,
    semicolons: bool,  # noqa: FBT001 - a parameter
):
    assert separated_by_semicolons(row) == semicolons


def noisy(**columns: float) -> Any:
    return SimpleNamespace(**{"sigma": None, "weights": None, **columns})


def test_two_columns_of_noise_are_told_each_with_its_file():
    error = refused(lambda: noise_of_columns(noisy(sigma=1.0), noisy(weights=2.0), (A, B)))
    assert str(error).startswith("b.csv: columns sigma of a.csv and weight of b.csv: which one")
    assert (error.path, error.column) == (B, "weight")

    error = refused(lambda: noise_of_columns(noisy(sigma=1.0, weights=2.0), noisy(), (A, B)))
    assert str(error).startswith("a.csv: columns sigma of a.csv and weight of a.csv: which one")


def test_rows_of_large_files_that_are_in_another_order_are_told_with_their_numbers(
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.setattr(arrays, "BLOCK_POINTS", 2)
    numbers = np.array([1234567.0, 2.0, 3.0, 40000001.0, 5.0])
    here = Cloud(
        path=A,
        points=np.zeros((5, 3)),
        labels=None,
        ignored=(),
        numbers=RowNumbers(column=numbers),
    )
    order = [0, 1, 2, 4, 3]
    there = Cloud(
        path=B,
        points=np.zeros((5, 3)),
        labels=None,
        ignored=(),
        numbers=RowNumbers(column=numbers[order]),
    )
    error = refused(lambda: require_same_rows(here, there))

    assert "a.csv and b.csv number the same points in another order: point 3" in str(error)
    assert "is 40000001 and 5, and files" in str(error)
    assert (error.row, error.value, error.limit) == (3, 5.0, 40000001.0)


def test_labels_in_the_way_are_told_of_the_cloud_that_is_in_the_way():
    for source, target, told in (
        (
            "ab",
            "aba",
            "label 'a' occurs 2 times in the target b.csv: each must occur once in both; drop",
        ),
        ("aba", "ab", "label 'a' occurs 2 times in the source a.csv: "),
        ("aab", "b", "label 'a' occurs 2 times in the source a.csv: "),
        (
            "abc",
            "a",
            "label 'b' occurs 0 times in the target b.csv, which lacks 2 of the 3 labels of a",
        ),
        (
            "a",
            "abc",
            "label 'b' occurs 0 times in the source a.csv, which lacks 2 of the 3 labels of b",
        ),
    ):
        error = refused(lambda s=source, t=target: rows_by_label(tuple(s), tuple(t), files=(A, B)))
        assert told in str(error)
    assert rows_by_label(tuple("abbc"), tuple("cdda"), Match.COMMON, files=(A, B)) == (
        [0, 3],
        [3, 0],
    )


def test_the_cloud_without_labels_is_named_as_such():
    (note,) = unused_labels_note((True, False), (A, B))
    assert note.startswith("a.csv: labels not used, as b.csv has none")
    (note,) = unused_labels_note((False, True), (A, B))
    assert note.startswith("b.csv: labels not used, as a.csv has none")


@pytest.mark.parametrize("shape", [(2, 4, 4), (5, 3, 4)])
def test_a_stack_of_poses_of_either_form_is_told_as_one(shape: tuple[int, ...]):
    error = refused(lambda: of_array(Place(A), np.zeros(shape)))
    assert f"a stack of {shape[0]}: save one of them" in str(error)


def test_of_a_line_that_is_not_there_the_number_of_lines_is_told():
    text = b"# poses\n1 0 0 0 1 2 3\n1 0 0 0 4 5 6\n"
    assert parse_line(io.BytesIO(text), A, 2).translation is not None
    assert "a.csv has 3 lines: --line 4 is none" in str(
        refused(lambda: parse_line(io.BytesIO(text), A, 4))
    )
    assert "line 1" in str(refused(lambda: parse_line(io.BytesIO(text), A, 1)))


def test_a_line_that_is_too_long_is_told_with_the_limit_of_lines():
    error = refused(lambda: list(lines(io.BytesIO(b"1\n" + b"1" * MAX_LINE_BYTES), A)))
    assert (error.line, error.limit) == (2, MAX_LINE_BYTES)


def test_a_mark_of_order_is_one_at_the_beginning_alone():
    text = "\ufeff1\n\ufeff2\n".encode()
    assert list(lines(io.BytesIO(text), A)) == ["1\n", "\ufeff2\n"]


def test_the_largest_of_an_integer_type_is_taken_and_no_larger_one():
    for kind, least, most in (("i1", -128, 127), ("u1", 0, 255), ("i2", -32768, 32767)):
        for value in (least, most):
            assert typed_number(Place(A, 1), str(value), kind) == value
        for value in (least - 1, most + 1):
            refused(lambda text=str(value), k=kind: typed_number(Place(A, 1), text, k))


def test_a_name_of_points_that_pairs_nothing_is_told_as_not_used():
    columns = named_columns(Place(A, 1), ["ID", "x", "y", "z"], noise=True)
    assert (columns.called, columns.label, columns.ignored) == (0, None, ("id",))
    columns = named_columns(Place(A, 1), ["id", "Label", "x", "y", "z"], noise=True)
    assert (columns.called, columns.label, columns.ignored) == (1, 1, ("id",))


@pytest.mark.parametrize("width", [4, 5])
def test_a_first_column_that_counts_is_no_x_whatever_stands_behind_z(width: int):
    rows = [[k, 5 * k % 3, k * k, 1, 2][:width] for k in range(3)]
    text = "\n".join(" ".join(map(str, row)) for row in rows)
    error = refused(lambda: cloud(text, "a.txt"))
    assert "column 1 counts the rows (0, 1, ...)" in str(error)
    assert len(cloud(text.replace("\n1 ", "\n1.5 "), "a.txt").points) == 3
    swapped = "\n".join(" ".join(map(str, [*row[1:2], *row[:1], *row[2:]])) for row in rows)
    assert len(cloud(swapped, "a.txt").points) == 3


@pytest.mark.parametrize(
    ("name", "top"),
    [("a.csv", "\n \nx,y,z\n"), ("a.txt", "\n# x y z\n\n"), ("a.asc", "// made today\n\n")],
)
def test_lines_are_counted_from_the_first_of_the_file(name: str, top: str):
    separator = "," if name == "a.csv" else " "
    rows = [separator.join(row) for row in ("123", "45", "678")]
    error = refused(lambda: cloud(top + "\n".join(rows) + "\n", name))
    assert error.line == top.count("\n") + 2


class Scans:
    """As pye57 has a file of one scan."""

    scan_count = 1

    def __init__(self, declared: int, valid: int) -> None:
        self.declared, self.valid = declared, valid

    def get_header(self, _number: int) -> Any:
        return SimpleNamespace(point_count=self.declared)

    def read_scan(self, _number: int, **_options: bool) -> dict[str, Any]:
        return {f"cartesian{axis}": np.arange(float(self.valid)) for axis in "XYZ"}

    def close(self) -> None:
        """As a file is closed."""


@pytest.mark.parametrize("valid", [3, 5])
def test_points_of_a_scan_that_are_not_valid_are_counted(
    monkeypatch: pytest.MonkeyPatch, valid: int
):
    library = SimpleNamespace(E57=lambda _file: Scans(5, valid))
    monkeypatch.setattr(scans, "optional_library", lambda *_: library)
    found = scans.parse_e57(io.BytesIO(b"x"), Path("a.e57"))

    assert len(found.points) == valid
    assert found.notes == (() if valid == 5 else ("2 of 5 points are not valid, and left out",))


def test_models_without_a_number_are_told_apart_by_their_lines():
    row = PDB.format(1, " ", 1.0, 2.0, 3.0, " C")
    model = f"MODEL\n{row}\nENDMDL\n"
    read = cloud(f"{model}{model}END\n", "a.pdb")

    assert len(read.points) == 1
    assert "the first of 2 models" in " ".join(read.notes)


def test_labels_are_kept_in_a_certificate_up_to_what_its_checker_reads():
    for nodes, kept in ((LABEL_NODES, True), (LABEL_NODES + 2, False)):
        assert are_short(("a,",) * (nodes // 2)) == kept
    for characters, kept in ((LABEL_CHARACTERS, True), (LABEL_CHARACTERS + 1, False)):
        assert are_short(("a" * characters,)) == kept


def test_columns_of_noise_are_left_where_sigma_is_given(tmp_path: Path):
    """They are not used, and told so; also where they could not be."""
    (tmp_path / "a.csv").write_text(
        "x,y,z,sigma,weight\n1,2,3,-1,2\n4,5,6,0,2\n7,8,1,1,2\n", "utf-8"
    )
    (tmp_path / "b.csv").write_text("1,2,3\n4,5,6\n7,8,1\n", "utf-8")
    problem, read = read_problem(tmp_path / "a.csv", tmp_path / "b.csv", sigma=0.5)

    assert problem.weights.tolist() == [4.0] * 3
    assert not read.weighed
    (note,) = read.notes
    assert note.startswith(f"{tmp_path / 'a.csv'}: not used: sigma, weight")


def test_two_columns_of_noise_of_one_name_hurt_nobody_who_leaves_them():
    names = ["x", "y", "z", "sigma", "Sigma"]
    assert named_columns(Place(A, 1), names, noise=False).ignored == ("sigma", "sigma")
    assert "two columns are named sigma" in str(
        refused(lambda: named_columns(Place(A, 1), names, noise=True))
    )


class Indexed:
    """As a data frame with columns x, y, z and an index."""

    columns = ("x", "y", "z")

    def __init__(self, index: list[int]) -> None:
        self.index = np.array(index)

    def __getitem__(self, _name: str) -> Any:
        return self.index.astype(float)

    def to_numpy(self) -> Any:
        return np.column_stack([self.index] * 3).astype(float)


def test_an_index_that_nobody_chose_names_rows_beside_one_in_another_order():
    """Either way round: what is meant is the order of the numbers."""
    plain, turned = [0, 1, 2], [2, 0, 1]
    for here, there in ((plain, turned), (turned, plain)):
        first, second = pair(Indexed(here), Indexed(there))
        assert first.points.tolist() == second.points.tolist()
    first, second = pair(Indexed(plain), Indexed([5, 6, 7]))
    assert (first.labels, first.points[0].tolist(), second.points[0].tolist()) == (
        None,
        [0.0] * 3,
        [5.0] * 3,
    )


@pytest.mark.parametrize("name", ["a.csv", "A.CSV"])
def test_a_table_is_one_in_capitals_too(name: str):
    """Only there quotes hold commas, and # begins no comment."""
    read = cloud('label,x,y,z\n"P#1, left",1,2,3\n#2,4,5,6\n', name)
    assert read.labels == ("P#1, left", "#2")
