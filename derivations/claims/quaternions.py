"""Claim: quaternions and rotations: R(q), its derivative, and every rotation is an R(q)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from certreg.geometry.so3 import body_frame, davenport_matrix, rotation_matrix

from ..algebra import combination, contraction, identity
from ..hypotheses import cofactor_matrix, rotation_of
from ..hypothesis import Point, vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import Array, Matrix, hat, inner, matrix, quaternion, square, symmetric, vector

Formula = Callable[[Any], Any]
R = matrix("R")


def _of_either_sign(point: Point) -> Any:
    """A rational rotation, or minus one."""
    prepare = rotation_of("R").prepare
    found = prepare(point) if prepare is not None else {}
    return {symbol: -value if point[R[2, 2]] < 0 else value for symbol, value in found.items()}


ORTHOGONAL = vanishing(
    r"For the last part: $RR^{\mathsf T} = I$.", R * R.T - sympy.eye(3), prepare=_of_either_sign
)
DIRECT = vanishing(r"For the last part: $\det R = 1$.", R.det(method="berkowitz") - 1)


def proof(
    rotation: Formula = rotation_matrix,
    frame: Formula = body_frame,
    davenport: Formula = davenport_matrix,
) -> Proof:
    """The map q -> R(q), its frame L(q), its derivative, and its inverse."""
    yield from _is_rotation(rotation)
    yield from _is_frame(frame)
    yield from _turns(rotation, frame)
    yield from _is_onto(rotation, davenport)


def _is_rotation(rotation: Formula) -> Proof:
    q = quaternion()
    R, n = Matrix(rotation(tuple(q))), square(q)
    yield identity(
        r"Write $\hat R(q)$ for the matrix that the code computes, with entries of degree two in "
        r"$q$. Then $\hat R^{\mathsf T}\hat R = |q|^4 I$: its columns are orthogonal and of equal "
        r"length, so $R(q) = \hat R(q)/|q|^2$ is orthogonal for every $q \ne 0$.",
        R.T * R,
        n**2 * sympy.eye(3),
    )
    yield identity(
        r"$\det \hat R(q) = |q|^6$, so $\det R(q) = +1$: a rotation, never a reflection.",
        R.det(method="berkowitz"),
        n**3,
    )
    yield identity(r"$q$ and $-q$ give the same rotation.", rotation(tuple(-q)), R)


def _is_frame(frame: Formula) -> Proof:
    q = quaternion()
    L, n = Matrix(frame(tuple(q))), square(q)
    yield identity(
        r"The columns of $L(q)$ are orthogonal to $q$: $L(q)^{\mathsf T} q = 0$. A motion "
        r"$\dot q = \tfrac12 L(q)\,\omega$ therefore keeps the length of $q$.",
        L.T * q,
        sympy.zeros(3, 1),
    )
    yield identity(
        r"They are orthogonal to each other and as long as $q$: $L^{\mathsf T}L = |q|^2 I$.",
        L.T * L,
        n * sympy.eye(3),
    )
    yield identity(
        r"Together with $q$ they span all of $\mathbb R^4$: "
        r"$L L^{\mathsf T} + q q^{\mathsf T} = |q|^2 I$.",
        L * L.T + q * q.T,
        n * sympy.eye(4),
    )


def _turns(rotation: Formula, frame: Formula) -> Proof:
    q, p, omega = quaternion(), quaternion("p"), vector("omega")
    L, R = Matrix(frame(tuple(q))), Matrix(rotation(tuple(q)))
    rate = L * omega / 2
    slopes = [R.diff(entry) * speed for entry, speed in zip(q, rate, strict=True)]
    yield identity(
        r"The derivative of $\hat R$ along $\dot q = \tfrac12 L(q)\,\omega$ is "
        r"$\hat R(q)\,[\omega]_\times$: the kinematic equation $\dot R = R[\omega]_\times$ "
        r"of the body, where $\omega$ is the angular velocity in its own frame.",
        sum(slopes, start=sympy.zeros(3, 3)),
        R * hat(omega),
    )
    product = q * p[0] + L * p[1:, :]
    yield identity(
        r"With the product $q \otimes p = p_w\, q + L(q)\,(p_x, p_y, p_z)^{\mathsf T}$: "
        r"$\hat R(q \otimes p) = \hat R(q)\,\hat R(p)$. Products of quaternions are products of "
        r"rotations.",
        rotation(tuple(product)),
        R * Matrix(rotation(tuple(p))),
    )


def _is_onto(rotation: Formula, davenport: Formula) -> Proof:
    q = quaternion()
    K, norm = Matrix(davenport(R.tolist())), inner(R, R)
    cofactors = cofactor_matrix(R)
    yield identity(
        r"Conversely, every rotation is an $R(q)$. For every $3\times3$ matrix $C$ whatever, "
        r"Davenport's matrix satisfies $K(C)^2 = \lVert C\rVert^2 I + 2K(\operatorname{cof} C)$ "
        r"with the matrix of cofactors of $C$.",
        K * K,
        norm * sympy.eye(4) + 2 * Matrix(davenport(cofactors.tolist())),
    )
    yield from _rotation_equals_its_cofactors(cofactors)
    P = (K + sympy.eye(4)) / 4
    yield _projector(P, davenport, cofactors)
    yield identity(
        r"Its trace is $1$. The rank of a projector is its trace, so $P = q q^{\mathsf T}$ for a "
        r"unit quaternion $q$.",
        P.trace(),
        1,
    )
    yield identity(
        r"The entries of $\hat R(q)$ are linear in those of $q q^{\mathsf T}$; with $P$ put in "
        r"their place they give $R$ back. So $R = R(q)$.",
        _from_products(rotation, P),
        R,
    )
    yield identity(
        r"And $q$ is unique up to its sign: $K(\hat R(q)) + |q|^2 I = 4\, q q^{\mathsf T}$, so the "
        r"rotation determines $q q^{\mathsf T}$.",
        Matrix(davenport(rotation(tuple(q)))) + square(q) * sympy.eye(4),
        4 * q * q.T,
    )


def _equal_to_cofactors(A: Any, cofactors: Array) -> list[Any]:
    """The terms by which <A, cof R - R> vanishes."""
    return [(inner(A, R), DIRECT[0]), *contraction(-A * cofactors.T, ORTHOGONAL)]


def _rotation_equals_its_cofactors(cofactors: Array) -> Proof:
    A = matrix("A")
    yield combination(
        r"A rotation equals its matrix of cofactors: for every matrix $A$ (so for every entry), "
        r"$\langle A, \operatorname{cof} R - R\rangle$ is a combination of the entries of "
        r"$RR^{\mathsf T} - I$ and of $\det R - 1$, which vanish.",
        inner(A, cofactors - R),
        _equal_to_cofactors(A, cofactors),
    )
    yield combination(
        r"And $\lVert R\rVert^2 - 3 = \operatorname{tr}(RR^{\mathsf T} - I)$ vanishes, too.",
        inner(R, R) - 3,
        [(1, part) for part in ORTHOGONAL.diagonal],
    )


def _projector(P: Array, davenport: Formula, cofactors: Array) -> Any:
    A, X = symmetric("A", 4), matrix("X")
    pairing = inner(A, Matrix(davenport(X.tolist())))
    dual = Matrix(3, 3, [sympy.diff(pairing, entry) for entry in X])
    return combination(
        r"So on $\mathrm{SO}(3)$ the symmetric matrix $P = \tfrac14(K(R) + I)$ is a projector: "
        r"$16\,(P^2 - P) = (\lVert R\rVert^2 - 3)\, I + 2K(\operatorname{cof} R - R)$, "
        r"and both terms vanish there; checked in every pairing $\langle A, P^2 - P\rangle$.",
        16 * inner(A, P * P - P),
        [
            *((A.trace(), part) for part in ORTHOGONAL.diagonal),
            *_equal_to_cofactors(2 * dual, cofactors),
        ],
    )


def _from_products(rotation: Formula, P: Array) -> Array:
    """R(q) with the entry P_ij put for the product of the entries i and j of q."""
    q = quaternion()

    def linear(entry: Any) -> Any:
        found = sympy.Integer(0)
        for powers, factor in sympy.Poly(entry, *q).terms():
            i, j = (k for k, power in enumerate(powers) for _ in range(power))
            found += factor * P[i, j]
        return found

    return Matrix(rotation(tuple(q))).applyfunc(linear)


def _other_side(q: Any) -> Any:
    """The frame of rotations about space axes: (0, a) * q instead of q * (0, a)."""
    w, x, y, z = q
    return ((-x, -y, -z), (w, z, -y), (-z, w, x), (y, -x, w))


def _other_axis(q: Any) -> Any:
    rows = [list(row) for row in rotation_matrix(q)]
    rows[1][2], rows[2][1] = rows[2][1], rows[1][2]
    return rows


CLAIM = Claim(
    name="quaternions",
    title="Quaternions are rotations",
    statement=r"$\hat R(q)^{\mathsf T}\hat R(q) = |q|^4 I$ and $\det\hat R(q) = |q|^6$; "
    r"$L^{\mathsf T}q = 0$, $L^{\mathsf T}L = |q|^2 I$, "
    r"$LL^{\mathsf T} + qq^{\mathsf T} = |q|^2 I$; along $\dot q = \tfrac12 L(q)\,\omega$ the "
    r"rotation obeys $\dot R = R[\omega]_\times$; and every rotation is $R(q)$ for a unit "
    r"quaternion $q$, unique up to sign: $qq^{\mathsf T} = \tfrac14\,(K(R) + I)$.",
    concludes=(1, 2, 4, 5, 6, 7, 10, 11, 12, 13, 14, 15),
    hypotheses=(ORTHOGONAL, DIRECT),
    source="[Horn1987]",
    proof=proof,
    controls={
        "R(q) transposed": Mutation(
            at=7, proof=lambda: proof(lambda q: list(zip(*rotation_matrix(q), strict=True)))
        ),
        "two entries of R(q) exchanged": Mutation(at=1, proof=lambda: proof(_other_axis)),
        "L(q) for space axes instead of body axes": Mutation(
            at=7, proof=lambda: proof(frame=_other_side)
        ),
        "K of the transpose": Mutation(
            at=14,
            proof=lambda: proof(
                davenport=lambda C: davenport_matrix([list(row) for row in zip(*C, strict=True)])
            ),
        ),
    },
    not_claimed=r"Anything about $q = 0$, which is no rotation, or about rounding.",
    needs=("davenport",),
    standard=("The rank of a projector is its trace.",),
    runs=(
        "certreg.geometry.so3.rotation_matrix",
        "certreg.geometry.so3.body_frame",
    ),
    used_by=("certreg.geometry.so3.quaternion_from_matrix",),
    coq=(
        "unit_quaternions_rotate",
        "every_rotation_has_a_quaternion",
        "same_rotation_same_quaternion_up_to_sign",
        "rotation_transpose",
        "rot_orthogonal",
        "rot_det",
        "cotangent_tangent",
        "cotangent_self",
        "along_and_across",
    ),
    not_in_coq="The kinematic equation.",
)
