"""Claim: a quartic has at most forty critical lines where two ranks are full, modulo any number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import combinations, combinations_with_replacement
from typing import Any

import sympy
from sympy.polys.domains import ZZ
from sympy.polys.rings import ring

from certreg.objective.quartics import MONOMIALS, gradient, quartic_of_form, value
from certreg.verify import QUARTICS, are_forty, in_chart, minors_of

from ..algebra import combination, facts, identity, quoted
from ..hypothesis import vanishing
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, entry, left_product, quaternion, scalar, square
from ..rationals import rank_modulo

Gradient = Callable[..., Any]
Quartic = tuple[int, ...]
Q, A = quaternion(), quaternion("a")
SYMBOLS = [entry("F", k) for k in range(len(MONOMIALS))]
LEVEL = scalar("lambda")
PLANE, LINES, COLUMNS = 45, 40, 120  # monomials of degree 8 in three variables; of degree 7 in four
TURN = (1, 2, 3, 5)
PRIME, COMPOSITE = 2**31 - 1, 10007 * 10009


def pure(*coefficients: int) -> Quartic:
    """The 35 coefficients of sum a_i q_i^4."""
    return tuple(coefficients[m[0]] if len(set(m)) == 1 else 0 for m in MONOMIALS)


def isotropic() -> Quartic:
    """|q|^2 times a quadratic form: one weight for each pair, C = diag(1, 2, 4)."""
    form = [[0] * 10 for _ in range(10)]
    for place, weight in ((1, 1), (5, 2), (9, 4)):
        form[0][place] = form[place][0] = weight
    return quartic_of_form(form)


CRITICAL = vanishing(
    r"$q$ lies on a critical line: $\nabla F(q) = \lambda q$.",
    Matrix(gradient(SYMBOLS, tuple(Q))) - LEVEL * Q,
    solves=(*SYMBOLS, LEVEL),
    example={Q[0]: 1, SYMBOLS[0]: 1},
)


def proof(shipped: Gradient = gradient, *, bound: int = LINES, turn: Any = left_product) -> Proof:
    """Minors, chart, turned charts; what the two ranks prove; that there are such quartics."""
    yield from _equations(shipped)
    yield _turned(turn)
    yield from _ranks(bound)
    yield quoted(
        r"There are 40 where they are finitely many, with multiplicities: $F_i(q) = s^2 q_i$, $i = "
        r"0 \ldots 3$, are four equations of degree 3 in $(q, s)$, with $3^4 = 81$ common zeros in "
        r"projective space, if finitely many. One is $q = 0$, which is simple. The others come in "
        r"pairs $(q, \pm s)$, a pair for each critical line, $\lambda = s^2$. $(81 - 1)/2 = 40$.",
        theorem="Bézout's theorem",
        source="Bézout's theorem [Fulton1984]",
    )


def _equations(shipped: Gradient) -> Proof:
    dF = Matrix(shipped(SYMBOLS, tuple(Q)))
    yield combination(
        r"By Euler's identity $q \cdot \nabla F = 4 F$. So on a critical line $\lambda\, q \cdot q "
        r"= 4 F(q)$, at $|q| = 1$ four times the energy.",
        LEVEL * square(Q) - 4 * value(SYMBOLS, tuple(Q)),
        [(-q, part) for q, part in zip(Q, CRITICAL.parts, strict=True)],
    )
    yield combination(
        r"The six minors $q_i F_j - q_j F_i$ of $[\,q \mid \nabla F\,]$, forms of degree 4, vanish "
        r"there; conversely, where they vanish, $\nabla F$ is along $q \ne 0$. With any "
        r"coefficients $c$: a combination of the entries of $\nabla F - \lambda q$.",
        sum(c * minor for c, minor in zip(_six(), _minors(Q, dF), strict=True)),
        [(_cofactor(k), part) for k, part in enumerate(CRITICAL.parts)],
    )
    symbolic: Any = dict(zip(QUARTICS, SYMBOLS, strict=True))
    forms = [
        sum(c * sympy.prod([Q[k] for k in m]) for m, c in minor.items())
        for minor in minors_of(symbolic)
    ]
    yield identity(
        r"`certreg.verify.minors_of`, run on the symbols of $F$, has the same six.",
        forms,
        _minors(Q, dF),
    )
    p = Matrix([1, *Q[1:]])
    at = Matrix(shipped(SYMBOLS, tuple(p)))
    three = [at[i] - at[0] * p[i] for i in (1, 2, 3)]
    yield identity(
        r"In the chart $p = (1, x, y, z)$ three of them suffice, $G_i = F_i(p) - F_0(p)\, p_i$: "
        r"the others are $p_i G_j - p_j G_i$.",
        _minors(p, at),
        [
            *three,
            *(p[i] * three[j - 1] - p[j] * three[i - 1] for i, j in combinations((1, 2, 3), 2)),
        ],
    )


def _six() -> list[Any]:
    return [entry("c", i, j) for i, j in combinations(range(4), 2)]


def _cofactor(k: int) -> Any:
    """What F_k - lambda q_k is multiplied by in the sum of c_ij (q_i F_j - q_j F_i)."""
    found = sympy.Integer(0)
    for c, (i, j) in zip(_six(), combinations(range(4), 2), strict=True):
        found += c * (Q[i] if k == j else 0) - c * (Q[j] if k == i else 0)
    return found


def _minors(q: Any, dF: Any) -> list[Any]:
    return [q[i] * dF[j] - q[j] * dF[i] for i, j in combinations(range(4), 2)]


def _turned(turn: Any) -> Any:
    L = turn(A)
    return identity(
        r"Another chart is a turned quartic. The product $q = a p$ with an integer quaternion is "
        r"$q = L p$ with $L^{\mathsf T} L = |a|^2 I$. So $p \mapsto F(a p)$ has the gradient "
        r"$L^{\mathsf T} \nabla F(q)$, which is along $p = L^{\mathsf T} q/|a|^2$ exactly if "
        r"$\nabla F(q)$ is along $q$: the same critical lines, turned, in integers.",
        L.T * L,
        square(A) * sympy.eye(4),
    )


def _ranks(bound: int) -> Proof:
    shown: dict[str, tuple[Quartic, tuple[int, ...]]] = {
        "good": (pure(1, 2, 3, 5), TURN),
        "unturned": (pure(1, 2, 3, 5), (1, 0, 0, 0)),
        "isotropic": (isotropic(), TURN),
    }
    yield facts(
        r"Let $I$ be the ideal of the minors, $\ell = p_0$. **First rank.** On $p_0 = 0$ the six "
        r"minors times the 15 monomials of degree 4 are 90 forms of degree 8 in three variables, "
        r"which have 45 monomials. If their rank is 45, $I + (\ell)$ holds all forms of degree 8, "
        r"so of every degree from there on; the minors have no common zero with $p_0 = 0$, and for "
        r"$d \ge 7$ multiplication by $\ell$ maps the forms of degree $d$ modulo $I$ onto those of "
        r"degree $d + 1$: their dimensions $H(d)$ do not grow. **Second rank.** The minors times "
        r"the 20 cubics are 120 forms of degree 7 among 120 monomials. If their rank is at least "
        r"80, $H(7) \le 40$, so $H(d) \le 40$ for all $d \ge 7$. Through all but one of $k$ lines "
        r"goes a product of $k - 1$ linear forms that does not vanish on the last; so for $d \ge "
        r"k - 1$ the values on the $k$ lines are independent, and $k \le H(d) \le 40$. An example: "
        r"$\sum a_i q_i^4$, $a = (1, 2, 3, 5)$, in the chart of $(1, 2, 3, 5)$.",
        [*ranks(*shown["good"], PRIME), COLUMNS - ranks(*shown["good"], PRIME)[1]],
        [PLANE, 80, bound],
    )
    yield facts(
        r"The ranks may be taken modulo any number, with pivots that have an inverse: then a minor "
        r"of the matrix of integers is not zero modulo it, and is not zero. So a rank found is at "
        r"most the rank over $\mathbb Q$, the safe side for both. `certreg.verify.are_forty` says "
        r"yes to the example, modulo a prime and a composite number, and no in the chart of $1$, "
        r"where critical lines lie in $p_0 = 0$, and to one weight for each pair, which has "
        r"infinitely many complex critical lines. Here the first rank is below 45.",
        [
            *(_granted(*shown["good"], modulus) for modulus in (PRIME, COMPOSITE)),
            *(_granted(*shown[name], PRIME) for name in ("unturned", "isotropic")),
            *(ranks(*shown[name], PRIME)[0] < PLANE for name in ("unturned", "isotropic")),
        ],
        [True, True, False, False, True, True],
    )


def _granted(quartic: Quartic, turn: tuple[int, ...], modulus: int) -> bool:
    return are_forty(minors_of(in_chart(quartic, _left(turn))), modulus)


def _left(turn: tuple[int, ...]) -> list[list[int]]:
    w, x, y, z = turn
    return [[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]


@cache
def ranks(quartic: Quartic, turn: tuple[int, ...], modulus: int) -> tuple[int, int]:
    """Both ranks modulo a number, of F(a p)."""
    made: Any = ring("p_0,p_1,p_2,p_3", ZZ)
    variables, left = made[1:], _left(turn)
    q = [sum(e * p for e, p in zip(row, variables, strict=True)) for row in left]
    dF = gradient(quartic, q)
    along = [sum(left[k][i] * dF[k] for k in range(4)) for i in range(4)]
    minors = _minors(variables, along)
    flat = [{m[1:]: int(c) for m, c in minor.terms() if not m[0]} for minor in minors]
    whole = [{m: int(c) for m, c in minor.terms()} for minor in minors]
    return (
        rank_modulo(_multiples(flat, 3, 4), modulus),
        rank_modulo(_multiples(whole, 4, 3), modulus),
    )


def _multiples(forms: Sequence[dict[Any, int]], variables: int, degree: int) -> list[list[int]]:
    """Forms of degree four times all monomials of a degree, by their coefficients."""
    places = {m: k for k, m in enumerate(_powers(variables, degree + 4))}
    rows: list[list[int]] = []
    for form in forms:
        for factor in _powers(variables, degree):
            row = [0] * len(places)
            for m, c in form.items():
                row[places[tuple(a + b for a, b in zip(m, factor, strict=True))]] = c
            rows.append(row)
    return rows


def _powers(variables: int, degree: int) -> list[tuple[int, ...]]:
    chosen = combinations_with_replacement(range(variables), degree)
    return [tuple(c.count(k) for k in range(variables)) for c in chosen]


def _general(a: Any) -> Any:
    """No multiple of an orthogonal matrix."""
    return left_product(a) + Matrix(4, 4, lambda i, j: int(i == j == 0))


def _one_term_lost(quartic: Sequence[Any], q: Sequence[Any]) -> Any:
    first, *others = gradient(quartic, q)
    return (first - quartic[0] * q[0] ** 3, *others)


CLAIM = Claim(
    name="forty_lines",
    title="At most forty critical lines, by two ranks",
    statement=r"Let $F$ be a form of degree four in $q \in \mathbb C^4$ and a critical line be a "
    r"$q \ne 0$, up to factors, with $\nabla F(q) = \lambda q$. If the six minors of $[\,q \mid "
    r"\nabla F\,]$, times all monomials of degree 4, have rank 45 on $q_0 = 0$, and times all "
    r"cubics rank at least 80, then $F$ has at most 40 critical lines, complex ones counted, and "
    r"none has $q_0 = 0$. Ranks modulo any number prove it. So for almost every $F$.",
    concludes=(1, 2, 3, 4, 5, 6, 7),
    hypotheses=(CRITICAL,),
    setting=(r"$F_i$ are the derivatives of $F$; its 35 coefficients are any numbers.",),
    source="ours; the number of lines is that of the eigenvectors of a symmetric tensor of order "
    "four, [CartwrightSturmfels2013]",
    proof=proof,
    controls={
        "at most 39": Mutation(at=6, proof=lambda: proof(bound=39)),
        "a gradient that lacks a term": Mutation(at=2, proof=lambda: proof(_one_term_lost)),
        "a chart that is no rotation": Mutation(at=5, proof=lambda: proof(turn=_general)),
    },
    not_claimed="That 40 lines are real, or how many: claims `forty_real`, `real_lines`. That the "
    "ranks are full wherever there are finitely many: another chart may be needed, and where they "
    "are not full nothing is said.",
    needs=("quaternions", "quartic_relaxation"),
    standard=("A polynomial that is not the zero polynomial vanishes on a set of measure zero.",),
    runs=(
        "certreg.objective.quartics.gradient",
        "certreg.objective.quartics.value",
        "certreg.verify.minors_of",
        "certreg.verify.in_chart",
        "certreg.verify.are_forty",
    ),
    used_by=("certreg.verify.SpringsListStatement", "certreg.equilibrium.paths.critical_lines"),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
