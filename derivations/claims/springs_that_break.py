"""Claim: where springs break, minima keep away from ties, and each is a least squares optimum."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from certreg.equilibrium.breaking import SpringSet
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.verify import consistent

from ..algebra import facts, identity, nonnegative, positive
from ..graphs import kept
from ..hypothesis import Hypothesis, Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import gradient, matrix, scalar, square, vector
from ..rationals import rank

Point = Sequence[int]
SLOPE, OTHERS, REST = scalar("f"), scalar("w"), scalar("g")
SUM, OWN, BROKEN, ENERGY = (scalar(name) for name in ("s", "s'", "o", "V"))
STIFF = scalar("k")

RISES = positive_by(
    r"$f > 0$: along some motion the tie has a slope, in one of its directions upwards.",
    SLOPE,
    standing=Standing.CASE,
)
MORE = nonnegative_by(
    r"$w \ge 0$, the sum of the sizes of the slopes of the other ties.",
    OTHERS,
    example={OTHERS: -1, SLOPE: 1},
)
TRUNCATED = nonnegative_by(
    "No spring has more energy than a broken one, or than it has unbroken.",
    SUM + BROKEN - ENERGY,
    standing=Standing.CASE,
    example={ENERGY: 1, OWN: 1},
)


def _least_by(broken: Any) -> Hypothesis:
    """The pose has the least energy, its own set's and that of so much for broken springs."""
    return nonnegative_by(
        "The pose has the least energy of all.",
        ENERGY - OWN - broken,
        standing=Standing.CASE,
        example={OWN: 1},
    )


LEAST = _least_by(BROKEN)
BOUND, SHIFT = 1, (4, 0, 0)
FIRST = ((0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3))  # stay
SECOND = ((20, 0, 0), (20, 3, 0), (20, 0, 3))  # shifted


def proof(*, softer: bool = True, own: bool = True, shift: Point = SHIFT) -> Proof:
    """Ties; their slope; the own set of a minimiser; two stable equilibria.

    softer: springs break and do not stiffen. own: the set is that of the pose itself.
    """
    stiffened = 0 if softer else SLOPE + OTHERS
    one_way, other_way = REST + stiffened, -REST - SLOPE - OTHERS + stiffened
    yield positive(
        r"At a tie, $|r| = \beta$, the energy $\min(k |r|^2, k \beta^2)$ changes by $\min(f, 0)$ "
        r"to first order along a motion on which $k |r|^2$ changes by $f$, and by $\min(-f, 0)$ "
        "along the opposite one. Let the energy of all springs without a tie change by $g$ and "
        "$-g$. The two changes of $V$ add up to $-|f|$, and as much less for each other tie, "
        r"$-w$: so one of them is negative if $f \ne 0$, and there is no local minimum.",
        -(one_way + other_way),
        [[RISES[0]], [MORE[0]]],
    )
    x, y, t, R = vector("x"), vector("y"), vector("t"), matrix("R")
    residual = y - R * x - t
    yield identity(
        "A translation is such a motion: the gradient of $k |y - R x - t|^2$ in $t$ is $-2 k r$, "
        r"and not $0$ at a tie with $\beta > 0$. So no local minimum sits on a tie.",
        gradient(STIFF * square(residual), t),
        -2 * STIFF * residual,
    )
    least = LEAST if own else _least_by(scalar("o'"))
    yield nonnegative(
        "A pose with the least energy $V' = s' + o$, $s'$ that of the springs which it leaves "
        "unbroken and $o$ that of the broken ones, is a least squares optimum of the former: if "
        r"these have $s$ at another pose, then $s + o \ge V \ge V' = s' + o$, $V$ the energy "
        "there. And at a local minimum, which is off all ties, $V$ is the sum of squares of its "
        "unbroken springs plus a constant as long as the pose moves little. A local minimum of "
        "that is the least (claim `morse_bott`).",
        SUM - OWN,
        [[TRUNCATED[0]], [least[0]]],
    )
    yield from _two_stable(shift)


def energy(shift: Point, motion: Point) -> tuple[int, list[bool]]:
    """V of the instance at a translation, all k = 1, and which springs are unbroken."""
    targets = [*((0, 0, 0) for _ in FIRST), *(shift for _ in SECOND)]
    off = [sum((a - b) ** 2 for a, b in zip(target, motion, strict=True)) for target in targets]
    return sum(min(square, BOUND**2) for square in off), [square < BOUND**2 for square in off]


def _set_of(shift: Point, rows: Sequence[int]) -> SpringSet:
    """Some springs of the instance, as certreg has them."""
    sources = np.array([*FIRST, *SECOND], float)
    targets = sources + np.array([[0, 0, 0]] * len(FIRST) + [shift] * len(SECOND), float)
    problem = bounded(RegistrationProblem(sources, targets), float(BOUND), Loss.BREAKING)
    return SpringSet(problem, tuple(rows))


