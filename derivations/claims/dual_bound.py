"""Claim: a multiplier nu with nu I - K >= 0, from whatever solver, bounds the gap of any pose."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from certreg.geometry.so3 import davenport_matrix, quadratic_form
from certreg.verify import proves_level

from ..algebra import Square, facts, identity, nonnegative
from ..hypotheses import semidefinite
from ..hypothesis import Hypothesis, nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, matrix, quaternion, scalar, square
from ..shipped import UNIT, checked_matrix

NU = scalar("nu")
DIAGONAL = ((1, 0, 0), (0, 2, 0), (0, 0, 3))  # its K is diagonal, with the eigenvalues 6, 0, -2, -4


def dual_matrix(K: Any) -> Any:
    """The matrix nu I - K."""
    return NU * Matrix.eye(4) - K


def semidefinite_by(dual: Callable[[Any], Any]) -> Hypothesis:
    """The matrix is positive semidefinite, and so its form at p is not negative."""
    p, K = quaternion("p"), Matrix(davenport_matrix(matrix("C").tolist()))
    return nonnegative_by(
        r"$\nu I - K \succeq 0$.",
        (p.T * dual(K) * p)[0],
        further=lambda point: semidefinite(dual(K), point),
    )


DUAL = semidefinite_by(dual_matrix)


def _shipped(K: Any) -> Any:
    """The matrix that the checker decides on, for K over a unit."""
    return checked_matrix(K, quaternion(), NU * square(quaternion()), 0)


def proof(
    dual: Callable[[Any], Any] = dual_matrix,
    shipped: Callable[[Any], Any] = _shipped,
    nudge: int = 1,
) -> Proof:
    """Weak duality at a pose, the matrix that ships, and an example on either side."""
    K, q, p = Matrix(davenport_matrix(matrix("C").tolist())), quaternion(), quaternion("p")
    v_q, v_p = quadratic_form(K.tolist(), tuple(q)), quadratic_form(K.tolist(), tuple(p))
    form = (DUAL if dual is dual_matrix else semidefinite_by(dual))[0]
    yield nonnegative(
        r"For every quaternion $p$: $\nu |p|^2 - p^{\mathsf T} K p = p^{\mathsf T}(\nu I - K)\, p "
        r"\ge 0$. So $\nu$ is an upper bound of $p^{\mathsf T} K p / |p|^2 = "
        r"\operatorname{tr}(R(p)^{\mathsf T} C)$, the alignment, over all rotations.",
        NU * square(p) - v_p,
        [(form,)],
    )
    yield nonnegative(
        r"Let $R(q)$ be any rotation, $v = q^{\mathsf T} K q / |q|^2$ its alignment, and $R(p)$ "
        r"the best one. The objective at $R(q)$ exceeds the minimum by the gap "
        r"$2\,(v(p) - v)$, and $2\,(\nu - v)$ less the gap is, times $|q|^2 |p|^2$, equal to "
        r"$2\,|q|^2\, p^{\mathsf T}(\nu I - K)\, p \ge 0$. So the gap is at most $2\,(\nu - v)$; "
        r"less, if $\nu I - K$ is positive definite.",
        2 * (NU * square(q) - v_q) * square(p) - 2 * (square(q) * v_p - square(p) * v_q),
        [(2, Square(entry), form) for entry in q],
    )
    yield identity(
        r"With $\mu = 0$ the checker's `proves_level`, run on polynomials, decides "
        r"$|q|^2 (\nu I - \mathrm{unit}\, K_M)$, where it holds $K = \mathrm{unit}\, K_M$ and is "
        r"given $|q|^2 \nu$: $\nu I - K$ times $|q|^2$. The pose does not enter.",
        (p.T * shipped(K) * p)[0],
        square(q) * (NU * square(p) - UNIT * v_p),
    )
    yield from _either_side(nudge * Fraction(1, 2**80))


def _either_side(tiny: Fraction) -> Proof:
    yield identity(
        r"An example on either side of the truth: with $C = \operatorname{diag}(1, 2, 3)$ the "
        r"largest eigenvalue of $K$ is $6$,",
        davenport_matrix(DIAGONAL),
        [[6, 0, 0, 0], [0, -4, 0, 0], [0, 0, -2, 0], [0, 0, 0, 0]],
    )
    yield facts(
        r"and the checker proves the bound $\nu = 6 + 2^{-80}$, but not $\nu = 6$ (semidefinite is "
        r"not definite) and not $\nu = 6 - 2^{-80}$, which is false. A solver's number that is "
        r"wrong in its twenty-fifth digit is no bound, and is not taken for one.",
        [_proves(6 + tiny), _proves(Fraction(6)), _proves(6 - tiny)],
        [True, False, False],
    )


def _proves(nu: Fraction) -> bool:
    davenport = [list(row) for row in davenport_matrix(DIAGONAL)]
    return proves_level(davenport, nu.denominator, [1, 0, 0, 0], nu.numerator, 0)


CLAIM = Claim(
    name="dual_bound",
    title="A multiplier that is proved is a bound",
    statement=r"If $\nu I - K \succeq 0$, then $\operatorname{tr}(R^{\mathsf T} C) \le \nu$ for "
    r"every rotation $R$, and the objective at any rotation $R(q)$ exceeds the global minimum by "
    r"at most $2\,(\nu - v)$, $v = q^{\mathsf T} K q / |q|^2$. What the checker decides with $\mu "
    r"= 0$ is whether a positive multiple of $\nu I - K$ is positive definite; where $\nu$ is the "
    r"largest eigenvalue or less, it is not.",
    concludes=(1, 2, 3, 5),
    hypotheses=(DUAL,),
    setting=(r"Nothing is asked of where $\nu$ comes from: a solver, a guess, a rounded number.",),
    source="weak duality of the Shor relaxation; [Briales2017]",
    proof=proof,
    controls={
        "K - nu I is semidefinite": Mutation(
            at=1,
            proof=lambda: proof(dual=lambda K: -dual_matrix(K)),
            point={NU: -1, quaternion("p")[0]: 1},
        ),
        "the matrix of 2 nu": Mutation(
            at=1,
            proof=lambda: proof(dual=lambda K: dual_matrix(K) + NU * Matrix.eye(4)),
            point={NU: 2, quaternion("p")[0]: 1} | {matrix("C")[k, k]: 1 for k in range(3)},
        ),
        "the checker without its unit": Mutation(
            at=3,
            proof=lambda: proof(shipped=lambda K: NU * Matrix.eye(4) - K),
            point={NU: 1, UNIT: 2, quaternion("p")[0]: 1},
        ),
        "a bound below the eigenvalue": Mutation(at=5, proof=lambda: proof(nudge=-1)),
    },
    not_claimed=r"That the number a solver prints is a bound: it lies on either side of the "
    r"largest eigenvalue. It becomes one when it is rounded outwards and $\nu I - K \succ 0$ is "
    r"proved exactly.",
    needs=("davenport", "quaternions", "optimality_certificate", "elimination"),
    runs=("certreg.verify.proves_level",),
    used_by=(
        "certreg.certificate.isotropic.proves_multiplier",
        "certreg.certificate.isotropic.multiplier_gap",
    ),
    coq=(
        "dual_gap",
        "top_eigenvector",
        "largest_value",
    ),
    not_in_coq=r"The case $\nu I - K \succeq 0$ that is not definite.",
)
