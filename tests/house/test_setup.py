"""The lock files, the metadata and the Makefile tell the same story."""

import os
import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest

import certreg
from certreg._loading import ORIGINS

ROOT = Path(__file__).parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
UV_LOCK = (ROOT / "uv.lock").read_text("utf-8")
REQUIREMENTS = (ROOT / "requirements.lock").read_text("utf-8")
TO_RUN = (ROOT / "requirements-run.lock").read_text("utf-8")
COMPILER = (ROOT / "requirements-compiler.lock").read_text("utf-8")
RESOLVED: list[dict[str, Any]] = [
    package for package in tomllib.loads(UV_LOCK)["package"] if package["name"] != "certreg"
]
INDEX_HOSTS = {"pypi.org", "files.pythonhosted.org"}

Pins = dict[tuple[str, str], frozenset[str]]


def normalized(requirement: str) -> str:
    """Name of a requirement, as the index spells it (PEP 503)."""
    match = re.match(r"[A-Za-z0-9._-]+", requirement)
    assert match is not None
    return re.sub(r"[-_.]+", "-", match.group()).lower()


def pins_of_uv() -> Pins:
    """Hashes of every (name, version) that uv.lock resolves."""
    return {
        (package["name"], package["version"]): frozenset(
            file["hash"] for file in [package.get("sdist"), *package.get("wheels", [])] if file
        )
        for package in RESOLVED
    }


def pins_of_pip(lock: str = REQUIREMENTS) -> Pins:
    """Hashes of every (name, version) in requirements.lock, or in what is given."""
    logical_lines = lock.replace("\\\n", " ").splitlines()
    pins: Pins = {}
    for line in logical_lines:
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        pin = re.match(r"([a-z0-9-]+)==([^\s;]+)", line)
        assert pin is not None, f"not an exact pin: {line[:80]}"
        pins[pin[1], pin[2]] = frozenset(re.findall(r"--hash=(sha256:[0-9a-f]{64})", line))
    return pins


LARGE = {"pye57", "pyquaternion"}  # of the extra `files`, 60 MB: not in the test environment


def test_both_lock_files_name_the_same_versions_with_the_same_hashes():
    installed = {pin: hashes for pin, hashes in pins_of_uv().items() if pin[0] not in LARGE}

    assert pins_of_pip() == installed
    assert {name for name, _ in pins_of_uv()} >= LARGE


def test_what_runs_is_pinned_as_in_the_whole_and_brings_no_extra():
    runs = pins_of_pip(TO_RUN)
    brought = {name for name, _ in runs}
    extras = {origin.name for origin in ORIGINS.values() if origin.extra is not None}

    assert runs.items() <= pins_of_pip().items()
    assert {normalized(each) for each in PYPROJECT["project"]["dependencies"]} <= brought
    assert not extras & brought


def test_the_compiler_of_machines_without_one_is_pinned_and_no_part_of_an_environment():
    ((pin, hashes),) = pins_of_pip(COMPILER).items()

    assert f"ZIG := {pin[0]}=={pin[1]}\n" in (ROOT / "Makefile").read_text("utf-8")
    assert len(hashes) > 5  # of each platform
    assert pin[0] not in UV_LOCK


def test_where_a_library_comes_from_is_what_the_metadata_says():
    declared = {
        normalized(each): extra
        for extra, group in PYPROJECT["project"]["optional-dependencies"].items()
        for each in group
        if extra != "all"
    }
    declared.update({normalized(each): None for each in PYPROJECT["project"]["dependencies"]})
    (every,) = PYPROJECT["project"]["optional-dependencies"]["all"]

    assert {origin.name: origin.extra for origin in ORIGINS.values()} == declared
    assert set(re.findall(r"[a-z]+", every)) == {"certreg", *filter(None, declared.values())}


def test_every_pin_has_a_hash():
    assert RESOLVED
    assert all(pins_of_uv().values())


def test_a_version_that_depends_on_the_python_is_chosen_by_a_marker():
    names = [name for name, _ in pins_of_pip()]
    twice = {name for name in names if names.count(name) > 1}

    for line in REQUIREMENTS.splitlines():
        if re.match(r"[a-z0-9-]+==", line) and normalized(line) in twice:
            assert "python_full_version" in line, line


@pytest.mark.parametrize(
    "lock",
    [UV_LOCK, REQUIREMENTS, TO_RUN, COMPILER],
    ids=["uv.lock", "requirements.lock", "run", "compiler"],
)
def test_a_lock_file_knows_no_place_but_the_standard_index(lock: str):
    hosts = {match.lower() for match in re.findall(r"[a-z+]+://([^/\s\"]*)", lock)}

    assert hosts <= INDEX_HOSTS
    assert "file:" not in lock
    assert "find-links" not in lock


