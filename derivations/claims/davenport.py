"""Claim: Davenport's matrix represents the alignment tr(R(q)^T C) as a quadratic form in q."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from certreg.geometry.so3 import davenport_matrix, quadratic_form

from ..algebra import identity
from ..kernel import Claim, Mutation, Proof
from ..notation import inner, matrix, quaternion, rotation


def proof(davenport: Callable[[Any], Any] = davenport_matrix) -> Proof:
    """One polynomial identity in the nine entries of C and the four of q."""
    C, q = matrix("C"), quaternion()
    K = davenport(C.tolist())
    yield identity(
        r"$K(C)$ is symmetric: $K(C) = K(C)^{\mathsf T}$.",
        K,
        [list(column) for column in zip(*K, strict=True)],
    )
    yield identity(
        r"Its trace vanishes: $\operatorname{tr} K(C) = 0$, so the mean of $q^{\mathsf T} K q$ "
        r"over all rotations is zero.",
        sum(K[k][k] for k in range(4)),
        0,
    )
    yield identity(
        r"Both sides of $q^{\mathsf T} K(C)\, q = |q|^2 \operatorname{tr}(R(q)^{\mathsf T} C)$ are "
        r"polynomials of degree two in $q$ and one in $C$, as $|q|^2 R(q)$ is the matrix $\hat "
        r"R(q)$ of quadratic entries; multiplied out, they are the same.",
        quadratic_form(K, tuple(q)),
        inner(rotation(q), C),
    )


def _wrong_axial_sign(C: Any) -> Any:
    K = [list(row) for row in davenport_matrix(C)]
    for k in (1, 2, 3):
        K[0][k], K[k][0] = -K[0][k], -K[k][0]
    return K


CLAIM = Claim(
    name="davenport",
    title="Davenport's matrix",
    statement=r"For every real $3\times3$ matrix $C$ and every quaternion $q \neq 0$: "
    r"$\;q^{\mathsf T} K(C)\, q = |q|^2 \operatorname{tr}\bigl(R(q)^{\mathsf T} C\bigr)$. The "
    r"matrix $K(C)$ is symmetric, and its trace is zero.",
    concludes=(1, 2, 3),
    source="[Davenport1968], [Horn1987]",
    proof=proof,
    controls={
        "K of the transpose of C": Mutation(
            at=3, proof=lambda: proof(lambda C: davenport_matrix(list(zip(*C, strict=True))))
        ),
        "the axial vector with the other sign": Mutation(
            at=3, proof=lambda: proof(_wrong_axial_sign)
        ),
    },
    not_claimed=r"Anything about $q = 0$. That $R(q)$ is a rotation is the claim `quaternions`.",
    runs=("certreg.geometry.so3.davenport_matrix",),
    used_by=("certreg.objective.isotropic.Isotropic.alignment",),
    coq=(
        "davenport_form",
        "davenport_traceless",
    ),
    not_in_coq="Nothing: the whole claim is proved there.",
)
