"""Claim: the energy is a quartic, and its relaxation that of sums of squares of degree four."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import sympy

from certreg.geometry.constraints import rotation_quadratics
from certreg.geometry.so3 import davenport_matrix
from certreg.objective.quartics import quartic_of_form
from certreg.objective.springs import Springs
from certreg.verify import PRODUCTS, QUARTICS, ROTATION, gram_matrix
from certreg.verify import _quartic_terms as quartic_terms  # pyright: ignore[reportPrivateUsage]

from ..algebra import facts, identity
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, entry, inner, matrix, quaternion, rotation, square, symmetric
from ..rationals import rank

SIZE = len(PRODUCTS)
Terms = Callable[[], Any]
Gram = Callable[[Any, Any], Any]
Size = Callable[[Sequence[Sequence[int]]], Fraction]
Q = quaternion()
M = Matrix([Q[i] * Q[j] for i, j in PRODUCTS])
R = rotation(Q)
LIFTED = Matrix([*R.T, square(Q)])  # |q|^2 R by columns, |q|^2
FORM = symmetric("Q", SIZE)


def shipped_terms() -> Any:
    """What the checker's table says, made anew."""
    return inspect.unwrap(quartic_terms)()


def monomial_of(at: Sequence[int]) -> Any:
    """The product of these entries of q."""
    return sympy.prod([Q[i] for i in at])


def even_size(form: Sequence[Sequence[int]]) -> Fraction:
    """What `isotropic_like` asks to be zero, of a form of `certreg.objective`: 1 first."""
    return _parts(form)[1]


def _parts(form: Sequence[Sequence[int]]) -> tuple[Fraction, Fraction]:
    shipped: Any = vars(Springs)["part_sizes"]
    return shipped.func(SimpleNamespace(form=lambda: form, unit=Fraction(1)))


def proof(
    terms: Terms = shipped_terms,
    gram: Gram = gram_matrix,
    written: str = ROTATION,
    size: Size = even_size,
) -> Proof:
    """The table of the checker, the Gram matrix, why both relaxations are one, and what is even."""
    texts = [
        [(text[k : k + 1], text[k + 1 : k + 3]) for k in (0, 3, 6, 9)] for text in _split(written)
    ]
    yield identity(
        r"The ten words that the checker spells the entries of $r$ with are $|q|^2 R$ by columns "
        r"and $|q|^2$.",
        [sum(int(s + "1") * monomial_of([*map(int, at)]) for s, at in text) for text in texts],
        [*LIFTED],
    )
    upper = [FORM[i, j] for i in range(SIZE) for j in range(i, SIZE)]
    yield identity(
        r"With $r = (\operatorname{vec} R, 1)$, here times $|q|^2$, and any form $Q$: the 35 "
        r"coefficients that the checker's table makes of $Q$ are those of $r^{\mathsf T} Q r$. So "
        r"the objective at $R(q)$ is $F(q)/|q|^4$ times the unit.",
        sum(
            monomial_of(at) * sum(k * upper[place] for place, k in row.items())
            for at, row in terms().items()
        ),
        (LIFTED.T * FORM * LIFTED)[0],
    )
    yield facts(
        r"So are those of `certreg.objective`, which has $1$ first and a table of its own: on the "
        r"55 forms with one entry or two.",
        [quartic_of_form(form) for form in _units()],
        [_by_the_checker(terms(), form) for form in _units()],
    )
    C = matrix("C")
    yield identity(
        r"A form that is linear in $R$ becomes $|q|^2$ times a quadratic form: $2 r_0 "
        r"\operatorname{tr}(R^{\mathsf T} C)$ is $2 |q|^2\, q^{\mathsf T} K(C)\, q$, the isotropic "
        r"objective.",
        2 * square(Q) * inner(R, C),
        2 * square(Q) * (Q.T * Matrix(davenport_matrix(C.tolist())) * Q)[0],
    )
    yield from _relaxation(gram)
    yield from _isotropic(size)


