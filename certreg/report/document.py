"""Results as JSON documents: the contract that scripts rely on. Every null has its reason."""

from __future__ import annotations

import json
import math
from itertools import chain
from typing import TYPE_CHECKING, Any

from certreg.results import Optimality

if TYPE_CHECKING:
    from certreg.assessment import Assessment
    from certreg.equilibria.components import Component, EquilibriumSet
    from certreg.pipeline import Registration

RESULT_SCHEMA = "certreg-result/1"
ASSESSMENT_SCHEMA = "certreg-assessment/1"
EQUILIBRIA_SCHEMA = "certreg-equilibria/1"

Document = dict[str, Any]

OUT_OF_RANGE = "no double holds the value: change the unit of length"
SINGULAR = (
    "the inertia matrix is singular (fewer than three noncollinear points): "
    "the rotational dynamics is not defined"
)
ILL_CONDITIONED = (
    "the source points are so nearly collinear, or the eigenvalues so nearly equal, that double "
    "precision cannot give the eigenvalues with their proven signs; the counts are exact"
)
NOT_UNIQUE_ANGLE = "the optimum is not unique: no angle to 'the' optimum exists"
NOT_BUILT = {
    "pose.covariance": "not computed by this version",
    "pose.covariance_scale": "not computed by this version",
    "relaxation": "the semidefinite relaxation is not part of this version",
    "simulation": "the simulation is not part of this version",
    "agreement.relaxation_deg": "the semidefinite relaxation is not part of this version",
    "agreement.simulation_deg": "the simulation is not part of this version",
}


def dumps(document: Document) -> str:
    """The document as JSON text, strictly: no NaN, no infinity."""
    return json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False)


def result_document(registration: Registration, certificate_path: str | None = None) -> Document:
    """A registration as `certreg-result/1`; the path is where the certificate was saved."""
    reasons = dict(NOT_BUILT)
    pose = registration.pose
    if registration.objective is None:
        reasons["objective"] = OUT_OF_RANGE
    if registration.rmse is None:
        reasons["rmse"] = OUT_OF_RANGE
    if certificate_path is None:
        reasons["certificate"] = (
            "not certified"
            if registration.certificate is None
            else "nothing is written without --out"
        )
    return {
        "schema": RESULT_SCHEMA,
        "n": registration.problem.n,
        "pose": {
            "rotation": pose.rotation.tolist(),
            "translation": pose.translation.tolist(),
            "quaternion_wxyz": pose.quaternion_wxyz.tolist(),
            "covariance": None,
            "covariance_scale": None,
        },
        "objective": registration.objective,
        "rmse": registration.rmse,
        "optimality": _optimality(registration, reasons),
        "equilibria": equilibria_fields(registration.equilibria, reasons),
        "margin": _margin(registration.equilibria, reasons),
        "relaxation": None,
        "simulation": None,
        "agreement": {
            "closed_form_deg": math.degrees(registration.solution.closed_form_angle),
            "relaxation_deg": None,
            "simulation_deg": None,
        },
        "certificate": certificate_path,
        "digest": registration.problem.digest(),
        "theorems": [] if registration.verdict is None else list(registration.verdict.theorems),
        "bounds_hold_for": "the rotation of quaternion_wxyz (normalised) and the translation",
        "timings_ms": {name: 1e3 * value for name, value in registration.timings.items()},
        "reasons": reasons,
    }


def equilibria_document(equilibria: EquilibriumSet) -> Document:
    """An equilibrium set on its own."""
    reasons: dict[str, str] = {}
    return {
        "schema": EQUILIBRIA_SCHEMA,
        "equilibria": equilibria_fields(equilibria, reasons),
        "margin": _margin(equilibria, reasons),
        "reasons": reasons,
    }


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
    }
    reason = assessment.words if nearest is None else OUT_OF_RANGE
    document["reasons"] = {key: reason for key, value in document.items() if value is None}
    if nearest is not None and assessment.gap_lower is None:
        document["reasons"] |= dict.fromkeys(("gap_lower", "gap_upper"), "not certified")
    return document


def equilibria_fields(equilibria: EquilibriumSet, reasons: dict[str, str]) -> Document:
    """The `equilibria` object of a result; adds the reason of each null to `reasons`."""
    classification = equilibria.classification
    if equilibria.count is None:
        reasons["equilibria.count"] = "the equilibria form a continuum: there are infinitely many"
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


def _margin(equilibria: EquilibriumSet, reasons: dict[str, str]) -> Document:
    margin = equilibria.margin
    if margin.eigenvalue_gap is None:
        reasons["margin.eigenvalue_gap"] = OUT_OF_RANGE
    return {"eigenvalue_gap": margin.eigenvalue_gap, "relative": margin.relative}


def _finite(value: float | None) -> float | None:
    return None if value is None or math.isinf(value) else value


def _degrees(angle: float | None) -> float | None:
    return None if angle is None else math.degrees(angle)
