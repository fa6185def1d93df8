"""The checks by which derivations are proved."""

import sympy

from derivations.algebra import Relation, modulo

x, y = sympy.symbols("x y")


def test_modulo_proves_entries_that_agree_without_the_relation():
    step = modulo("x = x, and x^2 = 1 - y^2", [x, x**2], [x, 1 - y**2], [Relation(x, 2, 1 - y**2)])

    assert step.verdict.proved


def test_modulo_refutes_what_the_relation_does_not_give():
    step = modulo("x = 1 - y^2", [x], [1 - y**2], [Relation(x, 2, 1 - y**2)])

    assert not step.verdict.proved
