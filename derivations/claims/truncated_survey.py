"""Claim: boxes of quaternions prove labels and cost of the truncated optimum, as the code does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations, product
from typing import Any

from certreg.geometry.so3 import dot, squared_norm
from certreg.verify import (
    CHORD,
    UNITS,
    RefusalError,
    TruncatedRotationStatement,
    form_at,
    form_of,
)
from certreg.verify import (
    positive as proved_positive,
)

from ..algebra import Square, facts, nonnegative, positive
from ..hypotheses import definite
from ..hypothesis import Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, entry, quaternion, scalar, square, symmetric
from ..rationals import apply, rotation_of, subtract

FormOf = Callable[[Sequence[int]], tuple[list[int], int]]
Decides = Callable[..., bool]
Q, P, A, C = quaternion(), quaternion("p"), symmetric("A", 4), symmetric("L", 4)
STEP = Matrix([0, *(entry("d", k) for k in "xyz")])
HALF, CURVED, MU, DELTA = (scalar(name) for name in ("h", "kappa", "mu", "delta"))
STEEP = [entry("s", k) for k in "xyz"]
SIZES = [entry("a", k) for k in "wxyz"]
NEAR, BEST, ROUNDED = scalar("c"), scalar("c'"), scalar("e")  # at u, at an optimum; 6 n
NORM, OTHER, ALONG = square(Q), square(P), dot(tuple(Q), tuple(P))
SLOPES = 2 * A * Q

BOX = nonnegative_by(
    r"$|d_j| \le h$: $p = q + d$ is in the box.",
    [HALF**2 - d**2 for d in STEP[1:]],
    example={STEP[1]: 1, Q[0]: 1, A[0, 0]: 1},
)
RISES = nonnegative_by(r"$\kappa \ge 0$.", CURVED, example={CURVED: -1, HALF: 1})
BENDS = nonnegative_by(
    r"$d^{\mathsf T} A\, d \ge -\kappa |d|^2$.",
    (STEP.T * A * STEP)[0] + CURVED * square(STEP),
    standing=Standing.CASE,
    example={A[1, 1]: -1, STEP[1]: 1, HALF: 1},
)
TILTS = nonnegative_by(
    r"$s_j$ is the size of the slope $g_j$, $g = 2 A q$.",
    [HALF * s + g * d for s, g, d in zip(STEEP, SLOPES[1:], STEP[1:], strict=True)],
    standing=Standing.CASE,
    example={A[0, 1]: -1, Q[0]: 1, STEP[1]: 1, HALF: 1},
)
BOUND = positive_by(
    r"$L + \mu u u^{\mathsf T} - b I \succ 0$ for $b = L(u) + e + \mu - \delta$, $u = q/|q|$.",
    (P.T * (NORM * C + MU * Q * Q.T) * P)[0]
    - ((Q.T * C * Q)[0] + (ROUNDED + MU - DELTA) * NORM) * OTHER,
    further=lambda point: definite(
        NORM * C
        + MU * Q * Q.T
        - ((Q.T * C * Q)[0] + (ROUNDED + MU - DELTA) * NORM) * Matrix.eye(4),
        point,
    ),
    standing=Standing.CASE,
)
FAR = {Q[0]: 1, P[1]: 1, DELTA: 1, MU: 1} | dict.fromkeys((C[k, k] for k in (1, 2, 3)), 1)
BELOW = nonnegative_by(
    r"$L(p) \le c(p)$ and $c(u) \le L(u) + e$, the forms being rounded down.",
    [BEST * OTHER - (P.T * C * P)[0], (Q.T * C * Q)[0] + (ROUNDED - NEAR) * NORM],
    standing=Standing.CASE,
    example=FAR,
)
OPTIMUM = nonnegative_by(
    r"$c(p) \le c(u)$: $R(p)$ is an optimum.",
    NEAR - BEST,
    standing=Standing.CASE,
    example=FAR | {BEST: 1},
)
ROWS = [1, -2, 3, 0, 4, 1, 2], [5, 0, -1, -1, 2, 2, 3], [0, 0, 2, 1, 0, -7, 5]
TURNS = (1, 0, 0, 0), (1, 2, 3, 4), (0, 5, -1, 2), (-3, 1, 1, 7)
AXES = [[8 * (i == j) for j in range(3)] for i in range(3)]


def proof(
    form: FormOf = form_of,
    decides: Decides = proved_positive,
    *,
    reach: int = 3,
    low: Fraction = Fraction(5, 2),
    rounded: int = 1,
) -> Proof:
    """How far points move in a box; rounding; forms in a box; the angle; the whole checker."""
    yield _moved(reach)
    yield from _rounding(form, low)
    yield _rise()
    yield _decided(decides)
    yield _angle(rounded)
    yield _checked()


def _moved(reach: int) -> Any:
    q = P - STEP
    across = square(q) * OTHER - (q.T * P)[0] ** 2
    return nonnegative(
        "Every rotation has a quaternion $p$ one entry of which is a given number, and the "
        "others are not larger: four cubes, cut into boxes. In a box about $q$ the lines of $p = "
        r"q + d$ and $q$ have an angle with $\sin^2 = 1 - (q \cdot p)^2/(|q|^2|p|^2) \le "
        r"|d|^2/|q|^2 \le 3 h^2/|q|^2$. It is half that of the rotations: $|q|$ times a residual "
        r"changes by at most $2 \sqrt 3\, h \min(|x|, |y|)$ (claim `truncated_box`; $|y - R x| = "
        r"|x - R^{\mathsf T} y|$).",
        reach * HALF**2 * OTHER - across,
        [
            [Square((STEP.T * P)[0])],
            *([BOX[k], Square(entry)] for k in range(3) for entry in P),
        ],
    )


def _rounding(form: FormOf, low: Fraction) -> Proof:
    pairs = list(combinations(SIZES, 2))
    yield nonnegative(
        "A form has ten coefficients, which are rounded down, by less than $1$ each: with $a_i = "
        r"|q_i|$, $\sum_{i \le j} a_i a_j \le \tfrac52 |q|^2$.",
        low * square(SIZES) - square(SIZES) - sum(a * b for a, b in pairs),
        [[Fraction(1, 2), Square(a - b)] for a, b in pairs],
    )
    wrong = 0
    for row, q in product(ROWS, TURNS):
        off = subtract(tuple(row[3:6]), apply(rotation_of(q), tuple(row[:3])))
        exact = squared_norm(q) * squared_norm(off) / Fraction(row[6] ** 2) * 2**UNITS
        wrong += not 0 <= exact - form_at(form(row)[0], q) <= 6 * squared_norm(q)
    reaches = [(form(row)[1] - 1) ** 2 <= square_of_reach(row) < form(row)[1] ** 2 for row in ROWS]
    yield facts(
        r"So with $3$ less on the diagonal `certreg.verify.form_of` is $|q|^2 r^2/\beta^2$, and "
        "less by at most $6 |q|^2$ units. Of three pairs at four rotations it is, compared in "
        r"fractions; and its reach is $2 \sqrt 3 \min(|x|, |y|)/\beta$, rounded up.",
        [wrong, *reaches],
        [0, True, True, True],
    )


def square_of_reach(row: Sequence[int]) -> Fraction:
    """12 min(|x|^2, |y|^2) / b^2, in units."""
    least = min(squared_norm(row[:3]), squared_norm(row[3:6]))
    return Fraction(12 * least, row[6] ** 2) * 2**UNITS


def _rise() -> Any:
    moved = Q + STEP
    return nonnegative(
        r"A form in a box: $p^{\mathsf T} A\, p = q^{\mathsf T} A\, q + g \cdot d + d^{\mathsf T} "
        r"A\, d$ is at least $q^{\mathsf T} A\, q - h \sum_j s_j - 3 h^2 \kappa$.",
        (moved.T * A * moved)[0] - (Q.T * A * Q)[0] + HALF * sum(STEEP) + 3 * CURVED * HALF**2,
        [[BENDS[0]], *([part] for part in TILTS.parts), *([RISES[0], part] for part in BOX.parts)],
    )


def _decided(decides: Decides) -> Any:
    """Of forms diag(a, b, b, 0) + c (q_w q_x): whether what is proved positive is so."""
    wrong = proved = 0
    for a, b, c, h in product((-1, 2, 9), (-3, 0, 1), (-4, 0, 3), (1, 2)):
        form = [entry << CHORD for entry in (a, c, 0, 0, b, 0, 0, b, 0, 0)]
        if decides(form, [4, 1, 0, 0], 0, h, 0, 3):
            proved += 1
            wrong += any(
                form_at(form, (4, 1 + x, y, z)) <= 0 for x, y, z in product((-h, 0, h), repeat=3)
            )
    return facts(
        "`certreg.verify.positive` asks for this, or for a positive definite form. Of $54$ forms "
        "in boxes it proves $24$ positive; at the corners and in the middle none of these is not.",
        [wrong, proved],
        [0, 24],
    )


def _angle(rounded: int) -> Any:
    return positive(
        r"The angle. Let no label be open, and $c(p)$ be the sum of $r^2/\beta^2$ over the "
        "inliers. The cost is $c$ plus the number of outliers at an optimum, and no more "
        r"anywhere: so $c(p) \le c(u)$ at an optimum $R(p)$, and it minimises $c$. Then "
        r"$|q|^2|p|^2\,(\delta - \mu \sin^2(\theta/2))$ is positive: $\sin^2(\theta/2) < "
        r"\delta/\mu$. If $\delta \le \mu$ nothing across $q$ minimises $c$, which a plane of "
        "minima would hold: the optimum is unique.",
        DELTA * NORM * OTHER - MU * (NORM * OTHER - ALONG**2),
        [
            [BOUND[0]],
            *([BELOW[0], Square(e)] for e in Q),
            *([rounded, BELOW[1], Square(e)] for e in P),
            *([OPTIMUM[0], Square(a * b)] for a in Q for b in P),
        ],
    )


def accepted(labels: str, gap: Fraction) -> bool:
    """Whether the checker accepts the labels of four pairs, at the identity."""
    statement = TruncatedRotationStatement(
        n=4,
        data=None,
        digest="",
        pose=(1, 0, 0, 0),
        gap=gap,
        labels=labels,
        mu=Fraction(0),
        sin2_half_angle=None,
        unique=False,
    )
    rows = [*([*axis, *axis, 4] for axis in AXES), [0, 0, 8, 8, 0, 0, 4]]
    try:
        return statement.prove(rows, 0, equal=False).verified
    except RefusalError:
        return False


def _checked() -> Any:
    gap = Fraction(1, 4)
    return facts(
        "`certreg.verify.TruncatedRotationStatement.prove` sums the costs in a box: $1$ of a "
        "pair that is out, the form of one that is in, of an open one its chord (claim "
        "`chord_bound`). A box is done where the cost is above that of $R$: there is no optimum. "
        "Or where no label is wrong, those of open pairs are not claimed, and the cost is above "
        "that of $R$ less the gap. So every rotation that costs no more than $R$ has the labels. "
        r"Of $8 e_j \to 8 e_j$ and $8 e_3 \to 8 e_1$ with $\beta = 4$ it proves the three and the "
        "one, and refuses any other label.",
        [accepted(labels, gap) for labels in ("1110", "11?0", "1111", "0110", "1011")],
        [True, True, False, False, False],
    )


def _rounded_up(row: Sequence[int]) -> tuple[list[int], int]:
    """A form with 1 more on its diagonal."""
    form, reach = form_of(row)
    return [k + 4 * (at in {0, 4, 7, 9}) for at, k in enumerate(form)], reach


def _flat(form: list[int], q: list[int], f: int, h: int, spare: int, slack: int) -> bool:
    """Without what a form may bend."""
    return proved_positive(form, q, f, h, spare, 0 * slack)


CLAIM = Claim(
    name="truncated_survey",
    title="Boxes of quaternions and truncated squares",
    statement=r"Let a rotation cost $\sum \min(|y_i - R x_i|^2/\beta_i^2, 1)$. What "
    "`certreg.verify.TruncatedRotationStatement` accepts is true: every rotation that costs no "
    "more than the certified one brings within their bounds the pairs labelled 1 and none of "
    "those labelled 0, and none costs less by the gap or more. If no label is open and the form "
    r"of the angle is positive definite, every optimum is within $\sin^2(\theta/2) < \delta/\mu$, "
    r"and it is unique if $\delta \le \mu$.",
    concludes=tuple(range(1, 8)),
    hypotheses=(BOX, RISES, BENDS, TILTS, BOUND, BELOW, OPTIMUM),
    setting=(
        "One entry of $d$ is $0$, here the first.",
        "$L$ is the sum of the rounded forms of the inliers; $e = 6 n$.",
    ),
    source="elementary; branch and bound",
    proof=proof,
    witness={DELTA: 1, Q[0]: 1, P[0]: 1},
    controls={
        "a box of a smaller diagonal": Mutation(
            at=1,
            proof=lambda: proof(reach=2),
            point={P[0]: 1, HALF: 1} | dict.fromkeys(STEP[1:], 1),
        ),
        "products that sum to twice the square": Mutation(
            at=2,
            proof=lambda: proof(low=Fraction(2)),
            point=dict.fromkeys(SIZES, 1),
        ),
        "a form that is rounded up": Mutation(at=3, proof=lambda: proof(_rounded_up)),
        "a form that does not bend": Mutation(at=5, proof=lambda: proof(decides=_flat)),
    },
    not_claimed="That the boxes come to an end: the checker refuses when there are too many.",
    needs=("davenport", "chord_bound", "truncated_box", "optimality_certificate"),
    runs=(
        "certreg.verify.form_of",
        "certreg.verify.form_at",
        "certreg.verify.positive",
        "certreg.verify.survey",
        "certreg.verify.TruncatedRotationStatement.prove",
    ),
    used_by=("certreg.relaxation.rotation_boxes",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
