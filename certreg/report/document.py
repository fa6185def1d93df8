"""Results as JSON documents: the contract that scripts rely on. Every null has its reason."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.exact import double_above, nearest_double
from certreg.registration import DEGREE_SLACK, SimulatedRegistration, is_loose, worst_residuals
from certreg.report.encoding import Document, Noted, encoded
from certreg.report.methods import methods_fields
from certreg.report.uncertainty import (
    covariance_of,
    more_than_noise,
    shift_sigmas,
    turn_sigmas,
    uncertainty_rows,
)
from certreg.results import OUT_OF_RANGE, Absent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.equilibrium import Component, EquilibriumSet
    from certreg.registration import Assessment, Enumeration, Fit, FitRow, Registration

RESULT_SCHEMA = "certreg-result/1"
ASSESSMENT_SCHEMA = "certreg-assessment/1"
EQUILIBRIA_SCHEMA = "certreg-equilibria/1"
POSE_SCHEMA = "certreg-pose/1"
SIMULATION_SCHEMA = "certreg-simulation/1"

NOT_WRITTEN = Absent("nothing is written without --out")
NOT_A_BOUND = Absent("its multiplier could not be made a proved bound")
WORST = 10  # residuals in a result: the whole list is one call away


def dumps(document: Document) -> str:
    """The document as JSON text, strictly: no NaN, no infinity."""
    return json.dumps(document, indent=1, allow_nan=False)


def result_document(
    registration: Registration, certificate_path: str | None = None, *, notes: Sequence[str] = ()
) -> Document:
    """A registration as `certreg-result/1`; the path is where the certificate was saved.

    notes: on how the clouds were read.
    """
    agreement = registration.solution.agreement
    written: str | Absent | None = certificate_path
    if written is None:
        missing = registration.certificate is None
        written = registration.solution.stated("certificate") if missing else NOT_WRITTEN
    return encoded(
        {
            "schema": RESULT_SCHEMA,
            "n": registration.problem.n,
            "damping": registration.problem.damping,
            "pose": _pose(registration),
            "objective": registration.stated("objective"),
            "rmse": registration.stated("rmse"),
            "optimality": _optimality(registration),
            "equilibria": _equilibria(registration.equilibria),
            "margin": {
                **_margin(registration.equilibria),
                "hardly_determined": _hardly_determined(registration),
            },
            "robustness": _robustness(registration),
            "relaxation": _relaxation(registration),
            "simulation": _simulation(registration),
            "agreement": {
                "closed_form_deg": math.degrees(agreement.closed_form),
                "relaxation_deg": _degrees(agreement.stated("relaxation")),
                "simulation_deg": _degrees(agreement.stated("simulation")),
            },
            "fit": _fit(registration.fit),
            "residuals": _residuals(registration),
            "certificate": written,
            "digest": registration.problem.digest(),
            "theorems": () if registration.verdict is None else registration.verdict.theorems,
            "notes": tuple(notes),
            "bounds_hold_for": "the rotation of quaternion_wxyz (normalised) and the translation",
            "timings_ms": {name: 1e3 * value for name, value in registration.timings.items()},
        }
    )


def pose_document(registration: Registration) -> Document:
    """The pose with its uncertainty, as `certreg-pose/1`; `assess` and `apply` read it."""
    return encoded(
        {
            "schema": POSE_SCHEMA,
            "T_target_source": registration.pose.T_target_source,
            **_pose(registration),
            "words": [f"{name}: {words}" for name, words in uncertainty_rows(registration)],
        }
    )


def equilibria_document(enumeration: Enumeration) -> Document:
    """An equilibrium set on its own; with the searches for it, if there were several."""
    return encoded({**_set(enumeration.equilibria), **methods_fields(enumeration)})


def set_document(equilibria: EquilibriumSet) -> Document:
    """As `equilibria_document`, without searches."""
    return encoded(_set(equilibria))


def _set(equilibria: EquilibriumSet) -> Document:
    return {
        "schema": EQUILIBRIA_SCHEMA,
        "equilibria": _equilibria(equilibria),
        "margin": _margin(equilibria),
    }


def simulation_document(simulated: SimulatedRegistration) -> Document:
    """A simulation on its own, as `certreg-simulation/1`."""
    return encoded({"schema": SIMULATION_SCHEMA, **_simulation_fields(simulated)})


def assessment_document(assessment: Assessment) -> Document:
    """An assessment as `certreg-assessment/1`."""
    nearest = assessment.stated("nearest_index")
    if not isinstance(nearest, Absent):
        nearest = {
            "morse_index": nearest,
            "angle_deg": _degrees(assessment.stated("nearest_angle")),
        }
    return encoded(
        {
            "schema": ASSESSMENT_SCHEMA,
            "objective": assessment.stated("objective"),
            "rmse": assessment.stated("rmse"),
            "gap_lower": assessment.stated("gap_lower"),
            "gap_upper": _finite(assessment.stated("gap_upper")),
            "gap_share": _finite(assessment.stated("gap_share")),
            "rounding_cost": _finite(assessment.stated("rounding_cost")),
            "angle_upper_deg": _degrees_above(assessment.stated("angle_upper")),
            "angle_to_optimum_deg": _degrees(assessment.stated("angle_to_optimum")),
            "nearest": nearest,
            "sigma_distance": _sigma_distance(assessment),
            "verdict": assessment.verdict.value,
            "headline": assessment.headline,
            "words": assessment.words,
            "hint": assessment.stated("slip") if assessment.slip is None else assessment.hint,
            "slip": _slip(assessment),
            "optimum": {
                "rotation": assessment.optimum.rotation,
                "translation": assessment.optimum.translation,
                "quaternion_wxyz": assessment.optimum.quaternion_wxyz,
                "objective": assessment.stated("optimum_objective"),
                "rmse": assessment.stated("optimum_rmse"),
            },
            "fit": _fit(assessment.fit),
        }
    )


def _sigma_distance(assessment: Assessment) -> Document | Absent:
    distance = assessment.stated("sigma_distance")
    if isinstance(distance, Absent):
        return distance
    return {"value": distance.value, "dof": distance.dof, "p": distance.p}


def _slip(assessment: Assessment) -> Document | Absent:
    slip = assessment.stated("slip")
    if isinstance(slip, Absent):
        return slip
    return {"code": slip.code.value, "verdict": slip.verdict.value, "words": slip.words}


def _equilibria(equilibria: EquilibriumSet) -> Document:
    complete, doubt, known = equilibria.complete, equilibria.doubt, equilibria.classification
    pattern, finite = known.pattern, known.finite
    count, spurious = equilibria.stated("count"), equilibria.stated("spurious")
    if doubt is not None:
        count = spurious = Absent(doubt)
    return {
        "pattern": pattern if doubt is None else Noted(pattern, doubt),
        "finite": finite if doubt is None else Noted(finite, doubt),
        "count": count,
        "spurious": spurious,
        "guarantee": equilibria.guarantee.label,
        "complete": complete if doubt is None else Noted(complete, doubt),
        "components": [_component(component, doubt) for component in equilibria.components],
    }


def _component(component: Component, doubt: str | None) -> Document:
    """What follows from the list being complete is not told where that is in doubt."""
    optimal, index = component.optimal, component.morse_index
    unstable = component.stated("unstable_eigenvalues")
    return {
        "kind": component.kind.value,
        "dimension": component.kind.dimension,
        "basis": component.basis,
        "morse_index": index if doubt is None else Absent(doubt),
        "unstable_eigenvalues": unstable if doubt is None else Absent(doubt),
        "eigenvalues": component.stated("eigenvalues"),
        "witness": component.stated("witness"),
        "optimal": optimal if doubt is None else Noted(optimal, doubt),
        "energy": component.stated("energy"),
        "rmse": component.stated("rmse"),
        "rotation": component.rotation,
        "quaternion_wxyz": component.quaternion_wxyz,
        "angle_to_optimum_deg": math.degrees(component.angle_to_optimum),
    }


def _optimality(registration: Registration) -> Document:
    bounds, classification = registration.stated("bounds"), registration.equilibria.classification
    proved = not isinstance(bounds, Absent)
    document: Document = {
        "status": registration.status.value,
        "gap_bound": _finite(bounds.gap_upper) if proved else bounds,
        "gap_share": _finite(bounds.stated("share_upper")) if proved else bounds,
        "angle_bound_rad": bounds.stated("angle_upper") if proved else bounds,
        "limits": {
            "gap_share": registration.limits.max_gap,
            "angle_rad": registration.limits.max_angle,
        },
        "unique": classification.unique,
    }
    if classification.ambiguity is not None:
        document["ambiguity"] = classification.ambiguity.value
    return document


def _robustness(registration: Registration) -> Document | Absent:
    found = registration.stated("robustness")
    if isinstance(found, Absent):
        return found
    return {
        "angle_deg": found.angle,
        "radius_target": found.target,
        "radius_both": found.both,
    }


def _pose(registration: Registration) -> Document:
    pose = registration.pose
    return {
        "rotation": pose.rotation,
        "translation": pose.translation,
        "quaternion_wxyz": pose.quaternion_wxyz,
        **_covariance(registration),
    }


def _covariance(registration: Registration) -> Document:
    """Covariance in the order (translation in the target's frame, rotation in the source's)."""
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
        "centre": covariance.centre_sigma,
        "loosest_turn": {
            "sigma_deg": math.degrees(covariance.loosest_sigma) if known else turned,
            "axis": covariance.loosest_axis,
        },
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


def _relaxation(registration: Registration) -> Document | Absent:
    solution = registration.solution
    relaxation, certificate = solution.relaxation, solution.certificate
    if isinstance(relaxation, Absent) or relaxation.value is None:
        return relaxation if isinstance(relaxation, Absent) else Absent(relaxation.status.value)
    value = nearest_double(Fraction(relaxation.value) * relaxation.unit)
    gap = None if certificate is None else certificate.body.claims.sdp_gap
    return {
        "solver": relaxation.solver.split()[0].upper(),
        "form": relaxation.form.value,
        "status": relaxation.solver_word,
        "value": OUT_OF_RANGE if value is None else value,
        "proved_gap": NOT_A_BOUND if gap is None else _finite(double_above(gap.value)),
        "rank": relaxation.rank,
        "angle_to_pose_deg": _degrees(solution.agreement.stated("relaxation")),
    }


def _simulation(registration: Registration) -> Document | Absent:
    solution = registration.solution
    trajectory = solution.trajectory
    if isinstance(trajectory, Absent):
        return trajectory
    certificate = solution.certificate
    end = SimulatedRegistration(
        trajectory=trajectory,
        energy_unit=solution.energy_unit,
        angle_to_optimum=solution.agreement.simulation or 0.0,
        in_certified_basin=certificate is not None and bool(certificate.body.claims.basin),
        unique=registration.equilibria.classification.unique,
    )
    return _simulation_fields(end)


def _simulation_fields(simulated: SimulatedRegistration) -> Document:
    trajectory = simulated.trajectory
    initial, final = simulated.energies
    return {
        "integrator": trajectory.integrator.value,
        "status": trajectory.status.value,
        "step": trajectory.step,
        "steps": trajectory.steps,
        "converged": trajectory.converged,
        "in_certified_basin": simulated.in_certified_basin,
        "escapes": trajectory.escapes,
        "residual": trajectory.speed,
        "predicted_rate": trajectory.stated("predicted_rate"),
        "decay_rate": trajectory.stated("decay_rate"),
        "angle_to_pose_deg": math.degrees(simulated.angle_to_optimum),
        "energy": {"initial": initial, "final": final},
    }


def _fit(fit: Fit) -> Document:
    """Statistics of the fit: nothing of it is proved."""
    chi2 = fit.stated("chi2")
    return {
        "explained": fit.stated("explained"),
        "best_scale": fit.stated("best_scale"),
        "scale_p": fit.stated("scale_p"),
        "largest_over_median_residual": fit.stated("largest_over_median_residual"),
        "worst": [_fit_row(one) for one in fit.worst],
        "chi2": chi2
        if isinstance(chi2, Absent)
        else {"value": chi2.value, "dof": chi2.dof, "p": chi2.p, "bound": chi2.bound},
        "warnings": [
            {"code": one.code.value, "text": one.text, "remedy": one.remedy} for one in fit.warnings
        ],
    }


def _fit_row(one: FitRow) -> Document:
    """A row with its label, if the points have labels."""
    label = {} if one.label is None else {"label": one.label}
    return {"row": one.row, **label, "residual": one.residual}


def _residuals(registration: Registration) -> list[Document]:
    """The worst correspondences, largest distance first."""
    worst = worst_residuals(registration.problem, registration.pose, WORST)
    return [{"row": one.row, "distance": one.distance} for one in worst]


def _margin(equilibria: EquilibriumSet) -> Document:
    margin, doubt = equilibria.margin, equilibria.doubt
    return {
        "eigenvalue_gap": margin.stated("eigenvalue_gap") if doubt is None else Absent(doubt),
        "relative": margin.relative if doubt is None else Absent(doubt),
        "nearly_ambiguous": equilibria.nearly_ambiguous,
    }


def _hardly_determined(registration: Registration) -> bool | Absent:
    """Whether the noise leaves a turn open, where it is known how large it is."""
    covariance = covariance_of(registration)
    if isinstance(covariance, Absent):
        return covariance
    doubt = more_than_noise(registration.fit)
    if covariance.estimated and doubt is not None:
        return Absent(doubt)
    return is_loose(registration)


def _finite(value: float | Absent) -> float | Absent:
    return OUT_OF_RANGE if not isinstance(value, Absent) and math.isinf(value) else value


def _degrees_above(angle: float | Absent) -> float | Absent:
    """An upper bound in degrees, that stays one."""
    return angle if isinstance(angle, Absent) else math.degrees(angle) * DEGREE_SLACK


def _degrees(angle: float | Absent) -> float | Absent:
    return angle if isinstance(angle, Absent) else math.degrees(angle)
