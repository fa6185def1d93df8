"""Producing a certificate: choose mu and delta, so that an exact inequality holds.

With v = q^T K q / |q|^2 and r = K q - v q, |q| = 1, in the splitting along q and across it the
matrix (v + delta - mu) I - K + mu q q^T is [[delta, -r^T], [-r, (v + delta - mu) I - K_across]].
It is positive definite as soon as delta > |r|^2 / (gap - mu + ...), gap = l1 - l2, so that mu near
gap / 2 and delta near 4 |r|^2 / gap do. Whether they do is decided by exact elimination.

A proposed multiplier nu of the relaxation becomes a proved bound in the same way: if nu I - K is
positive definite then tr(R(q)^T C) = q^T K q / |q|^2 < nu for every rotation R(q). A solver's nu
lies on either side of the largest eigenvalue, so it is rounded outwards until that is accepted.
"""

from __future__ import annotations

import hashlib
import math
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.certificate.count import CountBody
from certreg.certificate.envelope import Certificate
from certreg.certificate.isotropic import (
    Claims,
    IsotropicBody,
    RotationState,
    SimilarityBody,
    SimilarityClaims,
)
from certreg.certificate.radius import RADIUS_BITS, SAFE, SeparatedRadius, isotropic_radius
from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below, power_of_two
from certreg.exact.elimination import is_positive_definite
from certreg.geometry.so3 import dot, quadratic_form, squared_norm
from certreg.problem.moments import exact_moments

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from certreg.certificate.envelope import AnyBody_co
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.scaling import Scaling
    from certreg.problem.problem import RegistrationProblem


INLINE_POINTS = 1_000_000  # the contract: beyond, the file carries the digest only
INLINE_SPRINGS = 700_000  # of general springs, 128 bytes each in base64: files are below 1e8 bytes
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


def produce(
    problem: RegistrationProblem,
    objective: Isotropic,
    *,
    proposal: Fraction | None = None,
    state: RotationState | None = None,
    robustness_angle: float | None = None,
    about: dict[str, Any] | None = None,
) -> Certificate[IsotropicBody] | None:
    """A certificate of the optimum of an objective; None where no attempt passed the exact test.

    proposal: a multiplier of the semidefinite relaxation, made a proved bound if it can be.
    state: where a simulation ended, included if it is proved to lie in the certified basin.
    robustness_angle: degrees; how far the points may move with every optimum within it is claimed.
    None means not proved, not disproved.
    """
    bounds = _optimality(objective)
    if bounds is None:
        return None
    mu, delta = bounds
    angle = None
    if mu.mantissa:
        angle = dyadic_above(delta.value / mu.value, BOUND_BITS)
    classification, q = objective.classification, objective.optimum
    multiplier = None if proposal is None else proved_multiplier(objective, proposal)
    inside = state is not None and proves_basin(
        objective, state, objective.alignment(q) + delta.value - mu.value
    )
    body = IsotropicBody(
        quaternion=q,
        mu=mu,
        delta=delta,
        claims=Claims(
            gap=delta.scaled(1),
            sin2_half_angle=angle,
            unique=classification.unique,
            pattern=classification.pattern,
            unstable=classification.unstable,
            basin=True if inside else None,
            sdp_gap=None if multiplier is None else _sdp_gap(objective, multiplier),
        ),
        multiplier=multiplier,
        basin=state if inside else None,
        radius=_radius(objective, angle, robustness_angle),
        rotation_only=problem.rotation_only,
    )
    return enclosed(problem, body, about)


def produce_similarity(
    problem: RegistrationProblem,
    objective: Isotropic,
    scaling: Scaling,
    *,
    robustness_angle: float | None = None,
    about: dict[str, Any] | None = None,
) -> Certificate[SimilarityBody] | None:
    """The same of a problem whose scale is free; scaling: of the objective.

    The rotation is proved as without a scale, and v >= 0: the trace of K is 0, so that the largest
    eigenvalue is, and the quaternion is its own to far more digits than it is small in.
    """
    bounds, q, shape = _optimality(objective), objective.optimum, objective.classification
    v = objective.alignment(q)
    if bounds is None or (v < 0 and not scaling.symmetric):
        return None
    mu, delta = bounds
    lower, upper = scaling.interval(v, delta.value)
    angle = dyadic_above(delta.value / mu.value, BOUND_BITS) if mu.mantissa else None
    body = SimilarityBody(
        quaternion=q,
        mu=mu,
        delta=delta,
        scale=scaling.kind.value,
        claims=SimilarityClaims(
            gap=dyadic_above(scaling.gap(v, delta.value), BOUND_BITS),
            sin2_half_angle=angle,
            unique=shape.unique,
            pattern=shape.pattern,
            scale_lower=lower,
            scale_upper=upper,
        ),
        radius=_radius(objective, angle, robustness_angle),
        rotation_only=problem.rotation_only,
    )
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


def count_certificate(problem: RegistrationProblem) -> Certificate[CountBody] | None:
    """The certificate that a problem has at most four equilibria; None for infinitely many.

    None means not proved, not disproved. Raises InvalidProblemError without a translation, or with
    a free scale: that kind states a rigid motion.
    """
    if problem.motion.options:
        raise InvalidProblemError(
            f"no certificate counts equilibria with {problem.motion.options}: leave --out out",
            array="problem",
        )
    from certreg.equilibrium.torques import at_most_four  # loads FLINT, which few need

    proof = at_most_four(exact_moments(problem).cross)
    if proof is None:
        return None
    return enclosed(problem, CountBody(chart=proof.chart, modulus=proof.prime))


def enclosed(
    problem: RegistrationProblem, body: AnyBody_co, about: dict[str, Any] | None = None
) -> Certificate[AnyBody_co]:
    """The body in its envelope, with the points unless they are too many."""
    inline = None
    if problem.n <= (INLINE_POINTS if problem.factors is None else INLINE_SPRINGS):
        inline = problem.data_bytes() if problem.mapped else problem  # a file may change meanwhile
    return Certificate(
        n=problem.n,
        digest=hashlib.sha256(inline).hexdigest()
        if isinstance(inline, bytes)
        else problem.digest(),
        inline=inline,
        body=body,
        about=about or {},
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


def _sdp_gap(objective: Isotropic, nu: Dyadic) -> Dyadic:
    return dyadic_above(multiplier_gap(objective, objective.optimum, nu), BOUND_BITS)


def _optimality(objective: Isotropic) -> tuple[Dyadic, Dyadic] | None:
    """The mu and delta that pass, delta as small as the residual of the quaternion allows."""
    q, shape = objective.optimum, objective.classification
    gap = objective.eigenvalue_difference(0, 1) if len(shape.pattern) > 1 else Fraction(0)
    none = Dyadic(mantissa=0, exponent=0)
    mu = dyadic_below(gap, BOUND_BITS).scaled(-1) if shape.unique else none
    smallest = objective.size * power_of_two(-min(4 * objective.eigenspaces.pose_bits, LEAST_BITS))
    (r, s), (g, h) = objective.squared_residual(q).as_integer_ratio(), gap.as_integer_ratio()
    first, least = max(Fraction(4 * r * h, s * g) if g else Fraction(0), smallest), mu.value
    guess = dyadic_above(first, BOUND_BITS)
    for attempt in range(ATTEMPTS):
        delta = guess.scaled(GROWTH_BITS * attempt)
        if proves_optimality(objective, q, least, delta.value):
            return mu, delta
    return None
