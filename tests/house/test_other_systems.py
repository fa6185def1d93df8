"""What is known to differ on Windows, emulated here: certreg has not been run there.

Widths of integers stand in `native/test_kernels.py`, line ends that are read in `io/test_io.py`.
"""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path, PureWindowsPath
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from commands import certreg, write_csv
from strategies import AXES

import build_kernels
import certreg as package
from certreg.certificate import private_folder
from certreg.cli.main import main
from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically, write_files, write_together
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Callable

PACKAGE = Path(package.__file__).parent
DATA = PACKAGE / "data"
CLOUDS = (DATA / "survey_source.csv", DATA / "survey_target.csv")

# Names that Windows lacks -------------------------------------------------------------------------

MODULES = ("fcntl", "resource", "pwd", "grp", "termios", "tty", "pty", "readline", "syslog")
NAMES = {
    "os": (
        *("fork", "forkpty", "getuid", "geteuid", "getgid", "getpgid", "killpg", "setsid"),
        *("sched_getaffinity", "pread", "pwrite", "posix_fadvise", "fchmod", "chown", "uname"),
        *("getloadavg", "sysconf", "mkfifo", "nice", "statvfs", "O_NOFOLLOW", "O_DIRECTORY"),
    ),
    "signal": ("SIGKILL", "SIGHUP", "SIGALRM", "SIGUSR1", "setitimer", "pthread_kill"),
    "mmap": ("MADV_SEQUENTIAL", "MADV_WILLNEED", "MAP_PRIVATE", "PROT_READ"),
}
LACKING = """
import importlib, sys
import numpy, filelock  # which ask what system this is
for name in {modules!r}:
    sys.modules[name] = None
for name, lacking in {names!r}.items():
    module = importlib.import_module(name)
    for each in lacking:
        module.__dict__.pop(each, None)
from certreg.cli.main import main
for line in {lines!r}:
    sys.argv = ["certreg", *line]
    try:
        main()
    except SystemExit as stop:
        print("CODE", stop.code, flush=True)
"""


@pytest.mark.long
def test_every_command_runs_without_what_windows_lacks(tmp_path: Path):
    """Nor do backslashes in names mean anything, and workers are spawned: there is no fork."""
    out, made, pairs = tmp_path / "out", tmp_path / "out" / "certificate.json", tmp_path / "p.csv"
    write_csv(tmp_path / r"new\table.csv", AXES)
    pairs.write_text("source,target,name\nnew\\table.csv,new\\table.csv,\\n\n", "utf-8")
    lines: list[tuple[object, ...]] = [
        ("batch", pairs),
        ("certify", *CLOUDS, "--no-relaxation", "--out", out),
        ("verify", made),
        ("assess", *CLOUDS, "--pose", DATA / "flipped.txt"),
        ("apply", out, CLOUDS[0], "--out", tmp_path / "moved.csv"),
        ("report", made, "--out", tmp_path / "report.html"),
        ("equilibria", *CLOUDS),
        ("simulate", *CLOUDS),
        ("codegen", "--out", tmp_path / "c"),
        ("info",),
    ]
    code = LACKING.format(modules=MODULES, names=NAMES, lines=[[*map(str, line)] for line in lines])
    command = [sys.executable, "-W", "error", "-c", code]
    run = subprocess.run(command, capture_output=True, encoding="utf-8", check=False)
    line = json.loads(run.stdout.partition("\n")[0])

    codes = re.findall(r"^CODE (\d)$", run.stdout, flags=re.MULTILINE)
    assert "".join(codes) == "0001000000", run.stderr
    assert all(line.startswith("note: ") for line in run.stderr.splitlines())
    assert (line["name"], line["exit_code"]) == (r"\n", 0)


@pytest.mark.slow
def test_no_name_that_windows_lacks_is_used_unasked():
    """Each of these uses asks first, or stands in code that runs where the name is."""
    words = "|".join(f"{module}\\.(?:{'|'.join(names)})" for module, names in NAMES.items())
    unasked = re.compile(rf"(?<!hasattr\()\b(?:{words}|import (?:{'|'.join(MODULES)}))\b")
    found = {
        (path.name, use)
        for path in (*PACKAGE.rglob("*.py"), *map(Path, (build_kernels.__file__,)))
        for use in unasked.findall(path.read_text("utf-8"))
    }

    assert found <= {
        ("atomic.py", "os.getuid"),  # asks by hasattr
        ("memory.py", "import resource"),  # ImportError: no limit
        ("private_folder.py", "os.getuid"),  # as atomic.py
        ("workers.py", "os.sched_getaffinity"),  # as atomic.py
    }
    assert unasked.findall("os.fork(); import fcntl") == ["os.fork", "import fcntl"]


