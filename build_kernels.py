"""Compiles certreg's C code, at set-up: for a wheel, or in the checkout where it stands.

    python build_kernels.py [FOLDER]

Without a folder it renews certreg/native/built where the sources are no longer those that were
compiled. The compiler is $CC, else cc, gcc or clang; where there is none, or it fails, Zig's, from
the package index into a folder that is gone afterwards. Where that fails, too, the reason is kept,
and certreg runs the C in Python, much slower. With CERTREG_REQUIRE_KERNELS set it fails instead.
CERTREG_OBJECTS names a folder where builds share object files, each named by the digest of all
that it is made of, on a machine whose compiler and its headers stay the same. It needs Python
alone.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.native import kernels
from certreg.native.kernels import BASELINE, Built, MissingLibraryError
from certreg.native.signatures import WRITTEN

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from concurrent.futures import Future

ROOT = Path(__file__).resolve().parent
ZIG = ROOT / "requirements-compiler.lock"
OBJECTS = ROOT / "build" / "kernels"  # of a checkout: what did not change is not compiled again
SHARED = "CERTREG_OBJECTS"  # a folder of several builds instead, as .ci/run makes on one machine
# MinGW's GCC does not align the stack for vectors, and Microsoft's compiler has none: Zig's there.
COMPILERS = () if sys.platform == "win32" else ("cc", "gcc", "clang")
REQUIRED = "CERTREG_REQUIRE_KERNELS"
PATIENCE = 600.0  # seconds for one command; the longest takes three
X86 = platform.machine().lower() in ("x86_64", "amd64")
SUFFIX = {"darwin": ".dylib", "win32": ".dll"}.get(sys.platform, ".so")
LINKING = ("-shared", "-lm") if sys.platform == "darwin" else ("-shared", "-s", "-lm")
# Calls each generated function on zeros, and asks for the others.
TRIAL = """
import ctypes, json, sys
library = ctypes.CDLL(sys.argv[1])
for name in sys.argv[3:]:
    getattr(library, name)
for name, sizes in json.load(open(sys.argv[2])).items():
    numbers = [(ctypes.c_double * n)() for n in sizes["arguments"] + sizes["results"]]
    getattr(library, name)(*numbers)
"""


class BuildError(Exception):
    """A compiler, or what it made, does not work; the message is one line."""


class NoCompilerError(BuildError):
    """This machine has none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compiler:
    """A command, and what it calls itself."""

    command: tuple[str, ...]
    words: str
    zig: bool = False

    def level(self, name: str) -> tuple[str, ...]:
        """How it is told the level of the processor.

        Always: Zig's default is the processor of the machine that builds, some gcc's is wider than
        the baseline. Elsewhere than on x86-64 the baseline is the default of gcc and clang.
        """
        if self.zig:
            return (f"-mcpu={name.replace('-', '_')}",)
        return (f"-march={'x86-64' if name == BASELINE else name}",) if X86 else ()


def main() -> int:
    """Build for a folder that is named, or renew what the checkout has."""
    folders = [Path(name) for name in sys.argv[1:]]
    built = build(folders[0], checkout=False) if folders else renewed()
    return 1 if built.why and os.environ.get(REQUIRED) else 0


def renewed(*, set_up: bool = True) -> Built:
    """What stands in the checkout, built anew where it is not of its sources or of $CC's compiler.

    set_up: also where none could be built, and by another compiler where this machine's fails.
    """
    try:
        built = kernels.record_of(kernels.BUILT)
    except MissingLibraryError:
        return build(kernels.BUILT, checkout=True, set_up=set_up)
    there = all((kernels.BUILT / name).is_file() for name in _names(built))
    current = there and built.digest == kernels.source_digest()
    asked = built.asked == os.environ.get("CC", built.asked)
    if current and (not set_up if built.why else asked):
        return built
    return build(kernels.BUILT, checkout=True, set_up=set_up)


def build(folder: Path, *, checkout: bool, set_up: bool = True) -> Built:
    """Fill the folder; what stood there is gone once the new is whole."""
    folder.mkdir(parents=True, exist_ok=True)
    # Windows does not remove what this process has loaded: the one that tells the level.
    with tempfile.TemporaryDirectory(
        prefix="certreg-build-", ignore_cleanup_errors=True
    ) as scratch:
        built = _by_any_compiler(Path(scratch), checkout=checkout, set_up=set_up)
        for name in _names(built):
            _put((Path(scratch) / name).read_bytes(), folder / name)
    _put(json.dumps(asdict(built), indent=1, sort_keys=True).encode(), folder / kernels.RECORD)
    for path in folder.glob(f"*{SUFFIX}"):  # nothing that another process is writing
        if path.name not in _names(built):
            with suppress(PermissionError):  # on Windows, of one that another process has loaded
                path.unlink(missing_ok=True)
    if set_up:
        words = f"certreg's C code is compiled: {', '.join(built.variants)}, by {built.compiler}"
        print(built.why or words)
    return built


def _names(built: Built) -> list[str]:
    """The files of a build, but for its record."""
    return [name for name in (*built.variants.values(), built.processor) if name]


def _put(content: bytes, path: Path) -> None:
    """Whole or not at all: another process may load it, or write the same."""
    fresh = path.with_name(f"{path.name}.{os.getpid()}")
    fresh.write_bytes(content)
    fresh.replace(path)


def _by_any_compiler(scratch: Path, *, checkout: bool, set_up: bool) -> Built:
    none = Built(
        digest=kernels.source_digest(),
        checkout=checkout,
        compiler="",
        asked=os.environ.get("CC", ""),
        processor="",
        variants={},
        why="",
    )
    reasons: list[str] = []
    for find in (find_compiler, partial(_fetched_zig, scratch)):
        try:
            return _built(find(), scratch, none)
        except (BuildError, OSError) as error:
            reasons.append(str(error))
            if not set_up and find is find_compiler and not isinstance(error, NoCompilerError):
                break  # the code is wrong, not the machine
    return replace(none, why=f"certreg's C code was not compiled at set-up ({'; '.join(reasons)})")


