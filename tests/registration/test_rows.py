"""What the rows say of a fit is what plain sums over them say, in one block and in many."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from benchmarks.rates.fit_warnings import fit
from certreg.problem import arrays as problems
from certreg.problem.posing import PosedPairs
from certreg.problem.problem import RegistrationProblem
from certreg.registration import misfits, outlying
from certreg.registration.certification import certify
from certreg.registration.misfits import FitCode
from certreg.registration.motions import RigidMotion, WeightedPairs
from certreg.registration.outlying import LISTED, OtherPairing, RowFit, row_fit
from certreg.registration.row_names import RowNames

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

N, FAR_ROW = 23, 17
RNG = np.random.default_rng(20)
SOURCE = RNG.standard_normal((N, 3)) * [3.0, 2.0, 1.0] + [40.0, 50.0, 60.0]
TURN = Rotation.from_rotvec([0.3, -0.4, 1.2]).as_matrix()
TARGET = SOURCE @ TURN.T + [7.0, 8.0, 9.0] + 0.01 * RNG.standard_normal((N, 3))
TARGET[FAR_ROW] += [0.0, 2.0, 0.0]
WEIGHTS = RNG.uniform(0.5, 2.0, N)
NO_WEIGHT = np.arange(N) == 4


def least(
    x: NDArray[np.float64], y: NDArray[np.float64], w: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64]]:
    """The least sum of w |y - R x - t|^2 by SciPy's rotation, and the |y - R x - t|."""
    a, b = x - w @ x / w.sum(), y - w @ y / w.sum()
    R = Rotation.align_vectors(b, a, w)[0].as_matrix()
    distances = np.linalg.norm(b - a @ R.T, axis=1)
    return float(w @ distances**2), distances


def rows_of(problem: RegistrationProblem) -> RowFit:
    solution = certify(problem, relaxation=False, simulation=False).solution
    return checked(row_fit(problem, solution.objective, solution.pose))


@pytest.mark.one_in(3)
@pytest.mark.parametrize("block", [5, 8, 10**6])
@pytest.mark.parametrize("scale", [1.0, 1024.0, 1e-100])
def test_the_numbers_of_the_rows_are_those_of_plain_sums(
    monkeypatch: pytest.MonkeyPatch, block: int, scale: float
):
    monkeypatch.setattr(problems, "BLOCK_POINTS", block)
    w = np.where(NO_WEIGHT, 0.0, WEIGHTS)
    found = rows_of(RegistrationProblem(scale * SOURCE, scale * TARGET, weights=w))
    here = ~NO_WEIGHT
    energy, distances = least(SOURCE[here], TARGET[here], w[here])
    numbers, others = np.flatnonzero(here), here & (np.arange(N) != FAR_ROW)
    order = np.argsort(-distances)[:LISTED]

    assert (found.rows, found.far, found.far_rows) == (N - 1, (FAR_ROW,), 1)
    assert found.effective_rows == pytest.approx(w.sum() ** 2 / (w @ w), rel=1e-12)
    assert [one.row for one in found.worst] == numbers[order].tolist()
    assert [one.distance for one in found.worst] == pytest.approx(
        (scale * distances[order]).tolist(), rel=1e-9
    )
    assert found.largest_over_median == pytest.approx(distances.max() / np.median(distances))
    left = least(SOURCE[others], TARGET[others], w[others])[0] / energy
    assert found.left == pytest.approx(left, rel=1e-6)
    for moments, cloud in zip(found.second_moments, (SOURCE, TARGET), strict=True):
        values = np.linalg.eigvalsh(np.cov(cloud[here].T, bias=True))
        size = np.trace(np.cov(SOURCE[here].T, bias=True))
        assert moments == pytest.approx(values / size, rel=1e-9)


