"""A sample of `make planted`: no pair of a planted consensus is ever struck."""

from __future__ import annotations

import planted
import pytest

FEW = planted.INSTANCES // 4000


@pytest.mark.slow
@pytest.mark.parametrize("count", [FEW, pytest.param(40 * FEW, marks=pytest.mark.long)])
def test_no_planted_pair_is_struck_and_the_checker_agrees(count: int):
    first = 1 if count == FEW else 0

    assert [fault for seed in range(first, first + count) for fault in planted.faults(seed)] == []


def test_a_graph_that_loses_a_neighbour_at_its_bound_is_seen(monkeypatch):
    honest = planted.consistent_pairs

    def strict(problem):
        return honest(type(problem)(problem.problem, problem.bounds * (1.0 - 1e-6)))

    assert list(planted.faults(3)) == []
    monkeypatch.setattr(planted, "consistent_pairs", strict)
    assert any("no neighbours" in fault for k in (1, 3, 5, 7) for fault in planted.faults(k))
