"""Compiling the C code once, with the user's compiler; what comes out is tried before it is kept.

A library is named by a digest of all that it depends on: sources, compiler, flags, processor.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import platform
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import warnings
from functools import cache as kept
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.errors import CertregError, SlowSimulationWarning
from certreg.native import cache
from certreg.native.cache import CacheError

if TYPE_CHECKING:
    from collections.abc import Sequence

HERE = Path(__file__).resolve().parent
GENERATED = HERE / "generated"
SIGNATURES = GENERATED / "signatures.json"
UNITS = (
    GENERATED / "dynamics.c",
    HERE / "escape.c",
    HERE / "midpoint.c",
    HERE / "single.c",
    HERE / "lanes.c",
    HERE / "exact.c",
    HERE / "pose.c",
    HERE / "stationary.c",
    HERE / "sums.c",
)
HEADERS = (
    GENERATED / "dynamics.h",
    GENERATED / "layout.h",
    *(
        HERE / name
        for name in (
            *("loops.h", "lanes.h", "loop.h", "exact.h"),
            *("eigen.h", "pose.h", "stationary.h", "sums.h"),
        )
    ),
)
# No -ffast-math: a NaN must stay one. -fno-math-errno: sqrt as one instruction.
FLAGS = ("-std=gnu11", "-O3", "-march=native", "-fno-math-errno", "-fPIC", "-shared", "-Wno-psabi")
PLAIN_FLAGS = ("-std=gnu11", "-O2", "-fPIC", "-shared")  # for compilers that refuse the others
COMPILERS = ("cc", "gcc", "clang")
COMPILING = "certreg-compiling-"  # how folders for a compilation begin
PATIENCE = 120.0  # seconds for a compilation that takes three
WRITTEN = (  # by hand, not generated
    "certreg_euler_single",
    "certreg_euler_lanes",
    "certreg_splitting_single",
    "certreg_splitting_lanes",
    "certreg_midpoint_single",
    "certreg_exact_sums",
    "certreg_pose",
    "certreg_stationary_poses",
    "certreg_sums",
)
# Calls each generated function on zeros: a processor that lacks an instruction ends here.
TRIAL = """
import ctypes, json, sys
library = ctypes.CDLL(sys.argv[1])
for name in sys.argv[3:]:
    getattr(library, name)
for name, sizes in json.load(open(sys.argv[2])).items():
    numbers = [(ctypes.c_double * n)() for n in sizes["arguments"] + sizes["results"]]
    getattr(library, name)(*numbers)
"""


class CompilationError(CertregError):
    """There is no compiled library; the message says why."""


def compiled_library() -> Path:
    """The path of the compiled library, from the cache or made now.

    Where it cannot be kept, it is made for this process only, with a SlowSimulationWarning. Raises
    CompilationError where there is no compiler, or it fails.
    """
    try:
        compiler = find_compiler()
        name = f"certreg-{_key(compiler)}"
        return cache.find(name) or _compiled(compiler, name)
    except OSError as error:
        raise CompilationError(f"the C code cannot be compiled ({error})") from error


@kept
def is_compiled() -> bool:
    """Whether the library is kept from before, so that nothing has to be compiled."""
    try:
        return cache.find(f"certreg-{_key(find_compiler())}") is not None
    except (OSError, CompilationError):
        return False


def find_compiler() -> tuple[str, ...]:
    """The C compiler to use, with its arguments: `$CC`, or the first of cc, gcc, clang on PATH."""
    named = shlex.split(os.environ.get("CC", ""))
    for name in named[:1] or COMPILERS:
        path = shutil.which(name)
        if path:
            return (path, *named[1:])
    raise CompilationError(f"no C compiler found ({' '.join(named) or ', '.join(COMPILERS)})")


def _key(compiler: tuple[str, ...]) -> str:
    """What a compiled library depends on, in one word."""
    binary = Path(compiler[0]).resolve().stat()
    parts = [
        *(path.read_bytes() for path in (*UNITS, *HEADERS)),
        repr((FLAGS, PLAIN_FLAGS, compiler, binary.st_size, binary.st_mtime_ns)).encode(),
        _processor(),
    ]
    return cache.digest(b"".join(hashlib.sha256(part).digest() for part in parts))[:24]


def _processor() -> bytes:
    """Model and abilities of the processor: another one may not know the instructions."""
    try:
        lines = Path("/proc/cpuinfo").read_bytes()[:65536].splitlines()
    except OSError:
        return repr(platform.uname()).encode()
    wanted = (b"model name", b"flags", b"Features", b"CPU part")
    return b"\n".join(sorted({line for line in lines if line.startswith(wanted)}))


def _compiled(compiler: tuple[str, ...], name: str) -> Path:
    """Compile, try, keep; the folder with what cannot be kept goes when the process ends."""
    cache.sweep(Path(tempfile.gettempdir()), COMPILING)
    folder = Path(tempfile.mkdtemp(prefix=COMPILING))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    fresh = _built(compiler, folder)
    try:
        return cache.store(name, fresh.read_bytes())
    except CacheError as error:
        message = f"compiled code is for this run only: {error}; set CERTREG_CACHE_DIR"
        warnings.warn(message, SlowSimulationWarning, stacklevel=4)
        return fresh


def _built(compiler: tuple[str, ...], folder: Path) -> Path:
    target, words = folder / "library.so", ""
    for flags in (FLAGS, PLAIN_FLAGS):
        command = [*compiler, *flags, f"-I{GENERATED}", f"-I{HERE}"]
        words = _failure([*command, *map(str, UNITS), "-lm", "-o", str(target)], folder)
        if not words:
            words = _trial_failure(target, folder)
        if not words:
            return target
    raise CompilationError(f"{compiler[0]} failed: {words}")


def _trial_failure(library: Path, folder: Path) -> str:
    if getattr(sys, "frozen", False) or not sys.executable:
        return ""  # an application of its own, not Python
    command = [sys.executable, "-I", "-S", "-c", TRIAL, str(library), str(SIGNATURES), *WRITTEN]
    words = _failure(command, folder)
    return words and f"what it made does not run: {words}"


def _failure(command: Sequence[str], folder: Path) -> str:
    """What went wrong in a command, in one line; nothing if nothing did.

    Its words go to a file: children of a compiler that hangs would hold a pipe open.
    """
    said = folder / "said"
    with (
        said.open("wb") as stream,
        subprocess.Popen(  # noqa: S603 - the user's own compiler
            command, stdin=subprocess.DEVNULL, stdout=stream, stderr=stream, start_new_session=True
        ) as process,
    ):
        try:
            code = process.wait(PATIENCE)
        except subprocess.TimeoutExpired as error:
            raise CompilationError(f"{command[0]} took more than {PATIENCE:g} s") from error
        finally:
            _end(process)
    if code == 0:
        return ""
    lines = [line.strip() for line in said.read_text("utf-8", errors="replace").splitlines()]
    for telling in ("no space", "error", ""):
        for line in lines:
            if line and telling in line.lower():
                return line
    return f"code {code}"


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process that still runs, and its children."""
    if process.poll() is not None:
        return
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
