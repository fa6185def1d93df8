"""Graphs of bits: what C and Python strike of them is the same, and what sets say."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from reference_graphs import PlainThinned, bit_rows

from certreg.native.bitset_graph import BitRows, Thinned, agreeing, mask_of, rows_of

SIZES = (1, 5, 64, 65, 130)


def random_graph(n: int, seed: int) -> BitRows:
    rng = np.random.default_rng([n, seed])
    upper = np.triu(rng.random((n, n)) < rng.uniform(0.3, 0.9), 1)
    return BitRows.of_table(upper | upper.T)


def thinnings(n: int, seed: int):
    """The same in C and in Python, and the rows that colours do not strike."""
    near, rng = random_graph(n, seed), np.random.default_rng(seed)
    clique = mask_of(rng.choice(n, n // 8, replace=False).tolist())
    given = (near, (1 << n) - 1, 3 + seed * n // 10, clique)
    return Thinned(*given), PlainThinned(*given)


@pytest.mark.parametrize("n", SIZES)
def test_a_graph_is_the_same_as_bits_integers_and_a_table(n: int):
    near = random_graph(n, 0)

    assert np.array_equal(bit_rows([*near]).words, near.words)
    assert [list(rows_of(mask)) for mask in near] == [
        np.flatnonzero(row).tolist() for row in near.table
    ]
    assert near[n - 1] == near.integers[-1]


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("seed", range(5))
def test_c_strikes_what_python_strikes(n: int, seed: int):
    compiled, plain = thinnings(n, seed)

    assert compiled.alive == plain.alive
    assert [*compiled.open_rows()] == [*plain.open_rows()]
    assert compiled.strike_by_colours() == plain.strike_by_colours()
    assert compiled.alive == plain.alive
    for row in list(rows_of(plain.alive))[:3]:
        beside = plain.beside(row)
        assert compiled.beside(row) == beside
        assert [compiled.colours(beside, most) for most in (2, n)] == [
            plain.colours(beside, most) for most in (2, n)
        ]
        if plain.alive >> row & 1:
            compiled.strike(row)
            plain.strike(row)
            assert compiled.alive == plain.alive


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("seed", range(4))
def test_c_cuts_what_python_cuts_and_leaves_the_graph_alone(n: int, seed: int):
    (compiled, plain), rng = thinnings(n, seed), np.random.default_rng(seed)
    given = random_graph(n, seed)
    for _ in range(20):
        pairs = [(i, j) for i in rows_of(plain.alive) for j in rows_of(plain.beside(i)) if i < j]
        if not pairs:
            break
        pair = pairs[int(rng.integers(len(pairs)))]
        compiled.cut(*pair)
        plain.cut(*pair)

        assert compiled.alive == plain.alive
        assert not plain.near[pair[0]] >> pair[1] & 1
        assert compiled.strike_by_colours() == plain.strike_by_colours()
        assert [*compiled.near] == [*plain.near]
    assert np.array_equal(random_graph(n, seed).words, given.words)


def test_a_large_clique_stays():
    """None of its rows falls, and what is left has the degrees that were asked for."""
    for seed in range(20):
        near, rng = random_graph(30, seed), np.random.default_rng(seed)
        rows = np.sort(rng.choice(30, 9, replace=False)).tolist()
        near = near.with_edges(list(combinations(rows, 2)))
        left = Thinned(near, (1 << 30) - 1, 9, 0)
        struck = left.strike_by_colours()

        assert mask_of(rows) & ~left.alive == 0
        assert not mask_of(rows) & mask_of(struck)
        assert all(left.beside(row).bit_count() >= 8 for row in rows_of(left.alive))


def test_nothing_is_left_where_there_are_too_few_colours():
    """Two halves, each row beside all of the other: no three agree."""
    table = np.add.outer(np.arange(12), np.arange(12)) % 2 == 1
    left = Thinned(BitRows.of_table(table), (1 << 12) - 1, 3, 0)

    assert left.alive == (1 << 12) - 1
    assert left.colours(left.alive, 12) == 2
    assert left.strike_by_colours()
    assert left.alive == 0


def test_rows_of_the_clique_are_not_struck_by_colours():
    table = np.add.outer(np.arange(12), np.arange(12)) % 2 == 1
    left = Thinned(BitRows.of_table(table), (1 << 12) - 1, 3, (1 << 12) - 1)

    assert left.strike_by_colours() == []


@pytest.mark.parametrize("size", [1.0, 1e-9, 1e-160])
@pytest.mark.parametrize("n", [1, 40, 64, 150])
def test_lengths_agree_as_in_longer_numbers(n: int, size: float):
    """In long doubles, but for pairs that are told to be open; bounds of many sizes."""
    rng = np.random.default_rng(n)
    points = rng.uniform(-1, 1, (n, 6))
    points[:, 3:] = points[:, :3] + size * rng.normal(size=(n, 3))
    bounds = size * rng.uniform(0.1, 1.0, n)
    found = agreeing(points[:, :3], points[:, 3:], bounds)
    long = points.astype(np.longdouble)
    a, b = (
        np.sqrt(((part[:, None] - part) ** 2).sum(axis=2)) for part in (long[:, :3], long[:, 3:])
    )
    near = np.abs(a - b) <= np.add.outer(bounds, bounds)
    for i, j in found.open_pairs:
        near[i, j] = near[j, i] = False
    np.fill_diagonal(near, val=False)

    assert np.array_equal(found.near.table, near)
    assert size < 1e-9 or not found.open_pairs


def test_pairs_on_the_bound_are_left_open():
    """|a - b| = 2 = the sum of the bounds, in numbers that doubles have; and two equal points."""
    points = np.array([[0, 0, 0, 0, 0, 0], [4, 0, 0, 6, 0, 0], [4, 0, 0, 6, 0, 0]]) / 8.0
    found = agreeing(points[:, :3], points[:, 3:], np.full(3, 1 / 8))

    assert found.open_pairs == [(0, 1), (0, 2)]
    assert [*found.near] == [0, 0b100, 0b010]
