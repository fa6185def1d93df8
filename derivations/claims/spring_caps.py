"""Claim: around a centre of enough curvature the objective of general springs is seen to rise."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import prod
from types import SimpleNamespace
from typing import Any

import sympy

from certreg.verify import BITS, QUARTICS, SQUARE, cap_of, local, spread

from ..algebra import Square, facts, identity, nonnegative, positive, quoted
from ..hypothesis import Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import (
    Matrix,
    entry,
    gradient,
    left_product,
    quaternion,
    rotation,
    scalar,
    square,
    vector,
)
from ..rings import ring_of
from ..shipped import modelled, rerouted

Local = Callable[..., Any]
Spread = Callable[[Any], Fraction]
CapOf = Callable[[Any, Fraction], Any]
Q, AXIS = quaternion(), vector("d")
B = [entry("F", k) for k in range(len(QUARTICS))]
F = sum(b * sympy.prod([Q[i] for i in m]) for b, m in zip(B, QUARTICS, strict=True))
E = left_product([0, *AXIS]) * Q  # d q
SIZE, CURVATURE, WIDTH = scalar("unit"), scalar("k"), scalar("w")
BENT, CENTRE_BENT, ANGLE, SLOPE = (scalar(name) for name in ("h", "h_c", "a", "g"))
HERE, AT_CENTRE, DEPTH, STEEPNESS = (scalar(name) for name in ("f", "f_c", "depth", "m"))

LIPSCHITZ = nonnegative_by(
    "$h(S) \\ge h(R(c)) - 4 w a$.", BENT - CENTRE_BENT + 4 * WIDTH * ANGLE, standing=Standing.CASE
)
CURVED = positive_by("$h(R(c)) > k$.", CENTRE_BENT - CURVATURE, standing=Standing.CASE)
INSIDE = nonnegative_by(
    "$a \\le r = k/(8 w)$.",
    CURVATURE - 8 * WIDTH * ANGLE,
    standing=Standing.CASE,
    example={ANGLE: 1, WIDTH: 1, BENT: -2, CENTRE_BENT: 2, CURVATURE: 1},
)
RISES = nonnegative_by(
    "$f(S) - f(R(c))$ is at least $k a^2/4 - g a$.",
    HERE - AT_CENTRE + SLOPE * ANGLE - CURVATURE * ANGLE**2 / 4,
    standing=Standing.CASE,
)
SOME = nonnegative_by("$k \\ge 0$.", CURVATURE, standing=Standing.CASE)
ABOVE = nonnegative_by(
    "$k \\ge m$.",
    CURVATURE - STEEPNESS,
    standing=Standing.CASE,
    example={CURVATURE: 1, STEEPNESS: 2, DEPTH: -2, HERE: 5},
)
ROOM = positive_by(
    "$g^2 < (k - m)\\, \\eta$.",
    (CURVATURE - STEEPNESS) * DEPTH - SLOPE**2,
    standing=Standing.CASE,
)


def along(form: Any) -> Any:
    """The operator (d q)/2 . grad."""
    return (E.T * gradient(form, Q))[0] / 2


def proof(
    near: Local = local, width: Spread = spread, cap: CapOf = cap_of, *, less: int = 4, ask: int = 4
) -> Proof:
    """Derivatives of quartics are quartics; Bernstein; the ball; and the program."""
    yield from _derivatives(less)
    yield from _bounds(width)
    yield from _caps(cap)
    yield quoted(
        r"A trigonometric polynomial of degree $2$ and of size at most $c$ has a derivative of "
        r"size at most $2 c$. By step 4 $f$ less the middle of its range is one along every such "
        r"line, of size at most $w/2$, $w \ge \max f - \min f$: derived twice, $|h| \le 2 w$, $h = "
        r"D^2 f$, $|d| = 1$. For every fixed $d$ $h$ is again a quartic over $|q|^4$, by step "
        r"3: of degree $2$ along all those lines, in any direction. So its slope is at most $4 w$.",
        theorem="Bernstein's inequality",
        source="[Zygmund2002], Bernstein's inequality",
    )
    yield from _inside()
    yield from _decided(near, ask)


def _derivatives(less: int) -> Proof:
    a, s, turn = scalar("C"), scalar("S"), scalar("n")
    along_q = a * Q + s * E
    yield identity(
        r"Along $\exp(s [d]) R(q)$, $|d| = 1$, the quaternion is $C q + S e$, $C = \cos(s/2)$, $S "
        r"= \sin(s/2)$, $e = d q$: $R(C, S d)$ times $R(q)$, here for every $C$, $S$, $d$, each "
        r"times its norm.",
        rotation([a, *(s * AXIS)]) * rotation(Q),
        rotation(along_q),
    )
    yield identity(
        r"Its derivative at $s = 0$ is $e/2$, so the derivative of functions of $q$ along $d$ is "
        r"$D = \tfrac12 e \cdot \nabla$. It makes quartics of quartics, and $D |q|^2 = 0$: so it "
        r"does of quartics over $|q|^4$, that is of $f$.",
        along(square(Q)),
        0,
    )
    hessian = gradient(F, Q).jacobian(Q)
    yield identity(
        r"For every quartic $F$ $D^2 F = \tfrac14 (e^{\mathsf T} F'' e - 4 |d|^2 F)$: a quartic "
        r"once more, for every fixed $d$.",
        4 * along(along(F)),
        (E.T * hessian * E)[0] - less * square(AXIS) * F,
    )
    cosine, sine = a**2 - s**2, 2 * a * s
    yield identity(
        r"On a line, a quartic is one in $C$ and $S$; its five monomials are of degree two in "
        r"$\cos s = C^2 - S^2$ and $\sin s = 2 C S$, here with $C^2 + S^2$ for $1$.",
        [4 * a ** (4 - k) * s**k for k in range(5)],
        [
            value.subs(turn, a**2 + s**2)
            for value in (
                (turn + cosine) ** 2,
                (turn + cosine) * sine,
                sine**2,
                (turn - cosine) * sine,
                (turn - cosine) ** 2,
            )
        ],
    )


class Value:
    """The objective at c, unit F/|c|^4, with a curvature added, as a quotient of polynomials."""

    def __init__(self, number: Any, unit: Any, norm: Any, added: Any = 0) -> None:
        self.number, self.unit, self.norm, self.added = number, unit, norm, added

    def __add__(self, curvature: Any) -> Value:
        return Value(self.number, self.unit, self.norm, self.added + curvature)

    def __rmul__(self, factor: Any) -> Value:
        modelled(factor == 4 * self.norm**2, f"{factor} times the objective")
        return self

    def __truediv__(self, unit: Any) -> Value:
        modelled(unit == self.unit, f"the objective over {unit}")
        return self

    def as_integer_ratio(self) -> tuple[Any, Any]:
        """4 |c|^4 (objective + curvature), and the unit: it was to be over that."""
        return 4 * (self.unit * self.number + self.norm**2 * self.added), self.unit


def _decided(near: Local, ask: int) -> Proof:
    ring = ring_of([F, SIZE, CURVATURE])
    number, unit, k, *c = (ring.from_expr(x) for x in (F, SIZE, CURVATURE, *Q))
    norm, seen = sum((x * x for x in c[1:]), c[0] * c[0]), list[Any]()
    springs = SimpleNamespace(
        F=[ring.from_expr(b) for b in B], unit=unit, at=lambda _: Value(number, unit, norm)
    )
    slope = rerouted(
        near,
        definite=seen.append,
        require=lambda *_: None,
        Fraction=lambda over, under: (modelled(under == 36 * norm**4, "a slope"), over)[1],
    )(springs, c, k)
    modelled(len(seen) == 1, "more than one definiteness decides")
    A = Matrix([[entry.as_expr() for entry in row] for row in seen[0]])
    yield identity(
        r"`certreg.verify.local`, run on symbols, decides whether $A$ is positive definite: "
        r"$d^{\mathsf T} A d = 4 (\text{unit}\, D^2 F(c) - k |c|^4 |d|^2)$. Where it is, $h(R(c)) "
        r"> k$ for $f = \text{unit}\, F/|q|^4$ and all unit $d$.",
        (AXIS.T * A * AXIS)[0],
        4 * SIZE * along(along(F)) - ask * CURVATURE * square(Q) ** 2 * square(AXIS),
    )
    slopes = [along(F).subs(dict(zip(AXIS, row, strict=True))) for row in sympy.eye(3).tolist()]
    yield identity(
        r"What it returns is the square of the slope $g$, here times $36 |c|^8$: the sum of $(D "
        r"f)^2$ over three axes.",
        slope.as_expr(),
        36 * SIZE**2 * square(slopes),
    )


def _inside() -> Proof:
    yield positive(
        r"So at an angle $a \le r = k/(8 w)$ from $R(c)$, the second derivative exceeds $k/2$ in "
        r"every direction: $f$ is strongly convex along the lines.",
        2 * BENT - CURVATURE,
        [[2, LIPSCHITZ[0]], [2, CURVED[0]], [INSIDE[0]]],
    )
    yield nonnegative(
        r"Integrated twice along the line from $R(c)$, $f(S) \ge f(R(c)) - g a + k a^2/4$. With "
        r"$k \ge 0$ this is at least $f(R(c)) - g^2/k$, here times $k$.",
        CURVATURE * (HERE - AT_CENTRE) + SLOPE**2,
        [[SOME[0], RISES[0]], [Square(CURVATURE * ANGLE / 2 - SLOPE)]],
    )
    yield positive(
        r"If $g^2 < (k - m)\, \eta$ and $k \ge m$, then $k > m$ and $f(S) > f(R(c)) - \eta + m "
        r"a^2/4$, here times $k - m$. The checker asks for that with $m = \mu \ge 0$, $\eta = "
        r"\delta \ge 0$ if $R(c) = R$, and as $a^2/4 \ge \sin^2(a/2)$, $f(S) > f(R) - \delta + \mu "
        r"\sin^2(a/2)$. Else with $m = 0$, $\eta = f(R(c)) - f(R) + \delta - \mu$, and $f(S) > "
        r"f(R) - \delta + \mu$. Either is the growth form. Where a tie is claimed $g = \eta = 0$ "
        r"will do too: then $f(S) \ge f(R(c)) + k a^2/4$.",
        (CURVATURE - STEEPNESS) * (HERE - AT_CENTRE + DEPTH - STEEPNESS * ANGLE**2 / 4),
        [
            [ABOVE[0], RISES[0]],
            [Square((CURVATURE - STEEPNESS) * ANGLE / 2 - SLOPE)],
            [ROOM[0]],
        ],
    )


def _bounds(width: Spread) -> Proof:
    times = [prod(sympy.factorial(m.count(i)) for i in range(4)) for m in QUARTICS]
    squares = [prod(Fraction(m.count(i) or 1) ** m.count(i) for i in range(4)) for m in QUARTICS]
    most = [Fraction(min(16, int(t)), 16) for t in times]
    yield facts(
        r"On unit quaternions $(q^m)^2 \le a^a b^b \ldots/4^4$, $a, b, \ldots$ the powers in $q^m$ "
        r"(arithmetic and geometric means), and that is at most the square of $B_m = \min(16, a!\, "
        r"b! \ldots)/16$ for each of the 35.",
        [square_of / 256 <= bound**2 for square_of, bound in zip(squares, most, strict=True)],
        [True] * len(QUARTICS),
    )
    cases = _quartics()
    yield facts(
        r"So for any $v$ $\sum_m |F_m - v k_m| B_m$, twice where $q^m$ takes both signs, is at "
        r"least $\max f - \min f$, $k_m$ being the coefficients of $|q|^4$. "
        r"`certreg.verify.spread` is that, with the mean for $v$: on the 35 monomials, and on two "
        r"quartics more.",
        [width(SimpleNamespace(F=form, unit=Fraction(1, 2))) for form in cases],
        [_summed(form, most) / 2 for form in cases],
    )


def _quartics() -> list[list[int]]:
    size = range(len(QUARTICS))
    units = [[int(i == j) for j in size] for i in size]
    return [*units, [(7 * i * i + 3 * i) % 23 - 11 for i in size], SQUARE]


def _summed(form: list[int], most: list[Fraction]) -> Fraction:
    """With the mean of f on the unit sphere: 1/8 of q_i^4, 1/24 of q_i^2 q_j^2."""
    means = {1: Fraction(1, 8), 2: Fraction(1, 24), 0: Fraction(0)}
    mean = sum(c * means[k] for c, k in zip(form, SQUARE, strict=True))
    parts = zip(form, SQUARE, most, strict=True)
    return sum((abs(c - mean * k) * b * (1 if k else 2) for c, k, b in parts), Fraction(0))


def _caps(cap: CapOf) -> Proof:
    x, y = scalar("x"), scalar("y")
    yield identity(
        r"From $\cos y \le 1 - y^2/2 + y^4/24$ at $y = 2x$: $\cos^2 x = (1 + \cos 2x)/2 \le 1 - "
        r"x^2 (1 - x^2/3)$.",
        ((1 + 1 - y**2 / 2 + y**4 / 24) / 2).subs(y, 2 * x),
        1 - x**2 * (1 - x**2 / 3),
    )
    cases = [((1, 0, 0, 0), Fraction(1)), ((3, -2, 5, 7), Fraction(2, 7))]
    cases += [((0, 2**90, 1, 9), Fraction(1, 3**40))]
    yield facts(
        r"`certreg.verify.cap_of` with $x = k/(16 w)$: $(c \cdot q)^2\, 2^b \ge \ell\, |q|^2$ with "
        rf"$b = {BITS}$ and $\ell$ the least integer that is at least $(1 - x^2 (1 - x^2/3))\, "
        r"|c|^2\, 2^b$. Where it holds, $\cos^2(a/2) \ge \cos^2 x$, so that $a \le 2 x = r$.",
        [_least(cap(c, ratio)[1], c, ratio / 16) for c, ratio in cases],
        [True] * len(cases),
    )


def _least(level: int, c: Any, x: Fraction) -> bool:
    bound = (1 - x**2 + x**4 / 3) * sum(k * k for k in c) * 2**BITS
    return level - 1 < bound <= level


def _wide(c: Any, ratio: Fraction) -> Any:
    return cap_of(c, 2 * ratio)


def _narrow(springs: Any) -> Fraction:
    return spread(springs) / 2


CLAIM = Claim(
    name="spring_caps",
    title="Caps: curvature at a centre",
    statement=r"Let $f = \text{unit}\, F/|q|^4$ with a quartic $F$, $w \ge \max f - \min f$, and "
    r"let the second derivative at $R(c)$ along every $\exp(s[d])$, $|d| = 1$, exceed $k > 0$, the "
    r"slope there being $g$. Within the angle $r = k/(8w)$ of $R(c)$ it exceeds $k/2$, and $f \ge "
    r"f(R(c)) - g a + k a^2/4 \ge f(R(c)) - g^2/k$ at the angle $a$. Let $\mu, \delta \ge 0$. If "
    r"$g^2 < (k - \mu)\, \delta$ for $R(c) = R$, or $g^2 < k\, (f(R(c)) - f(R) + \delta "
    r"- \mu)$, the growth form of $f$ at $R$ holds there.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 13, 14),
    hypotheses=(LIPSCHITZ, CURVED, INSIDE, RISES, SOME, ABOVE, ROOM),
    source="[Zygmund2002], Bernstein's inequality; the rest is elementary",
    proof=proof,
    controls={
        "second derivatives without what the norm costs": Mutation(
            at=3, proof=lambda: proof(less=0)
        ),
        "a curvature by angles of quaternions": Mutation(at=13, proof=lambda: proof(ask=1)),
        "a spread of half the size": Mutation(at=6, proof=lambda: proof(width=_narrow)),
        "caps of twice the radius": Mutation(at=8, proof=lambda: proof(cap=_wide)),
    },
    not_claimed=r"That the objective is convex outside of the caps, or the caps as large as they "
    r"can be. That two caps which overlap say more than one.",
    needs=("growth_form", "quaternions", "bernstein_cones"),
    runs=("certreg.verify.local", "certreg.verify.spread", "certreg.verify.cap_of"),
    used_by=(
        "certreg.verify.SpringsConesStatement.prove",
        "certreg.certificate.cones.cones_body",
    ),
    standard=(
        "The arithmetic mean is at least the geometric one.",
        "A line $\\exp(s [d]) R$ leads from $R$ to any rotation, at $s$ the angle between them.",
    ),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
