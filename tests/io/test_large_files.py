"""Clouds too large to be read at once: mapped from their files, with the same answers."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from cloud_files import ply, xyz_ply
from commands import certreg
from hypothesis import given
from hypothesis import strategies as st
from samples import examples
from test_formats import REFUSED

from benchmarks.rates import broken_files
from certreg.errors import InvalidFileError
from certreg.io import cloud, streams
from certreg.io.cloud import RowNumbers
from certreg.io.clouds import read_cloud
from certreg.io.problems import read_problem, read_weights
from certreg.problem.arrays import mapped_file

POINTS = np.random.default_rng(5).normal(size=(500, 3)).astype(np.float32)


@pytest.fixture
def all_large(monkeypatch):
    monkeypatch.setattr(streams, "MAPPED_BYTES", 1)


def told(path: Path) -> tuple[str, object]:
    """What reading a file comes to: its points, or the refusal."""
    try:
        return "points", read_cloud(path).points.astype(float).tolist()
    except InvalidFileError as error:
        return "refused", re.sub(" at 0x[0-9a-f]+", "", str(error))


def told_both_ways(path: Path) -> tuple[tuple[str, object], tuple[str, object]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(streams, "MAPPED_BYTES", 1)
        mapped = told(path)
    return told(path), mapped


@pytest.mark.parametrize("kind", ["<f4", ">f4", "<f8", ">f8"])
@pytest.mark.parametrize("order", [np.ascontiguousarray, np.asfortranarray])
def test_an_npy_file_stays_in_its_place(tmp_path, kind, order, all_large):
    np.save(tmp_path / "a.npy", order(POINTS.astype(kind)))
    cloud = read_cloud(tmp_path / "a.npy")

    assert mapped_file(cloud.points) is not None
    assert cloud.points.dtype == kind
    assert np.array_equal(cloud.points, POINTS)
    with pytest.raises(ValueError, match="read-only"):
        cloud.points[0] = 0.0


def labelled(path: Path, numbers: list[float], type_: str = "uint", name: str = "label") -> Path:
    """A file whose points have numbers: text for a reader of the whole, mapped for a large one."""
    rows = [[*map(float, POINTS[int(k) % 500]), k] for k in numbers]
    names = [*(("float", axis) for axis in "xyz"), (type_, name)]
    path.write_bytes(ply([("vertex", names, rows)], "binary_little_endian"))
    return path


@pytest.mark.parametrize("name", ["label", "id"])
@pytest.mark.parametrize("bound", [1, 9000])  # both files are large, or the first
def test_large_files_with_the_same_labels_in_another_order_are_refused(
    tmp_path, monkeypatch, name, bound
):
    order = np.random.default_rng(3).permutation(500)
    first = labelled(tmp_path / "a.ply", list(range(500)), "double", name)
    second = labelled(tmp_path / "b.ply", order.tolist(), "uint" if bound < 2 else "ushort", name)
    monkeypatch.setattr(streams, "MAPPED_BYTES", bound)
    assert first.stat().st_size > 9000 > second.stat().st_size

    with pytest.raises(InvalidFileError, match="number the same points in another order") as error:
        read_problem(first, second)
    row = error.value.row
    assert order[: row or 0].tolist() == list(range(row or 0))
    assert f"is {row} and {order[row or 0]}, and" in str(error.value)


def test_large_files_with_the_labels_in_their_order_or_other_labels_pair_by_row(
    tmp_path, all_large
):
    first = labelled(tmp_path / "a.ply", list(range(500)), "double")
    others = labelled(tmp_path / "b.ply", [500 - k for k in range(500)], "double")
    bare = tmp_path / "c.ply"
    bare.write_bytes(xyz_ply(POINTS.tolist(), "binary_little_endian"))

    for other in (first, others, bare):
        assert read_problem(first, other)[0].n == 500


def test_numbers_of_rows_are_compared_in_blocks_and_whatever_they_are(monkeypatch):
    blocks = [slice(0, 300), slice(300, 500)]
    monkeypatch.setattr(cloud, "row_blocks", lambda _: blocks)
    numbers = np.arange(500.0)
    numbers[7] = np.nan
    rolled, other = np.roll(numbers, 1), numbers.copy()
    other[499] += 1.0
    one, same, late, moved = (
        RowNumbers(column=each) for each in (numbers, numbers.copy(), other, rolled)
    )

    assert one.first_other(same) is None
    assert (one.first_other(late), one.sum == late.sum) == (499, False)
    assert (one.first_other(moved), one.sum == moved.sum) == (0, True)
    assert RowNumbers.of(("7", "x")) is None


def colours(kind: str, type_: str) -> bytes:
    """Vertices between a colour and an odd byte, behind another element and before faces."""
    rows = [[1, *point, 7.5] for point in POINTS.tolist()]
    names = [("uchar", "red"), *((type_, axis) for axis in "xyz"), ("float", "q")]
    faces = [[[k, k + 1, k + 2]] for k in range(20)]
    return ply(
        [
            ("camera", [("short", "view")], [[3]]),
            ("vertex", names, rows),
            ("face", [("uchar", "int", "vertex_indices")], faces),
        ],
        kind,
    )


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("kind", ["binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("type_", ["float", "double"])
def test_a_ply_file_stays_in_its_place_whatever_is_around(tmp_path, kind, type_, all_large):
    for content in (xyz_ply(POINTS.tolist(), kind, type_), colours(kind, type_)):
        (tmp_path / "a.ply").write_bytes(content)
        cloud = read_cloud(tmp_path / "a.ply")

        assert mapped_file(cloud.points) is not None
        assert cloud.points.dtype.itemsize == {"float": 4, "double": 8}[type_]
        assert np.array_equal(cloud.points, POINTS)


ELSEWHERE = {
    "of several types": [("float", "x"), ("double", "y"), ("float", "z")],
    "of whole numbers": [("int", "x"), ("int", "y"), ("int", "z")],
    "apart": [("float", "x"), ("uchar", "r"), ("float", "y"), ("float", "z")],
    "with a list": [("float", "x"), ("uchar", "uchar", "l"), ("float", "y"), ("float", "z")],
}


@pytest.mark.parametrize("name", ELSEWHERE)
def test_points_that_are_not_side_by_side_are_copied(tmp_path, name, all_large, monkeypatch):
    lists = [[1, 2], [3]]
    rows = [[k, *([lists[k]] if "list" in name else [9] if name == "apart" else []), 2, 3 + k]
            for k in range(2)]  # fmt: skip
    (tmp_path / "a.ply").write_bytes(ply([("vertex", ELSEWHERE[name], rows)]))

    assert read_cloud(tmp_path / "a.ply").points.tolist() == [[0, 2, 3], [1, 2, 4]]
    monkeypatch.setattr("certreg.io.ply.MAX_BINARY_BYTES", 20)
    with pytest.raises(InvalidFileError, match=r"too many: save x, y, z of one type"):
        read_cloud(tmp_path / "a.ply")


def test_axes_in_any_order_are_points_in_theirs(tmp_path, all_large):
    rows = POINTS[:, ::-1].tolist()
    content = ply([("vertex", [("float", axis) for axis in "zyx"], rows)])
    (tmp_path / "a.ply").write_bytes(content)
    points = read_cloud(tmp_path / "a.ply").points

    assert mapped_file(points) is not None
    assert np.array_equal(points, POINTS)


@pytest.mark.parametrize("name", [name for name in REFUSED if REFUSED[name][0] in {"npy", "ply"}])
def test_a_broken_file_is_refused_in_the_same_words(tmp_path, name):
    suffix, content, words = REFUSED[name]
    path = tmp_path / f"broken.{suffix}"
    path.write_bytes(content)
    read, mapped = told_both_ways(path)

    assert read == mapped
    assert mapped[0] == "refused"
    assert words in str(mapped[1])


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("mutated")


GOOD = [("ply", content) for content in broken_files.PLY if b"ascii" not in content[:20]]
GOOD += [("npy", content) for content in broken_files.NPY]


@pytest.mark.slow
@examples(300)
@given(st.data())
def test_a_file_changed_anywhere_is_read_or_refused_as_if_it_were_small(place, data):
    suffix, content = data.draw(st.sampled_from(GOOD))
    at = data.draw(st.integers(0, len(content)))
    put = data.draw(st.binary(max_size=3))
    rest = data.draw(st.integers(0, 4))
    path = place / f"a.{suffix}"
    path.unlink(missing_ok=True)
    path.write_bytes(content[:at] + put + content[at + rest :])
    read, mapped = told_both_ways(path)

    assert read == mapped


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("suffix", ["npy", "ply"])
def test_a_row_that_is_no_number_is_named(tmp_path, suffix, bad, all_large, monkeypatch):
    monkeypatch.setattr("certreg.problem.arrays.BLOCK_POINTS", 100)
    points = POINTS.copy()
    points[417, 1] = bad
    path = tmp_path / f"a.{suffix}"
    if suffix == "npy":
        np.save(path, points)
    else:
        path.write_bytes(xyz_ply(points.tolist(), type_="float"))
    with pytest.raises(InvalidFileError, match=rf"a\.{suffix}: row 417 \(counting from 0\) is "):
        read_cloud(path)


def test_weights_may_be_large_too(tmp_path, all_large):
    np.save(tmp_path / "w.npy", np.arange(5.0))
    weights = read_weights(tmp_path / "w.npy")

    assert mapped_file(weights) is not None
    for wrong, words in (([1.0, -2.0], "weight 1 .* is -2.0"), ([0.0, 0.0], "all weights are")):
        np.save(tmp_path / "v.npy", wrong)
        with pytest.raises(InvalidFileError, match=words):
            read_weights(tmp_path / "v.npy")


def test_the_problem_and_its_certificate_are_those_of_small_files(tmp_path, monkeypatch):
    for name, points in (("a", POINTS), ("b", POINTS[:, [1, 2, 0]] + np.float32(0.25))):
        np.save(tmp_path / f"{name}.npy", points)
        (tmp_path / f"{name}.ply").write_bytes(xyz_ply(points.tolist(), type_="float"))
    small, _ = read_problem(tmp_path / "a.npy", tmp_path / "b.npy")
    monkeypatch.setattr(streams, "MAPPED_BYTES", 1)
    large, pair = read_problem(tmp_path / "a.ply", tmp_path / "b.npy")
    run = certreg("equilibria", tmp_path / "a.ply", tmp_path / "b.npy", "--json")

    assert large.digest() == small.digest()
    assert mapped_file(large.source) is not None
    assert (pair.source_rows, pair.notes) == (None, [])
    assert (run.code, run.err) == (0, "")


@pytest.mark.parametrize("suffix", ["npy", "ply", "csv"])
def test_a_large_cloud_is_moved_block_by_block_to_the_same_bytes(tmp_path, suffix, monkeypatch):
    np.save(tmp_path / "a.npy", POINTS)
    (tmp_path / "pose.txt").write_text("0.5 0.5 0.5 0.5 1 2 3\n", "utf-8")
    words = ("apply", tmp_path / "pose.txt", tmp_path / "a.npy", "--out")
    first = certreg(*words, tmp_path / f"small.{suffix}")
    monkeypatch.setattr("certreg.problem.arrays.BLOCK_POINTS", 100)
    monkeypatch.setattr(streams, "MAPPED_BYTES", 1)
    second = certreg(*words, tmp_path / f"large.{suffix}")
    contents = [(tmp_path / f"{size}.{suffix}").read_bytes() for size in ("small", "large")]

    assert (first.code, second.code) == (0, 0)
    assert contents[0] == contents[1]
    assert np.allclose(
        read_cloud(tmp_path / f"large.{suffix}").points, POINTS[:, [2, 0, 1]] + [1.0, 2.0, 3.0]
    )


def test_a_moved_row_beyond_the_doubles_is_named_and_nothing_is_written(tmp_path, monkeypatch):
    points = POINTS.astype(float)
    points[417] = 1.7e308
    np.save(tmp_path / "a.npy", points)
    (tmp_path / "pose.txt").write_text("1 0 0 0 1.7e308 0 0\n", "utf-8")
    monkeypatch.setattr("certreg.problem.arrays.BLOCK_POINTS", 100)
    run = certreg("apply", tmp_path / "pose.txt", tmp_path / "a.npy", "--out", tmp_path / "b.npy")

    assert run.code == 2
    assert "b.npy: row 417 (counting from 0) would be [inf" in run.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.npy", "pose.txt"]


def test_a_file_beyond_all_bounds_is_refused(tmp_path, monkeypatch):
    np.save(tmp_path / "a.npy", POINTS)
    monkeypatch.setattr(streams, "MAPPED_BYTES", 1)
    monkeypatch.setattr(streams, "MAX_MAPPED_BYTES", 100)
    with pytest.raises(InvalidFileError, match="bytes are too many"):
        read_cloud(tmp_path / "a.npy")


GROWTH = """
import resource, sys, certreg
from certreg.io.clouds import read_cloud
from certreg.problem.floating_sums import compiled
compiled(), certreg.register([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 0, 0], [1, 0, 0], [0, 2, 0]])
lines = open("/proc/self/status").read().splitlines()
before = next(int(line.split()[1]) for line in lines if line.startswith("VmData")) << 10
resource.setrlimit(resource.RLIMIT_DATA, (before + (50 << 20),) * 2)
source, target = map(read_cloud, sys.argv[1:])
pose = certreg.register(source.points, target.points)
print(*pose.translation.round(6).tolist())
"""


@pytest.mark.slow
def test_two_files_are_registered_in_a_fraction_of_their_size(tmp_path):
    # 72 MB each; what is added is a block of both at a time.
    few = np.random.default_rng(0).integers(-9, 9, size=(1000, 3)).astype(np.float32)
    points = np.resize(few, (6_000_000, 3))
    np.save(tmp_path / "a.npy", points)
    head = b"ply\nformat binary_little_endian 1.0\nelement vertex 6000000\n"
    head += b"property float x\nproperty float y\nproperty float z\nend_header\n"
    (tmp_path / "b.ply").write_bytes(head + (points + np.float32(2.0)).tobytes())
    run = subprocess.run(
        [sys.executable, "-c", GROWTH, str(tmp_path / "a.npy"), str(tmp_path / "b.ply")],
        env={"PYTHONPATH": str(Path(__file__).parents[2]), **os.environ},
        capture_output=True,
        text=True,
        check=True,
        encoding="utf-8",
    )

    assert run.stdout.split() == ["2.0"] * 3
