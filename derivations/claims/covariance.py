"""Claim: to first order in the noise, the optimal pose has the covariance that ships.

Noise e_i on the targets only, independent, isotropic, of variance 1/m_i. The first-order errors
are sums of m_i B_i e_i, whose covariance is the moment of B B^T.
"""

from __future__ import annotations

from collections.abc import Callable

import sympy

from certreg.geometry.so3 import body_frame, davenport_matrix

from ..algebra import combination, contraction, identity, quoted
from ..hypotheses import SOLID
from ..hypothesis import Standing, invertible, vanishing
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import MomentCloud
from ..motion import State, spring_torque
from ..notation import Array, Matrix, diagonal, hat, matrix, scalar, symmetric, vector

MASS_INVERSE = scalar("Minv")
HEAVY = invertible("The mass $M$ is positive.", scalar("M"), MASS_INVERSE)
SOLID_INVERSE = invertible(SOLID, MomentCloud().inertia, symmetric("I"))
GRAM = symmetric("N")  # R^T R
ROTATED = vanishing(
    r"$N = R^{\mathsf T}R$ for a rotation $R$, so $N = I$.",
    GRAM - sympy.eye(3),
    standing=Standing.NOTATION,
    solves=tuple(sorted(GRAM.free_symbols, key=str)),
)
Lever = Callable[[Array, Array], Array]


def lever_arm(R: Array, mean: Array) -> Array:
    """R [mean]x, what a turn phi of the body does to the translation."""
    return R * hat(mean)


def proof(
    hessian_factor: int = 2,
    lever: Lever = lever_arm,
    covariance_factor: int = 2,
    mean_weight: int = 1,
) -> Proof:
    """Hessian and sensitivity at noise-free data, then the blocks of the covariance."""
    R, cloud = matrix("R"), MomentCloud()
    yield from _translation(R, cloud, lever, mean_weight)
    yield _noise_free(cloud, hessian_factor)
    noise_mean = vector("ebar")
    yield identity(
        r"The torque is linear in the targets: noise $e_i$ changes it by "
        r"$2 \sum_i m_i\, \tilde x_i \times R^{\mathsf T} e_i$, in which the mean $\bar e$ of the "
        r"noise drops out, as the centred points sum to zero.",
        cloud.total(2 * cloud.x.cross(R.T * (cloud.y + noise_mean))),
        spring_torque(State(R=R), cloud),
    )
    yield quoted(
        r"The gradient vanishes at the optimum, and its derivative $G = 2J$ in $\varphi$ is "
        r"invertible. So the optimum is a smooth function of the noise, and to first order "
        r"$G\, \varphi = 2 \sum_i m_i\, \tilde x_i \times R^{\mathsf T} e_i$: $\varphi$ is "
        r"$-G^{-1}$ times the derivative of the gradient in the noise. As $G = 2J$, $\varphi = "
        r"J^{-1} \sum_i m_i B_i e_i$ with $B_i = [\tilde x_i]_\times R^{\mathsf T}$.",
        theorem="the implicit function theorem",
        source="the implicit function theorem",
    )
    yield from _rotation_block(cloud, covariance_factor)
    yield identity(
        r"The mean $\bar e$ has no covariance with $\varphi$: $\sum_i m_i B_i = 0$, because the "
        r"centred points sum to zero. So, with $\delta t = \bar e + R[\bar x]_\times \varphi$, "
        r"$\operatorname{cov}(\delta t, \varphi) = R [\bar x]_\times P$ and $\operatorname{cov} "
        r"\delta t = I/M + R [\bar x]_\times P\, [\bar x]_\times^{\mathsf T} R^{\mathsf T}$. The "
        r"error of the estimate is minus $(\delta t, \varphi)$, and has the same covariance.",
        cloud.total(hat(cloud.x) * R.T),
        sympy.zeros(3),
    )
    yield from _shipped_inverse()


def _noise_free(cloud: MomentCloud, factor: int) -> Step:
    """The derivative of minus the torque along R exp([phi]x), at y = R x, as a bilinear form."""
    phi, u, gram = vector("phi"), vector("u"), GRAM
    slope = -cloud.total(cloud.x.cross(2 * hat(phi).T * gram * cloud.x))
    wanted = factor * cloud.inertia * phi
    return combination(
        r"The gradient of the objective in $\varphi$, along $R \exp([\varphi]_\times)$, is minus "
        r"the spring torque $2\sum_i m_i\, \tilde x_i \times R^{\mathsf T} \tilde y_i$. At "
        r"noise-free data, $\tilde y = R \tilde x$ with $R^{\mathsf T} R = I$, its derivative in "
        r"$\varphi$ contains $R$ as $N = R^{\mathsf T} R$ only, and with $N = I$ it is the Hessian "
        r"$G = 2J$; checked as $u^{\mathsf T} G \varphi$ for every $u$.",
        (u.T * (slope - wanted))[0],
        contraction(2 * hat(phi).T * hat(u) * cloud.source_scatter, ROTATED),
    )


