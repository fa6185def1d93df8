"""A pose is judged as any tool returns it, by what it is like; the tool is never imported."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import scipy.spatial.transform as scipy_transform
from strategies import random_problem

import certreg
from certreg import Pose, Registration, assess
from certreg.errors import InvalidProblemError
from certreg.geometry.given import given_pose
from certreg.results import PoseVerdict

if TYPE_CHECKING:
    from collections.abc import Callable

PROBLEM = random_problem(np.random.default_rng(11), n=8)
RESULT = certreg.certify(PROBLEM, relaxation=False, simulation=False)
POSE = RESULT.pose
MATRIX = POSE.as_matrix()
R, T, Q = POSE.rotation, POSE.translation, POSE.quaternion_wxyz


class Tool(SimpleNamespace):
    """An object of another program with some attributes."""


WHOLE: dict[str, Callable[[], Any]] = {
    "4x4": lambda: MATRIX,
    "4x4 in lists": MATRIX.tolist,
    "4x4 of fractions": lambda: [[Fraction(entry) for entry in row] for row in MATRIX.tolist()],
    "3x4": lambda: MATRIX[:3],
    "(R, t)": lambda: (R, T),
    "[R, t]": lambda: [R.tolist(), T.tolist()],
    "(R, column)": lambda: (R, T[:, None]),
    "(q, t)": lambda: (Q, T),
    "SciPy's Rotation and t": lambda: (POSE.as_scipy(), T),
    "T_target_source": lambda: Tool(T_target_source=MATRIX),
    "transformation of Open3D": lambda: Tool(transformation=MATRIX, fitness=1.0),
    "as_matrix()": lambda: Tool(as_matrix=lambda: MATRIX),
    "matrix() of Sophus and GTSAM": lambda: Tool(matrix=lambda: MATRIX),
    "matrix() 3x4 of pycolmap": lambda: Tool(matrix=lambda: MATRIX[:3]),
    "matrix": lambda: Tool(matrix=MATRIX),
    "rotation and translation of KISS-Matcher": lambda: Tool(rotation=R, translation=T, valid=True),
    "rotation and translation in lists": lambda: Tool(rotation=R.tolist(), translation=T.tolist()),
    "Pose": lambda: POSE,
    "Registration": lambda: RESULT,
    "what has a Pose": lambda: Tool(pose=POSE),
}
if hasattr(scipy_transform, "RigidTransform"):
    WHOLE["SciPy's RigidTransform"] = lambda: scipy_transform.RigidTransform.from_matrix(MATRIX)
ALONE: dict[str, Callable[[], Any]] = {
    "3x3": lambda: R,
    "quaternion": lambda: Q,
    "SciPy's Rotation": POSE.as_scipy,
    "matrix() of a rotation": lambda: Tool(matrix=lambda: R),
    "(R, None)": lambda: (R, None),
}


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", WHOLE)
def test_a_pose_of_any_form_is_judged(name: str):
    found = assess(PROBLEM, WHOLE[name]())

    assert found.verdict in {PoseVerdict.OPTIMAL, PoseVerdict.NEAR_OPTIMAL}
    assert "Only a rotation" not in found.words
    assert found.slip is None
    assert found.rmse == pytest.approx(found.optimum_rmse)


@pytest.mark.parametrize("name", ALONE)
def test_a_rotation_alone_has_its_best_translation_and_it_is_said(name: str):
    found = assess(PROBLEM, ALONE[name]())

    assert found.verdict is PoseVerdict.OPTIMAL
    assert found.words.endswith("it was judged with the best translation for it.")
    given = assess(PROBLEM, ALONE[name](), T)
    assert given.verdict is PoseVerdict.OPTIMAL
    assert "Only a rotation" not in given.words


def test_a_rotation_alone_is_judged_by_its_rotation_only():
    turned = Pose.from_matrix(np.column_stack([np.diag([1.0, -1, -1]), np.zeros(3)]))
    alone, best = assess(PROBLEM, turned.rotation), RESULT.solution.objective
    q = (0, 1, 0, 0)

    assert alone.objective == pytest.approx(float(best.energy(q)), rel=1e-14)
    assert alone.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM


I4 = np.eye(4)
REFUSED: dict[str, tuple[Any, str]] = {
    "2x2": (np.eye(2), r"pose has shape \(2, 2\): give a matrix \(4, 4\)"),
    "a vector": (np.zeros(7), r"pose has shape \(7,\): give"),
    "a stack": (np.stack([I4] * 3), "a stack of 3 poses: give one of them"),
    "a stack of SciPy": (
        scipy_transform.Rotation.from_quat([[0, 0, 0, 1.0]] * 2),
        r"pose.as_matrix has shape \(2, 3, 3\): a stack of 2",
    ),
    "its last row": (np.diag([1.0, 1, 1, 2]), "last row of the pose matrix must be 0 0 0 1"),
    "by columns": (I4 + np.eye(4, k=-3), "found 1 0 0 1: transpose it"),
    "NaN": (np.where(I4 == 1, np.nan, 0)[:3], r"pose, row 0 .* all must be finite numbers"),
    "NaN of a rotation": (np.full((3, 3), np.nan), "rotation must be finite numbers"),
    "NaN of a translation": ((R, [0, np.inf, 0]), "translation must be finite numbers"),
    "a short translation": ((R, np.zeros(2)), r"translation must be \(3,\) finite numbers"),
    "complex numbers": (I4 * 1j, "pose has entries of type complex128"),
    "words": (
        "pose.txt",
        r"pose is a path or a text, pose\.txt: give what is in the file, .*np\.loadtxt",
    ),
    "nothing": (None, "pose is of type NoneType: give a matrix"),
    "an object of no numbers": (object(), r"pose is of type object: give a matrix \(4, 4\)"),
    "an object with parts of no numbers": (
        SimpleNamespace(rotation=object(), translation=T),
        "pose is of type object: give a matrix",
    ),
    "a class": (Pose, "pose is of type type: give a matrix"),
    "another object": (Tool(scale=2.0), "pose is of type Tool: give a matrix"),
    "two translations": ((MATRIX, T), "a translation of its own: give no other"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_pose_is_one_clear_error(name: str):
    given, words = REFUSED[name]
    with pytest.raises(InvalidProblemError, match=words) as caught:
        assess(PROBLEM, given)

    assert caught.value.array is not None
    assert str(caught.value).isprintable()


def test_a_problem_and_a_pose_the_other_way_round_are_told():
    with pytest.raises(InvalidProblemError, match="found the two the other way round"):
        assess(MATRIX, PROBLEM)  # type: ignore[arg-type]
    with pytest.raises(InvalidProblemError, match="that comes first, and then the pose"):
        assess(PROBLEM, PROBLEM)


def test_a_pose_with_a_translation_takes_no_other():
    with pytest.raises(InvalidProblemError, match="give no other beside it"):
        assess(PROBLEM, RESULT, T)


def test_own_poses_are_judged_by_their_quaternions_exactly():
    given = given_pose(RESULT)

    assert given.turn is POSE.quaternion_wxyz
    assert np.allclose(given.rotation, R, atol=1e-15)
    assert isinstance(RESULT, Registration)
    moved = given_pose(R).apply(PROBLEM.source) - PROBLEM.source @ R.T
    assert not moved.any()


def test_clouds_in_the_place_of_the_problem_are_told_what_to_write():
    remedy = r"assess\(RegistrationProblem\(source, target\), pose\)"
    with pytest.raises(InvalidProblemError, match=remedy):
        assess(np.eye(3), np.eye(4))
