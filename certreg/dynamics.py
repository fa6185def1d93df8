"""The registration dynamics: state, equations of motion, energies.

The body moves under springs 2 w and damping mu w per point; only moments enter [Yang2020]:

    c' = v,    R' = R [omega],    v' = -2 c - mu v,
    J omega' = 2 vee(R^T C - C^T R) - mu J omega - omega x J omega,

c the source's centre of mass minus the target's, omega in the body frame. The mass is divided out
and lengths are over a power of two (|s'| mixes lengths and angles); time has its own unit.

A state is a flat tuple of 18 numbers: c, R row by row, v, omega: the order of [Yang2020].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.dyadic import power_of_two
from certreg.errors import DegenerateProblemError

if TYPE_CHECKING:
    from certreg.moments import ExactMoments

Floats = tuple[float, ...]
SPRING_OVER_MASS = 2.0  # k = 2 w, m = w
SMALLEST_INERTIA = 1e-14  # of the clouds' spread: below, rounding is larger than J itself
AT_REST = (0.0,) * 6
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Body:
    """What the dynamics knows of a problem: per unit of mass, lengths over 2^length_exponent.

    cross_covariance: C / M row by row (9 numbers). inertia: J / M row by row; inertia_inverse.
    spread: (sum w |x - mean|^2 + sum w |y - mean|^2) / M. damping: mu > 0.
    """

    cross_covariance: Floats
    inertia: Floats
    inertia_inverse: Floats
    spread: float
    damping: float
    length_exponent: int

    def derivative(self, state: Floats) -> Floats:
        """s', 18 numbers: the right-hand side of the equations of motion."""
        c, r, v, o = state[:3], state[3:12], state[12:15], state[15:]
        a = _transposed_product(r, self.cross_covariance)
        j = self.inertia
        momentum = _image(j, o)
        mu = self.damping
        torque = (
            2.0 * (a[7] - a[5]) - mu * momentum[0] - (o[1] * momentum[2] - o[2] * momentum[1]),
            2.0 * (a[2] - a[6]) - mu * momentum[1] - (o[2] * momentum[0] - o[0] * momentum[2]),
            2.0 * (a[3] - a[1]) - mu * momentum[2] - (o[0] * momentum[1] - o[1] * momentum[0]),
        )
        turn = _product(r, (0.0, -o[2], o[1], o[2], 0.0, -o[0], -o[1], o[0], 0.0))
        fall = tuple(-SPRING_OVER_MASS * x - mu * y for x, y in zip(c, v, strict=True))
        return (*v, *turn, *fall, *_image(self.inertia_inverse, torque))

    def potential(self, state: Floats) -> float:
        """V_p / M: sum w |y - R x - c|^2 / M for centred x and y."""
        aligned = sum(map(float.__mul__, state[3:12], self.cross_covariance))
        return state[0] ** 2 + state[1] ** 2 + state[2] ** 2 + self.spread - 2.0 * aligned

    def rotational(self, state: Floats) -> float:
        """The kinetic energy of rotation over M: omega^T J omega / (2 M)."""
        o = state[15:]
        return 0.5 * sum(map(float.__mul__, o, _image(self.inertia, o)))

    def kinetic(self, state: Floats) -> float:
        """V_k / M: |v|^2 / 2 + omega^T J omega / (2 M)."""
        v = state[12:15]
        return 0.5 * (v[0] ** 2 + v[1] ** 2 + v[2] ** 2) + self.rotational(state)


def body(moments: ExactMoments, damping: float) -> Body:
    """The body of a problem whose source is not collinear (J positive definite).

    The unit of length is the power of two next to the root-mean-square radius of both clouds.
    Raises DegenerateProblemError where no double matrix is the inverse of J.
    """
    a, c = moments.source_exponent, moments.weight_exponent
    square = moments.spread / moments.total_weight
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
    return Body(
        cross_covariance=tuple(float(e * cross_unit) for row in moments.cross for e in row),
        inertia=tuple(inertia.ravel().tolist()),
        inertia_inverse=tuple(np.linalg.inv(inertia).ravel().tolist()),
        spread=float(moments.spread * unit),
        damping=damping,
        length_exponent=exponent,
    )


def start_at_rest(moments: ExactMoments, length_exponent: int) -> Floats:
    """The start of [Yang2020]: the source where it was given, R = I, no velocity."""
    unit = power_of_two(-length_exponent)
    pairs = zip(moments.source_centroid, moments.target_centroid, strict=True)
    return (*(float((x - y) * unit) for x, y in pairs), *IDENTITY, *AT_REST)


def euler_step(state: Floats, derivative: Floats, step: float) -> Floats:
    """One explicit Euler step, R projected to the nearest rotation [Yang2020].

    The projection in closed form: polar(I + h [w]) = I + (h/n) [w] + h^2/(n (n+1)) [w]^2 with
    n = sqrt(1 + h^2 |w|^2), so that R stays a rotation up to rounding.
    """
    x, y, z = (step * entry for entry in state[15:])
    n = math.sqrt(1.0 + x * x + y * y + z * z)
    first, second = 1.0 / n, 1.0 / (n * (n + 1.0))
    turn = (
        1.0 - second * (y * y + z * z),
        second * x * y - first * z,
        second * x * z + first * y,
        second * x * y + first * z,
        1.0 - second * (x * x + z * z),
        second * y * z - first * x,
        second * x * z - first * y,
        second * y * z + first * x,
        1.0 - second * (x * x + y * y),
    )
    centre = [a + step * b for a, b in zip(state[:3], derivative[:3], strict=True)]
    speeds = [a + step * b for a, b in zip(state[12:], derivative[12:], strict=True)]
    return (*centre, *_product(state[3:12], turn), *speeds)


def _product(a: Floats, b: Floats) -> Floats:
    """The 3x3 product A B, row by row."""
    a0, a1, a2, a3, a4, a5, a6, a7, a8 = a
    b0, b1, b2, b3, b4, b5, b6, b7, b8 = b
    return (
        a0 * b0 + a1 * b3 + a2 * b6,
        a0 * b1 + a1 * b4 + a2 * b7,
        a0 * b2 + a1 * b5 + a2 * b8,
        a3 * b0 + a4 * b3 + a5 * b6,
        a3 * b1 + a4 * b4 + a5 * b7,
        a3 * b2 + a4 * b5 + a5 * b8,
        a6 * b0 + a7 * b3 + a8 * b6,
        a6 * b1 + a7 * b4 + a8 * b7,
        a6 * b2 + a7 * b5 + a8 * b8,
    )


def _transposed_product(a: Floats, b: Floats) -> Floats:
    """The 3x3 product A^T B, row by row."""
    return _product((a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]), b)


def _image(a: Floats, v: Floats) -> tuple[float, float, float]:
    """The product of a 3x3 matrix, row by row, with a vector."""
    x, y, z = v
    return (
        a[0] * x + a[1] * y + a[2] * z,
        a[3] * x + a[4] * y + a[5] * z,
        a[6] * x + a[7] * y + a[8] * z,
    )