def _rotation_block(cloud: MomentCloud, factor: int) -> Proof:
    u, w, inverse = vector("u"), vector("w"), symmetric("I")
    scatter = cloud.total(hat(cloud.x) * GRAM * hat(cloud.x).T)
    yield combination(
        r"The $e_i$ are independent with covariance $I/m_i$, so a sum $\sum_i m_i B_i e_i$ has the "
        r"covariance $\sum_i m_i^2 B_i B_i^{\mathsf T} / m_i$, the moment of $B B^{\mathsf T} "
        r"= [\tilde x]_\times R^{\mathsf T} R\, [\tilde x]_\times^{\mathsf T}$. "
        r"With $R^{\mathsf T} R = I$ it is $J$; checked as a bilinear form in $u$ and $w$.",
        (u.T * (scatter - cloud.inertia) * w)[0],
        contraction(hat(u) * cloud.source_scatter * hat(w).T, ROTATED),
    )
    yield combination(
        r"Hence $\operatorname{cov} \varphi = J^{-1} J J^{-1} = J^{-1}$,",
        (u.T * (inverse * cloud.inertia * inverse - inverse) * w)[0],
        contraction(inverse * u * w.T, SOLID_INVERSE),
    )
    yield combination(
        r"which is $P = 2 G^{-1}$: $G P = 2 J J^{-1} = 2 I$.",
        (u.T * (2 * cloud.inertia * inverse - factor * sympy.eye(3)) * w)[0],
        contraction(2 * u * w.T, SOLID_INVERSE),
    )


def _translation(R: Array, cloud: MomentCloud, lever: Lever, weight: int) -> Proof:
    mean, phi = vector("xbar"), vector("phi")
    yield identity(
        r"The best translation is $t = \bar y - R \bar x$. Noise that turns the optimum by "
        r"$\varphi$ in the body's frame moves it, to first order, by "
        r"$\delta t = \bar e - R [\varphi]_\times \bar x = \bar e + R [\bar x]_\times \varphi$.",
        -R * hat(phi) * mean,
        lever(R, mean) * phi,
    )
    yield combination(
        r"The mean $\bar e = \sum_i m_i e_i / M$ has the covariance $M^{-2} \sum_i m_i = 1/M$ "
        r"times $I$.",
        weight * cloud.total(MASS_INVERSE**2) - MASS_INVERSE,
        [(MASS_INVERSE, HEAVY[0])],
    )


def _shipped_inverse() -> Proof:
    d = diagonal("d")
    values = [davenport_matrix(d.tolist())[k][k] for k in range(4)]
    L = Matrix(body_frame((1, 0, 0, 0)))
    axes = [L.T * sympy.eye(4).col(k) for k in (1, 2, 3)]
    yield identity(
        r"The inverse is $G^{-1} = \sum_k u_k u_k^{\mathsf T} / (\lambda_1 - \lambda_k)$, "
        r"$u_k = L(q)^{\mathsf T} q_k$. In the frame in which $C$ is diagonal and the optimum is "
        r"$R = I$, the $u_k$ are the unit vectors and $G = 2 \operatorname{tr}(R^{\mathsf T} C) I "
        r"- R^{\mathsf T} C - C^{\mathsf T} R = \sum_k (\lambda_1 - \lambda_k)\, u_k "
        r"u_k^{\mathsf T}$: the same axes, inverse numbers.",
        [Matrix.hstack(*axes), 2 * d.trace() * sympy.eye(3) - 2 * d],
        [
            sympy.eye(3),
            sum(
                ((values[0] - values[k]) * u * u.T for k, u in enumerate(axes, start=1)),
                start=sympy.zeros(3),
            ),
        ],
    )


CLAIM = Claim(
    name="covariance",
    title="The covariance of the optimal pose",
    statement=r"Let the targets carry independent Gaussian noise of covariance $I/m_i$, the "
    r"sources none. To first order in the noise, the optimum is at $R \exp([\varphi]_\times)$, "
    r"$t + \delta t$ with $$\operatorname{cov} \varphi = P, \quad \operatorname{cov}(\delta t, "
    r"\varphi) = R [\bar x]_\times P, \quad \operatorname{cov} \delta t = \frac{I}{M} + "
    r"R [\bar x]_\times P\, [\bar x]_\times^{\mathsf T} R^{\mathsf T}, \qquad P = 2 G^{-1},$$ "
    r"$G$ the Hessian of the objective, which is $2J$ at noise-free data.",
    concludes=(1, 2, 3, 6, 7, 8, 9, 10),
    hypotheses=(HEAVY, SOLID_INVERSE, ROTATED),
    setting=(r"$m_i = 1/\sigma_i^2$ with the true $\sigma_i$; the noise is on the targets only.",),
    source="Gauss-Markov theory of the linearised problem",
    proof=proof,
    controls={
        "a Hessian G = J": Mutation(at=3, proof=lambda: proof(hessian_factor=1)),
        "P = G^-1": Mutation(at=8, proof=lambda: proof(covariance_factor=1)),
        "the lever with the other sign": Mutation(
            at=1, proof=lambda: proof(lever=lambda R, x: -lever_arm(R, x))
        ),
        "the lever in the wrong frame": Mutation(
            at=1, proof=lambda: proof(lever=lambda R, x: hat(x) * R)
        ),
        "cov of the mean 2/M": Mutation(at=2, proof=lambda: proof(mean_weight=2)),
    },
    not_claimed=r"Anything beyond first order: with residuals that are not small the shipped $G$, "
    r"taken at the data as they are, differs from $2J$ by terms of the size of the noise. Not "
    r"defined where the optimum is not unique.",
    needs=("total_torque", "euler_poincare", "hessian", "inertia", "translation_gap"),
    runs=(
        "certreg.geometry.so3.davenport_matrix",
        "certreg.geometry.so3.body_frame",
    ),
    used_by=(
        "certreg.registration.covariance.pose_covariance",
        "certreg.registration.covariance.PoseCovariance",
    ),
    not_in_coq="Nothing in Coq speaks of noise.",
)
