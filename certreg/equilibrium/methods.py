"""Independent searches for the equilibria, by name, and how their results are compared.

`spectral` reads eigenspaces, `groebner` eliminates, `homotopy` follows paths and proves their ends
in ball arithmetic. The last two start from the torque quadratics and share no argument with the
first; of general springs they are all there is. Methods that have decided must agree: the same
components, rotations, indices and energies.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

from certreg._loading import found_late, library
from certreg.equilibrium.critical_set import CriticalSet
from certreg.errors import ContradictionError, UndecidedError
from certreg.exact.decimals import at_most
from certreg.geometry.so3 import dot
from certreg.objective.structure import Structure
from certreg.problem.support import Cell, Verb, refusal
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs


Method = Callable[[Any], CriticalSet]  # of the objective that it is for

LARGEST_ANGLE = 1e-10  # radians; spans of complete lists hold 28 digits and more
LARGEST_DIFFERENCE = 1e-12  # of the range of energies


@dataclass(frozen=True, slots=True, kw_only=True)
class Search(Brief):
    """What a method came to, and how long it took.

    critical: None where it came to no list, and then `reason` says why.
    """

    method: str
    critical: CriticalSet | None
    reason: str | None
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """How well complete lists agree.

    angle: radians, the largest between rotations. energy: the largest difference of the values at
    critical rotations, relative to the range of them.
    """

    angle: float
    energy: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Finder:
    """One way to all equilibria of an objective.

    verb: what asks for it. found: gives the function, loaded when it is first asked for, because
    ball arithmetic and elimination are not light. needs: a library of others.
    """

    verb: Verb
    found: Callable[[], Method]
    needs: str | None = "flint"

    @property
    def method(self) -> Method:
        """The function, its libraries loaded."""
        if self.needs is not None:
            library(self.needs, f"the method {self.verb.value}")
        return self.found()

    def accepts(self, cell: Cell) -> bool:
        """Whether it lists the equilibria of such problems."""
        return refusal(cell, self.verb) is None


def _by_name(*finders: Finder) -> dict[str, Finder]:
    return {each.verb.value: each for each in finders}


FINDERS: Mapping[Structure, Mapping[str, Finder]] = {  # the first is the usual one
    Structure.LINEAR: _by_name(
        Finder(
            verb=Verb.SPECTRAL,
            found=found_late("certreg.equilibrium.critical_set", "by_eigenspaces"),
            needs=None,
        ),
        Finder(
            verb=Verb.GROEBNER,
            found=found_late("certreg.equilibrium.groebner", "by_elimination"),
        ),
        Finder(
            verb=Verb.HOMOTOPY,
            found=found_late("certreg.equilibrium.homotopy", "by_continuation"),
        ),
    ),
    Structure.QUARTIC: _by_name(
        Finder(
            verb=Verb.HOMOTOPY,
            found=found_late("certreg.equilibrium.homotopy", "proved_list"),
        ),
        Finder(
            verb=Verb.GROEBNER,
            found=found_late("certreg.equilibrium.quotient_ring", "by_quotient_ring"),
        ),
    ),
}


def search(objective: Isotropic | Springs, name: str) -> Search:
    """The search by one method; loading a library is no part of it."""
    method = FINDERS[objective.structure][name].method
    critical, reason, start = None, None, time.perf_counter()
    try:
        critical = method(objective)
    except UndecidedError as error:
        reason = str(error)
    seconds = time.perf_counter() - start
    return Search(method=name, critical=critical, reason=reason, seconds=seconds)


def compare(sets: Sequence[CriticalSet]) -> Comparison:
    """The lists, held against the first, which is complete.

    A list in doubt may take near components together, no more. Raises ContradictionError where two
    disagree.
    """
    first, *others = sets
    angles, energies = [0.0], [0.0]
    for found in others:
        other = _in_order_of(first, found)
        if not other.complete:
            if not _merges(other.pattern, first.pattern):
                raise _disagreement(first, other)
            continue
        pairs = zip(first.indices, other.indices, strict=False)
        turned = any(None not in pair and pair[0] != pair[1] for pair in pairs)
        if turned or other.pattern != first.pattern:
            raise _disagreement(first, other)
        angles.append(_angle(first, other))
        energies.append(_energy_difference(first, other))
        if angles[-1] > LARGEST_ANGLE or energies[-1] > LARGEST_DIFFERENCE:
            raise _disagreement(first, other, angles[-1])
    return Comparison(angle=max(angles), energy=max(energies))


def _in_order_of(first: CriticalSet, other: CriticalSet) -> CriticalSet:
    """Points in the order of the nearest ones of another list: equal energies come in any order."""
    if other.pattern != first.pattern or set(first.pattern) != {1} or not _ascending(other):
        return other
    spans = [part.span[0] for part in other.components]
    order = [
        max(range(len(spans)), key=lambda k: abs(dot(part.span[0], spans[k])))
        for part in first.components
    ]
    if len(set(order)) < len(order):
        return other
    return replace(other, components=tuple(other.components[k] for k in order))


def _ascending(points: CriticalSet) -> bool:
    """Whether no value is less than the one before it, by more than equal ones may differ."""
    values = [part.value for part in points.components]
    slack = Fraction(LARGEST_DIFFERENCE) * (max(values) - min(values))
    return all(one <= two + slack for one, two in pairwise(values))


def _angle(one: CriticalSet, other: CriticalSet) -> float:
    """The largest angle in radians from a rotation of a span to the component of the other."""
    bits = min(one.bits, other.bits)
    largest = 0
    for a, b in zip(one.components, other.components, strict=True):
        span = [_rounded(v, other.bits - bits) for v in b.span]
        for v in (_rounded(v, one.bits - bits) for v in a.span):
            rest = v
            for w in span:
                along = dot(v, w) >> bits
                rest = [r - (along * entry >> bits) for r, entry in zip(rest, w, strict=True)]
            largest = max(largest, math.isqrt(dot(rest, rest)))
    return 2.0 * math.asin(min(1.0, largest / (1 << bits)))


def _rounded(vector: Sequence[int], places: int) -> list[int]:
    return [entry >> places for entry in vector]


def _energy_difference(one: CriticalSet, other: CriticalSet) -> float:
    """The largest difference of the values, relative to their range."""
    pairs = zip(one.components, other.components, strict=True)
    largest = max(abs(a.value - b.value) for a, b in pairs)
    if largest == 0:
        return 0.0
    span = one.components[-1].value - one.components[0].value
    return float(largest / span) if span else math.inf


def _merges(coarse: Sequence[int], fine: Sequence[int]) -> bool:
    """Whether a pattern comes from another by taking neighbours together."""
    return set(accumulate(coarse)) <= set(accumulate(fine))


def _disagreement(one: CriticalSet, other: CriticalSet, angle: float = 0.0) -> ContradictionError:
    sides = [
        f"{each.method} finds {each.pattern} of indices {each.indices}" for each in (one, other)
    ]
    away = f", rotations up to {at_most(math.degrees(angle))} degrees apart" if angle else ""
    message = f"two roads disagree: {' and '.join(sides)}{away}; please report this problem"
    limit = LARGEST_ANGLE if angle else None
    return ContradictionError(
        message, methods=(one.method, other.method), value=angle or None, limit=limit
    )
