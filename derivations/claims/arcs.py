"""Claim: with two pairs within their bounds the rotation is nearly a turn about one line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from certreg.verify import (
    AXIS,
    GRID,
    QUARTER,
    TURNS,
    RefusalError,
    Thinning,
    arc,
    consistent,
    crossed,
    frame,
    turned,
)

from ..algebra import Square, combination, facts, modulo, nonnegative
from ..hypotheses import CIRCLE
from ..hypothesis import Hypothesis, Point, Standing, equation, nonnegative_by, vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import Array, Matrix, rotation, scalar, square, vector

Arc = Callable[[Any, Any, Any], tuple[Any, Any, Any]]
Turns = Callable[[list[list[int]], int, int, int], list[int]]
B, C, E, F = (vector(name) for name in "bcef")
FAR, WIDE = scalar("alpha"), scalar("gamma")  # |a| = |R a|, |b|
EPSILON, REACH, SHIFT = scalar("epsilon"), scalar("rho"), scalar("kappa")
MISS, MOVE = vector("u"), vector("v")  # q - R p; what E moves
NEXT, APART = scalar("t"), scalar("d")  # a tangent, how far the next one is
LOOKS = 10**4  # more than the checker takes at four pairs
DIRECT = Matrix([1 + E.dot(F), *E.cross(F)])  # turns e to f

LENGTHS = vanishing(
    r"$\alpha = |a| = |R a|$ and $\gamma = |b|$.",
    Matrix([FAR**2 - square(C), WIDE**2 - square(B)]),
    prepare=lambda point: (
        {FAR: abs(point[C[0]]), WIDE: abs(point[B[0]])} | {C[1]: 0, C[2]: 0, B[1]: 0, B[2]: 0}
    ),
)
CLOSE = nonnegative_by(
    r"$|b - R a| \le \epsilon$.",
    EPSILON**2 - square(B - C),
    standing=Standing.CASE,
)
SIZES = nonnegative_by(
    r"$\rho = \beta_i + \beta_k$ and $\kappa$ are not negative.",
    [REACH, SHIFT],
    example={REACH: -1, SHIFT: 2},
)
NEAR = nonnegative_by(
    r"$|q - R p| \le \rho$, and $E$ moves the point by $\kappa$ at most.",
    [REACH**2 - square(MISS), SHIFT**2 - square(MOVE)],
    standing=Standing.CASE,
    example={REACH: 1, SHIFT: 1, MISS[0]: 3},
)

TANGENTS = nonnegative_by(
    r"$t \ge 0$ and $d \ge 0$: two tangents are $t$ and $t + d$.",
    [NEXT, APART],
    example={NEXT: -2, APART: 1},
)


def _unit(name: str, v: Array) -> Hypothesis:
    def put(point: Point) -> Point:
        y, z = point[v[1]], point[v[2]]
        size = 1 + y * y + z * z
        return {v[0]: (2 - size) / size, v[1]: 2 * y / size, v[2]: 2 * z / size}

    return equation(
        rf"$|{name}| = 1$.", v[0], 2, 1 - v[1] ** 2 - v[2] ** 2, prepare=put, standing=Standing.CASE
    )


UNITS = (_unit("e", E), _unit("f", F))


def proof(
    shipped: Arc = arc,
    turns: Turns = turned,
    *,
    tilt: int = 1,
    trace: int = 4,
    share: Fraction = Fraction(1),
) -> Proof:
    """The angle off the line; the turn that takes it away; what it costs; arcs; the checker's."""
    yield from _angle()
    yield from _direct(trace)
    yield from _reach(tilt)
    yield _arcs(shipped)
    yield _next_turn(share)
    yield _numbers()
    yield _wrongly_refuted(turns, tilt)
    yield _mirrored(shipped)
    yield _struck()


def _angle() -> Proof:
    lost = EPSILON**2 - (FAR - WIDE) ** 2
    yield combination(
        r"Let the pairs $i$ and $j$ be within their bounds: $|b - R a| \le \epsilon$ (claim "
        r"`pair_lengths`). Let $\delta$ be the angle of $R a$ and $b$, $b \cdot R a = "
        r"\alpha\gamma \cos\delta$, so that $4 \sin^2(\delta/2)\,\alpha\gamma = 2\alpha\gamma - "
        r"2\, b \cdot R a$. That is $|b - R a|^2 - (\alpha - \gamma)^2$,",
        2 * FAR * WIDE - 2 * B.dot(C) - square(B - C) + (FAR - WIDE) ** 2,
        [(1, LENGTHS[0]), (1, LENGTHS[1])],
    )
    yield nonnegative(
        r"and at most $\epsilon^2 - (\alpha - \gamma)^2$: $2 \sin(\delta/2) \le \sqrt{(\epsilon^2 "
        "- (|a| - |b|)^2)/(|a||b|)}$.",
        lost - square(B - C) + (FAR - WIDE) ** 2,
        [[CLOSE[0]]],
    )


