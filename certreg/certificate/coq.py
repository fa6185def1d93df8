"""A certificate as a Coq file, its integers copied, and what Coq's kernel decides of it.

Nothing is computed here but powers of two taken out of the doubles; `Checker.v` recomputes the
rest, and its theorem `checker_sound` says what an accepted file proves. The form of the file, its
digest and the finiteness of its numbers are checked while reading, by the code of `certreg.verify`.
The proofs are found, compiled once, and `coqc` is run on the file. A module of its own: few ask
for Coq, and `checking`, which alone asks here, is short to read without.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
import struct
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.certificate.private_folder import UnusableFolderError, opened_folder, sweep
from certreg.errors import InvalidFileError, MissingToolError
from certreg.io.atomic import write_atomically
from certreg.results import Ruling, Verdict
from certreg.verify import Clouds, IsotropicStatement, RefusalError, bound_doubles, parse, require

if TYPE_CHECKING:
    from fractions import Fraction


SECONDS = 600.0  # for one question: 338 points take four; hostile exponents could take days
COMPILING, RUNNING = ".coq-", "certreg-coq-"  # how folders for the time of a run begin
POINTS_IN_A_LIST = 500  # 10^5 overflow the stack of Coq's parser
HEADER = """\
(* Exported by certreg: integers copied from a certificate; Coq decides what they prove.
   SHA-256 of the doubles of its points: {digest}
   coqc -R DERIVATIONS/coq Certreg FILE *)
From Coq Require Import ZArith List.
From Certreg Require Import Integers Checker.
Import ListNotations.
Open Scope Z_scope.
"""
DECISION = """
Definition refused{tag} := Eval vm_compute in reasons data{tag} statement{tag}.
Print refused{tag}.
"""
THEOREM = """
Theorem certified : proved data statement.
Proof. apply checker_sound. vm_cast_no_check (eq_refl true). Qed.
(* What it assumes is what checker_sound does: Print Assumptions certified. *)
"""
GOAL = "Checker"  # the file of the proofs that certificates need
SOUND = "checker_sound"  # the one theorem that a certificate's is an instance of
ASSUMPTIONS = f"From Certreg Require {GOAL}.\nPrint Assumptions {GOAL}.{SOUND}.\n"
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


@dataclass(frozen=True, slots=True, kw_only=True)
class CoqProblem:
    """A well-formed certificate in Coq's words: definitions of `data` and `statement`."""

    n: int
    digest: str
    definitions: str
    beyond: str = ""  # the claim of the certificate that Coq's checker does not know

    def theorem(self) -> str:
        """A file with the theorem that all claims are true; Coq rejects it where they are not."""
        return HEADER.format(digest=self.digest) + self.definitions.replace("@", "") + THEOREM

    def refusal(self) -> str:
        """A file that prints the reasons to refuse the certificate, none if it is accepted."""
        return HEADER.format(digest=self.digest) + self.decision("")

    def decision(self, tag: str) -> str:
        """The same without its head, under names that end in the tag: for many in one file."""
        return self.definitions.replace("@", tag) + DECISION.format(tag=tag)


def export(certificate: bytes, clouds: Clouds | None = None) -> CoqProblem:
    """The certificate for Coq, of kind isotropic with a translation; InvalidFileError for another.

    Coq takes sums about the means: of a rotation alone, about the origin, it would prove nothing.
    Raises RefusalError where it is malformed or of other points.
    """
    stated = parse(certificate)
    if not isinstance(stated, IsotropicStatement):
        what = f"a certificate of kind {stated.kind}, and Coq decides on kind isotropic alone"
        raise InvalidFileError(
            f"{what}: leave out --coq", column="kind", value=stated.kind, limit="isotropic"
        )
    if stated.model:
        message = "a certificate of a rotation alone, and Coq decides where there is a translation"
        raise InvalidFileError(f"{message}: leave out --coq", column="rotation_only", value=True)
    content, n = bytes(bound_doubles(stated, clouds)), stated.n
    numbers = struct.unpack(f"<{7 * n}d", content)
    require(all(map(isfinite, numbers)), "the data hold a number that is not finite")
    minus_zero = struct.pack("<d", -0.0)
    whole = minus_zero not in content or all(struct.pack("<d", x) != minus_zero for x in numbers)
    require(whole, "the data hold -0.0, which is not canonical")
    definitions = _data(numbers, n, POINTS_IN_A_LIST) + _statement(stated)
    beyond = "" if stated.both is None else "radius"
    return CoqProblem(n=n, digest=stated.digest, definitions=definitions, beyond=beyond)


