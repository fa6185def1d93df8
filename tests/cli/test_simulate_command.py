"""`certreg simulate` and `certreg.simulate`: the trajectory, where it ends, and what is proved."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import numpy as np
import pytest
from commands import certreg, strict_json, write_csv
from strategies import AXES, BENT, LINE, MIRROR, TALL, ZOO

import certreg as package
from certreg import RegistrationProblem
from certreg.dynamics.body import SimulationStatus
from certreg.dynamics.integrators import SimulationSettings
from certreg.errors import InvalidProblemError
from certreg.io.problems import read_problem
from certreg.registration import linear as pipeline
from certreg.registration.simulation import optimally_damped
from certreg.results import Absent

if TYPE_CHECKING:
    from pathlib import Path


KEYS = {
    "schema",
    "integrator",
    "status",
    "step",
    "steps",
    "converged",
    "in_certified_basin",
    "escapes",
    "residual",
    "predicted_rate",
    "decay_rate",
    "angle_to_pose_deg",
    "energy",
    "reasons",
}
ENERGY = {"initial", "final"}


def survey(data: Path) -> tuple[Path, Path]:
    return data / "survey_source.csv", data / "survey_target.csv"


def clouds(folder: Path, source, target) -> tuple[Path, Path]:
    return write_csv(folder / "a.csv", source), write_csv(folder / "b.csv", target)


def test_a_simulation_is_one_object_with_the_keys_of_a_result(data: Path):
    run = certreg("simulate", *survey(data), "--json")
    document = run.document
    same = ("--integrator", "euler", "--damping", math.sqrt(8.0))
    result = certreg("certify", *survey(data), *same, "--json", "--no-relaxation").document

    assert (run.code, run.err) == (0, "")
    assert document.keys() == KEYS
    assert document["energy"].keys() == ENERGY
    assert document["schema"] == "certreg-simulation/1"
    assert document["reasons"] == {}
    assert document["converged"] is document["in_certified_basin"] is True
    assert {key: document[key] for key in KEYS - {"schema", "reasons"}} == result["simulation"]
    assert document["energy"]["final"] == pytest.approx(result["objective"], rel=1e-2)


def test_the_summary_tells_the_same_in_words(data: Path):
    run = certreg("simulate", *survey(data))
    document = certreg("simulate", *survey(data), "--json").document
    lines = {line[2:20].strip(): line[20:].strip() for line in run.out.splitlines()}

    assert (run.code, run.err) == (0, "")
    assert run.out.startswith(SimulationStatus.CONVERGED.value + "\n")
    assert lines["steps"].startswith(f"{document['steps']}, each at most ")
    assert float(lines["time"].split()[0]) == pytest.approx(
        document["steps"] * document["step"], rel=1e-5
    )
    assert lines["escapes"].startswith(f"{document['escapes']} ")
    assert "degrees from the optimum" in lines["end"]
    assert float(lines["initial energy"].split()[0]) == pytest.approx(
        document["energy"]["initial"], rel=1e-3
    )
    assert float(lines["final energy"].split()[0]) == pytest.approx(
        document["energy"]["final"], rel=1e-3
    )
    assert "\nProved: from its last state" in run.out


def test_the_trajectory_is_written_whole_with_its_energies(data: Path, tmp_path: Path):
    file = tmp_path / "run.npz"
    run = certreg("simulate", *survey(data), "--out", file, "--json")
    with np.load(file) as arrays:
        held = {name: arrays[name] for name in arrays.files}
    problem, _ = read_problem(*survey(data))
    trajectory = package.simulate(problem)

    assert run.code == 0
    assert list(tmp_path.iterdir()) == [file]
    assert held.pop("digest").tobytes().hex() == problem.digest()
    assert held.pop("damping") == problem.damping
    assert held.keys() == {"times", "states", "potential", "kinetic", "length_exponent"}
    for name, values in held.items():
        assert np.array_equal(values, getattr(trajectory, name))
    assert held["times"][-1] == run.document["step"] * run.document["steps"]


def test_without_out_nothing_is_written(data: Path, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    assert certreg("simulate", *survey(data)).code == 0
    assert list(tmp_path.iterdir()) == []


def test_step_and_damping_are_obeyed(data: Path):
    usual = certreg("simulate", *survey(data), "--json").document
    fine = certreg("simulate", *survey(data), "--step", "0.001", "--json").document
    heavy = certreg("simulate", *survey(data), "--damping", "20", "--json").document

    assert fine["step"] == 0.001 < usual["step"]
    assert fine["steps"] > usual["steps"]
    assert heavy["steps"] * heavy["step"] > 2 * usual["steps"] * usual["step"]
    assert fine["converged"] is heavy["converged"] is True


def test_a_run_that_does_not_converge_ends_with_code_four(data: Path, monkeypatch):
    few = SimulationSettings(max_steps=10)
    monkeypatch.setattr("certreg.registration.simulation.DEFAULT_SETTINGS", few)
    run = certreg("simulate", *survey(data))
    document = certreg("simulate", *survey(data), "--json").document

    assert run.code == 4
    assert run.out.startswith(SimulationStatus.OUT_OF_STEPS.value)
    assert document["converged"] is False
    assert document["status"] == SimulationStatus.OUT_OF_STEPS.value


@pytest.mark.slow  # a million steps: minutes without a compiler
@pytest.mark.one_in(3)
@pytest.mark.parametrize(
    ("options", "note"),
    [
        (("--step", "1e-8"), "The step 1e-08 is short: euler itself takes 0.01."),
        (("--damping", "1e4"), "The damping 1e+04 is far from the best one, 2."),
        (
            ("--damping", "1e6", "--integrator", "splitting"),
            "The damping 1e+06 is far from the best one, 2.",
        ),
    ],
)
def test_a_run_that_does_not_arrive_says_why(data: Path, options, note):
    run = certreg("simulate", *survey(data), *options, "--json")

    assert run.code == 4
    assert run.document["converged"] is False
    assert f"note: {note}" in run.err


@pytest.mark.slow  # a million steps: minutes without a compiler
def test_an_integrator_that_loses_the_state_is_refused(data: Path):
    run = certreg("simulate", *survey(data), "--damping", "1e-4", "--integrator", "splitting")

    assert run.code == 2
    assert "the splitting integrator gained energy without end under the damping 0.0001" in run.err


@pytest.mark.slow  # a million steps: minutes without a compiler
@pytest.mark.parametrize("integrator", ["euler", "midpoint", "splitting"])
def test_a_step_that_is_too_long_is_shortened_with_a_note(data: Path, integrator):
    run = certreg(
        "simulate", *survey(data), "--step", "1e300", "--integrator", integrator, "--json"
    )

    assert run.code == 0
    assert f"note: The step 1e+300 is longer than {integrator} takes here: " in run.err
    assert f": {run.document['step']:.6g} was taken." in run.err


@pytest.mark.slow  # a million steps: minutes without a compiler
def test_kicks_that_do_the_work_of_the_springs_are_mentioned(tmp_path: Path):
    tetrahedron = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]])
    mirrored = tetrahedron * [1, 1, -1]
    mirrored[0, 0] += 1e-3
    paths = clouds(tmp_path, tetrahedron, mirrored)
    run = certreg("simulate", *paths, "--integrator", "splitting", "--json")

    assert run.document["escapes"] == 4
    assert "note: 4 kicks turned the body by up to 64 degrees in all" in run.err


def test_an_optimum_that_is_not_unique_is_reached_but_no_basin_is_proved(tmp_path: Path):
    mirrored = (np.array(TALL) @ np.array(MIRROR).T).tolist()
    paths = clouds(tmp_path, TALL, mirrored)
    document = certreg("simulate", *paths, "--json").document
    run = certreg("simulate", *paths)

    assert run.code == 0
    assert document["escapes"] >= 1
    assert document["status"] == SimulationStatus.AT_REST.value
    assert document["in_certified_basin"] is False
    assert "\nNot proved that from its last state" in run.out


def test_energies_that_no_double_holds_are_null_with_a_reason(tmp_path: Path):
    scale = 2.0**600
    axes = np.array(ZOO[0].source) * scale
    run = certreg("simulate", *clouds(tmp_path, axes, 2 * axes), "--json")

    assert run.code == 0
    assert run.document["energy"] == {"initial": None, "final": None}
    assert run.document["reasons"].keys() == {"energy.initial", "energy.final", "decay_rate"}
    assert certreg("simulate", tmp_path / "a.csv", tmp_path / "b.csv").code == 0


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("--integrator", "heun"), "heun"),
        (("--step", "0"), "--step"),
        (("--step", "-1"), "--step"),
        (("--step", "nan"), "--step"),
        (("--step", "inf"), "--step"),
        (("--damping", "0"), "damping"),
    ],
)
def test_bad_options_are_bad_usage(data: Path, options, word):
    run = certreg("simulate", *survey(data), *options)

    assert (run.code, run.out) == (2, "")
    assert word in run.err
    assert "Traceback" not in run.err


def test_a_collinear_source_has_no_dynamics(tmp_path: Path):
    out = tmp_path / "run.npz"
    run = certreg("simulate", *clouds(tmp_path, LINE, BENT), "--out", out)

    assert (run.code, run.out) == (2, "")
    assert "collinear" in run.err
    assert not out.exists()


def test_an_output_that_cannot_be_written_is_one_line(data: Path, tmp_path: Path):
    run = certreg("simulate", *survey(data), "--out", tmp_path / "nowhere" / "run.npz")

    assert (run.code, run.out) == (2, "")
    assert "cannot be written" in run.err
    assert run.err.count("\n") == 1


def test_the_python_function_takes_what_the_command_takes():
    problem = RegistrationProblem(AXES, (2.0 * np.array(AXES)).tolist())
    trajectory = package.simulate(problem, integrator="euler", step=0.005)

    assert isinstance(trajectory, package.Trajectory)
    assert trajectory.step == 0.005
    with pytest.raises(InvalidProblemError, match="integrator is 'heun': give 'euler'"):
        package.simulate(problem, "heun")
    for step in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="give a finite number above 0"):
            package.simulate(problem, step=step)


def test_settings_of_the_simulation_are_those_of_the_python_functions():
    problem = RegistrationProblem(AXES, (2.0 * np.array(AXES) + 1.0).tolist())
    few = package.SimulationSettings(max_steps=10, step=0.003)

    registration = package.certify(problem, relaxation=False, simulation=few)
    trajectory = package.simulate(problem, settings=few)
    finer = package.simulate(problem, step=0.002, settings=few)

    assert not isinstance(registration.solution.trajectory, Absent)
    assert registration.solution.trajectory.steps == trajectory.steps == finer.steps == 10
    assert registration.solution.trajectory.step == trajectory.step == 0.003
    assert finer.step == 0.002
    assert registration.certificate is not None


@pytest.mark.parametrize(
    "wrong",
    [
        {"step": -1.0},
        {"max_steps": -1},
        {"max_steps": 1 << 63},
        {"threads": 0},
        {"speed_tolerance": math.nan},
        {"rest_angle": -1e-3},
        {"first_perturbation": math.inf},
        {"least_step": -1.0},
    ],
)
def test_settings_that_make_no_sense_are_refused(wrong):
    (name,) = wrong
    with pytest.raises(ValueError, match=f"^{name} is .*: give a "):
        package.SimulationSettings(**wrong)


def test_the_trajectory_is_written_as_npz_only_and_told_where(data: Path, tmp_path: Path):
    refused = certreg("simulate", *survey(data), "--out", tmp_path / "tr.txt")
    told = certreg("simulate", *survey(data), "--out", tmp_path / "tr.NPZ")
    silent = certreg("simulate", *survey(data), "--out", tmp_path / "tr.npz", "--json")

    assert (refused.code, refused.out) == (2, "")
    assert re.search(r"tr\.txt: [^\n]*\.npz", refused.err)
    assert not (tmp_path / "tr.txt").exists()
    with np.load(tmp_path / "tr.NPZ", allow_pickle=False) as arrays:
        count = len(arrays["times"])
    assert f"{count} states written to {tmp_path}/tr.NPZ" in told.out
    assert strict_json(silent.out)["converged"]
    assert (tmp_path / "tr.npz").read_bytes() == (tmp_path / "tr.NPZ").read_bytes()


def nearly_collinear(folder: Path) -> tuple[Path, Path]:
    rng = np.random.default_rng(1)
    source = np.outer(rng.normal(size=20), [1.0, 2.0, 3.0]) + 1e-4 * rng.normal(size=(20, 3))
    return clouds(folder, source.tolist(), source[:, [1, 2, 0]].tolist())


def test_explicit_euler_names_why_it_cannot(data: Path, tmp_path: Path):
    thin = nearly_collinear(tmp_path)
    large = write_csv(tmp_path / "large.csv", (1e6 * np.array(TALL)).tolist())
    small = write_csv(tmp_path / "small.csv", TALL)
    runs = {
        "nearly collinear (its moment of inertia about its line is ": thin,
        "the target is so much larger than the source": (small, large),
        "the damping 1e-07 is so small": (*survey(data), "--damping", "1e-7"),
        "the damping 1e+07 is so large": (*survey(data), "--damping", "1e7"),
    }
    for words, arguments in runs.items():
        run = certreg("simulate", *arguments)

        assert (run.code, run.out) == (2, "")
        assert words in run.err
        assert ("--integrator splitting" in run.err) is (arguments is thin)
    assert certreg("simulate", *thin, "--integrator", "splitting").code == 0


def test_certify_says_which_method_it_left_out_and_why(tmp_path: Path, monkeypatch):
    thin = nearly_collinear(tmp_path)
    euler = ("certify", *thin, "--integrator", "euler")
    told = certreg(*euler)
    reason = certreg(*euler, "--json").document["reasons"]["simulation"]
    assert certreg("certify", *thin, "--json").document["simulation"]["converged"]
    asked = certreg("certify", *thin, "--no-simulation", "--no-relaxation")
    monkeypatch.setattr(pipeline.LinearProver, "relaxed", lambda *_: Absent("out of luck"))
    unlucky = certreg("certify", *thin, "--no-simulation")

    assert f"  simulation        left out: {reason}\n" in told.out
    assert "nearly collinear" in reason
    assert "left out" not in asked.out
    assert "  relaxation (SDP)  left out: out of luck\n" in unlucky.out


def test_the_rates_are_compared_only_where_the_steps_are_small_beside_them(data: Path):
    large = certreg("simulate", *survey(data), "--integrator", "splitting")
    small = certreg("simulate", *survey(data))
    told = [
        next(line for line in run.out.splitlines() if "decay rate" in line)
        for run in (large, small)
    ]

    assert re.search(r"\d  \(too few steps to compare with the predicted [\d.]+\)$", told[0])
    assert re.search(r"\d  \(predicted [\d.]+\)$", told[1])


@pytest.mark.parametrize("command", ["equilibria", "simulate"])
def test_optimal_damping_is_that_of_the_fastest_decay_and_not_the_default(
    tmp_path: Path, command: str
):
    files = clouds(tmp_path, TALL, TALL)
    best = optimally_damped(RegistrationProblem(TALL, TALL)).damping
    plain, named, given = (
        certreg(command, *files, "--json", *options).document
        for options in ((), ("--damping", "optimal"), ("--damping", repr(best)))
    )

    assert named == given
    assert named != plain