# A console that is not of UTF-8 -------------------------------------------------------------------


def as_on_a_console(encoding: str, *arguments: object) -> tuple[int, bytes, bytes]:
    """Exit code and bytes of a command whose output goes to a console with Windows' line ends."""
    out, err = io.BytesIO(), io.BytesIO()
    stdout = io.TextIOWrapper(out, encoding, newline="\r\n")
    stderr = io.TextIOWrapper(err, encoding, "backslashreplace", newline="\r\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["certreg", *map(str, arguments)])
        patch.setattr(sys, "stdout", stdout)
        patch.setattr(sys, "stderr", stderr)
        with pytest.raises(SystemExit) as stop:
            main()
        stdout.flush()
        stderr.flush()
    code: Any = stop.value.code
    return code, out.getvalue(), err.getvalue()


@pytest.fixture(scope="module")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Clouds and results whose names and labels no single Western code page has."""
    folder = tmp_path_factory.mktemp("ж χ²±°") / "点"
    folder.mkdir()
    labels = ["α", "β±", "ж°", "点", "e", "f"]
    for name in ("χ.csv", "ψ.csv"):
        write_csv(folder / name, AXES, labels)
    (folder / "pairs.csv").write_text("source,target,name\nχ.csv,ψ.csv,χ→ψ\n", "utf-8")
    (folder / "pose.txt").write_text("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "utf-8")
    assert certreg("certify", folder / "χ.csv", folder / "ψ.csv", "--out", folder / "д").code == 0
    return folder


COMMANDS = {
    "certify": ("certify", "χ.csv", "ψ.csv", "--sigma", "1", "--out", "out-д"),
    "certify --json": ("certify", "χ.csv", "ψ.csv", "--no-simulation", "--json"),
    "assess": ("assess", "χ.csv", "ψ.csv", "--pose", "pose.txt"),
    "apply": ("apply", "д", "χ.csv", "--out", "д.csv"),
    "report": ("report", "д/certificate.json", "--out", "д.html"),
    "verify": ("verify", "д/certificate.json", "χ.csv", "ψ.csv"),
    "equilibria": ("equilibria", "χ.csv", "ψ.csv", "--out", "count-д.json"),
    "simulate": ("simulate", "χ.csv", "ψ.csv"),
    "help": ("assess", "--help"),
    "info": ("info",),
}


@pytest.mark.one_in(4)
@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
@pytest.mark.parametrize("name", COMMANDS)
def test_names_that_the_console_cannot_show_are_escaped(
    name: str, encoding: str, foreign: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(foreign)
    code, out, err = as_on_a_console(encoding, *COMMANDS[name])

    assert code == 0, err
    assert out
    if name == "report" and encoding == "cp1252":  # for ASCII, click prints UTF-8
        assert rb"\u0434.html: open it" in out


def test_a_refusal_of_such_a_name_is_one_line(foreign: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(foreign)
    code, out, err = as_on_a_console("cp1252", "certify", "щ.csv", "ψ.csv")

    assert (code, out) == (2, b"")
    assert err.startswith(rb"certreg: \u0449.csv: cannot be read (")
    assert err.endswith(b": give a readable file\r\n")


def test_json_on_such_a_console_is_the_same_document(
    foreign: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(foreign)
    line = ("equilibria", "χ.csv", "ψ.csv", "--json")
    _, out, _ = as_on_a_console("cp1252", *line)

    assert json.loads(out.decode("ascii")) == json.loads(certreg(*line).out)


# Files --------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_no_file_of_results_has_the_line_ends_of_the_system(
    foreign: Path, monkeypatch: pytest.MonkeyPatch
):
    """What is opened for text translates them there: so everything is written as bytes."""
    monkeypatch.chdir(foreign)
    opened = list[tuple[Any, str]]()
    honest = io.open

    def watched(file: Any, mode: str = "r", *rest: Any, **named: Any) -> Any:
        opened.append((file, mode))
        return honest(file, mode, *rest, **named)

    monkeypatch.setattr(io, "open", watched)
    monkeypatch.setattr("builtins.open", watched)
    for name in ("certify", "apply", "report", "equilibria"):
        certreg(*COMMANDS[name])

    assert [each for each in opened if "b" not in each[1] and set(each[1]) & set("wax+")] == []
    written = [*Path("out-д").iterdir(), *map(Path, ("д.csv", "д.html", "count-д.json"))]
    text = [path for path in written if path.suffix != ".npz"]
    assert len(text) > 6
    assert not any(b"\r" in path.read_bytes() for path in text)


def held(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """As if another program held files of these names open: Windows neither replaces nor removes.

    It removes none of an unfinished file either while something looks at it.
    """
    replace, unlink = Path.replace, Path.unlink

    def refuse(path: Path) -> None:
        if path.name in names:
            raise PermissionError(13, "Access is denied", str(path))

    def replaced(self: Path, target: Any) -> Path:
        refuse(Path(target))
        return replace(self, target)

    def unlinked(self: Path, *, missing_ok: bool = False) -> None:
        refuse(self)
        unlink(self, missing_ok=missing_ok)

    monkeypatch.setattr(Path, "replace", replaced)
    monkeypatch.setattr(Path, "unlink", unlinked)


WRITES: dict[str, Callable[[Path], object]] = {
    "one": lambda path: write_atomically(path, b"new"),
    "some": lambda path: write_files(path.parent, {path.name: b"new"}),
    "together": lambda path: write_together({path: b"new", path.with_name("b"): b"new"}, []),
}


@pytest.mark.parametrize("name", WRITES)
def test_a_file_that_another_program_holds_is_left_and_named(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    place = tmp_path / "report.html"
    place.write_bytes(b"old")
    held(monkeypatch, place.name)
    with pytest.raises(InvalidFileError, match=r"cannot be written \(Access is denied\): choose"):
        WRITES[name](place)

    assert [path.name for path in tmp_path.iterdir()] == [place.name]
    assert place.read_bytes() == b"old"


def test_an_unfinished_file_that_cannot_be_removed_hides_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def refuse(self: Path, *_: object, **__: object) -> None:
        raise PermissionError(13, "Access is denied", str(self))

    monkeypatch.setattr(Path, "replace", refuse)
    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(InvalidFileError, match=r"a\.json: cannot be written \(Access is denied\)"):
        write_atomically(tmp_path / "a.json", b"new")


def test_a_folder_is_judged_by_modes_only_where_there_are_modes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """On Windows every folder has the mode 777 and belongs to user 0, and nobody has a number."""
    folder = tmp_path / "mine"
    folder.mkdir()
    folder.chmod(0o777)
    status = SimpleNamespace(st_mode=folder.stat().st_mode, st_uid=0)
    windows = SimpleNamespace(name="nt", scandir=os.scandir)
    with pytest.raises(private_folder.UnusableFolderError, match="others may write"):
        private_folder._require_own(folder, folder.stat())

    monkeypatch.setattr(private_folder, "os", windows)
    monkeypatch.setattr(Path, "stat", lambda *_, **__: status)
    private_folder._require_own(folder, Path().stat())
    private_folder._require_fixed(folder)


def test_a_path_with_backslashes_is_shown_whole():
    path = PureWindowsPath("C:\\Users\\ω\\new\\table.csv")

    assert shown(path) == r"C:\\Users\\\u03c9\\new\\table.csv"
    assert json.loads(f'"{shown(path)}"') == str(path)


# Libraries ----------------------------------------------------------------------------------------


def test_a_build_survives_libraries_that_are_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Windows removes none: not of another process, nor the one that tells the level."""
    folder, old = tmp_path / "built", tmp_path / "built" / f"kernels-old{build_kernels.SUFFIX}"
    folder.mkdir()
    old.write_bytes(b"loaded elsewhere")
    places = list[Path]()

    def compiled(scratch: Path, **_: object) -> build_kernels.Built:
        places.append(scratch)
        (scratch / "processor.so").write_bytes(b"loaded here")
        return build_kernels.Built(
            digest="", checkout=False, compiler="", asked="", processor="", variants={}, why="none"
        )

    unlink = os.unlink

    def unlinked(path: Any, **options: Any) -> None:
        if Path(path).name in {"processor.so", old.name}:
            raise PermissionError(13, "Access is denied", str(path))
        unlink(path, **options)

    monkeypatch.setattr(build_kernels, "_by_any_compiler", compiled)
    with monkeypatch.context() as windows:
        windows.setattr(os, "unlink", unlinked)
        build_kernels.build(folder, checkout=False, set_up=False)

    assert old.exists()
    assert (folder / build_kernels.kernels.RECORD).is_file()
    assert (places[0] / "processor.so").exists()  # it stays in the folder for temporary files
