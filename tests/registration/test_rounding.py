"""What the rounding of a pose can cost is a bound, near what it costs, and decides on 'optimal'."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest
from commands import checked
from strategies import ZOO, random_problem, random_rotation

from certreg import RegistrationProblem, assess, certify
from certreg.certificate.bounds import ExactPose, pose_bounds, pose_energy
from certreg.geometry.given import GivenPose
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.registration.findings import exact_pose
from certreg.registration.rounding import rounding_cost, rounding_remedy
from certreg.report.judged_pose import assessment_summary
from certreg.results import PoseVerdict

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg import Registration

FORMS = ("matrix", "quaternion")
CASES = [(0.0, 0.0), (1e3, 0.0), (1e8, 0.0), (0.0, 6.0)]  # offset, decades of weights


def solved(offset: float, decades: float, seed: int = 0) -> Registration:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, n=8, noise=0.2, offset=offset, decades=decades)
    return certify(problem, relaxation=False, simulation=False)


def written(registration: Registration, form: str) -> NDArray[np.float64]:
    pose = registration.pose
    return pose.rotation if form == "matrix" else pose.quaternion_wxyz


def cost_and_gap(
    registration: Registration, turn: NDArray[np.float64], shift: NDArray[np.float64]
) -> tuple[Fraction, Fraction]:
    """What rounding can cost, and what exactly this pose costs at most."""
    objective = registration.solution.objective
    given, centre = GivenPose(turn=turn, translation=shift), objective.moments.source_centroid
    pose = exact_pose(objective, given, centre)
    bounds = pose_bounds(objective, checked(registration.certificate).body, pose)
    return rounding_cost(objective, turn, shift), bounds.greatest_gap


@pytest.mark.parametrize(("here", "there"), [(1.0, 1e60), (1e60, 1.0)])
def test_of_two_clouds_the_larger_is_said_to_be_so_many_times_as_large(here: float, there: float):
    points = np.random.default_rng(1).standard_normal((6, 3))
    moments = exact_moments(RegistrationProblem(here * points, there * points))
    larger, smaller = ("target", "source") if there > here else ("source", "target")
    words = f"the {larger} is 1e+60 times as large as the {smaller}: "

    assert rounding_remedy(moments, Fraction(1)).startswith(words)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("offset", "decades"), CASES)
def test_a_pose_off_in_its_last_digits_costs_no_more_than_the_bound_and_not_much_less(
    form: str, offset: float, decades: float
):
    registration = solved(offset, decades)
    turn, shift = written(registration, form), registration.pose.translation
    cost, own = cost_and_gap(registration, turn, shift)
    assert own <= cost
    rng, most = np.random.default_rng(1), Fraction(0)
    for _ in range(30):
        signs = rng.choice([-math.inf, math.inf], size=turn.size + 3)
        off = np.nextafter(turn, signs[: turn.size].reshape(turn.shape))
        gap = cost_and_gap(registration, off, np.nextafter(shift, signs[turn.size :]))[1]
        assert gap <= 9 * cost  # at most three halves of a unit in the last place, not a half
        most = max(most, gap)
    assert cost <= 100 * most


@pytest.mark.parametrize("form", FORMS)
def test_by_hand(form: str):
    """Six points on the axes, C = diag(2, 2, 2): F^2 = 4 |C|^2 = 48, at the identity and at 0."""
    cloud = np.vstack([np.eye(3), -np.eye(3)])
    registration = certify(RegistrationProblem(cloud, cloud), relaxation=False, simulation=False)
    cost, _ = cost_and_gap(registration, written(registration, form), np.zeros(3))
    half = 2.0**-53  # of a unit in the last place of 1
    sine = 3 * half**2 / 2 if form == "matrix" else half**2
    expected = math.sqrt(2) * 2 * math.sqrt(48) * sine

    assert float(cost) == pytest.approx(expected, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("offset", [(1e6, 0.0, 0.0), (0.0, 1e6, 0.0), (0.0, 0.0, 1e6)])
def test_the_rounding_of_a_quaternion_far_from_the_origin_costs_no_more(offset: tuple[float, ...]):
    """A turn that takes axis to axis, and no shift: all is exact, but for half an ulp of q."""
    source = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])]) + offset
    objective = Isotropic(exact_moments(RegistrationProblem(source, source[:, [2, 0, 1]])))
    cost = rounding_cost(objective, np.full(4, 0.5), np.zeros(3))
    best = objective.energy((1, 1, 1, 1))
    assert best == 0
    for signs in itertools.product((-1, 1), repeat=4):
        q = tuple(2**53 + sign for sign in signs)  # 1/2, and half a unit in the last place
        pose = ExactPose(quaternion=q, translation=(Fraction(0),) * 3)
        assert pose_energy(objective, pose) - best <= cost


@pytest.mark.one_in(5)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_the_pose_that_certify_prints_is_optimal_to_rounding(specimen, form: str):
    registration = certify(specimen.problem, relaxation=False, simulation=False)
    turn, shift = written(registration, form), registration.pose.translation
    found = assess(specimen.problem, turn, shift)

    assert found.verdict is PoseVerdict.OPTIMAL
    unique = registration.equilibria.classification.unique
    poor = ", BUT THE FIT IS POOR" if found.fit.warnings and unique else ""
    assert found.headline.startswith(f"OPTIMAL TO ROUNDING{poor}: ")
    assert checked(found.gap_upper) <= checked(found.rounding_cost)
    told = assessment_summary(found)
    assert "This is the global optimum" not in told
    assert "there is no other" not in told
    unique = specimen.pattern[0] == 1
    assert (found.angle_upper is not None) == unique
    assert ("degrees (proved)" in found.headline) == unique
    assert ("not the only one" in found.words) != unique


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_a_pose_that_costs_more_than_its_rounding_is_near_optimal(form: str):
    registration = solved(0.0, 0.0)
    turn, shift = written(registration, form), registration.pose.translation
    verdicts: list[PoseVerdict] = []
    for ulps in (0, 1, 4, 16, 64, 2**20):
        found = assess(registration.problem, turn + ulps * np.spacing(turn), shift)
        verdicts.append(found.verdict)
        optimal = checked(found.gap_upper) <= checked(found.rounding_cost)
        assert found.verdict is (PoseVerdict.OPTIMAL if optimal else PoseVerdict.NEAR_OPTIMAL)
        if not optimal:
            assert found.headline.startswith("NEAR-OPTIMAL: within ")
            assert "of the range of energies) above the minimum (proved)." in found.headline
    assert verdicts[0] is PoseVerdict.OPTIMAL
    assert verdicts[-1] is PoseVerdict.NEAR_OPTIMAL


@pytest.mark.parametrize("offset", [1e15, 1e16])
def test_far_from_the_origin_rounding_excuses_nothing(offset: float):
    registration = solved(0.0, 0.0)
    source, target = registration.problem.source + offset, registration.problem.target + offset
    problem = RegistrationProblem(source, target)
    pose = certify(problem, relaxation=False, simulation=False).pose
    found = assess(problem, pose.quaternion_wxyz, pose.translation)

    assert found.verdict is PoseVerdict.NOT_AN_EQUILIBRIUM
    assert "move the origin to the clouds" in found.words
    assert "above the minimum (proved)" in found.headline


def test_a_translation_that_is_not_written_costs_nothing():
    problem = random_problem(np.random.default_rng(12), n=8, offset=1e6)
    pose, objective = (
        certify(problem, relaxation=False, simulation=False).pose,
        Isotropic(exact_moments(problem)),
    )
    alone = rounding_cost(objective, pose.rotation, None)

    assert 0 < alone < rounding_cost(objective, pose.rotation, pose.translation) / 10**6
    assert alone == rounding_cost(objective, pose.rotation, None, (Fraction(7),) * 3)


@pytest.mark.parametrize("seed", range(4))
def test_a_centroid_far_away_is_moved_by_the_rounding_of_every_entry_of_a_row(seed: int):
    """Entries off by half a unit each, all to the side where a row moves the centroid most."""
    rng = np.random.default_rng(seed)
    objective = Isotropic(exact_moments(random_problem(rng, n=8)))
    turn = random_rotation(rng)
    centre = (1e9 * rng.uniform(0.5, 2.0, 3) * rng.choice([-1.0, 1.0], 3)).tolist()
    halves = (np.spacing(np.abs(turn)) / 2).tolist()
    moved = [sum(Fraction(h) * abs(Fraction(c)) for h, c in zip(row, centre, strict=True))
             for row in halves]  # fmt: skip
    least = objective.moments.total_weight * sum(m * m for m in moved)
    cost = rounding_cost(objective, turn, np.zeros(3), [Fraction(c) for c in centre])

    assert least <= cost <= least * Fraction(1001, 1000)
