"""Claim: with two pairs within their bounds the rotation is nearly a turn about one line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from ..algebra import Square, combination, facts, modulo, nonnegative
from ..hypotheses import CIRCLE
from ..hypothesis import Hypothesis, Point, Standing, equation, nonnegative_by, vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import Array, Matrix, rotation, scalar, square, vector

Arc = Callable[[Any, Any, Any], tuple[Any, Any, Any]]
B, C, E, F = (vector(name) for name in "bcef")
FAR, WIDE = scalar("alpha"), scalar("gamma")  # |a| = |R a|, |b|
EPSILON, REACH, SHIFT = scalar("epsilon"), scalar("rho"), scalar("kappa")
MISS, MOVE = vector("u"), vector("v")  # q - R p; what E moves
DIRECT = Matrix([1 + E.dot(F), *E.cross(F)])  # turns e to f

LENGTHS = vanishing(
    r"$\alpha = |a| = |R a|$ and $\gamma = |b|$.",
    Matrix([FAR**2 - square(C), WIDE**2 - square(B)]),
    standing=Standing.NOTATION,
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
    standing=Standing.NOTATION,
    example={REACH: -1, SHIFT: 2},
)
NEAR = nonnegative_by(
    r"$|q - R p| \le \rho$, and $E$ moves the point by $\kappa$ at most.",
    [REACH**2 - square(MISS), SHIFT**2 - square(MOVE)],
    standing=Standing.CASE,
    example={REACH: 1, SHIFT: 1, MISS[0]: 3},
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


def arc(p: Sequence[Any], q: Sequence[Any], reach: Any) -> tuple[Any, Any, Any]:
    """A, B, g: |R_phi p - q| is at most the reach where A cos phi + B sin phi >= g.

    In frames whose third axes lie along a and along b.
    """
    g = (square(p) + square(q) - reach**2) / 2 - p[2] * q[2]
    return p[0] * q[0] + p[1] * q[1], p[0] * q[1] - p[1] * q[0], g


def proof(shipped: Arc = arc, *, tilt: int = 1, trace: int = 4) -> Proof:
    """The angle off the line; the turn that takes it away; what it costs; arcs; instances."""
    yield from _angle()
    yield from _direct(trace)
    yield from _reach(tilt)
    yield _arcs(shipped)
    yield _wrongly_refuted(tilt)
    yield _mirrored(shipped)


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
        r"$h^2 - |q - R_\varphi p|^2 = 2\,(A \cos\varphi + B \sin\varphi - g)$, $A = p_1 q_1 + "
        r"p_2 q_2$, $B = p_1 q_2 - p_2 q_1$: the $\varphi$ that $k$ allows are an arc. A motion "
        r"that brings $i$, $j$ and $K - 2$ others within has a $\varphi$ on the arcs of all "
        r"these, which are neighbours of one another. If there is no such $\varphi$, no motion "
        "that brings $K$ pairs within brings both $i$ and $j$ within.",
        reach**2 - square(q - turned),
        2 * (left * c + right * s - level),
        [CIRCLE],
    )


def _wrongly_refuted(tilt: int) -> Any:
    """Of a true set: the nearest that any turn about the line brings p to q, against the reach."""
    bound, size = Fraction(3, 4), Fraction(10)
    a = (Fraction(5), Fraction(0), Fraction(0))
    turned = (Fraction(24, 5), Fraction(7, 5), Fraction(0))
    missed = sum((x - y) ** 2 for x, y in zip(a, turned, strict=True))
    nearest = 2 * size**2 - 2 * size * Fraction(48, 5)
    reach = 2 * bound + tilt * (2 * bound / 5) * size
    return facts(
        r"Without $\delta$ that is wrong. Let $R$ turn by $\cos = 24/25$, $\sin = 7/25$ about "
        r"$e_3$, and $\beta = 3/4$. The pairs $0 \to 0$, $5 e_1 \to 5 e_1$ and $10 e_2 \to 10\, R "
        r"e_2$ are within under $R$: $|5 R e_1 - 5 e_1|^2 = 2 \le \epsilon^2 = 9/4$. But no turn "
        r"about $e_1$ brings $10 e_2$ nearer to its target than $\sqrt 8$, above $\rho = 3/2$; $2 "
        r"\sin(\delta/2) = 3/10$ at most, and $\rho + \kappa = 9/2$ is enough.",
        [missed, nearest, missed <= (2 * bound) ** 2, nearest <= reach**2],
        [2, 8, True, True],
    )


def _mirrored(shipped: Arc) -> Any:
    third = shipped((10, 0, 0), (10, 0, 0), 4)
    fourth = shipped((0, 10, 0), (0, -10, 0), 4)
    return facts(
        "Mirror images are seen. Of $0$, $10 e_3$, $10 e_1$, $10 e_2$ and the targets $0$, $10 "
        r"e_3$, $10 e_1$, $-10 e_2$ with $\beta = 1$, all lengths agree; about $e_3$, with $\rho "
        r"+ \kappa = 4$, the third pair allows $100 \cos\varphi \ge 92$ and the fourth $-100 "
        r"\cos\varphi \ge 92$: not both.",
        [*third, *fourth],
        [100, 0, 92, -100, 0, 92],
    )


def _wide(p: Sequence[Any], q: Sequence[Any], reach: Any) -> tuple[Any, Any, Any]:
    """An arc of which the third coordinates are left out."""
    return *arc(p, q, reach)[:2], (square(p) + square(q) - reach**2) / 2


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
    "that brings $K$ pairs within brings both $i$ and $j$ within.",
    concludes=tuple(range(1, 9)),
    hypotheses=(LENGTHS, CLOSE, *UNITS, SIZES, NEAR, CIRCLE),
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
    },
    not_claimed="That pairs on whose arcs one angle lies are within their bounds under one "
    "motion. Nor anything where $a$ or $b$ is $0$.",
    needs=("pair_lengths", "few_neighbours", "truncated_box"),
    standard=("The triangle inequality.",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
