"""What a fit is worth: known answers, misfits with their codes, and silence where all is well."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from commands import checked
from scipy import special

from benchmarks.rates import fit_warnings as rates
from benchmarks.rates.fit_warnings import MEASURED, fit
from certreg.objective.isotropic import Isotropic
from certreg.problem import arrays as problems
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration import fit as fit_module
from certreg.registration import misfits, outlying
from certreg.registration.examples import STORIES, stated
from certreg.registration.misfits import ChiSquared, FitCode, FitSums
from certreg.results import Absent

RNG = np.random.default_rng(17)
CLOUD = RNG.standard_normal((12, 3))
NOISY = CLOUD + 0.01 * RNG.standard_normal((12, 3))
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def said(source, target, **options):
    return fit(RegistrationProblem(source, target, **options))


def by_hand(source, target, weights):
    """R^2, s, E and E_s from plain sums and SciPy's rotation."""
    from scipy.spatial.transform import Rotation

    shares = weights / weights.sum()
    x, y = source - shares @ source, target - shares @ target
    R = Rotation.align_vectors(y, x, weights)[0].as_matrix()
    a = np.sum(weights[:, None] * y * (x @ R.T))
    sxx, syy = (np.sum(weights[:, None] * points**2) for points in (x, y))
    return a**2 / (sxx * syy), a / sxx, sxx + syy - 2 * a, syy - a**2 / sxx


def test_the_numbers_are_those_of_plain_sums():
    weights = RNG.uniform(0.5, 2.0, 12)
    target = 1.3 * NOISY @ TURN.T + [5.0, 6.0, 7.0]
    result = said(CLOUD, target, weights=weights)
    explained, scale, energy, scaled = by_hand(CLOUD, target, weights)
    degrees = 3 * weights.sum() ** 2 / (weights @ weights) - 7
    t = math.sqrt(degrees * (energy - scaled) / scaled)

    assert result.explained == pytest.approx(explained, rel=1e-9)
    assert result.best_scale == pytest.approx(scale, rel=1e-9)
    assert result.scale_p == pytest.approx(2 * special.stdtr(degrees, -t), rel=1e-6, abs=0.0)


def test_chi_squared_is_the_objective_under_the_given_noise():
    result = said(CLOUD, NOISY, sigma=0.01)
    _, _, energy, _ = by_hand(CLOUD, NOISY, np.full(12, 1e4))

    assert result.chi2 is not None
    assert (result.chi2.value, result.chi2.dof) == (pytest.approx(energy, rel=1e-9), 30)
    assert result.chi2.p == pytest.approx(special.chdtrc(30, energy), rel=1e-6)
    assert said(CLOUD, NOISY).absent["chi2"] == fit_module.NO_NOISE


def test_the_noise_beyond_sigma_is_told_as_a_length():
    result = said(CLOUD, NOISY, sigma=1e-3)
    (text,) = [one.text for one in result.warnings if one.code is FitCode.CHI2]
    assert "independent Gaussian noise of this sigma gives less than once in a million" in text
    times = float(text.removeprefix("the residuals are ").split(" times ")[0])

    assert times**2 * checked(result.chi2).dof == pytest.approx(
        checked(result.chi2).value, rel=0.02
    )


@pytest.mark.parametrize(
    ("value", "told"), [(1.0037**2, "1.0037"), (1.04**2, "1.040"), (1.21, "1.1"), (144.0, "12")]
)
def test_how_much_larger_residuals_are_is_told_in_digits_that_tell_it_from_one(value, told):
    assert misfits._times_sigma(ChiSquared(value=30 * value, dof=30, p=1e-9)) == told


