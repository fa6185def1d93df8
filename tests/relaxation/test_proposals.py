"""Candidates of a maximum consensus: rows within bounds at proper poses, ever more of them."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from wrong_pairs import WrongPairs, wrong_pairs

from benchmarks.rates.consensus_poses import graduated_nonconvexity
from certreg.geometry.so3 import is_reflection
from certreg.native.bitset_graph import BitRows
from certreg.relaxation import proposals
from certreg.relaxation.cliques import consistency
from certreg.relaxation.edge_rows import grown, held, widened
from certreg.relaxation.paired_rows import fitted, paired_rows
from certreg.relaxation.proposals import candidates

GNC_FAILS = (5, 6, 10)  # seeds of clouds where graduated non-convexity ends at other rows
EPSILON = 1e-9  # of a bound: what other roundings may add


def made(points=50, wrong=0.5, seed=0):
    return wrong_pairs(np.random.default_rng(seed), points, wrong)


def all_candidates(pairs, **options):
    return list(candidates(pairs.source, pairs.target, pairs.bounds, **options))


def misses(pairs, candidate):
    x, y, z = (pairs.source @ candidate.rotation.T + candidate.translation - pairs.target).T
    return np.hypot(np.hypot(x, y), z)  # squares of a row out of reach overflow


def without_order(source, target, bounds):
    return WrongPairs(
        source=np.array(source, dtype=float),
        target=np.array(target, dtype=float),
        bounds=np.array(bounds, dtype=float),
        true=np.ones(len(bounds), dtype=bool),
    )


def mirrored():
    pairs = made(20, 0.0, seed=3)
    return replace(pairs, target=pairs.target * [1.0, 1.0, -1.0])


def many_to_one():
    pairs = made(40, 0.5, seed=4)
    return replace(pairs, source=pairs.source[np.arange(40) // 2])


def exhausted(pairs):
    """The most rows at any pose of a clique: every set of three rows, widened one at a time."""
    most = 0
    for rows in combinations(range(len(pairs.bounds)), 3):
        one = paired_rows(pairs.source, pairs.target, pairs.bounds)
        start = held(one, fitted(one, np.isin(np.arange(len(one)), rows) * one.precisions))
        if start.count >= 3:
            most = max(most, widened(one, grown(one, start)).count)
    return most


def far_row(size):
    """A wrong target that no sum of squares holds beside the others."""
    pairs = made(30, 0.3, seed=8)
    return replace(pairs, target=np.vstack([[size, 0.0, 0.0], pairs.target[1:]]))


LINE = np.outer(np.arange(8.0), [1.0, 2.0, 2.0])
ZOO = {
    "half wrong": made(),
    "all wrong": made(30, 1.0, seed=1),
    "none wrong": made(30, 0.0, seed=2),
    "three rows": made(3, 0.0),
    "mirrored": mirrored(),
    "many to one": many_to_one(),
    "mixed bounds": replace(made(), bounds=np.linspace(0.01, 0.2, 50)),
    "collinear": without_order(LINE, LINE[:, ::-1] + 5.0, np.full(8, 0.01)),
    "coincident": without_order(np.ones((6, 3)), np.full((6, 3), 2.0), np.full(6, 0.1)),
    "one row far": far_row(1e20),
    "one row out of reach": far_row(1e200),
    "far from each other": without_order(LINE, LINE[::-1] ** 3 * 100.0, np.full(8, 1e-3)),
}


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", ZOO)
def test_candidates_are_rows_within_bounds_at_proper_poses_and_ever_more(name):
    pairs = ZOO[name]
    found = all_candidates(pairs, effort=0.2)
    gnc = graduated_nonconvexity(pairs.source, pairs.target, pairs.bounds)

    assert found
    for one in [*found, gnc]:
        np.testing.assert_allclose(one.rotation @ one.rotation.T, np.eye(3), atol=1e-12)
        assert not is_reflection(one.rotation)
        assert (np.diff(one.inliers) > 0).all()
        ratios = misses(pairs, one) / pairs.bounds
        assert (ratios[one.inliers] <= 1.0 + EPSILON).all()
        assert (np.delete(ratios, one.inliers) > 1.0 - EPSILON).all()
    sizes = [len(one.inliers) for one in [gnc, *found]]
    assert sizes == sorted(sizes)
    assert len(set(sizes[1:])) == len(found)


def test_bounds_below_rounding_are_no_error():
    """Weights of some rows fall to 0 there in Lawson's iteration, and to nothing in all."""
    rng = np.random.default_rng(21)
    source = rng.integers(0, 3, (13, 3)).astype(float)
    target = source[:, [1, 0, 2]] * [-1.0, 1.0, 1.0]
    target[:6] = rng.random((6, 3))
    pairs = without_order(source, target, 10.0 ** rng.uniform(-15.0, -9.0, 13))

    assert len(all_candidates(pairs, effort=0.1)[-1].inliers) >= 3


