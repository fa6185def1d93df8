"""The rigid body on springs of one weight per pair: its functions, and how it is made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.body import (
    AnyBody,
    Basin,
    SimulationStatus,
    certified_basin,
    exponent_of,
    require_rank,
    require_thick,
)
from certreg.dynamics.integrators import SimulationSettings, step_parameters
from certreg.dynamics.states import (
    NO_TURN,
    NO_TURN_QUATERNION,
    centres_apart,
    in_doubles,
    start_at_rest,
    state_at_rest,
    with_matrices,
)
from certreg.exact.elimination import rank
from certreg.geometry.so3 import Matrix3, quaternion_from_matrix, rotation_matrix
from certreg.native.layout import (
    BODY,
    ENERGIES,
    MATRIX_STATE,
    QUATERNION_STATE,
    Records,
    named,
    plain,
    record_of,
)
from certreg.native.loops import Integrator, Kind
from certreg.problem.moments import ExactMoments, trace
from certreg.results import Absent

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from certreg.objective.isotropic import Isotropic


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RigidBody(AnyBody):
    """The body on springs of one weight per pair.

    record: () of BODY: C / M, the upper triangles of J / M and of its inverse, the spread of both
    clouds over M, the damping mu > 0. moments: all that it is made of, exactly.
    A state is 18 numbers, the parts of MATRIX_STATE, the order of [Yang2020]; states with a
    quaternion are taken, too.
    """

    KIND = Kind.RIGID
    ENERGIES = ENERGIES
    STATUS = SimulationStatus.by_ending()
    INTEGRATOR = Integrator.EULER  # the paper's
    NO_RATE = Absent("the optimum is not unique: no rate belongs to it")

    moments: ExactMoments

    @property
    def mass(self) -> Fraction:
        """M, exact, in the user's unit."""
        return self.moments.total_weight

    @property
    def parameters(self) -> NDArray[np.float64]:
        """The record as 23 doubles, as certreg/native/generated/dynamics.h lists them."""
        return plain(self.record)

    @property
    def cross_covariance(self) -> NDArray[np.float64]:
        """C / M, (3, 3)."""
        return self.record["cross"]

    @property
    def least_energy(self) -> float | None:
        """V_p / M at the optimum; None where nothing is certified of it."""
        return None if self.basin is None else float(self.energies(_at(self.basin))["potential"])

    @property
    def slowest_rate(self) -> float | None:
        """Of decay, by the linearised dynamics at the optimum; None where that is not unique."""
        if self.basin is None or not self.basin.barrier > 0.0:
            return None
        return -float(np.linalg.eigvals(self.intrinsic_jacobian(_at(self.basin))).real.max())

    @property
    def start(self) -> Records:
        """The state () at rest where the source was given, R = I [Yang2020]."""
        return named(start_at_rest(self.moments, self.length_exponent), MATRIX_STATE)

    def stated(self, start: NDArray[Any] | None, integrator: Integrator) -> Records:
        """A start (1,) as an integrator keeps it, with a matrix or a quaternion."""
        if start is None:
            turn = NO_TURN if integrator is Integrator.EULER else NO_TURN_QUATERNION
            apart = centres_apart(self.moments, self.length_exponent)
            return record_of([*apart, *turn, *[0.0] * 6], integrator.state, (1,))
        given = named(np.array(start, dtype=float), MATRIX_STATE)[np.newaxis]
        if integrator is Integrator.EULER:
            return given
        states = np.empty(1, dtype=QUATERNION_STATE)
        states["q"] = quaternion_from_matrix(given["R"][0])
        for part in ("c", "v", "omega"):
            states[part] = given[part]
        return states

    def steps(
        self, integrator: Integrator, starts: Records, settings: SimulationSettings
    ) -> Records:
        """The step (1,), from the springs at the optimum.

        Raises DegenerateProblemError where explicit Euler would need too small a step.
        """
        del starts
        return step_parameters(integrator, self.record[np.newaxis], self.basins, settings)

    def rate(self, state: NDArray[Any]) -> NDArray[np.float64]:
        """The rates of change s' = F(s), (18,), at a state (18,), R any matrix [Yang2020]."""
        return self._evaluated("rate", state)[0]

    def squared_speed(self, state: NDArray[Any]) -> float:
        """|s'|^2, of 18 numbers."""
        rate = self.rate(state)
        return float(rate @ rate)

    def quaternion(self, state: Records) -> NDArray[np.float64]:
        """(4,), of the matrix of a state."""
        return quaternion_from_matrix(with_matrices(state)["R"])

    def ambient_jacobian(self, state: NDArray[Any]) -> NDArray[np.float64]:
        """The derivative of F in all 18 numbers of the state, (18, 18): six structural zeros."""
        return self._evaluated("ambient_jacobian", state)[0].reshape(18, 18)

    def intrinsic_jacobian(self, state: NDArray[Any]) -> NDArray[np.float64]:
        """The linearised dynamics in (c, phi, v, omega), (12, 12), R turned to R exp([phi]x)."""
        return self._evaluated("intrinsic_jacobian", state)[0].reshape(12, 12)

    def _taken(self, state: NDArray[Any]) -> NDArray[Any]:
        """With a matrix."""
        return state if state.dtype.names is None else with_matrices(state)


