"""What is said of a fit and of a pose in rare cases: thresholds, reasons, remedies."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from scipy import special
from scipy.spatial.transform import Rotation

from certreg.errors import ContradictionError, InvalidProblemError
from certreg.exact.decimals import at_least, at_most
from certreg.geometry.given import given_pose
from certreg.geometry.so3 import davenport_matrix
from certreg.problem import arrays
from certreg.problem.motion import Motion
from certreg.problem.problem import RegistrationProblem
from certreg.registration import misfits
from certreg.registration.agreement import agreement, require_sound_trajectory
from certreg.registration.ambiguity import narrow_words
from certreg.registration.assessment import NO_SLIP, NOT_TRIED, judged
from certreg.registration.assessment_words import words_of_pose
from certreg.registration.certification import certify
from certreg.registration.closed_form import register
from certreg.registration.covariance import effective_rows
from certreg.registration.exit_codes import worst
from certreg.registration.findings import exact_pose, findings
from certreg.registration.fit import COINCIDENT, NO_SOURCE, ZERO_MEDIAN
from certreg.registration.landscape import AssessmentSettings, linear_rounding_cost
from certreg.registration.misfits import LEVEL, FitCode
from certreg.registration.outlying import SAMPLE_ROWS, OtherPairing, row_fit
from certreg.registration.row_names import RowNames
from certreg.report.lines import warnings
from certreg.results import Absent, PoseVerdict

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.registration.result import Registration


RNG = np.random.default_rng(31)
SOURCE = RNG.standard_normal((9, 3)) * [3.0, 2.0, 1.0]
TARGET = SOURCE @ Rotation.from_rotvec([0.3, -0.4, 1.2]).as_matrix().T + [7.0, 8.0, 9.0]
NOISY = TARGET + 0.01 * RNG.standard_normal((9, 3))
REFLECTION = np.diag([1.0, 1.0, -1.0])
ROUNDING = "the rounding of the translation to doubles costs more than a millionth of the fit"


def solved(source: Any, target: Any, **options: Any) -> Registration:
    problem = RegistrationProblem(source, target, **options)
    return certify(problem, relaxation=False, simulation=False)


@pytest.fixture(scope="module")
def registration() -> Registration:
    return solved(SOURCE, NOISY)


def threshold(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Where a property that holds at `low` alone ends."""
    assert holds(low)
    assert not holds(high)
    for _ in range(24):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


@pytest.mark.parametrize(("n", "k"), [(9, 1), (9, 3), (40, 5)])
def test_outlying_rows_are_told_where_all_sets_of_all_sizes_are_counted(
    registration: Registration, n: int, k: int
):
    """Below LEVEL over k (k + 1) times n over k sets, by SciPy's beta distribution."""
    found = checked(
        row_fit(registration.problem, registration.solution.objective, registration.pose)
    )

    def told(left: float) -> bool:
        rows = replace(
            found, rows=n, independent_rows=float(n), far_rows=k, far=tuple(range(k)), left=left
        )
        return misfits._outlier_words(rows, RowNames(None)) is not None

    last = threshold(told, 1e-12, 0.9)
    p = special.betainc((3 * (n - k) - 6) / 2, 3 * k / 2, last)
    assert p * math.comb(n, k) * k * (k + 1) == pytest.approx(LEVEL, rel=1e-5)


def test_random_pairings_explain_less_by_a_row_less_than_there_are(
    monkeypatch: pytest.MonkeyPatch,
):
    """C has variance 1 / (n - 1): of 5 and of 17 rows that count, shares are as 16 to 4."""
    monkeypatch.setattr(misfits, "RANDOM_PAIRINGS", 256)
    shape = np.array([1.0, 2.0, 3.0]) / 6.0

    def most(rows: float) -> float:
        given: Any = SimpleNamespace(second_moments=(shape, shape), effective_rows=rows)

        def random(explained: float) -> bool:
            sums: Any = SimpleNamespace(explained=explained)
            return misfits._as_random(sums, given)

        return threshold(random, 0.01, 10.0)

    assert most(5.0) / most(17.0) == pytest.approx(4.0, rel=1e-6)


