"""The certified basin of the optimum, as a simulation sees it: floating point proposes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium.equilibrium_set import unit_entries
from certreg.errors import DegenerateProblemError
from certreg.native.layout import BASIN, record_of
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.native.layout import Records
    from certreg.objective.isotropic import Isotropic

SMALLEST_BARRIER = 1e-280  # of l1 - l2: shares of it, times squares of small angles, are doubles
TIE = 1e-13  # of l1 - l4: doubles do not tell such eigenvalues apart


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Basin(Brief):
    """The certified basin of the optimum, per unit of mass, lengths over the body's unit.

    E = omega^T J omega / 2 - 2 q^T K q never rises along the exact flow, and at every spurious
    equilibrium E >= -2 l2. So a state with l1 - q^T K q + omega^T J omega / 4 < l1 - l2 has less
    energy than all of them, and by LaSalle's theorem ends at the optimum. The left side is a sum of
    squares, (l1 - lk) (q . q_k)^2, and so has no cancellation. Over l1 - l2 it bounds sin^2 of half
    the angle to the optimum, now and ever after. Proof: derivations, certified_basin.

    record: () of BASIN, what the trajectory loops take: the q_k as orthonormal rows, by descending
    eigenvalue, and their gaps l1 - lk over the mass, exact zeros on the optima.
    """

    record: Records

    @property
    def optimum(self) -> NDArray[np.float64]:
        """The unit quaternion (w, x, y, z) of an optimum, (4,)."""
        return self.record["quaternions"][0]

    @property
    def gaps(self) -> NDArray[np.float64]:
        """l1 - lk over the mass, (4,)."""
        return self.record["gaps"]

    @property
    def barrier(self) -> float:
        """The alignment l1 - l2 that separates the optimum from the rest: half of that in E."""
        return float(self.gaps[1])


def certified_basin(objective: Isotropic, length_exponent: int) -> Basin:
    """The basin that belongs to an objective, in the body's unit of length.

    Raises DegenerateProblemError where doubles do not tell the optima from the other poses.
    """
    optima, gaps = objective.classification.pattern[0], basin_gaps(objective, length_exponent)
    vectors = [entry for v in objective.eigenvectors for entry in unit_entries(v)]
    numbers = [*vectors, *[0.0] * optima, *gaps]
    return Basin(record=record_of(numbers, BASIN))


def basin_gaps(objective: Isotropic, length_exponent: int) -> list[float]:
    """l1 - lk over the mass, of the eigenvectors below the optima; raises as `certified_basin`."""
    moments, spaces = objective.moments, objective.eigenspaces
    optima = objective.classification.pattern[0]
    # One of a drop in units of the body: `eigenvalue_unit` / (total weight 4^length_exponent).
    exponents = moments.source_exponent + moments.target_exponent - 2 * length_exponent
    places = objective.shift - spaces.bits + exponents
    up, over = max(places, 0), moments.mass**2 << max(-places, 0)
    gaps = [(drop << up) / over for drop in objective.eigenvalue_drops[optima:]]
    if min(gaps, default=1.0) < SMALLEST_BARRIER:
        raise DegenerateProblemError(
            "not every pose is optimal, but by less than double precision can tell: the clouds "
            "differ so much in size, or are so nearly uncorrelated, that springs hardly turn the "
            "body; bring both clouds to one unit of length",
            value=min(gaps),
            limit=SMALLEST_BARRIER,
        )
    return gaps


def basins_of(
    vectors: NDArray[np.float64], values: NDArray[np.float64], unit: NDArray[np.float64]
) -> Records:
    """The basins (count,) of Davenport matrices: `values` times `unit` (count, 1), descending.

    vectors: (count, 4, 4), unit, row by row; values: (count, 4). Raises DegenerateProblemError
    where doubles do not tell the optima from the other poses.
    """
    differences = values[:, :1] - values
    differences[differences < TIE * differences[:, -1:]] = 0.0
    basins = np.empty(len(values), dtype=BASIN)
    basins["quaternions"], basins["gaps"] = vectors, differences * unit
    lost = ((differences > 0.0) & (basins["gaps"] < SMALLEST_BARRIER)).any(axis=1)
    if lost.any():
        instance = int(np.argmax(lost))
        where = f"the clouds of instance {instance}"
        raise DegenerateProblemError(
            f"{where} differ too much in size for double precision: bring both to one unit",
            instance=instance,
            limit=SMALLEST_BARRIER,
        )
    return basins
