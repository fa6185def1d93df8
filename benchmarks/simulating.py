"""Simulation beside the paper's loop in NumPy and SciPy's adaptive solvers; threads; size.

Ratios are of seconds per step (Euler) or per registration (splitting), N = 100. The NumPy loop is
the paper's scheme as one writes it, O(N) a step; `matrix products` is the same with every sum over
points as one. SciPy gets the equations of motion in moments, O(1), and the best of three methods.
"""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.clouds import random_problem
from benchmarks.measuring import Figure, Quantity, fastest
from certreg.dynamics.batch import Bodies, bodies_of
from certreg.dynamics.body import certified_basin, steps_of
from certreg.dynamics.integrators import SimulationSettings, step_parameters
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.simulation import simulate
from certreg.dynamics.states import start_at_rest
from certreg.dynamics.valleys import SprungBody, spring_body
from certreg.native.engine import current_engine
from certreg.native.layout import MATRIX_STATE, named
from certreg.native.layout import plain as doubles
from certreg.native.loops import Batch, Integrator
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import ExactMoments, exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.problem.stiffness import spring_moments

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


DAMPING = 2.0  # not stated in the paper: with it, a run takes some 1200 steps
SINGLE, BATCHED, SCIPY = 1000.0, 6000.0, 5000.0  # times faster
THREADS = 1.6  # times faster on two cores than on one; the rest is for a machine that is shared
FLAT = 1.2  # slowest over fastest, from ten points to ten million
LOOP_STEPS = 40  # of the NumPy loops, in one turn
INSTANCES = {Integrator.EULER: 512, Integrator.SPLITTING: 4096}
ROUNDS, BLOCKS = 40, 10
TIGHT = SimulationSettings(speed_tolerance=1e-10)
SPRING_SINGLE, SPRING_BATCHED, SPRING_STEPS = 5.0, 30.0, 20_000  # million steps per second; steps
SIZES = (10, 1000, 100_000, 10_000_000)


def measure() -> Iterator[Figure]:
    print(f"      {current_engine().words}")
    yield from _euler()
    yield _splitting()
    yield from _springs()
    yield _threads()
    yield _flat()


def _euler() -> Iterator[Figure]:
    problem = random_problem(100, noise=0.1)
    plain, tuned = (Loop(problem, products=products) for products in (False, True))
    assert np.allclose(plain.run(50), tuned.run(50), atol=1e-12)
    single, many = _single(problem, Integrator.EULER), _many(Integrator.EULER)
    again = [_again(batch, SimulationSettings()) for batch in (single, many)]
    again[0]()
    assert np.allclose(plain.run(int(single.taken[0]) + 9), doubles(single.states)[0], atol=1e-9)
    times = fastest(
        lambda: plain.run(LOOP_STEPS),
        lambda: tuned.run(LOOP_STEPS),
        *again,
        rounds=ROUNDS,
    )
    steps = [LOOP_STEPS, LOOP_STEPS, int(single.taken.sum()), int(many.taken.sum())]
    numpy, matrices, alone, together = (t / n for t, n in zip(times, steps, strict=True))
    for what, ours, least in (("single", alone, SINGLE), ("batched", together, BATCHED)):
        yield Figure(
            what=f"NumPy / Euler, {what}",
            value=Quantity(numpy / ours, "x"),
            least=least,
            beside={
                "certreg": Quantity(round(1e-6 / ours, 1), "M steps/s"),
                "NumPy": Quantity(numpy, "s"),
                "matrix products": Quantity(matrices, "s"),
                "ratio to that": Quantity(matrices / ours, "x"),
            },
        )


def _splitting() -> Figure:
    problem = random_problem(100, noise=0.1)
    many = _many(Integrator.SPLITTING)
    again = _again(many, TIGHT)
    again()
    assert (many.status == 1).all()
    flow = Flow(problem)
    solvers = {name: _solver(flow, name) for name in ("RK45", "DOP853", "LSODA")}
    for solve in solvers.values():
        assert np.abs(flow.rate(0.0, solve())).max() < 1e-9
    ours, *theirs = fastest(again, *solvers.values(), rounds=5)
    ours /= len(many.bodies)
    return Figure(
        what="SciPy / splitting, 1e-10",
        value=Quantity(min(theirs) / ours, "x"),
        least=SCIPY,
        beside={
            "certreg": Quantity(ours, "s"),
            "steps": Quantity(round(float(many.taken.mean()), 1), ""),
            **{name: Quantity(t, "s") for name, t in zip(solvers, theirs, strict=True)},
        },
    )


