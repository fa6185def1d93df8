"""Coq's answer on a certificate: the proofs found, compiled once, and `coqc` run on the export."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
import subprocess
import tempfile
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.certificate.coq import export
from certreg.errors import InvalidFileError, MissingToolError
from certreg.io import write_atomically
from certreg.results import Ruling, Verdict
from certreg.settings import CoqSettings
from certreg.verify import RefusalError

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.certificate.coq import CoqProblem
    from certreg.verify import Clouds

GOAL = "Checker"  # the file of the proofs that certificates need
THEOREM = "checker_sound"  # the one theorem that a certificate's is an instance of
ASSUMPTIONS = f"From Certreg Require {GOAL}.\nPrint Assumptions {GOAL}.{THEOREM}.\n"
QUIET = ("-q", "-w", "-ambiguous-paths")  # as derivations/coq/Makefile
AXIOMS = frozenset(  # of Coq's own libraries; derivations/coq/assumptions.txt lists who needs which
    {
        "ClassicalDedekindReals.sig_not_dec",
        "ClassicalDedekindReals.sig_forall_dec",
        "FunctionalExtensionality.functional_extensionality_dep",
        "Classical_Prop.classic",
    }
)
HOW_TO_GET = "install Coq 8.16 or newer with Coquelicot (apt-get install coq libcoq-coquelicot)"


def decide(
    certificate: bytes,
    clouds: Clouds | None = None,
    *,
    tell: Callable[[str], None] = print,
    settings: CoqSettings | None = None,
) -> tuple[Verdict, str]:
    """What Coq's kernel says of a certificate, and the file that it was given, '' if none was.

    PROVED: `coqc` accepted the theorem `certified`. Raises MissingToolError where there is no
    working Coq with Coquelicot. tell: hears of work that takes long.
    """
    settings = settings or CoqSettings()
    try:
        problem = export(certificate, clouds, settings=settings)
    except (RefusalError, MemoryError) as error:
        words = str(error) or "not enough memory"
        return Verdict(ruling=Ruling.REFUTED, words=words), ""
    coqc = find_coqc()
    proofs, source = compiled_proofs(coqc, tell=tell), problem.theorem()
    try:
        done = run_coqc(coqc, proofs, source, seconds=settings.seconds)
        if done.returncode == 0:
            return _proved(axioms(coqc, proofs), problem), source
        done = run_coqc(coqc, proofs, problem.refusal(), seconds=settings.seconds)
        return _refuted(done), source
    except subprocess.TimeoutExpired:
        words = f"Coq did not decide within {settings.seconds:g} s"
        return Verdict(ruling=Ruling.INCONCLUSIVE, words=words), source


def _proved(assumed: tuple[str, ...], problem: CoqProblem) -> Verdict:
    theorems = (
        f"Data: n = {problem.n} pairs. SHA-256 of their doubles is {problem.digest}.",
        "Coq's kernel accepted `Theorem certified : proved data statement`: every claim of the",
        "certificate holds of these points as real numbers (derivations/coq/Checker.v).",
        f"It assumes only axioms of Coq's library of the reals: {', '.join(assumed) or 'none'}.",
        "Not proved: that the file was copied rightly, and LaSalle's theorem.",
    )
    return Verdict(ruling=Ruling.PROVED, words="Coq accepted the theorem", theorems=theorems)


def _refuted(done: subprocess.CompletedProcess[str]) -> Verdict:
    """Coq did not accept the theorem. Raises MissingToolError if it names no reason."""
    reasons = re.findall(r"\b[a-z]+_[a-z_]+", done.stdout.partition("=")[2].partition(" : ")[0])
    if done.returncode != 0 or not reasons:
        message = f"coqc failed: {_first_error(done.stderr)}: {HOW_TO_GET}"
        raise MissingToolError(message, tool="coqc")
    return Verdict(ruling=Ruling.REFUTED, words="; ".join(reasons).replace("_", " "))


def find_coqc() -> str:
    """Path of coqc. Raises MissingToolError."""
    found = shutil.which("coqc")
    if found is None:
        raise MissingToolError(f"coqc was not found: {HOW_TO_GET}", tool="coqc")
    return found


def run_coqc(
    coqc: str, proofs: Path, source: str, *, seconds: float
) -> subprocess.CompletedProcess[str]:
    """Run coqc on a text, in a folder of its own that is gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="certreg-coq-") as folder:
        path = Path(folder) / "certificate.v"
        path.write_text(source, encoding="utf-8")
        command = [coqc, *QUIET, "-R", str(proofs), "Certreg", str(path)]
        return subprocess.run(  # noqa: S603 - found on PATH, our own arguments
            command, capture_output=True, text=True, check=False, timeout=seconds, cwd=folder
        )


def proofs_folder() -> Path:
    """The .v files: the wheel's copy, or derivations/coq of the checkout."""
    package = Path(str(files("certreg")))
    for folder in (package.parent / "derivations" / "coq", package / "_derivations" / "coq"):
        if (folder / f"{GOAL}.v").is_file():
            return folder
    message = "the proofs (derivations/coq) are not beside certreg: reinstall it"
    raise MissingToolError(message, tool="derivations/coq")


