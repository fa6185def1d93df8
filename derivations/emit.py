"""The last link of the chain: the derived expressions handed to the code generator.

`python -m derivations.emit` writes certreg/native/generated/. The functions are the objects
that the claims are about: `motion` (rate, energies), `linearisation`, `integrators`. Beside it
certreg/relaxation/generated/: what CVXPY makes of the semidefinite programs.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from certreg.io.atomic import write_files
from certreg.native.codegen.emit import BREATHING, GENERAL, generated_files
from certreg.native.codegen.records import RecordLayout, record_of
from certreg.native.codegen.translate import Definition, Port, port
from certreg.relaxation.cones import GENERATED as CONES_FOLDER

from . import breathing_emit, spring_emit
from .cones import cone_files
from .emitting import NamedValues
from .integrators import (
    DECAY,
    IMPULSE,
    STEP,
    QuaternionState,
    euler_step,
    midpoint_residual,
    midpoint_step,
    splitting_step,
    squared_speed,
)
from .linearisation import ambient_jacobian, hessian, intrinsic_jacobian
from .motion import Body, State, flat, kinetic, potential, rate, spring_torque, unit_cloud
from .notation import inner, jacobian, rotation, square, vector

SPLITTING_STEP = {"h": STEP, "decay": DECAY, "impulse": IMPULSE}
GENERATED = Path(__file__).resolve().parent.parent / "certreg" / "native" / "generated"


def records() -> tuple[RecordLayout, ...]:
    """The layout of what the functions take and give, and of what handwritten C does."""
    matrix_state = record_of("matrix_state", State().parts)
    quaternion_state = record_of("quaternion_state", QuaternionState().parts)
    energies = record_of("energies", _energies(State(), Body()))
    return (
        matrix_state,
        quaternion_state,
        record_of("body", Body().parts),
        energies,
        record_of("step", {"h": STEP}),
        record_of("splitting_step", SPLITTING_STEP),
        _sample("matrix_sample", matrix_state, energies),
        _sample("quaternion_sample", quaternion_state, energies),
        *_HANDWRITTEN,
    )


def _sample(name: str, state: RecordLayout, energies: RecordLayout) -> RecordLayout:
    """A row of a logged trajectory."""
    return RecordLayout(name=name, parts={"time": (), "state": state, "energies": energies})


# Of the C that is written by hand, in the order of its sums over points: w each, times the parts.
_SUMS = {"source": (3,), "target": (3,)}
_HANDWRITTEN = (
    RecordLayout(name="basin", parts={"quaternions": (4, 4), "gaps": (4,)}),
    RecordLayout(name="means", parts=_SUMS),
    RecordLayout(name="spreads", parts={"source": (), "target": (), "centred_target": ()}),
    RecordLayout(
        name="sums", parts={"mass": (), "spread": (), **_SUMS, "scatter": (6,), "cross": (3, 3)}
    ),
    RecordLayout(
        name="exact_sums",
        parts={
            "mass": (),
            **_SUMS,
            "cross": (3, 3),
            "source_scatter": (6,),
            "target_scatter": (6,),
        },
    ),
)


def definitions() -> tuple[Definition, ...]:
    """All functions of the generated code, in the order in which they are written."""
    return (*_of_matrix_states(), *_of_quaternion_states())


def _of_matrix_states() -> tuple[Definition, ...]:
    state, body = State(), Body()
    given = (port("state", state.flat), port("body", body.flat))
    rates = rate(state, body)
    step = port("step", [STEP])
    euler = NamedValues()
    return (
        Definition(
            name="certreg_rate",
            says="The equations of motion s' = F(s).",
            arguments=given,
            results=(port("rate", rates),),
        ),
        Definition(
            name="certreg_energies",
            says="Kinetic energy of translation and of rotation, potential energy, alignment.",
            arguments=given,
            results=(port("energies", flat(_energies(state, body))),),
        ),
        Definition(
            name="certreg_curvature",
            says="Hessian of the potential energy along R exp([phi]x), row by row; spring torque.",
            arguments=given,
            results=_curvature(state, body),
        ),
        Definition(
            name="certreg_ambient_jacobian",
            says="dF/ds, 18 x 18 row by row.",
            arguments=given,
            results=(port("jacobian", ambient_jacobian(state, body)),),
        ),
        Definition(
            name="certreg_intrinsic_jacobian",
            says="The linearised dynamics in (c, phi, v, omega), 12 x 12 row by row.",
            arguments=given,
            results=(port("jacobian", intrinsic_jacobian(state, body)),),
        ),
        Definition(
            name="certreg_euler_step",
            says="Explicit Euler, R projected to the nearest rotation; |F(s)|^2 before the step.",
            arguments=(*given, step),
            results=(
                port("next", euler_step(state, body, naming=euler)),
                port("squared_speed", [square(rates)]),
            ),
            named=euler.values,
        ),
    )


def _of_quaternion_states() -> tuple[Definition, ...]:
    state, body = QuaternionState(), Body()
    as_matrix = State(c=state.c, R=rotation(state.q), v=state.v, omega=state.omega)
    given = (port("state", state.flat), port("body", body.flat))
    middle = vector("middle")
    residual = midpoint_residual(state, body, middle)
    return (
        Definition(
            name="certreg_quaternion_energies",
            says="Kinetic energy of translation and of rotation, potential energy, alignment.",
            arguments=given,
            results=(port("energies", flat(_energies(as_matrix, body))),),
        ),
        Definition(
            name="certreg_quaternion_curvature",
            says="Hessian of the potential energy along q exp(phi / 2), row by row; spring torque.",
            arguments=given,
            results=_curvature(as_matrix, body),
        ),
        Definition(
            name="certreg_quaternion_squared_speed",
            says="|F(s)|^2 of the 18 rates of change, for |q| = 1.",
            arguments=given,
            results=(port("squared_speed", [squared_speed(state, body)]),),
        ),
        Definition(
            name="certreg_splitting_step",
            says="A kick with exact damping, then a drift; |F(s)|^2 before the step.",
            arguments=(*given, port("step", flat(SPLITTING_STEP))),
            results=(
                port("next", splitting_step(state, body)),
                port("squared_speed", [squared_speed(state, body)]),
            ),
        ),
        Definition(
            name="certreg_midpoint_residual",
            says="The midpoint rule's equations for the middle angular velocity; their Jacobian.",
            arguments=(*given, port("middle", middle), port("step", [STEP])),
            results=(
                port("residual", residual),
                port("jacobian", jacobian(residual, middle)),
            ),
        ),
        Definition(
            name="certreg_midpoint_step",
            says="The state after a step of the midpoint rule, given the middle angular velocity.",
            arguments=(*given, port("middle", middle), port("step", [STEP])),
            results=(port("next", midpoint_step(state, middle)),),
        ),
    )


def _energies(state: State, body: Body) -> dict[str, Any]:
    translation, rotation = kinetic(state, body)
    return {
        "translation": translation,
        "rotation": rotation,
        "potential": potential(state, body),
        "alignment": inner(state.R, body.cross),
    }


def _curvature(state: State, body: Body) -> tuple[Port, ...]:
    torque = spring_torque(state, unit_cloud(body))
    return port("hessian", hessian(state, body)), port("torque", torque)


EDITIONS: dict[str, Callable[[], dict[str, bytes]]] = {  # of which body on which springs
    "rigid": lambda: generated_files(definitions(), records()),
    "breathing": lambda: generated_files(
        breathing_emit.definitions(), breathing_emit.records(), BREATHING
    ),
    "springs": lambda: generated_files(spring_emit.definitions(), spring_emit.records(), GENERAL),
}


if __name__ == "__main__":
    for files_of in EDITIONS.values():
        write_files(GENERATED, files_of())
    write_files(CONES_FOLDER, cone_files())
