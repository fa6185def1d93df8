"""Judging a pose that any other tool returned: proved bounds, and which equilibrium it is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.bounds import pose_bounds, pose_energy
from certreg.dyadic import nearest_double, nearest_root
from certreg.energy import translation_energy
from certreg.errors import InvalidProblemError
from certreg.pipeline import certify
from certreg.problem import lift
from certreg.results import ComponentKind, PoseVerdict
from certreg.settings import AssessmentSettings
from certreg.so3 import quaternion_from_matrix

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.certificate.bounds import PoseBounds
    from certreg.equilibria.components import EquilibriumSet
    from certreg.pipeline import Registration, Solution
    from certreg.problem import RegistrationProblem


@dataclass(frozen=True, slots=True, kw_only=True)
class Assessment:
    """What is known of a given pose.

    objective, rmse: at the pose; None where it is no rotation, or beyond the doubles.
    gap_lower, gap_upper: proved bounds on objective - minimum; None where it is no rotation.
    angle_to_optimum: radians, to the nearest optimum.
    nearest_index, nearest_angle: Morse index of the nearest component of equilibria; radians.
    words: the verdict in one or two sentences.
    """

    verdict: PoseVerdict
    words: str
    objective: float | None = None
    rmse: float | None = None
    gap_lower: float | None = None
    gap_upper: float | None = None
    angle_to_optimum: float | None = None
    nearest_index: int | None = None
    nearest_angle: float | None = None


def assess(
    problem: RegistrationProblem,
    rotation: ArrayLike,
    translation: ArrayLike,
    *,
    settings: AssessmentSettings | None = None,
) -> Assessment:
    """The assessment of the pose y = rotation @ x + translation; rotation (3, 3), translation (3,).

    A matrix that is a rotation up to its printed digits is judged as the nearest rotation, exactly.
    Raises InvalidProblemError for arrays of other shapes or with values that are not finite.
    """
    settings = settings or AssessmentSettings()
    matrix = _finite(rotation, (3, 3), "rotation")
    shift = _finite(translation, (3,), "translation")
    fault = _why_no_rotation(matrix, settings.rotation_tolerance)
    if fault is not None:
        return Assessment(verdict=PoseVerdict.NOT_A_ROTATION, words=fault)
    facts = _findings(certify(problem), quaternion_from_matrix(matrix), shift)
    return _described(facts, _verdict(facts, settings))


def _finite(values: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        message = f"{name} must be {shape} finite numbers, found shape {array.shape}"
        raise InvalidProblemError(message)
    return array


def _why_no_rotation(matrix: NDArray[np.float64], tolerance: float) -> str | None:
    """Why a matrix is no rotation, in words; None if it is one up to its printed digits."""
    with np.errstate(over="ignore", invalid="ignore"):
        defect = float(np.abs(matrix.T @ matrix - np.eye(3)).max())
    stretch = np.linalg.svd(matrix, compute_uv=False)
    reflected = bool(np.linalg.slogdet(matrix)[0] < 0)
    if defect <= tolerance and not reflected:
        return None
    if defect <= tolerance:
        return (
            "The matrix is a reflection (determinant -1), not a rotation: no rigid motion does "
            "that. "
            "The tool that returned it lacks the determinant rule, or the target is mirrored."
        )
    if stretch[-1] > 0 and stretch[0] / stretch[-1] - 1 <= tolerance:
        return (
            f"The matrix scales by {stretch.mean():.6g}{' and reflects' * reflected}: it is "
            "not a rotation. Divide the scale out if a similarity was meant, and assess again."
        )
    return (
        f"The matrix is not orthogonal (R^T R is off by {defect:.2g}, singular values "
        f"{stretch[0]:.6g} to {stretch[-1]:.6g}): it is not a rotation. Give more digits, or the "
        "quaternion."
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Findings:
    """The facts on which the verdict rests; energies exact, angles in radians."""

    registration: Registration
    bounds: PoseBounds | None
    energy: Fraction
    translation_energy: Fraction  # what the translation adds to the best one
    energy_range: Fraction  # the scale that says which energies are small
    angles: list[float]  # to each component of equilibria
    nearest: int  # the component of the least angle

    @property
    def gap_upper(self) -> Fraction | None:
        if self.bounds is None or math.isinf(self.bounds.gap_upper):
            return None
        return Fraction(self.bounds.gap_upper)


def _findings(
    registration: Registration, quaternion: NDArray[np.float64], translation: NDArray[np.float64]
) -> _Findings:
    solution = registration.solution
    q = lift(quaternion).integers
    angles = [solution.spectrum.angle_to(i, q) for i in range(len(solution.spectrum.groups))]
    bounds = None
    if solution.certificate is not None:
        bounds = pose_bounds(solution.moments, solution.certificate, quaternion, translation)
    exact = [Fraction(entry) for entry in translation.tolist()]
    return _Findings(
        registration=registration,
        bounds=bounds,
        energy=pose_energy(solution.moments, quaternion, translation),
        translation_energy=translation_energy(solution.moments, q, exact),
        energy_range=_energy_range(solution),
        angles=angles,
        nearest=min(range(len(angles)), key=angles.__getitem__),
    )


def _energy_range(solution: Solution) -> Fraction:
    """Energy between the best and the worst rotation; the clouds' own where all are equal."""
    found, moments = solution.spectrum, solution.moments
    if len(found.groups) > 1:
        return 2 * found.level_difference(0, len(found.groups) - 1)
    centroids = (*moments.source_centroid, *moments.target_centroid)
    distance = sum((entry * entry for entry in centroids), start=Fraction(0))
    return moments.spread or moments.total_weight * distance or Fraction(1)


