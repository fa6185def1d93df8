"""What is generated for the breathing body: the functions, and the layout of their records.

The functions are the objects that the claims are about: `breathing_motion`,
`breathing_integrators`. `derivations.emit` writes them.
"""

from __future__ import annotations

from typing import Any

from certreg.native.codegen.records import RecordLayout, record_of
from certreg.native.codegen.translate import Definition, port

from .breathing_integrators import (
    BreathingMiddle,
    BreathingQuaternionState,
    midpoint_residual,
    midpoint_step,
    squared_speed,
)
from .breathing_motion import BreathingState, aligning_torque, hessian, kinetic, linearised
from .breathing_motion import potential as potential_of
from .breathing_motion import rate as rate_of
from .integrators import STEP
from .motion import Body, flat
from .notation import inner, jacobian, rotation

STATE, BODY = BreathingQuaternionState(), Body()
AS_MATRIX = BreathingState(
    c=STATE.c,
    R=rotation(STATE.q),
    scale=STATE.scale,
    v=STATE.v,
    omega=STATE.omega,
    growth=STATE.growth,
)
GIVEN = (port("state", flat(STATE.parts)), port("body", BODY.flat))


def records() -> tuple[RecordLayout, ...]:
    """The layout of what the functions take and give, beside that of the rigid body."""
    state = record_of("breathing_state", STATE.parts)
    energies = record_of("breathing_energies", _energies())
    sample = {"time": (), "state": state, "energies": energies}
    return state, energies, RecordLayout(name="breathing_sample", parts=sample)


def definitions() -> tuple[Definition, ...]:
    """All functions, in the order in which they are written."""
    return (*_of_states(), *_steps())


def _of_states() -> tuple[Definition, ...]:
    matrix_state = BreathingState()
    return (
        Definition(
            name="certreg_breathing_rate",
            says="The equations of motion s' = F(s), of states with a matrix.",
            arguments=(port("state", flat(matrix_state.parts)), GIVEN[1]),
            results=(port("rate", rate_of(matrix_state, BODY)),),
        ),
        Definition(
            name="certreg_breathing_energies",
            says="Kinetic energy of translation, of rotation, of the scale, potential energy, "
            "alignment.",
            arguments=GIVEN,
            results=(port("energies", flat(_energies())),),
        ),
        Definition(
            name="certreg_breathing_curvature",
            says="Hessian of the potential energy along q exp(phi / 2), s, 4 x 4 row by row; the "
            "torque of the springs at scale 1.",
            arguments=GIVEN,
            results=(
                port("hessian", hessian(AS_MATRIX, BODY)),
                port("torque", aligning_torque(AS_MATRIX.R, BODY)),
            ),
        ),
        Definition(
            name="certreg_breathing_jacobian",
            says="The linearised dynamics in (c, phi, s, v, omega, s'), 14 x 14 row by row.",
            arguments=GIVEN,
            results=(port("jacobian", linearised(AS_MATRIX, BODY)),),
        ),
    )


def _steps() -> tuple[Definition, ...]:
    middle = BreathingMiddle()
    residual = midpoint_residual(STATE, BODY, middle)
    arguments = (*GIVEN, port("middle", middle.flat), port("step", [STEP]))
    return (
        Definition(
            name="certreg_breathing_squared_speed",
            says="|F(s)|^2 of the 20 rates of change, for |q| = 1.",
            arguments=GIVEN,
            results=(port("squared_speed", [squared_speed(STATE, BODY)]),),
        ),
        Definition(
            name="certreg_breathing_midpoint_residual",
            says="The midpoint rule's equations for the middle rates; their Jacobian, 4 x 4.",
            arguments=arguments,
            results=(
                port("residual", residual),
                port("jacobian", jacobian(residual, middle.flat)),
            ),
        ),
        Definition(
            name="certreg_breathing_midpoint_step",
            says="The state after a step of the midpoint rule, given the middle rates.",
            arguments=arguments,
            results=(port("next", midpoint_step(STATE, middle)),),
        ),
    )


def _energies() -> dict[str, Any]:
    translation, turning, breath = kinetic(AS_MATRIX, BODY)
    return {
        "translation": translation,
        "rotation": turning,
        "scale": breath,
        "potential": potential_of(AS_MATRIX, BODY),
        "alignment": inner(AS_MATRIX.R, BODY.cross),
    }