def _relaxation(gram: Gram) -> Proof:
    P = [entry("P", k) for k in range(len(QUARTICS))]
    free = [entry("g", k) for k in range(20)]
    rows = gram(P, free)
    G = Matrix(SIZE, SIZE, lambda i, j: rows[min(i, j)][abs(i - j)])
    yield identity(
        r"`certreg.verify.gram_matrix`, run on symbols: whatever the twenty free entries are, "
        r"$s^{\mathsf T} G s = 2 P(q)$ with $s$ the ten products $q_i q_j$. With $G \succ 0$, $P$ "
        r"is a sum of squares of degree four, positive for $q \ne 0$.",
        (M.T * G * M)[0],
        2 * sum(c * monomial_of(at) for c, at in zip(P, QUARTICS, strict=True)),
    )
    table = Matrix(_coefficients(list(LIFTED), PRODUCTS))
    yield facts(
        r"The ten entries of $r$ are linear in the ten products $s$, with a matrix of integers of "
        r"determinant $\pm 8192 \ne 0$: $r = T s$. So $r^{\mathsf T} A r = s^{\mathsf T} "
        r"(T^{\mathsf T} A T) s$, and the one form is semidefinite where the other is.",
        [int(abs(table.det()))],
        [8192],
    )
    both = [M[i] * M[j] for i in range(SIZE) for j in range(i, SIZE)]
    quadratics = [Matrix(A) for A in rotation_quadratics()]
    vanish = [(_first_last().T * A * _first_last())[0] for A in quadratics]
    yield facts(
        r"The 55 products of two of the ten span the 35 monomials: the forms in $s$ that vanish "
        r"for all $q$ have 20 dimensions, which the twenty free entries are. The 21 quadratics "
        r"$A_k$ of rotations vanish for all $q$, and span 20 dimensions: they are all. So the "
        r"bound of the relaxation with the 21 quadratics, the largest $v$ with a semidefinite form "
        r"$r^{\mathsf T}(Q - v\, e e^{\mathsf T} + \sum_k \lambda_k A_k)\, r$, $e \cdot r=|q|^2$, "
        r"is the largest $v$ with $F - v |q|^4$ a sum of squares.",
        [
            rank(_coefficients(both, QUARTICS)),
            rank([[A[i, j] for i in range(SIZE) for j in range(SIZE)] for A in quadratics]),
            sum(bool(sympy.expand(value)) for value in vanish),
        ],
        [35, 20, 0],
    )


def _isotropic(size: Size) -> Proof:
    units = _units()
    single = [size(form) for form in units]
    both = [
        [size(_sum(one, other)) - single[i] - single[j] for j, other in enumerate(units)]
        for i, one in enumerate(units)
    ]
    dense = [[abs(i - j) ** 3 - 7 * i * j for j in range(SIZE)] for i in range(SIZE)]
    entries = [dense[i][j] for i in range(SIZE) for j in range(i, SIZE)]
    yield facts(
        r"The 25. `Springs.part_sizes` of `certreg.objective`, the second number $N(Q)$, is a "
        r"quadratic form in the 55 entries of $Q$: its values at sums of two of the forms with one "
        r"entry or two say what it is elsewhere, here at a form with all entries. Elimination of "
        r"its matrix meets 25 pivots, which are positive, and leaves zeros: a sum of 25 squares of "
        r"independent linear forms, zero on 30 dimensions.",
        [2 * size(dense), _pivots(both)],
        [
            sum(
                a * b * both[i][j]
                for i, a in enumerate(entries)
                for j, b in enumerate(entries)
                if a and b
            ),
            25,
        ],
    )
    vanishing = [[list(row) for row in A] for A in rotation_quadratics()]
    linear = [form for form in units if any(form[0])]
    held = Springs.isotropic_like.fget
    yield facts(
        r"On the 21 quadratics of rotations and the ten $r_0 r_j$ it is zero, and they span 30 "
        r"dimensions: these are all. A form that is $c - 2 \operatorname{tr}(R^{\mathsf T} C)$ on "
        r"rotations differs from a combination of the ten by one that vanishes on rotations, "
        r"which is one of the 21 by the step before the last. So `isotropic_like`, which asks "
        r"whether $N(Q) = 0$, is true exactly where $f = c - 2 \operatorname{tr}(R^{\mathsf T} "
        r"C)$ for some $c$ and $C$; at $R_{11}^2$, say, it is not.",
        [
            frozenset(size(form) for form in (*vanishing, *linear)),
            rank([[A[i][j] for i in range(SIZE) for j in range(SIZE)] for A in vanishing + linear]),
            [_held(held, form) for form in (*vanishing, units[SIZE])],
        ],
        [frozenset({Fraction(0)}), 30, [True] * len(vanishing) + [False]],
    )


def _held(held: Any, form: Sequence[Sequence[int]]) -> bool:
    return held(SimpleNamespace(part_sizes=_parts(form)))


def _sum(one: Sequence[Sequence[int]], other: Sequence[Sequence[int]]) -> list[list[int]]:
    return [[a + b for a, b in zip(*rows, strict=True)] for rows in zip(one, other, strict=True)]


