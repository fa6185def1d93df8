"""Judging a pose that any other tool returned: proved bounds, and which equilibrium it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Unpack, cast

from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import double_above, nearest_double, nearest_root
from certreg.geometry.given import GivenPose, given_pose
from certreg.geometry.pose_matrix import why_no_rotation
from certreg.io.objects import ProblemOptions
from certreg.objective.structure import Structure
from certreg.problem.attributes import require_known
from certreg.problem.bounds import bounded
from certreg.problem.support import Loss
from certreg.registration.assessed import Assessment
from certreg.registration.assessment_words import WORDS, headline_of_pose, words_of_pose
from certreg.registration.certification import certify
from certreg.registration.convention_errors import Slip, slip_of
from certreg.registration.findings import (
    GOOD,
    Findings,
    JudgedEnergies,
    exact_pose,
    findings,
    sigma_distance,
    verdict_of,
)
from certreg.registration.gap_parts import NOT_SCALED, read_for
from certreg.registration.headlines import NO_ROTATION
from certreg.registration.label_assessment import LabelAssessment, judged_labels
from certreg.registration.landscape import AssessmentSettings, landscape_of, optimum_worth
from certreg.registration.problem_arguments import is_problem, stated_in_clouds, stated_problem_of
from certreg.registration.result import UNDECIDED, PoseWorth, Registration
from certreg.results import OUT_OF_RANGE, Absent, PoseVerdict, present

if TYPE_CHECKING:
    from fractions import Fraction


NUMBERS = (
    *("objective", "rmse", "gap_lower", "gap_upper", "gap_share", "rounding_cost", "angle_upper"),
    *(
        "gap_parts",
        "shift_upper",
        "angle_to_optimum",
        "nearest_index",
        "nearest_angle",
        "sigma_distance",
    ),
)
NO_SLIP = Absent(
    "no single slip of those that are tried leads to it from a pose within 0.001 radians, and a "
    "millionth of the range of energies, of the optimum; two at once are not tried"
)
NO_SCALED_SLIP = Absent("no slip is tried where the scale is free")
NOT_TRIED = Absent("the optimum could not be certified, and no slip was tried")
NO_SPRING_SLIP = Absent(
    "no slip (a mirror image, swapped columns, the inverse pose) is tried for general springs"
)
NOT_UNIQUE = Absent("other poses are as good: no angle to 'the' optimum exists")
NOT_MET = Absent("no equilibrium was met at the pose, and those of general springs are not listed")
NOTHING_TO_EXPLAIN = Absent("the pose is (nearly) optimal: there is no slip to name")


def assess(  # noqa: PLR0913 - each is one question, and has its usual answer
    problem: Any,
    pose: Any = None,
    translation: Any = None,
    *,
    settings: AssessmentSettings | None = None,
    labels: Any = None,
    max_residual: Any = None,
    objective: str | None = None,
    effort: float = 1.0,
    **statement: Unpack[ProblemOptions],
) -> Assessment:
    """The assessment of a pose y = R x + t, as any tool returned it.

    A quaternion is normalised and judged exactly. A matrix that is a rotation up to its printed
    digits is judged as the nearest rotation, turned about the source's centroid, so that its
    rounding does not move the cloud.

    Parameters
    ----------
    problem
        A `RegistrationProblem`; of many poses for one problem, its `Registration`, so that it is
        certified once. Or source, target and pose, in this order: `assess(source, target, pose)`.
    pose
        A matrix (4, 4) with last row 0 0 0 1, or (3, 4): [R | t]; a pair (R, t); certreg's own
        `Pose` or `Registration`; SciPy's `Rotation` or `RigidTransform`; anything with
        `.T_target_source`, `.transformation`, `.as_matrix` or `.matrix`, a method or an array. Or a
        rotation, a matrix (3, 3) or a quaternion (4,) with the scalar first.
    translation
        (3,), a column or a row, beside a rotation. A rotation alone is judged with the best
        translation for it, and `words` say so.
    settings
        Where the words change; None: as `AssessmentSettings()` has it.
    labels
        Instead of a pose: (N,), 0 and 1, booleans, or "outlier" and "inlier", as a method for wrong
        pairs returned them: `assess(source, target, labels=..., max_residual=...)`.
    max_residual
        Beside labels: how far apart the two points of a right pair are at most, as for `certify`.
    objective
        Beside labels: "consensus", or "truncated", with `rotation_only=True`, as for `certify`.
    effort
        Beside labels: a factor on the budgets of the search and the proof.
    **statement
        Beside source and target, as for `certify`: `sigma`, `weights`, `normals` and so on.

    Returns
    -------
    Assessment
        The verdict, the proved bounds on what the pose costs, and the optimum beside it. Of labels
        `KeptPairs`: whether one motion meets all inliers, and how many the most are; with the
        objective "truncated" `TruncatedLabels`: whether an optimum has just these within.

    Raises
    ------
    InvalidProblemError
        For arrays of other shapes or with values that are not finite.
    UndecidedError
        Where the optimum could not be certified, so that nothing is proved of any pose.

    Examples
    --------
    >>> import numpy as np
    >>> from certreg import RegistrationProblem
    >>> cloud = np.diag([3.0, 2.0, 1.0])
    >>> judged = assess(RegistrationProblem(cloud, cloud), np.eye(4))
    >>> judged.verdict.value
    'optimal'
    """
    require_known(statement, ProblemOptions, "assess")
    if labels is not None or max_residual is not None or objective is not None:
        given = {"labels": labels, "max_residual": max_residual}
        sought = {"objective": objective, "effort": effort}
        judged_pairs = _judged_pairs(problem, pose, translation, given, sought, statement)
        return cast("Assessment", judged_pairs)
    if not _is_stated(problem):
        if translation is None or _is_stated(pose):
            raise InvalidProblemError(_unstated(problem, pose), array="problem")
        stated, _ = stated_in_clouds(problem, pose, statement, depth=3)
        problem, pose, translation = stated, translation, None
    elif statement:
        raise InvalidProblemError(
            f"{', '.join(statement)} beside a problem, which states it itself", array="problem"
        )
    if is_problem(pose):
        raise InvalidProblemError(
            "pose is a RegistrationProblem: that comes first, and then the pose", array="pose"
        )
    given = given_pose(pose, translation)
    if is_problem(problem):
        problem = certify(problem, relaxation=False, simulation=False)
    return judged(cast("Registration", problem), given, settings)


def _judged_pairs(
    problem: Any,
    target: Any,
    translation: Any,
    given: dict[str, Any],
    sought: dict[str, Any],
    statement: ProblemOptions,
) -> LabelAssessment:
    """What is proved of labels, of a problem or of two clouds."""
    missing = [name for name, value in given.items() if value is None]
    if missing or translation is not None:
        message = "labels and max_residual go together, without a pose: "
        remedy = f"give {missing[0]}" if missing else "leave the pose out"
        raise InvalidProblemError(message + remedy, array=missing[0] if missing else "pose")
    loss = Loss.of(sought["objective"], given["max_residual"])
    stated, about = stated_problem_of(problem, target, statement, loss)
    pairs = bounded(stated, given["max_residual"], loss)
    return judged_labels(pairs, given["labels"], effort=sought["effort"], about=about)


def _is_stated(value: Any) -> bool:
    """Whether it is a problem, or was certified."""
    return is_problem(value) or isinstance(value, Registration)


def _unstated(problem: Any, pose: Any) -> str:
    """What was given where a problem is expected, in words."""
    found = "the two the other way round" if _is_stated(pose) else f"a {type(problem).__name__}"
    return (
        "assess takes a RegistrationProblem, or what certify returned, and then the pose: "
        "assess(RegistrationProblem(source, target), pose), or assess(source, target, pose); found "
        f"{found}"
    )


def judged(
    registration: Registration,
    given: GivenPose,
    settings: AssessmentSettings | None = None,
) -> Assessment:
    """As `assess`, of a problem that is certified already."""
    settings, landscape = settings or AssessmentSettings(), landscape_of(registration)
    objective, given = registration.solution.objective, read_for(registration, given)
    turn = given.turn if objective.scaling is None else given.scaled_apart().turn
    fault = why_no_rotation(turn, settings.rotation_tolerance)
    if fault is not None:
        return _no_rotation(registration, given, fault, settings)
    exact = exact_pose(objective, given, landscape.centre(registration.solution))
    facts = findings(registration, exact, landscape.rounding_cost(registration, given), settings)
    verdict, best = verdict_of(facts, settings), optimum_worth(registration)
    distance = sigma_distance(facts, given, best.energy)
    headline, line = headline_of_pose(facts, verdict, distance)
    slip = SLIPS[objective.structure](registration, given, settings, verdict)
    return _assessment(
        registration,
        best,
        {
            "verdict": verdict,
            "headline": line,
            "green": headline.good,
            "energies": JudgedEnergies(
                objective=facts.worth.energy,
                optimum=best.energy,
                mean_square=facts.worth.mean_square,
                least_square=best.mean_square,
                bounds=facts.bounds,
                rounding_cost=facts.rounding_cost,
                of_what=WORDS[objective.structure].of_what,
            ),
            "words": words_of_pose(facts, verdict, given),
        },
        {**_numbers(facts, verdict), "sigma_distance": distance, "slip": slip},
    )


def _slip(
    registration: Registration,
    given: GivenPose,
    settings: AssessmentSettings,
    verdict: PoseVerdict,
) -> Slip | Absent:
    """Of one weight per pair."""
    if verdict in GOOD:
        return NOTHING_TO_EXPLAIN
    if verdict is PoseVerdict.NOT_A_ROTATION and registration.certificate is None:
        return NOT_TRIED
    if registration.solution.objective.scaling is not None:
        return NO_SCALED_SLIP
    return slip_of(registration, given, settings) or NO_SLIP


SLIPS: Mapping[Structure, Callable[..., Slip | Absent]] = {
    Structure.LINEAR: _slip,
    Structure.QUARTIC: lambda *_: NO_SPRING_SLIP,
}


def _no_rotation(
    registration: Registration, given: GivenPose, fault: str, settings: AssessmentSettings
) -> Assessment:
    verdict = PoseVerdict.NOT_A_ROTATION
    slip = SLIPS[registration.structure](registration, given, settings, verdict)
    return _assessment(
        registration,
        optimum_worth(registration),
        {"verdict": verdict, "headline": NO_ROTATION.said(fault=fault), "words": fault},
        {**dict.fromkeys(NUMBERS, Absent(fault)), "slip": slip},
    )


def _assessment(
    registration: Registration, best: PoseWorth, said: dict[str, Any], numbers: dict[str, Any]
) -> Assessment:
    """With the optimum beside the pose that is judged: what it costs itself, not rounded."""
    stated: dict[str, Any] = {
        **numbers,
        "optimum_objective": _double(best.energy, nearest_double),
        "optimum_rmse": _double(best.mean_square, nearest_root),
    }
    known: dict[str, Any] = {name: present(value) for name, value in stated.items()}
    return Assessment(
        **said,
        **known,
        optimum=registration.pose,
        fit=registration.fit,
        absent={name: value for name, value in stated.items() if isinstance(value, Absent)},
    )


def _numbers(facts: Findings, verdict: PoseVerdict) -> dict[str, Any]:
    """By name; where there is none, why not."""
    bounds = facts.bounds
    index, angle = _nearest(facts, verdict)
    no_angle = UNDECIDED if facts.unique is None else NOT_UNIQUE
    return {
        "objective": _double(facts.worth.energy, nearest_double),
        "rmse": _double(facts.worth.mean_square, nearest_root),
        "gap_lower": bounds.gap_lower,
        "gap_upper": bounds.gap_upper,
        "gap_share": bounds.stated("share_upper"),
        "gap_parts": NOT_SCALED if facts.parts is None else facts.parts,
        "rounding_cost": double_above(facts.rounding_cost),
        "angle_upper": bounds.stated("angle_upper"),
        "shift_upper": bounds.stated("shift_upper"),
        "angle_to_optimum": no_angle if facts.away is None else facts.away,
        "nearest_index": index,
        "nearest_angle": angle,
    }


def _nearest(facts: Findings, verdict: PoseVerdict) -> tuple[Any, Any]:
    """Index and angle of the equilibrium nearest to the pose; why there is none, twice."""
    rest = facts.place.rest
    number = None if rest is None else rest.number
    at_optimum = verdict in GOOD if number is None else not number
    if at_optimum and facts.away is not None:
        return 0, facts.away
    if rest is None or (number is None and verdict is not PoseVerdict.SPURIOUS_EQUILIBRIUM):
        return NOT_MET, NOT_MET
    return rest.index, rest.angle


def _double(value: Fraction | None, rounded: Callable[[Fraction], float | None]) -> float | Absent:
    """A double, or that there is none."""
    double = None if value is None else rounded(value)
    return OUT_OF_RANGE if double is None else double
