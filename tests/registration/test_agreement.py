"""Roads that lead to the optimum are told with the angle of the one that ended farthest."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from strategies import random_rotation

from certreg.errors import ContradictionError
from certreg.geometry.so3 import rotation_matrix
from certreg.problem.lifting import lift
from certreg.problem.moments import floating_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.agreement import CLOSED_FORM_LOSS
from certreg.registration.certification import certify
from certreg.registration.closed_form import arun, horn

if TYPE_CHECKING:
    from certreg.problem.fast_pose import FloatingPose


AXES = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])])
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("off", ["horn", "arun"])
def test_the_closed_form_that_ended_farther_is_told(monkeypatch: pytest.MonkeyPatch, off: str):
    """A turn of 1e-6 about x costs 1e-13 of the range: no contradiction, and told."""
    roads = import_module("certreg.registration.agreement")
    monkeypatch.setattr(roads, off, lambda _: np.array([1.0, 5e-7, 0.0, 0.0]))
    monkeypatch.setattr(roads, "floating_pose", lambda *_, **__: None)
    found = certify(RegistrationProblem(AXES, AXES), relaxation=False, simulation=False)

    assert found.solution.agreement.closed_form == pytest.approx(1e-6)


@pytest.mark.usefixtures("compiled")
def test_the_pose_of_one_call_is_told_where_it_ended_farther(monkeypatch: pytest.MonkeyPatch):
    roads = import_module("certreg.registration.agreement")
    called = roads.floating_pose

    def turned(*clouds: Any) -> FloatingPose:
        found = called(*clouds)
        pose = replace(found.pose, quaternion_wxyz=np.array([1.0, 5e-7, 0.0, 0.0]))
        return replace(found, pose=pose)

    monkeypatch.setattr(roads, "floating_pose", turned)
    found = certify(RegistrationProblem(AXES, AXES), relaxation=False, simulation=False)

    assert found.solution.agreement.closed_form == pytest.approx(1e-6)


class Quarter:
    """An objective at which every rotation loses a quarter, a tenth of a radian away."""

    def angle_to_optimum(self, _: object) -> float:
        return 0.1

    def relative_loss(self, _: object) -> Fraction:
        return Fraction(1, 4)


def test_a_loss_at_the_limit_is_allowed_and_one_beyond_it_is_told_in_degrees():
    agreement = import_module("certreg.registration.agreement")
    angle_of, identity = agreement._angle, [1, 0, 0, 0]

    assert angle_of(Quarter(), "a road", identity, 0.25) == 0.1
    with pytest.raises(ContradictionError, match=r"^a road contradicts .* is 5.73 deg") as caught:
        angle_of(Quarter(), "a road", identity, math.nextafter(0.25, 0.0))
    assert type(caught.value.value) is float
    assert caught.value.value == 0.25


@pytest.mark.parametrize(("decades", "lost"), [(200, False), (320, True)])
def test_weights_that_vanish_from_sums_of_doubles_contradict_nothing(decades: int, *, lost: bool):
    """Beside the heavy pair all that turns the clouds is lost: horn(C) is off by over 1e-11."""
    weights = np.array([1.0, *[10.0**-decades] * 6])
    source = np.vstack([[0.1, 0.2, 0.3], AXES])
    problem = RegistrationProblem(source, source @ TURN.T + 0.1, weights=weights)
    found = certify(problem, relaxation=False, simulation=False)
    q = lift(horn(floating_moments(problem).cross_covariance)).integers

    assert (found.solution.objective.relative_loss(q) > CLOSED_FORM_LOSS) == lost
    assert found.solution.agreement.closed_form < 1e-6
    assert found.certificate is not None


def test_both_closed_forms_find_the_turn_of_a_tilted_plane():
    """det C is zero but for rounding, of either sign: it must not decide on a reflection."""
    rng = np.random.default_rng(0)
    for _ in range(32):
        plane, turn = random_rotation(rng), random_rotation(rng)
        source = (rng.normal(size=(6, 3)) * [1.0, 1.0, 0.0]) @ plane.T
        problem = RegistrationProblem(source, source @ turn.T)
        cross_covariance = floating_moments(problem).cross_covariance
        for road in (horn, arun):
            found = rotation_matrix(road(cross_covariance).tolist())
            assert np.allclose(found, turn, atol=1e-12), road
