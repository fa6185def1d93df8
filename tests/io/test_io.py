"""What is written is read back bit for bit; whatever is read, only InvalidFileError is raised."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import stat
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from samples import examples

from certreg.errors import InvalidFileError
from certreg.io import atomic
from certreg.io.atomic import write_atomically, write_together
from certreg.io.clouds import read_cloud
from certreg.io.labels import Match, csv_field, text_of_field
from certreg.io.pairing import Pairing, read_pair
from certreg.io.poses import read_pose
from certreg.io.problems import read_weights
from certreg.io.streams import NUMBER
from certreg.io.written_clouds import write_cloud
from certreg.problem import arrays as problems

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

FORMATS = (".csv", ".txt", ".ply", ".npy")  # that are written
NUMBERS = (".csv", ".txt", ".npy")
DOUBLES = st.floats(allow_nan=False, allow_infinity=False)
POINTS = st.lists(st.tuples(DOUBLES, DOUBLES, DOUBLES), min_size=1, max_size=5).map(np.array)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for many examples."""
    return tmp_path_factory.mktemp("files")


def bits(array: NDArray[np.float64]) -> bytes:
    return array.astype("<f8").tobytes()


# Round trips -------------------------------------------------------------------------------------


@pytest.mark.slow
@given(points=POINTS, suffix=st.sampled_from(FORMATS))
@example(points=np.array([[-0.0, 5e-324, 1.7976931348623157e308]]), suffix=".csv")
@example(points=np.array([[-0.0, 5e-324, 1.7976931348623157e308]]), suffix=".txt")
def test_points_are_read_back_bit_for_bit(place: Path, points, suffix: str):
    file = place / f"cloud{suffix}"
    write_cloud(file, points, None)
    cloud = read_cloud(file)

    assert cloud.points.dtype == np.float64
    assert bits(cloud.points) == bits(points)
    assert (cloud.labels, cloud.ignored) == (None, ())


@pytest.mark.slow
@given(points=POINTS, data=st.data())
def test_labels_are_read_back_or_refused_at_writing(place: Path, points, data):
    """Any text; the alphabet of the second kind is that of CSV itself."""
    text = st.text(st.characters(), max_size=8) | st.text(
        " \t,;\"'#\r\n\ufeffa\u3000\x00", max_size=8
    )
    labels = tuple(data.draw(st.lists(text, min_size=len(points), max_size=len(points))))
    file = place / "labelled.csv"
    file.unlink(missing_ok=True)
    if any(label != label.strip() or strange(label) for label in labels):
        with pytest.raises(InvalidFileError, match="label") as caught:
            write_cloud(file, points, labels)
        assert one_line(caught.value)
        assert not file.exists()
        return
    write_cloud(file, points, labels)
    cloud = read_cloud(file)

    assert cloud.labels == labels
    assert bits(cloud.points) == bits(points)


def strange(label: str) -> bool:
    """Lone surrogates, which UTF-8 cannot hold, and a mark of byte order where a line begins."""
    return any("\ud800" <= c <= "\udfff" for c in label) or "\n\ufeff" in label


def test_labels_of_every_common_kind_are_kept(tmp_path: Path):
    labels = ("a,b", 'say "hi"', "Größe 5 µm", "点", "", "two words", "a\nb", "c\r\nd", "#1", "1.5")
    labels += ("'", '"', "\ufeffmark", "x", "label", "😀", "a;b", "tab\there")
    points = np.arange(3.0 * len(labels)).reshape(-1, 3)
    write_cloud(tmp_path / "a.csv", points, labels)
    write_cloud(tmp_path / "b.csv", points[::-1], labels[::-1])
    pair = read_pair(tmp_path / "a.csv", tmp_path / "b.csv")

    assert pair.source.labels == pair.target.labels == labels
    assert pair.target.points.tolist() == points.tolist()


