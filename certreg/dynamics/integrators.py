"""The step that each integrator is given, for one body or for many; and the run.

Floating point proposes: a step decides how fast a run ends, never where it may end.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.equilibrium import TRANSLATION_STIFFNESS
from certreg.errors import DegenerateProblemError
from certreg.geometry import rotation_matrix
from certreg.native import Ending, Integrator, current_engine
from certreg.problem import DEFAULT_DAMPING

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.native import Batch, Log
    from certreg.settings import SimulationSettings


def step_parameters(
    integrator: Integrator,
    parameters: NDArray[np.float64],
    basins: NDArray[np.float64],
    settings: SimulationSettings,
) -> NDArray[np.float64]:
    """The parameters of a step, (count, 1 or 3): the integrator's own, or the user's where stable.

    parameters: (count, 23) and basins: (count, 20), as `native.batch` describes them. Raises
    DegenerateProblemError where explicit Euler would need too small a step.
    """
    if integrator is Integrator.EULER:
        limit = _stable_euler_steps(parameters, basins, settings)
        return np.minimum(settings.step or settings.euler_step, limit)[:, np.newaxis]
    fastest = np.maximum(TRANSLATION_STIFFNESS, spring_ratios(parameters, basins)[:, -1])
    period = np.sqrt(TRANSLATION_STIFFNESS / fastest)  # 1 without noise
    if integrator is Integrator.MIDPOINT:
        own = settings.midpoint_share * period
        given = np.minimum(settings.step or np.inf, settings.midpoint_most * own)
        return (given if settings.step else own)[:, np.newaxis]
    h = np.minimum(settings.step or np.inf, settings.splitting_share * period)
    mu = parameters[:, 22]
    return np.column_stack([h, np.exp(-mu * h), -np.expm1(-mu * h) / mu])


def integrate(batch: Batch, settings: SimulationSettings, log: Log | None = None) -> None:
    """Run every instance of a batch to its end.

    The splitting's step suits small angular velocities. Where a nearly collinear body spins so fast
    that its state is lost, it starts anew with half the step.
    """
    starts = batch.states.copy()
    current_engine().run(batch, settings, log)
    halvings = settings.splitting_halvings if batch.integrator is Integrator.SPLITTING else 0
    for _ in range(halvings):
        unfinished = (batch.status == Ending.OUT_OF_STEPS) & (batch.taken < settings.max_steps)
        lost = np.asarray(unfinished & np.isfinite(starts).all(axis=1), dtype=np.bool_)
        if not lost.any():
            return
        again = batch.chosen(lost)
        again.states[:] = starts[lost]
        again.steps[:] = _halved(again.steps)
        if log is not None:
            log.clear()
        current_engine().run(again, settings, log)
        batch.put(lost, again)


def spring_ratios(
    parameters: NDArray[np.float64], basins: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The eigenvalues of the pencil (G, J) at the optimum, ascending, (count, 3)."""
    turned = np.moveaxis(np.array(rotation_matrix(list(basins[:, :4].T))), -1, 0)
    aligned = turned.mT @ parameters[:, :9].reshape(-1, 3, 3)
    traces = np.trace(aligned, axis1=1, axis2=2)[:, np.newaxis, np.newaxis]
    hessian = 2.0 * traces * np.eye(3) - aligned - aligned.mT
    whitening = np.linalg.inv(np.linalg.cholesky(inertias(parameters)))
    return np.linalg.eigvalsh(whitening @ hessian @ whitening.mT).astype(np.float64)


def inertias(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
    """J / M of bodies (count, 23), (count, 3, 3)."""
    return parameters[:, [9, 10, 11, 10, 12, 13, 11, 13, 14]].reshape(-1, 3, 3)


def _halved(steps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Half of h, with exp(-mu h) and (1 - exp(-mu h)) / mu to match."""
    root = np.sqrt(steps[:, 1])
    return np.column_stack([steps[:, 0] / 2.0, root, steps[:, 2] / (1.0 + root)])


def _stable_euler_steps(
    parameters: NDArray[np.float64], basins: NDArray[np.float64], settings: SimulationSettings
) -> NDArray[np.float64]:
    """The largest steps that explicit Euler is given here, (count,).

    The stiffest mode s^2 + mu s + g has g <= (l1 - l4) / least eigenvalue of J; Euler follows an
    oscillation only if h < mu / g, a decay only if h < 2 / mu.
    """
    least = np.maximum(np.linalg.eigvalsh(inertias(parameters))[:, 0], 5e-324)
    with np.errstate(over="ignore"):
        stiffness = np.maximum(TRANSLATION_STIFFNESS, basins[:, 19] / least)
    mu = parameters[:, 22]
    limit = settings.stability_share * np.minimum(1.0 / mu, mu / stiffness)
    refused = np.flatnonzero(~(limit > settings.least_step))
    if refused.size:
        raise DegenerateProblemError(_why_no_euler(parameters, basins, refused[0], settings))
    return limit


def _why_no_euler(
    parameters: NDArray[np.float64],
    basins: NDArray[np.float64],
    instance: np.intp,
    settings: SimulationSettings,
) -> str:
    """What makes an instance too stiff for explicit Euler: what, if usual, would make it easier."""
    thin, _, thick = np.linalg.eigvalsh(inertias(parameters[[instance]]))[0].tolist()
    mu, span = float(parameters[instance, 22]), float(basins[instance, 19])
    share = settings.least_step / settings.stability_share  # of min(1 / mu, mu / stiffness)
    usual = share * max(TRANSLATION_STIFFNESS, span / thick)  # had it no thin direction
    if not share * mu < 1.0:
        cause, remedy = f"the damping {mu:.3g} is so large", "take one nearer to sqrt(8)"
    elif not usual < DEFAULT_DAMPING:
        cause = "the target is so much larger than the source"
        remedy = "bring both clouds to one unit of length"
    elif not usual < mu:
        cause, remedy = f"the damping {mu:.3g} is so small", "take one nearer to sqrt(8)"
    else:
        cause = (
            "the source is so nearly collinear (its moment of inertia about its line is "
            f"{thin / thick:.1g} of that across it)"
        )
        remedy = "run `certreg simulate --integrator splitting`, whose steps stay large"
    return f"{cause} that explicit Euler would need too small a step: {remedy}"
