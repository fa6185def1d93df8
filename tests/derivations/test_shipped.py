"""Shipped code run on polynomials: the values are those that the code computes on numbers."""

from __future__ import annotations

import inspect
from fractions import Fraction
from importlib import import_module

import pytest
import sympy

from certreg.exact.elimination import is_positive_definite
from certreg.geometry.so3 import davenport_matrix
from certreg.verify import positive_definite, proves_basin, proves_level
from derivations import shipped
from derivations.notation import matrix, quaternion, scalar, symmetric, vector

checker = import_module("certreg.verify")
C = ((3, 1, -2), (0, 5, 4), (7, -1, 2))
J = ((9, 1, 0), (1, 8, 2), (0, 2, 7))
Q, OMEGA = (1, -2, 3, 5), (4, 0, -3)


def values(expression, pairs):
    return expression.subs({s: sympy.Rational(v) for s, v in pairs}, simultaneous=True)


@pytest.mark.slow
def test_the_matrix_that_is_decided_is_the_one_of_the_definition():
    level, mu, unit = 7, 5, 8
    symbols = shipped.checked_matrix(
        davenport_matrix(matrix("C").tolist()), quaternion(), scalar("level"), scalar("mu")
    )
    norm = sum(c * c for c in Q)
    pairs = [
        *zip(matrix("C"), sum(C, ()), strict=True),
        *zip(quaternion(), Q, strict=True),
        (scalar("level"), level),
        (scalar("mu"), mu),
        (shipped.UNIT, unit),
    ]
    K = davenport_matrix(C)
    wanted = [
        [level * (i == j) + mu * Q[i] * Q[j] - norm * unit * K[i][j] for j in range(4)]
        for i in range(4)
    ]

    assert values(symbols, pairs).tolist() == wanted


@pytest.mark.slow
def test_what_the_basin_compares_is_alignment_less_a_quarter_of_twice_the_kinetic_energy():
    expression = shipped.checked_alignment(
        davenport_matrix(matrix("C").tolist()), symmetric("J"), quaternion(), vector("omega")
    )
    norm = sum(c * c for c in Q)
    inertia = dict(zip(symmetric("J"), sum(J, ()), strict=True))
    pairs = [
        *zip(matrix("C"), sum(C, ()), strict=True),
        *inertia.items(),
        *zip(quaternion(), Q, strict=True),
        *zip(vector("omega"), OMEGA, strict=True),
        (shipped.NORM_INVERSE, Fraction(1, norm)),
        (shipped.TWO_POWER, Fraction(1, 4)),
    ]
    K = davenport_matrix(C)
    value = Fraction(sum(Q[i] * K[i][j] * Q[j] for i in range(4) for j in range(4)), norm)
    spin = sum(OMEGA[i] * J[i][j] * OMEGA[j] for i in range(3) for j in range(3))

    assert values(expression, pairs) == value - Fraction(spin, 4) / 16


@pytest.mark.parametrize(
    "elimination", [is_positive_definite, lambda rows: positive_definite(shipped.upper(rows))]
)
def test_the_pivots_of_an_integer_matrix_are_its_minors(elimination):
    A = sympy.Matrix([[2, 1, 0], [1, 3, -1], [0, -1, 4]])

    assert shipped.pivots_of(elimination, A) == [2, 5, 18]


