"""Forms of degree four in a quaternion (w, x, y, z), by their 35 coefficients.

The coefficients are plain, without multinomials, and stand in the order of MONOMIALS. Every
function on rotations that is quadratic in the entries of R is such a form over |q|^4, and every
such form is one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import cache
from itertools import combinations_with_replacement, groupby, product
from typing import Any

from certreg.geometry.constraints import ROTATION_SIZE, homogeneous
from certreg.geometry.so3 import Matrix4, T, Vector4, rotation_matrix, squared_norm

MONOMIALS = tuple(combinations_with_replacement(range(4), 4))  # q_i q_j q_k q_l, i <= j <= k <= l
PAIRS = tuple(combinations_with_replacement(range(4), 2))  # q_i q_j, i <= j
PLACE: dict[tuple[int, ...], int] = {monomial: k for k, monomial in enumerate(MONOMIALS)}
PAIR_PLACE: dict[tuple[int, ...], int] = {pair: k for k, pair in enumerate(PAIRS)}

Terms = tuple[tuple[int, int, int], ...]


def quartic_of_form(form: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """F with F(q) = r^T form r for r = (|q|^2, vec |q|^2 R(q)), of a symmetric 10x10 matrix."""
    total = [0] * len(MONOMIALS)
    for i, j, terms in _rotation_products():
        entry = form[i][j]
        if entry:
            for place, multiple in terms:
                total[place] += multiple * entry
    return tuple(total)


def value(quartic: Sequence[Any], q: Sequence[T]) -> T:
    """F(q)."""
    pairs = _pairs(q)
    total: Any = sum(
        pairs[first] * sum(quartic[k] * pairs[then] for k, then in rest) for first, rest in _VALUE
    )
    return total


def gradient(quartic: Sequence[Any], q: Sequence[T]) -> Vector4[T]:
    """The four first derivatives."""
    pairs = _pairs(q)
    rows: Any = tuple(
        sum(
            q[variable] * sum(multiple * quartic[k] * pairs[pair] for k, multiple, pair in terms)
            for variable, terms in row
        )
        for row in _GRADIENT
    )
    return rows


def hessian(quartic: Sequence[Any], q: Sequence[T]) -> Matrix4[T]:
    """The 4x4 matrix of second derivatives."""
    pairs = _pairs(q)
    entries: list[Any] = [
        sum(multiple * quartic[k] * pairs[pair] for k, multiple, pair in terms)
        for terms in _HESSIAN
    ]
    rows: Any = tuple(
        tuple(entries[PAIR_PLACE[min(i, j), max(i, j)]] for j in range(4)) for i in range(4)
    )
    return rows


def derivatives_along_turns(quartic: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """35x6: the coefficients of the derivative of F along six turns of the quaternion.

    Columns: along i q, j q, k q, turns in the world, and along q i, q j, q k, turns in the body.
    These six directions are a basis of so(4): a combination that vanishes leaves F as it is.
    """
    return tuple(
        tuple(sum([multiple * quartic[k] for k, multiple in terms]) for terms in row)
        for row in _turn_terms()
    )


@cache
def _turn_terms() -> tuple[tuple[tuple[tuple[int, int], ...], ...], ...]:
    """For each monomial and each turn: which coefficients go into it, how many times."""
    columns = [_along(turn) for turn in _TURNS]
    return tuple(tuple(tuple(terms.items()) for terms in row) for row in zip(*columns, strict=True))


def _along(turn: Sequence[tuple[int, int]]) -> list[Counter[int]]:
    """Of sum_k dF/dq_k (A q)_k: row k of A has but one entry, `turn[k]` = (sign, column)."""
    total: list[Counter[int]] = [Counter() for _ in MONOMIALS]
    for number, monomial in enumerate(MONOMIALS):
        for place, k in enumerate(monomial):
            sign, column = turn[k]
            moved = (*monomial[:place], column, *monomial[place + 1 :])
            total[PLACE[tuple(sorted(moved))]][number] += sign
    return total


_TURNS = (
    ((-1, 1), (1, 0), (-1, 3), (1, 2)),  # i q = (-x, w, -z, y)
    ((-1, 2), (1, 3), (1, 0), (-1, 1)),  # j q = (-y, z, w, -x)
    ((-1, 3), (-1, 2), (1, 1), (1, 0)),  # k q = (-z, -y, x, w)
    ((-1, 1), (1, 0), (1, 3), (-1, 2)),  # q i = (-x, w, z, -y)
    ((-1, 2), (-1, 3), (1, 0), (1, 1)),  # q j = (-y, -z, w, x)
    ((-1, 3), (1, 2), (-1, 1), (1, 0)),  # q k = (-z, y, -x, w)
)


def _pairs(q: Sequence[Any]) -> list[Any]:
    return [q[i] * q[j] for i, j in PAIRS]


@cache
def _rotation_products() -> tuple[tuple[int, int, tuple[tuple[int, int], ...]], ...]:
    """Of each entry (i, j), i <= j, of a form: which coefficients it goes into, how many times."""
    entries = [_quadratic(entry) for entry in _entries_of_r()]
    found: list[tuple[int, int, tuple[tuple[int, int], ...]]] = []
    for i, j in combinations_with_replacement(range(ROTATION_SIZE), 2):
        total: Counter[int] = Counter()
        for (one, a), (other, b) in product(entries[i].items(), entries[j].items()):
            total[PLACE[tuple(sorted((*one, *other)))]] += (1 + (i != j)) * a * b
        found.append((i, j, tuple((k, c) for k, c in total.items() if c)))
    return tuple(found)


def _entries_of_r() -> list[list[int]]:
    """Values of (|q|^2, vec |q|^2 R(q)) at e_i and e_i + e_j in the order of PAIRS, entry-wise."""
    values: list[tuple[int, ...]] = []
    for i, j in PAIRS:
        q = [int(k in (i, j)) for k in range(4)]
        values.append(homogeneous(rotation_matrix(q), unit=squared_norm(q)))
    return [list(column) for column in zip(*values, strict=True)]


def _quadratic(values: Sequence[int]) -> dict[tuple[int, int], int]:
    """The quadratic form that has these values at e_i and e_i + e_j."""
    at = dict(zip(PAIRS, values, strict=True))
    return {(i, j): at[i, j] - (i != j) * (at[i, i] + at[j, j]) for i, j in PAIRS}


def _value_terms() -> tuple[tuple[int, tuple[tuple[int, int], ...]], ...]:
    """By the first two factors of a monomial: its coefficient, and its last two."""
    return tuple(
        (PAIR_PLACE[first], tuple((PLACE[m], PAIR_PLACE[m[2:]]) for m in monomials))
        for first, monomials in groupby(MONOMIALS, key=lambda m: m[:2])
    )


def _derived(variables: Sequence[int]) -> list[tuple[int, int, tuple[int, ...]]]:
    """Which monomials have derivatives by these variables, how many times, and what is left."""
    found: list[tuple[int, int, tuple[int, ...]]] = []
    for place, monomial in enumerate(MONOMIALS):
        left, multiple = list(monomial), 1
        for variable in variables:
            multiple *= left.count(variable)
            if multiple:
                left.remove(variable)
        if multiple:
            found.append((place, multiple, tuple(left)))
    return found


def _gradient_terms() -> tuple[tuple[tuple[int, Terms], ...], ...]:
    """For each derivative, by the first factor that is left: coefficient, multiple, last two."""
    return tuple(
        tuple(
            (first, tuple((place, multiple, PAIR_PLACE[left[1:]]) for place, multiple, left in row))
            for first, row in groupby(
                sorted(_derived([k]), key=lambda term: term[2]), key=lambda term: term[2][0]
            )
        )
        for k in range(4)
    )


def _hessian_terms() -> tuple[Terms, ...]:
    """For each second derivative in the order of PAIRS: coefficient, multiple, what is left."""
    return tuple(
        tuple((place, multiple, PAIR_PLACE[left]) for place, multiple, left in _derived(pair))
        for pair in PAIRS
    )


_VALUE = _value_terms()
_GRADIENT = _gradient_terms()
_HESSIAN = _hessian_terms()