@pytest.mark.parametrize("wrong", [0.0, 0.5, 0.8])
def test_all_true_rows_are_found(wrong):
    pairs = made(100, wrong, seed=5)
    found = all_candidates(pairs)

    assert len(found[-1].inliers) >= pairs.true.sum()
    assert np.isin(np.flatnonzero(pairs.true), found[-1].inliers).all()


def test_the_same_seed_gives_the_same_candidates():
    first, again = (all_candidates(made(40, 0.9), effort=0.2) for _ in range(2))

    assert [one.inliers.tolist() for one in first] == [one.inliers.tolist() for one in again]
    for one, other in zip(first, again, strict=True):
        np.testing.assert_array_equal(one.rotation, other.rotation)


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e8), (1e6, 1e8)])
def test_rows_are_the_same_at_every_scale_and_offset(scale, shift):
    pairs = made(40, 0.6, seed=6)
    moved = replace(
        pairs,
        source=pairs.source * scale + shift,
        target=pairs.target * scale - shift,
        bounds=pairs.bounds * scale,
    )
    last, there = all_candidates(pairs)[-1], all_candidates(moved)[-1]

    np.testing.assert_array_equal(there.inliers, last.inliers)


def test_rows_are_the_same_in_every_order():
    pairs = made(40, 0.6, seed=6)
    order = np.random.default_rng(0).permutation(40)
    turned = replace(
        pairs, source=pairs.source[order], target=pairs.target[order], bounds=pairs.bounds[order]
    )
    last, there = all_candidates(pairs)[-1], all_candidates(turned)[-1]

    np.testing.assert_array_equal(np.sort(order[there.inliers]), last.inliers)


def test_rows_that_may_not_be_together_begin_no_search():
    pairs = made(50, 0.8, seed=GNC_FAILS[0])
    alone = BitRows.of_table(np.zeros((50, 50), dtype=bool))
    told = consistency(paired_rows(pairs.source, pairs.target, pairs.bounds))
    none, given, made_anew = (
        len(all_candidates(pairs, consistent=graph)[-1].inliers) for graph in (alone, told, None)
    )

    assert none < pairs.true.sum()
    assert given == made_anew >= pairs.true.sum()


@pytest.mark.parametrize("seed", GNC_FAILS)
@pytest.mark.parametrize("kept", ["CLIQUES", "STEPS", "TRIPLES"])
def test_each_source_of_poses_finds_the_true_rows_alone(kept, seed, monkeypatch):
    for others in {"CLIQUES", "STEPS", "TRIPLES"} - {kept}:
        monkeypatch.setattr(proposals, others, 0)
    pairs = made(50, 0.8, seed=seed)

    assert len(all_candidates(pairs, effort=4.0)[-1].inliers) >= pairs.true.sum()


@pytest.mark.parametrize("seed", range(3))
def test_no_triple_of_rows_leads_to_more_rows(seed):
    pairs = made(12, 0.6, seed=seed)

    assert len(all_candidates(pairs)[-1].inliers) >= exhausted(pairs)