def _at(basin: Basin) -> NDArray[np.float64]:
    """The state (18,) at rest at the optimum."""
    return state_at_rest(np.array(rotation_matrix(basin.optimum.tolist())))


def body_on_weights(objective: Isotropic, damping: float) -> RigidBody:
    """The body of an objective of scale 1, with its basin.

    Raises DegenerateProblemError where the dynamics is not defined, or not in doubles.
    """
    require_dynamics(objective)
    core = core_of(objective.moments)
    basin = certified_basin(objective, core.length_exponent)
    return _rigid(objective.moments, core, damping, basin)


def require_dynamics(objective: Isotropic) -> None:
    """Raises DegenerateProblemError where the source is collinear."""
    if not objective.classification.inertia_definite:
        require_rank(rank(objective.moments.source_scatter))


def rigid_body(
    moments: ExactMoments, damping: float, *, length_exponent: int | None = None
) -> RigidBody:
    """The body of a problem whose source is not collinear (J positive definite).

    The unit of length is 2^length_exponent, 0 for the user's own; None: the power of two next to
    the root-mean-square radius of both clouds. Raises DegenerateProblemError where no double
    matrix is the inverse of J.
    """
    return _rigid(moments, core_of(moments, length_exponent), damping)


def _rigid(
    moments: ExactMoments, core: Core, damping: float, basin: Basin | None = None
) -> RigidBody:
    places = 2 * (moments.source_exponent - core.length_exponent)
    inverse = _inverse(moments.inertia, places, moments.mass**2)
    numbers = [*core.cross, *core.inertia, *inverse, core.spread, damping]
    return RigidBody(
        record=record_of(numbers, BODY),
        length_exponent=core.length_exponent,
        basin=basin,
        moments=moments,
    )


def _inverse(inertia: Matrix3[int], places: int, over: int) -> list[float]:
    """The upper triangle of the inverse of integers times 2^places, over an integer."""
    (a, b, c), (_, d, e), (_, _, f) = inertia
    first, second, third = d * f - e * e, c * e - b * f, b * e - c * d
    cofactors = (first, second, third, a * f - c * c, b * c - a * e, a * d - b * b)
    determinant = a * first + b * second + c * third
    return in_doubles([entry * over for entry in cofactors], -places, determinant)


@dataclass(frozen=True, slots=True)
class Core:
    """What the springs of a body are made of, as in its record: cross and inertia flat."""

    length_exponent: int
    cross: list[float]
    inertia: list[float]
    spread: float


def core_of(moments: ExactMoments, length_exponent: int | None = None) -> Core:
    """The numbers of a body that are sums over its points; as `rigid_body`, which adds the rest."""
    a, b, square = moments.source_exponent, moments.target_exponent, moments.mass**2
    least = min(a, b)
    spread = trace(moments.source_scatter) << 2 * (a - least)
    spread += trace(moments.target_scatter) << 2 * (b - least)
    exponent = length_exponent
    if exponent is None:
        exponent = exponent_of(spread, square, 2 * least) // 2
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = moments.inertia
    inertia = in_doubles((xx, xy, xz, yy, yz, zz), 2 * (a - exponent), square)
    require_thick(inertia)
    cross = [entry for row in moments.cross for entry in row]
    return Core(
        exponent,
        cross=in_doubles(cross, a + b - 2 * exponent, square),
        inertia=inertia,
        spread=in_doubles([spread], 2 * (least - exponent), square)[0],
    )
