"""Claim: the index of the reduced quartic counts the growing modes, with any damping."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy

from certreg.objective.quartics import MONOMIALS, gradient, hessian, value

from ..algebra import Square, combination, contraction, facts, identity, positive
from ..hypotheses import SPECTRAL
from ..hypothesis import Standing, invertible, nonzero, positive_by, vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import Array, Matrix, entry, inner, matrix, quaternion, scalar, symmetric, vector

Second = Callable[..., Any]
SIZE = 3  # of the matrices that are written out below; the words hold for any
QUARTIC = [entry("F", k) for k in range(len(MONOMIALS))]
Q, P = quaternion(), quaternion("p")
S, B, A = symmetric("S"), matrix("B"), symmetric("A")
INVERSE = symmetric("P")
U, PHI = vector("u"), vector("phi")
STIFF = invertible(r"$S$ is invertible, $S P = I$.", S, INVERSE, standing=Standing.CASE)
MASSES, FORCES = symmetric("M"), symmetric("H")
DRAG, SKEW = symmetric("D"), matrix("G")
REAL, IMAGINARY = vector("a"), vector("b")
GROWTH, PITCH = scalar("sigma"), scalar("tau")
GYROSCOPIC = vanishing(
    r"$\Gamma$ is skew: $\Gamma^{\mathsf T} = -\Gamma$.",
    SKEW + SKEW.T,
    standing=Standing.CASE,
    solves=tuple(SKEW),
    example={SKEW[0, 0]: 1, REAL[0]: 1, GROWTH: 1},
)
DAMPS = positive_by(
    r"$D \succ 0$: $d_1, d_2, d_3 > 0$ in its axes.", list(vector("d")), standing=Standing.CASE
)
LEFT, RIGHT = sympy.Rational(1, 1000) - 100 * sympy.I, 100 + 100 * sympy.I
SWINGS = invertible(r"$\tau \ne 0$.", PITCH, standing=Standing.CASE)
SOME = nonzero(
    r"$w = a + i b \ne 0$.",
    [*REAL, *IMAGINARY],
    standing=Standing.CASE,
    example={PITCH: 1} | dict.fromkeys(vector("d"), 1),
)


def form(matrix_of_form: Any, left: Any, right: Any) -> Any:
    """The number left^T A right."""
    return (Matrix(left).T * matrix_of_form * Matrix(right))[0]


def proof(second: Second = hessian, *, coupling: int = 1, damped: bool = True) -> Proof:
    """The quartic's Hessian in angles, the block that is left, and the growing modes."""
    yield from _in_angles(second)
    yield _block(coupling)
    yield from _no_crossing()
    yield from _examples(damped=damped)


def _in_angles(second: Second) -> Proof:
    s, t = scalar("s"), scalar("t")
    moved = [s * q + t * p for q, p in zip(Q, P, strict=True)]
    whole = sympy.Poly(value(QUARTIC, moved), s, t)
    found = [whole.coeff_monomial(s ** (4 - k) * t**k) for k in (0, 1, 2)]
    H = Matrix(second(QUARTIC, tuple(Q)))
    yield identity(
        r"Turned by the angle $\theta$ about the axis $n$ of the body, $|q| = |n| = 1$, the "
        r"quaternion is $\cos(\theta/2)\, q + \sin(\theta/2)\, p$ with $p = L(q) n$. For any $p$ "
        r"and quartic $F$ the first terms of $F(s q + t p)$ are $s^4 F + s^3 t\, p \cdot \nabla F "
        r"+ \tfrac12 s^2 t^2\, p^{\mathsf T} F'' p$. So the second derivative in $\theta$ is "
        r"$\tfrac14 (p^{\mathsf T} F'' p - 4F)$: the Hessian of $f$ in angles is $\tfrac14 "
        r"(L^{\mathsf T} F'' L - 4 F I)$.",
        found,
        [
            value(QUARTIC, tuple(Q)),
            inner(P, gradient(QUARTIC, tuple(Q))),
            form(H, P, P) / 2,
        ],
    )


def _block(coupling: int) -> Any:
    off = U + coupling * INVERSE * B * PHI
    left = A - B.T * INVERSE * B
    return combination(
        r"To second order the energy about an equilibrium is $u^{\mathsf T} S u + 2 u^{\mathsf T} "
        r"B \varphi + \varphi^{\mathsf T} A \varphi$ in shift and turn. If $S$ is invertible, $P = "
        r"S^{-1}$, it is $(u + P B \varphi)^{\mathsf T} S (u + P B \varphi) + \varphi^{\mathsf T} "
        r"(A - B^{\mathsf T} P B)\, \varphi$, in other coordinates. With $S \succ 0$ the second "
        r"part is what is left at the best shift, the Hessian of $f$; and by Sylvester's law of "
        r"inertia (claim `unstable_count`) the $6\times6$ Hessian has as many negative eigenvalues "
        r"as that of $f$, as many zeros, and three more positive ones.",
        form(S, U, U)
        + 2 * form(B, U, PHI)
        + form(A, PHI, PHI)
        - form(S, off, off)
        - form(left, PHI, PHI),
        [
            *contraction(-2 * U * (B * PHI).T, STIFF),
            *contraction(-(INVERSE * B * PHI) * (B * PHI).T, STIFF),
        ],
    )


def _complex(root: Any, vector_of: Any) -> tuple[Array, Array]:
    """Real and imaginary part of a complex number times a vector, all as pairs."""
    (s, t), (a, b) = root, vector_of
    return s * a - t * b, t * a + s * b


