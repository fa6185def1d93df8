"""An equilibrium near a rotation, beside the optimum: what ties, what is worse, what is open."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache
from importlib.resources import files as files_of
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import spring_families
from commands import certreg, write_csv
from jsonschema import Draft202012Validator
from springs_certified import moved_springs

from certreg.geometry.given import GivenPose
from certreg.problem.problem import RegistrationProblem
from certreg.registration import valley
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.exit_codes import NOT_CERTIFIED
from certreg.registration.findings import exact_pose, findings, verdict_of
from certreg.registration.landscape import AssessmentSettings, landscape_of
from certreg.registration.nearby_equilibrium import TIE, NearbyEquilibrium
from certreg.report.judged_pose import assessment_summary
from certreg.results import PoseVerdict

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.registration.valley import SimulatedSprings


OPEN = "; whether its rotation is as good as the best found is not decided."
AT_REST = "The body is at rest (slower than the tolerance)"
# Three lines, which several poses fit exactly, and a stable pose that costs 1e-6 of the range.
SOURCE = [[-0.36, -1.02, 1.13], [-0.03, -0.74, -0.35], [-0.22, 0.70, -1.60]]
TARGET = [[-0.30, -1.00, 1.17], [-0.05, -0.64, -0.27], [-0.19, 0.73, -1.70]]
LINES = [[-1.04, -0.38, 2.53], [0.96, -0.11, 0.71], [2.06, -0.23, -0.37]]


@cache
def lines() -> Any:
    return certify(RegistrationProblem(SOURCE, TARGET, directions=LINES))


@cache
def rested() -> SimulatedSprings:
    """At another exact fit of three lines than the one that is found first."""
    x, lines = np.random.default_rng(13).normal(size=(2, 3, 3))
    return moved_springs(RegistrationProblem(x, x + 0.1 * lines[::-1], directions=lines))


def near(excess: float, left: float = 0.0, angle: float = 0.0) -> NearbyEquilibrium:
    return NearbyEquilibrium(index=0, angle=angle, slope=0.0, excess=excess, left=left)


def test_a_tie_ends_at_the_limit_and_what_is_worse_begins_beyond_it():
    beyond = math.nextafter(TIE, 1.0)

    assert near(TIE).ties
    assert not near(TIE).is_worse
    assert not near(beyond).ties
    assert near(beyond).is_worse
    assert not near(1.0, left=1.0).is_worse
    assert not near(1.0, left=math.inf).is_worse


@pytest.mark.slow
def test_a_body_that_rests_at_another_exact_fit_is_told_to_be_as_good():
    run = rested()

    assert run.angle_to_best > 1.0
    assert run.excess > TIE  # where it stopped, it is higher
    assert run.as_good is True
    assert run.converged
    assert str(run).startswith(f"{AT_REST} at a rotation as good as the best found.\n")
    assert "better rotation" not in str(run)


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize(
    ("found", "as_good", "words"),
    [
        (near(2 * TIE), False, " at another equilibrium: springs hold it there, and a better "),
        (near(TIE), True, " at a rotation as good as the best found."),
        (near(TIE, angle=1.0), None, OPEN),
        (near(1.0, left=2.0), None, OPEN),
    ],
)
def test_the_words_follow_what_newtons_steps_reach(monkeypatch, found, as_good, words):
    run = replace(rested())
    monkeypatch.setattr(valley, "equilibrium_near", lambda *_: found)

    assert run.as_good is as_good
    assert run.converged is (as_good is True)
    assert str(run).startswith(f"{AT_REST}{words}")


@pytest.mark.slow
def test_a_stable_wrong_pose_is_not_near_optimal_however_little_it_costs():
    """Where uniqueness is not decided no angle is known: the gap is 1e-6 of the range."""
    found = lines()
    ends = [q for q in found.solution.found.minima if _excess(found, q) > TIE]
    (wrong,) = [q for q in ends if _excess(found, q) < 1e-4]
    judged = assess(found, np.array(wrong, dtype=float) / np.linalg.norm(np.array(wrong, float)))

    assert judged.gap_share is not None
    assert judged.gap_share < 1e-4
    assert judged.verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM
    assert "from a stable equilibrium, at which a local method stops" in judged.headline


@pytest.mark.slow
def test_a_pose_near_one_of_several_fits_is_bounded_and_no_more():
    found = lines()
    settings = AssessmentSettings()
    turned = _turned(found.pose.quaternion_wxyz, 1e-4)
    given = GivenPose(turn=turned, translation=None)
    pose = exact_pose(found.solution.objective, given, found.solution.centre)
    cost = landscape_of(found).rounding_cost(found, given)
    facts = findings(found, pose, cost, settings)

    assert verdict_of(facts, settings) is PoseVerdict.BOUNDED
    assert verdict_of(_within(facts, 0.1), settings) is PoseVerdict.NEAR_OPTIMAL
    outside = math.nextafter(0.1, 1.0)
    assert verdict_of(_within(facts, outside), settings) is PoseVerdict.BOUNDED
    text = assessment_summary(assess(found, turned))
    assert text.startswith("BOUNDED: at most ")
    assert "NEAR-OPTIMAL" not in text


@pytest.mark.slow
def test_the_command_ends_with_code_4_where_a_pose_is_only_bounded(tmp_path: Path):
    for name, rows in (("a", SOURCE), ("b", TARGET)):
        write_csv(tmp_path / f"{name}.csv", rows)
    np.save(tmp_path / "lines.npy", LINES)
    found = lines()
    turned = _turned(found.pose.quaternion_wxyz, 1e-4)
    np.savetxt(tmp_path / "pose.txt", [*turned, *found.pose.translation], newline=" ")
    files = (*(str(tmp_path / f"{name}.csv") for name in "ab"), "--pose", f"{tmp_path}/pose.txt")
    run = certreg("assess", *files, "--directions", str(tmp_path / "lines.npy"), "--json")

    assert run.code == NOT_CERTIFIED
    assert run.document["verdict"] == "bounded"
    schema = files_of("certreg") / "report/schemas/certreg-assessment-1.json"
    Draft202012Validator(json.loads(schema.read_text("utf-8"))).validate(run.document)


def test_an_angle_to_every_optimum_makes_a_pose_near_optimal():
    made = spring_families.instance(spring_families.LISTED[2], 0)
    found: Any = certify(RegistrationProblem(**spring_families.statement(made)))
    claims = replace(found.certificate.body.claims, unique=None)
    weak = replace(found.certificate, body=replace(found.certificate.body, claims=claims))
    open_ = replace(found, solution=replace(found.solution, certificate=weak))
    judged = assess(open_, _turned(open_.pose.quaternion_wxyz, 1e-4))

    assert judged.headline.startswith("NEAR-OPTIMAL: within 0.00")
    assert " degrees of every optimum, at most " in judged.headline
    assert judged.headline.endswith(
        ") above the minimum (proved); whether there are several is not decided."
    )


def _excess(found: Any, q: Any) -> float:
    objective = found.solution.objective
    return float((objective.energy(q) - found.solution.least) / objective.oscillation)


def _turned(q: Any, angle: float) -> Any:
    """The rotation by a further angle about the source's first axis."""
    w, x, y, z = q
    c, s = math.cos(angle / 2), math.sin(angle / 2)
    return np.array([c * w - s * x, c * x + s * w, c * y + s * z, c * z - s * y])


def _within(facts: Any, angle: float) -> Any:
    return replace(facts, bounds=replace(facts.bounds, angle_upper=angle))
