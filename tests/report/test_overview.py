"""The first screen: which pose, how sure, how good the fit is, and no more than is known."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from commands import checked
from strategies import ZOO, random_rotation

from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.registration.covariance import NO_RESIDUALS
from certreg.report.markup import rendered
from certreg.report.overview import Overview
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.picture import BODY, registration_picture
from certreg.report.uncertainty import chi2_words, told_to, uncertainty_rows
from certreg.report.viewer import told_rmse
from certreg.results import Limits, Optimality

if TYPE_CHECKING:
    from certreg.registration.result import Registration


NUMBER = r"[-\d.e+]+"
QUIET = (
    "The tests for a wrong scale, outlying rows, shuffled rows and a mirror image raise no warning."
)


def registered(*, n: int = 40, noise: float = 0.01, sigma: float | None = None) -> Registration:
    rng = np.random.default_rng(n)
    source = rng.normal(size=(n, 3)) * [3.0, 2.0, 1.0]
    target = source @ random_rotation(rng).T + [100.0, -20.0, 3.0]
    problem = RegistrationProblem(source, target + noise * rng.normal(size=(n, 3)), sigma=sigma)
    return certify(problem, relaxation=False, simulation=False)


def numbers(words: str) -> list[float]:
    return [float(number) for number in re.findall(NUMBER, words)]


def visible(registration: Registration) -> str:
    """The words of a page without its data and what the checker said, to the letter."""
    page = html_page(Report.of(registration)).decode().split("<body>")[1]
    return re.sub(r"<(script|pre)\b.*?</\1>", "", page, flags=re.DOTALL)


def test_the_deviations_are_those_of_the_terminal_and_no_proof():
    registration = registered()
    facts = Overview.of(registration).pose.facts
    told = dict(uncertainty_rows(registration))

    assert [fact.name for fact in facts if "±" not in fact.name] == [
        *("Rotation", "Axis", "Centre", "Translation")
    ]
    sure = [fact for fact in facts if "±" in fact.name]
    for fact, row in zip(sure, ("rotation ±", "centre ±", "translation ±"), strict=True):
        assert fact.name.lower() == row
        assert fact.words == told[row].partition("  (")[0]
    words = Overview.of(registration).pose.uncertainty
    assert words.startswith(f"± is {told['± is']}. ")
    assert words.endswith(" Statistics, not proved.")


def test_the_pose_is_told_to_the_digits_that_its_deviation_leaves():
    registration = registered()
    rotation, axis, _, _, _, translation, _ = Overview.of(registration).pose.facts
    sigmas = np.sqrt(np.diag(np.asarray(checked(registration.solution.covariance)))[:3])
    w, *axial = registration.pose.quaternion_wxyz.tolist()

    assert abs(numbers(translation.value) - registration.pose.translation).max() < sigmas.min() / 9
    assert 4 <= len(translation.value.split(",")[0]) < 10
    assert numbers(rotation.value)[0] == pytest.approx(math.degrees(2 * math.acos(w)), abs=0.01)
    assert re.fullmatch(r"\d+\.\d{2,4}°", rotation.value)
    assert numbers(axis.value) == pytest.approx(np.array(axial) / np.linalg.norm(axial), abs=1e-4)


def test_of_map_coordinates_the_centre_is_told_which_is_as_sure_as_the_points():
    far = np.array([352000.0, 5410000.0, 410.0])
    near = registered().problem
    map_ = RegistrationProblem(near.source + far, near.target + far)
    registration = certify(map_, relaxation=False, simulation=False)
    sure = checked(registration.solution.covariance)
    _, _, _, centre, deviation, _, shift = Overview.of(registration).pose.facts
    told = numbers(centre.value)

    assert abs(told - map_.target.mean(axis=0)).max() < sure.centre_sigma / 9
    assert float(deviation.words.split()[0]) == pytest.approx(sure.centre_sigma, rel=0.05)
    assert float(shift.words.split()[0]) > 1e4 * sure.centre_sigma
    row = dict(uncertainty_rows(registration))["centre ±"]
    assert row.endswith(f" lands at {centre.value[1:-1].replace(',', '')})")


@pytest.mark.parametrize("factor", [1.02, 1000.0, 0.001])
def test_where_a_scale_fits_better_it_is_told_what_the_pose_explains_without_it(factor: float):
    good = registered().problem
    problem = RegistrationProblem(good.source, factor * good.target)
    registration = certify(problem, relaxation=False, simulation=False)
    (told,) = [fact for fact in Overview.of(registration).fit if fact.name == "Explained"]
    spread = ((problem.target - problem.target.mean(axis=0)) ** 2).sum()
    explained = 1.0 - checked(registration.objective) / spread

    if factor < 1.0:
        assert told.value == "nothing"
    else:
        assert float(told.value.split()[0]) == pytest.approx(100.0 * explained, rel=6e-3)
    assert re.search(r"at this scale; 99\.99\d* % with the best one$", told.words)


def test_the_matrix_fits_its_place_whatever_the_translation_is():
    source = registered().problem.source @ random_rotation(np.random.default_rng(3)).T
    problem = RegistrationProblem(source, registered().problem.target - [1.2e13, 0.0, 123456.789])
    rows = Overview.of(certify(problem, relaxation=False, simulation=False)).pose.rows

    assert "e+13" in rows[0]
    assert max(map(len, rows)) <= 46


@pytest.mark.parametrize("sigma", [None, 0.01])
def test_chi_squared_is_told_where_sigma_is_given(sigma: float | None):
    registration = registered(sigma=sigma)
    facts = {fact.name: f"{fact.value} {fact.words}" for fact in Overview.of(registration).fit}
    told = facts.get("Chi-squared")

    assert (told and told.replace("\u00a0", " ")) == chi2_words(registration)
    assert ("Chi-squared" in facts) == (sigma is not None)
    assert ("of the sigma given: 0.01." in Overview.of(registration).pose.uncertainty) == bool(
        sigma
    )


def test_residuals_of_zero_tell_no_uncertainty():
    eye = np.vstack([np.eye(3), -2.0 * np.eye(3)])
    registration = certify(RegistrationProblem(eye, eye), relaxation=False, simulation=False)
    pose = Overview.of(registration).pose

    assert [fact.name for fact in pose.facts] == ["Rotation", "Translation"]  # 0°: no axis
    assert pose.uncertainty == f"Uncertainty not known: {NO_RESIDUALS.reason}."


def test_a_warned_fit_is_marked_and_its_deviations_doubted():
    good = registered()
    target = good.problem.target.copy()
    target[5] += 50.0
    problem = RegistrationProblem(good.problem.source, target)
    poor = certify(problem, relaxation=False, simulation=False)
    quiet, warned = Overview.of(good), Overview.of(poor)

    assert (quiet.mark.kind, quiet.mark.words, quiet.tests) == ("good", "no warning", QUIET)
    assert (warned.mark.kind, warned.mark.words) == ("open", "1 warning, above")
    assert "see the warning" in warned.pose.uncertainty
    assert "warning" not in quiet.pose.uncertainty


MIRROR = np.diag([1.0, 1.0, -1.0])
FLAT = "The tests for a wrong scale, outlying rows and shuffled rows raise no warning. "


@pytest.mark.parametrize(
    ("n", "thick", "said"),
    [
        (3, 1.0, "The tests for a wrong scale and shuffled rows raise no warning. "),
        (30, 0.0, FLAT),
        (30, 1e-4, FLAT),
        (30, 1e-2, QUIET),
    ],
)
def test_a_test_that_could_not_warn_is_not_said_to_raise_no_warning(
    n: int, thick: float, said: str
):
    """A flat cloud, or one no thicker than its noise, fits its mirror image as well."""
    rng = np.random.default_rng(1)
    source = rng.normal(size=(n, 3)) * [1.0, 1.0, thick]
    noise = 1e-3 * rng.normal(size=(n, 3))
    quiet, mirrored = (
        certify(RegistrationProblem(source, each), relaxation=False, simulation=False)
        for each in (source + noise, source @ MIRROR + noise)
    )

    tests = Overview.of(quiet).tests
    assert tests.startswith(said)
    rest = {3: "Those for outlying rows and a mirror image", 30: "That for a mirror image"}
    assert tests.endswith("." if said == QUIET else f". {rest[n]} can tell nothing here.")
    assert bool(mirrored.fit.codes) == (said == QUIET)


def test_beside_a_verdict_that_is_not_good_no_warning_is_not_green():
    bounded = Overview.of(replace(registered(), limits=Limits(max_gap=0.0)))

    assert (bounded.mark.kind, bounded.mark.words) == ("plain", "no warning")


def test_of_too_few_points_nothing_is_said_to_be_tested():
    points = np.array([[0.0, 0, 0], [1, 0, 0]])
    few_ = certify(RegistrationProblem(points, 2.0 * points), relaxation=False, simulation=False)
    overview = Overview.of(few_)

    assert (overview.mark.kind, overview.mark.words) == ("plain", "not tested")
    assert overview.tests.startswith("Not tested: ")


@pytest.mark.one_in(4)
@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_no_headline_ends_in_a_colon_and_no_backtick_is_seen(specimen):
    page = visible(certify(specimen.problem, relaxation=False, simulation=False))
    (headline,) = re.findall(r"<h1>(.*?)</h1>", page)

    assert re.search(r"[\w)][.?]$", headline)
    assert "`" not in page


def test_of_a_bounded_pose_the_rmse_told_is_that_of_the_optimum():
    """Far from the origin the pose that is printed fits worse than the exact one."""
    rng = np.random.default_rng(7)
    source = np.array([4.1e6, 3.3e6, 5.1e6]) + 1e-3 * rng.standard_normal((10, 3))
    target = source @ random_rotation(rng).T
    bounded = certify(source, target, relaxation=False, simulation=False, max_gap=1e-30)
    rmse = bounded.equilibria.components[0].rmse

    assert bounded.status is Optimality.BOUNDED
    assert bounded.rmse != rmse
    assert told_rmse(bounded) == rmse


def test_a_bounded_pose_is_not_called_the_best_on_the_first_screen():
    bounded = replace(registered(), limits=Limits(max_gap=0.0))
    first = visible(bounded).split('id="rests"')[0]

    assert "BOUNDED" in first
    assert not re.search(r"best (?:pose|motion|rotation)|[Tt]he global optimum, and", first)


@pytest.mark.parametrize(
    ("value", "sigma", "words"),
    [
        (999.80268, 0.1934, "999.80"),
        (999.80268, 19.0, "1000"),
        (-1e-9, 0.02, "0.000"),
        (1.0, 1e-30, "1.0"),
        (1e300, 1.0, "1e+300"),
        (1.0, math.inf, "1"),
        (2.5, 0.0, "2.5"),
    ],
)
def test_a_value_has_the_decimals_of_its_deviation(value: float, sigma: float, words: str):
    assert told_to(value, sigma) == words


@pytest.mark.parametrize("n", [BODY, BODY + 1])
def test_the_picture_of_few_points_has_lines_to_them(n: int):
    picture = checked(registration_picture(registered(n=n)))
    drawn = rendered("report/templates/picture.html", picture=picture)
    inside = all(-1 <= float(x) <= picture.width + 1 for line in picture.spokes for x in line[::2])

    assert (len(picture.rings), len(picture.spokes)) == (n, n if n == BODY else 0)
    assert [line[2:] for line in picture.spokes] == list(picture.rings[: len(picture.spokes)])
    assert drawn.count("<line") == n + len(picture.spokes)
    assert inside


def test_the_picture_shows_what_a_mirrored_cloud_is_off():
    source = registered().problem.source * [1.0, 1.0, 0.3]
    problem = RegistrationProblem(source, source * [1.0, 1.0, -1.0])
    picture = checked(registration_picture(certify(problem, relaxation=False, simulation=False)))
    x1, y1, x2, y2 = np.array(picture.springs, dtype=float).T

    assert np.hypot(x2 - x1, y2 - y1).max() > 10.0
