"""Claim: the spring torque is the axial vector of R^T C - C^T R, and 2 L(q)^T K q at R(q)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from certreg.geometry.so3 import davenport_matrix

from ..algebra import identity
from ..integrators import quaternion_torque
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..motion import Body, State, left_gradient, spring_torque
from ..notation import Array, Matrix, body, hat, inner, quaternion, rotation, vee


def proof(
    torque: Callable[[State, MomentCloud], Array] = spring_torque,
    shipped: Callable[[Any, Body], Array] = quaternion_torque,
    davenport: Callable[[Any], Any] = davenport_matrix,
) -> Proof:
    """From the sum over the springs to the quaternion form that is integrated."""
    state, cloud = State(), MomentCloud()
    C, R = cloud.cross, state.R
    yield identity(
        r"The total torque of the springs, a sum over $N$ points, depends on the cloud through "
        r"$C$ alone. In the paper's form, which has $\tilde x_i$ for $R^{\mathsf T} R \tilde x_i$, "
        r"it is $\sum_i 2 m_i\, \tilde x_i \times \bigl(R^{\mathsf T}(\tilde y_i - c) - "
        r"\tilde x_i\bigr) = 2 \operatorname{vee}(R^{\mathsf T} C - C^{\mathsf T} R)$, an identity "
        r"for every $3\times3$ matrix $R$. The offset $c$ drops out because $\sum_i m_i \tilde x_i "
        r"= 0$, and $\tilde x_i \times \tilde x_i = 0$. On rotations the two forms are the same; "
        r"what the forces add elsewhere is in claim `total_torque`.",
        torque(state, cloud),
        2 * vee(R.T * C - C.T * R),
    )
    yield identity(
        r"The matrix inside is skew-symmetric, so $\operatorname{vee}$ loses nothing: "
        r"$[\operatorname{vee}(R^{\mathsf T} C - C^{\mathsf T} R)]_\times = "
        r"R^{\mathsf T} C - C^{\mathsf T} R$.",
        hat(vee(R.T * C - C.T * R)),
        R.T * C - C.T * R,
    )
    yield identity(
        r"It is a slope: the derivative of $2 \operatorname{tr}(R^{\mathsf T} C)$ along "
        r"$R \exp([\varphi]_\times)$ at $\varphi = 0$ is the same vector, so the springs turn the "
        r"body up the alignment, that is down the potential energy.",
        left_gradient(2 * inner(R, C), R),
        2 * vee(R.T * C - C.T * R),
    )
    yield from _in_quaternions(C, quaternion(), shipped, davenport)


def _in_quaternions(
    C: Array,
    q: Array,
    shipped: Callable[[Any, Body], Array],
    davenport: Callable[[Any], Any],
) -> Proof:
    K = Matrix(davenport(C.tolist()))
    turned = rotation(q)
    yield identity(
        r"At $R = R(q)$, with both sides multiplied by $|q|^2$, the axial vector is "
        r"$2\operatorname{vee}(R^{\mathsf T} C - C^{\mathsf T} R) = 2 L(q)^{\mathsf T} K(C)\, q$: "
        r"both are polynomials of degree two in $q$ and one in $C$.",
        2 * vee(turned.T * C - C.T * turned),
        2 * body(q).T * K * q,
    )
    yield identity(
        r"The expression from which the code of the quaternion integrators is generated is that "
        r"one.",
        shipped(q, Body(cross=C)),
        2 * body(q).T * K * q,
    )


def _sum_transposed(state: State, cloud: MomentCloud) -> Array:
    return spring_torque(State(c=state.c, R=state.R.T), cloud)


def _transposed_davenport(C: Any) -> Any:
    return davenport_matrix(Matrix(C).T.tolist())


CLAIM = Claim(
    name="torque",
    title="The torque is an eigenvector's residual",
    statement=r"The total spring torque in the body frame is $\;2 \operatorname{vee}"
    r"(R^{\mathsf T} C - C^{\mathsf T} R)\;$ for every rotation $R$ and every offset $c$ (in the "
    r"paper's form, with $x$ for $R^{\mathsf T} R x$, for every matrix $R$), and at "
    r"$R = R(q)$, $|q| = 1$, it is $\;2\, L(q)^{\mathsf T} K(C)\, q$.",
    concludes=(1, 4, 5),
    setting=(
        (
            r"Both clouds are taken about their means, $\sum_i m_i \tilde x_i = \sum_i m_i \tilde "
            r"y_i = 0$; any number of points, any masses."
        ),
    ),
    source="[Yang2020], the total torque; [Horn1987] for K",
    proof=proof,
    controls={
        "the torque with R for its transpose": Mutation(
            at=1, proof=lambda: proof(torque=_sum_transposed)
        ),
        "half of the springs' stiffness": Mutation(
            at=1, proof=lambda: proof(torque=lambda state, cloud: spring_torque(state, cloud) / 2)
        ),
        "K of the transpose of C": Mutation(
            at=4, proof=lambda: proof(davenport=_transposed_davenport)
        ),
        "the generated torque with the other sign": Mutation(
            at=5, proof=lambda: proof(shipped=lambda q, constants: -quaternion_torque(q, constants))
        ),
    },
    not_claimed=r"Anything about damping, which is a torque of its own. Nor that the first formula "
    r"is the torque of the springs' forces where $R$ is not a rotation.",
    needs=("davenport", "total_torque"),
    runs=(
        "derivations.motion.spring_torque",
        "derivations.integrators.quaternion_torque",
    ),
    coq=(
        "davenport_torque",
        "torque_reduction",
    ),
    not_in_coq="The formula for a matrix $R$ that is no rotation.",
)
