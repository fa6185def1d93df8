"""The bodies of whose optimum nothing is certified: their functions, and how they are made.

One is rigid, on springs that are matrices, made of exact sums. The other has its scale for a state.
At s = 0 its inertia s^2 J is gone and the motion not defined: a run that gets there stops. A state
with s > 0 and less energy than Syy never does (derivations, breathing_confined).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.body import (
    BreathingStatus,
    SpringStatus,
    ValleyBody,
    exponent_of,
    require_rank,
    require_thick,
)
from certreg.dynamics.states import CUBE, NO_TURN_QUATERNION, in_doubles, state_of
from certreg.equilibrium.stability import TRANSLATION_STIFFNESS
from certreg.errors import DegenerateProblemError
from certreg.exact.dyadic import power_of_two
from certreg.exact.elimination import rank
from certreg.native.layout import (
    BODY,
    BREATHING_ENERGIES,
    BREATHING_SAMPLE,
    SPRING_BODY,
    SPRING_ENERGIES,
    SPRING_SAMPLE,
    Records,
    named,
    symmetric,
)
from certreg.native.loops import Integrator, Kind
from certreg.problem.exact_sums import UPPER
from certreg.problem.moments import ExactMoments, trace
from certreg.problem.motion import Scale
from certreg.problem.support import Cell
from certreg.results import Absent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.objective.springs import Springs
    from certreg.problem.stiffness import SpringMoments


FULL = tuple(UPPER.index((min(a, b), max(a, b))) for a, b in product(range(3), repeat=2))
DIAGONAL = (0, 3, 5)  # among the six entries of a symmetric matrix
LEAST_STIFFNESS = 1e-10  # of the largest: directions that are weaker have their origin at the start


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SprungBody(ValleyBody):
    """The body on springs that are matrices.

    record: () of SPRING_BODY. origin: what c is measured from, and centre: the source's centre of
    mass, exact, in the user's unit. moments: all that it is made of, exactly. A state is a record
    QUATERNION_STATE.
    """

    CELL = Cell(springs=True)
    KIND = Kind.SPRINGS
    ENERGIES = SPRING_ENERGIES
    SAMPLE = SPRING_SAMPLE
    STATUS = SpringStatus.by_ending()
    NO_RATE = Absent("not computed for general springs")

    origin: tuple[Fraction, ...]
    centre: tuple[Fraction, ...]
    moments: SpringMoments

    @property
    def mass(self) -> Fraction:
        """M, the sum of tr(W) / 3, exact, in the user's unit."""
        traces = sum(self.moments.stiffness[k] for k in DIAGONAL)
        return traces * power_of_two(self.moments.weight_exponent) / 3

    @property
    def start(self) -> Records:
        """The state () at rest where the source was given."""
        unit = power_of_two(-self.length_exponent)
        apart = [float((a - b) * unit) for a, b in zip(self.centre, self.origin, strict=True)]
        return state_of(NO_TURN_QUATERNION, apart)

    def stiffest(self, start: Records) -> float:
        """The largest curvature of the energy beside the inertia, over some rotations."""
        hessians = [self.curvature(state_of(q))[0] for q in (*CUBE, start["q"])]
        whitening = np.eye(6)
        whitening[3:, 3:] = np.linalg.inv(np.linalg.cholesky(self.inertia))
        values = np.linalg.eigvalsh(whitening @ np.array(hessians) @ whitening.T)
        return max(float(values.max()), TRANSLATION_STIFFNESS)

    def curvature(self, state: Records) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The Hessian (6, 6) of V_p / M along c + d, q exp(phi / 2); force and torque (6,)."""
        hessian, force = self._evaluated("curvature", state)
        return hessian.reshape(6, 6), force

    def jacobian(self, state: Records) -> NDArray[np.float64]:
        """The linearised dynamics in (c, phi, v, omega), (12, 12), R turned to R exp([phi]x)."""
        return self._evaluated("jacobian", state)[0].reshape(12, 12)

    def balanced(self, q: Sequence[float] | NDArray[np.float64]) -> Records:
        """The state () at rest with a unit quaternion and the c of least energy."""
        state = state_of(q)
        _, force = self.curvature(state)
        half: Any = np.linalg.lstsq(
            2.0 * symmetric(self.record["stiffness"]), force[:3], rcond=LEAST_STIFFNESS
        )
        state["c"] = half[0]
        return state


@dataclass(frozen=True, slots=True, kw_only=True)
class CentredSums:
    """The 73 sums about the source's centre of mass and an origin of the target, in fractions.

    As in `certreg.problem.stiffness.SpringMoments`, in the user's unit. scatter: six rows
    of six.
    """

    stiffness: list[Fraction]
    lever: list[list[Fraction]]
    scatter: list[list[Fraction]]
    target: list[Fraction]
    cross: list[list[Fraction]]
    spread: Fraction


def body_on_springs(objective: Springs, damping: float) -> SprungBody:
    """The body of an objective. Raises DegenerateProblemError where the dynamics is undefined."""
    require_rank(rank(objective.mass_scatter))
    return spring_body(objective.moments, damping)


def spring_body(
    moments: SpringMoments, damping: float, *, length_exponent: int | None = None
) -> SprungBody:
    """The body of a problem of general springs whose source is not collinear.

    The unit of length is 2^length_exponent; None: the power of two next to the root-mean-square
    radius of both clouds, as the springs see it. Raises DegenerateProblemError where no double
    matrix is the inverse of J.
    """
    centre, origin = _centre(moments), _origin(moments)
    sums = centred_sums(moments, centre, origin)
    mass = sum((sums.stiffness[k] for k in DIAGONAL), Fraction(0)) / 3
    rest, spread = without_traces(sums.scatter)
    spread = (spread + sums.spread) / mass
    exponent = length_exponent
    if exponent is None:
        exponent = exponent_of(spread.numerator, spread.denominator, 0) // 2
    unit = power_of_two(-exponent)
    inertia = [float(entry * unit**2 / mass) for entry in inertia_of(sums.scatter)]
    require_thick(inertia)
    numbers = [
        *_in(sums.stiffness, 1 / mass),
        *_in([entry for row in sums.lever for entry in row], unit / mass),
        *_in([entry for row in rest for entry in row], unit**2 / mass),
        *_in(sums.target, unit / mass),
        *_in([entry for row in sums.cross for entry in row], unit**2 / mass),
        float(spread * unit**2),
        *inertia,
        *_inverse(inertia),
        damping,
    ]
    if not np.isfinite(numbers).all():
        raise DegenerateProblemError(
            "the springs are beyond double precision: bring the clouds to another unit",
            value=float(exponent),
        )
    return SprungBody(
        record=named(numbers, SPRING_BODY),
        length_exponent=exponent,
        origin=tuple(origin),
        centre=tuple(centre),
        moments=moments,
    )


def without_traces(scatter: Sequence[Sequence[Any]]) -> tuple[list[list[Any]], Any]:
    """The sums of W_ab x x^T without their traces, and what these add to the energy.

    For a rotation R, sum over a, b, j, k of B_ab,jk R_aj R_bk is the same without the parts
    delta_jk P_ab / 3 and delta_ab T_jk / 3, but for a third of the trace of both. Any numbers.
    """
    of_points = [sum(row[k] for k in DIAGONAL) for row in scatter]
    of_springs = [sum(scatter[k][j] for k in DIAGONAL) for j in range(6)]
    both = sum(of_points[k] for k in DIAGONAL)
    rest = [list(row) for row in scatter]
    for p, j in product(range(6), repeat=2):
        of_rest, of_point = int(p in DIAGONAL), int(j in DIAGONAL)
        nine = 3 * of_points[p] * of_point + 3 * of_springs[j] * of_rest
        rest[p][j] = rest[p][j] - (nine - both * (of_rest * of_point)) * Fraction(1, 9)
    return rest, both * Fraction(1, 3)


def inertia_of(scatter: Sequence[Sequence[Any]]) -> list[Any]:
    """The upper triangle of J, with masses tr W / 3, from the sums of W_ab x x^T."""
    xx, xy, xz, yy, yz, zz = (
        sum(scatter[k][j] for k in DIAGONAL) * Fraction(1, 3) for j in range(6)
    )
    return [yy + zz, -xy, -xz, xx + zz, -yz, xx + yy]


def centred_sums(
    moments: SpringMoments, centre: Sequence[Fraction], origin: Sequence[Fraction]
) -> CentredSums:
    """The sums with x - centre and y - origin in the place of x and y."""
    w, x, y = (
        power_of_two(k)
        for k in (moments.weight_exponent, moments.source_exponent, moments.target_exponent)
    )
    S = [entry * w for entry in moments.stiffness]
    A = [[entry * w * x for entry in row] for row in moments.source]
    lever = [[A[p][j] - S[p] * centre[j] for j in range(3)] for p in range(6)]
    scatter = [
        [
            moments.scatter[p][k] * w * x**2 - A[p][i] * centre[j] - centre[i] * lever[p][j]
            for k, (i, j) in enumerate(UPPER)
        ]
        for p in range(6)
    ]
    pull = [entry * w * y for entry in moments.target]
    held = [sum((S[FULL[3 * a + b]] * origin[b] for b in range(3)), Fraction(0)) for a in range(3)]
    target = [p - h for p, h in zip(pull, held, strict=True)]
    cross = [
        [
            moments.cross[a][j] * w * x * y
            - pull[a] * centre[j]
            - sum((lever[FULL[3 * a + b]][j] * origin[b] for b in range(3)), Fraction(0))
            for j in range(3)
        ]
        for a in range(3)
    ]
    rest = sum((o * (2 * p - h) for o, p, h in zip(origin, pull, held, strict=True)), Fraction(0))
    return CentredSums(
        stiffness=S,
        lever=lever,
        scatter=scatter,
        target=target,
        cross=cross,
        spread=moments.spread * w * y**2 - rest,
    )


def _centre(moments: SpringMoments) -> list[Fraction]:
    """The source's centre of mass."""
    mass = sum(moments.stiffness[k] for k in DIAGONAL)
    unit = power_of_two(moments.source_exponent)
    return [Fraction(sum(moments.source[k][j] for k in DIAGONAL), mass) * unit for j in range(3)]


