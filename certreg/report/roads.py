"""The roads to the equilibria side by side: a table and a JSON object."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from certreg.exact import nearest_double
from certreg.objective import potential_energy
from certreg.results import ComponentKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.equilibrium import Road, RoadAgreement, UndecidedRoad

PLURALS = {
    ComponentKind.POINT: ("point", "points"),
    ComponentKind.CIRCLE: ("circle", "circles"),
    ComponentKind.PROJECTIVE_PLANE: ("projective plane", "projective planes"),
    ComponentKind.ROTATION_GROUP: ("every rotation", "every rotation"),
}
HEADINGS = ("road", "solutions", "energies", "index", "time", "guarantee")
NO_LIST = "-"


def roads_summary(agreement: RoadAgreement) -> str:
    """The table of all roads, and what their agreement amounts to."""
    lines = [roads_table(agreement.roads, agreement.undecided)]
    decided = [each.method.value for each in agreement.roads if each.doubt is None]
    if len(decided) > 1:
        lines.append(
            f"The roads {', '.join(decided)} agree: rotations to {_degrees(agreement.angle)} "
            f"degrees, energies to {agreement.level:.0e} of their range."
        )
    doubts = [each.doubt for each in agreement.roads if each.doubt is not None]
    doubts += [each.reason for each in agreement.undecided]
    return "\n".join((*lines, *(f"Not decided by {doubt}" for doubt in doubts)))


def roads_table(roads: Sequence[Road], undecided: Sequence[UndecidedRoad] = ()) -> str:
    """A line for each road: what it found, how long it took, how it knows."""
    rows = [HEADINGS, *map(_row, roads), *map(_undecided_row, undecided)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(HEADINGS))]
    return "\n".join(
        ("  " + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    )


def roads_fields(agreement: RoadAgreement, reasons: dict[str, str]) -> dict[str, Any]:
    """The `roads` and `agreement` of a document; adds the reason of each null to `reasons`."""
    taken = [_fields(each, k, reasons) for k, each in enumerate(agreement.roads)]
    for k, each in enumerate(agreement.undecided, start=len(taken)):
        names = ("pattern", "energies", "indices", "guarantee")
        reasons |= {f"roads[{k}].{name}": each.reason for name in names}
        taken.append(
            {
                "method": each.method.value,
                **dict.fromkeys(names),
                "complete": False,
                "time_ms": 1e3 * each.seconds,
            }
        )
    return {
        "roads": taken,
        "agreement": {
            "rotation_deg": math.degrees(agreement.angle),
            "energy_relative": agreement.level,
        },
    }


def _fields(road: Road, place: int, reasons: dict[str, str]) -> dict[str, Any]:
    energies = _energies(road)
    if None in energies:
        reasons[f"roads[{place}].energies"] = "no double holds the value: change the unit of length"
    if None in road.indices:
        why = road.doubt or "the balls are too wide to tell the signs of the Hessian"
        reasons[f"roads[{place}].indices"] = why
    if road.doubt is not None:
        reasons[f"roads[{place}].complete"] = road.doubt
    return {
        "method": road.method.value,
        "pattern": list(road.found.classification.pattern),
        "energies": energies,
        "indices": list(road.indices),
        "guarantee": road.guarantee.label,
        "complete": road.doubt is None,
        "time_ms": 1e3 * road.seconds,
    }


def _energies(road: Road) -> list[float | None]:
    found = road.found
    return [nearest_double(potential_energy(found.moments, q)) for q in found.quaternions]


def _row(road: Road) -> tuple[str, ...]:
    kinds = road.found.classification.kinds
    energies = ["beyond doubles" if e is None else f"{e:.10g}" for e in _energies(road)]
    return (
        road.method.value,
        ", ".join(_counted(kind, kinds.count(kind)) for kind in dict.fromkeys(kinds)),
        " ".join(energies),
        " ".join(NO_LIST if index is None else str(index) for index in road.indices),
        f"{1e3 * road.seconds:.2f} ms",
        road.guarantee.label + ("" if road.doubt is None else ", in doubt"),
    )


def _undecided_row(road: UndecidedRoad) -> tuple[str, ...]:
    time = f"{1e3 * road.seconds:.2f} ms"
    return (road.method.value, NO_LIST, NO_LIST, NO_LIST, time, "undecided")


def _counted(kind: ComponentKind, count: int) -> str:
    if kind is ComponentKind.ROTATION_GROUP:
        return PLURALS[kind][0]
    return f"{count} {PLURALS[kind][count > 1]}"


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.0e}"
