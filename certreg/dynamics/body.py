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

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import DegenerateProblemError
from certreg.native import (
    BODY,
    ENERGIES,
    MATRIX_STATE,
    current_engine,
    named,
    plain,
    record_of,
    symmetric,
)
from certreg.problem import trace
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    from certreg.geometry import Matrix3
    from certreg.native import Records
    from certreg.problem import ExactMoments

SMALLEST_INERTIA = 1e-14  # of the clouds' spread: below, rounding is larger than J itself
CLEARLY_THICK = 1e-10  # far above that and all rounding


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
    core = core_of(moments, length_exponent)
    places = 2 * (moments.source_exponent - core.length_exponent)
    inverse = _inverse(moments.inertia, places, moments.mass**2)
    numbers = [*core.cross, *core.inertia, *inverse, core.spread, damping]
    return Body(record=record_of(numbers, BODY), length_exponent=core.length_exponent)


def _inverse(inertia: Matrix3[int], places: int, over: int) -> list[float]:
    """The upper triangle of the inverse of integers times 2^places, over an integer."""
    (a, b, c), (_, d, e), (_, _, f) = inertia
    first, second, third = d * f - e * e, c * e - b * f, b * e - c * d
    cofactors = (first, second, third, a * f - c * c, b * c - a * e, a * d - b * b)
    determinant = a * first + b * second + c * third
    return _in_doubles([entry * over for entry in cofactors], -places, determinant)


@dataclass(frozen=True, slots=True)
class Core:
    """What the springs of a body are made of, as in its record: cross and inertia flat."""

    length_exponent: int
    cross: list[float]
    inertia: list[float]
    spread: float


def core_of(moments: ExactMoments, length_exponent: int | None = None) -> Core:
    """The numbers of a body that are sums over its points; as `body_of`, which adds the rest."""
    a, b, square = moments.source_exponent, moments.target_exponent, moments.mass**2
    least = min(a, b)
    spread = trace(moments.source_scatter) << 2 * (a - least)
    spread += trace(moments.target_scatter) << 2 * (b - least)
    exponent = length_exponent
    if exponent is None:
        exponent = exponent_of(spread, square, 2 * least) // 2
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = moments.inertia
    inertia = _in_doubles((xx, xy, xz, yy, yz, zz), 2 * (a - exponent), square)
    require_thick(inertia)
    cross = [entry for row in moments.cross for entry in row]
    return Core(
        exponent,
        cross=_in_doubles(cross, a + b - 2 * exponent, square),
        inertia=inertia,
        spread=_in_doubles([spread], 2 * (least - exponent), square)[0],
    )


def exponent_of(dividend: int, divisor: int, places: int) -> int:
    """Of a power of two next to dividend / divisor 2^places: of the reduced fraction's lengths."""
    dividend, divisor = dividend << max(places, 0), divisor << max(-places, 0)
    common = math.gcd(dividend, divisor)
    return (dividend // common).bit_length() - (divisor // common).bit_length()


def require_thick(inertia: list[float]) -> None:
    """Raises DegenerateProblemError unless the least eigenvalue is above SMALLEST_INERTIA."""
    if clearly_thick(inertia):
        return
    thinnest = float(np.linalg.eigvalsh(_full(inertia))[0])
    if not thinnest > SMALLEST_INERTIA:
        message = (
            "the source is so nearly collinear, or so small beside the target, that its inertia is "
            "singular in double precision: the dynamics cannot be simulated"
        )
        raise DegenerateProblemError(message, value=thinnest, limit=SMALLEST_INERTIA)


def clearly_thick(inertia: list[float]) -> bool:
    """Whether the least eigenvalue is large at a glance; False says nothing.

    It is at least 4 det / trace^2, as the sum of the two others is below the trace, and the
    determinant is wrong by less than 1e-14 trace^3.
    """
    a, b, c, d, e, f = inertia
    determinant = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
    whole = a + d + f
    return 4.0 * determinant > CLEARLY_THICK * whole * whole * max(1.0, whole)


def _full(upper: list[float]) -> NDArray[np.float64]:
    a, b, c, d, e, f = upper
    return np.array([[a, b, c], [b, d, e], [c, e, f]])


def _in_doubles(entries: Iterable[int], places: int, over: int) -> list[float]:
    """The integers times 2^places, over an integer, each rounded once."""
    if places >= 0:
        return [(entry << places) / over for entry in entries]
    over <<= -places
    return [entry / over for entry in entries]


def start_at_rest(moments: ExactMoments, length_exponent: int) -> NDArray[np.float64]:
    """The start of [Yang2020], (18,): the source where it was given, R = I, no velocity."""
    return state_at_rest(np.eye(3), centres_apart(moments, length_exponent))


def centres_apart(moments: ExactMoments, length_exponent: int) -> list[float]:
    """The source's centre of mass where it was given minus the target's, over 2^length_exponent."""
    a, b = moments.source_exponent, moments.target_exponent
    least = min(a, b)
    x, y = a - least, b - least
    pairs = zip(moments.source_sum, moments.target_sum, strict=True)
    apart = [(here << x) - (there << y) for here, there in pairs]
    return _in_doubles(apart, least - length_exponent, moments.mass)


def state_at_rest(rotation: ArrayLike, c: ArrayLike = (0.0, 0.0, 0.0)) -> NDArray[np.float64]:
    """The state (18,) at rest with a rotation, the centres of mass together unless c is given."""
    state = np.zeros((), dtype=MATRIX_STATE)
    state["c"], state["R"] = c, rotation
    return plain(state)
