"""The body whose scale is a state: its functions, and how it is made.

At s = 0 the inertia s^2 J is gone and the motion not defined: a run that gets there stops. A state
with s > 0 and less energy than Syy never does (derivations, breathing_confined).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.body import (
    BreathingStatus,
    ValleyBody,
    exponent_of,
    require_rank,
    require_thick,
)
from certreg.dynamics.states import NO_TURN_QUATERNION, breathing_state
from certreg.equilibrium.stability import TRANSLATION_STIFFNESS
from certreg.errors import DegenerateProblemError
from certreg.exact.dyadic import power_of_two
from certreg.exact.elimination import rank
from certreg.native.layout import BODY, BREATHING_ENERGIES, BREATHING_SAMPLE, named, symmetric
from certreg.native.loops import Integrator, Kind
from certreg.problem.exact_sums import UPPER
from certreg.problem.moments import trace
from certreg.problem.motion import Scale
from certreg.problem.support import Cell
from certreg.results import Absent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.native.layout import Records
    from certreg.problem.moments import ExactMoments

MOST_BITS_APART = 256  # sizes, scale 1 in units: 3 of its powers, 2^768, and 2^53 are doubles


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BreathingBody(ValleyBody):
    """The body whose scale is a state, on springs of one weight per pair.

    Source and target have units of length of their own, so that the scale is near 1 where the fit
    is good: 2^source_exponent and 2^length_exponent, that of the target, of places and energies.
    record: () of BODY. apart: (3,), the source's centre of mass where it was given less the
    target's. moments: all that it is made of. A state is a record BREATHING_STATE.
    """

    CELL = Cell(scale=Scale.ASYMMETRIC)
    KIND = Kind.BREATHING
    ENERGIES = BREATHING_ENERGIES
    SAMPLE = BREATHING_SAMPLE
    STATUS = BreathingStatus
    NO_RATE = Absent("no basin is certified of a body whose scale is free")

    source_exponent: int
    apart: tuple[float, ...]
    moments: ExactMoments

    @property
    def mass(self) -> Fraction:
        """M, exact, in the user's unit."""
        return self.moments.total_weight

    @property
    def unit_of_scale(self) -> float:
        """What a scale of 1 in these units is for the user: 2^(length - source exponent)."""
        return math.ldexp(1.0, self.length_exponent - self.source_exponent)

    @property
    def start(self) -> Records:
        """The state () at rest where the source was given, at its own size: scale 1."""
        return breathing_state(NO_TURN_QUATERNION, 1.0 / self.unit_of_scale, self.apart)

    def stated(self, start: Records | None, integrator: Integrator) -> Records:
        """A start (1,), copied. Raises ValueError for one without a scale above 0."""
        given = ValleyBody.stated(self, start, integrator)
        scale = float(given["scale"][0])
        if not scale > 0.0:
            raise ValueError(f"the start has the scale {scale!r}: give one above 0")
        return given

    def stiffest(self, start: Records) -> float:
        """The largest curvature of the energy beside the inertia, at scale 1.

        Of the rotation it is at most 4 |C| over the least moment of inertia; translation and scale
        have 2.
        """
        del start
        least = float(np.linalg.eigvalsh(self.inertia)[0])
        values = np.linalg.svd(self.record["cross"])[1]
        return max(TRANSLATION_STIFFNESS, 2.0 * float(values[0] + values[1]) / least)

    @property
    def size(self) -> float:
        """Sxx / M."""
        return float(np.trace(self.inertia)) / 2.0

    def rate(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The rates s' = F(s), (20,), at c, R row by row, s, v, omega, s'."""
        return self._evaluated("rate", state)[0]

    def jacobian(self, state: Records) -> NDArray[np.float64]:
        """The linearised dynamics in (c, phi, s, v, omega, s'), (14, 14)."""
        return self._evaluated("jacobian", state)[0].reshape(14, 14)

    def hessian(self, state: Records) -> NDArray[np.float64]:
        """The Hessian (4, 4) of V_p / M along q exp(phi / 2), s."""
        return self._evaluated("curvature", state)[0].reshape(4, 4)

    def kinetic(self, energies: Records) -> NDArray[np.float64]:
        """V_k / M of records of energies, that of the scale included."""
        return ValleyBody.kinetic(self, energies) + energies["scale"]

    def scales(self, states: Records) -> NDArray[np.float64]:
        """The scales of states, target over source."""
        return states["scale"] * self.unit_of_scale


def breathing_body(moments: ExactMoments, damping: float) -> BreathingBody:
    """The body of a problem whose source is not collinear, and not too unlike its target in size.

    Raises DegenerateProblemError for another one.
    """
    require_rank(rank(moments.source_scatter))
    own, other = _units(moments)
    if abs(own - other) > MOST_BITS_APART:
        raise DegenerateProblemError(
            "source and target differ too much in size for a simulation in double precision: "
            "change the unit of length of one cloud",
            value=abs(own - other),
            limit=MOST_BITS_APART,
        )
    record = _record(moments, damping, own, other)
    apart = (
        float((x - y) / power_of_two(other))
        for x, y in zip(moments.source_centroid, moments.target_centroid, strict=True)
    )
    return BreathingBody(
        record=record,
        source_exponent=own,
        length_exponent=other,
        apart=tuple(apart),
        moments=moments,
    )


def _units(moments: ExactMoments) -> tuple[int, int]:
    """Of lengths of source and target: the exponents of powers of two near their radii."""
    own, other = (
        exponent_of(trace(scatter) or 1, moments.mass**2, 2 * exponent) // 2
        for scatter, exponent in (
            (moments.source_scatter, moments.source_exponent),
            (moments.target_scatter, moments.target_exponent),
        )
    )
    return own, other


def _record(moments: ExactMoments, damping: float, own: int, other: int) -> Records:
    """The record of the body in these units; raises where no double matrix is the inverse of J."""
    square = moments.mass**2
    a, b = moments.source_exponent - own, moments.target_exponent - other
    inertia = [_over(moments.inertia[i][j], 2 * a, square) for i, j in UPPER]
    require_thick(inertia)
    inverse = np.linalg.inv(symmetric(np.array(inertia)))
    spread = Fraction(trace(moments.source_scatter)) * power_of_two(2 * a)
    spread += Fraction(trace(moments.target_scatter)) * power_of_two(2 * b)
    numbers = [
        *(_over(entry, a + b, square) for row in moments.cross for entry in row),
        *inertia,
        *(float(inverse[i, j]) for i, j in UPPER),
        float(spread / square),
        damping,
    ]
    return named(numbers, BODY)


def _over(entry: int, places: int, square: int) -> float:
    return float(Fraction(entry, square) * power_of_two(places))
