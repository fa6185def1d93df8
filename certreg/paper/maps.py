"""Maps beyond the paper: what damping, noise, size, symmetry and start change.

Along each family, for many instances at each value: the steps of explicit Euler, the time to escape
from the best saddle, and the margin of the eigenvalues, with what the linearised dynamics tells.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics import Ensemble, ensemble, simulate_many
from certreg.equilibrium import exactly, solve_many
from certreg.geometry import rotation_matrix
from certreg.native import Integrator
from certreg.paper.families import FAMILIES
from certreg.paper.scheme import NO_BASIN
from certreg.settings import MapSettings, SimulationSettings

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from certreg.equilibrium import Solutions
    from certreg.paper.families import Family, Sample
    from certreg.paper.observations import Announcer

SIMULATION = SimulationSettings(
    threads=2,
    rest_angle=math.pi,  # the paper's stop, in the basin: rates alone say how near a body is
    least_step=0.0,  # a body too stiff for explicit Euler shows as one of very many steps
)
AT_ONCE = replace(
    SIMULATION,
    speed_tolerance=1e100,  # every state counts as slow, so that a run ends on entering the basin
    first_kick=0.0,
    largest_kick=0.0,  # and no state is disturbed
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Level:
    """What was measured at one value of the parameter, one entry per instance, (count,) each.

    steps: of explicit Euler until slow and in the basin. escape_times: from rest, the sample's
    distance from the best saddle towards the optimum, until the body can only end at the optimum
    (less than 0.4 of the barrier above it), by the implicit midpoint rule. margins: see
    `instances.Solutions`. told_*: what theory tells; NaN where nothing.
    converged: at the optimum. lost: the paper's rule stops it more than 90 degrees from there.
    four: exactly four equilibria, decided by proved bounds or in exact arithmetic.
    """

    value: float
    steps: NDArray[np.float64]
    escape_times: NDArray[np.float64]
    margins: NDArray[np.float64]
    told_steps: NDArray[np.float64]
    told_escape_times: NDArray[np.float64]
    told_margins: NDArray[np.float64]
    converged: NDArray[np.bool_]
    lost: NDArray[np.bool_]
    four: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """What a map shows of every instance: fields of `Level`, and which instance is the worst."""

    name: str
    label: str
    told: str
    worst: Callable[[NDArray[np.float64]], Any]


MEASURES = (
    Measure(name="steps", label="steps of explicit Euler", told="told_steps", worst=np.max),
    Measure(
        name="escape_times",
        label="escape time from the best saddle",
        told="told_escape_times",
        worst=np.max,
    ),
    Measure(name="margins", label="margin of the eigenvalues", told="told_margins", worst=np.min),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curves:
    """Median, worst and told median of one measure at each value of a map, (levels,) each."""

    median: NDArray[np.float64]
    worst: NDArray[np.float64]
    told: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Map:
    """A family measured at all its values, ascending."""

    family: Family
    levels: tuple[Level, ...]

    def curves(self, measure: Measure) -> Curves:
        """A measure along the family."""
        values = [getattr(each, measure.name) for each in self.levels]
        return Curves(
            median=np.array([np.median(v) for v in values]),
            worst=np.array([measure.worst(v) for v in values]),
            told=np.array([np.median(getattr(each, measure.told)) for each in self.levels]),
        )


def measured_maps(
    seed: int, runs: int | None, progress: Announcer, settings: MapSettings | None = None
) -> tuple[Map, ...]:
    """All maps, `runs` instances at each value (of very large clouds fewer), from one seed."""
    settings = settings or MapSettings()
    total = sum(len(family.values) for family in FAMILIES.values())
    seeds = np.random.SeedSequence(seed).spawn(len(FAMILIES))
    found: list[Map] = []
    done = 0
    for family, own in zip(FAMILIES.values(), seeds, strict=True):
        levels: list[Level] = []
        for value in family.values:
            progress("maps", done, total)
            count = instances(family.size(value), runs or settings.instances, settings)
            # The same random numbers at all values: what differs is what the parameter does.
            levels.append(level(family, value, np.random.default_rng(own), count, settings))
            done += 1
        found.append(Map(family=family, levels=tuple(levels)))
    progress("maps", total, total)
    return tuple(found)


def instances(points: int, runs: int, settings: MapSettings) -> int:
    """How many instances of so many points."""
    few = max(settings.least_instances, runs * settings.full_points // points)
    return min(runs, few)


def level(
    family: Family,
    value: float,
    rng: np.random.Generator,
    count: int,
    settings: MapSettings | None = None,
) -> Level:
    """One value of a family, measured in portions that fit into memory."""
    settings = settings or MapSettings()
    most = max(1, settings.portion_points // family.size(value))
    sizes = [min(most, count - start) for start in range(0, count, most)]
    parts = [_measured(family.sample(rng, value, size), settings) for size in sizes]
    names = [field.name for field in fields(Level)][1:]
    arrays: Any = {n: np.concatenate([part[n] for part in parts]) for n in names}
    return Level(value=value, **arrays)


def _measured(sample: Sample, settings: MapSettings) -> dict[str, Any]:
    mu = sample.damping
    found = solve_many(sample.sources, sample.targets, damping=mu, spectrum=True)
    bodies = ensemble(sample.sources, sample.targets, damping=mu)
    near = replace(bodies, starts=_near_saddle(found, sample.distance))
    released = near if sample.from_saddle else bodies
    ends = simulate_many(released, Integrator.EULER, settings=SIMULATION)
    modes: Any = found.eigenvalues
    slowest, growing = modes[:, 0, 0], modes[:, 1, 0].real
    tempo = float(np.nanmedian(growing))
    midpoint = replace(AT_ONCE, step=settings.escape_step / tempo)
    escapes = simulate_many(near, Integrator.MIDPOINT, settings=midpoint)
    steps = ends.times / np.maximum(ends.steps, 1)
    told = _told_steps(slowest, mu, steps)
    return {
        "steps": ends.steps.astype(np.float64),
        "escape_times": np.where(escapes.converged, escapes.times, np.inf),
        "margins": found.margins,
        "told_steps": np.full_like(told, np.nan) if sample.from_saddle else told,
        "told_escape_times": told_escape_times(growing, mu, sample.distance),
        "told_margins": sample.margins,
        "converged": ends.converged,
        "lost": _lost(released, found),
        "four": found.decided | _four(sample, ~found.decided),
    }


def _near_saddle(found: Solutions, distance: float) -> NDArray[np.float64]:
    """At rest on the shortest way from the best saddle to the optimum, (count, 13)."""
    best, saddle = found.quaternions[:, 0], found.quaternions[:, 1]
    q = math.cos(distance / 2.0) * saddle + math.sin(distance / 2.0) * best
    return np.hstack([np.zeros((len(q), 3)), q, np.zeros((len(q), 6))])


def _lost(bodies: Ensemble, found: Solutions) -> NDArray[np.bool_]:
    """Whether the paper's rule, slow is enough, stops further than 90 degrees from the optimum."""
    anywhere = replace(bodies, basins=np.tile(NO_BASIN, (len(bodies.bodies), 1)))
    ends = simulate_many(anywhere, Integrator.EULER, settings=SIMULATION)
    traces = np.einsum("kij,kij->k", ends.rotations, _rotations(found.quaternions[:, 0]))
    return np.asarray(traces < 1.0, dtype=np.bool_)


