"""How far the points may be off, as a result tells it."""

import math
from typing import Any

import numpy as np
import pytest

from certreg import RegistrationProblem, certify
from certreg.errors import InvalidProblemError
from certreg.registration.robustness import Robustness

PROBLEM = RegistrationProblem(
    [[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 3]], [[0, 0, 0.1], [0, 2, 0], [-1, 0, 0], [0, 0, 3]]
)


def certified(angle) -> Any:
    return certify(PROBLEM, relaxation=False, simulation=False, robustness_angle=angle)


@pytest.mark.parametrize("angle", [1e-3, 0.123456789, 5, 30.0, 90.0])
def test_the_angle_is_the_one_asked_for_and_no_smaller_than_the_proved_one(angle):
    registration = certified(angle)
    found, radius = registration.robustness, registration.certificate.body.radius
    proved = 2 * math.degrees(math.asin(radius.sin_half_angle.value))

    assert proved <= found.angle <= angle * (1 + 1e-5)
    assert 0 < found.both < found.target <= radius.target.value
    assert found.both <= radius.both.value


def test_a_larger_angle_lets_points_be_off_by_more():
    radii = [certified(angle).robustness.target for angle in (1.0, 5.0, 45.0, 90.0)]

    assert radii == sorted(radii)
    assert radii[3] > 10 * radii[0]


def test_it_can_be_left_out():
    registration = certified(None)

    assert registration.robustness is None
    assert registration.to_dict()["robustness"] is None
    assert "harmless" in registration.to_dict()["reasons"]["robustness"]
    assert "robustness        not proved" in str(registration)


@pytest.mark.parametrize("angle", [0, -5.0, 90.1, math.nan, math.inf])
def test_other_angles_are_refused(angle):
    with pytest.raises(InvalidProblemError, match="more than 0, and at most 90") as error:
        certified(angle)

    assert str(error.value) == (
        f"the angle of robustness is {angle!r} degrees: give more than 0, and at most 90"
    )


def test_nothing_is_proved_robust_where_optima_are_many():
    line = np.outer([-1.0, 0.0, 1.0], [1, 2, 3])

    assert certify(line, line, relaxation=False, simulation=False).robustness is None


def test_the_numbers_are_of_the_certificate():
    radius = certified(5.0).certificate.body.radius

    assert Robustness.of(radius) == certified(5.0).robustness
