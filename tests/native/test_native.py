"""Where there is no compiled code simulations run all the same, and both engines do the same."""

from __future__ import annotations

import contextlib
import json
import math
import os
import subprocess
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg
from reference_engine import eigenbasis
from rotations import saddle_start
from scipy.spatial.transform import Rotation
from strategies import ZOO, random_problem

from certreg.dynamics import body as dynamics
from certreg.dynamics import integrators as integration
from certreg.dynamics import simulation
from certreg.dynamics.body import SimulationStatus, certified_basin
from certreg.dynamics.integrators import SimulationSettings
from certreg.dynamics.rigid import rigid_body
from certreg.errors import DegenerateProblemError
from certreg.native import engine as engines
from certreg.native import loops
from certreg.native.engine import evaluator
from certreg.native.kernels import PYTHON, VARIANT
from certreg.native.layout import named, width
from certreg.native.library import loaded_library
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from certreg.dynamics.trajectory import Trajectory


ROOT = Path(__file__).parents[2]
DATA = ROOT / "certreg" / "data"
SURVEY = (str(DATA / "survey_source.csv"), str(DATA / "survey_target.csv"))
WITHOUT = {VARIANT: PYTHON}  # of the environment: as where there is no compiled code
each_integrator = pytest.mark.parametrize("integrator", loops.Integrator)


def python(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    given = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    return subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env=given,
        encoding="utf-8",
    )


# Without compiled code --------------------------------------------------------------------------


SIMULATIONS = (
    pytest.param(["cli/test_simulate_command.py"], marks=pytest.mark.long),
    pytest.param(
        ["dynamics/test_simulation.py", "dynamics/test_integrators.py"], marks=pytest.mark.long
    ),
)


@pytest.mark.slow
@pytest.mark.parametrize("names", SIMULATIONS)
def test_without_compiled_code_all_simulation_tests_pass(names: list[str]):
    suites = [str(ROOT / "tests" / name) for name in names]
    options = ["-q", "-p", "no:cacheprovider", "-m", "not slow", "--no-header"]
    code = f"import sys, pytest; sys.exit(pytest.main({[*options, *suites]!r}))"

    run = python(code, **WITHOUT)

    assert run.returncode == 0, run.stdout
    assert " passed" in run.stdout


@pytest.mark.slow
def test_without_compiled_code_the_user_is_told_once_in_one_line():
    command = (
        f"sys.argv[1:] = ['certify', *{SURVEY!r}, '--json'];"
        "from certreg.cli.main import main; main()"
    )
    run = python(f"import sys; {command}", **WITHOUT)

    assert run.returncode == 0
    assert json.loads(run.stdout)["simulation"]["converged"] is True
    assert run.stderr.count("\n") == 1
    assert run.stderr.startswith("note: CERTREG_VARIANT is python: ")
    assert "simulating in Python" in run.stderr


@pytest.mark.slow
def test_python_is_warned_once():
    code = (
        "import certreg, warnings, numpy\n"
        "points = numpy.random.default_rng(0).normal(size=(9, 3))\n"
        "problem = certreg.RegistrationProblem(points, points)\n"
        "with warnings.catch_warnings(record=True) as found:\n"
        "    warnings.simplefilter('always')\n"
        "    for name in ('euler', 'midpoint', 'splitting'):\n"
        "        assert certreg.simulate(problem, name).converged\n"
        "print([w.category.__name__ for w in found])\n"
    )
    run = python(code, **WITHOUT)

    assert (run.stdout, run.stderr) == ("['NotCompiledWarning']\n", "")


@pytest.mark.slow
def test_without_compiled_code_other_motions_are_refused_in_one_line_and_all_is_certified():
    code = (
        "import certreg, tempfile, numpy\n"
        "x = numpy.random.default_rng(0).normal(size=(20, 3))\n"
        "for options in ({'normals': x + 1.0}, {'scale': 'asymmetric'}):\n"
        "    problem = certreg.RegistrationProblem(x, 1.1 * x, **options)\n"
        "    try:\n"
        "        certreg.simulate(problem)\n"
        "    except certreg.CertregError as error:\n"
        "        print(error)\n"
        "    found = certreg.certify(problem)\n"
        "    with tempfile.TemporaryDirectory() as folder:\n"
        "        found.report(folder + '/page.html')\n"
        "    print(found.status.name)\n"
        "print(found.solution.trajectory)\n"
    )
    run = python(code, **WITHOUT)
    refused = (
        "the motion on general springs, or with a free scale, needs the compiled library: "
        "CERTREG_VARIANT is python\n"
    )

    assert (run.stdout.replace(refused, "no\n"), run.stderr) == (
        f"no\nCERTIFIED\nno\nCERTIFIED\nAbsent(reason={refused.strip()!r})\n",
        "",
    )


