"""Judging a pose that any other tool returned: proved bounds, and which equilibrium it is."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate import ExactPose, flat_energy, pose_bounds, pose_energy
from certreg.errors import InvalidProblemError, UndecidedError
from certreg.exact import double_above, integer_eigenbasis, nearest_double, nearest_root
from certreg.geometry import davenport_matrix, rotation_matrix, squared_norm
from certreg.io import ROTATION_TOLERANCE
from certreg.problem import lift
from certreg.registration.ambiguity import NEARLY_AMBIGUOUS, narrow_words
from certreg.registration.certification import certify
from certreg.registration.headlines import (
    NEAR_OPTIMAL,
    NEAR_OPTIMAL_NOT_UNIQUE,
    NO_EQUILIBRIUM,
    NO_ROTATION,
    OPTIMAL,
    OPTIMAL_NOT_UNIQUE,
    SPURIOUS,
    at_most,
    degrees_words,
    interval_words,
    share_words,
)
from certreg.registration.rounding import rounding_cost
from certreg.results import (
    OUT_OF_RANGE,
    Absent,
    ComponentKind,
    Explained,
    Limits,
    PoseVerdict,
    Presented,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.certificate import PoseBounds
    from certreg.problem import ExactMoments, RegistrationProblem
    from certreg.registration.result import Registration, Solution


GOOD = (PoseVerdict.OPTIMAL, PoseVerdict.NEAR_OPTIMAL)
UNNOTED_DEFECT = 1e-12  # |R^T R - I| of a matrix of doubles: its own rounding
UNNOTED_SHIFT = Fraction(1, 10**9)  # of the clouds' size
NUMBERS = (
    *("objective", "rmse", "gap_lower", "gap_upper", "gap_share", "rounding_cost", "angle_upper"),
    *("angle_to_optimum", "nearest_index", "nearest_angle"),
)
PROJECTION_BITS = 160  # of a nearest rotation: thrice a double's
UNDECIDED = "the optimum could not be certified: nothing is proved of any pose"
NO_HINT = Absent("no usual mistake explains the verdict")


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessmentSettings:
    """Where the words of an assessment change. Gaps are relative to the range of energies.

    What is optimal is no choice: the gap is then at most what rounding the pose can cost, and
    within what `certify` calls certified (`Limits`).
    """

    rotation_tolerance: float = ROTATION_TOLERANCE  # |R^T R - I|, as for poses in files
    near_optimal_gap: float = 1e-4  # a pose off by one part in a hundred
    near_optimal_angle: float = 0.1  # radians
    equilibrium_angle: float = 1e-3  # radians: a pose printed with few digits still counts
    equilibrium_shift: float = 1e-3  # distance of the centroids, relative to the clouds' radius


@dataclass(frozen=True, slots=True, kw_only=True)
class Assessment(Explained, Presented):
    """What is known of a given pose.

    objective, rmse: at the pose; None where it is no rotation, or beyond the doubles.
    gap_lower, gap_upper: proved bounds on objective - minimum; None where it is no rotation.
    gap_share: gap_upper over the range of energies; None where that is zero, too.
    rounding_cost: what rounding the numbers of the optimal pose to doubles can cost.
    angle_to_optimum: radians, to the nearest optimum, computed; angle_upper: proved, rounded up;
        None where the optimum is not unique.
    nearest_index, nearest_angle: Morse index of the nearest component of equilibria; radians.
    headline: the verdict, with what is proved; words: what else is to be said of it, in a sentence
        or two. hint: the mistake that explains it, if any.
    """

    verdict: PoseVerdict
    headline: str
    words: str
    objective: float | None = None
    rmse: float | None = None
    gap_lower: float | None = None
    gap_upper: float | None = None
    gap_share: float | None = None
    rounding_cost: float | None = None
    angle_upper: float | None = None
    angle_to_optimum: float | None = None
    nearest_index: int | None = None
    nearest_angle: float | None = None
    hint: str | None = None

    def __repr__(self) -> str:
        if self.angle_to_optimum is None:
            return f"<Assessment: {self.verdict.value}>"
        away = math.degrees(self.angle_to_optimum)
        return f"<Assessment: {self.verdict.value}; {away:.6g} degrees from the optimum>"


def assess(
    problem: RegistrationProblem,
    rotation: ArrayLike,
    translation: ArrayLike,
    *,
    settings: AssessmentSettings | None = None,
) -> Assessment:
    """The assessment of the pose y = R x + translation; translation (3,).

    rotation: a matrix (3, 3), or a quaternion (4,), scalar first, which is judged exactly. A matrix
        that is a rotation up to its printed digits is judged as the nearest rotation, turned about
        the source's centroid, so that its rounding does not move the cloud.
    Raises InvalidProblemError for arrays of other shapes or with values that are not finite, and
    UndecidedError where the optimum could not be certified, so that nothing is proved of any pose.
    """
    settings = settings or AssessmentSettings()
    shape = (4,) if np.shape(rotation) == (4,) else (3, 3)
    turn = _finite(rotation, shape, "rotation")
    shift = _finite(translation, (3,), "translation")
    fault = why_no_rotation(turn, settings.rotation_tolerance)
    if fault is not None:
        return Assessment(
            verdict=PoseVerdict.NOT_A_ROTATION,
            headline=NO_ROTATION.said(fault=fault),
            words=fault,
            absent={**dict.fromkeys(NUMBERS, Absent(fault)), "hint": NO_HINT},
        )
    registration = certify(problem, relaxation=False, simulation=False)
    objective = registration.solution.objective
    if shape == (4,):
        pose = ExactPose.of_doubles(turn, shift)
    else:
        pose = _nearest_pose(objective.moments, turn, shift)
    facts = _findings(registration, pose, _cost(registration, turn, shift))
    assessment = _described(facts, _verdict(facts, settings))
    note = _projection_note(turn) if shape == (3, 3) else ""
    hint = None if assessment.verdict in GOOD else _hint(facts, pose, settings)
    return replace(assessment, words=assessment.words + note, hint=hint)


def _hint(facts: _Findings, pose: ExactPose, settings: AssessmentSettings) -> str | None:
    """What to try where the inverse of a pose is (nearly) right, the usual mistake."""
    turned = _findings(facts.registration, _inverse(pose), facts.rounding_cost)
    verdict = _verdict(turned, settings)
    if verdict not in GOOD:
        return None
    return f"Its inverse is {verdict.value}: this pose takes the target to the source."


def _cost(
    registration: Registration, turn: NDArray[np.float64], shift: NDArray[np.float64]
) -> Fraction:
    """What rounding can cost, the pose written as the given one; of many optima, near that one."""
    objective, pose = registration.solution.objective, registration.pose
    if objective.classification.unique:
        turn = pose.rotation if turn.shape == (3, 3) else pose.quaternion_wxyz
        shift = pose.translation
    return rounding_cost(objective, turn, shift)


def _inverse(pose: ExactPose) -> ExactPose:
    """The pose x = R^T (y - t)."""
    w, *axial = pose.quaternion
    q = (w, *(-entry for entry in axial))
    norm = squared_norm(q)
    shift = [
        -sum(
            (Fraction(a, norm) * t for a, t in zip(row, pose.translation, strict=True)), Fraction(0)
        )
        for row in rotation_matrix(q)
    ]
    return ExactPose(quaternion=q, translation=tuple(shift))


def _nearest_pose(
    moments: ExactMoments, matrix: NDArray[np.float64], shift: NDArray[np.float64]
) -> ExactPose:
    """The nearest rotation to a matrix, with the translation that moves the centroid as it did.

    It maximises tr(R^T A): the first eigenvector of A's Davenport matrix, far beyond doubles.
    """
    entries = lift(matrix.ravel()).integers
    nearest = davenport_matrix((entries[:3], entries[3:6], entries[6:]))
    q = integer_eigenbasis(nearest, PROJECTION_BITS).vectors[0]
    norm, x = squared_norm(q), moments.source_centroid
    rows = zip(matrix.tolist(), rotation_matrix(q), shift.tolist(), strict=True)
    translation = [
        Fraction(t)
        + sum(
            (Fraction(a) - Fraction(b, norm)) * c for a, b, c in zip(given, nearest, x, strict=True)
        )
        for given, nearest, t in rows
    ]
    return ExactPose(quaternion=tuple(q), translation=tuple(translation))


def _projection_note(matrix: NDArray[np.float64]) -> str:
    """What the user should know where a matrix was not quite a rotation."""
    defect = float(np.abs(matrix.T @ matrix - np.eye(3)).max())
    if defect <= UNNOTED_DEFECT:
        return ""
    return (
        f" (The matrix is off a rotation by {defect:.1e} and was judged as the nearest one about "
        "the source's centroid.)"
    )


def _finite(values: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        message = f"{name} must be {shape} finite numbers, found shape {array.shape}"
        raise InvalidProblemError(message, array=name, value=array.shape, limit=shape)
    return array


def why_no_rotation(matrix: NDArray[np.float64], tolerance: float) -> str | None:
    """Why a matrix (3, 3) or quaternion (4,) is no rotation, in words; None if it is one.

    tolerance: what the digits that are not printed may make of a rotation.
    """
    if matrix.shape == (4,):
        norm = math.hypot(*matrix.tolist())
        if abs(norm - 1.0) <= tolerance:
            return None
        return f"The quaternion has norm {norm:.6g}, not 1: it is not a rotation."
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
            "Does the tool that returned it lack the determinant rule, or is the target mirrored?"
        )
    if stretch[-1] > 0 and stretch[0] / stretch[-1] - 1 <= tolerance:
        return (
            f"The matrix scales by {stretch.mean():.6g}{' and reflects' * reflected}: it is "
            "not a rotation. Divide the scale out if a similarity was meant, and try again."
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
    bounds: PoseBounds
    rounding_cost: Fraction  # of the optimal pose, see `certreg.registration.rounding`
    energy: Fraction
    translation_energy: Fraction  # what the translation adds to the best one
    energy_range: Fraction  # the scale that says which energies are small
    angles: list[float]  # to each component of equilibria
    nearest: int  # the component of the least angle

    @property
    def unique(self) -> bool:
        """Whether there is one optimum."""
        return self.registration.equilibria.classification.unique


def _findings(registration: Registration, pose: ExactPose, cost: Fraction) -> _Findings:
    solution = registration.solution
    objective, q = solution.objective, pose.quaternion
    angles = [objective.angle_to(i, q) for i in range(len(objective.classification.pattern))]
    if solution.certificate is None:
        raise UndecidedError(UNDECIDED, method="certificate")
    return _Findings(
        registration=registration,
        bounds=pose_bounds(objective, solution.certificate.body, pose),
        rounding_cost=cost,
        energy=pose_energy(objective, pose),
        translation_energy=objective.translation_energy(q, pose.translation),
        energy_range=_energy_range(solution),
        angles=angles,
        nearest=min(range(len(angles)), key=angles.__getitem__),
    )


def _energy_range(solution: Solution) -> Fraction:
    """Energy between the best and the worst rotation; the clouds' own where all are equal."""
    objective, moments = solution.objective, solution.moments
    spaces = len(objective.classification.pattern)
    if spaces > 1:
        return 2 * objective.eigenvalue_difference(0, spaces - 1)
    return flat_energy(moments) or Fraction(1)