def test_no_slip_is_said_to_be_tried_where_nothing_is_certified(registration: Registration):
    solution = replace(registration.solution, certificate=None)
    uncertified = replace(registration, solution=solution, verdict=None, bounds=None)
    pose = given_pose(REFLECTION, None)

    assert judged(uncertified, pose).stated("slip") == NOT_TRIED
    assert judged(registration, pose).stated("slip") == NO_SLIP


def test_rounding_is_named_as_the_cause_up_to_what_it_can_cost(registration: Registration):
    given = given_pose(np.hstack([registration.pose.rotation, [[9.0], [9.0], [9.0]]]), None)
    objective = registration.solution.objective
    pose = exact_pose(objective, given, objective.moments.source_centroid)
    facts = findings(registration, pose, Fraction(0), AssessmentSettings())
    gap = facts.bounds.greatest_gap

    for cost, named in ((gap, True), (gap * 999 / 1000, False)):
        costly = replace(facts, rounding_cost=cost)
        words = words_of_pose(costly, PoseVerdict.NOT_AN_EQUILIBRIUM, given)
        assert ("The rounding of its numbers to doubles can cost that much: " in words) == named


def test_an_infinite_bound_is_told_to_be_beyond_the_doubles():
    assert at_most(math.inf) == at_least(math.inf) == "(beyond doubles)"


TURN = np.array([[3.0, -4.0, 0.0], [4.0, 3.0, 0.0], [0.0, 0.0, 5.0]])  # five times a rotation
CORNERS = np.array([[0, 0, 0], [3, 0, 0], [0, 2, 0], [0, 0, 1], [1, 1, 1]], dtype=float)


def test_the_rounding_of_an_exact_fit_is_held_against_the_next_equilibrium():
    """The minimum is zero, and any rounding more than it; the next equilibrium is 194 above."""
    found = solved(5.0 * CORNERS, CORNERS @ TURN.T)
    gap = checked(found.equilibria.margin.eigenvalue_gap)

    assert checked(found.equilibria.components[0].energy) < 1e-50 * gap
    for cost, noted in ((0.9e-6 * gap, False), (1.1e-6 * gap, True)):
        bounds: Any = SimpleNamespace(gap_lower=cost, greatest_gap=Fraction(cost))
        told = warnings(replace(found, bounds=bounds), "")
        assert any(ROUNDING in words for words in told) == noted


def test_a_rounding_finer_than_any_data_is_not_noted():
    """A line turned exactly: the minimum is zero and there is no gap to hold anything against."""
    source = np.outer(np.arange(4.0), [5.0, 10.0, 15.0])
    found = solved(source, source @ TURN.T / 5.0)

    assert checked(found.equilibria.components[0].energy) < 1e-50
    assert found.equilibria.margin.eigenvalue_gap == 0.0
    assert checked(found.bounds).gap_lower > 0.0
    assert not any(ROUNDING in words for words in warnings(found, ""))


def test_near_optimal_and_not_unique_is_said_of_a_pose_that_is_both():
    line = np.outer([-3.0, -1.0, 0.0, 4.0], [1.0, 2.0, 2.0])
    found = solved(line, line)
    for off, stamp in ((0.0, "OPTIMAL TO ROUNDING"), (1e-3, "NEAR-OPTIMAL")):
        turn = Rotation.from_rotvec([off, 0.0, 0.0]).as_matrix()
        pose = judged(found, given_pose(turn, None))
        assert pose.headline.startswith(stamp), pose.headline
        assert "infinitely many" in pose.headline


def test_a_small_margin_is_told_without_an_rmse_that_no_double_holds(registration: Registration):
    found = registration.equilibria
    best, following, *others = found.components
    margin = replace(found.margin, relative=1e-4)
    for here, there in ((None, 2.0), (1.0, None), (1.0, 2.0)):
        components = (replace(best, rmse=here), replace(following, rmse=there), *others)
        words = narrow_words(
            replace(found, margin=margin, components=components, next_ruled_out=True)
        )
        assert ("(RMSE 1 instead" in checked(words)) is False
        assert ("(RMSE 2 instead of 1)" in checked(words)) == (None not in (here, there))


