"""What is given to others: the archive of sources, and the workflow that runs on their systems."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml  # of distributed

ROOT = Path(__file__).parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
WORKFLOW: dict[Any, Any] = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text("utf-8"))
JOBS: dict[str, Any] = WORKFLOW["jobs"]


def commands(job: str) -> str:
    return "\n".join(step["run"] for step in JOBS[job]["steps"] if "run" in step)


def test_the_archive_of_sources_has_what_its_pages_speak_of():
    included = set(PYPROJECT["tool"]["hatch"]["build"]["targets"]["sdist"]["include"])
    pages = {f"/{path.name}" for path in ROOT.glob("*.md")}  # the README is there by itself
    locks = {f"/{path.name}" for path in ROOT.glob("*.lock")}

    assert "/CHANGELOG.md" in pages
    assert (pages | locks) - {"/README.md"} <= included
    assert all((ROOT / name[1:]).exists() for name in included)


def test_urls_of_the_project_are_marked_as_placeholders_until_there_are_some():
    urls: dict[str, str] = PYPROJECT["project"]["urls"]
    marked = "[project.urls]  # placeholders" in (ROOT / "pyproject.toml").read_text("utf-8")

    assert set(urls) >= {"Homepage", "Documentation", "Source", "Changelog", "Security"}
    assert marked == all(".invalid/" in url for url in urls.values())


def test_the_workflow_tests_every_declared_python_on_every_system():
    matrix = JOBS["test"]["strategy"]["matrix"]
    declared = re.findall(r"Python :: (3\.\d+)", "\n".join(PYPROJECT["project"]["classifiers"]))

    assert matrix["python"] == declared
    assert {name.split("-")[0] for name in matrix["os"]} == {"ubuntu", "macos", "windows"}
    assert "ubuntu-24.04-arm" in matrix["os"]
    assert set(matrix["os"]) < set(JOBS["wheels"]["strategy"]["matrix"]["os"])


def test_the_workflow_has_the_lowest_the_newest_no_compiler_coverage_and_other_seeds():
    makefile = (ROOT / "Makefile").read_text("utf-8")
    targets = {name for job in JOBS for name in re.findall(r"\bmake ([a-z-]+)", commands(job))}

    assert "make test-lowest" in commands("lowest")
    assert "--upgrade" in commands("newest")
    assert JOBS["no-compiler"]["env"] == {"CC": "no-such-compiler"}
    assert re.search(r"coverage report --fail-under=9\d$", commands("coverage"))
    assert JOBS["random-seeds"]["env"] == {"CERTREG_SEEDS": "random"}
    assert WORKFLOW[True]["schedule"]  # `on`, as YAML reads it
    assert all(f"\n{name}:" in makefile for name in targets)


@pytest.mark.parametrize("job", [job for job in JOBS if "pytest" in commands(job)])
def test_the_workflow_runs_the_tests_as_make_does(job: str):
    (strict,) = re.findall(
        r"^STRICT := (.*)$", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE
    )

    assert commands(job).count(f"python {strict} -m") == commands(job).count("-m pytest")


def test_the_documentation_says_what_was_not_run():
    page = " ".join((ROOT / "docs" / "install.md").read_text("utf-8").split())

    assert "**untested on Windows and macOS, and on other processors**" in page
    assert "has not been run" in page
