"""The equilibria of general springs: sentences and a table, a JSON document, a card."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.equilibrium.line_set import Finiteness
from certreg.exact.dyadic import nearest_double
from certreg.report.cards import Card
from certreg.report.encoding import Document, Noted, encoded
from certreg.report.fields import degrees
from certreg.report.lines import number
from certreg.report.methods import agreement_words
from certreg.results import OUT_OF_RANGE, Absent, ComponentKind, Guarantee

if TYPE_CHECKING:
    from certreg.equilibrium.line_set import LineSet
    from certreg.equilibrium.methods import Search
    from certreg.registration.enumeration import Enumeration
    from certreg.registration.spring_equilibria import SpringEquilibria, SpringEquilibrium


SCHEMA = "certreg-equilibria/1"
HEADINGS = ("index", "stable", "RMSE", "energy")
NOTHING = "0 to rounding"  # of a proved equilibrium: less than its energy is known to
ROADS = ("road", "solutions", "index 0 1 2 3", "time", "guarantee")
NO_PATTERN = Absent("defined for one weight per pair: general springs have no eigenvalues")
NOT_LINEARISED = Absent("the motion on general springs is not linearised in this version")
NO_EIGENVALUES = Absent("there are no eigenvalues of general springs to compare")
NO_MINIMUM = (
    "None of these is the optimum: at the first, too, the energy falls in some direction. "
    "`certify` gives the best pose, and needs no list."
)
STAYS = (
    "A body that is released near a stable equilibrium stays there: not every stable one is the "
    "optimum."
)


def spring_enumeration_summary(enumeration: Enumeration[SpringEquilibria]) -> str:
    """The result of `equilibria` for general springs, readable; with the methods, if several."""
    words = spring_equilibria_words(enumeration.equilibria)
    if len(enumeration.searches) == 1:
        return words
    return f"{words}\n\n{_methods_words(enumeration)}"


def spring_equilibria_words(equilibria: SpringEquilibria) -> str:
    """How many there are and how that is known, a table, and what must be said beside it."""
    notes = [spring_count_words(equilibria), *_table(_rows(equilibria))]
    return "\n".join([*notes, *spring_notes(equilibria), *_open_notes(equilibria)])


def _open_notes(equilibria: SpringEquilibria) -> list[str]:
    """What the springs leave open, or hardly resist, as a sentence."""
    words = equilibria.undetermined
    return [f"{words[:1].upper()}{words[1:]}."] if words else []


def spring_count_words(equilibria: SpringEquilibria) -> str:
    """How many equilibria there are and how that is known, in one sentence."""
    if equilibria.finiteness is Finiteness.SYMMETRIC:
        return f"Equilibria (exact): infinitely many; {_apart(equilibria)}."
    known = f"{equilibria.guarantee.label}, {'' if equilibria.complete else 'not proved '}complete"
    return f"Equilibria ({known}): {_counted(equilibria)}."


def _counted(equilibria: SpringEquilibria) -> str:
    if equilibria.finiteness is Finiteness.CONSTANT:
        return "every rotation is an equilibrium, and every one is optimal"
    count, stable = equilibria.count, equilibria.stable
    if count is not None:
        return f"exactly {count}, of which {stable} stable"
    return f"not counted; {_apart(equilibria)}"


def _apart(equilibria: SpringEquilibria) -> str:
    if not equilibria.components:
        return "none is listed"
    apart = sum(part.separated for part in equilibria.components)
    return f"{ {0: 'none', 1: 'one'}.get(apart, apart) } proved to be isolated"


def spring_notes(equilibria: SpringEquilibria) -> list[str]:
    """What must be said beside the table."""
    notes: list[str] = []
    if equilibria.doubt is not None:
        ruled_out = [part.optimal is False for part in equilibria.components]
        saddles = [NO_MINIMUM] if ruled_out and all(ruled_out) else []
        return [f"Not proved complete: {equilibria.doubt}", *saddles]
    if equilibria.count is None:
        return notes
    euler = f"the Euler sum of the indices is {equilibria.euler_sum}, as that of all must be."
    if equilibria.count_complex is None:
        notes.append(
            f"{equilibria.finiteness.value} Each is proved to be alone in a box around it; {euler}"
        )
    else:
        notes.append(
            f"All 40 critical lines, complex ones included, are simple: {equilibria.count} "
            f"rotations and {equilibria.pairs} conjugate pairs, each proved to be alone in a box "
            f"around it; {euler}"
        )
    if equilibria.tied > 1:
        notes.append(
            f"Not decided which is best: the first {equilibria.tied} have the same energy, as far "
            "as 300 digits tell."
        )
    elif (equilibria.stable or 0) > 1:
        notes.append(STAYS)
    return notes


def _rows(equilibria: SpringEquilibria) -> list[tuple[str, ...]]:
    parts = equilibria.components
    if not parts:
        return []
    head = (*HEADINGS, "to row 1" if parts[0].angle_to_optimum is None else "to optimum", "")
    return [head, *(_row(part, parts[0]) for part in parts)]


def _row(part: SpringEquilibrium, first: SpringEquilibrium) -> tuple[str, ...]:
    return (
        "-" if part.morse_index is None else str(part.morse_index),
        {True: "yes", False: "no", None: "-"}[part.stable],
        magnitude(part, part.rmse),
        magnitude(part, part.energy),
        f"{math.degrees(part.angle_to_first):.6g} deg",
        _place_words(part, first),
    )


def magnitude(part: SpringEquilibrium, value: float | None) -> str:
    """The energy or the RMSE of an equilibrium."""
    return NOTHING if value == 0.0 and part.kind is ComponentKind.POINT else number(value)


def _place_words(part: SpringEquilibrium, first: SpringEquilibrium) -> str:
    """Whether it is the optimum; of one that shows the energy of the first, by how much not."""
    if not part.separated:
        return "not separated"
    if part.optimal is not False:
        return "optimal" if part.optimal else "may be optimal"
    same = part.above and number(part.energy) == number(first.energy)
    return f"higher by {part.above:.1e}" if same else ""


def _table(rows: list[tuple[str, ...]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        ("  " + "  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    ]


# --- methods side by side


def _methods_words(enumeration: Enumeration[SpringEquilibria]) -> str:
    rows = [ROADS, *map(_road, enumeration.searches)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        ("  " + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True))).rstrip()
        for row in rows
    ]
    comparison, found = enumeration.comparison, _found(enumeration)
    decided = [critical.method for critical in found if critical.complete]
    if comparison is not None and len(decided) > 1:
        lines.append(agreement_words(decided, comparison))
    said = enumeration.equilibria.doubt
    doubts = [
        each.critical.doubt if each.critical else each.reason for each in enumeration.searches
    ]
    lines += [
        f"Not decided by {each.method}: {doubt.removeprefix(f'{each.method}: ')}"
        for each, doubt in zip(enumeration.searches, doubts, strict=True)
        if doubt is not None and doubt != said
    ]
    return "\n".join(lines)


def _found(enumeration: Enumeration[SpringEquilibria]) -> list[LineSet]:
    return [each.critical for each in enumeration.searches if each.critical is not None]  # pyright: ignore[reportReturnType]


def _road(each: Search) -> tuple[str, ...]:
    critical, time = each.critical, f"{1e3 * each.seconds:.1f} ms"
    if critical is None:
        return (each.method, "-", "-", time, "undecided")
    if not critical.components:
        return (each.method, "none", "-", time, "in doubt")
    counts = " ".join(str(critical.indices.count(index)) for index in range(4))
    known = "" if critical.complete else ", in doubt"
    found = len(critical.components)
    label = min((p.guarantee for p in critical.components), default=Guarantee.NUMERICAL).label
    return (each.method, str(found), counts, time, f"{label}{known}")


# --- JSON


def spring_equilibria_document(enumeration: Enumeration[SpringEquilibria]) -> Document:
    """The equilibria of general springs as `certreg-equilibria/1`."""
    found = enumeration.equilibria
    return encoded({**_set(found), **_roads(enumeration)})


def spring_set_document(equilibria: SpringEquilibria) -> Document:
    """As `spring_equilibria_document`, without searches."""
    return encoded(_set(equilibria))


def _set(equilibria: SpringEquilibria) -> Document:
    return {
        "schema": SCHEMA,
        "equilibria": spring_equilibria_fields(equilibria),
        "margin": {
            "eigenvalue_gap": NO_EIGENVALUES,
            "relative": equilibria.stated("relative_margin"),
            "nearly_ambiguous": NO_EIGENVALUES,
        },
    }


def spring_equilibria_fields(equilibria: SpringEquilibria) -> Document:
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
        "components": [_component(part) for part in equilibria.components],
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


def _component(part: SpringEquilibrium) -> Document:
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
        "angle_to_optimum_deg": degrees(part.stated("angle_to_optimum")),
    }


def _roads(enumeration: Enumeration[SpringEquilibria]) -> Document:
    """The `roads`, and the `agreement` of those that have decided."""
    if len(enumeration.searches) == 1:
        return {}
    comparison = enumeration.comparison
    agreement = Absent("no list was proved complete")
    return {
        "roads": [_road_fields(each, enumeration) for each in enumeration.searches],
        "agreement": {
            "rotation_deg": agreement if comparison is None else math.degrees(comparison.angle),
            "energy_relative": agreement if comparison is None else comparison.energy,
        },
    }


def _road_fields(each: Search, enumeration: Enumeration[SpringEquilibria]) -> Document:
    critical = each.critical
    if critical is None:
        names = ("pattern", "energies", "indices", "guarantee")
        missing = Absent(each.reason or "")
        known = {**dict.fromkeys(names, missing), "complete": False}
    else:
        energy = enumeration.objective.energy
        energies = [nearest_double(energy(part.quaternion)) for part in critical.components]
        doubt = critical.doubt
        undecided = None in critical.indices and doubt is not None
        known = {
            "pattern": NO_PATTERN,
            "energies": Noted(energies, OUT_OF_RANGE.reason) if None in energies else energies,
            "indices": Noted(critical.indices, doubt or "") if undecided else critical.indices,
            "guarantee": min(
                (part.guarantee for part in critical.components), default=Guarantee.NUMERICAL
            ).label,
            "complete": True if doubt is None else Noted(value=False, reason=doubt),
        }
    return {"method": each.method, **known, "time_ms": 1e3 * each.seconds}


# --- a card


def spring_equilibria_card(equilibria: SpringEquilibria) -> str:
    """All equilibria as a table."""
    head, *rows = _rows(equilibria) or [()]
    return Card(
        headline=spring_count_words(equilibria),
        notes=[*spring_notes(equilibria), *_open_notes(equilibria)],
        head=head,
        rows=rows,
    ).html()
