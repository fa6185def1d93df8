"""Numbers of results in rare cases: each field, fact and word is of what its name says."""

from __future__ import annotations

import base64
import hashlib
import html
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from scipy.spatial.transform import Rotation

from certreg.geometry.given import given_pose
from certreg.problem.motion import MAX_DAMPING, MIN_DAMPING
from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import judged
from certreg.registration.certification import certify
from certreg.registration.enumeration import enumerated
from certreg.registration.linear import CROSS_CHECK
from certreg.registration.simulation import simulate
from certreg.report import any_report, lines, methods, page, summary, thinning, viewer
from certreg.report.cards import assessment_card, registration_card
from certreg.report.document import NOT_A_BOUND, result_document
from certreg.report.equilibria import count_words
from certreg.report.judged_pose import assessment_document, assessment_summary
from certreg.report.page import Report
from certreg.report.reload import MotionOptions
from certreg.report.thinning import FRAMES, thinned
from certreg.report.uncertainty import uncertainty_rows
from certreg.report.viewer import sample_of
from certreg.results import Limits

if TYPE_CHECKING:
    from certreg.registration.result import Registration


RNG = np.random.default_rng(41)
SOURCE = RNG.standard_normal((9, 3)) * [3.0, 2.0, 1.0]
TURN = Rotation.from_rotvec([0.3, -0.4, 1.2])
TARGET = TURN.apply(SOURCE) + [7.0, 8.0, 9.0] + 0.01 * RNG.standard_normal((9, 3))


def solved(source: Any, target: Any, **options: Any) -> Registration:
    problem = RegistrationProblem(source, target, **options)
    return certify(problem, relaxation=False, simulation=False)


@pytest.fixture(scope="module")
def registration() -> Registration:
    return certify(RegistrationProblem(SOURCE, TARGET), simulation=False)


@pytest.fixture(scope="module")
def far() -> Registration:
    """So far from the origin that the pose in doubles costs more than the optimum itself."""
    return solved(SOURCE, TARGET + 1e14)


def test_the_optimum_beside_a_pose_costs_what_it_costs_itself_and_not_its_rounding(
    far: Registration,
):
    best = far.equilibria.components[0]
    assert checked(far.objective) > 1.001 * checked(best.energy)
    pose = judged(far, given_pose(far.pose.T_target_source, None))
    beside: Any = assessment_document(pose)["optimum"]

    assert (pose.optimum_objective, pose.optimum_rmse) == (best.energy, best.rmse)
    assert (beside["objective"], beside["rmse"]) == (best.energy, best.rmse)
    assert pose.objective == pytest.approx(checked(far.objective), rel=1e-12)


def test_each_limit_stands_under_its_own_name(registration: Registration):
    asked = replace(registration, limits=Limits(max_gap=1e-7, max_angle=1e-5))
    limits = result_document(asked)["optimality"]["limits"]

    assert limits == {"gap_share": 1e-7, "angle_rad": 1e-5}


def test_a_multiplier_that_proves_nothing_is_no_number_out_of_range(registration: Registration):
    body = checked(registration.certificate).body
    unproved = replace(body, claims=replace(body.claims, sdp_gap=None))
    certificate = replace(checked(registration.certificate), body=unproved)
    solution = replace(registration.solution, certificate=certificate)
    document = result_document(replace(registration, solution=solution))

    assert document["relaxation"]["proved_gap"] is None
    assert document["reasons"]["relaxation.proved_gap"] == NOT_A_BOUND.reason
    assert result_document(registration)["relaxation"]["proved_gap"] > 0.0


@pytest.mark.parametrize("given", [True, False])
def test_whether_a_turn_is_loose_is_said_beside_a_warning_where_the_noise_was_given(given: bool):  # noqa: FBT001
    target = TARGET.copy()
    target[4] += [0.0, 3.0, 0.0]
    found = solved(SOURCE, target, sigma=0.01 if given else None)
    document = result_document(found)

    assert found.fit.warnings
    assert document["margin"]["hardly_determined"] is (False if given else None)
    assert ("margin.hardly_determined" in document["reasons"]) != given


