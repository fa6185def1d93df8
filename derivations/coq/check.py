"""Whether the proofs in this folder hold: compiled, re-checked, and resting on nothing of ours.

    python3 derivations/coq/check.py [--write | --install]

1. No file says Admitted, Axiom, Parameter and the like.  2. Every file compiles.
3. `coqchk` re-checks all files and every library below them, and lists their axioms.
4. What Coq says that each theorem assumes is what assumptions.txt says (--write renews it).
With --install nothing is checked: Coq is there afterwards.

Standard library only. Exit code 0 if all hold, 1 if not, 2 without Coq and no way to install it.
"""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
BUILD = HERE.parent.parent / "build" / "coq"  # `certreg verify --coq` looks here, too
ALLOWED = (  # of Coq's library of real numbers, none of ours
    "Coq.Logic.Classical_Prop.classic",
    "Coq.Logic.FunctionalExtensionality.functional_extensionality_dep",
    "Coq.Reals.ClassicalDedekindReals.sig_forall_dec",
    "Coq.Reals.ClassicalDedekindReals.sig_not_dec",
)
PACKAGES = ("coq", "libcoq-coquelicot")  # of Debian and Ubuntu
FLAGS = ("-q", "-w", "-ambiguous-paths")
SAFE_HEADINGS = ("type-in-type", "unsafe (co)fixpoints", "positivity is assumed")
FORBIDDEN = re.compile(
    r"\b(Admitted|admit|give_up|Axioms?|Parameters?|Conjectures?|Abort|Declare|Primitive|bypass_check"
    r"|Unset\s+(Guard|Positivity|Universe)\s+Checking)\b"
)
SECTIONED = re.compile(r"^\s*(Variables?|Hypothes[ie]s|Context)\b")


class ProofError(Exception):
    """The proofs do not hold, or Coq is not there; the message says which and where."""


def main(argv: list[str]) -> int:
    """All four steps; figures on stdout."""
    try:
        install()
    except ProofError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    if "--install" in argv:
        return 0
    start = time.monotonic()
    try:
        verify(HERE, write="--write" in argv)
    except ProofError as error:
        sys.stderr.write(f"REFUSED: {error}\n")
        return 1
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 2**20
    lines = sum(len(path.read_text("utf-8").splitlines()) for path in HERE.glob("*.v"))
    count = len(theorems(HERE))
    seconds = time.monotonic() - start
    print(f"{count} theorems, {lines} lines: {seconds:.0f} s, at most {peak:.2f} GB in a process")
    return 0


def verify(sources: Path, folder: Path = BUILD, *, write: bool = False) -> None:
    """Nothing if all proofs hold, compiled in the folder. Raises ProofError."""
    scan(sources)
    compile_in(folder, sources)
    modules = [f"Certreg.{name}" for name in names(folder)]
    command = ["coqchk", "-silent", "-o", "-R", str(folder), "Certreg", *modules]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, encoding="utf-8"
    ) as checker:
        found = assumptions(folder, theorems(folder))
        output = checker.communicate()[0]
    if checker.returncode != 0:
        raise ProofError(f"coqchk failed: {output.strip()[-500:]}")
    require_allowed(output)
    recorded = sources / "assumptions.txt"
    if write:
        recorded.write_text(found, "utf-8")
    compare(recorded.read_text("utf-8"), found)


