"""Judging a pose that any other tool returned: proved bounds, and which equilibrium it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack, cast

from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import double_above, nearest_double, nearest_root
from certreg.geometry.given import given_pose
from certreg.geometry.pose_matrix import why_no_rotation
from certreg.objective.structure import Structure
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.registration.assessed import Assessment
from certreg.registration.assessment_words import headline_of_pose, note_on, words_of_pose
from certreg.registration.certification import certify
from certreg.registration.convention_errors import slip_of
from certreg.registration.findings import (
    GOOD,
    AssessmentSettings,
    JudgedEnergies,
    cost_of_rounding,
    exact_pose,
    findings,
    sigma_distance,
    verdict_of,
)
from certreg.registration.headlines import NO_ROTATION
from certreg.registration.label_assessment import judged_labels
from certreg.registration.problem_arguments import (
    ProblemOptions,
    stated_in_clouds,
    stated_problem_of,
)
from certreg.registration.result import Registration
from certreg.registration.scaled_poses import NOT_SCALED, read_for, scale_note
from certreg.registration.spring_assessment import judged_on_springs
from certreg.results import OUT_OF_RANGE, Absent, PoseVerdict, present

if TYPE_CHECKING:
    from certreg.certificate.bounds import PoseBounds
    from certreg.geometry.given import GivenPose
    from certreg.registration.convention_errors import Slip
    from certreg.registration.findings import Findings
    from certreg.registration.label_assessment import LabelAssessment


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
OF_OPTIMUM = dict.fromkeys(("optimum_objective", "optimum_rmse"), OUT_OF_RANGE)
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
    if labels is not None or max_residual is not None or objective is not None:
        given = {"labels": labels, "max_residual": max_residual}
        sought = {"objective": objective, "effort": effort}
        judged_pairs = _judged_pairs(problem, pose, translation, given, sought, statement)
        return cast("Assessment", judged_pairs)
    if not isinstance(problem, RegistrationProblem | Registration):
        if translation is None or isinstance(pose, RegistrationProblem | Registration):
            raise InvalidProblemError(_unstated(problem, pose), array="problem")
        stated, _ = stated_in_clouds(problem, pose, statement, depth=3)
        problem, pose, translation = stated, translation, None
    elif statement:
        raise InvalidProblemError(
            f"{', '.join(statement)} beside a problem, which states it itself", array="problem"
        )
    if isinstance(pose, RegistrationProblem):
        raise InvalidProblemError(
            "pose is a RegistrationProblem: that comes first, and then the pose", array="pose"
        )
    given = given_pose(pose, translation)
    if isinstance(problem, RegistrationProblem):
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


def _unstated(problem: Any, pose: Any) -> str:
    """What was given where a problem is expected, in words."""
    swapped = isinstance(pose, RegistrationProblem | Registration)
    found = "the two the other way round" if swapped else f"a {type(problem).__name__}"
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
    settings, problem = settings or AssessmentSettings(), registration.problem
    given = read_for(problem, given)
    if registration.structure is Structure.QUARTIC:
        return judged_on_springs(registration, given, settings)
    turn = given.scaled_apart().turn if problem.scaled else given.turn
    fault = why_no_rotation(turn, settings.rotation_tolerance)
    if fault is not None:
        return _no_rotation(registration, given, fault, settings)
    exact = exact_pose(registration.solution.objective, given)
    facts = findings(registration, exact, cost_of_rounding(registration, given))
    verdict = verdict_of(facts, settings)
    slip = NOTHING_TO_EXPLAIN
    if verdict not in GOOD:
        slip = _slip(registration, given, settings)
    return _assessment(facts, verdict, given, slip)


def _slip(
    registration: Registration, given: GivenPose, settings: AssessmentSettings
) -> Slip | Absent:
    if registration.problem.scaled:
        return NO_SCALED_SLIP
    return slip_of(registration, given, settings) or NO_SLIP


def _no_rotation(
    registration: Registration, given: GivenPose, fault: str, settings: AssessmentSettings
) -> Assessment:
    slip = NOT_TRIED
    if registration.certificate is not None:
        slip = _slip(registration, given, settings)
    return Assessment(
        verdict=PoseVerdict.NOT_A_ROTATION,
        headline=NO_ROTATION.said(fault=fault),
        words=fault,
        slip=present(slip),
        **_beside(registration),
        absent={
            **dict.fromkeys(NUMBERS, Absent(fault)),
            **OF_OPTIMUM,
            **({"slip": slip} if isinstance(slip, Absent) else {}),
        },
    )


def _assessment(
    facts: Findings, verdict: PoseVerdict, given: GivenPose, slip: Slip | Absent
) -> Assessment:
    registration, bounds = facts.registration, facts.bounds
    distance = sigma_distance(facts, given)
    chosen, headline = headline_of_pose(facts, verdict, distance)
    return Assessment(
        verdict=verdict,
        headline=headline,
        green=chosen.good,
        energies=JudgedEnergies.of(facts),
        words=words_of_pose(facts, verdict) + _notes(facts, verdict, given),
        objective=nearest_double(facts.energy),
        rmse=nearest_root(facts.squares / registration.solution.moments.total_weight),
        gap_lower=bounds.gap_lower,
        gap_upper=bounds.gap_upper,
        gap_share=bounds.share_upper,
        gap_parts=facts.parts,
        rounding_cost=double_above(facts.rounding_cost),
        angle_upper=bounds.angle_upper,
        shift_upper=bounds.shift_upper,
        angle_to_optimum=facts.away,
        nearest_index=registration.equilibria.components[facts.nearest].morse_index,
        nearest_angle=facts.angles[facts.nearest],
        sigma_distance=present(distance),
        slip=present(slip),
        **_beside(registration),
        absent={
            **dict.fromkeys(("objective", "rmse"), OUT_OF_RANGE),
            **({} if facts.parts is not None else {"gap_parts": NOT_SCALED}),
            **_unbounded(bounds),
            **OF_OPTIMUM,
            **({"sigma_distance": distance} if isinstance(distance, Absent) else {}),
            **({"slip": slip} if isinstance(slip, Absent) else {}),
        },
    )


def _notes(facts: Findings, verdict: PoseVerdict, given: GivenPose) -> str:
    """What each part of the pose costs, and what was judged where that is not as it was given."""
    problem, parts = facts.registration.problem, facts.parts
    if parts is not None:
        costs = "" if verdict is PoseVerdict.OPTIMAL else parts.words
        return costs + scale_note(problem, given)
    return note_on(problem, given)


def _beside(registration: Registration) -> dict[str, Any]:
    """The optimum, to be held beside the pose that is judged: what it costs itself, not rounded."""
    best = registration.equilibria.components[0]
    return {
        "optimum": registration.pose,
        "optimum_objective": best.energy,
        "optimum_rmse": best.rmse,
        "fit": registration.fit,
    }


def _unbounded(bounds: PoseBounds) -> dict[str, Absent]:
    """Why there is no angle, or no share of the range of energies, if there is none."""
    names = {"angle_upper": "angle_upper", "share_upper": "gap_share"}
    return {names[name]: reason for name, reason in bounds.absent.items()}
