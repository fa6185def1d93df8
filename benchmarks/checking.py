"""The check of a certificate beside adding up the same numbers in Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.clouds import random_problem
from benchmarks.measuring import Figure, Quantity, fastest, power_of_ten
from certreg.registration.certification import solve
from certreg.verify import check

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.problem.problem import RegistrationProblem

BOUNDS = {20: None, 338: None, 100_000: 3.0}  # points: seconds
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
