"""`certify` for general springs: find the optimum, prove what can be proved, check the proof."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import late
from certreg.certificate.bounds import ExactPose
from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.spring_bounds import spring_pose_bounds
from certreg.equilibrium.presentation import rotation_double, unit_double
from certreg.errors import DegenerateProblemError, OutOfRangeError
from certreg.exact.dyadic import nearest_double, nearest_root
from certreg.geometry.pose import Pose
from certreg.objective.springs import Springs
from certreg.problem.stiffness import spring_moments
from certreg.registration.curvature import soft_axes
from certreg.registration.freedom import Freedom
from certreg.registration.loose_turns import axis_words
from certreg.registration.parts import logged
from certreg.registration.robustness import NONE_PROVED
from certreg.registration.spring_result import (
    SpringRegistration,
    SpringSolution,
)
from certreg.registration.weak_shifts import weak_shift_words, weak_shifts
from certreg.results import OUT_OF_RANGE, Absent, Limits

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.certificate import producing_springs
    from certreg.problem.problem import RegistrationProblem
    from certreg.relaxation import optimum
    from certreg.results import Verdict
else:
    # what proves is loaded where it is called
    producing_springs = late("certreg.certificate.producing_springs")
    optimum = late("certreg.relaxation.optimum")

NOT_CERTIFIED = Absent("not certified")
SPRING_PARTS = 4  # of certify: sums, optimum, certificate, checker


def certified_springs(
    problem: RegistrationProblem,
    *,
    solver: str | None = None,
    robustness_angle: float | None = None,
    about: dict[str, Any] | None = None,
    limits: Limits | None = None,
    done: Callable[[str], None] = logged,
) -> SpringRegistration:
    """The registration of a problem with general springs, as `certify` returns it.

    solver, robustness_angle: as `certify` has them. done: called with the name of each part.
    Raises as `certify` does.
    """
    timings: dict[str, float] = {}
    start = time.perf_counter()
    asked = {"robustness_angle": robustness_angle, "about": about}
    solution = _solved(problem, solver, asked, done)
    timings["compute"] = time.perf_counter() - start
    verdict = None
    if solution.certificate is not None:
        start = time.perf_counter()
        verdict = check_own(solution.certificate, problem)
        timings["check"] = time.perf_counter() - start
        require_accepted(verdict)
    done("checker")
    if problem.mapped:
        solution.complete()
    return replace(registration_of(solution, verdict, timings), limits=limits or Limits())


def _solved(
    problem: RegistrationProblem,
    solver: str | None,
    asked: dict[str, Any],
    done: Callable[[str], None],
) -> SpringSolution:
    """Everything that is computed, nothing yet checked."""
    objective = Springs(spring_moments(problem))
    done("exact sums")
    found = optimum.find_optimum(objective, solver)
    done("optimum")
    certificate = producing_springs.springs_certificate(problem, objective, found, **asked)
    done("certificate")
    quaternion = found.quaternion if certificate is None else certificate.body.quaternion
    return SpringSolution(
        problem=problem,
        objective=objective,
        found=found,
        pose=rounded_spring_pose(objective, quaternion),
        quaternion=quaternion,
        certificate=certificate,
        absent={"certificate": NOT_CERTIFIED},
    )


def spring_pose(problem: RegistrationProblem) -> Pose:
    """The best pose of a problem with general springs, found and not proved.

    Raises DegenerateProblemError where a shift or a turn is undetermined, or nearly so.
    """
    objective = Springs(spring_moments(problem))
    found = optimum.find_optimum(objective)
    open_ = Freedom.of(objective).words() or weak_shift_words(weak_shifts(objective.joint_form))
    if not open_ and len(soft := soft_axes(objective, found.quaternion)):
        about = " and ".join(axis_words(axis) for axis in soft)
        open_ = f"rotation about the source's axis {about} is undetermined to first order"
    if open_:
        message = f"{open_}; certreg.certify says what is proved of it"
        raise DegenerateProblemError(message)
    return rounded_spring_pose(objective, found.quaternion)


def rounded_spring_pose(objective: Springs, q: tuple[int, int, int, int]) -> Pose:
    """The pose with its best translation, every number rounded once."""
    exact = objective.best_translation(q)
    translation = [nearest_double(entry) for entry in exact]
    if None in translation:
        message = (
            "the translation of the optimal pose exceeds the range of doubles: "
            "change the unit of length of both clouds"
        )
        raise OutOfRangeError(message, value=exact)
    return Pose(
        rotation=rotation_double(q),
        translation=np.array(translation),
        quaternion_wxyz=unit_double(q),
    )


def registration_of(
    solution: SpringSolution, verdict: Verdict | None, timings: dict[str, float]
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
        limits=Limits(),
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
