"""Claim: equilibria of different energy are rotations exactly 180 degrees apart."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import combination, contraction, identity
from ..hypotheses import AT_P, AT_Q, DIFFERENT, eigenpair
from ..kernel import Claim, Mutation, Proof
from ..notation import (
    Array,
    body,
    inner,
    matrix,
    quaternion,
    rotation,
    scalar,
    square,
    vector,
)

Rotation = Callable[[Any], Array]


def proof(turn: Rotation = rotation, slope: int = 4, *, skewed: bool = False) -> Proof:
    """The trace of R(p)^T R(q), its axis, and why eigenvectors are orthogonal."""
    p, q = quaternion("p"), quaternion("q")
    along, across = inner(p, q), body(p).T * q
    yield identity(
        r"$\operatorname{tr}\bigl(\hat R(p)^{\mathsf T} \hat R(q)\bigr) = 4 (p \cdot q)^2 - |p|^2 "
        r"|q|^2$ (claim `quaternions`: $\hat R(q) = |q|^2 R(q)$). The trace of a rotation by the "
        r"angle $\theta$ is $1 + 2\cos\theta$, so for unit quaternions $\cos\theta = 2 (p\cdot "
        r"q)^2 - 1$, that is $|p \cdot q| = \cos(\theta/2)$. In particular $\theta = 180^\circ$ if "
        r"and only if $p \cdot q = 0$.",
        inner(turn(p), turn(q)),
        slope * along**2 - square(p) * square(q),
    )
    yield identity(
        r"The rotation from $R(p)$ to $R(q)$ is that of one quaternion, with real part $p\cdot q$ "
        r"and vector part $a = L(p)^{\mathsf T} q$: "
        r"$\hat R(p)^{\mathsf T} \hat R(q) = \hat R\bigl(p \cdot q,\; L(p)^{\mathsf T} q\bigr)$.",
        turn(p).T * turn(q),
        turn([along, *across]),
    )
    yield identity(
        r"The two parts share the length: "
        r"$(p\cdot q)^2 + |L(p)^{\mathsf T} q|^2 = |p|^2 |q|^2$. So for unit quaternions "
        r"$\theta = 0$ if and only if $L(p)^{\mathsf T} q = 0$; then $q = (p \cdot q)\, p = \pm p$ "
        r"by $|p|^2 q = (p \cdot q)\, p + L(p) L(p)^{\mathsf T} q$. Different lines through "
        r"the origin are different rotations.",
        [along**2 + square(across), *(square(p) * q)],
        [square(p) * square(q), *(along * p + body(p) * across)],
    )
    yield from _axes(turn)
    yield from _orthogonality(skewed=skewed)


def _axes(turn: Rotation) -> Proof:
    a = vector("a")
    yield identity(
        r"With $p \cdot q = 0$ it is that of $\hat R(0, a) = 2\, a a^{\mathsf T} - |a|^2 I$, which "
        r"for $|a| = 1$ keeps $a$ and reverses everything orthogonal to it: the half turn about "
        r"$a$, and no other rotation.",
        turn([0, *a]),
        2 * a * a.T - square(a) * sympy.eye(3),
    )
    p, q, r = quaternion("p"), quaternion("q"), quaternion("r")
    yield identity(
        r"Seen from $p$, products of axes are products of quaternions: "
        r"$L(p)^{\mathsf T} q \cdot L(p)^{\mathsf T} r = |p|^2\, q \cdot r - "
        r"(p \cdot q)(p \cdot r)$. So if $p, q, r$ are orthogonal, the two half turns that take "
        r"$R(p)$ to $R(q)$ and to $R(r)$ have orthogonal axes.",
        inner(body(p).T * q, body(p).T * r),
        square(p) * inner(q, r) - inner(p, q) * inner(p, r),
    )


def _orthogonality(*, skewed: bool) -> Proof:
    p, q, inverse = quaternion("p"), quaternion("q"), scalar("gap_inverse")
    K = matrix("K", 4)
    at_q = eigenpair(K, "q", "v") if skewed else AT_Q
    at_p = eigenpair(K, "p", "u") if skewed else AT_P
    yield combination(
        r"Let $K p = u p$ and $K q = v q$ with $K$ symmetric. Then $(u - v)\, p \cdot q = "
        r"q^{\mathsf T}(K p - u p) - p^{\mathsf T}(K q - v q)$ up to sign; with $u \ne v$ it can "
        r"be divided by, and $p \cdot q$ vanishes: eigenvectors of different eigenvalues are "
        r"orthogonal, and so equilibria of different energy are exactly $180^\circ$ apart, with "
        r"nothing left to the shape of the clouds. (Where an eigenvalue is repeated, all "
        r"combinations of its eigenvectors are eigenvectors, infinitely many lines. So if there "
        r"are four equilibria, the eigenvalues are distinct, and this holds of any two.)",
        inner(p, q),
        [
            *contraction(inverse * p, at_q),
            *contraction(-inverse * q, at_p),
            (-inner(p, q), DIFFERENT[0]),
        ],
    )


def _of_the_conjugate(q: Any) -> Array:
    return rotation(q).T


CLAIM = Claim(
    name="half_turns",
    title="Half turns between equilibria",
    statement=r"For unit quaternions $R(p)^{\mathsf T} R(q)$ is a rotation by $180^\circ$ if and "
    r"only if $p \cdot q = 0$, then about the axis $L(p)^{\mathsf T} q$; and $R(p) = R(q)$ if and "
    r"only if $q = \pm p$. Hence two equilibria with different energies are exactly "
    r"$180^\circ$ apart, and where there are four, the three half turns that lead from one of them "
    r"to the others have mutually orthogonal axes.",
    concludes=(1, 2, 3, 4, 5, 6),
    hypotheses=(AT_Q, AT_P, DIFFERENT),
    setting=(r"$K$ is real and symmetric.",),
    source="[Yang2020], the conjecture's part (i), there observed numerically",
    proof=proof,
    controls={
        "the trace with 2 (p.q)^2": Mutation(at=1, proof=lambda: proof(slope=2)),
        "R(q) of the conjugate quaternion": Mutation(
            at=2, proof=lambda: proof(turn=_of_the_conjugate)
        ),
        "a matrix K that is not symmetric": Mutation(at=6, proof=lambda: proof(skewed=True)),
    },
    not_claimed=r"That every two equilibria are $180^\circ$ apart: on a circle of equilibria, all "
    r"of the same energy, every angle occurs.",
    needs=("quaternions", "eigenvectors"),
    runs=(
        "certreg.geometry.so3.rotation_matrix",
        "certreg.geometry.so3.body_frame",
    ),
    used_by=(
        "certreg.geometry.so3.angle_between",
        "certreg.objective.isotropic.Isotropic.angle_to",
    ),
    coq=(
        "half_turn_apart_iff_orthogonal",
        "same_rotation_same_quaternion_up_to_sign",
        "exactly_four_equilibria",
    ),
    not_in_coq="The axes of the half turns.",
)
