"""Claim: d'Alembert's principle, particle by particle, gives the Newton-Euler equations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import combination, contraction, identity
from ..hypotheses import BOTH_CENTRED, CENTRED, ROTATION, moments
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud, PointCloud
from ..motion import DAMPING, State, newton_euler, velocity
from ..notation import Array, Matrix, hat, inner, jacobian, vector
from .total_force import force_on_particle

Equations = Callable[[State, MomentCloud], tuple[Array, Array]]
Acceleration = Callable[[State, Any], Array]
A, ALPHA = vector("a"), vector("alpha")
XI, PHI = vector("xi"), vector("phi")


def particle_acceleration(state: State, x: Any) -> Array:
    """The acceleration a + R (alpha x x + omega x (omega x x)) of the body's point x."""
    swing = ALPHA.cross(x) + state.omega.cross(state.omega.cross(x))
    return A + state.R * swing


def displacement(state: State, x: Any) -> Array:
    """The virtual displacement xi + R (phi x x) of the body's point x."""
    return XI + state.R * PHI.cross(x)


def proof(
    acceleration: Acceleration = particle_acceleration, equations: Equations = newton_euler
) -> Proof:
    """Acceleration of a particle; virtual work by the moment functional; with N written out."""
    state, cloud = State(), MomentCloud()
    yield _derivative_of_velocity(state, cloud.x, acceleration)
    lost = _lost(state, cloud.x, cloud.y, acceleration)
    balance, turn = _balance(state, cloud, equations), state.R * hat(PHI)
    yield identity(
        r"A rigid body's virtual displacements are $\delta r = \xi + R(\varphi\times x)$. "
        r"D'Alembert's principle asks that the forces less the inertia, $f_i - m_i\ddot r_i$, do "
        r"no work on any of them; constraint forces do none and need not be known. On a "
        r"translation $\xi$ the work of all particles is $(f - Ma)\cdot\xi$, for every matrix $R$.",
        inner(cloud.total(lost), XI),
        balance.subs(dict.fromkeys(PHI, 0)),
    )
    yield combination(
        r"On $\xi + R[\varphi]x$ it is $\xi\cdot\sum(f_i - m_i\ddot r_i) + \langle R[\varphi], "
        r"\sum(f_i - m_i\ddot r_i)\,x_i^{\mathsf T}\rangle$, which is $(f - Ma)\cdot\xi + (\tau - "
        r"\omega\times J\omega - J\alpha)\cdot\varphi$ where $R$ is a rotation: the rest is "
        r"$-\langle [\varphi]S_2\,(2I + \mu[\omega] + [\omega]^2 + [\alpha])^{\mathsf T},\, "
        r"R^{\mathsf T}R - I\rangle$. Since $\xi$ and $\varphi$ are arbitrary, the principle "
        r"holds if and only if both brackets vanish: the Newton-Euler equations.",
        inner(cloud.total(lost), XI) + inner(cloud.total(lost * cloud.x.T), turn) - balance,
        contraction(_stretch(state, cloud), ROTATION),
    )
    for n in (3, 4):
        yield _written_out(n, acceleration, equations)


def _derivative_of_velocity(state: State, x: Any, acceleration: Acceleration) -> Any:
    speed = velocity(state, x)
    along = (
        jacobian(speed, state.v) * A
        + jacobian(speed, state.omega) * ALPHA
        + jacobian(speed, state.R) * Matrix(list(state.R * hat(state.omega)))
    )
    return identity(
        r"Along a motion with $\dot R = R[\omega]_\times$, $\dot\omega = \alpha$, $\dot v = a$, "
        r"the velocity $R(\omega\times x) + v$ of a particle changes at the rate $a + "
        r"R\bigl(\alpha\times x + \omega\times(\omega\times x)\bigr)$.",
        along,
        acceleration(state, x),
    )


def _lost(state: State, x: Any, y: Any, acceleration: Acceleration) -> Array:
    """Force less inertia of a particle of mass 1."""
    return force_on_particle(state, x, y) - acceleration(state, x)


def _balance(state: State, cloud: MomentCloud, equations: Equations) -> Any:
    force, torque = equations(state, cloud)
    return inner(force - cloud.mass * A, XI) + inner(torque - cloud.inertia * ALPHA, PHI)


def _swing(state: State) -> Array:
    """2 I + mu [omega] + [omega]^2 + [alpha]: what multiplies -R x in force less inertia."""
    turning = hat(state.omega)
    return 2 * sympy.eye(3) + DAMPING * turning + turning * turning + hat(ALPHA)


def _stretch(state: State, cloud: MomentCloud) -> Array:
    return -hat(PHI) * cloud.source_scatter * _swing(state).T


def _written_out(n: int, acceleration: Acceleration, equations: Equations) -> Any:
    points, state = PointCloud.of_size(n), State()
    cloud = moments(points)
    pairs = zip(points.sources, points.targets, strict=True)
    work = [inner(_lost(state, x, y, acceleration), displacement(state, x)) for x, y in pairs]
    pushed = -(2 * state.c + DAMPING * state.v + A)
    along_x = hat(PHI).T * state.R.T * pushed - (state.R * _swing(state)).T * XI
    return combination(
        rf"Once more with $N = {n}$ particles written out: the virtual work of all of them less "
        r"the brackets is a combination of the entries of $R^{\mathsf T}R - I$, $\sum m\,x$ and "
        r"$\sum m\,y$.",
        points.total(work) - _balance(state, cloud, equations),
        [
            *contraction(_stretch(state, cloud), ROTATION),
            *contraction(along_x, CENTRED[n, "x"]),
            *contraction(2 * XI, CENTRED[n, "y"]),
        ],
    )


def _without_centripetal(state: State, x: Any) -> Array:
    return A + state.R * ALPHA.cross(x)


def _without_gyroscope(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    force, torque = newton_euler(state, cloud)
    return force, torque + state.omega.cross(cloud.inertia * state.omega)


def _spring_halved(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    force, torque = newton_euler(state, cloud)
    return force + cloud.mass * state.c, torque


CLAIM = Claim(
    name="dalembert",
    title="D'Alembert's principle",
    statement=r"$\sum (f_i - m_i\ddot r_i)\cdot\delta r_i = (f - Ma)\cdot\xi + (\tau - "
    r"\omega\times J\omega - J\alpha)\cdot\varphi$ for all virtual displacements $\delta r_i = \xi "
    r"+ R(\varphi\times x_i)$ of the rigid body, whose particles have the accelerations $\ddot r = "
    r"a + R(\alpha\times x + \omega\times(\omega\times x))$. So d'Alembert's principle gives the "
    r"Newton-Euler equations of the paper.",
    concludes=(1, 2, 3, 4, 5),
    hypotheses=(ROTATION, *BOTH_CENTRED),
    source="[Yang2020], the proposition on the dynamics",
    proof=proof,
    controls={
        "no centripetal acceleration": Mutation(
            at=1, proof=lambda: proof(acceleration=_without_centripetal)
        ),
        "no gyroscopic term": Mutation(at=3, proof=lambda: proof(equations=_without_gyroscope)),
        "half of the spring's force": Mutation(at=2, proof=lambda: proof(equations=_spring_halved)),
    },
    not_claimed="That the links between particles exert forces of any particular kind: only that "
    "they do no work.",
    needs=("total_force", "total_torque", "inertia"),
    runs=("derivations.motion.newton_euler",),
    not_in_coq=(
        "In Coq the equations of motion are a definition, written point by point; no "
        "principle of mechanics leads to them there."
    ),
)
