"""What a user may set of a simulation, the step that each integrator is given, and the run.

Floating point proposes: a step decides how fast a run ends, never where it may end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.equilibrium.stability import TRANSLATION_STIFFNESS
from certreg.errors import DegenerateProblemError
from certreg.geometry.so3 import rotation_matrices
from certreg.native.engine import current_engine
from certreg.native.layout import Records, plain, record_of, symmetric
from certreg.native.library import library_if_any
from certreg.native.loops import Batch, Ending, Integrator, Log, Rules
from certreg.problem.motion import DEFAULT_DAMPING

if TYPE_CHECKING:
    from numpy.typing import NDArray


EULER_STEP = 0.01  # [Yang2020]
STABILITY_SHARE = 0.25  # of the largest stable step of explicit Euler
MIDPOINT_SHARE = 1.4  # of sqrt(2 / g_max): kills a critically damped mode in one step
MIDPOINT_MOST = 1000.0  # of that: larger steps gain nothing; halving brings them back
SPLITTING_SHARE = 0.8  # of sqrt(2 / g_max): 12 to 23 steps from anywhere
MOST_STEPS = 1 << 53  # the sum of two of them is a long integer of C
IDENTITY = np.eye(3)
FOUR, SIX, NINE = 4 * 8, 6 * 8, 9 * 8  # bytes of so many doubles
SPLITTING_HALVINGS = 8  # of the step, from the start, where a fast spin lost the state


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationSettings:
    """What may be set of a simulation.

    Parameters
    ----------
    step
        The largest, in the time unit of the springs; None: each integrator's own.
    max_steps
        After which a run ends all the same.
    speed_tolerance
        Of the norm of the 18 rates of change, below which a body is slow.
    rest_angle
        Radians from the optimum, beyond which a body that stopped would never get.
    first_perturbation
        Radians, of a slow body off a saddle; while it stays slow, the next ones are ten times as
        large.
    least_step
        Of explicit Euler; a body that is too stiff for it is refused.
    threads
        For many bodies at once.

    Raises
    ------
    ValueError
        For numbers that make no sense.

    Examples
    --------
    >>> SimulationSettings(step=0.1, max_steps=1000).speed_tolerance
    0.0001
    """

    step: float | None = None
    max_steps: int = 1_000_000  # a tenth of a second of compiled Euler steps; a thousand are usual
    speed_tolerance: float = 1e-4  # [Yang2020]
    rest_angle: float = 1e-3
    first_perturbation: float = 1e-3
    least_step: float = 1e-5  # below, a run would outlast anyone's patience
    threads: int = 1

    def __post_init__(self) -> None:
        if self.step is not None and not 0.0 < self.step < math.inf:
            raise ValueError(f"step is {self.step!r}: give a finite number above 0")
        for name in ("speed_tolerance", "rest_angle", "first_perturbation", "least_step"):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf:
                raise ValueError(f"{name} is {value!r}: give a finite number, 0 or more")
        for name, least in (("max_steps", 0), ("threads", 1)):
            value = getattr(self, name)
            if not least <= value <= MOST_STEPS:
                raise ValueError(f"{name} is {value!r}: give a whole number from {least} on")

    @property
    def rules(self) -> Rules:
        """What the loops take of it."""
        return _rules(self)


@lru_cache(maxsize=16)
def _rules(settings: SimulationSettings) -> Rules:
    """The height above the optimum over l1 - l2 bounds sin^2 of half the angle to the optimum."""
    return Rules(
        speed_tolerance=settings.speed_tolerance,
        rest_share=math.sin(settings.rest_angle / 2.0) ** 2,
        first_perturbation=settings.first_perturbation,
        max_steps=settings.max_steps,
        threads=settings.threads,
    )


DEFAULT_SETTINGS = SimulationSettings()


def step_parameters(
    integrator: Integrator, bodies: Records, basins: Records, settings: SimulationSettings
) -> Records:
    """The steps (count,), records `integrator.step`: its own, or the user's where stable.

    bodies, basins: (count,) records BODY and BASIN. Raises DegenerateProblemError where explicit
    Euler would need too small a step.
    """
    if integrator is Integrator.EULER:
        limit = _stable_euler_steps(bodies, basins, settings)
        steps = np.empty(len(bodies), dtype=integrator.step)
        steps["h"] = np.minimum(settings.step or EULER_STEP, limit)
        return steps
    if len(bodies) == 1:  # plain floats, which NumPy takes ten times as long for
        _, _, stiffest = _ratios_of_one(bodies, basins)
        own = _own_step(integrator, stiffest, bodies["damping"].item(0), settings.step, _FLOATS)
        return record_of(own, integrator.step, (1,))
    _, _, stiffest = spring_ratios(bodies, basins).T
    return own_steps(integrator, stiffest, bodies["damping"], settings.step)


def own_steps(
    integrator: Integrator,
    stiffest: NDArray[np.float64],
    damping: NDArray[np.float64],
    given: float | None,
) -> Records:
    """The steps (count,) of the midpoint rule or the splitting, records `integrator.step`.

    stiffest, damping: (count,), of bodies. given: by the user; less is taken where that is unstable
    or gains nothing.
    """
    own = _own_step(integrator, stiffest, damping, given, np)
    steps = np.empty(len(stiffest), dtype=integrator.step)
    for part, numbers in zip(integrator.step.names or (), own, strict=True):
        steps[part] = numbers
    return steps


_FLOATS = SimpleNamespace(
    maximum=max, minimum=min, sqrt=math.sqrt, exp=math.exp, expm1=math.expm1, inf=math.inf
)  # of NumPy's functions those that are needed below


def _own_step(
    integrator: Integrator, stiffest: Any, damping: Any, given: float | None, functions: Any
) -> tuple[Any, ...]:
    """The parts of steps of the midpoint rule or the splitting: of many bodies, or of one."""
    fastest = functions.maximum(TRANSLATION_STIFFNESS, stiffest)
    period = functions.sqrt(TRANSLATION_STIFFNESS / fastest)  # 1 without noise
    if integrator is Integrator.MIDPOINT:
        own = MIDPOINT_SHARE * period
        return (functions.minimum(given, MIDPOINT_MOST * own) if given else own,)
    h = functions.minimum(given or functions.inf, SPLITTING_SHARE * period)
    decayed = -damping * h
    return h, functions.exp(decayed), -functions.expm1(decayed) / damping


def integrate(batch: Batch, settings: SimulationSettings, log: Log | None = None) -> None:
    """Run every body of a batch to its end.

    The splitting's step suits small angular velocities. Where a nearly collinear body spins so fast
    that its state is lost, it starts anew with half the step.
    """
    rules = settings.rules
    if batch.integrator is not Integrator.SPLITTING:
        current_engine().run(batch, rules, log)
        return
    kept = batch.states.tobytes()  # sooner copied than records
    current_engine().run(batch, rules, log)
    if np.count_nonzero(batch.status) == len(batch.status):  # none is out of steps
        return
    starts = np.frombuffer(kept, batch.states.dtype)
    for _ in range(SPLITTING_HALVINGS):
        if batch.status.all():
            return
        unfinished = (batch.status == Ending.OUT_OF_STEPS) & (batch.taken < rules.max_steps)
        lost = np.asarray(unfinished & np.isfinite(plain(starts)).all(axis=1), dtype=np.bool_)
        if not lost.any():
            return
        again = batch.part(lost)
        again.states[:] = starts[lost]
        again.steps[:] = _halved(again.steps)
        if log is not None:
            log.clear()
        current_engine().run(again, rules, log)
        batch.put(lost, again)


def spring_ratios(bodies: Records, basins: Records) -> NDArray[np.float64]:
    """The springs beside the inertia: eigenvalues of the pencil (G, J), ascending, (count, 3).

    At the optimum a small turn phi has the energy phi^T G phi / 2, G = 2 tr(A) I - A - A^T,
    A = R^T C.
    """
    if len(bodies) == 1:
        return np.array([_ratios_of_one(bodies, basins)])
    return _ratios(basins["quaternions"][:, 0], bodies["cross"], bodies["inertia"])


def _ratios_of_one(bodies: Records, basins: Records) -> list[float]:
    body, basin = bodies.tobytes(), basins.tobytes()  # whose parts are sooner taken
    return spring_ratios_of_one(basin[:FOUR], body[:NINE], body[NINE : NINE + SIX])


def spring_ratios_of_one(q: bytes, cross: bytes, inertia: bytes) -> list[float]:
    """Those of one body, by C where it is compiled and rounding leaves J a root.

    q: the doubles of the unit quaternion of the optimum; cross: of C row by row; inertia: of the
    upper triangle of J.
    """
    compiled = library_if_any()
    try:
        return (
            _ratios_by_numpy(q, cross, inertia)
            if compiled is None
            else compiled.spring_ratios(q, cross, inertia)
        )
    except ValueError:  # J has no root: what NumPy finds then, if anything, is told
        return _ratios_by_numpy(q, cross, inertia)


def _ratios_by_numpy(q: bytes, cross: bytes, inertia: bytes) -> list[float]:
    one, rows, upper = map(np.frombuffer, (q, cross, inertia))
    return _ratios(one[np.newaxis], rows.reshape(1, 3, 3), upper[np.newaxis])[0].tolist()


def _ratios(
    q: NDArray[np.float64], cross: NDArray[np.float64], inertia: NDArray[np.float64]
) -> NDArray[np.float64]:
    aligned = rotation_matrices(q).mT @ cross
    traces = np.trace(aligned, axis1=1, axis2=2)[:, np.newaxis, np.newaxis]
    hessian = 2.0 * traces * IDENTITY - aligned - aligned.mT
    whitening = np.linalg.inv(np.linalg.cholesky(symmetric(inertia)))
    return np.linalg.eigvalsh(whitening @ hessian @ whitening.mT).astype(np.float64)


def _halved(steps: Records) -> Records:
    """Half of h, with exp(-mu h) and (1 - exp(-mu h)) / mu to match."""
    root, halves = np.sqrt(steps["decay"]), np.empty_like(steps)
    halves["h"], halves["decay"] = steps["h"] / 2.0, root
    halves["impulse"] = steps["impulse"] / (1.0 + root)
    return halves


def _stable_euler_steps(
    bodies: Records, basins: Records, settings: SimulationSettings
) -> NDArray[np.float64]:
    """The largest steps that explicit Euler is given here, (count,).

    The stiffest mode s^2 + mu s + g has g <= (l1 - l4) / least eigenvalue of J; Euler follows an
    oscillation only if h < mu / g, a decay only if h < 2 / mu.
    """
    thinnest, _, _ = np.linalg.eigvalsh(symmetric(bodies["inertia"])).T
    *_, span = basins["gaps"].T
    with np.errstate(over="ignore"):
        stiffness = np.maximum(TRANSLATION_STIFFNESS, span / np.maximum(thinnest, 5e-324))
    mu = bodies["damping"]
    limit = STABILITY_SHARE * np.minimum(1.0 / mu, mu / stiffness)
    refused = np.flatnonzero(~(limit > settings.least_step))
    if refused.size:
        first = int(refused[0])
        raise DegenerateProblemError(
            _why_no_euler(bodies[first], basins[first], settings),
            instance=first,
            value=float(limit[first]),
            limit=settings.least_step,
        )
    return limit


def _why_no_euler(body: Records, basin: Records, settings: SimulationSettings) -> str:
    """What makes a body too stiff for explicit Euler: what, if usual, would make it easier."""
    thin, _, thick = np.linalg.eigvalsh(symmetric(body["inertia"])).tolist()
    mu, span = float(body["damping"]), float(basin["gaps"].max())
    share = settings.least_step / STABILITY_SHARE  # of min(1 / mu, mu / stiffness)
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
