"""Everything that the experiments observe, from one seed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from certreg.paper.comparisons import Comparison, compare
from certreg.paper.construction import Scene, scene
from certreg.paper.equilibria import EquilibriumRun, equilibrium_run
from certreg.paper.polygons import SQUARE, TRIANGLE, Turn, exact_sums, turn
from certreg.paper.poses import Gallery, gallery
from certreg.paper.simulations import SimulationRun, simulation_run
from certreg.problem import (
    PAPER_DAMPING,
    PAPER_POINTS,
    PAPER_SIGMA,
    Instances,
    RegistrationProblem,
    gaussian_instances,
)
from certreg.settings import ReproductionSettings

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


class Announcer(Protocol):
    """Told how far a stage is; for whoever watches."""

    def __call__(self, stage: str, done: int, total: int) -> None:
        """`done` of `total` parts of a stage are done."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What the instances are made of. N and mu are not stated in the paper.

    runs: of either experiment; None: as many as in the paper.
    """

    points: int = PAPER_POINTS
    noise: float = PAPER_SIGMA
    damping: float = PAPER_DAMPING
    seed: int = 0
    runs: int | None = None
    settings: ReproductionSettings = field(default_factory=ReproductionSettings)

    @property
    def equilibrium_runs(self) -> int:
        """Instances whose equilibria are found."""
        return self.settings.equilibrium_runs if self.runs is None else self.runs

    @property
    def simulation_runs(self) -> int:
        """Instances that are simulated."""
        return self.settings.simulation_runs if self.runs is None else self.runs

    def problem(self, made: Instances, index: int) -> RegistrationProblem:
        """One of the instances made, in the paper's units."""
        return RegistrationProblem(
            made.sources[index],
            made.targets[index],
            sigma=self.noise if self.noise > 0.0 else None,
            damping=self.damping,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observations:
    """What was observed. balance_sums: of each polygon, polynomials that vanish if it balances."""

    setup: Setup
    comparisons: tuple[Comparison, ...]
    equilibria: tuple[EquilibriumRun, ...]
    simulations: tuple[SimulationRun, ...]
    turns: tuple[Turn, ...]
    balance_sums: tuple[tuple[Any, ...], ...]
    scene: Scene
    gallery: Gallery


def observe(setup: Setup, progress: Announcer) -> Observations:
    """Every experiment. Raises InvalidProblemError for a setup that makes no instances."""
    seeds = np.random.SeedSequence(setup.seed).spawn(3)
    resting, moving, comparing = map(np.random.default_rng, seeds)
    settings = setup.settings
    first = _made(setup, resting, setup.equilibrium_runs)
    second = _made(setup, moving, setup.simulation_runs)
    polygons = (TRIANGLE, SQUARE)

    def at(index: int) -> tuple[Comparison, EquilibriumRun]:
        problem = setup.problem(first, index)
        return compare(problem, comparing, settings.states), equilibrium_run(problem)

    def simulated(index: int) -> SimulationRun:
        return simulation_run(setup.problem(second, index), second.rotations[index], settings)

    found = list(_each(at, len(first.rotations), "equilibria", progress))
    return Observations(
        setup=setup,
        comparisons=tuple(comparison for comparison, _ in found),
        equilibria=tuple(run for _, run in found),
        simulations=tuple(_each(simulated, len(second.rotations), "simulations", progress)),
        turns=tuple(turn(polygon, setup.damping) for polygon in polygons),
        balance_sums=tuple(exact_sums(polygon) for polygon in polygons),
        scene=scene(),
        gallery=gallery(),
    )


def _made(setup: Setup, rng: np.random.Generator, count: int) -> Instances:
    return gaussian_instances(rng, points=setup.points, sigma=setup.noise, count=count)


def _each(
    observed: Callable[[int], Any], count: int, stage: str, progress: Announcer
) -> Iterator[Any]:
    for index in range(count):
        progress(stage, index, count)
        yield observed(index)
    progress(stage, count, count)
