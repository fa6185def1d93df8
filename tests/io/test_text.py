"""The text reader takes what a person means by three columns of numbers, and nothing else."""

from __future__ import annotations

from array import array
from fractions import Fraction
from pathlib import Path

import certificates as oracle
import numpy as np
import pytest
from commands import certreg
from hypothesis import given, settings
from hypothesis import strategies as st

from certreg.errors import InvalidFileError
from certreg.io.columns import Points
from certreg.io.streams import MAX_LINE_BYTES
from certreg.io.text import pair_by_label, read_numbers, read_points

FILES = (Path("a.csv"), Path("b.csv"))

GENERIC = oracle.random_problem(seed=3)


@pytest.fixture(scope="module")
def generic():
    return oracle.produce(*GENERIC)


def without_data(certificate):
    problem = {**certificate["problem"], "data": None}
    return {**certificate, "problem": problem}


def write_csv(path, cloud, labels=None, order=None):
    rows = [
        ",".join([*map(repr, map(float, row)), *([] if labels is None else [labels[k]])])
        for k, row in enumerate(cloud)
    ]
    rows = rows if order is None else [rows[k] for k in order]
    head = "x,y,z\n" if labels is None else "x,y,z,label\n"
    path.write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
    return str(path)


def verify(*arguments):
    """Exit code and last line of `certreg verify`."""
    done = certreg("verify", *arguments)
    return done.code, done.out.splitlines()[-1]


def read(tmp_path, text, suffix="csv"):
    path = tmp_path / f"cloud.{suffix}"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    points = read_points(str(path))
    return points.coordinates.tolist(), points.labels, points.ignored


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1,2,3\n4,5,6\n", ([1, 2, 3, 4, 5, 6], None, ())),
        ("1,2,3\r\n4,5,6", ([1, 2, 3, 4, 5, 6], None, ())),
        ("\n1,2,3\n\n4,5,6\n\n", ([1, 2, 3, 4, 5, 6], None, ())),
        ("x,y,z,r,\n1,2,3,9,8\n4,5,6,x,\n", ([1, 2, 3, 4, 5, 6], None, ("r", ""))),
        ("x,y,z\n1,2,3\n", ([1, 2, 3], None, ())),
        ("Z, X ,y\n1,2,3\n", ([2, 3, 1], None, ())),
        ("label,x,y,z\nb,1,2,3\na,4,5,6\n", ([1, 2, 3, 4, 5, 6], ("b", "a"), ())),
        ("Label,X,Y,Z,r\nb,1,2,3,0\n", ([1, 2, 3], ("b",), ("r",))),
        ('label,x,y,z\n"a, b",1,2,3\n', ([1, 2, 3], ("a, b",), ())),
        (b"\xef\xbb\xbfx,y,z\n1,2,3\n", ([1, 2, 3], None, ())),
        ("label,x,y,z\n\u00e9,1,2,3\n", ([1, 2, 3], ("\u00e9",), ())),
        (" +1 ,-.5,1.e-3\n", ([1, -0.5, 0.001], None, ())),
        ("0.1,1e-400,-0\n", ([0.1, 0, 0], None, ())),
    ],
)
def test_a_csv_file_is_read_as_it_says(tmp_path, text, expected):
    assert read(tmp_path, text) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 2 3\n4\t5   6\n", [1, 2, 3, 4, 5, 6]),
        ('# a comment, "with quotes\n\n 1,2 , 3\n  # another\n4 5 6 \r\n', [1, 2, 3, 4, 5, 6]),
    ],
)
def test_a_txt_file_has_blanks_or_commas_and_comments(tmp_path, text, expected):
    assert read(tmp_path, text, "txt") == (expected, None, ())


@pytest.mark.parametrize("suffix", ["txt", "xyz"])
@pytest.mark.parametrize("first", ["0 1 2", "1 2 3", "101 102 103", "0e0 1.0 2.00"])
def test_a_first_column_that_counts_the_rows_is_not_taken_for_x(tmp_path, suffix, first):
    numbers = first.split()
    text = "".join(f"{number} {k * k} 5 {7 - k}\n" for k, number in enumerate(numbers))
    with pytest.raises(InvalidFileError, match=r"column 1 counts the rows .*label,x,y,z"):
        read(tmp_path, text, suffix)
    bare = "".join(line.rpartition(" ")[0] + "\n" for line in text.splitlines())
    assert read(tmp_path, bare, suffix)[0][::3] == list(map(float, numbers))


