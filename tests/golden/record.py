"""Writes what every command of one checkout prints and leaves behind, over a fixed corpus.

    python tests/golden/record.py CHECKOUT OUT --inputs FOLDER --begun FOLDER [--part 0/2]
    python tests/golden/record.py CHECKOUT FOLDER --inputs FOLDER --begin

Cases that OUT holds are left as they are. The second line makes the half-done campaigns that the
first goes on with. Of certreg only the command line and public names are used, and the checker's
file: so any checkout can be recorded. It comes first on PYTHONPATH, which `make golden` sees to.
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import os
import shutil
import signal
import subprocess
import sys
import tomllib
import traceback
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from cases import Case, How, Step, begun, cases, half_done
from volatile import stable_file, stable_name, stable_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

PATIENCE = (
    3600  # seconds for one step: a fork then ends by a signal, which is recorded; else all stops
)


@dataclass(frozen=True)
class Recorder:
    """One checkout and the folders of its record: `work` to run in, `out` to write to."""

    checkout: Path
    work: Path
    out: Path
    main: Callable[[], Any]

    def record(self, case: Case) -> None:
        """The steps of a case, then the files it left behind: all of it in `out`, or nothing."""
        folder, place = self.work / "unfinished" / case.name, self.work / case.name
        folder.mkdir(parents=True)
        if case.begun is not None:
            shutil.copytree(self.work / "begun" / case.begun, place)
        place.mkdir(exist_ok=True)
        for k, step in enumerate(case.steps):
            code, out, err = self.run(step, place)
            words = " ".join((step.how.value, *step.arguments))
            told = f"$ {words}\nexit code {code}\n--- stdout\n{out}--- stderr\n{err}"
            (folder / f"step-{k:02}.txt").write_text(
                told, errors="surrogateescape", encoding="utf-8"
            )
        for path in sorted(place.rglob("*")):
            if path.is_file():
                self.keep(path, folder / "files" / stable_name(f"{path.relative_to(place)}"))
        folder.rename(self.out / case.name)

    def keep(self, path: Path, kept: Path) -> None:
        """What is compared of a file; its own name, where the record has it under another."""
        text = stable_file(path.name, path.read_bytes(), self.places())
        title = "" if path.name == kept.name else f"name: {path.name}\n"
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.with_name(f"{kept.name}.txt").write_text(f"{title}{text}", "utf-8")

    def run(self, step: Step, place: Path) -> tuple[int, str, str]:
        """Exit code, stdout and stderr of a step, the texts without what is volatile."""
        with (self.work / "stdout").open("w+b") as out, (self.work / "stderr").open("w+b") as err:
            if step.how in {How.COMMAND, How.PYTHON}:
                code = forked(lambda: self.called(step), place, out.fileno(), err.fileno())
            else:
                command = [sys.executable, *self.start(step.how), *step.arguments]
                code = subprocess.run(
                    command, cwd=place, stdout=out, stderr=err, check=False, timeout=PATIENCE
                ).returncode
            return code, self.printed(out), self.printed(err)

    def printed(self, stream: BinaryIO) -> str:
        """What was written to a stream, without what is volatile."""
        stream.seek(0)
        return stable_text(stream.read().decode(errors="surrogateescape"), self.places())

    def start(self, how: How) -> tuple[str, ...]:
        """How Python is started on a step in a process of its own."""
        if how is How.CHECKER:
            return ("-I", "-S", str(self.checkout / "certreg" / "verify.py"))
        return ("-m", "certreg")

    def called(self, step: Step) -> Any:
        """The step in this process."""
        if step.how is How.PYTHON:
            function, *arguments = step.arguments
            return getattr(import_module("public_calls"), function)(*arguments)
        sys.argv = ["certreg", *step.arguments]
        return self.main()

    def places(self) -> dict[str, str]:
        """Paths of this machine, and how they are called in the record."""
        return {
            sys.executable: "PYTHON",
            sys.prefix: "PREFIX",
            str(self.checkout): "CHECKOUT",
            str(self.work): "WORK",
            str((self.work / "inputs").resolve()): "INPUTS",
            sys.path[0]: "GOLDEN",  # this folder, in a traceback
        }


def forked(call: Callable[[], Any], place: Path, out: int, err: int) -> int:
    """The exit code of a call in a fork of this process, in the folder, with its own streams."""
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    code = 70  # of a traceback
    try:
        signal.alarm(PATIENCE)
        os.chdir(place)
        for stream, number in ((os.open(os.devnull, os.O_RDONLY), 0), (out, 1), (err, 2)):
            os.dup2(stream, number)
        call()
        code = 0
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    except BaseException:  # noqa: BLE001 (a traceback is part of the record)
        traceback.print_exc()
    finally:
        with contextlib.suppress(OSError, ValueError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def entry(checkout: Path) -> Callable[[], Any]:
    """What the command `certreg` of a checkout calls, as its pyproject.toml says."""
    with (checkout / "pyproject.toml").open("rb") as stream:
        module, name = tomllib.load(stream)["project"]["scripts"]["certreg"].split(":")
    return getattr(import_module(module), name)


def load(recorder: Recorder) -> None:
    """Load what commands of this checkout load, libraries and modules, so that forks are fast."""
    listing = recorder.work / "modules"
    rows = recorder.work / "inputs" / "rows"

    def names() -> None:
        sides = [str(rows / f"1111-{side}.csv") for side in ("source", "target")]
        for command in (["certify"], ["equilibria", "--method", "all"]):
            sys.argv = ["certreg", *command, *sides]
            with contextlib.suppress(SystemExit):
                recorder.main()
        listing.write_text("\n".join(sys.modules), "utf-8")

    with Path(os.devnull).open("wb") as nothing:
        forked(names, recorder.work, nothing.fileno(), nothing.fileno())
    for name in listing.read_text("utf-8").split():
        with contextlib.suppress(ImportError):  # some libraries list names that are no modules
            import_module(name)
    gc.freeze()  # no fork touches, and so copies, what stands here


def require_own(checkout: Path) -> None:
    """That the package that is loaded is the one of the checkout."""
    import certreg

    loaded = Path(certreg.__file__ or "").resolve().parent.parent
    if loaded != checkout:
        sys.exit(f"certreg is loaded from {loaded}, not {checkout}: put it first on PYTHONPATH")


def begin(recorder: Recorder) -> None:
    """Campaigns run to their end, of which then a part is taken away."""
    for case in begun():
        place = recorder.work / case.name
        place.mkdir()
        for step in case.steps:
            code, _, err = recorder.run(step, place)
            if code not in {0, 2}:  # 2: pairs that cannot be read are part of the list
                sys.exit(f"{case.name} ended with exit code {code}: {err}")
        half_done(place)
        shutil.copytree(place, recorder.out / case.name)


def record_cases(recorder: Recorder, missing: Sequence[Case], campaigns: Path | None) -> None:
    """Record the cases that are missing, given the folder of half-done campaigns."""
    if not missing:
        return
    recorder.out.mkdir(parents=True, exist_ok=True)
    if campaigns is not None:
        shutil.copytree(campaigns, recorder.work / "begun")
    load(recorder)
    for case in missing:
        recorder.record(case)


def main() -> None:
    parser = argparse.ArgumentParser(description="Records what users see of a checkout.")
    parser.add_argument("checkout", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--inputs", type=Path, required=True)
    parser.add_argument("--begun", type=Path)
    parser.add_argument("--begin", action="store_true")
    parser.add_argument("--part", default="0/1", help="k/n: every n-th case, from the k-th")
    parser.add_argument("--only", metavar="PREFIX", default="", help="cases whose names begin so")
    told = parser.parse_args()
    checkout, out = told.checkout.resolve(), told.out.resolve()
    require_own(checkout)
    first, parts = map(int, told.part.split("/"))
    work = out.with_name(f"{out.name}-work-{first}")
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    inputs = told.inputs.resolve()
    (work / "inputs").symlink_to(inputs)  # not copied: a campaign knows where its list stands
    recorder = Recorder(checkout, work, out, entry(checkout))
    if told.begin:
        begin(recorder)
    else:
        chosen = [case for case in cases() if case.name.startswith(told.only)]
        missing = [case for case in chosen[first::parts] if not (out / case.name).exists()]
        record_cases(recorder, missing, told.begun)
    shutil.rmtree(work)


if __name__ == "__main__":
    main()
