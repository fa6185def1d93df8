"""Evidence on the paper's claims about the motion: of the flow, and of the simulation.

`verdicts` has the table of all claims; they stand in two modules by what they are about.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.geometry.so3 import quaternion_from_matrix
from certreg.paper.equilibria import angle
from certreg.paper.evidence import NEAR, SAME_SUM, Clouds, Evidence, rough, share, tally
from certreg.paper.particles import parts
from certreg.paper.scheme import STEP, descend
from certreg.problem.problem import RegistrationProblem
from certreg.registration.enumeration import equilibria

if TYPE_CHECKING:
    from certreg.paper.observations import Observations

SPIRAL_STEPS, SPIRAL_DAMPING = 1000, 0.005
SPIRAL_RATIO = 20003 / 20000  # of a step, exactly, by the audit's row 15b
HALF_TURN = 179.0  # degrees: near enough to tell from the optimum
FINER = 1000.0  # millimetres in a metre


def converging(observed: Observations, _: Clouds) -> Evidence:
    """Row 4b: runs that come to rest, by an integrator that follows the flow at any damping."""
    at_rest = sum(run.midpoint_at_rest for run in observed.simulations)
    return tally(at_rest, observed.simulations, "runs of the implicit midpoint rule came to rest")


def falling_energy(observed: Observations, _: Clouds) -> Evidence:
    """Row 13a: V along an integrator that keeps the law, and its rate."""
    falling = sum(run.midpoint_rise <= SAME_SUM for run in observed.simulations)
    worst = max(each.dissipation for each in observed.comparisons)
    evidence = tally(
        falling, observed.simulations, "runs of the implicit midpoint rule: V falls in every step"
    )
    return Evidence(
        words=f"{evidence.words}; dV/dt is as told to {rough(worst)}",
        agrees=evidence.agrees and worst <= SAME_SUM,
    )


def rising_energy(observed: Observations, _: Clouds) -> Evidence:
    """Row 13b: V in the steps of explicit Euler."""
    rising = sum(run.first_rise > 0.0 for run in observed.simulations)
    steps = [run.rises for run in observed.simulations]
    wrong = max(abs(run.first_rise - run.predicted_rise) for run in observed.simulations)
    least, most = (f(run.first_rise for run in observed.simulations) for f in (min, max))
    return Evidence(
        words=f"V rises in the first step of {share(rising, observed.simulations)} runs, by "
        f"{least * 1e6:.3g} to {most * 1e6:.3g} millionths, as told to {rough(wrong)}; in "
        f"{min(steps)} to {max(steps)} steps of each run",
        agrees=rising == len(steps) and wrong <= SAME_SUM,
    )


def always_optimal(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 15a: where simulations end that come to rest, and one that starts at a saddle."""
    stopped = [run for run in observed.simulations if run.stopped]
    near = sum(run.distance <= NEAR for run in stopped)
    evidence = tally(near, stopped, "simulations that come to rest do so at the optimum")
    steps = np.median([run.steps for run in observed.simulations])
    stuck = descend(clouds[0])
    off = _off(stuck.rotation, clouds[0])
    return Evidence(
        words=f"{evidence.words}, after {steps:.0f} steps in the median; started at the saddle the "
        f"body stays, {off:.0f}° off, after {stuck.steps} steps",
        agrees=evidence.agrees and stuck.steps == 0 and off > HALF_TURN,
    )


def likely_optimal(observed: Observations, _: Clouds) -> Evidence:
    """Row 15d: how many simulations that come to rest do so at the optimum; a count, no theorem."""
    stopped = [run for run in observed.simulations if run.stopped]
    near = sum(run.distance <= NEAR for run in stopped)
    return tally(near, stopped, "simulations that come to rest do so at the optimum")


def out_of_the_plane(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 9d: the square, flipped and turned out of the plane, released at rest."""
    del observed
    run = descend(clouds[0])
    off, energy = _off(run.rotation, clouds[0]), run.potential
    return Evidence(
        words=f"flipped over and turned 1.1° out of the plane, the square comes back: at rest "
        f"after "
        f"{run.steps} steps, {off:.0f}° from the optimum, V from {energy[0]:.4f} to "
        f"{energy[-1]:.4f}",
        agrees=run.stopped and off > HALF_TURN and bool(energy[-1] < energy[0]),
    )


def any_damping(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 15b: explicit Euler at two dampings."""
    cloud = clouds[0].damped(SPIRAL_DAMPING)
    run = descend(cloud, max_steps=SPIRAL_STEPS)
    c, _, v, _ = parts(run.state)
    size = v @ v + SPIRAL_DAMPING * (c @ v) + 2.0 * (c @ c)
    ratio = (float(size) / 2.0) ** (1.0 / SPIRAL_STEPS)
    stopped = sum(each.stopped for each in observed.simulations)
    return Evidence(
        words=f"μ = {observed.setup.damping:g}: {share(stopped, observed.simulations)} runs come "
        f"to rest; μ = {SPIRAL_DAMPING}: the motion of the centre grows by the factor {ratio:.6f} "
        "a step",
        agrees=math.isclose(ratio, SPIRAL_RATIO, rel_tol=SAME_SUM)
        and (stopped == len(observed.simulations) or not _small_step(observed)),
    )


def stopping_rule(observed: Observations, clouds: Clouds) -> Evidence:
    """Row 15c: where the rule stops, and in which unit."""
    del observed
    run = descend(clouds[0])
    off, energy = _off(run.rotation, clouds[0]), float(run.potential[-1])
    source, damping = clouds[0].source, clouds[0].damping
    aside = source + np.array([1.0, 0.0, 0.0])
    moved = RegistrationProblem(source, aside, damping=damping)
    finer = RegistrationProblem(source * FINER, aside * FINER, damping=damping)
    steps, longer = (descend(problem).steps for problem in (moved, finer))
    return Evidence(
        words=f"stopped after {run.steps} steps, {off:.3f}° from the optimum, V = {energy:.1f} "
        f"where 0 is possible; the octahedron moved by 1 takes {steps} steps in one unit of "
        f"length, and {longer} in a unit a thousand times smaller",
        agrees=run.steps == 0 and off > HALF_TURN and longer != steps,
    )


def _small_step(observed: Observations) -> bool:
    """Whether explicit Euler is stable for the centre: h < mu / 2 and h mu < 2."""
    return 2.0 * STEP < observed.setup.damping < 2.0 / STEP


def _off(R: Any, problem: RegistrationProblem) -> float:
    """The angle in degrees from a rotation to the optimum of a problem."""
    best = equilibria(problem).components[0].quaternion_wxyz
    return angle(quaternion_from_matrix(R), best)
