"""Numbers on their way to words, page and JSON: in the right unit, on the right side, labelled."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from strategies import random_problem

from certreg.dynamics.body import SimulationStatus
from certreg.exact.decimals import at_least, at_most
from certreg.problem.problem import RegistrationProblem
from certreg.registration.agreement import Agreement
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.enumeration import enumerated
from certreg.registration.headlines import interval_words
from certreg.report import thinning
from certreg.report.document import result_document
from certreg.report.judged_pose import assessment_document, assessment_summary
from certreg.report.methods import methods_fields
from certreg.report.pose_words import motion_words
from certreg.report.reload import WEAKER, _weaker
from certreg.report.summary import registration_summary
from certreg.report.viewer import Names, scene_document
from certreg.report.words import methods_sentence

if TYPE_CHECKING:
    from certreg.registration.result import Registration


AXES = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])])
PI_BELOW = Fraction(314159265358979323846, 10**20)


def plainly(problem: RegistrationProblem) -> Registration:
    return certify(problem, relaxation=False, simulation=False)


@pytest.fixture(scope="module")
def registration() -> Registration:
    return certify(random_problem(np.random.default_rng(3)), relaxation=False)


def test_a_lower_bound_is_rounded_down_and_an_upper_one_up(registration: Registration):
    third = Fraction(2, 3)
    bounds = replace(checked(registration.bounds), least_gap=third, greatest_gap=third)
    assessment = assess(random_problem(np.random.default_rng(3)), np.eye(3), np.zeros(3))
    energies = replace(checked(assessment.energies), bounds=bounds)
    told = assessment_summary(replace(assessment, energies=energies))

    assert (at_least(third), at_most(third)) == ("0.666", "0.667")
    assert interval_words(bounds) == "between 0.666666666 and 0.666666667"
    assert "above the minimum  between 0.666666666 and 0.666666667 (proved)" in told


def test_an_angle_in_degrees_is_no_smaller_than_in_radians():
    assessment = assess(RegistrationProblem(AXES, AXES), np.eye(3), np.zeros(3))
    for angle in np.random.default_rng(0).uniform(1e-9, 3.0, size=40).tolist():
        told = assessment_document(replace(assessment, angle_upper=angle))["angle_upper_deg"]

        assert Fraction(told) * PI_BELOW / 180 >= Fraction(angle) * (1 - Fraction(1, 10**20))


@pytest.mark.parametrize(("square", "warned"), [(1.55, False), (1.65, True)])
def test_the_next_equilibrium_is_not_ruled_out_where_twice_the_gap_is_below_25(
    square: float, *, warned: bool
):
    """C = diag(18, 8, 2) / sigma^2, so l1 - l2 = 20 / sigma^2: 40 / 1.6 is 25."""
    problem = RegistrationProblem(AXES, AXES, sigma=math.sqrt(square))
    told = registration_summary(plainly(problem))

    assert ("five standard deviations of the sigma given rule out no turn" in told) == warned


@pytest.mark.parametrize(("sigma", "scale"), [(None, "estimated"), (0.1, "given")])
def test_the_covariance_says_where_its_scale_is_from(sigma: float | None, scale: str):
    cloud = random_problem(np.random.default_rng(1))
    problem = RegistrationProblem(cloud.source, cloud.target, sigma=sigma)

    assert result_document(plainly(problem))["pose"]["covariance_scale"] == scale


def test_angles_of_methods_are_in_degrees(registration: Registration):
    angles = Agreement(closed_form=math.pi, relaxation=math.pi / 2, simulation=math.pi / 3)
    told = methods_sentence(registration, angles).words

    assert [float(one) for one in re.findall(r"ended (\d+)°", told)] == [180.0, 90.0, 60.0]


def test_how_well_roads_agree_is_told_in_degrees():
    found = enumerated(RegistrationProblem(AXES, AXES), "all")
    apart = replace(found, comparison=replace(checked(found.comparison), angle=math.pi / 6))

    assert methods_fields(apart)["agreement"]["rotation_deg"] == pytest.approx(30.0)


@pytest.mark.parametrize(("times", "weak"), [(0.99 * WEAKER, False), (1.01 * WEAKER, True)])
def test_a_certificate_of_a_wide_angle_is_weak_however_small_its_gap(
    registration: Registration, times: float, *, weak: bool
):
    proved = checked(registration.bounds)
    given = replace(proved, angle_upper=times * checked(proved.angle_upper))

    assert _weaker(given, proved) == weak


@pytest.mark.parametrize(("times", "weak"), [(0.999 * WEAKER, False), (1.001 * WEAKER, True)])
def test_a_certificate_of_a_wide_gap_is_weak_however_small_its_angle(
    registration: Registration, times: float, *, weak: bool
):
    proved = checked(registration.bounds)
    wide = replace(proved, greatest_gap=Fraction(times) * proved.greatest_gap)
    without = replace(proved, angle_upper=None)

    assert proved.greatest_gap > 0
    assert _weaker(wide, proved) == weak
    assert _weaker(replace(wide, angle_upper=None), without) == weak
    assert not _weaker(proved, wide)
    assert not _weaker(wide, None)
    assert (_weaker(without, proved), _weaker(proved, without)) == (True, False)


@pytest.mark.parametrize("arrived", [True, False])
def test_a_finer_motion_is_shown_only_where_it_ends(
    monkeypatch: pytest.MonkeyPatch, registration: Registration, *, arrived: bool
):
    solution = registration.solution
    coarse: Any = solution.trajectory
    status = SimulationStatus.CONVERGED if arrived else SimulationStatus.OUT_OF_STEPS
    fine = replace(coarse, status=status)
    samples = coarse.samples.copy()
    samples["time"] *= 2.0
    vars(fine)["samples"] = samples
    monkeypatch.setattr(thinning, "simulate", lambda *_, **__: fine)

    assert thinning.shown_motion(solution, coarse).last == (fine if arrived else coarse).times[-1]


def test_a_quarter_turn_is_told_as_90_degrees():
    quarter = AXES @ np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    told = motion_words(plainly(RegistrationProblem(AXES, quarter)))

    assert "turns the source by 90° about the axis (0.000, 0.000, 1.000)" in told


def test_each_road_is_told_with_its_own_angle():
    """Roads that ended 30 and 60 degrees off, and a closed form that did not."""
    found = certify(random_problem(np.random.default_rng(3)))
    angles = Agreement(closed_form=0.0, relaxation=math.pi / 6, simulation=math.pi / 3)
    told = registration_summary(replace(found, solution=replace(found.solution, agreement=angles)))

    assert re.search(r"relaxation \(SDP\) .* 30 degrees from the optimum", told)
    assert re.search(r"simulation .* 60 degrees from the optimum", told)


def test_equilibria_are_told_in_degrees():
    components = result_document(plainly(RegistrationProblem(AXES, AXES)))["equilibria"][
        "components"
    ]

    assert [c["angle_to_optimum_deg"] for c in components] == pytest.approx([0.0, *[180.0] * 3])


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_value_of_the_relaxation_is_in_the_unit_of_the_objective(scale: float):
    """It is the greatest tr(R^T C), here 28 times the square of the scale."""
    problem = RegistrationProblem(scale * AXES, scale * AXES)
    document = result_document(certify(problem, simulation=False))

    assert document["relaxation"]["value"] == pytest.approx(28.0 * scale**2, rel=1e-6)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_the_page_has_energies_in_units_of_the_objective(scale: float):
    """Motions are over 2^length_exponent, their energies over its square and per mass."""
    problem = RegistrationProblem(scale * AXES, scale * AXES, weights=np.full(6, 2.0))
    found = plainly(problem)
    scene = scene_document(found, Names(source="a", target="b", labels=None))
    exponent = scene["runs"][0]["length_exponent"]

    assert (exponent < 0) == (scale < 1.0)
    assert scene["energy_unit"] == 12.0 * 4.0**exponent
    for told, component in zip(scene["components"], found.equilibria.components, strict=True):
        assert told["level"] * scene["energy_unit"] == pytest.approx(component.energy)
