"""The checks by which derivations are proved: what each accepts, and what it refuses."""

from __future__ import annotations

import pytest
import sympy

from certreg.results import Ruling
from derivations import algebra
from derivations.algebra import Square
from derivations.hypothesis import equation, invertible, nonnegative_by, positive_by, vanishing
from derivations.notation import matrix, scalar

X, Y = scalar("x"), scalar("y")
ON_THE_CIRCLE = equation("x^2 = 1 - y^2", X, 2, 1 - Y**2)
LENGTH = nonnegative_by("y is a length", Y)
ABOVE = positive_by("y is positive", Y)
NOT_ZERO = invertible("x is not zero", X)


def test_modulo_proves_entries_that_agree_without_the_relation():
    step = algebra.modulo("x = x, and x^2", [X, X**2], [X, 1 - Y**2], [ON_THE_CIRCLE])

    assert step.verdict.proved


def test_modulo_refutes_what_the_relation_does_not_give():
    step = algebra.modulo("x = 1 - y^2", [X], [1 - Y**2], [ON_THE_CIRCLE])

    assert not step.verdict.proved


def test_modulo_needs_a_hypothesis_that_eliminates_a_symbol():
    with pytest.raises(TypeError, match="eliminates no symbol"):
        algebra.modulo("x", X, 0, [vanishing("x vanishes", X)])


def test_a_wrong_identity_is_refuted_with_what_is_left():
    step = algebra.identity("wrong", (X + Y) ** 2, X**2 + Y**2)

    assert step.verdict.ruling is Ruling.REFUTED
    assert "2*x*y" in step.verdict.words


def test_an_identity_of_lists_of_unequal_length_is_a_mistake():
    with pytest.raises(ValueError, match="2 entries against 1"):
        algebra.identity("lengths", [X, Y], [X])


@pytest.mark.parametrize("bad", [0.1 * X, sympy.sqrt(X), 1 / X, sympy.sin(X), X**Y])
def test_only_polynomials_with_rational_coefficients_are_compared(bad):
    with pytest.raises(TypeError):
        algebra.identity("not a polynomial", bad, bad)
    with pytest.raises(TypeError):
        algebra.identity("not a polynomial", X, bad)


def test_cofactors_are_multiplied_out():
    same = vanishing("x = y", X - Y)
    good = algebra.combination("in the ideal", X**2 - Y**2, [(X + Y, same[0])])
    bad = algebra.combination("wrong cofactor", X**2 - Y**2, [(X - Y, same[0])])

    assert good.verdict.proved
    assert good.asserted is not None
    assert good.asserted.leans == {same}
    assert bad.verdict.ruling is Ruling.REFUTED


def test_a_cofactor_of_zero_leans_on_nothing():
    step = algebra.combination("nothing", X - X, [(0, vanishing("x = y", X - Y)[0])])

    assert step.asserted is not None
    assert step.verdict.proved
    assert step.asserted.leans == frozenset()


@pytest.mark.parametrize("generator", [X - Y, LENGTH[0], NOT_ZERO[0]])
def test_only_what_a_hypothesis_says_vanishes_is_put_to_zero(generator):
    with pytest.raises(TypeError, match="no hypothesis says"):
        algebra.combination("x = y", X - Y, [(1, generator)])


def test_positivity_asks_for_a_reason_of_every_factor():
    good = algebra.nonnegative("a square", X**2 + 2 * Y, [[1, Square(X)], [2, LENGTH[0]]])
    bad = algebra.nonnegative("another", X**2 - Y, [[Square(X)], [LENGTH[0]]])

    assert good.verdict.proved
    assert "y is a length" in good.verdict.words
    assert bad.verdict.ruling is Ruling.REFUTED
    for factor in (-1, X, sympy.Rational(-1, 2), vanishing("x vanishes", X)[0], NOT_ZERO[0]):
        with pytest.raises(TypeError, match="nobody said why"):
            algebra.nonnegative("no reason", X, [[factor]])


@pytest.mark.parametrize(
    ("terms", "proved"),
    [
        ([[Square(X)], [2, ABOVE[0]]], True),
        ([[Square(NOT_ZERO[0])], [2, LENGTH[0]]], True),
        ([[Square(X)], [2, LENGTH[0]]], False),  # both may be zero
    ],
)
def test_a_strict_conclusion_needs_a_product_that_is_strictly_positive(terms, proved):
    assert algebra.nonnegative("weak", X**2 + 2 * Y, terms).verdict.proved
    strict = algebra.positive("strict", X**2 + 2 * Y, terms)

    assert strict.verdict.proved is proved
    if not proved:
        assert "it may be zero" in strict.verdict.words


def test_a_product_that_is_zero_makes_nothing_positive():
    step = algebra.positive("0 > 0", X - X, [[0, ABOVE[0]]])

    assert not step.verdict.proved


def test_what_is_not_zero_by_hypothesis_has_a_positive_square_and_not_its_generator():
    inverse = invertible("x u = 1", X, scalar("u"))

    assert algebra.positive("x^2 > 0", X**2, [[Square(inverse[0])]]).verdict.proved


def test_an_entry_of_an_invertible_matrix_may_be_zero():
    turn = invertible("A B = I", matrix("A", 2), matrix("B", 2))
    entry = matrix("A", 2)[0, 1]

    assert algebra.nonnegative("", entry**2, [[Square(turn[0, 1])]]).verdict.proved
    assert not algebra.positive("", entry**2, [[Square(turn[0, 1])]]).verdict.proved


def test_facts_are_exact_and_not_empty():
    assert algebra.facts("same", [1, "a"], [1, "a"]).verdict.proved
    assert algebra.facts("other", [1], [2]).verdict.ruling is Ruling.REFUTED
    with pytest.raises(TypeError, match="floating-point"):
        algebra.facts("float", [0.5], [0.5])
    with pytest.raises(ValueError, match="0 facts"):
        algebra.facts("nothing", [], [])


def test_a_false_statement_is_shown_false_by_a_value_that_differs():
    assert algebra.refuting("1 = 2", [1], [2]).verdict.proved
    assert not algebra.refuting("1 = 1", [1], [1]).verdict.proved