def _direct(trace: int) -> Proof:
    yield modulo(
        r"Let $e = b/|b|$ and $f = R a/|a|$. The turn $E$ with the quaternion $(1 + e \cdot f, e "
        r"\times f)$ takes $e$ to $f$, here times the square of its norm. (Where $f = -e$, take "
        "any half turn about a line across $e$.)",
        rotation(DIRECT) * E,
        square(DIRECT) * F,
        UNITS,
    )
    yield modulo(
        r"It turns by $\delta$: with the vector $v$ of the quaternion, $\sin^2 = |v|^2$ over the "
        r"square of the norm is $\tfrac14\,|e - f|^2$, $\sin^2(\delta/2)$. So it moves no point "
        r"$z$ by more than $2 \sin(\delta/2)\, |z|$ (claim `truncated_box`).",
        trace * square(E.cross(F)),
        square(DIRECT) * square(E - F),
        UNITS,
    )


def _reach(tilt: int) -> Proof:
    first, second = SIZES.parts
    terms = [
        [first, second, NEAR[0]],
        [second, second, NEAR[0]],
        [first, first, NEAR[1]],
        [first, second, NEAR[1]],
    ]
    yield nonnegative(
        r"So $R = E R_\varphi$ with $R_\varphi = E^{\mathsf T} R$, which takes the direction of "
        "$a$ to that of $b$. Let pair $k$ be within its bound, too, $p = x_k - x_i$, $q = y_k - "
        r"y_i$: $|q - R p| \le \rho = \beta_i + \beta_k$. As $q - R_\varphi p = (q - R p) + (R p "
        r"- R_\varphi p)$, where $R p = E R_\varphi p$, and $E (q - R_\varphi p) = (E q - q) + (q "
        r"- R p)$, $$|q - R_\varphi p| \le \rho + \kappa, \qquad \kappa = 2 \sin(\delta/2) "
        r"\min(|p|, |q|),$$ here times $\rho\kappa$ and squared.",
        REACH * SHIFT * ((REACH + tilt * SHIFT) ** 2 - square(MISS + MOVE)),
        [*terms, *([Square(entry)] for entry in SHIFT * MISS - REACH * MOVE)] if tilt else terms,
    )


def _arcs(shipped: Arc) -> Any:
    c, s = scalar("c"), scalar("s")
    p, q, reach = vector("p"), vector("q"), scalar("h")
    left, right, level = shipped(tuple(p), tuple(q), reach)
    turned = Matrix([c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]])
    return modulo(
        r"The rotations that take the direction of $a$ to that of $b$ are those $R_\varphi$ that "
        r"turn by $\varphi$ about it. In frames whose third axes lie along $a$ and along $b$, "
        r"$h^2 - |q - R_\varphi p|^2 = A \cos\varphi + B \sin\varphi - g$, $A = 2 (p_1 q_1 + "
        r"p_2 q_2)$, $B = 2 (p_1 q_2 - p_2 q_1)$, here by `certreg.verify.arc`: the $\varphi$ that "
        "$k$ allows are an arc. A motion "
        r"that brings $i$, $j$ and $K - 2$ others within has a $\varphi$ on the arcs of all "
        r"these, which are neighbours of one another. If there is no such $\varphi$, no motion "
        "that brings $K$ pairs within brings both $i$ and $j$ within.",
        reach**2 - square(q - turned),
        left * c + right * s - level,
        [CIRCLE],
    )


def _next_turn(share: Fraction) -> Any:
    first, second = TANGENTS.parts
    return nonnegative(
        r"The checker asks of some turns alone, by angles $m$ with $\tan(m/2) = k/n$, $k = 0, "
        r"\dots, n - 1$, and one, two, three right angles more. Half the angles of the tangents "
        r"$t$ and $t + d$ differ by the arctangent of $d/(1 + t (t + d))$, at most by $d$, here "
        r"times $1 + t (t + d)$. So angles next to each other differ by at most $2/n$, and some "
        r"$m$ by at most $1/n$ from $\varphi$. To turn $p$ by that, or $q$ back, moves it by at "
        r"most $1/n$ of its length: $|q - R_m p| \le \rho + (2 \sin(\delta/2) + 1/n) \min(|p|, "
        "|q|)$.",
        share * APART * (1 + NEXT * (NEXT + APART)) - APART,
        [[second, first, first], [second, second, first]] if share == 1 else [],
    )


