"""All equilibria: critical rotations of the objective, found by independent methods."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._faces import lazy_face

if TYPE_CHECKING:
    from certreg.equilibrium.batch import Solutions as Solutions
    from certreg.equilibrium.batch import clouds as clouds
    from certreg.equilibrium.batch import exactly as exactly
    from certreg.equilibrium.batch import solve_many as solve_many
    from certreg.equilibrium.batch import stationary_poses as stationary_poses
    from certreg.equilibrium.counting import at_most_four as at_most_four
    from certreg.equilibrium.critical_set import Component as Component
    from certreg.equilibrium.critical_set import EquilibriumSet as EquilibriumSet
    from certreg.equilibrium.methods import Method as Method
    from certreg.equilibrium.methods import Road as Road
    from certreg.equilibrium.methods import RoadAgreement as RoadAgreement
    from certreg.equilibrium.methods import UndecidedRoad as UndecidedRoad
    from certreg.equilibrium.methods import all_roads as all_roads
    from certreg.equilibrium.methods import road as road
    from certreg.equilibrium.spectral import Spectrum as Spectrum
    from certreg.equilibrium.spectral import equilibrium_set as equilibrium_set
    from certreg.equilibrium.spectral import rotation_double as rotation_double
    from certreg.equilibrium.spectral import spectrum as spectrum
    from certreg.equilibrium.spectral import unit_double as unit_double
    from certreg.equilibrium.stability import TRANSLATION_STIFFNESS as TRANSLATION_STIFFNESS

__getattr__ = lazy_face(
    __name__,
    {
        "batch": (
            "Solutions",
            "clouds",
            "exactly",
            "stationary_poses",
            "solve_many",
        ),
        "counting": ("at_most_four",),
        "critical_set": (
            "Component",
            "EquilibriumSet",
        ),
        "methods": (
            "Method",
            "Road",
            "RoadAgreement",
            "UndecidedRoad",
            "all_roads",
            "road",
        ),
        "spectral": (
            "Spectrum",
            "equilibrium_set",
            "rotation_double",
            "spectrum",
            "unit_double",
        ),
        "stability": ("TRANSLATION_STIFFNESS",),
    },
)
