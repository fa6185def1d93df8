"""All equilibria by the spectral theorem: the eigenspaces of the Davenport matrix.

Exact where it decides (how many components, of which kind, which index), and precise where it
proposes: the eigenbasis is refined in integer arithmetic until eigenvalues that are exactly
distinct are well apart in it, however close they are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.critical_set import Component, EquilibriumSet, Margin
from certreg.equilibrium.stability import (
    Curvature,
    curvature,
    linearised_spectrum,
    spring_ratios,
)
from certreg.exact import Eigenbasis, integer_eigenbasis, nearest_double, nearest_root, power_of_two
from certreg.geometry import (
    canonical,
    davenport_matrix,
    dot,
    rotation_matrix,
    squared_norm,
)
from certreg.objective import Classification, classify, potential_energy
from certreg.problem import trace
from certreg.results import Guarantee
from certreg.settings import SpectrumSettings

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from certreg.problem import ExactMoments

IntegerQuaternion = tuple[int, int, int, int]
LEAST = 5e-324  # the least positive double
DOUBLE_BITS = 60  # more than a double holds: integers of that size convert without double rounding


@dataclass(frozen=True, kw_only=True)
class Spectrum:
    """The eigenspaces of K, largest eigenvalue first, grouped as the exact classification says.

    `pose_bits` is the precision to which quaternions of this spectrum are worth writing down.
    """

    moments: ExactMoments
    classification: Classification
    basis: Eigenbasis
    pose_bits: int

    @cached_property
    def groups(self) -> tuple[range, ...]:
        """The indices into `basis` of each component."""
        starts = self.classification.indices
        sizes = self.classification.pattern
        return tuple(range(s, s + m) for s, m in zip(starts, sizes, strict=True))

    @cached_property
    def quaternions(self) -> tuple[IntegerQuaternion, ...]:
        """An integer quaternion of the representative of each component."""
        return tuple(self._representative(group) for group in self.groups)

    @cached_property
    def levels(self) -> tuple[int, ...]:
        """The eigenvalue of each component, in the fixed point of `basis`."""
        return tuple(sum(self.basis.values[k] for k in g) // len(g) for g in self.groups)

    @cached_property
    def unit(self) -> Fraction:
        """What one unit of `basis.values` is worth, in objective units."""
        return power_of_two(self.basis.shift - self.basis.bits) * self.moments.cross_unit

    def level_difference(self, upper: int, lower: int) -> Fraction:
        """Eigenvalue of one component minus that of another, in objective units; a proposal."""
        return (self.levels[upper] - self.levels[lower]) * self.unit

    def angle_to(self, component: int, q: Sequence[int]) -> float:
        """The angle in radians from R(q) to the nearest rotation of a component.

        Twice the angle of q to the eigenspace, from the projections in integers.
        """
        inside = [dot(v, q) for v in self.basis.vectors]
        group = self.groups[component]
        along = math.isqrt(sum(inside[k] ** 2 for k in group))
        across = math.isqrt(sum(p**2 for k, p in enumerate(inside) if k not in group))
        return 2.0 * math.atan2(across / (along + across), along / (along + across))

    def angle_to_optimum(self, q: Sequence[int]) -> float:
        """The angle in radians from R(q) to the nearest optimum."""
        return self.angle_to(0, q)

    def relative_loss(self, q: Sequence[int]) -> float:
        """How far R(q) is from the best alignment, 0, to the worst, 1; 0 if all are as good.

        The mean of the eigenvalues with the squares of the projections of q as weights.
        """
        levels, basis = self.levels, self.basis
        weights = [dot(v, q) ** 2 for v in basis.vectors]
        lost = sum(w * (levels[0] - value) for w, value in zip(weights, basis.values, strict=True))
        return max(0, lost) / (sum(weights) * (levels[0] - levels[-1]) or 1)

    def _representative(self, group: range) -> IntegerQuaternion:
        """The member of an eigenspace nearest to the identity rotation, else to a half turn."""
        bits = self.basis.bits
        vectors = [self.basis.vectors[k] for k in group]
        if len(vectors) == 1:
            combined = list(vectors[0])
        else:
            reach = [sum(v[axis] * v[axis] for v in vectors) for axis in range(4)]
            axis = 0 if reach[0] >> (2 * bits - 32) else reach.index(max(reach))
            combined = [sum(v[axis] * v[k] for v in vectors) >> bits for k in range(4)]
        norm = math.isqrt(sum(entry * entry for entry in combined))
        half = norm >> 1
        q = [((entry << self.pose_bits) + half) // norm for entry in combined]
        sign = next(1 if entry > 0 else -1 for entry in q if entry)
        return (sign * q[0], sign * q[1], sign * q[2], sign * q[3])


def spectrum(moments: ExactMoments, settings: SpectrumSettings | None = None) -> Spectrum:
    """The spectrum, with as many bits as it takes to tell exactly distinct eigenvalues apart."""
    davenport = davenport_matrix(moments.cross)
    return resolved(moments, classify(moments), partial(integer_eigenbasis, davenport), settings)


def resolved(
    moments: ExactMoments,
    classification: Classification,
    basis_of: Callable[[int], Eigenbasis],
    settings: SpectrumSettings | None = None,
) -> Spectrum:
    """The spectrum of a basis that can be had to any number of bits, to as many as it takes."""
    settings = settings or SpectrumSettings()
    bits = settings.start_bits
    while True:
        basis = basis_of(bits)
        found = Spectrum(moments=moments, classification=classification, basis=basis, pose_bits=0)
        lost = bits - _narrowest_gap(found).bit_length()
        pose_bits = settings.pose_bits + lost
        needed = pose_bits + lost + settings.guard_bits
        if needed <= bits or bits >= settings.max_bits:
            break
        bits = min(max(needed, 2 * bits), settings.max_bits)
    return Spectrum(
        moments=moments,
        classification=classification,
        basis=basis,
        pose_bits=min(pose_bits, bits),
    )


def equilibrium_set(
    found: Spectrum,
    damping: float,
    *,
    guarantee: Guarantee = Guarantee.EXACT,
    doubt: str | None = None,
) -> EquilibriumSet:
    """The equilibrium set that belongs to a spectrum.

    guarantee: of its classification. doubt: why the list may not be complete; None: it is.
    """
    vectors = np.array([unit_double(v) for v in found.basis.vectors])
    bends = [_curvature(found, i, vectors) for i in range(len(found.groups))]
    spectra = _linearised_spectra(found, bends, damping)
    parts = enumerate(zip(bends, spectra, strict=True))
    return EquilibriumSet(
        classification=found.classification,
        components=tuple(_component(found, i, vectors, *part) for i, part in parts),
        margin=margin(found),
        guarantee=guarantee,
        complete=doubt is None,
        doubt=doubt,
    )


def margin(found: Spectrum) -> Margin:
    """The ambiguity margin l1 - l2, exactly zero where the optimum is not unique."""
    if not found.classification.unique:
        return Margin(eigenvalue_gap=0.0, relative=0.0)
    values = found.basis.values
    return Margin(
        eigenvalue_gap=nearest_double(found.level_difference(0, 1)),
        relative=_quotient(values[0] - values[1], values[0] - values[3]),
    )


def _quotient(difference: int, scale: int) -> float:
    """The double nearest to a quotient, never 0 unless it is: a sign is not left to underflow."""
    sign = (difference > 0) - (difference < 0)
    return difference / scale or sign * LEAST


def unit_double(q: Sequence[int]) -> NDArray[np.float64]:
    """An integer quaternion as a unit quaternion of doubles, every entry within an ulp."""
    norm = math.isqrt(squared_norm(q) << (2 * DOUBLE_BITS))
    return np.array([(entry << DOUBLE_BITS) / norm for entry in q])


def rotation_double(q: IntegerQuaternion) -> NDArray[np.float64]:
    """R(q) of an integer quaternion, every entry rounded once."""
    norm = squared_norm(q)
    return np.array([[entry / norm for entry in row] for row in rotation_matrix(q)])


def _narrowest_gap(found: Spectrum) -> int:
    """The least difference of neighbouring levels, in fixed point; full scale if alone."""
    levels = found.levels
    gaps = [upper - lower for upper, lower in pairwise(levels)]
    return max(1, min(gaps, default=1 << found.basis.bits))


def _component(
    found: Spectrum,
    index: int,
    vectors: NDArray[np.float64],
    bend: Curvature,
    eigenvalues: NDArray[np.complex128] | None,
) -> Component:
    moments, classification = found.moments, found.classification
    q = found.quaternions[index]
    energy = potential_energy(moments, q)
    unstable = classification.unstable
    return Component(
        kind=classification.kinds[index],
        basis=np.array([canonical(v) for v in vectors[list(found.groups[index])]]).T,
        morse_index=classification.indices[index],
        unstable_eigenvalues=None if unstable is None else unstable[index],
        eigenvalues=eigenvalues,
        witness=bend.witness,
        energy=nearest_double(energy),
        rmse=nearest_root(energy / moments.total_weight),
        rotation=rotation_double(q),
        quaternion_wxyz=unit_double(q),
        angle_to_optimum=found.angle_to_optimum(q) if index else 0.0,
    )


def _curvature(found: Spectrum, index: int, vectors: NDArray[np.float64]) -> Curvature:
    """The curvature at a component, in units of 2^shift of `cross`."""
    group, values = found.groups[index], found.basis.values
    q = unit_double(found.quaternions[index])
    partners = _completion(q, vectors[list(group)])
    others = [k for k in range(len(values)) if k not in group]
    scale = 1 << found.basis.bits
    gaps = [_quotient(found.levels[index] - values[k], scale) for k in others]
    gaps = [0.0] * len(partners) + gaps
    return curvature(q, np.concatenate([partners, vectors[others]]), gaps)


def _linearised_spectra(
    found: Spectrum, bends: list[Curvature], damping: float
) -> list[NDArray[np.complex128] | None]:
    """The 12 eigenvalues of the linearised dynamics at each component."""
    moments = found.moments
    if not found.classification.inertia_definite:
        return [None] * len(bends)
    inertia_scale = trace(moments.source_scatter)
    inertia = np.array([[entry / inertia_scale for entry in row] for row in moments.inertia])
    # G is in units of 2^shift of `cross`, J in units of the trace of the scatter
    length_ratio = power_of_two(moments.target_exponent - moments.source_exponent)
    unit = nearest_double(Fraction(1 << found.basis.shift, inertia_scale) * length_ratio)
    if unit is None:
        return [None] * len(bends)
    return [
        None if ratios is None else linearised_spectrum(ratios, unit, damping)
        for ratios in spring_ratios(bends, inertia)
    ]


def _completion(q: NDArray[np.float64], members: NDArray[np.float64]) -> NDArray[np.float64]:
    """Orthonormal rows that complete unit q to a basis of the span of `members`."""
    if len(members) == 1:
        return np.empty((0, 4))
    rest = members - np.outer(members @ q, q)
    return np.linalg.svd(rest)[2][: len(members) - 1]