FORMULAS = ("=1+1", "+1+1", "-1+1", "@SUM(A1)", '=HYPERLINK("x","y")', "\uff1d1", "=", "-", "+A")
DANGEROUS = frozenset("=+-@\t\r\uff1d\uff0b\uff0d\uff20")


def cells(text: str, separator: str) -> list[str]:
    """All cells that a spreadsheet makes of a file, by either of its separators."""
    rows = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    return [cell for row in rows for cell in row]


def test_no_label_is_a_formula_and_all_are_read_back(tmp_path: Path):
    labels = (*FORMULAS, *(f"'{text}" for text in FORMULAS), "''=1", "a;=1+1", "a|@x", "b\t=1")
    labels += ("-1.5", "+3", "1e5", "'", "'nose", "x'=1")
    points = np.arange(3.0 * len(labels)).reshape(-1, 3)
    write_cloud(tmp_path / "a.csv", points, labels)
    text = (tmp_path / "a.csv").read_bytes().decode()

    assert read_cloud(tmp_path / "a.csv").labels == labels
    for separator in ",;\t":
        for cell in cells(text, separator):
            assert cell[:1] not in DANGEROUS or re.fullmatch(r"[-+][0-9.,]+", cell), cell
    assert "\n-1.5," in text  # a number is no formula
    assert '\n"a;=1+1",' in text


@given(st.text("=+-@\t\r\n'\"a1;,.\uff1d", max_size=6))
def test_a_field_is_no_formula_and_gives_its_text_back(text: str):
    (cell, end) = next(csv.reader(io.StringIO(csv_field(text) + ",end", newline="")))

    assert end == "end"
    assert text_of_field(cell) == text
    assert cell[:1] not in DANGEROUS or NUMBER.fullmatch(cell)


@pytest.mark.parametrize(
    "label", [" a", "a ", "a\n", "\u3000a", "\ud800", "a\n\ufeffb", "a" * 200_000]
)
def test_labels_that_would_change_are_refused_at_writing(tmp_path: Path, label: str):
    with pytest.raises(InvalidFileError, match="label") as caught:
        write_cloud(tmp_path / "a.csv", np.zeros((1, 3)), (label,))

    assert len(one_line(caught.value)) < 1000
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("suffix", FORMATS)
def test_points_beyond_the_doubles_are_refused_at_writing(tmp_path: Path, suffix: str, value):
    points = np.zeros((3, 3))
    points[1, 2] = value
    with pytest.raises(InvalidFileError, match="row 1 "):
        write_cloud(tmp_path / f"a{suffix}", points, None)

    assert list(tmp_path.iterdir()) == []


def test_a_format_that_cannot_be_written_or_read_is_named(tmp_path: Path):
    known = r"is not known: use one of \.csv \.txt \.xyz \.asc \.pts \.obj \.pdb \.npy .*\.kitti$"
    for name in ("a.doc", "a", "a.cxv", "a.xyz"):
        with pytest.raises(InvalidFileError, match=r"written: use \.csv \.txt \.ply \.npy$"):
            write_cloud(tmp_path / name, np.zeros((1, 3)), None)
        if name != "a.xyz":
            with pytest.raises(InvalidFileError, match=known):
                read_cloud(tmp_path / name)


def test_upper_case_suffixes_are_the_same_formats(tmp_path: Path):
    points = np.array([[1.0, 2, 3]])
    for suffix in FORMATS:
        file = tmp_path / f"A{suffix.upper()}"
        write_cloud(file, points, None)
        assert read_cloud(file).points.tolist() == points.tolist()


# What a text file may look like ------------------------------------------------------------------


