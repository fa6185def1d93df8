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

from certreg.certificate.envelope import Certificate, Claims, RotationState
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
from certreg.settings import CertificateSettings

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from certreg.equilibrium import Spectrum
    from certreg.problem import ExactMoments, RegistrationProblem


def produce(
    problem: RegistrationProblem,
    found: Spectrum,
    *,
    proposal: Fraction | None = None,
    state: RotationState | None = None,
    about: dict[str, Any] | None = None,
    settings: CertificateSettings | None = None,
) -> Certificate | None:
    """A certificate of the optimum of a spectrum; None where no attempt passed the exact test.

    proposal: a multiplier of the semidefinite relaxation, made a proved bound if it can be.
    state: where a simulation ended, included if it is proved to lie in the certified basin.
    None means not proved, not disproved.
    """
    settings = settings or CertificateSettings()
    bounds = _optimality(found, settings)
    if bounds is None:
        return None
    mu, delta = bounds
    angle = None
    if mu.mantissa:
        angle = dyadic_above(delta.value / mu.value, settings.bound_bits)
    classification, q = found.classification, found.quaternions[0]
    multiplier = None if proposal is None else proved_multiplier(found.moments, proposal)
    level = alignment(found.moments, q) + delta.value - mu.value
    inside = state is not None and proves_basin(found, state, level)
    return Certificate(
        n=problem.n,
        digest=problem.digest(),
        data=problem.data_bytes() if problem.n <= settings.inline_points else None,
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
            sdp_gap=None if multiplier is None else _sdp_gap(found, multiplier, settings),
        ),
        multiplier=multiplier,
        basin=state if inside else None,
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


def _sdp_gap(found: Spectrum, nu: Dyadic, settings: CertificateSettings) -> Dyadic:
    return dyadic_above(
        multiplier_gap(found.moments, found.quaternions[0], nu), settings.bound_bits
    )


def _optimality(found: Spectrum, settings: CertificateSettings) -> tuple[Dyadic, Dyadic] | None:
    """The mu and delta that pass, delta as small as the residual of the quaternion allows."""
    q = found.quaternions[0]
    gap = found.level_difference(0, 1) if len(found.groups) > 1 else Fraction(0)
    unique = found.classification.unique
    mu = dyadic_below(gap / 2, settings.bound_bits) if unique else Dyadic(mantissa=0, exponent=0)
    smallest = _scale(found.moments) * power_of_two(-min(4 * found.pose_bits, settings.least_bits))
    residual = _squared_residual(found.moments, q)
    first = max(4 * residual / gap if gap else Fraction(0), smallest)
    for attempt in range(settings.attempts):
        guess = first * power_of_two(settings.growth_bits * attempt)
        delta = dyadic_above(guess, settings.bound_bits)
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
