"""Claim: the total torque on the body, and what it leaves out where R is no rotation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import combination, contraction, identity
from ..hypotheses import CENTRED, ROTATION, SOURCES_CENTRED, cofactor_matrix, moments
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud, PointCloud
from ..motion import DAMPING, State, newton_euler, spring_torque
from ..notation import Array, hat, inner, matrix, vector, vee
from .total_force import force_on_particle

Total = Callable[[State, MomentCloud], Array]


def spring_part(state: State, cloud: MomentCloud) -> Array:
    """The torque of the springs, 2 vee(R^T C - C^T R)."""
    aligned = state.R.T * cloud.cross
    return 2 * vee(aligned - aligned.T)


def drag_part(state: State, cloud: MomentCloud) -> Array:
    """The torque of the drag, -mu J omega."""
    return -DAMPING * cloud.inertia * state.omega


def proof(springs: Total = spring_part, drag: Total = drag_part) -> Proof:
    """Axial vectors; the torque in the body frame, the paper's sum, and the exact one."""
    yield from _axial()
    state, cloud = State(), MomentCloud()
    yield identity(
        r"The springs' torque in the body frame is $\sum x\times 2m\,R^{\mathsf T}(y - c)$ in the "
        r"paper. The term with $c$ is linear in $x$ and vanishes; the rest is twice the axial "
        r"vector of $\sum m\,(R^{\mathsf T}y\,x^{\mathsf T} - x\,y^{\mathsf T}R) = "
        r"R^{\mathsf T}C - C^{\mathsf T}R$, for every matrix $R$.",
        spring_torque(state, cloud),
        springs(state, cloud),
    )
    pulled = cloud.x.cross(state.omega.cross(cloud.x) + state.R.T * state.v)
    yield identity(
        r"The drag's torque is $-\mu\sum m\,x\times(\omega\times x + R^{\mathsf T}v) = "
        r"-\mu J\omega$: again the part linear in $x$ vanishes.",
        -DAMPING * cloud.total(pulled),
        drag(state, cloud),
    )
    torque = springs(state, cloud) + drag(state, cloud)
    yield from _exactly(state, cloud, torque)
    for n in (3, 4):
        yield _written_out(n, springs, drag)
    gyroscopic = state.omega.cross(cloud.inertia * state.omega)
    yield identity(
        r"Euler's equation in the body frame is $J\alpha = \tau - \omega\times J\omega$. This is "
        r"the right-hand side that the other claims, and the generated code, use.",
        newton_euler(state, cloud)[1],
        torque - gyroscopic,
    )


def _axial() -> Proof:
    a, b, A = vector("a"), vector("b"), matrix("A")
    yield identity(
        r"For vectors $a$ and $b$: $[a\times b]_\times = b\,a^{\mathsf T} - a\,b^{\mathsf T}$. A "
        r"cross product is the axial vector of a skew matrix, and $\operatorname{vee}$ reads it "
        r"off: $\operatorname{vee}([a]_\times) = a$.",
        [hat(a.cross(b)), vee(hat(a))],
        [b * a.T - a * b.T, a],
    )
    yield identity(
        r"For every matrix $A$: $Aa\times Ab = \operatorname{cof}(A)\,(a\times b)$. A rotation is "
        r"its own cofactor matrix (claim `quaternions`), so the torque in the target's frame is "
        r"$R$ times the torque in the body frame.",
        (A * a).cross(A * b),
        cofactor_matrix(A) * a.cross(b),
    )


def _exactly(state: State, cloud: MomentCloud, torque: Array) -> Proof:
    phi = vector("phi")
    exact = cloud.x.cross(state.R.T * force_on_particle(state, cloud.x, cloud.y))
    cofactors = _cofactors(phi, state, cloud)
    yield combination(
        r"The torque of the forces themselves is $\sum m\,x\times R^{\mathsf T}f$. For every "
        r"direction $\varphi$ it differs from $2\operatorname{vee}(R^{\mathsf T}C - "
        r"C^{\mathsf T}R) - \mu J\omega$ by $-\langle [\varphi]S_2(2I - \mu[\omega]),\, "
        r"R^{\mathsf T}R - I\rangle$: nothing where $R$ is a rotation, and exactly this term where "
        r"it is not. The paper puts $x$ for $R^{\mathsf T}Rx$ and so drops it.",
        inner(phi, cloud.total(exact) - torque),
        contraction(cofactors, ROTATION),
    )


def _cofactors(phi: Array, state: State, cloud: MomentCloud) -> Array:
    resisted = 2 * sympy.eye(3) + DAMPING * hat(state.omega).T
    return -hat(phi) * cloud.source_scatter * resisted


def _written_out(n: int, springs: Total, drag: Total) -> Any:
    points, state, phi = PointCloud.of_size(n), State(), vector("phi")
    cloud = moments(points)
    pairs = zip(points.sources, points.targets, strict=True)
    exact = [x.cross(state.R.T * force_on_particle(state, x, y)) for x, y in pairs]
    lever = -(hat(phi).T * state.R.T * (2 * state.c + DAMPING * state.v))
    torque = springs(state, cloud) + drag(state, cloud)
    return combination(
        rf"Once more with $N = {n}$ particles written out: the torque of all forces less $\tau$, "
        r"along any direction, is a combination of the entries of $R^{\mathsf T}R - I$ and of "
        r"$\sum m\,x$.",
        inner(phi, points.total(exact) - torque),
        [
            *contraction(_cofactors(phi, state, cloud), ROTATION),
            *contraction(lever, CENTRED[n, "x"]),
        ],
    )


def _in_space(state: State, cloud: MomentCloud) -> Array:
    aligned = cloud.cross * state.R.T
    return 2 * vee(aligned - aligned.T)


CLAIM = Claim(
    name="total_torque",
    title="Total torque",
    statement=r"The torque in the body frame is $\tau = \sum m\,x\times R^{\mathsf T}f = "
    r"2\operatorname{vee}(R^{\mathsf T}C - C^{\mathsf T}R) - \mu J\omega$ where $R$ is a rotation; "
    r"and for every matrix $R$ if $x$ stands for $R^{\mathsf T}Rx$, as in the paper.",
    concludes=(3, 4, 5, 6, 7),
    hypotheses=(ROTATION, *SOURCES_CENTRED),
    source="[Yang2020], the total torque",
    proof=proof,
    controls={
        "torque with the other sign": Mutation(
            at=3, proof=lambda: proof(lambda state, cloud: -spring_part(state, cloud))
        ),
        "springs of stiffness m": Mutation(
            at=3, proof=lambda: proof(lambda state, cloud: spring_part(state, cloud) / 2)
        ),
        "torque in the target's frame": Mutation(at=3, proof=lambda: proof(_in_space)),
        "drag with the scatter in place of the inertia": Mutation(
            at=4,
            proof=lambda: proof(
                drag=lambda state, cloud: -DAMPING * cloud.source_scatter * state.omega
            ),
        ),
    },
    not_claimed="That the paper's torque is that of the forces off $\\mathrm{SO}(3)$: it is not.",
    needs=("quaternions", "inertia", "total_force"),
    runs=(
        "derivations.motion.newton_euler",
        "derivations.motion.spring_torque",
    ),
    used_by=(
        "derivations.motion.rate",
        "certreg.dynamics.rigid.RigidBody.rate",
    ),
    coq=(
        "torque_reduction",
        "paper_torque_is_torque",
    ),
    not_in_coq=(
        "The formula for a matrix $R$ that is no rotation; there the paper's torque is "
        "taken as a definition."
    ),
)
