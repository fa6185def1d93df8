"""All equilibria by the spectral theorem: the eigenspaces of the Davenport matrix.

Exact where it decides (how many components, of which kind, which index), and precise where it
proposes: the eigenspaces are refined in integer arithmetic until eigenvalues that are exactly
distinct are well apart in them, however close they are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.equilibrium.critical_set import Completeness, CriticalSet, spaces_as_components
from certreg.results import Guarantee

if TYPE_CHECKING:
    from certreg.objective.isotropic import Isotropic

SPECTRAL = "spectral"


def by_eigenspaces(objective: Isotropic) -> CriticalSet:
    """The eigenspaces of K; kinds and indices by the exact classification."""
    return CriticalSet(
        method=SPECTRAL,
        components=spaces_as_components(
            objective.eigenspaces,
            objective.energy_of_eigenvalue,
            objective.classification.indices,
            Guarantee.EXACT,
        ),
        bits=objective.eigenspaces.bits,
        completeness=Completeness.SPECTRAL,
    )