def needed(folder: Path, goal: str = GOAL) -> list[str]:
    """Modules in the order in which they compile, the goal last."""
    text = (folder / f"{goal}.v").read_text(encoding="utf-8")
    order: list[str] = []
    for names in re.findall(r"From Certreg Require Import ([^.]*)\.", text):
        for name in names.split():
            order += [other for other in needed(folder, name) if other not in order]
    return [*order, goal]


def compiled_proofs(coqc: str, *, tell: Callable[[str], None] = print) -> Path:
    """A folder of compiled proofs: the checkout's after `make proofs`, else the user's cache."""
    folder = proofs_folder()
    modules = needed(folder)
    built = folder.parent.parent / "build" / "coq"
    if is_compiled(built, modules, folder):
        return built
    cache = _cache(coqc, folder, modules)
    if not is_compiled(cache, modules, folder):
        tell(f"compiling the proofs into {cache}, once (about two minutes) ...")
        _compile(coqc, folder, modules, cache)
    return cache


def is_compiled(folder: Path, modules: list[str], sources: Path) -> bool:
    """Whether the folder holds what these sources compile to, the last of them compiled last."""
    stamps = [(folder / f"{name}.v", folder / f"{name}.vo") for name in modules]
    if not all(v.is_file() and vo.is_file() for v, vo in stamps):
        return False
    last = stamps[-1][1].stat().st_mtime
    return all(
        v.stat().st_mtime <= vo.stat().st_mtime <= last
        and v.read_bytes() == (sources / v.name).read_bytes()
        for v, vo in stamps
    )


def _cache(coqc: str, folder: Path, modules: list[str]) -> Path:
    """Named by what was compiled and by which Coq, so that it is never stale."""
    content = hashlib.sha256(_run([coqc, "--version"]).encode())
    for name in modules:
        content.update((folder / f"{name}.v").read_bytes())
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "certreg" / f"coq-{content.hexdigest()[:16]}"


def _compile(coqc: str, folder: Path, modules: list[str], cache: Path) -> None:
    """All or nothing: compiled under another name, then renamed."""
    try:
        cache.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=cache.parent, prefix=".coq-") as scratch:
            work = Path(scratch) / "coq"
            work.mkdir()
            for name in modules:
                shutil.copyfile(folder / f"{name}.v", work / f"{name}.v")
            for name in modules:
                _run([coqc, *QUIET, "-R", str(work), "Certreg", str(work / f"{name}.v")])
            shutil.rmtree(cache, ignore_errors=True)
            work.rename(cache)
    except OSError as error:
        reason = error.strerror or error
        message = f"{cache}: the proofs cannot be compiled there ({reason}): set XDG_CACHE_HOME"
        raise InvalidFileError(message, path=cache) from error


def _run(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
    if done.returncode != 0:
        message = f"coqc failed: {_first_error(done.stderr)}: {HOW_TO_GET}"
        raise MissingToolError(message, tool="coqc")
    return done.stdout


def _first_error(stderr: str) -> str:
    lines = [line for line in stderr.splitlines() if line.startswith("Error")]
    return (lines or stderr.splitlines() or ["no message"])[0][:200]


def axioms(coqc: str, proofs: Path) -> tuple[str, ...]:
    """What the checker's theorem assumes, as Coq says. Raises MissingToolError if it may not.

    Coq takes two seconds to find out, so its answer is kept beside what it speaks of:
    the digest of the compiled checker, which holds the digests of all that it rests on.
    """
    kept = proofs / f"{GOAL}.axioms"
    digest = hashlib.sha256((proofs / f"{GOAL}.vo").read_bytes()).hexdigest()
    if kept.is_file():
        known, *names = kept.read_text(encoding="utf-8", errors="replace").split() or [""]
        if known == digest:
            return _known(tuple(names))
    done = run_coqc(coqc, proofs, ASSUMPTIONS, seconds=CoqSettings().seconds)
    listed = axioms_in(done.stdout)
    if done.returncode != 0 or listed is None:
        message = f"coqc failed: {_first_error(done.stderr)}: {HOW_TO_GET}"
        raise MissingToolError(message, tool="coqc")
    found = _known(listed)
    with contextlib.suppress(InvalidFileError):  # cannot be written: asked again next time
        write_atomically(kept, " ".join([digest, *found]).encode())
    return found


def axioms_in(stdout: str) -> tuple[str, ...] | None:
    """What `Print Assumptions` lists; None if that cannot be read.

    Axioms by name; of other assumptions, as that a recursion ends, the whole line.
    """
    head, *lines = stdout.splitlines() or [""]
    if head == "Closed under the global context":
        return ()
    listed = [line for line in lines if not line.startswith(" ")]
    named = [re.match(r"[\w.]+(?=\s*(?::|$))", line) for line in listed]
    found = tuple(name[0] if name else line for name, line in zip(named, listed, strict=True))
    return found if head == "Axioms:" and found else None


def _known(found: tuple[str, ...]) -> tuple[str, ...]:
    unknown = sorted(set(found) - AXIOMS)
    if unknown:
        listed = ", ".join(unknown)
        message = f"the compiled proofs assume more than they may ({listed})"
        raise MissingToolError(message, tool="derivations/coq")
    return found
