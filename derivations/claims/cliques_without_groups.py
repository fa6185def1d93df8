"""Claim: a pair falls where no clique of its neighbours that is large enough holds no group."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from certreg.verify import RefusalError, Thinning, has_clique

from ..algebra import facts, nonnegative
from ..graphs import EVERY, LOOKS, Graph, graph, graphs, is_clique, kept
from ..hypothesis import nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..notation import scalar

Search = Callable[[list[int], int, list[int], int, Callable[[int], None]], bool]
MEMBERS, LEAST, OWN = scalar("k"), scalar("K"), scalar("c")
ENOUGH = nonnegative_by("$k \\ge K$.", MEMBERS - LEAST, example={LEAST: 1})
# Of five vertices, as bits: none; one vertex; two edges at a vertex; three edges; two triples.
FAMILIES = ((), (1,), (3, 6), (3, 12, 18), (7, 28))
RING = graph([(1, 2), (2, 3), (3, 4), (4, 1), *((0, i) for i in range(1, 5))])
SIDES = ((1, 2), (2, 3), (3, 4), (4, 1))
BESIDE = graph([*((i, j) for i in range(6) for j in range(i) if {i, j} not in ({1, 3}, {2, 4}))], 6)


def largest(near: Graph, sets: Sequence[int]) -> int:
    """The size of the largest clique of a graph that holds none of the sets as a whole."""
    return max(
        rows.bit_count()
        for rows in range(EVERY + 1)
        if is_clique(near, rows) and all(rows & T != T for T in sets)
    )


def proof(search: Search = has_clique, *, missing: int = 0) -> Proof:
    """The clique; the search; a row; two rows."""
    yield nonnegative(
        "Let $c = 1$ or $2$ pairs be given, the second a neighbour of the first, and groups, sets "
        "of their common neighbours, each of which is refuted together with them (claim "
        r"`weighted_refutation`). Let a motion bring these $c$ and others that are left within "
        r"their bounds, $k \ge K$ pairs in all. The $k - c$ others are neighbours of the $c$ and "
        "of one another, and they hold none of the groups as a whole: it is not within its bounds "
        "together with the $c$. Any $K - c$ of them are such a clique, too, and there are as "
        "many: $(k - c) - (K - c) = k - K$. So where no clique of $K - c$ common neighbours holds "
        "none of the groups, there is no such motion.",
        MEMBERS - OWN - (LEAST - OWN + missing),
        [[ENOUGH[0]]],
    )
    yield _searched(search)
    yield from _struck()


def _searched(search: Search) -> Any:
    wrong = there = 0
    for near in graphs():
        for sets in FAMILIES:
            most = largest(near, sets)
            found = [search(near, EVERY, [*sets], m, _free) for m in range(1, 6)]
            wrong += found != [m <= most for m in range(1, 6)]
            there += most
    return facts(
        "`certreg.verify.has_clique` takes the lowest vertex out or in, and then the next. A "
        "vertex goes out that is the last one of a group; so does all, where there are fewer "
        "colours than vertices still needed (claim `few_colours`). On all $1024$ graphs with five "
        "vertices and five families of groups it finds a clique of $1, \\ldots, 5$ vertices that "
        "holds no group just where one of the $32$ sets of vertices is one; the largest have "
        "$12562$ vertices in all.",
        [wrong, there],
        [0, 12562],
    )


def _free(_count: int) -> None:
    """The search may take what it takes."""


def rows(count: int) -> list[list[int]]:
    """Pairs as the checker has them, with bounds of 10.

    The first is lifted by 30 off the line on which the others stay where they are.
    """
    places = [900, -900, 800, -800, 700][: count - 1]
    return [[0, 0, 0, 0, 30, 0, 1, 10], *([k, 0, 0, k, 0, 0, 1, 10] for k in places)]


def _struck() -> Proof:
    one = [[[*side], [2, 1, 1]] for side in SIDES]
    yield facts(
        "A pair is lifted by $30$ off a line on which all others stay, $\\beta = 10$, and has "
        "four neighbours in a ring, which take two colours. The two at each side of the ring are "
        "on opposite sides of the pair, so they are refuted with it, by weights of $2$, $1$, $1$. "
        "For $K = 3$ counting does not strike it: two pairs hit all four groups, and $1 + (4 - 2) "
        "= K$. But each clique of two neighbours is a group: `certreg.verify.Thinning.after` "
        "strikes it, not with three of the groups, nor for $K = 2$, nor without any.",
        [_left(RING, 3, 0, one), _left(RING, 3, 0, one[:3]), _left(RING, 2, 0, one), _bare()],
        [EVERY & ~1, None, None, None],
    )
    two = [[[*side], [2, 0, 1, 1]] for side in SIDES]
    yield facts(
        "With one pair more, a neighbour of all, to which no weight is given, the same groups "
        "refute both together: for $K = 4$ the two are struck together, so that they have four "
        "neighbours each, and all stay. They are not with three groups, nor for $K = 3$.",
        [
            _left(BESIDE, 4, [0, 5], two),
            _left(BESIDE, 4, [0, 5], two[:3]),
            _left(BESIDE, 3, [0, 5], two),
        ],
        [63, None, None],
    )


def _left(near: Graph, K: int, head: Any, groups: Sequence[Any]) -> int | None:
    """What is left after one step; None where it is refused."""
    n = len(near)
    thinning = Thinning(rows(n), [*near], (1 << n) - 1, K, [LOOKS])
    try:
        return thinning.after([[head, *groups]])
    except RefusalError:
        return None


def _bare() -> int | None:
    """The same of the first pair without groups."""
    try:
        return kept(RING, EVERY, 3, [[0]])
    except RefusalError:
        return None


def _whatever(near: list[int], rows: int, _sets: list[int], count: int, look: Any) -> bool:
    return has_clique(near, rows, [], count, look)


def _taken(near: list[int], rows: int, sets: list[int], count: int, look: Any) -> bool:
    """A search that leaves out every row that a group holds."""
    union = 0
    for T in sets:
        union |= T
    return has_clique(near, rows & ~union, [], count, look)


def _one_more(near: list[int], rows: int, sets: list[int], count: int, look: Any) -> bool:
    return has_clique(near, rows, sets, count + 1, look)


CLAIM = Claim(
    name="cliques_without_groups",
    title="Cliques of neighbours that hold no refuted group",
    statement="Let groups of neighbours of a pair be refuted, each together with it (claim "
    "`weighted_refutation`). If no $K - 1$ of its neighbours are neighbours of one another without "
    "holding one of the groups as a whole, no rigid motion brings the pair and $K - 1$ others at "
    "least within their bounds: strike it. If groups of common neighbours of two pairs are refuted "
    "with both, and no $K - 2$ of these are neighbours of one another without holding a group, no "
    "motion that brings $K$ pairs within brings both within.",
    concludes=(1, 2, 3, 4),
    hypotheses=(ENOUGH,),
    setting=("$k$ pairs are within their bounds, $c$ given ones among them.",),
    source="elementary",
    proof=proof,
    controls={
        "cliques of one pair more": Mutation(
            at=1, proof=lambda: proof(missing=1), point={MEMBERS: 3, LEAST: 3}
        ),
        "a search that forgets the groups": Mutation(at=2, proof=lambda: proof(_whatever)),
        "a search that leaves all groups out": Mutation(at=2, proof=lambda: proof(_taken)),
        "a search for one pair more": Mutation(at=2, proof=lambda: proof(_one_more)),
    },
    not_claimed="That a motion meets the pair where there is such a clique.",
    needs=("pair_lengths", "few_neighbours", "few_colours", "weighted_refutation"),
    runs=("certreg.verify.has_clique", "certreg.verify.Thinning.after"),
    used_by=("certreg.certificate.clique_refutation.Assuming",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
