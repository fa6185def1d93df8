"""What the dynamics says of a problem whose scale is free: its equilibria, and a simulated motion.

With the asymmetric scale the size of the body is a state, and the equilibria are the eigenlines
with a positive eigenvalue. The symmetric scale is the same whatever the rotation: a body of that
size is rigid, and has the equilibria of the rigid body.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg._loading import cached_property
from certreg.dynamics.trajectory import Trajectory
from certreg.equilibrium.breathing import breathing_equilibria, source_size
from certreg.exact.dyadic import nearest_double
from certreg.problem.lifting import lift
from certreg.registration.simulation import SimulatedMotion
from certreg.results import OUT_OF_RANGE, Absent, Explained, Presented

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from certreg.dynamics.valleys import BreathingBody
    from certreg.equilibrium.breathing import BreathingEquilibria
    from certreg.equilibrium.equilibrium_set import Component, EquilibriumSet
    from certreg.objective.isotropic import Isotropic

CONTINUUM = Absent("the equilibria form a continuum: there are infinitely many")


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaledEquilibrium(Explained):
    """A connected component of the rest states of a body whose scale is free.

    component: its rotations, kind, index and energy. scale: target over source, rounded once.
    rmse: sqrt(sum w r^2 / sum w), in the unit of the target.
    """

    component: Component
    scale: float | None
    rmse: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScaledEquilibria(Presented):
    """All equilibria with a scale above 0, the optimum first.

    rigid: those of the body of scale 1, which has the same rotations. breathing: with the scale as
    a state, their exact count and the inside-out states; None of the symmetric scale.
    """

    rigid: EquilibriumSet
    components: tuple[ScaledEquilibrium, ...]
    breathing: BreathingEquilibria | None

    def __repr__(self) -> str:
        count = "infinitely many" if self.count is None else self.count
        return f"<ScaledEquilibria: {count}; {self.rigid.guarantee.label}>"

    @property
    def finite(self) -> bool:
        """Whether there are finitely many."""
        return all(each.component.kind.dimension == 0 for each in self.components)

    @property
    def count(self) -> int | None:
        """Their number, exact; None means infinitely many."""
        return len(self.components) if self.finite else None

    @property
    def spurious(self) -> int | None:
        """The number of those that are not optimal; None means infinitely many."""
        others = [each.component for each in self.components if not each.component.optimal]
        return len(others) if all(each.kind.dimension == 0 for each in others) else None

    @property
    def unique(self) -> bool:
        """Whether there is one optimum."""
        return self.rigid.classification.unique

    def stated(self, name: str) -> Any:
        """The number of that name, or why it is none."""
        value = getattr(self, name)
        return CONTINUUM if value is None else value


def scaled_equilibria(objective: Isotropic, rigid: EquilibriumSet) -> ScaledEquilibria:
    """The equilibria of a problem whose scale is free. rigid: those of its rotations."""
    scaling, breathing = objective.scaling, None
    kept = len(rigid.components)
    if scaling is None or not scaling.symmetric:
        breathing = breathing_equilibria(objective)
        kept = len(breathing.upright)  # rigid ones come with the largest eigenvalue first
    return ScaledEquilibria(
        rigid=rigid,
        components=tuple(
            _equilibrium(objective, component, objective.quaternions[place])
            for place, component in enumerate(rigid.components[:kept])
        ),
        breathing=breathing,
    )


def _equilibrium(objective: Isotropic, component: Component, q: Sequence[int]) -> ScaledEquilibrium:
    scale = objective.best_scale(q)
    return ScaledEquilibrium(
        component=component,
        scale=nearest_double(scale) or None,
        rmse=component.rmse,
        absent=dict.fromkeys(("scale", "rmse"), OUT_OF_RANGE),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedBreathing(SimulatedMotion):
    """With a free scale; where it ended beside the optimum."""

    objective: Isotropic
    moving: BreathingBody

    __repr__ = Trajectory.__repr__

    @property
    def scales(self) -> NDArray[np.float64]:
        """(L,), target over source."""
        return self.moving.scales(self.samples["state"])

    @cached_property
    def angle_to_optimum(self) -> float:
        """Radians, from the last rotation to the nearest optimum."""
        return self.objective.angle_to_optimum(lift(self.quaternion).integers)

    @property
    def best_scale(self) -> float | None:
        """That of the optimum, target over source; None where no double holds it."""
        return nearest_double(self.objective.best_scale(self.objective.optimum))

    @cached_property
    def never_collapses(self) -> bool:
        """Whether it is proved that the exact motion from the start never comes to the scale 0."""
        return never_collapses(self.objective)


def never_collapses(objective: Isotropic) -> bool:
    """Whether the exact motion from where the source was given, at rest at scale 1, keeps s > 0.

    Proved, in rationals: it begins with less energy than Syy (derivations, breathing_confined).
    False means not proved, not disproved. Raises as `source_size`.
    """
    still = (1, 0, 0, 0)
    shifted = objective.translation_energy(still, (Fraction(0),) * 3)
    released = objective.energy_at(still, shifted, Fraction(1))
    return released < objective.moments.spread - source_size(objective)
