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
from scipy import stats
from scipy.spatial.transform import Rotation

from certreg.geometry import given_pose
from certreg.problem import RegistrationProblem
from certreg.registration import certify, headlines, misfits
from certreg.registration.ambiguity import narrow_words
from certreg.registration.assessment import NO_SLIP, NOT_TRIED, judged
from certreg.registration.assessment_words import words_of_pose
from certreg.registration.findings import cost_of_rounding, exact_pose, findings
from certreg.registration.misfits import LEVEL, RowNames
from certreg.registration.outlying import OtherPairing, row_fit
from certreg.report.summary import warnings
from certreg.results import PoseVerdict

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.registration import Registration

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
        rows = replace(found, rows=n, far_rows=k, far=tuple(range(k)), left=left)
        return misfits._outlier_words(rows, RowNames(None)) is not None

    last = threshold(told, 1e-12, 0.9)
    p = stats.beta.cdf(last, (3 * (n - k) - 6) / 2, 3 * k / 2)
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
    facts = findings(registration, exact_pose(objective, given), Fraction(0))
    gap = facts.bounds.greatest_gap

    for cost, named in ((gap, True), (gap * 999 / 1000, False)):
        words = words_of_pose(replace(facts, rounding_cost=cost), PoseVerdict.NOT_AN_EQUILIBRIUM)
        assert ("The rounding of its numbers to doubles can cost that much: " in words) == named


def test_an_infinite_bound_is_told_to_be_beyond_the_doubles():
    assert headlines.at_most(math.inf) == headlines.at_least(math.inf) == "(beyond doubles)"


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
    plain, inverse = (cost_of_rounding(found, given, inverse=k) for k in (False, True))
    back = found.pose.inverse()
    x, y = (cloud.mean(axis=0) for cloud in (found.problem.source, found.problem.target))

    for cost, pose, centre in ((plain, found.pose, x), (inverse, back, y)):
        halves = np.array([math.ulp(entry) / 2 for entry in pose.rotation.ravel()]).reshape(3, 3)
        moved = np.array([math.ulp(entry) / 2 for entry in pose.translation])
        away = moved + halves @ np.abs(centre)
        least = 9.0 * float(away @ away)
        assert least <= float(cost) * (1 + 1e-9)
        assert float(cost) <= 1.01 * least + 1e4 * float((halves**2).sum())


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
        return misfits._fits_better(OtherPairing(words="", rows=rows, left=left))

    last = threshold(better, 1e-12, 0.499)
    bounds = [
        max(
            stats.chi2.cdf(cut := degrees * last ** (k / 32), degrees),
            stats.chi2.sf(cut / last, degrees),
        )
        for k in range(1, 32)
    ]
    assert 3 * 2 * min(bounds) == pytest.approx(LEVEL, rel=1e-4)
