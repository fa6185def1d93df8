"""No command overwrites a file that it reads, whatever it is called."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from commands import certreg

from certreg.report.file_names import FILES

if TYPE_CHECKING:
    from collections.abc import Callable

X = np.random.default_rng(4).normal(size=(6, 3))


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("x.npy", "y.npy", "w.npy"):
        np.save(tmp_path / name, X if name != "w.npy" else np.ones(6))
    np.savetxt(tmp_path / "x.csv", X, delimiter=",")
    np.savetxt(tmp_path / "pose.txt", np.eye(4))
    np.savez(tmp_path / "x.npz", xyz=X)
    (tmp_path / "b.txt").write_text("1\n" * 6, "utf-8")
    (tmp_path / "c.json").write_text("{}", "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("typed", "read"),
    [
        ("apply pose.txt x.csv", "x.csv"),
        ("apply pose.txt x.csv", "pose.txt"),
        ("equilibria x.npy y.npy", "y.npy"),
        ("equilibria x.npy y.npy --weights w.npy", "w.npy"),
        ("equilibria x.npy y.npy --normals x.npy", "x.npy"),
        ("simulate x.npz y.npy", "x.npz"),
        ("report c.json", "c.json"),
        ("report c.json x.npy y.npy", "y.npy"),
        ("report c.json x.npy y.npy --max-residual b.txt", "b.txt"),
        ("verify c.json --coq", "c.json"),
        ("verify c.json x.npy y.npy --coq", "x.npy"),
    ],
)
def test_a_file_that_is_read_is_not_written(place: Path, typed: str, read: str):
    held = {file: file.read_bytes() for file in place.iterdir()}
    run = certreg(*typed.split(), "--out", read)

    said = f"certreg: {read}: would overwrite {read}, which is read: give --out another name\n"
    assert (run.code, run.out, run.err) == (2, "", said)
    assert {file: file.read_bytes() for file in place.iterdir()} == held


@pytest.mark.parametrize("link", [Path.symlink_to, Path.hardlink_to, None])
def test_another_name_of_the_file_is_no_other_file(
    place: Path, link: Callable[[Path, Path], None] | None
):
    out = place / "link.csv" if link is not None else place / ".." / place.name / "x.csv"
    if link is not None:
        link(out, place / "x.csv")
    content = (place / "x.csv").read_bytes()
    run = certreg("apply", "pose.txt", "x.csv", "--out", out)

    said = f"certreg: {out}: would overwrite x.csv, which is read: give --out another name\n"
    assert (run.code, run.out, run.err) == (2, "", said)
    assert (place / "x.csv").read_bytes() == out.read_bytes() == content


@pytest.mark.parametrize(
    ("typed", "read"),
    [
        ("certify fit.csv y.npy", "fit.csv"),
        ("certify x.npy y.npy --weights pose.txt", "pose.txt"),
        ("certify x.npy trajectory.npz", "trajectory.npz"),  # which a failed run would remove
        ("certify x.npy y.npy --pairs fit.csv", "fit.csv"),
        ("certify x.npy y.npy --normals fit.csv", "fit.csv"),
        ("certify x.npy y.npy --max-residual pose.txt", "pose.txt"),
    ],
)
def test_a_file_that_is_read_is_not_written_in_a_folder(place: Path, typed: str, read: str):
    for name, of in (("fit.csv", "x.csv"), ("trajectory.npz", "x.npz")):
        (place / name).write_bytes((place / of).read_bytes())
    held = {file: file.read_bytes() for file in place.iterdir()}
    run = certreg(*typed.split(), "--out", place)

    said = (
        f"certreg: {place / read}: would overwrite {read}, which is read: choose another folder\n"
    )
    assert (run.code, run.out, run.err) == (2, "", said)
    assert {file: file.read_bytes() for file in place.iterdir()} == held


def test_a_folder_with_inputs_of_other_names_is_written_to_again_and_again(place: Path):
    held = {file: file.read_bytes() for file in place.iterdir() if file.name != "pose.txt"}
    for _ in range(2):
        assert certreg("certify", "x.csv", "y.npy", "--out", ".").code == 0
    assert {file: file.read_bytes() for file in held} == held
    assert {file.name for file in place.iterdir()} - {file.name for file in held} == set(FILES)


def test_a_file_of_another_name_may_be_overwritten(place: Path):
    """Standard input is no file `-`, and a name that no file can have is another one."""
    (place / "-").write_bytes(b"kept")
    for out in ("other.csv", "other.csv", f"{place}/other.csv"):
        assert certreg("apply", "pose.txt", "x.csv", "--out", out).code == 0
    run = certreg("apply", "pose.txt", "x.csv", "--out", "a" * 300 + ".csv")
    assert (run.code, "would overwrite" in run.err) == (2, False)
    run = certreg("apply", "pose.txt", "-", "--out", "./-")
    assert "would overwrite" not in run.err
