from __future__ import annotations

from fractions import Fraction
from importlib import import_module

import numpy as np
import pytest
import strategies
from flint import ctx
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.systems import quaternion_system
from samples import examples

from certreg.equilibrium.groebner import eliminate, fibres
from certreg.errors import ContradictionError
from certreg.exact.balls import _changes, morse_bott_index, radius_bits
from certreg.geometry.so3 import davenport_matrix
from certreg.objective.classification import pattern_of
from certreg.problem.moments import exact_moments

GROEBNER = import_module("certreg.equilibrium.groebner")
small = st.integers(-6, 6)
matrices = st.lists(st.lists(small, min_size=3, max_size=3), min_size=3, max_size=3)
BITS = 120


def eliminated(C):
    return eliminate(C, davenport_matrix(C))


def index_of(pattern):
    return [sum(pattern[:k]) for k in range(len(pattern))]


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_every_row_has_its_components_dimensions_degrees_and_indices(specimen):
    C = exact_moments(specimen.problem).cross
    found = eliminated(C)
    parts = fibres(found, BITS)

    assert tuple(part.dimension + 1 for part in parts) == specimen.pattern
    assert [part.degree for part in parts] == [2**part.dimension for part in parts]
    assert (found.dimension == 4) == (specimen.pattern == (1, 1, 1, 1))
    indices = [morse_bott_index(C, part.vectors[0], part.dimension, bits=BITS) for part in parts]
    assert indices == index_of(specimen.pattern)


@pytest.mark.slow
@examples(300)
@given(matrices)
def test_elimination_and_discriminant_give_the_same_pattern(C):
    """Small integers make degenerate matrices frequent; the two share no formula."""
    assert tuple(p.dimension + 1 for p in fibres(eliminated(C), 60)) == pattern_of(C)


@pytest.mark.slow
@settings(max_examples=40)
@given(matrices)
def test_all_six_quadratics_vanish_on_every_vector_found(C):
    system = quaternion_system(C)
    for part in fibres(eliminated(C), BITS):
        for vector in part.vectors:
            with ctx.workprec(2 * BITS):
                values = system.evaluate(vector)
            assert all(value == 0 or value.contains(0) for value in values)
            assert all(value == 0 or radius_bits(value) < 20 - BITS for value in values)


def test_half_turns_are_found_though_the_first_chart_misses_them():
    """C = diag(-1, -2, -3): the optimum is a half turn, w = 0, at infinity where w = 1."""
    found = eliminated([[-1, 0, 0], [0, -2, 0], [0, 0, -3]])

    assert found.chart not in ((1, 0, 0, 0), None)
    best = fibres(found, 60)[0].vectors[0]
    assert [float(c.mid()) for c in best[:1]] == [0.0]


def test_with_the_first_chart_alone_a_half_turn_would_be_a_contradiction(monkeypatch):
    monkeypatch.setattr(GROEBNER, "CHARTS", 1)
    with pytest.raises(ContradictionError, match="infinity"):
        eliminated([[-1, 0, 0], [0, -2, 0], [0, 0, -3]])


def test_the_eliminant_is_the_characteristic_polynomial_of_the_davenport_matrix():
    """The elimination rediscovers it: K is the multiplication matrix of the critical value."""
    C = [[3, 1, -2], [7, 2, 5], [0, -1, 4]]
    found = eliminated(C)
    K = np.array(davenport_matrix(C))

    assert found.chart == (1, 0, 0, 0)
    assert [[int(found.action[i, j]) for j in range(4)] for i in range(4)] == K.tolist()
    wanted = np.round(np.poly(K)).astype(int).tolist()
    assert [int(c) for c in found.eliminant.coeffs()][::-1] == wanted


@pytest.mark.parametrize("exponent", [3, 6, 9, 12, 60])
def test_a_gap_however_small_is_told_from_none(exponent):
    big = 10**exponent
    close = [[big + 1, 0, 0], [0, big, 0], [0, 0, 1]]
    equal = [[big, 0, 0], [0, big, 0], [0, 0, 1]]

    assert [p.dimension for p in fibres(eliminated(close), BITS)] == [0, 0, 0, 0]
    assert [p.dimension for p in fibres(eliminated(equal), BITS)] == [0, 1, 0]
    values = [p.value for p in fibres(eliminated(close), 4 * BITS)]
    with ctx.workprec(4 * BITS):
        gap = values[1] - values[2]
    assert gap.contains(2)
    assert radius_bits(gap) < 0


def test_an_index_is_not_guessed_from_balls_that_are_too_wide():
    C = [[3, 0, 0], [0, 2, 0], [0, 0, 1]]
    vector = fibres(eliminated(C), 60)[0].vectors[0]
    with ctx.workprec(60):
        wide = tuple(c + 0 * c + (c - c).__class__(0, 1) for c in vector)

    assert morse_bott_index(C, vector, 0, bits=60) == 0
    assert morse_bott_index(C, wide, 0, bits=60) is None


def test_irrational_conjugate_components_are_both_found():
    """2,2 with an irrational critical value: C of rank one, d1 = sqrt(14 * 3)."""
    C = [[1, 2, 3], [1, 2, 3], [1, 2, 3]]
    found = eliminated(C)
    values = [float(part.value.mid()) for part in fibres(found, 60)]

    assert [factor.degree() for factor, _ in found.fibres] == [2]
    assert values == pytest.approx([42**0.5, -(42**0.5)], rel=1e-15)
    assert Fraction(int(found.eliminant.coeffs()[0])) == -42


def test_rules_that_are_no_groebner_basis_are_a_contradiction(monkeypatch):
    """Six quadratics at random have no four common zeros: the multiplications do not commute."""
    rng = np.random.default_rng(0)
    table = rng.integers(-9, 9, size=(6, 10)).tolist()
    monkeypatch.setattr(GROEBNER, "torque_table", lambda _: table)

    with pytest.raises(ContradictionError, match="no Groebner basis"):
        eliminated([[3, 1, -2], [7, 2, 5], [0, -1, 4]])


def test_a_lost_component_would_be_missed_by_the_hilbert_function(monkeypatch):
    monkeypatch.setattr(GROEBNER, "_nullity", lambda *_: 1)

    with pytest.raises(ContradictionError, match="Hilbert"):
        eliminated([[2, 0, 0], [0, 2, 0], [0, 0, 1]])


@pytest.mark.parametrize(
    ("signs", "changes"),
    [
        ([1, 1, 1, 1], 0),
        ([1, -1, 1, -1], 3),
        ([1, 0, -1, -1], 1),
        ([1, 1, 0, -1], 1),
        ([1, 0, 1, 1], None),
        ([1, -1, 0, -1], None),
        ([1, -1, 1, 0], None),
        ([1, 0, 0, -1], None),
        ([1], 0),
    ],
)
def test_changes_of_sign_are_counted_where_they_are_known(signs, changes):
    assert _changes(signs) == changes
