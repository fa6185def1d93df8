"""What `certreg-result/1` tells of general springs, under the keys that every result has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.exact.dyadic import double_above, double_below, nearest_double
from certreg.registration.quartic import NOT_LISTED, NOT_SIMULATED
from certreg.registration.result import UNDECIDED
from certreg.report.fields import (
    degrees,
    finite,
    hardly_determined,
    optimality_fields,
    robustness_fields,
)
from certreg.results import OUT_OF_RANGE, Absent

if TYPE_CHECKING:
    from certreg.certificate.springs_sos import SpringsSosBody
    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration
    from certreg.report.encoding import Document


FORM = "rotation-10"
NO_CLOSED_FORM = Absent("general springs have no closed form")
NO_EIGENVALUES = Absent("there are no eigenvalues of general springs to compare")
NO_PROOF = Absent("not certified")
NO_BOUND = Absent("the certificate uses what the relaxation proposes, and proves its own bound")


def spring_fields(registration: Registration[QuarticSolution]) -> Document:
    """What is told of general springs."""
    turned = degrees(registration.solution.angle_to_relaxation)
    return {
        "springs": _springs(registration),
        "optimality": _optimality(registration),
        "equilibria": NOT_LISTED,
        "margin": {
            "eigenvalue_gap": NO_EIGENVALUES,
            "relative": NO_EIGENVALUES,
            "nearly_ambiguous": NO_EIGENVALUES,
            "hardly_determined": hardly_determined(registration),
        },
        "robustness": robustness_fields(registration),
        "relaxation": _relaxation(registration),
        "simulation": NOT_SIMULATED,
        "agreement": {
            "closed_form_deg": NO_CLOSED_FORM,
            "relaxation_deg": turned,
            "simulation_deg": NOT_SIMULATED,
        },
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


def _optimality(registration: Registration[QuarticSolution]) -> Document:
    solution = registration.solution
    rotation = solution.unique_rotation
    certificate = solution.certificate
    return {
        **optimality_fields(registration),
        "unique_rotation": UNDECIDED if rotation is None else rotation,
        "method": NO_PROOF if registration.method is None else registration.method.value,
        "growth": NO_PROOF if certificate is None else _growth(certificate.body),
    }


def _growth(body: SpringsSosBody) -> Document:
    """f(R) >= f(pose) - delta + mu sin^2(angle / 2), the angle to the certified rotation."""
    return {
        "mu": double_below(body.growth),
        "delta": finite(double_above(body.gap)),
        "quaternion_wxyz": list(map(str, body.quaternion)),
    }


def _relaxation(registration: Registration[QuarticSolution]) -> Document | Absent:
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
        "proved_gap": NO_BOUND,
        "rank": relaxation.rank,
        "angle_to_pose_deg": degrees(solution.angle_to_relaxation),
    }
