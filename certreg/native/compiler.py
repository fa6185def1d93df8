"""Compiling the C code once, with the user's compiler, into a cache of the user's own.

A library in the cache is named by a digest of all that it depends on: sources, compiler, flags,
processor. Beside it stands the digest of its bytes, so that a damaged file is seen before it is
loaded. It is written under a temporary name and renamed, so that several processes may compile at
once: the last one wins, and all are equal.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import stat
import subprocess
import tempfile
from pathlib import Path

from certreg.errors import CertregError

HERE = Path(__file__).resolve().parent
GENERATED = HERE.parent / "generated"
UNITS = (
    GENERATED / "dynamics.c",
    HERE / "settle.c",
    HERE / "midpoint.c",
    HERE / "single.c",
    HERE / "lanes.c",
)
HEADERS = (GENERATED / "dynamics.h", HERE / "loops.h", HERE / "lanes.h", HERE / "loop.h")
# No -ffast-math: a NaN must stay one. -fno-math-errno: sqrt as one instruction.
FLAGS = ("-std=gnu11", "-O3", "-march=native", "-fno-math-errno", "-fPIC", "-shared", "-Wno-psabi")
PLAIN_FLAGS = ("-std=gnu11", "-O2", "-fPIC", "-shared")  # for compilers that refuse the others
COMPILERS = ("cc", "gcc", "clang")
PATIENCE = 120.0  # seconds for a compilation that takes three


class CompilationError(CertregError):
    """There is no compiled library; the message says why."""


def compiled_library() -> Path:
    """The path of the compiled library, from the cache or made now.

    Raises CompilationError where there is no compiler, it fails, or nothing can be written.
    """
    compiler = find_compiler()
    place = cache_folder()
    library = place / f"certreg-{_key(compiler)}.so"
    if not is_intact(library):
        _compile(compiler, library)
    return library


def find_compiler() -> str:
    """The C compiler to use: the environment's CC, else the first of cc, gcc, clang on PATH."""
    named = os.environ.get("CC")
    for name in (named,) if named else COMPILERS:
        found = shutil.which(name)
        if found:
            return found
    raise CompilationError(f"no C compiler found ({named or ', '.join(COMPILERS)})")


def cache_folder() -> Path:
    """The user's cache for compiled code, made if need be; the owner's alone.

    $CERTREG_CACHE_DIR, else $XDG_CACHE_HOME/certreg, else ~/.cache/certreg. Raises CompilationError
    where it cannot be made or belongs to someone else: code is loaded from it.
    """
    named = os.environ.get("CERTREG_CACHE_DIR")
    base = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    place = Path(named) if named else Path(base).expanduser() / "certreg"
    try:
        place.mkdir(parents=True, exist_ok=True, mode=0o700)
        status = place.stat()
    except (OSError, RuntimeError) as error:
        raise CompilationError(f"the cache {place} cannot be made ({error})") from error
    if hasattr(os, "getuid") and status.st_uid not in {os.getuid(), 0}:
        raise CompilationError(f"the cache {place} belongs to another user: set CERTREG_CACHE_DIR")
    if status.st_mode & stat.S_IWOTH:
        raise CompilationError(f"others may write to the cache {place}: set CERTREG_CACHE_DIR")
    return place


def is_intact(library: Path) -> bool:
    """Whether a library is there with exactly the bytes that were compiled."""
    try:
        return _seal(library).read_text() == _digest(library.read_bytes())
    except (OSError, UnicodeDecodeError):
        return False


def _seal(library: Path) -> Path:
    return library.with_suffix(".sha256")


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _key(compiler: str) -> str:
    """What a compiled library depends on, in one word."""
    binary = Path(compiler).resolve().stat()
    parts = [
        *(path.read_bytes() for path in (*UNITS, *HEADERS)),
        repr((FLAGS, PLAIN_FLAGS, compiler, binary.st_size, binary.st_mtime_ns)).encode(),
        _processor(),
    ]
    return _digest(b"".join(hashlib.sha256(part).digest() for part in parts))[:24]


def _processor() -> bytes:
    """Model and abilities of the processor: another one may not know the instructions."""
    try:
        lines = Path("/proc/cpuinfo").read_bytes()[:65536].splitlines()
    except OSError:
        return repr(platform.uname()).encode()
    wanted = (b"model name", b"flags", b"Features", b"CPU part")
    return b"\n".join(sorted({line for line in lines if line.startswith(wanted)}))


def _compile(compiler: str, library: Path) -> None:
    try:
        with tempfile.TemporaryDirectory(dir=library.parent, prefix=".compiling-") as folder:
            fresh = Path(folder) / "library.so"
            _run_compiler(compiler, fresh)
            seal = Path(folder) / "library.sha256"
            seal.write_text(_digest(fresh.read_bytes()))
            # A reader between the two renames sees a seal that does not fit, and compiles again.
            fresh.replace(library)
            seal.replace(_seal(library))
    except OSError as error:
        raise CompilationError(f"the cache {library.parent} cannot be written ({error})") from error
    if not is_intact(library):
        raise CompilationError(f"the cache {library.parent} does not keep what is written to it")


def _run_compiler(compiler: str, target: Path) -> None:
    words = ""
    for flags in (FLAGS, PLAIN_FLAGS):
        command = [compiler, *flags, f"-I{GENERATED}", f"-I{HERE}"]
        command += [*map(str, UNITS), "-lm", "-o", str(target)]
        try:
            done = subprocess.run(  # noqa: S603 - the user's own compiler, fixed arguments
                command, capture_output=True, timeout=PATIENCE, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise CompilationError(f"{compiler} took more than {PATIENCE:g} s") from error
        if done.returncode == 0:
            return
        words = done.stderr.decode(errors="replace").strip().splitlines()[-1:] or ["no message"]
        words = words[0]
    raise CompilationError(f"{compiler} failed: {words}")
