"""Independent roads to the equilibrium set, brought into one form and held against each other.

`spectral` reads eigenspaces, `groebner` eliminates, `homotopy` follows paths and proves their ends
in ball arithmetic. The last two start from the torque quadratics and share no argument with the
first. Roads that have decided must agree: the same components, rotations, indices and energies.
"""

from __future__ import annotations

import enum
import math
import time
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.spectral import Spectrum, resolved, spectrum
from certreg.errors import ContradictionError, UndecidedError
from certreg.exact import Eigenbasis
from certreg.geometry import davenport_matrix, dot
from certreg.objective import with_pattern
from certreg.results import Guarantee
from certreg.settings import RoadSettings

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from flint import arb
    from numpy.typing import NDArray

    from certreg.equilibrium.homotopy import Continuation
    from certreg.equilibrium.krawczyk import EigenBalls, RootBox
    from certreg.problem import ExactMoments

FIXED = 53  # fractional bits of a double near 1


class Method(enum.Enum):
    """A road to the equilibrium set; the value is its name for the user."""

    SPECTRAL = "spectral"
    GROEBNER = "groebner"
    HOMOTOPY = "homotopy"


@dataclass(frozen=True, slots=True, kw_only=True)
class Road:
    """Where a road ended.

    indices: the Morse-Bott index of each component; of the two algebraic roads from the Hessian of
        the energy, in ball arithmetic; None where it was not decided.
    doubt: why the list may not be complete; None: it is.
    seconds: how long it took.
    """

    method: Method
    found: Spectrum
    indices: tuple[int | None, ...]
    guarantee: Guarantee
    doubt: str | None
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class UndecidedRoad:
    """A road that did not come to an end, and why."""

    method: Method
    reason: str
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadAgreement:
    """All roads side by side, in agreement as far as they decided.

    angle: radians, the largest between rotations of the roads whose list is complete.
    level: the largest difference of their critical values, relative to the range of them.
    """

    roads: tuple[Road, ...]
    undecided: tuple[UndecidedRoad, ...]
    angle: float
    level: float


def road(moments: ExactMoments, method: Method) -> Road:
    """One road. Raises UndecidedError where it came to no list at all."""
    for name in _LIBRARIES[method]:
        import_module(name)  # loading a library is no part of the road
    start = time.perf_counter()
    end = _ROADS[method](moments)
    return Road(
        method=method,
        found=end.found,
        indices=end.indices,
        guarantee=end.guarantee,
        doubt=end.doubt,
        seconds=time.perf_counter() - start,
    )


def all_roads(moments: ExactMoments) -> RoadAgreement:
    """Every road, compared. Raises ContradictionError where two that decided disagree."""
    roads, undecided = list[Road](), list[UndecidedRoad]()
    for method in Method:
        start = time.perf_counter()
        try:
            roads.append(road(moments, method))
        except UndecidedError as error:
            seconds = time.perf_counter() - start
            undecided.append(UndecidedRoad(method=method, reason=str(error), seconds=seconds))
    return agreement_of(roads, undecided)