def test_worst_rows_have_labels_and_their_residuals():
    target = NOISY.copy()
    target[4] += [0.0, 3.0, 0.0]
    labels = tuple(f"P{k}" for k in range(12))
    result = fit(RegistrationProblem(CLOUD, target), labels)

    assert (result.worst[0].row, result.worst[0].label, len(result.worst)) == (4, "P4", 10)
    assert result.worst[0].residual > 2.0
    assert (result.largest_over_median_residual or 0.0) > outlying.FAR
    assert "row 4 (P4)" in result.warnings[0].text

    also = fit(RegistrationProblem(CLOUD, target, sigma=0.01))
    assert [one.code for one in also.warnings] == [FitCode.OUTLIER_ROWS, FitCode.CHI2]
    assert also.outlier_rows == result.outlier_rows == (4,)


@pytest.mark.parametrize("misfit", MEASURED, ids=lambda misfit: misfit.name)
def test_misfits_have_the_right_code(misfit):
    for case, result in rates.misfits(misfit, 4):
        assert rates.is_right(misfit, case, result), rates.texts(result)


@pytest.mark.slow
def test_good_problems_raise_no_alarm():
    assert list(rates.alarms(40)) == []


@pytest.mark.slow
def test_good_problems_raise_no_alarm_where_few_rows_weigh_more():
    assert list(rates.weighted_alarms(40)) == []


def test_a_scale_is_seen_where_weights_differ():
    weights = np.array([1.0] * 4 + [0.3] * 8)

    assert said(CLOUD, 1.3 * NOISY, weights=weights).codes == (FitCode.SCALE,)
    few = np.array([1.0] * 3 + [1e-9] * 9)
    assert said(CLOUD, 1.3 * NOISY, weights=few).codes == ()  # three rows fit anything
    assert said(CLOUD, 1.3 * NOISY, sigma=1.0 / np.sqrt(few)).codes == (FitCode.SCALE,)


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("n", [4, 5, 7])
def test_few_points_raise_no_alarm_though_some_rows_are_far(n):
    """Half of them always agree on a pose: only the number of ways to choose them tells."""
    far = 0
    for seed in range(60):
        rng = np.random.default_rng([n, seed])
        source = rng.standard_normal((n, 3))
        result = said(source, source + 0.1 * rng.standard_normal((n, 3)))
        far += (result.largest_over_median_residual or 0.0) > 2.0
        assert result.warnings == ()
    assert far > 0


@pytest.mark.parametrize("story", STORIES, ids=lambda story: story.name)
def test_packaged_pairs_raise_no_alarm(story):
    assert fit(stated(story)).warnings == ()


def test_a_scale_that_is_certain_and_removes_little_raises_no_alarm():
    """As between real clouds of many points: Student's test alone would warn."""
    rng = np.random.default_rng(4)
    source = rng.standard_normal((2000, 3))
    result = said(source, 1.003 * source + 0.02 * rng.standard_normal((2000, 3)))

    assert 0.0 < (result.scale_p or 0.0) < misfits.LEVEL
    assert result.warnings == ()


def test_noise_as_large_as_the_cloud_is_a_poor_fit():
    target = CLOUD + 1.5 * np.random.default_rng(3).standard_normal((12, 3))
    target[:, 0] *= 3.0  # of another shape: nobody shuffled it

    result = said(CLOUD, target)
    assert result.codes == (FitCode.POOR_FIT,)
    assert "or the noise is large beside them" in result.warnings[0].text


def test_a_fit_without_a_pairing_is_not_told_to_be_scaled():
    source = np.random.default_rng(5).standard_normal((200, 3))
    shuffled = np.random.default_rng(6).permutation(0.9 * source)
    result = said(source, shuffled)

    assert (result.scale_p or 0.0) < misfits.LEVEL
    assert FitCode.SCALE not in result.codes


@pytest.mark.parametrize("offset", [0.0, 1e6, 1e12])
@pytest.mark.parametrize("scale", [1e-120, 1.0, 1e120])
def test_residuals_at_rounding_raise_no_alarm(offset, scale):
    turn = np.linalg.qr(np.random.default_rng(1).standard_normal((3, 3)))[0]
    source = scale * (CLOUD @ (turn * np.linalg.det(turn)).T + offset)
    result = said(source, scale * CLOUD, sigma=scale * 1e-30)

    assert result.warnings == ()
    assert result.absent["scale_p"] == fit_module.ROUNDED


