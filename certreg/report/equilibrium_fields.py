"""Lists of equilibria as JSON: what stands under `equilibria` and `margin` of a document."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.equilibrium.line_set import Finiteness
from certreg.report.encoding import Document, Noted
from certreg.results import Absent, mapped

if TYPE_CHECKING:
    from certreg.equilibrium.equilibrium_set import Component, EquilibriumSet
    from certreg.registration.equilibria import (
        ScaledEquilibria,
        SpringEquilibria,
        SpringEquilibrium,
    )


NOT_SCALED_MODES = Absent("the motion with a free scale has more modes, which are not listed here")
NO_INSIDE_OUT = Absent("the symmetric scale is never below 0")
NO_EIGENVALUES = Absent("there are no eigenvalues of general springs to compare")
NO_PATTERN = Absent("defined for one weight per pair: general springs have no eigenvalues")
NOT_LINEARISED = Absent("the motion on general springs is not linearised in this version")


def rigid_fields(equilibria: EquilibriumSet) -> Document:
    """Of one weight per pair; what follows from the list being complete may be in doubt."""
    complete, doubt, known = equilibria.complete, equilibria.doubt, equilibria.classification
    pattern, finite = known.pattern, known.finite
    count, spurious = equilibria.stated("count"), equilibria.stated("spurious")
    if doubt is not None:
        count = spurious = Absent(doubt)
    return {
        "pattern": pattern if doubt is None else Noted(pattern, doubt),
        "finite": finite if doubt is None else Noted(finite, doubt),
        "count": count,
        "spurious": spurious,
        "guarantee": equilibria.guarantee.label,
        "complete": complete if doubt is None else Noted(complete, doubt),
        "components": [_component(component, doubt) for component in equilibria.components],
    }


def scaled_fields(equilibria: ScaledEquilibria) -> Document:
    """What a free scale changes: the scale of each, and the states inside out."""
    breathing = equilibria.breathing
    return {
        "finite": equilibria.finite,
        "count": equilibria.stated("count"),
        "spurious": equilibria.stated("spurious"),
        "components": [
            {
                **_component(each.component, None),
                "eigenvalues": NOT_SCALED_MODES,
                "rmse": each.stated("rmse"),
                "scale": each.stated("scale"),
            }
            for each in equilibria.components
        ],
        "inside_out": NO_INSIDE_OUT
        if breathing is None
        else [
            {"kind": each.kind.value, "scale": each.stated("scale"), "stable": each.stable}
            for each in breathing.inside_out
        ],
    }


def _component(component: Component, doubt: str | None) -> Document:
    """What follows from the list being complete is not told where that is in doubt."""
    optimal, index = component.optimal, component.morse_index
    unstable = component.stated("unstable_eigenvalues")
    return {
        "kind": component.kind.value,
        "dimension": component.kind.dimension,
        "basis": component.basis,
        "morse_index": index if doubt is None else Absent(doubt),
        "unstable_eigenvalues": unstable if doubt is None else Absent(doubt),
        "eigenvalues": component.stated("eigenvalues"),
        "witness": component.stated("witness"),
        "optimal": optimal if doubt is None else Noted(optimal, doubt),
        "energy": component.stated("energy"),
        "rmse": component.stated("rmse"),
        "rotation": component.rotation,
        "quaternion_wxyz": component.quaternion_wxyz,
        "angle_to_optimum_deg": math.degrees(component.angle_to_optimum),
    }


def margin_fields(equilibria: EquilibriumSet) -> Document:
    """How far the optimum is from being ambiguous."""
    margin, doubt = equilibria.margin, equilibria.doubt
    return {
        "eigenvalue_gap": margin.stated("eigenvalue_gap") if doubt is None else Absent(doubt),
        "relative": margin.relative if doubt is None else Absent(doubt),
        "nearly_ambiguous": equilibria.nearly_ambiguous,
    }


def spring_fields(equilibria: SpringEquilibria) -> Document:
    """What stands under `equilibria` of general springs."""
    doubt, count = equilibria.doubt, equilibria.stated("count")
    optimal = [part.optimal for part in equilibria.components]
    spurious: int | Absent = count
    if not isinstance(count, Absent):
        undecided = optimal.count(None)
        spurious = Absent("which are the best is not decided") if undecided else count - 1
    return {
        "pattern": NO_PATTERN,
        "finite": _finite(equilibria),
        "count": count,
        "count_real": count,
        "count_complex": equilibria.stated("count_complex"),
        "stable": equilibria.stated("stable"),
        "spurious": spurious,
        "guarantee": equilibria.guarantee.label,
        "undetermined": equilibria.stated("undetermined"),
        "complete": equilibria.complete if doubt is None else Noted(value=False, reason=doubt),
        "components": [_spring_component(part) for part in equilibria.components],
    }


def _finite(equilibria: SpringEquilibria) -> bool | Absent:
    known = {
        Finiteness.FORTY: True,
        Finiteness.FOUR: True,
        Finiteness.CONSTANT: False,
        Finiteness.SYMMETRIC: False,
    }
    finiteness = equilibria.finiteness
    return known[finiteness] if finiteness in known else Absent(finiteness.value)


def _spring_component(part: SpringEquilibrium) -> Document:
    index = part.stated("morse_index")
    return {
        "kind": part.kind.value,
        "dimension": part.kind.dimension,
        "basis": part.basis,
        "separated": part.separated,
        "morse_index": index,
        "stable": index if isinstance(index, Absent) else index == 0,
        "unstable_eigenvalues": NOT_LINEARISED,
        "eigenvalues": NOT_LINEARISED,
        "witness": part.stated("witness"),
        "optimal": part.stated("optimal"),
        "energy": part.stated("energy"),
        "energy_above_least": part.stated("above"),
        "rmse": part.stated("rmse"),
        "rotation": part.pose.rotation,
        "translation": part.pose.translation,
        "quaternion_wxyz": part.pose.quaternion_wxyz,
        "angle_to_first_deg": math.degrees(part.angle_to_first),
        "angle_to_optimum_deg": mapped(part.stated("angle_to_optimum"), math.degrees),
    }


def spring_margin_fields(equilibria: SpringEquilibria) -> Document:
    """How far the second energy is from the best: there are no eigenvalues."""
    return {
        "eigenvalue_gap": NO_EIGENVALUES,
        "relative": equilibria.stated("relative_margin"),
        "nearly_ambiguous": NO_EIGENVALUES,
    }
