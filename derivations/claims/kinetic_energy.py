"""Claim: the kinetic energy of the particles is that of a rigid body, where R is a rotation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..algebra import combination, contraction, identity
from ..hypotheses import CENTRED, ROTATION, SOURCES_CENTRED, moments
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud, PointCloud
from ..motion import (
    Body,
    State,
    body_kinetic_energy,
    kinetic,
    unit_cloud,
    velocity,
)
from ..notation import Array, hat, inner, square

Velocity = Callable[[State, Any], Array]
Energy = Callable[[State, MomentCloud], Any]


def proof(speed: Velocity = velocity, rigid: Energy = body_kinetic_energy) -> Proof:
    """The sum over the particles, for any R, and what it is on SO(3)."""
    state, cloud, body = State(), MomentCloud(), Body()
    turning = hat(state.omega)
    swing = turning * cloud.source_scatter * turning.T
    energy = cloud.total(square(speed(state, cloud.x))) / 2
    yield identity(
        r"A particle at $R x + c$ has the velocity $R\,(\omega\times x) + v$. In the sum $V_k = "
        r"\tfrac12\sum m\,|R(\omega\times x) + v|^2$ the mixed terms are linear in $x$ and vanish, "
        r"because $x$ is taken about the centre of mass. For every matrix $R$ it remains $V_k = "
        r"\tfrac12 M|v|^2 + \tfrac12\operatorname{tr}(R^{\mathsf T}R\,[\omega]S_2[\omega]^{\mathsf "
        r"T})$.",
        energy,
        (cloud.mass * square(state.v) + inner(state.R.T * state.R, swing)) / 2,
    )
    yield combination(
        r"Where $R$ is a rotation, $R^{\mathsf T}R = I$ and the second term is "
        r"$\tfrac12\,\omega^{\mathsf T}J\omega$: the difference is "
        r"$\tfrac12\langle [\omega]S_2[\omega]^{\mathsf T},\, R^{\mathsf T}R - I\rangle$. So "
        r"$V_k = \tfrac12 M|v|^2 + \tfrac12\,\omega^{\mathsf T}J\omega$.",
        energy - rigid(state, cloud),
        contraction(swing / 2, ROTATION),
    )
    for n in (3, 4):
        yield _written_out(n, speed, rigid)
    yield identity(
        r"The generated code divides by the mass and keeps the two parts apart: "
        r"$\tfrac12|v|^2$ and $\tfrac12\,\omega^{\mathsf T}(J/M)\,\omega$. For a cloud of mass 1 "
        r"with the body's moments, their sum is this energy.",
        sum(kinetic(state, body)),
        rigid(state, unit_cloud(body)),
    )


def _written_out(n: int, speed: Velocity, rigid: Energy) -> Any:
    points, state = PointCloud.of_size(n), State()
    energy = points.total([square(speed(state, x)) for x in points.sources]) / 2
    cloud, turning = moments(points), hat(state.omega)
    swing = turning * cloud.source_scatter * turning.T
    mixed = turning.T * state.R.T * state.v
    return combination(
        rf"Once more with $N = {n}$ particles written out: what is left is a combination of the "
        r"entries of $R^{\mathsf T}R - I$ and of $\sum m\,x$, which vanish.",
        energy - rigid(state, cloud),
        [
            *contraction(swing / 2, ROTATION),
            *contraction(mixed, CENTRED[n, "x"]),
        ],
    )


def _with_scatter(state: State, cloud: MomentCloud) -> Any:
    swing = (state.omega.T * cloud.source_scatter * state.omega)[0]
    return (cloud.mass * square(state.v) + swing) / 2


CLAIM = Claim(
    name="kinetic_energy",
    title="Kinetic energy",
    statement=r"$V_k = \tfrac12\sum m\,|R(\omega\times x) + v|^2 = \tfrac12 M|v|^2 + "
    r"\tfrac12\,\omega^{\mathsf T}J\omega$ where $R$ is a rotation.",
    concludes=(1, 2, 3, 4),
    hypotheses=(ROTATION, *SOURCES_CENTRED),
    source="[Yang2020], the kinetic energy in the proof of convergence to equilibria",
    proof=proof,
    controls={
        "omega in the space frame": Mutation(
            at=1,
            proof=lambda: proof(speed=lambda state, x: state.omega.cross(state.R * x) + state.v),
        ),
        "the scatter in place of the inertia": Mutation(
            at=2, proof=lambda: proof(rigid=_with_scatter)
        ),
        "without the factor one half": Mutation(
            at=2,
            proof=lambda: proof(rigid=lambda state, cloud: 2 * body_kinetic_energy(state, cloud)),
        ),
    },
    not_claimed=r"The second form where $R$ is no rotation: there the energy of the particles is "
    r"$\tfrac12\operatorname{tr}(R^{\mathsf T}R\,[\omega]S_2[\omega]^{\mathsf T})$ instead.",
    needs=("inertia",),
    runs=("derivations.motion.kinetic",),
    used_by=("certreg.dynamics.body.AnyBody.energies",),
    coq=("kinetic_reduction",),
    not_in_coq="Nothing: the whole claim is proved there.",
)
