"""Claim: between which numbers the scale stays when the points move."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from certreg.registration.scale_range import moved_scale, moved_symmetric_scale

from ..algebra import Square, combination, facts, nonnegative, quoted
from ..hypothesis import Standing, invertible, nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..moments import PointCloud
from ..notation import scalar, square

Range = Callable[..., tuple[Fraction, Fraction] | None]
LEVEL, THEN, MOVED = (scalar(name) for name in ("lambda", "lambda'", "m"))
ROOT, SHIFT, SIZE = scalar("a"), scalar("e"), scalar("S'")
CLOUD, HEAVY = PointCloud.of_size(3), scalar("n")

WEIGHTY = invertible(r"$M \ne 0$, $n = 1/M$.", CLOUD.mass, HEAVY)
NEAR_ABOVE = nonnegative_by(
    r"$\lambda' \le \lambda + m$.",
    LEVEL + MOVED - THEN,
    prepare=lambda point: {MOVED: abs(point[THEN]) + abs(point[LEVEL])},
)
NEAR_BELOW = nonnegative_by(
    r"$\lambda' \ge \lambda - m$.",
    THEN - LEVEL + MOVED,
    standing=Standing.CASE,
    example={LEVEL: 1, SIZE: 1, ROOT: 1},
)
EIGENVALUE = nonnegative_by(
    r"$\lambda' \ge 0$.",
    THEN,
    standing=Standing.CASE,
    example={THEN: -1, LEVEL: -2, MOVED: 1, ROOT: 1, SHIFT: 1, SIZE: 1},
)
LEFT = nonnegative_by(
    r"$\lambda \ge m$.", LEVEL - MOVED, standing=Standing.CASE, example={ROOT: 1, THEN: 1}
)
LARGE = nonnegative_by(
    r"$S'_{xx} \ge (a - e)^2$.",
    SIZE - (ROOT - SHIFT) ** 2,
    standing=Standing.CASE,
    prepare=lambda point: {SIZE: (point[ROOT] - point[SHIFT]) ** 2 + abs(point[SIZE])},
)
SMALL = nonnegative_by(
    r"$S'_{xx} \le (a + e)^2$.",
    (ROOT + SHIFT) ** 2 - SIZE,
    standing=Standing.CASE,
    example={SIZE: 4, ROOT: 1, LEVEL: 1, THEN: 1},
)


def proof(moved: Range = moved_scale, *, least: int = 1, most: int = 1) -> Proof:
    """The eigenvalue, the size of the source, their quotient; the code."""
    yield quoted(
        r"The largest eigenvalue $\lambda$ of $K$ and $\lambda'$ of the moved points differ by at "
        r"most $m = \sqrt{M S_{yy}}\,dx + \sqrt{M S_{xx}}\,dy + M\,dx\,dy$, by Weyl's inequality "
        r"and the bound of claim `eigenvector_radius` on the change of $K$.",
        theorem="Weyl's inequality",
        source="[HornJohnson2012], Weyl's inequality",
    )
    yield from _size()
    yield nonnegative(
        r"So with $a = \sqrt{S_{xx}}$, $e = \sqrt M\,dx$: $(a - e)^2 \lambda' \le (\lambda + "
        r"m)\, S'_{xx}$, that is $\lambda'/S'_{xx} \le (\lambda + m)/(a - e)^2$ where $e < a$,",
        (LEVEL + MOVED) * SIZE - most * THEN * (ROOT - SHIFT) ** 2,
        [
            [NEAR_ABOVE[0], Square(ROOT - SHIFT)],
            [NEAR_ABOVE[0], LARGE[0]],
            [EIGENVALUE[0], LARGE[0]],
        ],
    )
    yield nonnegative(
        r"and $\lambda'/S'_{xx} \ge (\lambda - m)/(a + e)^2$ where $\lambda \ge m$.",
        THEN * (ROOT + SHIFT) ** 2 - least * (LEVEL - MOVED) * SIZE,
        [[NEAR_BELOW[0], Square(ROOT + SHIFT)], [LEFT[0], SMALL[0]]],
    )
    yield facts(
        r"`certreg.registration.scale_range.moved_scale` for $\lambda = 6$, $S_{xx} = S_{yy} = 4$, "
        r"$M = 1$: at $dx = dy = 1$, $m = 5$, from $1/9$ to $11$; at $dx = 0$, $dy = 1$ from $1$ "
        r"to $2$; at $dx = 2$ nothing is said; at $dx = 1$, $dy = 2$ nothing of the least one but "
        r"$0$.",
        [
            moved(Fraction(6), Fraction(6), (1, 4, 4), *by)
            for by in ((1, 1), (0, 1), (2, 0), (1, 2))
        ],
        [
            (Fraction(1, 9), Fraction(11)),
            (Fraction(1), Fraction(2)),
            None,
            (Fraction(0), Fraction(14)),
        ],
    )
    one = Fraction(1)
    yield facts(
        r"The symmetric scale $\sqrt{S_{yy}/S_{xx}}$ is a quotient of two such roots: for $S_{xx} "
        r"= 4$, $S_{yy} = 9$, $M = 1$, $dx = dy = 1$ between $2/3$ and $4$.",
        [moved_symmetric_scale((one, 4 * one, 9 * one), one, one)],
        [(Fraction(2, 3), Fraction(4))],
    )


def _size() -> Proof:
    centred = CLOUD.centred(CLOUD.sources, HEAVY)
    mean = CLOUD.total(CLOUD.sources) * HEAVY
    spread = CLOUD.total([square(x) for x in centred])
    whole = CLOUD.total([square(x) for x in CLOUD.sources])
    yield combination(
        r"Taking the mean away makes a sum of squares no larger: $\sum m|d - \bar d|^2 = \sum "
        r"m|d|^2 - M|\bar d|^2$ (three points written out). So by the triangle inequality "
        r"$\sqrt{S_{xx}}$ moves by at most $\sqrt M\,dx$, if no point moves by more than $dx$.",
        spread - whole + CLOUD.mass * square(mean),
        [(2 * HEAVY * square(CLOUD.total(CLOUD.sources)), WEIGHTY[0])],
    )


def _half_of_the_move(*arguments: Any) -> tuple[Fraction, Fraction] | None:
    """The range with half of the target's move."""
    least, most, spreads, source, target = arguments
    return moved_scale(least, most, spreads, source, Fraction(target) / 2)


