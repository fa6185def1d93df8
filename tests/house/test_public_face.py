"""`import certreg` is light, and its names mean the same in whatever order they are imported."""

from __future__ import annotations

import importlib
import itertools
import json
import pkgutil
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import certreg
from certreg.certificate import checking
from certreg.cli.main import COMMANDS
from certreg.verify import check

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


ROOT = Path(certreg.__file__).parents[1]
DATA = ROOT / "certreg" / "data"
PAIR = (DATA / "survey_source.csv", DATA / "survey_target.csv")
HEAVY = {"scipy", "sympy", "casadi", "cvxpy", "jinja2", "matplotlib"}

# Imports of the one name that is a function and a submodule.
IMPORTS = (
    "import certreg",
    "import certreg.verify",
    "from certreg import verify",
    "from certreg.verify import check",
    "import importlib; importlib.import_module('certreg.verify')",
    "import certreg.certificate.checking",
)


def loaded_modules(code: str) -> set[str]:
    """What a new process has loaded after running the code."""
    told = "import json, sys\nprint(); print(json.dumps([*sys.modules]))"
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", f"{code}\n{told}"],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        encoding="utf-8",
    )
    assert (run.returncode, run.stderr) == (0, "")
    return set(json.loads(run.stdout.splitlines()[-1]))


def top_level_modules(code: str) -> set[str]:
    """The packages of these."""
    return {name.split(".")[0] for name in loaded_modules(code)}


def command(*arguments: object) -> str:
    """Code that runs a command to its end, where its exit code is 0."""
    return "\n".join(
        (
            "import sys",
            f"sys.argv = {['certreg', *map(str, arguments)]!r}",
            "from certreg.cli.main import main",
            "try:",
            "    main()",
            "except SystemExit as stop:",
            "    assert stop.code == 0, stop.code",
        )
    )


@pytest.mark.slow
def test_import_certreg_loads_nothing_heavy():
    code = "import certreg\nassert certreg.__version__ and certreg.CertregError"
    use = "certreg.certify(certreg.RegistrationProblem([[0, 0, 1]], [[1, 0, 0]]), relaxation=False)"

    absent = {*HEAVY, "numpy", "click"}
    light = f"import sys\nassert not {absent} & {{*sys.modules}}"
    loaded = top_level_modules(f"{code}\n{light}\n{use}")

    assert not loaded & HEAVY
    assert "numpy" in loaded  # the question finds something


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("which", ["--help", "verify --help", "verify", "certify --no-relaxation"])
def test_help_and_verify_load_no_numerical_library(which: str, tmp_path: Path):
    certificate = tmp_path / "certificate.json"
    problem = certreg.RegistrationProblem([[0, 0, 1], [2, 0, 0]], [[1, 0, 0], [0, 1, 0]])
    made = certreg.certify(problem).certificate
    assert made is not None
    made.save(certificate)
    for name, points in (("a.csv", problem.source), ("b.csv", problem.target)):
        (tmp_path / name).write_text(
            "\n".join(",".join(map(str, p)) for p in points) + "\n", "utf-8"
        )

    name, *options = which.split()
    given = {"verify": (certificate, tmp_path / "a.csv", tmp_path / "b.csv"), "certify": PAIR}
    arguments = (*options, *(() if "--help" in which else given[name]))
    absent = HEAVY if name == "certify" else {*HEAVY, "numpy"}

    assert not top_level_modules(command(name, *arguments)) & absent


# What is of another kind of problem, of another format, or of a report that nobody asked for.
OF_OTHERS = re.compile(
    r"certreg[.](?:\w+[.]\w*(?:spring|consensus|scaled|truncated|breath|breaking|similarity)"
    r"|problem[.]\w*stiffness|registration[.](?:valley|quartic|whitened_residuals|gap_parts)"
    r"|report[.]\w*(?:page|picture|card|document|overview|folder)"
    r"|certificate[.](?:cones|listing|squares|refuting|consistency|coq|blockwise)"
    r"|relaxation[.](?:proposals|paired_scales|graduated_nonconvexity)"
    r"|equilibrium[.](?:paths|tracking|quartics|methods|line_)"
    r"|io[.](?:cif|np[yz]|obj|pairs|pcd|atoms|ply|scans|stl|trajectories)$)"
    r"|scipy[.](?:sparse|optimize|spatial)"
)
ANY_PROBLEM = {  # names of what stands in problems, or may stand in the files of any
    "certreg.geometry.similarity",
    "certreg.io.springs",
    "certreg.report.springs",
    "certreg.problem.springs",
}