def _verdict(facts: _Findings, settings: AssessmentSettings) -> PoseVerdict:
    """The verdict: by the angle first, as a small gap may only mean that little is at stake."""
    scale = facts.energy_range
    settled = facts.angles[facts.nearest] <= settings.equilibrium_angle
    if facts.translation_energy > Fraction(settings.equilibrium_shift) ** 2 * scale:
        settled = False
    if facts.nearest > 0:
        return PoseVerdict.SPURIOUS_EQUILIBRIUM if settled else PoseVerdict.NOT_AN_EQUILIBRIUM
    gap, away = facts.bounds.greatest_gap, facts.angles[0]
    if gap > Fraction(settings.near_optimal_gap) * scale or away > settings.near_optimal_angle:
        return PoseVerdict.NOT_AN_EQUILIBRIUM
    if gap <= facts.rounding_cost and facts.bounds.meet(Limits(), unique=facts.unique):
        return PoseVerdict.OPTIMAL
    return PoseVerdict.NEAR_OPTIMAL


def _described(facts: _Findings, verdict: PoseVerdict) -> Assessment:
    rmse = nearest_root(facts.energy / facts.registration.solution.moments.total_weight)
    components = facts.registration.equilibria.components
    return Assessment(
        verdict=verdict,
        headline=_headline(facts, verdict),
        words=_words(facts, verdict),
        objective=nearest_double(facts.energy),
        rmse=rmse,
        gap_lower=facts.bounds.gap_lower,
        gap_upper=facts.bounds.gap_upper,
        gap_share=facts.bounds.share_upper,
        rounding_cost=double_above(facts.rounding_cost),
        angle_upper=facts.bounds.angle_upper,
        angle_to_optimum=facts.angles[0],
        nearest_index=components[facts.nearest].morse_index,
        nearest_angle=facts.angles[facts.nearest],
        absent={
            **dict.fromkeys(("objective", "rmse"), OUT_OF_RANGE),
            **_unbounded(facts.bounds),
            "hint": NO_HINT,
        },
    )


