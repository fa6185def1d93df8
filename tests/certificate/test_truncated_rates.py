"""A sample of `make truncated-rates`."""

from __future__ import annotations

from dataclasses import replace

import pytest
import truncated_rates


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, pytest.param(40, marks=pytest.mark.long)])
def test_random_problems_are_proved_and_forgeries_are_refused(count: int):
    trials = truncated_rates.usual(count)

    assert truncated_rates.faults(trials) == []
    assert all(one.forgeries[0] >= 14 for one in trials[:1])
    assert all(one.excess is not None for one in trials[:1])
    assert "exhaustive searches: " in truncated_rates.table(trials)


def test_what_must_not_be_is_told():
    good = truncated_rates.Trial(
        name="a", proved=True, boxes=1, search=0.1, check=0.1, excess=0.0, forgeries=(1, 0)
    )
    bad = replace(good, proved=False, search=11.0, excess=0.01, forgeries=(1, 1))
    ends = ("not proved", "too slow", "not the least", "a forgery was accepted")

    assert truncated_rates.faults([good, bad]) == [f"a: {end}" for end in ends]