def test_residuals_above_rounding_are_told_apart_from_it():
    assert said(CLOUD, CLOUD * (1.0 + 1e-9)).codes == (FitCode.SCALE,)


def test_of_two_points_chi_squared_tests_the_distance():
    lengths = [np.linalg.norm(cloud[1] - cloud[0]) for cloud in (CLOUD, NOISY)]
    result = said(CLOUD[:2], NOISY[:2], sigma=0.1)
    value = (lengths[1] - lengths[0]) ** 2 / 2 / 0.1**2

    assert checked(result.chi2).dof == 1
    assert checked(result.chi2).value == pytest.approx(value)
    assert result.scale_p is None


def test_one_point_explains_nothing_that_could_be_tested():
    result = said(CLOUD[:1], NOISY[:1], sigma=0.01)

    assert (result.scale_p, result.chi2, result.warnings) == (None, None, ())
    assert result.absent["chi2"] == fit_module.TOO_FEW
    assert isinstance(result.stated("scale_p"), Absent)


def test_three_points_are_enough_for_all_numbers():
    assert said(CLOUD[:3], NOISY[:3], sigma=0.01).absent == {}


@pytest.mark.parametrize("target", [CLOUD, np.ones((12, 3))], ids=["spread", "coincident"])
@pytest.mark.parametrize("source", [CLOUD, np.zeros((12, 3))], ids=["spread", "coincident"])
def test_coincident_points_explain_nothing(source, target):
    result = said(source, target)
    coincident = not (source.any() and (target != 1.0).any())

    assert (result.explained is None) == coincident
    assert (result.best_scale is None) == (not source.any())
    assert result.warnings == ()


def test_rows_without_weight_do_not_count():
    weights = np.ones(12)
    target = NOISY.copy()
    weights[7], target[7] = 0.0, 1e9
    result = said(CLOUD, target, weights=weights)
    others = said(np.delete(CLOUD, 7, axis=0), np.delete(target, 7, axis=0))

    assert result.warnings == ()
    assert (result.scale_p, result.explained) == (others.scale_p, others.explained)
    assert 7 not in {row.row for row in result.worst}


def test_great_weights_make_no_outliers():
    """Noise of one size under weights that say otherwise: in length alone no row is far."""
    weights = np.where(np.arange(12) < 3, 1e6, 1.0)

    assert FitCode.OUTLIER_ROWS not in said(CLOUD, NOISY, weights=weights).codes


@pytest.mark.parametrize("scale", [(1e150, 1e150), (1e-150, 1e-150), (1.0, 1e300)])
def test_units_of_any_size_are_judged_alike(scale):
    here, there = scale
    target = NOISY.copy()
    target[5] += 20.0
    result = said(here * CLOUD, there * target)

    assert result.explained == pytest.approx(said(CLOUD, target).explained, rel=1e-12)
    assert result.largest_over_median_residual is not None


def test_numbers_beyond_the_doubles_are_absent_with_a_reason():
    result = said(1e-300 * CLOUD, 1e300 * NOISY)

    assert result.stated("best_scale") == fit_module.OUT_OF_RANGE


def test_one_row_in_many_is_named_though_no_sample_holds_it():
    n = 3 * outlying.SAMPLE_ROWS
    source = np.random.default_rng(2).standard_normal((n, 3))
    target = source + 0.01 * np.random.default_rng(3).standard_normal((n, 3))
    target[9999] += 1.0
    result = said(source, target)

    assert (result.codes, result.outlier_rows) == ((FitCode.OUTLIER_ROWS,), (9999,))


def test_rows_of_all_blocks_are_named(monkeypatch):
    monkeypatch.setattr(problems, "BLOCK_POINTS", 7)
    source = np.random.default_rng(2).standard_normal((40, 3))
    target = source + 0.01 * np.random.default_rng(3).standard_normal((40, 3))
    target[3] += 1.0
    target[30] += 2.0
    result = said(source, target)

    assert (result.codes, result.outlier_rows) == ((FitCode.OUTLIER_ROWS,), (30, 3))
    assert "rows 30, 3, counting from 0, do not fit" in result.warnings[0].text


