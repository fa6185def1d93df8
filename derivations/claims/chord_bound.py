"""Claim: up to a largest residual, a truncated square is at least a certain share of the square."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from ..algebra import Square, facts, nonnegative
from ..hypothesis import nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..notation import scalar

RESIDUAL, LIMIT, MOST = scalar("r"), scalar("beta"), scalar("h")
SIDES = nonnegative_by(
    r"$r, \beta \ge 0$.",
    [RESIDUAL, LIMIT],
    example={RESIDUAL: -2, LIMIT: 1, MOST: 1},
)
ABOVE = nonnegative_by(r"$h \ge \beta$.", MOST - LIMIT, example={LIMIT: 2, RESIDUAL: 1, MOST: 1})
WITHIN = nonnegative_by(r"$r \le h$.", MOST - RESIDUAL, example={LIMIT: 1, RESIDUAL: 2, MOST: 1})


def truncated(r: Fraction, limit: Fraction) -> Fraction:
    """min(r^2, limit^2)."""
    return min(r * r, limit * limit)


def chord(r: Fraction, limit: Fraction, most: Fraction) -> Fraction:
    """(limit / most)^2 r^2."""
    return (limit * r / most) ** 2


def proof(share: Any = LIMIT**2) -> Proof:
    """Below the bound; above it; why no more. share: what is proved, times h^2."""
    yield nonnegative(
        r"Where $r \le \beta$, the truncated square is $r^2$, and $h^2 r^2 - \beta^2 r^2 = "
        r"r^2\,(h - \beta)^2 + 2 \beta r^2\,(h - \beta) \ge 0$.",
        MOST**2 * RESIDUAL**2 - LIMIT**2 * RESIDUAL**2,
        [[Square(RESIDUAL), Square(ABOVE[0])], [2, Square(RESIDUAL), SIDES[1], ABOVE[0]]],
    )
    yield nonnegative(
        r"Where $\beta \le r \le h$, it is $\beta^2$, and $h^2 \beta^2 - \beta^2 r^2 = "
        r"\beta^2\,(h - r)^2 + 2 r \beta^2\,(h - r) \ge 0$.",
        MOST**2 * LIMIT**2 - share * RESIDUAL**2,
        [[Square(LIMIT), Square(WITHIN[0])], [2, Square(LIMIT), SIDES[0], WITHIN[0]]],
    )
    half, limit, most = Fraction(1, 2), Fraction(1), Fraction(2)
    places = [half * k for k in range(5)]
    yield facts(
        "It is the chord: as a function of $r^2$ the truncated square is concave, and on $[0, "
        r"h^2]$ this is the line through its two ends. So no larger share is right. For $\beta = "
        r"1$, $h = 2$ at $r = 0, \tfrac12, 1, \tfrac32, 2$: the truncated square is $0, \tfrac14, "
        r"1, 1, 1$, the chord $0, \tfrac1{16}, \tfrac14, \tfrac9{16}, 1$.",
        [*(truncated(r, limit) for r in places), *(chord(r, limit, most) for r in places)],
        [0, half**2, 1, 1, 1, 0, half**4, half**2, Fraction(9, 16), 1],
    )


CLAIM = Claim(
    name="chord_bound",
    title="A truncated square is above its chord",
    statement=r"For $0 \le r \le h$ and $0 \le \beta \le h$, $h > 0$: $$\min(r^2, \beta^2) \ge "
    r"\frac{\beta^2}{h^2}\, r^2, \qquad\text{so}\qquad \min\Bigl(\frac{r^2}{\beta^2}, 1\Bigr) \ge "
    r"\frac{r^2}{h^2} \quad\text{if}\quad \beta > 0,$$ with equality at $r = h$.",
    concludes=(1, 2, 3),
    hypotheses=(SIDES, ABOVE, WITHIN),
    source="elementary",
    proof=proof,
    controls={
        "the share beta / h": Mutation(
            at=2,
            proof=lambda: proof(LIMIT * MOST),
            point={RESIDUAL: 2, LIMIT: 1, MOST: 2},
        ),
        "a share of one": Mutation(
            at=2,
            proof=lambda: proof(MOST**2),
            point={RESIDUAL: 2, LIMIT: 1, MOST: 2},
        ),
    },
    not_claimed=r"Anything where $r$ may be above $h$: there the truncated square may be less.",
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
