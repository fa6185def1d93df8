"""The files of a commit, compiled, beside the working tree: both run in this environment."""

from __future__ import annotations

import hashlib
import io
import os
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def git(*arguments: str) -> bytes:
    run = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, check=False)
    if run.returncode:
        sys.exit(run.stderr.decode(errors="replace").strip())
    return run.stdout


def check_out(commit: str, folder: Path) -> None:
    """The files of a commit, without git."""
    shutil.rmtree(folder, ignore_errors=True)
    with tarfile.open(fileobj=io.BytesIO(git("archive", commit)), encoding="utf-8") as archive:
        archive.extractall(folder, filter="data")
    script = folder / "build_kernels.py"
    if script.exists():  # earlier ones compile when they are first used
        shared = {"CERTREG_OBJECTS": str(ROOT / "build" / "kernels"), **os.environ}
        command = [sys.executable, script]
        subprocess.run(command, env=shared, check=True, stdout=subprocess.DEVNULL)


def working_tree() -> str:
    """The digest of all files of the working tree that git does not ignore."""
    digest = hashlib.sha256()
    listed = git("ls-files", "-z", "--cached", "--others", "--exclude-standard").decode()
    for name in sorted({*listed.split("\0")} - {""}):
        path = ROOT / name
        digest.update(
            name.encode() + b"\0" + (path.read_bytes() if path.is_file() else b"") + b"\0"
        )
    return digest.hexdigest()
