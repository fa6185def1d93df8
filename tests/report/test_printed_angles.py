"""Angles and lengths on a page are bounds as printed: on both sides of a decimal."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from types import MappingProxyType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from certreg.geometry.pose import Pose
from certreg.problem.motion import Motion, Scale
from certreg.registration.headlines import degrees_words
from certreg.registration.labelled import TruncatedRegistration
from certreg.registration.result import Method
from certreg.registration.robustness import Robustness
from certreg.report import document, lines
from certreg.report import words as page_words
from certreg.report.judged_pose import within_words
from certreg.report.lines import step_words
from certreg.report.overview import bound_facts, robustness_facts
from certreg.report.pairs import degrees_from
from certreg.report.robustness import robustness_words
from certreg.results import Optimality

DIGITS = 7


def reached(sin2: Fraction) -> Fraction:
    """The degrees that are printed of this proved bound; where none are, it is no bound."""
    pose = Pose.from_matrix(np.eye(4))
    return Fraction(degrees_from(pose, (1, 0, 0, 0), sin2, digits=DIGITS) or "180")


def test_the_degrees_of_reach_are_no_fewer_than_the_proved_angle():
    """Of 7 digits they are the next ones, but for the slack of 1e-12 of the arcsine."""
    sines = [Fraction(k, 97) ** (1 + k % 9) for k in range(1, 97)]
    sines += [1 - Fraction(1, 4**k) for k in range(1, 40)]
    with ctx.workprec(200):
        for sin2 in sines:
            exact = 2 * (arb(sin2.numerator) / sin2.denominator).sqrt().asin() * 180 / arb.pi()
            told = reached(sin2)
            printed = arb(told.numerator) / told.denominator
            unit = Fraction(10) ** (math.floor(math.log10(told)) + 1 - DIGITS)
            step = arb(unit.numerator) / unit.denominator

            assert exact <= printed
            assert printed < exact * (1 + 2e-12) + step


@pytest.mark.parametrize("angle", [1e-9, 0.1, math.radians(1.0), 1.0, math.nextafter(math.pi, 0.0)])
def test_a_proved_angle_in_degrees_is_no_fewer_than_it_is(angle: float):
    judged: Any = SimpleNamespace(angle_upper=angle)
    number = Fraction(degrees_words(judged) or "")

    with ctx.workprec(200):
        assert arb(angle) * 180 / arb.pi() <= arb(number.numerator) / number.denominator
    assert float(number) < math.degrees(angle) * 1.0101


def test_where_no_angle_is_proved_none_is_printed():
    for angle in (None, math.pi):
        judged: Any = SimpleNamespace(angle_upper=angle)
        assert degrees_words(judged) is None
    bare = SimpleNamespace(body=SimpleNamespace(claims=SimpleNamespace(sin2_half_angle=None)))
    for certificate in (None, bare):
        truncated = SimpleNamespace(certificate=certificate)
        assert vars(TruncatedRegistration)["turn"].fget(truncated) is None


def robust(angle: float, target: float, both: float, scales: Any = MappingProxyType({})) -> Any:
    found = Robustness(angle=angle, target=target, both=both, scales=scales)
    return SimpleNamespace(robustness=found)


@pytest.mark.parametrize(
    ("target", "told", "half"),
    [
        (math.nextafter(0.5, 0.0), "0.499", "0.249"),
        (0.5, "0.5", "0.25"),
        (math.nextafter(0.5, 1.0), "0.500", "0.250"),
    ],
)
def test_a_harmless_error_is_rounded_down_and_its_angle_is_as_claimed(
    target: float, told: str, half: str
):
    registration = robust(5.00001, target, target / 2)
    words = robustness_words(registration)
    (fact,) = robustness_facts(registration)

    assert words.startswith("every optimum stays within 5.00001 degrees of the certified rotation ")
    assert f"is off by less than {told}; points of both clouds, {half} (sufficient" in words
    assert fact.value == told
    assert "every optimum stays within 5.00001° of the certified rotation; " in str(fact.words)


def test_the_angle_of_robustness_is_no_smaller_than_the_claimed_one():
    """Six digits of it, of sines of half of up to 90 degrees."""
    with ctx.workprec(200):
        for k in range(1, 700, 9):
            sine = SimpleNamespace(value=Fraction(k, 990))
            length = SimpleNamespace(value=Fraction(1))
            radius: Any = SimpleNamespace(sin_half_angle=sine, target=length, both=length)
            told = Robustness.of(radius).angle
            exact = 2 * (arb(k) / 990).asin() * 180 / arb.pi()

            assert exact < arb(told) < exact * (1 + 1e-5)
            assert told == float(f"{told:.6g}")


def test_a_scale_stays_between_the_printed_numbers():
    words = robustness_words(robust(5.0, 0.1, 0.1, {"target": (2 / 3, 4 / 3), "both": None}))

    assert "the scale stays between 0.666666 and 1.33334; " in words
    assert words.endswith("off, within no proved bound")


def test_steps_are_at_most_as_long_as_printed():
    assert step_words(0.1) == "each at most 0.1 long"
    assert step_words(0.12345612) == "each at most 0.123457 long"


@pytest.mark.parametrize("apart", [Fraction(-1, 10**20), Fraction(0), Fraction(1, 10**20)])
def test_the_growth_that_is_told_is_no_more_than_the_proved_one(apart: Fraction):
    """At least mu, rounded down, less delta, rounded up."""
    body = SimpleNamespace(growth=Fraction(1, 2) + apart, gap=Fraction(1, 4) + apart)
    problem = SimpleNamespace(motion=Motion())
    registration: Any = SimpleNamespace(certificate=SimpleNamespace(body=body), problem=problem)
    (told,) = page_words._growth(registration)
    found = re.search(r"costs at least (\S+) sin²\(a/2\) - (\S+) more", told.words)
    assert found is not None
    mu, delta = map(Fraction, found.groups())

    assert body.growth - Fraction(1, 500) < mu <= body.growth
    assert body.gap <= delta < body.gap + Fraction(1, 500)
    body.growth = Fraction(0)
    assert list(page_words._growth(registration)) == []
    registration.certificate = None
    assert list(page_words._growth(registration)) == []


@pytest.mark.parametrize("apart", [Fraction(-1, 10**20), Fraction(0), Fraction(1, 10**20)])
def test_the_growth_of_the_document_is_no_more_than_the_proved_one(apart: Fraction):
    body: Any = SimpleNamespace(
        growth=Fraction(1, 2) + apart, gap=Fraction(1, 4) + apart, quaternion=(1, -2, 3, 4)
    )
    fields: Any = document._growth(body)
    mu, delta = fields["mu"], fields["delta"]

    assert mu <= body.growth < math.nextafter(mu, 1.0)
    assert math.nextafter(delta, 0.0) < body.gap <= delta
    assert fields["quaternion_wxyz"] == ["1", "-2", "3", "4"]


@pytest.mark.parametrize("shift", [math.nextafter(0.5, 0.0), 0.5, math.nextafter(0.5, 1.0)])
def test_a_centre_is_no_farther_off_than_printed(shift: float):
    number = Fraction(within_words(shift).removeprefix("within ").removesuffix(" (proved)"))

    assert Fraction(shift) <= number <= Fraction(501, 1000)


NEAR_HALF = [Fraction(1, 2) + Fraction(k, 10**20) for k in (-1, 0, 1)]


@pytest.mark.parametrize("gap", NEAR_HALF)
def test_a_gap_is_printed_as_no_less_than_it_is_wherever_it_is_told(gap: Fraction):
    registration: Any = SimpleNamespace(
        bounds=SimpleNamespace(greatest_gap=gap, least_range_squared=0, angle_upper=None),
        method=Method.ENERGY,
        problem=SimpleNamespace(motion=Motion(), scale=Scale.NONE, springs=None),
        equilibria=SimpleNamespace(classification=SimpleNamespace(unique=False)),
        status=Optimality.CERTIFIED,
        robustness=None,
        solution=SimpleNamespace(unique_rotation=None),
    )
    told = [
        *(one.words for one in page_words._optimality(registration)),
        page_words.weak_words(registration),
        lines.proved_lines(registration, registration.bounds)[0],
        *(fact.value for fact in bound_facts(registration, None, "the optimum")),
    ]
    printed = "0.5" if gap == Fraction(1, 2) else "0.501" if gap > Fraction(1, 2) else "0.500"

    assert len(told) == 4
    for line in told:
        found = re.search(r"(?:by at most|<=|≤) (0\.5\d*)", line)
        assert found is not None, line
        assert found[1] == printed
