"""Results as JSON documents: the contract that scripts rely on. Every null has its reason."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.exact.dyadic import double_above, double_below, nearest_double
from certreg.registration.quartic import NOT_LISTED, NOT_SIMULATED, QuarticSolution
from certreg.registration.result import UNDECIDED, Method, Registration
from certreg.report.encoding import Document, encoded
from certreg.report.equilibria import rests_beside
from certreg.report.equilibrium_fields import NO_EIGENVALUES, margin_fields
from certreg.report.fields import (
    finite,
    fit_fields,
    hardly_determined,
    optimality_fields,
    pose_fields,
    robustness_fields,
)
from certreg.report.parts import listed, sprung
from certreg.report.simulation import simulation_fields
from certreg.report.uncertainty import uncertainty_rows
from certreg.results import OUT_OF_RANGE, Absent, mapped

if TYPE_CHECKING:
    from certreg.certificate.squares import SpringsSosBody


RESULT_SCHEMA = "certreg-result/1"
POSE_SCHEMA = "certreg-pose/1"
ERROR_SCHEMA = "certreg-error/1"

NO_BOUND = Absent("no bound on residuals was given (--max-residual)")
NOT_WRITTEN = Absent("nothing is written without --out")
NOT_A_BOUND = Absent("its multiplier could not be made a proved bound")
OF_EIGENVALUES = Absent("told of general springs; here the eigenvalues say as much")
FORM = "rotation-10"
NO_CLOSED_FORM = Absent("general springs have no closed form")
NO_PROOF = Absent("not certified")
NO_BOUND_OF_IT = Absent(
    "the certificate uses what the relaxation proposes, and proves its own bound"
)
ANGLES = ("closed_form_deg", "relaxation_deg", "simulation_deg")
MARGIN = ("eigenvalue_gap", "relative", "nearly_ambiguous")
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
            **_parts(registration),
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


def _parts(registration: Registration) -> Document:
    """What is told of springs, proof, equilibria and methods; what is not there says why."""
    own, springs = listed(registration), sprung(registration)
    parts: Document = {
        "springs": registration.solution.freedom if springs is None else _springs(springs),
        "optimality": _optimality(registration),
        "equilibria": NOT_LISTED,
        "margin": dict.fromkeys(MARGIN, NO_EIGENVALUES),
        "robustness": robustness_fields(registration),
        "relaxation": NO_PROOF if springs is None else _relaxation_of_springs(springs),
        "simulation": NOT_SIMULATED,
        "agreement": dict.fromkeys(ANGLES, NOT_SIMULATED),
    }
    if springs is not None:
        turned = mapped(springs.solution.angle_to_relaxation, math.degrees)
        parts["agreement"] |= {"closed_form_deg": NO_CLOSED_FORM, "relaxation_deg": turned}
    if own is not None:
        angles = own.solution.agreement
        parts |= {
            "equilibria": rests_beside(own).fields(),
            "margin": margin_fields(own.equilibria),
            "relaxation": _relaxation(own),
            "simulation": simulation_fields(own),
            "agreement": {
                "closed_form_deg": math.degrees(angles.closed_form),
                "relaxation_deg": mapped(angles.stated("relaxation"), math.degrees),
                "simulation_deg": mapped(angles.stated("simulation"), math.degrees),
            },
        }
    parts["margin"] = {**parts["margin"], "hardly_determined": hardly_determined(registration)}
    return parts


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


def _optimality(registration: Registration) -> Document:
    equilibria, springs = registration.equilibria, sprung(registration)
    fields = optimality_fields(registration)
    if equilibria is not None and (ambiguity := equilibria.classification.ambiguity) is not None:
        fields["ambiguity"] = ambiguity.value
    if springs is None:
        return {**fields, "method": Method.SPECTRAL.value, "growth": OF_EIGENVALUES}
    rotation, certificate = springs.solution.unique_rotation, springs.solution.certificate
    return {
        **fields,
        "unique_rotation": UNDECIDED if rotation is None else rotation,
        "method": NO_PROOF if springs.method is None else springs.method.value,
        "growth": NO_PROOF if certificate is None else _growth(certificate.body),
    }


def _growth(body: SpringsSosBody) -> Document:
    """f(R) >= f(pose) - delta + mu sin^2(angle / 2), the angle to the certified rotation."""
    return {
        "mu": double_below(body.growth),
        "delta": finite(double_above(body.gap)),
        "quaternion_wxyz": list(map(str, body.quaternion)),
    }


def _springs(registration: Registration[QuarticSolution]) -> Document | Absent:
    summary, freedom = registration.problem.springs, registration.solution.freedom
    if summary is None:
        return Absent("")
    return {
        "kind": summary.kind,
        "ranks": {str(rank): summary.ranks[rank] for rank in (1, 2, 3)},
        "free_translations": freedom.shifts(),
        "weak_translations": [
            {"direction": one.direction.tolist(), "share": one.share}
            for one in registration.solution.weak_shifts
        ],
        "symmetry_dimension": len(freedom.symmetry),
        "notes": list(summary.notes),
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
        "angle_to_pose_deg": mapped(solution.agreement.stated("relaxation"), math.degrees),
    }


def _relaxation_of_springs(registration: Registration[QuarticSolution]) -> Document | Absent:
    """The relaxation, its value in the unit of the objective."""
    solution = registration.solution
    relaxation, value = solution.found.relaxation, solution.relaxation_value
    if value is None:
        return Absent(relaxation.reason)
    nearest = nearest_double(value)
    return {
        "solver": relaxation.solver.split()[0].upper(),
        "form": FORM,
        "status": relaxation.solver_word,
        "value": OUT_OF_RANGE if nearest is None else nearest,
        "proved_gap": NO_BOUND_OF_IT,
        "rank": relaxation.rank,
        "angle_to_pose_deg": mapped(solution.angle_to_relaxation, math.degrees),
    }


def _residuals(registration: Registration) -> list[Document]:
    """The worst correspondences, largest distance first."""
    worst = registration.worst_residuals(WORST)
    return [{"row": one.row, "distance": one.distance} for one in worst]
