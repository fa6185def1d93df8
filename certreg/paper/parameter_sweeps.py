"""Parameter sweeps beyond the paper: what damping, noise, size, symmetry and start change.

Along each family, for many instances at each value: the steps of explicit Euler, the time to escape
from the best saddle, and the margin of the eigenvalues, with what the linearised dynamics predicts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.dynamics.batch import Bodies, bodies_of, simulate_many
from certreg.dynamics.integrators import SimulationSettings
from certreg.equilibrium.batch import Solutions, exactly, solve_many
from certreg.geometry.so3 import rotation_matrices
from certreg.native.layout import QUATERNION_STATE, Records
from certreg.native.loops import BASIN_SHARE, Integrator
from certreg.paper.experiments import NO_BASIN
from certreg.paper.parameter_families import FAMILIES, Family, Sample

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.paper.observations import StageProgress

INSTANCES = 200  # at each value: the median is known to a tenth of the spread
FULL_POINTS = 10_000  # of clouds larger than that fewer instances are made
LEAST_INSTANCES = 10  # all the same
PORTION_POINTS = 1 << 19  # made at a time: 25 MB
ESCAPE_STEP = 0.04  # of the time in which a displacement grows by e: wrong by 10^-4
SWEEPS_FILE = "maps.csv"
SIMULATION = SimulationSettings(
    threads=2,
    rest_angle=math.pi,  # the paper's stop, in the basin: rates alone say how near a body is
    least_step=0.0,  # a body too stiff for explicit Euler shows as one of very many steps
)
AT_ONCE = replace(
    SIMULATION,
    speed_tolerance=1e100,  # every state counts as slow, so that a run ends on entering the basin
    first_perturbation=0.0,  # and no state is disturbed
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measurements:
    """What was measured at one value of the parameter, one entry per instance, (count,) each.

    steps: of explicit Euler until slow and in the basin. escape_times: from rest, the sample's
    distance from the best saddle towards the optimum, until the body can only end at the optimum
    (less than 0.4 of the barrier above it), by the implicit midpoint rule. margins: see
    `equilibrium.Solutions`. predicted_*: by theory; NaN where it says nothing.
    converged: at the optimum. lost: the paper's rule stops it more than 90 degrees from there.
    four: exactly four equilibria, decided by proved bounds or in exact arithmetic.
    """

    value: float
    steps: NDArray[np.float64]
    escape_times: NDArray[np.float64]
    margins: NDArray[np.float64]
    predicted_steps: NDArray[np.float64]
    predicted_escape_times: NDArray[np.float64]
    predicted_margins: NDArray[np.float64]
    converged: NDArray[np.bool_]
    lost: NDArray[np.bool_]
    four: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """What a sweep shows of every instance: a field of `Measurements`; which instance is worst."""

    name: str
    title: str
    worst: Callable[[NDArray[np.float64]], Any]


QUANTITIES = (
    Quantity(name="steps", title="Steps of\nexplicit Euler", worst=np.max),
    Quantity(name="escape_times", title="Escape time from\nthe best saddle", worst=np.max),
    Quantity(name="margins", title="Least gap of the\neigenvalues, relative", worst=np.min),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curves:
    """Median, worst and predicted median of one quantity at each value of a sweep, (values,)."""

    median: NDArray[np.float64]
    worst: NDArray[np.float64]
    predicted: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sweep:
    """A family measured at all its values, ascending."""

    family: Family
    measurements: tuple[Measurements, ...]

    def curves(self, quantity: Quantity) -> Curves:
        """A quantity along the family."""
        values, predicted = (
            [getattr(each, name) for each in self.measurements]
            for name in (quantity.name, f"predicted_{quantity.name}")
        )
        return Curves(
            median=np.array([np.median(v) for v in values]),
            worst=np.array([quantity.worst(v) for v in values]),
            predicted=np.array([np.median(v) for v in predicted]),
        )


def all_sweeps(seed: int, runs: int | None, progress: StageProgress) -> tuple[Sweep, ...]:
    """A sweep of each family from one seed: `runs` instances a value, fewer of large clouds."""
    total = sum(len(family.values) for family in FAMILIES.values())
    seeds = np.random.SeedSequence(seed).spawn(len(FAMILIES))
    sweeps: list[Sweep] = []
    done = 0
    for family, own in zip(FAMILIES.values(), seeds, strict=True):
        measured: list[Measurements] = []
        for value in family.values:
            progress("maps", done, total)
            count = instance_count(family.size(value), runs or INSTANCES)
            # The same random numbers at all values: what differs is what the parameter does.
            rng = np.random.default_rng(own)
            measured.append(measurements(family, value, rng, count))
            done += 1
        sweeps.append(Sweep(family=family, measurements=tuple(measured)))
    progress("maps", total, total)
    return tuple(sweeps)


def instance_count(points: int, runs: int) -> int:
    """How many instances of so many points are made where `runs` were asked for."""
    few = max(LEAST_INSTANCES, runs * FULL_POINTS // points)
    return min(runs, few)


def measurements(
    family: Family,
    value: float,
    rng: np.random.Generator,
    count: int,
    *,
    portion: int = PORTION_POINTS,
) -> Measurements:
    """One value of a family, measured in portions of so many points, which fit into memory."""
    most = max(1, portion // family.size(value))
    sizes = [min(most, count - start) for start in range(0, count, most)]
    parts = [_measured(family.sample(rng, value, size)) for size in sizes]
    names = [field.name for field in fields(Measurements)][1:]
    arrays: Any = {n: np.concatenate([part[n] for part in parts]) for n in names}
    return Measurements(value=value, **arrays)


def _measured(sample: Sample) -> dict[str, Any]:
    mu = sample.damping
    solutions = solve_many(sample.sources, sample.targets, damping=mu, spectrum=True)
    bodies = bodies_of(sample.sources, sample.targets, damping=mu)
    near = replace(bodies, starts=_near_saddle(solutions, sample.distance))
    released = near if sample.from_saddle else bodies
    ends = simulate_many(released, Integrator.EULER, settings=SIMULATION)
    modes: Any = solutions.eigenvalues
    slowest, growing = modes[:, 0, 0], modes[:, 1, 0].real
    tempo = float(np.nanmedian(growing))
    midpoint = replace(AT_ONCE, step=ESCAPE_STEP / tempo)
    escapes = simulate_many(near, Integrator.MIDPOINT, settings=midpoint)
    steps = ends.times / np.maximum(ends.steps, 1)
    predicted = _predicted_steps(slowest, mu, steps)
    return {
        "steps": ends.steps.astype(np.float64),
        "escape_times": np.where(escapes.converged, escapes.times, np.inf),
        "margins": solutions.margins,
        "predicted_steps": np.full_like(predicted, np.nan) if sample.from_saddle else predicted,
        "predicted_escape_times": predicted_escape_times(growing, mu, sample.distance),
        "predicted_margins": sample.margins,
        "converged": ends.converged,
        "lost": _lost(released, solutions),
        "four": solutions.decided | _four(sample, ~solutions.decided),
    }


def _near_saddle(solutions: Solutions, distance: float) -> Records:
    """At rest on the shortest way from the best saddle to the optimum, states (count,)."""
    best, saddle = solutions.quaternions[:, 0], solutions.quaternions[:, 1]
    q = math.cos(distance / 2.0) * saddle + math.sin(distance / 2.0) * best
    states = np.zeros(len(q), dtype=QUATERNION_STATE)
    states["q"] = q
    return states


def _lost(bodies: Bodies, solutions: Solutions) -> NDArray[np.bool_]:
    """Whether the paper's rule, slow is enough, stops further than 90 degrees from the optimum."""
    anywhere = replace(bodies, basins=np.repeat(NO_BASIN, len(bodies.records)))
    ends = simulate_many(anywhere, Integrator.EULER, settings=SIMULATION)
    traces = np.einsum("kij,kij->k", ends.rotations, rotation_matrices(solutions.quaternions[:, 0]))
    return np.asarray(traces < 1.0, dtype=np.bool_)


