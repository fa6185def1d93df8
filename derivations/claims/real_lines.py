"""Claim: at least four real equilibria; if none is degenerate, of every index, in even number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

from certreg.objective.springs import Springs

from ..algebra import combination, facts, nonnegative, quoted
from ..hypothesis import nonnegative_by, vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import entry
from ..rationals import rank_modulo
from .forty_real import index_of, lines, six_planes

Indices = Callable[..., int | None]
C = [entry("c", k) for k in range(4)]
BETTI = (1, 1, 1, 1)
HELD = (1, 1, 1)
MINIMUM = nonnegative_by(r"By Morse, quoted: $c_0 \ge 1$.", C[0] - 1)
SADDLES = nonnegative_by(
    r"By Morse, quoted: $c_1 - c_0 \ge 0$.",
    C[1] - C[0],
    example={C[0]: 1, C[1]: 0, C[2]: 1, C[3]: 2},
)
MIDDLE = nonnegative_by(
    r"By Morse, quoted: $c_2 - c_1 + c_0 \ge 1$.",
    C[2] - C[1] + C[0] - 1,
    example={C[0]: 1, C[1]: 1},
)
EULER = vanishing(
    r"By Morse, quoted: $c_3 - c_2 + c_1 - c_0 = 0$.",
    C[3] - C[2] + C[1] - C[0],
    solves=(C[3],),
    example={C[0]: 1, C[1]: 1, C[2]: 1},
)


def cells() -> dict[int, list[tuple[int, ...]]]:
    """Faces of a cube's dual in four dimensions, up to the sign, by their dimension.

    A face is the vector of the signs of its corners +-e_i.
    """
    found: dict[int, list[tuple[int, ...]]] = {k: [] for k in range(4)}
    for face in product((0, 1, -1), repeat=4):
        if next((entry for entry in face if entry), 0) == 1:
            found[sum(map(abs, face)) - 1].append(face)
    return found


def edges(face: Sequence[int]) -> list[tuple[int, ...]]:
    """The faces of one dimension less on its rim, one of each opposite pair."""
    left = [
        tuple(0 if k == gone else entry for k, entry in enumerate(face))
        for gone in range(4)
        if face[gone]
    ]
    signs = [next((entry for entry in rim if entry), 0) for rim in left]
    return [tuple(s * e for e in rim) for s, rim in zip(signs, left, strict=True) if s]


def betti_numbers(rim: Callable[[Sequence[int]], list[tuple[int, ...]]] = edges) -> list[int]:
    """Of the sphere with opposite points made one, modulo 2."""
    every = cells()
    ranks = [0]
    for k in (1, 2, 3):
        rows = [[int(below in rim(face)) for below in every[k - 1]] for face in every[k]]
        ranks.append(rank_modulo(rows, 2))
    ranks.append(0)
    return [len(every[k]) - ranks[k] - ranks[k + 1] for k in range(4)]


def proof(index: Indices = index_of, *, least: int = 4, betti: Sequence[int] = BETTI) -> Proof:
    """The topology of the rotations, Morse's inequalities and what follows from them."""
    yield facts(
        r"Rotations are unit quaternions up to the sign. Cut the unit sphere in four dimensions by "
        r"the coordinate planes into 8, 24, 32 and 16 cells, one for each sign vector; opposite "
        r"ones made one, 4, 12, 16 and 8 are left. By the ranks of their boundaries modulo 2 the "
        r"Betti numbers modulo 2 are 1, 1, 1, 1.",
        betti_numbers(),
        list(betti),
    )
    yield quoted(
        r"Morse's inequalities: of a smooth function on a closed manifold without degenerate "
        r"critical points, $c_k$ of them of index $k$, $c_k - c_{k-1} + \ldots \pm c_0 \ge b_k - "
        r"b_{k-1} + \ldots \pm b_0$ for every $k$, with equality for the last. Here the right "
        r"sides are $1, 0, 1, 0$.",
        theorem="Morse's inequalities",
        source="[Milnor1963]",
    )
    c = C
    yield nonnegative(
        r"So each index occurs: $c_0 \ge 1$; $c_1 \ge c_0 \ge 1$;",
        c[1] - 1,
        [[SADDLES[0]], [MINIMUM[0]]],
    )
    yield nonnegative(
        r"$c_2 \ge 1 + c_1 - c_0 \ge 1$;",
        c[2] - 1,
        [[MIDDLE[0]], [SADDLES[0]]],
    )
    yield combination(
        r"and $c_3 = c_2 - c_1 + c_0 \ge 1$, as the former is 1 at least: $c_3 - 1$ is what is not "
        r"negative there.",
        c[3] - 1 - (c[2] - c[1] + c[0] - 1),
        [(1, EULER[0])],
    )
    yield combination(
        r"Their number is even, twice $c_0 + c_2$; as many have an even as have an odd index. (And "
        r"the lines that are not real come in conjugate pairs: if there are 40 in all, an even "
        r"number is left.)",
        sum(c) - 2 * (c[0] + c[2]),
        [(1, EULER[0])],
    )
    yield quoted(
        r"Degenerate or not, there are at least four: the classes of degree one of the rotations "
        r"modulo 2 have a cube that is not zero, and a function has more critical points than "
        r"that product has factors.",
        theorem="the theorem of Lusternik and Schnirelmann",
        source="[Cornea2003]",
    )
    yield from _seen(index, least)