@pytest.mark.slow
def test_certify_loads_nothing_of_other_kinds_of_problems():
    loaded = loaded_modules(command("certify", *PAIR, "--sigma", "4"))
    others = {name for name in loaded if OF_OTHERS.match(name)}

    assert others == ANY_PROBLEM
    assert {"certreg.registration.linear", "scipy.linalg"} <= loaded


@pytest.fixture
def forget() -> Iterator[Callable[[], None]]:
    """Takes certreg out of the loaded modules, so that it is imported anew; undone at the end."""
    saved = {name: sys.modules[name] for name in sys.modules if name.split(".")[0] == "certreg"}

    def forget_all() -> None:
        for name in [name for name in sys.modules if name.split(".")[0] == "certreg"]:
            del sys.modules[name]

    yield forget_all
    forget_all()
    sys.modules.update(saved)


def taken_by(*statements: str) -> dict[str, Any]:
    """The names that statements leave behind."""
    names: dict[str, Any] = {}
    for statement in statements:
        exec(statement, names)  # noqa: S102 (the import statements above)
    return names


ORDERS = [*itertools.permutations(IMPORTS, 2), *itertools.permutations(IMPORTS[:4])]


@pytest.mark.slow
@pytest.mark.parametrize("every", [12, pytest.param(1, marks=pytest.mark.long)])
def test_verify_is_the_function_after_every_order_of_imports(forget, every):
    for order in ORDERS[::every]:
        forget()
        names = taken_by(*order)
        again = importlib.import_module("certreg")

        assert again is not certreg
        assert again.verify is sys.modules["certreg.certificate.checking"].verify, order
        assert again.verify is not sys.modules["certreg.verify"], order
        assert names.get("verify", again.verify) is again.verify, order
        assert names.get("check", check) is check or names["check"].__module__ == "certreg.verify"
    assert not again.verify(b"{}").proved


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("statement", IMPORTS)
def test_verify_is_the_function_in_a_new_process(statement):
    code = f"{statement}\nimport certreg\nassert not certreg.verify(b'{{}}').proved"

    assert "certreg" in top_level_modules(code)


@pytest.mark.slow
def test_loading_a_submodule_later_takes_no_name_from_the_face(forget):
    forget()
    again = importlib.import_module("certreg")
    public = {name: getattr(again, name) for name in again.__all__}
    for module in pkgutil.iter_modules(again.__path__, "certreg."):
        if module.name != "certreg.__main__":
            importlib.import_module(module.name)

    assert {name: getattr(again, name) for name in again.__all__} == public


def test_no_public_name_but_verify_is_a_submodule():
    names = {module.name for module in pkgutil.iter_modules(certreg.__path__)}

    assert names & set(certreg.__all__) == {"verify"}


def test_every_public_name_is_listed_and_found():
    assert dir(certreg) == certreg.__all__ == sorted(certreg.__all__)
    assert set(taken_by("from certreg import *")) - {"__builtins__"} == set(certreg.__all__)
    for name in certreg.__all__:
        assert getattr(certreg, name) is getattr(certreg, name)
    assert certreg.verify is checking.verify
    assert {"verify", "equilibria", "certify", "assess"} <= {
        name for name in certreg.__all__ if callable(getattr(certreg, name))
    }


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'certreg' has no attribute 'nonsense'"):
        certreg.nonsense  # noqa: B018 # pyright: ignore[reportAttributeAccessIssue]
    assert not hasattr(certreg, "__wrapped__")
    with pytest.raises(ImportError, match="nonsense"):
        exec("from certreg import nonsense", {})  # noqa: S102


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("which", ["help", "version", "names"])
def test_a_command_is_imported_when_it_is_run_and_not_when_it_is_listed(which: str):
    complete = (
        "from click import Context\n"
        "from certreg.cli.main import cli\n"
        "names = [item.value for item in cli.shell_complete(Context(cli), 're')]\n"
        "assert names == ['report', 'reproduce'], names\n"
    )
    absent = "import sys\nassert not [m for m in sys.modules if m in {!r}]".format(
        {f"certreg.cli.{entry.module}" for entry in COMMANDS.values()}
    )
    code = {"help": command("--help"), "version": command("--version"), "names": complete}[which]

    assert not top_level_modules(f"{code}\n{absent}") & {*HEAVY, "numpy"}
    with pytest.raises(AssertionError):
        top_level_modules(f"{command('info')}\n{absent}")


def test_the_face_can_be_patched_as_any_module(monkeypatch):
    def stub() -> None: ...

    monkeypatch.setattr(certreg, "certify", stub)
    assert certreg.certify is stub
    monkeypatch.undo()
    assert certreg.certify is not stub