def _pivots(matrix: Sequence[Sequence[Fraction]]) -> int:
    """How many pivots elimination meets on the diagonal; -1 unless all are > 0 and nothing else is.

    A semidefinite matrix has zeros beside a zero of its diagonal.
    """
    rows, met = [list(row) for row in matrix], 0
    while rows:
        first, *others = rows
        if first[0] < 0 or (first[0] == 0 and any(first)):
            return -1
        if first[0]:
            met += 1
            others = [
                [
                    a - row[0] / first[0] * b if row[0] else a
                    for a, b in zip(row, first, strict=True)
                ]
                for row in others
            ]
        rows = [row[1:] for row in others]
    return met


def _split(written: str) -> list[str]:
    return written.split()


def _first_last() -> Any:
    """The ten entries with 1 first, as the package has it."""
    return Matrix([LIFTED[9], *LIFTED[:9]])


def _coefficients(forms: Sequence[Any], order: Sequence[tuple[int, ...]]) -> list[list[int]]:
    rows: list[list[int]] = []
    for form in forms:
        terms: Any = sympy.Poly(form, *Q).as_dict()
        powers = [tuple(at.count(i) for i in range(4)) for at in order]
        rows.append([int(terms.get(power, 0)) for power in powers])
    return rows


def _units() -> list[list[list[int]]]:
    places = range(SIZE)
    pairs = [(i, j) for i in places for j in range(i, SIZE)]
    return [[[int((a, b) in {(i, j), (j, i)}) for b in places] for a in places] for i, j in pairs]


def _by_the_checker(terms: Any, form: list[list[int]]) -> tuple[int, ...]:
    order = [*range(1, SIZE), 0]
    upper = [form[order[i]][order[j]] for i in range(SIZE) for j in range(i, SIZE)]
    return tuple(sum(k * upper[place] for place, k in row.items()) for row in terms.values())


def _once() -> Any:
    """A table that counts the entries beside the diagonal once."""
    diagonal = {sum(range(SIZE - i + 1, SIZE + 1)) for i in range(SIZE)}
    return {
        at: {place: k if place in diagonal else sympy.Rational(k, 2) for place, k in row.items()}
        for at, row in shipped_terms().items()
    }


def _traced(form: Sequence[Sequence[int]]) -> Fraction:
    """The size with the traces that no rotation changes."""
    return _parts(form)[1] + Fraction(sum(form[k][k] for k in range(1, SIZE)) ** 2)


def _undoubled(P: Any, free: Any) -> Any:
    return [[row[0] / 2, *row[1:]] for row in gram_matrix(P, free)]


CLAIM = Claim(
    name="quartic_relaxation",
    title="A quartic, and its sums of squares",
    statement=r"For every form $Q$ in $r = (1, \operatorname{vec} R)$ the checker's 35 "
    r"coefficients are those of $F(q) = |q|^4\, r^{\mathsf T} Q r$. Its matrix $G$ satisfies "
    r"$s^{\mathsf T} G s = 2 P(q)$ for every $P$ and all twenty free entries, $s$ the ten products "
    r"$q_i q_j$. The bound by multipliers of the 21 quadratics of rotations, in $r$, is the "
    r"largest $v$ for which $F - v |q|^4$ is a sum of squares of degree four. Of the 35 "
    r"numbers of $f$ ten are those of $c - 2 \operatorname{tr}(R^{\mathsf T} C)$; the other 25 "
    r"vanish, and `isotropic_like` is true, exactly where $f$ is of that form.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 9),
    setting=("$q$ of any length.",),
    source="[Briales2017], redundant rotation constraints; the rest is elementary",
    proof=proof,
    controls={
        "a sign of ROTATION turned": Mutation(
            at=1, proof=lambda: proof(written=ROTATION.replace("+12+12-03", "+12+12+03", 1))
        ),
        "entries beside the diagonal counted once": Mutation(
            at=2, proof=lambda: proof(terms=_once)
        ),
        "a Gram matrix of P instead of 2 P on the diagonal": Mutation(
            at=5, proof=lambda: proof(gram=_undoubled)
        ),
        "25 numbers with a trace among them": Mutation(at=8, proof=lambda: proof(size=_traced)),
    },
    not_claimed=r"That this bound is the minimum: for springs it need not be, and is not where $F "
    r"- \min F\, |q|^4$ is no sum of squares.",
    needs=("quaternions", "davenport", "relaxation_tightness", "spring_translation"),
    runs=(
        "certreg.verify._quartic_terms",
        "certreg.verify.gram_matrix",
        "certreg.objective.quartics.quartic_of_form",
        "certreg.objective.springs.Springs.isotropic_like",
    ),
    used_by=("certreg.relaxation.quartic.relax_quartic",),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
