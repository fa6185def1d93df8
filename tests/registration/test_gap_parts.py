"""Where the scale is free a pose is judged as a similarity, and what its parts cost is exact."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from commands import checked
from strategies import random_rotation

import certreg
from certreg import Pose, RegistrationProblem, Similarity, assess
from certreg.certificate.bounds import ExactPose
from certreg.errors import InvalidProblemError
from certreg.geometry.given import given_pose
from certreg.objective.isotropic import Isotropic
from certreg.registration.gap_parts import gap_parts
from certreg.report.judged_pose import assessment_summary
from certreg.results import Optimality, PoseVerdict

SCALES = ("asymmetric", "symmetric")
TRUE = Similarity.of_pose(
    Pose.from_matrix(np.column_stack([random_rotation(np.random.default_rng(1)), [5.0, 6.0, 7.0]])),
    25.0,
)


def certified(scale: str, *, only: bool = False, noise: float = 0.3) -> Any:
    rng = np.random.default_rng(2)
    x = rng.normal(size=(9, 3)) * [1.0, 2.0, 3.0] + 4.0
    y = TRUE.apply(x) - TRUE.translation * only + noise * rng.normal(size=x.shape)
    problem = RegistrationProblem(x, y, scale=scale, rotation_only=only)
    return certreg.certify(problem, relaxation=False, simulation=False)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_clouds_that_fit_exactly_are_certified_with_an_energy_of_zero(scale: str, factor: float):
    for seed in range(3):
        x = np.random.default_rng(seed).normal(size=(12, 3)).round(3)
        found: Any = certreg.certify(x, factor * x, scale=scale, relaxation=False, simulation=False)

        assert found.status is Optimality.CERTIFIED
        assert found.equilibria.components[0].energy <= 1e-60
        assert np.isclose(found.pose.scale, factor, rtol=1e-15, atol=0.0)


@pytest.mark.parametrize("scale", SCALES)
def test_the_text_has_the_rmse_of_the_document_though_the_symmetric_objective_is_over_s(scale: str):
    judged = assess(certified(scale), TRUE)
    rows = [line.split() for line in assessment_summary(judged).splitlines()]
    text = [float(row[1]) for row in rows if row[:1] == ["RMSE"]]
    text += [float(row[3]) for row in rows if row[:3] == ["of", "the", "optimum"]][:1]

    assert text == pytest.approx([judged.rmse, judged.optimum_rmse], rel=1e-5)


def objective(result: Any, pose: Similarity) -> Fraction:
    """By its definition, in fractions, of the doubles of a pose."""
    scale, total = Fraction(pose.scale), Fraction(0)
    w, *v = map(Fraction, pose.quaternion_wxyz.tolist())
    norm = w * w + sum(k * k for k in v)
    x1, y1, z1 = v
    rows = (
        (w * w + x1 * x1 - y1 * y1 - z1 * z1, 2 * (x1 * y1 - w * z1), 2 * (x1 * z1 + w * y1)),
        (2 * (x1 * y1 + w * z1), w * w - x1 * x1 + y1 * y1 - z1 * z1, 2 * (y1 * z1 - w * x1)),
        (2 * (x1 * z1 - w * y1), 2 * (y1 * z1 + w * x1), w * w - x1 * x1 - y1 * y1 + z1 * z1),
    )
    shift = list(map(Fraction, pose.translation.tolist()))
    for x, y in zip(result.problem.source.tolist(), result.problem.target.tolist(), strict=True):
        for row, t, at in zip(rows, shift, y, strict=True):
            moved = scale * sum(r * Fraction(c) for r, c in zip(row, x, strict=True)) / norm + t
            total += (Fraction(at) - moved) ** 2
    return total / scale if result.problem.scale == "symmetric" else total


@pytest.mark.parametrize("scale", SCALES)
def test_the_parts_are_what_the_objective_rises_by_as_each_is_spoilt(scale: str):
    result = certified(scale)
    best = result.pose
    turn = Pose.from_matrix(
        np.column_stack([random_rotation(np.random.default_rng(3)), np.zeros(3)])
    )
    x, y = (c.mean(axis=0) for c in (result.problem.source, result.problem.target))
    turned = (turn @ best).rotation
    spoilt = {
        "scale": replace(
            best, scale=1.3 * best.scale, translation=y - 1.3 * best.scale * best.rotation @ x
        ),
        "translation": replace(best, translation=best.translation + 1.0),
        "rotation": (turned, None),
        "all": replace(turn @ best, scale=0.2),
    }
    least = objective(result, best)
    for name, pose in spoilt.items():
        found = assess(result, pose)
        assert found.gap_parts is not None
        parts = found.gap_parts
        total = parts.rotation + parts.scale + parts.translation
        if name != "rotation":
            above = objective(result, pose) - least  # type: ignore[arg-type]
            assert abs(total / above - 1) < Fraction(1, 10**9)
            assert found.gap_lower is not None
            assert Fraction(found.gap_lower) <= above <= Fraction(found.gap_upper or 0) * 2
        if name != "all":
            assert getattr(parts, name) > total * Fraction(999999, 1000000)
            assert (
                f"over 99.9 % from the {name}" in found.words
                or f"100 % from the {name}" in found.words
            )
        else:
            assert min(parts.rotation, parts.scale, parts.translation) > 0


def test_a_rigid_pose_beside_a_free_scale_and_a_scale_beside_a_rigid_problem_are_told():
    result, rigid = certified("asymmetric"), certified("none")
    pose = result.pose
    unscaled = assess(result, Pose.from_matrix(np.column_stack([pose.rotation, pose.translation])))

    assert unscaled.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM
    assert unscaled.words.endswith("It has no scale of its own and was judged with scale 1.")
    alone = assess(result, pose.rotation)
    assert alone.verdict is PoseVerdict.OPTIMAL
    assert alone.words.endswith("judged with the best scale and translation for it.")
    for each in (pose, pose.as_matrix()):
        refused = assess(rigid, each)
        assert refused.verdict is PoseVerdict.NOT_A_ROTATION
        assert f"scales by {pose.scale:.6g}" in refused.headline
        assert refused.gap_parts is None
    assert assess(rigid, Similarity.of_pose(rigid.pose, 1.0)).verdict is PoseVerdict.OPTIMAL
    assert assess(rigid, rigid.pose).gap_parts is None


@pytest.mark.parametrize("scale", ["none", *SCALES])
def test_a_problem_of_rotations_alone_has_no_translation_to_judge(scale: str):
    result = certified(scale, only=True)
    rotation = result.pose.rotation

    for pose in (rotation, np.asarray(result.pose.as_matrix()), result.pose):
        found = assess(result, pose)
        assert found.verdict is PoseVerdict.OPTIMAL
        assert "translation" not in found.words
    with pytest.raises(InvalidProblemError, match="the problem is of rotations alone"):
        assess(result, (rotation, [0.0, 0.0, 1e-9]))


@pytest.mark.parametrize("scale", SCALES)
def test_another_equilibrium_needs_its_own_scale(scale: str):
    """That of the second eigenline is its best one; a symmetric scale is never negative."""
    result = certified(scale)
    exact = result.solution.objective
    q = exact.quaternions[1]
    assert exact.alignment(q) > 0
    turn = np.array([float(entry) for entry in q])
    turn /= np.linalg.norm(turn)
    found = assess(result, turn)

    assert found.verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM
    assert found.nearest_index == 1
    own = float(exact.best_scale(q))
    R = Pose.from_matrix(np.column_stack([assess_rotation(turn), np.zeros(3)])).rotation
    x, y = (c.mean(axis=0) for c in (result.problem.source, result.problem.target))
    for factor, verdict in (
        (1.0, PoseVerdict.SPURIOUS_EQUILIBRIUM),
        (1.1, PoseVerdict.NOT_AN_EQUILIBRIUM),
    ):
        s = factor * own
        assert assess(result, (R, y - s * R @ x, s)).verdict is verdict
    opposite = np.array([float(entry) for entry in exact.quaternions[-1]])
    assert exact.alignment(exact.quaternions[-1]) < 0
    last = assess(result, opposite / np.linalg.norm(opposite)).verdict
    assert (last is PoseVerdict.SPURIOUS_EQUILIBRIUM) == (scale == "symmetric")


def assess_rotation(q: Any) -> Any:
    return given_pose(q).rotation


@pytest.mark.parametrize("gap", [Fraction(0), Fraction(1, 3)])
@pytest.mark.parametrize(("scale", "rotation"), [("symmetric", 16), ("asymmetric", 4)])
def test_what_each_part_of_a_pose_costs_is_a_bound_where_the_root_is_no_fraction_of_two(
    scale: str, rotation: int, gap: Fraction
):
    """Sxx = Syy = 4/3 = l1: half a turn about z has a = -4/3, and costs 16/3; asymmetric, 4/3.

    Then scale 2 costs (4/3 + 16/3 + 16/3) / 2 - 16/3 = 2/3, or 12 - 4/3 = 32/3; 1 along z costs 3.
    """
    points = [[1, 0, 0], [0, 1, 0], [0, 0, 0]]
    objective = Isotropic.of(RegistrationProblem(points, points, scale=scale))
    one, none = Fraction(1), Fraction(0)
    pose = ExactPose(quaternion=(0, 0, 0, 1), translation=(one, one, one))
    parts = gap_parts(objective, gap, replace(pose, scale=Fraction(2)))
    slack = checked(objective.scaling).slack

    assert parts is not None
    assert parts.rotation == Fraction(rotation, 3) + gap
    cost = Fraction(2, 3) if scale == "symmetric" else Fraction(32, 3)
    assert cost <= parts.scale <= cost + slack
    assert parts.translation == Fraction(3, 2 if scale == "symmetric" else 1)
    best = gap_parts(objective, gap, ExactPose(quaternion=(1, 0, 0, 0), translation=(none,) * 3))
    assert best is not None
    assert best.rotation == gap
    assert best.scale <= slack
    assert best.translation == 0
