"""The registration dynamics: what it knows of a problem, and its functions.

The body moves under springs 2 w and damping mu w per point; only moments enter [Yang2020]:

    c' = v,    R' = R [omega],    v' = -2 c - mu v,
    J omega' = 2 vee(R^T C - C^T R) - mu J omega - omega x J omega,

c the source's centre of mass minus the target's, omega in the body frame. The mass is divided out
and lengths are over a power of two (|s'| mixes lengths and angles); time has its own unit.

A state is 18 numbers, the parts of the record MATRIX_STATE: c, R row by row, v, omega, the order of
[Yang2020]. Nothing is evaluated here: the functions are generated from the derivation
(certreg/native/generated), and run compiled or in Python (certreg/native).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import DegenerateProblemError
from certreg.exact import power_of_two
from certreg.native import BODY, ENERGIES, MATRIX_STATE, current_engine, named, plain, symmetric
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.geometry import Matrix3
    from certreg.native import Records
    from certreg.problem import ExactMoments

UPPER = np.triu_indices(3)
SMALLEST_INERTIA = 1e-14  # of the clouds' spread: below, rounding is larger than J itself


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
class Body(Brief):
    """What the dynamics knows of a problem: per unit of mass, lengths over 2^length_exponent.

    record: () of BODY: C / M, the upper triangles of J / M and of its inverse, the spread of both
    clouds over M, the damping mu > 0.
    """

    record: Records
    length_exponent: int

    @property
    def parameters(self) -> NDArray[np.float64]:
        """The record as 23 doubles, as certreg/native/generated/dynamics.h lists them."""
        return plain(self.record)

    @property
    def cross_covariance(self) -> NDArray[np.float64]:
        """C / M, (3, 3)."""
        return self.record["cross"]

    @property
    def inertia(self) -> NDArray[np.float64]:
        """J / M, (3, 3)."""
        return symmetric(self.record["inertia"])

    @property
    def spread(self) -> float:
        """(sum w |x - mean|^2 + sum w |y - mean|^2) / M."""
        return float(self.record["spread"])

    @property
    def damping(self) -> float:
        """The damping mu."""
        return float(self.record["damping"])

    def rate(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The rates of change s' = F(s), (18,), at a state (18,), R any matrix [Yang2020]."""
        return self._evaluated("certreg_rate", state)

    def energies(self, state: NDArray[np.float64]) -> Energies:
        """The energies at a state (18,) whose R is a rotation."""
        energies = named(self._evaluated("certreg_energies", state), ENERGIES)
        return Energies(**{name: float(energies[name]) for name in ENERGIES.names or ()})

    def ambient_jacobian(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The derivative of F in all 18 numbers of the state, (18, 18): six structural zeros."""
        return self._evaluated("certreg_ambient_jacobian", state).reshape(18, 18)

    def intrinsic_jacobian(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The linearised dynamics in (c, phi, v, omega), (12, 12), R turned to R exp([phi]x)."""
        return self._evaluated("certreg_intrinsic_jacobian", state).reshape(12, 12)

    def _evaluated(self, name: str, state: NDArray[np.float64]) -> NDArray[np.float64]:
        return current_engine().evaluate(name, state, self.record)[0]


def body_of(moments: ExactMoments, damping: float, *, length_exponent: int | None = None) -> Body:
    """The body of a problem whose source is not collinear (J positive definite).

    The unit of length is 2^length_exponent, 0 for the user's own; None: the power of two next to
    the root-mean-square radius of both clouds. Raises DegenerateProblemError where no double
    matrix is the inverse of J.
    """
    a, b, square = moments.source_exponent, moments.target_exponent, moments.mass**2
    exponent = length_exponent
    if exponent is None:
        mean = moments.spread / moments.total_weight
        exponent = (mean.numerator.bit_length() - mean.denominator.bit_length()) // 2
    inertia = _in_doubles(moments.inertia, 2 * (a - exponent), square)
    thinnest = float(np.linalg.eigvalsh(inertia)[0])
    if not thinnest > SMALLEST_INERTIA:
        message = (
            "the source is so nearly collinear, or so small beside the target, that its inertia is "
            "singular in double precision: the dynamics cannot be simulated"
        )
        raise DegenerateProblemError(message, value=thinnest, limit=SMALLEST_INERTIA)
    record = np.empty((), dtype=BODY)
    record["cross"] = _in_doubles(moments.cross, a + b - 2 * exponent, square)
    record["inertia"] = inertia[UPPER]
    record["inertia_inverse"] = np.linalg.inv(inertia)[UPPER]
    record["spread"] = float(moments.spread * power_of_two(-2 * exponent) / moments.total_weight)
    record["damping"] = damping
    return Body(record=record, length_exponent=exponent)


def _in_doubles(matrix: Matrix3[int], places: int, over: int) -> NDArray[np.float64]:
    """The integers times 2^places, over an integer, each rounded once."""
    up, over = max(places, 0), over << max(-places, 0)
    return np.array([[(entry << up) / over for entry in row] for row in matrix])


def start_at_rest(moments: ExactMoments, length_exponent: int) -> NDArray[np.float64]:
    """The start of [Yang2020], (18,): the source where it was given, R = I, no velocity."""
    a, b = moments.source_exponent, moments.target_exponent
    least = min(a, b)
    places = least - length_exponent
    up, over = max(places, 0), moments.mass << max(-places, 0)
    pairs = zip(moments.source_sum, moments.target_sum, strict=True)
    apart = [((x << (a - least)) - (y << (b - least))) for x, y in pairs]
    return state_at_rest(np.eye(3), [(entry << up) / over for entry in apart])


def state_at_rest(rotation: ArrayLike, c: ArrayLike = (0.0, 0.0, 0.0)) -> NDArray[np.float64]:
    """The state (18,) at rest with a rotation, the centres of mass together unless c is given."""
    state = np.zeros((), dtype=MATRIX_STATE)
    state["c"], state["R"] = c, rotation
    return plain(state)