def compile_in(folder: Path, sources: Path = HERE) -> None:
    """All files compiled in a folder of their own, as far as they changed since the last time."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in [*sources.glob("*.v"), sources / "Makefile"]:
        copy = folder / path.name
        if not copy.is_file() or copy.read_bytes() != path.read_bytes():
            shutil.copyfile(path, copy)
    for copy in folder.glob("*.v"):
        if not (sources / copy.name).is_file():
            copy.unlink()
    run(["make", "-C", str(folder), "-j2", "--no-print-directory", "all"], "does not compile")


def install() -> None:
    """Coq and Coquelicot by apt-get where they are missing and that is allowed."""
    if shutil.which("coqc") and shutil.which("coqchk") and has_coquelicot():
        return
    how = f"the proofs need Coq 8.16 with Coquelicot: apt-get install {' '.join(PACKAGES)}"
    if not shutil.which("apt-get") or os.geteuid() != 0:
        raise ProofError(f"{how} (as root), or opam install coq coq-coquelicot")
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in (["update"], ["install", "-y", "--no-install-recommends", *PACKAGES]):
        done = subprocess.run(["apt-get", "-q", *command], env=quiet, check=False)
        if done.returncode != 0:
            raise ProofError(f"{how}: apt-get {command[0]} failed")


def has_coquelicot() -> bool:
    """Whether coqc finds Coquelicot."""
    where = subprocess.run(
        ["coqc", "-where"], capture_output=True, text=True, check=False, encoding="utf-8"
    )
    return Path(where.stdout.strip(), "user-contrib", "Coquelicot").is_dir()


def names(folder: Path) -> list[str]:
    """The files, by name."""
    return sorted(path.stem for path in folder.glob("*.v"))


def without_comments(text: str) -> str:
    """Coq text with its comments, which nest, blanked out; lines are kept."""
    kept, depth = [], 0
    for part in re.split(r"(\(\*|\*\))", text):
        depth += (part == "(*") - (part == "*)")
        outside = depth == 0 and part != "*)"
        kept.append(part if outside else re.sub(r"[^\n]", "", part))
    return "".join(kept)


def scan(folder: Path) -> None:
    """Nothing if no file claims without proof. Raises ProofError naming the line."""
    for path in sorted(folder.glob("*.v")):
        sections = 0
        for number, line in enumerate(without_comments(path.read_text("utf-8")).splitlines(), 1):
            sections += line.startswith("Section ") - line.startswith("End ")
            loose = sections == 0 and SECTIONED.match(line)
            if FORBIDDEN.search(line) or loose:
                raise ProofError(f"{path.name}, line {number}: {line.strip()}")


def theorems(folder: Path) -> list[tuple[str, str]]:
    """(file, name) of every Theorem."""
    return [
        (name, theorem)
        for name in names(folder)
        for theorem in re.findall(
            r"^Theorem (\w+)",
            without_comments((folder / f"{name}.v").read_text("utf-8")),
            re.MULTILINE,
        )
    ]


def assumptions(folder: Path, listed: list[tuple[str, str]]) -> str:
    """What Coq prints that each theorem assumes: `file.theorem: axioms`, a line each."""
    modules = sorted({name for name, _ in listed})
    text = f"From Certreg Require {' '.join(modules)}.\n" + "".join(
        f'Goal True. idtac "## {name}.{theorem}". exact I. Qed.\n'
        f"Print Assumptions {name}.{theorem}.\n"
        for name, theorem in listed
    )
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "assumptions.v"
        path.write_text(text, "utf-8")
        output = run(["coqc", *FLAGS, "-R", str(folder), "Certreg", str(path)], "cannot be asked")
    lines = []
    for part in output.split("## ")[1:]:
        theorem, _, printed = part.partition("\n")
        axioms = assumed(printed)
        closed = printed.strip() == "Closed under the global context"
        if not axioms and not closed:
            raise ProofError(f"{theorem}: what it assumes cannot be read: {printed[:200]}")
        lines.append(f"{theorem}: {', '.join(sorted(axioms)) or 'nothing'}\n")
    return "".join(sorted(lines))


def assumed(printed: str) -> list[str]:
    """The axioms that are listed, by name; of other assumptions the whole line."""
    head, *lines = printed.splitlines() or [""]
    listed = [line for line in lines if line.strip() and not line.startswith(" ")]
    named = [re.match(r"[\w.]+(?=\s*(?::|$))", line) for line in listed]
    found = [name[0] if name else line for name, line in zip(named, listed, strict=True)]
    return found if head == "Axioms:" else []


def compare(recorded: str, found: str) -> None:
    """Nothing if the assumptions are those recorded and allowed. Raises ProofError."""
    for line in found.splitlines():
        theorem, _, listed = line.partition(": ")
        for axiom in listed.split(", "):
            if axiom != "nothing" and not any(name.endswith(f".{axiom}") for name in ALLOWED):
                raise ProofError(f"{theorem} assumes {axiom}")
    differing = sorted(set(recorded.splitlines()) ^ set(found.splitlines()))
    if differing:
        raise ProofError(f"assumptions.txt is not what Coq prints (--write): {differing[0]}")


def require_allowed(output: str) -> None:
    """Nothing if coqchk's summary lists axioms of the library only. Raises ProofError."""
    sections = {
        part.partition(":")[0].strip(): part.partition(":")[2].split()
        for part in output.partition("CONTEXT SUMMARY")[2].split("* ")[1:]
    }
    if "Axioms" not in sections:
        raise ProofError(f"coqchk's summary cannot be read: {output[:200]}")
    for axiom in sections["Axioms"]:
        if axiom not in {*ALLOWED, "<none>"}:
            raise ProofError(f"coqchk finds the axiom {axiom}")
    for heading in SAFE_HEADINGS:
        listed = [words for name, words in sections.items() if heading in name]
        if listed != [["<none>"]]:
            raise ProofError(f"coqchk on {heading}: {listed}")


def run(command: list[str], what: str) -> str:
    """Output of a command. Raises ProofError with the end of what it says if it fails."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, encoding="utf-8")
    if done.returncode != 0:
        raise ProofError(f"{command[0]}: {what}: {(done.stderr or done.stdout).strip()[-500:]}")
    return done.stdout


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
