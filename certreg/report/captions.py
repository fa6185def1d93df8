"""Words for the pictures: the pose as a motion, and what each component of equilibria is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.report.summary import number
from certreg.results import ComponentKind

if TYPE_CHECKING:
    from certreg.equilibrium import Component, EquilibriumSet
    from certreg.registration import Registration

PLURALS = {
    ComponentKind.CIRCLE: "a circle of them",
    ComponentKind.PROJECTIVE_PLANE: "a projective plane of them",
    ComponentKind.ROTATION_GROUP: "every rotation",
}
NUMERALS = {1: "one axis", 2: "either of two axes", 3: "any of three axes"}
LARGE_FACTOR = 1.05  # below, a factor says nothing that the two numbers do not
LARGEST_FACTOR = 1e6  # above, it says nothing to anyone


def motion_words(registration: Registration) -> str:
    """The pose as a turn about an axis and a shift."""
    pose, unique = registration.pose, registration.equilibria.classification.unique
    which = "The best motion" if unique else "That pose"
    w, *axial = pose.quaternion_wxyz.tolist()
    length = math.hypot(*axial)
    shift = ", ".join(f"{entry:.6g}" for entry in pose.translation.tolist())
    if length == 0.0:
        return f"{which} turns nothing and shifts the source by ({shift})."
    degrees = math.degrees(2.0 * math.atan2(length, w))
    axis = ", ".join(f"{entry / length:.3f}" for entry in axial)
    turn = f"turns the source by {degrees:.4g}° about the axis ({axis})"
    return f"{which} {turn} and shifts it by ({shift})."


def trap_words(equilibria: EquilibriumSet) -> str | None:
    """How wrong the worst pose at rest is, and that a body leaves it; None if all are optimal."""
    worst, last = equilibria.components[-1], len(equilibria.components) - 1
    if worst.optimal or None in {worst.rmse, equilibria.components[0].rmse}:
        return None
    factor = factor_words(equilibria, last)
    unstable = worst.unstable_eigenvalues is not None
    return (
        f"The worst rotation, {math.degrees(worst.angle_to_optimum):.4g}° off, balances the "
        f"springs, too. It is wrong, with an RMSE of {number(worst.rmse)} instead of "
        f"{number(equilibria.components[0].rmse)}{f' ({factor})' if factor else ''}"
        f"{', and unstable: the smallest push ends it' if unstable else ''}."
    )


def component_name(equilibria: EquilibriumSet, index: int) -> str:
    """A short name for a button."""
    component = equilibria.components[index]
    single = component.kind is ComponentKind.POINT
    if component.optimal:
        return "Optimum" if single else f"Optima: {PLURALS[component.kind]}"
    name = "Worst rotation" if index == len(equilibria.components) - 1 else "Saddle"
    return name if single else f"{name}s: {PLURALS[component.kind]}"


def factor_words(equilibria: EquilibriumSet, index: int) -> str:
    """How many times as far apart the pairs are as at the optimum; empty where that says little."""
    best, here = equilibria.components[0].rmse, equilibria.components[index].rmse
    if not best or not here or not LARGE_FACTOR < here / best < LARGEST_FACTOR:
        return ""
    return f"{here / best:.3g} times the optimum's"


def component_words(equilibria: EquilibriumSet, index: int) -> str:
    """What is to be seen at a component, and why a body stays there or leaves."""
    component = equilibria.components[index]
    if component.optimal:
        return _optimal_words(component)
    factor = factor_words(equilibria, index)
    wrong = f"RMSE {number(component.rmse)}{f', {factor}' if factor else ''}"
    last = index == len(equilibria.components) - 1
    worst = " It is the worst rotation there is." if last else ""
    axes = NUMERALS[component.morse_index]
    return (
        f"All forces and torques balance here, and yet it is wrong: {wrong}.{worst} Turning about "
        f"{axes} lowers the energy, {_growth_words(component)}"
    )


def _growth_words(component: Component) -> str:
    count = component.unstable_eigenvalues
    if count is None:
        return "so it is no minimum."
    modes = "1 of the 12 eigenvalues has" if count == 1 else f"{count} of the 12 eigenvalues have"
    return (
        f"and so {modes} a positive real part: the smallest push grows, and the body leaves. "
        "Push it, and watch."
    )


def _optimal_words(component: Component) -> str:
    fit = f"RMSE {number(component.rmse)}"
    if component.kind is not ComponentKind.POINT:
        return (
            f"No pose is better than these, and all of them are exactly as good: {fit}. "
            "Move along them: the pairs come no closer, and get no farther apart."
        )
    stable = "" if component.unstable_eigenvalues is None else ", and the body comes back"
    return (
        f"The best pose there is: {fit}. Turned a little about any axis the energy rises{stable}."
    )
