"""Similarities are a group that acts on points, and poses are those of scale 1."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import random_rotation

from certreg import Pose, Similarity
from certreg.errors import InvalidProblemError, OutOfRangeError
from certreg.geometry.similarity import split_scale

FEW = settings(max_examples=30, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)
I4 = np.eye(4)


def random_pose(rng: np.random.Generator) -> Pose:
    return Pose.from_matrix(np.column_stack([random_rotation(rng), rng.normal(size=3)]))


def random_similarity(rng: np.random.Generator) -> Similarity:
    return Similarity.of_pose(random_pose(rng), math.exp(rng.normal()))


def is_close(a: Similarity, b: Similarity, within: float = 1e-13) -> bool:
    size = np.abs(a.as_matrix()).max()
    q = min(np.abs(a.quaternion_wxyz - s * b.quaternion_wxyz).max() for s in (1, -1))
    same = np.abs(a.as_matrix() - b.as_matrix()).max() <= within * size
    return bool(same and q <= within and math.isclose(a.scale, b.scale, rel_tol=within))


@pytest.mark.slow
@FEW
@given(SEEDS)
def test_similarities_obey_the_laws_of_a_group(seed: int):
    rng = np.random.default_rng(seed)
    a, b, c = (random_similarity(rng) for _ in range(3))
    identity = Similarity.from_matrix(I4)

    assert is_close((a @ b) @ c, a @ (b @ c))
    assert is_close(a @ identity, a)
    assert is_close(identity @ a, a)
    assert np.abs((a @ a.inverse()).as_matrix() - I4).max() < 1e-13 * (1 + a.scale)
    assert np.abs((a.inverse() @ a).as_matrix() - I4).max() < 1e-13 * (1 + 1 / a.scale)
    assert is_close((a @ b).inverse(), b.inverse() @ a.inverse(), 1e-12)
    assert is_close(a.inverse().inverse(), a)


@pytest.mark.slow
@FEW
@given(SEEDS)
def test_composing_is_multiplying_matrices_and_moving_twice(seed: int):
    rng = np.random.default_rng(seed)
    a, b, points = random_similarity(rng), random_similarity(rng), rng.normal(size=(5, 3))
    size = 10.0 * (1 + a.scale) * (1 + b.scale)

    assert np.allclose((a @ b).as_matrix(), a.as_matrix() @ b.as_matrix(), atol=1e-14 * size)
    assert np.allclose((a @ b) @ points, a @ (b @ points), atol=1e-14 * size)
    assert np.array_equal(a @ points, a.apply(points))
    assert np.allclose(a @ points, a.scale * points @ a.rotation.T + a.translation, rtol=1e-13)
    rows = np.column_stack([points, np.ones(5)]) @ a.as_matrix().T
    assert np.allclose(rows[:, :3], a @ points, atol=1e-14 * size)
    assert np.allclose(a @ points[0], (a @ points)[0], rtol=1e-13)


@pytest.mark.slow
@FEW
@given(SEEDS)
def test_a_pose_composes_with_a_similarity_on_either_side_as_one_of_scale_1(seed: int):
    rng = np.random.default_rng(seed)
    rigid, a = random_pose(rng), random_similarity(rng)

    assert is_close(rigid @ a, Similarity.of_pose(rigid) @ a)
    assert is_close(a @ rigid, a @ Similarity.of_pose(rigid))
    assert (rigid @ a).scale == (a @ rigid).scale == a.scale
    assert np.array_equal(Similarity.of_pose(rigid).as_matrix(), rigid.as_matrix())
    assert np.array_equal(a.as_scipy().as_matrix(), Pose.as_scipy(rigid_of(a)).as_matrix())


def rigid_of(a: Similarity) -> Pose:
    return Pose(rotation=a.rotation, translation=a.translation, quaternion_wxyz=a.quaternion_wxyz)


@pytest.mark.parametrize("scale", [1e-300, 1e-160, 1e-8, 0.3048, 1.0, 1000.0, 1e8, 1e160, 1e300])
def test_a_matrix_gives_back_scale_and_rotation_at_every_size(scale: float):
    for seed in range(20):
        pose = random_pose(np.random.default_rng(seed))
        back = Similarity.from_matrix(Similarity.of_pose(pose, scale).as_matrix())

        assert math.isclose(back.scale, scale, rel_tol=2e-15)  # singular values in doubles
        assert np.abs(back.rotation - pose.rotation).max() < 1e-15
        assert np.array_equal(back.translation, pose.translation)
        assert abs(np.linalg.norm(back.quaternion_wxyz) - 1.0) < 1e-15
    assert np.array_equal(back.T_target_source, back.as_matrix())


def test_the_scale_of_printed_digits_is_the_nearest_to_the_matrix():
    """No scale beside it is nearer: the distance to s R is a parabola in s."""
    R, rng = random_rotation(np.random.default_rng(3)), np.random.default_rng(4)
    matrix = 3.0 * R + 1e-4 * rng.normal(size=(3, 3))
    scale, near = split_scale(matrix)
    u, _, vt = np.linalg.svd(matrix)

    def distance(s: float) -> float:
        return float(np.linalg.norm(matrix - s * (u @ vt)))

    assert distance(scale) < min(distance(scale + 1e-6), distance(scale - 1e-6))
    assert np.allclose(near * scale, matrix, rtol=1e-15)
    printed = Similarity.from_matrix(np.column_stack([np.round(1000.0 * R, 2), np.zeros(3)]))
    assert math.isclose(printed.scale, 1000.0, rel_tol=1e-5)
    assert np.abs(printed.rotation.T @ printed.rotation - np.eye(3)).max() < 1e-15


def linear(matrix: list[list[float]] | np.ndarray) -> np.ndarray:
    return np.column_stack([np.array(matrix, dtype=float), np.ones(3)])


WRONG_MATRICES = {
    "a reflection": (linear(np.diag([2.0, 2, -2])), r"a reflection \(determinant -1\)"),
    "zeros": (linear(np.zeros((3, 3))), "scale 0 has no rotation to read"),
    "a shear": (linear([[2, 1, 0], [0, 2, 0], [0, 0, 2]]), "not orthogonal"),
    "two scales": (linear(np.diag([2.0, 2, 3])), "not orthogonal"),
    "a rotation alone": (np.eye(3), r"found shape \(3, 3\)"),
    "its last row": (np.diag([2.0, 2, 2, 2]), "must be 0 0 0 1"),
    "a gap": (linear(np.diag([np.nan, 1, 1])), "finite"),
}


@pytest.mark.parametrize("name", WRONG_MATRICES)
def test_what_is_no_similarity_is_refused_with_the_reason(name: str):
    matrix, words = WRONG_MATRICES[name]
    with pytest.raises(InvalidProblemError, match=words) as caught:
        Similarity.from_matrix(matrix)

    assert caught.value.array == "matrix"
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("scale", [-1.0, math.nan, math.inf])
def test_a_scale_that_is_negative_or_not_finite_is_refused(scale: float):
    with pytest.raises(InvalidProblemError, match="a finite one, >= 0"):
        Similarity.of_pose(Pose.from_matrix(I4), scale)


def test_scale_0_puts_every_point_at_one_place_and_has_no_inverse():
    point = Similarity.of_pose(Pose.from_matrix(I4 + np.eye(4, k=3) * 7), 0.0)

    assert (point @ np.random.default_rng(1).normal(size=(4, 3))).tolist() == [[7, 0, 0]] * 4
    assert (point @ point).scale == 0.0
    with pytest.raises(OutOfRangeError, match="no inverse"):
        point.inverse()


def test_what_leaves_the_doubles_is_said():
    large = Similarity.of_pose(Pose.from_matrix(I4 + np.eye(4, k=3)), 1e200)
    tiny = Similarity.of_pose(Pose.from_matrix(I4), 1e-200)
    subnormal = Similarity.of_pose(Pose.from_matrix(I4), 5e-324)
    far = Similarity.of_pose(Pose.from_matrix(I4 + np.eye(4, k=3) * 1e200), 1e-180)
    beyond = {
        "scale": [lambda: large @ large, lambda: tiny @ tiny, subnormal.inverse],
        "translation": [lambda: large @ far, far.inverse],
    }

    for name, attempts in beyond.items():
        for attempt in attempts:
            with pytest.raises(OutOfRangeError, match=f"{name} of the .* change the unit"):
                attempt()
    assert (large @ tiny).scale == 1.0


def test_points_stand_on_the_right_and_have_three_columns():
    motion = random_similarity(np.random.default_rng(8))
    for points in (np.zeros((3, 4)), np.zeros(4), np.zeros((1, 2, 3)), 1.0):
        with pytest.raises(InvalidProblemError, match=r"points must be \(N, 3\)"):
            motion.apply(points)
    for left in (np.zeros((5, 3)), [[1.0, 2.0, 3.0]]):
        with pytest.raises(TypeError):
            left @ motion  # type: ignore[operator]


def test_a_similarity_shows_itself_in_one_line_and_its_inverse_has_no_minus_zero():
    motion = Similarity.from_matrix(np.diag([1000.0, -1000.0, -1000.0, 1.0]))

    assert repr(motion).startswith("<Similarity: scale 1000, quaternion_wxyz (0, 1, 0, 0), ")
    assert len(repr(motion)) <= 200
    for each in (motion.inverse(), motion @ motion.inverse()):
        assert not np.signbit(each.translation).any()