def _numbers() -> Any:
    """Entries k of an axis along v against 2^G v / |v|, by their squares with their signs."""
    wrong = 0
    for a in ((1, 0, 0), (0, -1, 2), (5, 7, -3), (10**9, 1, 0), (43, 29, 17)):
        across = crossed(a, AXIS)
        for axis, v in zip(frame([*a]), (across, crossed(a, across), a), strict=True):
            size = sum(k * k for k in v)
            for k, entry in zip(axis, v, strict=True):
                exact = _signed(entry) << 2 * GRID
                low, high = (_signed(k + off) * size for off in (-2, 2))
                wrong += not low < exact < high
    circle = [c * c + s * s - d * d for c, s, d in TURNS]
    tangents = [Fraction(s, c + d) * QUARTER for c, s, d in TURNS]
    return facts(
        r"In numbers: a turn of `certreg.verify.turned` has $c^2 + s^2 = d^2$ and $s/(c + d) = "
        r"k/n$. Its frames, `certreg.verify.frame`, are integers: each of nine entries is off by "
        r"less than $2$ of $2^{64}$, here of five lines. So $2^{64} p$ and $2^{64} q$ are off by "
        r"less than $6 |p|$ and $6 |q|$ in frames that are exact, and the reach is longer by that.",
        [any(circle), tangents, wrong],
        [False, [*range(QUARTER)], 0],
    )


def _signed(k: int) -> int:
    """Its square, of its sign."""
    return k * abs(k)


def _wrongly_refuted(turns: Turns, tilt: int) -> Any:
    """Of a true set: the nearest that any turn about the line brings p to q, against the reach."""
    bound, size = Fraction(3, 4), Fraction(10)
    a = (Fraction(5), Fraction(0), Fraction(0))
    turned = (Fraction(24, 5), Fraction(7, 5), Fraction(0))
    missed = sum((x - y) ** 2 for x, y in zip(a, turned, strict=True))
    nearest = 2 * size**2 - 2 * size * Fraction(48, 5)
    reach = 2 * bound + tilt * (2 * bound / 5) * size
    points = ([0] * 3, [100, 0, 0], [0, 200, 0]), ([0] * 3, [100, 0, 0], [-56, 192, 0])
    rows = [[*x, *y, 1, 15] for x, y in zip(*points, strict=True)]  # times 20
    return facts(
        r"Without $\delta$ that is wrong. Let $R$ turn by $\cos = 24/25$, $\sin = 7/25$ about "
        r"$e_3$, and $\beta = 3/4$. The pairs $0 \to 0$, $5 e_1 \to 5 e_1$ and $10 e_2 \to 10\, R "
        r"e_2$ are within under $R$: $|5 R e_1 - 5 e_1|^2 = 2 \le \epsilon^2 = 9/4$. But no turn "
        r"about $e_1$ brings $10 e_2$ nearer to its target than $\sqrt 8$, above $\rho = 3/2$; $2 "
        r"\sin(\delta/2) = 3/10$ at most, and $\rho + \kappa = 9/2$ is enough: of "
        "`certreg.verify.turned` some turns may bring the third pair within.",
        [
            missed,
            nearest,
            missed <= (2 * bound) ** 2,
            nearest <= reach**2,
            4 in turns(rows, 0, 1, 4),
        ],
        [2, 8, True, True, True],
    )


def _mirrored(shipped: Arc) -> Any:
    third = shipped((10, 0, 0), (10, 0, 0), 4)
    fourth = shipped((0, 10, 0), (0, -10, 0), 4)
    return facts(
        "Mirror images are seen. Of $0$, $10 e_3$, $10 e_1$, $10 e_2$ and the targets $0$, $10 "
        r"e_3$, $10 e_1$, $-10 e_2$ with $\beta = 1$, all lengths agree; about $e_3$, with $\rho "
        r"+ \kappa = 4$, the third pair allows $100 \cos\varphi \ge 92$ and the fourth $-100 "
        r"\cos\varphi \ge 92$, here twice: not both.",
        [*third, *fourth],
        [200, 0, 184, -200, 0, 184],
    )


