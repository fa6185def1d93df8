"""The main job: register, enumerate, certify, check."""

from __future__ import annotations

import math
import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.bounds import PoseBounds, pose_bounds, pose_energy
from certreg.certificate.checking import check_own
from certreg.certificate.producing import produce
from certreg.dyadic import nearest_double, nearest_or_zero, nearest_root
from certreg.energy import best_translation
from certreg.equilibria.closed_form import arun, horn
from certreg.equilibria.spectral import (
    equilibrium_set,
    rotation_double,
    spectrum,
    unit_double,
)
from certreg.errors import ContradictionError, OutOfRangeError, RefusedCertificateError
from certreg.moments import exact_moments, floating_moments
from certreg.pose import Pose
from certreg.problem import lift
from certreg.results import Optimality
from certreg.settings import AgreementSettings

if TYPE_CHECKING:
    from collections.abc import Generator

    from certreg.certificate.types import Certificate
    from certreg.equilibria.components import EquilibriumSet
    from certreg.equilibria.spectral import Spectrum
    from certreg.moments import ExactMoments
    from certreg.problem import RegistrationProblem
    from certreg.results import Verdict


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """What is computed before anything is checked."""

    moments: ExactMoments
    spectrum: Spectrum
    equilibria: EquilibriumSet
    pose: Pose
    certificate: Certificate | None
    closed_form_angle: float  # radians, the larger of Horn's and Arun's to the nearest optimum


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Registration:
    """The result of `certify`: a solution and what the checker has accepted of it.

    objective: sum w |y - R x - t|^2 at `pose`; None where no double holds it.
    rmse: sqrt(objective / sum w), in the unit of length.
    bounds: proved of `pose` as reported, rounding included; None if not certified.
    verdict: the checker's, with the theorems in its words; None if there is no certificate.
    timings: seconds per phase.
    """

    problem: RegistrationProblem
    solution: Solution
    objective: float | None
    rmse: float | None
    bounds: PoseBounds | None
    verdict: Verdict | None
    timings: dict[str, float]

    @property
    def pose(self) -> Pose:
        """The optimum, rounded to doubles; where it is not unique, the one nearest the identity."""
        return self.solution.pose

    @property
    def equilibria(self) -> EquilibriumSet:
        """All equilibria of the registration dynamics."""
        return self.solution.equilibria

    @property
    def certificate(self) -> Certificate | None:
        """The certificate that the checker has accepted; None if none was found."""
        return self.solution.certificate

    @property
    def status(self) -> Optimality:
        """What is proved of the pose; never more than the checker has accepted."""
        if self.verdict is None or not self.verdict.proved:
            return Optimality.NOT_CERTIFIED
        if self.equilibria.classification.unique:
            return Optimality.CERTIFIED
        return Optimality.CERTIFIED_NOT_UNIQUE


def certify(problem: RegistrationProblem, *, about: dict[str, Any] | None = None) -> Registration:
    """Register, enumerate all equilibria, certify, and run the checker on the certificate.

    Raises ContradictionError or RefusedCertificateError where certreg contradicts itself, and
    OutOfRangeError where no double can hold the pose.
    """
    timings: dict[str, float] = {}
    with _timed(timings, "compute"):
        solution = solve(problem, about=about)
    certificate = solution.certificate
    verdict = None
    if certificate is not None:
        with _timed(timings, "check"):
            verdict = check_own(certificate, problem)
        if not verdict.proved:
            message = f"the checker refused certreg's own certificate: {verdict.words}"
            raise RefusedCertificateError(message, verdict=verdict)
    return _registration(problem, solution, verdict, timings)


def equilibria(problem: RegistrationProblem, method: str = "spectral") -> EquilibriumSet:
    """All equilibria of the registration dynamics of a problem.

    method: "spectral", the eigenspaces of the Davenport matrix. Raises ValueError for others.
    """
    if method != "spectral":
        message = f"method is {method!r}: this version knows 'spectral'"
        raise ValueError(message)
    return equilibrium_set(spectrum(exact_moments(problem)), problem.damping)


def solve(problem: RegistrationProblem, *, about: dict[str, Any] | None = None) -> Solution:
    """Everything that is computed, nothing yet checked."""
    moments = exact_moments(problem)
    found = spectrum(moments)
    return Solution(
        moments=moments,
        spectrum=found,
        equilibria=equilibrium_set(found, problem.damping),
        pose=_optimal_pose(moments, found),
        certificate=produce(problem, found, about=about),
        closed_form_angle=_closed_form_angle(problem, found),
    )


def _registration(
    problem: RegistrationProblem,
    solution: Solution,
    verdict: Verdict | None,
    timings: dict[str, float],
) -> Registration:
    pose, moments, certificate = solution.pose, solution.moments, solution.certificate
    place = (pose.quaternion_wxyz, pose.translation)
    energy = pose_energy(moments, *place)
    return Registration(
        problem=problem,
        solution=solution,
        objective=nearest_double(energy),
        rmse=nearest_root(energy / moments.total_weight),
        bounds=None if certificate is None else pose_bounds(moments, certificate, *place),
        verdict=verdict,
        timings=timings,
    )


def _optimal_pose(moments: ExactMoments, found: Spectrum) -> Pose:
    """The representative of the optimal component, every number rounded once."""
    q = found.quaternions[0]
    translation = [nearest_or_zero(entry) for entry in best_translation(moments, q)]
    if not np.isfinite(translation).all():
        message = (
            "the translation of the optimal pose exceeds the range of doubles: "
            "change the unit of length of both clouds"
        )
        raise OutOfRangeError(message)
    return Pose(
        rotation=rotation_double(q),
        translation=np.array(translation),
        quaternion_wxyz=unit_double(q),
    )


def _closed_form_angle(problem: RegistrationProblem, found: Spectrum) -> float:
    """The larger angle, in radians, from Horn's and Arun's rotation to the nearest optimum.

    Raises ContradictionError if one of them fits worse than rounding explains.
    """
    moments = floating_moments(problem)
    angles: list[float] = []
    for name, quaternion in (("Horn", horn(moments)), ("Arun", arun(moments))):
        q = lift(quaternion).integers
        angles.append(found.angle_to_optimum(q))
        if found.relative_loss(q) > AgreementSettings().relative_gap:
            message = (
                f"{name}'s closed form contradicts the certified pose: it is "
                f"{math.degrees(angles[-1]):.3g} degrees away; please report this problem"
            )
            raise ContradictionError(message)
    return max(angles)


@contextmanager
def _timed(timings: dict[str, float], phase: str) -> Generator[None]:
    start = time.perf_counter()
    yield
    timings[phase] = time.perf_counter() - start
