"""What is generated for springs that are matrices: the functions, and the layout of their records.

The functions are the objects that the claims are about: `spring_motion`, `spring_integrators`.
`derivations.emit` writes them.
"""

from __future__ import annotations

from typing import Any

from certreg.native.codegen.records import RecordLayout, record_of
from certreg.native.codegen.translate import Definition, Port, port

from .emitting import NamedValues
from .integrators import DECAY, IMPULSE, STEP, QuaternionState
from .motion import State, flat, kinetic
from .notation import rotation
from .spring_integrators import (
    middle,
    midpoint_step,
    midpoint_system,
    splitting_step,
    springs_at,
    squared_speed,
)
from .spring_motion import (
    SpringBody,
    hessian,
    linearised,
    potential,
    pull,
    rate,
    spring_force,
    torque_of,
)

STATE, BODY = QuaternionState(), SpringBody()
AS_MATRIX = State(c=STATE.c, R=rotation(STATE.q), v=STATE.v, omega=STATE.omega)
GIVEN = (port("state", STATE.flat), port("body", flat(BODY.parts)))
SPLITTING_STEP = {"h": STEP, "decay": DECAY, "impulse": IMPULSE}


def records() -> tuple[RecordLayout, ...]:
    """The layout of what the functions take and give, beside that of isotropic springs."""
    energies = record_of("spring_energies", _energies(AS_MATRIX))
    state = record_of("quaternion_state", STATE.parts)
    sample = {"time": (), "state": state, "energies": energies}
    return (
        record_of("spring_body", BODY.parts),
        energies,
        RecordLayout(name="spring_sample", parts=sample),
    )


def definitions() -> tuple[Definition, ...]:
    """All functions, in the order in which they are written."""
    return (*_of_states(), *_explicit(), *_implicit())


def _of_states() -> tuple[Definition, ...]:
    matrix_state = State()
    named = NamedValues()
    R = named("R", rotation(STATE.q))
    state = State(c=STATE.c, R=R, v=STATE.v, omega=STATE.omega)
    force, torque = _pulls(state)
    return (
        Definition(
            name="certreg_spring_rate",
            says="The equations of motion s' = F(s), of states with a matrix.",
            arguments=(port("state", matrix_state.flat), GIVEN[1]),
            results=(port("rate", rate(matrix_state, BODY)),),
        ),
        Definition(
            name="certreg_spring_energies",
            says="Kinetic energy of translation and of rotation, potential energy.",
            arguments=GIVEN,
            results=(port("energies", flat(_energies(state))),),
            named=named.values,
        ),
        Definition(
            name="certreg_spring_curvature",
            says="Hessian of the potential energy along c + d, q exp(phi / 2), 6 x 6 row by row; "
            "force and torque of the springs.",
            arguments=GIVEN,
            results=(port("hessian", hessian(state, BODY)), port("force", [*force, *torque])),
            named=named.values,
        ),
        Definition(
            name="certreg_spring_jacobian",
            says="The linearised dynamics in (c, phi, v, omega), 12 x 12 row by row.",
            arguments=GIVEN,
            results=(port("jacobian", linearised(state, BODY)),),
            named=named.values,
        ),
    )


def _explicit() -> tuple[Definition, ...]:
    at_speed, at_step = NamedValues(), NamedValues()
    alone = springs_at(STATE, BODY, at_speed)
    springs = springs_at(STATE, BODY, at_step)
    return (
        Definition(
            name="certreg_spring_squared_speed",
            says="|F(s)|^2 of the 18 rates of change, for |q| = 1.",
            arguments=GIVEN,
            results=(_speed(alone),),
            named=at_speed.values,
        ),
        Definition(
            name="certreg_spring_splitting_step",
            says="A kick with exact damping, then a drift; |F(s)|^2 before the step.",
            arguments=(*GIVEN, port("step", flat(SPLITTING_STEP))),
            results=(port("next", splitting_step(STATE, springs, BODY)), _speed(springs)),
            named=at_step.values,
        ),
    )


def _implicit() -> tuple[Definition, ...]:
    unknown, named = middle(), NamedValues()
    residual, slope = midpoint_system(STATE, BODY, unknown, named)
    arguments = (*GIVEN, port("middle", unknown.flat), port("step", [STEP]))
    return (
        Definition(
            name="certreg_spring_midpoint_residual",
            says="The midpoint rule's equations for the middle velocities; their Jacobian, 6 x 6.",
            arguments=arguments,
            results=(port("residual", residual), port("jacobian", slope)),
            named=named.values,
        ),
        Definition(
            name="certreg_spring_midpoint_step",
            says="The state after a step of the midpoint rule, given the middle velocities.",
            arguments=arguments,
            results=(port("next", midpoint_step(STATE, unknown)),),
        ),
    )


def _energies(state: State) -> dict[str, Any]:
    # the kinetic energy is that of any body with this inertia
    translation, rotation_part = kinetic(state, BODY)  # type: ignore[arg-type]
    return {
        "translation": translation,
        "rotation": rotation_part,
        "potential": potential(state, BODY),
    }


def _pulls(state: State) -> tuple[Any, Any]:
    """Force and torque of the springs."""
    torque = torque_of(pull(state.c, state.R, BODY), state.R)
    return spring_force(state.c, state.R, BODY), torque


def _speed(springs: tuple[Any, Any]) -> Port:
    return port("squared_speed", [squared_speed(STATE, springs, BODY)])