def test_every_locked_package_comes_from_the_standard_index():
    sources = [package["source"] for package in RESOLVED]

    assert all(source == {"registry": "https://pypi.org/simple"} for source in sources)


def test_every_declared_requirement_is_pinned():
    groups = [PYPROJECT["project"]["dependencies"], *PYPROJECT["dependency-groups"].values()]
    declared = [named for group in groups for named in group if isinstance(named, str)]
    pinned = {name for name, _ in pins_of_pip()}

    assert {normalized(requirement) for requirement in declared} <= pinned


def test_what_builds_the_package_is_pinned_for_the_pip_way():
    build_tools = PYPROJECT["build-system"]["requires"]
    pinned = {name for name, _ in pins_of_pip(TO_RUN)}

    # pip builds without isolation; hatchling needs `editables` for an editable wheel.
    assert {normalized(tool) for tool in [*build_tools, "editables"]} <= pinned


def test_the_version_is_one_everywhere():
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    cited = re.findall(r"^version: (\S+)$", citation, flags=re.MULTILINE)

    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    released = f"## {certreg.__version__} (unreleased)" not in changes

    assert cited == [certreg.__version__]
    assert ("\ndate-released: " in citation) == released
    assert PYPROJECT["project"]["dynamic"] == ["version"]
    assert PYPROJECT["tool"]["hatch"]["version"]["path"] == "certreg/__init__.py"


def make(*arguments: str, path: str | None = None) -> subprocess.CompletedProcess[str]:
    """Runs make on the checkout, in an environment that no outer make or uv has touched."""
    outer = {"UV", "PYTHON", "VENV", "MAKEFLAGS", "MFLAGS", "MAKELEVEL", "MAKEOVERRIDES"}
    environment = {name: value for name, value in os.environ.items() if name not in outer}
    if path is not None:
        environment["PATH"] = path
    command = ["make", *arguments]
    return subprocess.run(
        command,
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        encoding="utf-8",
    )


def dry_run(folder: Path, *arguments: str, path: str | None = None, target: str = "test") -> str:
    """What `make test` would do where nothing is set up, whatever the checkout's .venv is."""
    done = make("-n", target, f"VENV={folder / 'absent'}", *arguments, path=path)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_make_sets_up_with_venv_and_pip_where_uv_is_unwanted(tmp_path: Path):
    plan = dry_run(tmp_path, "UV=")

    assert "-m venv" in plan
    assert "--require-hashes -r requirements-run.lock" in plan
    assert "--require-hashes -r requirements.lock" in plan
    assert "--no-deps --no-build-isolation -e ." in plan
    assert "uv sync" not in plan


def test_make_sets_up_with_uv_where_it_is_on_path(tmp_path: Path):
    uv = tmp_path / "uv"
    uv.write_text("#!/bin/sh\nexit 1\n", "utf-8")
    uv.chmod(0o755)

    plan = dry_run(tmp_path, path=f"{tmp_path}{os.pathsep}{os.environ['PATH']}")

    assert f"{uv} sync --locked --no-default-groups" in plan
    assert f"{uv} sync --locked --all-groups" in plan
    assert "-m pip" not in plan


@pytest.mark.parametrize("arguments", [["UV="], ["UV=uv"]], ids=["pip", "uv"])
def test_a_set_up_that_was_cut_short_leaves_no_stamp(tmp_path: Path, arguments: list[str]):
    steps = dry_run(tmp_path, *arguments).splitlines()
    runs, stamp = tmp_path / "absent" / ".runs", tmp_path / "absent" / ".ready"

    assert steps[0] == f"rm -f {runs} {stamp}"
    assert steps.index(f"touch {runs}") < steps.index(f"rm -f {stamp}")
    assert steps[-2:] == [
        f"touch {stamp}",
        f"{tmp_path / 'absent'}/bin/python -X warn_default_encoding -m pytest",
    ]


@pytest.mark.parametrize("arguments", [["UV="], ["UV=uv"]], ids=["pip", "uv"])
def test_the_demo_sets_up_what_it_runs_on_and_says_so(tmp_path: Path, arguments: list[str]):
    plan = dry_run(tmp_path, *arguments, target="demo")
    said = re.findall(r'echo "(Setting .*|Adding .*)"', plan)

    assert "requirements.lock" not in plan
    assert "--all-groups" not in plan
    assert [words.split(":")[1].split("(")[0].strip(" .") for words in said] == [
        "what certreg needs to run"
    ]
    assert len(re.findall(r'echo "(?:Setting|Adding) ', dry_run(tmp_path, *arguments))) == 2


def test_a_set_up_that_cannot_start_says_what_to_install(tmp_path: Path):
    done = make("test", f"VENV={tmp_path / 'absent'}", "UV=", "PYTHON=python3.no-such")

    assert done.returncode != 0
    assert "apt-get install python3" in done.stderr
    assert not (tmp_path / "absent").exists()
