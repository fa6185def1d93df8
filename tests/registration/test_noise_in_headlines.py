"""First lines where the noise says less than the proof, or the data lie near a tie."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from commands import checked
from scipy.special import chdtri
from strategies import random_rotation

from certreg.problem.problem import RegistrationProblem
from certreg.registration import headlines as listed
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.findings import FIT_WARNED, SigmaDistance, rules_out
from certreg.registration.headlines import headline_words, is_green, is_loose
from certreg.registration.misfits import LEVEL
from certreg.report.cards import GREEN
from certreg.report.document import result_document
from certreg.report.judged_pose import assessment_document, assessment_summary
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.summary import registration_summary
from certreg.results import Limits, Optimality

if TYPE_CHECKING:
    from certreg.registration.result import Registration

RNG = np.random.default_rng(21)
CLOUD = RNG.normal(size=(12, 3))
R = random_rotation(RNG)
TARGET = CLOUD @ R.T + [1.0, 2.0, 3.0] + 0.01 * RNG.normal(size=(12, 3))
ROD = np.c_[np.linspace(-1.0, 1.0, 8), 1e-6 * RNG.normal(size=(8, 2))]
SEEN = ROD @ R.T + 0.01 * RNG.normal(size=(8, 3))
X = np.array([1.0, 0.0, 0.0])


def proof(source: object, target: object, **noise: object) -> Registration:
    problem = RegistrationProblem(source, target, **noise)  # type: ignore[arg-type]
    return certify(problem, relaxation=False, simulation=False)


@pytest.fixture(scope="module")
def fine() -> Registration:
    return proof(CLOUD, TARGET, sigma=0.01)


@pytest.fixture(scope="module")
def loose() -> Registration:
    """A sigma of ten times the cloud's size."""
    return proof(CLOUD, TARGET, sigma=10.0)


@pytest.fixture(scope="module")
def rod() -> Registration:
    return proof(ROD, SEEN)


def moved(registration: Registration, by: float) -> str:
    """The headline of the optimal pose after a shift."""
    pose = registration.pose
    return assess(registration, pose.rotation, pose.translation + by * X).headline


# Nearly ambiguous --------------------------------------------------------------------------------


def test_a_good_pose_of_nearly_ambiguous_data_says_so_first(rod: Registration):
    optimal, near = moved(rod, 0.0), moved(rod, 1e-4)

    assert headline_words(rod).startswith("CERTIFIED, BUT NEARLY AMBIGUOUS: ")
    assert optimal.startswith("OPTIMAL TO ROUNDING, BUT NEARLY AMBIGUOUS: within ")
    assert near.startswith("NEAR-OPTIMAL, BUT NEARLY AMBIGUOUS: within ")
    for line in (optimal, near):
        words = "a very different pose costs little more beside the range of energies"
        assert line.endswith(f"(proved); {words}.")
    assert not assess(rod, rod.pose).green


# A pose that the noise rules out -----------------------------------------------------------------


def test_a_near_optimal_pose_that_the_noise_rules_out_says_so_first(fine: Registration):
    """A shift of 0.02 is sqrt(12) * 0.02 / 0.01 = 6.93 standard deviations, of 0.01 half that."""
    out, within = moved(fine, 0.02), moved(fine, 0.01)

    assert out.startswith("NEAR-OPTIMAL, BUT THE NOISE RULES IT OUT: within ")
    assert out.endswith(" above the minimum (proved); 6.93 standard deviations from the optimum.")
    assert within.startswith("NEAR-OPTIMAL: within ")
    assert moved(proof(CLOUD, TARGET), 0.02).startswith("NEAR-OPTIMAL: within ")  # no sigma


@pytest.mark.parametrize("dof", [3, 6])
def test_the_noise_rules_out_what_is_as_likely_as_a_millionth(fine: Registration, dof: int):
    edge = math.sqrt(chdtri(dof, LEVEL))
    far, near = (SigmaDistance(value=k * edge, dof=dof, p=0.0) for k in (1.0001, 0.9999))

    assert rules_out(fine, far)
    assert not rules_out(fine, near)
    assert rules_out(fine, SigmaDistance(value=1e300, dof=dof, p=0.0))


def test_a_sigma_that_is_too_small_rules_nothing_out(fine: Registration):
    """The residuals are larger, by as little as no warning tells; or by a hundred."""
    small, tiny = (proof(CLOUD, TARGET, sigma=sigma) for sigma in (0.006, 1e-4))
    factor = small.solution.covariance.variance_factor  # type: ignore[union-attr]

    assert not small.fit.warnings
    assert checked(factor) > 1.5
    edge = math.sqrt(chdtri(6, LEVEL) * checked(factor))
    far, near = (SigmaDistance(value=k * edge, dof=6, p=0.0) for k in (1.0001, 0.9999))
    assert (rules_out(small, far), rules_out(small, near)) == (True, False)
    for shift in (0.01, 0.03):
        assert moved(tiny, shift).startswith("NEAR-OPTIMAL, BUT THE FIT IS POOR: ")
    assert "RULES IT OUT" not in moved(fine, 0.0)


