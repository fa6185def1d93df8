"""Certificates of kind "isotropic": the optimal pose of a problem with springs alike in every way.

And of kind "similarity", of a problem whose scale is free: the rotation is proved in the same way.
Their theorems, and how they give the scale, are in `certreg.verify`. To produce one is to choose mu
and delta, so that an exact inequality holds.

With v = q^T K q / |q|^2 and r = K q - v q, |q| = 1, in the splitting along q and across it the
matrix (v + delta - mu) I - K + mu q q^T is [[delta, -r^T], [-r, (v + delta - mu) I - K_across]].
It is positive definite as soon as delta > |r|^2 / (gap - mu + ...), gap = l1 - l2, so that mu near
gap / 2 and delta near 4 |r|^2 / gap do. Whether they do is decided by exact elimination.

A proposed multiplier nu of the relaxation becomes a proved bound in the same way: if nu I - K is
positive definite then tr(R(q)^T C) = q^T K q / |q|^2 < nu for every rotation R(q). A solver's nu
lies on either side of the largest eigenvalue, so it is rounded outwards until that is accepted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from certreg.certificate.envelope import Certificate, enclosed
from certreg.certificate.file_parts import FilePart
from certreg.certificate.pose_claims import PoseBody, PoseClaims
from certreg.certificate.radius import RADIUS_BITS, SAFE, SeparatedRadius, isotropic_radius
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below, power_of_two
from certreg.exact.elimination import is_positive_definite
from certreg.geometry.so3 import dot, quadratic_form, squared_norm

if TYPE_CHECKING:
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.problem import RegistrationProblem


BOUND_BITS = 32  # mantissa of mu and delta: short numbers, at most 2^-31 wasted
GROWTH_BITS = 16  # delta grows by 2^16 after a refused attempt
LEAST_BITS = 8192  # delta is at least 2^-8192 of K: exponents stay in bounds
LEADING_BITS = 256  # twice those of a pose: delta, about its residual's square, is seen in them
SEPARATING_BITS = 64  # what a separation is rounded by is seen in them
ATTEMPTS = 8  # 8 * 16 bits: far beyond any rounding of the first guess

# Of a multiplier; steps are relative to the size of K.
MULTIPLIER_BITS = 40  # mantissa of nu: a short number, at most 2^-39 of it wasted
FIRST_STEP_BITS = 36  # 2^-36 = 1.5e-11, below what a solver promises
STEP_GROWTH_BITS = 2  # each step four times the last: at most four times too far
STEPS = 16  # up to 2^-6: whatever is still refused was no solution


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationClaims(PoseClaims):
    """What is claimed besides.

    unique: True claims that the optimum is one single pose; False claims nothing.
    pattern: multiplicities of the eigenvalues of K, largest first.
    """

    unique: bool
    pattern: Annotated[tuple[int, ...], range(5)]


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationBody(PoseBody):
    """A proof that a rotation is optimal: an integer quaternion, a few dyadic numbers.

    mu, delta: (v + delta - mu) I - K + mu q q^T / |q|^2 > 0 with v = q^T K q / |q|^2.
    radius: how far points may move before an optimum turns by more than an angle.
    rotation_only: of a problem without a translation.
    """

    PLACES: ClassVar = {
        "quaternion": "pose",
        "mu": "optimality.mu",
        "delta": "optimality.delta",
        "radius": "radius?",
        "rotation_only": "rotation_only?",
    }

    mu: Dyadic
    delta: Dyadic
    claims: RotationClaims
    radius: SeparatedRadius | None = None
    rotation_only: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Claims(RotationClaims):
    """What is claimed besides.

    unstable: unstable eigenvalues of the dynamics at each component; None: no claim.
    basin: True claims that a body in the certificate's `basin` state ends at the optimum.
    sdp_gap: the gap as the dual of the semidefinite relaxation alone bounds it; None: no claim.
    """

    unstable: Annotated[tuple[int, ...], range(5)] | None
    basin: bool | None = None
    sdp_gap: Dyadic | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationState(FilePart):
    """A rotation and an angular velocity (body frame, in the time unit of the springs), exactly.

    quaternion: integers (w, x, y, z). angular_velocity: three integers, the exponent of their unit.
    """

    quaternion: tuple[int, int, int, int]
    angular_velocity: tuple[int, int, int, int]

    @property
    def spin(self) -> tuple[Fraction, ...]:
        """The angular velocity in radians per time unit, body frame."""
        *velocity, exponent = self.angular_velocity
        return tuple(entry * power_of_two(exponent) for entry in velocity)


@dataclass(frozen=True, slots=True, kw_only=True)
class IsotropicBody(RotationBody):
    """A proof that a pose is optimal, and what follows.

    multiplier: nu with nu I - K > 0, the dual of the semidefinite relaxation rounded outwards.
    basin: a state of the moving body from which it must end at the optimum.
    """

    KIND: ClassVar[str] = "isotropic"
    PLACES: ClassVar = {**RotationBody.PLACES, "multiplier": "sdp.nu"}

    claims: Claims
    multiplier: Dyadic | None = None
    basin: RotationState | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityClaims(RotationClaims):
    """What is claimed besides. scale_lower, scale_upper: the scale of every optimum is between."""

    scale_lower: Dyadic
    scale_upper: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityBody(RotationBody):
    """A proof that a pose with a scale is optimal, and between which scales.

    scale: "asymmetric" or "symmetric", as of the problem.
    """

    KIND: ClassVar[str] = "similarity"

    scale: str
    claims: SimilarityClaims


def produce(
    problem: RegistrationProblem,
    objective: Isotropic,
    *,
    proposal: Fraction | None = None,
    state: RotationState | None = None,
    robustness_angle: float | None = None,
    about: dict[str, Any] | None = None,
) -> Certificate[Any] | None:
    """A certificate of the optimum of an objective; None where no attempt passed the exact test.

    proposal: a multiplier of the semidefinite relaxation, made a proved bound if it can be.
    state: where a simulation ended, included if it is proved to lie in the certified basin.
    robustness_angle: degrees; how far the points may move with every optimum within it is claimed.
    None means not proved, not disproved. With a free scale there is neither proposal nor state, and
    v >= 0: the trace of K is 0, so that the largest eigenvalue is, and the quaternion is its own to
    far more digits than it is small in.
    """
    bounds, q, scaling = _optimality(objective), objective.optimum, objective.scaling
    v, shape = objective.alignment(q), objective.classification
    if bounds is None or (scaling is not None and v < scaling.upright):
        return None
    mu, delta = bounds
    angle = dyadic_above(delta.value / mu.value, BOUND_BITS) if mu.mantissa else None
    radius = _radius(objective, angle, robustness_angle)
    rotation: dict[str, Any] = {"quaternion": q, "mu": mu, "delta": delta, "radius": radius}
    rotation["rotation_only"] = problem.motion.arguments["rotation_only"]
    claims: dict[str, Any] = {"sin2_half_angle": angle, "unique": shape.unique}
    claims["pattern"] = shape.pattern
    if scaling is not None:
        claims["scale_lower"], claims["scale_upper"] = scaling.interval(v, delta.value)
        gap = dyadic_above(scaling.gap(v, delta.value), BOUND_BITS)
        own = SimilarityClaims(gap=gap, **claims)
        body = SimilarityBody(scale=scaling.kind.value, claims=own, **rotation)
        return enclosed(problem, body, about)
    multiplier = None if proposal is None else proved_multiplier(objective, proposal)
    inside = state is not None and proves_basin(objective, state, v + delta.value - mu.value)
    own = Claims(
        gap=delta.shifted(1),
        unstable=shape.unstable,
        basin=True if inside else None,
        sdp_gap=multiplier and dyadic_above(multiplier_gap(objective, q, multiplier), BOUND_BITS),
        **claims,
    )
    basin = state if inside else None
    body = IsotropicBody(claims=own, multiplier=multiplier, basin=basin, **rotation)
    return enclosed(problem, body, about)


def _radius(
    objective: Isotropic, sin2_half_angle: Dyadic | None, degrees: float | None
) -> SeparatedRadius | None:
    """How far the points may move, from a separation of the largest eigenvalue that is proved."""
    if sin2_half_angle is None or degrees is None:
        return None
    g = dyadic_below(SAFE * objective.eigenvalue_difference(0, 1), RADIUS_BITS)
    rest = 16 * objective.size  # and g: so much along the quaternion is enough
    q = objective.optimum
    if not proves_optimality(objective, q, rest + g.value, rest, bits=SEPARATING_BITS):
        return None
    return isotropic_radius(
        objective.moments, separation=g, sin2_half_angle=sin2_half_angle.value, degrees=degrees
    )


def proves_optimality(
    objective: Isotropic,
    q: Sequence[int],
    mu: Fraction,
    delta: Fraction,
    *,
    bits: int = LEADING_BITS,
) -> bool:
    """Whether (v + delta - mu) I - K + mu q q^T / |q|^2 is positive definite, exactly.

    bits: that are looked at first. False means not proved, not disproved.
    """
    davenport, unit = objective.davenport, objective.moments.cross_unit
    norm = squared_norm(q)
    common = math.lcm(mu.denominator, delta.denominator)
    times, clear = common * unit.denominator, common * unit.numerator  # of what is over the unit
    lift, lead = (x.numerator * (times // x.denominator) for x in (mu, delta))
    diagonal = quadratic_form(davenport, q) * clear + (lead - lift) * norm
    scaled = norm * clear
    along = [lift * entry for entry in q]
    rows = [
        [along[i] * q[j] - scaled * davenport[i][j] if j >= i else 0 for j in range(4)]
        for i in range(4)
    ]
    for i, row in enumerate(rows):
        row[i] += diagonal
    return _bits_tell(rows, bits) or is_positive_definite(rows)  # it reads the upper triangle


def _bits_tell(rows: Sequence[Sequence[int]], bits: int) -> bool:
    """Whether a symmetric 4x4 matrix is seen to be positive definite by so many leading bits.

    It is 2^s B + E, 0 <= E_ij < 2^s, so |p^T E p| <= 4 2^s |p|^2: B - 4 I > 0 is enough.
    False means not seen.
    """
    s = max([row[i].bit_length() for i, row in enumerate(rows)]) - bits
    if s <= 0:
        return False
    leading = [[entry >> s for entry in row] for row in rows]
    for i, row in enumerate(leading):
        row[i] -= 4
    return is_positive_definite(leading)


def proves_basin(objective: Isotropic, state: RotationState, level: Fraction) -> bool:
    """Whether q^T K q / |q|^2 - omega^T J omega / 4 > level, exactly, and J is positive definite.

    With level = v + delta - mu above the second eigenvalue of K the state then has less energy
    than any spurious equilibrium, so that by LaSalle's theorem the damped body ends at the optimum.
    False means not proved, not disproved.
    """
    moments, (*omega, exponent) = objective.moments, state.angular_velocity
    if not (objective.classification.inertia_definite and any(state.quaternion)):
        return False
    spin = sum(a * dot(row, omega) for a, row in zip(omega, moments.inertia, strict=True))
    unit = power_of_two(moments.weight_exponent + 2 * (moments.source_exponent + exponent))
    return objective.alignment(state.quaternion) - spin * unit / (4 * moments.mass) > level


def proved_multiplier(objective: Isotropic, proposal: Fraction) -> Dyadic | None:
    """A short dyadic nu just above the proposal with nu I - K > 0, proved; in units of tr(R^T C).

    The proposal itself, rounded up, then moved out by growing steps relative to the largest entry
    of K. None means not proved, not disproved: the proposal is far too small.
    """
    start, first = max(proposal, Fraction(0)), objective.size * power_of_two(-FIRST_STEP_BITS)
    over = math.lcm(start.denominator, first.denominator)
    least = start.numerator * (over // start.denominator)
    step = first.numerator * (over // first.denominator)
    reached = objective.alignment(objective.optimum)  # tr(R^T C): nu is above, or refused
    for moved in (0, *(step << STEP_GROWTH_BITS * k for k in range(STEPS))):
        nu = dyadic_above(Fraction(least + moved, over), MULTIPLIER_BITS)
        if nu.value > reached and proves_multiplier(objective, nu.value):
            return nu
    return None


def proves_multiplier(objective: Isotropic, nu: Fraction) -> bool:
    """Whether nu I - K is positive definite, exactly: nu lies above every tr(R^T C).

    False means that nu is not above the largest eigenvalue of K.
    """
    in_units = nu / objective.moments.cross_unit
    level, over = in_units.numerator, in_units.denominator
    rows = [[-over * entry for entry in row] for row in objective.davenport]
    for k, row in enumerate(rows):
        row[k] += level
    return is_positive_definite(rows)


def multiplier_gap(objective: Isotropic, q: Sequence[int], nu: Dyadic) -> Fraction:
    """2 (nu - v), v = q^T K q / |q|^2: more than objective(R(q)) - minimum if nu is proved.

    The objective at the best translation is spread - 2 v, and the minimum exceeds spread - 2 nu.
    """
    return 2 * (nu.value - objective.alignment(q))


def _optimality(objective: Isotropic) -> tuple[Dyadic, Dyadic] | None:
    """The mu and delta that pass, delta as small as the residual of the quaternion allows."""
    q, shape = objective.optimum, objective.classification
    gap = objective.eigenvalue_difference(0, 1) if len(shape.pattern) > 1 else Fraction(0)
    none = Dyadic(mantissa=0, exponent=0)
    mu = dyadic_below(gap, BOUND_BITS).shifted(-1) if shape.unique else none
    smallest = objective.size * power_of_two(-min(4 * objective.eigenspaces.pose_bits, LEAST_BITS))
    (r, s), (g, h) = objective.squared_residual(q).as_integer_ratio(), gap.as_integer_ratio()
    first, least = max(Fraction(4 * r * h, s * g) if g else Fraction(0), smallest), mu.value
    guess = dyadic_above(first, BOUND_BITS)
    for attempt in range(ATTEMPTS):
        delta = guess.shifted(GROWTH_BITS * attempt)
        if proves_optimality(objective, q, least, delta.value):
            return mu, delta
    return None
