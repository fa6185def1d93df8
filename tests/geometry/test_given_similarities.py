"""A similarity as any tool returns it is read with its scale apart; the tool is never imported."""

from __future__ import annotations

import io
import json
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from strategies import random_rotation

from certreg import Pose, Similarity
from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.geometry.given import given_pose
from certreg.io.poses import parse_pose

if TYPE_CHECKING:
    from collections.abc import Callable

R, T, S = random_rotation(np.random.default_rng(1)), np.array([1.0, -2.0, 3.0]), 12.5
MOTION = Similarity.of_pose(Pose.from_matrix(np.column_stack([R, T])), S)
MATRIX = MOTION.as_matrix()
POINTS = np.random.default_rng(2).normal(size=(6, 3))


class Tool(SimpleNamespace):
    """An object of another program with some attributes."""


FORMS: dict[str, Callable[[], Any]] = {
    "Similarity": lambda: MOTION,
    "what has a Similarity": lambda: Tool(pose=MOTION),
    "4x4 of Open3D": lambda: MATRIX,
    "params of scikit-image": lambda: Tool(params=MATRIX, scale=S, rotation=R),
    "matrix() of Sophus": lambda: Tool(matrix=lambda: MATRIX),
    "(R, t, s) of evo": lambda: (R, T, S),
    "[R, t, s] of lists": lambda: [R.tolist(), T.tolist(), S],
    "(q, t, s)": lambda: (MOTION.quaternion_wxyz, T, np.float64(S)),
}


@pytest.mark.parametrize("name", FORMS)
def test_a_similarity_of_any_form_moves_points_and_its_scale_is_told_apart(name: str):
    given = given_pose(FORMS[name]())
    apart, within = given.scaled_apart(), given.scaled_within()

    assert apart.scale == pytest.approx(S, rel=1e-14)
    assert np.abs(apart.rotation - R).max() < 1e-14
    assert within.scale is None
    assert np.abs(within.turn - S * R).max() < 1e-13
    assert given.translation is not None
    for one in (given, apart, within):
        assert np.allclose(one.apply(POINTS), MOTION.apply(POINTS), rtol=1e-13)


@pytest.mark.parametrize("scale", [1e-150, 1.0, 1e150])
def test_a_rotation_has_scale_1_whatever_it_is_written_as(scale: float):
    for given in (given_pose((R, T)), given_pose((MOTION.quaternion_wxyz, T))):
        assert given.scaled_apart().scale == pytest.approx(1.0, rel=1e-15)
        assert given.scaled_within().turn is given.turn
    assert given_pose(scale * R).scaled_apart().scale == pytest.approx(scale, rel=1e-14)


def test_three_rows_are_a_matrix_and_no_scale():
    given = given_pose(MATRIX[:3].tolist())

    assert given.scale is None
    assert np.array_equal(given.turn, MATRIX[:3, :3])


@pytest.mark.parametrize("scale", [0.0, -2.0, np.nan, np.inf])
def test_a_scale_that_is_not_above_0_is_refused(scale: float):
    with pytest.raises(InvalidProblemError, match="finite and > 0"):
        given_pose((R, T, scale))


def stated(**fields: Any) -> io.BytesIO:
    return io.BytesIO(json.dumps(fields).encode())


def test_json_may_hold_a_scale_beside_the_rotation():
    fields: dict[str, Any] = {"rotation": R.tolist(), "translation": T.tolist()}
    scaled = {**fields, "quaternion_wxyz": MOTION.quaternion_wxyz.tolist(), "scale": S}
    for content in (stated(**fields, scale=S), stated(**scaled), stated(pose=scaled)):
        given = parse_pose(content, Path("pose.json"))
        assert given.scale == S
        assert np.allclose(given.apply(POINTS), MOTION.apply(POINTS), rtol=1e-13)
    assert parse_pose(stated(**fields, scale=None), Path("pose.json")).scale is None
    assert parse_pose(stated(**fields), Path("pose.json")).scale is None


@pytest.mark.parametrize("scale", ["large", [2.0], 0.0, -1.0, {}])
def test_a_scale_in_json_is_one_number_above_0(scale: Any):
    fields: dict[str, Any] = {"rotation": R.tolist(), "translation": T.tolist(), "scale": scale}
    with pytest.raises(InvalidFileError, match=r"pose\.json: scale"):
        parse_pose(stated(**fields), Path("pose.json"))