@pytest.mark.parametrize(
    ("scale", "units"),
    [
        (1000.0, "millimetres against metres"),
        (1e-3, "millimetres against metres"),
        (0.3048, "feet against metres"),
        (1 / 0.3048, "feet against metres"),
    ],
)
def test_units_that_differ_are_named_whichever_cloud_is_the_larger(scale, units):
    (warning,) = said(CLOUD, scale * NOISY).warnings

    assert warning.code is FitCode.SCALE
    assert f" times as large as the source ({units}?), " in warning.text


def test_a_chain_that_is_one_row_on_fits_well_and_is_told():
    """Neighbours are near: more than 99 % are explained, and the next row fits better."""
    chain = np.cumsum(np.random.default_rng(1).standard_normal((400, 3)), axis=0)
    noise = 0.01 * np.random.default_rng(2).standard_normal((399, 3))
    result = said(chain[:-1], chain[1:] + noise)

    assert (result.explained or 0.0) > 0.99
    assert result.codes == (FitCode.SHUFFLED,)
    assert "one row earlier over 99.9 % of the squared residuals" in result.warnings[0].text


@pytest.mark.slow
def test_p_values_of_the_scale_are_uniform_where_it_is_one():
    found = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        source = rng.standard_normal((5, 3))
        found.append(said(source, source + 0.01 * rng.standard_normal((5, 3))).scale_p)

    steps = np.linspace(0.0, 1.0, 61)  # of Kolmogorov and Smirnov
    apart = max((steps[1:] - np.sort(found)).max(), (np.sort(found) - steps[:-1]).max())
    assert special.kolmogorov(math.sqrt(60) * apart) > 1e-3


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize(("moved", "parameters"), [([1, 1, 1], 6), ([1, 0, 0], 5), ([0, 0, 0], 3)])
def test_chi_squared_has_a_degree_less_for_each_number_that_moves_the_source(
    moved: list[int], parameters: int
):
    """The mean of 400 sums is within four of its deviations, sqrt(2 dof / 400), of the degrees."""
    rng, source = np.random.default_rng(11), np.array(CLOUD)[:4] * moved
    degrees, values = 12 - parameters, list[float]()
    for _ in range(400):
        problem = RegistrationProblem(source, source + rng.normal(size=(4, 3)) / 1e4)
        sums = FitSums(Isotropic(exact_moments(problem)))
        assert problem.motion.parameters - sums.free_turns == parameters
        values.append(float(sums.energy) * 1e8)

    assert abs(np.mean(values) - degrees) < 4 * math.sqrt(2 * degrees / 400)


def test_points_on_a_line_have_five_parameters():
    line = np.array(CLOUD)[:4] * [1, 0, 0]

    assert checked(said(line, line + 1e-4, sigma=1e-4).chi2).dof == 7


@pytest.mark.parametrize(
    ("power", "words"),
    [
        (307, "1e+307 times as large as the source"),
        (450, "over 1e+308 times as large as the source"),
        (-450, "under 1e-308 times as large as the source"),
    ],
)
def test_a_scale_beyond_the_doubles_is_told_by_a_bound(power, words):
    assert misfits._times_words(Fraction(10) ** power) == words


@pytest.mark.slow
def test_light_rows_are_not_blamed_where_two_heavy_ones_carry_the_fit():
    """Noise of all rows alike, relative weights: two rows of weight 1 leave nothing to test by."""
    blamed = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        source = rng.standard_normal((29, 3))
        source[-3:] *= 60.0
        weights = np.r_[1.0, 1.0, np.full(27, 1e-5)]
        target = source + 1e-3 * rng.standard_normal((29, 3))
        blamed += FitCode.OUTLIER_ROWS in said(source, target, weights=weights).codes
    assert blamed == 0