def _springs() -> Iterator[Figure]:
    """Steps of the splitting on general springs: 73 sums, so that no step knows how many points."""
    rng = np.random.default_rng(0)
    bodies: list[SprungBody] = []
    for count in (20, 200, 2000) * 5 + (20,):
        source = rng.normal(size=(count, 3))
        target = source + 0.1 * rng.normal(size=(count, 3))
        planes = RegistrationProblem(source, target, normals=rng.normal(size=(count, 3)))
        bodies.append(spring_body(spring_moments(planes), DAMPING))
    for what, some, steps, least in (
        ("single", bodies[:1], SPRING_STEPS, SPRING_SINGLE),
        ("batched", bodies * 16, SPRING_STEPS // 40, SPRING_BATCHED),
    ):
        starts = np.array([body.start for body in some])
        settings = SimulationSettings(step=0.01, max_steps=steps, speed_tolerance=0.0)
        batch = Batch.of(
            Integrator.SPLITTING,
            bodies=np.array([body.record for body in some]),
            steps=steps_of(Integrator.SPLITTING, some, starts, settings),
            states=starts,
        )
        (seconds,) = fastest(_again(batch, settings), rounds=ROUNDS)
        rate = float(batch.taken.sum()) / seconds / 1e6
        yield Figure(
            what=f"general springs, {what}", value=Quantity(rate, "M steps/s"), least=least
        )


def _threads() -> Figure:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    many = _many(Integrator.EULER, 1024)
    one, two = (_again(many, SimulationSettings(threads=threads)) for threads in (1, 2))
    alone = both = np.inf
    for _ in range(BLOCKS):  # until both cores were ours for once
        times = fastest(one, two, rounds=ROUNDS)
        alone, both = min(alone, times[0]), min(both, times[1])
        if alone >= THREADS * both:
            break
    return Figure(
        what="one thread / two",
        value=Quantity(alone / both, "x"),
        least=THREADS if (cores or 1) >= 2 else None,
        beside={"one": Quantity(alone, "s"), "two": Quantity(both, "s")},
    )


def _flat() -> Figure:
    """From the moments on; those of a cloud k times over follow from those of the cloud."""
    base = random_problem(10, noise=0.1)
    moments = exact_moments(base)
    thousand = RegistrationProblem(
        np.tile(base.source, (100, 1)),
        np.tile(base.target, (100, 1)),
        weights=np.tile(base.weights, 100),
    )
    assert exact_moments(thousand) == _times(moments, 100)
    works = [_registered(_times(moments, size // 10)) for size in SIZES]
    times = fastest(*works, rounds=ROUNDS)
    return Figure(
        what="after the moments, any N",
        value=Quantity(max(times) / min(times), "x"),
        bound=FLAT,
        beside={f"N = {n}:": Quantity(t, "s") for n, t in zip(SIZES, times, strict=True)},
    )


def _times(moments: ExactMoments, k: int) -> ExactMoments:
    """The moments of the same points k times: sums k-fold, products of sums k^2-fold."""

    def scaled(entries: Any, factor: int) -> Any:
        if isinstance(entries, int):
            return entries * factor
        return tuple(scaled(entry, factor) for entry in entries)

    sums = ("mass", "source_sum", "target_sum")
    products = ("cross", "source_scatter", "target_scatter")
    changed = {name: scaled(getattr(moments, name), k) for name in sums}
    changed |= {name: scaled(getattr(moments, name), k * k) for name in products}
    return replace(moments, n=k * moments.n, **changed)


def _registered(moments: ExactMoments) -> Callable[[], object]:
    return lambda: simulate(Isotropic(replace(moments)), DAMPING, Integrator.SPLITTING)


def _single(problem: RegistrationProblem, integrator: Integrator) -> Batch:
    found = Isotropic(exact_moments(problem))
    moving = rigid_body(found.moments, DAMPING)
    basin = certified_basin(found, moving.length_exponent)
    start = named(start_at_rest(found.moments, moving.length_exponent), MATRIX_STATE)
    records = (moving.record, basin.record, start)
    return _batch(integrator, *(record[np.newaxis] for record in records))


def _bodies(count: int) -> Bodies:
    problems = [random_problem(100, seed=seed, noise=0.1) for seed in range(64)]
    some = bodies_of(
        [problem.source for problem in problems],
        [problem.target for problem in problems],
        damping=DAMPING,
    )
    repeat = count // 64
    names = ("records", "basins", "starts", "length_exponents")
    tiled: dict[str, Any] = {name: np.tile(getattr(some, name), repeat) for name in names}
    points = {name: np.tile(getattr(some, name), (repeat, 1)) for name in ("centres", "origins")}
    return replace(some, **tiled, **points)


def _many(integrator: Integrator, count: int | None = None) -> Batch:
    bodies = _bodies(count or INSTANCES[integrator])
    starts = bodies.starts
    if integrator is Integrator.EULER:
        starts = np.zeros(len(starts), dtype=MATRIX_STATE)
        starts["c"], starts["R"] = bodies.starts["c"], np.eye(3)
    return _batch(integrator, bodies.records, bodies.basins, starts)


def _batch(integrator: Integrator, bodies: Any, basins: Any, starts: Any) -> Batch:
    steps = step_parameters(integrator, bodies, basins, SimulationSettings())
    return Batch.of(integrator, bodies=bodies, basins=basins, steps=steps, states=starts)


def _again(batch: Batch, settings: SimulationSettings) -> Callable[[], object]:
    """The batch from its start to its end, again and again."""
    starts = batch.states.copy()

    def work() -> None:
        batch.states[:] = starts
        current_engine().run(batch, settings.rules)

    return work


def hat(a: Any) -> Any:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


class Loop:
    """The scheme of the paper in NumPy: explicit Euler, projection, stop at |s'| < 1e-4."""

    def __init__(self, problem: RegistrationProblem, *, products: bool) -> None:
        moments = exact_moments(problem)
        moving = rigid_body(moments, DAMPING)
        self.start = start_at_rest(moments, moving.length_exponent)
        unit, w = 2.0**moving.length_exponent, problem.weights
        self.w, self.mass = w, w.sum()
        self.x = (problem.source - w @ problem.source / self.mass) / unit
        self.y = (problem.target - w @ problem.target / self.mass) / unit
        self.J = moving.inertia * self.mass
        self.inverse = np.linalg.inv(self.J)
        self.torque_of = self.by_products if products else self.by_points

    def by_points(self, c: Any, R: Any, v: Any, omega: Any) -> tuple[Any, Any]:
        place = self.x @ R.T + c
        speed = np.cross(omega, self.x) @ R.T + v
        force = self.w[:, None] * (2.0 * (self.y - place) - DAMPING * speed)
        return force.sum(axis=0), np.cross(self.x, force @ R).sum(axis=0)

    def by_products(self, c: Any, R: Any, v: Any, omega: Any) -> tuple[Any, Any]:
        turning = 2.0 * R + DAMPING * R @ hat(omega)
        force = self.w[:, None] * (2.0 * self.y - (2.0 * c + DAMPING * v) - self.x @ turning.T)
        A = self.x.T @ (force @ R)
        torque = np.array([A[1, 2] - A[2, 1], A[2, 0] - A[0, 2], A[0, 1] - A[1, 0]])
        return force.sum(axis=0), torque

    def run(self, steps: int, h: float = 0.01) -> Any:
        c, R, v, omega = np.split(self.start, [3, 12, 15])
        R = R.reshape(3, 3)
        for _ in range(steps):
            force, torque = self.torque_of(c, R, v, omega)
            a, W = force / self.mass, hat(omega)
            alpha, turning = self.inverse @ (torque - W @ (self.J @ omega)), R @ W
            if np.linalg.norm(np.concatenate([v, turning.ravel(), a, alpha])) < 1e-4:
                break
            left, _, right = np.linalg.svd(R + h * turning)
            c, R, v, omega = c + h * v, left @ right, v + h * a, omega + h * alpha
        return np.concatenate([c, R.ravel(), v, omega])


class Flow:
    """The equations of motion for SciPy: in moments, so that no evaluation costs O(N)."""

    def __init__(self, problem: RegistrationProblem) -> None:
        moments = exact_moments(problem)
        moving = rigid_body(moments, DAMPING)
        self.start = start_at_rest(moments, moving.length_exponent)
        self.C, self.J = moving.cross_covariance, moving.inertia
        self.inverse = np.linalg.inv(self.J)

    def rate(self, _: float, state: Any) -> Any:
        R, v, omega = state[3:12].reshape(3, 3), state[12:15], state[15:]
        A = R.T @ self.C
        torque = 2.0 * np.array([A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]])
        W = hat(omega)
        alpha = self.inverse @ (torque - W @ (self.J @ omega)) - DAMPING * omega
        return np.concatenate([v, (R @ W).ravel(), -2.0 * state[:3] - DAMPING * v, alpha])


def _solver(flow: Flow, method: Any) -> Callable[[], Any]:
    """From the start until |s'| is below 1e-10, which is the solver's own tolerance, too.

    RK45 never quite gets there (4e-10), and goes on to the end of the time it is given.
    """

    def rested(time: float, state: Any) -> float:
        return float(np.linalg.norm(flow.rate(time, state))) - TIGHT.speed_tolerance

    rested.terminal = True

    def solve() -> Any:
        end = solve_ivp(
            flow.rate,
            (0.0, 100.0),
            flow.start,
            method=method,
            events=rested,
            rtol=1e-10,
            atol=1e-10,
        )
        return end.y[:, -1]

    return solve
