"""The slip that is named makes the pose optimal, provedly; where none does, none is named."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest
from commands import certreg, checked, write_csv
from strategies import MIRROR, ZOO, random_problem, random_rotation

import certreg as package
from benchmarks.rates import convention_errors
from certreg import Pose, RegistrationProblem, assess, certify
from certreg.geometry.given import given_pose
from certreg.registration.assessment import NO_SLIP, judged
from certreg.registration.convention_errors import SlipCode
from certreg.registration.findings import GOOD
from certreg.registration.loose_turns import TURNED_FAR
from certreg.report.judged_pose import assessment_document, assessment_summary
from certreg.results import PoseVerdict

SAMPLE = 2
PROBLEM = random_problem(np.random.default_rng(21), n=10)
OPTIMUM = package.certify(PROBLEM, relaxation=False, simulation=False).pose
R, T = OPTIMUM.rotation, OPTIMUM.translation


@pytest.mark.one_in(3)
@pytest.mark.parametrize("case", convention_errors.SLIPS, ids=lambda case: case.name)
def test_a_slip_is_named_right(case: convention_errors.SlipCase):
    for said in convention_errors.judged(case, SAMPLE):
        assert convention_errors.is_right(case, said), said.hint


@pytest.mark.slow
def test_of_random_rotations_and_of_tilted_poses_no_slip_is_named():
    assert not list(convention_errors.named_of_random(SAMPLE))


WRONG = {
    "inverse": OPTIMUM.inverse(),
    "transposed": (R.T, T),
    "quaternion-order": (OPTIMUM.quaternion_wxyz[[1, 2, 3, 0]], T),
    "centred": (R, np.zeros(3)),
    "scaled": (1000.0 * R, T),
    "translation": (R, T + np.array([0.0, 5.0, 0.0])),
}


@pytest.mark.parametrize("code", WRONG)
def test_a_slip_is_told_in_text_and_json(code: str):
    found = assess(PROBLEM, WRONG[code])
    slip, document, text = (
        checked(found.slip),
        assessment_document(found),
        assessment_summary(found),
    )

    assert slip.code is SlipCode(code)
    assert found.hint == slip.words
    assert text.splitlines()[2 if found.nearest_index is not None else 1] == slip.words
    verdict = slip.verdict.value
    assert document["slip"] == {"code": code, "verdict": verdict, "words": slip.words}
    assert document["hint"] == slip.words
    assert f" is {verdict}: " in slip.words


@pytest.mark.parametrize("pose", [OPTIMUM.inverse(), None], ids=["inverse", "translation"])
def test_of_two_slips_at_once_it_is_said_that_no_single_one_explains_it(pose: Pose | None):
    """The inverse in other units; and one wrong rotation that is not even near a rotation."""
    wrong = (
        (2.0 * R.T + 0.3, T) if pose is None else (pose.rotation, 1000.0 * pose.translation + 1.0)
    )
    found = assess(PROBLEM, *wrong)
    said = NO_SLIP.reason
    within = "within 0.001 radians, and a millionth of the range of energies, of the optimum"
    assert f"no single slip of those that are tried leads to it from a pose {within}; " in said
    assert "; two at once are not tried" in said

    assert found.slip is found.hint is None
    assert f"\nN{said[1:]}.\n" in f"{assessment_summary(found)}\n"
    assert f"N{said[1:]}.</div>" in found._repr_html_()
    assert assessment_document(found)["reasons"]["slip"] == said


def test_a_good_pose_needs_no_slip():
    found = assess(PROBLEM, OPTIMUM)

    assert found.unexplained is None
    assert "slip" not in assessment_summary(found)


def test_every_code_of_a_slip_is_tried():
    assert set(WRONG) == {code.value for code in SlipCode}


@pytest.mark.parametrize("code", [code for code in WRONG if code != "translation"])
def test_what_is_named_is_proved_by_assessing_that_pose(code: str):
    """Nothing is named of the same slip at a pose that is not optimal."""
    tilt = Pose.from_matrix(
        np.column_stack([random_rotation(np.random.default_rng(3)), [1.0, 2.0, 3.0]])
    )
    wrong = tilt @ OPTIMUM
    spoilt = {
        "inverse": wrong.inverse(),
        "transposed": (wrong.rotation.T, T),
        "quaternion-order": (wrong.quaternion_wxyz[[1, 2, 3, 0]], T),
        "centred": (wrong.rotation, np.zeros(3)),
        "scaled": (1000.0 * wrong.rotation, T),
    }
    found = assess(PROBLEM, spoilt[code])

    assert found.verdict not in GOOD
    assert found.slip is None
    assert "no single slip" in assessment_document(found)["reasons"]["slip"]


@pytest.mark.parametrize("degrees", [0.057, 0.058, 3.0])  # 1e-3 radians are 0.0573
def test_a_slip_is_named_of_a_pose_off_by_what_few_digits_lose_and_not_of_one_farther_off(
    degrees: float,
):
    off = Pose.from_matrix(np.eye(4)[:3])
    half = math.radians(degrees) / 2
    c, s = math.cos(2 * half), math.sin(2 * half)
    turn = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0]])
    x, y = PROBLEM.source.mean(axis=0), PROBLEM.target.mean(axis=0)
    tilted = (Pose.from_matrix(turn) @ off).rotation @ R
    found = assess(PROBLEM, Pose.from_matrix(np.column_stack([tilted, y - tilted @ x])).inverse())

    assert (found.slip is not None) == (degrees == 0.057)
    if found.slip is not None:
        assert found.slip.verdict is PoseVerdict.NEAR_OPTIMAL


@pytest.mark.parametrize(("shift", "code"), [(0.0, SlipCode.TRANSLATION), (1e6, SlipCode.CENTRED)])
def test_few_decimals_are_named_before_a_slip_that_may_explain_the_same(
    shift: float, code: SlipCode
):
    """Five decimals at 1e7 (1, 1, 1) can cost 150; the pose is that of centred clouds, too."""
    source = PROBLEM.source + 1e7
    problem = RegistrationProblem(source, source @ R.T + shift)
    slip = checked(assess(problem, R.round(5), np.zeros(3)).slip)

    assert slip.code is code
    assert ("writing its entries with 5 decimals" in slip.words) == (shift == 0.0)


@pytest.mark.parametrize(("offset", "decimals", "said"), [(1e8, 6, True), (0.0, 6, False)])
def test_of_a_pose_with_few_digits_far_away_it_is_said_how_far_it_is_off(
    offset: float, decimals: int, *, said: bool
):
    far = RegistrationProblem(PROBLEM.source + offset, PROBLEM.target + offset)
    pose = certify(far, relaxation=False, simulation=False).pose
    shift = pose.translation + (0.0 if said else 1.0)
    slip = checked(assess(far, pose.rotation.round(decimals), shift.round(decimals)).slip)

    assert slip.code is SlipCode.TRANSLATION
    assert "nothing is wrong" not in slip.words
    told = re.search(
        r": its rotation is (\S+) degrees from the optimal one, its translation (\S+) from the "
        r"best one for it(; writing its entries with 6 decimals can cost as much, so far from the "
        r"origin)?\.$",
        slip.words,
    )
    degrees, distance, lever = checked(told).groups()
    assert float(degrees) < 1e-4
    assert float(distance) == pytest.approx(math.sqrt(3.0), rel=0.01) if not said else True
    assert (lever is not None) == said


@pytest.mark.parametrize(("share", "explains"), [(0.99, True), (1.01, False)])
def test_few_digits_explain_a_shift_up_to_what_they_can_cost(share: float, *, explains: bool):
    """Three decimals, at (200, 300, 400): at most 0.0005 (200 + 300 + 400) = 0.45."""
    corners = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])])
    centre = np.array([200.0, 300.0, 400.0])
    c, s = math.cos(0.1), math.sin(0.1)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    problem = RegistrationProblem(corners + centre, corners @ turn.T + turn @ centre)
    shift = (turn - turn.round(3)) @ centre + [share * 0.45, 0.0, 0.0]
    slip = checked(assess(problem, turn.round(3), shift).slip)

    assert ("writing its entries with 3 decimals" in slip.words) == explains


def test_whole_numbers_are_not_taken_for_few_digits():
    problem = RegistrationProblem(PROBLEM.source + 1e3, PROBLEM.source + 1e3)
    slip = checked(assess(problem, np.eye(3), [9.0, 0.0, 0.0]).slip)

    assert "decimals" not in slip.words


@pytest.mark.one_in(3)
@pytest.mark.parametrize("unit", [1000.0, 100.0, 10.0, 25.4, 0.3048])
def test_a_translation_in_another_unit_is_named_with_its_factor(unit: float):
    result = package.certify(PROBLEM, relaxation=False, simulation=False)
    for factor, times in ((unit, "divided by"), (1.0 / unit, "times")):
        found = assess(result, R, T * factor)

        assert checked(found.slip).code is SlipCode.SCALED
        assert f"its translation {times} {unit:g} is" in checked(found.hint)


@pytest.mark.parametrize("seed", [41, 90])
def test_of_two_slips_that_explain_it_the_one_that_leaves_less_is_named(seed: int):
    """A translation a thousandth as long is all but none, as of clouds moved to their centroids."""
    case = convention_errors.SLIPS[5]
    rng = np.random.default_rng([seed, 5])
    stated = convention_errors.problem(rng)

    assert convention_errors.is_right(case, assess(stated, case.spoil(stated, rng)))


def test_a_good_pose_has_no_slip_even_where_its_inverse_is_as_good():
    cloud = np.vstack([np.diag([3.0, 2, 1]), -np.diag([3.0, 2, 1])])
    found = assess(RegistrationProblem(cloud, cloud), np.eye(3), np.zeros(3))

    assert found.slip is None
    assert "there is no slip to name" in assessment_document(found)["reasons"]["slip"]


@pytest.mark.parametrize("matrix", [np.diag([1.0, 1, -1]), -2.0 * R, R + np.eye(3), 0.0 * R])
def test_of_what_is_no_multiple_of_a_rotation_no_slip_is_named(matrix: np.ndarray):
    found = assess(PROBLEM, matrix, T)

    assert found.verdict is PoseVerdict.NOT_A_ROTATION
    assert found.slip is None
    assert found.optimum_rmse is not None
    assert found.optimum.quaternion_wxyz.tolist() == OPTIMUM.quaternion_wxyz.tolist()


@pytest.mark.one_in(4)
@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_slips_of_every_kind_of_problem_are_tried_without_a_fault(specimen):
    """Where every rotation is optimal, or many are, what is named is optimal all the same."""
    rng = np.random.default_rng(5)
    found = assess(specimen.problem, random_rotation(rng), rng.normal(size=3) + 7.0)

    assert found.verdict not in GOOD
    assert found.slip is None or found.slip.verdict in GOOD
    if specimen.pattern == (4,):
        assert checked(found.slip).code is SlipCode.TRANSLATION


@pytest.mark.parametrize("q", [[0.5, 0, 0, 0], [0.0, 0, 0, 0], [1e300, 1e300, 0, 0]])
def test_a_quaternion_that_is_not_normalised_is_a_scale(q: list[float]):
    cloud = np.diag([3.0, 2, 1])
    found = assess(RegistrationProblem(cloud, cloud), q)

    assert found.verdict is PoseVerdict.NOT_A_ROTATION
    assert (found.slip is not None) == (q[0] == 0.5)


@pytest.mark.parametrize("offset", [0.0, 30.0])
def test_the_distance_in_sigma_is_that_of_the_joint_covariance(offset: float):
    """e^T P^-1 e with the covariance (dt, phi) that `certify` reports; at offsets to first order.

    A rotation moves a centroid at the origin not at all, so that there e is exact.
    """
    rng = np.random.default_rng(6)
    source = rng.normal(size=(15, 3))
    source += offset - source.mean(axis=0)
    target = source @ random_rotation(rng).T + 0.01 * rng.normal(size=(15, 3))
    problem = RegistrationProblem(source, target, sigma=0.01)
    solution = package.certify(problem, relaxation=False, simulation=False).solution
    matrix, pose = np.asarray(checked(solution.covariance)), solution.pose
    for angle, within in ((1e-6, 1e-4), *((a, 1e-7) for a in (1e-3, 0.399) if not offset)):
        phi = rng.normal(size=3)
        phi *= angle / np.linalg.norm(phi)
        half = phi / angle * math.sin(angle / 2)
        turned = pose.rotation @ convention_errors.of_quaternion([math.cos(angle / 2), *half])
        shift = pose.translation + angle * rng.normal(size=3)
        error = np.concatenate([shift - pose.translation, phi])
        expected = math.sqrt(error @ np.linalg.solve(matrix, error))
        only = math.sqrt(phi @ np.linalg.solve(matrix[3:, 3:], phi))
        distance = checked(assess(problem, turned, shift).sigma_distance)
        alone = checked(assess(problem, turned).sigma_distance)

        assert distance.value == pytest.approx(expected, rel=within)
        assert alone.value == pytest.approx(only, rel=within)
        assert (distance.dof, alone.dof) == (6, 3)


@pytest.mark.slow
def test_the_probability_of_a_distance_is_the_tail_of_chi_squared():
    """Drawn noise: the true pose is beyond a distance as often as p says."""
    rng = np.random.default_rng(7)
    source, tails = 3.0 * rng.normal(size=(12, 3)), list[float]()
    for _ in range(30):
        turn = random_rotation(rng)
        target = source @ turn.T + 0.01 * rng.normal(size=source.shape)
        found = assess(RegistrationProblem(source, target, sigma=0.01), turn, np.zeros(3))
        tails.append(checked(found.sigma_distance).p)

    edges = np.sort(tails)
    ranks = (np.arange(30) + 0.5) / 30
    assert np.abs(edges - ranks).max() < 1.95 / math.sqrt(30)  # Kolmogorov and Smirnov: 0.1 %


def test_beyond_a_first_order_there_is_no_distance_and_it_is_said():
    """Of a pose turned far; of one that is loose, unless it is ruled out all the same."""
    cloud = PROBLEM.source
    noisy = RegistrationProblem(cloud, cloud, sigma=0.01)
    loose = RegistrationProblem(cloud, cloud, sigma=1e3)
    far, near = (
        convention_errors.of_quaternion([math.cos(a / 2), math.sin(a / 2), 0, 0])
        for a in (0.401, 0.399)
    )
    told = assess(noisy, far)

    assert told.sigma_distance is None
    words = "\n  sigma distance     not known: the pose is turned too far from the optimum"
    assert words in assessment_summary(told)
    assert assessment_document(told)["reasons"]["sigma_distance"] == TURNED_FAR.reason
    assert assess(noisy, near).sigma_distance is not None
    why = assessment_document(assess(loose, near))["reasons"]["sigma_distance"]
    assert why.endswith("is hardly determined, far beyond a first order")
    assert assess(loose, np.eye(3), np.full(3, 1e9)).sigma_distance is not None


def test_without_a_sigma_there_is_no_distance_and_it_is_said():
    document = assessment_document(assess(PROBLEM, OPTIMUM))
    line = [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]]
    many = assessment_document(assess(RegistrationProblem(line, line, sigma=1.0), np.eye(4)))

    assert document["sigma_distance"] is None
    assert document["reasons"]["sigma_distance"] == "no noise was given: give sigma"
    assert many["reasons"]["sigma_distance"] == "the optimum is not unique"
    assert "standard deviations" not in assessment_summary(assess(PROBLEM, OPTIMUM))


def test_a_distance_is_told_plainly():
    noisy = RegistrationProblem(PROBLEM.source, PROBLEM.target, sigma=0.01)
    text = assessment_summary(assess(noisy, R, T + np.array([0.3, 0.0, 0.0])))

    assert "standard deviations, rotation and translation jointly" in text
    assert "(to first order; if all pairs are right and the errors independent,\n" in text
    assert "far with probability" in text
    assert "standard deviations, of the rotation" in assessment_summary(assess(noisy, R))


def test_an_optimal_pose_with_a_poor_fit_is_not_told_as_plainly_optimal():
    cloud = np.random.default_rng(8).normal(size=(40, 3))
    problem = RegistrationProblem(cloud, cloud @ np.array(MIRROR))
    result = package.certify(problem, relaxation=False, simulation=False)
    found = assess(result, result)

    assert found.verdict is PoseVerdict.OPTIMAL
    assert found.headline.startswith("OPTIMAL TO ROUNDING, BUT THE FIT IS POOR: within")
    assert "the target fits a mirror image of the source better" in found.headline
    assert assessment_document(found)["fit"]["warnings"][0]["code"] == "mirrored"
    assert "  warning  " not in assessment_summary(found)
    near = assess(result, np.round(result.pose.rotation, 5))
    assert near.headline.startswith("NEAR-OPTIMAL, BUT THE FIT IS POOR: within")
    wrong = assessment_summary(assess(result, random_rotation(np.random.default_rng(9))))
    assert "\n  warning            the target fits a mirror image" in wrong
    no_rotation = assessment_summary(assess(result, np.ones((3, 3))))
    assert "\n  warning            the target fits a mirror image" in no_rotation


def test_a_good_fit_that_a_scale_makes_better_is_not_called_poor():
    rng = np.random.default_rng(10)
    cloud = rng.normal(size=(60, 3))
    target = 1.02 * cloud + 0.001 * rng.normal(size=cloud.shape)
    result = package.certify(RegistrationProblem(cloud, target), relaxation=False, simulation=False)
    pose = result.pose.as_matrix()
    better = "BUT A SCALE FITS BETTER: within"

    assert assess(result, result).headline.startswith(f"OPTIMAL TO ROUNDING, {better}")
    assert assess(result, np.round(pose, 7)).headline.startswith(f"NEAR-OPTIMAL, {better}")
    assert "taken as 1.01994 times as large" in assess(result, pose).headline


def test_the_optimum_stands_beside_the_pose(tmp_path):
    document = assessment_document(assess(PROBLEM, np.eye(4)))
    text = assessment_summary(assess(PROBLEM, np.eye(4)))
    certified = package.certify(PROBLEM, relaxation=False, simulation=False)

    assert document["optimum"]["translation"] == T.tolist()
    assert document["optimum"]["rotation"] == R.tolist()
    assert document["optimum"]["rmse"] == certified.rmse
    assert document["rmse"] > 10 * document["optimum"]["rmse"]
    assert f"  of the optimum     {certified.rmse:.6f}" in text
    assert " ".join(map(repr, T.tolist())) in text
    json.dumps(document, allow_nan=False)


@pytest.mark.slow
def test_a_certificate_and_a_line_of_a_trajectory_are_judged(tmp_path):
    files = [
        write_csv(tmp_path / f"{n}.csv", getattr(PROBLEM, n).tolist()) for n in ("source", "target")
    ]
    certreg("certify", *files, "--out", tmp_path, "--no-simulation", "--no-relaxation")
    certificate = certreg("assess", *files, "--pose", tmp_path / "certificate.json")
    kitti = tmp_path / "poses.txt"
    np.savetxt(kitti, [np.eye(4)[:3].ravel(), OPTIMUM.as_matrix()[:3].ravel()], fmt="%.17g")
    chosen = certreg("assess", *files, "--pose", kitti, "--line", 2)
    moved = certreg("apply", kitti, files[0], "--out", tmp_path / "moved.csv", "--line", 2)

    assert (certificate.code, chosen.code, moved.code) == (0, 0, 0)
    assert "Only a rotation was given" in certificate.out
    assert "Only a rotation" not in chosen.out
    assert certreg("assess", *files, "--pose", kitti).code == 2


@pytest.mark.parametrize("scale", [1000.0, 0.015625])
def test_a_similarity_is_told_whatever_its_scale_and_its_translation(scale: float):
    """The translation is that of the pose, scaled as the rotation is, or that of Umeyama."""
    x, y = convention_errors.means(PROBLEM)
    turns = (R, OPTIMUM.quaternion_wxyz)
    poses = [(scale * turn, shift) for turn in turns for shift in (T, scale * T)]
    registration = certify(PROBLEM, relaxation=False, simulation=False)
    for pose in (*poses, (scale * R, y - scale * R @ x)):
        slip = checked(judged(registration, given_pose(pose)).slip)

        assert slip.code is SlipCode.SCALED
        assert slip.words.startswith(f"Its rotation without the scale {scale:g} is ")


@pytest.mark.parametrize("off", [0.99e-4, -0.99e-4])
def test_of_a_rotation_with_few_digits_no_scale_is_named(off: float):
    registration = certify(PROBLEM, relaxation=False, simulation=False)
    words = checked(judged(registration, given_pose(((1.0 + off) * R, T))).slip).words

    assert words.startswith("The rotation nearest to it is ")
    assert words.endswith("optimal: digits may be missing.")
    slip = checked(judged(registration, given_pose(((1.0 + 1.02 * off) * R, T))).slip)
    assert slip.words.startswith("Its rotation without the scale ")
