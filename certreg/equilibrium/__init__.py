"""All equilibria: critical rotations of the objective, found by independent methods."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.equilibrium.batch import Solutions as Solutions
    from certreg.equilibrium.batch import clouds as clouds
    from certreg.equilibrium.batch import exactly as exactly
    from certreg.equilibrium.batch import solve_many as solve_many
    from certreg.equilibrium.batch import stationary_poses as stationary_poses
    from certreg.equilibrium.breaking import Labels as Labels
    from certreg.equilibrium.breaking import RestPose as RestPose
    from certreg.equilibrium.breaking import SpringSet as SpringSet
    from certreg.equilibrium.breathing import BreathingEquilibria as BreathingEquilibria
    from certreg.equilibrium.breathing import BreathingEquilibrium as BreathingEquilibrium
    from certreg.equilibrium.breathing import breathing_equilibria as breathing_equilibria
    from certreg.equilibrium.breathing import source_size as source_size
    from certreg.equilibrium.counting import at_most_four as at_most_four
    from certreg.equilibrium.critical_set import Completeness as Completeness
    from certreg.equilibrium.critical_set import Critical as Critical
    from certreg.equilibrium.critical_set import CriticalSet as CriticalSet
    from certreg.equilibrium.line_set import Finiteness as Finiteness
    from certreg.equilibrium.line_set import LineSet as LineSet
    from certreg.equilibrium.methods import FINDERS as FINDERS
    from certreg.equilibrium.methods import Comparison as Comparison
    from certreg.equilibrium.methods import Method as Method
    from certreg.equilibrium.methods import Search as Search
    from certreg.equilibrium.methods import compare as compare
    from certreg.equilibrium.methods import search as search
    from certreg.equilibrium.paths import CriticalLines as CriticalLines
    from certreg.equilibrium.paths import PathsOutcome as PathsOutcome
    from certreg.equilibrium.paths import critical_lines as critical_lines
    from certreg.equilibrium.presentation import Component as Component
    from certreg.equilibrium.presentation import EquilibriumSet as EquilibriumSet
    from certreg.equilibrium.presentation import equilibrium_set as equilibrium_set
    from certreg.equilibrium.presentation import rotation_double as rotation_double
    from certreg.equilibrium.presentation import unit_double as unit_double
    from certreg.equilibrium.presentation import unit_entries as unit_entries
    from certreg.equilibrium.quartics import FloatingQuartic as FloatingQuartic
    from certreg.equilibrium.quartics import QuarticDescent as QuarticDescent
    from certreg.equilibrium.quartics import descended as descended
    from certreg.equilibrium.spectral import by_eigenspaces as by_eigenspaces
    from certreg.equilibrium.spring_batch import QuarticSolutions as QuarticSolutions
    from certreg.equilibrium.spring_batch import many_springs as many_springs
    from certreg.equilibrium.spring_batch import solve_many_springs as solve_many_springs
    from certreg.equilibrium.spring_sets import LEAST_SPRINGS as LEAST_SPRINGS
    from certreg.equilibrium.spring_sets import label_sets as label_sets
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
        "breaking": (
            "Labels",
            "RestPose",
            "SpringSet",
        ),
        "breathing": (
            "BreathingEquilibria",
            "BreathingEquilibrium",
            "breathing_equilibria",
            "source_size",
        ),
        "counting": ("at_most_four",),
        "critical_set": (
            "Completeness",
            "Critical",
            "CriticalSet",
        ),
        "line_set": (
            "Finiteness",
            "LineSet",
        ),
        "methods": (
            "FINDERS",
            "Comparison",
            "Method",
            "Search",
            "compare",
            "search",
        ),
        "paths": (
            "CriticalLines",
            "PathsOutcome",
            "critical_lines",
        ),
        "presentation": (
            "Component",
            "EquilibriumSet",
            "equilibrium_set",
            "rotation_double",
            "unit_double",
            "unit_entries",
        ),
        "quartics": (
            "QuarticDescent",
            "FloatingQuartic",
            "descended",
        ),
        "spectral": ("by_eigenspaces",),
        "spring_batch": (
            "QuarticSolutions",
            "many_springs",
            "solve_many_springs",
        ),
        "spring_sets": (
            "LEAST_SPRINGS",
            "label_sets",
        ),
        "stability": ("TRANSLATION_STIFFNESS",),
    },
)
