"""Claim: to first order in the noise, the optimal similarity has the 7x7 covariance that ships."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import sympy

from certreg.objective.isotropic import Isotropic
from certreg.problem.problem import RegistrationProblem
from certreg.registration.covariance import pose_covariance

from ..algebra import combination, contraction, facts, identity, quoted
from ..hypotheses import SOLID
from ..hypothesis import Standing, invertible, vanishing
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..notation import Array, Matrix, hat, inner, matrix, scalar, symmetric, vector

Covariance = Callable[..., Any]
Lever = Callable[[Array, Array, Any], Array]
CLOUD, R, S = MomentCloud(), matrix("R"), scalar("s")
SPREAD = CLOUD.source_scatter
BACK, OWN, INVERSE, GRAM = scalar("v"), scalar("w"), symmetric("I"), symmetric("N")
SOLID_INVERSE = invertible(SOLID, CLOUD.inertia, INVERSE)
SIZED = invertible(r"$S_{xx} > 0$; $w = 1/S_{xx}$.", SPREAD.trace(), OWN, standing=Standing.CASE)
SCALED = invertible(r"The true scale is not $0$; $v = 1/s$.", S, BACK)
ROTATED = vanishing(
    r"$N = R^{\mathsf T}R$ for a rotation $R$, so $N = I$.",
    GRAM - sympy.eye(3),
    standing=Standing.NOTATION,
    solves=tuple(sorted(GRAM.free_symbols, key=str)),
)


def lever_arm(turn: Array, mean: Array, scale: Any) -> Array:
    """The lever s R [mean]x: what a turn phi of the body does to the translation."""
    return scale * turn * hat(mean)


def proof(
    shipped: Covariance = pose_covariance,
    *,
    lever: Lever = lever_arm,
    stiff: Any = S,
    spread: int = 1,
) -> Proof:
    """The move of the translation; the linearised conditions; the blocks; the code."""
    mean, phi, sigma = vector("xbar"), vector("phi"), scalar("sigma")
    yield identity(
        r"The best translation is $t = \bar y - s R \bar x$. Noise that turns the optimum by "
        r"$\varphi$ in the body's frame and changes its scale by $\sigma$ moves it, to first "
        r"order, by $\delta t = \bar e + s R [\bar x]_\times \varphi - \sigma R \bar x$, $\bar e$ "
        r"the mean of the noise.",
        -S * R * hat(phi) * mean - sigma * R * mean,
        lever(R, mean, S) * phi - sigma * R * mean,
    )
    yield from _conditions(phi, stiff)
    yield from _blocks(spread)
    yield from _turn()
    yield _shipped(shipped)


def _conditions(phi: Array, stiff: Any) -> Proof:
    u = vector("u")
    slope = -CLOUD.total(CLOUD.x.cross(2 * hat(phi).T * S * GRAM * CLOUD.x))
    yield combination(
        r"The optimum has no torque, $2\sum_i m_i\, \tilde x_i \times R^{\mathsf T} \tilde y_i = "
        r"0$, whatever its scale. At noise-free data, $\tilde y = s R \tilde x$, the derivative of "
        r"minus the torque along $R \exp([\varphi]_\times)$ contains $R$ as $N = R^{\mathsf T} R$ "
        r"only, and it is the Hessian $G = 2 s J$; checked as $u^{\mathsf T} G \varphi$.",
        (u.T * (slope - 2 * stiff * CLOUD.inertia * phi))[0],
        contraction(2 * S * hat(phi).T * hat(u) * SPREAD, ROTATED),
    )
    yield combination(
        r"Its scale is $\operatorname{tr}(R^{\mathsf T} C)/S_{xx}$ (claim `scale_elimination`), "
        r"which a turn does not change to first order: $C = s R S_2$, $S_2$ symmetric.",
        inner(hat(phi), S * GRAM * SPREAD),
        contraction(S * hat(phi) * SPREAD, ROTATED),
    )
    yield quoted(
        r"So the optimum is a smooth function of the noise, and to first order $s J \varphi = "
        r"\sum_i m_i\, \tilde x_i \times R^{\mathsf T} e_i$ and $S_{xx} \sigma = \sum_i m_i "
        r"(R \tilde x_i)^{\mathsf T} e_i$.",
        theorem="the implicit function theorem",
        source="the implicit function theorem",
    )


def _blocks(spread: int) -> Proof:
    u, x = vector("u"), CLOUD.x
    yield combination(
        r"The $e_i$ are independent with covariance $I/m_i$: $\operatorname{var} \sigma = "
        r"\sum_i m_i |R \tilde x_i|^2 / S_{xx}^2 = 1/S_{xx}$;",
        OWN**2 * CLOUD.total((x.T * GRAM * x)[0]) - spread * OWN,
        [*contraction(OWN**2 * SPREAD, ROTATED), (OWN, SIZED[0])],
    )
    yield combination(
        r"$\varphi$ and $\sigma$ are uncorrelated: $\sum_i m_i\, \tilde x_i \times R^{\mathsf T} R "
        r"\tilde x_i = 0$;",
        CLOUD.total((u.T * hat(x) * GRAM * x)[0]),
        contraction(hat(u) * SPREAD, ROTATED),
    )
    yield identity(
        r"and neither is correlated with $\bar e$, as the centred points sum to zero; "
        r"$\operatorname{cov} \bar e = I/M$ (claim `covariance`). With $P = \operatorname{cov} "
        r"\varphi$ that is all of the matrix.",
        [CLOUD.total(hat(x) * R.T), CLOUD.total(R * x)],
        [sympy.zeros(3), sympy.zeros(3, 1)],
    )


def _turn() -> Proof:
    u, b = vector("u"), vector("b")
    outer = u * b.T
    yield combination(
        r"$\sum_i m_i\, \tilde x_i \times R^{\mathsf T} e_i$ has the covariance $J$ (claim "
        r"`covariance`), so $P = (s J)^{-1} J (s J)^{-1} = J^{-1}/s^2$,",
        (u.T * BACK**2 * (INVERSE * CLOUD.inertia * INVERSE - INVERSE) * b)[0],
        contraction(BACK**2 * INVERSE * outer, SOLID_INVERSE),
    )
    yield combination(
        r"which is $2 (s G)^{-1}$, as $G = 2 s J$: $s G P = 2 I$.",
        (u.T * (2 * S**2 * BACK**2 * CLOUD.inertia * INVERSE - 2 * sympy.eye(3)) * b)[0],
        [
            *contraction(2 * S**2 * BACK**2 * outer, SOLID_INVERSE),
            (2 * (S * BACK + 1) * inner(u, b), SCALED[0]),
        ],
    )


def _shipped(shipped: Covariance) -> Any:
    """A cube of side 2 about (1, 2, 3): M = 8, J = 16 I, Sxx = 24; s = 2, R = I."""
    mean, scale = Matrix([1, 2, 3]), 2
    corners = [
        [a + b for a, b in zip((1, 2, 3), c, strict=True)] for c in product((-1, 1), repeat=3)
    ]
    source = np.array(corners, dtype=float)
    problem = RegistrationProblem(source, scale * source + 5, scale="asymmetric", sigma=1.0)
    found: Any = shipped(problem, Isotropic.of(problem)).matrix
    lever, P, own = scale * hat(mean), sympy.eye(3) / (16 * scale**2), sympy.Rational(1, 24)
    shift = sympy.eye(3) / 8 + lever * P * lever.T + own * mean * mean.T
    rows: Any = Matrix.vstack(
        Matrix.hstack(shift, lever * P, -own * mean),
        Matrix.hstack((lever * P).T, P, sympy.zeros(3, 1)),
        Matrix.hstack(-own * mean.T, sympy.zeros(1, 3), own * sympy.eye(1)),
    )
    return facts(
        r"`certreg.registration.covariance.pose_covariance` gives this matrix, its 49 entries "
        r"rounded to the nearest doubles, of the eight corners of a cube about $(1, 2, 3)$ with "
        r"targets $2 x + (5, 5, 5)$ and $\sigma_i = 1$: $M = 8$, $J = 16 I$, $S_{xx} = 24$.",
        [str(float(entry) + 0.0) for row in found for entry in row],
        [str(float(Fraction(int(e.p), int(e.q)))) for e in rows],
    )


class _Bare:
    """A covariance whose translation does not feel the scale."""

    def __init__(self, covariance: Any) -> None:
        self.matrix = np.array(covariance.matrix)
        self.matrix[:3, 6] = self.matrix[6, :3] = 0.0


def _without_spread(problem: RegistrationProblem, objective: Isotropic) -> _Bare:
    return _Bare(pose_covariance(problem, objective))


CLAIM = Claim(
    name="scale_covariance",
    title="The covariance of the optimal similarity",
    statement=r"Let the targets $y_i = s R x_i + t + e_i$, $s > 0$, carry independent Gaussian "
    r"noise of covariance $I/m_i$, the sources none. To first order in the noise, the asymmetric "
    r"optimum is at $R \exp([\varphi]_\times)$, $s + \sigma$, $t + \delta t$ with "
    r"$\operatorname{cov} \varphi = P$, $\operatorname{var} \sigma = 1/S_{xx}$, $\varphi$ and "
    r"$\sigma$ uncorrelated, $$\operatorname{cov}(\delta t, \varphi) = s R [\bar x]_\times P, "
    r"\quad \operatorname{cov}(\delta t, \sigma) = -\frac{R \bar x}{S_{xx}}, \quad "
    r"\operatorname{cov} \delta t = \frac{I}{M} + s^2 R [\bar x]_\times P\, "
    r"[\bar x]_\times^{\mathsf T} R^{\mathsf T} + \frac{R \bar x \bar x^{\mathsf T} R^{\mathsf T}}"
    r"{S_{xx}},$$ $P = 2 (s G)^{-1}$, $G$ the Hessian at scale $1$ of the same $C$, which is $2 s "
    r"J$ at noise-free data.",
    concludes=(1, 2, 3, 5, 6, 7, 8, 9, 10),
    hypotheses=(SOLID_INVERSE, SIZED, SCALED, ROTATED),
    setting=(r"$m_i = 1/\sigma_i^2$ with the true $\sigma_i$; the noise is on the targets only.",),
    source="Gauss-Markov theory of the linearised problem",
    proof=proof,
    controls={
        "a lever without the scale": Mutation(
            at=1, proof=lambda: proof(lever=lambda turn, mean, _: lever_arm(turn, mean, 1))
        ),
        "a Hessian without the scale": Mutation(at=2, proof=lambda: proof(stiff=1)),
        "a variance 2 / Sxx of the scale": Mutation(at=5, proof=lambda: proof(spread=2)),
        "the covariance of a pose beside a given scale": Mutation(
            at=10, proof=lambda: proof(_without_spread)
        ),
    },
    not_claimed=r"Anything beyond first order. Of the symmetric scale nothing: noise in the target "
    r"makes it too large. Not defined where the optimum is not unique, or the scale $0$.",
    needs=("covariance", "scale_elimination", "hessian", "inertia"),
    runs=("certreg.registration.covariance.pose_covariance",),
    used_by=("certreg.registration.covariance.PoseCovariance",),
    not_in_coq="Nothing in Coq speaks of noise.",
)
