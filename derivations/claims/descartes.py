"""Claim: the signs of the eigenvalues of K follow from the signs of integers, without roots."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import astuple
from itertools import product
from typing import Any

import sympy

from certreg.exact.signs import RootSigns, characteristic, signs_of_roots
from certreg.geometry.so3 import davenport_matrix

from ..algebra import facts, identity
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, determinant, matrix, scalar, square, symmetric

Counting = Callable[[Sequence[int]], RootSigns]
A, X = symmetric("A", 4), scalar("x")
C = matrix("C")
EXAMPLES = {(4, 3, 2): 1, (4, 2, 1): 2, (4, 3, -2): 3, (2, 1, 1): 1, (0, 0, 0): 0}


def proof(counting: Counting = signs_of_roots, *, volume: int = 8) -> Proof:
    """The shipped polynomial; that of K; the rule for every pattern of signs; examples."""
    yield _polynomial()
    yield _quartic(volume)
    yield _patterns(counting)
    yield _all_roots(counting)
    yield _by_determinants(counting)
    yield _examples(counting)


def _polynomial() -> Any:
    coefficients = characteristic_of(A.tolist())
    return identity(
        r"`certreg.exact.signs.characteristic`, run on a symmetric $4\times4$ matrix of symbols, "
        r"gives the coefficients of $\det(xI - A)$, and its divisions leave no remainder.",
        sum(c * X ** (4 - k) for k, c in enumerate(coefficients)),
        determinant(X * sympy.eye(4) - A),
    )


def characteristic_of(rows: Sequence[Sequence[Any]]) -> Sequence[Any]:
    """The shipped recursion on polynomials: its divisions by integers leave no remainder."""
    ring = sympy.polys.rings.PolyRing(sorted(A.free_symbols, key=str), sympy.QQ)
    entries: Any = [[_Entry(ring.from_expr(sympy.sympify(e))) for e in r] for r in rows]
    found: Any = characteristic(entries)
    return [entry.value.as_expr() if isinstance(entry, _Entry) else entry for entry in found]


class _Entry:
    """A polynomial that is divided by integers only, as the code divides."""

    def __init__(self, value: Any) -> None:
        self.value = value

    def _of(self, other: Any) -> Any:
        return other.value if isinstance(other, _Entry) else self.value.ring(other)

    def __add__(self, other: Any) -> _Entry:
        return _Entry(self.value + self._of(other))

    __radd__ = __add__

    def __mul__(self, other: Any) -> _Entry:
        return _Entry(self.value * self._of(other))

    __rmul__ = __mul__

    def __neg__(self) -> _Entry:
        return _Entry(-self.value)

    def __floordiv__(self, other: int) -> _Entry:
        quotient = self.value * sympy.QQ(1, other)
        if any(c.denominator != 1 for c in quotient.coeffs()):
            raise ArithmeticError(f"{other} leaves a remainder")
        return _Entry(quotient)


def _quartic(volume: int) -> Any:
    K = Matrix(davenport_matrix(C.tolist()))
    return identity(
        r"For Davenport's matrix: $\det(xI - K) = x^4 - 2|C|^2 x^2 - 8 \det(C)\, x + \det K$, "
        r"$|C|^2$ the sum of the squares of the entries.",
        determinant(X * sympy.eye(4) - K),
        X**4 - 2 * square(C) * X**2 - volume * determinant(C) * X + determinant(K),
    )


def _patterns(counting: Counting) -> Any:
    found: list[bool] = []
    for signs in product((-1, 0, 1), repeat=4):
        coefficients = (1, *signs)
        mirrored = [c * (-1) ** k for k, c in enumerate(coefficients)]
        one, other = counting(coefficients), counting(mirrored)
        found.append(one.positive + other.positive + one.zero <= 4 and one.zero == other.zero)
    return facts(
        r"The changes of sign in the coefficients of $p(x)$, those of $p(-x)$ and the zeros at the "
        r"end are never more than four in all: in each of the 81 patterns of signs. By Descartes' "
        r"rule $p$ has no more positive roots than changes of sign, $p(-x)$ none more than its "
        r"own. All four roots of $p$ are real, as $K$ is symmetric: so in both it has exactly as "
        r"many.",
        found,
        [True] * 81,
    )


def _all_roots(counting: Counting) -> Any:
    found, expected = list[RootSigns](), list[RootSigns]()
    for roots in product(range(-2, 3), repeat=4):
        coefficients = [1]
        for root in roots:
            shifted = [0, *(-root * c for c in coefficients)]
            coefficients = [a + b for a, b in zip([*coefficients, 0], shifted, strict=True)]
        found.append(counting(coefficients))
        below, zero = sum(r < 0 for r in roots), roots.count(0)
        expected.append(RootSigns(positive=4 - below - zero, zero=zero, negative=below))
    return facts(
        r"`certreg.exact.signs.signs_of_roots` counts so, of all 625 products of $x - r$ with "
        r"roots $r$ from $-2$ to $2$, each positive, zero and negative one.",
        list(map(astuple, found)),
        list(map(astuple, expected)),
    )


def _by_determinants(counting: Counting) -> Any:
    found = {
        (volume, level): counting((1, 0, -1, -volume, level)).positive
        for volume in (-1, 0, 1)
        for level in (-1, 0, 1)
    }
    return facts(
        r"So where $C \ne 0$ two signs tell the number of positive eigenvalues: two if $\det K > "
        r"0$; if $\det K < 0$, one where $\det C \ge 0$, three where $\det C < 0$; if $\det K = "
        r"0$, one where $\det C \ge 0$, two where $\det C < 0$.",
        list(found.values()),
        [3, 2, 2, 1, 1, 2, 1, 1, 2],
    )


def _examples(counting: Counting) -> Any:
    found: list[int] = []
    for diagonal in EXAMPLES:
        K: Any = davenport_matrix(sympy.diag(*diagonal).tolist())
        rows = [[int(entry) for entry in row] for row in K]
        found.append(counting(characteristic(rows)).positive)
    return facts(
        r"One, two and three: $C = \operatorname{diag}(4, 3, 2)$ has the eigenvalues $9, -1, -3, "
        r"-5$; $\operatorname{diag}(4, 2, 1)$ $7, 1, -3, -5$; $\operatorname{diag}(4, 3, -2)$ $5, "
        r"3, 1, -9$. And $\operatorname{diag}(2, 1, 1)$, with $4, 0, -2, -2$, has one; $C = 0$ "
        r"none.",
        found,
        list(EXAMPLES.values()),
    )


def _zeros_count(coefficients: Sequence[int]) -> RootSigns:
    """A zero among the coefficients taken for a change of sign."""
    found = signs_of_roots(coefficients)
    more = found.positive + sum(c == 0 for c in coefficients)
    return RootSigns(positive=more, zero=found.zero, negative=4 - more - found.zero)


def _zero_is_positive(coefficients: Sequence[int]) -> RootSigns:
    """Roots 0 counted as positive ones, up to the pattern's limit."""
    found = signs_of_roots(coefficients)
    positive = found.positive + found.zero
    return RootSigns(positive=min(positive, 4), zero=0, negative=found.negative)