def _verdict(facts: _Findings, settings: AssessmentSettings) -> PoseVerdict:
    scale, gap = facts.energy_range, facts.gap_upper
    if gap is not None and gap <= Fraction(settings.optimal_gap) * scale:
        return PoseVerdict.OPTIMAL
    turned = facts.angles[facts.nearest] > settings.equilibrium_angle
    shifted = facts.translation_energy > Fraction(settings.equilibrium_shift) ** 2 * scale
    if facts.nearest > 0 and not turned and not shifted:
        return PoseVerdict.SPURIOUS_EQUILIBRIUM
    if gap is not None and gap <= Fraction(settings.near_optimal_gap) * scale:
        return PoseVerdict.NEAR_OPTIMAL
    return PoseVerdict.NOT_AN_EQUILIBRIUM


def _described(facts: _Findings, verdict: PoseVerdict) -> Assessment:
    rmse = nearest_root(facts.energy / facts.registration.solution.moments.total_weight)
    components = facts.registration.equilibria.components
    return Assessment(
        verdict=verdict,
        words=_words(facts, verdict),
        objective=nearest_double(facts.energy),
        rmse=rmse,
        gap_lower=None if facts.bounds is None else facts.bounds.gap_lower,
        gap_upper=None if facts.bounds is None else facts.bounds.gap_upper,
        angle_to_optimum=facts.angles[0],
        nearest_index=components[facts.nearest].morse_index,
        nearest_angle=facts.angles[facts.nearest],
    )


def _words(facts: _Findings, verdict: PoseVerdict) -> str:
    equilibria = facts.registration.equilibria
    component = equilibria.components[facts.nearest]
    degrees = math.degrees(facts.angles[facts.nearest])
    away = math.degrees(facts.angles[0])
    if verdict is PoseVerdict.OPTIMAL:
        return _optimal_words(equilibria)
    if verdict is PoseVerdict.NEAR_OPTIMAL:
        return (
            f"This is near the global optimum, {away:.3g} degrees from it, but not at it: "
            "it fits measurably worse."
        )
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM:
        name = f"the index-{component.morse_index} equilibrium"
        if component.kind is not ComponentKind.POINT:
            name = f"one of a {component.kind.value} of index-{component.morse_index} equilibria"
        worst = facts.nearest == len(equilibria.components) - 1
        end = ": the worst rotation there is" if worst else ""
        return (
            f"This is {name}{end}. Forces and torques balance here, but it is unstable in "
            f"{component.morse_index} direction{'s' * (component.morse_index > 1)} and "
            f"{away:.6g} degrees from the global optimum."
        )
    return (
        f"This is no equilibrium: a body released here would move. The nearest one has index "
        f"{component.morse_index} and is {degrees:.3g} degrees away; the global optimum is "
        f"{away:.3g} degrees away{_shift_words(facts)}."
    )


def _optimal_words(equilibria: EquilibriumSet) -> str:
    ambiguity = equilibria.classification.ambiguity
    if ambiguity is None:
        return "This is the global optimum, up to the proved bounds, and there is no other."
    return (
        "This is a global optimum, up to the proved bounds, but not the only one: "
        f"{ambiguity.value}."
    )


def _shift_words(facts: _Findings) -> str:
    weight = facts.registration.solution.moments.total_weight
    shift = nearest_root(facts.translation_energy / weight)
    if not shift:
        return ""
    return f", and the centroids are {shift:.6g} apart"