def _origin(moments: SpringMoments) -> list[Fraction]:
    """Where the springs would draw the centre of mass if the body did not turn, about.

    The centre of mass plus three doubles: along a shift that no spring resists, or hardly, none.
    """
    centre = _centre(moments)
    sums = centred_sums(moments, centre, centre)
    largest = max(sums.stiffness)
    pull = max(map(abs, sums.target)) or Fraction(1)
    stiffness = symmetric(np.array(_in(sums.stiffness, 1 / largest)))
    share: Any = np.linalg.lstsq(
        stiffness, np.array(_in(sums.target, 1 / pull)), rcond=LEAST_STIFFNESS
    )
    return [
        c + Fraction(float(part)) * pull / largest for c, part in zip(centre, share[0], strict=True)
    ]


def _in(entries: Sequence[Fraction], unit: Fraction) -> list[float]:
    return [float(entry * unit) for entry in entries]


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
    STATUS = BreathingStatus.by_ending()
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
        return state_of(NO_TURN_QUATERNION, self.apart, scale=1.0 / self.unit_of_scale)

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
    inertia = in_doubles([moments.inertia[i][j] for i, j in UPPER], 2 * a, square)
    require_thick(inertia)
    cross, least = [entry for row in moments.cross for entry in row], min(a, b)
    spread = trace(moments.source_scatter) << 2 * (a - least)
    spread += trace(moments.target_scatter) << 2 * (b - least)
    numbers = [
        *in_doubles(cross, a + b, square),
        *inertia,
        *_inverse(inertia),
        *in_doubles([spread], 2 * least, square),
        damping,
    ]
    return named(numbers, BODY)


def _inverse(inertia: list[float]) -> list[float]:
    """The upper triangle of the inverse of a matrix that is given by its own."""
    inverse = np.linalg.inv(symmetric(np.array(inertia)))
    return [float(inverse[i, j]) for i, j in UPPER]
