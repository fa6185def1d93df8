"""Claim: pairs that one rigid motion brings within their bounds are neighbours of one another."""

from __future__ import annotations

from typing import Any

from ..algebra import facts, nonnegative
from ..graphs import SIZE, Graph, Rule, graphs, kept, lost, members
from ..hypothesis import nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..notation import scalar

MEMBERS, LEAST, OTHERS = scalar("k"), scalar("K"), scalar("n")
ENOUGH = nonnegative_by("$k \\ge K$.", MEMBERS - LEAST, example={LEAST: 1})
MORE = nonnegative_by("$n \\ge 0$.", OTHERS, example={OTHERS: -1})


def proof(rule: Rule = kept, *, missing: int = 1) -> Proof:
    """The number of neighbours; all small graphs; the order."""
    yield nonnegative(
        r"Let a rigid motion bring $k \ge K$ of the pairs that are left within their bounds. Any "
        "two of them are neighbours (claim `pair_lengths`). So each has the $k - 1$ others as "
        r"neighbours, and $n \ge 0$ more: at least $K - 1$, as $(k - 1 + n) - (K - 1) = (k - K) + "
        "n$.",
        MEMBERS - 1 + OTHERS - (LEAST - missing),
        [[ENOUGH[0]], [MORE[0]]],
    )
    yield facts(
        "So none of the $k$ is struck, and after that they are still $k$ pairs of what is left: "
        "by induction none is ever struck. `certreg.verify.Thinning.after` on all $1024$ graphs "
        "with five vertices, for $K = 3, 4, 5$: no clique of $K$ vertices or more loses a vertex, "
        "while $12050$ vertices are struck.",
        lost(rule),
        [0, 12050],
    )
    yield _order(rule)


def _order(rule: Rule) -> Any:
    apart = sum(
        rule(near, (1 << SIZE) - 1, K) != _backwards(rule, near, K)
        for near in graphs()
        for K in (3, 4)
    )
    return facts(
        "What is left does not depend on the order: it is the largest set in which each has $K - "
        "1$ neighbours within the set, as the union of two such sets is one, and no vertex of "
        "such a set is struck. With the vertices numbered backwards the same are left, in all "
        "these graphs.",
        [apart],
        [0],
    )


def _backwards(rule: Rule, near: Graph, K: int) -> int:
    """What a rule leaves of the graph whose vertices are numbered backwards, numbered as before."""
    return _mirrored(rule([_mirrored(near[SIZE - 1 - i]) for i in range(SIZE)], (1 << SIZE) - 1, K))


def _mirrored(vertices: int) -> int:
    return sum(1 << SIZE - 1 - i for i in members(vertices))


def _greedy(near: Graph, alive: int, K: int) -> int:
    """The vertices left if K neighbours are asked for."""
    return kept(near, alive, K + 1)


CLAIM = Claim(
    name="few_neighbours",
    title="Many pairs within their bounds are many neighbours",
    statement="Call two pairs neighbours if their lengths do not refute them (claim "
    "`pair_lengths`). If a rigid motion brings at least $K$ pairs within their bounds, these are "
    "neighbours of one another, and each has at least $K - 1$ neighbours. So a pair with fewer is "
    "not among them: strike it. Then the same holds of the pairs that are left, until none has "
    "fewer; which are left does not depend on the order.",
    concludes=(1, 2, 3),
    hypotheses=(ENOUGH, MORE),
    setting=("$k$ pairs are within their bounds; one of them has these and $n$ more neighbours.",),
    source="elementary",
    proof=proof,
    controls={
        "at least K neighbours": Mutation(
            at=1, proof=lambda: proof(missing=0), point={MEMBERS: 3, LEAST: 3}
        ),
        "a rule that asks for K neighbours": Mutation(at=2, proof=lambda: proof(_greedy)),
    },
    not_claimed="That pairs which are left are within their bounds under one motion.",
    needs=("pair_lengths",),
    runs=("certreg.verify.Thinning.after",),
    used_by=("certreg.certificate.vertex_elimination.GraphThinning",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
