"""Claim: the components of equilibria are projective spaces, nondegenerate, of known index."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import sympy

from certreg.geometry.so3 import davenport_matrix
from certreg.objective.classification import Classification
from certreg.results import ComponentKind

from ..algebra import facts, identity
from ..hypotheses import SPECTRAL
from ..kernel import Claim, Mutation, Proof, Step
from ..notation import Matrix, body, inner, quaternion, square
from ..table import ROWS, Row, eigenvalues, sign, singular_values

Indices = Callable[[Classification], tuple[int, ...]]


def proof(
    indices: Indices = lambda kind: kind.indices,
    kinds: Callable[[Classification], tuple[ComponentKind, ...]] = lambda kind: kind.kinds,
    characteristic: Sequence[int] = (1, 0, 1, 0),
) -> Proof:
    """Projective spaces; the Hessian in each row by the signs of its eigenvalues; Euler's sum."""
    p, q = quaternion("p"), quaternion("q")
    yield identity(
        r"The equilibria of one eigenvalue are the rotations $R(q)$ of the unit vectors $q$ of its "
        r"eigenspace. As $q$ and $-q$, and no others, are one rotation (claim `half_turns`), an "
        r"eigenspace of dimension $k$ gives a real projective space $\mathrm{RP}^{k-1}$, embedded "
        r"in $\mathrm{SO}(3) = \mathrm{RP}^3$. Moving $q$ within it towards $p \perp q$ turns "
        r"the body about $L(q)^{\mathsf T} p$: $L(q) L(q)^{\mathsf T} p = |q|^2 p - "
        r"(p \cdot q)\, q$. So its tangent space at $R(q)$ is spanned by the "
        r"$L(q)^{\mathsf T} p$ with $p$ in the eigenspace.",
        body(q) * body(q).T * p,
        square(q) * p - inner(p, q) * q,
    )
    yield _axes()
    for row in ROWS:
        yield _row(row, indices, kinds)
    yield facts(
        r"A count that has to come out, and nothing rests on it: by Morse–Bott theory the sum of "
        r"$(-1)^{\text{index}} \chi(\text{component})$ is the Euler characteristic of "
        r"$\mathrm{SO}(3)$, which is $0$. The projective spaces of dimension 0, 1, 2, 3 have "
        r"$\chi = 1, 0, 1, 0$, and in each of the eight rows the sum is $0$.",
        [_euler_sum(row, indices, characteristic) for row in ROWS],
        [0] * len(ROWS),
    )


def _axes() -> Step:
    d = sympy.Matrix(sympy.symbols("d_1:4", real=True))
    K = Matrix(davenport_matrix(sympy.diag(*d).tolist()))
    levels = eigenvalues(d)
    found, expected = [], []
    for j, e in enumerate(sympy.eye(4).columnspace()):
        L = body(e)
        found.append(levels[j] * sympy.eye(3) - L.T * K * L)
        expected.append(sympy.diag(*[levels[j] - levels[k] for k in _partners(j)]))
    return identity(
        r"In the diagonal frame the four unit quaternions of the axes are an eigenbasis, and the "
        r"Hessian $G = \lambda_j I - L^{\mathsf T} K L$ at the $j$-th (claim `hessian`) is the "
        r"diagonal matrix of $\lambda_j - \lambda_k$, $k \neq j$, in an order that depends on $j$. "
        r"Every unit eigenvector is a member of some orthonormal eigenbasis, so these are the "
        r"eigenvalues of $G$ at every equilibrium of $\lambda_j$ (claim `hessian` again). In the "
        r"rows below their signs stand in brackets. As many are zero as the component has "
        r"dimensions, so the kernel of the Hessian is its tangent space and nothing more; as many "
        r"are negative as there are eigenvalues above, and that is the index.",
        found,
        expected,
    )


def _partners(j: int) -> tuple[int, int, int]:
    """The k for the directions x, y, z of the body at the j-th axis: e_j times i, j, k."""
    return ((1, 2, 3), (0, 3, 2), (3, 0, 1), (2, 1, 0))[j]


