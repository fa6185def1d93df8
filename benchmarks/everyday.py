"""The everyday calls, in processor time: each bound is scaled by a yardstick that is run beside.

A bound is meant where the yardstick, `Rotation.align_vectors` of 100 pairs, takes 100 us, and is
scaled by what it takes here, in this process.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

import certreg
from benchmarks.clouds import random_clouds
from benchmarks.measuring import Figure, Quantity, fastest, power_of_ten
from certreg.certificate.isotropic import produce
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.robustness import ROBUSTNESS_ANGLE
from certreg.verify import check

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from certreg.registration.result import Registration

    Cloud = NDArray[np.float64]

YARDSTICK = 100e-6  # seconds that the bounds are meant for
OFTEN = 200  # calls of the yardstick, and of what takes little, in all rounds: the least is told
FEW, MANY, MILLION = 20, 10_000, 1_000_000
# Processor seconds where the yardstick takes 100 us.
BOUNDS = {
    "certificate from the spectrum": 0.1e-3,
    "check": 0.3e-3,
    "certify, bare": 1.5e-3,
    "certify": 3e-3,
    "certify, many": 15e-3,
    "certify, a million": 200e-3,
    "simulate": 0.2e-3,
}
SIZES = {10: 0.5, 100: 0.5, 1000: 0.5, MANY: 0.5}  # of `register`: share of five lines of NumPy
ROUNDS = 5


def measure() -> Iterator[Figure]:
    unit, works = math.inf, list(_works())
    times = [math.inf] * len(works)
    for _ in range(ROUNDS):  # so that no busy moment spoils all calls of one work
        unit = min(unit, yardstick(OFTEN // ROUNDS))
        for k, (*_, work, calls) in enumerate(works):
            times[k] = min(times[k], _least(work, -(-calls // ROUNDS)))
    scale = unit / YARDSTICK
    yield Figure(what="yardstick: align_vectors", value=Quantity(unit, "s"))
    for (name, what, *_), seconds in zip(works, times, strict=True):
        beside = {"where the yardstick takes 100 us": Quantity(seconds / scale, "s")}
        bound = BOUNDS[name] * scale if name in BOUNDS else None
        yield Figure(what=what, value=Quantity(seconds, "s"), bound=bound, beside=beside)
    for n, share in SIZES.items():
        yield _registering(n, share)


def _works() -> Iterator[tuple[str, str, Callable[[], object], int]]:
    """Name of the bound, what it is, the call, and how often it is made."""
    few, many = (RegistrationProblem(*random_clouds(n)) for n in (FEW, MANY))
    moments = exact_moments(few)
    found = Isotropic(moments)
    certificate = produce(few, found)
    assert certificate is not None
    content, of = certificate.to_json(), f", N = {FEW}"

    def bare(
        problem: RegistrationProblem, robustness_angle: float | None = ROBUSTNESS_ANGLE
    ) -> Registration:
        return certreg.certify(
            problem, relaxation=False, simulation=False, robustness_angle=robustness_angle
        )

    def answered() -> object:
        found = bare(few)
        return found.equilibria, found.covariance, found.fit

    spectrum = "certificate from the spectrum"
    yield spectrum, spectrum + of, lambda: produce(few, found), OFTEN
    yield "check", "verify.check" + of, lambda: check(content), OFTEN
    # As `certify` is called: how far points may move is proved, too. Without that, beside it.
    yield "certify, bare", "certify, no relaxation, no run" + of, lambda: bare(few), OFTEN
    least = "certify, no relaxation, no run, no robustness"
    yield least, least + of, lambda: bare(few, robustness_angle=None), OFTEN
    asked = "certify, bare, then equilibria, covariance and fit"
    yield asked, asked + of, answered, OFTEN
    yield "certify", "certify, everything" + of, lambda: certreg.certify(few), OFTEN
    yield "simulate", "simulate, splitting" + of, lambda: certreg.simulate(few, "splitting"), OFTEN
    yield "certify, many", f"certify, bare, N = {power_of_ten(MANY)}", lambda: bare(many), 20
    million = RegistrationProblem(*random_clouds(MILLION))
    yield "certify, a million", f"certify, N = {power_of_ten(MILLION)}", lambda: bare(million), 3


def yardstick(calls: int = OFTEN) -> float:
    source, target = random_clouds(100)
    return _least(lambda: Rotation.align_vectors(target, source), calls)


def _least(work: Callable[[], object], calls: int) -> float:
    """Processor seconds of the cheapest call."""
    work()
    least = math.inf
    for _ in range(calls):
        start = time.process_time()
        work()
        least = min(least, time.process_time() - start)
    return least


def _registering(n: int, share: float) -> Figure:
    source, target = random_clouds(n)
    ours, lines = fastest(
        lambda: certreg.register(source, target),
        lambda: _five_lines(source, target),
        rounds=ROUNDS,
    )
    return Figure(
        what=f"register / NumPy, N = {power_of_ten(n)}",
        value=Quantity(ours / lines, "x"),
        bound=share,
        beside={"register": Quantity(ours, "s"), "five lines": Quantity(lines, "s")},
    )


def _five_lines(source: Cloud, target: Cloud) -> tuple[Cloud, Cloud]:
    """What one would write: nothing is checked."""
    here, there = source.mean(0), target.mean(0)
    u, _, vt = np.linalg.svd((target - there).T @ (source - here))
    u[:, 2] *= np.sign(np.linalg.det(u @ vt))
    rotation = u @ vt
    return rotation, there - rotation @ here
