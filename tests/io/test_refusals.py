"""Refusals hold the numbers of the file that is wrong, and limits hold at themselves."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path
from typing import Any

import cloud_files as files
import numpy as np
import pytest
from commands import write_csv
from refusals import wrong_evidence

from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.io import atomic, labels, npz, pairs, problems
from certreg.io.atomic import write_files, write_together
from certreg.io.cloud import Cloud
from certreg.io.clouds import read_cloud
from certreg.io.pairing import Pair, Pairing, read_pair
from certreg.io.problems import read_problem
from certreg.io.streams import MAX_LINE_BYTES, Place, typed_number
from certreg.io.text import notes_on, read_clouds
from certreg.io.written_clouds import write_cloud

FOUR = [[float(x), 0.5 * x * x, -1.0 * x] for x in range(4)]
SIX = [[float(x), 2.0 - x, 0.25 * x * x] for x in range(6)]
FLOATS = [(axis, "F", 4, 1) for axis in "xyz"]


def refusal(read: Any, *arguments: Any, **options: Any) -> InvalidFileError:
    with pytest.raises(InvalidFileError) as caught:
        read(*arguments, **options)
    return caught.value


@pytest.fixture
def sides(tmp_path: Path) -> tuple[Path, Path]:
    """Clouds of four and of six points."""
    return write_csv(tmp_path / "s.csv", FOUR), write_csv(tmp_path / "t.csv", SIX)


def test_clouds_of_two_sizes_are_told_with_both(sides: tuple[Path, Path]):
    for first, second, n, m in ((*sides, 4, 6), (*reversed(sides), 6, 4)):
        error = refusal(read_pair, first, second)

        assert (error.path, error.value, error.limit) == (second, m, n)
        assert f"{first} has {n} points, {second} has {m}: " in str(error)


def test_weights_are_one_for_each_row_of_the_source_and_go_with_it(
    sides: tuple[Path, Path], tmp_path: Path
):
    listing, weights = tmp_path / "pairs.csv", tmp_path / "w.txt"
    listing.write_text("Source,TARGET\n3,5\n0,1\n2,2\n", "utf-8")  # any case
    weights.write_text("1\n2\n3\n4\n", "utf-8")
    pairing = Pairing(pairs=listing)
    problem, pair = read_problem(*sides, weights=weights, pairing=pairing)

    assert problem.weights.tolist() == [4.0, 1.0, 3.0]
    assert problem.source.tolist() == [FOUR[k] for k in (3, 0, 2)]
    assert problem.target.tolist() == [SIX[k] for k in (5, 1, 2)]
    assert (pair.sizes, pair.left_out) == ((4, 6), (1, 3))
    weights.write_text("1\n" * 6, "utf-8")
    error = refusal(read_problem, *sides, weights=weights, pairing=pairing)
    assert (error.path, error.value, error.limit) == (weights, 6, 4)
    assert f"{weights}: holds 6 weights, {sides[0]} has 4 points" in str(error)


def test_weights_of_another_shape_are_told_with_it(tmp_path: Path):
    path = tmp_path / "w.NPY"
    path.write_bytes(files.npy(np.ones((4, 1))))
    error = refusal(problems.read_weights, path)

    assert str(error).startswith(f"{path}: holds an array of shape (4, 1): ")
    assert error.value == (4, 1)
    path.write_bytes(files.npy(np.array([1.0, -0.5])))
    error = refusal(problems.read_weights, path)
    assert (error.row, error.value, error.limit) == (1, -0.5, 0.0)


@pytest.mark.parametrize("suffix", [".CSV", ".Txt", ".PLY", ".NPY"])
def test_formats_are_told_by_suffixes_of_any_case(tmp_path: Path, suffix: str):
    path = tmp_path / f"cloud{suffix}"
    write_cloud(path, np.array(FOUR), None)

    assert read_cloud(path).points.tolist() == FOUR


@pytest.mark.parametrize(("suffix", "named"), [(".xyzw", ".xyzw"), ("", "(none)")])
def test_a_format_that_is_not_written_is_named(tmp_path: Path, suffix: str, named: str):
    error = refusal(write_cloud, tmp_path / f"cloud{suffix}", np.array(FOUR), None)

    assert f": the format {named} cannot be written: use .csv .txt .ply .npy" in str(error)
    assert (error.value, error.limit) == (suffix, (".csv", ".txt", ".ply", ".npy"))


def test_labels_in_a_certificate_are_those_of_either_cloud_if_they_are_short(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    (tmp_path / "pairs.csv").write_text("2,3\n0,3\n", "utf-8")
    for name in ("s.csv", "t.csv"):
        write_cloud(tmp_path / name, np.array(FOUR), None)
    by_rows = read_pair(
        tmp_path / "s.csv", tmp_path / "t.csv", Pairing(pairs=tmp_path / "pairs.csv")
    ).about["labels"]

    def about(source: tuple[str, ...] | None, target: tuple[str, ...] | None) -> Any:
        first, second = (
            Cloud(path=Path(name), points=np.array(FOUR), labels=labels, ignored=())
            for name, labels in (("s.csv", source), ("t.csv", target))
        )
        return Pair(source=first, target=second, source_rows=None, sizes=(4, 4)).about

    names, others = ("a", "b", "c", "d"), ("e", "f", "g", "h")
    bare = {"source": "s.csv", "target": "t.csv"}
    assert about(None, None) == bare
    assert about(names, None) == about(names, others) == {**bare, "labels": list(names)}
    assert about(None, others) == {**bare, "labels": list(others)}
    assert by_rows == ["source row 2 and target row 3", "source row 0 and target row 3"]
    monkeypatch.setattr(labels, "LABEL_CHARACTERS", 4)
    assert "labels" in about(names, None)
    monkeypatch.setattr(labels, "LABEL_CHARACTERS", 3)
    assert about(names, None) == bare


@pytest.mark.parametrize(
    ("changed", "line", "evidence"),
    [
        ({"TYPE": "F F C"}, 5, ("z", "C 4", None)),
        ({"SIZE": "4 4 2"}, 5, ("z", "F 2", None)),
        ({"COUNT": "1 0 1"}, 6, ("y", 0, 1)),
    ],
)
def test_a_field_that_is_wrong_is_named_with_what_it_says(
    tmp_path: Path, changed: dict[str, Any], line: int, evidence: tuple[Any, ...]
):
    path = tmp_path / "cloud.pcd"
    path.write_bytes(files.pcd(FLOATS, SIX, "ascii", **changed))
    error = refusal(read_cloud, path)

    assert (error.path, error.line) == (path, line)
    assert (error.column, error.value, error.limit) == evidence


@pytest.mark.parametrize("declared", [5, 7])
def test_rows_of_a_pcd_file_are_as_many_as_it_declares(tmp_path: Path, declared: int):
    path = tmp_path / "cloud.pcd"
    count = str(declared)
    path.write_bytes(files.pcd(FLOATS, SIX, "ascii", WIDTH=count, POINTS=count))
    error = refusal(read_cloud, path)

    assert f" {declared} " in str(error)
    assert error.path == path
    assert declared == 5 or (error.value, error.limit) == (6, 7)


def test_numbers_of_integer_types_keep_to_their_range():
    place = Place(Path("a.ply"), 7, "x")
    for bits, least, most in ((8, -128, 127), (16, -32768, 32767), (32, -(2**31), 2**31 - 1)):
        kind = f"i{bits // 8}"
        assert typed_number(place, str(least), kind) == least
        assert typed_number(place, str(most), kind) == most
        for wrong in (least - 1, most + 1):
            error = refusal(typed_number, place, str(wrong), kind)
            assert (error.column, error.value, error.limit) == ("x", str(wrong), kind)
    assert typed_number(place, "255", "u1") == 255
    for wrong in ("256", "-1"):
        refusal(typed_number, place, wrong, "u1")
    assert place.refusal("", column="y").column == "y"


def test_a_list_of_an_unknown_type_is_no_property(tmp_path: Path):
    path = tmp_path / "mesh.ply"
    head = "ply\nformat ascii 1.0\nelement vertex 1\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    for types, good in (("uint8 int", True), ("uint8 nothing", False), ("nothing int", False)):
        path.write_text(f"{head}property list {types} more\nend_header\n1 2 3 0\n", "utf-8")
        if good:
            assert read_cloud(path).points.tolist() == [[1.0, 2.0, 3.0]]
        else:
            assert refusal(read_cloud, path).value == f"list {types} more"


def test_an_archive_has_at_most_its_arrays_and_its_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    path, others = tmp_path / "cloud.npz", {f"a{k}": np.ones(1) for k in range(63)}
    path.write_bytes(files.npz({"points": np.array(FOUR), **others}))
    assert read_cloud(path).points.tolist() == FOUR
    path.write_bytes(files.npz({"points": np.array(FOUR), "b": np.ones(1), **others}))
    error = refusal(read_cloud, path)
    assert (error.value, error.limit) == (65, 64)

    path.write_bytes(files.npz({"points": np.array(FOUR)}))
    with zipfile.ZipFile(path) as archive:
        size = archive.infolist()[0].file_size
    monkeypatch.setattr(npz, "MAX_UNPACKED_BYTES", size)
    assert read_cloud(path).points.tolist() == FOUR
    monkeypatch.setattr(npz, "MAX_UNPACKED_BYTES", size - 1)
    error = refusal(read_cloud, path)
    assert (error.column, error.value, error.limit) == ("points", size, size - 1)


def test_a_file_without_pairs_says_what_it_needs(tmp_path: Path):
    path = tmp_path / "pairs.csv"
    path.write_text("source,target\n", "utf-8")
    error = refusal(pairs.read_pairs, path, (4, 4))

    assert (error.path, error.value, error.limit) == (path, 0, 1)


@pytest.mark.parametrize("spare", [0, 1])
def test_the_longest_line_is_shorter_than_its_limit(tmp_path: Path, spare: int):
    path, rest = tmp_path / "cloud.csv", ",1,2,3\n"
    label = "p" * (MAX_LINE_BYTES - len(rest) - spare)
    path.write_text(f"label,x,y,z\n{label}{rest}", "utf-8")

    assert MAX_LINE_BYTES == 65536
    if spare:
        assert read_cloud(path).labels == (label,)
    else:
        assert refusal(read_cloud, path).limit == 65536


def test_files_are_written_by_their_names_into_a_folder_that_is_made(tmp_path: Path):
    write_files(tmp_path / "a" / "b", {"c": b"1", "d": b"2"})

    assert [path.read_bytes() for path in sorted((tmp_path / "a" / "b").iterdir())] == [b"1", b"2"]


def test_a_folder_in_the_place_of_a_file_is_refused_and_nothing_changes(tmp_path: Path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "old").write_bytes(b"old")
    error = refusal(
        write_together, {tmp_path / "a": b"", tmp_path / "folder": b""}, [tmp_path / "old"]
    )

    assert error.path == tmp_path / "folder"
    assert "is a folder where a file is to be" in str(error)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "old"]


def test_only_names_of_certreg_are_swept(tmp_path: Path):
    names = {f"{start}certreg-{'0123456789abcdef'}" for start in (".", "x", "")}
    for name in names:
        (tmp_path / name).write_bytes(b"")
        os.utime(tmp_path / name, (0, 0))
    atomic._sweep.cache_clear()
    atomic._sweep(tmp_path)

    assert {path.name for path in tmp_path.iterdir()} == names - {".certreg-0123456789abcdef"}


@pytest.mark.parametrize("sigma", [0.0, -1.0, float("nan"), float("inf"), 1e-200])
def test_a_sigma_that_gives_no_weights_is_refused(sides: tuple[Path, Path], sigma: float):
    with pytest.raises(InvalidProblemError, match="sigma"):
        read_clouds(sides[0], sides[0], sigma=sigma)


@pytest.mark.parametrize(("name", "hint"), [("a.csv", True), ("a.CSV", True), ("a.txt", False)])
def test_in_a_table_alone_labels_are_said_to_pair_rows(name: str, *, hint: bool):
    (note,) = notes_on(Path(name), (), ("r", "g"))

    assert note == f"{name}: not used: r, g{' (only `label` pairs rows)' * hint}"


@pytest.mark.parametrize(
    ("evidence", "good"),
    [
        ({"path": Path("b/a.csv"), "line": 1, "row": 0, "column": "x", "value": 2.0}, True),
        ({"path": "a.csv"}, False),
        ({"path": Path("b.csv")}, False),
        ({"line": 0}, False),
        ({"row": -1}, False),
        ({"row": np.int64(1)}, False),
        ({"column": 3}, False),
        ({"value": np.float64(1.0)}, False),
        ({"limit": Path("a.csv")}, False),
    ],
)
def test_what_every_refusal_of_these_tests_is_held_to(evidence: dict[str, Any], *, good: bool):
    assert (wrong_evidence("a.csv: mend it", evidence) is None) == good


def test_columns_of_noise_are_read_where_no_other_noise_is_given(tmp_path: Path):
    cloud, weights = tmp_path / "cloud.csv", tmp_path / "weights.txt"
    cloud.write_text("x,y,z,sigma\n0,0,0,2\n1,0,0,2\n0,1,0,4\n", "utf-8")
    weights.write_text("5\n6\n7\n", "utf-8")
    plain = write_csv(tmp_path / "plain.csv", [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    given: tuple[dict[str, Any], ...] = ({}, {"sigma": 0.5}, {"weights": weights})
    masses = [read_clouds(plain, cloud, **one)[0].weights for one in given]

    assert [list(one or ()) for one in masses] == [[0.25, 0.25, 0.0625], [4.0] * 3, [5.0, 6.0, 7.0]]
    cloud.write_text("x,y,z,sigma\n0,0,0,much\n1,0,0,2\n0,1,0,4\n", "utf-8")
    for one in given[1:]:
        assert read_clouds(plain, cloud, **one)[0].weights is not None
    with pytest.raises(InvalidFileError, match="much"):
        read_clouds(plain, cloud)