def agreement_of(roads: Sequence[Road], undecided: Sequence[UndecidedRoad] = ()) -> RoadAgreement:
    """The roads, held against the first, which is complete.

    A list in doubt may take near components together, no more. Raises ContradictionError where two
    roads disagree.
    """
    settings = RoadSettings()
    first, *others = roads
    angles, levels = [0.0], [0.0]
    for other in others:
        if other.doubt is not None:
            pattern = other.found.classification.pattern
            if not _merges(pattern, first.found.classification.pattern):
                raise ContradictionError(_disagreement(first, other))
            continue
        pairs = zip(first.indices, other.indices, strict=False)
        turned = any(None not in pair and pair[0] != pair[1] for pair in pairs)
        if turned or other.found.classification != first.found.classification:
            raise ContradictionError(_disagreement(first, other))
        angles.append(_angle(first.found, other.found))
        levels.append(_level_difference(first.found, other.found))
        if angles[-1] > settings.angle or levels[-1] > settings.level:
            raise ContradictionError(_disagreement(first, other, angles[-1]))
    return RoadAgreement(
        roads=tuple(roads), undecided=tuple(undecided), angle=max(angles), level=max(levels)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _End:
    """What a road comes to; see `Road`."""

    found: Spectrum
    indices: tuple[int | None, ...]
    guarantee: Guarantee
    doubt: str | None = None


def _spectral(moments: ExactMoments) -> _End:
    found = spectrum(moments)
    indices = found.classification.indices
    return _End(found=found, indices=indices, guarantee=Guarantee.EXACT)


def _groebner(moments: ExactMoments) -> _End:
    from certreg.equilibrium.groebner import Fibre, eliminate, fibres
    from certreg.exact import fixed_point, morse_bott_index

    elimination, shift = eliminate(moments.cross), _shift(moments)
    known: list[tuple[Fibre, ...]] = []

    def basis_of(bits: int) -> Eigenbasis:
        parts = fibres(elimination, bits)
        known.append(parts)
        rows = [(part.value, v) for part in parts for v in part.vectors]
        return Eigenbasis(
            values=tuple(fixed_point(value, bits - shift) for value, _ in rows),
            vectors=tuple(tuple(fixed_point(c, bits) for c in v) for _, v in rows),
            bits=bits,
            shift=shift,
        )

    pattern = tuple(part.dimension + 1 for part in fibres(elimination, RoadSettings().first_bits))
    found = resolved(moments, with_pattern(moments, pattern), basis_of)
    bits = 2 * found.basis.bits
    indices = tuple(
        morse_bott_index(moments.cross, part.vectors[0], part.dimension, bits=bits)
        for part in known[-1]
    )
    return _End(found=found, indices=indices, guarantee=Guarantee.EXACT)


def _homotopy(moments: ExactMoments) -> _End:
    """Four paths; their ends proved, and a count of at most four, make the list complete."""
    from certreg.equilibrium.counting import at_most_four
    from certreg.equilibrium.homotopy import HomotopyStatus, continuation

    ends = continuation(_scaled_davenport(moments)[None])
    counted = at_most_four(moments.cross)
    proved = None if counted is None else _proved(moments, ends)
    if proved is not None:
        return proved
    outcome = ends.outcomes[0]
    if outcome is not HomotopyStatus.CONTINUUM:
        raise UndecidedError(f"homotopy: {outcome.value}", method="homotopy")
    found = _numerical(moments, ends)
    return _End(
        found=found,
        indices=(None,) * len(found.groups),
        guarantee=Guarantee.NUMERICAL,
        doubt=f"homotopy: {outcome.value}",
    )


def _proved(moments: ExactMoments, ends: Continuation) -> _End | None:
    """The four ends in disjoint boxes with one root each; None where that is not proved."""
    from certreg.equilibrium.krawczyk import EigenBalls, are_distinct, proved_root, tightened
    from certreg.exact import exact_matrix, morse_bott_index

    shift, K = _shift(moments), davenport_matrix(moments.cross)
    balls = exact_matrix(K, shift)
    systems = [EigenBalls(balls, q) for q in ends.quaternions[0].tolist()]
    boxes = [
        proved_root(system, system.start(q))
        for system, q in zip(systems, ends.quaternions[0].tolist(), strict=True)
    ]
    if any(box is None for box in boxes):
        return None
    held = [(system, box) for system, box in zip(systems, boxes, strict=True) if box is not None]
    if not are_distinct([box for _, box in held]):
        return None
    held.sort(key=lambda pair: pair[1].coordinates[4].mid(), reverse=True)
    classification = with_pattern(moments, (1,) * len(held))
    found = resolved(moments, classification, partial(_basis_of_boxes, held, shift))
    bits = found.basis.bits
    indices = tuple(
        morse_bott_index(
            moments.cross, tightened(system, box, bits).coordinates[:4], 0, bits=2 * bits
        )
        for system, box in held
    )
    return _End(found=found, indices=indices, guarantee=Guarantee.ENCLOSED)


def _basis_of_boxes(
    held: Sequence[tuple[EigenBalls, RootBox]], shift: int, bits: int
) -> Eigenbasis:
    """Unit quaternions and values of proved roots, the boxes made small enough."""
    from flint import ctx

    from certreg.equilibrium.krawczyk import tightened
    from certreg.exact import fixed_point, orthonormal

    values, vectors = list[int](), list[tuple[int, ...]]()
    for system, box in held:
        *q, value = tightened(system, box, bits).coordinates
        with ctx.workprec(2 * bits):
            unit: tuple[arb, ...] = orthonormal([q], 1)[0]
        values.append(fixed_point(value, bits))
        vectors.append(tuple(fixed_point(c, bits) for c in unit))
    return Eigenbasis(values=tuple(values), vectors=tuple(vectors), bits=bits, shift=shift)


def _numerical(moments: ExactMoments, ends: Continuation) -> Spectrum:
    """The spectrum that the ends in doubles suggest, an orthonormal basis for each value."""
    pattern, settings = ends.patterns[0], RoadSettings()
    size = np.linalg.norm(_scaled_davenport(moments))
    values, vectors, start = list[int](), list[tuple[int, ...]](), 0
    for multiplicity in pattern:
        group = slice(start, start + multiplicity)
        frame = np.linalg.svd(ends.quaternions[0][group])[2][:multiplicity]
        level = float(ends.values[0][group].mean() * size)
        start += multiplicity
        for row in frame.tolist():
            values.append(_fixed(level, settings.first_bits))
            vectors.append(tuple(_fixed(entry, settings.first_bits) for entry in row))
    basis = Eigenbasis(
        values=tuple(values),
        vectors=tuple(vectors),
        bits=settings.first_bits,
        shift=_shift(moments),
    )
    classification = with_pattern(moments, pattern)
    return Spectrum(moments=moments, classification=classification, basis=basis, pose_bits=FIXED)


_LIBRARIES = {
    Method.SPECTRAL: (),
    Method.GROEBNER: ("certreg.equilibrium.groebner",),
    Method.HOMOTOPY: ("certreg.equilibrium.homotopy", "certreg.equilibrium.krawczyk"),
}
_ROADS: dict[Method, Callable[[ExactMoments], _End]] = {
    Method.SPECTRAL: _spectral,
    Method.GROEBNER: _groebner,
    Method.HOMOTOPY: _homotopy,
}


def _shift(moments: ExactMoments) -> int:
    """The entries of K are below 2^shift."""
    entries = (entry for row in davenport_matrix(moments.cross) for entry in row)
    return max(abs(entry) for entry in entries).bit_length()


def _scaled_davenport(moments: ExactMoments) -> NDArray[np.float64]:
    """K over 2^shift in doubles, each entry rounded once."""
    unit = 1 << _shift(moments)
    return np.array([[entry / unit for entry in row] for row in davenport_matrix(moments.cross)])


def _fixed(value: float, bits: int) -> int:
    """A double in fixed point."""
    return round(math.ldexp(value, FIXED)) << (bits - FIXED)


def _angle(one: Spectrum, other: Spectrum) -> float:
    """The largest angle in radians from a rotation of a basis to the component of the other."""
    bits = min(one.basis.bits, other.basis.bits)
    largest = 0
    for group in one.groups:
        span = [_rounded(other.basis, k, bits) for k in group]
        for v in (_rounded(one.basis, k, bits) for k in group):
            rest = list(v)
            for b in span:
                along = dot(v, b) >> bits
                rest = [r - (along * entry >> bits) for r, entry in zip(rest, b, strict=True)]
            largest = max(largest, math.isqrt(dot(rest, rest)))
    return 2.0 * math.asin(min(1.0, largest / (1 << bits)))


def _rounded(basis: Eigenbasis, k: int, bits: int) -> list[int]:
    return [entry >> (basis.bits - bits) for entry in basis.vectors[k]]


def _level_difference(one: Spectrum, other: Spectrum) -> float:
    """The largest difference of critical values, relative to their range."""
    bits = min(one.basis.bits, other.basis.bits)
    first, second = (
        [level >> (found.basis.bits - bits) for level in found.levels] for found in (one, other)
    )
    span = first[0] - first[-1] or 1 << bits
    return max(abs(a - b) for a, b in zip(first, second, strict=True)) / span


def _merges(coarse: Sequence[int], fine: Sequence[int]) -> bool:
    """Whether a pattern comes from another by taking neighbours together."""
    return set(accumulate(coarse)) <= set(accumulate(fine))


def _disagreement(one: Road, other: Road, angle: float = 0.0) -> str:
    sides = [
        f"{each.method.value} finds {each.found.classification.pattern} of indices {each.indices}"
        for each in (one, other)
    ]
    away = f", rotations up to {math.degrees(angle):.3g} degrees apart" if angle else ""
    return f"two roads disagree: {' and '.join(sides)}{away}; please report this problem"
