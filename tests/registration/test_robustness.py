"""How far the points may be off, as a result tells it."""

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from certreg import RegistrationProblem, certify
from certreg.certificate.radius import Radius
from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import Dyadic
from certreg.registration.robustness import Robustness
from certreg.registration.scale_range import proved_scales

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


@pytest.mark.parametrize("mantissa", [(1 << 60) + k for k in (0, 1, 127, 129, 200, 255)])
def test_lengths_are_rounded_down_to_the_next_double(mantissa: int):
    number = Dyadic(mantissa=mantissa, exponent=-61 - mantissa % 7)
    found = Robustness.of(Radius(sin_half_angle=number, target=number, both=number))

    for length in (found.target, found.both):
        assert Fraction(length) <= number.value < Fraction(math.nextafter(length, 9.0))


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


MOVES = 63  # of each of 16 problems: 1,008
MODELS = [(scale, only) for scale in ("asymmetric", "symmetric") for only in (False, True)]


def best_scale(x, y, w, scale, *, only):
    """By singular values."""
    if not only:
        x, y = x - w @ x / w.sum(), y - w @ y / w.sum()
    C = (y * w[:, None]).T @ x
    left, values, right = np.linalg.svd(C)
    values[2] *= np.sign(np.linalg.det(left @ right))
    source, target = (np.sum(w[:, None] * p * p) for p in (x, y))
    return values.sum() / source if scale == "asymmetric" else math.sqrt(target / source)


def moved(rng, points, length, kind, *, only):
    """Points off by `length`: from the mean (0), to it (1), anywhere (2), some of them (3)."""
    centre = np.zeros(3) if only else points.mean(axis=0)
    d = points - centre if kind < 2 else rng.normal(size=points.shape)
    d = d / np.linalg.norm(d, axis=1, keepdims=True)
    d *= -1.0 if kind == 1 else 1.0
    d *= rng.integers(0, 2, size=(len(d), 1)) if kind == 3 else 1.0
    return points + 0.999 * length * d


@pytest.mark.one_in(4)
@pytest.mark.parametrize(("scale", "only"), MODELS)
@pytest.mark.parametrize("seed", range(4))
def test_no_move_within_the_radius_takes_the_scale_out_of_its_range(scale, only, seed):
    rng = np.random.default_rng([seed, 21])
    x, w = rng.normal(size=(10, 3)), rng.uniform(0.2, 3.0, size=10)
    y = 10.0 ** rng.uniform(-1, 1) * x + 0.02 * rng.normal(size=x.shape)
    model: Any = {"scale": scale, "rotation_only": only, "weights": w, "robustness_angle": 20.0}
    found = certify(x, y, relaxation=False, simulation=False, **model).robustness
    assert found is not None
    assert found.scale_target is not None
    assert found.scale_both is not None
    (low, high), (least, most) = found.scale_target, found.scale_both
    now, reached = best_scale(x, y, w, scale, only=only), []

    for k in range(MOVES):
        b = moved(rng, y, found.target, k % 4, only=only)
        reached.append(best_scale(x, b, w, scale, only=only))
        assert low <= reached[-1] <= high
        a = moved(rng, x, found.both, k // 4 % 4, only=only)
        b = moved(rng, y, found.both, k % 4, only=only)
        assert least <= best_scale(a, b, w, scale, only=only) <= most
    # the bounds are no excuse: a third of what is allowed is reached, moving away from the mean
    assert max(reached) - now > (high - now) / 3
    assert now - min(reached) > (now - low) / 3


def test_the_range_of_a_scale_is_that_of_its_certificate_told_everywhere():
    x = np.array(PROBLEM.source)
    registration: Any = certify(x, 2 * x, relaxation=False, simulation=False, scale="asymmetric")
    found, body = registration.robustness, registration.certificate.body
    told = registration.to_dict()["robustness"]
    moments = registration.solution.moments

    assert told["scale_target"] == list(found.scale_target)
    assert told["scale_both"] == list(found.scale_both)
    assert "meanwhile the scale stays between" in str(registration)
    still: Any = proved_scales(body, moments, source=Fraction(0), target=Fraction(0))
    assert still == pytest.approx((2.0, 2.0), rel=1e-14)
    assert still[0] <= 2.0 <= still[1]
    spread = Fraction(registration.solution.objective.scaling.source)
    assert proved_scales(body, moments, source=spread, target=Fraction(0)) is None


def test_of_a_rigid_problem_no_scale_is_told():
    registration = certified(5.0)

    assert registration.robustness.scale_target is None
    assert registration.robustness.scale_both is None
    assert "scale_target" not in registration.to_dict()["robustness"]
    assert "meanwhile" not in str(registration)


def test_where_nothing_bounds_the_scale_that_is_told(monkeypatch):
    monkeypatch.setattr("certreg.registration.robustness.proved_scales", lambda *_, **__: None)
    x = np.array(PROBLEM.source)
    registration: Any = certify(x, 2 * x, relaxation=False, simulation=False, scale="asymmetric")
    document = registration.to_dict()

    assert document["robustness"]["scale_target"] is None
    assert document["robustness"]["scale_both"] is None
    assert (
        "points that move so far may leave no size to the source, nor a bound"
        in document["reasons"].values()
    )
    assert (
        "; meanwhile the scale stays within no proved bound; with points of both clouds off, "
        "within no proved bound" in str(registration)
    )
