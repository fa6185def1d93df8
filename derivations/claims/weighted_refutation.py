"""Claim: weights whose least sum of squares is too large show that pairs do not go together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from certreg.verify import cross, davenport, definite, spreads

from ..algebra import combination, contraction, facts, identity, nonnegative, positive
from ..hypotheses import ROTATION
from ..hypotheses import definite as definite_at
from ..hypothesis import Hypothesis, Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..notation import Matrix, inner, matrix, quaternion, scalar, square, symmetric, vector
from .pair_lengths import refuted

Test = Callable[[Sequence[Sequence[int]], Sequence[int]], bool]
Row = Sequence[int]  # x, y, beta
SPREAD, BUDGET = scalar("S"), scalar("B")
K, P, R = symmetric("K", 4), quaternion("p"), matrix("R")
WEIGHTS = [scalar(f"lambda_{i}") for i in (1, 2, 3)]
LIMITS = [scalar(f"beta_{i}") for i in (1, 2, 3)]
RESIDUALS = [vector(f"r{i}") for i in (1, 2, 3)]
LEAST, MEMBERS, COLOURS = scalar("K"), scalar("k"), scalar("c")
SIZES = [scalar(f"t_{i}") for i in (1, 2)]  # of two groups
PARTS = [scalar(f"k_{i}") for i in (0, 1, 2)]  # what the motion brings within of the rest, of each
POOL = scalar("n")

LIGHT = nonnegative_by(r"$\lambda_i \ge 0$.", WEIGHTS, example={WEIGHTS[0]: -1, LIMITS[0]: 1})
WITHIN = nonnegative_by(
    r"One motion brings the pairs within their bounds: $|r_i| \le \beta_i$.",
    [limit**2 - square(r) for limit, r in zip(LIMITS, RESIDUALS, strict=True)],
    standing=Standing.CASE,
    example={WEIGHTS[0]: 1, RESIDUALS[0][0]: 1},
)
SHORT = nonnegative_by(
    "Of each refuted group at least one pair is not within.",
    [size - 1 - part for size, part in zip(SIZES, PARTS[1:], strict=True)],
    standing=Standing.CASE,
    example={PARTS[1]: 2, SIZES[0]: 1, SIZES[1]: 1, LEAST: 2},
)
COLOURED = nonnegative_by(
    "Of the rest there are no more within than colours.",
    COLOURS - PARTS[0],
    standing=Standing.CASE,
    example={PARTS[0]: 3, SIZES[0]: 1, SIZES[1]: 1, LEAST: 2},
)


def _struck_by(own: int) -> Hypothesis:
    """The count is below K; own: 1 if e itself is counted."""
    return positive_by(
        r"$1 + \sum_g (|T_g| - 1) + c < K$.",
        LEAST - own - sum(size - 1 for size in SIZES) - COLOURS,
        standing=Standing.CASE,
        example={SIZES[0]: 1, SIZES[1]: 1},
    )


STRUCK = _struck_by(1)


def bound_matrix(K: Any) -> Any:
    """The matrix (S - B) I - 2 K."""
    return (SPREAD - BUDGET) * Matrix.eye(4) - 2 * K


def _definite_by(built: Callable[[Any], Any]) -> Hypothesis:
    A = built(K)
    return positive_by(
        r"$(S - B)\, I - 2 K \succ 0$, and so its form is positive at $p \ne 0$.",
        (P.T * A * P)[0],
        further=lambda point: definite_at(A, point),
        standing=Standing.CASE,
    )


DEFINITE = _definite_by(bound_matrix)


def refutes(rows: Sequence[Row], weights: Sequence[int]) -> bool:
    """Whether no motion brings these rows within their bounds, with the functions of the checker.

    False means not refuted by these weights.
    """
    points = [(1, *row[:6]) for row in rows]
    table = [
        [sum(w * a[i] * a[j] for w, a in zip(weights, points, strict=True)) for j in range(7)]
        for i in range(7)
    ]
    limits = sum(w * row[6] ** 2 for w, row in zip(weights, rows, strict=True))
    left = sum(spreads(table)) - table[0][0] * limits
    turned = davenport(cross(table))
    return definite([[left * (i == j) - 2 * turned[i][j] for j in range(4)] for i in range(4)])


def mirrored(bound: int) -> list[list[int]]:
    """Four pairs, the targets the mirror images of the sources, with this bound each."""
    corners = [[10 * (i == j) for j in range(3)] for i in range(-1, 3)]
    return [[*corner, *corner[:2], -corner[2], bound] for corner in corners]


def proof(
    test: Test = refutes,
    built: Callable[[Any], Any] = bound_matrix,
    *,
    groups: int = 1,
    own: int = 1,
) -> Proof:
    """The sum within the bounds; the least sum; what the checker decides; groups; mirror images."""
    yield from _sums(built)
    yield from _groups(groups, own)
    yield _numbers(test)


def _sums(built: Callable[[Any], Any]) -> Proof:
    triples = list(zip(WEIGHTS, LIMITS, RESIDUALS, strict=True))
    yield nonnegative(
        r"If one motion brings all pairs of a set $T$ within their bounds, then $\sum \lambda_i "
        r"|r_i|^2 \le \sum \lambda_i \beta_i^2 = B$, as each summand of the difference is "
        r"$\lambda_i\,(\beta_i^2 - |r_i|^2) \ge 0$ (three pairs written out).",
        sum(w * (b**2 - square(r)) for w, b, r in triples),
        [[LIGHT[k], WITHIN[k]] for k in range(3)],
    )
    cloud, shift = MomentCloud(), vector("c")
    yield combination(
        "At a rotation $R$ and a translation that is $c$ off the best one that sum is $S - "
        r"2\operatorname{tr}(R^{\mathsf T} C) + M|c|^2$, with the weights $\lambda$ for masses "
        r"and $S = \operatorname{tr} S_2 + \operatorname{tr} T_2$: at least $S - 2 p^{\mathsf T} "
        "K p$ for $R = R(p)$, $|p| = 1$ (claim `davenport`).",
        cloud.total(square(cloud.y - R * cloud.x - shift))
        - cloud.mass * square(shift)
        - cloud.target_scatter.trace()
        - cloud.source_scatter.trace()
        + 2 * inner(R, cloud.cross),
        contraction(cloud.source_scatter, ROTATION),
    )
    given = DEFINITE if built is bound_matrix else _definite_by(built)
    yield positive(
        r"Where $(S - B)\, I - 2 K$ is positive definite, $S - 2 p^{\mathsf T} K p > B$ for all "
        "unit $p$, here times $|p|^2$: at every motion the sum is above $B$, so that none brings "
        "all of $T$ within the bounds. $T$ is refuted.",
        (SPREAD - BUDGET) * square(P) - 2 * (P.T * K * P)[0],
        [[given[0]]],
    )


def _groups(groups: int, own: int) -> Proof:
    struck = STRUCK if own else _struck_by(own)
    yield positive(
        "Let a motion bring $e$ and others that are left within their bounds, $k$ pairs in all; "
        r"they are neighbours of $e$. Let disjoint groups $T_1, T_2, \ldots$ of neighbours of $e$ "
        "be refuted, each together with $e$: of $T_g$ at most $|T_g| - 1$ are within. Let the "
        "other neighbours have $c$ colours: of them at most $c$ are within (claim "
        r"`few_colours`). So if $1 + \sum_g (|T_g| - 1) + c < K$, then $k < K$, and $e$ is struck "
        "(two groups written out).",
        LEAST - 1 - sum(PARTS),
        [[SHORT[0]], [SHORT[1]], [COLOURED[0]], [struck[0]]],
    )
    omitted = POOL - LEAST
    yield identity(
        "In particular, of $n$ pairs that are left let $r = n - K$: with $r + 1$ groups and a "
        "colour for each pair beside them, the number on the left is $1 + (n - 1) - (r + 1) = K - "
        "1$.",
        1 + (POOL - 1) - (omitted + groups),
        LEAST - 1,
    )


def _numbers(test: Test) -> Any:
    rows, ones = mirrored(4), (1, 1, 1, 1)
    lengths = [
        refuted(_apart(a[:3], b[:3]), _apart(a[3:6], b[3:6]), a[6] + b[6])
        for a in rows
        for b in rows
    ]
    return facts(
        "Mirror images, $x = 0$, $10 e_1$, $10 e_2$, $10 e_3$ and $y = 0$, $10 e_1$, $10 e_2$, "
        "$-10 e_3$, agree in all lengths. The least sum of squares is $100$: with bounds of $4$, "
        "$B = 64$, the equal weights refute them, by `certreg.verify.definite` and the sums of "
        "the checker. With bounds of $5$ it is $B$, and they do not. Three of the four are not "
        "refuted: the mirror image of a triangle is the triangle, turned.",
        [any(lengths), test(rows, ones), test(mirrored(5), ones), test(rows[:3], (1, 1, 1))],
        [False, True, False, False],
    )


def _apart(a: Row, b: Row) -> int:
    """The squared distance."""
    return sum((u - v) ** 2 for u, v in zip(a, b, strict=True))


def _without_bounds(rows: Sequence[Row], weights: Sequence[int]) -> bool:
    return refutes([[*row[:6], 0] for row in rows], weights)


CLAIM = Claim(
    name="weighted_refutation",
    title="Weights that refute pairs together",
    statement=r"Let $\lambda_i \ge 0$ be weights of the pairs of a set $T$. If $(S - B)\, I - 2 "
    "K$ is positive definite, with $K$ Davenport's matrix, $S$ the sum of the traces of both "
    r"scatters, of these weights, and $B = \sum \lambda_i \beta_i^2$, then no rigid motion brings "
    "all pairs of $T$ within their bounds. If disjoint groups $T_g$ of neighbours of a pair $e$ "
    r"are refuted so, each with $e$ in it, the other neighbours have $c$ colours, and $1 + \sum_g "
    "(|T_g| - 1) + c < K$, then no motion brings $e$ and $K - 1$ others within their bounds: "
    "strike it. Of $n$ pairs left, $n - K + 1$ groups are enough.",
    concludes=tuple(range(1, 7)),
    hypotheses=(LIGHT, WITHIN, ROTATION, DEFINITE, SHORT, COLOURED, STRUCK),
    setting=(
        "$k_0$ of the other neighbours, $k_1$ and $k_2$ of the groups are within.",
        "$t_g = |T_g|$.",
    ),
    source="elementary; weak duality",
    proof=proof,
    controls={
        "S - B less K only": Mutation(
            at=3,
            proof=lambda: proof(built=lambda K: bound_matrix(K) + K),
            point={SPREAD: 4, P[0]: 1} | {K[i, i]: 3 for i in range(4)},
        ),
        "a count without e itself": Mutation(
            at=4,
            proof=lambda: proof(own=0),
            point={SIZES[0]: 1, SIZES[1]: 1, LEAST: 1},
        ),
        "a group less": Mutation(at=5, proof=lambda: proof(groups=0)),
        "weights that refute whatever the bounds": Mutation(
            at=6, proof=lambda: proof(_without_bounds)
        ),
    },
    not_claimed="That pairs which no weights refute are within their bounds under one motion: the "
    "least sum of squares is a bound of the least maximum, and not more.",
    needs=("davenport", "translation_gap", "few_colours", "elimination"),
    runs=(
        "certreg.verify.spreads",
        "certreg.verify.cross",
        "certreg.verify.davenport",
        "certreg.verify.definite",
    ),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
