"""The README: short, and every block of it runs and prints what it says."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg

from certreg import equilibria, read_problem

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text("utf-8")
PICTURE = ROOT / "docs" / "_static" / "report.png"
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\]\(([^)#]+)\)")
LEFT_OUT = "[...]"


def blocks(language: str) -> list[str]:
    return [body for found, body in FENCE.findall(README) if found == language]


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the paths of the README are those of this checkout."""
    (tmp_path / "certreg").symlink_to(ROOT / "certreg")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def sessions(text: str) -> Iterator[tuple[str, list[str]]]:
    """The commands of a console, each with the lines that are shown of what it prints."""
    for part in ("\n" + text).split("\n$ ")[1:]:
        command, *shown = part.rstrip("\n").split("\n")
        yield command, shown


def shows(shown: list[str], printed: str) -> bool:
    """Whether these lines are what is printed, where `[...]` stands for anything left out."""
    pattern = ".*".join(re.escape(part) for part in "\n".join(shown).split(LEFT_OUT))
    return re.fullmatch(pattern, printed.rstrip("\n"), re.DOTALL) is not None


def test_it_is_short_and_no_block_of_it_is_passed_over():
    assert len(README.splitlines()) <= 80
    assert {language for language, _ in FENCE.findall(README)} == {"sh", "python", "console"}
    assert README.count("```") == 2 * len(FENCE.findall(README))


def test_its_links_lead_somewhere():
    assert [link for link in LINK.findall(README) if not (ROOT / link).exists()] == []
    assert len(LINK.findall(README)) > 10


def test_its_picture_is_a_small_png():
    content = PICTURE.read_bytes()

    assert "](docs/_static/report.png)" in README
    assert content.startswith(b"\x89PNG\r\n")
    assert len(content) < 150_000


@pytest.mark.usefixtures("checkout")
def test_its_python_runs_in_a_few_lines(capsys):
    (block,) = blocks("python")
    names: dict[str, Any] = {}
    exec(compile(block, "README.md", "exec"), names)  # noqa: S102 - our own page

    assert len([line for line in block.splitlines() if line]) <= 7
    assert np.shape(names["T"]) == (4, 4)
    assert capsys.readouterr().out.startswith("CERTIFIED: the global optimum, and unique")


@pytest.mark.slow
@pytest.mark.usefixtures("checkout")
def test_its_commands_print_what_it_shows():
    (console,) = blocks("console")
    told = list(sessions(console))

    for command, shown in told:
        program, *arguments = shlex.split(command)
        if program == "certreg":
            printed = certreg(*arguments).out
        else:
            assert program == "python3"
            run = subprocess.run(
                [sys.executable, *arguments],
                capture_output=True,
                text=True,
                check=True,
                encoding="utf-8",
            )
            printed = run.stdout
        assert shows(shown, printed), (command, printed)
    assert len(told) == console.count("$ ") == 3


def test_what_is_shown_is_compared():
    assert shows(["one", LEFT_OUT, "three [...] four"], "one\ntwo\nthree and a half four\n")
    assert not shows(["one", LEFT_OUT, "three"], "one\ntwo\nfour\n")
    assert not shows(["one"], "one\ntwo\n")


def test_what_sets_up_is_run_from_a_clean_checkout():
    """By `.ci/run`, which needs a package index: both commands, and pip with the wheel."""
    whole = (ROOT / ".ci" / "run").read_text("utf-8")

    assert "".join(blocks("sh")).splitlines() == ["pip install .", "make demo", "make test"]
    for line in ("make demo", "make test", '"${pip[@]}" install --quiet'):
        assert line in whole


def test_the_flipped_pose_is_the_worst_equilibrium_of_the_survey_points(data: Path):
    matrix = np.loadtxt(data / "flipped.txt")
    problem, _ = read_problem(data / "survey_source.csv", data / "survey_target.csv")
    worst = equilibria(problem).components[-1]
    means = problem.source.mean(axis=0), problem.target.mean(axis=0)
    printed = (data / "flipped.txt").read_text("utf-8")

    assert worst.morse_index == 3
    assert np.allclose(matrix[:3, :3], worst.rotation, rtol=0, atol=1e-12)
    assert np.allclose(matrix[:3, 3], means[1] - worst.rotation @ means[0], rtol=0, atol=1e-8)
    assert printed in (ROOT / "docs" / "howto" / "judge-a-pose.md").read_text("utf-8")