def _stable(shift: Point, rows: Sequence[int]) -> list[tuple[Any, str]]:
    """Energies and labels of the poses of index 0 at which these springs may hold."""
    poses = _set_of(shift, rows).rest_poses()
    return [(pose.energy, pose.labels.name) for pose in poses if pose.index == 0]


def _two_stable(shift: Point) -> Proof:
    halfway = tuple(entry // 2 for entry in SHIFT)
    spread = [
        rank([[a - b for a, b in zip(p, points[0], strict=True)] for p in points[1:]])
        for points in (FIRST, SECOND)
    ]
    yield facts(
        "Two stable equilibria: $0$, $3 e_1$, $3 e_2$, $3 e_3$ are their own targets, those of "
        r"$20 e_1$, $20 e_1 + 3 e_2$, $20 e_1 + 3 e_3$ are shifted by $4 e_1$; $\beta = k = 1$. "
        "At rest where they are, the four springs have no energy and three are broken: $V = 3$. "
        "Shifted by $4 e_1$ it is the other way round, $V = 4$. Neither set is on a line, so "
        "each has the energy $0$ at one pose only, and both poses are strict local minima of "
        "$V$; halfway all springs are broken, $V = 7$.",
        [
            energy(shift, (0, 0, 0)),
            energy(shift, SHIFT),
            energy(shift, halfway)[0],
            *(found >= 2 for found in spread),
        ],
        [(3, [True] * 4 + [False] * 3), (4, [False] * 4 + [True] * 3), 7, True, True],
    )
    yield facts(
        "`certreg.equilibrium.breaking.SpringSet`, which decides labels in integers, has these "
        "two poses, both of index $0$ and with just these springs unbroken, and proves that the "
        "seven never hold together, nor the four with one of the three.",
        [
            _stable(shift, (0, 1, 2, 3)),
            _stable(shift, (4, 5, 6)),
            *(_set_of(shift, rows).never_holds for rows in (range(7), (0, 1, 2, 3, 4))),
        ],
        [[(3, "PROVED")], [(4, "PROVED")], True, True],
    )
    yield facts(
        "An unbroken spring is a pair within its bound. So every equilibrium with $K$ unbroken "
        "springs or more, stable or not, has them in what is left of all pairs by claims "
        "`few_neighbours`, `few_colours`, `weighted_refutation` and `arcs`. Here, for $K = 4$, "
        "lengths and numbers of neighbours leave the four.",
        [kept(consistent(_rows(shift)), 127, 4)],
        [15],
    )


def _rows(shift: Point) -> list[list[int]]:
    """The pairs as the checker has them: source, target, weight, bound."""
    moved = [tuple(a + b for a, b in zip(p, shift, strict=True)) for p in SECOND]
    pairs = zip((*FIRST, *SECOND), (*FIRST, *moved), strict=True)
    return [[*x, *y, 1, BOUND] for x, y in pairs]


CLAIM = Claim(
    name="springs_that_break",
    title="Springs that break",
    statement=r"Let a spring of stiffness $2k$ break where its length is $\beta > 0$: $V = \sum "
    r"\min(k_i |r_i|^2, k_i \beta_i^2)$, $r_i = y_i - R x_i - t$. No local minimum of $V$ sits on "
    r"a tie $|r_i| = \beta_i$. A local minimum, and so a global one, is a least squares optimum "
    "of the pairs whose springs it leaves unbroken. Every equilibrium with $K$ unbroken springs "
    "or more is a motion that brings their pairs within their bounds. Stable equilibria that are "
    "not the best exist: seven pairs with two minima.",
    concludes=tuple(range(1, 7)),
    hypotheses=(RISES, MORE, TRUNCATED, LEAST),
    setting=(
        "$f$ is the slope of one tie, $g$ that of the springs without a tie.",
        "$s$ and $s'$: the energies of the same springs, at another pose and at the best one.",
    ),
    source="elementary",
    proof=proof,
    controls={
        "springs that stiffen at the tie": Mutation(
            at=1, proof=lambda: proof(softer=False), point={SLOPE: 1}
        ),
        "the set of another pose": Mutation(
            at=3, proof=lambda: proof(own=False), point={OWN: 1, BROKEN: 1}
        ),
        "a shift within the bounds": Mutation(at=4, proof=lambda: proof(shift=(0, 0, 0))),
    },
    not_claimed="That there are few equilibria: each set of pairs has some of its own. Nor, "
    "without a translation, that no minimum sits on a tie: there the slope may be $0$.",
    needs=("maximum_likelihood", "morse_bott", "pair_lengths", "few_neighbours"),
    runs=(
        "certreg.equilibrium.breaking.SpringSet.rest_poses",
        "certreg.equilibrium.breaking.SpringSet._labels",
        "certreg.verify.consistent",
        "certreg.verify.Thinning.after",
    ),
    used_by=(
        "certreg.equilibrium.breaking.label_sets",
        "certreg.dynamics.breaking",
    ),
    not_in_coq="All of it: the theorems in Coq are about springs that do not break.",
)
