"""Results as JSON documents: the contract that scripts rely on. Every null has its reason."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from typing import TYPE_CHECKING, cast

from certreg._loading import late
from certreg.exact.dyadic import double_above, nearest_double
from certreg.objective.structure import Structure
from certreg.registration.result import Method
from certreg.registration.simulation import SimulatedRegistration
from certreg.report.encoding import Document, Noted, encoded
from certreg.report.fields import (
    degrees,
    finite,
    fit_fields,
    hardly_determined,
    optimality_fields,
    pose_fields,
    robustness_fields,
    scale_of,
    upper_degrees,
)
from certreg.report.uncertainty import uncertainty_rows
from certreg.results import OUT_OF_RANGE, Absent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.equilibrium.equilibrium_set import Component, EquilibriumSet
    from certreg.registration import breathing as registration_breathing
    from certreg.registration.assessed import Assessment
    from certreg.registration.breathing import ScaledEquilibria, SimulatedBreathing
    from certreg.registration.enumeration import Enumeration
    from certreg.registration.result import Registration
    from certreg.report import breathing, methods, spring_document
else:
    # of a free scale
    breathing = late("certreg.report.breathing")
    methods = late("certreg.report.methods")
    registration_breathing = late("certreg.registration.breathing")
    spring_document = late("certreg.report.spring_document")


RESULT_SCHEMA = "certreg-result/1"
ASSESSMENT_SCHEMA = "certreg-assessment/1"
EQUILIBRIA_SCHEMA = "certreg-equilibria/1"
POSE_SCHEMA = "certreg-pose/1"
SIMULATION_SCHEMA = "certreg-simulation/1"
ERROR_SCHEMA = "certreg-error/1"

NO_BOUND = Absent("no bound on residuals was given (--max-residual)")
NOT_WRITTEN = Absent("nothing is written without --out")
NOT_A_BOUND = Absent("its multiplier could not be made a proved bound")
ALIKE = Absent("each pair has one weight, and a spring alike in every way")
NOT_LINEARISED = Absent("the motion with a free scale has more modes, which are not listed here")
NO_INSIDE_OUT = Absent("the symmetric scale is never below 0")
OF_EIGENVALUES = Absent("told of general springs; here the eigenvalues say as much")
WORST = 10  # residuals in a result: the whole list is one call away


def dumps(document: Document) -> str:
    """The document as JSON text, strictly: no NaN, no infinity."""
    return json.dumps(document, indent=1, allow_nan=False)


def error_document(error: Exception, code: int, **about: str) -> Document:
    """What stands in the place of a result, `certreg-error/1`; about: what it would be of."""
    told = {"kind": type(error).__name__, "message": str(error)}
    return {"schema": ERROR_SCHEMA, **about, "exit_code": code, "error": told}


def result_document(
    registration: Registration, certificate_path: str | None = None, *, notes: Sequence[str] = ()
) -> Document:
    """A registration as `certreg-result/1`; the path is where the certificate was saved.

    notes: on how the clouds were read.
    """
    own = FIELDS[registration.structure](registration)
    written: str | Absent | None = certificate_path
    if written is None:
        missing = registration.certificate is None
        written = registration.stated("bounds") if missing else NOT_WRITTEN
    return encoded(
        {
            "schema": RESULT_SCHEMA,
            "n": registration.problem.n,
            "damping": registration.problem.damping,
            "pose": pose_fields(registration),
            "objective": registration.stated("objective"),
            "rmse": registration.stated("rmse"),
            **own,
            "consensus": NO_BOUND,
            "fit": fit_fields(registration.fit),
            "residuals": _residuals(registration),
            "certificate": written,
            "digest": registration.problem.digest(),
            "theorems": () if registration.verdict is None else registration.verdict.theorems,
            "notes": tuple(notes),
            "bounds_hold_for": "the rotation of quaternion_wxyz (normalised) and the translation",
            "timings_ms": {name: 1e3 * value for name, value in registration.timings.items()},
        }
    )


def _fields(registration: Registration) -> Document:
    """What is told of springs alike in every way."""
    agreement = registration.solution.agreement
    return {
        "springs": ALIKE,
        "optimality": _optimality(registration),
        "equilibria": _scaled_equilibria(
            registration_breathing.scaled_equilibria(
                registration.solution.objective, registration.equilibria
            )
        )
        if registration.problem.scaled
        else _equilibria(registration.equilibria),
        "margin": {
            **_margin(registration.equilibria),
            "hardly_determined": hardly_determined(registration),
        },
        "robustness": robustness_fields(registration),
        "relaxation": _relaxation(registration),
        "simulation": _simulation(registration),
        "agreement": {
            "closed_form_deg": math.degrees(agreement.closed_form),
            "relaxation_deg": degrees(agreement.stated("relaxation")),
            "simulation_deg": degrees(agreement.stated("simulation")),
        },
    }


def _spring_fields(registration: Registration) -> Document:
    return spring_document.spring_fields(registration)


FIELDS = {Structure.LINEAR: _fields, Structure.QUARTIC: _spring_fields}


def pose_document(registration: Registration) -> Document:
    """The pose with its uncertainty, as `certreg-pose/1`; `assess` and `apply` read it."""
    return encoded(
        {
            "schema": POSE_SCHEMA,
            "T_target_source": registration.pose.T_target_source,
            **pose_fields(registration),
            "words": [f"{name}: {words}" for name, words in uncertainty_rows(registration)],
        }
    )


def equilibria_document(enumeration: Enumeration[EquilibriumSet]) -> Document:
    """An equilibrium set on its own; with the searches for it, if there were several."""
    return encoded({**_set(enumeration.equilibria), **methods.methods_fields(enumeration)})


def scaled_document(equilibria: ScaledEquilibria) -> Document:
    """As `equilibria_document`, of a free scale."""
    return encoded(
        {
            "schema": EQUILIBRIA_SCHEMA,
            "equilibria": _scaled_equilibria(equilibria),
            "margin": _margin(equilibria.rigid),
        }
    )


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
            "angle_deg": degrees(assessment.stated("nearest_angle")),
        }
    return encoded(
        {
            "schema": ASSESSMENT_SCHEMA,
            "objective": assessment.stated("objective"),
            "rmse": assessment.stated("rmse"),
            "gap_lower": assessment.stated("gap_lower"),
            "gap_upper": finite(assessment.stated("gap_upper")),
            "gap_share": finite(assessment.stated("gap_share")),
            "gap_parts": _gap_parts(assessment),
            "rounding_cost": finite(assessment.stated("rounding_cost")),
            "angle_upper_deg": upper_degrees(assessment.stated("angle_upper")),
            "shift_upper": finite(assessment.stated("shift_upper")),
            "angle_to_optimum_deg": degrees(assessment.stated("angle_to_optimum")),
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
                "scale": scale_of(assessment.optimum),
                "objective": assessment.stated("optimum_objective"),
                "rmse": assessment.stated("optimum_rmse"),
            },
            "fit": fit_fields(assessment.fit),
        }
    )


def _gap_parts(assessment: Assessment) -> Document | Absent:
    parts = assessment.stated("gap_parts")
    if isinstance(parts, Absent):
        return parts
    rotation, scale, translation = map(finite, parts.doubles)
    return {"scale": scale, "rotation": rotation, "translation": translation}


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


def _scaled_equilibria(equilibria: ScaledEquilibria) -> Document:
    """With the scale of each, and the states inside out; the pattern is that of all rotations."""
    breathing = equilibria.breathing
    return {
        **_equilibria(equilibria.rigid),
        "finite": equilibria.finite,
        "count": equilibria.stated("count"),
        "spurious": equilibria.stated("spurious"),
        "components": [
            {
                **_component(each.component, None),
                "eigenvalues": NOT_LINEARISED,
                "rmse": each.stated("rmse"),
                "scale": each.stated("scale"),
            }
            for each in equilibria.components
        ],
        "inside_out": NO_INSIDE_OUT
        if breathing is None
        else [
            {"kind": each.kind.value, "scale": each.stated("scale"), "stable": each.stable}
            for each in breathing.inside_out
        ],
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
    ambiguity = registration.equilibria.classification.ambiguity
    return {
        **optimality_fields(registration),
        **({} if ambiguity is None else {"ambiguity": ambiguity.value}),
        "method": Method.SPECTRAL.value,
        "growth": OF_EIGENVALUES,
    }


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
        "proved_gap": NOT_A_BOUND if gap is None else finite(double_above(gap.value)),
        "rank": relaxation.rank,
        "angle_to_pose_deg": degrees(solution.agreement.stated("relaxation")),
    }


def _simulation(registration: Registration) -> Document | Absent:
    solution = registration.solution
    trajectory = solution.trajectory
    if isinstance(trajectory, Absent):
        return trajectory
    if trajectory.scales is not None:
        return breathing.breathing_fields(cast("SimulatedBreathing", trajectory))
    certificate = solution.certificate
    end = SimulatedRegistration(
        trajectory=trajectory,
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


def _residuals(registration: Registration) -> list[Document]:
    """The worst correspondences, largest distance first."""
    worst = registration.worst_residuals(WORST)
    return [{"row": one.row, "distance": one.distance} for one in worst]


def _margin(equilibria: EquilibriumSet) -> Document:
    margin, doubt = equilibria.margin, equilibria.doubt
    return {
        "eigenvalue_gap": margin.stated("eigenvalue_gap") if doubt is None else Absent(doubt),
        "relative": margin.relative if doubt is None else Absent(doubt),
        "nearly_ambiguous": equilibria.nearly_ambiguous,
    }