def _struck() -> Any:
    return facts(
        "So for $K = 4$ `certreg.verify.Thinning.after` strikes the first two pairs together, "
        r"after which each has two neighbours, too few. It refuses for $K = 3$, with $\beta = 4$, "
        "and of motions that do not keep lengths.",
        [_left(1, 4), _left(1, 3), _left(4, 4), _left(1, 4, rigid=False)],
        [0, None, None, None],
    )


def _left(bound: int, K: int, *, rigid: bool = True) -> int | None:
    """What the checker leaves of the mirror images; None if it refuses the step."""
    points = [(0, 0, 0), (0, 0, 10), (10, 0, 0)]
    rows = [[*p, *p, 1, bound] for p in points] + [[0, 10, 0, 0, -10, 0, 1, bound]]
    try:
        return Thinning(rows, consistent(rows), 15, K, [LOOKS], rigid=rigid).after([[[0, 1]]])
    except RefusalError:
        return None


def _wide(p: Sequence[Any], q: Sequence[Any], reach: Any) -> tuple[Any, Any, Any]:
    """An arc of which the third coordinates are left out."""
    left, right, level = arc(p, q, reach)
    return left, right, level + 2 * p[2] * q[2]


def _sharp(rows: list[list[int]], e: int, f: int, others: int) -> list[int]:
    """With all of both bounds in that of each other pair, so that no delta is left."""
    reach = rows[e][7]
    return turned(
        [[*row[:7], 0 if k in (e, f) else row[7] + reach] for k, row in enumerate(rows)],
        e,
        f,
        others,
    )


CLAIM = Claim(
    name="arcs",
    title="Two pairs leave little more than a turn about one line",
    statement="Let a rigid motion with the rotation $R$ bring the pairs $i$, $j$, $k$ within "
    "their bounds, $a = x_j - x_i$ and $b = y_j - y_i$ not $0$, $p = x_k - x_i$, $q = y_k - "
    r"y_i$, $\epsilon = \beta_i + \beta_j$. Then $R = E R_\varphi$, where $R_\varphi$ takes the "
    r"direction of $a$ to that of $b$ and $E$ turns by at most $\delta$, $$2 \sin(\delta/2) = "
    r"\sqrt{\frac{\epsilon^2 - (|a| - |b|)^2}{|a||b|}}, \qquad |q - R_\varphi p| \le \beta_i + "
    r"\beta_k + 2 \sin(\delta/2) \min(|p|, |q|).$$ So $k$ allows an arc of $\varphi$. If no "
    r"$\varphi$ is on the arcs of $K - 2$ pairs that are neighbours of one another, no motion "
    "that brings $K$ pairs within brings both $i$ and $j$ within. It is enough to ask of angles "
    r"that are at most $2/n$ apart, with $1/n$ added to $2 \sin(\delta/2)$.",
    concludes=tuple(range(1, 12)),
    hypotheses=(LENGTHS, CLOSE, *UNITS, SIZES, NEAR, CIRCLE, TANGENTS),
    setting=(r"$k$ is a neighbour of $i$ and of $j$.",),
    source="elementary",
    proof=proof,
    controls={
        "delta = 0": Mutation(
            at=5,
            proof=lambda: proof(tilt=0),
            point={REACH: 1, SHIFT: 1, MISS[0]: 1, MOVE[0]: 1},
        ),
        "twice the angle": Mutation(at=4, proof=lambda: proof(trace=1)),
        "an arc without the part along the line": Mutation(at=6, proof=lambda: proof(_wide)),
        "turns half as far apart": Mutation(
            at=7, proof=lambda: proof(share=Fraction(1, 2)), point={APART: 1}
        ),
        "turns without delta": Mutation(at=9, proof=lambda: proof(turns=_sharp)),
    },
    not_claimed="That pairs on whose arcs one angle lies are within their bounds under one "
    "motion. Nor anything where $a$ or $b$ is $0$.",
    needs=("pair_lengths", "few_neighbours", "few_colours", "truncated_box"),
    runs=(
        "certreg.verify.arc",
        "certreg.verify.frame",
        "certreg.verify.turned",
        "certreg.verify.Thinning.after",
    ),
    used_by=(
        "certreg.certificate.edge_elimination.turned",
        "certreg.certificate.edge_elimination.Parting",
    ),
    standard=("The triangle inequality.",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