@pytest.mark.parametrize("suffix", ["txt", "xyz"])
@pytest.mark.parametrize("first", ["0 2 3", "0.5 1.5 2.5", "3 2 1", "0 0 0", "1"])
def test_columns_behind_z_are_left_out_where_the_first_counts_nothing(tmp_path, suffix, first):
    numbers = first.split()
    text = "".join(f"{number} 4 5 255 0 7\n" for number in numbers)
    coordinates, labels, ignored = read(tmp_path, text, suffix)
    assert coordinates == [x for number in numbers for x in (float(number), 4, 5)]
    assert (labels, ignored) == (None, ("column 4", "column 5", "column 6"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "line 1: give three columns"),
        ("\n\n", "line 1: give three columns"),
        ("x,y,z\n", "line 1: no points"),
        ("1,2\n3,4\n", "line 1: give three columns"),
        ("x,y\n1,2\n", "line 1: give three columns"),
        ("a,b,c\n1,2,3\n", "line 1: the header (a, b, c) names no column x, y, z: rename"),
        ("0,1,2,3\n1,4,5,6\n", "line 1: 4 columns and no header: which are x, y, z? Add a header"),
        ("1.5,2,3,9,8\n4,5,6,9,8\n", "line 1: 5 columns and no header"),
        ("x,y,z,x\n1,2,3,4\n", "line 1: the header (x, y, z, x) does not say which"),
        ("x,y,z,label,label\n1,2,3,a,b\n", "line 1: two columns are named label"),
        ("1,2,3\n4,5\n", "line 2: 2 columns, not 3: mend the row"),
        ("1,2,3\n\n4,5,6,7\n", "line 3: 4 columns, not 3"),
        ("1,2,3\n4,abc,6\n", "line 2, y: 'abc' is not a number: write plain decimal numbers"),
        ("1,2,3\n4,,6\n", "line 2, y: '' is not a number"),
        ("1,2,3\n4,1_0,6\n", "line 2, y: '1_0' is not a number"),
        ("1,2,3\n4,nan,6\n", "line 2, y: 'nan' is not a number: remove the row, from both clouds"),
        ("nan,2,3\n4,5,6\n", "line 1, column 1: 'nan' is not a number: remove the row"),
        ("label,East,North,H\na,1,-NaN,3\n", "line 2, north: '-NaN' is not a number: remove"),
        ("1,2,3\n4,inf,6\n", "line 2, y: 'inf' is not a number: remove the row, from both clouds"),
        ("1,2,3\n4,0x10,6\n", "line 2, y: '0x10' is not a number"),
        ("1,2,3\n4,1d5,6\n", "line 2, y: '1d5' is not a number"),
        ("1,2,3\n4,\u0661,6\n", r"line 2, y: '\u0661' is not a number"),
        ("1,2,3\n4,\x1b[31m,6\n", r"line 2, y: '\x1b[31m' is not a number"),
        ("1,2,3\n4,1e400,6\n", "line 2, y: '1e400' is not a finite number"),
        ("1,2,3\n4,1 2,6\n", "line 2, y: '1 2' is not a number"),
        (b"1,2,3\n4,\xff,6\n", "line 2: 'utf-8' codec"),
        ('1,2,3\n4,"5,6\n', "line 2: "),
        ('1,2,3\n4,"5"5,6\n', "line 2: "),
        ("1,2,3\r4,5,6\r", "line 1: "),
        ("1,2,3\n4," + "1" * 200_000 + ",6\n", "line 2: "),
    ],
)
def test_a_csv_file_in_error_names_the_line_and_the_remedy(tmp_path, text, words):
    with pytest.raises(InvalidFileError) as caught:
        read(tmp_path, text)
    assert str(caught.value).startswith(f"{tmp_path}/cloud.csv, ")
    assert words in str(caught.value)
    assert str(caught.value).isascii()
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1 2\n", "line 1: give three columns"),
        ("1 2 3\n# none\n1,,3\n", "line 3, y: '' is not a number: remove the row"),
        ("1 2 3\n1 2\n", "line 2: 2 columns, not 3"),
        ('1 2 3\n"1" 2 3\n', "line 2, x: '\"1\"' is not a number"),
    ],
)
def test_a_txt_file_in_error_names_the_line_and_the_remedy(tmp_path, text, words):
    with pytest.raises(InvalidFileError, match=r"cloud\.txt, ") as caught:
        read(tmp_path, text, "txt")
    assert words in str(caught.value)


