"""What commands say besides their results: bars, notes, hints, versions; and what they refuse."""

from __future__ import annotations

import io
import platform
import warnings
from contextlib import redirect_stderr
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

import click
import numpy as np
import pytest
from commands import certreg, write_csv

from certreg.cli import memory, options, progress
from certreg.cli.campaigns import resumable
from certreg.cli.main import cli
from certreg.cli.progress import Progress, Stages
from certreg.errors import InvalidFileError, NotCompiledWarning

if TYPE_CHECKING:
    from pathlib import Path


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def terminal() -> Terminal:
    """To be made stderr in the test itself: around it pytest does so with its own."""
    return Terminal()


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def test_a_bar_counts_what_this_run_makes_and_its_rate(terminal: Terminal, clock: list[float]):
    with redirect_stderr(terminal), Progress(1000, items="pairs") as bar:
        bar.begin_with(200)
        assert terminal.getvalue() == "note: 200 of 1,000 pairs were there already\n"
        clock[0] += 0.9
        bar.advance(40)
        assert (bar.made, bar.seconds, terminal.tell()) == (40, pytest.approx(0.9), 44)
        clock[0] += 1.1
        bar.advance(160)
        assert (bar.made, bar.seconds) == (200, pytest.approx(2.0))
        assert "25%" in terminal.getvalue()  # of the 800 that were left
        assert "100 pairs/s" in terminal.getvalue()
        clock[0] += 2.0
        bar.advance(200)
        assert "50%" in terminal.getvalue()


def test_a_bar_is_left_by_the_error_that_ends_it(clock: list[float]):
    bar = Progress(10)
    clock[0] += 3.0

    def broken() -> None:
        with bar:
            bar.advance(1)
            raise KeyError

    with pytest.raises(KeyError):
        broken()
    assert (bar.made, bar.seconds) == (1, 3.0)
    assert (Progress(10).made, Progress(10).seconds) == (0, 0.0)


def test_stages_are_named_after_a_second_and_gone_at_the_end(
    terminal: Terminal, clock: list[float]
):
    with redirect_stderr(terminal):
        with Stages() as stages:
            clock[0] += progress.PATIENCE
            stages.at("early")
        assert terminal.getvalue() == ""
        with Stages() as stages:
            clock[0] += progress.PATIENCE + 0.1
            stages.at("figures")
            stages.at("instances", 1000, 2000)
        assert terminal.getvalue() == (
            "\r\033[Kfigures ...\r\033[Kinstances 1,000 of 2,000 ...\r\033[K"
        )
        assert progress.PATIENCE == options.PATIENCE == 1.0


def test_a_long_computation_says_what_it_does_to_a_terminal(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch
):
    started = list[tuple[float, Any]]()

    class Timer:
        def __init__(self, seconds: float, say: Any) -> None:
            self.seconds, self.say = seconds, say

        def start(self) -> None:
            started.append((self.seconds, self.say))

        def cancel(self) -> None: ...

    monkeypatch.setattr(options.threading, "Timer", Timer)
    with redirect_stderr(terminal), options._patience("working"):
        ((seconds, say),) = started
        say()
    assert (seconds, terminal.getvalue()) == (1.0, "working ...\n")
    with redirect_stderr(io.StringIO()), options._patience("working"):
        assert len(started) == 1


def test_warnings_of_certreg_are_notes_and_others_are_left_to_python(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch
):
    with redirect_stderr(terminal):
        others = list[Any]()
        with warnings.catch_warnings():
            warnings.simplefilter("always", UserWarning)
            monkeypatch.setattr(
                warnings, "showwarning", lambda *given, **_: others.append(given[:2])
            )
            warnings.filterwarnings("ignore", category=NotCompiledWarning)
            with options.warnings_as_notes():
                for _ in range(2):
                    warnings.warn("slow", NotCompiledWarning, stacklevel=1)
                warnings.warn("odd", UserWarning, stacklevel=1)
        assert terminal.getvalue() == "note: slow\nnote: slow\n"
        ((message, category),) = others
        assert (str(message), category) == ("odd", UserWarning)


