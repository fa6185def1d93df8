"""Springs that break, as users see them: equilibria, the simulated motion, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import twin_motions
from wrong_pairs import wrong_pairs

import certreg
from certreg.dynamics.breaking import BreakingStatus
from certreg.dynamics.integrators import SimulationSettings
from certreg.equilibrium.breaking import Labels, SpringSet
from certreg.errors import InvalidProblemError, UndecidedError
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.registration import breaking
from certreg.registration.breaking import _end, _fewest, _optimum_listed
from certreg.results import OUT_OF_RANGE, ComponentKind

if TYPE_CHECKING:
    from certreg.registration.breaking import BreakingEquilibria


def clouds(seed: int, n: int, wrong: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    made = wrong_pairs(np.random.default_rng(seed), n, wrong)
    return made.source, made.target, made.true


def few(n: int) -> RegistrationProblem:
    x = np.arange(3.0 * n).reshape(n, 3) ** 2
    return bounded(RegistrationProblem(x, x), 1.0, Loss.BREAKING)


def test_as_many_springs_hold_as_are_asked_for_from_three_to_all():
    for least in range(3, 8):
        assert _fewest(few(7), least) == least
    for least in (-1, 0, 1, 2, 8, 9):
        with pytest.raises(InvalidProblemError) as caught:
            _fewest(few(7), least)
        assert (caught.value.value, caught.value.limit) == (least, 7)


@pytest.mark.parametrize(("n", "held", "fewest"), [(12, 9, 3), (13, 9, 9), (13, 3, 3), (13, 2, 3)])
def test_of_more_than_twelve_as_many_as_a_pose_holds_and_three_at_least(
    monkeypatch: pytest.MonkeyPatch, n: int, held: int, fewest: int
):
    """Of several poses the last, which holds the most."""
    poses = [SimpleNamespace(inliers=np.arange(k)) for k in (1, held)]
    monkeypatch.setattr(breaking, "candidates", lambda *_: iter(poses))
    monkeypatch.setattr(breaking, "_held_at_rest", lambda _, rows: len(rows))

    assert _fewest(few(n), None) == fewest


def test_where_no_pose_is_found_three_are_looked_for(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(breaking, "candidates", lambda *_: iter(()))

    assert _fewest(few(13), None) == 3


# Equilibria ---------------------------------------------------------------------------------------


def test_twin_motions_have_two_stable_equilibria_and_the_better_one_is_the_optimum():
    found = certreg.breaking_equilibria(twin_motions.SOURCE, twin_motions.TARGET, max_residual=1.0)

    assert [(each.unbroken, each.energy) for each in found.stable] == twin_motions.STABLE
    assert found.complete
    assert found.optimum_listed
    first, second = found.stable
    np.testing.assert_array_equal(first.pose.translation, [0, 0, 0])
    np.testing.assert_array_equal(second.pose.translation, [4, 0, 0])
    assert repr(found) == "<BreakingEquilibria: 2 with 3 or more of 7 springs, 2 stable>"


def test_of_many_pairs_those_equilibria_are_listed_that_have_as_many_springs_as_the_best():
    x, y, true = clouds(1, 30, 0.4)
    found = certreg.breaking_equilibria(x, y, max_residual=0.06)
    (best,) = found.stable

    assert found.least == len(best.unbroken) == true.sum() == 18
    assert found.sets == 1
    assert best.unbroken == tuple(np.flatnonzero(true).tolist())
    fit = certreg.register(x[true], y[true])
    np.testing.assert_allclose(best.pose.rotation, fit.rotation, atol=1e-12)
    assert best.energy == pytest.approx(
        ((y[true] - fit.apply(x[true])) ** 2).sum() + 12 * 0.06**2, rel=1e-12
    )


def test_as_many_springs_are_asked_for_as_hold_at_rest_not_at_the_pose_that_was_found():
    """A pose brings ten pairs within the bound, their least squares only nine."""
    x, y, _ = clouds(17, 20, 0.5)
    (best,) = certreg.breaking_equilibria(x, y, max_residual=0.035).stable
    ten = certreg.breaking_equilibria(x, y, max_residual=0.035, least=10)

    assert len(best.unbroken) == 9
    assert ten.equilibria == ()
    assert not ten.optimum_listed


@pytest.mark.parametrize("unit", [1e-200, 1e200])
def test_energies_that_no_double_holds_are_none_and_say_so(unit):
    x, y, true = clouds(1, 14, 0.3)
    (best,) = certreg.breaking_equilibria(x * unit, y * unit, max_residual=0.06 * unit).stable

    assert best.unbroken == tuple(np.flatnonzero(true).tolist())
    assert best.energy is None
    assert best.stated("energy") is OUT_OF_RANGE


def test_where_no_pose_is_found_sets_of_three_are_asked_for():
    rng = np.random.default_rng(0)
    assert certreg.breaking_equilibria(*rng.normal(size=(2, 13, 3)), max_residual=1e-6).least == 3


def test_what_is_not_decided_is_said():
    line = [[-3, 0, 0], [0, 0, 0], [3, 0, 0]]
    found = certreg.breaking_equilibria(
        [*line, [0, 2, 0]], [*line, [0, 0, 2]], max_residual=[0.5, 0.5, 0.5, 0.25]
    )
    (open_,) = [each for each in found.doubtful if each.unbroken == (0, 1, 2)]

    assert (open_.labels, open_.doubtful, open_.stable) == (Labels.CONTINUUM, (3,), False)
    assert not found.complete
    assert not found.optimum_listed
    assert repr(found).endswith(f", {len(found.doubtful)} doubtful>")


def test_of_a_continuum_none_is_a_strict_minimum():
    """Three points on a line stay, the fourth is broken along all turns about it."""
    line = [[-3, 0, 0], [0, 0, 0], [3, 0, 0]]
    found = certreg.breaking_equilibria(
        [*line, [0, 2, 0]], [*line, [0, 0, 4]], max_residual=[0.5, 0.5, 0.5, 0.25]
    )
    (turning,) = [each for each in found.equilibria if each.kind is not ComponentKind.POINT]

    assert (turning.unbroken, turning.labels, turning.morse_index) == (
        *((0, 1, 2), Labels.PROVED),
        0,
    )
    assert not turning.stable


@pytest.mark.parametrize("labels", Labels)
def test_a_list_is_complete_where_all_that_is_doubtful_is_on_a_tie(labels: Labels):
    found = one_broken([1.0] * 4, [1.0] * 4)
    first, *_ = found.equilibria
    doubted = replace(found, doubtful=(replace(first, labels=labels),))

    assert found.complete
    assert doubted.complete is (labels is Labels.TIED)
    assert doubted.doubtful[0].stable is (labels is Labels.PROVED)


def test_a_tie_is_decided_and_no_minimum():
    four = [[0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 0, 5]]
    found = certreg.breaking_equilibria([*four, [7, 1, 2]], [*four, [8, 1, 2]], max_residual=1.0)
    ties = [each for each in found.doubtful if each.labels is Labels.TIED]

    assert [each.unbroken for each in ties] == [(0, 1, 2, 3)]
    assert not any(each.stable for each in ties)
    assert found.complete
    assert found.stable[0].unbroken == (0, 1, 2, 3, 4)  # the fifth pulls, and holds


def test_with_few_springs_that_hold_the_least_energy_may_be_elsewhere():
    """Two springs that break late outweigh three that break soon."""
    x = np.array([[0, 0, 0], [3, 0, 0], [0, 4, 0], [50, 0, 0], [50, 7, 0.0]])
    y = x + np.array([[0, 0, 0]] * 3 + [[9, 0, 0]] * 2)
    found = certreg.breaking_equilibria(x, y, max_residual=[0.5, 0.5, 0.5, 4, 4])

    assert found.stable[0].energy == 32.0
    assert not found.optimum_listed


def one_broken(weights: list[float], bounds: list[float]) -> BreakingEquilibria:
    """Three springs that hold at no energy; another pose holds the last two, and breaks the rest.

    With three springs or more at least one breaks, the last; with fewer two do, at least.
    """
    source = [[0, 0, 0], [3, 0, 0], [0, 4, 0], [20, 0, 0]]
    target = [[0, 0, 0], [3, 0, 0], [0, 4, 0], [4, 24, 0]]
    return certreg.breaking_equilibria(source, target, max_residual=bounds, weights=weights)


@pytest.mark.parametrize(
    ("weights", "bound", "listed"),
    [
        ([2, 2, 5, 1], np.nextafter(2.0, 1.0), True),
        ([2, 2, 5, 1], 2.0, True),  # 1 * 2^2 = 2 + 2: the other pose is as good, and no better
        ([2, 2, 5, 1], np.nextafter(2.0, 3.0), False),
        ([0.1, 0.2, 5, 0.3], 1.0, True),  # the doubles 0.1 and 0.2 add up to more than 0.3
        ([0.1, 0.2, 5, np.nextafter(0.3, 1.0)], 1.0, False),  # and to less than the next
    ],
)
def test_the_optimum_is_listed_up_to_the_energy_of_poses_that_hold_fewer_springs(
    weights: list[float], bound: float, listed
):
    found = one_broken(weights, [1.0, 1.0, 1.0, bound])

    assert [each.unbroken for each in found.stable] == [(0, 1, 2)]
    assert found.optimum_listed is listed


@pytest.mark.parametrize("labels", [label for label in Labels if label is not Labels.PROVED])
@pytest.mark.parametrize("index", [0, 1])
def test_the_optimum_is_listed_unless_a_doubtful_pose_may_be_a_minimum(labels: Labels, index: int):
    """A tie is none, nor is a pose from which the energy falls."""
    problem = one_broken([1.0] * 4, [1.0] * 4).problem
    best, *_ = SpringSet(problem, (0, 1, 2)).rest_poses()
    other = replace(best, labels=labels, index=index)

    assert best.labels is Labels.PROVED
    assert _optimum_listed(problem, 3, [best], []) is True
    assert _optimum_listed(problem, 3, [best], [other]) is (labels is Labels.TIED or index > 0)
    assert not _optimum_listed(problem, 3, [], [])


@pytest.mark.parametrize("least", [2, 8])
def test_a_number_of_springs_that_hold_no_pose_is_refused(least):
    with pytest.raises(InvalidProblemError) as refused:
        certreg.breaking_equilibria(
            twin_motions.SOURCE, twin_motions.TARGET, max_residual=1.0, least=least
        )
    assert str(refused.value) == (
        f"least is {least}: give a number of springs from 3 to 7; fewer hold the body in no pose, "
        "it turns about their line"
    )


def test_too_many_sets_are_refused_with_what_to_do():
    x, y, _ = clouds(2, 12, 0.3)
    with pytest.raises(UndecidedError, match=r"ask for more unbroken springs \(`least`\), or for"):
        certreg.breaking_equilibria(x, y, max_residual=0.3, most_sets=20)


# The motion ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("integrator", ["midpoint", "splitting", "euler"])
def test_the_body_ends_on_the_true_pairs_and_that_is_proved(integrator):
    x, y, true = clouds(1, 30, 0.4)
    run = certreg.simulate_breaking(x, y, max_residual=0.06, integrator=integrator)

    assert run.unbroken == tuple(np.flatnonzero(true).tolist())
    assert run.self_consistent
    assert run.ending == (
        "Ended at a self-consistent set of 18 springs, proved: the body rests on just these, the "
        "other 12 are broken."
    )
    assert run.end is not None
    assert repr(run).startswith("<SimulatedBreaking: SETTLED on 18 of 30 springs after ")
    np.testing.assert_allclose(run.rotation, run.end.pose.rotation, atol=2e-3)
    np.testing.assert_allclose(run.translation, run.end.pose.translation, atol=4e-3)


def test_without_wrong_pairs_no_spring_breaks():
    x, y, _ = clouds(3, 8, 0.0)

    assert certreg.simulate_breaking(x, y, max_residual=0.1).ending == (
        "Ended at a self-consistent set of 8 springs, proved: the body rests on just these, none "
        "is broken."
    )


def test_the_same_arguments_give_the_same_run():
    x, y, _ = clouds(4, 20, 0.5)
    first, again = (certreg.simulate_breaking(x, y, max_residual=0.06) for _ in range(2))

    assert (first.rotation == again.rotation).all()
    assert [s.energy for s in first.stages] == [s.energy for s in again.stages]


def test_the_body_may_end_in_the_worse_of_two_stable_equilibria():
    """Released at the pose of the three shifted points, with bounds that hardly shrink the rest."""
    x, y = np.array(twin_motions.SOURCE, float), np.array(twin_motions.TARGET, float) - [4, 0, 0]
    weights = [1, 1, 1, 1, 4, 4, 4]
    found = certreg.breaking_equilibria(x, y, max_residual=1.0, weights=weights)
    light = [certreg.simulate_breaking(x, y, max_residual=1.0, weights=w) for w in (None, weights)]

    assert [each.energy for each in found.stable] == [4.0, 12.0]
    assert [run.unbroken for run in light] == [(0, 1, 2, 3), (4, 5, 6)]
    assert all(run.self_consistent for run in light)


def test_a_run_that_does_not_settle_says_so():
    x, y, _ = clouds(5, 20, 0.5)
    short = certreg.simulate_breaking(
        x, y, max_residual=0.06, settings=SimulationSettings(max_steps=1)
    )
    assert short.status is BreakingStatus.OUT_OF_STEPS
    assert short.end is None
    assert short.ending == (
        "The steps ran out before the body was at rest. 20 of 20 springs held then."
    )

    rng = np.random.default_rng(0)
    loose = certreg.simulate_breaking(*rng.normal(size=(2, 6, 3)), max_residual=1e-3)
    assert loose.status is BreakingStatus.LOOSE
    assert loose.ending.startswith(f"{BreakingStatus.LOOSE.value} ")
    assert not loose.self_consistent


def test_an_end_whose_labels_are_not_proved_is_not_called_self_consistent():
    """The target is on a line, about which the body turns freely."""
    source = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]
    target = [[2, 0, 0], [-2, 0, 0], [0, 0, 0], [0, 0, 0]]
    run = certreg.simulate_breaking(source, target, max_residual=1.2)

    assert run.end is not None
    assert run.end.labels is Labels.CONTINUUM
    assert not run.self_consistent
    assert run.ending == (
        "Ended on 4 of 4 springs; not proved that just these hold at rest: a residual is on its "
        "bound, or nearly so, or the rest poses form a continuum."
    )


def test_a_run_does_not_end_at_a_rest_pose_from_which_the_energy_falls():
    """At the best rotation of the three the fourth holds, too; at another it is broken."""
    cloud = np.array([[0, 0, 0], [0, 0, 2], [4, 3, 1], [9, 9, 9.0]])
    problem = bounded(RegistrationProblem(cloud, cloud), 2.5, Loss.BREAKING)
    run: Any = SimpleNamespace(status=BreakingStatus.SETTLED, problem=problem, unbroken=(0, 1, 2))
    found = list(SpringSet(problem, (0, 1, 2)).rest_poses())

    assert [(pose.index, pose.labels) for pose in found] == [(1, Labels.PROVED)]
    assert _end(run) is None


@pytest.mark.parametrize("shrinking", [1.0, float("nan"), 1e7])
def test_bounds_that_do_not_shrink_are_refused(shrinking):
    with pytest.raises(InvalidProblemError) as refused:
        certreg.simulate_breaking(
            twin_motions.SOURCE, twin_motions.TARGET, max_residual=1.0, shrinking=shrinking
        )
    told = f"shrinking is {shrinking}: give a number above 1, up to 1e6; 1.4 is usual"
    assert str(refused.value) == told