def test_unreadable_clouds_are_input_errors(tmp_path, monkeypatch):
    (tmp_path / "folder.csv").mkdir()
    for name, words in (
        ("cloud.ply", "give a .csv, .txt, .xyz, .asc, .pts, .obj or .pdb file"),
        ("missing.csv", "No such file"),
        ("folder.csv", "directory"),
        ("nul\0.csv", "zero byte"),
    ):
        with pytest.raises(InvalidFileError, match=words):
            read_points(tmp_path / name)
    with pytest.raises(InvalidFileError, match="line 1: the line or the file is too long"):
        read(tmp_path, "1" * (MAX_LINE_BYTES + 1))
    monkeypatch.setattr("certreg.io.streams.MAX_TEXT_BYTES", 4)
    with pytest.raises(InvalidFileError, match="line 1: the line or the file is too long"):
        read(tmp_path, "1,2,3\n")


def test_numbers_are_read_one_a_line(tmp_path):
    path = tmp_path / "weights.txt"
    path.write_text("1\n# none\n2.5\n", encoding="ascii")
    assert read_numbers(str(path)).tolist() == [1, 2.5]
    path.write_text("1\n2 3\n", encoding="ascii")
    with pytest.raises(InvalidFileError, match="line 2: '2,3' is not a number"):
        read_numbers(path)


def points(rows, labels=None):
    return Points(array("d", np.ravel(rows).astype(float)), labels, (), labels)


def test_labels_decide_the_order_where_both_clouds_have_them():
    a, b = [1, 2, 3], [4, 5, 6]
    paired = pair_by_label(points([b, a], ("b", "a")), points([a, b], ("a", "b")), FILES)

    assert paired == points([b, a], ("b", "a"))
    for source, target in (
        (points([a, b]), points([a, b], ("a", "b"))),
        (points([a, b], ("a", "b")), points([b, a])),
        (points([a, b]), points([b, a])),
    ):
        assert pair_by_label(source, target, FILES) is target


@pytest.mark.parametrize(
    ("source", "target", "words"),
    [
        (
            ("a", "b", "d", "d"),
            ("a", "c"),
            (
                "label 'b' occurs 0 times in the target b.csv, which lacks 2 of the 3 labels of "
                "a.csv: each must occur once in both; drop it, or take --match common"
            ),
        ),
        (
            ("a",),
            ("a", "c"),
            "label 'c' occurs 0 times in the source a.csv, which lacks 1 of the 2 labels",
        ),
        (("a", "b", "b"), ("b", "a", "c"), "label 'b' occurs 2 times in the source a.csv: each"),
        (("a", "b"), ("b", "a", "a"), "label 'a' occurs 2 times in the target"),
        (("a", "b", "\x07"), ("b", "a", "\x08"), r"label '\x07' occurs 0 times"),
        (None, ("b", "a", "a"), "2 source but 3 target points"),
        (("a", "b"), None, "2 source but 3 target points"),
    ],
)
def test_clouds_that_do_not_pair_are_input_errors(source, target, words):
    first = points(np.zeros((len(source or "ab"), 3)), source)
    second = points(np.zeros((len(target or "abc"), 3)), target)
    with pytest.raises(InvalidFileError) as caught:
        pair_by_label(first, second, FILES)
    assert words in str(caught.value)


@pytest.mark.slow
@given(st.lists(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 3), min_size=1))
@settings(max_examples=50, deadline=None, derandomize=True)
def test_every_double_survives_the_text(tmp_path_factory, rows):
    path = tmp_path_factory.mktemp("cloud") / "cloud.csv"
    path.write_text("\n".join(",".join(map(repr, row)) for row in rows), encoding="ascii")

    assert read_points(path).coordinates.tolist() == [x for row in rows for x in row]


def test_labels_pair_the_clouds_given_beside_the_certificate(generic, tmp_path):
    source, target, weights = GENERIC
    path = tmp_path / "certificate.json"
    path.write_bytes(oracle.dump(without_data(generic)))
    labels = [f"point {k}" for k in range(20)]
    shuffled = np.random.default_rng(2).permutation(20)
    first = write_csv(tmp_path / "source.csv", source, labels)
    second = write_csv(tmp_path / "target.csv", target, labels, shuffled)
    plain = write_csv(tmp_path / "plain.csv", target, None, shuffled)
    numbers = tmp_path / "weights.txt"
    numbers.write_text("\n".join(map(repr, weights.tolist())), encoding="ascii")

    assert verify(path, first, second, "--weights", numbers) == (0, "VERIFIED")
    assert "digest" in verify(path, first, plain, "--weights", numbers)[1]
    assert "digest" in verify(path, first, second)[1]


