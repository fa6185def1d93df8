"""Independent searches for the equilibria, by name, and how their results are compared.

`spectral` reads eigenspaces, `groebner` eliminates, `homotopy` follows paths and proves their ends
in ball arithmetic. The last two start from the torque quadratics and share no argument with the
first; of general springs they are all there is. Methods that have decided must agree: the same
components, rotations, indices and energies.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib import import_module
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

from certreg._loading import library
from certreg.equilibrium.critical_set import CriticalSet
from certreg.errors import ContradictionError, UndecidedError
from certreg.exact.decimals import at_most
from certreg.geometry.so3 import dot
from certreg.objective.springs import Springs
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.objective.isotropic import Isotropic

Method = Callable[[Any], CriticalSet]  # of the objective that it is for

METHODS = {  # by name; loaded when asked for, because ball arithmetic and elimination are not light
    "spectral": ("certreg.equilibrium.spectral", "by_eigenspaces"),
    "groebner": ("certreg.equilibrium.groebner", "by_elimination"),
    "homotopy": ("certreg.equilibrium.homotopy", "by_continuation"),
}
SPRING_METHODS = {  # of general springs
    "homotopy": ("certreg.equilibrium.spring_homotopy", "by_forty_paths"),
    "groebner": ("certreg.equilibrium.spring_groebner", "by_quotient_ring"),
}
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


def methods_of(objective: Isotropic | Springs) -> dict[str, tuple[str, str]]:
    """The methods that there are for an objective."""
    return SPRING_METHODS if isinstance(objective, Springs) else METHODS


def method_named(name: str, methods: dict[str, tuple[str, str]] = METHODS) -> Method:
    """The method of a name among `methods`, its libraries loaded."""
    module, function = methods[name]
    if name != "spectral":
        library("flint", f"the method {name}")
    return getattr(import_module(module), function)


def search(objective: Isotropic | Springs, name: str) -> Search:
    """The search by one method; loading a library is no part of it."""
    method = method_named(name, methods_of(objective))
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
