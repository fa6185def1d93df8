"""Sentences beside numbers that a hostile reader found to say too much, or something else."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from strategies import random_rotation

from certreg.campaign.pairs import PAIR_COLUMNS
from certreg.geometry.pose_matrix import why_no_rotation
from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.simulation import proved_end, simulate
from certreg.report import lines
from certreg.report.any_report import ASSETS
from certreg.report.judged_pose import assessment_summary
from certreg.report.scene_words import component_words, trap_words
from certreg.report.simulation import told_motion
from certreg.report.summary import registration_summary
from certreg.report.thinning import thinned, unspent_words
from certreg.report.viewer import WATCH, Names, ended_words, scene_document, viewer_words
from certreg.report.words import lie_words
from certreg.verify import check

if TYPE_CHECKING:
    from certreg.registration.result import Registration


RNG = np.random.default_rng(11)
CLOUD = RNG.standard_normal((12, 3))
NOISY = CLOUD + 0.01 * RNG.standard_normal((12, 3))
OCTAHEDRON = np.vstack([np.eye(3), -np.eye(3)])
NAMES = Names.of({}, 0)
BOX = np.array([[1.0, 2, 0], [1, -2, 0], [-1, 2, 0], [-1, -2, 0], [0, 0, 3], [0, 0, -3]])


def proof(source: Any, target: Any, **options: Any) -> Registration:
    options = {"relaxation": False, "simulation": False, **options}
    return certify(RegistrationProblem(source, target), **options)


@pytest.fixture(scope="module")
def saddle() -> Registration:
    """The body begins at a saddle: the target is the source after a half turn."""
    return proof(BOX, BOX * [1.0, -1.0, -1.0], simulation=True)


def test_a_run_that_was_kicked_says_so(saddle: Registration):
    trajectory: Any = saddle.solution.trajectory
    usual = registration_summary(proof(CLOUD, NOISY, simulation=True))

    assert trajectory.escapes == 1
    assert f"{trajectory.steps} steps (kicked off a saddle once), " in registration_summary(saddle)
    assert "kicked" not in usual


@pytest.mark.parametrize("target", [-OCTAHEDRON, np.ones((6, 3))])
def test_of_several_optima_none_is_called_the_optimum(target: Any):
    problem = RegistrationProblem(OCTAHEDRON, target)
    ended = simulated(problem)
    spoilt = assess(problem, np.eye(3), [5.0, 0.0, 0.0])

    assert not ended.unique
    words = told_motion(ended.trajectory).words()
    assert "from the nearest optimum" in words
    assert "the exact motion ends at an optimum." in words
    assert "the global optimum" not in spoilt.words
    assert "the nearest optimum is " in spoilt.words


def test_far_angles_have_three_digits():
    assert lines.away_words(math.radians(154.3)) == "154 degrees from the optimum"
    assert lines.away_words(math.radians(2.34e-7)) == "2e-07 degrees from the optimum"


def test_what_moving_the_origin_does_not_mend_is_not_advised():
    moved = proof(CLOUD + 1e16, CLOUD @ random_rotation(RNG).T + 1e16)
    apart = proof(CLOUD * 1e-100, NOISY * 1e100)
    words = [
        assess(one.problem, one.pose.rotation, one.pose.translation).words for one in (moved, apart)
    ]

    assert words[0].endswith("move the origin to the clouds.")
    assert words[1].endswith("times as large as the source: no translation in doubles is closer.")
    assert "move the origin" not in words[1]


def test_a_gap_beyond_doubles_is_one_thing_in_both_places():
    judged = assess(RegistrationProblem(CLOUD, NOISY), np.eye(3), [1e308, 1e308, 0.0])

    assert judged.headline.startswith("NOT-AN-EQUILIBRIUM: between ")
    interval = judged.headline.split(": ")[1].removesuffix(" above the minimum (proved).")
    assert f"above the minimum  {interval} (proved)" in assessment_summary(judged)
    assert "beyond" not in assessment_summary(judged)


@pytest.mark.parametrize("unit", [1e-310, 1e-200, 1.0, 1e140])
def test_the_table_of_a_pose_holds_its_numbers_in_any_unit(unit: float):
    """Read back, each to nine digits: lengths in units, energies in their squares."""
    tiny = np.array([[0.0, 0, 0], [3, 0, 0], [0, 2, 0], [0, 0, 1]])  # whole units: nothing is lost
    shift = np.array([1.0, 0.0, 0.0])
    judged = assess(RegistrationProblem(tiny * unit, tiny * unit), np.eye(3), shift * unit)
    table = dict(re.findall(r"^  (\S.{17}) (\S+)", assessment_summary(judged), re.MULTILINE))
    length, digits = Fraction(unit), Fraction(1, 10**6)

    assert abs(Fraction(table["RMSE              "]) / length - 1) < digits
    assert abs(Fraction(table["objective         "]) / (4 * length**2) - 1) < digits
    assert "beyond" not in assessment_summary(judged)


def test_what_a_subnormal_double_would_round_keeps_its_digits():
    third = Fraction(5e-324) / 3  # of 4.940656458412465e-324

    assert lines.exact_number(10 * third) == "1.646885486e-323"
    assert lines.exact_number(Fraction(0)) == "0.000000"
    assert lines.exact_number(Fraction(1, 3)) == "0.333333"


def test_a_plane_has_no_worst_rotation_but_several():
    worst = proof(OCTAHEDRON, OCTAHEDRON)
    plane = worst.equilibria.components[-1]
    judged = assess(worst.problem, plane.rotation, np.zeros(3))

    assert "the worst rotations there are" in judged.headline
    assert "No rotation is worse than these." in component_words(worst.equilibria, 1)
    assert checked(trap_words(worst.equilibria)).startswith("One of the worst rotations, ")
    single = proof(CLOUD, NOISY).equilibria
    assert "It is the worst rotation there is." in component_words(single, 3)
    assert checked(trap_words(single)).startswith("The worst rotation, ")


def test_points_at_one_place_are_not_on_a_line():
    point, line = proof(np.ones((4, 3)), CLOUD[:4]), proof(np.outer(range(4), [1, 2, 3]), CLOUD[:4])

    assert (lie_words(point), lie_words(line)) == ("coincide", "are on one line")
    for one in (point, line):
        assert f"the source points {lie_words(one)}, so" in scene_document(one, NAMES)["still"]
        assert "moves" not in viewer_words(one)["springs_words"]
    assert "moves" in viewer_words(proof(CLOUD, NOISY))["springs_words"]


def test_a_push_is_offered_where_there_is_a_run(saddle: Registration, monkeypatch: Any):
    def offered() -> list[bool]:
        return [one["words"].endswith(WATCH) for one in scene_document(saddle, NAMES)["components"]]

    assert offered() == [False, True, True, True]
    monkeypatch.setattr("certreg.report.viewer.simulated_escapes", lambda *_: [])
    assert offered() == [False] * 4


def test_each_run_says_how_it_ended(saddle: Registration):
    told = [run["ended"] for run in scene_document(saddle, NAMES)["runs"]]
    kicked = "It stood at a saddle and was kicked off. "

    assert told[0] == f"{kicked}It comes to rest at the optimum."
    assert told[1:] == ["It comes to rest at the optimum."] * 3
    trajectory: Any = saddle.solution.trajectory
    short = replace(thinned(trajectory), converged=False, escapes=0, end=np.array([1.0, 0, 0, 0]))
    words = "The steps ran out before it was at rest, 180° from the optimum."
    assert ended_words(saddle.solution, short) == words
    assert "and nowhere else" not in (ASSETS / "report.js").read_text("utf-8")


def test_a_matrix_of_zeros_is_not_short_of_digits():
    rounded = np.asarray(np.eye(3) + 0.03, dtype=np.float64)

    assert "every entry of it is 0" in checked(why_no_rotation(np.zeros((3, 3))))
    assert "Give more digits" in checked(why_no_rotation(rounded))
    assert "Rounding to two decimals does not do that" in checked(
        why_no_rotation(np.diag([1.0, 2.0, 3.0]))
    )


def test_a_table_of_bounds_says_at_most():
    (gap,) = [one for one in PAIR_COLUMNS if one.name == "gap_bound"]

    assert gap.meaning == "proved: objective - minimum is at most this"


def test_the_checker_counts_one_pair_and_bounds_no_angle_where_all_are_optimal():
    single = checked(proof([[1.0, 2, 3]], [[4.0, 5, 6]]).certificate).to_json()
    words = " ".join(check(single).theorems)

    assert json.loads(single)["problem"]["n"] == 1
    assert "n = 1 pair, all of one weight" in words
    assert "every rotation is optimal" in words
    assert "No angle is bounded" not in words


def test_a_body_that_hardly_moved_is_not_said_to_have_come_to_the_optimum():
    problem = RegistrationProblem(CLOUD, CLOUD + 5.0, damping=1e9)
    slow = certify(problem, relaxation=False)
    usual = certify(RegistrationProblem(CLOUD, CLOUD + 5.0), relaxation=False)
    trajectory: Any = slow.solution.trajectory
    left = "slower than the tolerance, with over 99.9 % of its energy above the optimum left"

    assert trajectory.converged
    assert trajectory.energy_left > 0.999
    assert f"1 step, then {left}; its rotation " in registration_summary(slow)
    (told,) = {run["ended"] for run in scene_document(slow, NAMES)["runs"] if run["start"] is None}
    assert told.startswith("It is slower than the tolerance, with ")
    words = told_motion(simulated(problem, "splitting").trajectory).words()
    assert f"\n  not there yet     {left}\n" in words
    assert "\n  end               its rotation " in words
    assert "left" not in registration_summary(usual)


@pytest.mark.parametrize(("left", "told"), [(0.0100001, True), (0.01, False), (0.0, False)])
def test_what_is_left_of_the_energy_is_told_from_a_hundredth_on(left: float, *, told: bool):
    slow: Any = SimpleNamespace(converged=True, energy_left=left)
    running: Any = SimpleNamespace(converged=False, energy_left=left)

    assert (unspent_words(slow) is not None) == told
    assert unspent_words(running) is None


def simulated(problem: RegistrationProblem, integrator: str | None = None) -> Any:
    run: Any = simulate(problem, integrator)
    return proved_end(run)


def test_what_is_left_is_a_share_of_what_there_was():
    trajectory: Any = proof(CLOUD, CLOUD + 5.0, simulation=True).solution.trajectory
    still: Any = proof(CLOUD, CLOUD, simulation=True).solution.trajectory
    level = trajectory.moving.energies(trajectory.states[-1])["potential"]
    half = np.array([4.0, 1.0]) * trajectory.moving.spread
    begun, samples = replace(trajectory), trajectory.samples[:2].copy()
    samples["energies"]["potential"] = level + half
    samples["energies"]["translation"] = samples["energies"]["rotation"] = 0.0
    vars(begun)["samples"] = samples

    assert trajectory.energy_left < 1e-3
    assert begun.energy_left == pytest.approx(0.25, rel=1e-3)
    assert still.energy_left == 0.0


def test_a_bad_verdict_says_where_the_optimum_is_hardly_better():
    """A needle: the next equilibrium, and a pose beside it, are not ruled out by the noise."""
    rng = np.random.default_rng(3)
    needle = np.outer(np.linspace(-1.0, 1.0, 12), [1.0, 0.0, 0.0])
    needle = needle + 0.004 * rng.standard_normal((12, 3)) * [0.0, 1.0, 1.0]
    target = needle + 0.005 * rng.standard_normal((12, 3))
    problem = RegistrationProblem(needle, target, sigma=0.005)
    following = certify(problem, relaxation=False, simulation=False).equilibria.components[1]
    near = assess(problem, following.rotation)
    far = assess(problem, np.diag([-1.0, -1.0, 1.0]))
    plain = assess(RegistrationProblem(CLOUD, NOISY, sigma=0.01), np.diag([-1.0, -1.0, 1.0]))
    open_ = " At the sigma given five standard deviations do not rule this pose out."
    tie = " The optimum itself is nearly ambiguous: its rotation is not to be relied on."

    assert near.headline.startswith("SPURIOUS-EQUILIBRIUM")
    assert f"{tie}{open_}" in near.words
    assert tie in far.words
    assert open_ not in plain.words + far.words
    assert tie not in plain.words


def test_a_bad_verdict_says_where_a_turn_is_open():
    problem = RegistrationProblem(CLOUD, NOISY, sigma=5.0)
    words = assess(problem, np.eye(3), [9.0, 0.0, 0.0]).words

    assert " The optimum's rotation is hardly determined: five standard deviations of the " in words


@pytest.mark.parametrize(("times", "told"), [(0.9999, True), (1.0001, False)])
def test_five_standard_deviations_rule_a_pose_out(times: float, *, told: bool):
    """A shift by d costs n d^2 / sigma^2: 25 and no less rules it out."""
    problem = RegistrationProblem(CLOUD, CLOUD, sigma=0.1)
    words = assess(problem, np.eye(3), [times * 0.5 / math.sqrt(len(CLOUD)), 0.0, 0.0]).words

    assert ("do not rule this pose out" in words) == told


def test_a_spurious_pose_tells_how_far_its_translation_is():
    apart = CLOUD - CLOUD.mean(axis=0)
    problem = RegistrationProblem(apart, apart)
    turn = certify(problem, relaxation=False, simulation=False).equilibria.components[3].rotation
    lines = [assess(problem, turn, [shift, 0.0, 0.0]).headline for shift in (0.0, 5e-4)]

    assert re.fullmatch(r"SPURIOUS-EQ\w+: \S+ degrees from the index-3 .*", lines[0])
    assert " degrees, and 0.0005 between the centroids, from the index-3 equilibrium" in lines[1]