def test_the_inverse_is_rounded_about_the_centroid_that_it_moves():
    """A target far from the origin: as the inverse the pose is written for it, at its lever."""
    found = solved(SOURCE, NOISY + np.array([1e9, 0.0, 0.0]))
    given = given_pose(np.hstack([np.eye(3), [[1.0], [2.0], [3.0]]]), None)
    plain, inverse = (linear_rounding_cost(found, given, inverse=k) for k in (False, True))
    back = found.pose.inverse()
    x, y = (cloud.mean(axis=0) for cloud in (found.problem.source, found.problem.target))

    for cost, pose, centre in ((plain, found.pose, x), (inverse, back, y)):
        halves = np.array([math.ulp(entry) / 2 for entry in pose.rotation.ravel()]).reshape(3, 3)
        moved = np.array([math.ulp(entry) / 2 for entry in pose.translation])
        away = moved + halves @ np.abs(centre)
        least = 9.0 * float(away @ away)
        assert least <= float(cost) * (1 + 1e-9)
        assert float(cost) <= 1.01 * least + 1e4 * float((halves**2).sum())


@pytest.mark.slow
def test_rows_that_are_far_by_chance_are_none_of_the_outliers():
    """Of few points one is soon six medians off: no warning, and no row is marked."""
    rng = np.random.default_rng(5)
    far = 0
    for _ in range(9):
        cloud = rng.standard_normal((5, 3))
        found = solved(cloud, cloud + 0.01 * rng.standard_normal((5, 3)))
        rows = checked(row_fit(found.problem, found.solution.objective, found.pose))
        far += rows.far_rows > 0
        assert (found.fit.outlier_rows, found.fit.codes) == ((), ())
    assert far > 0


@pytest.mark.parametrize("rows", [4, 9, 30])
def test_another_pairing_fits_better_by_what_its_rows_allow(rows: int):
    """Three pairings are tried, of 3 n - 6 degrees of freedom each, dependent in any way."""
    degrees = 3 * rows - 6

    def better(left: float) -> bool:
        return misfits._fits_better(OtherPairing(words="", rows=rows, left=left), Motion())

    last = threshold(better, 1e-12, 0.499)
    bounds = [
        max(
            special.chdtr(degrees, cut := degrees * last ** (k / 32)),
            special.chdtrc(degrees, cut / last),
        )
        for k in range(1, 32)
    ]
    assert 3 * 2 * min(bounds) == pytest.approx(LEVEL, rel=1e-4)


@pytest.mark.parametrize("name", ["sigma", "weights"])
def test_rows_that_count_effectively_are_fewer_where_weights_differ(name: str):
    """Each row carries the objective where its noise was given; a shape is that of the weights."""
    values = np.array([1.0, 1.0, 2.0, 2.0, 1.0, 3.0, 1.0, 2.0, 4.0])
    w = 1.0 / values**2 if name == "sigma" else values
    found = solved(SOURCE, NOISY, **{name: values})
    rows = checked(row_fit(found.problem, found.solution.objective, found.pose))

    effective = w.sum() ** 2 / (w @ w)
    assert rows.effective_rows == pytest.approx(effective, rel=1e-12)
    assert rows.independent_rows == pytest.approx(9.0 if name == "sigma" else effective, rel=1e-12)


def test_a_block_without_weight_changes_nothing_of_how_many_rows_count(
    monkeypatch: pytest.MonkeyPatch,
):
    w = np.array([0.0, 0.0, 0.0, 5.0, 1.0, 2.0, 0.0, 0.0, 3.0])
    problem = RegistrationProblem(SOURCE, NOISY, weights=w)
    monkeypatch.setattr(arrays, "BLOCK_POINTS", 3)

    assert effective_rows(problem) == pytest.approx(121.0 / 39.0, rel=1e-14)


def test_rows_without_weight_are_none_of_another_pairing():
    w = np.array([1.0, 0.0, 2.0, 0.0, 1.0, 3.0, 1.0, 1.0, 2.0])
    y = np.roll(NOISY, 1, axis=0)  # row i of the source is row i + 1 of the target
    found = solved(SOURCE, y, weights=w)
    rows = checked(row_fit(found.problem, found.solution.objective, found.pose))

    other = checked(rows.other_pairing)
    assert (other.words, other.rows) == ("one row later", 6)