def _data(numbers: Sequence[float], n: int, length: int) -> str:
    x, ex = _integers(numbers[: 3 * n])
    y, ey = _integers(numbers[3 * n : 6 * n])
    w, ew = _integers(numbers[6 * n :])
    rows = [
        " ".join(map(_integer, (w[i], *x[3 * i : 3 * i + 3], *y[3 * i : 3 * i + 3])))
        for i in range(n)
    ]
    parts = [rows[start : start + length] for start in range(0, n, length)]
    lists = [
        f"Definition points{k}@ := [\n  " + ";\n  ".join(f"ZPair {row}" for row in part) + "].\n"
        for k, part in enumerate(parts)
    ]
    joined = " ++ ".join(f"points{k}@" for k in range(len(parts)))
    powers = " ".join(map(_integer, (ew, ex, ey)))
    return "\n" + "".join(lists) + f"Definition data@ := Data ({joined}) {powers}.\n"


def _integers(numbers: Sequence[float]) -> tuple[list[int], int]:
    """Integers k and the one exponent e such that the numbers are k 2^e exactly."""
    ratios = [number.as_integer_ratio() for number in numbers]
    shift = max(below.bit_length() - 1 for _, below in ratios)
    lifted = [above << (shift + 1 - below.bit_length()) for above, below in ratios]
    common = 0
    for k in lifted:
        common |= k
    spare = (common & -common).bit_length() - 1 if common else 0
    return [k >> spare for k in lifted], spare - shift


def _statement(stated: IsotropicStatement) -> str:
    pose, turned = (_record("ZQuat", each) for each in (stated.pose, stated.quaternion))
    spinning = "None"
    if stated.angular_velocity is not None:
        *velocity, exponent = stated.angular_velocity
        spinning = f"(Some ({_record('ZVec', velocity)}, {_integer(exponent)}))"
    entries = {
        "pose": pose,
        "delta": _dyadic(stated.delta),
        "mu": _dyadic(stated.mu),
        "gap": _dyadic(stated.gap),
        "sin2": _optional_dyadic(stated.sin2_half_angle),
        "unique": _truth(stated.unique),
        "multiplicities": _list(stated.pattern),
        "unstable": "None" if stated.unstable is None else f"Some {_list(stated.unstable)}",
        "nu": _optional_dyadic(stated.nu),
        "sdp_gap": _optional_dyadic(stated.sdp_gap),
        "basin": _truth(stated.basin),
        "turned": "None" if stated.quaternion is None else f"Some {turned}",
        "spinning": spinning,
    }
    words = ";\n  ".join(f"{name} := {value}" for name, value in entries.items())
    return f"Definition statement@ := {{|\n  {words} |}}.\n"


def _integer(number: int) -> str:
    return f"{number:#x}" if number >= 0 else f"({number:#x})"  # decimal takes Coq longer


def _record(name: str, numbers: Iterable[int] | None) -> str:
    return "None" if numbers is None else f"({name} {' '.join(map(_integer, numbers))})"


def _list(numbers: Iterable[int]) -> str:
    return f"[{'; '.join(map(_integer, numbers))}]"


def _truth(value: object) -> str:
    return "true" if value else "false"


def _dyadic(value: Fraction) -> str:
    """A rational whose denominator is a power of two, with an odd mantissa."""
    if value.denominator.bit_count() != 1:
        raise RefusalError("a number is not dyadic")
    low = (value.numerator & -value.numerator).bit_length() - 1 if value else 0
    exponent = low - (value.denominator.bit_length() - 1)
    return f"(Dyadic {_integer(value.numerator >> low)} {_integer(exponent)})"


def _optional_dyadic(value: Fraction | None) -> str:
    return "None" if value is None else f"(Some {_dyadic(value)})"


def decide(
    certificate: bytes,
    clouds: Clouds | None = None,
    *,
    tell: Callable[[str], None] = print,
) -> tuple[Verdict, str]:
    """What Coq's kernel says of a certificate, and the file that it was given, '' if none was.

    PROVED: `coqc` accepted the theorem `certified`. Raises MissingToolError where there is no
    working Coq with Coquelicot. tell: hears of work that takes long.
    """
    try:
        problem = export(certificate, clouds)
    except (RefusalError, MemoryError) as error:
        words = str(error) or "not enough memory"
        return Verdict(ruling=Ruling.REFUTED, words=words), ""
    coqc = find_coqc()
    proofs, source = compiled_proofs(coqc, tell=tell), problem.theorem()
    try:
        done = run_coqc(coqc, proofs, source, seconds=SECONDS)
        if done.returncode == 0:
            return _proved(axioms(coqc, proofs), problem), source
        done = run_coqc(coqc, proofs, problem.refusal(), seconds=SECONDS)
        return _refuted(done), source
    except subprocess.TimeoutExpired:
        words = f"Coq did not decide within {SECONDS:g} s"
        return Verdict(ruling=Ruling.INCONCLUSIVE, words=words), source


def _proved(assumed: tuple[str, ...], problem: CoqProblem) -> Verdict:
    but, left = (
        (f" but `{problem.beyond}`", f"`{problem.beyond}`, ") if problem.beyond else ("", "")
    )
    theorems = (
        f"Data: n = {problem.n} pairs. SHA-256 of their doubles is {problem.digest}.",
        "Coq's kernel accepted `Theorem certified : proved data statement`: every claim of the",
        f"certificate{but} holds of these points as real numbers (derivations/coq/Checker.v).",
        f"It assumes only axioms of Coq's library of the reals: {', '.join(assumed) or 'none'}.",
        f"Not proved: {left}that the file was copied rightly, and LaSalle's theorem.",
    )
    return Verdict(
        ruling=Ruling.PROVED, words="Coq accepted the theorem", tell=partial(tuple, theorems)
    )


