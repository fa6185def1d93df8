"""Claim: as many growing modes as the Hessian has negative eigenvalues."""

from __future__ import annotations

from collections.abc import Callable

import sympy

from certreg.objective.classification import Classification

from ..algebra import (
    Square,
    combination,
    contraction,
    facts,
    identity,
    modulo,
    nonnegative,
    positive,
)
from ..hypotheses import DAMPED, SOLID, SPECTRAL, rotation_of
from ..hypothesis import (
    Standing,
    equation,
    invertible,
    nonnegative_by,
    nonzero,
    positive_by,
    vanishing,
)
from ..kernel import Claim, Mutation, Proof, Step
from ..linearisation import hessian
from ..moments import inertia_of
from ..motion import Body, State
from ..notation import Matrix, diagonal, inner, matrix, scalar, vector
from ..table import ROWS, eigenvalues, sign, singular_values

Counted = Callable[[Classification], tuple[int, ...] | None]
MU = scalar("mu")
NORMALISER, NORMALISER_INVERSE = matrix("N"), matrix("P")
SOLID_FACTOR = invertible(SOLID, NORMALISER.T, NORMALISER_INVERSE.T)
Y = matrix("Y")
ORTHONORMAL = vanishing(
    r"$Y$ is orthogonal, $YY^{\mathsf T} = I$: eigenvectors of $T^{-1}GT^{-\mathsf T}$.",
    Y * Y.T - sympy.eye(3),
    prepare=rotation_of("Y").prepare,
)
NEGATIVE = positive_by("$g_i < 0$.", [-g for g in vector("g")], standing=Standing.CASE)
ALONG = nonzero(
    "$y_i \\ne 0$ for one $i$.",
    vector("y"),
    standing=Standing.CASE,
    example=dict.fromkeys(vector("g"), -1),
)
REST = nonnegative_by(r"$g_i \geq 0$.", list(vector("g")), standing=Standing.CASE)
NOT_DECAYING = nonnegative_by(
    r"A root with real part $a \ge 0$.", scalar("a"), standing=Standing.CASE
)
GROWING = positive_by("A root with real part $a > 0$.", scalar("a"), standing=Standing.CASE)
SWINGING = invertible(r"A root with imaginary part $b \ne 0$.", scalar("b"), standing=Standing.CASE)
W_ROOT = equation(
    r"$w^2 = \mu^2 - 4g$.",
    scalar("w"),
    2,
    MU**2 - 4 * scalar("g"),
    standing=Standing.CASE,
    solves=(scalar("g"),),
)
SYMMETRIC = vanishing(
    r"For collinear points, at an equilibrium: $u n^{\mathsf T}$ is symmetric.",
    (vector("u") * vector("n").T).T - vector("u") * vector("n").T,
    standing=Standing.CASE,
    solves=tuple(vector("u")),
)


def unstable(kind: Classification) -> tuple[int, ...] | None:
    """What the shipped classification says."""
    return kind.unstable


def proof(
    counted: Counted = unstable, *, damping: int = 1, transposed: bool = False, pencil: int = 1
) -> Proof:
    """Three damped springs instead of a pencil, Sylvester's law, the roots of one spring."""
    yield from _diagonalisation(transposed=transposed, pencil=pencil)
    yield from _sylvester(transposed=transposed)
    yield from _no_other_root(damping)
    yield _one_growing_root(damping)
    yield _count(counted)
    yield from _collinear()