def _four(sample: Sample, which: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which of the instances that doubles do not decide have four equilibria, exactly."""
    four = np.zeros(len(which), dtype=np.bool_)
    for k in np.flatnonzero(which):
        shape = exactly(sample.sources[k], sample.targets[k]).classification
        four[k] = shape.pattern == (1, 1, 1, 1)
    return four


def predicted_escape_times(
    growing: NDArray[np.float64], damping: float, distance: float
) -> NDArray[np.float64]:
    """How long the linearised dynamics takes from the saddle to the basin, (count,).

    growing: (count,), the positive root s of s^2 + mu s + g. From rest the displacement grows as
    (s + mu) / (2 s + mu) e^(s t); the potential energy is 0.4 of the barrier above the optimum
    where sin^2 of half the angle from the saddle is 0.6.
    """
    exit_angle = 2.0 * math.asin(math.sqrt(1.0 - BASIN_SHARE))
    share = (growing + damping) / (2.0 * growing + damping)
    return np.maximum(0.0, np.log(exit_angle / (distance * share))) / growing


def _predicted_steps(
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


def sweep_rows(sweeps: Sequence[Sweep]) -> Iterator[dict[str, Any]]:
    """A row for each value of each sweep, of a CSV file or the JSON document.

    Of each quantity the median, the worst and the median that theory predicts, None where it
    predicts none or where the number is infinite: times in the springs' own unit. Then how many
    instances converged, how many the paper's rule stops more than 90 degrees from the optimum, and
    how many have exactly four equilibria.
    """
    for sweep in sweeps:
        curves = {quantity.name: sweep.curves(quantity) for quantity in QUANTITIES}
        for k, each in enumerate(sweep.measurements):
            row: dict[str, Any] = {
                "map": sweep.family.name,
                "value": each.value,
                "instances": len(each.steps),
            }
            for name, curve in curves.items():
                row[f"{name}_median"] = _finite(curve.median[k])
                row[f"{name}_worst"] = _finite(curve.worst[k])
                row[f"{name}_told"] = _finite(curve.predicted[k])
            row["converged"] = int(each.converged.sum())
            row["lost_by_the_papers_rule"] = int(each.lost.sum())
            row["four_equilibria"] = int(each.four.sum())
            yield row


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
