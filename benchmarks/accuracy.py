"""The angle from an answer in doubles to the optimum in 60 digits: the worst of many problems."""

from __future__ import annotations

import math
import warnings
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.clouds import random_problem
from benchmarks.measuring import Figure, Quantity
from benchmarks.reference import angle, optimal_quaternion
from certreg.equilibria.closed_form import arun, horn
from certreg.moments import floating_moments
from certreg.pipeline import solve

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from certreg.problem import RegistrationProblem

USUAL, FAR = 2e-14, 2e-13  # radians; at an offset of 1e8 the points themselves hold 8 digits
CASES = {
    "generic": ({}, USUAL),
    "offset 1e6": ({"offset": 1e6}, USUAL),
    "offset as in UTM": ({"offset": (5e5, 5.4e6, 3e2)}, USUAL),
    "offset 1e8": ({"offset": 1e8}, FAR),
    "scale 1e-170": ({"scale": 1e-170}, USUAL),
    "scale 1e150": ({"scale": 1e150}, USUAL),
}
SIZES, NOISES, SEEDS = (100, 1000), (0.01, 0.1), range(5)


def measure() -> Iterator[Figure]:
    for name, (options, bound) in CASES.items():
        errors = [
            _errors(random_problem(n, noise=noise, seed=seed, **options))
            for n, noise, seed in product(SIZES, NOISES, SEEDS)
        ]
        worst = {road: _worst(each[road] for each in errors) for road in errors[0]}
        yield Figure(
            what=name,
            value=Quantity(_worst(worst[road] for road in ("certreg", "Horn", "Arun")), "rad"),
            bound=bound,
            beside={road: Quantity(error, "rad") for road, error in worst.items()},
        )


def _worst(errors: Iterable[float]) -> float:
    """The largest; one that is no number counts as infinite."""
    return max(math.inf if math.isnan(error) else error for error in errors)


def _errors(problem: RegistrationProblem) -> dict[str, float]:
    """Radians, of each road to the rotation."""
    reference = optimal_quaternion(problem.source, problem.target, problem.weights)
    moments = floating_moments(problem)
    answers = {
        "certreg": solve(problem).pose.quaternion_wxyz,
        "Horn": horn(moments.cross_covariance),
        "Arun": arun(moments.cross_covariance),
    }
    errors = {road: angle(answer.tolist(), reference) for road, answer in answers.items()}
    return errors | {"SciPy": _scipy_error(problem, reference)}


def _scipy_error(problem: RegistrationProblem, reference: list) -> float:
    """Infinite where SciPy refuses to answer."""
    x, y, w = problem.source, problem.target, problem.weights
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            mass = w.sum()
            found = Rotation.align_vectors(y - w @ y / mass, x - w @ x / mass, weights=w)[0]
    except (ValueError, np.linalg.LinAlgError):
        return math.inf
    *vector, scalar = found.as_quat().tolist()
    return angle([scalar, *vector], reference)