def test_of_equally_bad_rows_the_first_come_first():
    axes = np.vstack([np.eye(3), -np.eye(3)])
    fit = solved(axes, 3.0 * axes).fit

    assert [(one.row, one.residual) for one in fit.worst] == [(row, 2.0) for row in range(6)]


@pytest.mark.slow
def test_the_median_of_many_rows_is_not_that_of_the_first():
    n = 3 * SAMPLE_ROWS
    rng = np.random.default_rng(9)
    cloud = rng.standard_normal((n, 3))
    size = np.where(np.arange(n) < SAMPLE_ROWS, 1e-4, 1e-2)
    off = size[:, None] * rng.standard_normal((n, 3))
    fit = solved(cloud, cloud + off).fit
    distances = np.linalg.norm(off, axis=1)

    ratio = distances.max() / np.median(distances)
    assert checked(fit.largest_over_median_residual) == pytest.approx(ratio, rel=0.1)


def test_a_median_of_zero_is_said_to_be_one():
    axes = np.vstack([np.eye(3), -np.eye(3)]) * [[1.0], [2.0], [3.0], [1.0], [2.0], [3.0]]
    target = axes.copy()
    target[[0, 3]] *= 1.5
    fit = solved(axes, target).fit

    assert [one.residual for one in fit.worst] == [0.5, 0.5, 0.0, 0.0, 0.0, 0.0]
    assert fit.stated("largest_over_median_residual") == ZERO_MEDIAN


def test_which_cloud_lies_at_one_place_is_said_of_each_number():
    here, there = SOURCE, np.ones((9, 3))
    for source, target, scale, scale_p in (
        (there, here, NO_SOURCE, NO_SOURCE),
        (there, there, NO_SOURCE, NO_SOURCE),
        (here, there, 0.0, COINCIDENT),
    ):
        fit = solved(source, target).fit
        assert fit.stated("explained") == COINCIDENT
        assert (fit.stated("best_scale"), fit.stated("scale_p")) == (scale, scale_p)


@pytest.mark.parametrize(("other", "told"), [(0.015, "shuffled"), (0.025, "outlier-rows")])
def test_fewer_rows_must_leave_half_of_what_another_cause_leaves(
    registration: Registration, other: float, told: str
):
    found = checked(
        row_fit(registration.problem, registration.solution.objective, registration.pose)
    )
    pairing = OtherPairing(words="", rows=9, left=other)
    causes: Any = {code: code.value for code in (FitCode.OUTLIER_ROWS, FitCode.SHUFFLED)}
    sums: Any = SimpleNamespace(mirrored_share=1.0)
    rows = replace(found, left=0.01, other_pairing=pairing)

    assert list(misfits._likeliest(causes, sums, rows).values()) == [told]


@pytest.mark.slow
def test_what_random_pairings_explain_is_that_of_rotations_alone(monkeypatch: pytest.MonkeyPatch):
    """In the median: the largest eigenvalue of Davenport's matrix, of other random matrices."""
    monkeypatch.setattr(misfits, "CHANCE", 0.5)
    shape = np.full(3, 1.0 / 3.0)
    crosses = np.random.default_rng(77).standard_normal((4096, 3, 3)) / 3.0 / math.sqrt(49.0)
    largest = [np.linalg.eigvalsh(davenport_matrix(C.tolist()))[-1] for C in crosses[:2000]]
    median = float(np.median(largest))
    rows: Any = SimpleNamespace(second_moments=(shape, shape), effective_rows=50.0)

    for times, random in ((0.985, True), (1.015, False)):
        sums: Any = SimpleNamespace(explained=(times * median) ** 2)
        assert misfits._as_random(sums, rows) == random


def test_of_many_optima_a_translation_is_held_against_the_nearest():
    line = np.outer([-3.0, -1.0, 0.0, 4.0], [1.0, 2.0, 2.0])
    for source, which in ((line, "the nearest optimal one"), (SOURCE, "the optimal one")):
        pose = given_pose(np.hstack([np.eye(3), [[50.0], [60.0], [70.0]]]), None)
        slip = checked(judged(solved(source, source), pose).slip)
        assert f"degrees from {which}, its translation 105 from the best" in slip.words


