"""How light `import certreg` and `certreg --help` are: whole processes, beside importing NumPy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.measuring import Figure, Quantity, fastest

if TYPE_CHECKING:
    from collections.abc import Iterator

HEAVY = ("scipy", "sympy", "flint", "casadi", "cvxpy", "matplotlib")
BOUND = 2.5
ROUNDS = 20
ROOT = Path(__file__).parent.parent


def measure() -> Iterator[Figure]:
    loaded = _run([sys.executable, "-c", "import certreg, sys; print(*sys.modules)"]).split()
    assert "certreg" in loaded
    heavy = [name for name in HEAVY if name in loaded]
    yield Figure(
        what=" ".join(["import certreg", *heavy]),
        value=Quantity(len(heavy), "heavy modules"),
        bound=0,
    )
    commands = {"python -m certreg --help": [sys.executable, "-m", "certreg", "--help"]}
    script = Path(sys.executable).with_name("certreg")
    if script.exists():
        commands["certreg --help"] = [str(script), "--help"]
    for name, command in commands.items():
        assert "certify" in _run(command)
        ours, numpy = fastest(
            lambda command=command: _run(command),
            lambda: _run([sys.executable, "-c", "import numpy"]),
            rounds=ROUNDS,
            seconds=0.0,
        )
        yield Figure(
            what=name,
            value=Quantity(ours / numpy, "x"),
            bound=BOUND,
            beside={"help": Quantity(ours, "s"), "import numpy": Quantity(numpy, "s")},
        )


def _run(command: list[str]) -> str:
    done = subprocess.run(
        command, cwd=ROOT, check=True, capture_output=True, text=True, encoding="utf-8"
    )
    return done.stdout
