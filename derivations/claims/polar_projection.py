"""Claim: the closed form of the rotation nearest to R (I + [a]x), to which Euler's step goes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import sympy

from ..algebra import Square, combination, contraction, identity, modulo, positive
from ..hypotheses import IDENTITY, ROTATION, inverted, rotation_of
from ..hypothesis import Point, Standing, equation, invertible, nonnegative_by, nonzero
from ..integrators import STEP, euler_step, polar_turn
from ..kernel import Claim, Mutation, Proof
from ..motion import Body, State, rate
from ..notation import (
    Array,
    Matrix,
    determinant,
    entry,
    hat,
    inner,
    matrix,
    quaternion,
    rotation,
    scalar,
    square,
    vector,
)

Turn = Callable[[Any, Any], Array]
Step = Callable[[State, Body], Array]

A, N = vector("a"), scalar("n")
U, W = scalar("u"), scalar("w")  # 1/n and 1/(n + 1)


def _rational(point: Point) -> Mapping[Any, Any]:
    """Rational a and n with n^2 = 1 + |a|^2, n of the sign it has."""
    p = [point[entry] / 8 for entry in A]
    size = sum((entry * entry for entry in p), start=Fraction(0))
    sign = -1 if point[N] < 0 else 1
    parts = {s: 2 * value / (1 - size) for s, value in zip(A, p, strict=True)}
    return parts | {N: sign * (1 + size) / (1 - size)}


NOTATION = Standing.NOTATION
ROOT = equation(
    r"$n = \sqrt{1 + |a|^2}$, so $n^2 = 1 + |a|^2$.",
    N,
    2,
    1 + square(A),
    standing=NOTATION,
    prepare=_rational,
)
POSITIVE_ROOT = nonnegative_by(
    r"$n = \sqrt{1 + |a|^2}$, so $n \ge 0$.",
    N,
    standing=NOTATION,
    example={N: Fraction(-5, 3), A[0]: Fraction(4, 3), entry("x", 1): 1},
)
STRETCHED = nonzero(r"$x \ne 0$.", vector("x"), standing=Standing.CASE)
FIRST_INVERSE = invertible("$u = 1/n$.", N, U, standing=NOTATION)
SECOND_INVERSE = invertible("$w = 1/(n + 1)$.", N + 1, W, standing=NOTATION)
S_ROTATION, T_ROTATION = rotation_of("S"), rotation_of("T")


def cleared_turn() -> Array:
    """The matrix P = (n + 1) (I + [a]x) + a a^T."""
    return (N + 1) * (IDENTITY + hat(A)) + A * A.T


def cleared_stretch() -> Array:
    """The matrix n (n + 1) I - a a^T, which is n + 1 times the stretch H."""
    return N * (N + 1) * IDENTITY - A * A.T


def proof(
    turn: Turn = polar_turn,
    *,
    stretch: Callable[[], Array] = cleared_stretch,
    step: Step = euler_step,
) -> Proof:
    """The shipped formula is a rotation, a polar factor, the nearest one; and the step uses it."""
    yield from _is_a_rotation(turn)
    yield from _is_the_polar_factor(stretch)
    yield from _is_nearest(stretch)
    yield from _in_the_step(turn, step)


def _is_a_rotation(turn: Turn) -> Proof:
    B, outer, P = matrix("B"), A * A.T, cleared_turn()
    shipped = inverted(turn(A, N), {N: U, N + 1: W})
    first = (N + 1) * (IDENTITY + hat(A)) + W * (N + 1) * outer
    yield combination(
        r"The code computes $U = \frac1n\bigl(I + [a]_\times\bigr) + "
        r"\frac1{n(n+1)}\,aa^{\mathsf T}$. Write $u$ for $\frac1n$ and $w$ for $\frac1{n+1}$, and "
        r"$P = (n+1)\bigl(I + [a]_\times\bigr) + aa^{\mathsf T}$. Then $n(n+1)\,U - P = "
        r"(un-1)\bigl((n+1)(I + [a]_\times) + w(n+1)\,aa^{\mathsf T}\bigr) + "
        r"\bigl(w(n+1)-1\bigr)aa^{\mathsf T}$, here paired with an arbitrary matrix $B$. Both "
        r"factors vanish, so $U = P/\bigl(n(n+1)\bigr)$.",
        inner(B, N * (N + 1) * shipped - P),
        [(inner(B, first), FIRST_INVERSE[0]), (inner(B, outer), SECOND_INVERSE[0])],
    )
    yield modulo(
        r"From here on $n^2 = 1 + |a|^2$. The same matrix in powers of $[a]_\times$ is $P = "
        r"n(n+1)I + (n+1)[a]_\times + [a]_\times^2$, because $[a]_\times^2 = aa^{\mathsf T} - "
        r"|a|^2I$ and $n(n+1) - |a|^2 = n + 1$: so $U = I + \frac1n[a]_\times + "
        r"\frac1{n(n+1)}[a]_\times^2$, to which the code's form is equal and shorter to compute.",
        P,
        N * (N + 1) * IDENTITY + (N + 1) * hat(A) + hat(A) ** 2,
        [ROOT],
    )
    yield modulo(
        r"Multiplied out, $P^{\mathsf T}P = n^2(n+1)^2 I$: $U$ is "
        r"orthogonal.",
        P.T * P,
        N**2 * (N + 1) ** 2 * IDENTITY,
        [ROOT],
    )
    yield modulo(
        r"$\det P = n^3(n+1)^3$, hence $\det U = 1$: $U$ is a rotation, never a reflection.",
        determinant(P),
        N**3 * (N + 1) ** 3,
        [ROOT],
    )
    yield modulo(
        r"Its axis is $a$, because $Pa = n(n+1)\,a$, and $\operatorname{tr}P = (n+1)(n+2)$ says "
        r"that $1 + 2\cos\theta = 1 + \frac2n$. So $U$ turns by $\theta = \arctan|a|$, a little "
        r"less than the angle $|a|$ of the exponential.",
        [*(P * A), P.trace()],
        [*(N * (N + 1) * A), (N + 1) * (N + 2)],
        [ROOT],
    )


def _is_the_polar_factor(stretch: Callable[[], Array]) -> Proof:
    x, P, H = vector("x"), cleared_turn(), stretch()
    yield modulo(
        r"Let $H = nI - \frac1{n+1}\,aa^{\mathsf T}$, so that $(n+1)H = n(n+1)I - aa^{\mathsf T}$, "
        r"symmetric. The product is $P\,\bigl(n(n+1)I - aa^{\mathsf T}\bigr) = "
        r"n(n+1)^2\,(I + [a]_\times)$. Divided by $n(n+1)^2$: $I + [a]_\times = UH$, a rotation "
        r"times a symmetric matrix. Along the axis nothing is stretched, $Ha = a$.",
        [*(P * H), *H, *(H * A)],
        [*(N * (N + 1) ** 2 * (IDENTITY + hat(A))), *H.T, *((N + 1) * A)],
        [ROOT],
    )
    yield modulo(
        r"$H$ is positive definite: $x^{\mathsf T}\bigl(n(n+1)I - aa^{\mathsf T}\bigr)x = "
        r"|a\times x|^2 + (n+1)|x|^2$,",
        (x.T * H * x)[0],
        square(A.cross(x)) + (N + 1) * square(x),
        [ROOT],
    )
    yield positive(
        r"and that is positive for $x \ne 0$, as $n \ge 0$. So $UH$ is the polar decomposition of "
        r"$I + [a]_\times$.",
        square(A.cross(x)) + (N + 1) * square(x),
        [
            *([Square(entry)] for entry in (*STRETCHED.parts, *A.cross(x))),
            *([POSITIVE_ROOT[0], Square(entry)] for entry in x),
        ],
    )


def _is_nearest(stretch: Callable[[], Array]) -> Proof:
    B, H, R, S, T = (matrix(name) for name in "BHRST")
    yield combination(
        r"Now compare $U$ with any other rotation $S$. For orthogonal $S$ and $T$ and every matrix "
        r"$B$, $\lVert S - B\rVert^2 - \lVert T - B\rVert^2 = 2\operatorname{tr}(T^{\mathsf T}B) - "
        r"2\operatorname{tr}(S^{\mathsf T}B)$, since $\operatorname{tr}(S^{\mathsf T}S - I)$ and "
        r"$\operatorname{tr}(T^{\mathsf T}T - I)$ vanish: the nearest rotation to $B$ is the one "
        r"with the largest $\operatorname{tr}(S^{\mathsf T}B)$.",
        square(S - B) - square(T - B) - 2 * inner(T - S, B),
        [
            *((1, part) for part in S_ROTATION.diagonal),
            *((-1, part) for part in T_ROTATION.diagonal),
        ],
    )
    yield combination(
        r"Write $S = UT$ with a rotation $T$. Then $\operatorname{tr}\bigl((UT)^{\mathsf T}UH\bigr)"
        r" = \operatorname{tr}(T^{\mathsf T}H)$: the difference is a combination of the entries of "
        r"$U^{\mathsf T}U - I$ (here $R$ stands for $U$).",
        inner(R * T, R * H) - inner(T, H),
        contraction(T * H.T, ROTATION),
    )
    q, a = quaternion(), A
    v = Matrix(q[1:])
    yield modulo(
        r"Every rotation $T$ is $R(q)$ for a unit quaternion $q = (q_w, v)$. With both sides "
        r"multiplied by $(n+1)|q|^2$, $(n+1)\bigl(|q|^2\operatorname{tr}H - "
        r"\operatorname{tr}(\hat R(q)^{\mathsf T}H)\bigr) = 2(n+1)^2|v|^2 + 2(v\cdot a)^2 \ge 0$. "
        r"It vanishes only for $v = 0$, that is $T = I$ and $S = U$: $U$ is nearer to "
        r"$I + [a]_\times$ than every other rotation.",
        square(q) * stretch().trace() - inner(rotation(q), stretch()),
        2 * (N + 1) ** 2 * square(v) + 2 * inner(v, a) ** 2,
        [ROOT],
    )
    yield combination(
        r"A rotation $R$ in front changes no distance: $\lVert RB\rVert^2 = \lVert B\rVert^2$, for "
        r"every matrix $B$. With $B = R^{\mathsf T}S - (I + [a]_\times)$ for the rotations $S$: "
        r"the nearest rotation to $R(I + [a]_\times)$ is $RU$, and no other is as near.",
        square(R * B) - square(B),
        contraction(B * B.T, ROTATION),
    )


def _in_the_step(turn: Turn, step: Step) -> Proof:
    state, body = State(), Body()
    angle = STEP * state.omega
    root = sympy.sqrt(1 + square(angle))
    inverses = {root: U, root + 1: W}
    moved, rates = inverted(step(state, body), inverses), rate(state, body)
    unprojected = state.flat + STEP * rates
    yield identity(
        r"Explicit Euler, $s + h\,\mathcal F(s)$, moves the rotation to $R + hR[\omega]_\times = "
        r"R(I + [a]_\times)$ with $a = h\omega$.",
        unprojected[3:12, :],
        Matrix([*(state.R * (IDENTITY + hat(angle)))]),
    )
    yield identity(
        r"The step from which the code is generated has $RU$ in this place, with "
        r"$n = \sqrt{1 + h^2|\omega|^2}$ and $u$, $w$ as above; all its other entries are those of "
        r"$s + h\,\mathcal F(s)$. It is the paper's scheme: one step of explicit Euler, then the "
        r"nearest rotation.",
        moved,
        Matrix(
            [
                *unprojected[:3, :],
                *(state.R * inverted(turn(angle, N), {N: U, N + 1: W})),
                *unprojected[12:, :],
            ]
        ),
    )


def _truncated(angle: Any, root: Any) -> Array:
    return IDENTITY + hat(angle) / root


def _doubled(angle: Any, root: Any) -> Array:
    return polar_turn(angle, root) + hat(angle) ** 2 / (root * (root + 1))


def _wrong_way(state: State, body: Body) -> Array:
    return euler_step(State(c=state.c, R=state.R, v=state.v, omega=-state.omega), body)


CLAIM = Claim(
    name="polar_projection",
    title="Projection to the nearest rotation",
    statement=r"Let $n = \sqrt{1 + |a|^2}$. The rotation nearest to $R(I + [a]_\times)$ in the "
    r"Frobenius norm is $R\,\bigl(I + \frac1n[a]_\times + \frac1{n(n+1)}[a]_\times^2\bigr)$, for "
    r"every vector $a$ and every rotation $R$, and it is the only one: the polar factor, $I + "
    r"[a]_\times = UH$ with $(n+1)H = n(n+1)I - aa^{\mathsf T}$. The step that ships goes there.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14),
    hypotheses=(
        ROOT,
        POSITIVE_ROOT,
        STRETCHED,
        FIRST_INVERSE,
        SECOND_INVERSE,
        ROTATION,
        S_ROTATION,
        T_ROTATION,
    ),
    source="[Yang2020], the projection in the section on simulation; the formula is ours",
    proof=proof,
    controls={
        "the square of the cross product left out": Mutation(at=1, proof=lambda: proof(_truncated)),
        "2/(n(n+1)) for 1/(n(n+1))": Mutation(at=1, proof=lambda: proof(_doubled)),
        "a stretch with + a a^T": Mutation(
            at=6,
            proof=lambda: proof(stretch=lambda: 2 * N * (N + 1) * IDENTITY - cleared_stretch()),
        ),
        "a step that turns the other way": Mutation(at=14, proof=lambda: proof(step=_wrong_way)),
    },
    not_claimed="Anything about the size of the error of explicit Euler, or about the nearest "
    "rotation to a matrix that is not a rotation times $I + [a]_\\times$.",
    needs=("quaternions",),
    runs=(
        "derivations.integrators.polar_turn",
        "derivations.integrators.euler_step",
    ),
    used_by=("certreg.dynamics.simulation.simulate",),
    not_in_coq="Nothing in Coq speaks of integrators.",
)
