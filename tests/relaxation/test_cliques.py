"""The graph of rows that agree in their lengths, its cores, cliques and triangles."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from wrong_pairs import wrong_pairs

from certreg.relaxation import cliques
from certreg.relaxation.cliques import CliqueSearch, consistency, core, greedy_clique, triangles
from certreg.relaxation.paired_rows import paired_rows


@pytest.fixture(scope="module")
def pairs():
    return wrong_pairs(np.random.default_rng(0), 40, 0.7)


@pytest.fixture(scope="module")
def graph(pairs):
    return consistency(paired_rows(pairs.source, pairs.target, pairs.bounds))


def test_rows_agree_whose_lengths_differ_by_no_more_than_both_bounds(pairs, graph):
    for i, j in combinations(range(40), 2):
        lengths = [np.linalg.norm(points[i] - points[j]) for points in (pairs.source, pairs.target)]
        agree = abs(lengths[0] - lengths[1]) <= pairs.bounds[i] + pairs.bounds[j]
        assert graph[i, j] == graph[j, i] == agree
    assert not graph.diagonal().any()


def test_the_graph_is_the_same_in_blocks(pairs, graph, monkeypatch):
    monkeypatch.setattr(cliques, "BLOCK", 100)

    blocks = consistency(paired_rows(pairs.source, pairs.target, pairs.bounds))
    np.testing.assert_array_equal(blocks, graph)


def test_an_edge_on_the_boundary_is_kept():
    source = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    target = np.array([[0.0, 0.0, 0.0], [0.0, 1.3, 0.0]])

    assert consistency(paired_rows(source, target, np.array([0.1, 0.2])))[0, 1]


@pytest.mark.parametrize("degree", [0, 3, 8, 12, 40])
def test_a_core_is_the_largest_part_of_that_degree(graph, degree):
    rows = core(graph, degree)
    inside = graph[np.ix_(rows, rows)].sum(axis=1)
    left = set(range(40))
    while poor := [i for i in left if graph[i, sorted(left)].sum() < degree]:
        left.discard(poor[0])

    assert (inside >= degree).all()
    assert set(rows.tolist()) == left


def test_a_greedy_clique_is_one_that_no_row_can_join(graph):
    for row in range(40):
        clique = greedy_clique(graph, row)
        assert row in clique
        assert all(graph[i, j] for i, j in combinations(clique, 2))
        assert not graph[clique].all(axis=0).any()


def test_a_greedy_clique_that_begins_at_a_true_row_holds_most_true_rows(pairs, graph):
    cliques_of_true = [greedy_clique(graph, row) for row in np.flatnonzero(pairs.true).tolist()]

    assert np.median([pairs.true[rows].sum() for rows in cliques_of_true]) == pairs.true.sum()


@pytest.mark.parametrize("size", [1, 2, 3, 5, 9, 12, 40])
def test_every_clique_of_a_size_is_enumerated_once(graph, size):
    small = graph[:14, :14]
    found = [tuple(sorted(one)) for one in CliqueSearch(10**6).of_size(small, size)]
    cliques_there = [
        rows
        for rows in combinations(range(14), size)
        if all(small[i, j] for i, j in combinations(rows, 2))
    ]

    assert sorted(found) == cliques_there


def test_an_enumeration_ends_with_its_steps_and_says_so(graph):
    short, long = CliqueSearch(100), CliqueSearch(10**6)

    assert len(list(short.of_size(graph, 3))) < len(list(long.of_size(graph, 3)))
    assert short.steps < 0 <= long.steps


def test_a_clique_of_many_rows_is_enumerated():
    """No function calls itself once a row."""
    (found,) = CliqueSearch(10**6).of_size(~np.eye(1500, dtype=bool), 1500)

    assert sorted(found) == list(range(1500))


def test_triangles_are_counted_and_estimated(graph, monkeypatch):
    counted = triangles(graph, np.random.default_rng(0))
    each = [sum(graph[i, j] for i, j in combinations(np.flatnonzero(row), 2)) for row in graph]
    monkeypatch.setattr(cliques, "SAMPLED", 20)
    estimated = triangles(graph, np.random.default_rng(0))

    np.testing.assert_array_equal(counted, 2.0 * np.array(each))
    assert np.corrcoef(counted, estimated)[0, 1] > 0.9
