"""Claim: every equilibrium that is not optimal has a growing mode, and the body leaves it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from certreg.geometry.so3 import davenport_matrix

from ..algebra import Square, combination, contraction, identity, modulo, positive
from ..hypotheses import AT_P, AT_Q, SPECTRAL
from ..hypothesis import Standing, invertible, positive_by, vanishing
from ..kernel import Claim, Mutation, Proof, Step
from ..linearisation import intrinsic_jacobian
from ..motion import DAMPING, Body, State
from ..notation import (
    Array,
    Matrix,
    body,
    inner,
    matrix,
    quaternion,
    scalar,
    square,
    symmetric,
    vector,
)
from .convergence import CLAIM as CONVERGENCE
from .unstable_count import W_ROOT

Davenport = Callable[[Any], Any]
BETTER = positive_by(
    r"$R(p)$ is the better one: $u > v$.", scalar("u") - scalar("v"), standing=Standing.CASE
)
TURNED = invertible(
    r"The body is turned by an angle that is not zero: $s \ne 0$.",
    scalar("s"),
    standing=Standing.CASE,
)
AT_REST = intrinsic_jacobian(State(omega=sympy.zeros(3, 1)), Body())
GROWTH = vanishing(
    r"$s$ is a root of $s^2 + \mu s + g$.",
    scalar("s") ** 2 + DAMPING * scalar("s") + scalar("g"),
    solves=(scalar("g"),),
)
MODE = vanishing(
    r"$\varphi$ belongs to the eigenvalue $g$ of the pencil, $J^{-1} G \varphi = g \varphi$.",
    -AT_REST[9:12, 3:6] * vector("phi") - scalar("g") * vector("phi"),
    solves=tuple(matrix("C")),
)


def proof(
    davenport: Davenport = davenport_matrix, *, sign: int = 1, growth: int = 1, power: int = 2
) -> Proof:
    """There is a better equilibrium, a way down to it, a mode that grows, and no way back."""
    yield from _something_better(davenport)
    yield _downhill(sign)
    yield from _growing_mode(growth)
    yield from _lower_beside(power)
    yield _no_way_back()


def _something_better(davenport: Davenport) -> Proof:
    C = matrix("C")
    K = Matrix(davenport(C.tolist()))
    yield identity(
        r"If $C \neq 0$, there are equilibria that are not optimal. $C$ can be read off $K$, "
        r"with $C_{11} = \tfrac12 (K_{ww} + K_{xx})$, $C_{21} = \tfrac12 (K_{xy} + K_{wz})$ and "
        r"the like for all nine entries, so $K \neq 0$; and $\operatorname{tr} K = 0$. The largest "
        r"eigenvalue is positive then and the smallest negative: $\lambda_1 > \lambda_4$. (If "
        r"$C = 0$, every rotation is optimal "
        r"and nothing is claimed.)",
        [K.trace(), *_read_off(K)],
        [0, *C],
    )


def _read_off(K: Array) -> list[Any]:
    """The nine entries of C, row by row."""
    return [
        (K[0, 0] + K[1, 1]) / 2,
        (K[1, 2] - K[0, 3]) / 2,
        (K[1, 3] + K[0, 2]) / 2,
        (K[1, 2] + K[0, 3]) / 2,
        (K[0, 0] + K[2, 2]) / 2,
        (K[2, 3] - K[0, 1]) / 2,
        (K[1, 3] - K[0, 2]) / 2,
        (K[2, 3] + K[0, 1]) / 2,
        (K[0, 0] + K[3, 3]) / 2,
    ]


def _downhill(sign: int) -> Step:
    K, v, u = symmetric("K", 4), scalar("v"), scalar("u")
    q, p, L = quaternion("q"), quaternion("p"), body(quaternion("q"))
    phi = L.T * p
    G = (q.T * K * q)[0] * sympy.eye(3) - sign * L.T * K * L
    return combination(
        r"Let $K q = v q$ be an equilibrium that is not optimal, and $K p = u p$ a better one, "
        r"$u > v$, for instance the optimum. Along $\varphi = L(q)^{\mathsf T} p$, the axis of the "
        r"half turn from one to the other, $\varphi^{\mathsf T} G \varphi = "
        r"|q|^2 (v - u)\, |\varphi|^2 < 0$, modulo the entries of $K q - v q$ and $K p - u p$. "
        r"As an axis $\varphi$ is not zero (claim `half_turns`), so the Hessian has a negative "
        r"eigenvalue. Its index is at least one on every component of equilibria but the best, be "
        r"it a point, a circle or a projective plane.",
        inner(phi, G * phi) - square(q) * (v - u) * square(phi),
        [
            *contraction(square(phi) * q + inner(p, q) * L * phi, AT_Q),
            *contraction(-square(q) * L * phi, AT_P),
        ],
    )


def _growing_mode(growth: int) -> Proof:
    g, w = scalar("g"), scalar("w")
    yield modulo(
        r"By Sylvester's law the pencil $(G, J)$ then has an eigenvalue $g < 0$ (claim "
        r"`unstable_count`): $J^{-1} G \varphi = g \varphi$ with $\varphi \neq 0$. With "
        r"$w = \sqrt{\mu^2 - 4g} > \mu$, the number $s = (w - \mu)/2 > 0$ is a root of "
        r"$s^2 + \mu s + g$.",
        ((w - DAMPING) / 2) ** 2 + DAMPING * (w - DAMPING) / 2 + g,
        0,
        [W_ROOT],
    )
    phi, a, s = vector("phi"), Matrix(sympy.symbols("a_1:13", real=True)), scalar("s")
    still = sympy.zeros(3, 1)
    mode = Matrix.vstack(still, phi, still, growth * s * phi)
    yield combination(
        r"The mode that grows can be written down: turned by $\varphi$, turning at the rate "
        r"$s \varphi$, nothing else. $A_{12}\, (0, \varphi, 0, s\varphi) = "
        r"s\, (0, \varphi, 0, s\varphi)$, for every contraction with twelve numbers a combination "
        r"of $J^{-1} G \varphi - g\varphi$ and $s^2 + \mu s + g$. Small perturbations of this "
        r"kind grow like $e^{st}$ in the linearised dynamics.",
        inner(a, AT_REST * mode - s * mode),
        [
            *contraction(-a[9:12, :], MODE),
            (-inner(a[9:12, :], phi), GROWTH[0]),
        ],
    )


def _lower_beside(power: int) -> Proof:
    v, u = scalar("v"), scalar("u")
    K, q, p = symmetric("K", 4), quaternion("q"), quaternion("p")
    c, s = scalar("c"), scalar("s")
    beside = c * q + s * p
    yield combination(
        r"The linearised dynamics is not yet the true one, but the energy decides. Let "
        r"$q, p$ be unit vectors with $p \cdot q = 0$, and turn from $q$ towards $p$: "
        r"$q_\theta = c q + s p$ with $c = \cos\tfrac{\theta}{2}$, $s = \sin\tfrac{\theta}{2}$. "
        r"Then $q_\theta^{\mathsf T} K q_\theta = v + s^2 (u - v)$, and as the energy is a "
        r"constant less twice this, the body at rest at $q_\theta$ has less energy than at $q$, by "
        r"$2 s^2 (u - v)$. (As $u \ne v$, $p \cdot q = 0$ follows from the equations of $p$ and "
        r"$q$.)",
        (beside.T * K * beside)[0] - v * square(beside) - s**power * (u - v) * square(p),
        [
            *contraction(c * beside + s * c * p, AT_Q),
            *contraction(s * beside - s * c * q, AT_P),
        ],
    )
    yield positive(
        r"That is less for every angle $\theta \neq 0$, however small.",
        2 * s**2 * (u - v),
        [[2, Square(TURNED[0]), BETTER[0]]],
    )


def _no_way_back() -> Step:
    v, u = scalar("v"), scalar("u")
    q, p = quaternion("q"), quaternion("p")
    return combination(
        r"Release the body there. Its energy never rises (claim `dissipation`), and the motion "
        r"tends to the set of equilibria (claim `convergence`). Every equilibrium $R(p)$ it comes "
        r"near to has less energy than $R(q)$ has: $K p = u p$ with $u > v$. Such a $p$ is "
        r"orthogonal to $q$, since $(u - v)\, p \cdot q$ is a combination of the entries of "
        r"$K q - v q$ and $K p - u p$: it lies $180^\circ$ away. So states at rest as near to the "
        r"equilibrium as one likes leave it for good, and it is unstable, with no theorem on "
        r"linearisation needed.",
        (u - v) * inner(p, q),
        [*contraction(p, AT_Q), *contraction(-q, AT_P)],
    )


def _wrong_sign(C: Any) -> Any:
    """K with the wrong sign in one diagonal entry."""
    K = [list(row) for row in davenport_matrix(C)]
    K[3][3] = -K[3][3]
    return K


CLAIM = Claim(
    name="instability",
    title="Every spurious equilibrium is unstable",
    statement=r"Let $J \succ 0$ and $\mu > 0$. At every equilibrium that is not a global optimum "
    r"the linearised dynamics has a mode that grows like $e^{st}$, $s > 0$, and the equilibrium is "
    r"unstable: from states at rest arbitrarily near to it the body leaves and ends "
    r"$180^\circ$ away. If $C \neq 0$, there are such equilibria.",
    concludes=(1, 2, 3, 4, 5, 6, 7),
    hypotheses=(AT_Q, AT_P, BETTER, TURNED, W_ROOT, GROWTH, MODE),
    inherits=(CONVERGENCE,),
    source="[Yang2020], the conjecture's part (iii), there observed numerically",
    proof=proof,
    controls={
        "K with a wrong entry": Mutation(at=1, proof=lambda: proof(davenport=_wrong_sign)),
        "a Hessian with + L^T K L": Mutation(at=2, proof=lambda: proof(sign=-1)),
        "a mode that turns back": Mutation(at=4, proof=lambda: proof(growth=-1)),
        "an energy that falls to first order": Mutation(at=5, proof=lambda: proof(power=1)),
    },
    not_claimed=r"That every state nearby leaves, or almost every one: that would need a theorem "
    r"about centre-stable manifolds, which is not proved here. Nor how long leaving takes. Nor "
    r"anything where $J$ is singular: the dynamics is not defined there.",
    needs=("eigenvectors", "hessian", "unstable_count", "dissipation", "convergence", "half_turns"),
    standard=(SPECTRAL,),
    runs=("certreg.geometry.so3.davenport_matrix",),
    used_by=(
        "certreg.equilibrium.stability.Curvature.witness",
        "certreg.dynamics.simulation",
    ),
    coq=(
        "positive_index_grows",
        "spurious_equilibria_have_a_growing_mode",
        "optimal_iff_index_zero",
    ),
    not_in_coq=(
        "That a growing mode of the linearised motion makes the motion itself leave "
        "(Lyapunov's theorem), and where it ends."
    ),
)
