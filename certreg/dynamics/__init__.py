"""The damped body under springs: equations of motion, integrators, simulations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.dynamics.basin import Basin as Basin
    from certreg.dynamics.batch import Bodies as Bodies
    from certreg.dynamics.batch import bodies_of as bodies_of
    from certreg.dynamics.batch import bodies_on_springs as bodies_on_springs
    from certreg.dynamics.batch import simulate_many as simulate_many
    from certreg.dynamics.body import AnyBody as AnyBody
    from certreg.dynamics.breaking import SHRINKING as SHRINKING
    from certreg.dynamics.breaking import BreakingRun as BreakingRun
    from certreg.dynamics.breaking import BreakingStage as BreakingStage
    from certreg.dynamics.breaking import BreakingStatus as BreakingStatus
    from certreg.dynamics.breaking import run_breaking as run_breaking
    from certreg.dynamics.breathing import BreathingBody as BreathingBody
    from certreg.dynamics.integrators import DEFAULT_SETTINGS as DEFAULT_SETTINGS
    from certreg.dynamics.integrators import EULER_STEP as EULER_STEP
    from certreg.dynamics.integrators import SimulationSettings as SimulationSettings
    from certreg.dynamics.rigid import RigidBody as RigidBody
    from certreg.dynamics.rigid import rigid_body as rigid_body
    from certreg.dynamics.simulation import optimal_damping as optimal_damping
    from certreg.dynamics.simulation import simulate as simulate
    from certreg.dynamics.springs import SprungBody as SprungBody
    from certreg.dynamics.springs import spring_body as spring_body
    from certreg.dynamics.states import start_at_rest as start_at_rest
    from certreg.dynamics.states import state_at_rest as state_at_rest
    from certreg.dynamics.status import SimulationStatus as SimulationStatus
    from certreg.dynamics.trajectories import Record as Record
    from certreg.dynamics.trajectory import Trajectory as Trajectory

__getattr__ = lazy_face(
    __name__,
    {
        "basin": ("Basin",),
        "batch": (
            "Bodies",
            "bodies_of",
            "bodies_on_springs",
            "simulate_many",
        ),
        "body": ("AnyBody",),
        "breaking": (
            "BreakingRun",
            "BreakingStage",
            "BreakingStatus",
            "SHRINKING",
            "run_breaking",
        ),
        "breathing": ("BreathingBody",),
        "integrators": (
            "DEFAULT_SETTINGS",
            "EULER_STEP",
            "SimulationSettings",
        ),
        "rigid": (
            "RigidBody",
            "rigid_body",
        ),
        "simulation": (
            "optimal_damping",
            "simulate",
        ),
        "springs": (
            "SprungBody",
            "spring_body",
        ),
        "states": (
            "start_at_rest",
            "state_at_rest",
        ),
        "status": ("SimulationStatus",),
        "trajectories": ("Record",),
        "trajectory": ("Trajectory",),
    },
)
