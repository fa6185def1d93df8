"""Fields that the documents of all results have, whatever the springs are."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.exact.dyadic import double_above, double_below
from certreg.registration.headlines import is_loose
from certreg.registration.result import UNDECIDED, Registration
from certreg.report.encoding import Document, Noted
from certreg.report.scale import scale_of
from certreg.report.uncertainty import covariance_of, more_than_noise, shift_sigmas, turn_sigmas
from certreg.results import OUT_OF_RANGE, Absent

if TYPE_CHECKING:
    from certreg.certificate.isotropic import SimilarityClaims
    from certreg.registration.fit import Fit, FitRow
    from certreg.registration.misfits import FitWarning


UNBOUNDED_SCALE = Absent("points that move so far may leave no size to the source, nor a bound")


def pose_fields(registration: Registration) -> Document:
    """The pose with its uncertainty."""
    pose = registration.pose
    return {
        "rotation": pose.rotation,
        "translation": pose.translation,
        "quaternion_wxyz": pose.quaternion_wxyz,
        "scale": scale_of(registration.pose),
        "scale_interval": scale_interval(registration),
        **_covariance(registration),
    }


def scale_interval(registration: Registration) -> tuple[float, float] | Absent:
    """Between which numbers a free scale is at every optimum, proved, rounded outwards."""
    if isinstance(scale := scale_of(registration.pose), Absent):
        return scale
    certificate, bounds = registration.certificate, registration.stated("bounds")
    if certificate is None or isinstance(bounds, Absent):
        return bounds
    claims: SimilarityClaims = certificate.body.claims
    ends = double_below(claims.scale_lower.value), double_above(claims.scale_upper.value)
    return (max(0.0, ends[0]), ends[1]) if math.isfinite(ends[1]) else OUT_OF_RANGE


def _covariance(registration: Registration) -> Document:
    """Covariance in the order (translation in the target's frame, rotation in the source's, scale).

    The scale only where it is free.
    """
    covariance = covariance_of(registration)
    if isinstance(covariance, Absent):
        names = ("covariance", "covariance_scale", "variance_factor", "uncertainty")
        return dict.fromkeys(names, covariance)
    matrix = covariance.stated("matrix")
    turned, moved = turn_sigmas(covariance), shift_sigmas(covariance)
    doubt = moved.reason if isinstance(moved, Absent) else None
    warned = more_than_noise(registration.fit)
    known = not isinstance(turned, Absent)
    sigmas = {
        "translation": moved,
        "rotation_deg": np.degrees(turned) if known else turned,
        "centre": covariance.stated("centre_sigma"),
        "loosest_turn": {
            "sigma_deg": math.degrees(covariance.loosest_sigma) if known else turned,
            "axis": covariance.loosest_axis,
        },
        **({} if covariance.scale_sigma is None else {"scale": covariance.scale_sigma}),
        "degrees_of_freedom": covariance.degrees_of_freedom,
    }
    return {
        "covariance": _noted(matrix, warned or doubt),
        "covariance_scale": "estimated" if covariance.estimated else "given",
        "variance_factor": covariance.stated("variance_factor"),
        "uncertainty": _noted(sigmas, warned),
    }


def _noted(value: Any, doubt: str | None) -> Any:
    """A value that is there, with what is to be said of it, if anything."""
    return value if doubt is None or isinstance(value, Absent) else Noted(value, doubt)


def warning_fields(warnings: Iterable[FitWarning]) -> list[Document]:
    """What is wrong with a fit."""
    return [{"code": one.code.value, "text": one.text, "remedy": one.remedy} for one in warnings]


def fit_fields(fit: Fit) -> Document:
    """Statistics of the fit: nothing of it is proved."""
    chi2 = fit.stated("chi2")
    warnings = warning_fields(fit.warnings)
    return {
        "explained": fit.stated("explained"),
        "best_scale": fit.stated("best_scale"),
        "scale_p": fit.stated("scale_p"),
        "largest_over_median_residual": fit.stated("largest_over_median_residual"),
        "worst": [_fit_row(one) for one in fit.worst],
        "chi2": chi2
        if isinstance(chi2, Absent)
        else {"value": chi2.value, "dof": chi2.dof, "p": chi2.p, "bound": chi2.bound},
        "warnings": warnings if fit.untested is None else Noted(warnings, fit.untested),
    }


def _fit_row(one: FitRow) -> Document:
    """A row with its label, if the points have labels."""
    label = {} if one.label is None else {"label": one.label}
    return {"row": one.row, **label, "residual": one.residual}


def hardly_determined(registration: Registration) -> bool | Absent:
    """Whether the noise leaves a turn open, where it is known how large it is."""
    covariance = covariance_of(registration)
    if isinstance(covariance, Absent):
        return covariance
    doubt = more_than_noise(registration.fit)
    if covariance.estimated and doubt is not None:
        return Absent(doubt)
    return is_loose(registration)


def finite(value: float | Absent) -> float | Absent:
    """A number that JSON has, or why there is none."""
    return OUT_OF_RANGE if not isinstance(value, Absent) and math.isinf(value) else value


def optimality_fields(registration: Registration) -> Document:
    """What is proved of the pose, and whether it is called certified."""
    bounds, unique = registration.stated("bounds"), registration.unique
    proved = not isinstance(bounds, Absent)
    return {
        "status": registration.status.value,
        "gap_bound": finite(bounds.gap_upper) if proved else bounds,
        "gap_share": finite(bounds.stated("share_upper")) if proved else bounds,
        "angle_bound_rad": bounds.stated("angle_upper") if proved else bounds,
        "limits": {
            "gap_share": registration.limits.max_gap,
            "angle_rad": registration.limits.max_angle,
        },
        "unique": UNDECIDED if unique is None else unique,
    }


def robustness_fields(registration: Registration) -> Document | Absent:
    """How far the points may be off, proved."""
    found = registration.stated("robustness")
    if isinstance(found, Absent):
        return found
    return {
        "angle_deg": found.angle,
        "radius_target": found.target,
        "radius_both": found.both,
        **{f"scale_{off}": within or UNBOUNDED_SCALE for off, within in found.scales.items()},
    }