def find_compiler() -> Compiler:
    """`$CC` with its arguments, or the first of cc, gcc, clang on PATH."""
    named = shlex.split(os.environ.get("CC", ""))
    for name in named[:1] or COMPILERS:
        path = shutil.which(name)
        if path:
            command = (path, *named[1:])
            words = _run([*command, "--version"]).partition("\n")[0].strip()
            zig = any(Path(part).stem in ("zig", "ziglang") for part in command)
            return Compiler(command=command, words=words, zig=zig)
    raise NoCompilerError(f"no C compiler found: {' '.join(named) or ', '.join(COMPILERS)}")


def _fetched_zig(scratch: Path) -> Compiler:
    """Zig's, which is clang, from the package index; nothing of it is kept."""
    place = scratch / "zig"
    options = ("--require-hashes", "--no-deps", "--only-binary=:all:", "--no-compile", "--quiet")
    where = ("--target", str(place), "--retries=1", "--disable-pip-version-check")
    pip = [sys.executable, "-m", "pip", "install"]
    print(
        "certreg: no C compiler here: fetching one from the package index (80 MB) ...", flush=True
    )
    _run([*pip, *options, *where, "-r", str(ZIG)])
    os.environ["ZIG_GLOBAL_CACHE_DIR"] = os.environ["ZIG_LOCAL_CACHE_DIR"] = str(scratch / "zigs")
    path = str(place / "ziglang" / f"zig{'.exe' if sys.platform == 'win32' else ''}")
    words = f"zig {_run([path, 'version']).strip()}"
    return Compiler(command=(path, "cc"), words=words, zig=True)


def _built(compiler: Compiler, scratch: Path, none: Built) -> Built:
    """All variants that the compiler makes and, where this processor should, that run here."""
    mark = none.digest[:12]
    processor = f"processor-{mark}{SUFFIX}"
    flags = (*kernels.FLAGS, *compiler.level(BASELINE), str(kernels.PROCESSOR), *LINKING)
    _run([*compiler.command, *flags, "-o", str(scratch / processor)])
    made = replace(none, compiler=compiler.words, processor=processor)
    levels = kernels.LEVELS if X86 else (BASELINE,)
    objects = _objects(compiler, levels, OBJECTS if none.checkout else scratch / "objects")
    for name in levels:
        library = f"kernels-{mark}-{name}{SUFFIX}"
        try:
            parts = [str(part.result()) for part in objects[name]]
            flags = (*compiler.level(name), *LINKING)  # Zig compiles its runtime for the level
            _run([*compiler.command, *parts, *flags, "-o", str(scratch / library)])
            tried = replace(made, variants={**made.variants, name: library})
            if name in kernels.runnable(tried, scratch):
                _try(scratch / library)
        except BuildError:
            if name == BASELINE:
                raise
            continue  # a compiler that does not know this level, or makes what does not run
        made = tried
    return made


def _objects(
    compiler: Compiler, levels: Iterable[str], folder: Path
) -> dict[str, list[Future[Path]]]:
    """The object files of each level, made on all processors; others go, unless it is shared."""
    shared = os.environ.get(SHARED)
    folder = Path(shared) if shared else folder
    folder.mkdir(parents=True, exist_ok=True)
    before = set() if shared else set(folder.glob("*.o"))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        # What takes longest begins first.
        made = {
            name: [
                pool.submit(_object, compiler, name, unit, folder) for unit in kernels.UNITS[::-1]
            ]
            for name in levels
        }
    used = {part.result() for parts in made.values() for part in parts if not part.exception()}
    for path in before - used:
        path.unlink(missing_ok=True)
    return made


def _object(compiler: Compiler, level: str, unit: Path, folder: Path) -> Path:
    """The object file of one unit, named by the digest of all that it is made of."""
    flags = (*kernels.flags_of(unit), *compiler.level(level))
    content = hashlib.sha256(repr((compiler.command, compiler.words, flags)).encode())
    for path in (unit, *kernels.INCLUDED, *kernels.HEADERS):
        content.update(hashlib.sha256(path.read_bytes()).digest())
    target = folder / f"{unit.stem}-{level}-{content.hexdigest()[:24]}.o"
    if not target.is_file():
        fresh = target.with_suffix(f".{os.getpid()}")
        places = (f"-I{kernels.GENERATED}", f"-I{kernels.HERE}")
        _run([*compiler.command, *flags, *places, "-c", str(unit), "-o", str(fresh)])
        fresh.replace(target)
    return target


def _try(library: Path) -> None:
    """Whether it loads and runs, in a process of its own."""
    for signatures in kernels.SIGNATURES:
        names = (str(signatures), *WRITTEN)
        _run([sys.executable, "-I", "-S", "-c", TRIAL, str(library), *names])


def _run(command: Sequence[str]) -> str:
    """What a command prints. Raises BuildError with the most telling line where it fails."""
    name = Path(command[0]).name
    try:
        done = subprocess.run(  # noqa: S603 - compilers, pip and Python
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            check=False,
            timeout=PATIENCE,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BuildError(f"{name}: {error}") from error
    if done.returncode == 0:
        return done.stdout
    lines = [line.strip() for line in (done.stderr + done.stdout).splitlines()]
    told = [line for line in lines if "error" in line.lower()] or [line for line in lines if line]
    raise BuildError(f"{name} failed: {told[0] if told else f'code {done.returncode}'}")


if __name__ == "__main__":
    sys.exit(main())
