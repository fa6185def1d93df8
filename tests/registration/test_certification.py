"""What a registration says is what was asked, what was computed, and no more than was accepted."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
import pytest
from strategies import AXES, BENT, random_problem

import certreg
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.simulation import optimal_damping
from certreg.dynamics.trajectory import Trajectory
from certreg.errors import ContradictionError, InvalidFileError, InvalidProblemError
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.simulation import ProblemTrajectory, final_state, proved_end
from certreg.relaxation.conic import ConicSolution, RelaxationStatus
from certreg.results import Absent, Limits, Optimality, Ruling, Verdict

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.registration.result import Registration


LINEAR = import_module("certreg.registration.linear")
SIMULATION = import_module("certreg.registration.simulation")
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
PROBLEM = random_problem(np.random.default_rng(4), n=8, noise=0.1, scale=8.0)


@pytest.fixture(scope="module")
def bare() -> Registration:
    return certify(PROBLEM, relaxation=False, simulation=False)


@pytest.fixture(scope="module")
def whole() -> Registration:
    return certify(PROBLEM, simulation=SimulationSettings(max_steps=3))


def unfinished(registration: Registration) -> Trajectory:
    trajectory = registration.solution.trajectory
    assert isinstance(trajectory, Trajectory)
    return trajectory


def test_what_is_not_asked_for_is_not_computed(bare: Registration, monkeypatch: pytest.MonkeyPatch):
    solution = bare.solution
    nothing = (solution.relaxation, solution.trajectory)
    assert nothing == (Absent("not asked for"),) * 2
    assert solution.agreement.absent == dict.fromkeys(("relaxation", "simulation"), nothing[0])

    def computed(*_: object, **__: object) -> NoReturn:
        raise AssertionError

    monkeypatch.setattr(LINEAR, "relax", computed)
    monkeypatch.setattr(LINEAR, "simulated_motion", computed)
    assess(PROBLEM, np.eye(3), np.zeros(3))


def simulated(problem: RegistrationProblem, settings: SimulationSettings | None = None) -> Any:
    """A motion with what is proved of its end."""
    run = SIMULATION.simulate(problem, settings=settings)
    assert isinstance(run, ProblemTrajectory)
    return proved_end(run)


def test_without_a_simulation_energies_are_per_weight_and_nothing_ended_anywhere(
    bare: Registration, whole: Registration
):
    state = final_state(unfinished(whole))

    assert bare.solution.energy_unit == bare.solution.moments.total_weight
    assert not bare.solution.ended_in(state)
    assert whole.solution.ended_in(state)
    *omega, exponent = state.angular_velocity
    assert not whole.solution.ended_in(replace(state, angular_velocity=(*omega, exponent + 1)))


def test_energies_of_a_simulation_are_potential_and_kinetic_in_objective_units():
    found = simulated(PROBLEM, settings=SimulationSettings(max_steps=3))
    one, unit = found.trajectory, exact_moments(PROBLEM).total_weight
    unit *= Fraction(2) ** (2 * one.length_exponent)

    assert one.kinetic[-1] > 0
    assert one.energy_unit == unit
    ends = [float(Fraction(float(one.potential[k] + one.kinetic[k])) * unit) for k in (0, -1)]
    assert list(one.energies) == ends


def test_the_damping_is_that_of_the_fastest_decay_unless_one_is_given(bare: Registration):
    rod = RegistrationProblem(BENT, np.array(BENT) / 2.0)  # weak springs: less than sqrt(8)
    best = optimal_damping(Isotropic(exact_moments(rod)))
    free, own = (certify(one, relaxation=False, simulation=False) for one in (rod, rod.damped(3.0)))

    assert best != rod.damping
    assert free.problem.damping == free.solution.problem.damping == best
    assert own.problem.damping == own.solution.problem.damping == 3.0
    for registration in (bare, free, own):
        assert registration.certificate is not None
        assert registration.certificate.about["damping"] == registration.problem.damping


@pytest.mark.parametrize("ruling", [Ruling.REFUTED, Ruling.INCONCLUSIVE])
def test_nothing_is_certified_that_the_checker_has_not_accepted(bare: Registration, ruling: Ruling):
    assert bare.status is Optimality.CERTIFIED
    assert (
        replace(bare, verdict=Verdict(ruling=ruling, words="")).status is Optimality.NOT_CERTIFIED
    )
    assert replace(bare, verdict=None).status is Optimality.NOT_CERTIFIED
    assert replace(bare, bounds=None).status is Optimality.NOT_CERTIFIED


@pytest.mark.parametrize("command", [certify, simulated])
def test_a_trajectory_below_the_certified_minimum_is_a_contradiction(
    monkeypatch: pytest.MonkeyPatch, command: object
):
    """Below by more than its rounding; by less, as in every run to the end, is none."""
    run = SIMULATION.simulated_motion

    def sunk(*arguments: object, **more: object) -> Trajectory:
        trajectory = run(*arguments, **more)
        samples = trajectory.course.samples.copy()
        samples["energies"]["potential"] -= trajectory.potential[0]
        return replace(trajectory, course=replace(trajectory.course, samples=samples))

    command(PROBLEM)  # type: ignore[operator]
    for module in (LINEAR, SIMULATION):
        monkeypatch.setattr(module, "simulated_motion", sunk)
    with pytest.raises(ContradictionError, match="below the certified minimum"):
        command(PROBLEM)  # type: ignore[operator]


def test_what_no_proof_needs_is_computed_once_and_when_asked_for():
    found = certify(PROBLEM, relaxation=False, simulation=False)
    asked = ("equilibria", "covariance", "fit")

    assert not {"equilibria", "stated_covariance", "fit"} & vars(found.solution).keys()
    first = [getattr(found, name) for name in asked]
    assert [getattr(replace(found, limits=Limits(max_gap=0.0)), name) for name in asked] == first


def test_of_a_mapped_file_nothing_is_left_to_be_read(tmp_path: Path):
    np.save(tmp_path / "target.npy", PROBLEM.target)
    problem = RegistrationProblem(PROBLEM.source, np.load(tmp_path / "target.npy", mmap_mode="r"))
    found, kept = (certify(one, relaxation=False, simulation=False) for one in (problem, PROBLEM))
    np.load(tmp_path / "target.npy", mmap_mode="r+")[:] = 0.0

    assert found.fit.worst == kept.fit.worst
    assert vars(found.solution).keys() >= {"equilibria", "stated_covariance"}


def test_a_relaxation_without_a_value_says_why(monkeypatch: pytest.MonkeyPatch):
    def lost(*_: object, **__: object) -> ConicSolution:
        return ConicSolution(status=RelaxationStatus.FAILED, said="")

    monkeypatch.setattr(import_module("certreg.relaxation.shor"), "solve", lost)
    found = certify(PROBLEM, simulation=False).solution

    assert found.relaxation == Absent(RelaxationStatus.FAILED.value)
    assert found.agreement.stated("relaxation") == found.relaxation


def test_phases_take_their_own_seconds(monkeypatch: pytest.MonkeyPatch):
    ticks = iter(range(0, 1000, 7))
    monkeypatch.setattr(time, "perf_counter", lambda: float(next(ticks)))

    found = certify(PROBLEM, relaxation=False, simulation=False)

    assert found.timings == {"compute": 7.0, "check": 7.0}


def test_the_pose_is_the_optimum_each_number_rounded_once():
    source = np.array(AXES) + np.array([1.0, 2.0, 3.0])
    found = certify(
        RegistrationProblem(source, source @ TURN.T + [5.0, 6.0, 7.0]),
        relaxation=False,
        simulation=False,
    )

    assert found.pose.rotation.tolist() == TURN.tolist()
    assert found.pose.translation.tolist() == [5.0, 6.0, 7.0]
    assert found.pose.quaternion_wxyz == pytest.approx([math.sqrt(0.5), 0, 0, math.sqrt(0.5)])
    assert found.objective == found.rmse == 0.0


@pytest.mark.parametrize(
    "beside", [{"target": BENT}, {"sigma": 1.0}, {"target": BENT, "damping": 2.0}]
)
def test_whatever_stands_beside_a_problem_is_refused(beside: dict[str, Any]):
    with pytest.raises(InvalidProblemError, match="beside a problem") as caught:
        certify(RegistrationProblem(BENT, BENT), **beside)

    assert str(caught.value).startswith(", ".join(beside))
    assert caught.value.array == ("target" if "target" in beside else "problem")


def test_without_a_certificate_the_rows_of_a_fit_have_no_names(bare: Registration):
    labels = [f"P{k}" for k in range(bare.problem.n)]
    named = certify(bare.problem, relaxation=False, simulation=False, about={"labels": labels})
    alone = replace(named.solution, certificate=None).fit

    assert [row.label for row in named.fit.worst] == [labels[row.row] for row in named.fit.worst]
    assert {row.label for row in alone.worst} == {None}
    assert [row.row for row in alone.worst] == [row.row for row in named.fit.worst]
    assert alone.explained == named.fit.explained


@pytest.mark.parametrize("function", ["equilibria", "simulate"])
def test_two_clouds_where_a_problem_is_asked_for_are_told_what_makes_one(function: str):
    asked: Any = getattr(certreg, function)
    with pytest.raises(InvalidProblemError) as refused:
        asked(np.eye(3), np.eye(3))

    assert str(refused.value) == (
        f"{function} takes a RegistrationProblem, not ndarray: of two clouds "
        "RegistrationProblem(source, target) makes one"
    )


def test_the_folder_of_a_result_is_verified_by_its_certificate(bare: Registration, tmp_path: Path):
    bare.save(tmp_path / "out")

    assert certreg.verify(tmp_path / "out").ruling is Ruling.PROVED
    with pytest.raises(InvalidFileError, match=r"certificate\.json: cannot be read"):
        certreg.verify(tmp_path)
