"""The equilibrium set as it is handed to the user: a critical set, seen as equilibria of a body.

What depends on the dynamics is added here: inertia, damping, the eigenvalues of the linearised
motion. Signs and counts come from the classification; numbers are rounded to doubles once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.stability import (
    Curvature,
    curvature,
    linearised_spectrum,
    spring_ratios,
)
from certreg.exact.dyadic import nearest_double, nearest_quotient, nearest_root, power_of_two
from certreg.geometry.so3 import canonical, dot, rotation_matrix, squared_norm
from certreg.problem.moments import trace
from certreg.results import (
    OUT_OF_RANGE,
    Absent,
    ComponentKind,
    Explained,
    Guarantee,
    Presented,
    present,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.equilibrium.critical_set import CriticalSet
    from certreg.objective.classification import Classification
    from certreg.objective.isotropic import Isotropic


LEAST = 5e-324  # the least positive double
DOUBLE_BITS = 60  # more than a double holds: integers of that size convert without double rounding
WEAK_MARGIN = 1e-3  # of the range of energies: what separates right from wrong is less
SINGULAR = Absent(
    "the inertia matrix is singular (fewer than three noncollinear points): "
    "the rotational dynamics is not defined"
)
ILL_CONDITIONED = Absent(
    "the source points are so nearly collinear, or the eigenvalues so nearly equal, that double "
    "precision cannot give the eigenvalues with their proven signs; the counts are exact"
)
AT_OPTIMUM = Absent("optimal: the energy falls in no direction")
CONTINUUM = Absent("the equilibria form a continuum: there are infinitely many")
SPURIOUS_CONTINUUM = Absent("there are infinitely many spurious equilibria")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Component(Explained):
    """A connected component of the rest poses of the damped rigid body.

    Kind, index, unstable count and optimality are exact; the numbers are rounded to doubles from a
    basis of at least 57 digits. Where the component is not a point, `rotation`, `quaternion_wxyz`,
    `eigenvalues` and `witness` are those of one representative: the member with the least rotation
    angle from the identity.

    basis: (4, k), orthonormal columns: the unit quaternions of the component are its combinations.
    morse_index: number of independent directions in which the energy falls.
    unstable_eigenvalues: number of the 12 with positive real part; None where J is singular.
    eigenvalues: (12,) complex, of the linearised dynamics, in 1/time; None where J is singular.
    witness: (3,), unit, body frame: turning about it lowers the energy most; None at an optimum.
    energy: V_p at rest; None where no double holds it (see `rmse`).
    rmse: sqrt(sum w r^2 / sum w), in the unit of length.
    angle_to_optimum: radians, to the nearest optimum.
    """

    kind: ComponentKind
    basis: NDArray[np.float64]
    morse_index: int
    unstable_eigenvalues: int | None
    eigenvalues: NDArray[np.complex128] | None
    witness: NDArray[np.float64] | None
    energy: float | None
    rmse: float | None
    rotation: NDArray[np.float64]
    quaternion_wxyz: NDArray[np.float64]
    angle_to_optimum: float

    @property
    def optimal(self) -> bool:
        """Whether these are the global optima: exactly those of index 0."""
        return self.morse_index == 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Margin(Explained):
    """How far the optimum is from being ambiguous.

    eigenvalue_gap: l1 - l2 = 2 (d2 + d3), in objective units; half the energy between the optimum
        and the lowest spurious equilibrium. None where no double holds it.
    relative: (l1 - l2) / (l1 - l4), from 0 (not unique) to 1.
    """

    eigenvalue_gap: float | None
    relative: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EquilibriumSet(Explained, Presented):
    """All equilibria of the registration dynamics, by descending eigenvalue: the optimum first.

    `guarantee` speaks of the classification: that the list is complete, the kinds, the indices.
    `doubt` says in words why the list may not be complete; None where it is.
    `next_ruled_out`: whether the noise was found to rule out the next equilibrium; False: not
    ruled out, or not asked.
    `pairs_in_doubt`: whether it would be ruled out if the fit did not warn that pairs may be wrong.
    """

    classification: Classification
    components: tuple[Component, ...]
    margin: Margin
    guarantee: Guarantee
    complete: bool
    doubt: str | None = None
    next_ruled_out: bool = False
    pairs_in_doubt: bool = False

    @property
    def narrow(self) -> bool:
        """Whether the optimum is unique, but the next equilibrium costs little of the range."""
        return self.classification.unique and self.margin.relative < WEAK_MARGIN

    def __repr__(self) -> str:
        count = "infinitely many" if self.count is None else self.count
        pattern = "".join(map(str, self.classification.pattern))
        known = self.guarantee.label + ("" if self.complete else ", not proved complete")
        return f"<EquilibriumSet: {count}, of pattern {pattern}; {known}>"

    @property
    def nearly_ambiguous(self) -> bool:
        """Whether the optimum is unique, but noise or wrong pairs may turn it over."""
        return self.narrow and not self.next_ruled_out

    @property
    def count(self) -> int | None:
        """Number of equilibria; None means infinitely many."""
        return len(self.components) if self.classification.finite else None

    @property
    def spurious(self) -> int | None:
        """Number of equilibria that are not optimal; None means infinitely many."""
        return self.classification.spurious


def equilibrium_set(critical: CriticalSet, objective: Isotropic, damping: float) -> EquilibriumSet:
    """The equilibria of the damped body at the critical rotations of its objective."""
    classification = objective.classified(critical.pattern)
    frame = _Frame.of(critical, objective)
    curvatures = [_curvature(frame, i) for i in range(len(critical.components))]
    spectra = _linearised_spectra(objective, curvatures, damping)
    parts = enumerate(zip(curvatures, spectra, strict=True))
    return EquilibriumSet(
        classification=classification,
        components=tuple(_component(frame, classification, i, *part) for i, part in parts),
        margin=_margin(critical, classification),
        guarantee=critical.guarantee,
        complete=critical.complete,
        doubt=critical.doubt,
        absent={"count": CONTINUUM, "spurious": SPURIOUS_CONTINUUM},
    )


def _margin(critical: CriticalSet, classification: Classification) -> Margin:
    """The ambiguity margin l1 - l2, exactly zero where the optimum is not unique."""
    if not classification.unique:
        return Margin(eigenvalue_gap=0.0, relative=0.0)
    values, over = _over_one([part.value for part in critical.components])
    best, second, *_ = values
    return Margin(
        eigenvalue_gap=nearest_quotient(second - best, 2 * over),
        relative=_nonzero(second - best, values[-1] - best),
        absent={"eigenvalue_gap": OUT_OF_RANGE},
    )


def _nonzero(numerator: int, denominator: int) -> float:
    """The nearest double, never 0 unless the value is: a sign is not left to underflow.

    The denominator is positive.
    """
    sign = (numerator > 0) - (numerator < 0)
    return numerator / denominator or sign * LEAST


def _over_one(values: Sequence[Fraction]) -> tuple[list[int], int]:
    """The numerators over one denominator, and this."""
    over = math.lcm(*(value.denominator for value in values))
    return [value.numerator * (over // value.denominator) for value in values], over


def unit_double(q: Sequence[int]) -> NDArray[np.float64]:
    """An integer quaternion as a unit quaternion of doubles, every entry within an ulp."""
    return np.array(unit_entries(tuple(q)))


def rotation_double(q: Sequence[int]) -> NDArray[np.float64]:
    """R(q) of an integer quaternion, every entry rounded once."""
    return np.array(_rotation_entries(tuple(q)))


@lru_cache(maxsize=16)  # the quaternions of one problem are asked for by every part of its answer
def unit_entries(q: tuple[int, ...]) -> tuple[float, ...]:
    """The same entries, of a tuple."""
    w, x, y, z = q
    norm, up = math.isqrt((w * w + x * x + y * y + z * z) << (2 * DOUBLE_BITS)), DOUBLE_BITS
    return (w << up) / norm, (x << up) / norm, (y << up) / norm, (z << up) / norm


@lru_cache(maxsize=16)
def _rotation_entries(q: tuple[int, ...]) -> list[list[float]]:
    norm = squared_norm(q)
    return [[entry / norm for entry in row] for row in rotation_matrix(q)]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Frame:
    """The critical quaternions of an isotropic objective as an orthonormal frame of doubles.

    vectors: (4, 4), unit rows. component: of each row. values: of each component, integers over
    `over`, in units of 2 * 2^shift of `cross`.
    """

    critical: CriticalSet
    objective: Isotropic
    vectors: NDArray[np.float64]
    component: tuple[int, ...]
    values: tuple[int, ...]
    over: int

    @classmethod
    def of(cls, critical: CriticalSet, objective: Isotropic) -> _Frame:
        spans = [part.span for part in critical.components]
        values, over = _over_one([part.value for part in critical.components])
        unit = 2 * objective.moments.cross_unit * power_of_two(objective.shift)
        return cls(
            values=tuple(value * unit.denominator for value in values),
            over=over * unit.numerator,
            critical=critical,
            objective=objective,
            vectors=np.array([unit_double(v) for span in spans for v in span]),
            component=tuple(i for i, span in enumerate(spans) for _ in span),
        )

    def rows(self, index: int) -> list[int]:
        """The rows of a component."""
        return [k for k, i in enumerate(self.component) if i == index]


def _component(
    frame: _Frame,
    classification: Classification,
    index: int,
    curvature: Curvature,
    eigenvalues: NDArray[np.complex128] | Absent,
) -> Component:
    objective, q = frame.objective, frame.critical.components[index].quaternion
    energy, unstable = objective.energy(q), classification.unstable
    squares = objective.squares(energy, objective.best_scale(q))
    return Component(
        kind=classification.kinds[index],
        basis=np.array([canonical(v) for v in frame.vectors[frame.rows(index)]]).T,
        morse_index=classification.indices[index],
        unstable_eigenvalues=None if unstable is None else unstable[index],
        eigenvalues=present(eigenvalues),
        witness=curvature.witness,
        energy=nearest_double(energy),
        rmse=nearest_root(squares / objective.moments.total_weight),
        rotation=rotation_double(q),
        quaternion_wxyz=unit_double(q),
        angle_to_optimum=_angle_to_optimum(frame.critical, q) if index else 0.0,
        absent={
            "unstable_eigenvalues": SINGULAR,
            "witness": AT_OPTIMUM,
            **dict.fromkeys(("energy", "rmse"), OUT_OF_RANGE),
            **({"eigenvalues": eigenvalues} if isinstance(eigenvalues, Absent) else {}),
        },
    )


def _angle_to_optimum(critical: CriticalSet, q: Sequence[int]) -> float:
    """The angle in radians from R(q) to the nearest optimum, twice that of q to its eigenspace.

    From the projections in integers: other critical quaternions are orthogonal to the optimum.
    """
    optimum, *others = ([dot(v, q) for v in part.span] for part in critical.components)
    along = math.isqrt(sum(p**2 for p in optimum))
    across = math.isqrt(sum(p**2 for part in others for p in part))
    return 2.0 * math.atan2(across / (along + across), along / (along + across))


def _curvature(frame: _Frame, index: int) -> Curvature:
    """The curvature at a component, in units of 2^shift of `cross`."""
    own, here = frame.rows(index), frame.values[index]
    q = unit_double(frame.critical.components[index].quaternion)
    partners = _completion(q, frame.vectors[own])
    others = [k for k in range(len(frame.vectors)) if k not in own]
    values = [frame.values[frame.component[k]] for k in others]
    gaps = [0.0] * len(partners) + [_nonzero(value - here, frame.over) for value in values]
    return curvature(q, np.concatenate([partners, frame.vectors[others]]), gaps)


def _linearised_spectra(
    objective: Isotropic, curvatures: list[Curvature], damping: float
) -> list[NDArray[np.complex128] | Absent]:
    """The 12 eigenvalues of the linearised dynamics at each component, or why there are none."""
    moments = objective.moments
    if not objective.classification.inertia_definite:
        return [SINGULAR] * len(curvatures)
    inertia_scale = trace(moments.source_scatter)
    inertia = np.array([[entry / inertia_scale for entry in row] for row in moments.inertia])
    # G is in units of 2^shift of `cross`, J in units of the trace of the scatter
    length_ratio = power_of_two(moments.target_exponent - moments.source_exponent)
    unit = nearest_double(Fraction(1 << objective.shift, inertia_scale) * length_ratio)
    if unit is None:
        return [ILL_CONDITIONED] * len(curvatures)
    spectra = (
        None if ratios is None else linearised_spectrum(ratios, unit, damping)
        for ratios in spring_ratios(curvatures, inertia)
    )
    return [ILL_CONDITIONED if spectrum is None else spectrum for spectrum in spectra]


def _completion(q: NDArray[np.float64], members: NDArray[np.float64]) -> NDArray[np.float64]:
    """Orthonormal rows that complete unit q to a basis of the span of `members`."""
    if len(members) == 1:
        return np.empty((0, 4))
    rest = members - np.outer(members @ q, q)
    return np.linalg.svd(rest)[2][: len(members) - 1]
