"""Everything that the experiments observe, from one seed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from certreg.dynamics.rigid import rigid_body
from certreg.geometry.so3 import rotation_matrix
from certreg.paper.experiments import EquilibriumRun, SimulationRun, equilibrium_run, simulation_run
from certreg.paper.particles import RAW_UNIT, Particles, parts
from certreg.paper.scenes import (
    SQUARE,
    TRIANGLE,
    Gallery,
    Scene,
    Turn,
    exact_sums,
    gallery,
    scene,
    turn,
)
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.problem.random_instances import (
    PAPER_DAMPING,
    PAPER_POINTS,
    PAPER_SIGMA,
    Instances,
    gaussian_instances,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray


EQUILIBRIUM_RUNS = 50  # [Yang2020]
SIMULATION_RUNS = 100  # [Yang2020]
STATES = 3  # random states per instance at which equations are compared


class StageProgress(Protocol):
    """Called with how far a stage has come."""

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

    @property
    def equilibrium_runs(self) -> int:
        """Instances whose equilibria are found."""
        return EQUILIBRIUM_RUNS if self.runs is None else self.runs

    @property
    def simulation_runs(self) -> int:
        """Instances that are simulated."""
        return SIMULATION_RUNS if self.runs is None else self.runs

    def problem(self, instances: Instances, index: int) -> RegistrationProblem:
        """One of the instances made, in the paper's units."""
        return RegistrationProblem(
            instances.sources[index],
            instances.targets[index],
            sigma=self.noise if self.noise > 0.0 else None,
            damping=self.damping,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FormulaComparison:
    """The largest relative differences over the states compared.

    objective: of V_p to the maximum-likelihood objective at t = c - R x_mean. rate: of F(s), from
    the derivation, to the Newton-Euler equations summed over the particles. dissipation: of dV/dt
    along F to -mu M |v|^2 - mu omega^T J omega.
    """

    objective: float
    rate: float
    dissipation: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observations:
    """What was observed. balance_sums: of each polygon, polynomials that vanish if it balances."""

    setup: Setup
    comparisons: tuple[FormulaComparison, ...]
    equilibria: tuple[EquilibriumRun, ...]
    simulations: tuple[SimulationRun, ...]
    turns: tuple[Turn, ...]
    balance_sums: tuple[tuple[Any, ...], ...]
    scene: Scene
    gallery: Gallery


def observe(setup: Setup, progress: StageProgress) -> Observations:
    """Every experiment. Raises InvalidProblemError for a setup that makes no instances."""
    seeds = np.random.SeedSequence(setup.seed).spawn(3)
    finding, moving, comparing = map(np.random.default_rng, seeds)
    first = _made(setup, finding, setup.equilibrium_runs)
    second = _made(setup, moving, setup.simulation_runs)
    polygons = (TRIANGLE, SQUARE)

    def at(index: int) -> tuple[FormulaComparison, EquilibriumRun]:
        problem = setup.problem(first, index)
        return compare(problem, comparing, STATES), equilibrium_run(problem)

    def simulated(index: int) -> SimulationRun:
        return simulation_run(setup.problem(second, index), second.rotations[index])

    pairs = list(_each(at, len(first.rotations), "equilibria", progress))
    return Observations(
        setup=setup,
        comparisons=tuple(comparison for comparison, _ in pairs),
        equilibria=tuple(run for _, run in pairs),
        simulations=tuple(_each(simulated, len(second.rotations), "simulations", progress)),
        turns=tuple(turn(polygon, setup.damping) for polygon in polygons),
        balance_sums=tuple(exact_sums(polygon) for polygon in polygons),
        scene=scene(),
        gallery=gallery(),
    )


def _made(setup: Setup, rng: np.random.Generator, count: int) -> Instances:
    return gaussian_instances(rng, points=setup.points, sigma=setup.noise, count=count)


def _each(
    observation: Callable[[int], Any], count: int, stage: str, progress: StageProgress
) -> Iterator[Any]:
    for index in range(count):
        progress(stage, index, count)
        yield observation(index)
    progress(stage, count, count)


def compare(
    problem: RegistrationProblem, rng: np.random.Generator, states: int
) -> FormulaComparison:
    """The comparison at random states whose R is a rotation."""
    moving = rigid_body(exact_moments(problem), problem.damping, length_exponent=RAW_UNIT)
    particles = Particles.of(problem)
    drawn = [_random_state(rng) for _ in range(states)]
    objectives = [_likelihood(particles, state) for state in drawn]
    potentials = [particles.mass * float(moving.energies(state)["potential"]) for state in drawn]
    printed, derived = [particles.rate(s) for s in drawn], [moving.rate(s) for s in drawn]
    claimed = [particles.dissipation(s) for s in drawn]
    computed = [particles.energy_rate(s) for s in drawn]
    return FormulaComparison(
        objective=_difference(potentials, objectives),
        rate=_difference(derived, printed),
        dissipation=_difference(computed, claimed),
    )


def _likelihood(particles: Particles, state: NDArray[np.float64]) -> float:
    """The sum of |y - R x - t|^2 / sigma^2 at the pose of a state."""
    c, R, _, _ = parts(state)
    t = c - R @ particles.centre
    residuals = particles.target - particles.source @ R.T - t
    return float(particles.masses @ (residuals**2).sum(axis=1))


def _difference(
    computed: list[float] | list[NDArray[np.float64]],
    claimed: list[float] | list[NDArray[np.float64]],
) -> float:
    pairs = zip(map(np.atleast_1d, computed), map(np.atleast_1d, claimed), strict=True)
    return max(float(np.linalg.norm(a - b) / np.linalg.norm(b)) for a, b in pairs)


def _random_state(rng: np.random.Generator) -> NDArray[np.float64]:
    q = rng.standard_normal(4)
    R = np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))
    c, v, omega = rng.standard_normal((3, 3))
    return np.concatenate([c, R.ravel(), v, omega])
