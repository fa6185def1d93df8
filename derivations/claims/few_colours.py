"""Claim: where the neighbours of a pair are coloured with few colours, few of them go together."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from certreg.verify import RefusalError, colours

from ..algebra import facts, nonnegative
from ..graphs import EVERY, Graph, Rule, graph, graphs, kept, lost, members, thinned
from ..hypothesis import nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..notation import scalar

Count = Callable[[int, list[int], int], int]
MEMBERS, LEAST, IDLE = scalar("k"), scalar("K"), scalar("n")
ENOUGH = nonnegative_by("$k \\ge K$.", MEMBERS - LEAST, example={LEAST: 1})
EMPTY = nonnegative_by("$n \\ge 0$.", IDLE, example={IDLE: -1})
WHEEL = graph([(0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1)])


def colouring(near: Graph, vertices: int) -> list[int]:
    """Sets without two neighbours that make up the vertices, each as large as it becomes."""
    classes: list[int] = []
    while vertices:
        one = 0
        for i in members(vertices):
            if near[i] & one == 0:
                one |= 1 << i
        classes.append(one)
        vertices &= ~one
    return classes


def faded(near: Graph, alive: int, K: int) -> int:
    """The vertices left if those are struck whose neighbours need fewer than K - 1 colours."""
    most = K - 2
    return thinned(near, alive, lambda _, left: colours(left, [*near], most) <= most)


def proof(rule: Rule = faded, count: Count = colours, *, missing: int = 1) -> Proof:
    """The number of colours; the colouring; all small graphs; a wheel."""
    yield nonnegative(
        r"Let a rigid motion bring $k \ge K$ of the pairs that are left within their bounds, and "
        "let the neighbours of one of them be coloured so that no two of one colour are "
        "neighbours. The $k - 1$ others are neighbours of one another, so they have $k - 1$ "
        r"colours; with $n \ge 0$ more that none of them has, the colours are at least $K - 1$: "
        "$(k - 1 + n) - (K - 1) = (k - K) + n$.",
        MEMBERS - 1 + IDLE - (LEAST - missing),
        [[ENOUGH[0]], [EMPTY[0]]],
    )
    yield _proper(count)
    yield facts(
        "As before, by induction, no vertex of such a set is struck. For $K = 3, 4, 5$, on all "
        "these graphs, no clique of $K$ vertices or more loses a vertex, while $12685$ vertices "
        "are struck.",
        lost(rule),
        [0, 12685],
    )
    yield facts(
        "That is more than for few neighbours. The hub of a wheel with four spokes has four, and "
        "the rim needs two colours: for $K = 4$ each vertex has three neighbours or four, and "
        "`certreg.verify.Thinning.after` strikes the hub, and after it all. For $K = 3$ it "
        "refuses to.",
        [kept(WHEEL, EVERY, 4), kept(WHEEL, EVERY, 4, [[0]]), _refused(WHEEL, 3)],
        [EVERY, 0, True],
    )


def _refused(near: Graph, K: int) -> bool:
    """Whether the checker refuses to strike the first vertex."""
    try:
        kept(near, EVERY, K, [[0]])
    except RefusalError:
        return True
    return False


def _proper(count: Count) -> Any:
    """The colouring is one, of all graphs, and it has as many colours as the checker says."""
    improper = other = 0
    for near in graphs():
        classes = colouring(near, EVERY)
        improper += any(near[i] & one for one in classes for i in members(one))
        improper += sum(classes) != EVERY
        other += any(count(EVERY, near, most) != min(len(classes), most + 1) for most in (1, 2, 5))
    return facts(
        "Each vertex in turn takes the first colour that no neighbour has. On all $1024$ graphs "
        "with five vertices no two neighbours have one colour, each vertex has one, and there are "
        "as many as `certreg.verify.colours` says.",
        [improper, other],
        [0, 0],
    )


def _greedy(near: Graph, alive: int, K: int) -> int:
    """The vertices left if K colours are asked for."""
    return faded(near, alive, K + 1)


def _one(mask: int, _near: Graph, _most: int) -> int:
    return int(mask > 0)


CLAIM = Claim(
    name="few_colours",
    title="Neighbours with few colours",
    statement="Call two pairs neighbours if their lengths do not refute them, and colour the "
    "neighbours of a pair so that no two of one colour are neighbours. If a rigid motion brings "
    "that pair and $K - 1$ others at least within their bounds, there are at least $K - 1$ "
    "colours. So a pair for whose neighbours fewer are enough is not among them: strike it.",
    concludes=(1, 2, 3, 4),
    hypotheses=(ENOUGH, EMPTY),
    setting=("$k$ pairs are within their bounds; the neighbours of one have $k - 1 + n$ colours.",),
    source="elementary; a bound of the largest clique",
    proof=proof,
    controls={
        "at least K colours": Mutation(
            at=1, proof=lambda: proof(missing=0), point={MEMBERS: 3, LEAST: 3}
        ),
        "a rule that asks for K colours": Mutation(at=3, proof=lambda: proof(_greedy)),
        "a colour for all": Mutation(at=2, proof=lambda: proof(count=_one)),
        "that few neighbours strike as many": Mutation(at=3, proof=lambda: proof(kept)),
    },
    not_claimed="That the colours are as few as possible: more of them strike less.",
    needs=("pair_lengths", "few_neighbours"),
    runs=("certreg.verify.colours", "certreg.verify.Thinning.after"),
    used_by=("certreg.certificate.vertex_elimination.GraphThinning",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