@pytest.mark.parametrize(
    ("escapes", "words"),
    [
        (0, ""),
        (1, " (kicked off a saddle once)"),
        (2, " (kicked off a saddle 2 times)"),
        (7, " (kicked off a saddle 7 times)"),
    ],
)
def test_kicks_are_counted(escapes: int, words: str):
    assert thinning.kicked_words(escapes) == words


@pytest.mark.parametrize("n", [1, 9, 10, 11, 20, 21])
def test_a_sample_has_as_many_pairs_as_it_may_evenly_chosen(
    monkeypatch: pytest.MonkeyPatch, n: int
):
    monkeypatch.setattr(viewer, "SAMPLE", 10)
    points = np.arange(3.0 * n).reshape(n, 3)
    problem = RegistrationProblem(points, points + 1000.0, weights=np.arange(1.0, n + 1))
    numbers = np.frombuffer(base64.b64decode(sample_of(problem)), "<f8")
    rows = np.arange(0, n, math.ceil(n / 10))
    source, target, weights = np.split(numbers, [3 * len(rows), 6 * len(rows)])

    assert len(rows) <= 10
    assert source.reshape(-1, 3).tolist() == points[rows].tolist()
    assert target.reshape(-1, 3).tolist() == (points[rows] + 1000.0).tolist()
    assert weights.tolist() == (rows + 1.0).tolist()


def test_the_card_of_a_pose_that_is_no_rotation_tells_no_numbers(registration: Registration):
    card = assessment_card(judged(registration, given_pose(np.diag([1.0, 1.0, -1.0]), None)))
    assert "NOT-A-ROTATION" in card
    assert "RMSE" not in card
    assert "RMSE" in assessment_card(judged(registration, given_pose(np.eye(3), None)))


def test_a_pose_is_told_by_as_many_digits_as_its_size_allows():
    for value, told in (
        (0.0, "0.000000"),
        (1e-4, "0.000100"),
        (9.9e-5, "9.900000000e-05"),
        (9999999.0, "9999999.000000"),
        (1e7, "1.000000000e+07"),
        (None, "(beyond doubles)"),
    ):
        assert lines.number(value) == told


@pytest.mark.parametrize(("step", "compared"), [(0.099, True), (0.1, True), (0.11, False)])
def test_a_rate_is_compared_where_the_steps_are_small_enough(
    step: float,
    compared: bool,  # noqa: FBT001
):
    run: Any = SimpleNamespace(step=step, predicted_rate=1.0, decay_rate=0.9)
    words = lines.rate_words(run)
    assert words == (
        "0.9  (predicted 1)" if compared else "0.9  (too few steps to compare with the predicted 1)"
    )
    unknown: Any = SimpleNamespace(step=step, predicted_rate=1.0, decay_rate=None)
    assert lines.rate_words(unknown) == "unknown  (predicted 1)"


def test_what_is_told_apart_is_counted_by_its_kind():
    """Of pattern 1, 2, 1 two points and a circle; of 1, 1, 1, 1 four points."""
    square = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    cases = ((square, "two points and one circle"), (SOURCE, "four points"))
    for cloud, kinds in cases:
        found = solved(cloud, cloud)
        doubtful = replace(found.equilibria, doubt="a search that ended too soon")
        assert f": the search found {kinds}, " in count_words(doubtful)


@pytest.mark.parametrize(
    ("damping", "kept"),
    [
        (MIN_DAMPING, True),
        (MAX_DAMPING, True),
        (MIN_DAMPING / 2, False),
        (MAX_DAMPING * 2, False),
        (2, False),
        ("2.0", False),
    ],
)
def test_a_damping_is_taken_from_a_certificate_up_to_its_limits(damping: Any, *, kept: bool):
    point = RegistrationProblem([[1.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]])
    motion = MotionOptions.of({"damping": damping, "integrator": "euler"}, point)
    assert (motion.damping, motion.integrator) == (
        (damping, "euler") if kept else (None, CROSS_CHECK.value)
    )


def test_where_every_rotation_fits_it_is_said_that_no_motion_was_simulated():
    """The dynamics is defined: it is not what is missing."""
    corners = np.vstack([np.eye(3), -np.eye(3)])
    names = viewer.Names(source="a", target="b", labels=None)
    still = viewer.scene_document(solved(corners, np.ones((6, 3))), names)["still"]
    line = viewer.scene_document(solved(corners[[0, 3]], corners[[0, 3]]), names)["still"]

    assert still == viewer.NO_MOTION + viewer.NOT_SIMULATED
    assert line == viewer.NO_MOTION + viewer.UNDEFINED.format(lie="are on one line")


