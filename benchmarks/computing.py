"""All that certreg computes of 100 points, beside the one rotation that SciPy computes.

Without files and without the check of its own certificate, which `checking` and `phases` measure.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scipy.spatial.transform import Rotation

from benchmarks.clouds import random_problem
from benchmarks.measuring import Figure, Quantity, fastest
from certreg.problem.problem import RegistrationProblem
from certreg.registration.squares import solve

if TYPE_CHECKING:
    from collections.abc import Iterator

BOUND = 25.0
ROUNDS = 40


def measure() -> Iterator[Figure]:
    problem = random_problem(100)
    x, y, w = problem.source, problem.target, problem.weights

    def by_certreg() -> object:
        return solve(RegistrationProblem(x, y, weights=w))

    def by_scipy() -> object:
        mass = w.sum()
        return Rotation.align_vectors(y - w @ y / mass, x - w @ x / mass, weights=w)

    ours, theirs = fastest(by_certreg, by_scipy, rounds=ROUNDS, seconds=0.05)
    yield Figure(
        what="certreg / SciPy, N = 100",
        value=Quantity(ours / theirs, "x"),
        bound=BOUND,
        beside={"certreg": Quantity(ours, "s"), "align_vectors": Quantity(theirs, "s")},
    )
