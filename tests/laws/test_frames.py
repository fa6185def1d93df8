"""Another frame, order, unit or weight of the same data: what follows is known of every kind."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from laws.zoo import ALL, GENERIC, SQUARES, TURN, Placement, named, weights_of
from same.problems import random_rotation

from certreg.certificate.bounds import sin2_half_angle_between
from certreg.problem.motion import Scale
from certreg.problem.support import Loss

if TYPE_CHECKING:
    from laws.zoo import Specimen

ROWS = {*TURN, "weights", "sigma"}  # of the options, those with a row for each pair


def near(found: Placement, right: Placement, size: float = 1.0) -> bool:
    """Whether both are the same to nine digits, of lengths of this size."""
    return bool(
        np.allclose(found.rotation, right.rotation, rtol=0.0, atol=1e-9)
        and np.allclose(found.translation, right.translation, rtol=0.0, atol=1e-9 * size)
        and np.isclose(found.scale, right.scale, rtol=1e-9, atol=0.0)
    )


@pytest.mark.parametrize(**named(GENERIC))
def test_in_moved_frames_the_pose_moves_along_and_nothing_else(one: Specimen):
    rng, given = np.random.default_rng(1), one.given
    P, Q = random_rotation(rng), random_rotation(rng)
    u, v = np.zeros((2, 3)) if one.cell.rotation_only else rng.normal(size=(2, 3))
    springs = {name: TURN[name](rows, Q) for name, rows in one.options.items() if name in TURN}
    other = one.changed(
        source=given.source @ P.T + u,
        target=given.target @ Q.T + v,
        statement={**one.options, **springs},
    )
    at = Placement.of(one.result.pose)
    rotation = Q @ at.rotation @ P.T
    shift = Q @ at.translation + v - at.scale * rotation @ u

    assert near(Placement.of(other.result.pose), Placement(rotation, shift, at.scale))
    assert other.value == pytest.approx(one.value, rel=1e-9)
    assert other.result.exit_code == one.result.exit_code
    assert other.rows.tolist() == one.rows.tolist()


@pytest.mark.parametrize(**named(GENERIC))
def test_the_order_of_the_pairs_is_of_no_matter(one: Specimen):
    order, given = np.random.default_rng(2).permutation(one.n), one.given
    rows = {name: values[order] for name, values in one.options.items() if name in ROWS}
    other = one.changed(
        source=given.source[order],
        target=given.target[order],
        statement={**one.options, **rows},
    )

    assert near(Placement.of(other.result.pose), Placement.of(one.result.pose))
    assert other.value == pytest.approx(one.value, rel=1e-12)
    assert sorted(order[other.rows]) == one.rows.tolist()
    assert other.problem.digest() != one.problem.digest()


def unit_of(one: Specimen, here: int, there: int) -> tuple[Specimen, float]:
    """Both clouds in other units, each of 2 to a power, and what one of the objective is then."""
    loss = dict(one.given.loss)
    if "max_residual" in loss:
        loss["max_residual"] = 2.0**there * loss["max_residual"]
    other = one.changed(
        source=2.0**here * one.given.source,
        target=2.0**there * one.given.target,
        loss=loss,
    )
    power = here + there if one.cell.scale is Scale.SYMMETRIC else 2 * there
    return other, 2.0**power


@pytest.mark.parametrize(**named(ALL))
def test_in_another_unit_every_number_is_the_same_times_a_power_of_two(one: Specimen):
    """Exactly: no digit of a result is of the unit in which lengths are given."""
    power = -40
    other, unit = unit_of(one, power - 3 * one.cell.scaled, power)
    here, there = one.fit, other.fit

    assert (there.pose.rotation == here.pose.rotation).all()
    assert (there.pose.translation == here.pose.translation * 2.0**power).all()
    assert there.objective == here.objective * unit
    if one.cell.scaled:
        assert there.pose.scale == here.pose.scale * 8.0
    if one.cell.loss is not Loss.SQUARES:
        assert other.value == one.value
        assert other.result.labels == one.result.labels
    assert claimed_angle(there) == claimed_angle(here)
    assert there.unique is here.unique


def claimed_angle(found: Any) -> Any:
    bound = found.certificate.body.claims.sin2_half_angle
    return None if bound is None else bound.value


@pytest.mark.parametrize(**named([one for one in SQUARES if "mixed" not in one.name]))
def test_weights_times_a_number_are_an_energy_times_it(one: Specimen):
    """Covariances, which take no weights, are over it."""
    factor = 3.0
    options = {name: values for name, values in one.options.items() if name != "sigma"}
    if "covariances" in options:
        options["covariances"] = options["covariances"] / factor
    else:
        options["weights"] = factor * weights_of(one.options, one.n)
    other = one.changed(statement=options)

    assert near(Placement.of(other.result.pose), Placement.of(one.result.pose))
    assert other.value == pytest.approx(factor * one.value, rel=1e-9)


@pytest.mark.parametrize(
    **named([one for one in SQUARES if not one.cell.springs and not one.cell.scaled])
)
def test_springs_alike_in_every_way_are_one_weight_per_pair(one: Specimen):
    alike = {"factors": np.tile([1.0, 0.0, 1.0, 0.0, 0.0, 1.0], (one.n, 1))}
    other = one.changed(statement={**one.options, **alike})
    here, there = one.result, other.result

    assert there.problem.digest() != here.problem.digest()
    quaternions = [each.certificate.body.quaternion for each in (here, there)]
    assert sin2_half_angle_between(*quaternions) < Fraction(1, 10**20)
    assert there.objective == pytest.approx(here.objective, rel=1e-9)
    assert there.rmse == pytest.approx(here.rmse, rel=1e-12)
    assert there.residuals == pytest.approx(here.residuals, rel=1e-9)
    assert there.degrees_of_freedom == here.degrees_of_freedom
    assert np.array(there.covariance) == pytest.approx(np.array(here.covariance), rel=1e-6)
    assert there.fit.chi2 == here.fit.chi2 or there.fit.chi2.p == pytest.approx(here.fit.chi2.p)
