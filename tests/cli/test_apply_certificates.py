"""`apply` moves by a pose, a similarity, a certificate; `verify` and `report` take its folder."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg, write_csv
from scipy.spatial.transform import Rotation
from strategies import random_rotation

from certreg import Pose, Similarity, load

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


TURN = np.column_stack([random_rotation(np.random.default_rng(1)), [1.0, 2.0, 3.0]])
MOTION = Similarity.of_pose(Pose.from_matrix(TURN), 1000.0)
CLOUD = np.random.default_rng(2).normal(size=(5, 3))


@pytest.fixture
def cloud(tmp_path: Path) -> Path:
    np.savetxt(tmp_path / "cloud.txt", CLOUD, fmt="%.17g")
    return tmp_path / "cloud.txt"


def test_a_scale_beside_the_rotation_is_applied(cloud: Path, tmp_path: Path):
    fields: dict[str, Any] = {"scale": MOTION.scale, "translation": MOTION.translation.tolist()}
    fields["quaternion_wxyz"] = MOTION.quaternion_wxyz.tolist()
    (tmp_path / "pose.json").write_text(json.dumps({"pose": fields}), encoding="utf-8")
    run = certreg("apply", tmp_path / "pose.json", cloud, "--out", tmp_path / "moved.csv")

    assert run.code == 0
    assert "moved.csv, scaled by 1000 (header: x,y,z)" in run.out
    assert np.allclose(load(tmp_path / "moved.csv").points, MOTION.apply(CLOUD), rtol=1e-12)


def test_a_scale_within_a_matrix_is_refused_unless_it_is_asked_for(cloud: Path, tmp_path: Path):
    np.savetxt(tmp_path / "pose.txt", MOTION.as_matrix(), fmt="%.17g")
    line = ("apply", tmp_path / "pose.txt", cloud, "--out", tmp_path / "moved.csv")
    refused = certreg(*line)

    assert refused.code == 2
    assert "scales by 1000" in refused.err
    assert "--scaled moves by a similarity" in refused.err
    assert not (tmp_path / "moved.csv").exists()
    assert certreg(*line, "--scaled").code == 0
    assert np.allclose(load(tmp_path / "moved.csv").points, MOTION.apply(CLOUD), rtol=1e-12)


def test_a_reflection_is_none_however_it_is_asked_for(cloud: Path, tmp_path: Path):
    np.savetxt(tmp_path / "pose.txt", MOTION.as_matrix() * [[-1.0], [1.0], [1.0], [1.0]])
    run = certreg("apply", tmp_path / "pose.txt", cloud, "--out", tmp_path / "m.csv", "--scaled")

    assert run.code == 2
    assert "reflection" in run.err
