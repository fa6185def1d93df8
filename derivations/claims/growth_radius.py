"""Claim: how far the points of general springs may move before an optimum leaves an angle."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from certreg.verify import Movable, RefusalError

from ..algebra import Square, facts, identity, positive
from ..hypothesis import Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import inner, quaternion, rotation, scalar, square, vector

Keeps = Callable[..., Any]
MU, DELTA, FIT = scalar("mu"), scalar("delta"), scalar("z")
AT_S, MOVED = scalar("f_S"), scalar("m")
LITTLE, SMALL = Fraction(1, 2**20), Fraction(1, 16)
LEVER, OFF_X, OFF_Y, S, SIGMA = (scalar(name) for name in ("k", "X", "Y", "s", "sigma"))


def margin(s: Any, eight: int = 8) -> Any:
    """(mu - 8 k X) s^2 - 4 s (k (X + Y) + X (z + X + Y)) - delta."""
    slope = LEVER * (OFF_X + OFF_Y) + OFF_X * (FIT + OFF_X + OFF_Y)
    return (MU - eight * LEVER * OFF_X) * s**2 - 4 * s * slope - DELTA


LOST = nonnegative_by(
    r"$\delta \ge 0$.",
    DELTA,
    example={S: 1, SIGMA: 2, MU: 1, LEVER: 1, OFF_Y: 1, DELTA: -3},
)
ENOUGH = nonnegative_by(
    r"At $s = \sin(a/2)$ the margin is not negative.", margin(S), standing=Standing.CASE
)
POSITIVE = positive_by("$s > 0$.", S, standing=Standing.CASE, example={S: -1, SIGMA: 1, MU: 1})
STEEP = positive_by(
    r"$\mu > 8 k X$.",
    MU - 8 * LEVER * OFF_X,
    standing=Standing.CASE,
    example={S: 1, SIGMA: 2},
)
GROWN = positive_by(
    r"The growth form at $\sigma$, $z^2 = f(R)$.",
    AT_S - FIT**2 + DELTA - MU * SIGMA**2,
    standing=Standing.CASE,
)
ROOTS = nonnegative_by(
    r"$\mu s^2 \ge \delta + 4 m (z + m)$.",
    MU * S**2 - DELTA - 4 * MOVED * (FIT + MOVED),
    standing=Standing.CASE,
    example={S: 1, SIGMA: 2, MU: 1, FIT: 1, MOVED: 10, AT_S: 6},
)
GROWS = nonnegative_by(r"$\mu \ge 0$.", MU, standing=Standing.CASE)
BEYOND = positive_by(
    r"$\sigma > s$.", SIGMA - S, standing=Standing.CASE, example={S: 1, MU: 1, DELTA: 1}
)


def proof(
    radius: Keeps = Movable.steady_by_growth, *, eight: int = 8, twice: int = 2, four: int = 4
) -> Proof:
    """Residuals move by so much; the energy by so much; a convex function; and the program."""
    q, p, x = quaternion(), quaternion("p"), vector("x")
    n, m = square(q), square(p)
    apart = m * rotation(q) * x - n * rotation(p) * x
    along = (q.T * p)[0]
    across = n * m - along**2
    yield identity(
        r"For two rotations at an angle $\theta$, $\sigma = \sin(\theta/2)$: $|R - S|^2$ is $8 "
        r"\sigma^2$ in the Frobenius norm, here times $n^2 m^2$.",
        inner(m * rotation(q) - n * rotation(p), m * rotation(q) - n * rotation(p)),
        2 * twice**2 * n * m * across,
    )
    rest = apart.T * apart
    yield identity(
        r"And $|R x - S x|^2 \le 4 \sigma^2 |x|^2$: with axis $e$ and $R^{\mathsf T} S$ turning "
        r"by $\theta$ it is $4 \sigma^2 |x|^2$ less $4 \sigma^2 (e \cdot x)^2$, here for $R = I$ "
        r"and $p = (w, v)$, times $m^2$, where $m \sigma^2 = |v|^2$.",
        rest[0].subs(dict(zip(q, (1, 0, 0, 0), strict=True))),
        4 * m * (square(p[1:]) * square(x) - _dot(p[1:], x) ** 2),
    )
    yield from _energies(eight)
    yield from _roots(four)
    yield facts(
        r"`certreg.verify.Movable.steady_by_growth` with $\mu = 10$, $\delta = 0$, $f(R) = 4$, "
        r"$k = 1$, $\sum w = 1$, $s = 1/2$ grants $Y$ a little below $5/4$, where $5 = 4 Y$, and "
        r"refuses it a little above; of both clouds it grants 0.229 and refuses 0.230: the root of "
        r"$8 X^2 + 20 X = 5$ is between. With $\delta = 1/4$ the edge is at $Y = 9/8$. With $f(R) "
        r"= 9/16$ and $k = 4$ it is at $Y = 1/2$, and at $X = Y = 1/4$, by the roots; if $\delta = "
        r"3/2$ besides at $Y = 1/4$.",
        [
            *(_granted(radius, *radii) for radii in _radii()),
            *(_granted(radius, y, SMALL, Fraction(1, 4)) for y in _around(Fraction(9, 8))),
            *(_rooted(radius, y, SMALL) for y in _around(Fraction(1, 2))),
            *(_rooted(radius, SMALL, x) for x in _around(Fraction(1, 4))),
            *(_rooted(radius, y, SMALL, Fraction(3, 2)) for y in _around(Fraction(1, 4))),
        ],
        [True, False, False, *[True, False] * 4],
    )


def _dot(a: Any, b: Any) -> Any:
    return sum(i * j for i, j in zip(a, b, strict=True))


def _energies(eight: int) -> Proof:
    h, g, r, u = (vector(name) for name in "hgru")
    yield identity(
        r"Write $r(S)$ for all residuals $L_i^{\mathsf T}(y_i - S x_i)$ less the part that a "
        r"shift takes away (a projection, the same for all $S$): $f(S) = |r(S)|^2$, and $|r(S) - "
        r"r(R)| \le 2 \sigma k$, $k^2 = \sum_i w_i |x_i - \bar x|^2$, by the step before and $w_i "
        r"\ge \lambda_{\max}(W_i)$, a shift of $x$ being taken away. Points that move add $h - "
        r"g(S)$, linear in $S$, $|h| \le Y$, $|g(S)| \le X$, $|g(S) - g(R)| \le 2 \sigma X$. With "
        r"$r = r(R)$, $u = r(S) - r$, $g$ at $R$ and $g'$ the change of $g$, the moved energies at "
        r"$S$ and $R$ differ by $|r + u|^2 - |r|^2$, the old difference, and "
        r"$2 u \cdot (h - g - g') - 2 (r + h - g) \cdot g' + |g'|^2$.",
        square(r + u + h - g - vector("d")) - square(r + h - g),
        (square(r + u) - square(r))
        + 2 * _dot(u, h - g - vector("d"))
        - 2 * _dot(r + h - g, vector("d"))
        + square(vector("d")),
    )
    d = SIGMA * 2
    yield identity(
        r"By Cauchy and Schwarz, $|g'| \le 2\sigma X$ and $|u| \le 2 \sigma k$, the further terms "
        r"are at least $-4 \sigma k (X + Y + 2 \sigma X) - 4 \sigma X (z + X + Y)$, $z = "
        r"\sqrt{f(R)}$. Less these, the growth form leaves the margin $(\mu - 8 k X) \sigma^2 - 4 "
        r"\sigma\, (k (X + Y) + X (z + X + Y)) - \delta$.",
        MU * SIGMA**2
        - DELTA
        - 2 * d * LEVER * (OFF_X + OFF_Y + d * OFF_X)
        - 2 * d * OFF_X * (FIT + OFF_X + OFF_Y),
        margin(SIGMA, eight),
    )
    yield positive(
        r"If the margin is not negative at $s$, with $\mu > 8 k X$, it is positive at every "
        r"$\sigma > s$, here times $s$: no rotation farther than $a$ is optimal.",
        S * margin(SIGMA),
        [
            [POSITIVE[0], ENOUGH[0]],
            [BEYOND[0], ENOUGH[0]],
            [STEEP[0], Square(POSITIVE[0]), BEYOND[0]],
            [STEEP[0], POSITIVE[0], Square(BEYOND[0])],
            [LOST[0], BEYOND[0]],
        ],
    )


def _roots(four: int) -> Proof:
    yield positive(
        r"Or by roots. The residuals at every rotation move by no more than $m = X + Y$, and so "
        r"does their length: the moved $\sqrt{f(S)}$ is at least $\sqrt{f(S)} - m$, that of $R$ at "
        r"most $z + m$. If $\mu s^2 \ge \delta + 4 m (z + m)$, then $f(S) > (z + 2 m)^2$ at every "
        r"$\sigma > s$: no rotation farther than $a$ is optimal.",
        AT_S - FIT**2 - four * MOVED * (FIT + MOVED),
        [
            [GROWN[0]],
            [ROOTS[0]],
            [GROWS[0], Square(BEYOND[0])],
            [2, GROWS[0], POSITIVE[0], BEYOND[0]],
        ],
    )


def _rooted(radius: Keeps, target: Fraction, both: Fraction, delta: Fraction = Fraction(0)) -> bool:
    """With z = 3/4 and k = 4."""
    return _granted(radius, target, both, delta, value=Fraction(9, 16), lever=Fraction(16))


def _around(edge: Fraction) -> tuple[Fraction, Fraction]:
    return edge - LITTLE, edge + LITTLE


def _radii() -> tuple[tuple[Fraction, Fraction], ...]:
    """Of the target, of both: just inside, and one of them outside."""
    (below, above), inside = _around(Fraction(5, 4)), Fraction(229, 1000)
    return (below, inside), (above, inside), (below, inside + Fraction(1, 1000))


def _granted(
    radius: Keeps,
    target: Fraction,
    both: Fraction,
    delta: Fraction = Fraction(0),
    *,
    value: Fraction = Fraction(4),
    lever: Fraction = Fraction(1),
) -> bool:
    claim = Movable(both=both, separation=None, sin_half_angle=Fraction(1, 2), target=target)
    try:
        radius(claim, Fraction(10), delta, value, Fraction(1), lever)
    except RefusalError:
        return False
    return True


def _trusting(*_parts: Any) -> list[str]:
    return []


CLAIM = Claim(
    name="growth_radius",
    title="How far the points of general springs may move",
    statement=r"Let $f$ have a growth form with $\mu, \delta$ at $R$, $w_i \ge "
    r"\lambda_{\max}(W_i)$, $k^2 = \sum_i w_i |x_i - \bar x|^2$, and let points move with $\sum_i "
    r"w_i |dx_i|^2 \le X^2$, $\sum_i w_i |dy_i|^2 \le Y^2$, the $W_i$ staying. If with $s = "
    r"\sin(a/2) > 0$ $$(\mu - 8 k X)\, s^2 \ge 4 s\, \bigl(k (X + Y) + X (\sqrt{f(R)} + X + "
    r"Y)\bigr) + \delta, \qquad \mu > 8 k X,$$ or if with $m = X + Y$ $$\mu s^2 \ge 4 m\, "
    r"(\sqrt{f(R)} + m) + \delta,$$ every optimum of the moved points is within the angle $a$ of "
    r"$R$.",
    concludes=(1, 2, 3, 4, 5, 6, 7),
    hypotheses=(LOST, ENOUGH, POSITIVE, STEEP, GROWN, ROOTS, GROWS, BEYOND),
    source="elementary",
    proof=proof,
    witness={S: 1, SIGMA: 2, AT_S: 1},
    controls={
        "rotations half as far apart": Mutation(at=1, proof=lambda: proof(twice=1)),
        "a loss of 4 k X in the growth": Mutation(at=4, proof=lambda: proof(eight=4)),
        "roots that move by half as much again": Mutation(
            at=6,
            proof=lambda: proof(four=5),
            point={S: 1, SIGMA: Fraction(101, 100), MU: 8, MOVED: 1, FIT: 1, AT_S: Fraction(46, 5)},
        ),
        "a checker that grants all": Mutation(at=7, proof=lambda: proof(_trusting)),
    },
    not_claimed=r"That this is the largest such motion: the true one is some times larger. That "
    r"the optimum of the moved points is unique. Normals and weights do not move.",
    needs=("growth_form", "spring_translation", "quaternions"),
    runs=("certreg.verify.Movable.steady_by_growth",),
    used_by=("certreg.certificate.radius.growth_radius",),
    standard=("The inequality of Cauchy and Schwarz.",),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