def _diagonalisation(*, transposed: bool, pencil: int) -> Proof:
    T, a, b = matrix("T"), vector("a"), vector("b")
    yield combination(
        r"As $J \succ 0$, it is $J = T T^{\mathsf T}$ with $T$ invertible (Cholesky). The matrix "
        r"$T^{-1} G T^{-\mathsf T}$ is symmetric, so it is $Y D Y^{\mathsf T}$ with $Y$ orthogonal "
        r"and $D = \operatorname{diag}(g_1, g_2, g_3)$ real. Let $N = T Y$. Then $G = "
        r"T (Y D Y^{\mathsf T}) T^{\mathsf T} = N D N^{\mathsf T}$, and $J = N N^{\mathsf T}$: the "
        r"difference of $N N^{\mathsf T}$ and $T T^{\mathsf T}$, contracted with any $a$ and $b$, "
        r"is a combination of the entries of $Y Y^{\mathsf T} - I$.",
        inner(a, (T * Y * (T * Y).T - T * T.T) * b),
        contraction((T.T * a) * (T.T * b).T, ORTHONORMAL),
    )
    N, D, s = matrix("N"), diagonal("g"), scalar("sigma")
    G = N.T * D * N if transposed else N * D * N.T
    yield identity(
        r"So $\sigma J + G = N (\sigma I + D) N^{\mathsf T}$, and the determinant is "
        r"$\det(N)^2 \prod_i (\sigma + g_i)$ with $\det(N)^2 = \det J > 0$. The $g_i$ are the "
        r"eigenvalues of the pencil $(G, J)$, all real.",
        s * N * N.T + pencil * G,
        N * (s * sympy.eye(3) + D) * N.T,
    )
    inner_form = s * sympy.eye(3) + D
    yield combination(
        r"$N$ is invertible: with $P = N^{-1}$ it is $(\sigma J + G)\, P^{\mathsf T} = N (\sigma I "
        r"+ D)$, so that the columns of $P^{\mathsf T}$ are the eigenvectors of the pencil; for "
        r"all $a$ and $b$ a combination of the entries of $N^{\mathsf T} P^{\mathsf T} - I$.",
        inner(a, (N * inner_form * N.T * NORMALISER_INVERSE.T - N * inner_form) * b),
        contraction(inner_form * N.T * a * b.T, SOLID_FACTOR),
    )
    root, g = scalar("lambda"), vector("g")
    yield identity(
        r"With $\sigma = \lambda(\lambda + \mu)$ the characteristic polynomial of the intrinsic "
        r"Jacobian (claim `characteristic_polynomial`) falls into six quadratics: "
        r"$\chi_{12}(\lambda) = (\lambda^2 + \mu\lambda + 2)^3 \prod_i (\lambda^2 + \mu\lambda + "
        r"g_i)$. Six damped springs, of which three may push.",
        [root * (root + MU) + entry for entry in g],
        [root**2 + MU * root + entry for entry in g],
    )


def _sylvester(*, transposed: bool) -> Proof:
    N, D, phi = matrix("N"), diagonal("g"), vector("phi")
    y = N * phi if transposed else N.T * phi
    yield identity(
        r"As many $g_i$ are negative, zero and positive as eigenvalues of $G$ are (Sylvester's "
        r"law of inertia). With the coordinates $y = N^{\mathsf T} \varphi$, $\varphi^{\mathsf T} "
        r"G \varphi = \sum_i g_i y_i^2$.",
        inner(phi, N * D * N.T * phi),
        sum((g * entry**2 for g, entry in zip(vector("g"), y, strict=True)), start=0),
    )
    pairs = list(zip(vector("g"), vector("y"), strict=True))
    yield positive(
        r"Where only the $y_i$ of the $g_i < 0$ are not zero, $G$ is negative definite, since "
        r"$-\varphi^{\mathsf T} G \varphi$ is a sum of terms $(-g_i)\, y_i^2$. That is a subspace "
        r"with as many dimensions as there are negative $g_i$.",
        -sum((g * y**2 for g, y in pairs), start=sympy.Integer(0)),
        [[g, Square(y)] for g, y in zip(NEGATIVE.parts, ALONG.parts, strict=True)],
    )
    yield nonnegative(
        r"Where they are all zero, $\varphi^{\mathsf T} G \varphi \geq 0$. A subspace on which $G$ "
        r"is negative definite meets this one only in $0$, so it has no more dimensions than there "
        r"are negative $g_i$. Hence the largest dimension of such a subspace, the index of $G$, is "
        r"the number of negative $g_i$; and by the same two steps with orthonormal eigenvectors of "
        r"$G$ for the columns of $N$ it is the number of negative eigenvalues of $G$. The same "
        r"for $-G$ gives the positive ones, and what is left are the zeros.",
        sum((g * y**2 for g, y in pairs), start=sympy.Integer(0)),
        [[g, Square(y)] for g, y in zip(REST.parts, vector("y"), strict=True)],
    )


