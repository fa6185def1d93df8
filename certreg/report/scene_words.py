"""What is to be seen of each pose at rest, in sentences, and why a body stays there or leaves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.problem.moments import trace
from certreg.problem.motion import TRANSLATION
from certreg.report.lines import number
from certreg.results import ComponentKind

if TYPE_CHECKING:
    from certreg.equilibrium.equilibrium_set import Component, EquilibriumSet
    from certreg.registration.result import Registration

PLURALS = {
    ComponentKind.CIRCLE: "a circle of them",
    ComponentKind.PROJECTIVE_PLANE: "a projective plane of them",
    ComponentKind.ROTATION_GROUP: "every rotation",
}
NUMERALS = {1: "one axis", 2: "either of two axes", 3: "any of three axes"}
AT_ONE_PLACE = "coincide", "are all at the origin"  # and where all turn about the origin
ON_ONE_LINE = "are on one line", "are on one line through the origin"
LARGE_FACTOR = 1.05  # below, a factor says nothing that the two numbers do not
LARGEST_FACTOR = 1e6  # above, the number means nothing to a reader


def trap_words(equilibria: EquilibriumSet, rmse: float | None = None) -> str | None:
    """How much worse the worst stationary pose fits, and that bodies leave it.

    None if all are optimal. rmse: that of the pose as printed, where the page tells it; else of the
    exact optimum.
    """
    worst, last = equilibria.components[-1], len(equilibria.components) - 1
    if worst.optimal or None in {worst.rmse, equilibria.components[0].rmse}:
        return None
    optimum = equilibria.components[0].rmse if rmse is None else rmse
    factor, best = factor_words(equilibria, last), number(optimum)
    fit = f"with an RMSE of {number(worst.rmse)} instead of {best}"
    if number(worst.rmse) == best:
        fit = f"though its RMSE is {best}, as the optimum's is, in these digits"
    unstable = worst.unstable_eigenvalues is not None
    single = worst.kind is ComponentKind.POINT
    return (
        f"{'The worst rotation' if single else 'One of the worst rotations'}, "
        f"{math.degrees(worst.angle_to_optimum):.4g}° off, balances the "
        f"springs, too. It is not the best, {fit}{f' ({factor})' if factor else ''}"
        f"{', and unstable: a push, however small, can end it' if unstable else ''}."
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
    fit = f"RMSE {number(component.rmse)}{f', {factor}' if factor else ''}"
    last = index == len(equilibria.components) - 1
    single = component.kind is ComponentKind.POINT
    worst = "It is the worst rotation there is" if single else "No rotation is worse than these"
    worst = f" {worst}." if last else ""
    axes = NUMERALS[component.morse_index]
    return (
        f"All forces and torques balance here, but the fit is not the best: {fit}.{worst} Turning "
        f"about {axes} lowers the energy, {_growth_words(component)}"
    )


def _growth_words(component: Component) -> str:
    count = component.unstable_eigenvalues
    if count is None:
        return "so it is no minimum."
    which = "its mode" if count == 1 else "their modes"
    modes = "1 of the 12 eigenvalues has" if count == 1 else f"{count} of the 12 eigenvalues have"
    return (
        f"and so {modes} a positive real part: along {which} a push grows, however small, "
        "and the body leaves."
    )


def _optimal_words(component: Component) -> str:
    if component.kind is not ComponentKind.POINT:
        return "No pose is better than these, and all of them are exactly as good: move along them."
    stable = "" if component.unstable_eigenvalues is None else ", and the body comes back"
    return f"No pose fits better. Turned a little about any axis, the energy rises{stable}."


def lie_words(registration: Registration) -> str:
    """How source points lie for which no dynamics is defined."""
    one = not trace(registration.solution.moments.source_scatter)
    anywhere, about_origin = AT_ONE_PLACE if one else ON_ONE_LINE
    return next(iter(registration.problem.motion.lacking(((TRANSLATION, about_origin),))), anywhere)
