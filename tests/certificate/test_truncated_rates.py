"""A sample of `make rates NAME=truncated_rotations`."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.rates import truncated_rotations


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, pytest.param(40, marks=pytest.mark.long)])
def test_random_problems_are_proved_and_forgeries_are_refused(count: int):
    trials = truncated_rotations.usual(count)

    assert truncated_rotations.faults(trials) == []
    assert all(one.forgeries[0] >= 14 for one in trials[:1])
    assert all(one.excess is not None for one in trials[:1])
    assert "exhaustive searches: " in truncated_rotations.table(trials)


def test_what_must_not_be_is_told():
    good = truncated_rotations.Trial(
        name="a", proved=True, boxes=1, search=0.1, check=0.1, excess=0.0, forgeries=(1, 0)
    )
    bad = replace(good, proved=False, search=11.0, excess=0.01, forgeries=(1, 1))
    ends = ("not proved", "too slow", "not the least", "a forgery was accepted")

    assert truncated_rotations.faults([good, bad]) == [f"a: {end}" for end in ends]