@pytest.mark.parametrize("embedded", [True, False])
def test_the_file_to_check_is_the_one_that_the_page_gives(*, embedded: bool):
    report: Any = SimpleNamespace(
        name="my certificate.json", embedded=embedded, content=b"x" * (3 << 19)
    )
    file = any_report.file_fields(report)

    assert file["argument"] == ("certificate.json" if embedded else "'my certificate.json'")
    assert (file["name"], file["mebibytes"]) == ("my certificate.json", 1.5)
    assert file["sha256"] == hashlib.sha256(report.content).hexdigest()


@pytest.mark.parametrize(("n", "words"), [(1, "1 pair"), (2, "2 pairs")])
def test_pairs_are_counted_on_the_page(n: int, words: str):
    found = solved(SOURCE[:n], SOURCE[:n])
    assert f"· {words}</p>" in Report.of(found).html().decode()


def test_a_page_without_its_certificate_shows_a_sample(
    registration: Registration, monkeypatch: pytest.MonkeyPatch
):
    report = Report.of(registration)
    names = viewer.Names(source="a", target="b", labels=None)
    assert page._scene(report, registration, names)["sample_data"] is None
    monkeypatch.setattr(any_report, "EMBEDDED_BYTES", 10)
    blocks = page._scene(report, registration, names)
    assert blocks["certificate_data"] is None
    assert blocks["sample_data"] == sample_of(registration.problem)


def test_searches_in_doubt_are_not_said_to_agree():
    found = enumerated(RegistrationProblem(SOURCE, TARGET), "all")
    assert "The roads spectral, groebner, homotopy agree" in methods.methods_summary(found)
    first, second, third = found.searches
    doubtful = replace(checked(second.critical), completeness=None, doubt="groebner: too long")
    spoilt = replace(found, searches=(first, replace(second, critical=doubtful), third))
    told = methods.methods_summary(spoilt)
    assert "The roads spectral, homotopy agree" in told


def test_the_card_says_which_turn_is_too_large_for_a_first_order():
    """Points near a line, whose turn about it is known to twenty degrees."""
    rng = np.random.default_rng(2)
    source = np.outer(np.linspace(-9.0, 9.0, 9), [1.0, 0.0, 0.0])
    source[:, 1] = 0.2 * np.sin(np.arange(9.0))
    sigma = 0.12
    found = solved(source, source + 0.1 * sigma * rng.standard_normal((9, 3)), sigma=sigma)
    words = dict(uncertainty_rows(found))["rotation ±"]
    told = words[words.index("; a rough figure: a turn so large, about") :]

    assert told in summary.registration_summary(found)
    assert told in html.unescape(registration_card(found))


def test_what_the_headline_warns_of_is_told_once():
    target = TARGET.copy()
    target[4] += [0.0, 3.0, 0.0]
    found = solved(SOURCE, target)
    (warning,) = found.fit.warnings

    assert summary.registration_summary(found).count(warning.text) == 1
    assert html.unescape(registration_card(found)).count(warning.text) == 1
    pose = judged(found, given_pose(found.pose.T_target_source, None))
    assert assessment_summary(pose).count(warning.text) == 1


def test_a_motion_is_shown_until_nothing_is_seen_to_move():
    trajectory: Any = simulate(RegistrationProblem(SOURCE, TARGET))
    energy = trajectory.potential + trajectory.kinetic
    still = np.flatnonzero(energy - energy[-1] > 1e-8 * (energy[0] - energy[-1]))[-1] + 1
    run = thinned(trajectory)

    assert (run.times[0], run.times[-1]) == (trajectory.times[0], trajectory.times[still])
    assert still < len(energy) - 1
    assert (run.last, len(run.times)) == (trajectory.times[-1], FRAMES)
    rows = np.searchsorted(trajectory.times, run.times)
    assert run.potential.tolist() == trajectory.potential[rows].tolist()
    assert np.diff(run.times).max() <= 2.0 * run.times[-1] / (FRAMES - 1)