TABLES = {
    "bare rows": "1,2,3\n4,5,6\n",
    "bare rows, no newline at the end": "1,2,3\n4,5,6",
    "named columns": "x,y,z\n1,2,3\n4,5,6\n",
    "named columns in another order": "Z, Y, X\n3,2,1\n6,5,4\n",
    "more columns": "x,y,z,red\n1,2,3,9\n4,5,6,9\n",
    "Windows": "\ufeffx,y,z\r\n1,2,3\r\n4,5,6\r\n",
    "blank lines": "\nx,y,z\n\n1,2,3\n\n4,5,6\n\n",
    "quoted and exponents": '"x","y","z"\n"1e0",+2.,3\n4,.5e1,60E-1\n',
}


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_read_as_it_is_meant(tmp_path: Path, name: str):
    file = tmp_path / "a.csv"
    file.write_bytes(TABLES[name].encode())

    assert read_cloud(file).points.tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    "text",
    ["1 2 3\n4 5 6\n", " 1\t2   3 \n# said\n\n4 5 6\n", "1, 2, 3\n4,5,6\n", "1 2 3 9\n4 5 6 9\n"],
)
def test_plain_text_is_read_as_it_is_meant(tmp_path: Path, text: str):
    file = tmp_path / "a.txt"
    file.write_text(text, "utf-8")

    assert read_cloud(file).points.tolist() == [[1, 2, 3], [4, 5, 6]]


def test_weights_are_read_from_text_and_npy(tmp_path: Path):
    weights = [1.0, 0.0, 2.5e-300, 3.0]
    (tmp_path / "w.txt").write_text("# weights\n" + "\n".join(map(repr, weights)) + "\n", "utf-8")
    (tmp_path / "w.csv").write_text("\n".join(map(repr, weights)) + "\n", "utf-8")
    np.save(tmp_path / "w.npy", np.array(weights))

    for suffix in NUMBERS:
        assert read_weights(tmp_path / f"w{suffix}").tolist() == weights


@pytest.mark.parametrize(
    "array",
    [
        np.asfortranarray(np.arange(12.0).reshape(4, 3) / 7),
        (np.arange(12.0).reshape(4, 3) / 7).astype(">f8"),
        (np.arange(12.0).reshape(4, 3) / 8).astype(np.float32),
        (np.arange(12.0).reshape(4, 3) / 8).astype(np.float16),
        np.arange(12).reshape(4, 3) - 5,
        np.arange(12, dtype=np.uint8).reshape(4, 3),
        np.full((1, 3), 2**60 + 2**20),
        np.full((1, 3), 2**63, dtype=np.uint64),
        np.arange(24.0).reshape(8, 3)[::2],
    ],
    ids=["fortran", "big-endian", "float32", "float16", "int", "uint8", "2^60", "2^63", "strided"],
)
def test_an_npy_file_of_any_real_type_and_order_is_read_right(tmp_path: Path, array):
    np.save(tmp_path / "a.npy", array)
    cloud = read_cloud(tmp_path / "a.npy")

    assert cloud.points.dtype == np.float64
    assert cloud.points.flags.c_contiguous
    assert [list(map(float, row)) for row in array.tolist()] == cloud.points.tolist()


# Bytes of any kind -------------------------------------------------------------------------------


def one_line(error: BaseException) -> str:
    message = str(error)
    assert message.isprintable()
    return message


def npy(header: str, body: bytes) -> bytes:
    """A file with the frame of npy 1.0 and any header."""
    text = header.encode("latin1", errors="replace")
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + body


SHAPES = st.lists(st.integers(-3, 4), max_size=3).map(lambda shape: repr(tuple(shape)))
TYPES = st.sampled_from(
    ["<f8", ">f8", "<f4", "<i8", "|O", "<c16", "|S3", "<U2", "<M8[s]", "(2,)<f8"]
)
HEADERS = st.builds(
    "{{'descr': {!r}, 'fortran_order': {}, 'shape': {}, }}\n".format,
    TYPES,
    st.sampled_from(["True", "False", "None"]),
    SHAPES | st.just("(1L, 3L)") | st.just("(9" + "9" * 30 + ",)"),
)
NUMPY_FILES = st.builds(
    npy,
    HEADERS | st.text("{}()[]'\"\\:,L-~ \n\x000descr", max_size=60) | st.text("-(", max_size=9990),
    st.binary(max_size=80) | st.integers(0, 12).map(lambda n: bytes(8 * n)),
)
CSV_LIKE = st.text('0123456789.,eE+- \t\n\r"#xyzlabe\ufeffnif_', max_size=60).map(str.encode)
JSON_VALUES: st.SearchStrategy[Any] = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(
                ["pose", "rotation", "translation", "quaternion_wxyz", "T_target_source"]
            ),
            inner,
        )
    ),
    max_leaves=20,
)
ANYTHING = (
    st.binary(max_size=100)
    | CSV_LIKE
    | NUMPY_FILES
    | JSON_VALUES.map(lambda value: json.dumps(value).encode())
)


