"""`make same BASE=<commit> [QUICK=1]`: the problems of all kinds, at a commit and now.

The commit is taken from git into build/same and compiled there; "now" is the working tree as it
stands. Both run in this environment, on the same doubles, two processes at a time. What a commit
made of the problems is kept for the next time.

Exit code 1 where anything differs but times, unless tests/same/meant.toml or the command line says
that it is meant. New fields are printed, and pass. The differences, by kinds of problems and by
fields, stand in build/same/differences.txt, too.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from same.checkouts import ROOT, check_out, git
from same.fields import BEYOND, Bounds, Stated, changed_fields, read_bounds, read_fields

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from same.fields import Field

BUILD = ROOT / "build" / "same"
HERE = Path(__file__).resolve().parent
MEANT = HERE / "meant.toml"
PARTS = 2  # of each side, each by a process: two at a time

Documents = dict[str, Any]


def main() -> int:
    parser = argparse.ArgumentParser(description="Problems of all kinds, at a commit and now.")
    parser.add_argument("base", help="the commit: make same BASE=<commit>")
    parser.add_argument("--quick", action="store_true", help="a tenth of the problems")
    parser.add_argument(
        "--meant", action="append", default=[], help="fields that may differ: *.rmse"
    )
    asked = parser.parse_args()
    meant = Stated(tuple(asked.meant), "said on the command line", changes=True)
    bounds = Bounds((meant, *read_bounds(MEANT).fields))
    found = compared(*recorded(asked.base, quick=asked.quick), bounds)
    page = "\n".join(lines(found)) + "\n"
    (BUILD / "differences.txt").write_text(page, "utf-8")
    sys.stdout.write(page)
    return 0 if found.passes else 1


# Recording ----------------------------------------------------------------------------------------


def recorded(base_name: str, *, quick: bool) -> tuple[Documents, Documents]:
    """What the commit and the working tree make of the problems, by their names."""
    commit = git("rev-parse", "--verify", f"{base_name}^{{commit}}").decode().strip()
    base, head = BUILD / commit, BUILD / "head"
    for folder in BUILD.glob("*/"):
        if folder != base:
            shutil.rmtree(folder)
    if not (base / "compiled").exists():
        check_out(commit, base / "checkout")
        (base / "compiled").touch()
    records = {head / "record": ROOT, base / f"record-{_mark(quick=quick)}": base / "checkout"}
    with ThreadPoolExecutor(PARTS) as pool:
        jobs = [
            pool.submit(_record, checkout, out, part, quick=quick)
            for out, checkout in records.items()
            for part in range(PARTS)
        ]
        for job in jobs:
            job.result()
    now, before = (_read(out) for out in records)
    return before, now


def _record(checkout: Path, out: Path, part: int, *, quick: bool) -> None:
    """One part of the record of a checkout, which comes first on the path; kept if it is there."""
    out.mkdir(parents=True, exist_ok=True)
    file = out / f"{part}.jsonl"
    if file.exists():
        return
    environment = {
        **os.environ,
        "PYTHONPATH": f"{checkout}{os.pathsep}{ROOT / 'tests'}",
        "COLUMNS": "80",
        "LC_ALL": "C.UTF-8",
        "OPENBLAS_NUM_THREADS": "1",
    }
    begun = file.with_suffix(".begun")
    command = [sys.executable, HERE / "recorded.py", checkout, begun, "--part", f"{part}/{PARTS}"]
    subprocess.run([*command, *(["--quick"] if quick else [])], env=environment, check=True)
    begun.rename(file)


def _read(out: Path) -> Documents:
    texts = (file.read_text("utf-8") for file in sorted(out.glob("*.jsonl")))
    return dict(json.loads(line) for text in texts for line in text.splitlines())


def _mark(*, quick: bool) -> str:
    """What the record of a commit depends on besides it."""
    files = (HERE / "problems.py", HERE / "recorded.py", ROOT / "uv.lock")
    parts = (*(path.read_bytes() for path in files), sys.version.encode(), bytes([quick]))
    return hashlib.sha256(b"\0".join(parts)).hexdigest()[:16]


# Comparing ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Comparison:
    """The fields that differ by kinds of problems; how many problems there are, and of how many."""

    problems: int
    differing: int
    rows: Mapping[str, Sequence[Field]]

    @property
    def passes(self) -> bool:
        return not any(row.verdict == BEYOND for rows in self.rows.values() for row in rows)


def compared(base: Documents, head: Documents, bounds: Bounds | None = None) -> Comparison:
    """Two records held against each other, problem by problem."""
    if base.keys() != head.keys() or not base:
        sys.exit(f"one side has {len(base)} problems, the other {len(head)}, or they are others")
    kinds = defaultdict[str, list[str]](list)
    for name in base:
        if base[name] != head[name]:
            kinds[name.partition("/")[0]].append(name)
    rows = {
        kind: changed_fields(
            ((name, read_fields(base[name]), read_fields(head[name])) for name in names),
            bounds,
            words_decide=True,
        )
        for kind, names in kinds.items()
    }
    return Comparison(len(base), sum(map(len, kinds.values())), rows)


def lines(found: Comparison) -> Iterator[str]:
    """The differences: a kind of problems, its fields, of what is not meant the first example."""
    for kind, rows in found.rows.items():
        yield kind
        for row in rows:
            yield f"  {row.verdict}  {row}".replace(" files", " problems")
            if row.verdict == BEYOND:
                yield f"      {row.example}"
            elif row.stated is not None:
                yield f"      {row.stated}. {row.stated.reason}"
    if not found.differing:
        yield f"{found.problems} problems: all identical"
        return
    beyond = sum(row.verdict == BEYOND for rows in found.rows.values() for row in rows)
    yield f"{found.differing} of {found.problems} problems differ; fields that may not: {beyond}"


if __name__ == "__main__":
    sys.exit(main())
