"""The paper's equations as printed: sums over particles, none of certreg's moments.

Written from [Yang2020] term by term, so that what certreg computes from moments, derived and
generated, can be held against it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import cached_property
from certreg.dynamics.states import state_at_rest
from certreg.native.layout import MATRIX_STATE, named

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem


RAW_UNIT = 0  # the exponent of the unit of length: |s'| mixes lengths and angles, as in the paper
SAME_SUM = 1e-12  # relative: of two ways to add 100 terms, a thousand times their rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class Particles:
    """A rigid body of particles on springs to a target whose centre is the origin.

    source, target: (N, 3); masses: (N,), 1/sigma^2; damping: mu. A state is the paper's s, (18,):
    centre of mass, R row by row (any matrix), velocity, angular velocity in the body frame.
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    masses: NDArray[np.float64]
    damping: float

    @classmethod
    def of(cls, problem: RegistrationProblem) -> Particles:
        """The particles of a problem, both clouds shifted by the target's centre of mass."""
        centre = problem.weights @ problem.target / problem.weights.sum()
        return cls(
            source=problem.source - centre,
            target=problem.target - centre,
            masses=problem.weights,
            damping=problem.damping,
        )

    @cached_property
    def mass(self) -> float:
        """M."""
        return float(self.masses.sum())

    @cached_property
    def springs(self) -> NDArray[np.float64]:
        """k_i = 2 m_i, (N,)."""
        return 2.0 * self.masses

    @cached_property
    def centre(self) -> NDArray[np.float64]:
        """The centre of mass of the source where it was given, (3,)."""
        return self.masses @ self.source / self.mass

    @cached_property
    def arms(self) -> NDArray[np.float64]:
        """The positions in the body frame, x less its centre, (N, 3)."""
        return self.source - self.centre

    @cached_property
    def inertia(self) -> NDArray[np.float64]:
        """J = -sum m_i [x_i]^2, (3, 3)."""
        crosses = hat(self.arms)
        return -np.einsum("n,nij,njk->ik", self.masses, crosses, crosses)

    @property
    def start(self) -> NDArray[np.float64]:
        """The paper's start: at rest where the source is, R = I, (18,)."""
        return state_at_rest(np.eye(3), self.centre)

    def force(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The total force on the body, world frame, (3,)."""
        c, R, v, _ = parts(state)
        stretched = self.target - self.arms @ R.T - c
        return self.springs @ stretched - self.damping * self.mass * v

    def torque(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The total torque about the centre of mass, body frame, (3,)."""
        c, R, _, omega = parts(state)
        pull = np.cross(self.arms, (self.target - c) @ R)
        drag = np.cross(self.arms, np.cross(omega, self.arms))
        return self.springs @ pull - self.damping * (self.masses @ drag)

    def rate(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """F(s), the rate of change of a state, (18,): the Newton-Euler equations."""
        _, R, v, omega = parts(state)
        turn = self.torque(state) - np.cross(omega, self.inertia @ omega)
        spin = np.asarray(np.linalg.solve(self.inertia, turn), dtype=np.float64)
        return np.concatenate([v, (R @ hat(omega)).ravel(), self.force(state) / self.mass, spin])

    def potential(self, state: NDArray[np.float64]) -> float:
        """V_p = sum k_i / 2 |y_i - R x_i - c|^2."""
        c, R, _, _ = parts(state)
        return float(self.springs / 2.0 @ ((self.target - self.arms @ R.T - c) ** 2).sum(axis=1))

    def energy(self, state: NDArray[np.float64]) -> float:
        """V = V_k + V_p, with the kinetic energy of a rotation: M |v|^2 / 2 + omega^T J omega / 2.

        Off the rotations the paper's two forms of V_k differ; the second is what it derives with.
        """
        _, _, v, omega = parts(state)
        kinetic = self.mass * v @ v / 2.0 + omega @ self.inertia @ omega / 2.0
        return self.potential(state) + float(kinetic)

    def energy_rate(self, state: NDArray[np.float64]) -> float:
        """dV/dt along F. V is quadratic in the 18 numbers, so a central difference is exact."""
        rate = self.rate(state)
        return (self.energy(state + rate) - self.energy(state - rate)) / 2.0

    def dissipation(self, state: NDArray[np.float64]) -> float:
        """What the paper says dV/dt is: -mu M |v|^2 - mu omega^T J omega."""
        _, _, v, omega = parts(state)
        return float(-self.damping * (self.mass * v @ v + omega @ self.inertia @ omega))

    def balance(self, R: NDArray[np.float64]) -> float:
        """The paper's equilibrium equation: |sum k [x]x R^T y| over the sum of the norms."""
        terms = self.springs[:, np.newaxis] * np.cross(self.arms, self.target @ R)
        lengths = np.linalg.norm(self.arms, axis=1) * np.linalg.norm(self.target, axis=1)
        return float(np.linalg.norm(terms.sum(axis=0)) / (self.springs @ lengths))


def parts(
    state: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """c, R, v, omega of a state."""
    record = named(state, MATRIX_STATE)
    return record["c"], record["R"], record["v"], record["omega"]


def hat(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """[a]x, with [a]x b = a x b, of vectors (..., 3): (..., 3, 3)."""
    return np.cross(vectors[..., np.newaxis, :], np.eye(3)).swapaxes(-1, -2)
