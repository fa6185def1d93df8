"""Columns are what their names say, whoever wrote the table; what is unclear is refused."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg

from certreg import RegistrationProblem, read_problem
from certreg.errors import InvalidFileError
from certreg.io.clouds import read_cloud
from certreg.io.pairing import Pairing

if TYPE_CHECKING:
    from pathlib import Path

HERE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3], [1, 1, 1]])
THERE = HERE[:, [1, 2, 0]] + [0.01, -0.02, 0.0]


def cloud(tmp_path: Path, text: str, name: str = "a.csv"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_cloud(tmp_path / name)


HEADERS = {
    "surveyors": ("Easting,Northing,Elev\n1,2,3\n", None, ("x=Easting, y=Northing, z=Elev",)),
    "letters": ("E,N,H\n1,2,3\n", None, ("x=E, y=N, z=H",)),
    "northing first": ("N,E,H\n2,1,3\n", None, ("x=E, y=N, z=H",)),
    "point, northing first": ("Label,N,E,Elev\na,2,1,3\n", ("a",), ("x=E, y=N, z=Elev",)),
    "upwards": ("east,north,up\n1,2,3\n", None, ("x=east, y=north, z=up",)),
    "height": ("Y;X;H\n2;1;3\n", None, ("x=X, y=Y, z=H",)),
    "units": ('"X [m]","Y [m]","Z [m]"\n1,2,3\n', None, ()),
    "units of surveyors": ("Easting (m),Northing (m),Z (m)\n1,2,3\n", None, (
        "x=Easting (m), y=Northing (m), z=Z (m)",
    )),
    "units without a blank": ("Easting(m),Northing(m),X\n1,2,3\n".replace("X", "Height(m)"), None, (
        "x=Easting(m), y=Northing(m), z=Height(m)",
    )),
    "brackets without a blank": ("X[mm],Y[mm],Z[mm]\n1,2,3\n", None, ()),
    "semicolons": ("label;x;y;z\na,b;1;2;3\n", ("a,b",), ()),
    "semicolons without a header": ("1;2;3\n", None, ()),
    "decimal commas": ("x;y;z\n1,0;2;3,000\n", None, ("decimal commas",)),
    "labels without a header": ("P1,1,2,3\n", ("P1",), ()),
    "x, y, z beside a grid": ("E,N,H,x,y,z\n7,8,9,1,2,3\n", None, ()),
}  # fmt: skip


@pytest.mark.parametrize("name", HEADERS)
def test_a_header_says_which_columns_are_x_y_z(tmp_path: Path, name: str):
    text, labels, notes = HEADERS[name]
    read = cloud(tmp_path, text)

    assert (read.points.tolist(), read.labels, read.notes) == ([[1, 2, 3]], labels, notes)


TABLES = {
    "labels in front": ("P1 1 2 3\nP2 4 5 6\n", ("P1", "P2"), ()),
    "labels in front, code behind": ("P1 1 2 3 tree\nP2 4 5 6 wall\n", ("P1", "P2"), ("column 5",)),
    "a number as a later label": ("P1 1 2 3\n2 4 5 6\n", ("P1", "2"), ()),
    "a header": ("label x y z\nP1 1 2 3\nP2 4 5 6\n", ("P1", "P2"), ()),
    "a header of CloudCompare": ("//X Y Z R\n1 2 3 9\n4 5 6 9\n", None, ("r",)),
    "a header behind a cross": ("# y x z\n2 1 3\n5 4 6\n", None, ()),
    "a comment": ("# y x z are three\n1 2 3\n4 5 6\n", None, ()),
    "two comments": ("# of a survey\n# n e h\n\n2 1 3\n5 4 6\n", None, ()),
}


@pytest.mark.parametrize("suffix", ["txt", "asc", "pts"])
@pytest.mark.parametrize("name", TABLES)
def test_text_is_read_as_its_first_rows_say(tmp_path: Path, name: str, suffix: str):
    text, labels, ignored = TABLES[name]
    read = cloud(tmp_path, text, f"a.{suffix}")

    assert read.points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert (read.labels, read.ignored) == (labels, ignored)


def test_a_count_may_stand_in_front_of_the_points_of_a_scanner(tmp_path: Path):
    rows = "1 2 3 -100 255 0 0\n4 5 6 -90 0 0 0\n"
    read = cloud(tmp_path, f"2\n{rows}", "a.pts")

    assert read.points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert len(read.ignored) == 4
    for count, words in (("3", "declares 3 points, the file holds 2"), ("1", "the file holds 2")):
        with pytest.raises(InvalidFileError, match=f"line 1: .*{words}"):
            cloud(tmp_path, f"{count}\n{rows}", "a.pts")


UNCLEAR = {
    "another header": ("lon,lat,alt\n1,2,3\n", r"\(lon, lat, alt\) names no column x, y: rename"),
    "a plane only": ("E,N\n1,2\n", "three columns"),
    "no height": ("E,N,code\n1,2,3\n", "names no column z: rename"),
    "two heights": ("E,N,Z,H\n1,2,3,4\n", "does not say which columns are x, y, z"),
    "two planes": ("X,Y,E,N,H\n1,2,3,4,5\n", "does not say which columns are x, y, z"),
    "half of each": ("X,N,H\n1,2,3\n", "does not say which columns are x, y, z"),
    "several units": ("X [m],Y [m],Z [mm]\n1,2,3\n", "several units"),
    "sigma twice": ("x,y,z,sigma,sigma\n1,2,3,4,5\n", "two columns are named sigma"),
    "perhaps thousands": ("1,234;2,000;3\n", r"line 1: '1,234': is it 1\.234 or 1234\?"),
    "commas and points": ("1,5;2.5;3\n", r"'1,5' here and '2\.5' in line 1"),
    "groups": ("1,5;2.000,5;3\n", r"'2\.000,5' is not a number"),
    "many commas": ("1,000,000;2;3\n", "not a number"),
    "half a header": ("x,y,z,1\n1,2,3,4\n", "'x' is not a number, and the row is no header"),
    "no name in front": ("1,2,3,4\n", "4 columns and no header"),
    "sigma of zero": ("x,y,z,sigma\n1,2,3,0\n", "line 2: sigma 0.0: give a standard deviation"),
    "tiny sigma": ("x,y,z,sigma\n1,2,3,1e-170\n", "line 2: sigma"),
    "a negative weight": ("x,y,z,weight\n1,2,3,1\n1,2,3,-1\n", r"line 3: weight -1\.0: .* >= 0"),
    "no weight": ("x,y,z,weight\n1,2,3,\n", "line 2, weight: '' is not a number: remove the row"),
    "beyond the doubles": ("x;y;z\n1,5;2,0e999;3\n", "line 2, y: '2.0e999' is not a finite number"),
    "NaN": ("x,y,z,weight\n1,2,3,nan\n", "line 2, weight: 'nan' is not a number: remove the row"),
}


@pytest.mark.parametrize("name", UNCLEAR)
def test_what_is_unclear_is_refused_with_the_remedy(tmp_path: Path, name: str):
    text, words = UNCLEAR[name]
    with pytest.raises(InvalidFileError, match=words) as caught:
        cloud(tmp_path, text)

    assert str(caught.value).isprintable()


WHOLES = ("0", "00", "1", "9", "07", "12", "012", "123", "1234")


@pytest.mark.parametrize("whole", WHOLES)
def test_a_comma_is_decimal_where_nobody_would_group_so(tmp_path: Path, whole: str):
    """Python groups thousands by itself: what it writes so is refused, and nothing else."""
    for sign in ("", "+", "-"):
        for rest in ("5", "12", "000", "123", "1234"):
            text = f"{sign}{whole},{rest}"
            table = f"x;y;z\n{text};{text};{text}\n"
            if f"{int(whole + rest):,}" == f"{whole},{rest}":
                with pytest.raises(InvalidFileError, match=r"line 2: .*: is it .* or .* points"):
                    cloud(tmp_path, table)
                continue
            read = cloud(tmp_path, table)
            assert read.points.tolist() == [[float(f"{sign}{whole}.{rest}")] * 3], text
            assert read.notes == ("decimal commas",)


def test_symbols_in_front_of_an_xyz_file_are_no_labels(tmp_path: Path):
    with pytest.raises(InvalidFileError, match="'C' is not a number"):
        cloud(tmp_path, "C 1 2 3\n", "a.xyz")


# Noise in columns --------------------------------------------------------------------------------

SIGMA = [0.5, 1.0, 2.0, 4.0, 0.25]


def table(tmp_path: Path, name: str, points, **columns) -> Path:
    head = ",".join(["x", "y", "z", *columns])
    rows = [[*row, *more] for row, *more in zip(points.tolist(), *columns.values(), strict=True)]
    text = "\n".join([head, *(",".join(map(str, row)) for row in rows)])
    (tmp_path / name).write_text(text + "\n", encoding="utf-8")
    return tmp_path / name


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("column", ["sigma", "weight"])
def test_noise_of_a_column_is_that_of_the_option(tmp_path: Path, column: str, side: int):
    more: tuple[dict[str, list[float]], ...] = ({column: SIGMA}, {})
    clouds = [
        table(tmp_path, f"{k}.csv", points, **more[k ^ side])
        for k, points in enumerate((HERE, THERE))
    ]
    problem, pair = read_problem(*clouds)
    noise: dict[str, Any] = {"sigma" if column == "sigma" else "weights": SIGMA}

    assert problem.digest() == RegistrationProblem(HERE, THERE, **noise).digest()
    assert problem.noise_given == (column == "sigma")
    assert [f"column {column} is used as" in note for note in pair.notes] == [True]
    bare = read_problem(*clouds, pairing=Pairing(ignore_weights=True))
    assert bare[0].digest() == RegistrationProblem(HERE, THERE).digest()
    assert [f"not used: {column}" in note for note in bare[1].notes] == [True]
    given = read_problem(*clouds, sigma=3.0)
    assert given[0].digest() == RegistrationProblem(HERE, THERE, sigma=3.0).digest()


def test_a_certificate_of_weights_in_columns_is_verified_beside_them_alone(tmp_path: Path):
    source, target = table(tmp_path, "a.csv", HERE, sigma=SIGMA), table(tmp_path, "b.csv", THERE)
    (tmp_path / "w.txt").write_text("\n".join(str(1 / s**2) for s in SIGMA), encoding="utf-8")
    quick = ("--no-relaxation", "--no-simulation", "--out", tmp_path / "out")
    run = certreg("certify", source, target, *quick)
    certificate = tmp_path / "out" / "certificate.json"

    assert run.code == 0
    assert "a.csv: column sigma is used as the standard deviation of each pair" in run.err
    assert certreg("verify", certificate, source, target).code == 0
    (tmp_path / "p.csv").write_text("".join(f"{k},{k}\n" for k in range(5)), encoding="utf-8")
    told = ("--pairs", tmp_path / "p.csv")  # through NumPy
    assert certreg("verify", certificate, source, target, *told).code == 0
    for options in (("--ignore-weights",), ("--sigma", "1"), (*told, "--ignore-weights")):
        assert certreg("verify", certificate, source, target, *options).code == 1
    for command in ("verify", "report"):
        usage = certreg(command, certificate, source, target, "--any-weight")
        assert (usage.code, usage.out) == (2, "")
        assert "a column of the clouds tells the weights: add --ignore-weights" in usage.err
    weights = ("--weights", tmp_path / "w.txt")
    assert certreg("verify", certificate, source, target, *weights).code == 0


def test_columns_of_both_clouds_or_both_kinds_are_refused_and_may_be_ignored(tmp_path: Path):
    here = table(tmp_path, "a.csv", HERE, sigma=SIGMA)
    there = table(tmp_path, "b.csv", THERE, sigma=SIGMA)
    both = table(tmp_path, "c.csv", THERE, sigma=SIGMA, weight=SIGMA)
    bare = table(tmp_path, "d.csv", HERE)
    for clouds in ((here, there), (bare, both), (here, both)):
        with pytest.raises(InvalidFileError, match=r"which one holds.*--ignore-weights"):
            read_problem(*clouds)
        run = certreg("verify", tmp_path / "none.json", *clouds)
        assert (run.code, "which one holds" in run.err) == (2, True)
        assert certreg("equilibria", *clouds, "--ignore-weights").code == 0
        assert certreg("equilibria", *clouds, "--sigma", "1").code == 0


@pytest.mark.parametrize("column", ["sigma", "weight"])
def test_noise_goes_with_its_rows_by_label_and_by_pairs(tmp_path: Path, column: str):
    names = list("abcde")
    source = table(tmp_path, "a.csv", HERE, label=names)
    order = [3, 1, 4, 0, 2]
    target = table(
        tmp_path,
        "b.csv",
        THERE[order],
        label=[names[k] for k in order],
        **{column: [SIGMA[k] for k in order]},
    )
    noise: dict[str, Any] = {"sigma" if column == "sigma" else "weights": SIGMA}
    expected = RegistrationProblem(HERE, THERE, **noise).digest()
    (tmp_path / "p.csv").write_text("".join(f"{k},{order.index(k)}\n" for k in range(5)), "utf-8")
    quick = ("--no-relaxation", "--no-simulation", "--out", tmp_path / "out")

    assert read_problem(source, target)[0].digest() == expected
    by_pairs = read_problem(source, target, pairing=Pairing(pairs=tmp_path / "p.csv"))
    assert by_pairs[0].digest() == expected
    certreg("certify", source, target, *quick)
    assert certreg("verify", tmp_path / "out" / "certificate.json", source, target).code == 0


def test_the_json_says_how_the_clouds_were_read(tmp_path: Path):
    source = table(tmp_path, "a.csv", HERE, sigma=SIGMA, code=[1, 2, 3, 4, 5])
    target = table(tmp_path, "b.csv", THERE)
    quick = ("--no-relaxation", "--no-simulation", "--json")
    run = certreg("certify", source, target, *quick, "--out", tmp_path / "out")
    plain = certreg("certify", target, target, *quick)

    notes = [line.removeprefix("note: ") for line in run.err.splitlines()]
    assert run.document["notes"] == notes
    assert ["not used: code" in notes[0], "column sigma is used" in notes[1]] == [True, True]
    written = json.loads((tmp_path / "out" / "result.json").read_text("utf-8"))
    assert written["notes"] == notes
    assert plain.document["notes"] == []