def _four(sample: Sample, which: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which of the instances that doubles do not decide have four equilibria, exactly."""
    four = np.zeros(len(which), dtype=np.bool_)
    for k in np.flatnonzero(which):
        shape = exactly(sample.sources[k], sample.targets[k]).classification
        four[k] = shape.pattern == (1, 1, 1, 1)
    return four


def told_escape_times(
    growing: NDArray[np.float64], damping: float, distance: float
) -> NDArray[np.float64]:
    """How long the linearised dynamics takes from the saddle to the basin, (count,).

    growing: (count,), the positive root s of s^2 + mu s + g. From rest the displacement grows as
    (s + mu) / (2 s + mu) e^(s t); the potential energy is 0.4 of the barrier above the optimum
    where sin^2 of half the angle from the saddle is 0.6.
    """
    exit_angle = 2.0 * math.asin(math.sqrt(1.0 - SIMULATION.basin_share))
    share = (growing + damping) / (2.0 * growing + damping)
    return np.maximum(0.0, np.log(exit_angle / (distance * share))) / growing


def _told_steps(
    slowest: NDArray[np.complex128], damping: float, step: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Steps until the slowest mode, one radian from rest, has rates below the stop, (count,).

    slowest: (count,), the root s of s^2 + mu s + g nearest to zero; the other is -mu - s. The rates
    (R', v or omega, and acceleration) are sqrt(2 + |s|^2) times the velocity, which is
    g |e^(s t) - e^(s' t)| / |s - s'|, near critical damping g t e^(s t). Explicit Euler multiplies
    by |1 + h s| in a step instead of e^(Re s h).
    """
    other = -damping - slowest
    rate = -np.log(np.abs(1.0 + step * slowest)) / step
    size = np.abs(slowest * other) * np.sqrt(2.0 + np.abs(slowest) ** 2)
    apart = 1.0 / np.maximum(np.abs(other - slowest), 1e-9)
    time = np.ones_like(rate)
    for _ in range(40):  # contracts by 1 / (rate * time), a tenth
        reached = size * np.minimum(time, apart) / SIMULATION.speed_tolerance
        time = np.maximum(1.0, np.log(reached)) / rate
    return time / step


def _rotations(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.moveaxis(np.array(rotation_matrix(list(quaternions.T))), -1, 0)
