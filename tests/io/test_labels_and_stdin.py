"""Labels of .ply files pair or are refused; a cloud from standard input or a pipe is read."""

from __future__ import annotations

import io
import os
import sys
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import cloud_files as files
import numpy as np
import pytest
from commands import certreg

from certreg import RegistrationProblem, read_problem
from certreg.campaign.listing import read_listing
from certreg.campaign.store import MANIFEST, Manifest, require_same
from certreg.certificate.envelope import certificate_bytes
from certreg.certificate.refusals import why_no_certificates
from certreg.errors import InvalidFileError
from certreg.io.clouds import read_cloud
from certreg.io.pairing import Pairing
from certreg.io.streams import format_of, reading

if TYPE_CHECKING:
    from pathlib import Path


HERE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3], [1, 1, 1]])
THERE = HERE[:, [1, 2, 0]] + [0.25, -0.5, 0.0]
KINDS = ("ascii", "binary_little_endian", "binary_big_endian")


def ply(path: Path, points, kind: str = KINDS[0], **columns: Any) -> Path:
    """Doubles x, y, z, and columns of any type, as PLY names it, before them."""
    names = [(kinds, name) for name, (kinds, _) in columns.items()]
    rows = [
        [*more, *row]
        for row, *more in zip(
            points.tolist(), *(values for _, values in columns.values()), strict=True
        )
    ]
    properties = [*names, *(("double", axis) for axis in "xyz")]
    path.write_bytes(files.ply([("vertex", properties, rows)], kind))
    return path


@pytest.mark.parametrize("kind", KINDS)
def test_labels_of_ply_files_pair_their_points(tmp_path: Path, kind: str):
    order = [3, 1, 4, 0, 2]
    source = ply(tmp_path / "a.ply", HERE, kind, label=("int", [7, 8, 9, 10, 11]))
    target = ply(tmp_path / "b.ply", THERE[order], kind, label=("float", [7.0 + k for k in order]))
    problem, pair = read_problem(source, target)

    assert problem.digest() == RegistrationProblem(HERE, THERE).digest()
    assert pair.source.labels == pair.target.labels == ("7", "8", "9", "10", "11")
    assert pair.notes == []


@pytest.mark.parametrize("name", ["id", "index", "point_id"])
def test_points_of_ply_files_that_are_named_in_another_order_are_refused(tmp_path: Path, name):
    source = ply(tmp_path / "a.ply", HERE, KINDS[0], **{name: ("uchar", [1, 2, 3, 4, 5])})
    same = ply(tmp_path / "b.ply", THERE, KINDS[0], **{name: ("int", [1, 2, 3, 4, 5])})
    other = ply(tmp_path / "c.ply", THERE, KINDS[0], **{name: ("int", [5, 4, 3, 2, 1])})

    assert read_problem(source, same)[1].notes[-1].endswith(f"not used: {name}")
    with pytest.raises(InvalidFileError, match="name the same points in another order"):
        read_problem(source, other)


def test_classes_of_a_segmentation_are_no_names(tmp_path: Path):
    source = ply(tmp_path / "a.ply", HERE, label=("uchar", [1, 1, 2, 2, 2]))
    target = ply(tmp_path / "b.ply", THERE, label=("uchar", [1, 1, 2, 2, 2]))
    turned = ply(tmp_path / "c.ply", THERE, label=("uchar", [2, 2, 2, 1, 1]))
    named = ply(tmp_path / "d.ply", THERE, label=("uchar", [1, 2, 3, 4, 5]))
    problem, pair = read_problem(source, target)

    assert problem.digest() == RegistrationProblem(HERE, THERE).digest()
    assert "labels repeat in both: classes, not names" in pair.notes[-1]
    with pytest.raises(InvalidFileError, match="in another order"):
        read_problem(source, turned)
    with pytest.raises(InvalidFileError, match="label '1' occurs 2 times"):
        read_problem(source, named)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("column", ["sigma", "weight"])
def test_noise_of_a_ply_file_is_used_or_ignored(tmp_path: Path, column: str, kind: str):
    numbers = [0.5, 1.0, 2.0, 4.0, 0.25]
    source = ply(tmp_path / "a.ply", HERE, kind, **{column: ("float", numbers)})
    target = ply(tmp_path / "b.ply", THERE, kind)
    noise: dict[str, Any] = {"sigma" if column == "sigma" else "weights": numbers}
    problem, pair = read_problem(source, target)

    assert problem.digest() == RegistrationProblem(HERE, THERE, **noise).digest()
    assert [f"column {column} is used" in note for note in pair.notes] == [True]
    bare, pair = read_problem(source, target, pairing=Pairing(ignore_weights=True))
    assert bare.digest() == RegistrationProblem(HERE, THERE).digest()
    assert [f"not used: {column}" in note for note in pair.notes] == [True]


@pytest.mark.parametrize(
    ("column", "value", "words"),
    [
        ("sigma", 0.0, "sigma 2 .* is 0.0: give a standard deviation > 0"),
        ("weight", -1.0, "weight 2 .* is -1.0: weights must be >= 0"),
        ("weight", np.nan, "row 2 .* must be finite"),
        ("sigma", np.inf, "row 2 .* must be finite"),
    ],
)
def test_noise_of_a_ply_file_that_is_none_is_refused(tmp_path: Path, column, value, words):
    numbers = [1.0, 1.0, value, 1.0, 1.0]
    file = ply(tmp_path / "a.ply", HERE, KINDS[1], **{column: ("float", numbers)})
    with pytest.raises(InvalidFileError, match=words):
        read_cloud(file)

    assert read_cloud(file, noise=False).ignored == (column,)


