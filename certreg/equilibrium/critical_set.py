"""The equilibrium set as it is handed to the user: components, and the set of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from certreg.objective import Classification
    from certreg.results import ComponentKind, Guarantee


WEAK_MARGIN = 1e-3  # of the range of energies: what separates right from wrong is less


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Component:
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
class Margin:
    """How far the optimum is from being ambiguous.

    eigenvalue_gap: l1 - l2 = 2 (d2 + d3), in objective units; half the energy between the optimum
        and the lowest spurious equilibrium. None where no double holds it.
    relative: (l1 - l2) / (l1 - l4), from 0 (not unique) to 1.
    """

    eigenvalue_gap: float | None
    relative: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EquilibriumSet:
    """All equilibria of the registration dynamics, by descending eigenvalue: the optimum first.

    `guarantee` speaks of the classification: that the list is complete, the kinds, the indices.
    `doubt` says in words why the list may not be complete; None where it is.
    """

    classification: Classification
    components: tuple[Component, ...]
    margin: Margin
    guarantee: Guarantee
    complete: bool
    doubt: str | None = None

    @property
    def nearly_ambiguous(self) -> bool:
        """Whether the optimum is unique, but so narrowly that the noise may turn it over."""
        return self.classification.unique and self.margin.relative < WEAK_MARGIN

    @property
    def count(self) -> int | None:
        """Number of equilibria; None means infinitely many."""
        return len(self.components) if self.classification.finite else None
