"""What the dynamics says of a problem whose scale is free: its equilibria, and a simulated motion.

With the asymmetric scale the size of the body is a state, and the equilibria are the eigenlines
with a positive eigenvalue. The symmetric scale is the same whatever the rotation: a body of that
size is rigid, and has the equilibria of the rigid body.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg._loading import cached_property
from certreg.dynamics import (
    BreathingTrajectory,
    never_collapses,
    simulate_breathing,
)
from certreg.equilibrium import breathing_equilibria
from certreg.exact import nearest_double, power_of_two
from certreg.native import Integrator
from certreg.problem import Verb, lift, require_supported
from certreg.results import OUT_OF_RANGE, Absent, Explained, Presented

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.dynamics import SimulationSettings
    from certreg.equilibrium import BreathingEquilibria, Component, EquilibriumSet
    from certreg.objective import Isotropic
    from certreg.problem import RegistrationProblem

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
class SimulatedBreathing(BreathingTrajectory, Presented):
    """A simulation with a free scale, and where it ended beside the optimum.

    problem, objective: that it is of.
    """

    problem: RegistrationProblem
    objective: Isotropic

    __repr__ = BreathingTrajectory.__repr__

    @cached_property
    def angle_to_optimum(self) -> float:
        """Radians, from the last rotation to the nearest optimum."""
        return self.objective.angle_to_optimum(lift(self.quaternion).integers)

    @property
    def best_scale(self) -> float | None:
        """That of the optimum, target over source; None where no double holds it."""
        return nearest_double(self.objective.best_scale(self.objective.optimum))

    @property
    def energies(self) -> tuple[float | Absent, ...]:
        """V_p + V_k at the start and at the end, in objective units."""
        unit = self.objective.moments.total_weight * power_of_two(2 * self.length_exponent)
        ends = (self.potential + self.kinetic)[[0, -1]].tolist()
        energies = [nearest_double(Fraction(value) * unit) for value in ends]
        return tuple(OUT_OF_RANGE if energy is None else energy for energy in energies)

    @cached_property
    def never_collapses(self) -> bool:
        """Whether it is proved that the exact motion from the start never comes to the scale 0."""
        return never_collapses(self.objective)


_RUN = tuple(one.name for one in fields(BreathingTrajectory))


def simulated_breathing(
    problem: RegistrationProblem,
    objective: Isotropic,
    integrator: str | None,
    *,
    settings: SimulationSettings,
) -> SimulatedBreathing:
    """The motion of a body whose scale is free, released at rest where it was given at scale 1.

    Raises InvalidProblemError for other integrators than midpoint and for the symmetric scale,
    DegenerateProblemError where the dynamics is not defined.
    """
    chosen = Integrator(integrator or Integrator.MIDPOINT)
    require_supported(problem.cell, Verb(chosen.value))
    run = simulate_breathing(objective, problem.damping, settings=settings)
    kept: dict[str, Any] = {name: getattr(run, name) for name in _RUN}
    return SimulatedBreathing(**kept, problem=problem, objective=objective)
