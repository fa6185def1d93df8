"""Claim: with a scale between two numbers, lengths refute two pairs, by two tests without roots."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from certreg.verify import graphs

from ..algebra import Square, facts, identity, nonnegative, positive
from ..hypothesis import Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import entry, scalar, square, vector

Test = Callable[[int, int, int, int, int | None], bool]
A, B = vector("a"), vector("b")  # a turned by the rotation
SCALE, EPSILON = scalar("s"), scalar("epsilon")
LOW, HIGH = entry("s", 0), entry("s", 1)
LONG, SHORT = scalar("lambda"), scalar("mu")
OFF = SCALE * A - B

RANGE = nonnegative_by(r"$0 \le s_0 \le s$.", [LOW, SCALE - LOW])
BELOW = nonnegative_by(r"$s \le s_1$.", HIGH - SCALE, standing=Standing.CASE)
CLOSE = nonnegative_by(
    r"$|b - s R a| \le \epsilon$.",
    EPSILON**2 - square(OFF),
    standing=Standing.CASE,
    example={A[0]: 1, SCALE: 1, LOW: 1},
)
LARGE = nonnegative_by(
    r"$G \ge 0$.",
    LOW**2 * square(A) - square(B) - EPSILON**2,
    standing=Standing.CASE,
    example={EPSILON: 1},
)
SMALL = nonnegative_by(
    r"$G' \ge 0$.",
    square(B) - HIGH**2 * square(A) - EPSILON**2,
    standing=Standing.CASE,
    example={EPSILON: 1},
)
SIDES = nonnegative_by(
    r"$\mu, \epsilon \ge 0$.",
    [SHORT, EPSILON],
    example={SHORT: -2, EPSILON: 1, LONG: 1},
)
APART = positive_by(
    r"$\lambda > \mu + \epsilon$.",
    LONG - SHORT - EPSILON,
    standing=Standing.CASE,
    example={LONG: 1, SHORT: 1, EPSILON: 1},
)


def refuted(a: int, b: int, epsilon: int, low: int, high: int | None) -> bool:
    """Whether no scale from low to high, None if it has no end, goes with the lengths a and b.

    By the graphs of the checker: whether two pairs are no neighbours.
    """
    rows = [[0, 0, 0, 0, 0, 0, 1, 0], [a, 0, 0, b, 0, 0, 1, epsilon]]
    ends = [end for end in (low, high) if end]
    return [*graphs(rows, ends)][low > 0] == [0, 0]


def proof(test: Test = refuted, *, loose: int = 4, far: Any = HIGH) -> Proof:
    """Too long a source; too short a one; what the tests say; the rigid one; numbers."""
    yield _too_long(loose)
    yield _too_short(far)
    yield from _lengths()
    yield _numbers(test)


def _too_long(loose: int) -> Any:
    low, more = RANGE.parts
    over = EPSILON**2 - square(OFF) + (SCALE**2 - LOW**2) * square(A)
    return nonnegative(
        "Let a motion with a scale $s$ from $s_0$ to $s_1$ bring both pairs within their bounds, "
        r"$|e| \le \epsilon$ for $e = s R a - b$, by the triangle inequality (claim "
        r"`pair_lengths`). With $A = |a|^2$, $B = |b|^2$ and $G = s_0^2 A - B - \epsilon^2$, $2\, "
        r"b \cdot e - G = (\epsilon^2 - |e|^2) + (s^2 - s_0^2) A = X \ge 0$, and $4 \epsilon^2 B "
        r"- G^2 = 4 B (\epsilon^2 - |e|^2) + 4\,|b \times e|^2 + X^2 + 2 G X$. So $G^2 \le 4 "
        r"\epsilon^2 B$ if $G \ge 0$.",
        loose * EPSILON**2 * square(B) - LARGE[0].value ** 2,
        [
            *([4, Square(x), CLOSE[0]] for x in B),
            *([4, Square(x)] for x in B.cross(OFF)),
            [Square(over)],
            [2, LARGE[0], CLOSE[0]],
            *([2, LARGE[0], Square(more), Square(x)] for x in A),
            *([4, LARGE[0], low, more, Square(x)] for x in A),
        ],
    )


def _too_short(far: Any) -> Any:
    low, more = RANGE.parts
    under = EPSILON**2 - square(OFF) + (HIGH**2 - SCALE**2) * square(A)
    ways = [[1, Square(BELOW[0])], [2, low, BELOW[0]], [2, more, BELOW[0]]]  # s_1^2 - s^2
    return nonnegative(
        r"With $G' = B - s_1^2 A - \epsilon^2$ and $c = s R a$, $-2\, c \cdot e - G' = "
        r"(\epsilon^2 - |e|^2) + (s_1^2 - s^2) A = Y \ge 0$, and $4 \epsilon^2 s_1^2 A - G'^2 = 4 "
        r"\epsilon^2 A (s_1^2 - s^2) + 4 s^2 A\, (\epsilon^2 - |e|^2) + 4\,|c \times e|^2 + Y^2 + "
        r"2 G' Y$. So $G'^2 \le 4 \epsilon^2 s_1^2 A$ if $G' \ge 0$.",
        4 * EPSILON**2 * far**2 * square(A) - SMALL[0].value ** 2,
        [
            *([4, Square(EPSILON), Square(x), *way] for x in A for way in ways),
            *([4, Square(SCALE), Square(x), CLOSE[0]] for x in A),
            *([4, Square(x)] for x in (SCALE * A).cross(OFF)),
            [Square(under)],
            [2, SMALL[0], CLOSE[0]],
            *([2, SMALL[0], Square(x), *way] for x in A for way in ways),
        ],
    )


def _lengths() -> Proof:
    G = LONG**2 - SHORT**2 - EPSILON**2
    apart, (short, epsilon) = APART[0], SIDES.parts
    yield positive(
        r"With $\lambda = s_0 |a|$ and $\mu = |b|$, or $\lambda = |b|$ and $\mu = s_1 |a|$, the "
        r"tests are $G > 0$ and $G^2 > 4 \epsilon^2 \mu^2$ for $G = \lambda^2 - \mu^2 - "
        r"\epsilon^2$. They say $\lambda > \mu + \epsilon$: that makes $G$ positive,",
        G,
        [[Square(apart)], [2, short, apart], [2, epsilon, apart], [2, short, epsilon]],
    )
    yield positive(
        r"and $G^2 - 4 \epsilon^2 \mu^2$ too.",
        G**2 - 4 * EPSILON**2 * SHORT**2,
        [
            [Square(apart), Square(apart)],
            *([4, side, apart, Square(apart)] for side in (short, epsilon)),
            [4, Square(SHORT + EPSILON), Square(apart)],
            [4, short, epsilon, Square(apart)],
            *([8, side, short, epsilon, apart] for side in (short, epsilon)),
        ],
    )
    yield identity(
        r"Conversely, where $G > 0$ and $G^2 > 4 \epsilon^2 \mu^2$, both factors of $G^2 - 4 "
        r"\epsilon^2 \mu^2$ are positive, as the second is $G + 2 \epsilon\mu$. And for $s_0 = "
        "s_1 = 1$ it is $D^2 - 4 A B$, the test of claim `pair_lengths`.",
        [G**2 - 4 * EPSILON**2 * SHORT**2] * 2,
        [
            (LONG**2 - (SHORT + EPSILON) ** 2) * (G + 2 * EPSILON * SHORT),
            (LONG**2 + SHORT**2 - EPSILON**2) ** 2 - 4 * LONG**2 * SHORT**2,
        ],
    )


def _numbers(test: Test) -> Any:
    lengths = (8, 9, 21, 22)
    return facts(
        r"The graphs of the checker: $|a| = 10$, $\epsilon = 1$ and a scale from $1$ to $2$ go "
        "with $|b|$ from $9$ to $21$, and not with $8$ or $22$; with no end of the scale, $22$ is "
        "not refuted. A scale from $0$ on refutes nothing.",
        [
            *(test(10, length, 1, 1, 2) for length in lengths),
            *(test(10, length, 1, 1, None) for length in lengths),
            *(test(10, length, 1, 0, None) for length in (0, 1000)),
        ],
        [True, False, False, True, True, False, False, False, False, False],
    )


def _one_end(a: int, b: int, epsilon: int, low: int, _high: int | None) -> bool:
    """The test with the lower scale at both ends."""
    return refuted(a, b, epsilon, low, low)


CLAIM = Claim(
    name="scaled_lengths",
    title="Lengths, where the scale is free",
    statement=r"Let a motion with a scale, $x \mapsto s R x + t$ with $0 \le s_0 \le s \le s_1$, "
    r"bring two pairs within their bounds, $\epsilon = \beta_i + \beta_j$, and let $a = x_j - "
    r"x_i$, $b = y_j - y_i$. Then $$s_0 |a| \le |b| + \epsilon \qquad\text{and}\qquad s_1 |a| \ge "
    r"|b| - \epsilon.$$ With $A = |a|^2$ and $B = |b|^2$ the first is wrong if and only if $G = "
    r"s_0^2 A - B - \epsilon^2 > 0$ and $G^2 > 4 \epsilon^2 B$, the second if and only if $G' = B "
    r"- s_1^2 A - \epsilon^2 > 0$ and $G'^2 > 4 \epsilon^2 s_1^2 A$. Where the scale has no upper "
    "end, the first is all.",
    concludes=tuple(range(1, 7)),
    hypotheses=(RANGE, BELOW, CLOSE, LARGE, SMALL, SIDES, APART),
    setting=(r"Bounds are in the unit of the target. In steps 1 and 2 $a$ is written for $R a$.",),
    source="elementary",
    proof=proof,
    controls={
        "half of the right side": Mutation(
            at=1,
            proof=lambda: proof(loose=2),
            point={A[0]: 3, B[0]: 2, SCALE: 1, LOW: 1, EPSILON: 1},
        ),
        "the lower scale in the second test": Mutation(
            at=2,
            proof=lambda: proof(far=LOW),
            point={A[0]: 1, B[0]: 3, SCALE: 2, HIGH: 2, EPSILON: 1},
        ),
        "a program with the lower scale at both ends": Mutation(
            at=6, proof=lambda: proof(_one_end)
        ),
    },
    not_claimed="That three pairs or more which pass two by two have a scale in common.",
    needs=("pair_lengths",),
    runs=("certreg.verify.graphs", "certreg.verify.longer"),
    used_by=("certreg.certificate.consistency.ConsistentPairs.near",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
