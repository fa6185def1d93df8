"""When a pose is called optimal, or certified: on each side of every number that decides it."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from spring_families import plane, statement

import certreg
from certreg.registration.findings import (
    FINE_PROOF,
    Findings,
    findings,
    verdict_of,
)
from certreg.registration.headlines import CERTIFIED, WITHIN_LIMITS, headline_of, is_green
from certreg.registration.landscape import AssessmentSettings
from certreg.registration.optimum import exact_pose
from certreg.results import Limits, PoseVerdict

USUAL, SETTINGS = Limits(), AssessmentSettings()
GAP, ANGLE = Fraction(USUAL.max_gap), USUAL.max_angle
TINY, FINE, NONE = Fraction(1, 1 << 200), Fraction(FINE_PROOF), Fraction(0)
BEYOND = math.nextafter(ANGLE, 1.0)


@pytest.fixture(scope="module")
def registration() -> Any:
    source = np.random.default_rng(0).normal(size=(8, 3))
    return certreg.certify(source, source, relaxation=False, simulation=False)


@pytest.fixture(scope="module")
def facts(registration: Any) -> Findings:
    return findings(registration, exact_pose(registration.pose), NONE, SETTINGS)


@pytest.fixture(scope="module")
def sprung() -> Findings:
    made = plane(np.random.default_rng(4), 30, 0.05)
    found: Any = certreg.certify(certreg.RegistrationProblem(**statement(made)))
    return findings(found, exact_pose(found.pose), NONE, SETTINGS)


@pytest.mark.parametrize(
    ("gap", "cost", "angle", "optimal"),
    [
        (GAP, GAP, ANGLE, True),
        (GAP, GAP - TINY, ANGLE, False),  # more than rounding can cost
        (GAP + TINY, 2 * GAP, ANGLE, False),  # more than may be called certified
        (GAP, GAP, BEYOND, False),
        (NONE, NONE, None, False),
        (NONE, NONE, 0.0, True),
    ],
)
def test_a_pose_is_optimal_up_to_its_rounding_and_the_usual_limits(
    facts: Findings, gap: Fraction, cost: Fraction, angle: float | None, optimal
):
    bounds = replace(
        facts.bounds, greatest_gap=gap, least_range_squared=Fraction(1), angle_upper=angle
    )
    judged = replace(facts, bounds=bounds, rounding_cost=cost)

    expected = PoseVerdict.OPTIMAL if optimal else PoseVerdict.NEAR_OPTIMAL
    assert facts.unique
    assert verdict_of(judged, SETTINGS) is expected


@pytest.mark.parametrize(
    ("least", "gap", "cost", "angle", "optimal"),
    [
        (GAP, GAP, GAP, ANGLE, True),
        (GAP, GAP, GAP - TINY, ANGLE, False),  # the pose costs more than its rounding can
        (NONE, FINE, NONE, 0.0, True),
        (NONE, FINE + TINY, NONE, 0.0, False),  # the proof leaves more open than it may
        (NONE, FINE + TINY, FINE + TINY, 0.0, True),  # but for what rounding can cost
        (GAP, GAP + TINY, GAP, 0.0, False),
        (NONE, NONE, NONE, BEYOND, False),
        (NONE, NONE, NONE, None, False),
    ],
)
def test_a_pose_on_general_springs_is_optimal_up_to_its_rounding_the_proof_and_the_limits(
    sprung: Findings,
    least: Fraction,
    gap: Fraction,
    cost: Fraction,
    angle: float | None,
    optimal,
):
    bounds = replace(
        sprung.bounds,
        least_gap=least,
        greatest_gap=gap,
        least_range_squared=Fraction(1),
        angle_upper=angle,
    )
    place = replace(sprung.place, energy_range=Fraction(1), rest=None)
    judged = replace(sprung, bounds=bounds, rounding_cost=cost, place=place, away=0.0)

    expected = PoseVerdict.OPTIMAL if optimal else PoseVerdict.NEAR_OPTIMAL
    assert verdict_of(judged, SETTINGS) is expected


def test_the_optimum_is_no_spurious_equilibrium_however_little_is_called_near(registration: Any):
    """Turned by 2e-4 radians, within the angle of an equilibrium, and no gap is small enough."""
    pose = replace(exact_pose(registration.pose), quaternion=(10**4, 1, 0, 0))
    strict = AssessmentSettings(near_optimal_gap=0.0)

    judged = findings(registration, pose, NONE, strict)
    assert judged.bounds.least_gap > 0
    assert verdict_of(judged, strict) is PoseVerdict.NOT_AN_EQUILIBRIUM


@pytest.mark.parametrize(
    ("gap", "angle", "usual"),
    [
        (GAP, ANGLE, True),
        (GAP + TINY, ANGLE, False),
        (GAP, BEYOND, False),
        (NONE, 0.0, True),
    ],
)
def test_limits_of_ones_own_do_not_make_more_of_what_is_proved(
    registration: Any, gap: Fraction, angle: float, usual
):
    bounds = replace(
        registration.bounds, greatest_gap=gap, least_range_squared=Fraction(1), angle_upper=angle
    )
    found = replace(registration, bounds=bounds, limits=Limits(max_gap=0.5, max_angle=1.0))

    assert headline_of(found) is (CERTIFIED if usual else WITHIN_LIMITS)
    assert is_green(found) is usual