CLAIM = Claim(
    name="descartes",
    title="How many eigenvalues are positive, from signs of integers",
    statement=r"The characteristic polynomial of a symmetric $4\times4$ matrix, made by the "
    r"shipped recursion, has exactly as many positive roots as its coefficients, zeros left out, "
    r"change their sign, and as many roots $0$ as it has zeros at its end. Of Davenport's matrix "
    r"it is $x^4 - 2|C|^2 x^2 - 8\det(C)\,x + \det K$, so that the number of positive eigenvalues "
    r"is one, two or three where $C \ne 0$, by the signs of $\det K$ and $\det C$, and each "
    r"occurs.",
    concludes=(1, 2, 3, 4, 5, 6),
    source="Descartes' rule of signs",
    proof=proof,
    controls={
        "zeros as changes of sign": Mutation(at=3, proof=lambda: proof(_zeros_count)),
        "roots zero taken for positive": Mutation(at=3, proof=lambda: proof(_zero_is_positive)),
        "four times the determinant": Mutation(at=2, proof=lambda: proof(volume=4)),
    },
    not_claimed="Anything of polynomials with complex roots, where the rule is an inequality.",
    needs=("davenport", "spectrum"),
    standard=(
        (
            "Descartes' rule of signs: a real polynomial has at most as many positive roots, with "
            "multiplicities, as its coefficients have changes of sign."
        ),
        "The eigenvalues of a real symmetric matrix are real.",
    ),
    runs=(
        "certreg.exact.signs.characteristic",
        "certreg.exact.signs.signs_of_roots",
    ),
    used_by=("certreg.equilibrium.breathing.breathing_equilibria",),
    not_in_coq="All of it.",
)
