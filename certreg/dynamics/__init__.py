"""The damped rigid body under springs: equations of motion, integrators, simulations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.dynamics.batch import Bodies as Bodies
    from certreg.dynamics.batch import bodies_of as bodies_of
    from certreg.dynamics.batch import simulate_many as simulate_many
    from certreg.dynamics.body import Body as Body
    from certreg.dynamics.body import body_of as body_of
    from certreg.dynamics.body import start_at_rest as start_at_rest
    from certreg.dynamics.body import state_at_rest as state_at_rest
    from certreg.dynamics.breaking import SHRINKING as SHRINKING
    from certreg.dynamics.breaking import BreakingRun as BreakingRun
    from certreg.dynamics.breaking import BreakingStage as BreakingStage
    from certreg.dynamics.breaking import BreakingStatus as BreakingStatus
    from certreg.dynamics.breaking import run_breaking as run_breaking
    from certreg.dynamics.breathing import BreathingBody as BreathingBody
    from certreg.dynamics.breathing import BreathingStatus as BreathingStatus
    from certreg.dynamics.breathing import BreathingTrajectory as BreathingTrajectory
    from certreg.dynamics.breathing import breathing_body as breathing_body
    from certreg.dynamics.breathing import never_collapses as never_collapses
    from certreg.dynamics.breathing import simulate_breathing as simulate_breathing
    from certreg.dynamics.integrators import DEFAULT_SETTINGS as DEFAULT_SETTINGS
    from certreg.dynamics.integrators import EULER_STEP as EULER_STEP
    from certreg.dynamics.integrators import SimulationSettings as SimulationSettings
    from certreg.dynamics.simulation import optimal_damping as optimal_damping
    from certreg.dynamics.simulation import simulate as simulate
    from certreg.dynamics.spring_batch import SpringBodies as SpringBodies
    from certreg.dynamics.spring_batch import SpringEnds as SpringEnds
    from certreg.dynamics.spring_batch import bodies_on_springs as bodies_on_springs
    from certreg.dynamics.spring_body import MovingSprings as MovingSprings
    from certreg.dynamics.spring_body import moving_springs as moving_springs
    from certreg.dynamics.spring_simulation import SpringStatus as SpringStatus
    from certreg.dynamics.spring_simulation import SpringTrajectory as SpringTrajectory
    from certreg.dynamics.spring_simulation import simulate_springs as simulate_springs
    from certreg.dynamics.trajectories import Record as Record
    from certreg.dynamics.trajectory import SimulationStatus as SimulationStatus
    from certreg.dynamics.trajectory import Trajectory as Trajectory

__getattr__ = lazy_face(
    __name__,
    {
        "batch": (
            "Bodies",
            "bodies_of",
            "simulate_many",
        ),
        "body": (
            "Body",
            "body_of",
            "start_at_rest",
            "state_at_rest",
        ),
        "breaking": (
            "BreakingRun",
            "BreakingStage",
            "BreakingStatus",
            "SHRINKING",
            "run_breaking",
        ),
        "breathing": (
            "BreathingBody",
            "BreathingStatus",
            "BreathingTrajectory",
            "breathing_body",
            "never_collapses",
            "simulate_breathing",
        ),
        "integrators": (
            "DEFAULT_SETTINGS",
            "EULER_STEP",
            "SimulationSettings",
        ),
        "simulation": (
            "optimal_damping",
            "simulate",
        ),
        "spring_batch": (
            "SpringBodies",
            "SpringEnds",
            "bodies_on_springs",
        ),
        "spring_body": (
            "MovingSprings",
            "moving_springs",
        ),
        "spring_simulation": (
            "SpringStatus",
            "SpringTrajectory",
            "simulate_springs",
        ),
        "trajectories": ("Record",),
        "trajectory": (
            "SimulationStatus",
            "Trajectory",
        ),
    },
)
