"""`apply` moves by the pose of a certificate; `verify` and `report` take its folder."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest
from commands import certreg, write_csv
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from pathlib import Path

RNG = np.random.default_rng(6)
X = RNG.uniform(-1.0, 1.0, (9, 3))
Y = X @ Rotation.from_rotvec([0.3, 0.2, -0.5]).as_matrix().T
Y += 0.005 * RNG.standard_normal(X.shape)
BOUND = ("--max-residual", "0.1")
TURNS = ("--rotation-only", *BOUND, "--objective", "truncated")


@pytest.fixture
def clouds(tmp_path: Path) -> list[Path]:
    np.save(tmp_path / "n.npy", np.eye(3)[np.arange(9) % 3])
    return [write_csv(tmp_path / f"{n}.csv", c.tolist()) for n, c in (("x", X), ("y", Y))]


@pytest.mark.parametrize(
    "options",
    [
        (),
        ("--scale", "symmetric"),
        ("--rotation-only",),
        BOUND,
        (*BOUND, "--scale", "asymmetric"),
        (*BOUND, "--normals", "n.npy"),
        pytest.param(TURNS, marks=pytest.mark.slow),
    ],
)
def test_a_certificate_moves_as_the_result_beside_it(tmp_path, clouds, options):
    given = [tmp_path / one if one.endswith("npy") else one for one in options]
    certreg("certify", *clouds, *given, "--out", tmp_path / "o")
    moved = [
        certreg("apply", pose, clouds[0], "--out", tmp_path / name)
        for pose, name in ((tmp_path / "o", "a.csv"), (tmp_path / "o/certificate.json", "b.csv"))
    ]
    assert [run.code for run in moved] == [0, 0]
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert moved[1].out.endswith("certificate.json, which the checker accepts.\n")


def test_a_certificate_that_is_refused_moves_nothing(tmp_path, clouds):
    certreg("certify", *clouds, *BOUND, "--out", tmp_path)
    path = tmp_path / "certificate.json"
    document = json.loads(path.read_text("utf-8"))
    document["claims"]["upper"] -= 1
    path.write_text(json.dumps(document), "utf-8")
    run = certreg("apply", path, clouds[0], "--out", tmp_path / "a.csv")

    assert run.code == 1
    assert "REFUSED: claims.upper is below the proved bound 9" in run.err
    document["problem"]["data"] = None
    path.write_text(json.dumps(document), "utf-8")
    run = certreg("apply", path, clouds[0], "--out", tmp_path / "a.csv")
    assert run.code == 2
    assert "holds no points, from which its pose is computed: give the result or the" in run.err
    assert not (tmp_path / "a.csv").exists()


def test_a_folder_of_certify_is_verified_and_reported(tmp_path, clouds):
    certreg("certify", *clouds, "--no-simulation", "--out", tmp_path / "o")
    page = tmp_path / "o" / "report.html"
    page.unlink()

    assert certreg("verify", tmp_path / "o", *clouds).out.endswith("VERIFIED\n")
    assert certreg("report", tmp_path / "o").code == 0
    assert page.exists()
    for command in ("verify", "report"):
        refused = certreg(command, tmp_path)
        assert refused.code == 2
        assert "a folder without certificate.json: give a folder that certify --out" in refused.err


@pytest.mark.parametrize(
    ("options", "names", "checks"),
    [
        (BOUND, ("", "result.json", "pose.json", "pose.txt", "certificate.json"), "certreg verify"),
        (
            (*BOUND, "--scale", "asymmetric"),
            ("", "result.json", "certificate.json"),
            "certreg verify",
        ),
        ((*BOUND, "--normals", "n.npy"), ("", "certificate.json"), "certreg verify"),
        ((), ("", "pose.json", "certificate.json"), "certreg assess"),
        pytest.param(TURNS, ("", "certificate.json"), "certreg verify", marks=pytest.mark.slow),
    ],
)
def test_a_pose_of_the_pairs_within_a_bound_is_told_from_that_of_all(
    tmp_path, clouds, options, names, checks
):
    """By `apply`, which says what checks it, and by `assess`, which judges it on all pairs."""
    given = [tmp_path / one if one.endswith("npy") else one for one in options]
    certreg("certify", *clouds, *given, "--out", tmp_path / "o")
    for name in names:
        pose = tmp_path / "o" / name
        moved = certreg("apply", pose, clouds[0], "--out", tmp_path / "a.csv")
        if name != "certificate.json":
            assert moved.out.count("certreg ") == 1
            assert checks in moved.out
        judged = certreg("assess", *clouds, "--pose", pose)
        noted = (
            f"note: {pose}: the pose was fitted to the pairs within a bound alone, and is judged"
        )
        assert judged.err.startswith(noted) == (options != ())


def test_a_pose_file_of_another_pose_is_not_that_of_the_result_beside_it(tmp_path, clouds):
    certreg("certify", *clouds, *BOUND, "--out", tmp_path / "o")
    path = tmp_path / "o" / "pose.txt"
    matrix = np.loadtxt(path)
    for turn, shift in ((matrix[:3, :3], 7.0), (np.eye(3), matrix[:3, 3])):
        other = matrix.copy()
        other[:3, :3], other[:3, 3] = turn, shift
        np.savetxt(path, other)
        assert certreg("assess", *clouds, "--pose", path).err == ""

    path.with_name("result.json").unlink()
    assert certreg("assess", *clouds, "--pose", path.with_name("pose.json")).err == ""


def test_a_pose_is_not_judged_with_bounds(clouds):
    refused = certreg("assess", *clouds, "--pose", "o", *BOUND)

    assert refused.code == 2
    assert refused.err.endswith(
        "Error: --pose is judged on all pairs, and --max-residual is for --labels: leave it out, "
        "and give the pairs that are right alone (--pairs FILE)\n"
    )