def _headline(facts: _Findings, verdict: PoseVerdict) -> str:
    bounds, degrees = facts.bounds, degrees_words(facts.bounds) if facts.unique else None
    gap, share = at_most(bounds.greatest_gap), share_words(bounds)
    if verdict is PoseVerdict.OPTIMAL:
        chosen = OPTIMAL_NOT_UNIQUE if degrees is None else OPTIMAL
        return chosen.said(degrees=degrees or "", gap=gap)
    if verdict is PoseVerdict.NEAR_OPTIMAL:
        chosen = NEAR_OPTIMAL if facts.unique else NEAR_OPTIMAL_NOT_UNIQUE
        return chosen.said(degrees=degrees or "180", gap=gap, share=share)
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM:
        components = facts.registration.equilibria.components
        component = components[facts.nearest]
        name = f"the index-{component.morse_index} equilibrium"
        if component.kind is not ComponentKind.POINT:
            kind = component.kind.value.replace("-", " ")
            name = f"a {kind} of index-{component.morse_index} equilibria"
        last = facts.nearest == len(components) - 1
        end = ": the worst rotation there is" if last else ""
        near = f"{math.degrees(facts.angles[facts.nearest]):.2g}"
        return SPURIOUS.said(near=near, name=name, end=end)
    return NO_EQUILIBRIUM.said(interval=interval_words(bounds))