# Standard input ----------------------------------------------------------------------------------


def given(monkeypatch: pytest.MonkeyPatch, content: bytes) -> None:
    """Content on standard input."""
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(content)))


def npy(points) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, points)
    return buffer.getvalue()


TEXT = "\n".join(" ".join(map(repr, row)) for row in HERE.tolist()).encode()
INPUTS = {
    "text": TEXT,
    "text behind a comment": b"# by hand\n\n" + TEXT,
    "table": b"x,y,z\n" + TEXT.replace(b" ", b","),
    "semicolons": TEXT.replace(b" ", b";"),
    "chemical": b"5\n\n" + b"\n".join(b"C " + row for row in TEXT.splitlines()),
    "obj": b"# a mesh\nv " + TEXT.replace(b"\n", b"\nv ") + b"\nf 1 2 3\n",
    "npy": npy(HERE),
    "npz": files.npz({"points": HERE}),
    "ply": files.xyz_ply(HERE.tolist(), KINDS[1]),
    "pcd": files.pcd([(axis, "F", 8, 1) for axis in "xyz"], HERE.tolist(), "binary"),
}


@pytest.mark.parametrize("name", INPUTS)
def test_one_cloud_may_come_from_standard_input(tmp_path: Path, monkeypatch, name: str):
    np.save(tmp_path / "b.npy", THERE)
    given(monkeypatch, INPUTS[name])

    problem, pair = read_problem("-", tmp_path / "b.npy")

    assert problem.digest() == RegistrationProblem(HERE, THERE).digest()
    assert pair.about["source"].startswith("stdin.")


def test_the_command_line_reads_a_dash_and_a_certificate_beside_it(tmp_path: Path, monkeypatch):
    np.save(tmp_path / "b.npy", THERE)
    told = ("-", tmp_path / "b.npy")
    given(monkeypatch, TEXT)
    quick = ("--no-relaxation", "--no-simulation", "--out", tmp_path / "out")
    assert certreg("certify", *told, *quick).code == 0
    given(monkeypatch, TEXT)
    assert certreg("verify", tmp_path / "out" / "certificate.json", *told).code == 0
    given(monkeypatch, b"1 2 x\n")
    run = certreg("equilibria", *told)
    assert (run.code, run.out) == (2, "")
    assert "stdin.txt, line 1: 'x' is not a number" in run.err
    both = certreg("equilibria", "-", "-")
    assert (both.code, both.out) == (2, "")
    assert "standard input holds one cloud: give a file for the other" in both.err


@pytest.mark.parametrize(
    ("beginning", "suffix"),
    [
        (b"", ".txt"),
        (b"HEADER    PROTEIN\n", ".pdb"),
        (b"NUMMDL    2\n", ".pdb"),
        (b"data_2BEG\n", ".cif"),
        (b"LASF\0", ".las"),
        (b"solid a\n", ".stl"),
        (b"# .PCD v0.7\n", ".pcd"),
        (b"ply\r\n", ".ply"),
        (b"\xff\xfe", ".txt"),
    ],
)
def test_how_an_input_begins_tells_its_format(beginning: bytes, suffix: str):
    assert format_of(beginning) == suffix


def test_an_endless_input_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("certreg.io.streams.MAX_TEXT_BYTES", 8)
    given(monkeypatch, TEXT)
    with pytest.raises(InvalidFileError, match="standard input: more than 8 bytes"):
        read_cloud("-")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("device", [False, True])
def test_a_named_pipe_and_a_device_are_refused(tmp_path: Path, *, device: bool):
    path = tmp_path / "a.csv"
    if device:
        path.symlink_to("/dev/zero")
    else:
        os.mkfifo(path)
    with pytest.raises(InvalidFileError, match="a named pipe or a device"), reading(path):
        pass
    with pytest.raises(InvalidFileError, match="a named pipe or a device"):
        certificate_bytes(path)


def test_a_pipe_of_the_shell_is_read():
    end, writing = os.pipe()
    os.write(writing, b"1 2 3")
    os.close(writing)
    with reading(f"/dev/fd/{end}") as stream:
        assert stream.read() == b"1 2 3"
    os.close(end)


def test_a_cloud_piped_without_a_name_of_its_format_is_told_to_come_on_standard_input():
    with pytest.raises(InvalidFileError, match=r"/dev/fd/63: the format \(none\) .*: .* give -"):
        read_cloud("/dev/fd/63")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("name", ["a.jsonl", "a.json"])
def test_a_named_pipe_of_certificates_is_refused(tmp_path: Path, name: str):
    os.mkfifo(tmp_path / name)
    run = certreg("verify", tmp_path / name)

    assert run.code == 2
    assert "a named pipe or a device" in run.err


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_named_pipe_as_list_or_manifest_is_refused(tmp_path: Path):
    listed, manifest = tmp_path / "pairs.csv", tmp_path / MANIFEST
    for path in (listed, manifest):
        os.mkfifo(path)
    with pytest.raises(InvalidFileError, match="a named pipe"):
        read_listing(listed)
    wanted = Manifest(kind="pairs", count=1, shard_size=1, settings={}, versions={})
    with pytest.raises(InvalidFileError, match="a named pipe"):
        require_same(manifest, wanted)


def test_certificates_that_the_shell_pipes_in_are_all_checked():
    end, writing = os.pipe()
    os.write(writing, b"{}\n{}\n")
    os.close(writing)
    assert why_no_certificates(f"/dev/fd/{end}") is None
    assert os.read(end, 10) == b"{}\n{}\n"
    os.close(end)
