"""The methods that searched for equilibria side by side: a table and a JSON object."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.exact.decimals import at_most
from certreg.exact.dyadic import nearest_double
from certreg.report.encoding import Document, Noted
from certreg.report.equilibria import equilibria_words
from certreg.results import OUT_OF_RANGE, Absent, ComponentKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.equilibrium.critical_set import CriticalSet
    from certreg.equilibrium.equilibrium_set import EquilibriumSet
    from certreg.equilibrium.methods import Comparison, Search
    from certreg.registration.enumeration import Enumeration


PLURALS = {
    ComponentKind.POINT: ("point", "points"),
    ComponentKind.CIRCLE: ("circle", "circles"),
    ComponentKind.PROJECTIVE_PLANE: ("projective plane", "projective planes"),
    ComponentKind.ROTATION_GROUP: ("every rotation", "every rotation"),
}
HEADINGS = ("road", "solutions", "energies", "index", "time", "guarantee")
NO_LIST = "-"
SPECTRAL = "spectral"  # of this method the table of the equilibria says everything


def enumeration_summary(enumeration: Enumeration[EquilibriumSet]) -> str:
    """The result of `equilibria`, readable; with the searches, where more than eigenspaces."""
    words = equilibria_words(enumeration.equilibria)
    methods = [each.method for each in enumeration.searches]
    return words if methods == [SPECTRAL] else f"{words}\n\n{methods_summary(enumeration)}"


def methods_summary(enumeration: Enumeration[EquilibriumSet]) -> str:
    """The table of all methods, and what their agreement amounts to; of one, the table alone."""
    lines, searches = [methods_table(enumeration)], enumeration.searches
    comparison = enumeration.comparison
    if comparison is None:  # the words about the equilibria have said what is in doubt
        return lines[0]
    found = [each.critical for each in searches if each.critical is not None]
    decided = [critical.method for critical in found if critical.complete]
    if len(decided) > 1:
        lines.append(agreement_words(decided, comparison))
    doubts = [critical.doubt for critical in found if critical.doubt is not None]
    doubts += [each.reason for each in searches if each.reason is not None]
    return "\n".join((*lines, *(f"Not decided by {doubt}" for doubt in doubts)))


def methods_table(enumeration: Enumeration[EquilibriumSet]) -> str:
    """A line for each method: what it found, how long it took, how it knows."""
    rows = [HEADINGS, *(_row(each, enumeration) for each in _decided_first(enumeration))]
    widths = [max(len(row[k]) for row in rows) for k in range(len(HEADINGS))]
    return "\n".join(
        ("  " + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    )


def methods_fields(enumeration: Enumeration[EquilibriumSet]) -> Document:
    """The `roads` and `agreement` of a document, to be encoded; empty if there was one method."""
    if enumeration.comparison is None:
        return {}
    return {
        "roads": [_fields(each, enumeration) for each in _decided_first(enumeration)],
        "agreement": {
            "rotation_deg": math.degrees(enumeration.comparison.angle),
            "energy_relative": enumeration.comparison.energy,
        },
    }


def _decided_first(enumeration: Enumeration[EquilibriumSet]) -> list[Search]:
    return sorted(enumeration.searches, key=lambda each: each.critical is None)


def _fields(each: Search, enumeration: Enumeration[EquilibriumSet]) -> Document:
    if each.critical is None:
        names = ("pattern", "energies", "indices", "guarantee")
        known = {**dict.fromkeys(names, Absent(each.reason or "")), "complete": False}
    else:
        known = _known_fields(each.critical, enumeration)
    return {"method": each.method, **known, "time_ms": 1e3 * each.seconds}


def _known_fields(critical: CriticalSet, enumeration: Enumeration[EquilibriumSet]) -> Document:
    energies, doubt = _energies(critical, enumeration), critical.doubt
    complete, indices = critical.complete, critical.indices
    undecided = doubt or "the balls are too wide to tell the signs of the Hessian"
    return {
        "pattern": critical.pattern,
        "energies": Noted(energies, OUT_OF_RANGE.reason) if None in energies else energies,
        "indices": Noted(indices, undecided) if None in indices else indices,
        "guarantee": critical.guarantee.label,
        "complete": complete if doubt is None else Noted(complete, doubt),
    }


def _energies(
    critical: CriticalSet, enumeration: Enumeration[EquilibriumSet]
) -> list[float | None]:
    energy = enumeration.objective.energy
    return [nearest_double(energy(part.quaternion)) for part in critical.components]


def _row(each: Search, enumeration: Enumeration[EquilibriumSet]) -> tuple[str, ...]:
    critical, time = each.critical, f"{1e3 * each.seconds:.2f} ms"
    if critical is None:
        return (each.method, NO_LIST, NO_LIST, NO_LIST, time, "undecided")
    kinds = [ComponentKind.of_multiplicity(m) for m in critical.pattern]
    energies = _energies(critical, enumeration)
    return (
        each.method,
        ", ".join(_counted(kind, kinds.count(kind)) for kind in dict.fromkeys(kinds)),
        " ".join("beyond doubles" if e is None else f"{e:.10g}" for e in energies),
        " ".join(NO_LIST if index is None else str(index) for index in critical.indices),
        time,
        critical.guarantee.label + ("" if critical.complete else ", in doubt"),
    )


def _counted(kind: ComponentKind, count: int) -> str:
    if kind is ComponentKind.ROTATION_GROUP:
        return PLURALS[kind][0]
    return f"{count} {PLURALS[kind][count > 1]}"


def agreement_words(methods: Sequence[str], comparison: Comparison) -> str:
    """How far the rotations and the energies of complete lists are apart."""
    degrees, share = at_most(math.degrees(comparison.angle), 1), at_most(comparison.energy, 1)
    return (
        f"The roads {', '.join(methods)} agree: rotations to {degrees} degrees, energies to "
        f"{share} of their range."
    )
