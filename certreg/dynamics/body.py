"""The registration dynamics: what it knows of a problem, and its functions.

The body moves under springs 2 w and damping mu w per point; only moments enter [Yang2020]:

    c' = v,    R' = R [omega],    v' = -2 c - mu v,
    J omega' = 2 vee(R^T C - C^T R) - mu J omega - omega x J omega,

c the source's centre of mass minus the target's, omega in the body frame. The mass is divided out
and lengths are over a power of two (|s'| mixes lengths and angles); time has its own unit.

A state is 18 numbers: c, R row by row, v, omega: the order of [Yang2020]. Nothing is evaluated
here: the functions are generated from the derivation (certreg/native/generated), and run compiled
or in CasADi's evaluator (certreg/native).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import DegenerateProblemError
from certreg.exact import power_of_two
from certreg.native import ENERGIES, current_engine

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem import ExactMoments

SMALLEST_BARRIER = 1e-280  # of l1 - l2: shares of it, times squares of small angles, are doubles
SMALLEST_INERTIA = 1e-14  # of the clouds' spread: below, rounding is larger than J itself
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
AT_REST = (0.0,) * 6
STATE = 18


@dataclass(frozen=True, slots=True, kw_only=True)
class Energies:
    """|v|^2/2, omega^T J omega/2, V_p, tr(R^T C), per mass, lengths over 2^length_exponent."""

    translation: float
    rotation: float
    potential: float
    alignment: float

    @property
    def kinetic(self) -> float:
        """V_k, of translation and rotation."""
        return self.translation + self.rotation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Body:
    """What the dynamics knows of a problem: per unit of mass, lengths over 2^length_exponent.

    parameters: (23,), as certreg/native/generated/dynamics.h lists them: C / M row by row, the
    upper triangles of J / M and of its inverse, the spread of both clouds over M, the damping
    mu > 0.
    """

    parameters: NDArray[np.float64]
    length_exponent: int

    @property
    def cross_covariance(self) -> NDArray[np.float64]:
        """C / M, (3, 3)."""
        return self.parameters[:9].reshape(3, 3)

    @property
    def inertia(self) -> NDArray[np.float64]:
        """J / M, (3, 3)."""
        a, b, c, d, e, f = self.parameters[9:15].tolist()
        return np.array([[a, b, c], [b, d, e], [c, e, f]])

    @property
    def spread(self) -> float:
        """(sum w |x - mean|^2 + sum w |y - mean|^2) / M."""
        return float(self.parameters[21])

    @property
    def damping(self) -> float:
        """The damping mu."""
        return float(self.parameters[22])

    def rate(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The rates of change s' = F(s), (18,), at a state (18,), R any matrix [Yang2020]."""
        return self._evaluated("certreg_rate", state)

    def energies(self, state: NDArray[np.float64]) -> Energies:
        """The energies at a state (18,) whose R is a rotation."""
        found = self._evaluated("certreg_energies", state).tolist()
        return Energies(**dict(zip(ENERGIES, found, strict=True)))

    def ambient_jacobian(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The derivative of F in all 18 numbers of the state, (18, 18): six structural zeros."""
        return self._evaluated("certreg_ambient_jacobian", state).reshape(STATE, STATE)

    def intrinsic_jacobian(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The linearised dynamics in (c, phi, v, omega), (12, 12), R turned to R exp([phi]x)."""
        return self._evaluated("certreg_intrinsic_jacobian", state).reshape(12, 12)

    def _evaluated(self, name: str, state: NDArray[np.float64]) -> NDArray[np.float64]:
        return current_engine().evaluate(name, state, self.parameters)[0]


def body_of(moments: ExactMoments, damping: float, *, length_exponent: int | None = None) -> Body:
    """The body of a problem whose source is not collinear (J positive definite).

    The unit of length is 2^length_exponent, 0 for the user's own; None: the power of two next to
    the root-mean-square radius of both clouds. Raises DegenerateProblemError where no double
    matrix is the inverse of J.
    """
    a, c = moments.source_exponent, moments.weight_exponent
    square = moments.spread / moments.total_weight
    exponent = length_exponent
    if exponent is None:
        exponent = (square.numerator.bit_length() - square.denominator.bit_length()) // 2
    unit = power_of_two(-2 * exponent) / moments.total_weight
    cross_unit = moments.cross_unit * unit
    inertia_unit = power_of_two(c + 2 * a) / moments.mass * unit
    inertia = np.array([[float(e * inertia_unit) for e in row] for row in moments.inertia])
    if not np.linalg.eigvalsh(inertia)[0] > SMALLEST_INERTIA:
        message = (
            "the source is so nearly collinear, or so small beside the target, that its inertia is "
            "singular in double precision: the dynamics cannot be simulated"
        )
        raise DegenerateProblemError(message)
    upper = np.triu_indices(3)
    cross = [float(e * cross_unit) for row in moments.cross for e in row]
    inverse = np.linalg.inv(inertia)
    parameters = [*cross, *inertia[upper], *inverse[upper], float(moments.spread * unit), damping]
    return Body(parameters=np.array(parameters), length_exponent=exponent)


def start_at_rest(moments: ExactMoments, length_exponent: int) -> NDArray[np.float64]:
    """The start of [Yang2020], (18,): the source where it was given, R = I, no velocity."""
    unit = power_of_two(-length_exponent)
    pairs = zip(moments.source_centroid, moments.target_centroid, strict=True)
    return np.array([*(float((x - y) * unit) for x, y in pairs), *IDENTITY, *AT_REST])
