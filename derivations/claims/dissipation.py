"""Claim: the total energy falls at the rate at which drag dissipates it, on SO(3)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import Square, combination, contraction, facts, identity, nonnegative
from ..hypotheses import UNDRIVEN, WEIGHTS, WHERE_ROTATION, moments
from ..hypothesis import nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud, PointCloud
from ..motion import DAMPING, State, body_kinetic_energy, newton_euler, potential_energy
from ..notation import Array, Matrix, gradient, hat, inner, matrix, scalar, vector
from ..rings import rational

Equations = Callable[[State, MomentCloud], tuple[Array, Array]]
Formula = Callable[[State, MomentCloud], Any]


LIGHT = nonnegative_by("Masses are not negative.", scalar("M"))


def dissipated(state: State, cloud: MomentCloud) -> Any:
    """The power of the drag, mu (M |v|^2 + omega^T J omega)."""
    return 2 * DAMPING * body_kinetic_energy(state, cloud)


def stretching(state: State, cloud: MomentCloud) -> Any:
    """The term 2 tr(R^T R [omega] S2), which is zero where R is a rotation."""
    return 2 * (state.R.T * state.R * hat(state.omega) * cloud.source_scatter).trace()


def proof(
    equations: Equations = newton_euler,
    extra: Formula = stretching,
    loss: Formula = dissipated,
) -> Proof:
    """dV/dt for any matrix R; on SO(3); its sign; and a state off SO(3) that gains energy."""
    yield from _rate(equations, extra, loss)
    yield from _sign(loss)
    yield _off_rotations(extra, loss)


def _rate(equations: Equations, extra: Formula, loss: Formula) -> Proof:
    state, cloud = State(), MomentCloud()
    kinetic, potential = body_kinetic_energy(state, cloud), potential_energy(state, cloud)
    a, alpha = vector("a"), vector("alpha")
    moved = inner(gradient(kinetic, state.v), a) + inner(gradient(kinetic, state.omega), alpha)
    yield identity(
        r"The kinetic energy changes at the rate $\dot V_k = v\cdot Ma + \omega\cdot J\alpha$, "
        r"because $J$ is symmetric. So the equations of motion can be put in as they stand, for "
        r"$Ma$ and $J\alpha$.",
        moved,
        inner(state.v, cloud.mass * a) + inner(state.omega, cloud.inertia * alpha),
    )
    force, torque = equations(state, cloud)
    slope = gradient(potential, state.R)
    falling = inner(gradient(potential, state.c), state.v)
    turning = inner(slope, state.R * hat(state.omega))
    change = inner(state.v, force) + inner(state.omega, torque) + falling + turning
    yield identity(
        r"With $\dot c = v$ and $\dot R = R[\omega]_\times$ the springs' work cancels, and so "
        r"does that of the gyroscopic term, which is orthogonal to $\omega$. For every $3\times3$ "
        r"matrix $R$ it remains $\dot V = -\mu M|v|^2 - \mu\,\omega^{\mathsf T}J\omega + "
        r"2\operatorname{tr}(R^{\mathsf T}R\,[\omega]S_2)$.",
        change,
        extra(state, cloud) - loss(state, cloud),
    )
    yield combination(
        r"Where $R$ is a rotation the last term vanishes. It is $-2\langle S_2[\omega],\, "
        r"R^{\mathsf T}R - I\rangle$, because the trace of a symmetric times a skew matrix, "
        r"$\operatorname{tr}([\omega]S_2)$, is zero.",
        extra(state, cloud),
        contraction(2 * cloud.source_scatter * hat(state.omega).T, WHERE_ROTATION),
    )


def _sign(loss: Formula) -> Proof:
    B, state = matrix("B"), State()
    cloud = MomentCloud(source_scatter=B.T * B)
    damping = UNDRIVEN[0]
    yield nonnegative(
        r"On $\mathrm{SO}(3)$ energy is never gained. A scatter matrix is positive semidefinite, "
        r"so $S_2 = B^{\mathsf T}B$ with rows $b_k$, and the loss is $\mu M|v|^2 + \mu\sum_k "
        r"|\omega\times b_k|^2$: a sum of squares.",
        loss(state, cloud),
        [
            *([damping, LIGHT[0], Square(speed)] for speed in state.v),
            *(
                [damping, Square(entry)]
                for k in range(3)
                for entry in state.omega.cross(B.row(k).T)
            ),
        ],
    )
    for n in (3, 4):
        points = PointCloud.of_size(n)
        swings = [state.omega.cross(x) for x in points.sources]
        yield nonnegative(
            rf"Once more with $N = {n}$ particles written out: the loss is "
            r"$\mu\sum m\,(|v|^2 + |\omega\times x|^2)$.",
            loss(state, moments(points)),
            [
                [damping, m, Square(entry)]
                for m, swing in zip(WEIGHTS[n].parts, swings, strict=True)
                for entry in (*state.v, *swing)
            ],
        )


def _off_rotations(extra: Formula, loss: Formula) -> Any:
    """A sheared state: R with R^T R other than I, turning about the third axis."""
    zero, one, half = sympy.zeros(3, 1), sympy.Integer(1), sympy.Rational(1, 2)
    axes = [sign * axis for axis in sympy.eye(3).columnspace() for sign in (one, -one)]
    cloud = moments(PointCloud((2 * one, 2 * one, one, one, one, one), tuple(axes), tuple(axes)))
    shear = Matrix([[1, 1, 0], [0, 1, 0], [0, 0, 1]])
    state = State(c=zero, R=shear, v=zero, omega=Matrix([0, 0, 1]))
    gained, lost = extra(state, cloud), loss(state, cloud).subs(DAMPING, half)
    return facts(
        r"Off $\mathrm{SO}(3)$ it can be. Take the six points $\pm e_1, \pm e_2, \pm e_3$ with "
        r"weights $2, 2, 1, 1, 1, 1$, registered to themselves, $R = "
        r"\begin{pmatrix}1&1&0\\0&1&0\\0&0&1\end{pmatrix}$, $\omega = e_3$, $c = v = 0$, $\mu = "
        r"\tfrac12$. The extra term is $4$ and the loss $3$, so $\dot V = 1 > 0$: the paper's "
        r"$\dot V \le 0$ needs $R$ to be a rotation.",
        [rational(value) for value in (gained, lost, gained - lost)],
        [4, 3, 1],
    )


def _drag_of_the_scatter(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    force, torque = newton_euler(state, cloud)
    wrong = cloud.inertia - cloud.source_scatter
    return force, torque + DAMPING * wrong * state.omega


def _springs_of_m(state: State, cloud: MomentCloud) -> tuple[Array, Array]:
    force, torque = newton_euler(state, cloud)
    return force + cloud.mass * state.c, torque


CLAIM = Claim(
    name="dissipation",
    title="Energy is dissipated",
    statement=r"For $V = V_k + V_p$ along the equations of motion, $\dot V = -\mu M|v|^2 - "
    r"\mu\,\omega^{\mathsf T}J\omega + 2\operatorname{tr}(R^{\mathsf T}R\,[\omega]S_2)$ for every "
    r"matrix $R$; where $R$ is a rotation the last term vanishes and $\dot V \le 0$.",
    concludes=(2, 3, 4, 5, 6),
    hypotheses=(WHERE_ROTATION, UNDRIVEN, LIGHT, *WEIGHTS.values()),
    source="[Yang2020], the derivative of the total energy",
    proof=proof,
    controls={
        "springs of stiffness m in the force alone": Mutation(
            at=2, proof=lambda: proof(_springs_of_m)
        ),
        "drag with the scatter in place of the inertia": Mutation(
            at=2, proof=lambda: proof(_drag_of_the_scatter)
        ),
        "no extra term off SO(3)": Mutation(
            at=2, proof=lambda: proof(extra=lambda *_: sympy.Integer(0))
        ),
        "drag that drives": Mutation(
            at=2, proof=lambda: proof(loss=lambda state, cloud: -dissipated(state, cloud))
        ),
    },
    not_claimed="Anything about a discretised flow: explicit Euler can raise the energy (claim "
    "`euler_energy`). Off $\\mathrm{SO}(3)$, $V_k$ is the rigid body's form.",
    needs=(
        "euler_poincare",
        "total_force",
        "total_torque",
        "inertia",
        "kinetic_energy",
        "potential_energy",
    ),
    runs=("derivations.motion.newton_euler",),
    used_by=(
        "certreg.dynamics.body.Basin",
        "derivations.motion.rate",
    ),
    coq=(
        "dissipation_reduction",
        "rotations_stay_rotations",
        "dissipation_identity",
        "energy_never_rises",
    ),
    not_in_coq=(
        r"That solutions exist: the theorems hold along any solution, on any open interval "
        r"of time. The additional term off $\mathrm{SO}(3)$."
    ),
)
