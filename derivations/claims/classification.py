"""Claim: the eight kinds of equilibrium set, and the decision between them without a root."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Any

import sympy

from certreg.objective.classification import (
    Classification,
    Invariants,
    Pattern,
    decide,
    invariants,
    pattern_of,
)
from certreg.verify import multiplicities

from ..algebra import facts, identity, refuting
from ..kernel import Claim, Mutation, Proof, Step
from ..notation import vector
from ..table import (
    GAPS,
    ROWS,
    Row,
    eigenvalues,
    multiplicities_of,
    representatives,
    sign,
    singular_values,
)


def proof(
    decisive: Callable[[Sequence[Sequence[Any]]], Invariants] = invariants,
    decision: Callable[[Invariants], Pattern] = decide,
    rows: Sequence[Row] = ROWS,
) -> Proof:
    """Gaps for coordinates; the signs of the invariants in each row; the decision on the signs."""
    yield from _coordinates(rows)
    yield from _factored(decisive)
    yield facts(
        r"What remains is to find the signs of five numbers in each row. Written in those gaps "
        r"that do not vanish, the numbers that matter turn out to have coefficients of one sign "
        r"only. A polynomial of that kind has this sign wherever the gaps are positive, and one "
        r"without any coefficient is zero. Where both signs occur, as in $g_1 - g_3$, the test "
        r"does not tell, and says so.",
        [sign(GAPS[0] + 2 * GAPS[1]), sign(-GAPS[0] * GAPS[2]), sign(0), sign(GAPS[0] - GAPS[2])],
        [1, -1, 0, None],
    )
    for row in rows:
        yield _row_signs(row, decisive)
    yield _decisions(rows, decision)
    yield _examples(rows)
    yield from _consequences(rows)


def _coordinates(rows: Sequence[Row]) -> Proof:
    d = vector("d")
    l1, l2, l3, l4 = eigenvalues(d)
    back = singular_values([l1 - l2, l2 - l3, l3 - l4])
    forth = eigenvalues(singular_values(GAPS))
    yield identity(
        r"Take the three gaps $g_k = \lambda_k - \lambda_{k+1}$ for coordinates: "
        r"$4 d_1 = g_1 + 2 g_2 + g_3$, $4 d_2 = g_1 + g_3$, $4 d_3 = g_1 - g_3$. The map is "
        r"linear and invertible, and $d_1 \geq d_2 \geq |d_3|$ says $g_1, g_2, g_3 \geq 0$ and "
        r"nothing else: every triple of nonnegative gaps occurs.",
        [back, [a - b for a, b in pairwise(forth)]],
        [d, list(GAPS)],
    )
    found = [multiplicities_of(row.vanish) for row in rows]
    every = sorted(row.vanish for row in rows) == sorted(product([False, True], repeat=3))
    yield facts(
        r"The multiplicities of $\lambda_1 \geq \dots \geq \lambda_4$ say which gaps vanish, and "
        r"conversely. Each of the $2^3$ subsets of the gaps is one row of the table: the eight "
        r"rows exclude each other and leave nothing out.",
        [every, *found],
        [True, *(row.pattern for row in rows)],
    )


def _factored(decisive: Callable[[Any], Invariants]) -> Proof:
    a, b, c = GAPS
    found = decisive(sympy.diag(*singular_values(GAPS)).tolist())
    yield identity(
        r"In the diagonal frame, which changes none of the invariants (claims `spectrum` and "
        r"`discriminant`), the discriminant of $C^{\mathsf T} C$ is a square of gaps and their "
        r"sums: $4096 \operatorname{disc} = \bigl(g_1 g_2 g_3 (g_1 + g_2)(g_2 + g_3)"
        r"(g_1 + g_2 + g_3)\bigr)^2$. It vanishes if and only if a gap does.",
        4096 * found.discriminant,
        (a * b * c * (a + b) * (b + c) * (a + b + c)) ** 2,
    )
    middle, last = (
        decisive(sympy.diag(*singular_values(gaps)).tolist()).cubic_invariant
        for gaps in ((a, 0, c), (a, b, 0))
    )
    first = decisive(sympy.diag(*singular_values((0, b, c))).tolist()).cubic_invariant
    yield identity(
        r"Where one gap vanishes, $s = 2 e_1^3 - 9 e_1 e_2 + 27 e_3$ is a cube, $2 (r - p)^3$ for "
        r"the double $d_i^2 = p$ and the single one $r$: $32 s = -(g_1 g_3)^3$ for $g_2 = 0$, "
        r"$32 s = \bigl(g_2 (g_1 + g_2)\bigr)^3$ for $g_3 = 0$ and $32 s = "
        r"\bigl(g_2 (g_2 + g_3)\bigr)^3$ for $g_1 = 0$. So $s$ says on which side the single one "
        r"lies, and vanishes with a second gap.",
        [32 * middle, 32 * last, 32 * first],
        [-((a * c) ** 3), (b * (a + b)) ** 3, (b * (b + c)) ** 3],
    )


def _row_signs(row: Row, decisive: Callable[[Any], Invariants]) -> Step:
    d = singular_values(row.gaps)
    found = decisive(sympy.diag(*d).tolist())
    values = [found.discriminant, found.e1, found.e2, found.cubic_invariant, found.det]
    told = [sign(value) for value in values]
    names = ("\\operatorname{disc}", "e_1", "e_2", "s", "D")
    decided = [
        (name, found_sign, wanted)
        for name, found_sign, wanted in zip(names, told, row.signs, strict=True)
        if wanted is not None
    ]
    words = ", ".join(f"${name} {'<=>'[wanted + 1]} 0$" for name, _, wanted in decided)
    differences = [d[1] + d[2], d[0] - d[1], d[1] - d[2]]
    gone = [f"g_{k}" for k, vanishes in enumerate(row.vanish, start=1) if vanishes]
    rest = "the other positive" if len(gone) == 2 else "the others positive"
    gaps = f"${' = '.join([*gone, '0'])}$, {rest}" if gone else "all gaps positive"
    return facts(
        f"Row {_shown(row.pattern)} ({gaps if len(gone) < 3 else 'all gaps zero'}) is "
        f"{row.condition}, and in it {words}.",
        [*(found_sign for _, found_sign, _ in decided), *map(sign, differences)],
        [*(wanted for _, _, wanted in decided), *(0 if gone else 1 for gone in row.vanish)],
    )


def _decisions(rows: Sequence[Row], decision: Callable[[Invariants], Pattern]) -> Step:
    found, expected = [], []
    for row in rows:
        choices = [(-1, 0, 1) if s is None else (s,) for s in row.signs]
        for disc, e1, e2, s, det in product(*choices):
            signs = {"e1": e1, "e2": e2, "det": det, "disc": disc, "s": s}
            found.append(decision(_Signs(**{name: _Sign(value) for name, value in signs.items()})))
            expected.append(row.pattern)
    return facts(
        r"The shipped decision is run on objects that answer one question only, how they compare "
        r"with zero. On the signs of each row, with every choice of those that the row leaves "
        r"open, it returns the row's pattern, and so it does for every matrix of the row. "
        r"Since the rows exhaust all matrices and give different patterns, the converse holds as "
        r"well: if the decision returns a pattern, the matrix belongs to its row.",
        found,
        expected,
    )


class _Sign:
    """A number of which nothing can be learned but how it compares with zero."""

    def __init__(self, value: int) -> None:
        self._value = value

    def __eq__(self, other: object) -> bool:
        return self._value == _zero(other)

    def __lt__(self, other: object) -> bool:
        return self._value < _zero(other)

    def __gt__(self, other: object) -> bool:
        return self._value > _zero(other)

    def __hash__(self) -> int:
        return hash(self._value)


def _zero(other: object) -> int:
    if other != 0:
        raise TypeError("only a comparison with zero has an answer")
    return 0


@dataclass(frozen=True, kw_only=True)
class _Signs(Invariants):
    """Invariants of which only the signs are known."""

    disc: _Sign
    s: _Sign

    @property
    def discriminant(self) -> _Sign:
        """The sign of the discriminant."""
        return self.disc

    @property
    def cubic_invariant(self) -> _Sign:
        """The sign of s."""
        return self.s


def _examples(rows: Sequence[Row]) -> Step:
    cases = [(row.pattern, C) for row in rows for C in representatives(row)]
    expected = [pattern for pattern, _ in cases]
    return facts(
        r"The code agrees on integer matrices of every row and every sign of $D$ that it admits, "
        r"diagonal ones and $U \operatorname{diag}(d) V^{\mathsf T}$ with rational rotations times "
        r"a common denominator: `pattern_of` of the library, and the stand-alone checker's own "
        r"version of the same decision.",
        [pattern_of(C) for _, C in cases] + [tuple(multiplicities(C)) for _, C in cases],
        expected * 2,
    )


def _consequences(rows: Sequence[Row]) -> Proof:
    kinds = [
        Classification(pattern=row.pattern, inertia_definite=True, ambiguity=None) for row in rows
    ]
    yield facts(
        r"The eigenvectors of an eigenvalue of multiplicity one are a line, and a line is one "
        r"rotation (claim `half_turns`); from multiplicity two on there are infinitely many. So "
        r"the optimum is unique if and only if $\lambda_1 > \lambda_2$, that is $d_2 + d_3 > 0$.",
        [kind.unique for kind in kinds],
        [not row.vanish[0] for row in rows],
    )
    yield facts(
        r"There are exactly four equilibria, one of them optimal and three spurious, if and only "
        r"if no gap vanishes: $d_1 > d_2 > |d_3|$, the three $d_i^2$ are different. If the optimum "
        r"is unique, the spurious equilibria are three or infinitely many; if it is not, they are "
        r"two, one, none or infinitely many.",
        [*(kind.finite for kind in kinds), *(kind.spurious for kind in kinds)],
        [*(not any(row.vanish) for row in rows), *(row.spurious for row in rows)],
    )


def _shown(pattern: Pattern) -> str:
    return ",".join(map(str, pattern))


@dataclass(frozen=True, kw_only=True)
class _WrongCubic(Invariants):
    """The decisive number s with 26 for 27."""

    @property
    def cubic_invariant(self) -> Any:
        """The shipped one less e3."""
        return super().cubic_invariant - self.det**2


def _one_coefficient_wrong(C: Any) -> Invariants:
    found = invariants(C)
    return _WrongCubic(e1=found.e1, e2=found.e2, det=found.det)


def _blind_to_mirroring(found: Any) -> Pattern:
    return decide(replace(found, det=_Sign(1)))


def _sides_exchanged(found: Any) -> Pattern:
    flipped = _Sign((found.cubic_invariant < 0) - (found.cubic_invariant > 0))
    return decide(replace(found, s=flipped))


def _cube_for_a_square() -> Step:
    one = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    return refuting(
        r"At $C = I$, where $s = 0$ and the eigenvalues are $3, -1, -1, -1$, the decision with "
        r"$26$ for $27$ is not 1,3.",
        [decide(_one_coefficient_wrong(one))],
        [pattern_of(one)],
    )


def _one_row_forgotten() -> tuple[Row, ...]:
    return tuple(row for row in ROWS if row.pattern != (2, 2))


CLAIM = Claim(
    name="classification",
    title="The eight kinds of equilibrium set",
    statement=r"The multiplicities of the eigenvalues $\lambda_1 \geq \dots \geq \lambda_4$ of "
    r"$K(C)$ are one of 1,1,1,1; 1,2,1; 1,1,2; 1,3; 2,1,1; 3,1; 2,2; 4, each under exactly the "
    r"condition on $d_1 \geq d_2 \geq |d_3|$ of its row. With $e_1, e_2, e_3 = D^2$ the "
    r"coefficients of $\chi_{C^{\mathsf T}C}$ and $s = 2e_1^3 - 9 e_1 e_2 + 27 e_3$ the row is "
    r"decided by signs: $\operatorname{disc} \neq 0$: 1,1,1,1; else $e_1 = 0$: 4; else "
    r"$e_2 = 0$: 2,2; else $s = 0$: 1,3 for $D > 0$ and 3,1 for $D < 0$; else $s < 0$: 1,2,1; else "
    r"1,1,2 for $D > 0$ and 2,1,1 for $D < 0$. There are exactly four equilibria if and only if "
    r"the $d_i^2$ are different, and the optimum is unique if and only if $d_2 + d_3 > 0$.",
    concludes=(1, 2, 3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 16, 17),
    source="ours; it corrects the corollary and the conjecture of [Yang2020]",
    proof=proof,
    controls={
        "s with 26 for 27": Mutation(
            at=4, proof=lambda: proof(decisive=_one_coefficient_wrong), instance=_cube_for_a_square
        ),
        "a decision that does not see mirroring": Mutation(
            at=14, proof=lambda: proof(decision=_blind_to_mirroring)
        ),
        "a decision with s of the other sign": Mutation(
            at=14, proof=lambda: proof(decision=_sides_exchanged)
        ),
        "a table without the row 2,2": Mutation(
            at=2, proof=lambda: proof(rows=_one_row_forgotten())
        ),
    },
    not_claimed=r"Anything about how near a matrix is to another row: the decision is exact for "
    r"the numbers given, which for a measured cloud are rounded coordinates.",
    needs=("spectrum", "discriminant", "eigenvectors", "half_turns"),
    runs=(
        "certreg.objective.classification.decide",
        "certreg.objective.classification.invariants",
        "certreg.objective.classification.Invariants.cubic_invariant",
        "certreg.objective.classification.Classification.unique",
        "certreg.objective.classification.Classification.finite",
        "certreg.objective.classification.Classification.spurious",
    ),
    used_by=(
        "certreg.objective.classification.pattern_of",
        "certreg.objective.classification.Classification",
        "certreg.verify.multiplicities",
    ),
    coq=(
        "exactly_four_equilibria",
        "infinite_iff_repeated_eigenvalue",
        "pattern_decided",
        "zpattern_real",
        "table_uniqueness",
        "table_spurious",
        "unique_optimum_iff_simple_top",
        "unique_registration_iff",
        "unique_iff_positive_margin",
    ),
    not_in_coq=(
        "That each of the eight rows occurs, and what its components look like, circles and "
        "projective planes."
    ),
)
