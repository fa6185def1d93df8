"""Results as plain sentences and a small table: what a person reads in a terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.results import ComponentKind, Optimality

if TYPE_CHECKING:
    from certreg.assessment import Assessment
    from certreg.equilibria.components import Component, EquilibriumSet
    from certreg.pipeline import Registration

COUNTS = {1: "one", 2: "two", 3: "three", 4: "four"}
KINDS = {
    ComponentKind.POINT: "point",
    ComponentKind.CIRCLE: "circle",
    ComponentKind.PROJECTIVE_PLANE: "projective plane",
    ComponentKind.ROTATION_GROUP: "every rotation",
}
WEAK_MARGIN = 1e-3  # below: wording only; a thousandth of the range separates right from wrong


def registration_summary(registration: Registration) -> str:
    """The result of `certify`, readable."""
    pose = registration.pose
    quaternion = " ".join(f"{entry:+.9f}" for entry in pose.quaternion_wxyz)
    translation = " ".join(f"{entry:.9g}" for entry in pose.translation)
    return "\n".join(
        (
            *_status_lines(registration),
            "",
            f"  correspondences   {registration.problem.n}",
            f"  rotation (wxyz)   {quaternion}",
            f"  translation       {translation}",
            f"  RMSE              {_number(registration.rmse)}",
            f"  ambiguity margin  {margin_words(registration.equilibria)}",
            "",
            equilibria_summary(registration.equilibria),
        )
    )


def equilibria_summary(equilibria: EquilibriumSet) -> str:
    """The equilibrium set as a sentence and a table."""
    rows = [("index", "kind", "RMSE", "energy", "to optimum", "unstable", "")]
    rows += [_row(component) for component in equilibria.components]
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    table = [
        ("  " + "  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    ]
    return "\n".join((count_words(equilibria), *table))


def count_words(equilibria: EquilibriumSet) -> str:
    """How many equilibria there are and how that is known, in one sentence."""
    classification = equilibria.classification
    spurious = classification.spurious
    if classification.finite:
        what = "exactly four equilibria: the optimum and three spurious ones"
    elif spurious == 0:
        what = "every pose is an equilibrium, and every one is optimal"
    elif spurious is None:
        what = "infinitely many spurious equilibria"
    else:
        what = f"infinitely many optima and exactly {COUNTS[spurious]} spurious equilibri" + (
            "um" if spurious == 1 else "a"
        )
    if not classification.unique and spurious is None:
        what = "infinitely many optima and " + what
    return f"Equilibria ({equilibria.guarantee.label}, complete): {what}."


def margin_words(equilibria: EquilibriumSet) -> str:
    """How far the optimum is from being ambiguous, in words."""
    margin = equilibria.margin
    if not equilibria.classification.unique:
        return "0: the optimum is not unique"
    percent = f"{100 * margin.relative:.3g} % of the range of energies"
    if margin.relative < WEAK_MARGIN:
        return f"{percent}: unique, but a small change of the data may turn the answer over"
    return f"{percent}: unique"


def assessment_summary(assessment: Assessment) -> str:
    """The result of `assess`, readable."""
    lines = [f"{assessment.verdict.value.upper()}. {assessment.words}"]
    if assessment.nearest_index is None:
        return lines[0]
    away = math.degrees(assessment.angle_to_optimum or 0.0)
    gap = f"between {_number(assessment.gap_lower)} and {_number(assessment.gap_upper)}"
    lines += [
        "",
        f"  RMSE               {_number(assessment.rmse)}",
        f"  objective          {_number(assessment.objective)}",
        f"  above the minimum  {gap} (proved)",
        f"  angle to optimum   {away:.6g} degrees",
    ]
    return "\n".join(lines)


def _status_lines(registration: Registration) -> list[str]:
    if registration.status is Optimality.NOT_CERTIFIED:
        return ["NOT CERTIFIED: the pose is computed, but its optimality was not proved."]
    bounds, ambiguity = registration.bounds, registration.equilibria.classification.ambiguity
    gap = _number(None if bounds is None else bounds.gap_upper)
    if ambiguity is not None:
        return [
            "CERTIFIED, BUT NOT UNIQUE: no pose is better, and infinitely many are as good:",
            f"{ambiguity.value}.",
            f"  proved gap        objective - minimum <= {gap}",
        ]
    angle = 0.0 if bounds is None or bounds.angle_upper is None else bounds.angle_upper
    return [
        "CERTIFIED: this is the global optimum, and it is unique.",
        f"  proved gap        objective - minimum <= {gap}",
        f"  proved angle      rotation within {math.degrees(angle):.2g} degrees of the optimum",
    ]


def _row(component: Component) -> tuple[str, ...]:
    unstable = component.unstable_eigenvalues
    return (
        str(component.morse_index),
        KINDS[component.kind],
        _number(component.rmse),
        _number(component.energy),
        f"{math.degrees(component.angle_to_optimum):.6g} deg",
        "undefined" if unstable is None else str(unstable),
        "optimal" if component.optimal else "",
    )


def _number(value: float | None) -> str:
    if value is None:
        return "(beyond doubles)"
    plain = 1e-4 <= abs(value) < 1e7 or value == 0
    return f"{value:.6f}" if plain else f"{value:.4g}"
