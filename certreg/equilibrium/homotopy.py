"""All equilibria by continuation: the ends of four paths, or of 40, proved in boxes.

With one weight per pair there are four paths (see `four_paths`): Krawczyk's test proves roots, with
K exact and a chart near the quaternion itself, and four disjoint boxes with the count of at most
four make the list complete.

On general springs there are 40 (see `paths`). Each real end, and one of each pair of conjugates,
gets a box that holds one critical line; with 40 lines apart and ranks that leave no room for a 41st
the list is complete. Where ends meet, the list says how many could not be told apart.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from flint import ctx

from certreg.equilibrium.critical_set import (
    Completeness,
    Critical,
    CriticalSet,
    spaces_as_components,
)
from certreg.equilibrium.four_paths import PATHS, Continuation, HomotopyStatus, continuation
from certreg.equilibrium.line_boxes import (
    BallMatrix,
    BallQuartic,
    BoxedLine,
    all_different,
    boxed,
    critical_at,
    index_of,
)
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
from certreg.equilibrium.paths import REAL, CriticalLines, critical_lines
from certreg.equilibrium.torques import at_most_four
from certreg.equilibrium.tracking import REGULAR
from certreg.errors import UndecidedError
from certreg.exact.balls import exact_matrix
from certreg.exact.spaces import Resolution, Space
from certreg.objective.normalisation import levelled_exactly
from certreg.results import Guarantee

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.equilibrium.tracking import (
        Complexes,
    )
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs

    Numbers = NDArray[np.float64] | NDArray[np.complex128]

HOMOTOPY = "homotopy"
DOUBLE_BITS = 53  # fractional bits of a double near 1
ENDS_BITS = 64  # of the ends in fixed point
SPARE_BITS = 8
TIE_BITS = 1024  # to which two energies are told apart
MOST_SINGULAR = 8  # each costs as much as ten that are regular
SAME_END = 1e-2  # sine between ends that meet: of a line that is sixfold they are 2e-3 apart
NEARLY_REAL = 1e-2  # of such an end, the sine of the angle to its conjugate


def by_continuation(objective: Isotropic) -> CriticalSet:
    """Four paths; their ends proved, and a count of at most four, make the list complete.

    Without these the ends in doubles, in doubt, where they look like a continuum; UndecidedError
    where they are no list at all.
    """
    unit = 1 << objective.shift
    scaled = np.array([[entry / unit for entry in row] for row in objective.davenport])
    ends = continuation(scaled[None])
    balls = BallMatrix(-exact_matrix(objective.davenport, objective.shift))
    boxes = (boxed(balls, q, real=True) for q in ends.quaternions[0].tolist())
    lines = [line for line in boxes if line is not None]
    if len(lines) == PATHS and all_different(lines) and at_most_four(objective.moments.cross):
        return _in_order(objective, lines)
    outcome = ends.outcomes[0]
    if outcome is not HomotopyStatus.CONTINUUM:
        raise UndecidedError(f"homotopy: {outcome.value}", method=HOMOTOPY)
    spaces = _ends_in_doubles(ends, float(np.linalg.norm(scaled)))
    return CriticalSet(
        method=HOMOTOPY,
        components=spaces_as_components(
            Resolution(spaces=spaces, bits=ENDS_BITS, pose_bits=DOUBLE_BITS),
            objective.energy_of_eigenvalue,
            (None,) * len(spaces),
            Guarantee.NUMERICAL,
        ),
        bits=ENDS_BITS,
        completeness=None,
        doubt=f"homotopy: {outcome.value}",
    )


def _in_order(objective: Isotropic, lines: list[BoxedLine]) -> CriticalSet:
    """Four proved lines by energy, which differs: in boxes so small that this is seen."""
    bits = BITS
    while True:
        lines = [line.within(bits + SPARE_BITS) for line in lines]
        with ctx.workprec(2 * bits):
            levels = [line.system.form.level(line.quaternion) for line in lines]
            order = sorted(range(PATHS), key=lambda k: levels[k].mid())
            if all(bool(levels[j] < levels[k]) for j, k in pairwise(order)):
                break
        bits *= 2
    with ctx.workprec(2 * bits):
        parts = ((lines[k].quaternion, index_of(lines[k])) for k in order)
        components = tuple(critical_at(objective, *part, bits) for part in parts)
    return CriticalSet(
        method=HOMOTOPY, components=components, bits=bits, completeness=Completeness.COUNT
    )


def _ends_in_doubles(ends: Continuation, size: float) -> tuple[Space, ...]:
    """What the ends suggest: an orthonormal frame for each value. size: norm of K, scaled."""
    spaces, start = list[Space](), 0
    for multiplicity in ends.patterns[0]:
        group = slice(start, start + multiplicity)
        frame = np.linalg.svd(ends.quaternions[0][group])[2][:multiplicity]
        value = _fixed(float(ends.values[0][group].mean() * size))
        start += multiplicity
        vectors = tuple(tuple(_fixed(entry) for entry in row) for row in frame.tolist())
        spaces.append(Space(values=(value,) * multiplicity, vectors=vectors))
    return tuple(spaces)


def _fixed(value: float) -> int:
    """A double in fixed point."""
    return round(math.ldexp(value, DOUBLE_BITS)) << (ENDS_BITS - DOUBLE_BITS)


def proved_list(objective: Springs, ends: CriticalLines | None = None) -> LineSet:
    """The real ends of the 40 paths, proved where they are simple; what is not proved is said.

    ends: where they are known already, of the same quartic but for rounding.
    """
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
        lines.sort(key=lambda line: line.system.form.level(line.quaternion).mid())
    best = _least(lines)
    order = [*best, *(place for place in range(len(lines)) if place not in best)]
    with ctx.workprec(2 * BITS):
        parts = [critical_at(objective, lines[k].quaternion, index_of(lines[k])) for k in order]
    return parts, len(best)


def _least(lines: Sequence[BoxedLine]) -> list[int]:
    """Which lines may have the least energy, told apart with up to `TIE_BITS`."""
    bits, several = BITS, list[tuple[int, BoxedLine]](enumerate(lines))
    while len(several) > 1 and bits <= TIE_BITS:
        several = [(place, line.within(bits)) for place, line in several]
        with ctx.workprec(2 * bits):
            levels = [line.system.form.level(line.quaternion) for _, line in several]
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