CLAIM = Claim(
    name="scale_radius",
    title="Between which numbers the scale stays when the points move",
    statement=r"Let $s = \lambda_1/S_{xx}$, and let no source point move by more than $dx$, no "
    r"target point by more than $dy$. With $m = \sqrt{M S_{yy}}\,dx + \sqrt{M S_{xx}}\,dy + "
    r"M\,dx\,dy$ the new scale is between $$\frac{\lambda_1 - m}{(\sqrt{S_{xx}} + \sqrt M\,dx)^2} "
    r"\quad\text{and}\quad \frac{\lambda_1 + m}{(\sqrt{S_{xx}} - \sqrt M\,dx)^2},$$ where $\sqrt "
    r"M\,dx < \sqrt{S_{xx}}$ and, for the first, $m \le \lambda_1$.",
    concludes=(2, 3, 4, 5, 6),
    hypotheses=(WEIGHTY, NEAR_ABOVE, NEAR_BELOW, EIGENVALUE, LEFT, LARGE, SMALL),
    setting=(r"$\lambda'$, $S'_{xx}$ are those of the moved points; $a = \sqrt{S_{xx}}$.",),
    source="ours; [HornJohnson2012], Weyl's inequality",
    proof=proof,
    controls={
        "a scale that may grow half as much": Mutation(
            at=3,
            proof=lambda: proof(most=2),
            point={LEVEL: 1, THEN: 1, ROOT: 1, SIZE: 1},
        ),
        "a scale that may fall half as much": Mutation(
            at=4,
            proof=lambda: proof(least=2),
            point={LEVEL: 1, THEN: 1, ROOT: 1, SIZE: 1},
        ),
        "half of the target's move": Mutation(at=5, proof=lambda: proof(_half_of_the_move)),
    },
    not_claimed="That these are the largest motions. Weights do not move.",
    needs=("eigenvector_radius", "breathing_equilibria"),
    standard=("The triangle inequality.",),
    runs=(
        "certreg.registration.scale_range.moved_scale",
        "certreg.registration.scale_range.moved_symmetric_scale",
    ),
    used_by=("certreg.registration.scale_range",),
    not_in_coq="All of it: the checker in Coq reads no radius.",
)
