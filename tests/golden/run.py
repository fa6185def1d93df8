"""`make golden BASE=<commit> [ONLY=<prefix>] [WORDS=counted]`: what users see, at a commit and now.

The commit is taken from git into build/golden; "now" is the working tree as it stands. Both run in
this environment, on the same files, at the same time. What was recorded is kept as long as it would
be the same: a run that was stopped goes on, and the record of the base serves the next time. ONLY
records the cases whose names begin so.

Exit code 1 where a field of a document changed, or a number moved, by more than
tests/golden/bounds.toml states; and where something differs in the text of a file that
tests/golden/meant.toml does not list, unless words are but counted. The table of both is printed
and written to build/golden/fields.txt.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from comparison import MEANT, compare, differences, read_meant
from corpus import ROOT, write_corpus
from documents import BOUNDS, changed_fields, gone_files
from same.checkouts import check_out, git, working_tree
from same.fields import BEYOND, read_bounds
from table import table
from wording import changed_words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from comparison import Comparison

BUILD = ROOT / "build" / "golden"
RECORDING = ("cases.py", "public_calls.py", "record.py", "volatile.py")
PARTS = 2  # of each record, each by a process: two at a time
HERE = Path(__file__).resolve().parent
SHOWN = 40  # lines of each difference on the terminal; all are in the file of differences


def main() -> int:
    parser = argparse.ArgumentParser(description="What users see, at a commit and now.")
    parser.add_argument("base", help="the commit: make golden BASE=<commit>")
    parser.add_argument("only", nargs="?", default="", help="cases whose names begin so")
    parser.add_argument("--count-words", action="store_true", help="words decide nothing")
    asked = parser.parse_args()
    base, head = recorded(asked.base, asked.only)
    compared = compare(base, head, read_meant())
    words = told(compared, whole=not asked.only, counted=asked.count_words)
    return judged(base, head) or words


def recorded(base_name: str, only: str) -> tuple[Path, Path]:
    """The folders with the records of the commit and of the working tree, made as far as needed."""
    commit = git("rev-parse", "--verify", f"{base_name}^{{commit}}").decode().strip()
    inputs, base, head = (BUILD / name for name in ("inputs", "base", "head"))
    left = marked(commit, inputs)
    shutil.rmtree(inputs, ignore_errors=True)
    write_corpus(inputs)
    mark = marked(commit, inputs)
    if left != mark:  # a command of a run that was stopped may have written to them
        shutil.rmtree(base, ignore_errors=True)
        shutil.rmtree(head, ignore_errors=True)
    if not is_marked(base / "begun", mark):
        shutil.rmtree(base, ignore_errors=True)
        check_out(commit, base / "checkout")
        record(base / "checkout", base / "begun", "--begin")
        mark_as(base / "begun", mark)
    out = "some" if only else "all"
    for folder, state in ((base / out, mark), (head / out, marked(working_tree(), inputs) + mark)):
        if only or not is_marked(folder, state):
            shutil.rmtree(folder, ignore_errors=True)
            mark_as(folder, state)
    record_all({head / out: ROOT, base / out: base / "checkout"}, base / "begun", only)
    if marked(commit, inputs) != mark:
        sys.exit(f"a command has written to {inputs}, which both sides read: mend its case")
    return base / out, head / out


def record_all(sides: Mapping[Path, Path], begun: Path, only: str) -> None:
    """What is not yet recorded of each checkout, in the folder beside it, by a few processes."""
    with ThreadPoolExecutor(PARTS) as pool:
        options = [
            ("--begun", begun, "--part", f"{k}/{PARTS}", "--only", only) for k in range(PARTS)
        ]
        jobs = [
            pool.submit(record, checkout, out, *option)
            for out, checkout in sides.items()
            for option in options
        ]
        for job in jobs:
            job.result()


def is_marked(folder: Path, mark: str) -> bool:
    """Whether the folder was written from what the mark stands for."""
    file = folder.with_suffix(".mark")
    return file.exists() and file.read_text("utf-8") == mark


def mark_as(folder: Path, mark: str) -> None:
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.with_suffix(".mark").write_text(mark, "utf-8")


def marked(state: str, inputs: Path) -> str:
    """What a record of a commit, or of files, depends on: it is kept while this is the same."""
    digest = hashlib.sha256(f"{state} {sys.version} {ROOT}".encode())
    files = (*(HERE / name for name in RECORDING), ROOT / "uv.lock", *inputs.rglob("*"))
    for path in sorted(path for path in files if path.is_file()):
        digest.update(str(path).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def record(checkout: Path, out: Path, *options: str | Path) -> None:
    """The recorder on a checkout, which comes first on its path; its compiled code, too."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(checkout),
        "COLUMNS": "80",
        "LC_ALL": "C.UTF-8",
        "OPENBLAS_NUM_THREADS": "1",
    }
    command = (sys.executable, HERE / "record.py", checkout, out, *options)
    subprocess.run([*command, "--inputs", BUILD / "inputs"], env=environment, check=True)


def told(found: Comparison, *, whole: bool, counted: bool) -> int:
    """The comparison of texts; 1 where something differs that is not meant.

    Where words are but counted, only in one line, and it is no failure.
    """
    report = BUILD / "differences.diff"
    report.write_text("".join(difference.diff for difference in found.unmeant), "utf-8")
    for difference in () if counted else found.unmeant:
        lines = difference.diff.splitlines(keepends=True)
        sys.stdout.write("".join(lines[:SHOWN]))
        if len(lines) > SHOWN:
            sys.stdout.write(f"... {len(lines) - SHOWN} more lines\n")
    for meant in found.unmet if whole and not counted else ():
        entry = f"{meant.path}, {meant.found!r} ({meant.reason})"
        sys.stdout.write(f"listed in {MEANT.name}, but no longer there: {entry}\n")
    count = len(found.unmeant)
    outcome = f"{count} differ, all of it in {report}" if count else "all as they were"
    sys.stdout.write(f"{found.files} recorded files: {outcome}\n")
    return 1 if count and not counted else 0


def judged(base: Path, head: Path) -> int:
    """The table of fields and words; 1 where a field is beyond its bound, or gone unsaid."""
    bounds = read_bounds(BOUNDS)
    found = list(differences(base, head))
    rows, gone = changed_fields(found, bounds), gone_files(found, bounds)
    page = table(rows, gone, changed_words(found))
    (BUILD / "fields.txt").write_text(page, "utf-8")
    sys.stdout.write(page)
    return 1 if None in gone or any(row.verdict == BEYOND for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