def test_what_a_user_says_of_clouds_goes_before_what_their_files_are_called():
    found = certify(
        SOURCE, NOISY, relaxation=False, simulation=False, about={"source": "mine", "more": 1}
    )
    about = checked(found.certificate).about
    assert (about["source"], about["target"], about["more"]) == ("mine", "target", 1)


@pytest.mark.parametrize("converged", [True, False])
def test_a_run_that_rests_elsewhere_contradicts_and_one_that_was_stopped_does_not(
    registration: Registration,
    converged: bool,  # noqa: FBT001
):
    run: Any = SimpleNamespace(quaternion=np.array([0.0, 0.0, 1.0, 0.0]), converged=converged)
    solution = registration.solution

    def compared() -> Any:
        return agreement(
            registration.problem, solution.objective, relaxation=Absent("no"), trajectory=run
        )

    if converged:
        with pytest.raises(ContradictionError, match="the simulation contradicts"):
            compared()
    else:
        q = [0, 0, 1, 0]
        assert compared().simulation == solution.objective.angle_to_optimum(q)


def test_a_run_may_end_below_its_certificate_by_what_that_leaves_open(registration: Registration):
    objective, q = (
        registration.solution.objective,
        checked(registration.certificate).body.quaternion,
    )
    weight = float(objective.moments.total_weight)
    least, gap = float(objective.energy(q)), Fraction(1, 1000)
    body: Any = SimpleNamespace(quaternion=q, gap=gap)

    def run(*energies: float) -> Any:
        return SimpleNamespace(
            length_exponent=0,
            states=np.zeros((len(energies), 18)),
            steps=1,
            scales=None,
            potential=np.array(energies) / weight,
        )

    require_sound_trajectory(objective, body, run(least - 0.0009))
    for energies in ((least - 0.0011,), (least + 1.0, least - 0.0011, least)):
        with pytest.raises(ContradictionError, match="below the certified minimum"):
            require_sound_trajectory(objective, body, run(*energies))


def test_where_both_happen_bad_input_comes_before_a_refusal():
    assert [worst(codes) for codes in ([1, 2], [1, 4, 3], [3, 0], [])] == [2, 1, 3, 0]


def test_an_exact_fit_almost_on_a_line_is_not_nearly_ambiguous():
    """There is no noise at all that could turn it over, small as the margin is."""
    source = np.outer(np.arange(9.0), [1.0, 0.0, 0.0])
    source[:, 1] = 0.01 * RNG.integers(-4, 5, 9)
    source[:, 2] = 0.01 * RNG.integers(-4, 5, 9)
    found = solved(source, source).equilibria

    assert found.narrow
    assert not found.nearly_ambiguous


def test_numbers_longer_than_doubles_are_taken_where_doubles_hold_them():
    source, target = (cloud.astype(np.longdouble) for cloud in (SOURCE, NOISY))
    assert register(source, target).rotation.tolist() == register(SOURCE, NOISY).rotation.tolist()
    if np.finfo(np.longdouble).nmant > 52:
        with pytest.raises(InvalidProblemError, match="no double holds exactly"):
            register(source / np.longdouble(3), target)


def test_the_cloud_at_fault_is_named():
    good, bad = np.zeros((3, 3)), np.zeros((3, 2))
    for clouds, name in (((bad, good), "source"), ((good, bad), "target"), ((bad, bad), "source")):
        with pytest.raises(InvalidProblemError, match=f"^{name} has shape") as caught:
            register(*clouds)
        assert caught.value.array == name


@pytest.mark.parametrize(("longer", "alike"), [(0.1999, True), (0.2001, False)])
def test_clouds_are_of_one_shape_where_they_are_as_long_along_each_axis(
    longer: float, *, alike: bool, monkeypatch: pytest.MonkeyPatch
):
    """Flat against thick: squared lengths hide it, 0.2^2 being 0.04 of the size."""
    monkeypatch.setattr(misfits, "RANDOM_PAIRINGS", 64)
    flat, thick = np.array([0.0, 0.3, 0.7]), np.array([longer**2, 0.3, 0.7])
    rows: Any = SimpleNamespace(second_moments=(flat, thick), effective_rows=5.0)
    sums: Any = SimpleNamespace(explained=0.0)

    assert misfits._as_random(sums, rows) == alike
