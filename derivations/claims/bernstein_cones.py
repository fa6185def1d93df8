"""Claim: positive Bernstein coefficients prove a quartic positive on a cone, and how it is cut."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import sympy

from certreg.verify import POWERS, QUARTICS, cutting

from ..algebra import identity, positive
from ..hypothesis import nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import entry

Cutting = Callable[[], Any]
HALF = sympy.Rational(1, 2)
S = [entry("s", k) for k in range(4)]
B = [entry("b", k) for k in range(len(QUARTICS))]
ABOVE = positive_by("The 35 coefficients $b_m$ are positive.", B)
INSIDE = nonnegative_by("$s_1, s_2, s_3 \\ge 0$.", S[1:])
FIRST = positive_by("$s_0 > 0$: one of the four is, this one, say.", S[0])


def shipped_cutting() -> Any:
    """What the checker's table says, made anew."""
    return inspect.unwrap(cutting)()


def of(b: Any, s: Any) -> Any:
    """The sum of b_m (24/POWERS_m) s^m."""
    return sum(
        c * sympy.Rational(24, times) * sympy.prod([s[i] for i in m])
        for c, times, m in zip(b, POWERS, QUARTICS, strict=True)
    )


def proof(table: Cutting = shipped_cutting, mean: Any = HALF) -> Proof:
    """Positive on the cone; both halves at each of the six edges."""
    yield positive(
        r"On the cone of $v_0, \ldots, v_3$ a quartic is $P(s_0 v_0 + \ldots + s_3 v_3) = \sum_m "
        r"b_m \binom{4}{m} s^m$, $s \ge 0$. If all 35 $b_m$ are positive so is $P$, but at zero.",
        of(B, S),
        [
            [
                sympy.Rational(24, times),
                ABOVE[k],
                *(FIRST[0] if i == 0 else INSIDE[i - 1] for i in m),
            ]
            for k, (times, m) in enumerate(zip(POWERS, QUARTICS, strict=True))
        ],
    )
    for (i, j), sums, halves in table()[0]:
        means = [*B]
        for x, y in sums:
            means.append((means[x] + means[y]) * mean)
        half = S[i] + S[j] / 2, S[j] / 2
        other = S[i] / 2, S[j] + S[i] / 2
        cut = [{S[i]: a, S[j]: b} for a, b in (half, other)]
        yield identity(
            rf"The edge of $v_{i}$ and $v_{j}$ is cut at $(v_{i} + v_{j})/2$. The means that "
            r"`certreg.verify.cutting` names, run on symbols, are the coefficients on both halves: "
            rf"of $v_{i}$ with the middle, and of the middle with $v_{j}$.",
            [of(found(means), S) for found in halves],
            [of(B, S).subs(at, simultaneous=True) for at in cut],
        )


def _swapped() -> Any:
    edges, bent = shipped_cutting()
    return [(edge, sums, halves[::-1]) for edge, sums, halves in edges], bent


CLAIM = Claim(
    name="bernstein_cones",
    title="Cones and Bernstein coefficients",
    statement=r"Let $P(\sum_k s_k v_k) = \sum_m b_m \binom{4}{m} s^m$ with 35 coefficients $b_m > "
    r"0$. Then $P > 0$ on the cone of $v_0, \ldots, v_3$, but at zero. At each of the six edges, "
    r"the coefficients that the checker makes by means of two are those on the two halves, cut at "
    r"$(v_i + v_j)/2$.",
    concludes=(1, 2, 3, 4, 5, 6, 7),
    hypotheses=(ABOVE, INSIDE, FIRST),
    setting=(
        "The checker rounds means down: these increase with both, so its numbers stay below.",
    ),
    source="elementary; the means are de Casteljau's",
    proof=proof,
    controls={
        "sums instead of means": Mutation(at=2, proof=lambda: proof(mean=sympy.Integer(1))),
        "the halves exchanged": Mutation(at=2, proof=lambda: proof(_swapped)),
    },
    not_claimed=r"That coefficients which are not positive say anything of $P$; that cutting ends. "
    r"Of the caps, in which no cone is asked for, nothing is proved here.",
    needs=("growth_form",),
    runs=("certreg.verify.cutting",),
    used_by=("certreg.verify.prove_positive", "certreg.native.cones.search_cones"),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