def _row(
    row: Row, indices: Indices, kinds: Callable[[Classification], tuple[ComponentKind, ...]]
) -> Step:
    kind = Classification(pattern=row.pattern, inertia_definite=True, ambiguity=None)
    levels = eigenvalues(singular_values(row.gaps))
    starts = [sum(row.pattern[:k]) for k in range(len(row.pattern))]
    signs = [[sign(levels[j] - levels[k]) for k in range(4) if k != j] for j in starts]
    shown = "; ".join(
        f"{name.value.replace('-', ' ')} of index {index} (${','.join(map(_symbol, at))}$)"
        for name, index, at in zip(kinds(kind), indices(kind), signs, strict=True)
    )
    return facts(
        f"Row {','.join(map(str, row.pattern))}, {row.condition}: {shown}.",
        [
            *(row_signs.count(-1) for row_signs in signs),
            *(row_signs.count(0) for row_signs in signs),
            *(row_signs.count(None) for row_signs in signs),
        ],
        [
            *indices(kind),
            *(component.dimension for component in kinds(kind)),
            *([0] * len(starts)),
        ],
    )


def _symbol(told: int | None) -> str:
    return "?" if told is None else "0+-"[told]


def _euler_sum(row: Row, indices: Indices, characteristic: Sequence[int]) -> int:
    kind = Classification(pattern=row.pattern, inertia_definite=True, ambiguity=None)
    parts = zip(indices(kind), row.pattern, strict=True)
    return sum((-1) ** index * characteristic[size - 1] for index, size in parts)


def _counted_from_below(kind: Classification) -> tuple[int, ...]:
    """The number of eigenvalues below, for those above."""
    return tuple(4 - i - m for i, m in zip(kind.indices, kind.pattern, strict=True))


def _off_by_one(kind: Classification) -> tuple[int, ...]:
    """The position of the component, which is not the index behind a multiple eigenvalue."""
    return tuple(range(len(kind.pattern)))


def _spheres(kind: Classification) -> tuple[ComponentKind, ...]:
    """Kinds with one dimension too many: the eigenspace for its projective space."""
    return tuple(ComponentKind.of_multiplicity(min(m + 1, 4)) for m in kind.pattern)


CLAIM = Claim(
    name="morse_bott",
    title="The shape and index of each component",
    statement=r"The equilibria with an eigenvalue of multiplicity $k$ form an $\mathrm{RP}^{k-1}$ "
    r"in $\mathrm{SO}(3)$: a point, a circle, a projective plane, or everything. The potential is "
    r"a Morse–Bott function: the kernel of its Hessian is tangent to the component, and its index "
    r"is the number of eigenvalues of $K$ above, with multiplicities. The only minima are the "
    r"global ones, and $\sum (-1)^{\text{index}} \chi(\text{component}) = 0$.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11),
    source="[Frankel1965] for traces on orthogonal groups; the table is ours",
    proof=proof,
    controls={
        "the eigenvalues below counted": Mutation(
            at=3, proof=lambda: proof(indices=_counted_from_below)
        ),
        "the index counted in components": Mutation(at=4, proof=lambda: proof(indices=_off_by_one)),
        "components with a dimension too many": Mutation(at=3, proof=lambda: proof(kinds=_spheres)),
        "a projective plane with the sphere's characteristic": Mutation(
            at=11, proof=lambda: proof(characteristic=(1, 0, 2, 0))
        ),
    },
    not_claimed=r"That the sum proves the table; it would only expose an error. Instability in the "
    r"dynamics needs $J \succ 0$ besides (claim `unstable_count`).",
    needs=("classification", "hessian", "half_turns"),
    standard=(SPECTRAL,),
    runs=(
        "certreg.objective.classification.Classification.indices",
        "certreg.objective.classification.Classification.kinds",
    ),
    used_by=("certreg.results.ComponentKind",),
    coq=(
        "morse_index",
        "morse_indices_of_four",
        "optimal_iff_index_zero",
        "eigenvector_in_a_basis",
        "index_unique",
    ),
    not_in_coq=(
        "Topology: that the components are projective spaces, that the kernel of the "
        "Hessian is tangent to them, and the sum with Euler's characteristic."
    ),
)