@pytest.mark.parametrize("warned", ["outlier-rows", "chi2", "scale"])
def test_the_noise_rules_no_pose_out_where_the_fit_has_a_warning(warned: str):
    """A row, sigma or the scale is wrong: the true pose may be off by more than the noise."""
    target, sigma = TARGET * (1.05 if warned == "scale" else 1.0), 0.01
    target[5] += 0.3 if warned == "outlier-rows" else 0.0
    found = proof(CLOUD, target, sigma=1e-4 if warned == "chi2" else sigma)
    judged = assess(found, found.pose.rotation, found.pose.translation + 0.03 * X)
    summary = assessment_summary(judged)

    assert warned in [code.value for code in found.fit.codes]
    assert judged.headline.startswith("NEAR-OPTIMAL, BUT "), judged.headline
    assert "RULES IT OUT" not in judged.headline
    assert "probability" not in summary
    assert "sigma distance     not known: the fit has a warning" in summary
    assert assessment_document(judged)["sigma_distance"] is None
    assert assessment_document(judged)["reasons"]["sigma_distance"] == FIT_WARNED.reason


# A rotation that is hardly determined ------------------------------------------------------------


def test_a_rotation_that_the_given_noise_leaves_open_is_not_green(
    loose: Registration, fine: Registration, monkeypatch: pytest.MonkeyPatch
):
    axis = listed.axis_words(loose.solution.covariance.loosest_axis)  # type: ignore[union-attr]
    open_turn = (
        "five standard deviations of the sigma given rule out no turn about the source's axis "
        f"{axis}"
    )
    line = headline_words(loose)

    assert line.startswith("CERTIFIED, BUT THE ROTATION IS HARDLY DETERMINED: the global optimum ")
    assert line.endswith(f"; {open_turn}.")
    assert not is_green(loose)
    assert GREEN not in loose._repr_html_()
    with monkeypatch.context() as patched:
        patched.setattr(
            "certreg.report.any_report.rendered", lambda *_, **given: str(given["good"])
        )
        assert html_page(Report.of(loose)) == b"False\n"
        assert html_page(Report.of(fine)) == b"True\n"
    assert "next equilibrium" not in registration_summary(loose)  # said already
    judged = assess(loose, loose.pose)
    assert judged.headline.startswith("OPTIMAL TO ROUNDING, BUT THE ROTATION IS HARDLY DETERMINED")
    assert judged.headline.endswith(f"; {open_turn}.")
    assert result_document(loose)["margin"]["hardly_determined"] is True


@pytest.mark.parametrize(("sigma", "open_turn"), [(0.399, False), (0.401, True)])
def test_a_turn_is_open_where_the_half_turn_is_within_five_deviations(
    sigma: float, *, open_turn: bool
):
    """Points at +-1 on the axes: l1 - l2 = 8 / sigma^2, and sigma_phi^2 = 2 / (l1 - l2)."""
    axes = np.vstack([np.eye(3), -np.eye(3)])
    registration = proof(axes, axes, sigma=2.0 * sigma)
    covariance, margin = registration.solution.covariance, registration.equilibria.margin

    assert covariance is not None
    assert covariance.loosest_sigma == pytest.approx(sigma)
    assert is_loose(registration) == open_turn == (2.0 * (margin.eigenvalue_gap or 0.0) < 25.0)


def test_residuals_leave_a_turn_open_too_but_not_those_of_a_fit_that_is_warned_of():
    source = np.array([[0.0, 0, 0], [2, 0, 0], [0, 0.2, 0], [2, 0, 0.2]])
    noise = np.array([[0.1, 0, 0], [-0.1, 0.2, 0], [0, -0.2, 0.1], [0, 0.1, -0.2]])
    wide = proof(source, source + noise)

    assert is_loose(wide)
    assert "deviations of noise as large as the residuals rule out no turn" in headline_words(wide)
    shuffled = proof(CLOUD, TARGET[::-1])
    assert shuffled.fit.warnings
    assert not is_loose(shuffled)
    assert not is_loose(proof(CLOUD, CLOUD))  # residuals of zero hold no noise


def test_a_card_is_green_within_the_usual_limits_only(fine: Registration):
    wide = replace(proof(CLOUD + 1e16, TARGET + 1e16), limits=Limits(max_gap=0.9))

    assert is_green(fine)
    assert GREEN in fine._repr_html_()
    assert wide.status is Optimality.CERTIFIED
    assert not is_green(wide)
    assert GREEN not in wide._repr_html_()


def test_a_card_of_a_pose_is_green_where_nothing_speaks_against_it(fine: Registration):
    pose = fine.pose
    shifted = pose.translation + 1e-6 * X

    assert GREEN in assess(fine, pose)._repr_html_()
    assert GREEN not in assess(fine, pose.rotation, shifted)._repr_html_()
