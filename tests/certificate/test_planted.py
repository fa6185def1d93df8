"""A sample of `make rates NAME=planted_consensus`."""

from __future__ import annotations

import pytest

from benchmarks.rates import planted_consensus
from certreg.problem.losses import Consensus

FEW = planted_consensus.INSTANCES // 4000


@pytest.mark.slow
@pytest.mark.parametrize("count", [FEW, pytest.param(40 * FEW, marks=pytest.mark.long)])
def test_no_planted_pair_is_struck_and_the_checker_agrees(count: int):
    first = 1 if count == FEW else 0

    assert [
        fault for seed in range(first, first + count) for fault in planted_consensus.faults(seed)
    ] == []


def test_a_graph_that_loses_a_neighbour_at_its_bound_is_seen(monkeypatch):
    honest = planted_consensus.consistent_pairs

    def strict(problem):
        return honest(problem.under(Consensus(problem.bounds * (1.0 - 1e-6))))

    assert list(planted_consensus.faults(3)) == []
    monkeypatch.setattr(planted_consensus, "consistent_pairs", strict)
    assert any(
        "no neighbours" in fault for k in (1, 3, 5, 7) for fault in planted_consensus.faults(k)
    )
