"""The graph of rows that agree in their lengths, its cores, cliques and triangles."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from reference_graphs import PlainEnumeration, plain_greedy_clique
from wrong_pairs import wrong_pairs

from certreg.native.bitset_graph import BitRows, mask_of, rows_of
from certreg.native.cliques import greedy_clique, triangles
from certreg.relaxation import cliques
from certreg.relaxation.cliques import CliqueSearch, consistency, core
from certreg.relaxation.paired_rows import paired_rows

ALL = (1 << 40) - 1


@pytest.fixture(scope="module")
def pairs():
    return wrong_pairs(np.random.default_rng(0), 40, 0.7)


@pytest.fixture(scope="module")
def near(pairs):
    return consistency(paired_rows(pairs.source, pairs.target, pairs.bounds))


@pytest.fixture(scope="module")
def graph(near):
    return near.table


def test_rows_agree_whose_lengths_differ_by_no_more_than_both_bounds(pairs, graph):
    for i, j in combinations(range(40), 2):
        lengths = [np.linalg.norm(points[i] - points[j]) for points in (pairs.source, pairs.target)]
        agree = abs(lengths[0] - lengths[1]) <= pairs.bounds[i] + pairs.bounds[j]
        assert graph[i, j] == graph[j, i] == agree
    assert not graph.diagonal().any()


def test_an_edge_on_the_boundary_is_kept():
    source = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    target = np.array([[0.0, 0.0, 0.0], [0.0, 1.3, 0.0]])

    assert consistency(paired_rows(source, target, np.array([0.1, 0.2]))).table[0, 1]


@pytest.mark.parametrize("degree", [0, 3, 8, 12, 40])
def test_a_core_is_the_largest_part_of_that_degree(near, graph, degree):
    rows = np.array(list(rows_of(core(near, degree))), dtype=int)
    inside = graph[np.ix_(rows, rows)].sum(axis=1)
    left = set(range(40))
    while poor := [i for i in left if graph[i, sorted(left)].sum() < degree]:
        left.discard(poor[0])

    assert (inside >= degree).all()
    assert set(rows.tolist()) == left


@pytest.mark.parametrize("alive", [ALL, ALL // 3, 0b1110111 << 20])
def test_a_greedy_clique_is_one_that_no_row_can_join(near, graph, alive):
    rows = list(rows_of(alive))
    for row in rows:
        clique = greedy_clique(near, alive, row)
        assert row in clique
        assert set(clique.tolist()) <= set(rows)
        assert all(graph[i, j] for i, j in combinations(clique, 2))
        assert not graph[clique][:, rows].all(axis=0).any()


def test_greedy_cliques_are_the_same_in_c_and_in_python(near):
    """Rows with as many neighbours, too: the first is taken."""
    apart = np.subtract.outer(np.arange(10), np.arange(10)) % 5 != 0
    for graph in (near, BitRows.of_table(apart)):
        n = len(graph)
        compiled = [greedy_clique(graph, (1 << n) - 1, row).tolist() for row in range(n)]
        assert compiled == [plain_greedy_clique(graph, (1 << n) - 1, row) for row in range(n)]


def test_a_greedy_clique_that_begins_at_a_true_row_holds_most_true_rows(pairs, near):
    found = [greedy_clique(near, ALL, row) for row in np.flatnonzero(pairs.true).tolist()]

    assert np.median([pairs.true[rows].sum() for rows in found]) == pairs.true.sum()


@pytest.mark.parametrize("batch", [1, 7, 1000])
@pytest.mark.parametrize("size", [1, 2, 3, 5, 9, 12, 40])
def test_every_clique_of_a_size_is_enumerated_once(near, graph, size, batch):
    rows = range(3, 17)
    search = CliqueSearch(10**6).of_size(near, mask_of(rows), size, batch)
    batches = [one.tolist() for one in search]
    there = [
        chosen
        for chosen in combinations(rows, size)
        if all(graph[i, j] for i, j in combinations(chosen, 2))
    ]

    assert sorted(tuple(sorted(one)) for some in batches for one in some) == there
    assert all(len(some) == batch for some in batches[:-1])


def test_cliques_come_in_the_same_order_and_at_the_same_price_in_c_and_in_python(near, monkeypatch):
    def told():
        search = CliqueSearch(3000)
        return [one.tolist() for one in search.of_size(near, ALL, 4, 50)], search.steps

    compiled = told()
    monkeypatch.setattr(cliques, "CliqueEnumeration", PlainEnumeration)

    assert told() == compiled
    assert compiled[1] < 0


def test_an_enumeration_ends_with_its_steps_and_says_so(near):
    short, long = CliqueSearch(100), CliqueSearch(10**6)
    few, many = (sum(map(len, one.of_size(near, ALL, 3, 10))) for one in (short, long))

    assert few < many
    assert short.steps < 0 <= long.steps


def test_a_clique_of_many_rows_is_enumerated():
    """No function calls itself once a row."""
    near = BitRows.of_table(~np.eye(1500, dtype=bool))
    ((found,),) = CliqueSearch(10**6).of_size(near, (1 << 1500) - 1, 1500, 5)

    assert sorted(found.tolist()) == list(range(1500))


@pytest.mark.parametrize("alive", [ALL, ALL // 3])
def test_triangles_are_counted(near, graph, alive):
    rows = list(rows_of(alive))
    each = [0] * 40
    for i, j, k in combinations(rows, 3):
        if graph[i, j] and graph[j, k] and graph[i, k]:
            each = [count + (row in (i, j, k)) for row, count in enumerate(each)]

    assert triangles(near, alive)[rows].tolist() == [2 * each[row] for row in rows]
