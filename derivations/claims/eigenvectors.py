"""Claim: R(q) is an equilibrium iff q is an eigenvector of Davenport's matrix."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from certreg.geometry.so3 import davenport_matrix

from ..algebra import combination, contraction, identity, modulo
from ..hypotheses import SOLID, SPECTRAL, unit_of
from ..hypothesis import Hypothesis, Standing, invertible, vanishing
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..motion import State, newton_euler, potential_energy
from ..notation import (
    Array,
    Matrix,
    body,
    hat,
    inner,
    quaternion,
    rotation,
    scalar,
    square,
    symmetric,
    vector,
    vee,
)

Frame = Callable[[Any], Array]


HEAVY = invertible("For (b): the mass $M$ is positive.", scalar("M"), scalar("Minv"))
SOLID_INVERSE = invertible(f"For (b): {SOLID}", MomentCloud().inertia, symmetric("I"))
WHERE_UNIT = unit_of("q", Standing.CASE)


def eigenvector(davenport: Callable[[Any], Any] = davenport_matrix) -> Hypothesis:
    """K q = kappa q."""
    cloud, q = MomentCloud(), quaternion()
    K = Matrix(davenport(cloud.cross.tolist()))
    return vanishing(
        r"$q$ is an eigenvector, $K q = \kappa q$.",
        K * q - scalar("kappa") * q,
        standing=Standing.CASE,
        solves=tuple(cloud.cross),
    )


EIGENVECTOR = eigenvector()


def proof(
    frame: Frame = body, davenport: Callable[[Any], Any] = davenport_matrix, energy_factor: int = 2
) -> Proof:
    """At rest the torque is the only thing left; it vanishes exactly at eigenvectors."""
    yield from _at_rest()
    cloud, q = MomentCloud(), quaternion()
    K, L = Matrix(davenport(cloud.cross.tolist())), frame(q)
    yield identity(
        r"The columns of $L(q)$ span what is orthogonal to $q$: "
        r"$|q|^2 I = q q^{\mathsf T} + L(q) L(q)^{\mathsf T}$ and $L(q)^{\mathsf T} q = 0$.",
        [square(q) * sympy.eye(4), L.T * q],
        [q * q.T + L * L.T, sympy.zeros(3, 1)],
    )
    yield identity(
        r"So $K q$ is split into its part along $q$ and the torque: $|q|^2 K q = "
        r"(q^{\mathsf T} K q)\, q + L(q)\, \bigl(L(q)^{\mathsf T} K q\bigr)$. If the torque "
        r"$2 L(q)^{\mathsf T} K q$ vanishes, then $K q = \kappa q$ with "
        r"$\kappa = q^{\mathsf T} K q / |q|^2$: $q$ is an eigenvector.",
        square(q) * K * q,
        (q.T * K * q)[0] * q + L * (L.T * K * q),
    )
    a = vector("a")
    yield combination(
        r"Conversely, if $K q = \kappa q$, then the torque vanishes: for every vector $a$, "
        r"$a^{\mathsf T} L(q)^{\mathsf T} K q$ is a combination of the entries of $K q - \kappa "
        r"q$, because $L(q)^{\mathsf T} q = 0$.",
        (a.T * L.T * K * q)[0],
        contraction(
            L * a, EIGENVECTOR if davenport is davenport_matrix else eigenvector(davenport)
        ),
    )
    yield from _symmetry(cloud)
    yield from _energy(cloud, q, K, energy_factor)


def _at_rest() -> Proof:
    state, cloud = State(), MomentCloud()
    rest = State(c=state.c, R=state.R, v=sympy.zeros(3, 1), omega=sympy.zeros(3, 1))
    C, R = cloud.cross, state.R
    force, torque = newton_euler(rest, cloud)
    yield identity(
        r"At an equilibrium nothing moves: $\dot c = v = 0$ and $\dot R = R [\omega]_\times = 0$, "
        r"so $v = \omega = 0$. There the damping and the gyroscopic "
        r"torque are zero, the force is $-2 M c$ and the torque is that of the springs.",
        [force, torque],
        [-2 * cloud.mass * state.c, 2 * vee(R.T * C - C.T * R)],
    )
    a, alpha = vector("a"), vector("alpha")
    yield combination(
        r"With $M > 0$ the force vanishes if and only if $c = 0$: for every $a$, $a\cdot c + "
        r"\tfrac12 M^{-1} a\cdot f$ is a multiple of $M M^{-1} - 1$.",
        inner(a, state.c) + scalar("Minv") * inner(a, force) / 2,
        [(-inner(a, state.c), HEAVY[0])],
    )
    yield combination(
        r"And with $J$ invertible the body does not begin to turn, $\alpha = 0$, if and only if "
        r"the torque $J\alpha$ vanishes: for every $a$, $a\cdot\alpha - (J^{-1}a)\cdot J\alpha$ is "
        r"a combination of the entries of $J J^{-1} - I$.",
        inner(a, alpha) - inner(symmetric("I") * a, cloud.inertia * alpha),
        contraction(-alpha * a.T, SOLID_INVERSE),
    )


def _symmetry(cloud: MomentCloud) -> Proof:
    R, C = State().R, cloud.cross
    A = R.T * C
    yield identity(
        r"The same in matrices: $R^{\mathsf T} C - C^{\mathsf T} R$ is the cross-product matrix of "
        r"half the torque, so the torque vanishes if and only if $R^{\mathsf T} C$ is symmetric.",
        A - A.T,
        hat(vee(A - A.T)),
    )


def _energy(cloud: MomentCloud, q: Array, K: Array, factor: int) -> Proof:
    at_rest = State(c=sympy.zeros(3, 1), R=rotation(q))
    spread = cloud.source_scatter.trace() + cloud.target_scatter.trace()
    yield modulo(
        r"With $c = 0$ and $|q| = 1$ the potential energy is $V_p = \operatorname{tr} T_2 + "
        r"\operatorname{tr} S_2 - 2\, q^{\mathsf T} K q$, where $T_2$ is the target's scatter. So "
        r"an equilibrium of eigenvalue $\kappa$ has the energy of a constant minus $2\kappa$: the "
        r"higher the eigenvalue, the better the pose. Over the unit quaternions, a compact set, "
        r"$q^{\mathsf T} K q$ has a maximum, at an eigenvector of the largest eigenvalue: the "
        r"global optimum exists and is an equilibrium.",
        potential_energy(at_rest, cloud),
        spread - factor * (q.T * K * q)[0],
        [WHERE_UNIT],
    )


def _one_sign_wrong(q: Any) -> Array:
    L = body(q)
    L[1, 1] = -L[1, 1]
    return L


CLAIM = Claim(
    name="eigenvectors",
    title="Equilibria are eigenvectors",
    statement=r"(a) For every $C$ the springs' torque, $2 L(q)^{\mathsf T} K q$, vanishes at "
    r"$R(q)$ if and only if $q$ is an "
    r"eigenvector of $K(C)$; equivalently $R(q)^{\mathsf T} C$ is symmetric. (b) Let $M > 0$ and "
    r"$J \succ 0$. A state with rotation $R(q)$ is an equilibrium of the registration dynamics if "
    r"and only if $v = \omega = 0$, $c = 0$ and $q$ is an eigenvector of $K(C)$. Its energy is "
    r"$V_p = \text{const} - 2 \kappa$ with $\kappa$ the eigenvalue.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8),
    hypotheses=(HEAVY, SOLID_INVERSE, EIGENVECTOR, WHERE_UNIT),
    source="[Yang2020], the equilibrium equations; [Horn1987], [Davenport1968]",
    proof=proof,
    controls={
        "L with one sign wrong": Mutation(at=4, proof=lambda: proof(frame=_one_sign_wrong)),
        "K of the transpose of C": Mutation(
            at=8, proof=lambda: proof(davenport=lambda C: davenport_matrix(Matrix(C).T.tolist()))
        ),
        "the energy const - kappa, half of it": Mutation(
            at=8, proof=lambda: proof(energy_factor=1)
        ),
    },
    not_claimed=r"How many eigenvectors there are "
    r"(`classification`), or that an equilibrium is stable (`hessian`, `unstable_count`).",
    needs=("davenport", "quaternions", "torque", "equilibrium_equations"),
    standard=(SPECTRAL,),
    runs=(
        "certreg.geometry.so3.davenport_matrix",
        "certreg.geometry.so3.body_frame",
    ),
    used_by=(
        "certreg.equilibrium.equilibrium_set.equilibrium_set",
        "certreg.registration.closed_form.horn",
        "certreg.objective.isotropic.Isotropic.energy",
    ),
    coq=(
        "balanced_iff_eigenvector",
        "equilibrium_iff_eigenvector",
        "optimal_iff_top_eigenvector",
        "spectral_theorem",
    ),
    not_in_coq="The formula of the energy as a theorem of its own: it is `potential_reduction` "
    "with `davenport_form`. The spectral theorem is proved there, too.",
)
