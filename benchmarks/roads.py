"""The roads to the equilibria side by side, on the exact matrix C of 338 points: time and ratios.

Times are of the fastest call. Singular, msolve and PHCpack, where they are installed, are whole
processes, as they are used; what Singular and PHCpack say of their own time stands beside it.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from importlib.resources import as_file, files
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.measuring import Figure, Quantity, fastest
from certreg.equilibrium.four_paths import HomotopyStatus, continuation
from certreg.equilibrium.groebner import eliminate, fibres
from certreg.equilibrium.line_boxes import BallMatrix, boxed
from certreg.equilibrium.torques import at_most_four
from certreg.exact.balls import exact_matrix
from certreg.geometry.so3 import davenport_matrix
from certreg.io.problems import read_problem
from certreg.objective.classification import pattern_of
from certreg.problem.moments import exact_moments
from tests.oracles.exports import as_msolve, as_phcpack, as_singular, value_unit
from tests.oracles.groebner_basis import rotation_ideal
from tests.oracles.polynomials import multiplier_system
from tests.oracles.systems import quaternion_system

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from flint import arb_mat

    from certreg.geometry.so3 import Matrix3


CLASSIFICATION, CHART, SINGLE, BATCHED, ROOT = 50e-6, 1e-3, 3e-3, 0.5e-3, 0.1e-3  # seconds
SLOWER = 100.0  # SymPy's R-form than the chart: at least
INSTANCES, BITS, ROUNDS = 1000, 60, 15


def measure() -> Iterator[Figure]:
    C = _cross()
    chart, sympy, singular, msolve, phc = _times(C)
    yield from _exact(C, chart, sympy)
    yield from _numerical(C)
    for name, time in (("Singular", singular), ("msolve", msolve), ("phc -b", phc)):
        beside = {"chart": Quantity(chart, "s")}
        if time is None:
            yield Figure(what=f"{name}: not installed", beside=beside)
            continue
        beside |= {name: Quantity(time, "s"), f"{name} / chart": Quantity(time / chart, "x")}
        yield Figure(what=f"{name}, process", beside=beside)


def _exact(C: Matrix3[int], chart: float, sympy: float) -> Iterator[Figure]:
    (classification,) = fastest(lambda: pattern_of(C), rounds=ROUNDS)
    yield Figure(
        what="exact classification", value=Quantity(classification, "s"), bound=CLASSIFICATION
    )
    (count,) = fastest(lambda: at_most_four(C), rounds=ROUNDS)
    yield Figure(
        what="Groebner chart",
        value=Quantity(chart, "s"),
        bound=CHART,
        beside={"count modulo a prime": Quantity(count, "s")},
    )
    yield Figure(
        what="chart, of SymPy's R-form",
        value=Quantity(round(100.0 * chart / sympy, 3), "%"),
        bound=100.0 / SLOWER,
        beside={"SymPy": Quantity(sympy, "s"), "SymPy / chart": Quantity(sympy / chart, "x")},
    )


def _numerical(C: Matrix3[int]) -> Iterator[Figure]:
    K = davenport_matrix(C)
    shift = max(abs(entry) for row in K for entry in row).bit_length()
    one = np.array([[[entry / (1 << shift) for entry in row] for row in K]])
    random = np.random.default_rng(0).normal(size=(INSTANCES, 3, 3))
    many = np.array([davenport_matrix(c.tolist()) for c in random])
    ends = continuation(one)
    assert ends.outcomes[0] is HomotopyStatus.FOUND
    assert set(continuation(many).outcomes) == {HomotopyStatus.FOUND}
    single, batched, roots = fastest(
        lambda: continuation(one),
        lambda: continuation(many),
        _proofs(exact_matrix(K, shift), ends.quaternions[0].tolist()),
        rounds=ROUNDS,
    )
    yield Figure(what="homotopy, single", value=Quantity(single, "s"), bound=SINGLE)
    yield Figure(
        what=f"homotopy, one of {INSTANCES}",
        value=Quantity(batched / INSTANCES, "s"),
        bound=BATCHED,
        beside={"all": Quantity(batched, "s")},
    )
    yield Figure(what="Krawczyk, a root", value=Quantity(roots / 4, "s"), bound=ROOT)


def _proofs(K: arb_mat, vectors: list[list[float]]) -> Callable[[], object]:
    def proofs() -> object:
        form = BallMatrix(K)
        lines = [boxed(form, q, real=True) for q in vectors]
        assert all(lines)
        return lines

    return proofs


def _times(C: Matrix3[int]) -> tuple[float, float, float | None, float | None, float | None]:
    """Seconds of the chart, of SymPy, and of Singular, msolve, PHCpack; None: not installed."""
    K = davenport_matrix(C)
    with tempfile.TemporaryDirectory() as folder:
        works = [
            lambda: fibres(eliminate(C, K), BITS),
            lambda: rotation_ideal(C),
            *_processes(C, Path(folder)),
        ]
        taken = [work for work in works if work is not None]
        fast, slow = fastest(works[0], rounds=ROUNDS), fastest(*taken[1:], rounds=3, seconds=0.0)
    times = iter([*fast, *slow])
    first, second, *others = [None if work is None else next(times) for work in works]
    assert first is not None
    assert second is not None
    return (first, second, *others)  # pyright: ignore[reportReturnType]


def _processes(C: Matrix3[int], folder: Path) -> list[Callable[[], object] | None]:
    """What runs Singular and msolve on the quaternion chart, and PHCpack on the square system."""
    chart = quaternion_system(C, chart=True)
    singular = folder / "singular"
    singular.write_text(as_singular(chart) + "ideal G = groebner(I);\nvdim(G);\nquit;\n", "utf-8")
    msolve, phc = folder / "msolve", folder / "phc"
    msolve.write_text(as_msolve(chart), "utf-8")
    phc.write_text(as_phcpack(multiplier_system(davenport_matrix(C), unit=value_unit(C))), "utf-8")
    return [
        _process("Singular", lambda tool: [tool, "-q", str(singular)], r"^4$"),
        _process(
            "msolve", lambda tool: [tool, "-f", str(msolve), "-o", "/dev/stdout"], r"\[0, \[1"
        ),
        _process("phc", lambda tool: [tool, "-b", "-0", str(phc), str(folder / "out")], None),
    ]


def _process(
    tool: str, command: Callable[[str], list[str]], expected: str | None
) -> Callable[[], object] | None:
    found = shutil.which(tool) or shutil.which(tool, path=os.environ.get("CERTREG_ORACLES"))
    if found is None:
        return None

    def run() -> None:
        words = command(found)
        out = Path(words[-1])
        out.unlink(missing_ok=True) if tool == "phc" else None
        done = subprocess.run(
            words, capture_output=True, text=True, check=True, timeout=60, encoding="utf-8"
        )
        assert expected is None or re.search(expected, done.stdout, re.MULTILINE), done.stdout

    return run


def _cross() -> Matrix3[int]:
    folder = files("certreg") / "data"
    names = ("head_colin27.csv", "head_fsaverage.csv")
    with as_file(folder / names[0]) as source, as_file(folder / names[1]) as target:
        problem, _ = read_problem(source, target)
    return exact_moments(problem).cross


if __name__ == "__main__":
    sys.exit("run `python -m benchmarks --only roads`")