@pytest.mark.slow
def test_without_compiled_code_the_search_for_wrong_pairs_is_refused_in_one_line():
    command = (
        f"sys.argv[1:] = ['certify', *{SURVEY!r}, '--max-residual', '1'];"
        "from certreg.cli.main import main; main()"
    )
    run = python(f"import sys; {command}", **WITHOUT)
    words = "the search for wrong pairs needs the compiled library: CERTREG_VARIANT is python"

    assert (run.returncode, run.stdout, run.stderr) == (2, "", f"certreg: {words}\n")


@pytest.mark.long
@pytest.mark.slow
def test_without_compiled_code_all_is_proved_that_needs_no_search():
    """Least squares of all kinds and truncated ones, their lists, and batches of certificates."""
    code = (
        "import certreg, numpy as np\n"
        "x, noise = np.random.default_rng(0).normal(size=(2, 20, 3))\n"
        "y = x[:, [1, 2, 0]] + 0.01 * noise\n"
        "assert np.allclose(certreg.register(x, y).rotation, np.eye(3)[[1, 2, 0]], atol=0.01)\n"
        "truncated = {'objective': 'truncated', 'max_residual': 0.1}\n"
        "kinds = ({}, {'scale': 'symmetric'}, {'normals': noise}, {'rotation_only': True})\n"
        "for options in (*kinds, {'rotation_only': True, **truncated}):\n"
        "    found = certreg.certify(x, y, simulation=False, **options)\n"
        "    print(found.exit_code, certreg.verify(found.certificate).proved)\n"
        "listed = certreg.equilibria(certreg.RegistrationProblem(x, y))\n"
        "print(listed.count, certreg.certify_many([x, x], [y, y]).unique.all())\n"
    )
    run = python(code, **WITHOUT)

    assert (run.stdout, run.stderr) == (5 * "0 True\n" + "4 True\n", "")


@pytest.mark.long
def test_without_compiled_code_many_problems_at_once_are_refused_in_one_line():
    code = (
        "import certreg, numpy\n"
        "x = numpy.random.default_rng(0).normal(size=(2, 9, 3))\n"
        "for many in (certreg.solve_many, certreg.bodies_of):\n"
        "    try:\n"
        "        many(x, x)\n"
        "    except certreg.CertregError as error:\n"
        "        print(error)\n"
    )
    run = python(code, **WITHOUT)
    task = "solving or moving many problems at once"
    refused = f"{task} needs the compiled library: CERTREG_VARIANT is python\n"

    assert (run.stdout, run.stderr) == (2 * refused, "")


def test_other_warnings_stay_warnings(monkeypatch, data):
    def loud(*_: object, **__: object) -> Any:
        warnings.warn("of another kind", UserWarning, stacklevel=1)
        pytest.fail("a warning is an error here")

    monkeypatch.setattr("certreg.cli.dynamics.run", loud)
    with pytest.raises(UserWarning, match="of another kind"):
        certreg("simulate", data / "survey_source.csv", data / "survey_target.csv")


# Both engines do the same ------------------------------------------------------------------------


def by_both(monkeypatch, *args: Any, **options: Any) -> tuple[Trajectory, Trajectory]:
    found: list[Any] = []
    for machine in (engines.current_engine, evaluator):
        monkeypatch.setattr(integration, "current_engine", machine)
        monkeypatch.setattr(dynamics, "current_engine", machine)
        found.append(simulation.simulate(*args, **options))
    one, other = found
    return one, other


def assert_same(one: Trajectory, other: Trajectory, *, tolerance: float) -> None:
    assert (one.status, one.steps, one.escapes) == (other.status, other.steps, other.escapes)
    for name in ("times", "states", "potential", "kinetic"):
        mine, theirs = getattr(one, name), getattr(other, name)
        assert mine.shape == theirs.shape
        assert np.abs(mine - theirs).max() <= tolerance * max(1.0, np.abs(theirs).max()), name


