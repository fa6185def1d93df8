"""Compiled code is made once and kept; where it cannot be, simulations run all the same."""

from __future__ import annotations

import contextlib
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import certreg
from rotations import saddle_start
from scipy.spatial.transform import Rotation
from strategies import ZOO, random_problem

from certreg.dynamics import body as dynamics
from certreg.dynamics import integrators as integration
from certreg.dynamics import simulation
from certreg.dynamics.basin import certified_basin
from certreg.dynamics.integrators import SimulationSettings
from certreg.errors import DegenerateProblemError, SlowSimulationWarning
from certreg.native import cache, compiler, loops
from certreg.native import engine as engines
from certreg.native.compiler import CompilationError, compiled_library, find_compiler
from certreg.native.evaluator import _least_curvature, evaluator
from certreg.native.layout import named, width
from certreg.native.library import loaded_library
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

ROOT = Path(__file__).parents[2]
DATA = ROOT / "certreg" / "data"
SURVEY = (str(DATA / "survey_source.csv"), str(DATA / "survey_target.csv"))
SIMULATED = "import certreg.native.engine as e; print(e.current_engine().words)"
each_integrator = pytest.mark.parametrize("integrator", loops.Integrator)


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A compiled library of this machine."""
    try:
        find_compiler()
    except CompilationError as error:
        pytest.skip(str(error))
    copy = tmp_path_factory.mktemp("made") / "library.so"
    shutil.copy(loaded_library().path, copy)
    return copy


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, and a folder of its own for temporary files."""
    (tmp_path / "cache").mkdir()
    (tmp_path / "temporary").mkdir()
    monkeypatch.setenv("CERTREG_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    monkeypatch.setattr(tempfile, "tempdir", None)
    return tmp_path / "cache"


def pretend(path: Path, does: str) -> str:
    """A compiler that does what Python says, `target` being the file to make."""
    lines = [
        f"#!{sys.executable} -IS",
        "import os, shutil, sys, time",
        "target = sys.argv[sys.argv.index('-o') + 1]",
        does,
    ]
    path.write_text("\n".join(lines) + "\n")
    path.chmod(0o755)
    return str(path)


@pytest.fixture
def copying(made: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A compiler that is done at once; the cache it fills."""
    monkeypatch.setenv(
        "CC", pretend(folder.parent / "copying", f"shutil.copy({str(made)!r}, target)")
    )
    return folder


def python(code: str, **environment: str | None) -> subprocess.CompletedProcess[str]:
    changed = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    given = {name: value for name, value in changed.items() if value is not None}
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, env=given
    )


def without_compiler(place: Path) -> dict[str, str | None]:
    (place / "bin").mkdir()
    (place / "empty").mkdir()
    return {"PATH": str(place / "bin"), "CC": None, "CERTREG_CACHE_DIR": str(place / "empty")}


def files(place: Path) -> list[str]:
    return sorted(path.suffix for path in place.iterdir())


# Without a compiler ------------------------------------------------------------------------------


SIMULATIONS = (
    ["cli/test_simulate_command.py"],
    pytest.param(
        ["dynamics/test_simulation.py", "dynamics/test_integrators.py"], marks=pytest.mark.long
    ),
)


@pytest.mark.slow
@pytest.mark.parametrize("names", SIMULATIONS)
def test_without_a_compiler_all_simulation_tests_pass(tmp_path, names: list[str]):
    suites = [str(ROOT / "tests" / name) for name in names]
    options = ["-q", "-p", "no:cacheprovider", "-m", "not slow", "--no-header"]
    code = f"import sys, pytest; sys.exit(pytest.main({[*options, *suites]!r}))"

    run = python(code, **without_compiler(tmp_path))

    assert run.returncode == 0, run.stdout
    assert " passed" in run.stdout
    assert list((tmp_path / "empty").iterdir()) == []


@pytest.mark.slow
def test_without_a_compiler_the_user_is_told_once_in_one_line(tmp_path):
    command = (
        f"sys.argv[1:] = ['certify', *{SURVEY!r}, '--json'];"
        "from certreg.cli.main import main; main()"
    )
    run = python(f"import sys; {command}", **without_compiler(tmp_path))

    assert run.returncode == 0
    assert json.loads(run.stdout)["simulation"]["converged"] is True
    assert run.stderr.count("\n") == 1
    assert run.stderr.startswith("note: no C compiler found (cc, gcc, clang): ")
    assert "simulating in Python" in run.stderr


@pytest.mark.slow
def test_python_is_warned_once(tmp_path):
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
    run = python(code, **without_compiler(tmp_path))

    assert (run.stdout, run.stderr) == ("['SlowSimulationWarning']\n", "")


def test_other_warnings_stay_warnings(monkeypatch, data):
    def loud(*_: object, **__: object) -> Any:
        warnings.warn("of another kind", UserWarning, stacklevel=1)
        pytest.fail("a warning is an error here")

    monkeypatch.setattr("certreg.cli.dynamics.simulated", loud)
    with pytest.raises(UserWarning, match="of another kind"):
        certreg("simulate", data / "survey_source.csv", data / "survey_target.csv")


# Both engines do the same ------------------------------------------------------------------------


def by_both(
    monkeypatch, *args: Any, **options: Any
) -> tuple[simulation.Trajectory, simulation.Trajectory]:
    found: list[Any] = []
    for machine in (engines.current_engine, evaluator):
        monkeypatch.setattr(integration, "current_engine", machine)
        monkeypatch.setattr(dynamics, "current_engine", machine)
        found.append(simulation.simulate(*args, **options))
    one, other = found
    return one, other


def assert_same(
    one: simulation.Trajectory, other: simulation.Trajectory, *, tolerance: float
) -> None:
    assert (one.status, one.steps, one.escapes) == (other.status, other.steps, other.escapes)
    for name in ("times", "states", "potential", "kinetic"):
        mine, theirs = getattr(one, name), getattr(other, name)
        assert mine.shape == theirs.shape
        assert np.abs(mine - theirs).max() <= tolerance * max(1.0, np.abs(theirs).max()), name


@pytest.mark.slow
@pytest.mark.usefixtures("made")
@each_integrator
@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_the_evaluator_takes_the_same_way_through_the_zoo(specimen, integrator, monkeypatch):
    found = Isotropic(exact_moments(specimen.problem))
    with contextlib.suppress(DegenerateProblemError):
        pair = by_both(monkeypatch, found, specimen.problem.damping, integrator)
        assert_same(*pair, tolerance=1e-12)


@pytest.mark.slow
@pytest.mark.usefixtures("made")
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


@pytest.mark.usefixtures("made")
@each_integrator
@pytest.mark.parametrize("steps", [0, 1, 5])
def test_the_evaluator_runs_out_of_steps_where_the_library_does(steps, integrator, monkeypatch):
    problem = random_problem(np.random.default_rng(4))
    found, few = Isotropic(exact_moments(problem)), SimulationSettings(max_steps=steps)

    pair = by_both(monkeypatch, found, problem.damping, integrator, settings=few)

    assert pair[0].status is simulation.SimulationStatus.OUT_OF_STEPS
    assert_same(*pair, tolerance=1e-12)


@pytest.mark.usefixtures("made")
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

    assert one.status is simulation.SimulationStatus.OUT_OF_STEPS
    assert_same(one, other, tolerance=1e-11)
    assert one.escapes == escapes
    assert one.speed < 1e-4


@pytest.mark.usefixtures("made")
@each_integrator
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_state_that_is_no_number_ends_out_of_steps_at_once(bad, integrator):
    problem = random_problem(np.random.default_rng(4))
    found = Isotropic(exact_moments(problem))
    start = np.array([bad, 0, 0, *np.eye(3).ravel(), *[0.0] * 6])
    body = dynamics.body_of(found.moments, problem.damping)
    basin = certified_basin(found, body.length_exponent)
    (state,) = simulation._stepped(start, integrator)
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


def test_the_least_curvature_is_that_of_lapack():
    rng = np.random.default_rng(5)
    for _ in range(100):
        A = rng.normal(size=(3, 3))
        least, axis = _least_curvature(A + A.T)
        values, vectors = np.linalg.eigh(A + A.T)

        assert least == pytest.approx(values[0], abs=1e-14)
        assert abs(axis @ vectors[:, 0]) == pytest.approx(1.0, abs=1e-10)


# Compiled once -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_user_s_compiler_makes_the_library(folder, monkeypatch):
    """Without optimising, which takes two seconds; what other tests load was made with it."""
    try:
        find_compiler()
    except CompilationError as error:
        pytest.skip(str(error))
    monkeypatch.setattr(compiler, "FLAGS", (*compiler.FLAGS, "-O0"))
    path = compiled_library()

    assert path.parent == folder
    assert files(folder) == [".sha256", ".so"]
    assert folder.stat().st_mode & 0o022 == 0


def test_what_was_compiled_is_found_again(copying, monkeypatch):
    first = compiled_library()
    monkeypatch.setattr(compiler, "_built", lambda *_: pytest.fail("compiled twice"))

    assert compiled_library() == first
    assert files(copying) == [".sha256", ".so"]


@pytest.mark.slow
def test_another_compiler_other_flags_or_another_processor_compile_anew(copying, monkeypatch):
    paths = [compiled_library()]
    monkeypatch.setattr(compiler, "FLAGS", (*compiler.FLAGS, "-g"))
    paths.append(compiled_library())
    monkeypatch.setattr(compiler, "_processor", lambda: b"another")
    paths.append(compiled_library())
    monkeypatch.setenv("CC", os.environ["CC"] + " -DARGUMENT")
    paths.append(compiled_library())

    assert len(set(paths)) == 4


@pytest.mark.slow
def test_processes_that_compile_at_once_all_get_a_library(made, folder):
    slow = pretend(folder.parent / "slow", f"time.sleep(0.5); shutil.copy({str(made)!r}, target)")
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "CC": slow}
    running = [
        subprocess.Popen(
            [sys.executable, "-c", SIMULATED],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
        )
        for _ in range(4)
    ]
    ends = [process.communicate() for process in running]

    assert [process.returncode for process in running] == [0] * 4
    assert {err for _, err in ends} == {""}
    (words,) = {out for out, _ in ends}
    assert str(folder) in words
    assert files(folder) == [".sha256", ".so"]
    assert cache.is_intact(next(folder.glob("*.so")))


@pytest.mark.slow
def test_a_library_serves_all_threads(copying):
    del copying
    run = python(
        "from concurrent.futures import ThreadPoolExecutor as Pool\n"
        "import certreg.native.engine as e\n"
        "words = set(Pool(4).map(lambda _: e.current_engine().words, range(4)));"
        "print(len(words), *words)"
    )

    assert run.stdout.startswith("1 compiled C")


# Damage ------------------------------------------------------------------------------------------


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:1000])


def flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(bytes(content))


def empty(path: Path) -> None:
    path.write_bytes(b"")


def unseal(path: Path) -> None:
    path.with_suffix(".sha256").unlink()


def scrawl(path: Path) -> None:
    path.with_suffix(".sha256").write_bytes(b"\xff\xfe")


@pytest.mark.slow
@pytest.mark.parametrize("damage", [cut, flip, empty, unseal, scrawl, Path.unlink])
def test_a_damaged_library_is_compiled_again(damage, copying, made):
    path = compiled_library()
    damage(path)
    assert not cache.is_intact(path)

    assert compiled_library() == path
    assert cache.is_intact(path)
    assert path.read_bytes() == made.read_bytes()
    assert files(copying) == [".sha256", ".so"]


def test_a_folder_in_the_library_s_place_does_no_harm(copying):
    path = compiled_library()
    path.unlink()
    path.mkdir()

    assert compiled_library().parent == copying.parent / "temporary" / f"certreg-{os.getuid()}"


# Caches that do not work -------------------------------------------------------------------------


def mounted(where: Path, *options: str) -> None:
    done = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", ",".join(options), "tmpfs", str(where)],
        capture_output=True,
        check=False,
    )
    if done.returncode:
        pytest.skip("mounting is not allowed here")


@pytest.fixture
def mount(folder):
    """Mounts file systems on folders, until the test is over."""
    places: list[Path] = []

    def make(where: Path, *options: str) -> None:
        try:
            mounted(where, *options)
        except FileNotFoundError:
            pytest.skip("there is no mount here")
        places.append(where)

    yield make
    for place in reversed(places):
        subprocess.run(["umount", str(place)], check=True)


def elsewhere(copying: Path) -> Path:
    return copying.parent / "temporary" / f"certreg-{os.getuid()}"


def test_a_full_cache_is_left_for_the_folder_of_temporary_files(copying, mount):
    mount(copying, "mode=700", "size=16k")

    assert compiled_library().parent == elsewhere(copying)
    assert list(copying.iterdir()) == []
    assert files(elsewhere(copying)) == [".sha256", ".so"]


def test_a_read_only_cache_is_left_for_the_folder_of_temporary_files(copying, mount):
    mount(copying, "mode=700", "ro")

    assert compiled_library().parent == elsewhere(copying)


def test_a_read_only_cache_that_has_the_library_is_used(copying, mount):
    mount(copying, "mode=700", "size=1m")
    path = compiled_library()
    subprocess.run(["mount", "-o", "remount,ro", str(copying)], check=True)

    assert compiled_library() == path


@pytest.mark.parametrize("place", ["file/below", "file"])
def test_a_cache_that_cannot_be_made_is_done_without(place, copying, monkeypatch):
    (copying.parent / "file").write_text("in the way")
    monkeypatch.setenv("CERTREG_CACHE_DIR", str(copying.parent / place))

    assert compiled_library().parent == elsewhere(copying)


def test_a_user_without_a_home_is_served(copying, monkeypatch):
    monkeypatch.delenv("CERTREG_CACHE_DIR")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(
        Path, "expanduser", lambda _: (_ for _ in ()).throw(RuntimeError("no home"))
    )

    assert compiled_library().parent == elsewhere(copying)


@pytest.mark.parametrize("mode", [0o777, 0o1777, 0o770, 0o720])
def test_a_cache_that_others_may_write_to_is_not_trusted_and_the_user_is_told(copying, mode):
    path = compiled_library()
    copying.chmod(mode)

    with pytest.warns(SlowSimulationWarning) as told:
        assert compiled_library().parent == elsewhere(copying)
    assert path.exists()
    (words,) = [str(each.message) for each in told]
    assert words.startswith(f"others may write to {copying} (remedy: chmod go-w): ")
    assert words.endswith(f"compiled code is kept in {elsewhere(copying)} instead")
    assert "\n" not in words


@pytest.mark.parametrize(("mode", "trusted"), [(0o775, False), (0o1777, True), (0o755, True)])
def test_a_folder_that_others_could_replace_is_not_trusted(copying, mode, trusted):
    """Who may write to the folder above renames; in a sticky one only the owner does."""
    copying.parent.chmod(mode)

    if trusted:
        assert compiled_library().parent == copying
    else:  # nor is the folder of temporary files, which stands beside
        with pytest.warns(SlowSimulationWarning, match="for this run only: others may write to"):
            assert copying not in compiled_library().parents


def test_a_link_to_the_cache_is_judged_by_what_it_names(copying, monkeypatch):
    (copying.parent / "link").symlink_to(copying)
    monkeypatch.setenv("CERTREG_CACHE_DIR", str(copying.parent / "link"))

    assert compiled_library().parent == copying


def test_a_library_that_others_may_write_to_or_that_is_a_link_is_not_loaded(copying, monkeypatch):
    path = compiled_library()
    path.chmod(0o775)
    assert cache.find(path.stem) is None

    path.chmod(0o755)
    assert cache.find(path.stem) == path

    path.rename(copying / "real.so")
    path.symlink_to(copying / "real.so")
    assert cache.find(path.stem) is None

    path.unlink()
    (copying / "real.so").rename(path)
    assert cache.find(path.stem) == path
    monkeypatch.setattr(os, "getuid", lambda: path.lstat().st_uid + 1)
    monkeypatch.setattr(cache, "_require_own", lambda *_: None)
    monkeypatch.setattr(cache, "_require_fixed", lambda *_: None)
    assert (cache.find(path.stem) is None) == (path.stat().st_uid != 0)


def test_a_cache_is_made_for_the_user_alone_whatever_the_mask(copying, monkeypatch):
    monkeypatch.setenv("CERTREG_CACHE_DIR", str(copying / "a" / "b"))
    former = os.umask(0o002)
    try:
        path = compiled_library()
    finally:
        os.umask(former)

    assert cache.find(path.stem) == path
    assert path.parent == copying / "a" / "b"
    assert [place.stat().st_mode & 0o777 for place in path.parents[:2]] == [0o700] * 2
    assert path.stat().st_mode & 0o022 == 0


def test_a_folder_of_another_user_is_not_trusted(tmp_path):
    status = list(tmp_path.stat())
    status[4] = os.getuid() + 1  # st_uid

    with pytest.raises(cache.CacheError, match="belongs to another user"):
        cache._require_own(tmp_path, os.stat_result(status))


def test_what_the_system_owns_is_trusted_as_ones_own_is(tmp_path, monkeypatch):
    status = list(tmp_path.stat())
    monkeypatch.setattr(os, "getuid", lambda: 1000)
    for owner in (0, 1000):
        status[4] = owner
        cache._require_own(tmp_path, os.stat_result(status))
    status[4] = 1001
    with pytest.raises(cache.CacheError, match="belongs to another user"):
        cache._require_own(tmp_path, os.stat_result(status))


def test_a_folder_below_one_of_another_user_is_not_trusted(tmp_path, monkeypatch):
    honest = Path.stat

    def foreign(self: Path, **options: Any) -> os.stat_result:
        status = list(honest(self, **options))
        status[4] += 1 if self == tmp_path else 0
        return os.stat_result(status)

    (tmp_path / "mine").mkdir()
    monkeypatch.setattr(Path, "stat", foreign)

    with pytest.raises(cache.CacheError, match=r"above .* belongs to another user"):
        cache._require_fixed(tmp_path / "mine")


def test_folders_of_killed_compilations_are_swept_and_no_others(copying, monkeypatch):
    temporary = copying.parent / "temporary"
    left = [copying / ".writing-abcd_123", temporary / "certreg-compiling-abcdefgh"]
    kept = [copying / ".writing-mine", temporary / f"certreg-{'1' * 8}", temporary / "compiling"]
    kept += [temporary / "certreg-compiling-fresh___", copying / ".writing-fresh___"]
    for place in (*left, *kept):
        place.mkdir()
        (place / "library.so").write_text("half")
        if "fresh" not in place.name:
            os.utime(place, (0.0, time.time() - cache.STALE - 60.0))
    (temporary / "elsewhere").mkdir()
    (temporary / "certreg-compiling-linklink").symlink_to(temporary / "elsewhere")
    compiled_library()

    assert not any(place.exists() for place in left)
    assert all((place / "library.so").exists() for place in kept)
    assert (temporary / "certreg-compiling-linkink").parent.exists()
    assert (temporary / "elsewhere").exists()

    monkeypatch.setattr(os, "getuid", lambda: temporary.stat().st_uid + 1)
    os.utime(kept[-2], (0.0, 0.0))
    cache.sweep(temporary, compiler.COMPILING)
    assert kept[-2].exists()


@pytest.mark.slow
@pytest.mark.parametrize("trap", ["link", "file", "open"])
def test_what_others_put_among_temporary_files_is_not_trusted(trap, copying, monkeypatch):
    """Then the library is for this run only, and the user is told."""
    monkeypatch.setenv("CERTREG_CACHE_DIR", "/proc/nowhere")
    place, mine = elsewhere(copying), copying.parent / "mine"
    mine.mkdir(mode=0o700)
    if trap == "link":
        place.symlink_to(mine)
    elif trap == "file":
        place.write_text("in the way")
    else:
        place.mkdir()
        place.chmod(0o777)

    run = python(SIMULATED)

    assert run.returncode == 0
    assert "compiled code is for this run only" in run.stderr
    assert run.stdout.startswith("compiled C (")
    assert list(mine.iterdir()) == []
    used = Path(run.stdout.strip().removeprefix("compiled C (").removesuffix(")"))
    assert not used.parent.exists()  # gone with the process


def test_a_cache_that_does_not_keep_what_is_written_is_left(copying, monkeypatch):
    honest, written = Path.write_bytes, []

    def forgetful(self: Path, content: bytes) -> int:
        if copying in self.parents:
            written.append(self)
            content = content[:-1]
        return honest(self, content)

    monkeypatch.setattr(Path, "write_bytes", forgetful)

    assert compiled_library().parent == elsewhere(copying)
    assert written


@pytest.mark.slow
def test_a_disk_that_is_full_everywhere_leaves_the_evaluator(folder):
    """Files of more than 8 KiB cannot be written, by whatever process."""
    try:
        find_compiler()
    except CompilationError as error:
        pytest.skip(str(error))
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))\n"
    run = python(limit + SIMULATED)

    assert run.returncode == 0
    assert run.stdout == "generated Python (no compiled code)\n"
    assert "failed" in run.stderr
    assert list(folder.iterdir()) == []


# Compilers that do not work ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("does", "words"),
    [
        (
            "print('first', 'fatal error: no luck', sep='\\n', file=sys.stderr); sys.exit(1)",
            "no luck",
        ),
        ("sys.exit(3)", "code 3"),
        ("os.kill(os.getpid(), 9)", "code -9"),
        ("pass", "does not run: .*cannot open"),
        ("open(target, 'w').write('garbage')", "does not run: "),
        ("open(target, 'w')", "does not run: "),
    ],
)
def test_a_compiler_that_fails_says_why_and_leaves_nothing(does, words, folder, monkeypatch):
    monkeypatch.setenv("CC", pretend(folder.parent / "broken", does))

    with pytest.raises(CompilationError, match=f"broken failed: .*{words}"):
        compiled_library()
    assert list(folder.iterdir()) == []


@pytest.mark.slow
def test_code_that_crashes_is_not_kept(made, folder, monkeypatch):
    """As where the processor lacks an instruction: the trial ends, not the user's process."""
    del made
    code = folder.parent / "crash.c"
    code.write_text(
        "__attribute__((constructor)) static void at_once(void) { __builtin_trap(); }\n"
    )
    crash = [*find_compiler(), "-shared", "-fPIC", str(code)]
    script = f"import subprocess; subprocess.run([*{crash!r}, '-o', target])"
    monkeypatch.setenv("CC", pretend(folder.parent / "crashing", script))

    with pytest.raises(CompilationError, match="what it made does not run"):
        compiled_library()
    assert list(folder.iterdir()) == []


@pytest.fixture
def hollow(folder: Path) -> Path:
    """A library that loads, and lacks what it should have."""
    library = folder.parent / "hollow.so"
    code = folder.parent / "hollow.c"
    code.write_text("int nothing;\n")
    try:
        command = [*find_compiler(), "-shared", "-fPIC", str(code), "-o", str(library)]
    except CompilationError as error:
        pytest.skip(str(error))
    subprocess.run(command, check=True)
    return library


def test_a_library_without_its_symbols_is_a_message(hollow, monkeypatch):
    monkeypatch.setattr("certreg.native.library.compiled_library", lambda: hollow)

    with pytest.raises(CompilationError, match=r"hollow\.so lacks certreg_\w+: remove the file"):
        loaded_library.__wrapped__()


def test_a_library_without_its_symbols_is_not_kept(hollow, folder, monkeypatch):
    monkeypatch.setenv("CC", pretend(folder.parent / "cc", f"shutil.copy({str(hollow)!r}, target)"))

    with pytest.raises(CompilationError, match=r"does not run: .*undefined symbol: certreg_"):
        compiled_library()


def test_a_library_without_the_handwritten_loops_is_not_kept(copying, monkeypatch):
    del copying
    monkeypatch.setattr(compiler, "WRITTEN", ("certreg_nothing",))

    with pytest.raises(CompilationError, match=r"does not run: .*undefined symbol: certreg_noth"):
        compiled_library()


def test_the_loops_that_are_asked_for_are_looked_for_when_the_library_is_loaded(made):
    text = "".join(path.read_text() for path in compiler.UNITS)

    handle = loaded_library().handle
    assert made.exists()
    assert all(hasattr(handle, name) for name in compiler.WRITTEN)
    assert all(name in text for name in compiler.WRITTEN)


def test_a_compiler_that_hangs_is_ended_with_its_children(folder, monkeypatch):
    child = folder.parent / "child"
    hang = (
        "import subprocess\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(60)'])\n"
        f"open({str(child)!r}, 'w').write(str(child.pid))\n"
        "time.sleep(60)"
    )
    monkeypatch.setenv("CC", pretend(folder.parent / "hanging", hang))
    monkeypatch.setattr(compiler, "PATIENCE", 1.0)
    start = time.monotonic()

    with pytest.raises(CompilationError, match="hanging took more than 1 s"):
        compiled_library()

    assert time.monotonic() - start < 10.0
    state = Path(f"/proc/{child.read_text()}/stat")
    time.sleep(0.2)
    assert not state.exists() or state.read_text().split()[2] == "Z"


def test_a_compiler_that_only_knows_plain_flags_is_used(made, folder, monkeypatch):
    picky = f"sys.exit(1) if '-march=native' in sys.argv else shutil.copy({str(made)!r}, target)"
    monkeypatch.setenv("CC", pretend(folder.parent / "picky", picky))

    assert compiled_library().parent == folder


def test_a_named_compiler_is_looked_for_with_its_arguments(tmp_path, monkeypatch):
    monkeypatch.setenv("CC", pretend(tmp_path / "mine", "") + " -m64 '-D A'")
    assert find_compiler() == (str(tmp_path / "mine"), "-m64", "-D A")

    monkeypatch.setenv("CC", "no-such-compiler -m64")
    with pytest.raises(CompilationError, match=r"no C compiler found \(no-such-compiler -m64\)"):
        find_compiler()


def test_the_engine_falls_back_and_says_why(folder, monkeypatch):
    monkeypatch.setenv("CC", str(folder / "nothing"))
    loaded_library.cache_clear()
    try:
        with pytest.warns(SlowSimulationWarning, match="no C compiler found .*simulating in Pyt"):
            found = engines.current_engine.__wrapped__()
        assert found is evaluator()
    finally:
        loaded_library.cache_clear()