def refused_or(read: Callable[[Path], Any], file: Path) -> Any:
    """What is read; None where it is refused, in one line that names the file."""
    try:
        return read(file)
    except InvalidFileError as error:
        refusal = one_line(error)
    assert refusal.startswith(str(file))
    return None


@pytest.mark.slow
@examples(400)
@given(content=ANYTHING, suffix=st.sampled_from(FORMATS))
@example(
    content=npy("{'descr': '<f8', 'fortran_order': False, 'shape': (-1, -3)}", bytes(24)),
    suffix=".npy",
)
@example(
    content=npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1L, 3L)}", bytes(24)),
    suffix=".npy",
)
@example(content=npy("-" * 9990 + "1", b""), suffix=".npy")
@example(content=npy("(" * 9990, b""), suffix=".npy")
@example(content=npy("'''", b""), suffix=".npy")
@example(content=npy("  a\n b", b""), suffix=".npy")
@example(content=npy("{1: 2, 'a': 3}", b""), suffix=".npy")
@example(content=npy("  {\n 'a", b""), suffix=".npy")
def test_any_bytes_are_a_cloud_of_finite_points_or_refused(
    place: Path, content: bytes, suffix: str
):
    file = place / f"any{suffix}"
    file.write_bytes(content)
    cloud = refused_or(read_cloud, file)
    weights = refused_or(read_weights, file) if suffix in NUMBERS else None

    if cloud is not None:
        assert cloud.points.dtype == np.float64
        assert cloud.points.shape == (len(cloud.points), 3)
        assert len(cloud.points) > 0
        assert np.isfinite(cloud.points).all()
    if weights is not None:
        assert weights.dtype == np.float64
        assert weights.ndim == 1
        assert np.isfinite(weights).all()
        assert weights.min() >= 0 < weights.max()


@pytest.mark.slow
@examples(400)
@given(content=ANYTHING)
@example(content=b",")
@example(content=b"[" * 100_000)
@example(content=b'{"pose": 1, "translation": [0, 0, 0], "rotation": {}}')
@example(content=b'{"T_target_source": {"a": 1, "b": 2, "c": 3}}')
@example(content=b"1 0 0 0\n0 nan 0 0\n0 0 1 0")
@example(content=b"1 0 1e200 0 1 2 3")
@example(content=b"1e308 1e308 1e308 1e308 1 2 3")
@example(content=b'{"rotation": [[1,0,0],[0,1,0],[0,0,1]], "translation": [0,0,Infinity]}')
@example(content=b"1_0 0 0 0\n0 1 0 0\n0 0 1 0")
def test_any_bytes_are_a_finite_pose_or_refused(place: Path, content: bytes):
    file = place / "any.pose"
    file.write_bytes(content)
    pose = refused_or(read_pose, file)

    if pose is not None:
        assert pose.rotation.shape == (3, 3)
        assert pose.translation.shape == (3,)
        assert np.isfinite(pose.rotation).all()
        assert np.isfinite(pose.translation).all()


def test_a_pickle_is_never_run(tmp_path: Path):
    class Bomb:
        def __reduce__(self):
            return (Path.touch, (tmp_path / "exploded",))

    buffer = io.BytesIO()
    np.save(buffer, np.array([[Bomb(), 1, 2]], dtype=object), allow_pickle=True)
    (tmp_path / "a.npy").write_bytes(buffer.getvalue())
    with pytest.raises(InvalidFileError, match="object"):
        read_cloud(tmp_path / "a.npy")

    assert not (tmp_path / "exploded").exists()
    np.load(tmp_path / "a.npy", allow_pickle=True)
    assert (tmp_path / "exploded").exists()  # so the bomb was one