def _seen(index: Indices, least: int) -> Proof:
    found = [index(Springs.hessian, six_planes(), q) for q in lines()]
    yield facts(
        r"Two examples. The six planes of claim `forty_real`: 8, 16, 12 and 4 lines of index 0, 1, "
        r"2 and 3, and $8 - 16 + 12 - 4 = 0$.",
        [*(found.count(k) for k in range(4)), sum((-1) ** (k or 0) for k in found)],
        [8, 16, 12, 4, 0],
    )
    levels = (1, 2, 4, 7)
    below = [sum(other < level for other in levels) for level in levels]
    yield facts(
        r"And four are attained: with one weight for each pair $F$ is $|q|^2$ times a quadratic "
        r"form, here with the eigenvalues $1, 2, 4, 7$, whose real critical lines are the four "
        r"eigenvectors, one of each index.",
        [*below, len(levels)],
        [0, 1, 2, 3, least],
    )


CLAIM = Claim(
    name="real_lines",
    title="At least four real equilibria",
    statement=r"The energy of any springs has at least four critical rotations. If none is "
    r"degenerate, let $c_k$ be the number of those of index $k$. Then $c_k \ge 1$ for $k = 0, 1, "
    r"2, 3$, $c_0 - c_1 + c_2 - c_3 = 0$, and their number is even.",
    concludes=(1, 3, 4, 5, 6, 8, 9),
    hypotheses=(MINIMUM, SADDLES, MIDDLE, EULER),
    setting=("Where $c_k$ stand, no critical rotation is degenerate.",),
    source="Morse and Lusternik–Schnirelmann, [Milnor1963] and [Cornea2003]",
    proof=proof,
    controls={
        "the Betti numbers of the sphere": Mutation(at=1, proof=lambda: proof(betti=(1, 0, 0, 1))),
        "at least five": Mutation(at=9, proof=lambda: proof(least=5)),
        "one index too many": Mutation(
            at=8, proof=lambda: proof(lambda *parts: (index_of(*parts) or 0) + 1)
        ),
    },
    not_claimed=r"That more than one is stable, or that only one is. That none is degenerate: "
    r"this is decided for each problem.",
    needs=("forty_real", "forty_lines"),
    standard=(
        "The rotations are a closed manifold; boundaries of cells modulo 2 give its homology.",
    ),
    runs=("certreg.objective.objective.Objective.hessian",),
    used_by=("certreg.equilibrium.paths.critical_lines",),
    not_in_coq="All of it: nothing in Coq speaks of topology.",
)
