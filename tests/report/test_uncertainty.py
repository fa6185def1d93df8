"""What is said of a pose's uncertainty: the numbers of the covariance, and where there are none."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from answers import answered
from commands import certreg, write_csv
from scipy.special import chdtrc
from strategies import TETRAHEDRON

from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.registration.fit import ChiSquared
from certreg.registration.loose_turns import LOOSE_SIGMA
from certreg.registration.misfits import FitCode
from certreg.report.cards import registration_card
from certreg.report.document import pose_document, result_document
from certreg.report.overview import Overview
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.summary import registration_summary
from certreg.report.uncertainty import (
    FINE,
    FIRST_ORDER,
    PLAIN_BELOW,
    SURE_SIGMA,
    SWUNG,
    centre_words,
    chi2_words,
    rotation_words,
    shift_sigmas,
    shift_words,
    told_to,
    turn_sigmas,
    two_digits,
    uncertainty_rows,
)

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.registration.covariance import PoseCovariance
    from certreg.registration.result import Registration

RNG = np.random.default_rng(17)
CLOUD = RNG.normal(size=(12, 3)) + np.array([3.0, 0.0, -2.0])
NOISE = RNG.normal(size=(12, 3))


def registered(target: Any, source: Any = CLOUD, **noise: Any) -> Registration:
    problem = RegistrationProblem(source, target, **noise)
    return certify(problem, relaxation=False, simulation=False)


@pytest.fixture(scope="module")
def given() -> Registration:
    return registered(CLOUD + 0.01 * NOISE, sigma=0.01)


@pytest.fixture(scope="module")
def estimated() -> Registration:
    return registered(CLOUD + 0.01 * NOISE)


def rows(registration: Registration) -> dict[str, str]:
    return dict(uncertainty_rows(registration))


def covariance_of(registration: Registration) -> PoseCovariance:
    covariance = registration.solution.covariance
    assert covariance is not None
    return covariance


def near(words: str, values: Any) -> bool:
    """Whether these are the first numbers of a text, to two digits."""
    told = [float(word) for word in words.split()[: len(values)]]
    return bool(np.allclose(told, values, rtol=0.05))


def test_the_numbers_are_the_roots_of_the_covariance_and_sigma_is_as_given(given):
    told, covariance = rows(given), covariance_of(given)
    sigma = np.sqrt(np.diag(np.asarray(covariance)))

    assert list(told) == ["centre ±", "rotation ±", "translation ±", "± is", "chi-squared"]
    assert near(told["translation ±"], sigma[:3])
    assert near(told["rotation ±"], np.degrees(sigma[3:]))
    assert told["centre ±"].startswith("0.0029 along every axis  (the centre of the source lands")
    assert covariance.centre_sigma == pytest.approx(0.01 / math.sqrt(12))
    assert told["rotation ±"].endswith(" degrees  (a small turn about the source's axes)")
    assert (
        told["± is"]
        == "one standard deviation, to first order, of independent errors of the sigma given: 0.01"
    )
    p = chdtrc(30, given.objective or 0.0)
    assert told["chi-squared"].endswith(f" with 30 degrees of freedom, p = {p:.2g}")


def test_without_sigma_it_comes_from_the_residuals_and_says_how_sure_it_is(estimated):
    told, covariance = rows(estimated), covariance_of(estimated)
    sigma = math.sqrt((estimated.objective or 0.0) / 30)

    assert "chi-squared" not in told
    basis, _, rest = told["± is"].partition(": sigma ")
    assert basis == "one standard deviation, to first order, from the residuals"
    assert near(rest, [sigma])
    assert rest.endswith(
        " ± 13 %, 30 degrees of freedom, if errors are independent, Gaussian, of one size"
    )
    assert near(told["translation ±"], covariance.translation_sigma)


def test_weights_alone_are_relative_and_sigma_is_that_of_the_mean_weight(estimated):
    weights = np.linspace(1.0, 3.0, 12)
    even = rows(registered(CLOUD + 0.01 * NOISE, weights=np.full(12, 9.0)))
    uneven = registered(CLOUD + 0.01 * NOISE, weights=weights)
    sigma = math.sqrt((uneven.objective or 0.0) / 30 / weights.mean())

    assert even == rows(estimated)
    _, _, rest = rows(uneven)["± is"].partition(": sigma ")
    assert near(rest, [sigma])
    assert " at the mean weight ± 13 %" in rest
    assert rest.endswith(", if errors are independent, Gaussian, as large as the weights say")


def test_of_a_poor_fit_no_deviation_is_told():
    wrong = CLOUD + 0.01 * NOISE
    wrong[4] += 300.0

    told = rows(registered(wrong, sigma=0.01))

    assert list(rows(registered(wrong))) == ["uncertainty"]
    assert list(told) == ["uncertainty", "chi-squared"]
    assert told["uncertainty"].startswith("not known: the fit may hold more than noise (see the w")
    assert told["chi-squared"].endswith("p < 1e-300: the residuals are larger than sigma says")


def test_of_a_sigma_that_is_too_small_alone_it_is_not_said_that_there_is_more_than_noise():
    small = registered(CLOUD + 0.01 * NOISE, sigma=1e-9)
    reason = "the residuals are larger than sigma says (see the warning), and ± would be of sigma"

    assert small.fit.codes == (FitCode.CHI2,)
    assert rows(small)["uncertainty"] == f"not known: {reason}"
    reasons = result_document(small)["reasons"]
    assert reasons["pose.uncertainty"] == reasons["pose.covariance"] == reason


def test_a_turn_that_sigma_leaves_open_counts_no_degree_and_p_is_a_bound():
    """Three points of size one, sigma ten: the least of E is chi-squared of nearly 3 n - 3."""
    rng = np.random.default_rng(2)
    source = rng.standard_normal((3, 3))
    found = registered(source + 10.0 * rng.standard_normal((3, 3)), sigma=10.0, source=source)
    test = found.fit.chi2

    assert test is not None
    assert (test.dof, test.bound) == (6, True)
    assert test.p == pytest.approx(chdtrc(6, test.value))
    words = rows(found)["chi-squared"]
    assert "with 6 degrees of freedom at most (sigma leaves a turn open), p at most " in words
    assert result_document(found)["fit"]["chi2"]["bound"] is True


@pytest.mark.parametrize(("length", "dof"), [(0.01, 3), (3.53, 3), (3.54, 1)])
def test_a_line_that_is_not_long_beside_sigma_has_open_turns_too(length: float, dof: int):
    """The turns of two points have the deviation sqrt(2) / length: 0.4 at a length of 3.5355."""
    line = np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]])
    noise = np.random.default_rng(3).standard_normal((2, 3))
    test = registered(line + noise, sigma=1.0, source=line).fit.chi2

    assert test is not None
    assert (test.dof, test.bound) == (dof, dof == 3)
    assert test.p == pytest.approx(chdtrc(dof, test.value))


def test_a_sigma_that_is_far_too_large_is_told(given):
    def words(p: float) -> str:
        made = ChiSquared(value=1.0, dof=30, p=p)
        return chi2_words(answered(given, fit=replace(given.fit, chi2=made))) or ""

    assert words(1 - 0.9 * SURE_SIGMA).endswith(": the residuals are smaller than sigma says")
    assert words(1 - 1.1 * SURE_SIGMA).endswith("p = 1")
    assert rows(registered(CLOUD + 0.01 * NOISE, sigma=1.0))["chi-squared"].endswith("sigma says")


@pytest.mark.parametrize(
    ("p", "told"),
    [(0.12, "0.12"), (math.nextafter(0.125, 1.0), "0.13"), (0.1201, "0.13"), (0.0, "1e-300")],
)
def test_a_bound_on_p_is_rounded_up(given, p: float, told: str):
    made = ChiSquared(value=1.0, dof=30, p=p, bound=True)
    words = chi2_words(answered(given, fit=replace(given.fit, chi2=made))) or ""

    assert words.endswith(f"p at most {told}")


def test_small_turns_are_in_arc_seconds_and_large_ones_no_longer_small(given):
    covariance = covariance_of(given)

    def words(sigma: float) -> str:
        sigmas = np.array([math.sqrt(0.5) * sigma, math.sqrt(0.5) * sigma, sigma])
        axis = np.array([0.0, 0.0, 1.0])
        changed = {"rotation_sigma": sigmas, "loosest_sigma": sigma, "loosest_axis": axis}
        return rotation_words(replace(covariance, **changed), "")

    assert words(0.99 * FINE).startswith("25 25 36 arc seconds")
    assert words(1.01 * FINE).startswith("0.0071 0.0071 0.010 degrees")
    assert "too large" not in words(0.99 * FIRST_ORDER)
    large = "; a rough figure: a turn so large, about (0, 0, 1), is beyond a first order"
    assert words(1.01 * FIRST_ORDER).endswith(large)
    assert words(0.99 * LOOSE_SIGMA).endswith(large)
    none = "not known: the turn about (0, 0, 1) is hardly determined, far beyond a first order"
    assert words(1.01 * LOOSE_SIGMA) == none


def test_where_a_turn_is_loose_no_deviation_is_told_but_that_of_the_centre(tmp_path: Path):
    """In the terminal, on the page, in the documents and in the file of the pose alike."""
    line = np.outer(np.arange(12.0), [0.6, 0.0, 0.8]) + 1e-3 * NOISE
    problem = RegistrationProblem(line, line + 1e-2 * NOISE[::-1], sigma=0.01)
    found = certify(problem, relaxation=False, simulation=False)
    told, document = rows(found), result_document(found)
    why = "the turn about (0.6, 0, 0.8) is hardly determined, far beyond a first order"

    assert told["rotation ±"] == told["translation ±"] == f"not known: {why}"
    assert told["centre ±"].startswith("0.0029 along every axis")
    sigmas, reasons = document["pose"]["uncertainty"], document["reasons"]
    assert (sigmas["translation"], sigmas["rotation_deg"]) == (None, None)
    assert sigmas["loosest_turn"]["sigma_deg"] is None
    assert sigmas["centre"] == pytest.approx(0.01 / math.sqrt(12))
    names = ("uncertainty.translation", "uncertainty.rotation_deg", "covariance")
    assert all(reasons[f"pose.{name}"] == why for name in names)
    assert pose_document(found)["uncertainty"] == sigmas
    facts = {f"{one.words}{one.value}" for one in Overview.of(found).pose.facts}
    assert f"not known: {why}" in facts
    assert registration_card(found).count(f"not known: {why}") == 2


def test_no_deviation_of_a_translation_is_told_where_its_turn_bends_it(given):
    """Seen from far along one axis: that entry moves by the second order of the turn alone."""
    cloud = CLOUD - CLOUD.mean(axis=0)
    far = cloud + np.array([300.0, 0.0, 0.0])
    moved = certify(RegistrationProblem(far, far, sigma=0.01), relaxation=False, simulation=False)
    covariance = covariance_of(moved)

    assert shift_sigmas(covariance) == SWUNG
    assert isinstance(turn_sigmas(covariance), np.ndarray)
    assert rows(moved)["translation ±"] == f"not known: {SWUNG.reason}"
    assert result_document(moved)["reasons"]["pose.uncertainty.translation"] == SWUNG.reason
    at, of = (replace(covariance_of(given), second_order=k * FIRST_ORDER) for k in (0.99, 1.0))
    assert shift_words(at, "") == two_digits(at.translation_sigma)
    assert shift_words(of, "").startswith("not known")


@pytest.mark.parametrize("springs", [{}, {"normals": np.eye(3)[np.arange(12) % 3]}])
def test_without_a_translation_no_deviation_of_the_centre_is_told(springs: dict[str, Any]):
    """The rotation moves it, too; it is neither 0 nor told where a first order says nothing."""
    points = NOISE + np.array([5.0, 0.0, 0.0])
    found = certify(points, points[::-1], sigma=0.01, rotation_only=True, **springs)
    document = result_document(found)

    assert document["pose"]["uncertainty"]["centre"] is None
    assert document["reasons"]["pose.uncertainty.centre"] == (
        "without a translation the source's mean goes where the rotation takes it"
    )


def test_where_the_centre_lands_is_told_to_its_deviation_at_any_size():
    """The sentence says where: so no digit that its deviation leaves is lost, and none is zero."""
    for scale in (1e-300, 1e-9, 1.0, 1e9, 1e150):
        source = scale * CLOUD
        problem = RegistrationProblem(source, source + 1e-3 * scale * NOISE)
        found = certify(problem, relaxation=False, simulation=False)
        sigma, target = covariance_of(found).centre_sigma, problem.target.mean(axis=0)
        told = [float(word) for word in centre_words(found, covariance_of(found))]
        assert sigma is not None
        assert np.allclose(told, target, rtol=0.0, atol=0.06 * sigma)

    assert told_to(math.nextafter(PLAIN_BELOW, 0.0), 1.0) == "999999999999999.9"
    assert told_to(PLAIN_BELOW, 1.0) == "1000000000000000.0"
    assert told_to(1.25e20, 1e17) == "1.2500e+20"
    assert [told_to(0.3, sigma) for sigma in (1e30, 200.0, 2.0)] == ["0.3", "0.3", "0.3"]
    assert told_to(1.5e-305, 2e-303) == "2e-305"
    assert told_to(0.0, 2e-303) == "0"
    assert told_to(0.1, 1e-15) == "0.1"


def test_where_there_is_none_the_reason_stands_in_its_place(estimated):
    line = np.outer(np.arange(4.0), [1.0, 2.0, 3.0])
    circle = certify(RegistrationProblem(line, line, sigma=0.1), simulation=False, relaxation=False)
    exact = RegistrationProblem(TETRAHEDRON, TETRAHEDRON)
    rounded = certify(exact, simulation=False, relaxation=False)
    told = certify(replace_sigma(exact), simulation=False, relaxation=False)

    none = "not known: the optimum is not unique"
    exactly = "0 with 7 degrees of freedom, p = 1: the residuals are smaller than sigma says"
    assert rows(circle) == {"uncertainty": none, "chi-squared": exactly}
    none = "not known: the residuals are so near rounding that they tell no noise: give sigma"
    assert rows(rounded) == {"uncertainty": none}
    assert rows(told)["± is"].endswith("of the sigma given: 0.1")
    assert f"\n  uncertainty       {none}\n" in registration_summary(rounded)
    assert not estimated.fit.rounded


def replace_sigma(problem: RegistrationProblem) -> RegistrationProblem:
    return RegistrationProblem(problem.source, problem.target, sigma=0.1)


def test_two_digits_are_plain_where_they_can_be():
    numbers = [0.0, 3e-9, 1e-4, 0.0123, 0.996, 9.96, 123.4, 999999.0, 1e6]

    words = "0 3.0e-09 0.00010 0.012 1.00 10.0 123 999999 1.0e+06"
    assert two_digits(numbers) == words
    assert all(
        float(a) == pytest.approx(b, rel=0.05) for a, b in zip(words.split(), numbers, strict=True)
    )


def test_the_terminal_says_it_in_ascii_and_the_page_as_it_is(given):
    text = registration_summary(given)
    page = html_page(Report.of(given)).decode()

    text.encode("ascii")
    for name, words in uncertainty_rows(given):
        plain = [part.replace("±", "+/-") for part in (name, words)]
        assert "\n  {:<17} {}\n".format(*plain) in text
        assert words.partition("  (")[0] in page.replace("\u00a0", " ").replace("</b>", "").replace(
            "<b>", ""
        )


def test_the_document_and_the_pose_file_hold_the_numbers(given, tmp_path: Path):
    told = result_document(given)["pose"]["uncertainty"]
    sigma = np.sqrt(np.diag(np.asarray(covariance_of(given))))
    source, target = tmp_path / "a.csv", tmp_path / "b.csv"
    write_csv(source, CLOUD.tolist())
    write_csv(target, (CLOUD + 0.01 * NOISE).tolist())
    quick = ("--sigma", "0.01", "--no-relaxation", "--no-simulation")

    assert np.array_equal(told["translation"], sigma[:3])
    assert np.array_equal(told["rotation_deg"], np.degrees(sigma[3:]))
    assert told["degrees_of_freedom"] == 30
    assert certreg("certify", source, target, *quick, "--out", tmp_path / "out").code == 0
    pose = json.loads((tmp_path / "out" / "pose.json").read_text("utf-8"))
    assert pose["uncertainty"] == told
    assert pose["words"] == [f"{name}: {words}" for name, words in uncertainty_rows(given)]
    assert np.array_equal(pose["T_target_source"], np.loadtxt(tmp_path / "out" / "pose.txt"))
    judged = certreg("assess", source, target, "--pose", tmp_path / "out" / "pose.json")
    assert judged.code == 0
    assert judged.out.startswith("OPTIMAL")


def test_a_deviation_of_many_rows_is_not_said_to_be_exact():
    rng = np.random.default_rng(8)
    many = rng.standard_normal((20_000, 3))
    told = rows(registered(many, many + 0.1 * rng.standard_normal(many.shape)))["± is"]

    assert " ± 0.3 %, 59994 degrees of freedom" in told
