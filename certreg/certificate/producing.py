"""Producing a certificate: choose mu and delta, so that an exact inequality holds.

With v = q^T K q / |q|^2 and r = K q - v q, |q| = 1, in the splitting along q and across it the
matrix (v + delta - mu) I - K + mu q q^T is [[delta, -r^T], [-r, (v + delta - mu) I - K_across]].
It is positive definite as soon as delta > |r|^2 / (gap - mu + ...), gap = l1 - l2, so that mu near
gap / 2 and delta near 4 |r|^2 / gap do. Whether they do is decided by exact elimination.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.certificate.count import CountBody
from certreg.certificate.envelope import Certificate
from certreg.certificate.isotropic import Claims, IsotropicBody, RotationState
from certreg.certificate.multiplier import multiplier_gap, proved_multiplier
from certreg.exact import (
    Dyadic,
    dyadic_above,
    dyadic_below,
    is_positive_definite,
    power_of_two,
)
from certreg.geometry import (
    davenport_matrix,
    dot,
    quadratic_form,
    squared_norm,
)
from certreg.objective import alignment
from certreg.problem import exact_moments

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from certreg.certificate.envelope import AnyBody_co
    from certreg.equilibrium import Spectrum
    from certreg.problem import ExactMoments, RegistrationProblem

INLINE_POINTS = 1_000_000  # the contract: beyond, the file carries the digest only
BOUND_BITS = 32  # mantissa of mu and delta: short numbers, at most 2^-31 wasted
GROWTH_BITS = 16  # delta grows by 2^16 after a refused attempt
LEAST_BITS = 8192  # delta is at least 2^-8192 of the spread: exponents stay in bounds
ATTEMPTS = 8  # 8 * 16 bits: far beyond any rounding of the first guess


def produce(
    problem: RegistrationProblem,
    found: Spectrum,
    *,
    proposal: Fraction | None = None,
    state: RotationState | None = None,
    about: dict[str, Any] | None = None,
) -> Certificate[IsotropicBody] | None:
    """A certificate of the optimum of a spectrum; None where no attempt passed the exact test.

    proposal: a multiplier of the semidefinite relaxation, made a proved bound if it can be.
    state: where a simulation ended, included if it is proved to lie in the certified basin.
    None means not proved, not disproved.
    """
    bounds = _optimality(found)
    if bounds is None:
        return None
    mu, delta = bounds
    angle = None
    if mu.mantissa:
        angle = dyadic_above(delta.value / mu.value, BOUND_BITS)
    classification, q = found.classification, found.quaternions[0]
    multiplier = None if proposal is None else proved_multiplier(found.moments, proposal)
    level = alignment(found.moments, q) + delta.value - mu.value
    inside = state is not None and proves_basin(found, state, level)
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
            sdp_gap=None if multiplier is None else _sdp_gap(found, multiplier),
        ),
        multiplier=multiplier,
        basin=state if inside else None,
    )
    return _enclosed(problem, body, about)


def count_certificate(problem: RegistrationProblem) -> Certificate[CountBody] | None:
    """The certificate that a problem has at most four equilibria; None for infinitely many.

    None means not proved, not disproved.
    """
    from certreg.equilibrium import at_most_four  # loads FLINT, which few need

    proof = at_most_four(exact_moments(problem).cross)
    if proof is None:
        return None
    return _enclosed(problem, CountBody(chart=proof.chart, modulus=proof.prime))


def _enclosed(
    problem: RegistrationProblem, body: AnyBody_co, about: dict[str, Any] | None = None
) -> Certificate[AnyBody_co]:
    """The body in its envelope, with the points unless they are too many."""
    return Certificate(
        n=problem.n,
        digest=problem.digest(),
        data=problem.data_bytes() if problem.n <= INLINE_POINTS else None,
        body=body,
        about=about or {},
    )


def proves_optimality(
    moments: ExactMoments, q: Sequence[int], mu: Fraction, delta: Fraction
) -> bool:
    """Whether (v + delta - mu) I - K + mu q q^T / |q|^2 is positive definite, exactly.

    False means not proved, not disproved.
    """
    davenport = davenport_matrix(moments.cross)
    norm = squared_norm(q)
    mu_unit, delta_unit = mu / moments.cross_unit, delta / moments.cross_unit
    clear = math.lcm(mu_unit.denominator, delta_unit.denominator)
    lift, lead = int(mu_unit * clear), int(delta_unit * clear)
    diagonal = quadratic_form(davenport, q) * clear + (lead - lift) * norm
    scaled = norm * clear
    return is_positive_definite(
        [
            [
                (diagonal if i == j else 0) - scaled * davenport[i][j] + lift * q[i] * q[j]
                for j in range(4)
            ]
            for i in range(4)
        ]
    )


def proves_basin(found: Spectrum, state: RotationState, level: Fraction) -> bool:
    """Whether q^T K q / |q|^2 - omega^T J omega / 4 > level, exactly, and J is positive definite.

    With level = v + delta - mu above the second eigenvalue of K the state then has less energy
    than any spurious equilibrium, so that by LaSalle's theorem the damped body ends at the optimum.
    False means not proved, not disproved.
    """
    moments, omega = found.moments, state.angular_velocity
    if not (found.classification.inertia_definite and any(state.quaternion)):
        return False
    spin = sum(a * dot(row, omega) for a, row in zip(omega, moments.inertia, strict=True))
    unit = power_of_two(moments.weight_exponent + 2 * (moments.source_exponent + state.exponent))
    return alignment(moments, state.quaternion) - spin * unit / (4 * moments.mass) > level


def _sdp_gap(found: Spectrum, nu: Dyadic) -> Dyadic:
    return dyadic_above(multiplier_gap(found.moments, found.quaternions[0], nu), BOUND_BITS)


def _optimality(found: Spectrum) -> tuple[Dyadic, Dyadic] | None:
    """The mu and delta that pass, delta as small as the residual of the quaternion allows."""
    q = found.quaternions[0]
    gap = found.level_difference(0, 1) if len(found.groups) > 1 else Fraction(0)
    unique = found.classification.unique
    mu = dyadic_below(gap / 2, BOUND_BITS) if unique else Dyadic(mantissa=0, exponent=0)
    smallest = _scale(found.moments) * power_of_two(-min(4 * found.pose_bits, LEAST_BITS))
    residual = _squared_residual(found.moments, q)
    first = max(4 * residual / gap if gap else Fraction(0), smallest)
    for attempt in range(ATTEMPTS):
        guess = first * power_of_two(GROWTH_BITS * attempt)
        delta = dyadic_above(guess, BOUND_BITS)
        if proves_optimality(found.moments, q, mu.value, delta.value):
            return mu, delta
    return None


def _scale(moments: ExactMoments) -> Fraction:
    """An energy of the size of the problem, positive even where all points coincide."""
    return moments.spread or Fraction(1)


def _squared_residual(moments: ExactMoments, q: Sequence[int]) -> Fraction:
    """|K q - v q|^2 / |q|^2, in objective units squared."""
    davenport = davenport_matrix(moments.cross)
    norm, form = squared_norm(q), quadratic_form(davenport, q)
    image = [dot(row, q) for row in davenport]
    rest = [norm * a - form * b for a, b in zip(image, q, strict=True)]
    return Fraction(squared_norm(rest), norm**3) * moments.cross_unit**2
