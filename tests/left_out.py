"""Commands where some libraries are as if they were not installed."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

# In a process of its own: in this one the libraries are loaded.
RUNNING = """
import sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        root = name.partition(".")[0]
        if root in {left_out!r}:
            raise ModuleNotFoundError(f"No module named {{root!r}}", name=root)
sys.meta_path.insert(0, Blocked())
from certreg.cli.main import main
for line in {lines!r}:
    sys.argv = ["certreg", *line]
    try:
        main()
    except SystemExit as stop:
        print("\\nCODE", stop.code, file=sys.stderr, flush=True)
"""


def endings(
    left_out: Iterable[str], lines: Iterable[Sequence[object]], folder: Path, *, strict: bool
) -> list[tuple[int, str]]:
    """Exit code and stderr of each line, run in this folder; if strict, warnings are errors."""
    asked = [[*map(str, line)] for line in lines]
    run = subprocess.run(
        [
            sys.executable,
            *(("-W", "error") if strict else ()),
            *("-c", RUNNING.format(left_out={*left_out}, lines=asked)),
        ],
        capture_output=True,
        encoding="utf-8",
        check=False,
        cwd=folder,
        # dask leaves encodings open
        env={**os.environ, "PYTHONWARNDEFAULTENCODING": "1" if strict else ""},
    )
    first, *rest = run.stderr.split("\nCODE ")
    assert len(rest) == len(asked), run.stderr[-2000:]
    codes, words = zip(*(each.split("\n", 1) for each in rest), strict=True)
    return [*zip(map(int, codes), (first, *words[:-1]), strict=True)]