@pytest.mark.parametrize("error", [KeyboardInterrupt(), InvalidFileError("full"), KeyError()])
def test_what_ends_a_campaign_ends_it_and_says_that_nothing_is_lost(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, error: BaseException
):
    with pytest.raises(type(error)), resumable(tmp_path):
        raise error
    said = capsys.readouterr().err
    assert said.strip() == (
        ""
        if isinstance(error, KeyError)
        else f"{tmp_path}: what is done is kept: run the same to go on"
    )


def test_info_names_the_system_and_the_machine():
    told = dict(line.split(maxsplit=1) for line in certreg("info").out.splitlines())

    assert told["system"] == f"{platform.system()} {platform.machine()}"
    assert told["Python"].startswith(platform.python_version())
    assert told["numpy"] == np.__version__


def test_notes_on_a_simulation_stand_on_stderr(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    module = import_module("certreg.cli.dynamics")
    found = module.run

    def noted(*arguments: Any, **more: Any) -> Any:
        end = found(*arguments, **more)
        return replace(end, course=replace(end.course, notes=("one", "two")))

    monkeypatch.setattr(module, "run", noted)
    cloud = write_csv(tmp_path / "a.csv", [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    run = certreg("simulate", cloud, cloud)

    assert run.err.splitlines()[-2:] == ["note: one", "note: two"]


@pytest.mark.parametrize(("given", "taken"), [("2", 2.0), ("0.5", 0.5), ("Optimal", "optimal")])
def test_a_damping_is_a_number_or_a_word(given: str, taken: object):
    said = options._damping(None, None, given)  # pyright: ignore[reportArgumentType]

    assert said == taken
    assert type(said) is type(taken)
    assert options._damping(None, None, None) is None  # pyright: ignore[reportArgumentType]


def test_the_soft_limit_on_memory_counts_and_at_enough_of_it_nothing_is_tried(
    monkeypatch: pytest.MonkeyPatch,
):
    resource = pytest.importorskip("resource")
    tried = list[object]()
    for limits, known in (
        ((1 << 30, 1 << 40), 1 << 30),
        ((resource.RLIM_INFINITY, 1 << 30), None),
    ):
        monkeypatch.setattr(resource, "getrlimit", lambda _, limits=limits: limits)
        assert memory.memory_limit() == known
    monkeypatch.setattr(memory, "_succeeds", tried.append)
    monkeypatch.setattr(memory.os, "cpu_count", lambda: 3)
    enough = memory.BASE + 3 * memory.EACH_PROCESSOR
    monkeypatch.setattr(memory, "memory_limit", lambda: enough)
    memory.require_loadable("")
    assert tried == []
    monkeypatch.setattr(memory, "memory_limit", lambda: enough - 1)
    with pytest.raises(memory.MissingToolError, match=f"the {(enough - 1) >> 20} MB of memory"):
        memory.require_loadable("")
    assert len(tried) == 1
    assert memory.EACH_PROCESSOR >= 1 << 24


def test_commands_and_options_are_completed_and_none_is_imported(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("certreg.cli.main.import_module", lambda _: 1 / 0)
    context = click.Context(cli)

    assert [one.value for one in cli.shell_complete(context, "si")] == ["simulate"]
    assert "--version" in [one.value for one in cli.shell_complete(context, "--v")]


@pytest.mark.parametrize(
    ("command", "missing"),
    [(("assess", "a.csv", "a.csv"), "--pose"), (("codegen",), "--out")],
)
def test_what_a_command_cannot_do_without_is_asked_for(command: tuple[str, ...], missing: str):
    run = certreg(*command)

    assert run.code == 2
    assert run.err.startswith("Usage: ")
    assert f"Missing option '{missing}'" in run.err


def test_what_ends_a_command_is_told_on_stderr(monkeypatch: pytest.MonkeyPatch):
    def short(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr(cli, "main", short)
    run = certreg("info")

    assert (run.code, run.out) == (2, "")
    assert run.err == "certreg: not enough memory for this input: use fewer points\n"


def test_a_bar_is_as_long_as_what_is_left(terminal: Terminal, clock: list[float]):
    with redirect_stderr(terminal), Progress(5) as bar:
        bar.begin_with(1)
        clock[0] += 2.0
        bar.advance(1)
        assert " 25%" in terminal.getvalue()
        bar.advance(3)
        assert "100%" in terminal.getvalue()
