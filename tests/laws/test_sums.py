"""Objective, residuals and optimum beside sums over the points, which know no kind of problem."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from laws.zoo import (
    ALL,
    GENERIC,
    SQUARES,
    Placement,
    curvature,
    energy,
    free,
    named,
    slope,
    weights_of,
)

import certreg
from certreg.problem.motion import Scale
from certreg.problem.support import Loss
from certreg.registration import closed_form
from certreg.results import PoseVerdict

if TYPE_CHECKING:
    from laws.zoo import Specimen

NOISE_FREE = 1e-24  # of the target's squares: below it an energy is what rounding made of zero


@pytest.mark.parametrize(**named(ALL))
def test_the_objective_is_the_sum_over_the_points(one: Specimen):
    right = energy(one, Placement.of(one.fit.pose), one.rows)
    size = float(np.abs(one.given.target).max()) ** 2

    assert one.fit.objective == pytest.approx(right, rel=1e-10, abs=NOISE_FREE * size)


@pytest.mark.parametrize(**named(GENERIC))
def test_what_is_least_or_largest_is_counted_at_the_pose(one: Specimen):
    distances = distances_of(one)
    bound = one.given.loss.get("max_residual", np.inf)

    if one.cell.loss is Loss.TRUNCATED:
        assert one.value == pytest.approx(np.minimum((distances / bound) ** 2, 1.0).sum())
        assert one.rows.tolist() == np.flatnonzero(distances <= bound).tolist()
    if one.cell.loss is Loss.CONSENSUS:
        assert one.value == len(one.rows)
        assert (distances_of(one, one.result.witness)[one.rows] <= bound).all()
    if one.given.labels is not None:  # drawn with noise far below the bounds
        assert one.rows.tolist() == np.flatnonzero(one.given.labels).tolist()


def distances_of(one: Specimen, pose: Any = None) -> Any:
    at = Placement.of(one.result.pose if pose is None else pose)
    moved = at.scale * one.given.source @ at.rotation.T + at.translation
    return np.linalg.norm(one.given.target - moved, axis=1)


@pytest.mark.parametrize(**named(GENERIC))
def test_residuals_are_distances_along_what_resists_and_their_mean_square_is_the_rmse(
    one: Specimen,
):
    """Of a plane its normal, of a line all but its direction; each counts by its weight."""
    at, found = Placement.of(one.fit.pose), one.fit
    e = one.given.target - at.scale * one.given.source @ at.rotation.T - at.translation
    largest = np.linalg.eigvalsh(one.matrices)[:, -1]
    along = np.einsum("kij,kj->ki", one.matrices, e) / largest[:, None]
    flat = not one.cell.springs or {"normals", "directions"} & one.options.keys()
    if flat and "covariances" not in one.options:
        assert found.residuals == pytest.approx(np.linalg.norm(along, axis=1)[one.rows], abs=1e-12)
    squares = energy(one, at, one.rows) * (at.scale if one.cell.scale is Scale.SYMMETRIC else 1.0)
    assert found.rmse == pytest.approx(np.sqrt(squares / largest[one.rows].sum()), rel=1e-9)


@pytest.mark.parametrize(**named(GENERIC))
def test_at_the_optimum_the_slope_is_zero_and_no_small_move_lowers_the_energy(one: Specimen):
    at, directions = Placement.of(one.fit.pose), free(one)
    bent = curvature(one, at, one.rows)
    step = np.linalg.solve(bent, slope(one, at, one.rows))
    moves = np.zeros((20, 7))
    moves[:, directions] = 1e-3 * np.random.default_rng(0).normal(size=(20, len(directions)))
    least = energy(one, at, one.rows)

    assert len(directions) == one.motion.parameters
    assert np.abs(step).max() < 1e-6
    assert np.linalg.eigvalsh(bent)[0] > 0.0
    assert all(energy(one, at.moved(move), one.rows) > least for move in moves)


SIZED = [one for one in ALL if one.name.split()[0] in {"tiny", "huge"}]


@pytest.mark.parametrize(**named([*SQUARES, *SIZED], way=["fast", "long"]))
def test_register_gives_the_certified_pose(
    one: Specimen, way: str, monkeypatch: pytest.MonkeyPatch
):
    """By sums of doubles, and where those do not tell it."""
    if way == "long":
        monkeypatch.setattr(closed_form, "floating_pose", lambda *_, **__: None)
    options = {
        name: values for name, values in one.options.items() if name not in {"sigma", "damping"}
    }
    if "sigma" in one.options:
        options["weights"] = weights_of(one.options, one.n)
    found, pose = certreg.register(one.given.source, one.given.target, **options), one.fit.pose
    moved, right = (np.array(each.apply(one.given.source)) for each in (found, pose))

    assert type(found) is type(pose)
    assert np.abs(found.rotation - pose.rotation).max() < 1e-12
    assert np.abs(moved - right).max() < 1e-11 * np.abs(right).max()
    assert getattr(found, "scale", 1.0) == pytest.approx(getattr(pose, "scale", 1.0), rel=1e-12)
    assert not one.cell.rotation_only or found.translation.tolist() == [0.0] * 3


@pytest.mark.parametrize(**named(SQUARES))
def test_the_certified_pose_is_judged_optimal_in_every_form(one: Specimen):
    pose = one.fit.pose
    scale = [pose.scale] if one.cell.scaled else []
    forms = [pose, pose.as_matrix(), SimpleNamespace(params=pose.as_matrix())]
    forms += [(turn, pose.translation, *scale) for turn in (pose.rotation, pose.quaternion_wxyz)]
    if not one.cell.scaled:
        forms.append((pose.rotation, pose.translation, 1.0))

    for form in forms:
        judged: Any = certreg.assess(one.result, form)
        assert judged.verdict is PoseVerdict.OPTIMAL
        assert judged.angle_to_optimum < 1e-12
        assert (judged.rmse, judged.optimum_rmse) == pytest.approx([one.result.rmse] * 2)
    if one.result.equilibria is not None:
        assert one.result.equilibria.components[0].rmse == pytest.approx(one.result.rmse)


@pytest.mark.parametrize(**named(SQUARES))
def test_a_pose_that_is_turned_is_judged_by_what_it_costs(one: Specimen):
    at, pose = Placement.of(one.fit.pose), one.fit.pose
    off = at.moved(np.array([0.0, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0]))
    given = (off.rotation, off.translation, *([pose.scale] if one.cell.scaled else []))
    judged = certreg.assess(one.result, given)
    above = energy(one, off) - energy(one, at)

    assert judged.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM
    assert judged.angle_to_optimum == pytest.approx(0.3, abs=1e-9)
    assert judged.gap_lower == pytest.approx(above, rel=1e-6)
    assert judged.angle_upper == pytest.approx(0.3, abs=1e-4)
    for reflected in (-np.eye(3), (-np.eye(3), np.zeros(3))):
        assert certreg.assess(one.result, reflected).verdict is PoseVerdict.NOT_A_ROTATION
    if not one.cell.scaled:
        scaled = certreg.assess(one.result, (pose.rotation, pose.translation, 1.5))
        assert scaled.verdict is PoseVerdict.NOT_A_ROTATION
        assert "scales by 1.5" in scaled.headline


BOUNDED = [one for one in GENERIC if one.cell.loss is not Loss.SQUARES]


@pytest.mark.parametrize(**named(BOUNDED))
def test_the_fit_is_that_of_the_pairs_within_alone_and_labels_are_those_of_points(one: Specimen):
    rows, given = one.rows, one.given
    kept = {
        name: values[rows] if np.ndim(values) else values for name, values in one.options.items()
    }
    alone = certreg.certify(given.source[rows], given.target[rows], **kept)
    motion = {name: one.options[name] for name in ("scale", "rotation_only") if name in kept}
    points: Any = certreg.certify(given.source, given.target, **motion, **given.loss)

    assert one.fit.problem.digest() == alone.problem.digest()
    assert (one.result.pose.as_matrix() == alone.pose.as_matrix()).all()
    assert (one.fit.status, one.fit.structure) == (alone.status, alone.structure)
    assert one.result.labels == points.labels
    assert one.result.labels_unique
    assert one.result.exit_code == 0


@pytest.mark.parametrize(**named([one for one in SQUARES if one.cell.scaled]))
def test_a_free_scale_leaves_the_rotation_as_it_is_and_is_between_its_bounds(one: Specimen):
    statement = {name: value for name, value in one.options.items() if name != "scale"}
    rigid = certreg.certify(one.given.source, one.given.target, **statement)
    low, high = one.result.to_dict()["pose"]["scale_interval"]
    claims = one.result.certificate.body.claims

    assert (one.result.pose.rotation == rigid.pose.rotation).all()
    assert low <= one.result.pose.scale <= high <= low * (1 + 1e-15)
    assert 0 < claims.scale_upper.value / claims.scale_lower.value - 1 < Fraction(1, 10**20)