# What killed processes left -----------------------------------------------------------------------


def unfinished(path: Path, age: float) -> Path:
    path.write_text("half", "utf-8")
    os.utime(path, (0.0, time.time() - age))
    return path


def test_files_that_killed_processes_left_are_swept_and_no_others(tmp_path: Path, monkeypatch):
    names = (
        "0123456789abcdef",
        "0123456789abcdeg",
        "0123456789abcde",
        "0123456789abcdef0",
        "notes",
    )
    left, *kept = [unfinished(tmp_path / f".certreg-{n}", atomic.STALE + 60.0) for n in names]
    kept.append(unfinished(tmp_path / f".certreg-{'a' * 16}", atomic.STALE - 60.0))
    (tmp_path / f".certreg-{'b' * 16}").mkdir()
    (tmp_path / f".certreg-{'c' * 16}").symlink_to(tmp_path / "elsewhere")
    os.utime(tmp_path / f".certreg-{'b' * 16}", (0.0, 0.0))
    os.utime(tmp_path / f".certreg-{'c' * 16}", (0.0, 0.0), follow_symlinks=False)
    write_atomically(tmp_path / "a.bin", b"new")

    assert not left.exists()
    assert all(path.read_text("utf-8") == "half" for path in kept)
    assert len(list(tmp_path.iterdir())) == len(kept) + 3

    own = unfinished(left, atomic.STALE + 60.0)
    monkeypatch.setattr(os, "getuid", lambda: own.stat().st_uid + 1)
    atomic._sweep.__wrapped__(tmp_path)
    assert own.exists()  # another user's


def test_a_folder_is_swept_once(tmp_path: Path):
    write_atomically(tmp_path / "a.bin", b"new")
    left = unfinished(tmp_path / f".certreg-{'a' * 16}", atomic.STALE + 60.0)
    write_atomically(tmp_path / "b.bin", b"new")

    assert left.exists()


# Writing -----------------------------------------------------------------------------------------


def test_a_file_is_replaced_as_a_whole(tmp_path: Path):
    file = tmp_path / "a.bin"
    file.write_bytes(b"a longer old content")
    write_atomically(file, b"new")

    assert file.read_bytes() == b"new"
    assert [path.name for path in tmp_path.iterdir()] == ["a.bin"]


def test_a_file_has_the_permissions_of_any_other_new_file(tmp_path: Path):
    (tmp_path / "other").touch()
    write_atomically(tmp_path / "a.bin", b"new")

    modes = {stat.S_IMODE(path.stat().st_mode) for path in tmp_path.iterdir()}
    assert len(modes) == 1


@pytest.mark.parametrize("step", ["fdopen", "replace"])
@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_failed_write_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch, step, error
):
    def fail(*_: object, **__: object):
        raise error

    file = tmp_path / "a.csv"
    file.write_bytes(b"old")
    monkeypatch.setattr(*((os, "fdopen") if step == "fdopen" else (Path, "replace")), fail)
    expected = InvalidFileError if isinstance(error, OSError) else KeyboardInterrupt
    with pytest.raises(expected) as caught:
        write_cloud(file, np.zeros((1, 3)), None)

    if expected is InvalidFileError:
        assert str(file) in one_line(caught.value)
        assert "No space left on device" in str(caught.value)
    assert file.read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path):
    (tmp_path / "file").touch()
    (tmp_path / "folder.csv").mkdir()
    for file in (tmp_path / "file" / "a.csv", tmp_path / "none" / "a.csv", tmp_path / "folder.csv"):
        with pytest.raises(InvalidFileError, match="cannot be written") as caught:
            write_cloud(file, np.zeros((1, 3)), None)
        assert str(file) in one_line(caught.value)

    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.csv"]
    assert list((tmp_path / "folder.csv").iterdir()) == []