@pytest.mark.parametrize(
    ("words", "here", "there"),
    [
        ("one row later", slice(0, -1), slice(1, None)),
        ("one row earlier", slice(1, None), slice(0, -1)),
        ("in reversed order", slice(None, None, -1), slice(None)),
    ],
)
def test_the_best_slip_is_told_with_what_it_leaves_of_the_same_rows(
    words: str, here: slice, there: slice
):
    rng = np.random.default_rng(3)
    x, y = rng.standard_normal((2, 9, 3))
    y[there] = x[here] @ TURN.T + 0.01 * rng.standard_normal(x[here].shape)
    w = rng.uniform(0.5, 2.0, 9)
    other = checked(rows_of(RegistrationProblem(x, y, weights=w)).other_pairing)
    left = least(x[here], y[there], w[there])[0]
    given = min(least(x[kept], y[kept], w[kept])[0] for kept in (here, there))

    assert (other.words, other.rows) == (words, len(x[here]))
    assert other.left == pytest.approx(left / given, rel=1e-9)
    (warning,) = fit(RegistrationProblem(x, y, weights=w)).warnings
    assert warning.code is FitCode.SHUFFLED
    assert warning.text.startswith(f"with the target {words} over 99.9 % of the squared residuals")
    assert warning.text.endswith(" are gone: are the rows out of step?")


@pytest.mark.parametrize("wrong", [0, -1])
@pytest.mark.parametrize("which", ["source", "target"])
def test_a_wrong_row_at_an_end_is_no_slip_where_a_slip_is_a_turn(which: str, wrong: int):
    """Marks on a turntable: a slip leaves one row out, and a turn makes up for all others."""
    angles = np.arange(24) * np.pi / 12
    x = np.column_stack([10 * np.cos(angles), 10 * np.sin(angles), np.zeros(24)])
    y = x @ TURN.T + 1e-3 * np.random.default_rng(1).standard_normal(x.shape)
    (x if which == "source" else y)[wrong] += [9.0, 0.0, 0.0]
    found = fit(RegistrationProblem(x, y))

    assert (found.codes, found.outlier_rows) == ((FitCode.OUTLIER_ROWS,), (wrong % 24,))