@pytest.mark.slow
@pytest.mark.one_in(6)
@pytest.mark.usefixtures("compiled")
@each_integrator
@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_the_evaluator_takes_the_same_way_through_the_zoo(specimen, integrator, monkeypatch):
    found = Isotropic(exact_moments(specimen.problem))
    with contextlib.suppress(DegenerateProblemError):
        pair = by_both(monkeypatch, found, specimen.problem.damping, integrator)
        assert_same(*pair, tolerance=1e-12)


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.usefixtures("compiled")
@each_integrator
@pytest.mark.parametrize("index", [1, 2, 3])
@pytest.mark.parametrize("angle", [0.0, 1e-6, 1e-3])
def test_the_evaluator_escapes_from_saddles_on_the_same_side(index, angle, integrator, monkeypatch):
    """Leaving a saddle, a difference of rounding grows a thousandfold with the perturbation."""
    problem = random_problem(np.random.default_rng(index), n=20, noise=0.05)
    found = Isotropic(exact_moments(problem))
    start = saddle_start(found, index, angle, np.array([0.6, 0.0, 0.8]))

    one, other = by_both(monkeypatch, found, problem.damping, integrator, start=start)

    assert_same(one, other, tolerance=1e-11)
    assert (one.escapes >= 1) == (angle <= 1e-6)


@pytest.mark.usefixtures("compiled")
@each_integrator
@pytest.mark.parametrize("steps", [0, 1, 5])
def test_the_evaluator_runs_out_of_steps_where_the_library_does(steps, integrator, monkeypatch):
    problem = random_problem(np.random.default_rng(4))
    found, few = Isotropic(exact_moments(problem)), SimulationSettings(max_steps=steps)

    pair = by_both(monkeypatch, found, problem.damping, integrator, settings=few)

    assert pair[0].status is SimulationStatus.OUT_OF_STEPS
    assert_same(*pair, tolerance=1e-12)


@pytest.mark.one_in(3)
@pytest.mark.usefixtures("compiled")
@each_integrator
@pytest.mark.parametrize(("turn", "escapes"), [(1.0, 0), (math.pi - 1e-3, 3)])
def test_the_evaluator_goes_on_where_weak_springs_make_all_slow(
    turn, escapes, integrator, monkeypatch
):
    rng = np.random.default_rng(6)
    source = rng.normal(size=(12, 3))
    source -= source.mean(axis=0)
    source = source @ np.linalg.svd(source)[2].T  # half a turn about z is an equilibrium
    weak = 1e-6 * Rotation.from_rotvec([0.0, 0.0, turn]).apply(source)
    found = Isotropic(exact_moments(RegistrationProblem(source, weak)))
    settings = SimulationSettings(max_steps=20)

    one, other = by_both(monkeypatch, found, 2.8, integrator, settings=settings)

    assert one.status is SimulationStatus.OUT_OF_STEPS
    assert_same(one, other, tolerance=1e-11)
    assert one.escapes == escapes
    assert one.speed < 1e-4


@pytest.mark.usefixtures("compiled")
@each_integrator
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_state_that_is_no_number_ends_out_of_steps_at_once(bad, integrator):
    problem = random_problem(np.random.default_rng(4))
    found = Isotropic(exact_moments(problem))
    start = np.array([bad, 0, 0, *np.eye(3).ravel(), *[0.0] * 6])
    body = rigid_body(found.moments, problem.damping)
    basin = certified_basin(found, body.length_exponent)
    (state,) = body.stated(start, integrator)
    for machine in (loaded_library(), evaluator()):
        alone = loops.Batch.of(
            integrator,
            bodies=np.repeat(body.record, 9),
            basins=np.repeat(basin.record, 9),
            steps=named(np.full((9, width(integrator.step)), 0.1), integrator.step),
            states=np.repeat(state, 9),
        )
        machine.run(alone, SimulationSettings().rules)

        assert set(alone.status.tolist()) == {loops.Ending.OUT_OF_STEPS}
        assert alone.taken.max() <= 2


@pytest.mark.slow
def test_jacobis_rotations_find_what_lapack_finds():
    rng = np.random.default_rng(5)
    for _ in range(100):
        A = rng.normal(size=(3, 3))
        values, vectors = np.linalg.eigh(A + A.T)
        found, basis = eigenbasis(A + A.T, 12)
        order = np.argsort(found)

        assert found[order] == pytest.approx(values, abs=1e-14)
        assert np.abs((basis[:, order] * vectors).sum(axis=0)) == pytest.approx(1.0, abs=1e-10)
