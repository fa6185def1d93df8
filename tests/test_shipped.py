"""Shipped code run on polynomials: the values are those that the code computes on numbers."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy

from certreg.exact.elimination import is_positive_definite
from certreg.geometry.so3 import davenport_matrix
from certreg.verify import positive_definite
from derivations import shipped
from derivations.notation import matrix, quaternion, scalar, symmetric, vector

C = ((3, 1, -2), (0, 5, 4), (7, -1, 2))
J = ((9, 1, 0), (1, 8, 2), (0, 2, 7))
Q, OMEGA = (1, -2, 3, 5), (4, 0, -3)


def values(expression, pairs):
    return expression.subs({s: sympy.Rational(v) for s, v in pairs}, simultaneous=True)


def test_the_matrix_that_is_decided_is_the_one_of_the_definition():
    level, mu, unit = Fraction(7, 3), Fraction(5, 2), Fraction(1, 8)
    symbols = shipped.checked_matrix(
        davenport_matrix(matrix("C").tolist()), quaternion(), scalar("level"), scalar("mu")
    )
    norm = Fraction(sum(c * c for c in Q))
    pairs = [
        *zip(matrix("C"), sum(C, ()), strict=True),
        *zip(quaternion(), Q, strict=True),
        (scalar("level"), level),
        (scalar("mu"), mu),
        (shipped.UNIT_INVERSE, 1 / unit),
        (shipped.NORM_INVERSE, 1 / norm),
    ]
    K = davenport_matrix(C)
    wanted = [
        [(level * (i == j) + mu * Q[i] * Q[j] / norm) / unit - K[i][j] for j in range(4)]
        for i in range(4)
    ]

    assert values(symbols, pairs).tolist() == [
        [sympy.Rational(entry.numerator, entry.denominator) for entry in row] for row in wanted
    ]


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


@pytest.mark.parametrize("elimination", [is_positive_definite, shipped.checked_elimination])
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
        shipped.rerouted(positive_definite, lcm=refuse)([[1]])
    assert positive_definite([[1]])
