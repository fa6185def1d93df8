"""`make golden BASE=<commit>`: what users see at a commit and now, recorded and compared.

The commit is taken from git into build/golden; "now" is the working tree as it stands. Both run in
this environment, on the same files, at the same time. Exit code 1 where something differs that
tests/golden/meant.toml does not list.
"""

from __future__ import annotations

import hashlib
import io
import os
import shutil
import subprocess
import sys
import tarfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from comparison import MEANT, compare, read_meant
from corpus import ROOT, write_corpus

BUILD = ROOT / "build" / "golden"
RECORDING = ("cases.py", "public_calls.py", "record.py", "volatile.py")
PARTS = 2  # of each record, each by a process: two at a time
HERE = Path(__file__).resolve().parent
SHOWN = 40  # lines of each difference on the terminal; all are in the file of differences


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit("which commit is the base? make golden BASE=<commit>")
    commit = git("rev-parse", "--verify", f"{sys.argv[1]}^{{commit}}").decode().strip()
    inputs, base, head = (BUILD / name for name in ("inputs", "base", "head"))
    shutil.rmtree(inputs, ignore_errors=True)
    write_corpus(inputs)
    mark, done = marked(commit, inputs), base / "recorded"
    sides = [(ROOT, head)]
    if not done.exists() or done.read_text() != mark:
        checkout = base / "checkout"
        shutil.rmtree(base, ignore_errors=True)
        check_out(commit, checkout)
        record(checkout, base, "begun", "--begin")
        sides.append((checkout, base))
    shutil.rmtree(head / "record", ignore_errors=True)
    begun = str(base / "begun")
    with ThreadPoolExecutor(PARTS) as pool:
        jobs = [
            pool.submit(
                record, checkout, side, "record", "--begun", begun, "--part", f"{k}/{PARTS}"
            )
            for checkout, side in sides
            for k in range(PARTS)
        ]
        for job in jobs:
            job.result()
    done.write_text(mark)
    return told(base / "record", head / "record")


def git(*arguments: str) -> bytes:
    run = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, check=False)
    if run.returncode:
        sys.exit(run.stderr.decode(errors="replace").strip())
    return run.stdout


def check_out(commit: str, folder: Path) -> None:
    """The files of a commit, without git."""
    shutil.rmtree(folder, ignore_errors=True)
    with tarfile.open(fileobj=io.BytesIO(git("archive", commit))) as archive:
        archive.extractall(folder, filter="data")


def marked(commit: str, inputs: Path) -> str:
    """What a record of the base depends on: it is kept as long as this is the same."""
    digest = hashlib.sha256(f"{commit} {sys.version} {ROOT}".encode())
    files = (*(HERE / name for name in RECORDING), ROOT / "uv.lock", *inputs.rglob("*"))
    for path in sorted(path for path in files if path.is_file()):
        digest.update(str(path).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def record(checkout: Path, side: Path, out: str, *options: str) -> None:
    """The recorder on a checkout, which comes first on its path; compiled code is its own, too."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(checkout),
        "CERTREG_CACHE_DIR": str(side / "cache"),
        "COLUMNS": "80",
        "LC_ALL": "C.UTF-8",
        "OPENBLAS_NUM_THREADS": "1",
    }
    command = (sys.executable, HERE / "record.py", checkout, side / out, *options)
    subprocess.run([*command, "--inputs", BUILD / "inputs"], env=environment, check=True)


def told(base: Path, head: Path) -> int:
    """The comparison in words; 1 where something differs that is not meant."""
    found = compare(base, head, read_meant())
    report = BUILD / "differences.diff"
    report.write_text("".join(difference.diff for difference in found.unmeant))
    for difference in found.unmeant:
        lines = difference.diff.splitlines(keepends=True)
        sys.stdout.write("".join(lines[:SHOWN]))
        if len(lines) > SHOWN:
            sys.stdout.write(f"... {len(lines) - SHOWN} more lines\n")
    for meant in found.unmet:
        entry = f"{meant.path}, {meant.found!r} ({meant.reason})"
        sys.stdout.write(f"listed in {MEANT.name}, but no longer there: {entry}\n")
    count = len(found.unmeant)
    outcome = f"{count} differ, all of it in {report}" if count else "all as they were"
    sys.stdout.write(f"{found.files} recorded files: {outcome}\n")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
