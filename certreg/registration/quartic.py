"""The prover of general springs: a search for the optimum, squares or cones, their check."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg._loading import late
from certreg.certificate.bounds import ExactPose
from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.spring_bounds import spring_pose_bounds
from certreg.errors import DegenerateProblemError
from certreg.exact.dyadic import nearest_double, nearest_root
from certreg.objective.springs import Springs
from certreg.registration.curvature import soft_axes
from certreg.registration.freedom import Freedom
from certreg.registration.loose_turns import axis_words
from certreg.registration.optimum import pose_at
from certreg.registration.pipeline import Asked, Prover, Work
from certreg.registration.robustness import NONE_PROVED
from certreg.registration.spring_result import (
    SpringRegistration,
    SpringSolution,
)
from certreg.registration.weak_shifts import weak_shift_words, weak_shifts
from certreg.results import OUT_OF_RANGE, Absent

if TYPE_CHECKING:
    from certreg.certificate import producing_springs
    from certreg.geometry.pose import Pose
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.support import Cell
    from certreg.relaxation import optimum
    from certreg.relaxation.optimum import Found
    from certreg.results import Limits, Verdict
else:
    # what proposes and proves is loaded where it is called
    producing_springs = late("certreg.certificate.producing_springs")
    optimum = late("certreg.relaxation.optimum")

NOT_CERTIFIED = Absent("not certified")


@dataclass(frozen=True, slots=True, kw_only=True)
class QuarticProposal:
    """The optimum in doubles, with the relaxation that led to it."""

    objective: Springs
    found: Found


class QuarticProver(Prover[QuarticProposal, SpringSolution, SpringRegistration]):
    """Of a rigid motion; the relaxation is a part of the search, and always taken."""

    PARTS = 4  # exact sums, optimum, certificate, checker

    def accepts(self, cell: Cell) -> bool:
        """All that there are."""
        return cell.springs

    def propose(self, problem: RegistrationProblem, asked: Asked, work: Work) -> QuarticProposal:
        """The best that was found."""
        objective = Springs.of(problem)
        work.done("exact sums")
        found = optimum.find_optimum(objective, asked.solver)
        work.done("optimum")
        return QuarticProposal(objective=objective, found=found)

    def prove(
        self, problem: RegistrationProblem, proposal: QuarticProposal, asked: Asked, work: Work
    ) -> SpringSolution:
        """By squares or cones."""
        objective, found = proposal.objective, proposal.found
        certificate = producing_springs.springs_certificate(
            problem,
            objective,
            found,
            robustness_angle=asked.robustness_angle,
            about=asked.about,
        )
        work.done("certificate")
        quaternion = found.quaternion if certificate is None else certificate.body.quaternion
        solution = SpringSolution(
            problem=problem,
            objective=objective,
            found=found,
            pose=pose_at(objective, quaternion),
            quaternion=quaternion,
            certificate=certificate,
            absent={"certificate": NOT_CERTIFIED},
        )
        work.lap("compute")
        return solution

    def check(self, proved: SpringSolution, work: Work) -> Verdict | None:
        """The checker's answer."""
        verdict = None
        if proved.certificate is not None:
            verdict = check_own(proved.certificate, proved.problem)
            work.lap("check")
            require_accepted(verdict)
        work.done("checker")
        return verdict

    def judge(
        self,
        proved: SpringSolution,
        verdict: Verdict | None,
        asked: Asked,
        timings: dict[str, float],
    ) -> SpringRegistration:
        """What a solution says of the pose as it is printed."""
        if proved.problem.mapped:
            proved.complete()
        return _registration(proved, verdict, timings, asked.limits)


PROVER = QuarticProver()


def spring_pose(problem: RegistrationProblem) -> Pose:
    """The best pose of a problem with general springs, found and not proved.

    Raises DegenerateProblemError where a shift or a turn is undetermined, or nearly so.
    """
    objective = Springs.of(problem)
    found = optimum.find_optimum(objective)
    open_ = Freedom.of(objective).words() or weak_shift_words(weak_shifts(objective))
    if not open_ and len(soft := soft_axes(objective, found.quaternion)):
        about = " and ".join(axis_words(axis) for axis in soft)
        open_ = f"rotation about the source's axis {about} is undetermined to first order"
    if open_:
        message = f"{open_}; certreg.certify says what is proved of it"
        raise DegenerateProblemError(message)
    return pose_at(objective, found.quaternion)


def _registration(
    solution: SpringSolution,
    verdict: Verdict | None,
    timings: dict[str, float],
    limits: Limits,
) -> SpringRegistration:
    """What a solution says of the pose as it is printed."""
    place = ExactPose.of_doubles(solution.pose.quaternion_wxyz, solution.pose.translation)
    energy = solution.objective.energy(place.quaternion)
    energy += solution.objective.translation_energy(place.quaternion, place.translation)
    bounds = None
    if solution.certificate is not None:
        bounds = spring_pose_bounds(solution.objective, solution.certificate.body, place)
    stiffness = solution.sums.stiffness
    squared = energy / Fraction(stiffness) if 0.0 < stiffness < math.inf else None
    return SpringRegistration(
        problem=solution.problem,
        solution=solution,
        objective=nearest_double(energy),
        rmse=None if squared is None else nearest_root(squared),
        bounds=bounds,
        limits=limits,
        verdict=verdict,
        timings=timings,
        absent={
            **solution.absent,
            "objective": OUT_OF_RANGE,
            "rmse": OUT_OF_RANGE,
            "bounds": NOT_CERTIFIED,
            "robustness": NONE_PROVED,
        },
    )