def test_a_division_that_leaves_a_remainder_is_an_error():
    def careless(rows):
        return (rows[0][0] // rows[0][1]) <= 0

    with pytest.raises(ArithmeticError, match="remainder"):
        shipped.pivots_of(careless, symmetric("A"))


def test_rerouting_leaves_the_shipped_function_as_it_was():
    def refuse(*_):
        raise AssertionError("asked")

    with pytest.raises(AssertionError, match="asked"):
        shipped.rerouted(positive_definite, zip=refuse)([[1, 0], [1]], 1)
    assert positive_definite([[1]])


# What a replacement does not stand for ------------------------------------------------------------


def careless(function, change):
    """A function of the checker with its text changed."""
    text = inspect.getsource(function)
    assert text.count(change[0]) == 1
    names = dict(vars(checker))
    code = compile("from __future__ import annotations\n" + text.replace(*change), "-", "exec")
    exec(code, names)  # noqa: S102  (the shipped text, changed in one place)
    return names[function.__name__]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("_dyadic(1, exponent)", "_dyadic(1, 0)"), "the power of 0"),
        (("_dyadic(1, exponent)", "_dyadic(1, exponent - 1)"), "unsupported operand"),
        (("_dyadic(1, exponent)", "_dyadic(1, -exponent)"), "bad operand"),
        (("sum(c * c for c in p)", "2 * sum(c * c for c in p)"), "a division by"),
        (("sum(c * c for c in p)", "sum(c * c for c in p[1:])"), "a division by"),
        (("any(p) and", "level < 0 or any(p) and"), "no polynomial"),
        (("- spin > level", "- spin >= level"), "not supported"),
        (("return any(p)", "return not any(p)"), "more than one comparison"),
    ],
)
def test_a_basin_decided_otherwise_than_is_modelled_is_an_error(monkeypatch, change, words):
    monkeypatch.setattr(shipped, "proves_basin", careless(proves_basin, change))
    K = davenport_matrix(matrix("C").tolist())

    with pytest.raises((shipped.UnmodelledError, TypeError), match=words):
        shipped.checked_alignment(K, symmetric("J"), quaternion("p"), vector("omega"))


def test_a_replacement_that_the_code_does_not_use_is_an_error():
    with pytest.raises(shipped.UnmodelledError, match="does not use"):
        shipped.rerouted(positive_definite, gcd=max)


def test_a_quotient_by_anything_but_the_norm_or_an_integer_is_an_error():
    ring = shipped.ring_of([*quaternion(), shipped.NORM_INVERSE])
    norm = ring.from_expr(sum(c**2 for c in quaternion()))
    quotient = shipped.fraction_over(norm)

    assert quotient(norm, norm) == norm * ring.from_expr(shipped.NORM_INVERSE)
    assert quotient(norm, 3) == norm * Fraction(1, 3)
    for number, divisor in ((norm, norm + 1), (norm, 2 * norm), (norm, 1.5), (1, norm)):
        with pytest.raises(shipped.UnmodelledError):
            quotient(number, divisor)


@pytest.mark.one_in(3)
@pytest.mark.parametrize("other", [1, -1, 0.0])
def test_a_pivot_compared_with_anything_but_zero_is_an_error(other):
    with pytest.raises(shipped.UnmodelledError, match="a comparison with"):
        shipped.pivots_of(lambda rows: rows[0][0] <= other, symmetric("A"))
    with pytest.raises(shipped.UnmodelledError, match="a comparison with"):
        shipped.pivots_of(lambda rows: rows[0][0] > other, symmetric("A"))


@pytest.mark.parametrize(
    "change",
    [
        ("sum(map(mul, q, q))", "2 * sum(map(mul, q, q))"),
        ("q)) * unit", "q))"),
        ("mu * c for c in q", "mu for c in q"),
        ("a * b - n * k", "a * b - k"),
        ("row[i] += level", "row[0] += level"),
    ],
)
def test_a_level_decided_otherwise_is_another_matrix(monkeypatch, change):
    K, q = davenport_matrix(matrix("C").tolist()), quaternion()
    shipped_one = shipped.checked_matrix(K, q, scalar("level"), scalar("mu"))
    monkeypatch.setattr(shipped, "proves_level", careless(proves_level, change))

    assert shipped.checked_matrix(K, q, scalar("level"), scalar("mu")) != shipped_one


def test_a_level_decided_twice_is_an_error(monkeypatch):
    twice = careless(proves_level, ("return definite(", "return definite(K, 1) or definite("))
    monkeypatch.setattr(shipped, "proves_level", twice)

    with pytest.raises(shipped.UnmodelledError, match="more than one definiteness"):
        shipped.checked_matrix(
            davenport_matrix(matrix("C").tolist()), quaternion(), scalar("level"), scalar("mu")
        )
