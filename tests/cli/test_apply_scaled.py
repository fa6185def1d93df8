"""`apply` moves by a similarity: one that stands beside the rotation, or in a matrix if asked."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg
from strategies import random_rotation

from certreg import Pose, Similarity, load

if TYPE_CHECKING:
    from pathlib import Path

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
