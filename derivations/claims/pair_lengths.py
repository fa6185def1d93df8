"""Claim: two pairs that one rigid motion brings within their bounds have nearly equal lengths."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

from certreg.verify import consistent

from ..algebra import Square, combination, contraction, facts, identity, nonnegative, positive
from ..hypotheses import ROTATION
from ..hypothesis import Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import matrix, scalar, square, vector

Rows = list[list[int]]  # x, y, weight, bound
Test = Callable[[Rows], list[int]]  # of each row those that agree with it, as bits
SIZED = ((0, 0, 0), 0), ((0, 3, 0), 3), ((1, 2, 2), 3), ((2, 3, 6), 7), ((4, 8, 1), 9)
PLACES = ((1, -2, 3), (-4, 0, 7))  # of the first source point and its target
R, A, B, C = matrix("R"), vector("a"), vector("b"), vector("c")  # c = R a
LEFT, RIGHT = vector("u"), vector("v")  # the residuals of the pairs i and j
FIRST, SECOND = scalar("beta_i"), scalar("beta_j")
EPSILON, SOURCE, TARGET = scalar("epsilon"), scalar("alpha"), scalar("gamma")
EXCESS = square(C) + square(B) - EPSILON**2

BOUNDS = nonnegative_by(
    r"$\beta_i, \beta_j \ge 0$.", [FIRST, SECOND], example={FIRST: -1, SECOND: 2}
)
WITHIN = nonnegative_by(
    r"The motion brings both pairs within their bounds: $|r_i| \le \beta_i$, $|r_j| \le \beta_j$.",
    [FIRST**2 - square(LEFT), SECOND**2 - square(RIGHT)],
    standing=Standing.CASE,
    example={FIRST: 1, SECOND: 1, LEFT[0]: 3},
)
CLOSE = nonnegative_by(
    r"$|b - R a| \le \epsilon$.",
    EPSILON**2 - square(B - C),
    standing=Standing.CASE,
    example={B[0]: 2, C[0]: 1},
)
LONG = nonnegative_by(r"$D \ge 0$.", EXCESS, standing=Standing.CASE, example={EPSILON: 1})
LENGTHS = nonnegative_by(
    r"$\alpha = |a|$ and $\gamma = |b|$ are not negative.",
    [SOURCE, TARGET],
    example={SOURCE: -1, TARGET: 1, EPSILON: 1},
)
APART = positive_by(
    r"$|\alpha - \gamma| > \epsilon$.",
    (SOURCE - TARGET) ** 2 - EPSILON**2,
    standing=Standing.CASE,
    example={SOURCE: 1, TARGET: 1, EPSILON: 1},
)


def two_rows(a: Any, b: Any, bounds: tuple[int, int]) -> Rows:
    """Two rows for the checker with these differences of sources and of targets."""
    x, y = PLACES
    moved = [p + d for p, d in zip((*x, *y), (*a, *b), strict=True)]
    return [[*x, *y, 1, bounds[0]], [*moved, 1, bounds[1]]]


def proof(test: Test = consistent, *, both: bool = True, excess: bool = True) -> Proof:
    """The triangle inequality; the turn; the test without roots; lengths; numbers."""
    yield from _near(both=both)
    yield from _without_roots(excess=excess)
    yield from _lengths()
    yield _numbers(test)


def _near(*, both: bool) -> Proof:
    """both: the bounds of both pairs are added."""
    x, y, t = ((vector(f"{name}_i"), vector(f"{name}_j")) for name in "xyt")
    shift = t[0]
    yield identity(
        "With the residuals $r = y - R x - t$, $a = x_j - x_i$ and $b = y_j - y_i$: $r_j - r_i = "
        "b - R a$, whatever the translation.",
        (y[1] - R * x[1] - shift) - (y[0] - R * x[0] - shift),
        (y[1] - y[0]) - R * (x[1] - x[0]),
    )
    epsilon = FIRST + SECOND if both else FIRST
    first, second = BOUNDS.parts
    yield nonnegative(
        r"The triangle inequality, without roots: with $\epsilon = \beta_i + \beta_j$, $\beta_i "
        r"\beta_j\,(\epsilon^2 - |r_j - r_i|^2) = \epsilon\beta_j\,(\beta_i^2 - |r_i|^2) + "
        r"\epsilon\beta_i\,(\beta_j^2 - |r_j|^2) + |\beta_j r_i + \beta_i r_j|^2$. So $|b - R a| "
        r"\le \epsilon$, also where a bound is $0$: then that residual is.",
        FIRST * SECOND * (epsilon**2 - square(RIGHT - LEFT)),
        [
            [first, second, WITHIN[0]],
            [second, second, WITHIN[0]],
            [first, first, WITHIN[1]],
            [first, second, WITHIN[1]],
            *([Square(entry)] for entry in SECOND * LEFT + FIRST * RIGHT),
        ],
    )


def _without_roots(*, excess: bool) -> Proof:
    """excess: whether D > 0 is asked for."""
    yield combination(
        r"A rotation keeps lengths: $|R a|^2 = |a|^2$.",
        square(R * A) - square(A),
        contraction(A * A.T, ROTATION),
    )
    crossed = C.cross(B)
    yield nonnegative(
        r"Let $A = |a|^2$, $B = |b|^2$, $D = A + B - \epsilon^2$, $c = R a$ and $P = b \cdot c$, "
        r"so that $2 P - D = \epsilon^2 - |b - c|^2 \ge 0$. If $D \ge 0$, then $4 A B - D^2 = "
        r"4\,|c \times b|^2 + (2 P - D)^2 + 2 D\,(2 P - D) \ge 0$. So where $D > 0$ and $D^2 > 4 "
        "A B$, no rigid motion brings both pairs within their bounds.",
        4 * square(C) * square(B) - EXCESS**2,
        [
            *([4, Square(entry)] for entry in crossed),
            [Square(CLOSE[0])],
            *([[2, LONG[0], CLOSE[0]]] if excess else []),
        ],
    )


def _lengths() -> Proof:
    D = SOURCE**2 + TARGET**2 - EPSILON**2
    yield positive(
        r"The test says $\bigl||a| - |b|\bigr| > \epsilon$: with $\alpha = |a|$, $\gamma = |b|$ "
        r"that makes $D = (\alpha - \gamma)^2 - \epsilon^2 + 2\alpha\gamma$ positive,",
        D,
        [[APART[0]], [2, *LENGTHS.parts]],
    )
    yield positive(
        r"and $D^2 - 4 A B$ too.",
        D**2 - 4 * (SOURCE * TARGET) ** 2,
        [[Square(APART[0])], [4, *LENGTHS.parts, APART[0]]],
    )
    yield identity(
        "Conversely, where $D > 0$ and $D^2 > 4 A B$, both factors of $D^2 - 4 A B$ are "
        r"positive, as the second is $D + 2\alpha\gamma$: the lengths differ by more than "
        r"$\epsilon$.",
        D**2 - 4 * (SOURCE * TARGET) ** 2,
        ((SOURCE - TARGET) ** 2 - EPSILON**2) * (D + 2 * SOURCE * TARGET),
    )


def _numbers(test: Test) -> Any:
    wrong = struck = 0
    for (a, source), (b, target), bounds in product(SIZED, SIZED, ((1, 1), (1, 3), (5, 2))):
        agree = abs(source - target) <= sum(bounds)
        struck += not agree
        wrong += test(two_rows(a, b, bounds)) != ([0b10, 0b01] if agree else [0, 0])
    return facts(
        "`certreg.verify.consistent`, which decides it in integers, on differences of the lengths "
        "$0, 3, 3, 7, 9$ with bounds of $1$ and $1$, $1$ and $3$, $5$ and $2$, some of them on "
        "the edge: of $75$ cases it refutes $26$, just those in which the lengths differ by more.",
        [wrong, struck],
        [0, 26],
    )


def _without_excess(rows: Rows) -> list[int]:
    """The test without D > 0."""
    lengths = [sum((u - v) ** 2 for u, v in zip(*ends, strict=True)) for ends in _ends(rows)]
    excess = sum(lengths) - (rows[0][7] + rows[1][7]) ** 2
    return [0b10, 0b01] if excess**2 <= 4 * lengths[0] * lengths[1] else [0, 0]


def _ends(rows: Rows) -> list[tuple[list[int], list[int]]]:
    """The two sources, and the two targets."""
    return [(rows[0][k : k + 3], rows[1][k : k + 3]) for k in (0, 3)]


CLAIM = Claim(
    name="pair_lengths",
    title="Two pairs within their bounds have nearly the same length",
    statement="Let a rigid motion bring the pairs $i$ and $j$ within their bounds, $|y_i - R x_i "
    r"- t| \le \beta_i$ and $|y_j - R x_j - t| \le \beta_j$. Then $$\bigl|\,|x_j - x_i| - |y_j - "
    r"y_i|\,\bigr| \le \beta_i + \beta_j = \epsilon.$$ With $A$ and $B$ the squares of the two "
    r"lengths and $D = A + B - \epsilon^2$ that is wrong if and only if $D > 0$ and $D^2 > 4 A "
    "B$: a test in integers, where the data are.",
    concludes=tuple(range(1, 9)),
    hypotheses=(ROTATION, BOUNDS, WITHIN, CLOSE, LONG, LENGTHS, APART),
    setting=(r"$r_i = y_i - R x_i - t$ is the residual of pair $i$, $\beta_i$ its bound.",),
    source="elementary",
    proof=proof,
    controls={
        "a bound without that of the second pair": Mutation(
            at=2,
            proof=lambda: proof(both=False),
            point={FIRST: 1, SECOND: 1, RIGHT[0]: 1, LEFT[0]: -1},
        ),
        "a test that does not ask for D > 0": Mutation(
            at=4, proof=lambda: proof(excess=False), point={EPSILON: 1}
        ),
        "a program that does not ask for it": Mutation(at=8, proof=lambda: proof(_without_excess)),
    },
    not_claimed="That pairs whose lengths agree, two by two, are within their bounds together: "
    "mirror images agree in all lengths.",
    runs=("certreg.verify.consistent",),
    used_by=("certreg.certificate.consistency.RigidPairs.near",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