def _no_other_root(damping: int) -> Proof:
    a, b, g = (scalar(name) for name in ("a", "b", "g"))
    mu = damping * MU
    s = Matrix([[a, -b], [b, a]])
    real, imaginary = a**2 - b**2 + mu * a + g, b * (2 * a + mu)
    yield identity(
        r"One spring. At $s = a + ib$ the real part of $s^2 + \mu s + g$ is $a^2 - b^2 + \mu a + "
        r"g$ and the imaginary part is $b\, (2a + \mu)$; with matrices $\begin{pmatrix}a & -b\\ b "
        r"& a\end{pmatrix}$ for complex numbers.",
        s * s + mu * s + g * sympy.eye(2),
        [[real, -imaginary], [imaginary, real]],
    )
    yield positive(
        r"Let $s$ be a root with $a \geq 0$. If $b \ne 0$, then $b \cdot b\,(2a + \mu)$, which is "
        r"$2 a b^2 + \mu b^2$, is positive as $\mu > 0$, and not zero: a root that does not decay "
        r"is real. There are no growing oscillations.",
        b * imaginary,
        [[2, NOT_DECAYING[0], Square(SWINGING[0])], [DAMPED[0], Square(SWINGING[0])]],
    )
    yield nonnegative(
        r"Then $a^2 + \mu a + g = 0$, so that $-g = a^2 + \mu a \geq 0$,",
        (real - g).subs(b, 0),
        [[Square(a)], [DAMPED[0], NOT_DECAYING[0]]],
    )
    yield positive(
        r"and it is positive if $a > 0$. Hence, if $g > 0$, both roots have negative real parts; "
        r"if $g = 0$, none has a positive one, and the only one with the real part zero is $s = "
        r"0$. In particular the translation, $g = 2$, has only decaying modes.",
        (real - g).subs(b, 0),
        [[Square(GROWING[0])], [DAMPED[0], GROWING[0]]],
    )


def _one_growing_root(damping: int) -> Step:
    s, w, g = scalar("s"), scalar("w"), scalar("g")
    mu = damping * MU
    return modulo(
        r"If $g < 0$, then $w = \sqrt{\mu^2 - 4g}$ is real and $s^2 + \mu s + g = "
        r"\bigl(s - \tfrac{1}{2}(w - \mu)\bigr) \bigl(s + \tfrac{1}{2}(w + \mu)\bigr)$. Since "
        r"$(w - \mu)(w + \mu) = -4g > 0$ and $w + \mu > 0$, also $w - \mu > 0$: one root is "
        r"positive, the other negative. If $g = 0$, then $w = \mu$, and the roots are $0$ and "
        r"$-\mu$.",
        [(s - (w - MU) / 2) * (s + (w + MU) / 2), (w - MU) * (w + MU)],
        [s**2 + mu * s + g, -4 * g],
        [W_ROOT],
    )


def _count(counted: Counted) -> Step:
    found, expected = [], []
    for row in ROWS:
        kind = Classification(pattern=row.pattern, inertia_definite=True, ambiguity=None)
        levels = eigenvalues(singular_values(row.gaps))
        starts = [sum(row.pattern[:k]) for k in range(len(row.pattern))]
        found.append(counted(kind))
        expected.append(tuple([sign(levels[j] - x) for x in levels].count(-1) for j in starts))
    return facts(
        r"So each negative $g_i$ contributes one positive eigenvalue, each $g_i = 0$ one zero "
        r"eigenvalue, and everything else decays. Counted with multiplicities the intrinsic "
        r"Jacobian has exactly as many eigenvalues with positive real part as $G$ has negative "
        r"eigenvalues. At the equilibria of the eigenvalue $\lambda_j$ of $K$ these are the "
        r"$\lambda_j - \lambda_k < 0$ (claim `hessian`), one for each eigenvalue above. In each of "
        r"the eight rows of the table the code that ships counts the same.",
        found,
        expected,
    )