def test_a_slip_of_the_first_rows_is_told_of_those_alone(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(outlying, "SAMPLE_ROWS", 40)
    x = np.random.default_rng(4).standard_normal((100, 3))
    y = x @ TURN.T
    y[:40] = np.roll(y[:40], 1, axis=0)

    (some,) = fit(RegistrationProblem(x, y)).warnings
    (every,) = fit(RegistrationProblem(x[:40], y[:40])).warnings
    gone = "with the target one row later over 99.9 % of the squared residuals"
    assert some.text == f"{gone} of the first 40 rows are gone: are the rows out of step?"
    assert every.text == f"{gone} are gone: are the rows out of step?"


@pytest.fixture(scope="module")
def rows() -> RowFit:
    return rows_of(RegistrationProblem(SOURCE, TARGET))


CAUSES = (FitCode.OUTLIER_ROWS, FitCode.SHUFFLED, FitCode.MIRRORED)


@pytest.mark.parametrize("best", CAUSES)
@pytest.mark.parametrize("silent", [None, *CAUSES])
def test_of_causes_that_exclude_each_other_the_one_that_leaves_least_is_told(
    rows: RowFit, best: FitCode, silent: FitCode | None
):
    left = {code: 0.01 if code is best else 0.2 + 0.1 * k for k, code in enumerate(CAUSES)}
    other = OtherPairing(words="", rows=N, left=left[FitCode.SHUFFLED])
    given = replace(rows, left=left[FitCode.OUTLIER_ROWS] / misfits.FEWER, other_pairing=other)
    sums: Any = SimpleNamespace(mirrored_share=left[FitCode.MIRRORED])
    causes = {code: None if code is silent else code.value for code in CAUSES}
    chosen = min((code for code in CAUSES if code is not silent), key=lambda code: left[code])

    assert misfits._likeliest(causes, sums, given) == {chosen: chosen.value}
    assert misfits._likeliest(dict.fromkeys(CAUSES), sums, given) == {}


def test_outliers_are_fewer_than_half_of_the_rows(rows: RowFit):
    def words(far: int, n: int) -> str | None:
        given = replace(rows, rows=n, far_rows=far, far=tuple(range(far)), left=1e-30)
        return misfits._outlier_words(given, RowNames(None))

    assert words(0, 8) is None
    several, one = checked(words(3, 8)), checked(words(1, 8))
    agreed = "not fit the best pose of the others: without"
    assert f"rows 0, 1, 2, counting from 0, do {agreed} them over 99.9 % of" in several
    assert f"row 0, counting from 0, does {agreed} it over 99.9 % of" in one
    assert words(4, 8) is None


def test_a_noisy_pairing_that_beats_random_ones_is_not_called_shuffled():
    """Of 200 pairs with noise of 1.2 sizes 41 % are explained; random pairings explain 1 %."""
    rng = np.random.default_rng(1)
    x = rng.standard_normal((200, 3))
    y = (x + 1.2 * rng.standard_normal((200, 3))) / 1.56  # as large as the source

    assert fit(RegistrationProblem(x, y)).codes == (FitCode.POOR_FIT,)
    (warning,) = fit(RegistrationProblem(x, rng.permutation(y))).warnings
    assert warning.code is FitCode.SHUFFLED
    estimate = "(an estimate: more than one in 1000 would explain as much)"
    assert f"as a random pairing might {estimate}" in warning.text


@pytest.mark.parametrize(
    ("share", "said"),
    [
        (None, "0 %"),
        (0.125, "12.5 %"),
        (0.9994, "99.9 %"),
        (0.9995, "over 99.9 %"),
        (1.0 - 1e-15, "over 99.9 %"),
        (1.0, "100 %"),
    ],
)
def test_shares_are_said_in_per_cent_and_all_is_said_of_all_alone(
    share: Fraction | float | None, said: str
):
    assert misfits._percent(share) == said


def test_a_row_is_far_in_length_and_in_standard_deviations_beyond_six_medians():
    """Distances 1, ..., 1 and one: medians are 1 in length, 2 where weights are 4."""
    x = np.random.default_rng(2).standard_normal((3, 9))
    still = RigidMotion(rotation=np.eye(3), translation=np.zeros(3))

    def sample(last: float, weight: float) -> WeightedPairs:
        distances, weights = np.append(np.ones(8), last), np.append(np.full(8, 4.0), weight)
        return WeightedPairs(
            source=x, target=x + [[1.0], [0.0], [0.0]] * distances, weights=weights
        )

    for last, weight, far in (
        (5.9, 4.0, False),
        (6.1, 4.0, True),
        (6.1, 3.8, False),
        (5.9, 9.0, False),
    ):
        pairs = sample(last, weight)
        limits = outlying._limits_at(pairs, still)
        assert (limits.distance, limits.weighted) == pytest.approx((6.0, 12.0), rel=1e-9)
        assert limits.far(pairs, pairs.distances(still)).tolist() == [*[False] * 8, far]


OTHER_TURN = Rotation.from_rotvec([-2.0, 0.3, 0.5]).as_matrix()


def on_two_poses(common: NDArray[np.float64], first: int, second: int) -> RegistrationProblem:
    """Rows that fit both poses, so many that fit the first alone, and so many the second."""
    ends = RNG.standard_normal((first + second, 3)) * [3.0, 2.0, 1.0]
    moved = [ends[:first] @ TURN.T, ends[first:] @ OTHER_TURN.T]
    return RegistrationProblem(np.vstack([common, ends]), np.vstack([common @ TURN.T, *moved]))


AXIS = Rotation.from_matrix(TURN.T @ OTHER_TURN).as_rotvec()  # points that both turns take to one
LINE = np.outer(np.arange(-3.0, 4.0), AXIS)


@pytest.mark.parametrize(("first", "second"), [(8, 8), (7, 7), (3, 3), (2, 2), (1, 1)])
def test_of_two_poses_that_as_many_rows_agree_on_no_rows_are_named(first: int, second: int):
    tied = fit(on_two_poses(LINE, first, second))
    told = fit(on_two_poses(LINE, first + 1, second))

    (warned,) = (one for one in tied.warnings if one.code is FitCode.OUTLIER_ROWS)
    told_of = warned.text
    n = len(LINE) + first + second
    begun = (
        f"{n - second} of {n} rows lie within six medians of one pose, at least as many of another"
    )
    assert told_of.startswith(f"{begun}: their number does not tell which are right; without ")
    assert tied.outlier_rows == ()
    assert warned.remedy == (
        "check all pairs, whether both clouds show one rigid shape, and whether one is mirrored; "
        "more right pairs may tell"
    )
    far = tuple(range(len(LINE) + first + 1, len(LINE) + first + second + 1))
    assert tuple(sorted(told.outlier_rows)) == far


@pytest.mark.parametrize(("others", "wrong"), [(0, "second"), (2, None), (4, "first")])
def test_of_many_rows_all_tell_which_of_two_poses_more_agree_on(
    monkeypatch: pytest.MonkeyPatch, others: int, wrong: str | None
):
    """Of the sample four rows fit either pose alone; of four beside it, some fit the second."""
    monkeypatch.setattr(outlying, "SAMPLE_ROWS", 100)
    seen = np.random.default_rng(0).choice(120, 100, replace=False, shuffle=False)
    unseen = np.setdiff1d(np.arange(120), seen)[:4]
    rows = {"first": seen[:4], "second": seen[4:8]}
    x = np.outer(np.linspace(-3.0, 3.0, 120), AXIS)
    x[[*seen[:8], *unseen]] = RNG.standard_normal((12, 3)) * [3.0, 2.0, 1.0]
    y, turned = x @ TURN.T, [*rows["second"], *unseen[:others]]
    y[turned] = x[turned] @ OTHER_TURN.T
    found = fit(RegistrationProblem(x, y))

    assert FitCode.OUTLIER_ROWS in found.codes
    assert sorted(found.outlier_rows) == sorted(rows[wrong] if wrong else ())


def test_of_two_poses_the_weights_do_not_tell_which_rows_are_wrong():
    """A thousandth more of weight turns the optimum to one of them, and says nothing of rows."""
    problem = on_two_poses(LINE, 4, 4)
    weights = np.ones(problem.n)
    weights[len(LINE) + 4 :] += 1e-3

    assert fit(RegistrationProblem(problem.source, problem.target, weights=weights)).codes
    assert fit(problem).outlier_rows == ()


@given(seed=st.integers(0, 2**32 - 1), spread=st.sampled_from((0.0, 1.0, 8.0)))
def test_the_best_motion_in_c_costs_no_more_than_that_of_singular_values(seed: int, spread: float):
    """Under weights of all sizes, some of them zero; strides as of rows left out, or reversed."""
    rng = np.random.default_rng(seed)
    x = rng.standard_normal((3, rng.integers(3, 30)))
    weights = np.exp(spread * rng.standard_normal(x.shape[1])) * (rng.random(x.shape[1]) < 0.9)
    weights[:3] += 1.0
    pairs = WeightedPairs(source=x, target=x + rng.standard_normal(x.shape), weights=weights)
    back = pairs.paired(slice(None, None, -1), slice(None))

    for each in (pairs, back, pairs.paired(slice(1, None), slice(0, -1))):
        found = each.best_motion(each.weights)
        known = each.motion_by_singular_values(each.weights)
        one, other = (each.weights @ each.distances(m) ** 2 for m in (found, known))
        assert one == pytest.approx(other, rel=1e-12)
        assert np.linalg.det(found.rotation) == pytest.approx(1.0)


def test_without_compiled_code_the_rows_say_the_same(monkeypatch: pytest.MonkeyPatch):
    """Of a problem with a row that is wrong: what the warnings rest on."""
    problem = RegistrationProblem(SOURCE, TARGET, weights=WEIGHTS)
    compiled = rows_of(problem)
    monkeypatch.setattr(PosedPairs, "of", lambda *_: None)
    plain = rows_of(problem)

    assert (compiled.far, compiled.far_rows, compiled.tied) == ((FAR_ROW,), 1, False)
    assert (plain.far, plain.far_rows, plain.tied) == ((FAR_ROW,), 1, False)
    assert plain.left == pytest.approx(compiled.left, rel=1e-12)
    slips = [checked(each.other_pairing) for each in (compiled, plain)]
    assert slips[0].words == slips[1].words
    assert slips[0].left == pytest.approx(slips[1].left, rel=1e-12)
