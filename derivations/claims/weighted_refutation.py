"""Claim: weights whose least sum of squares is too large show that pairs do not go together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Any

from certreg.geometry.so3 import squared_norm
from certreg.verify import (
    RefusalError,
    Thinning,
    consistent,
    definite,
    quadratic,
    raised,
    weighed,
)

from ..algebra import combination, contraction, facts, identity, nonnegative, positive
from ..graphs import LOOKS
from ..hypotheses import ROTATION
from ..hypotheses import definite as definite_at
from ..hypothesis import Hypothesis, Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..notation import Matrix, entry, inner, matrix, quaternion, scalar, square, symmetric, vector
from ..rationals import apply, rotation_of, scale, subtract

Row = list[int]  # x, y, weight, bound
Test = Callable[[list[Row], Sequence[int]], bool]
Hit = Callable[[Thinning, list[int], int], bool]
Weighed = Callable[[list[Row], Sequence[int]], tuple[int, int, Any]]
ROWS = (
    [1, 0, 2, 3, -1, 0, 1, 2],
    [-3, 4, 0, 0, 5, 1, 1, 1],
    [0, 5, 1, 2, 2, -7, 1, 3],
    [6, -2, 3, -4, 1, 1, 1, 5],
)
HITS: Hit = vars(Thinning)["_hit"]
LAMBDA = (2, 0, 3, 1)
TURNS = (1, 0, 0, 0), (1, 2, 3, 4), (0, 5, -1, 2)
SPREAD, BUDGET = scalar("S"), scalar("B")
K, P, R = symmetric("K", 4), quaternion("p"), matrix("R")
WEIGHTS = [entry("lambda", i) for i in (1, 2, 3)]
LIMITS = [entry("beta", i) for i in (1, 2, 3)]
RESIDUALS = [vector(f"r{i}") for i in (1, 2, 3)]
LEAST, MEMBERS, COLOURS = scalar("K"), scalar("k"), scalar("c")
UNION, HIT = scalar("u"), scalar("r")  # pairs of all groups; so many do not hit every group
PARTS = [entry("k", i) for i in (0, 1)]  # of the rest, of the groups: within their bounds
POOL = scalar("n")

LIGHT = nonnegative_by(r"$\lambda_i \ge 0$.", WEIGHTS, example={WEIGHTS[0]: -1, LIMITS[0]: 1})
WITHIN = nonnegative_by(
    r"One motion brings the pairs within their bounds: $|r_i| \le \beta_i$.",
    [limit**2 - square(r) for limit, r in zip(LIMITS, RESIDUALS, strict=True)],
    standing=Standing.CASE,
    example={WEIGHTS[0]: 1, RESIDUALS[0][0]: 1},
)
SHORT = nonnegative_by(
    "Of each group a pair is not within, and no $r$ pairs hit all groups.",
    UNION - HIT - 1 - PARTS[1],
    standing=Standing.CASE,
    example={PARTS[1]: 2, UNION: 2, HIT: 1, LEAST: 2},
)
COLOURED = nonnegative_by(
    "Of the rest there are no more within than colours.",
    COLOURS - PARTS[0],
    standing=Standing.CASE,
    example={PARTS[0]: 3, UNION: 1, LEAST: 2},
)


def _struck_by(own: int) -> Hypothesis:
    """The count is below K; own: 1 if e itself is counted."""
    return positive_by(
        "$1 + (u - r - 1) + c < K$.",
        LEAST - own - (UNION - HIT - 1) - COLOURS,
        standing=Standing.CASE,
        example={UNION: 1},
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


def refutes(rows: list[Row], weights: Sequence[int]) -> bool:
    """Whether no motion brings these rows within their bounds, with the functions of the checker.

    False means not refuted by these weights.
    """
    squares, limits, turned = weighed(rows, weights)
    return definite(raised([[-2 * entry for entry in line] for line in turned], squares - limits))


def mirrored(bound: int) -> list[Row]:
    """Four pairs, the targets the mirror images of the sources, with this bound each."""
    corners = [[10 * (i == j) for j in range(3)] for i in range(-1, 3)]
    return [[*corner, *corner[:2], -corner[2], 1, bound] for corner in corners]


def proof(
    test: Test = refutes,
    built: Callable[[Any], Any] = bound_matrix,
    sums: Weighed = weighed,
    hit: Hit = HITS,
    *,
    groups: int = 1,
    own: int = 1,
) -> Proof:
    """The sum within the bounds; the least sum; what the checker decides; groups; mirror images."""
    yield from _sums(built)
    yield from _groups(groups, own)
    yield _hitting(hit)
    yield _decided(sums)
    yield from _numbers(test)


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
        r"they are neighbours of $e$. Let groups $T_1, T_2, \ldots$ of neighbours of $e$ be "
        "refuted, each together with $e$: of each at least one pair is not within. If no $r$ "
        "pairs hit all groups (hold one of each), more than $r$ of their $u$ pairs are not "
        "within. Let the other neighbours have $c$ colours: of them at most $c$ are within "
        "(claim `few_colours`). So if $1 + (u - r - 1) + c < K$, then $k < K$, and $e$ is struck.",
        LEAST - 1 - sum(PARTS),
        [[SHORT[0]], [COLOURED[0]], [struck[0]]],
    )
    omitted = POOL - LEAST
    yield identity(
        "In particular $g$ disjoint groups are not hit by $g - 1$ pairs. Of $n$ pairs that are "
        "left let $r = n - K$: with $r + 1$ disjoint groups and a colour for each pair beside "
        "them, the number on the left is $1 + (n - 1) - (r + 1) = K - 1$.",
        1 + (POOL - 1) - (omitted + groups),
        LEAST - 1,
    )


def _hitting(hit: Hit) -> Any:
    """Of all families of three sets of four rows: whether so many rows hit them."""
    thinning = Thinning([[0]] * 4, [], 0, 0, [10**6])
    wrong = 0
    for sets in combinations_with_replacement(range(1, 16), 3):
        least = min(rows.bit_count() for rows in range(16) if all(rows & T for T in sets))
        wrong += any(hit(thinning, [*sets], most) != (least <= most) for most in range(-1, 4))
    return facts(
        "The checker looks for $r$ pairs that hit all groups: each pair of the first group is "
        "tried. Of all $680$ families of three groups of four pairs it finds the least $r$.",
        [wrong],
        [0],
    )


def _decided(sums: Weighed) -> Any:
    squares, limits, turned = sums([*ROWS], LAMBDA)
    mass = sum(LAMBDA)
    least = [_least_at(q) * mass for q in TURNS]
    told = [squares - Fraction(2 * quadratic(turned, q), squared_norm(q)) for q in TURNS]
    bound = sum(w * row[7] ** 2 for w, row in zip(LAMBDA, ROWS, strict=True))
    return facts(
        r"`certreg.verify.weighed` has these numbers times $\sum \lambda$, and so no quotient: of "
        r"four pairs at three rotations, $S - 2 p^{\mathsf T} K p/|p|^2$ is the sum at the best "
        "translation, which is computed in fractions.",
        [*told, limits],
        [*least, mass * bound],
    )


def _least_at(q: Sequence[int]) -> Fraction:
    """The weighted sum of squares of the rows at a rotation and its best translation."""
    R, mass = rotation_of(q), sum(LAMBDA)
    missed = [subtract(tuple(row[3:6]), apply(R, tuple(row[:3]))) for row in ROWS]
    weighted = [scale(w, off) for w, off in zip(LAMBDA, missed, strict=True)]
    mean = tuple(sum(column, start=Fraction(0)) / mass for column in zip(*weighted, strict=True))
    total = Fraction(0)
    for w, off in zip(LAMBDA, missed, strict=True):
        total += w * squared_norm(subtract(off, mean))
    return total


def _numbers(test: Test) -> Proof:
    rows, ones = mirrored(4), (1, 1, 1, 1)
    yield facts(
        "Mirror images, $x = 0$, $10 e_1$, $10 e_2$, $10 e_3$ and $y = 0$, $10 e_1$, $10 e_2$, "
        "$-10 e_3$, agree in all lengths. The least sum of squares is $100$: with bounds of $4$, "
        "$B = 64$, the equal weights refute them, by `certreg.verify.definite`. With bounds of "
        "$5$ it is $B$, and they do not. Three of the four are not refuted: the mirror image of a "
        "triangle is the triangle, turned.",
        [consistent(rows), test(rows, ones), test(mirrored(5), ones), test(rows[:3], ones[:3])],
        [[14, 13, 11, 7], True, False, False],
    )
    yield facts(
        "`certreg.verify.Thinning.after` strikes the first of them with the other three for a "
        "group, for $K = 4$, and then the others, which have too few neighbours. With bounds of "
        "$5$ it refuses, and for $K = 3$, where $1 + (3 - 1) = K$, also if the group is said "
        "twice.",
        [_struck(4, 4), _struck(5, 4), _struck(4, 3), _struck(4, 3, said=2)],
        [0, None, None, None],
    )


def _struck(bound: int, K: int, said: int = 1) -> int | None:
    """What is left of the mirror images after the first is struck; None if that is refused."""
    rows = mirrored(bound)
    thinning = Thinning(rows, consistent(rows), 15, K, [LOOKS])
    try:
        return thinning.after([[0, *[[[1, 2, 3], [1, 1, 1, 1]]] * said]])
    except RefusalError:
        return None


def _without_bounds(rows: list[Row], weights: Sequence[int]) -> bool:
    return refutes([[*row[:7], 0] for row in rows], weights)


def _one_each(_thinning: Thinning, sets: list[int], most: int) -> bool:
    return len(sets) <= most


def _without_mass(rows: list[Row], weights: Sequence[int]) -> tuple[int, int, Any]:
    squares, limits, turned = weighed(rows, weights)
    return squares, limits // sum(weights), turned


CLAIM = Claim(
    name="weighted_refutation",
    title="Weights that refute pairs together",
    statement=r"Let $\lambda_i \ge 0$ be weights of the pairs of a set $T$. If $(S - B)\, I - 2 "
    "K$ is positive definite, with $K$ Davenport's matrix, $S$ the sum of the traces of both "
    r"scatters, of these weights, and $B = \sum \lambda_i \beta_i^2$, then no rigid motion brings "
    "all pairs of $T$ within their bounds. If groups of neighbours of a pair $e$ are refuted so, "
    "each with $e$ in it, no $r$ pairs hit all groups, which have $u$ pairs, the other "
    "neighbours have $c$ colours, and $1 + (u - r - 1) + c < K$, then no motion brings $e$ and "
    "$K - 1$ others within their bounds: strike it. Of $n$ pairs left, $n - K + 1$ disjoint "
    "groups are enough.",
    concludes=tuple(range(1, 10)),
    hypotheses=(LIGHT, WITHIN, ROTATION, DEFINITE, SHORT, COLOURED, STRUCK),
    setting=("$k_0$ of the other neighbours and $k_1$ of the groups are within.",),
    source="elementary; weak duality",
    proof=proof,
    witness={SPREAD: 1, P[0]: 1} | dict.fromkeys(R.diagonal(), 1),
    controls={
        "S - B less K only": Mutation(
            at=3,
            proof=lambda: proof(built=lambda K: bound_matrix(K) + K),
            point={SPREAD: 4, P[0]: 1} | {K[i, i]: 3 for i in range(4)},
        ),
        "a count without e itself": Mutation(
            at=4, proof=lambda: proof(own=0), point={UNION: 1, LEAST: 1}
        ),
        "a group less": Mutation(at=5, proof=lambda: proof(groups=0)),
        "groups that need a pair each": Mutation(at=6, proof=lambda: proof(hit=_one_each)),
        "bounds that are not multiplied": Mutation(at=7, proof=lambda: proof(sums=_without_mass)),
        "weights that refute whatever the bounds": Mutation(
            at=8, proof=lambda: proof(_without_bounds)
        ),
    },
    not_claimed="That pairs which no weights refute are within their bounds under one motion: the "
    "least sum of squares is a bound of the least maximum, and not more.",
    needs=("davenport", "translation_gap", "few_colours", "elimination"),
    runs=(
        "certreg.verify.weighed",
        "certreg.verify.raised",
        "certreg.verify.definite",
        "certreg.verify.Thinning.after",
        "certreg.verify.Thinning._hit",
    ),
    used_by=(
        "certreg.certificate.infeasibility_weights.PointRows.refutation",
        "certreg.certificate.vertex_elimination.GraphThinning",
    ),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
