"""Results as JSON documents: the contract that scripts rely on. Every null has its reason."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING, Any

from certreg.exact import double_above, nearest_double
from certreg.registration import SimulatedRegistration, worst_residuals
from certreg.report.methods import methods_fields
from certreg.results import Absent, Optimality

if TYPE_CHECKING:
    from certreg.equilibrium import Component, EquilibriumSet
    from certreg.registration import Assessment, Enumeration, Registration

RESULT_SCHEMA = "certreg-result/1"
ASSESSMENT_SCHEMA = "certreg-assessment/1"
EQUILIBRIA_SCHEMA = "certreg-equilibria/1"
SIMULATION_SCHEMA = "certreg-simulation/1"

Document = dict[str, Any]

OUT_OF_RANGE = "no double holds the value: change the unit of length"
NOT_UNIQUE_RATE = "the optimum is not unique: no rate belongs to it"
TOO_FEW_SAMPLES = "too few logged samples lie between the start and rest"
SINGULAR = (
    "the inertia matrix is singular (fewer than three noncollinear points): "
    "the rotational dynamics is not defined"
)
ILL_CONDITIONED = (
    "the source points are so nearly collinear, or the eigenvalues so nearly equal, that double "
    "precision cannot give the eigenvalues with their proven signs; the counts are exact"
)
NOT_UNIQUE_ANGLE = "the optimum is not unique: no angle to 'the' optimum exists"
WORST = 10  # residuals in a result: the whole list is one call away
NO_DEGREES = "fewer than three points with weight leave no degree of freedom for the noise"


def dumps(document: Document) -> str:
    """The document as JSON text, strictly: no NaN, no infinity."""
    return json.dumps(document, indent=1, allow_nan=False)


def result_document(registration: Registration, certificate_path: str | None = None) -> Document:
    """A registration as `certreg-result/1`; the path is where the certificate was saved."""
    reasons: dict[str, str] = {}
    pose, agreement = registration.pose, registration.solution.agreement
    if registration.objective is None:
        reasons["objective"] = OUT_OF_RANGE
    if registration.rmse is None:
        reasons["rmse"] = OUT_OF_RANGE
    if certificate_path is None:
        written = registration.certificate is not None
        reasons["certificate"] = "nothing is written without --out" if written else "not certified"
    return {
        "schema": RESULT_SCHEMA,
        "n": registration.problem.n,
        "damping": registration.problem.damping,
        "pose": {
            "rotation": pose.rotation.tolist(),
            "translation": pose.translation.tolist(),
            "quaternion_wxyz": pose.quaternion_wxyz.tolist(),
            **_covariance(registration, reasons),
        },
        "objective": registration.objective,
        "rmse": registration.rmse,
        "optimality": _optimality(registration, reasons),
        "equilibria": equilibria_fields(registration.equilibria, reasons),
        "margin": _margin(registration.equilibria, reasons),
        "relaxation": _relaxation(registration, reasons),
        "simulation": _simulation(registration, reasons),
        "agreement": {
            "closed_form_deg": math.degrees(agreement.closed_form),
            "relaxation_deg": _degrees(agreement.relaxation),
            "simulation_deg": _degrees(agreement.simulation),
        },
        "residuals": _residuals(registration),
        "certificate": certificate_path,
        "digest": registration.problem.digest(),
        "theorems": [] if registration.verdict is None else list(registration.verdict.theorems),
        "bounds_hold_for": "the rotation of quaternion_wxyz (normalised) and the translation",
        "timings_ms": {name: 1e3 * value for name, value in registration.timings.items()},
        "reasons": reasons,
    }


def equilibria_document(enumeration: Enumeration) -> Document:
    """An equilibrium set on its own; with the searches for it, if there were several."""
    reasons: dict[str, str] = {}
    return {
        "schema": EQUILIBRIA_SCHEMA,
        "equilibria": equilibria_fields(enumeration.equilibria, reasons),
        "margin": _margin(enumeration.equilibria, reasons),
        **methods_fields(enumeration, reasons),
        "reasons": reasons,
    }


def simulation_document(simulated: SimulatedRegistration) -> Document:
    """A simulation on its own, as `certreg-simulation/1`."""
    reasons: dict[str, str] = {}
    fields = _simulation_fields(simulated, "", reasons)
    return {"schema": SIMULATION_SCHEMA, **fields, "reasons": reasons}


def assessment_document(assessment: Assessment) -> Document:
    """An assessment as `certreg-assessment/1`."""
    nearest = None
    if assessment.nearest_index is not None and assessment.nearest_angle is not None:
        nearest = {
            "morse_index": assessment.nearest_index,
            "angle_deg": math.degrees(assessment.nearest_angle),
        }
    document: Document = {
        "schema": ASSESSMENT_SCHEMA,
        "objective": assessment.objective,
        "rmse": assessment.rmse,
        "gap_lower": assessment.gap_lower,
        "gap_upper": _finite(assessment.gap_upper),
        "angle_to_optimum_deg": _degrees(assessment.angle_to_optimum),
        "nearest": nearest,
        "verdict": assessment.verdict.value,
        "words": assessment.words,
        "hint": assessment.hint,
    }
    reason = assessment.words if nearest is None else OUT_OF_RANGE
    document["reasons"] = {key: reason for key, value in document.items() if value is None}
    if nearest is not None and assessment.gap_lower is None:
        document["reasons"] |= dict.fromkeys(("gap_lower", "gap_upper"), "not certified")
    if assessment.hint is None:
        document["reasons"]["hint"] = "no usual mistake explains the verdict"
    return document


def equilibria_fields(equilibria: EquilibriumSet, reasons: dict[str, str]) -> Document:
    """The `equilibria` object of a result; adds the reason of each null to `reasons`."""
    classification = equilibria.classification
    if equilibria.count is None:
        reasons["equilibria.count"] = "the equilibria form a continuum: there are infinitely many"
    if equilibria.doubt is not None:
        reasons["equilibria.complete"] = equilibria.doubt
    if classification.spurious is None:
        reasons["equilibria.spurious"] = "there are infinitely many spurious equilibria"
    return {
        "pattern": list(classification.pattern),
        "finite": classification.finite,
        "count": equilibria.count,
        "spurious": classification.spurious,
        "guarantee": equilibria.guarantee.label,
        "complete": equilibria.complete,
        "components": [
            _component(component, f"equilibria.components[{i}]", reasons)
            for i, component in enumerate(equilibria.components)
        ],
    }


def _component(component: Component, place: str, reasons: dict[str, str]) -> Document:
    unstable, eigenvalues = component.unstable_eigenvalues, component.eigenvalues
    spectrum = None if eigenvalues is None else [[s.real, s.imag] for s in eigenvalues.tolist()]
    if spectrum is not None and not all(map(math.isfinite, chain(*spectrum))):
        spectrum = None
        reasons[f"{place}.eigenvalues"] = "no double holds them: change the unit, or the damping"
    if unstable is None:
        reasons[f"{place}.unstable_eigenvalues"] = SINGULAR
    if eigenvalues is None:
        reasons[f"{place}.eigenvalues"] = SINGULAR if unstable is None else ILL_CONDITIONED
    if component.witness is None:
        reasons[f"{place}.witness"] = "optimal: the energy falls in no direction"
    for name, value in (("energy", component.energy), ("rmse", component.rmse)):
        if value is None:
            reasons[f"{place}.{name}"] = OUT_OF_RANGE
    return {
        "kind": component.kind.value,
        "dimension": component.kind.dimension,
        "basis": component.basis.tolist(),
        "morse_index": component.morse_index,
        "unstable_eigenvalues": unstable,
        "eigenvalues": spectrum,
        "witness": None if component.witness is None else component.witness.tolist(),
        "optimal": component.optimal,
        "energy": component.energy,
        "rmse": component.rmse,
        "rotation": component.rotation.tolist(),
        "quaternion_wxyz": component.quaternion_wxyz.tolist(),
        "angle_to_optimum_deg": math.degrees(component.angle_to_optimum),
    }


def _optimality(registration: Registration, reasons: dict[str, str]) -> Document:
    bounds, classification = registration.bounds, registration.equilibria.classification
    gap = None if bounds is None else _finite(bounds.gap_upper)
    angle = None if bounds is None else bounds.angle_upper
    if gap is None:
        reasons["optimality.gap_bound"] = OUT_OF_RANGE if bounds else "not certified"
    if angle is None:
        certified = registration.status is not Optimality.NOT_CERTIFIED
        reasons["optimality.angle_bound_rad"] = NOT_UNIQUE_ANGLE if certified else "not certified"
    document: Document = {
        "status": registration.status.value,
        "gap_bound": gap,
        "angle_bound_rad": angle,
        "unique": classification.unique,
    }
    if classification.ambiguity is not None:
        document["ambiguity"] = classification.ambiguity.value
    return document


def _covariance(registration: Registration, reasons: dict[str, str]) -> Document:
    """Covariance in the order (translation in the target's frame, rotation in the source's)."""
    covariance = registration.solution.covariance
    if covariance is None:
        why = "the optimum is not unique"
        if registration.equilibria.classification.unique:
            why = (
                OUT_OF_RANGE
                if registration.problem.noise_given
                else f"{OUT_OF_RANGE}, or {NO_DEGREES}"
            )
        reasons |= dict.fromkeys(("pose.covariance", "pose.covariance_scale"), why)
        reasons["pose.variance_factor"] = why
        return {"covariance": None, "covariance_scale": None, "variance_factor": None}
    if covariance.variance_factor is None:
        reasons["pose.variance_factor"] = f"{OUT_OF_RANGE}, or {NO_DEGREES}"
    return {
        "covariance": covariance.matrix.tolist(),
        "covariance_scale": "estimated" if covariance.estimated else "given",
        "variance_factor": covariance.variance_factor,
    }


def _relaxation(registration: Registration, reasons: dict[str, str]) -> Document | None:
    solution = registration.solution
    relaxation, certificate = solution.relaxation, solution.certificate
    if isinstance(relaxation, Absent) or relaxation.value is None:
        why = relaxation.reason if isinstance(relaxation, Absent) else relaxation.status.value
        reasons |= dict.fromkeys(("relaxation", "agreement.relaxation_deg"), why)
        return None
    value = nearest_double(Fraction(relaxation.value) * relaxation.unit)
    gap = None if certificate is None else certificate.body.claims.sdp_gap
    proved = None if gap is None else _finite(double_above(gap.value))
    if value is None:
        reasons["relaxation.value"] = OUT_OF_RANGE
    if proved is None:
        reasons["relaxation.proved_gap"] = (
            "its multiplier could not be made a proved bound" if gap is None else OUT_OF_RANGE
        )
    return {
        "solver": relaxation.solver.split()[0].upper(),
        "form": relaxation.form.value,
        "status": relaxation.solver_word,
        "value": value,
        "proved_gap": proved,
        "rank": relaxation.rank,
        "angle_to_pose_deg": _degrees(solution.agreement.relaxation),
    }


def _simulation(registration: Registration, reasons: dict[str, str]) -> Document | None:
    solution = registration.solution
    trajectory = solution.trajectory
    if isinstance(trajectory, Absent):
        names = ("simulation", "agreement.simulation_deg")
        reasons |= dict.fromkeys(names, trajectory.reason)
        return None
    certificate = solution.certificate
    end = SimulatedRegistration(
        trajectory=trajectory,
        energy_unit=solution.energy_unit,
        angle_to_optimum=solution.agreement.simulation or 0.0,
        in_certified_basin=certificate is not None and bool(certificate.body.claims.basin),
    )
    return _simulation_fields(end, "simulation.", reasons)


def _simulation_fields(
    simulated: SimulatedRegistration, place: str, reasons: dict[str, str]
) -> Document:
    """The `simulation` object of a result; adds the reason of each null to `reasons`."""
    trajectory = simulated.trajectory
    energies = [
        nearest_double(Fraction(value) * simulated.energy_unit)
        for value in (trajectory.potential + trajectory.kinetic)[[0, -1]].tolist()
    ]
    for name, value in zip(("initial", "final"), energies, strict=True):
        if value is None:
            reasons[f"{place}energy.{name}"] = OUT_OF_RANGE
    if trajectory.predicted_rate is None:
        reasons |= dict.fromkeys((f"{place}predicted_rate", f"{place}decay_rate"), NOT_UNIQUE_RATE)
    elif trajectory.decay_rate is None:
        reasons[f"{place}decay_rate"] = TOO_FEW_SAMPLES
    return {
        "integrator": trajectory.integrator.value,
        "status": trajectory.status.value,
        "step": trajectory.step,
        "steps": trajectory.steps,
        "converged": trajectory.converged,
        "in_certified_basin": simulated.in_certified_basin,
        "escapes": trajectory.escapes,
        "residual": trajectory.speed,
        "predicted_rate": trajectory.predicted_rate,
        "decay_rate": trajectory.decay_rate,
        "angle_to_pose_deg": math.degrees(simulated.angle_to_optimum),
        "energy": {"initial": energies[0], "final": energies[1]},
    }


def _residuals(registration: Registration) -> list[Document]:
    """The worst correspondences, largest distance first."""
    worst = worst_residuals(registration.problem, registration.pose, WORST)
    return [{"row": one.row, "distance": one.distance} for one in worst]


def _margin(equilibria: EquilibriumSet, reasons: dict[str, str]) -> Document:
    margin = equilibria.margin
    if margin.eigenvalue_gap is None:
        reasons["margin.eigenvalue_gap"] = OUT_OF_RANGE
    return {
        "eigenvalue_gap": margin.eigenvalue_gap,
        "relative": margin.relative,
        "nearly_ambiguous": equilibria.nearly_ambiguous,
    }


def _finite(value: float | None) -> float | None:
    return None if value is None or math.isinf(value) else value


def _degrees(angle: float | None) -> float | None:
    return None if angle is None else math.degrees(angle)