def test_files_of_an_earlier_run_that_are_not_written_again_go(tmp_path: Path):
    kept, gone = tmp_path / "a.txt", tmp_path / "b.txt"
    kept.write_text("old", "utf-8")
    gone.write_text("old", "utf-8")
    contents: Any = {kept: b"new"}
    write_together(contents, obsolete=[gone, tmp_path / "never.txt"])

    assert kept.read_bytes() == b"new"
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_of_a_pose_with_a_quaternion_the_quaternion_is_judged(tmp_path: Path):
    file = tmp_path / "pose.json"
    quaternion = [0.5000000000000001, 0.5, -0.5, 0.4999999999999999]
    file.write_text(json.dumps({"quaternion_wxyz": quaternion, "translation": [1, 2, 3]}), "utf-8")

    assert read_pose(file).turn.tolist() == quaternion


@pytest.mark.parametrize("obsolete", [False, True])
@pytest.mark.parametrize("exists", [False, True])
def test_files_that_belong_together_are_not_written_through_a_link(
    tmp_path: Path, exists, obsolete
):
    precious, link = tmp_path / "precious", tmp_path / "b.txt"
    if exists:
        precious.write_text("mine", "utf-8")
    link.symlink_to(precious)
    (tmp_path / "a.txt").write_text("old", "utf-8")
    contents = {tmp_path / "a.txt": b"new"} | ({} if obsolete else {link: b"new"})

    with pytest.raises(
        InvalidFileError, match=r"b.txt: is a link where a file is to be: remove it"
    ):
        write_together(contents, obsolete=[link] if obsolete else [])

    assert link.is_symlink()
    assert precious.exists() == exists
    assert not exists or precious.read_text("utf-8") == "mine"
    assert (tmp_path / "a.txt").read_text("utf-8") == "old"


def test_a_link_put_there_meanwhile_is_replaced_and_not_followed(tmp_path: Path):
    precious, first, second = (tmp_path / name for name in ("precious", "a.txt", "b.txt"))
    precious.write_text("mine", "utf-8")

    def pieces() -> Iterator[bytes]:
        second.symlink_to(precious)
        yield b"new"

    write_together({first: pieces(), second: b"new"}, obsolete=[])

    assert (second.is_symlink(), second.read_text("utf-8"), precious.read_text("utf-8")) == (
        False,
        "new",
        "mine",
    )


def test_writing_through_a_link_keeps_the_link(tmp_path: Path):
    target, link = tmp_path / "real.csv", tmp_path / "link.csv"
    target.write_text("old", "utf-8")
    link.symlink_to(target)
    write_cloud(link, np.zeros((1, 3)), None)

    assert link.is_symlink()
    assert target.read_text("utf-8") == "x,y,z\n0.0,0.0,0.0\n"


def test_what_is_left_out_is_told_of_the_file_that_has_it(tmp_path: Path):
    texts = {"a": "pqrs", "b": "rqtuvw"}  # of each, two of the other and more
    for name, labels in texts.items():
        rows = [f"{label},{k},0,0" for k, label in enumerate(labels)]
        (tmp_path / f"{name}.csv").write_text("\n".join(("label,x,y,z", *rows)) + "\n", "utf-8")
    files = tmp_path / "a.csv", tmp_path / "b.csv"
    pair = read_pair(*files, Pairing(match=Match.COMMON))

    assert pair.notes == [f"2 pairs; left out: 2 of {files[0]}, 4 of {files[1]}"]


def test_a_row_that_cannot_be_written_is_counted_over_all_blocks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(problems, "BLOCK_POINTS", 2)
    points = np.ones((8, 3))
    points[5, 1] = np.inf

    with pytest.raises(InvalidFileError, match="row 5 ") as caught:
        write_cloud(tmp_path / "moved.csv", points, None)
    assert caught.value.row == 5
