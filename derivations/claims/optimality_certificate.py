"""Claim: one positive definite 4x4 matrix bounds gap and angle and proves the optimum unique.

Everything is multiplied by norms, so that it is about polynomials: q is the certificate's integer
quaternion, p any other quaternion, neither of norm one.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import sympy

from certreg.geometry.so3 import body_frame, davenport_matrix, dot, quadratic_form

from ..algebra import Square, combination, contraction, identity, positive
from ..hypotheses import ROTATION, SPECTRAL, definite, semidefinite
from ..hypothesis import Hypothesis, Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import MomentCloud
from ..notation import (
    Matrix,
    entry,
    inner,
    matrix,
    quaternion,
    rotation,
    scalar,
    square,
)
from ..shipped import UNIT, checked_davenport, checked_matrix

MU, DELTA = scalar("mu"), scalar("delta")
LEVEL = scalar("level")
Certificate = Callable[[Any, Any], Any]


def symmetric_four(name: str) -> Any:
    """A symmetric 4x4 matrix of ten symbols."""
    return Matrix(4, 4, lambda i, j: entry(name, min(i, j), max(i, j)))


def certificate_matrix(K: Any, q: Any) -> Any:
    """|q|^2 A = [q^T K q + (delta - mu) |q|^2] I - |q|^2 K + mu q q^T, a polynomial in q."""
    norm = square(q)
    level = quadratic_form(K.tolist(), tuple(q)) + (DELTA - MU) * norm
    return level * Matrix.eye(4) - norm * K + MU * q * q.T


K_OF, Q_OF, P_OF = symmetric_four("K"), quaternion(), quaternion("p")


def _values() -> tuple[Any, Any]:
    """q^T K q and p^T K p."""
    rows = K_OF.tolist()
    return quadratic_form(rows, tuple(Q_OF)), quadratic_form(rows, tuple(P_OF))


def _better() -> Any:
    """|q|^2 p^T K p - |p|^2 q^T K q."""
    v_q, v_p = _values()
    return square(Q_OF) * v_p - square(P_OF) * v_q


def definite_by(built: Certificate) -> Hypothesis:
    """The matrix of a certificate is positive definite; at p, which is not zero, so is its form."""
    A = built(K_OF, Q_OF)
    return positive_by(
        r"$A \succ 0$, and so $p^{\mathsf T} A\, p > 0$ for $p \ne 0$.",
        (P_OF.T * A * P_OF)[0],
        further=lambda point: definite(A, point),
    )


def _is_optimal(point: Any) -> bool:
    """Whether |p|^2 times the largest eigenvalue of K is p^T K p."""
    return semidefinite(_values()[1] * Matrix.eye(4) - square(P_OF) * K_OF, point)


DEFINITE = definite_by(certificate_matrix)
NOT_NEGATIVE = nonnegative_by(
    r"$\mu \ge 0$.",
    MU,
    example={MU: -1, DELTA: 1, Q_OF[0]: 1, P_OF[1]: 1, K_OF[1, 1]: Fraction(3, 2)},
)
OPTIMAL = nonnegative_by(
    r"For (2): $R(p)$ is a global optimum.",
    _better(),
    standing=Standing.CASE,
    further=_is_optimal,
    example={DELTA: 1, MU: 2, Q_OF[0]: 1, P_OF[1]: 1} | {K_OF[k, k]: -5 for k in (1, 2, 3)},
)
UNIQUE_BY = nonnegative_by(
    r"For (3): $\delta \leq \mu$.",
    MU - DELTA,
    standing=Standing.CASE,
    example={DELTA: 2, Q_OF[0]: 1, P_OF[1]: 1, K_OF[1, 1]: 1},
)


def shipped_matrix(K: Any, q: Any) -> Any:
    """The matrix that the checker decides on, for K over a unit."""
    return checked_matrix(K, q, LEVEL * square(q), MU)


def proof(
    built: Certificate = certificate_matrix,
    decided: Certificate = shipped_matrix,
    *,
    gap: Fraction = Fraction(2),
    angle: Fraction = Fraction(1),
    trace: int = 4,
) -> Proof:
    """Gap, angle, uniqueness, and the matrix that ships."""
    K, q, p = K_OF, Q_OF, P_OF
    n, m = square(q), square(p)
    across = Matrix(body_frame(tuple(q))).T * p
    along = dot(tuple(q), tuple(p))
    given = DEFINITE if built is certificate_matrix else definite_by(built)
    cloud, R = MomentCloud(), matrix("R")
    yield combination(
        r"The objective at a rotation $R$ and its best translation is the moment of $|\tilde y - "
        r"R\tilde x|^2$, the sum over the points of $m$ times it. That is $\operatorname{tr} T_2 + "
        r"\operatorname{tr} S_2 - 2 \operatorname{tr}(R^{\mathsf T} C)$, as $R^{\mathsf T} R = I$, "
        r"with the scatters $S_2 = \sum_i m_i \tilde x_i \tilde x_i^{\mathsf T}$ and $T_2 = \sum_i "
        r"m_i \tilde y_i \tilde y_i^{\mathsf T}$. With $\operatorname{tr}(R(p)^{\mathsf T} C) = "
        r"p^{\mathsf T} K p / |p|^2 = v(p)$ the objective at $R(q)$ exceeds that at $R(p)$ by "
        r"$2\,(v(p) - v(q))$. Of $K$ all that follows uses that it is symmetric.",
        cloud.total(square(cloud.y - R * cloud.x))
        - cloud.target_scatter.trace()
        - cloud.source_scatter.trace()
        + 2 * inner(R, cloud.cross),
        contraction(cloud.source_scatter, ROTATION),
    )
    yield identity(
        r"$|q|^2 |p|^2 = (q \cdot p)^2 + |L(q)^{\mathsf T} p|^2$: what $p$ has along $q$, and "
        r"what it has across.",
        n * m,
        along**2 + square(across),
    )
    yield from _bounds(given, sympy.Rational(gap), sympy.Rational(angle), trace)
    yield from _uniqueness(given)
    yield identity(
        r"The checker builds $K$ by a formula of its own; it is the same matrix.",
        checked_davenport(matrix("C")),
        davenport_matrix(matrix("C").tolist()),
    )
    yield _decided(decided(K, q), (K, q, p))


def _bounds(given: Hypothesis, gap: Any, angle: Any, trace: int) -> Proof:
    q, p = Q_OF, P_OF
    n, m = square(q), square(p)
    across = Matrix(body_frame(tuple(q))).T * p
    yield positive(
        r"**Gap.** With $A \succ 0$ and $\mu \ge 0$: the bound $2\delta$ less the gap "
        r"$2\,(v(p) - v(q))$, times $|q|^2|p|^2$, is "
        r"$2\, p^{\mathsf T}(|q|^2 A)\, p + 2 \mu\, |L(q)^{\mathsf T} p|^2$. The first summand is "
        r"positive for every $p \ne 0$, so the objective at $R(q)$ exceeds that at every rotation, "
        r"the best one too, by less than $2\delta$.",
        gap * DELTA * n * m - 2 * _better(),
        [(2, given[0]), *((2, NOT_NEGATIVE[0], Square(c)) for c in across)],
    )
    yield identity(
        r"**Angle.** The trace of $R(q)^{\mathsf T} R(p)$ is $1 + 2 \cos\theta = "
        r"3 - 4 \sin^2(\theta/2)$, and it is $3 - 4\, |L(q)^{\mathsf T} p|^2 / (|q|^2 |p|^2)$. So "
        r"the angle between the rotations has "
        r"$\sin^2(\theta/2) = |L(q)^{\mathsf T} p|^2 / (|q|^2 |p|^2)$.",
        inner(rotation(q), rotation(p)),
        3 * n * m - trace * square(across),
    )
    yield positive(
        r"Let $R(p)$ be a global optimum, so that $v(p) \ge v(q)$. Then "
        r"$\delta - \mu \sin^2(\theta/2)$, times $|q|^2|p|^2$, is $p^{\mathsf T}(|q|^2 A)\, p + "
        r"|q|^2|p|^2\,(v(p) - v(q))$, again positive. So $\sin^2(\theta/2) < \delta/\mu$ if "
        r"$\mu > 0$, and this holds of every global optimum.",
        angle * DELTA * n * m - MU * square(across),
        [(given[0],), (OPTIMAL[0],)],
    )


def _uniqueness(given: Hypothesis) -> Proof:
    q, p = Q_OF, P_OF
    v_q, v_p = _values()
    along = dot(tuple(q), tuple(p))
    first, second = quaternion("a"), quaternion("b")
    combined = dot(tuple(q), tuple(second)) * first - dot(tuple(q), tuple(first)) * second
    yield identity(
        r"**Uniqueness.** Suppose there are two global optima $R(a) \ne R(b)$. Both quaternions "
        r"are eigenvectors of the largest eigenvalue of $K$, linearly independent, and so is every "
        r"combination of them other than zero a global optimum. Either both are orthogonal to $q$, "
        r"or $p = (q \cdot b)\, a - (q \cdot a)\, b$ is not zero, and it is orthogonal to $q$. So "
        r"there is a global optimum $R(p)$ with $q \cdot p = 0$, half a turn away from $R(q)$.",
        dot(tuple(q), tuple(combined)),
        0,
    )
    yield positive(
        r"But across $q$ nothing is optimal if $\delta \le \mu$: "
        r"$|q|^2|p|^2\, (v(q) - v(p)) + \mu\,(q \cdot p)^2$ is $p^{\mathsf T}(|q|^2 A)\, p + "
        r"(\mu - \delta)\, |q|^2 |p|^2$, positive. With $q \cdot p = 0$ it says $v(p) < v(q)$, so "
        r"$R(p)$ is not optimal. Hence the global optimum is unique.",
        square(p) * v_q - square(q) * v_p + MU * along**2,
        [
            (given[0],),
            *((UNIQUE_BY[0], Square(a * b)) for a in q for b in p),
        ],
    )


def _decided(found: Any, frame: tuple[Any, Any, Any]) -> Step:
    """The matrix that ships is |q|^2 A with unit K for K."""
    K, q, p = frame
    n, m = square(q), square(p)
    rank_one = MU * dot(tuple(q), tuple(p)) ** 2
    return identity(
        r"`certreg.verify.proves_level`, run on polynomials, hands to the elimination a symmetric "
        r"matrix; here is its quadratic form in $p$. The checker holds $K$ as integers $K_M$ over "
        r"a unit $> 0$ (it works with $M K$), and the level $\ell$ times $|q|^2$. The matrix is "
        r"$\ell\, |q|^2 I - |q|^2\, \mathrm{unit}\, K_M + \mu\, q q^{\mathsf T}$: $|q|^2 A$ at the "
        r"level $\ell = v + \delta - \mu$, without denominators, and the elimination decides "
        r"exactly whether it is positive definite.",
        (p.T * found * p)[0],
        LEVEL * n * m - n * UNIT * quadratic_form(K.tolist(), tuple(p)) + rank_one,
    )


def _rank_one_doubled(K: Any, q: Any) -> Any:
    return certificate_matrix(K, q) + MU * q * q.T


def _level_without_mu(K: Any, q: Any) -> Any:
    return certificate_matrix(K, q) + MU * square(q) * Matrix.eye(4)


def _decided_with_the_other_sign(K: Any, q: Any) -> Any:
    return shipped_matrix(-K, q)


CLAIM = Claim(
    name="optimality_certificate",
    title="The optimality certificate",
    statement=r"Let $q \ne 0$ be a quaternion, $\delta > 0$, $\mu \ge 0$, "
    r"$v = q^{\mathsf T} K q / |q|^2$, and let "
    r"$$A = (v + \delta - \mu)\, I - K + \mu\, \frac{q q^{\mathsf T}}{|q|^2}$$ be positive "
    r"definite. Then for every global optimum $R^*$: "
    r"(1) the objective at $R(q)$ exceeds the minimum by less than $2\delta$; "
    r"(2) $\sin^2(\theta/2) < \delta/\mu$ if $\mu > 0$, with $\theta$ the angle between $R(q)$ and "
    r"$R^*$, the trace of $R(q)^{\mathsf T} R^*$ being $3 - 4\sin^2(\theta/2)$; (3) if $\delta "
    r"\le \mu$, there is only one global optimum. What the checker decides "
    r"is the definiteness of a positive multiple of $A$.",
    concludes=(1, 3, 4, 5, 7, 8, 9),
    hypotheses=(ROTATION, DEFINITE, NOT_NEGATIVE, OPTIMAL, UNIQUE_BY),
    setting=(
        r"The objective is minimised over the translation; see `translation_gap` for another.",
    ),
    source="Shor's dual of [Horn1987]'s eigenvalue problem; the bounds are elementary",
    proof=proof,
    witness={Q_OF[0]: 1, P_OF[0]: 1, DELTA: 1} | dict.fromkeys(matrix("R").diagonal(), 1),
    controls={
        "a gap below delta": Mutation(
            at=3,
            proof=lambda: proof(gap=Fraction(1)),
            point={DELTA: Fraction(3, 2), Q_OF[0]: 1, P_OF[1]: 1, K_OF[1, 1]: 1},
        ),
        "A at the level v + delta": Mutation(
            at=3,
            proof=lambda: proof(built=_level_without_mu),
            point={DELTA: 1, MU: 4, Q_OF[0]: 1, P_OF[0]: 1, P_OF[1]: 1, K_OF[0, 1]: 2},
        ),
        "A with twice its rank-one term": Mutation(
            at=3,
            proof=lambda: proof(built=_rank_one_doubled),
            point={DELTA: 1, MU: 1, Q_OF[0]: 1, P_OF[0]: 2, P_OF[1]: 1, K_OF[0, 1]: 4}
            | dict.fromkeys((K_OF[k, k] for k in (1, 2, 3)), -10),
        ),
        "sin^2(theta/2) below delta / (8 mu)": Mutation(
            at=5,
            proof=lambda: proof(angle=Fraction(1, 8)),
            point={DELTA: 15, MU: 60, Q_OF[0]: 1, P_OF[0]: 4, P_OF[1]: 1, K_OF[0, 1]: 32}
            | dict.fromkeys((K_OF[k, k] for k in (1, 2, 3)), -120),
        ),
        "the trace as 3 - 2 sin^2": Mutation(at=4, proof=lambda: proof(trace=2)),
        "the checker with K of the other sign": Mutation(
            at=9, proof=lambda: proof(decided=_decided_with_the_other_sign)
        ),
    },
    not_claimed=r"That a matrix which is not positive definite says anything about the pose: the "
    r"checker then answers *not proved*, whether the pose is bad or the numbers "
    r"$\mu, \delta$ are. Nor that the correspondences are right.",
    needs=("davenport", "quaternions", "eigenvectors", "maximum_likelihood", "elimination"),
    standard=(SPECTRAL,),
    runs=(
        "certreg.verify.proves_level",
        "certreg.verify.davenport",
    ),
    used_by=(
        "certreg.certificate.isotropic.proves_optimality",
        "certreg.certificate.bounds.sin2_half_angle_between",
    ),
    coq=(
        "certified_gap",
        "certified_angle",
        "certified_unique",
        "checker_sound",
    ),
    not_in_coq=(
        "Anything about `certreg/verify.py`: what Coq proves correct is a second checker, "
        "which `certreg verify --coq` runs. Floating point occurs in neither. That a "
        "certificate was read and copied into Coq rightly."
    ),
)
