"""The angle from an answer in doubles to the optimum in 60 digits: the worst of many problems.

Weighted problems for the roads that take weights; then the same clouds without weights, for all.
"""

from __future__ import annotations

import math
import warnings
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.clouds import random_clouds, random_problem
from benchmarks.measuring import Figure, Quantity
from benchmarks.peers import PEERS, Peer, presence
from benchmarks.reference import angle, angle_of_matrix, optimal_quaternion
from certreg.problem.moments import floating_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.closed_form import arun, horn, register
from certreg.registration.squares import solve

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

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
OURS = ("certreg", "certreg, with proof", "Horn", "Arun")


def measure() -> Iterator[Figure]:
    variants = list(product(SIZES, NOISES, SEEDS))
    for name, (shape, bound) in CASES.items():
        problems = (
            random_problem(n, noise=noise, seed=seed, **shape) for n, noise, seed in variants
        )
        yield _figure(name, bound, [_errors(problem) for problem in problems])
    peers = [peer for peer in PEERS if not presence(peer).absent]
    for name, (shape, bound) in CASES.items():
        clouds = (random_clouds(n, noise=noise, seed=seed, **shape) for n, noise, seed in variants)
        found = [_errors_of(peers, source, target) for source, target in clouds]
        yield _figure(f"{name}, no weights", bound, found)


def _figure(what: str, bound: float, errors: Sequence[dict[str, float]]) -> Figure:
    worst = {method: _worst(each[method] for each in errors) for method in errors[0]}
    return Figure(
        what=what,
        value=Quantity(_worst(worst[method] for method in OURS if method in worst), "rad"),
        bound=bound,
        beside={method: Quantity(error, "rad") for method, error in worst.items()},
    )


def _worst(errors: Iterable[float]) -> float:
    """The largest; one that is no number counts as infinite."""
    return max(math.inf if math.isnan(error) else error for error in errors)


def _errors(problem: RegistrationProblem) -> dict[str, float]:
    """Radians, of each method to the rotation."""
    reference = optimal_quaternion(problem.source, problem.target, problem.weights)
    moments = floating_moments(problem)
    answers = {
        "certreg, with proof": solve(problem).pose.quaternion_wxyz,
        "Horn": horn(moments.cross_covariance),
        "Arun": arun(moments.cross_covariance),
    }
    errors = {method: angle(answer.tolist(), reference) for method, answer in answers.items()}
    return errors | {"SciPy": _scipy_error(problem, reference)}


def _errors_of(peers: Sequence[Peer], source: Any, target: Any) -> dict[str, float]:
    """Radians, of each peer; infinite where it refuses, or answers with no rotation."""
    problem = RegistrationProblem(source, target)
    reference = optimal_quaternion(problem.source, problem.target, problem.weights)
    poses = {"certreg": register(source, target), "certreg, with proof": solve(problem).pose}
    errors = {
        method: angle(pose.quaternion_wxyz.tolist(), reference) for method, pose in poses.items()
    }
    return errors | {peer.name: _peer_error(peer, source, target, reference) for peer in peers}


def _peer_error(peer: Peer, source: Any, target: Any, reference: list) -> float:
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            found = np.asarray(peer.prepare(source, target)(), dtype=float)
    except Exception:  # noqa: BLE001 (each library refuses with errors of its own)
        return math.inf
    if found.shape != (3, 3) or not np.isfinite(found).all():
        return math.inf
    return angle_of_matrix(found, reference)


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
