"""The methods that searched for equilibria side by side: a table and a JSON object."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.equilibrium.methods import FINDERS, Comparison, Search
from certreg.exact.decimals import at_most
from certreg.exact.dyadic import nearest_double
from certreg.objective.structure import Structure
from certreg.report.encoding import Document, Noted
from certreg.report.equilibrium_fields import NO_PATTERN
from certreg.results import OUT_OF_RANGE, Absent, ComponentKind, Guarantee

if TYPE_CHECKING:
    from certreg.equilibrium.critical_set import CriticalSet
    from certreg.registration.enumeration import Enumeration


PLURALS = {
    ComponentKind.POINT: ("point", "points"),
    ComponentKind.CIRCLE: ("circle", "circles"),
    ComponentKind.PROJECTIVE_PLANE: ("projective plane", "projective planes"),
    ComponentKind.ROTATION_GROUP: ("every rotation", "every rotation"),
}
NO_LIST = "-"
NOT_COMPARED = Absent("no list was proved complete")


@dataclass(frozen=True, slots=True, kw_only=True)
class Columns:
    """What the table has between the method and its time, and the pattern of a document."""

    head: tuple[str, ...]
    cells: Callable[[CriticalSet, list[float | None]], tuple[str, ...]]
    pattern: Callable[[CriticalSet], tuple[int, ...] | Absent]


def _cells_of_lines(critical: CriticalSet, energies: list[float | None]) -> tuple[str, ...]:
    """How many there are of each kind; each with its energy and its index."""
    kinds = [ComponentKind.of_multiplicity(m) for m in critical.pattern]
    return (
        ", ".join(_counted(kind, kinds.count(kind)) for kind in dict.fromkeys(kinds)),
        " ".join("beyond doubles" if e is None else f"{e:.10g}" for e in energies),
        " ".join(NO_LIST if index is None else str(index) for index in critical.indices),
    )


def _cells_of_springs(critical: CriticalSet, energies: list[float | None]) -> tuple[str, ...]:
    """How many there are, and of each index: forty energies are too many for a line."""
    if not energies:
        return ("none", NO_LIST)
    counts = " ".join(str(critical.indices.count(index)) for index in range(4))
    return (str(len(energies)), counts)


COLUMNS: Mapping[Structure, Columns] = {
    Structure.LINEAR: Columns(
        head=("solutions", "energies", "index"),
        cells=_cells_of_lines,
        pattern=lambda critical: critical.pattern,
    ),
    Structure.QUARTIC: Columns(
        head=("solutions", "index 0 1 2 3"),
        cells=_cells_of_springs,
        pattern=lambda _: NO_PATTERN,
    ),
}


def unusual(enumeration: Enumeration[Any]) -> bool:
    """Whether more was searched with than the usual method, of which the list says everything."""
    usual, *_ = FINDERS[enumeration.objective.structure]
    return [each.method for each in enumeration.searches] != [usual]


def methods_summary(enumeration: Enumeration[Any]) -> str:
    """The table of all methods, and what their agreement amounts to; of one, the table alone."""
    lines, searches = [methods_table(enumeration)], enumeration.searches
    comparison, said = enumeration.comparison, enumeration.equilibria.doubt
    decided = [each.method for each in searches if each.critical and each.critical.complete]
    if comparison is not None and len(decided) > 1:
        lines.append(agreement_words(decided, comparison))
    doubts = [each.critical.doubt if each.critical else each.reason for each in searches]
    lines += [
        f"Not decided by {each.method}: {doubt.removeprefix(f'{each.method}: ')}"
        for each, doubt in zip(searches, doubts, strict=True)
        if doubt is not None and doubt != said
    ]
    return "\n".join(lines)


def methods_table(enumeration: Enumeration[Any]) -> str:
    """A line for each method: what it found, how long it took, how it knows."""
    columns = COLUMNS[enumeration.objective.structure]
    rows = [
        ("road", *columns.head, "time", "guarantee"),
        *(_row(each, enumeration, columns) for each in _decided_first(enumeration)),
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        ("  " + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    )


def methods_fields(enumeration: Enumeration[Any]) -> Document:
    """The `roads` and `agreement` of a document, to be encoded; empty if there was one method."""
    if len(enumeration.searches) == 1:
        return {}
    comparison = enumeration.comparison
    return {
        "roads": [road_fields(each, enumeration) for each in _decided_first(enumeration)],
        "agreement": {
            "rotation_deg": NOT_COMPARED if comparison is None else math.degrees(comparison.angle),
            "energy_relative": NOT_COMPARED if comparison is None else comparison.energy,
        },
    }


def _decided_first(enumeration: Enumeration[Any]) -> list[Search]:
    return sorted(enumeration.searches, key=lambda each: each.critical is None)


def road_fields(each: Search, enumeration: Enumeration[Any]) -> Document:
    """What a method found, and how it knows."""
    if each.critical is None:
        names = ("pattern", "energies", "indices", "guarantee")
        known = {**dict.fromkeys(names, Absent(each.reason or "")), "complete": False}
    else:
        known = _known_fields(each.critical, enumeration)
    return {"method": each.method, **known, "time_ms": 1e3 * each.seconds}


def _known_fields(critical: CriticalSet, enumeration: Enumeration[Any]) -> Document:
    energies, doubt = _energies(critical, enumeration), critical.doubt
    complete, indices = critical.complete, critical.indices
    undecided = doubt or "the balls are too wide to tell the signs of the Hessian"
    return {
        "pattern": COLUMNS[enumeration.objective.structure].pattern(critical),
        "energies": Noted(energies, OUT_OF_RANGE.reason) if None in energies else energies,
        "indices": Noted(indices, undecided) if None in indices else indices,
        "guarantee": _guarantee(critical),
        "complete": complete if doubt is None else Noted(complete, doubt),
    }


def _guarantee(critical: CriticalSet) -> str:
    """That of the least sure component."""
    known = (part.guarantee for part in critical.components)
    return min(known, default=Guarantee.NUMERICAL).label


def _energies(critical: CriticalSet, enumeration: Enumeration[Any]) -> list[float | None]:
    energy = enumeration.objective.energy
    return [nearest_double(energy(part.quaternion)) for part in critical.components]


def _row(each: Search, enumeration: Enumeration[Any], columns: Columns) -> tuple[str, ...]:
    critical, time = each.critical, f"{1e3 * each.seconds:.2f} ms"
    if critical is None:
        return (each.method, *[NO_LIST] * len(columns.head), time, "undecided")
    known = [_guarantee(critical)] if critical.components else []
    words = ", ".join(known + ["in doubt"] * (not critical.complete))
    cells = columns.cells(critical, _energies(critical, enumeration))
    return (each.method, *cells, time, words)


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
