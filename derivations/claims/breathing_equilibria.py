"""Claim: the equilibria of the body that breathes are eigenlines; their scale, energy, index."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import sympy

from certreg.equilibrium.breathing import BreathingEquilibria, breathing_equilibria
from certreg.geometry.so3 import davenport_matrix
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

from ..algebra import Square, combination, facts, identity, positive
from ..breathing_motion import BreathingState, hessian, linearised, own_size
from ..hypothesis import Standing, nonzero, positive_by, vanishing
from ..kernel import Claim, Mutation, Proof
from ..motion import DAMPING, Body
from ..notation import (
    Matrix,
    body,
    inner,
    quaternion,
    scalar,
    square,
    symmetric,
    vector,
    vee,
)

Listed = Callable[[Isotropic], BreathingEquilibria]
K, Q, S = symmetric("K", 4), quaternion(), scalar("s")
SIZE, TARGET, LEVEL, OTHER = (scalar(name) for name in ("S_xx", "S_yy", "l_j", "l_k"))
STATE, BODY = BreathingState(), Body()
TORQUE = vee(STATE.R.T * BODY.cross - BODY.cross.T * STATE.R)
NO_TORQUE = vanishing(
    r"The torque vanishes, $L(q)^{\mathsf T} K q = 0$.",
    body(Q).T * K * Q,
    standing=Standing.CASE,
    solves=tuple(K[:, 0]),
)
RESTING = vanishing(
    r"At an equilibrium: $R^{\mathsf T} C$ is symmetric.",
    TORQUE,
    standing=Standing.CASE,
    solves=(BODY.cross[0, 1], BODY.cross[0, 2], BODY.cross[1, 2]),
)
BALANCED = vanishing(
    r"The scale is at rest: $s S_{xx} = \lambda_j$.",
    S * SIZE - LEVEL,
    standing=Standing.CASE,
    solves=(LEVEL,),
)
BIG = positive_by(r"The source is no single point: $S_{xx} > 0$.", SIZE)
UPRIGHT = positive_by(r"$s > 0$.", S, standing=Standing.CASE)
LOWER = positive_by(r"$\lambda_k < \lambda_j$.", LEVEL - OTHER, standing=Standing.CASE)
TURNED = nonzero(
    r"The torque at scale $1$ is not $0$: $\tau \ne 0$.", vector("tau"), standing=Standing.CASE
)
CLOUDS = ((4, 3, 2), (4, 2, 1), (4, 3, -2), (3, 2, -1), (2, 1, 1), (1, 1, -1))


def proof(listed: Listed = breathing_equilibria, *, energy: int = 1, coupling: int = 1) -> Proof:
    """The equations of rest; scale and energy; the Hessian; the linearised motion; s = 0."""
    yield from _rest()
    yield from _levels(energy)
    yield from _index(coupling)
    yield _motion()
    yield _at_zero()
    yield _listed(listed)


def _rest() -> Proof:
    image = K * Q
    yield identity(
        r"$q$ and the columns of $L(q)$ are orthogonal, of the length of $q$: $|q|^2 I = q "
        r"q^{\mathsf T} + L L^{\mathsf T}$,",
        square(Q) * sympy.eye(4),
        Q * Q.T + body(Q) * body(Q).T,
    )
    a = quaternion("a")
    yield combination(
        r"so that $|q|^2 K q = (q^{\mathsf T} K q)\, q$ where $L^{\mathsf T} K q = 0$. The torque "
        r"of the springs is $2 s L^{\mathsf T} K q$ (claims `breathing_motion`, `torque`): the "
        r"rotation rests at $s \ne 0$ if and only if $q$ is an eigenvector of $K$, as for the "
        r"rigid body; at rest, $\dot s = \omega = 0$, the scale does if and only if $s S_{xx} = "
        r"\operatorname{tr}(R^{\mathsf T} C)$, the eigenvalue.",
        inner(a, square(Q) * image - (Q.T * image)[0] * Q),
        list(zip(body(Q).T * a, NO_TORQUE.parts, strict=True)),
    )


def _levels(energy: int) -> Proof:
    value = TARGET + S**2 * SIZE - 2 * S * LEVEL
    yield combination(
        r"The energy there is $S_{yy} - \lambda_j^2/S_{xx}$, here times $S_{xx}$. So the larger "
        r"the positive eigenvalue, the lower: the optimum of the rigid body is the optimum.",
        SIZE * value - (SIZE * TARGET - energy * LEVEL**2),
        [(S * SIZE - LEVEL, BALANCED[0])],
    )
    yield positive(
        r"As $S_{xx} > 0$, $s$ and $\lambda_j$ have one sign: to an eigenvalue $\lambda_j > 0$ "
        r"there is one scale $s_j = \lambda_j/S_{xx} > 0$, to $\lambda_j < 0$ one below $0$, the "
        r"body inside out, and to $\lambda_j = 0$ none but $0$.",
        S * SIZE,
        [[UPRIGHT[0], BIG[0]]],
    )


def _index(coupling: int) -> Proof:
    phi, sigma = vector("phi"), scalar("sigma")
    aligned = STATE.R.T * BODY.cross
    G = 2 * inner(STATE.R, BODY.cross) * sympy.eye(3) - aligned - aligned.T
    along = Matrix([*phi, sigma])
    yield combination(
        r"The Hessian of $V_p$ in $(\varphi, s)$ at an equilibrium, the shipped one: $s\, "
        r"\varphi^{\mathsf T} G \varphi + 2 S_{xx} \sigma^2$, $G$ that of the rigid body. Rotation "
        r"and scale do not mix, and the scale is a spring.",
        (along.T * hessian(STATE, BODY) * along)[0]
        - S * (phi.T * G * phi)[0]
        - 2 * coupling * own_size(BODY) * sigma**2,
        [(-4 * sigma * e, part) for e, part in zip(phi, RESTING.parts, strict=True)],
    )
    yield positive(
        r"$G$ has the eigenvalues $\lambda_j - \lambda_k$ (claim `hessian`). For $s > 0$ those of "
        r"$s G$ have their signs: the index is that of the rigid body, the number of eigenvalues "
        r"above $\lambda_j$. For $s < 0$ it is the number of those below: $4 - j$ where all "
        r"differ, and $0$ for $\lambda_4$, which is negative unless $C = 0$, as $\operatorname{tr} "
        r"K = 0$: that body inside out is always stable.",
        S * (LEVEL - OTHER),
        [[UPRIGHT[0], LOWER[0]]],
    )


def _motion() -> Any:
    zeros = dict.fromkeys((*STATE.omega, STATE.growth), 0)
    inverse, own = scalar("u"), scalar("w")
    found = linearised(STATE, BODY).subs(zeros)
    found = found.xreplace({1 / S: inverse, S**-2: inverse**2, 1 / own_size(BODY): own})
    aligned = STATE.R.T * BODY.cross
    spring = 2 * (aligned - inner(STATE.R, BODY.cross) * sympy.eye(3))
    a, b = Matrix(sympy.symbols("a_1:15", real=True)), Matrix(sympy.symbols("b_1:15", real=True))
    expected = sympy.zeros(14, 14)
    expected[:7, 7:] = sympy.eye(7)
    expected[7:, 7:] = -DAMPING * sympy.eye(7)
    expected[7:10, :3], expected[13, 6] = -2 * sympy.eye(3), -2
    expected[10:13, 3:6] = inverse * BODY.inertia_inverse * spring
    pulled = -2 * inverse**2 * b[6] * BODY.inertia_inverse * a[10:13, :]
    driven = 2 * own * a[13] * b[3:6, :]
    return combination(
        r"The shipped linearisation at rest: $\ddot c = -2c - \mu\dot c$, $\ddot s = -2s - \mu\dot "
        r"s$, a fourth such spring, and $\ddot\varphi = -J^{-1}(G/s)\varphi - \mu\dot\varphi$. So "
        r"by claim `unstable_count`, with $G/s$ for $G$, as many of the 14 eigenvalues have a "
        r"positive real part as $s G$ has negative ones: the index.",
        (a.T * (found - expected) * b)[0],
        list(zip(pulled + driven, RESTING.parts, strict=True)),
    )


def _at_zero() -> Any:
    tau = vector("tau")
    phi, sigma = SIZE * tau, square(tau) / 2
    form = -2 * sigma * inner(tau, phi) + 2 * SIZE * sigma**2
    half = sympy.Rational(1, 2)
    squares = [[half, BIG[0], Square(a), Square(a)] for a in TURNED.parts]
    others = [[half, BIG[0], Square(a * b)] for a in tau for b in tau if a != b]
    return positive(
        r"At $s = 0$ the energy is stationary wherever $\operatorname{tr}(R^{\mathsf T} C) = 0$. "
        r"There the inertia $s^2 J$ is gone: no equilibrium of a motion. With the torque $\tau$ at "
        r"scale $1$ the Hessian is $-2\sigma\,\tau\cdot\varphi + 2 S_{xx}\sigma^2$, negative at "
        r"$\varphi = S_{xx}\tau$, $\sigma = |\tau|^2/2$: a saddle, where $\tau \ne 0$.",
        -form,
        [*squares, *others],
    )


@cache
def cross_of(diagonal: tuple[int, ...]) -> Isotropic:
    """The objective of six points +-e_k at +-d_k e_k: C = 2 diag(d), Sxx = 6."""
    source = np.array([s * row for row in np.eye(3) for s in (1.0, -1.0)])
    return Isotropic(exact_moments(RegistrationProblem(source, source * np.array(diagonal, float))))


def _listed(listed: Listed) -> Any:
    found, expected = list[Any](), list[Any]()
    for diagonal in CLOUDS:
        K_of: Any = davenport_matrix(sympy.diag(*diagonal).tolist())
        levels = sorted((int(K_of[k][k]) for k in range(4)), reverse=True)
        list_of = listed(cross_of(diagonal))
        found.append([(e.scale, e.morse_index, e.energy) for e in list_of.upright])
        found[-1] += [(e.scale, e.morse_index, e.energy) for e in list_of.inside_out]
        each = [v for v in dict.fromkeys(levels) if v > 0]
        each += [v for v in dict.fromkeys(reversed(levels)) if v < 0]
        spread = 2 * sum(d * d for d in diagonal)
        expected.append(
            [
                (
                    float(Fraction(v, 3)),
                    sum((w > v) if v > 0 else (w < v) for w in levels),
                    float(spread - Fraction(2 * v * v, 3)),
                )
                for v in each
            ]
        )
    told = [[tuple(map(str, entry)) for entry in each] for each in found]
    wanted = [[tuple(map(str, entry)) for entry in each] for each in expected]
    return facts(
        r"`certreg.equilibrium.breathing.breathing_equilibria` lists these, of six points $\pm "
        r"e_k$ with targets $\pm d_k e_k$ ($S_{xx} = 6$, eigenvalues twice those of "
        r"$\operatorname{diag}(d)$): with $s > 0$ one for $d = (4, 3, 2)$, $s = 3$; two for $(4, "
        r"2, 1)$, $s = 7/3, 1/3$; three for $(4, 3, -2)$, $s = 5/3, 1, 1/3$.",
        told,
        wanted,
    )


def _rigid_index(objective: Isotropic) -> BreathingEquilibria:
    """The inside-out states with the index of the rigid body."""
    found = breathing_equilibria(objective)
    turned = tuple(
        replace(e, morse_index=objective.classification.indices[e.component])
        for e in found.inside_out
    )
    return replace(found, inside_out=turned)


CLAIM = Claim(
    name="breathing_equilibria",
    title="The equilibria of the body that breathes",
    statement=r"Let $S_{xx} > 0$. With $s \ne 0$ the body rests exactly at the eigenvectors of $K$ "
    r"with an eigenvalue $\lambda_j \ne 0$, at the scale $s_j = \lambda_j/S_{xx}$, with the energy "
    r"$S_{yy} - \lambda_j^2/S_{xx}$. If $\lambda_j > 0$ the index is that of the rigid body; if "
    r"$\lambda_j < 0$ it is the number of eigenvalues below, so that the inside-out body of "
    r"$\lambda_4$ is stable. As many eigenvalues of the linearised motion have a positive real "
    r"part. $s = 0$ is no state of the motion.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 9),
    hypotheses=(NO_TORQUE, BALANCED, BIG, UPRIGHT, RESTING, LOWER, TURNED),
    setting=(
        r"At the best translation, $c = 0$; $S_{xx}$, $S_{yy}$ about the means; $u = 1/s$.",
        r"$\lambda_1 \ge \dots \ge \lambda_4$ are the eigenvalues of $K$.",
    ),
    source="ours; the scale of [Umeyama1991] at the optimum",
    proof=proof,
    controls={
        "twice the energy": Mutation(at=3, proof=lambda: proof(energy=2)),
        "a scale twice as stiff": Mutation(at=5, proof=lambda: proof(coupling=2)),
        "inside out with the index of the rigid body": Mutation(
            at=9, proof=lambda: proof(_rigid_index)
        ),
    },
    not_claimed=r"How many there are: claim `descartes`. That a motion ends at one of them: claim "
    r"`breathing_confined`.",
    needs=("breathing_motion", "eigenvectors", "torque", "hessian", "unstable_count", "davenport"),
    runs=(
        "certreg.equilibrium.breathing.breathing_equilibria",
        "derivations.breathing_motion.hessian",
        "derivations.breathing_motion.linearised",
    ),
    used_by=("certreg.equilibrium.breathing",),
    not_in_coq="All of it: the theorems in Coq are about the rigid body.",
)