def _words(facts: _Findings, verdict: PoseVerdict) -> str:
    equilibria = facts.registration.equilibria
    away = math.degrees(facts.angles[0])
    if verdict in GOOD:
        return _good_words(facts, verdict)
    if verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM:
        return _spurious_words(facts)
    nearest = equilibria.components[facts.nearest]
    words = "This is no equilibrium: a body released here would move. "
    if facts.nearest > 0:
        degrees = math.degrees(facts.angles[facts.nearest])
        words += f"The nearest one has index {nearest.morse_index}, {degrees:.4g} degrees away; "
    else:
        words += "The nearest one is the optimum; "
    words = f"{words}the global optimum is {away:.4g} degrees away{_shift_words(facts)}."
    if facts.bounds.greatest_gap <= facts.rounding_cost:
        words += (
            " The rounding of its numbers to doubles can cost that much: move the origin to the "
            "clouds."
        )
    return words


def _good_words(facts: _Findings, verdict: PoseVerdict) -> str:
    """What the gap is beside the rounding of the pose, and whether others are as good."""
    gap, cost = at_most(facts.bounds.greatest_gap), at_most(facts.rounding_cost)
    if verdict is PoseVerdict.OPTIMAL:
        words = (
            f"Its objective is at most {gap} above the minimum: rounding the numbers of the "
            f"optimal pose to doubles can cost up to {cost}."
        )
    else:
        away = math.degrees(facts.angles[0])
        nearest = "the optimum" if facts.unique else "the nearest optimum"
        words = (
            f"It is {away:.4g} degrees from {nearest}{_shift_words(facts)}. Rounding the numbers "
            f"of the optimal pose to doubles costs at most {cost}."
        )
    ambiguity = facts.registration.equilibria.classification.ambiguity
    if ambiguity is not None:
        words += f" The optimum is not the only one: {ambiguity.value}."
    elif facts.registration.equilibria.nearly_ambiguous:
        words += f" {NEARLY_AMBIGUOUS}"
    elif (narrow := narrow_words(facts.registration.equilibria)) is not None:
        words += f" {narrow[0].upper()}{narrow[1:]}."
    return words


def _spurious_words(facts: _Findings) -> str:
    component = facts.registration.equilibria.components[facts.nearest]
    many = f"{component.morse_index} direction{'s' * (component.morse_index > 1)}"
    how = f"it is unstable in {many}"
    if component.unstable_eigenvalues is None:
        how = f"the energy falls in {many}"
    return (
        f"Forces and torques balance there, but {how}, and the pose is "
        f"{math.degrees(facts.angles[0]):.6g} degrees from the global optimum."
    )


def _unbounded(bounds: PoseBounds) -> dict[str, Absent]:
    """Why there is no angle, or no share of the range of energies, if there is none."""
    names = {"angle_upper": "angle_upper", "share_upper": "gap_share"}
    return {names[name]: reason for name, reason in bounds.absent.items()}


def _shift_words(facts: _Findings) -> str:
    """How far the centroids are apart, where that is more than rounding."""
    moments = facts.registration.solution.moments
    if facts.translation_energy <= UNNOTED_SHIFT**2 * facts.energy_range:
        return ""
    shift = nearest_root(facts.translation_energy / moments.total_weight)
    return "" if shift is None else f" and the centroids {shift:.6g} apart"
