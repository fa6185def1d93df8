"""How light `import certreg`, help and `certify` are: whole processes, beside importing NumPy."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.measuring import Figure, Quantity, fastest

if TYPE_CHECKING:
    from collections.abc import Iterator

HEAVY = ("scipy", "sympy", "flint", "casadi", "cvxpy", "matplotlib")
HELP, CERTIFY = 2.5, 6.0  # times what importing NumPy takes
ROUNDS = 20
NOT_KEPT = "PYTHONDONTWRITEBYTECODE"
ROOT = Path(__file__).parent.parent
DATA = ROOT / "certreg" / "data"


def measure() -> Iterator[Figure]:
    loaded = _run([sys.executable, "-c", "import certreg, sys; print(*sys.modules)"]).split()
    assert "certreg" in loaded
    heavy = [name for name in HEAVY if name in loaded]
    yield Figure(
        what=" ".join(["import certreg", *heavy]),
        value=Quantity(len(heavy), "heavy modules"),
        bound=0,
    )
    yield _beside_numpy("python -m certreg --help", ["--help"], HELP)
    survey = [str(DATA / f"survey_{side}.csv") for side in ("source", "target")]
    command = ["certify", *survey, "--sigma", "4"]
    yield _beside_numpy("certreg certify, the survey", command, CERTIFY)
    with tempfile.TemporaryDirectory() as folder:
        # With the report, whose pages and templates are loaded, too.
        yield _beside_numpy("certreg certify --out, the survey", [*command, "--out", folder])


def _beside_numpy(what: str, arguments: list[str], bound: float | None = None) -> Figure:
    command = [sys.executable, "-m", "certreg", *arguments]
    assert "certif" in _run(command).lower()
    ours, numpy = fastest(
        lambda: _run(command),
        lambda: _run([sys.executable, "-c", "import numpy"]),
        rounds=ROUNDS,
        seconds=0.0,
    )
    return Figure(
        what=what,
        value=Quantity(ours / numpy, "x"),
        bound=bound,
        beside={"the process": Quantity(ours, "s"), "import numpy": Quantity(numpy, "s")},
    )


def _run(command: list[str]) -> str:
    """As users have it: what was imported once stays compiled, whatever the environment says."""
    usual = {name: value for name, value in os.environ.items() if name != NOT_KEPT}
    done = subprocess.run(
        command, cwd=ROOT, check=True, capture_output=True, text=True, encoding="utf-8", env=usual
    )
    return done.stdout
