"""Claim: almost every cloud of at least three points has exactly four equilibria."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from certreg.objective.classification import Invariants, invariants

from ..algebra import identity, positive, quoted, refuting
from ..hypotheses import MASSES as POSITIVE
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import PointCloud
from ..notation import Array, Matrix, entry, scalar, vector

Decisive = Callable[[Sequence[Sequence[Any]]], Invariants]
MASSES = tuple(entry("m", i) for i in (1, 2, 3))
POSITIVE_MASSES = POSITIVE[3]


def scaled_moment(masses: Sequence[Any], left: Sequence[Array], right: Sequence[Array]) -> Array:
    """M times the sum of m y x^T about the means: no quotient."""
    cloud = PointCloud(masses=tuple(masses), sources=tuple(right), targets=tuple(left))
    products = cloud.total([y * x.T for x, y in zip(right, left, strict=True)])
    return cloud.mass * products - cloud.total(left) * cloud.total(right).T


def balanced(first: Any, second: Any) -> tuple[Array, Array, Array]:
    """Three points with the two vectors given, times m_3, whose weighted mean is the origin."""
    m1, m2, m3 = MASSES
    a, b = Matrix(first), Matrix(second)
    return m3 * a, m3 * b, -(m1 * a + m2 * b)


def proof(decisive: Decisive = invariants, *, stretch: int = 2, extra: int = 0) -> Proof:
    """The discriminant is a polynomial of the data, and not the zero polynomial."""
    yield from _two_points(decisive)
    yield from _witness(decisive, stretch)
    yield from _without_noise(decisive)
    yield from _more_points(extra)
    yield quoted(
        r"A polynomial in $n$ real variables that is not the zero polynomial vanishes on a set of "
        r"measure zero only: in one variable it has finitely many zeros, and Fubini's theorem "
        r"passes from $n - 1$ variables to $n$. So clouds with $\operatorname{disc} = 0$ have "
        r"probability zero under every distribution with a density, and by the claims "
        r"`classification` and `half_turns` all others have one optimum and exactly three "
        r"spurious equilibria, each $180^\circ$ away.",
        theorem="Fubini's theorem",
        source="Fubini's theorem",
    )


def _two_points(decisive: Decisive) -> Proof:
    m1, m2, _ = MASSES
    x, y = [vector("x1"), vector("x2")], [vector("y1"), vector("y2")]
    C = scaled_moment([m1, m2], y, x)
    u, a = vector("u"), vector("a")
    found = decisive((u * a.T).tolist())
    yield identity(
        r"Two points are not enough: $M C = m_1 m_2 (y_1 - y_2)(x_1 - x_2)^{\mathsf T}$. Nor is "
        r"a collinear source, $\tilde x_i = s_i a$, for which $C = u a^{\mathsf T}$ with "
        r"$u = \sum_i m_i s_i \tilde y_i$. A matrix of that form has $e_2 = D = 0$, and so its "
        r"discriminant vanishes. Conversely, where the discriminant does not vanish three source "
        r"points are not collinear, $J \succ 0$, and the dynamics is defined.",
        [C, found.e2, found.det, found.discriminant],
        [m1 * m2 * (y[0] - y[1]) * (x[0] - x[1]).T, 0, 0, 0],
    )


def _witness(decisive: Decisive, stretch: int) -> Proof:
    m1, m2, m3 = MASSES
    sources = balanced([1, 0, 0], [0, 1, 0])
    targets = balanced(
        [m2 * (m2 + m3), -stretch * m1 * m2, 0], [-m1 * m2, stretch * m1 * (m1 + m3), 0]
    )
    M = m1 + m2 + m3
    unit = m1 * m2 * m3**2 * M
    C = scaled_moment(MASSES, targets, sources)
    yield identity(
        r"Three points are, whatever the positive masses. Take $x_1 = m_3 (1,0,0)$, "
        r"$x_2 = m_3 (0,1,0)$ and $x_3 = -(m_1, m_2, 0)$, whose mean is the origin, and likewise "
        r"$y_1 = m_3 (m_2(m_2 + m_3), -2 m_1 m_2, 0)$, "
        r"$y_2 = m_3 (-m_1 m_2, 2 m_1 (m_1 + m_3), 0)$, $y_3 = -m_1 m_2 m_3\,(1, 2, 0)$. Then "
        r"$M C = M u \operatorname{diag}(1, 2, 0)$ with $u = m_1 m_2 m_3^2 M > 0$: rational data "
        r"for rational masses.",
        C,
        M * unit * sympy.diag(1, stretch, 0),
    )
    t = scalar("t")
    yield identity(
        r"At $C = t \operatorname{diag}(1, 2, 0)$ the discriminant, of degree twelve in $C$, is "
        r"$144\, t^{12} \neq 0$. So for all given positive masses it is not the zero polynomial of "
        r"the coordinates of three points.",
        decisive((t * sympy.diag(1, stretch, 0)).tolist()).discriminant,
        144 * t**12,
    )


def _without_noise(decisive: Decisive) -> Proof:
    m1, m2, m3 = MASSES
    points = balanced([1, 0, 0], [0, 1, 0])
    a, b, c = m1 * (m1 + m3), m1 * m2, m2 * (m2 + m3)
    M = m1 + m2 + m3
    S = scaled_moment(MASSES, points, points)
    yield identity(
        r"Clouds without noise, $y = R x + t$, are a null set among all data and need a witness of "
        r"their own. There $C = R S_2$, and the discriminant is that of $S_2$, a polynomial in the "
        r"source's coordinates alone. At the same three source points "
        r"$S_2 = m_3 \begin{pmatrix} a & b \\ b & c \end{pmatrix}$ in the plane, with "
        r"$a = m_1(m_1 + m_3)$, $b = m_1 m_2$, $c = m_2(m_2 + m_3)$.",
        S,
        M * m3 * Matrix([[a, b, 0], [b, c, 0], [0, 0, 0]]),
    )
    p, q, r = (scalar(k) for k in "abc")
    flat = decisive([[p, q, 0], [q, r, 0], [0, 0, 0]])
    yield identity(
        r"The discriminant of that shape factors: "
        r"$(ac - b^2)^4\, (a + c)^2 \bigl((a - c)^2 + 4 b^2\bigr)$.",
        flat.discriminant,
        (p * r - q**2) ** 4 * (p + r) ** 2 * ((p - r) ** 2 + 4 * q**2),
    )
    first, second, third = POSITIVE_MASSES.parts
    yield positive(
        r"And no factor vanishes for positive masses: $a + c > 0$, $b > 0$, and $ac - b^2 = "
        r"m_1 m_2 m_3 (m_1 + m_2 + m_3)$ is a sum of products of masses. So the discriminant is "
        r"not the zero polynomial on clouds without noise either.",
        a * c - b**2,
        [[first, second, third, one] for one in POSITIVE_MASSES.parts],
    )


def _more_points(extra: int) -> Proof:
    sources = balanced(vector("x1"), vector("x2"))
    targets = balanced(vector("y1"), vector("y2"))
    three = scaled_moment(MASSES, targets, sources)
    M, rest = sum(MASSES), [entry("m", 4), entry("m", 5)]
    origin = Matrix([extra, 0, 0])
    for k in (1, 2):
        masses = [*MASSES, *rest[:k]]
        more = scaled_moment(masses, [*targets, *[origin] * k], [*sources, *[origin] * k])
        yield identity(
            rf"A cloud of {3 + k} points: put the further points, of any masses, at the common "
            r"mean of three balanced ones, in both clouds. They add zero to each of the sums "
            r"$\sum m x$, $\sum m y$ and $\sum m\, y x^{\mathsf T}$, so $C$ is that of the three "
            r"points and the witness stays one. The same words hold for every $N \geq 3$.",
            M * more,
            sum(masses) * three,
        )


@dataclass(frozen=True)
class _OneTermWrong(Invariants):
    """A discriminant with 5 e2 for 4 e2."""

    @property
    def discriminant(self) -> Any:
        """The shipped one less e2^3."""
        return super().discriminant - self.e2**3


def _one_term_wrong(C: Sequence[Sequence[Any]]) -> Invariants:
    found = invariants(C)
    return _OneTermWrong(e1=found.e1, e2=found.e2, det=found.det)


def _vanishes_too_seldom() -> Step:
    one = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    return refuting(
        r"At $C = I$, which has infinitely many equilibria, that polynomial is not zero.",
        [_one_term_wrong(one).discriminant],
        [0],
    )


CLAIM = Claim(
    name="generic",
    title="Generically exactly four equilibria",
    statement=r"Fix $N \geq 3$ and positive masses. The clouds $(x_i, y_i) \in \mathbb{R}^{6N}$ "
    r"that do not have exactly four equilibria form the zero set of one polynomial that is not "
    r"zero, so a closed set of measure zero. The same holds for clouds without noise, $y_i = R x_i "
    r"+ t$, among all sources $x \in \mathbb{R}^{3N}$. Outside of it there are one optimum and "
    r"three spurious equilibria, each exactly $180^\circ$ from every other. A witness is a cloud "
    r"with $C = t\operatorname{diag}(1, 2, 0)$, three balanced points with all others at their "
    r"mean; two points never are one.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8),
    hypotheses=(POSITIVE_MASSES,),
    setting=(
        r"$N \geq 3$. The data, or the source alone where there is no noise, have a density.",
    ),
    source="[Yang2020], the conjecture's part (i), there without proof",
    proof=proof,
    controls={
        "a witness with C = diag(1, 1, 0)": Mutation(at=3, proof=lambda: proof(stretch=1)),
        "further points that are not at the mean": Mutation(at=7, proof=lambda: proof(extra=1)),
        "a wrong term in the discriminant": Mutation(
            at=3,
            proof=lambda: proof(decisive=_one_term_wrong),
            instance=_vanishes_too_seldom,
        ),
    },
    not_claimed=r"That a cloud in floating point is generic because it was random: doubles are "
    r"finitely many, and the code decides each case. Nor that a symmetric cloud is exceptional "
    r"(claim `symmetry`).",
    needs=("classification", "half_turns", "discriminant"),
    runs=("certreg.objective.classification.invariants",),
    used_by=("certreg.objective.classification.Classification.finite",),
    not_in_coq=(
        "Genericity is not formalised: nothing in Coq speaks of measure. For each instance "
        "the pattern is decided exactly (`classification`)."
    ),
)
