"""The check of a certificate, beside adding up the same numbers, and of points of all sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from benchmarks.clouds import random_problem
from benchmarks.measuring import Figure, Quantity, fastest, power_of_ten
from certreg.problem.problem import RegistrationProblem
from certreg.registration.squares import solve
from certreg.verify import check

if TYPE_CHECKING:
    from collections.abc import Iterator

BOUNDS = {20: None, 338: None, 100_000: 3.0}  # points: seconds
FAR = {20: 200, 300: 40, 10_000: 5, 100_000: 2}  # points: rounds
FAR_BOUND, FAR_EXPONENT = 3.0, 1000  # times the usual, of coordinates times 2^-1000 to 2^1000
ROUNDS = 5


def measure() -> Iterator[Figure]:
    for n, bound in BOUNDS.items():
        problem = random_problem(n)
        content, numbers = _certificate(problem), _numbers(problem)
        assert check(content).verified
        ours, baseline = fastest(
            lambda content=content: check(content),
            lambda numbers=numbers: _added(numbers),
            rounds=ROUNDS,
        )
        yield Figure(
            what=f"check, N = {power_of_ten(n)}",
            value=Quantity(ours, "s"),
            bound=bound,
            beside={
                "adding": Quantity(baseline, "s"),
                "check / adding": Quantity(ours / baseline, "x"),
            },
        )

    for n, rounds in FAR.items():
        yield _of_all_sizes(n, rounds)


def _of_all_sizes(n: int, rounds: int) -> Figure:
    """Coordinates over nearly all exponents of doubles, beside usual ones."""
    usual, random = random_problem(n), np.random.default_rng(0)
    powers = 2.0 ** random.integers(-FAR_EXPONENT, FAR_EXPONENT + 1, (2, n, 3))
    far = RegistrationProblem(usual.source * powers[0], usual.target * powers[1])
    given = [_certificate(problem) for problem in (far, usual)]
    assert all(check(content).verified for content in given)
    ours, baseline = fastest(lambda: check(given[0]), lambda: check(given[1]), rounds=rounds)
    return Figure(
        what=f"check, all exponents / usual, N = {power_of_ten(n)}",
        value=Quantity(ours / baseline, "x"),
        bound=FAR_BOUND,
        beside={"all exponents": Quantity(ours, "s"), "usual": Quantity(baseline, "s")},
    )


def _certificate(problem: RegistrationProblem) -> bytes:
    certificate = solve(problem).certificate
    assert certificate is not None
    return certificate.to_json()


def _numbers(problem: RegistrationProblem) -> list[float]:
    arrays = (problem.source, problem.target, problem.weights)
    return [number for array in arrays for number in array.ravel().tolist()]


def _added(numbers: list[float]) -> float:
    total = 0.0
    for number in numbers:
        total += number
    return total
