"""All equilibria of general springs by continuation: 40 paths, their ends proved in boxes.

The ends of the paths (see `paths`) are proposals in doubles. Each real end, and one of each pair of
conjugates, gets a box that holds one critical line; with 40 lines apart and ranks that leave no
room for a 41st the list is complete. Where ends meet, the list says how many could not be told
apart.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from flint import ctx

from certreg.equilibrium.homotopy import HOMOTOPY
from certreg.equilibrium.line_boxes import BallQuartic, BoxedLine, all_different, boxed, index_of
from certreg.equilibrium.line_set import (
    BITS,
    LINES,
    Finiteness,
    LineSet,
    constant_set,
    critical_of,
    finiteness_of,
    line_set,
)
from certreg.equilibrium.paths import REAL, critical_lines
from certreg.equilibrium.tracking import REGULAR
from certreg.exact.balls import fixed_point, orthonormal
from certreg.objective.levelling import levelled_exactly
from certreg.results import Guarantee

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from certreg.equilibrium.critical_set import Critical
    from certreg.equilibrium.paths import CriticalLines
    from certreg.equilibrium.tracking import Complexes
    from certreg.objective.springs import Springs

    Numbers = NDArray[np.float64] | NDArray[np.complex128]

SPARE_BITS = 8
TIE_BITS = 1024  # to which two energies are told apart
MOST_SINGULAR = 8  # each costs as much as ten that are regular
SAME_END = 1e-2  # sine between ends that meet: of a line that is sixfold they are 2e-3 apart
NEARLY_REAL = 1e-2  # of such an end, the sine of the angle to its conjugate


def by_forty_paths(objective: Springs) -> LineSet:
    """The real ends of the 40 paths, proved where they are simple; what is not proved is said."""
    return proved_list(objective)


def proved_list(objective: Springs, ends: CriticalLines | None = None) -> LineSet:
    """The same from ends that are known already, of the same quartic but for rounding."""
    finiteness = finiteness_of(objective)
    if finiteness is Finiteness.CONSTANT:
        return constant_set(HOMOTOPY, objective)
    levelled = levelled_exactly(objective.quartic)
    ends = ends or critical_lines(levelled.rest)
    proved = proved_lines(BallQuartic(levelled), ends)
    real = [line for line in proved if line.is_real]
    parts, tied = proved_components(objective, real)
    whole = len(real) + 2 * (len(proved) - len(real)) == LINES
    rest = [] if whole else _unproved(ends.points, proved)
    parts += [_unproved_component(objective, q) for q in rest]
    why = f" {_rest_words(len(rest))}" if rest else ""
    return line_set(
        HOMOTOPY,
        sorted(parts, key=lambda part: part.value) if rest else parts,
        finiteness=finiteness,
        pairs=len(proved) - len(real),
        tied=tied,
        why=why,
    )


def proved_lines(quartic: BallQuartic, ends: CriticalLines) -> list[BoxedLine]:
    """Boxes with one line each, of real ends and of one of each pair of conjugates; all apart.

    Ends that are singular as far as doubles tell are tried where they are few: of a multiple line
    none can be proved. What is not proved to be another line than those before it is left out.
    """
    found: list[BoxedLine] = []
    singular = ends.codes != REGULAR
    few = np.count_nonzero(singular) <= MOST_SINGULAR
    for q in _halved(ends.points if few else ends.points[~singular]):
        line = None
        if np.linalg.norm(q.imag) < REAL:
            line = boxed(quartic, q.real.tolist(), real=True)
        found_line = line or boxed(quartic, q.tolist(), real=False)
        if found_line is not None:
            found.append(found_line)
    if all_different(found):
        return found
    kept: list[BoxedLine] = []
    for one in found:
        if all(all_different([one, other]) for other in kept):
            kept.append(one)
    return kept


def proved_components(objective: Springs, real: Sequence[BoxedLine]) -> tuple[list[Critical], int]:
    """Proved equilibria by ascending energy, and how many of the first may be the best."""
    lines = [line.within(BITS + SPARE_BITS) for line in real]
    with ctx.workprec(2 * BITS):
        lines.sort(key=lambda line: line.system.quartic.level(line.quaternion).mid())
    best = _least(lines)
    order = [*best, *(place for place in range(len(lines)) if place not in best)]
    return [_proved_component(objective, lines[place]) for place in order], len(best)


def _least(lines: Sequence[BoxedLine]) -> list[int]:
    """Which lines may have the least energy, told apart with up to `TIE_BITS`."""
    bits, several = BITS, list[tuple[int, BoxedLine]](enumerate(lines))
    while len(several) > 1 and bits <= TIE_BITS:
        several = [(place, line.within(bits)) for place, line in several]
        with ctx.workprec(2 * bits):
            levels = [line.system.quartic.level(line.quaternion) for _, line in several]
        least = min(levels, key=lambda level: level.mid())
        several = [
            one for one, level in zip(several, levels, strict=True) if not bool(level > least)
        ]
        bits *= 2
    return [place for place, _ in several]


def _halved(points: Complexes) -> Complexes:
    """The ends without those whose conjugate comes before them."""
    other = np.linalg.norm(points.imag, axis=1) >= REAL
    met = np.triu(_sines(points.conj(), points) < REAL, k=1)  # [j, k]: k is the conjugate of j
    return points[~(other & (met & other[:, np.newaxis]).any(axis=0))]


def _sines(p: Numbers, q: Numbers) -> NDArray[np.float64]:
    """(j, k): of the angles between lines, each given by a unit."""
    along = p.conj() @ q.T
    return np.linalg.norm(q[np.newaxis] - along[..., np.newaxis] * p[:, np.newaxis], axis=2)


def _proved_component(objective: Springs, line: BoxedLine) -> Critical:
    with ctx.workprec(2 * BITS):
        (unit,) = orthonormal([line.quaternion], 1)
    vector = [fixed_point(entry, BITS) for entry in unit]
    return critical_of(objective, vector, index_of(line), Guarantee.ENCLOSED)


def _unproved_component(objective: Springs, q: Complexes) -> Critical:
    entries = (q.real / np.linalg.norm(q.real)).tolist()
    vector = [int(entry * (1 << 60)) << (BITS - 60) for entry in entries]
    return critical_of(objective, vector, None, Guarantee.NUMERICAL)


def _unproved(points: Complexes, proved: Sequence[BoxedLine]) -> list[Complexes]:
    """Of ends without a box those that are nearly real, one of each place where some met."""
    rest = points[np.linalg.norm(points.imag, axis=1) <= NEARLY_REAL]
    if proved:
        known = np.array([_middle(line) for line in proved])
        near = np.minimum(_sines(known, rest), _sines(known.conj(), rest)).min(axis=0)
        rest = rest[near >= REAL]
    kept: list[Complexes] = []
    for q in rest:
        if not kept or _sines(np.array(kept), q[np.newaxis]).min() > SAME_END:
            kept.append(q)
    return kept


def _middle(line: BoxedLine) -> Complexes:
    """The middle of a box, a unit."""
    parts = [[float(c.real.mid()), float(c.imag.mid())] for c in line.quaternion]
    q = np.array(parts).view(np.complex128)[:, 0]
    q /= np.linalg.norm(q)
    return q


def _rest_words(places: int) -> str:
    where = "one rotation" if places == 1 else f"{places} rotations"
    return (
        f"Paths ended near {where} without a proof, listed as not separated: each may be no "
        "equilibrium, one, or several."
    )
