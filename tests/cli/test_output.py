"""Exit code 1 is a verdict: what becomes of the output changes no code, or makes it 2."""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys
import traceback
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from campaign_work import InProcess
from commands import certreg, write_csv

from certreg.cli import campaigns, main, output, registering, reproducing
from certreg.cli.main import COMMANDS
from certreg.verify import main as checked

if TYPE_CHECKING:
    from collections.abc import Callable

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")

CHECKER = str(Path(main.__file__).parents[1] / "verify.py")
FULL = Path("/dev/full")
WORDS = "the output cannot be written"
SPACE, CLOSED = f"{WORDS} (No space left on device)\n", f"{WORDS} (standard output is closed)\n"
LINES = {  # of each command: one that does its work, where the fixture `place` is
    "certify": ("a.csv", "b.csv", "--no-relaxation", "--out", "again"),
    "demo": ("--out", "demo"),
    "assess": ("a.csv", "b.csv", "--pose", "wrong.txt"),  # code 1
    "apply": ("wrong.txt", "a.csv", "--out", "moved.csv"),
    "report": ("out", "--out", "report.html"),
    "verify": ("out", "--max-gap", "0"),  # code 1
    "equilibria": ("a.csv", "b.csv"),
    "simulate": ("a.csv", "b.csv"),
    "batch": ("pairs.csv",),
    "reproduce": ("--runs", "1", "--no-proofs", "--out", "paper"),
    "derive": ("davenport",),
    "codegen": ("--out", "c"),
    "info": (),
}
CODES = {"assess": 1, "verify": 1, "reproduce": 1}  # of the others 0


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two clouds, what `certify` wrote of them, a list and a wrong pose."""
    folder = tmp_path_factory.mktemp("output")
    points = np.random.default_rng(4).normal(size=(6, 3))
    a = write_csv(folder / "a.csv", points.tolist())
    b = write_csv(folder / "b.csv", (points[:, [1, 2, 0]] + 0.01 * points).tolist())
    assert certreg("certify", a, b, "--no-relaxation", "--out", folder / "out").code == 0
    (folder / "pairs.csv").write_text("source,target\na.csv,b.csv\n", "utf-8")
    (folder / "wrong.txt").write_text("1 0 0 1\n0 1 0 2\n0 0 1 3\n", "utf-8")
    return folder


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """No processes for a list, one example, no experiments; a claim of the paper fails."""
    monkeypatch.setattr(registering, "STORIES", registering.STORIES[:1])
    monkeypatch.setattr(campaigns, "workers_at", lambda _: InProcess(1))
    made = SimpleNamespace(observations=(), stands=False)
    monkeypatch.setattr(reproducing, "reproduced", lambda *_, **__: made)
    monkeypatch.setattr(reproducing, "paper_drawings", lambda *_: ())
    monkeypatch.setattr(reproducing, "write_reproduction", lambda *_: Path("verdicts.html"))
    monkeypatch.setattr(reproducing, "texts", lambda _: ["a claim", "another"])


def started(number: int, stream: int | None) -> Any:
    """What Python makes of a descriptor as it starts."""
    return None if stream is None else os.fdopen(number, "w", closefd=False, encoding="utf-8")


def ended(call: Callable[[], Any], folder: Path, out: int | None, err: int | None) -> int:
    """The exit code of a process that Python starts on these streams, None: closed, and ends.

    A fork of this one: so it starts in no time.
    """
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    code: Any = 1  # Python's own for an exception that nobody catches
    try:
        os.chdir(folder)
        for number, stream in ((1, out), (2, err)):
            os.close(number)
            if stream is not None:
                os.dup2(stream, number)
        streams = [started(1, out), started(2, err)]
        sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__ = streams
        call()
    except SystemExit as stop:
        code = stop.code
    except BaseException:  # noqa: BLE001 - as Python does
        with contextlib.suppress(AttributeError, OSError):
            traceback.print_exc(file=streams[1])
    finally:
        try:
            for stream in (sys.stdout, sys.stderr):
                if stream is not None:
                    stream.flush()
        except OSError:
            code = 120  # as Python does
        os._exit(code if isinstance(code, int) else int(code is not None))


def kept(call: Callable[[], Any], folder: Path, out: int | None = -1, err: int | None = -1):
    """Exit code, and what was written to stdout and stderr where -1 stands for them."""
    names = [folder / "stdout", folder / "stderr"]
    with contextlib.ExitStack() as stack:
        streams = [
            stack.enter_context(name.open("wb")).fileno() if given == -1 else given
            for name, given in zip(names, (out, err), strict=True)
        ]
        code = ended(call, folder, *streams)
    given = zip(names, (out, err), strict=True)
    return code, *(name.read_text("utf-8") if stream == -1 else "" for name, stream in given)


@contextlib.contextmanager
def unread():
    """A pipe whose reader has left."""
    reading, writing = os.pipe()
    os.close(reading)
    yield writing
    os.close(writing)


@contextlib.contextmanager
def full():
    if not FULL.exists():
        pytest.skip("this system has no full device")
    handle = os.open(FULL, os.O_WRONLY)
    yield handle
    os.close(handle)


def command(monkeypatch: pytest.MonkeyPatch, *words: str) -> Callable[[], Any]:
    monkeypatch.setattr(sys, "argv", ["certreg", *words])
    return main.main


def stable(text: str) -> str:
    """Without digits: times differ."""
    return "".join("0" if letter.isdigit() else letter for letter in text)


def test_every_command_is_asked():
    assert [*LINES] == [*COMMANDS]


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("name", LINES)
def test_what_becomes_of_the_output_decides_no_verdict(
    name: str, place: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(place)
    run = certreg(name, *LINES[name])  # here, so that the forks find all loaded
    call = command(monkeypatch, name, *LINES[name])

    assert run.code == CODES.get(name, 0)
    with unread() as pipe, full() as device:
        assert ended(call, place, pipe, device) == run.code
        code, told, _ = kept(call, place, err=None)
        assert (code, stable(told)) == (run.code, stable(run.out))
        code, _, told = kept(call, place, out=device)
        assert (code, told.endswith(f"certreg: {SPACE}")) == (2, True)
        assert told.removesuffix(f"certreg: {SPACE}") in run.err
        assert kept(call, place, out=None)[::2] == (2, f"certreg: {CLOSED}")


@pytest.mark.parametrize("line", [("--help",), ("--version",), ("verify", "--help")])
def test_nor_does_it_where_click_prints(
    line: tuple[str, ...], place: Path, monkeypatch: pytest.MonkeyPatch
):
    call = command(monkeypatch, *line)
    with unread() as pipe, full() as device:
        assert kept(call, place, out=pipe)[::2] == (0, "")
        assert kept(call, place, out=device)[::2] == (2, f"certreg: {SPACE}")
        assert kept(call, place, out=None)[::2] == (2, f"certreg: {CLOSED}")


def test_wrong_usage_and_input_end_with_2_whoever_reads(
    place: Path, monkeypatch: pytest.MonkeyPatch
):
    with unread() as pipe, full() as device:
        for line in (("verify", "--nothing"), ("verify", "nowhere.json")):
            call = command(monkeypatch, *line)
            for err in (pipe, device, None):
                assert kept(call, place, err=err)[0] == 2


def test_a_defect_is_no_verdict(place: Path, monkeypatch: pytest.MonkeyPatch):
    def wrong(**_: Any) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(main.cli, "main", wrong)
    code, _, told = kept(command(monkeypatch), place)

    assert code == 70
    assert told.startswith("Traceback")
    assert kept(command(monkeypatch), place, err=None)[0] == 70


def test_a_reader_that_leaves_late_ends_nothing(place: Path, monkeypatch: pytest.MonkeyPatch):
    """All work is done, to its end."""
    done = place / "done"

    def long(**_: Any) -> int:
        for _line in range(1000):
            sys.stdout.write(1000 * "x" + "\n")
        done.write_text("", "utf-8")
        return 4

    monkeypatch.setattr(main.cli, "main", long)
    reading, writing = os.pipe()
    reader = os.fork()
    if not reader:
        os.close(writing)
        os.read(reading, 1)
        os._exit(0)
    os.close(reading)
    code, _, told = kept(command(monkeypatch), place, out=writing)
    os.close(writing)
    os.waitpid(reader, 0)

    assert (code, told) == (4, "")
    assert done.exists()


def test_no_file_takes_the_place_of_a_stream_that_is_closed(
    place: Path, monkeypatch: pytest.MonkeyPatch
):
    def opening(**_: Any) -> int:
        with (place / "a.csv").open("rb") as file:
            return 0 if file.fileno() > 2 and sys.stderr.write("lost") else 3

    monkeypatch.setattr(main.cli, "main", opening)
    assert kept(command(monkeypatch), place, err=None)[0] == 0


def test_streams_that_others_put_there_stay():
    with contextlib.redirect_stdout(io.StringIO()) as out:
        output.shelter_streams()
        assert sys.stdout is out


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("code", [0, 1])
def test_the_checker_alone_ends_with_the_code_of_its_verdict(code: int, place: Path):
    limits = ["--max-gap=0"] * code

    def call() -> None:
        sys.exit(checked([*limits, "out/certificate.json"]))

    with unread() as pipe, full() as device:
        assert kept(call, place, out=pipe)[::2] == (code, "")
        assert kept(call, place, out=device)[::2] == (2, SPACE)
        assert kept(call, place, out=None)[::2] == (2, f"{WORDS} (it is closed)\n")
        for err in (pipe, device, None):
            assert kept(call, place, err=err)[0] == code
            assert kept(call, place, out=device, err=err)[0] == 2


@pytest.mark.slow
@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize(
    ("program", "closed"),
    [(("-m", "certreg", "verify"), CLOSED), (("-I", "-S", CHECKER), "it is closed)\n")],
    ids=["certreg", "verify.py"],
)
def test_the_shell_sees_these_codes(program: tuple[str, ...], closed: str, place: Path):
    """What is run above in forks, as users do; the verdict is that it is refused."""
    typed = [sys.executable, *program, "--max-gap=0", "out/certificate.json"]
    quoted = " ".join(f"'{word}'" for word in typed)
    for line, code, told in (
        (f"{quoted} | true; exit ${{PIPESTATUS[0]}}", 1, ""),
        (f"{quoted} > /dev/full", 2, SPACE),
        (f"{quoted} >&-", 2, closed),
    ):
        run = subprocess.run(
            ["bash", "-c", line],
            cwd=place,
            capture_output=True,
            text=True,
            check=False,
            encoding="utf-8",
        )
        assert (run.returncode, run.stderr.endswith(told)) == (code, True), line
        assert run.stderr.count("\n") == bool(told)
