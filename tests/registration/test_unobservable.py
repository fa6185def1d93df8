"""What springs leave undetermined: by all turns that are free, not by single ones of a basis."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest

from certreg.registration.unobservable import Freedom

Turn = tuple[int, ...]
SPIN, TWIST = (1, 0, 0, 0, 0, 1), (1, 0, 0, 0, 0, -1)  # of equal lengths; their sum is (2, 0, 0, 0)
FIXING = ((1, 0, 0, 0, 1, 0), (0, 1, 0, 0, 0, 1), (0, 0, 1, 1, 0, 0))  # a = -R b, for one R
ALL = tuple(tuple(int(i == k) for i in range(6)) for k in range(6))


@pytest.mark.parametrize(
    "symmetry",
    [(), (SPIN,), ((1, 0, 0, 0, 0, 2),), (SPIN, TWIST), (TWIST, SPIN), FIXING, FIXING[:1], ALL],
)
def test_the_optimum_moves_where_some_free_turn_has_two_rates(symmetry: tuple[Turn, ...]):
    """Among all small combinations of the basis: a turn (a, b) leaves one fixed iff |a| = |b|."""
    moved = False
    for shares in product(range(-1, 2), repeat=len(symmetry)):
        turn = [sum(s * one[k] for s, one in zip(shares, symmetry, strict=True)) for k in range(6)]
        moved |= sum(k * k for k in turn[:3]) != sum(k * k for k in turn[3:])

    assert Freedom(translations=(), symmetry=symmetry).moves_optimum is moved


@pytest.mark.parametrize(
    ("symmetry", "target", "source"),
    [
        ((SPIN, TWIST), (2, 0, 0), (0, 0, 2)),
        ((SPIN,), None, None),
        (((1, 2, 0, 0, 0, 0),), (1, 2, 0), None),
        (((0, 0, 0, 0, 3, 0),), None, (0, 3, 0)),
        (((0, 0, 5, 0, 0, 0),), (0, 0, 5), None),
        (((0, 0, 0, 5, 0, 0),), None, (5, 0, 0)),
        (FIXING, None, None),
        (ALL, None, None),
    ],
)
def test_an_axis_is_named_where_turns_about_it_alone_are_free(
    symmetry: tuple[Turn, ...], target: Turn | None, source: Turn | None
):
    found = Freedom(translations=(), symmetry=symmetry)

    for axis, expected in ((found.target_axis, target), (found.source_axis, source)):
        directions = None if axis is None else [Fraction(k, max(axis, key=abs)) for k in axis]
        assert directions == (expected and [Fraction(k, max(expected)) for k in expected])
    assert found.flat is (symmetry == ALL)
