"""Poses and similarities are groups that act on points, and SciPy has the same rigid motions."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.spatial.transform as scipy_transform
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import random_rotation

from certreg import Pose, Similarity
from certreg.errors import InvalidProblemError, OutOfRangeError
from certreg.geometry import so3
from certreg.geometry.given import given_pose
from certreg.geometry.pose_matrix import why_no_rotation
from certreg.geometry.similarity import split_scale
from certreg.geometry.so3 import (
    canonical,
    davenport_matrices,
    davenport_matrix,
    is_reflection,
    quaternions_from_matrices,
    rotation_matrices,
    rotation_matrix,
)

FEW = settings(max_examples=30, deadline=None)
LAST = [[0.0, 0.0, 0.0, 1.0]]
SEEDS = st.integers(0, 2**32 - 1)


def random_pose(rng: np.random.Generator) -> Pose:
    return Pose.from_matrix(np.column_stack([random_rotation(rng), rng.normal(size=3)]))


def is_close(a: Pose, b: Pose, within: float = 1e-14) -> bool:
    """Both representations of the rotation, and the translation."""
    same = np.abs(a.as_matrix() - b.as_matrix()).max() <= within
    q = min(np.abs(a.quaternion_wxyz - s * b.quaternion_wxyz).max() for s in (1, -1))
    return bool(same and q <= within)


def is_whole(pose: Pose) -> bool:
    """Unit quaternion of canonical sign, and the rotation is that of the quaternion."""
    q = pose.quaternion_wxyz
    R = scipy_transform.Rotation.from_quat(q, scalar_first=True).as_matrix()
    first = q[np.flatnonzero(q)[0]]
    unit = abs(np.linalg.norm(q) - 1.0) < 1e-15
    return bool(unit and first > 0.0 and np.abs(pose.rotation - R).max() < 1e-15 * 8)


@pytest.mark.slow
@FEW
@given(SEEDS)
def test_poses_obey_the_laws_of_a_group(seed: int):
    rng = np.random.default_rng(seed)
    a, b, c = (random_pose(rng) for _ in range(3))
    identity = Pose.from_matrix(np.eye(4))

    assert is_close((a @ b) @ c, a @ (b @ c))
    assert is_close(a @ identity, a)
    assert is_close(identity @ a, a)
    assert is_close(a @ a.inverse(), identity)
    assert is_close(a.inverse() @ a, identity)
    assert is_close((a @ b).inverse(), b.inverse() @ a.inverse())
    assert is_close(a.inverse().inverse(), a)
    assert all(map(is_whole, (a, a @ b, a.inverse())))


@pytest.mark.slow
@FEW
@given(SEEDS)
def test_composing_is_multiplying_matrices_and_moving_twice(seed: int):
    rng = np.random.default_rng(seed)
    a, b, points = random_pose(rng), random_pose(rng), rng.normal(size=(5, 3))

    assert np.allclose((a @ b).as_matrix(), a.as_matrix() @ b.as_matrix(), atol=1e-14)
    assert np.allclose((a @ b) @ points, a @ (b @ points), atol=1e-13)
    assert np.allclose(a.inverse() @ (a @ points), points, atol=1e-13)
    assert np.array_equal(a @ points, a.apply(points))
    assert np.allclose(a @ points[0], (a @ points)[0], rtol=1e-14)
    rows = np.column_stack([points, np.ones(5)]) @ a.as_matrix().T
    assert np.allclose(rows[:, :3], a @ points, atol=1e-14)


@pytest.mark.slow
@pytest.mark.skipif(
    not hasattr(scipy_transform, "RigidTransform"), reason="SciPy before 1.16 has none"
)
@FEW
@given(SEEDS)
def test_scipys_rigid_transforms_are_the_same_group(seed: int):
    rng = np.random.default_rng(seed)
    a, b, points = random_pose(rng), random_pose(rng), rng.normal(size=(5, 3))
    A, B = (scipy_transform.RigidTransform.from_matrix(p.as_matrix()) for p in (a, b))

    assert np.allclose((a @ b).as_matrix(), (A * B).as_matrix(), atol=1e-14)
    assert np.allclose(a.inverse().as_matrix(), A.inv().as_matrix(), atol=1e-14)
    assert np.allclose(a @ points, A.apply(points), atol=1e-14)
    assert np.allclose(a.as_scipy().as_matrix(), a.rotation, atol=1e-15)


@pytest.mark.slow
def test_a_long_product_does_not_drift_from_the_rotations():
    rng = np.random.default_rng(5)
    step, product = random_pose(rng), Pose.from_matrix(np.eye(4))
    for _ in range(3000):
        product = step @ product

    assert is_whole(product)
    assert np.abs(product.rotation.T @ product.rotation - np.eye(3)).max() < 1e-15


def test_a_pose_has_the_scale_of_the_similarity_that_it_is():
    pose = random_pose(np.random.default_rng(3))

    assert pose.scale == Similarity.of_pose(pose).scale == 1.0
    assert "scale" not in repr(pose)


def test_a_matrix_goes_in_and_out_unchanged():
    pose = random_pose(np.random.default_rng(6))

    for matrix in (pose.as_matrix(), pose.as_matrix()[:3], pose.as_matrix().tolist()):
        assert np.array_equal(Pose.from_matrix(matrix).as_matrix(), pose.as_matrix())
    assert np.array_equal(pose.T_target_source, pose.as_matrix())
    assert np.array_equal(pose.inverse().rotation, pose.rotation.T)


def test_a_pose_shares_no_memory_with_what_it_was_made_of():
    matrix = random_pose(np.random.default_rng(6)).as_matrix()
    pose = Pose.from_matrix(matrix)
    back = pose.inverse()
    kept = matrix.copy()
    matrix[:] = 0.0
    pose.rotation[:] = pose.rotation  # writable: whoever does it changes this pose alone

    assert np.array_equal(pose.as_matrix(), kept)
    assert not np.shares_memory(pose.rotation, back.rotation)


def test_no_entry_of_a_pose_is_minus_zero_where_zeros_are_turned():
    turn = Pose.from_matrix(np.diag([1.0, -1, -1, 1]))
    for pose in (turn.inverse(), turn @ turn, turn @ turn.inverse()):
        assert not np.signbit(pose.translation).any()
        assert not np.signbit(pose.quaternion_wxyz[pose.quaternion_wxyz == 0.0]).any()


@pytest.mark.parametrize("axis", np.vstack([np.eye(3), [[0.0, 0.6, -0.8], [0.0, -0.6, 0.8]]]))
def test_the_inverse_of_a_half_turn_is_the_same_half_turn(axis):
    turn = Pose.from_matrix(np.column_stack([2.0 * np.outer(axis, axis) - np.eye(3), np.zeros(3)]))
    back = turn.inverse().quaternion_wxyz

    assert np.allclose(back, turn.quaternion_wxyz, atol=1e-15)
    assert back[np.flatnonzero(back)[0]] > 0.0
    many = quaternions_from_matrices(turn.rotation[None])
    for q in (canonical(np.array([-0.0, *-axis])), many[0]):
        assert np.allclose(np.abs(q[1:]), np.abs(axis))
        assert not np.signbit(q[q == 0.0]).any()


@pytest.mark.parametrize("tiny", [1e-3, 1e-12, 5e-324])
@pytest.mark.parametrize("place", range(3))
def test_the_first_entry_that_is_not_zero_is_positive_however_small(tiny: float, place: int):
    q = np.full(4, 0.5) * (np.arange(4) > place)
    q[place] = -tiny

    assert np.array_equal(canonical(q), -q)
    assert np.array_equal(canonical(-q), -q)


def test_many_quaternions_have_the_sign_of_each_alone():
    turns = [np.diag(d) for d in ([1.0, -1, -1], [-1.0, 1, -1], [-1.0, -1, 1], [1.0, 1, 1])]
    turns += [random_rotation(np.random.default_rng(k)) for k in range(20)]
    for turn, q in zip(turns, quaternions_from_matrices(np.array(turns)), strict=True):
        assert np.array_equal(
            q, Pose.from_matrix(np.column_stack([turn, np.ones(3)])).quaternion_wxyz
        )
        assert q[np.flatnonzero(q)[0]] > 0.0


@pytest.mark.parametrize(("off", "words"), [(0.09, "Give more digits"), (0.11, "another matrix")])
def test_a_matrix_that_is_not_orthogonal_is_rounded_or_another_one(off: float, words: str):
    """R^T R is off by a tenth at most where two decimals were printed."""
    assert words in str(why_no_rotation(np.diag([np.sqrt(1.0 + off), 1.0, 1.0])))


def test_a_quaternion_too_short_is_no_rotation_as_one_too_long_is_none():
    q = np.array([0.0, 0.6, 0.0, -0.8])
    refused = [why_no_rotation(length * q) is not None for length in (0.9998, 0.99991, 1.0002)]

    assert refused == [True, False, True]


def test_a_translation_of_zero_is_one_of_its_own_too():
    with pytest.raises(InvalidProblemError, match="give no other beside it"):
        given_pose(np.eye(4), [1.0, 2.0, 3.0])


def test_a_pair_may_be_a_list_and_a_translation_a_column_or_a_row():
    for shift in ([1.0, 2.0, 3.0], [[1.0], [2.0], [3.0]], [[1.0, 2.0, 3.0]]):
        for pair in ((np.eye(3), shift), [np.eye(3), shift]):
            given = given_pose(pair)

            assert given.translation is not None
            assert given.translation.tolist() == [1.0, 2.0, 3.0]


def test_five_decimals_are_a_rotation_and_four_are_not():
    matrix = random_pose(np.random.default_rng(7)).as_matrix()
    printed = Pose.from_matrix(np.round(matrix, 5))

    assert is_whole(printed)
    assert 1e-7 < np.abs(printed.rotation - matrix[:3, :3]).max() < 1e-5
    matrix[0, 0] += 1.01e-3
    with pytest.raises(InvalidProblemError, match=r"matrix: .*\(R\^T R is off by 0\.00"):
        Pose.from_matrix(matrix)


I4 = np.eye(4)
WRONG_MATRICES = {
    "a rotation alone": (np.eye(3), r"found shape \(3, 3\): give \[R \| t\]"),
    "a stack": (np.stack([I4, I4]), r"found shape \(2, 4, 4\): a stack of 2: give one of them"),
    "a column of vectors": (np.vstack([I4[:3], [[1.0, 2, 3, 1]]]).round(), "transpose it"),
    "its last row": (np.diag([1.0, 1, 1, 2]), r"must be 0 0 0 1, found 0 0 0 2: give the 3x4"),
    "a reflection": (np.diag([1.0, 1, -1, 1]), r"a reflection \(determinant -1\)"),
    "a scale": (np.diag([2.0, 2, 2, 1]), "scales by 2"),
    "a shear": (np.eye(4) + np.eye(4, k=1) * [[1], [0], [0], [0]], "not orthogonal"),
    "a gap": (np.where(np.eye(4, k=3), np.nan, I4), r"matrix, row 0 \(counting from 0\) is .*nan"),
    "complex numbers": (I4 * 1j, "entries of type complex128: give real numbers"),
    "words": ("pose.txt", "entries of type <U8: give real numbers"),
    "ragged rows": ([[1.0], [1.0, 2.0]], "matrix is not an array of real numbers"),
}


@pytest.mark.parametrize("name", WRONG_MATRICES)
def test_what_is_no_pose_is_refused_with_the_reason(name: str):
    matrix, words = WRONG_MATRICES[name]
    with pytest.raises(InvalidProblemError, match=words) as caught:
        Pose.from_matrix(matrix)  # type: ignore[arg-type]

    assert caught.value.array == "matrix"
    assert str(caught.value).isprintable()


def test_points_of_another_shape_are_refused():
    pose = random_pose(np.random.default_rng(8))
    for points in (np.zeros((3, 4)), np.zeros(4), np.zeros((1, 2, 3)), 1.0, np.zeros((4, 4))):
        with pytest.raises(InvalidProblemError, match=r"points must be \(N, 3\)"):
            pose @ points  # type: ignore[operator]
    with pytest.raises(TypeError):
        np.zeros((5, 3)) @ pose  # type: ignore[operator]


def test_a_translation_beyond_the_doubles_is_said():
    matrix = np.eye(4)
    matrix[:3, :3] = random_rotation(np.random.default_rng(9))
    matrix[:3, 3] = 1.7e308
    pose = Pose.from_matrix(matrix)

    for beyond in (lambda: pose @ pose, lambda: Pose.from_matrix(matrix).inverse()):
        with pytest.raises(OutOfRangeError, match="change the unit"):
            beyond()


@pytest.mark.parametrize("length", [1e-160, 0.99991, 1.00005, 3.0, 1e200])
def test_a_quaternion_of_any_length_turns_and_does_not_stretch(length: float):
    rng = np.random.default_rng(7)
    points, shift = rng.normal(size=(5, 3)), np.array([1.0, 2.0, 3.0])
    for q in rng.normal(size=(5, 4)):
        turn = scipy_transform.Rotation.from_quat(q, scalar_first=True)
        pose = given_pose((length * q / np.linalg.norm(q), shift))

        assert np.abs(pose.rotation - turn.as_matrix()).max() < 1e-14
        assert np.abs(pose.apply(points) - turn.apply(points) - shift).max() < 1e-14


SCALES = (1e-160, 1e-5, 0.5, 2.0, 1e3, 1e8)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize(("sign", "reflects"), [(1.0, ""), (-1.0, " and reflects")])
def test_why_a_matrix_is_no_rotation_does_not_depend_on_its_unit(
    scale: float, sign: float, reflects: str
):
    """Stretches are compared with each other, just inside and just outside of the tolerance."""
    R = random_rotation(np.random.default_rng(5))

    def why(stretch: float, **tolerance: float) -> str:
        return why_no_rotation(scale * R @ np.diag([1.0, sign * stretch, 1.0]), **tolerance) or ""

    assert why(1.0).startswith(f"The matrix scales by {scale:.6g}{reflects}: it is not a rotation.")
    for stretch in (1.0 + 0.99e-4, 1.0 / (1.0 + 0.99e-4)):
        assert why(stretch).startswith("The matrix scales by ")
    for stretch in (1.0 + 1.01e-4, 1.0 / (1.0 + 1.01e-4), 2.0, 1e-6):
        assert why(stretch).startswith("The matrix is not orthogonal ")
    assert why(1.0019, tolerance=2e-3).startswith("The matrix scales by ")
    assert why(1.0021, tolerance=2e-3).startswith("The matrix is not orthogonal ")


def test_a_scale_is_named_whatever_digits_are_printed():
    R = random_rotation(np.random.default_rng(6))

    assert "scales by 1000:" in str(why_no_rotation(np.round(1000.0 * R, 3)))
    assert "scales by 1e-05:" in str(why_no_rotation(np.round(1e-5 * R, 10)))


@pytest.mark.slow
def test_digits_that_are_not_printed_are_no_scale():
    """Of 2,000 rotations with four decimals; dividing a scale out leaves a rotation."""
    rng, refused = np.random.default_rng(11), 0
    for _ in range(2000):
        why = why_no_rotation(np.round(random_rotation(rng), 4))
        refused += why is not None
        assert why is None or why.startswith("The matrix is not orthogonal ")
    assert refused

    still = np.eye(3)
    assert "not orthogonal" in str(why_no_rotation((1.0 + 0.99e-4) * still))
    for scale in (1.0 + 1.01e-4, 1.0 - 1.01e-4):
        assert f"scales by {scale:.6g}:" in str(why_no_rotation(scale * still))
        assert why_no_rotation(scale * still / float(f"{scale:.6g}")) is None


@pytest.mark.parametrize("count", [0, 1, so3.FEW - 1, so3.FEW, 3 * so3.FEW])
def test_matrices_of_many_quaternions_are_to_the_bit_those_of_each(count: int):
    quaternions = np.random.default_rng(count).normal(size=(count, 4))
    single = np.array([rotation_matrix(q) for q in quaternions.tolist()]).reshape(count, 3, 3)

    assert rotation_matrices(quaternions).tobytes() == single.tobytes()


@pytest.mark.parametrize("count", [0, 1, so3.FEW - 1, so3.FEW, 3 * so3.FEW])
def test_davenports_matrices_of_many_are_to_the_bit_those_of_each(count: int):
    matrices = np.random.default_rng(count).normal(size=(count, 3, 3))
    single = np.array([davenport_matrix(C) for C in matrices.tolist()]).reshape(count, 4, 4)

    assert davenport_matrices(matrices).tobytes() == single.tobytes()


def test_a_reflection_is_told_from_a_rotation_by_its_sign():
    rng = np.random.default_rng(2)
    for turn in rotation_matrices(rng.normal(size=(20, 4))):
        unit = turn / np.cbrt(np.linalg.det(turn))
        assert not is_reflection(unit)
        assert is_reflection(-unit)
        assert is_reflection(unit * [1.0, -1.0, 1.0])


def random_similarity(rng: np.random.Generator) -> Similarity:
    return Similarity.of_pose(random_pose(rng), math.exp(rng.normal()))


def is_near(a: Similarity, b: Similarity, within: float = 1e-13) -> bool:
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

    assert is_near((a @ b) @ c, a @ (b @ c))
    assert is_near(a @ identity, a)
    assert is_near(identity @ a, a)
    assert np.abs((a @ a.inverse()).as_matrix() - I4).max() < 1e-13 * (1 + a.scale)
    assert np.abs((a.inverse() @ a).as_matrix() - I4).max() < 1e-13 * (1 + 1 / a.scale)
    assert is_near((a @ b).inverse(), b.inverse() @ a.inverse(), 1e-12)
    assert is_near(a.inverse().inverse(), a)


@pytest.mark.slow
@FEW
@given(SEEDS)
def test_composing_similarities_is_multiplying_matrices(seed: int):
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

    assert is_near(rigid @ a, Similarity.of_pose(rigid) @ a)
    assert is_near(a @ rigid, a @ Similarity.of_pose(rigid))
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


NO_SIMILARITIES = {
    "a reflection": (linear(np.diag([2.0, 2, -2])), r"a reflection \(determinant -1\)"),
    "zeros": (linear(np.zeros((3, 3))), "scale 0 has no rotation to read"),
    "a shear": (linear([[2, 1, 0], [0, 2, 0], [0, 0, 2]]), "not orthogonal"),
    "two scales": (linear(np.diag([2.0, 2, 3])), "not orthogonal"),
    "a rotation alone": (np.eye(3), r"found shape \(3, 3\)"),
    "its last row": (np.diag([2.0, 2, 2, 2]), "must be 0 0 0 1"),
    "a gap": (linear(np.diag([np.nan, 1, 1])), "finite"),
}


@pytest.mark.parametrize("name", NO_SIMILARITIES)
def test_what_is_no_similarity_is_refused_with_the_reason(name: str):
    matrix, words = NO_SIMILARITIES[name]
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
