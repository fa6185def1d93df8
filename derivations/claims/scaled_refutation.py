"""Claim: weights refute pairs together for all scales between two numbers, by one test of three."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import product
from typing import Any

from certreg.verify import scaled_refuted

from ..algebra import Square, cases, combination, contraction, facts, nonnegative, positive
from ..hypotheses import ROTATION
from ..hypothesis import Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..notation import inner, matrix, scalar, square, vector

Test = Callable[[Fraction, Fraction, Fraction, Fraction, Fraction], bool]
ONE = 2**20  # the root of c X, which the checker rounds down, is right to as much
SCALE, END, LEVEL = scalar("s"), scalar("s'"), scalar("lambda")
SPREAD, REST = scalar("X"), scalar("c")  # sum w |x|^2; sum w |y|^2 less sum w beta^2

SPACE = nonnegative_by(
    r"$X \ge 0$: it is a sum of squares.",
    SPREAD,
    example={SPREAD: -1, REST: -1, LEVEL: -2, END: 1, SCALE: 5},
)
UPRIGHT = positive_by(r"$s, s' > 0$.", [SCALE, END], standing=Standing.CASE)
LOW = positive_by(
    r"$\lambda^2 < c X$.",
    REST * SPREAD - LEVEL**2,
    standing=Standing.CASE,
    example={SPREAD: 1, LEVEL: 1, SCALE: 1},
)
ABOVE = nonnegative_by(r"$s \ge s'$.", SCALE - END, standing=Standing.CASE)
GROWS = nonnegative_by(
    r"$s'^2 X \ge c$.",
    END**2 * SPREAD - REST,
    standing=Standing.CASE,
    example={REST: 9, SPREAD: 1, END: 1, SCALE: 3, LEVEL: Fraction(7, 2)},
)
BELOW = nonnegative_by(
    r"$s \le s'$.",
    END - SCALE,
    standing=Standing.CASE,
    example={SPREAD: 1, REST: 4, LEVEL: Fraction(9, 4), END: 1, SCALE: 2},
)
FALLS = nonnegative_by(
    r"$c \ge s'^2 X$.",
    REST - END**2 * SPREAD,
    standing=Standing.CASE,
    example={REST: 1, SPREAD: 1, END: 3, SCALE: 1, LEVEL: Fraction(3, 2)},
)


def excess(scale: Any) -> Any:
    """s^2 X + c - 2 s lambda: the least sum of squares at a scale, less that of the bounds."""
    return scale**2 * SPREAD + REST - 2 * scale * LEVEL


AT_END = positive_by(
    r"$s'^2 X + c > 2 s' \lambda$.",
    excess(END),
    standing=Standing.CASE,
    example={SCALE: 1, END: 1, LEVEL: 1},
)


def refutes(X: Fraction, c: Fraction, level: Fraction, low: Fraction, high: Fraction) -> bool:
    """The three tests by the checker, in integers: the target times ONE, all of it its square."""
    K = [[int(k * level * ONE) * (i == j) for j in range(4)] for i, k in enumerate((1, 1, 1, -3))]
    return scaled_refuted(int(X), int(c * ONE**2), K, int(low * ONE), int(high * ONE))


def proof(test: Test = refutes, *, cross: int = 2) -> Proof:
    """The sum of squares; the least of all scales; at the lower end; at the upper end; numbers."""
    cloud, R = MomentCloud(), matrix("R")
    shift = vector("t")
    yield combination(
        "With weights $w$, a scale $s$, a rotation $R$ and a translation that is $t$ off the "
        r"best one the sum of squares is $s^2 X + Y - 2 s \operatorname{tr}(R^{\mathsf T} C) + "
        r"M|t|^2$, $X = \sum w|x|^2$ and $Y = \sum w|y|^2$ about means: at least $s^2 X + Y - 2 s "
        r"\lambda$, $\lambda$ the largest eigenvalue of $K$ (claim `davenport`). With $c = Y - "
        r"\sum w \beta^2$ the pairs are refuted together at $s$ if $s^2 X + c - 2 s \lambda > 0$.",
        cloud.total(square(cloud.y - SCALE * R * cloud.x - shift))
        - cloud.mass * square(shift)
        - cloud.target_scatter.trace()
        - SCALE**2 * cloud.source_scatter.trace()
        + cross * SCALE * inner(R, cloud.cross),
        contraction(SCALE**2 * cloud.source_scatter, ROTATION),
    )
    yield positive(
        r"**All scales.** If $\lambda^2 < c X$, then $X\,(s^2 X + c - 2 s \lambda) = (s X - "
        r"\lambda)^2 + c X - \lambda^2$ is positive at every $s$. (It is so at $s = 0$, too, as "
        "$c > 0$.)",
        SPREAD * excess(SCALE),
        [[Square(SPREAD * SCALE - LEVEL)], [LOW[0]]],
    )
    yield positive(
        r"**From the lower end on.** Let it be positive at $s' > 0$, and $c \le s'^2 X$. For $s "
        r"\ge s'$, $s'$ times it is $s$ times that at $s'$ plus $(s - s')(s s' X - c)$, and the "
        "latter is not negative.",
        END * excess(SCALE),
        [
            [UPRIGHT[0], AT_END[0]],
            [ABOVE[0], GROWS[0]],
            [UPRIGHT[1], SPACE[0], Square(ABOVE[0])],
        ],
    )
    yield positive(
        r"**Up to the upper end.** Let it be positive at $s' > 0$, and $c \ge s'^2 X$. For $0 < s "
        r"\le s'$, $s'$ times it is $s$ times that at $s'$ plus $(s' - s)(c - s s' X)$. At $s = "
        r"0$ it is $c$, which is positive: $c = 0$ would need $X = 0$, and then $\lambda < 0$, "
        "which the largest eigenvalue is not.",
        END * excess(SCALE),
        [
            [UPRIGHT[0], AT_END[0]],
            [BELOW[0], FALLS[0]],
            [UPRIGHT[1], SPACE[0], Square(BELOW[0])],
        ],
    )
    yield nonnegative(
        "Of two numbers one test is always enough: as a function of $s > 0$, $(s X + c/s)/2$, "
        r"with which $\lambda$ is compared, falls up to $\sqrt{c/X}$ and grows from there on. "
        r"There it is $\sqrt{c X}$: $(s X + c/s)^2 - 4 c X$, here times $s^2$, is a square. So a "
        r"motion with a scale that brings the pairs within has $p^{\mathsf T} K p \ge \sqrt{c "
        r"X}$, if $c \ge 0$, which bounds its rotation as claim `angle_of_consensus` does.",
        (SCALE**2 * SPREAD + REST) ** 2 - 4 * SCALE**2 * REST * SPREAD,
        [[Square(SCALE**2 * SPREAD - REST)]],
    )
    yield _numbers(test)
    yield cases("Every scale is on one side of $s'$,", [ABOVE, BELOW])
    yield cases("and $c$ on one side of $s'^2 X$: one of the two tests applies.", [GROWS, FALLS])


def _numbers(test: Test) -> Any:
    wrong = refuted = 0
    ends = [(Fraction(a, 2), Fraction(b, 2)) for a in range(5) for b in range(a, 5)]
    for X, c, level, (low, high) in product((1, 2), (-1, 0, 1, 3), range(4), ends):
        found = test(Fraction(X), Fraction(c), Fraction(level), low, high)
        places = [low + (high - low) * Fraction(k, 24) for k in range(25)]
        refuted += found
        wrong += found and any(s**2 * X + c - 2 * s * level <= 0 for s in places)
    return facts(
        r"The three tests of the checker, with $X = 1, 2$, $c = -1, 0, 1, 3$, $\lambda = 0, 1, 2, "
        r"3$ and scales between multiples of $\tfrac12$ up to $2$: of $480$ cases $175$ are "
        "refuted, in each of which the sum is above that of the bounds at $25$ scales.",
        [wrong, refuted],
        [0, 175],
    )


def _ends_only(X: Fraction, c: Fraction, level: Fraction, low: Fraction, high: Fraction) -> bool:
    """A test at both ends, and not between."""
    return all(s**2 * X + c > 2 * s * level for s in (low, high))


CLAIM = Claim(
    name="scaled_refutation",
    title="Weights that refute pairs at every scale",
    statement=r"Let $w \ge 0$ be weights of pairs with bounds, $X = \sum w|x|^2$ and $Y = \sum "
    r"w|y|^2$ about means, $c = Y - \sum w \beta^2$, and $\lambda$ the largest eigenvalue of $K$. "
    r"No motion with a scale $s$ from $s_0 \ge 0$ to $s_1$ brings all of the pairs within, if "
    r"$s_0^2 X < c < s_1^2 X$ and $\lambda^2 < c X$; or if $c \le s_0^2 X$ and $s_0^2 X + c > 2 "
    r"s_0 \lambda$; or if $c \ge s_1^2 X$ and $s_1^2 X + c > 2 s_1 \lambda$, $s_1 > 0$.",
    concludes=tuple(range(1, 7)),
    hypotheses=(ROTATION, SPACE, UPRIGHT, LOW, ABOVE, GROWS, BELOW, FALLS, AT_END),
    setting=(r"$s'$ is the end of the scales at which a test is made.",),
    source="elementary; weak duality",
    proof=proof,
    controls={
        "the alignment once": Mutation(at=1, proof=lambda: proof(cross=1)),
        "a test at both ends alone": Mutation(at=6, proof=lambda: proof(_ends_only)),
    },
    not_claimed="That pairs which no weights refute are within at some scale.",
    needs=("davenport", "weighted_refutation", "scale_elimination", "angle_of_consensus"),
    runs=("certreg.verify.scaled_refuted", "certreg.verify.definite"),
    used_by=(
        "certreg.certificate.producing_consensus.ConsensusProver",
        "certreg.certificate.refuting.PointRows",
    ),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
