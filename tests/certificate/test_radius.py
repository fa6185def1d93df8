"""How far points may move: no such move turns the optimum further; larger claims are refused."""

import json
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from certreg.certificate.envelope import Certificate
from certreg.certificate.isotropic import produce
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.verify import check, room_of_eigenvector

NOT_AN_ANGLE = "radius is not of an angle up to 90 degrees, or not positive"


def instance(seed, n, flat=1.0, noise=0.1):
    rng = np.random.default_rng(seed)
    source = rng.standard_normal((n, 3)) * (1.0, flat, flat**2)
    turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    target = source @ turn.T + noise * rng.standard_normal((n, 3)) * flat
    return source, target, np.exp(rng.standard_normal(n))


def certificate_of(source, target, weights, degrees) -> Any:
    problem = RegistrationProblem(source, target, weights=weights)
    return produce(problem, Isotropic(exact_moments(problem)), robustness_angle=degrees)


def best_rotation(source, target, weights):
    x, y = (a - np.average(a, axis=0, weights=weights) for a in (source, target))
    u, _, vt = np.linalg.svd((y * weights[:, None]).T @ x)
    return u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt


def turn_between(first, second):
    return math.degrees(Rotation.from_matrix(first.T @ second).magnitude())


def unit_rows(rows):
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def largest_turn(source, target, weights, radii, rng):
    """Of the optimum, over random and adversarial moves of 0.999 of the radii."""
    best = best_rotation(source, target, weights)
    centred = (source - np.average(source, axis=0, weights=weights)) @ best.T
    turns = []
    for axis in (*np.linalg.svd(centred)[2], *rng.standard_normal((3, 3))):
        for moved in (np.cross(axis, centred), rng.standard_normal(source.shape)):
            for x, y in ((0.0, radii["target"]), (radii["both"], radii["both"])):
                off = 0.999 * unit_rows(moved)
                disturbed = best_rotation(source - x * off @ best, target + y * off, weights)
                turns.append(turn_between(best, disturbed))
    return max(turns)


def radii_of(certificate):
    return {
        name: float(getattr(certificate.body.radius, name).value) for name in ("target", "both")
    }


@pytest.mark.one_in(4)
@pytest.mark.parametrize("flat", [1.0, 0.3, 0.03])
@pytest.mark.parametrize("degrees", [0.1, 5.0, 60.0, 90.0])
def test_no_move_within_the_radius_turns_the_optimum_further(degrees, flat):
    for seed in range(4):
        source, target, weights = instance(seed, 3 + 4 * seed, flat)
        certificate = certificate_of(source, target, weights, degrees)
        assert check(certificate.to_json()).verified
        if certificate.body.radius is None:
            continue
        rng = np.random.default_rng(seed)

        turn = largest_turn(source, target, weights, radii_of(certificate), rng)

        assert turn <= degrees


def test_the_radius_is_not_far_below_the_true_one():
    source, target, weights = instance(1, 20)
    radii = radii_of(certificate_of(source, target, weights, 5.0))

    turn = largest_turn(source, target, weights, {k: 4 * r for k, r in radii.items()}, np.random)

    assert turn > 5.0


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), power=st.integers(-6, 6), shift=st.integers(-3, 3))
def test_claims_a_little_larger_are_refused(seed, power, shift):
    """Of numbers with many zeros at the end, too, which the checker takes out."""
    rng = np.random.default_rng(seed)
    source = rng.integers(-8, 8, size=(6, 3)) * 2.0**power
    target = (source + rng.integers(-1, 2, size=(6, 3))) * 2.0**shift
    certificate = certificate_of(source, target, 4.0 ** rng.integers(-2, 3, size=6), 30.0)
    if certificate is None or certificate.body.radius is None:
        return

    document = json.loads(certificate.to_json())
    assert check(certificate.to_json()).verified
    for name, reason in (
        ("target", "radius is larger than what is proved"),
        ("both", "radius is larger than what is proved"),
        ("separation", "radius.separation is not proved"),
    ):
        (mantissa, exponent), kept = document["radius"][name], dict(document["radius"])
        document["radius"][name] = [mantissa + (mantissa >> 16) + 1, exponent]
        assert check(json.dumps(document).encode()).reason == reason
        document["radius"] = kept


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"target": [0, 0]}, NOT_AN_ANGLE),
        ({"both": [-1, 0]}, NOT_AN_ANGLE),
        ({"sin_half_angle": None}, NOT_AN_ANGLE),
        (
            {"sin_half_angle": [3, -2]},
            NOT_AN_ANGLE,
        ),
        ({"target": None}, NOT_AN_ANGLE),
        (dict.fromkeys(("both", "target")), NOT_AN_ANGLE),
        ({"separation": None}, "radius.separation is not proved"),
        ({"separation": [0, 0]}, "radius.separation is not proved"),
        ({"separation": [-1, 0]}, "radius.separation is not proved"),
    ],
)
def test_a_radius_with_a_part_that_is_none_is_refused(changed, reason):
    document = json.loads(certificate_of(*instance(2, 8), 5.0).to_json())
    document["radius"] |= changed

    assert check(json.dumps(document).encode()).reason == reason


@pytest.mark.parametrize(("size", "verified"), [(2**30, True), (2**30 + 1, False)])
def test_two_points_on_a_line_bring_the_radius_to_its_very_limit(size, verified):
    """The largest angle, at which the sine is sqrt(1/2) of half of it, to the last bit."""
    document = json.loads(certificate_of(*instance(2, 8), 90.0).to_json())
    root = math.isqrt(2**61)  # of half, times 2^31
    document["radius"]["sin_half_angle"] = [root + size - 2**30, -31]
    document["radius"] |= {"target": [1, -60], "both": [1, -60]}

    assert check(json.dumps(document).encode()).verified is verified


def test_nothing_is_claimed_of_optima_that_are_not_unique():
    corners = [[1, 0, 0], [-1, 0, 0], [0, 0, 0]]
    certificate = certificate_of(corners, corners, [1.0, 1.0, 1.0], 5.0)

    assert certificate.body.radius is None
    assert "radius" not in json.loads(certificate.to_json())


def test_a_certificate_with_a_radius_is_read_as_it_was_written():
    certificate = certificate_of(*instance(3, 9), 5.0)

    assert Certificate.load(certificate.to_json()) == certificate


def test_of_null_and_of_no_radius_nothing_is_said():
    document = json.loads(certificate_of(*instance(3, 9), 5.0).to_json())
    said = check(json.dumps(document).encode()).theorems
    del document["radius"]
    unsaid = check(json.dumps(document).encode()).theorems

    assert check(json.dumps(document | {"radius": None}).encode()).theorems == unsaid
    assert [line for line in said if line not in unsaid] == [
        line for line in said if "off by less than" in line
    ]
    assert len(said) == len(unsaid) + 2


@pytest.mark.parametrize("degrees", [0.0, -1.0, 90.5, math.nan, math.inf])
def test_other_angles_are_an_error(degrees):
    with pytest.raises(ValueError, match=r"the angle is .* degrees: give more than 0, and at most"):
        certificate_of(*instance(2, 8), degrees)


def test_the_room_is_that_of_the_sine():
    """g (sin 60 - b) / 2, a little less, with s = 1/2."""
    room = room_of_eigenvector(Fraction(4), Fraction(1, 8), Fraction(1, 2))

    assert 0 < 2 * (math.sqrt(3) / 2 - 1 / 8) - float(room) < 1e-15 or float(room) == 2 * (
        math.sqrt(3) / 2 - 1 / 8
    )
    assert (room / 2 + Fraction(1, 8)) ** 2 < Fraction(3, 4)
