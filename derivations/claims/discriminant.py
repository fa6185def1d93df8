"""Claim: the characteristic polynomial of K in the invariants of C, and its discriminant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import sympy

from certreg.geometry.so3 import davenport_matrix
from certreg.objective.classification import Invariants, invariants

from ..algebra import identity
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, determinant, entry, matrix, scalar, vector
from ..table import eigenvalues

Decisive = Callable[[Sequence[Sequence[Any]]], Invariants]


def proof(
    davenport: Callable[[Any], Any] = davenport_matrix,
    decisive: Decisive = invariants,
    factor: int = 4096,
) -> Proof:
    """Coefficients first, then both discriminants, then what their zero means."""
    C, x = matrix("C"), scalar("x")
    found = decisive(C.tolist())
    yield from _invariants(C, found, decisive)
    K = Matrix(davenport(C.tolist()))
    yield identity(
        r"The characteristic polynomial of $K$ in the same invariants, for every $C$, all nine "
        r"entries symbols: $\chi_K(x) = \det(x I - K(C)) = "
        r"x^4 - 2 e_1 x^2 - 8 D\, x + e_1^2 - 4 e_2$.",
        determinant(x * sympy.eye(4) - K),
        x**4 - 2 * found.e1 * x**2 - 8 * found.det * x + found.e1**2 - 4 * found.e2,
    )
    free = replace(found, e1=entry("e", 1), e2=entry("e", 2), det=scalar("D"))
    e1, e2, det = free.e1, free.e2, free.det
    yield identity(
        r"The discriminant of a quartic $x^4 + p x^2 + q x + r$ is $16 p^4 r - 4 p^3 q^2 - "
        r"128 p^2 r^2 + 144 p q^2 r - 27 q^4 + 256 r^3$. With $p = -2 e_1$, $q = -8 D$, "
        r"$r = e_1^2 - 4 e_2$ it is $4096$ times $e_1^2 e_2^2 - 4 e_2^3 - 4 e_1^3 D^2 + "
        r"18 e_1 e_2 D^2 - 27 D^4$, the discriminant of the cubic above. The code computes just "
        r"this from its three invariants, in integers and without a root.",
        [_quartic(-2 * e1, -8 * det, e1**2 - 4 * e2), free.discriminant],
        [factor * _cubic(e1, e2, det**2), _cubic(e1, e2, det**2)],
    )
    yield from _roots()


def _invariants(C: Any, found: Invariants, decisive: Decisive) -> Proof:
    x, d = scalar("x"), vector("d")
    yield identity(
        r"The invariants that the code computes are the coefficients of the characteristic "
        r"polynomial of $C^{\mathsf T} C$: $\det(x I - C^{\mathsf T} C) = "
        r"x^3 - e_1 x^2 + e_2 x - D^2$, and $D = \det C$.",
        [determinant(x * sympy.eye(3) - C.T * C), determinant(C)],
        [x**3 - found.e1 * x**2 + found.e2 * x - found.det**2, found.det],
    )
    at_d = decisive(sympy.diag(*d).tolist())
    a, b, c = (entry**2 for entry in d)
    yield identity(
        r"In the diagonal frame they are the elementary symmetric functions of the $d_i^2$ and "
        r"$D = d_1 d_2 d_3$.",
        [at_d.e1, at_d.e2, at_d.det],
        [a + b + c, a * b + a * c + b * c, d[0] * d[1] * d[2]],
    )


def _roots() -> Proof:
    d = vector("d")
    levels, squares = eigenvalues(d), [entry**2 for entry in d]
    e1, e2 = sum(squares), sum(a * b for a, b in combinations(squares, 2))
    det = d[0] * d[1] * d[2]
    yield identity(
        r"These discriminants are the products of squared differences of roots: "
        r"$\prod_{i<j} (d_i^2 - d_j^2)^2$ for the cubic with the roots $d_1^2, d_2^2, d_3^2$.",
        _cubic(e1, e2, det**2),
        _differences(squares) ** 2,
    )
    yield identity(
        r"And for the quartic: the six differences of its roots $\lambda_1, \ldots, \lambda_4$ "
        r"come in three pairs with products $\pm 4 (d_i^2 - d_j^2)$, for instance "
        r"$(\lambda_1 - \lambda_2)(\lambda_3 - \lambda_4) = 4 (d_2^2 - d_3^2)$.",
        [
            (levels[0] - levels[1]) * (levels[2] - levels[3]),
            (levels[0] - levels[2]) * (levels[1] - levels[3]),
            (levels[0] - levels[3]) * (levels[1] - levels[2]),
        ],
        [
            4 * (squares[1] - squares[2]),
            4 * (squares[0] - squares[2]),
            4 * (squares[0] - squares[1]),
        ],
    )
    yield identity(
        r"Squared and multiplied: $\prod_{i<j} (\lambda_i - \lambda_j)^2 = "
        r"4^{6} \prod_{i<j} (d_i^2 - d_j^2)^2$, and $4^6 = 4096$. It is the discriminant of the "
        r"quartic with these coefficients, so it vanishes exactly where two of the $\lambda$ "
        r"coincide, and that is exactly where two of the $d_i^2$ do.",
        [_differences(levels), _quartic(-2 * e1, -8 * det, e1**2 - 4 * e2)],
        [64 * _differences(squares), 4096 * _differences(squares) ** 2],
    )


def _cubic(e1: Any, e2: Any, e3: Any) -> Any:
    """The discriminant of x^3 - e1 x^2 + e2 x - e3."""
    return e1**2 * e2**2 - 4 * e2**3 - 4 * e1**3 * e3 + 18 * e1 * e2 * e3 - 27 * e3**2


def _quartic(p: Any, q: Any, r: Any) -> Any:
    """The discriminant of x^4 + p x^2 + q x + r."""
    even = 16 * p**4 * r - 128 * p**2 * r**2 + 256 * r**3
    return even - 4 * p**3 * q**2 + 144 * p * q**2 * r - 27 * q**4


def _differences(roots: Sequence[Any]) -> Any:
    return sympy.prod(a - b for a, b in combinations(roots, 2))


@dataclass(frozen=True)
class _OneTermWrong(Invariants):
    """The discriminant with 17 for 18."""

    @property
    def discriminant(self) -> Any:
        """The shipped one less e1 e2 e3."""
        return super().discriminant - self.e1 * self.e2 * self.det**2


def _one_term_wrong(C: Sequence[Sequence[Any]]) -> Invariants:
    found = invariants(C)
    return _OneTermWrong(e1=found.e1, e2=found.e2, det=found.det)


def _sign_of_det_lost(C: Sequence[Sequence[Any]]) -> Invariants:
    found = invariants(C)
    return replace(found, det=-found.det)


CLAIM = Claim(
    name="discriminant",
    title="The discriminant",
    statement=r"Let $e_1, e_2$ be the first two elementary symmetric functions of the eigenvalues "
    r"of $C^{\mathsf T} C$ and $D = \det C$. Then $\chi_K(x) = x^4 - 2 e_1 x^2 - 8 D\, x + "
    r"e_1^2 - 4 e_2$ for every $C$, and $\operatorname{disc} \chi_K = "
    r"4096 \operatorname{disc} \chi_{C^{\mathsf T} C}$. Hence $K$ has four different eigenvalues "
    r"if and only if the three numbers $d_i^2$ are different, and that is decided by one integer.",
    concludes=(1, 3, 4, 7),
    source="ours; the coefficients of the quartic are in [Horn1987]",
    proof=proof,
    controls={
        "a factor of 256": Mutation(at=4, proof=lambda: proof(factor=256)),
        "17 for 18 in the discriminant": Mutation(
            at=4, proof=lambda: proof(decisive=_one_term_wrong)
        ),
        "the determinant with the other sign": Mutation(
            at=1, proof=lambda: proof(decisive=_sign_of_det_lost)
        ),
        "K of the transpose of C, negated": Mutation(
            at=3, proof=lambda: proof(davenport=lambda C: davenport_matrix((-Matrix(C).T).tolist()))
        ),
    },
    not_claimed=r"Which eigenvalues coincide where the discriminant vanishes: that is "
    r"`classification`.",
    needs=("davenport", "spectrum"),
    runs=(
        "certreg.objective.classification.invariants",
        "certreg.objective.classification.Invariants.discriminant",
    ),
    used_by=("certreg.verify.multiplicities",),
    coq=(
        "singular_values_symmetric_functions",
        "squares_are_eigenvalues_of_gram",
        "pattern_decided",
        "zpattern_real",
    ),
    not_in_coq=(
        "The characteristic polynomial of $K$ and the factor 4096, as identities of their "
        "own; what they are used for, the decision by signs, is proved there."
    ),
)
