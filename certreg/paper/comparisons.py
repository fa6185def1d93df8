"""certreg's generated functions beside the paper's equations, at random states of an instance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics import body_of
from certreg.geometry import rotation_matrix
from certreg.paper.particles import Particles, parts
from certreg.paper.scheme import RAW_UNIT
from certreg.problem import exact_moments

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem import RegistrationProblem


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """The largest relative differences over the states compared.

    objective: of V_p to the maximum-likelihood objective at t = c - R x_mean. rate: of F(s), from
    the derivation, to the Newton-Euler equations summed over the particles. dissipation: of dV/dt
    along F to -mu M |v|^2 - mu omega^T J omega.
    """

    objective: float
    rate: float
    dissipation: float


def compare(problem: RegistrationProblem, rng: np.random.Generator, states: int) -> Comparison:
    """The comparison at random states whose R is a rotation."""
    moving = body_of(exact_moments(problem), problem.damping, length_exponent=RAW_UNIT)
    particles = Particles.of(problem)
    drawn = [_random_state(rng) for _ in range(states)]
    objectives = [_likelihood(particles, state) for state in drawn]
    potentials = [particles.mass * moving.energies(state).potential for state in drawn]
    printed, derived = [particles.rate(s) for s in drawn], [moving.rate(s) for s in drawn]
    told, found = (
        [particles.dissipation(s) for s in drawn],
        [particles.energy_rate(s) for s in drawn],
    )
    return Comparison(
        objective=_difference(potentials, objectives),
        rate=_difference(derived, printed),
        dissipation=_difference(found, told),
    )


def _likelihood(particles: Particles, state: NDArray[np.float64]) -> float:
    """The sum of |y - R x - t|^2 / sigma^2 at the pose of a state."""
    c, R, _, _ = parts(state)
    t = c - R @ particles.centre
    residuals = particles.target - particles.source @ R.T - t
    return float(particles.masses @ (residuals**2).sum(axis=1))


def _difference(
    found: list[float] | list[NDArray[np.float64]], told: list[float] | list[NDArray[np.float64]]
) -> float:
    pairs = zip(map(np.atleast_1d, found), map(np.atleast_1d, told), strict=True)
    return max(float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in pairs)


def _random_state(rng: np.random.Generator) -> NDArray[np.float64]:
    q = rng.standard_normal(4)
    R = np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))
    c, v, omega = rng.standard_normal((3, 3))
    return np.concatenate([c, R.ravel(), v, omega])