def _refuted(done: subprocess.CompletedProcess[str]) -> Verdict:
    """Coq did not accept the theorem. Raises MissingToolError if it names no reason."""
    reasons = re.findall(r"\b[a-z]+_[a-z_]+", done.stdout.partition("=")[2].partition(" : ")[0])
    if done.returncode != 0 or not reasons:
        raise MissingToolError(
            f"coqc failed: {_first_error(done.stderr)}: {HOW_TO_GET}", tool="coqc"
        )
    return Verdict(ruling=Ruling.REFUTED, words="; ".join(reasons).replace("_", " "))


def find_coqc() -> str:
    """Path of coqc. Raises MissingToolError."""
    path = shutil.which("coqc")
    if path is None:
        raise MissingToolError(f"coqc was not found: {HOW_TO_GET}", tool="coqc")
    return path


def run_coqc(
    coqc: str, proofs: Path, source: str, *, seconds: float
) -> subprocess.CompletedProcess[str]:
    """Run coqc on a text, in a folder of its own that is gone afterwards."""
    sweep(Path(tempfile.gettempdir()), RUNNING)
    with tempfile.TemporaryDirectory(prefix=RUNNING) as folder:
        path = Path(folder) / "certificate.v"
        path.write_text(source, encoding="utf-8")
        command = [coqc, *QUIET, "-R", str(proofs), "Certreg", str(path)]
        return subprocess.run(  # noqa: S603 - found on PATH, our own arguments
            command, capture_output=True, encoding="utf-8", check=False, timeout=seconds, cwd=folder
        )


def proofs_folder() -> Path:
    """The .v files: the wheel's copy, or derivations/coq of the checkout."""
    package = Path(str(files("certreg")))
    for folder in (package.parent / "derivations" / "coq", package / "_derivations" / "coq"):
        if (folder / f"{GOAL}.v").is_file():
            return folder
    raise MissingToolError(
        "the proofs (derivations/coq) are not beside certreg: reinstall it", tool="derivations/coq"
    )


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
    """Named by what was compiled and by which Coq, so that it is never stale; the user's alone."""
    content = hashlib.sha256(_run([coqc, "--version"]).encode())
    for name in modules:
        content.update((folder / f"{name}.v").read_bytes())
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    try:
        with opened_folder(Path(base) / "certreg") as opened:
            return opened / f"coq-{content.hexdigest()[:16]}"
    except UnusableFolderError as error:
        raise InvalidFileError(
            f"{error}: compiled proofs cannot be kept there: set XDG_CACHE_HOME", path=Path(base)
        ) from error


def _compile(coqc: str, folder: Path, modules: list[str], cache: Path) -> None:
    """All or nothing: compiled under another name, then renamed."""
    try:
        sweep(cache.parent, COMPILING)
        with tempfile.TemporaryDirectory(dir=cache.parent, prefix=COMPILING) as scratch:
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
        raise InvalidFileError(
            f"{cache}: the proofs cannot be compiled there ({reason}): set XDG_CACHE_HOME",
            path=cache,
        ) from error


def _run(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=False)  # noqa: S603
    if done.returncode != 0:
        raise MissingToolError(
            f"coqc failed: {_first_error(done.stderr)}: {HOW_TO_GET}", tool="coqc"
        )
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
    done = run_coqc(coqc, proofs, ASSUMPTIONS, seconds=SECONDS)
    listed = axioms_in(done.stdout)
    if done.returncode != 0 or listed is None:
        raise MissingToolError(
            f"coqc failed: {_first_error(done.stderr)}: {HOW_TO_GET}", tool="coqc"
        )
    names = _known(listed)
    with contextlib.suppress(InvalidFileError):  # cannot be written: asked again next time
        write_atomically(kept, " ".join([digest, *names]).encode())
    return names


def axioms_in(stdout: str) -> tuple[str, ...] | None:
    """What `Print Assumptions` lists; None if that cannot be read.

    Axioms by name; of other assumptions, as that a recursion ends, the whole line.
    """
    head, *lines = stdout.splitlines() or [""]
    if head == "Closed under the global context":
        return ()
    listed = [line for line in lines if not line.startswith(" ")]
    named = [re.match(r"[\w.]+(?=\s*(?::|$))", line) for line in listed]
    names = tuple(name[0] if name else line for name, line in zip(named, listed, strict=True))
    return names if head == "Axioms:" and names else None


def _known(names: tuple[str, ...]) -> tuple[str, ...]:
    unknown = sorted(set(names) - AXIOMS)
    if unknown:
        listed = ", ".join(unknown)
        raise MissingToolError(
            f"the compiled proofs assume more than they may ({listed})", tool="derivations/coq"
        )
    return names