def _collinear() -> Proof:
    n, u, a, s = vector("n"), vector("u"), vector("a"), scalar("s")
    yield identity(
        r"Why $J \succ 0$ is needed: if the source lies on a line, $S_2 = s\, n n^{\mathsf T}$, "
        r"then $J n = 0$. A turn about the line moves no point.",
        inertia_of(s * n * n.T) * n,
        sympy.zeros(3, 1),
    )
    A = u * n.T
    yield combination(
        r"And $C$ is a column times $n^{\mathsf T}$, $R^{\mathsf T} C = u n^{\mathsf T}$. Where "
        r"that is symmetric, $G n = 2 \operatorname{tr}(A) n - A n - A^{\mathsf T} n = 0$ as well: "
        r"the pencil $(G, J)$ is singular, $\det(\sigma J + G) = 0$ for every $\sigma$, and there "
        r"is no linearised dynamics to count eigenvalues of.",
        inner(a, hessian(State(R=sympy.eye(3)), Body(cross=A)) * n),
        contraction(a * n.T, SYMMETRIC),
    )


def _one_too_many(kind: Classification) -> tuple[int, ...]:
    return tuple(index + 1 for index in kind.indices)


CLAIM = Claim(
    name="unstable_count",
    title="As many growing modes as the index",
    statement=r"Let $J \succ 0$ and $\mu > 0$. There is an invertible $N$ with $J = N N^{\mathsf "
    r"T}$ and $G = N D N^{\mathsf T}$, $D$ diagonal. At every equilibrium the linearised dynamics "
    r"has exactly as many eigenvalues with positive real part as the Hessian $G$ has negative "
    r"eigenvalues, all of them real, and as many zero eigenvalues as $G$ has; all others have "
    r"negative real parts. At the equilibria of the eigenvalue $\lambda_j$ of $K$ that is the "
    r"number of eigenvalues of $K$ above $\lambda_j$.",
    concludes=(1, 2, 3, 5, 6, 7, 9, 10, 11, 12, 13, 15),
    hypotheses=(
        SOLID_FACTOR,
        DAMPED,
        ORTHONORMAL,
        NEGATIVE,
        ALONG,
        REST,
        NOT_DECAYING,
        GROWING,
        SWINGING,
        W_ROOT,
        SYMMETRIC,
    ),
    setting=(r"$G$ is symmetric, as it is at every equilibrium and elsewhere.",),
    source="ours; [Yang2020] observes zero, one, two and three eigenvalues numerically",
    proof=proof,
    controls={
        "negative damping": Mutation(at=9, proof=lambda: proof(damping=-1)),
        "congruence from the wrong side": Mutation(at=2, proof=lambda: proof(transposed=True)),
        "the pencil of -G": Mutation(at=2, proof=lambda: proof(pencil=-1)),
        "one more than the index": Mutation(at=13, proof=lambda: proof(counted=_one_too_many)),
    },
    not_claimed=r"The sizes of the eigenvalues: they depend on $J$ and $\mu$, their signs do not. "
    r"Nor anything about the six further zeros of the ambient Jacobian.",
    needs=("characteristic_polynomial", "hessian", "morse_bott"),
    standard=(
        SPECTRAL,
        r"Cholesky: $J \succ 0$ is $T T^{\mathsf T}$ with an invertible matrix $T$.",
    ),
    runs=("certreg.objective.classification.Classification.unstable",),
    used_by=(
        "certreg.equilibrium.stability.spring_ratios",
        "certreg.verify",
    ),
    coq=(
        "unstable_roots_are_the_index",
        "unstable_roots_at_equilibrium",
        "simultaneous_diagonalisation",
        "index_zero_iff",
    ),
    not_in_coq=(
        r"That the polynomial of the linearised motion is the determinant of a $12\times12$ "
        r"matrix: it is written down from `torque_linearised` and the equation of the "
        r"translation. That the unstable roots are real, and which of the others are zero."
    ),
)
