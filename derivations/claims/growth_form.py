"""Claim: one growth form bounds gap and angle, and proves the optimum unique.

Everything is multiplied by norms: q is the certified quaternion, p any other, neither of norm one.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

from certreg.geometry.so3 import body_frame, dot
from certreg.verify import settled

from ..algebra import Square, facts, identity, nonnegative, positive
from ..hypothesis import Hypothesis, Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, inner, quaternion, rotation, scalar, square
from ..shipped import rerouted

MU, DELTA, WIDTH = scalar("mu"), scalar("delta"), scalar("w")
AT_Q, AT_P = scalar("f_q"), scalar("f_p")
Q, P = quaternion(), quaternion("p")
N, M = square(Q), square(P)
ALONG = dot(tuple(Q), tuple(P))
ACROSS = Matrix(body_frame(tuple(Q))).T * P
K, C = scalar("k"), scalar("c")  # cos b, and the factor of (cos b - cos s)^2
COS_S, COS_V = scalar("cos_s"), scalar("cos_v")
Settled = Callable[..., Any]


def growth_by(exponent: int) -> Hypothesis:
    """The growth form at p, with 1 - (u.v)^exponent; times powers of the norms."""
    power = exponent // 2
    return positive_by(
        rf"The growth form at $p$, with $1 - (u \cdot v)^{exponent}$.",
        (N * M) ** power * (AT_P - AT_Q + DELTA) - MU * ((N * M) ** power - ALONG**exponent),
        standing=Standing.CASE,
    )


GROWTH, QUARTIC = growth_by(2), growth_by(4)
GROWS = nonnegative_by(
    r"$\mu \ge 0$.",
    MU,
    example={MU: -1, WIDTH: 1, DELTA: 0, Q[0]: 1, P[1]: 1, AT_P: 0, AT_Q: Fraction(1, 2)},
)
OPTIMAL = nonnegative_by(r"$R(p)$ is a global optimum.", AT_Q - AT_P, standing=Standing.CASE)
COSINE = nonnegative_by(
    r"$k = \cos b$ lies between $-1$ and 1.",
    [1 - K, 1 + K],
    example={K: 2, WIDTH: 2, MU: 1, DELTA: Fraction(1, 8)},
)
RANGE = nonnegative_by(
    r"$c\,(1 + \cos b)^2 \le w$.",
    WIDTH - C * (1 + K) ** 2,
    standing=Standing.CASE,
    example={K: 1, WIDTH: 2, MU: 1, C: 2},
)
WIDE = nonnegative_by(
    r"$2\mu \le w$.",
    WIDTH - 2 * MU,
    standing=Standing.CASE,
    example={WIDTH: 1, C: 1, MU: 3, DELTA: Fraction(9, 4)},
)
NEAR_B = positive_by(
    r"The growth form at $\cos s = \cos b$, twice: $2\delta > \mu (1 - k)$.",
    2 * DELTA - MU * (1 - K),
    standing=Standing.CASE,
)
STEEP = positive_by(r"$\mu > 0$.", MU, standing=Standing.CASE)
SMALL = nonnegative_by(
    r"$4 w \delta \le \mu^2$.",
    MU**2 - 4 * WIDTH * DELTA,
    standing=Standing.CASE,
    example={WIDTH: 2, MU: 1, DELTA: 1},
)
NEAR_H = positive_by(
    r"The growth form at $\cos s = k - h$, $h = \mu (1 + k)^2/(4w)$, times $16 w^2$.",
    16 * WIDTH**2 * DELTA
    - 8 * WIDTH**2 * MU * (1 - K)
    - 2 * WIDTH * MU**2 * (1 + K) ** 2
    + C * MU**2 * (1 + K) ** 4,
    standing=Standing.CASE,
)
HALF = nonnegative_by(r"$\cos s \ge 0$.", COS_S, standing=Standing.CASE)
BELOW_ONE = nonnegative_by(r"$\cos v \le 1$.", 1 - COS_V)


def proof(
    shipped: Settled = settled, *, gap: int = 1, angle: int = 1, enough: int = 4, bend: int = 1
) -> Proof:
    """The two growth forms, gap and angle, two optima on a circle, and what the checker asks."""
    yield identity(
        r"With $n = |q|^2$, $m = |p|^2$: $n^2 m^2 - (q \cdot p)^4 = |L(q)^{\mathsf T} p|^2\, "
        r"(n m + (q \cdot p)^2)$, and $|L(q)^{\mathsf T} p|^2 = n m \sin^2(\theta/2)$.",
        (N * M) ** 2 - ALONG**4,
        square(ACROSS) * (N * M + bend * ALONG**2),
    )
    yield identity(
        r"For the trace of $R(q)^{\mathsf T} R(p)$, which is $1 + 2\cos\theta = 3 - "
        r"4\sin^2(\theta/2)$, is $3 - 4\,|L(q)^{\mathsf T} p|^2/(n m)$.",
        inner(rotation(Q), rotation(P)),
        3 * N * M - 4 * square(ACROSS),
    )
    yield positive(
        r"So a growth form of degree four, in $1 - (u \cdot v)^4$, is one in $\sin^2(\theta/2)$, "
        r"here times $n^2 m^2$.",
        (N * M) ** 2 * (AT_P - AT_Q + DELTA) - MU * N * M * square(ACROSS),
        [[QUARTIC[0]], *([GROWS[0], Square(e), Square(ALONG)] for e in ACROSS)],
    )
    yield positive(
        r"**Gap.** $f(R(q)) - f(R(p)) < \delta$, here times $n m$, for every $p \ne 0$.",
        N * M * (DELTA - gap * (AT_Q - AT_P)),
        [[GROWTH[0]], *([GROWS[0], Square(e)] for e in ACROSS)],
    )
    yield positive(
        r"**Angle.** At a global optimum $\mu \sin^2(\theta/2) < \delta$, here times $n m$.",
        DELTA * N * M - angle * MU * square(ACROSS),
        [[GROWTH[0]], *([OPTIMAL[0], Square(a * b)] for a in Q for b in P)],
    )
    yield from _circle()
    yield from _uniqueness(enough)
    yield facts(
        r"`certreg.verify.settled`, with its words replaced, at $\mu = 2$: it grants *unique* at "
        r"$\delta = \mu^2/(4w)$ with $w = 4$ and refuses it a little above, or with a larger $w$; "
        r"where $w < 2\mu$, $2\mu$ stands for it. Without the claim it grants all of them, and a "
        r"gap or an angle below $\delta$, $\delta/\mu$ it refuses.",
        _granted(shipped),
        [True, False, False, True, False, True, False, False],
    )


def _circle() -> Proof:
    a, b, c, s = (scalar(name) for name in ("cos_b2", "sin_b2", "cos_s2", "sin_s2"))
    yield identity(
        r"**Uniqueness.** Suppose two global optima. The quaternions of the circle through both "
        r"are $\cos(s/2)\, g + \sin(s/2)\, h$, with $g$ in the middle, and the optima at "
        r"$s = \mp b$, $0 < b \le \pi/2$ (choose signs). Along it $f - \min f$ is a form of degree "
        r"four in $(\cos(s/2), \sin(s/2))$, nowhere negative and zero on two lines, hence double "
        r"there: a constant times the square of the product of two linear forms, "
        r"$2 \sin((s-b)/2) \sin((s+b)/2) = \cos b - \cos s$ (here with "
        r"$\cos^2 + \sin^2$ written out). So it is $c\,(\cos b - \cos s)^2$, and at $s = \pi$ it "
        r"is $c\,(1 + \cos b)^2 \le w$.",
        2 * (s * a - c * b) * (s * a + c * b),
        (a**2 - b**2) * (c**2 + s**2) - (c**2 - s**2) * (a**2 + b**2),
    )
    yield nonnegative(
        r"Let $s = v$ be the point of the circle nearest to $q$. Of the quaternion at $s$ the part "
        r"along $q$ is at most $|\cos((s - v)/2)|$, so $\sin^2(\theta/2) \ge \sin^2((s - v)/2)$ "
        r"there. At $s$ and $-s$ these add up to $1 - \cos s \cos v$, which is at least $1 - \cos "
        r"s$ if $\cos s \ge 0$: one of the two is at least $(1 - \cos s)/2$. As $c\,(\cos b - \cos "
        r"s)^2$ is the same at both, the growth form says $c\,(\cos b - \cos s)^2 > \mu (1 - \cos "
        r"s)/2 - \delta$ whenever $\cos s \ge 0$ (as $f(R(q)) \ge \min f$).",
        (1 - COS_S * COS_V) - (1 - COS_S),
        [[HALF[0], BELOW_ONE[0]]],
    )


def _uniqueness(enough: int) -> Proof:
    yield positive(
        r"At $\cos s = \cos b = k$ it says $2\delta > \mu(1 - k)$. Let $4 w \delta \le \mu^2$ and "
        r"$2\mu \le w$, $\mu > 0$ (if $\mu = 0$, $w > 0$ and $\delta > 0$, the first is false); "
        r"then $k > 3/4$, here times $w \mu$.",
        WIDTH * MU * (4 * K - 3),
        [[4, WIDE[0], NEAR_B[0]], [8, STEEP[0], NEAR_B[0]], [2, SMALL[0]], [GROWS[0], WIDE[0]]],
    )
    yield nonnegative(
        r"So $k - h \ge 0$ for $h = \mu (1 + k)^2/(4w) \le 1/2$; the latter here times $4w$.",
        2 * WIDTH - MU * (1 + K) ** 2,
        [[2, WIDE[0]], [2, GROWS[0], COSINE[0]], [GROWS[0], COSINE[0], COSINE[1]]],
    )
    yield positive(
        r"At $\cos s = k - h$ it says $c h^2 > \mu (1 - k + h)/2 - \delta$. With $c (1 + k)^2 \le "
        r"w$ and $2\mu \le w$ follows $4 w \delta > \mu^2$, here times $4 w$. So if $4 w \delta "
        r"\le \mu^2$ there are no two optima.",
        4 * WIDTH * (enough * WIDTH * DELTA - MU**2),
        [
            [NEAR_H[0]],
            [Square(MU * (1 + K)), RANGE[0]],
            *([8, GROWS[0], COSINE[0], WIDE[0], *wide] for wide in ([WIDE[0]], [2, GROWS[0]])),
            *(
                [factor, GROWS[0], GROWS[0], *one, *wide]
                for wide in ([WIDE[0]], [2, GROWS[0]])
                for factor, one in ((12, [COSINE[0]]), (1, [COSINE[0], COSINE[0]]))
            ),
        ],
    )


def _granted(shipped: Settled) -> list[bool]:
    """Whether claims are granted: of unique, at (delta, width); of gap and angle."""
    at = (
        (Fraction(1, 4), 4, True),
        (Fraction(1, 4) + Fraction(1, 2**40), 4, True),
        (Fraction(1, 4), 4 + Fraction(1, 2**40), True),
        (Fraction(1, 4), 1, True),
        (Fraction(1, 4) + Fraction(1, 2**40), 1, True),
        (Fraction(100), 4, None),
    )
    found = [_asked(shipped, d, Fraction(d), d / 2, w, unique=u) for d, w, u in at]
    less = Fraction(1) - Fraction(1, 2**40)
    found.append(_asked(shipped, Fraction(1), less, None, 4, unique=None))
    found.append(_asked(shipped, Fraction(1), Fraction(1), less / 2, 4, unique=None))
    return found


def _asked(
    shipped: Settled,
    delta: Fraction,
    gap: Fraction,
    sin2: Fraction | None,
    width: Any,
    *,
    unique: bool | None,
) -> bool:
    met: list[bool] = []
    decide = rerouted(
        shipped,
        require=lambda condition, _words: met.append(bool(condition)),
        _worth=lambda *_parts: None,
        _words=lambda *_parts: (),
    )
    stated = SimpleNamespace(pose=(1, 0, 0, 0), gap=gap, sin2_half_angle=sin2)
    stated.unique, stated.symmetry = unique, None
    stated.steady_by_growth = lambda *_parts: []
    f = SimpleNamespace(at=lambda _: Fraction(0), F=[], weight=Fraction(1), lever=Fraction(1))
    decide(stated, f, delta, Fraction(2), width, tied=False)
    return all(met)


def _careless(stated: Any, f: Any, *bounds: Any, tied: bool) -> Any:
    """A checker that grants whatever is claimed."""
    return _worth(f), _words(stated), require(bool(bounds) or tied, "")


def _worth(*_parts: Any) -> None:
    """Replaced."""


def _words(*_parts: Any) -> tuple[str, ...]:
    """Replaced."""
    return ()


def require(*_parts: Any) -> None:
    """Replaced."""


CLAIM = Claim(
    name="growth_form",
    title="The growth form",
    statement=r"Let $f(S) > f(R) - \delta + \mu \sin^2(\theta/2)$ for every rotation $S$, $\theta$ "
    r"the angle between $R$ and $S$, $\mu \ge 0$; it is enough that this holds with $1 - "
    r"(u \cdot v)^4$ for $\sin^2(\theta/2)$, $u$ and $v$ the unit quaternions. Then "
    r"(1) $f(R) - \min f < \delta$; (2) $\mu \sin^2(\theta/2) < \delta$ at every global optimum; "
    r"(3) for $f$ of degree two in the entries of $S$, $\max f - \min f \le w$ and "
    r"$2\mu \le w$: if $4 w \delta \le \mu^2$, there is one global optimum only.",
    concludes=(1, 3, 4, 5, 7, 8, 9, 10, 11),
    hypotheses=(
        GROWTH,
        QUARTIC,
        GROWS,
        OPTIMAL,
        COSINE,
        RANGE,
        WIDE,
        NEAR_B,
        STEEP,
        SMALL,
        NEAR_H,
        HALF,
        BELOW_ONE,
    ),
    source="elementary",
    proof=proof,
    witness={K: 1, WIDTH: 2, MU: 1, DELTA: Fraction(1, 8)},
    controls={
        "half of the gap": Mutation(
            at=4,
            proof=lambda: proof(gap=2),
            point={DELTA: 3, AT_Q: 2, Q[0]: 1, P[0]: 1},
        ),
        "twice the sine": Mutation(
            at=5,
            proof=lambda: proof(angle=2),
            point={DELTA: 3, MU: 2, Q[0]: 1, P[1]: 1},
        ),
        "the fourth power without the square": Mutation(at=1, proof=lambda: proof(bend=0)),
        "unique wherever 2 w delta <= mu^2": Mutation(
            at=10,
            proof=lambda: proof(enough=2),
            point={K: 1, WIDTH: 2, MU: 1, C: Fraction(1, 2), DELTA: Fraction(1, 5)},
        ),
        "a checker that grants all": Mutation(at=11, proof=lambda: proof(_careless)),
    },
    not_claimed=r"That an optimum which is not proved unique has another beside it. That pairs are "
    r"right.",
    needs=("quaternions", "optimality_certificate"),
    runs=("certreg.verify.settled",),
    used_by=(
        "certreg.certificate.cones.springs_certificate",
        "certreg.certificate.cones.cones_body",
    ),
    standard=(
        "Where a polynomial in one variable is nowhere negative, its real zeros are multiple.",
    ),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
