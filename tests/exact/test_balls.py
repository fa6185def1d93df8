"""What is read off balls: fixed point, the bits of a radius, and signs."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

from certreg.exact.balls import (
    BEYOND,
    _changes,
    fixed_point,
    negative_eigenvalues,
    radius_bits,
    sign,
)


@pytest.mark.parametrize("exponent", [-300, -1, 0, 1, 77])
@pytest.mark.parametrize("mantissa", [1, 3, 2**20 + 1])
def test_a_radius_is_below_two_to_its_bits_and_not_far(mantissa, exponent):
    ball = arb(1, arb((mantissa, exponent)))
    bits = radius_bits(ball)

    assert ball.rad() < arb((1, bits))
    assert ball.rad() >= arb((1, bits - 2))


def test_no_radius_and_an_infinite_one_are_beyond_all_bounds():
    assert radius_bits(arb(3)) == -BEYOND
    assert radius_bits(arb(0, float("inf"))) == BEYOND
    assert radius_bits(arb(float("nan"))) == BEYOND


@pytest.mark.parametrize("number", [5, -5, 0, 2**70 + 1])
@pytest.mark.parametrize("bits", [0, 3, 100])
def test_fixed_point_is_the_midpoint_rounded_down(number, bits):
    with ctx.workprec(200):
        assert fixed_point(arb((number, -3)), bits) == (number << bits) >> 3


def test_a_sign_is_only_what_the_ball_tells():
    assert [sign(arb(2, 1)), sign(arb(-2, 1)), sign(arb(1, 2)), sign(arb(0))] == [1, -1, 0, 0]


@pytest.mark.parametrize(
    ("signs", "changes"),
    [
        ([1], 0),
        ([1, 1, 1, 1], 0),
        ([1, -1, 1, -1], 3),
        ([1, 0, -1], 1),
        ([1, 0, 1], None),
        ([1, 0, 0, -1], None),
        ([1, -1, 0], None),
        ([1, -1, 0, 1], 2),
    ],
)
def test_changes_of_sign_are_counted_where_no_zero_could_hide_one(signs, changes):
    assert _changes(signs) == changes


def symmetric(entries: tuple[int, ...]) -> list[list[int]]:
    a, b, c, d, e, f = entries
    return [[a, b, c], [b, d, e], [c, e, f]]


def test_negative_eigenvalues_are_counted_for_all_small_matrices():
    entries = [(*diagonal, *off) for diagonal in product((-1, 0, 2), repeat=3) for off in OFF]
    matrices = [symmetric((a, x, y, b, z, c)) for a, b, c, x, y, z in entries]
    for rows, values in zip(matrices, np.linalg.eigvalsh(np.array(matrices)), strict=True):
        zeros = int((abs(values) < 1e-9).sum())
        matrix = arb_mat(rows)

        assert negative_eigenvalues(matrix, zeros=zeros) == (values < -1e-9).sum()
        assert zeros == 0 or negative_eigenvalues(matrix) is None


OFF = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (1, -1, 2), (2, 1, 0))