def _no_crossing() -> Proof:
    w = (REAL, IMAGINARY)
    s = (GROWTH, PITCH)
    once = _complex(s, w)
    twice = _complex(s, once)
    moved = [MASSES * twice[k] + (DRAG + SKEW) * once[k] + FORCES * w[k] for k in (0, 1)]
    imaginary = inner(REAL, moved[1]) - inner(IMAGINARY, moved[0])
    both = [form(one, REAL, REAL) + form(one, IMAGINARY, IMAGINARY) for one in (MASSES, DRAG)]
    turned = 2 * form(SKEW, REAL, IMAGINARY)
    yield combination(
        r"The motion about an equilibrium is, to first order, $M \ddot u + (D + \Gamma)\, \dot u + "
        r"H u = 0$, in six coordinates; here with $3\times3$ matrices, written out. Let $s = "
        r"\sigma + i\tau$ be a root, $w = a + i b$, $(s^2 M + s (D + \Gamma) + H)\, w = 0$, and "
        r"multiply by the conjugate of $w$. The imaginary part is $2 \sigma \tau m + \tau d + "
        r"\sigma g = 0$, with $m = a^{\mathsf T} M a + b^{\mathsf T} M b$, likewise $d$, and $g = "
        r"2\, a^{\mathsf T} \Gamma b$; this takes that $\Gamma$ is skew.",
        imaginary - (2 * GROWTH * PITCH * both[0] + PITCH * both[1] + GROWTH * turned),
        [
            *contraction(PITCH * (REAL * REAL.T + IMAGINARY * IMAGINARY.T) / 2, GYROSCOPIC),
            *contraction(-GROWTH * IMAGINARY * REAL.T, GYROSCOPIC),
        ],
    )
    swings, damping = Square(SWINGS[0]), DAMPS.parts
    squares = [[swings, damping[k % SIZE], Square(SOME[k])] for k in range(2 * SIZE)]
    yield positive(
        r"On the imaginary axis, $\sigma = 0$, that is $\tau d = 0$. In the axes of $D$, $\tau "
        r"\cdot \tau d > 0$ unless $\tau = 0$: the only root there can be zero, with $H w = 0$. "
        r"So if $H$ is invertible and $D$ and $\Gamma$ change to $\mu M$ and $0$ along a line, on "
        r"which $D$ stays positive definite, no root crosses the axis. At the end of it there are "
        r"as many with positive real part as $H$ has negative eigenvalues (claim `unstable_count`, "
        r"whose steps hold for any number of coordinates), so there are at the start.",
        PITCH**2 * sum(d * (a**2 + b**2) for d, a, b in zip(vector("d"), *w, strict=True)),
        squares,
    )


def growing(drag: Sequence[int], turning: int, forces: Sequence[int]) -> int:
    """Roots beyond 1/1000 of two coordinates of unit mass, coupled by a gyroscopic term."""
    x = sympy.Symbol("x")
    one, two = (x**2 + d * x + h for d, h in zip(drag, forces, strict=True))
    polynomial = sympy.Poly(one * two + turning**2 * x**2, x)
    return int(polynomial.count_roots(LEFT, RIGHT))


def _examples(*, damped: bool) -> Proof:
    drag = (1, 3) if damped else (0, 0)
    cases = [(5, (1, 2)), (5, (-1, 2)), (5, (-1, -2)), (0, (-1, -2))]
    yield facts(
        r"Seen in two coordinates, $M = I$, $D = \operatorname{diag}(1, 3)$, with a gyroscopic "
        r"term of 5 and forces of index 0, 1 and 2, and of index 2 without it: as many roots have "
        r"a positive real part. Without damping the gyroscopic term would hold both back.",
        [growing(drag, *case) for case in cases] + [growing((0, 0), 5, (-1, -2))],
        [0, 1, 2, 2, 0],
    )


def _no_half(quartic: Sequence[Any], q: Sequence[Any]) -> Any:
    return 2 * Matrix(hessian(quartic, q))


CLAIM = Claim(
    name="spring_index",
    title="The index of the quartic counts the growing modes",
    statement=r"Let $S \succ 0$. At a critical rotation the Hessian of $f$ in angles is "
    r"$\tfrac14 (L^{\mathsf T} F'' L - 4 F I)$ for $|q| = 1$, and the $6\times6$ Hessian of the "
    r"energy in shift and turn has the same index. If it is invertible and $J \succ 0$, the "
    r"linearised motion has exactly as many eigenvalues with positive real part, with any damping "
    r"$D \succ 0$, also beside gyroscopic terms.",
    concludes=(1, 2, 3, 4, 5),
    hypotheses=(STIFF, GYROSCOPIC, DAMPS, SWINGS, SOME),
    setting=(
        r"$S, B, A$ are the blocks of the $6\times6$ Hessian.",
        r"$M$ and $H$ are symmetric, $M \succ 0$.",
    ),
    source="[Haynsworth1968]; Kelvin, Tait and Chetaev",
    proof=proof,
    controls={
        "twice the second derivatives": Mutation(at=1, proof=lambda: proof(_no_half)),
        "a shift the other way": Mutation(at=2, proof=lambda: proof(coupling=-1)),
        "without damping": Mutation(at=5, proof=lambda: proof(damped=False)),
    },
    not_claimed=r"Anything where the Hessian is singular or $S$ is: zeros are not counted. Nor "
    r"that growing modes are real, as they are with $D = \mu M$ and $\Gamma = 0$.",
    needs=("spring_translation", "quartic_relaxation", "unstable_count"),
    standard=(
        SPECTRAL,
        "The roots of a polynomial depend continuously on its coefficients.",
    ),
    runs=("certreg.objective.quartics.hessian", "certreg.objective.quartics.value"),
    used_by=("certreg.objective.objective.Objective.hessian",),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