@pytest.mark.parametrize("sigma", ["0.01", "0.3", "7e-5", "1.1e9"])
def test_sigma_stands_for_the_double_nearest_to_its_inverse_square(sigma, tmp_path):
    source, target, _ = oracle.random_problem(4, n=5)
    exact = 1 / Fraction(float(sigma)) ** 2
    weight = float(exact)
    assert all(
        abs(Fraction(np.nextafter(weight, k)) - exact) >= abs(weight - exact) for k in (0, 1e300)
    )
    path = tmp_path / "certificate.json"
    path.write_bytes(oracle.dump(oracle.produce(source, target, [weight] * 5)))
    clouds = [write_csv(tmp_path / f"{k}.csv", cloud) for k, cloud in enumerate((source, target))]

    assert verify(path, *clouds, "--sigma", sigma)[0] == 0
    assert verify(path, *clouds, "--sigma", "0.5")[0] == 1
    assert verify(path, *clouds, "--any-weight")[0] == 0  # the weights in the certificate
    code, out = verify(path, *clouds)[:2]
    assert code == 1
    assert f"--sigma {float(sigma)!r}" in out


def test_columns_left_out_are_noted_once(generic, tmp_path):
    path, cloud = tmp_path / "certificate.json", tmp_path / "cloud.csv"
    path.write_bytes(oracle.dump(generic))
    cloud.write_text("x,y,z,colour\n1,2,3,red\n4,5,6,\x1b[31m\n", encoding="ascii")

    done = certreg("verify", path, cloud, cloud)
    assert done.code == 1
    assert done.err.count("colour") == 2  # once for each of the two files


def named(path, header, names):
    rows = (f"{name},{k},{k * k},{k**3}\n" for k, name in enumerate(names))
    path.write_text(f"{header},x,y,z\n" + "".join(rows), encoding="utf-8")
    return path


def both_ways(tmp_path, source, target):
    """`equilibria`, which reads arrays, and `verify`, which reads text by itself."""
    (tmp_path / "c.json").write_text("{}", "utf-8")
    return (
        certreg("equilibria", source, target),
        certreg("verify", tmp_path / "c.json", source, target),
    )


@pytest.mark.parametrize(
    ("first", "second"), [("id", "id"), ("Name", "POINT"), ("nr", "number"), ("label", "id")]
)
def test_the_same_points_in_another_order_are_not_paired_by_row(tmp_path, first, second):
    source = named(tmp_path / "a.csv", first, ["p", "q", "r", "s"])
    target = named(tmp_path / "b.csv", second, ["p", "s", "r", "q"])
    for run in both_ways(tmp_path, source, target):
        assert (run.code, run.out) == (2, "")
        assert run.err.splitlines()[-1] == (
            f"certreg: {source} and {target} name the same points in another order: point 1 "
            "(counting from 0) is 'q' and 's': rename the column that names them to label in both "
            "files, or give pairs"
        )
    (tmp_path / "pairs.csv").write_text("0,0\n1,3\n2,2\n3,1\n", "utf-8")
    assert certreg("equilibria", source, target, "--pairs", tmp_path / "pairs.csv").code in {0, 3}


@pytest.mark.parametrize(
    ("header", "names"), [("id", "pqrs"), ("id", "pqrt"), ("colour", "spqr"), ("id", "pqsx")]
)
def test_the_same_order_or_other_points_are_paired_by_row_with_a_note(tmp_path, header, names):
    source = named(tmp_path / "a.csv", header, "pqrs")
    target = named(tmp_path / "b.csv", header, names)
    for run, code in zip(both_ways(tmp_path, source, target), (0, 1), strict=True):
        assert run.code == code
        assert run.err.count(f"not used: {header} (only `label` pairs rows)") == 2


def test_labels_in_one_file_only_are_told_to_be_of_no_use(tmp_path):
    full = named(tmp_path / "a.csv", "label", "pqrs")
    bare = tmp_path / "b.csv"
    bare.write_text("0,0,0\n1,1,1\n2,4,8\n3,9,27\n", "utf-8")
    note = f"note: {full}: labels not used, as {bare} has none: row i pairs with row i\n"
    for clouds in ((full, bare), (bare, full)):
        assert [run.err for run in both_ways(tmp_path, *clouds)] == [note, note]
    for run in both_ways(tmp_path, full, full):
        assert run.err == ""
