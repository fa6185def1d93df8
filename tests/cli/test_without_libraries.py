"""Each command works or names what is missing in one line, whatever library is left out."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from commands import certreg
from left_out import endings

from certreg import _loading
from certreg._loading import ORIGINS
from certreg.cli import about
from certreg.errors import MissingToolError
from certreg.relaxation.cones import cones_of
from certreg.report import markup

DATA = Path(_loading.__file__).parent / "data"
CLOUDS = (DATA / "survey_source.csv", DATA / "survey_target.csv")


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch):
    """As if some libraries were not installed, for all that loads them from now on."""

    def leave_out(*names: str) -> None:
        for module in [*sys.modules]:
            if module.partition(".")[0] in names:
                monkeypatch.setitem(sys.modules, module, None)
        for name in names:
            monkeypatch.setitem(sys.modules, name, None)
        cones_of.cache_clear()
        markup._environment.cache_clear()

    return leave_out


COMMANDS = {  # what is left out, and a command that needs it: the one line
    "casadi": (("derive", "--out", "OUT"), "pip install 'certreg[derive]'"),
    "sympy": (("derive", "davenport"), "pip install 'certreg[derive]'"),
    "matplotlib": (("reproduce", "--out", "OUT"), "pip install 'certreg[figures]'"),
    "distributed": (("batch", "PAIRS", "--scheduler", "tcp://127.0.0.1:9"), "[campaign]'"),
    "pyarrow": (("batch", "PAIRS", "--parquet", "--out", "OUT"), "pip install 'certreg[parquet]'"),
    "cvxpy": (("certify", "A", "B", "--solver", "SCS"), "pip install 'certreg[derive]'"),
    "flint": (("equilibria", "A", "B", "--method", "all"), "pip install python-flint"),
    "filelock": (("batch", "PAIRS", "--out", "OUT"), "pip install filelock"),
    "jinja2": (("report", "CERTIFICATE"), "pip install jinja2"),
}


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("without")
    certreg("certify", *CLOUDS, "--no-simulation", "--out", folder)
    return folder / "certificate.json"


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_that_needs_a_library_names_it_in_one_line(
    name: str, without, tmp_path: Path, certificate: Path
):
    arguments, remedy = COMMANDS[name]
    (tmp_path / "pairs.csv").write_text(
        "source,target\n" + ",".join(map(str, CLOUDS)) + "\n", "utf-8"
    )
    places = {
        "A": CLOUDS[0],
        "B": CLOUDS[1],
        "OUT": tmp_path / "out",
        "PAIRS": tmp_path / "pairs.csv",
        "CERTIFICATE": certificate,
    }
    without(name)
    run = certreg(*(places.get(each, each) for each in arguments))

    *notes, line = run.err.splitlines()
    assert run.code == 2
    assert all(note.startswith("note: ") for note in notes)
    assert f"needs {ORIGINS[name].name}, which is not installed: " in line
    assert remedy in line


def test_what_brings_two_missing_libraries_is_said_at_once(without, tmp_path: Path):
    without("matplotlib", "sympy")
    run = certreg("reproduce", "--out", tmp_path / "out")

    remedy = "which are not installed: pip install 'certreg[figures,derive]'"
    assert (run.code, run.out) == (2, "")
    assert run.err == f"certreg: reproduce needs matplotlib and sympy, {remedy}\n"
    assert not (tmp_path / "out").exists()


def test_of_two_missing_libraries_the_first_is_the_tool_by_the_name_that_python_knows(without):
    without("flint", "sympy")
    with pytest.raises(MissingToolError, match="needs python-flint and sympy") as caught:
        _loading.require("flint", "sympy", purpose="this")
    assert caught.value.tool == "flint"


@pytest.mark.parametrize("name", ["clarabel", "scipy"])
def test_without_the_solver_the_relaxation_is_null_and_says_why(name: str, without):
    without(name)
    run = certreg("certify", *CLOUDS, "--no-simulation", "--json")
    words = certreg("certify", *CLOUDS, "--no-simulation")

    assert (run.code, words.code, run.err + words.err) == (0, 0, "")
    assert run.document["relaxation"] is None
    reason = f"the relaxation needs {name}, which is not installed: pip install {name}"
    assert reason in json.dumps(run.document)
    assert reason in " ".join(words.out.split())


@pytest.mark.parametrize("installed", [True, False])
def test_a_library_that_another_one_needs_is_named_itself(
    installed, without, monkeypatch: pytest.MonkeyPatch
):
    def load(_module: str):
        raise ModuleNotFoundError("No module named 'scipy.sparse'", name="scipy.sparse")

    if not installed:
        without("scipy")
    monkeypatch.setattr(_loading, "import_module", load)
    with pytest.raises(MissingToolError) as caught:
        _loading.library("cvxpy", "this")

    words = str(caught.value).removeprefix("this needs scipy, which is ")
    assert caught.value.tool == "scipy"
    if installed:  # a file of it is lost
        assert words.startswith("installed but does not load (ModuleNotFoundError: ")
        assert words.endswith(": pip install --force-reinstall scipy")
    else:
        assert words == "not installed: pip install scipy"


def test_info_lists_every_library_and_what_brings_it(without):
    without(*(name for name in ORIGINS if name not in {"numpy", "click"}))
    known = certreg("info").out
    left_out = pytest.MonkeyPatch()
    left_out.setattr(about, "version", _nothing_installed)
    run = certreg("info")
    left_out.undo()

    for origin in ORIGINS.values():
        assert f"\n{origin.name:12} " in known
        extra = f" (extra `{origin.extra}`)" if origin.extra else ""
        assert f"\n{origin.name:12} not installed{extra}\n" in run.out
    assert run.code == 0


def _nothing_installed(name: str) -> str:
    raise about.PackageNotFoundError(name)


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (AttributeError("numpy has no\n`in1d`"), "AttributeError: numpy has no `in1d`"),
        (ModuleNotFoundError("No module named 'osqp'", name="osqp"), "No module named 'osqp'"),
        (OSError("libfoo.so: cannot open"), "OSError: libfoo.so: cannot open"),
    ],
)
def test_a_library_that_does_not_load_is_told_from_one_that_is_not_there(
    monkeypatch: pytest.MonkeyPatch, fault: Exception, told: str
):
    def load(_module: str):
        raise fault

    monkeypatch.setattr(_loading, "import_module", load)
    with pytest.raises(MissingToolError) as caught:
        _loading.library("cvxpy", "this")

    assert "is installed but does not load (" in str(caught.value)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)
    assert str(caught.value).endswith("pip install --force-reinstall cvxpy-base")


EVERY = {*ORIGINS, "markupsafe", "mpmath"}  # the last two come with Jinja and SymPy


@pytest.mark.slow
def test_the_main_job_needs_numpy_click_and_jinja_alone(tmp_path: Path):
    lines = (
        ("certify", *CLOUDS, "--sigma", "4", "--out", "out"),
        ("assess", *CLOUDS, "--pose", DATA / "flipped.txt"),
        ("verify", "out/certificate.json"),
        ("report", "out/certificate.json", "--out", "report.html"),
        ("equilibria", *CLOUDS),
        ("simulate", *CLOUDS),
        ("info",),
        ("equilibria", *CLOUDS, "--method", "homotopy"),
    )
    left_out = EVERY - {"numpy", "click", "jinja2", "markupsafe"}
    codes, words = zip(*endings(left_out, lines, tmp_path, strict=True), strict=True)

    assert codes == (0, 1, 0, 0, 0, 0, 0, 2)
    assert [line for line, told in zip(lines, words, strict=True) if told] == [lines[3], lines[7]]
    assert words[3].startswith("note: ")  # on the motion
    assert words[7] == (
        "certreg: the method homotopy needs python-flint, which is not installed: "
        "pip install python-flint\n"
    )
    assert (tmp_path / "report.html").stat().st_size > 10_000


@pytest.mark.slow
def test_without_numpy_the_checker_checks_and_others_say_what_they_need(
    certificate: Path, tmp_path: Path
):
    lines = (("verify", certificate), ("certify", *CLOUDS), ("info",))

    assert endings(EVERY - {"click"}, lines, tmp_path, strict=True) == [
        (0, ""),
        (2, "certreg: this command needs numpy, which is not installed: pip install numpy\n"),
        (0, ""),
    ]


@pytest.mark.one_in(3)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "told"),
    [
        ('ImportError("libblas.so.3: cannot open")', "ImportError: libblas.so.3: cannot open"),
        ('OSError("no\\nlibrary")', "OSError: no library"),
        ('ModuleNotFoundError("No _foo", name="_foo")', "ModuleNotFoundError: No _foo"),
    ],
)
def test_a_broken_numpy_is_told_by_every_command_in_one_line(fault: str, told: str, tmp_path: Path):
    folder = tmp_path / "numpy"
    folder.mkdir()
    (folder / "__init__.py").write_text(f"raise {fault}\n", "utf-8")

    def ended(*line: object) -> tuple[int, str, str]:
        command = [sys.executable, "-c", "from certreg.cli.main import main; main()"]
        run = subprocess.run(
            [*command, *map(str, line)],
            capture_output=True,
            encoding="utf-8",
            check=False,
            env={**os.environ, "PYTHONPATH": str(tmp_path)},
        )
        return run.returncode, run.stdout, run.stderr

    words = f"numpy, which is installed but does not load ({told}): pip install --force-reinstall"
    info = ended("info")

    assert ended("simulate", *CLOUDS) == (2, "", f"certreg: this command needs {words} numpy\n")
    assert (info[0], info[2]) == (0, "")
    assert f"\nsimulation   none: it needs {words} numpy\n" in info[1]


def test_an_exception_of_a_library_that_is_loaded_keeps_none_from_loading():
    with pytest.raises(np.exceptions.AxisError) as caught:
        np.zeros(3).sum(axis=7)

    assert _loading.unloaded(caught.value) is None
