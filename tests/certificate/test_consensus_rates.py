"""A few of the problems of which `make rates NAME=consensus_labels` takes many."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from benchmarks.rates import consensus_labels as rates


@pytest.fixture(scope="module")
def rate():
    return rates.rate_of(rates.Cell(n=20, wrong=50), 2, checked=1)


def test_labels_of_small_problems_are_proved_and_checked(rate):
    assert (rate.labels, rate.outliers, rate.best) == (1.0, 1.0, 1.0)
    assert 0 < rate.size < rates.MOST_BYTES
    assert rate.checking > 0.0


def test_what_is_not_as_it_must_be_is_named(rate):
    cell = rates.Cell(n=100, wrong=80)
    good = replace(
        rate, gnc=2.0, proving=2.0, together=20.0, checking=100.0, labels=0.95, outliers=0.5
    )

    assert rates.misses(cell, good) == []
    assert rates.misses(cell, replace(good, labels=0.94)) == ["labels"]
    assert rates.misses(cell, replace(good, proving=2.1)) == ["proving"]
    assert rates.misses(cell, replace(good, together=20.1)) == ["together"]
    assert rates.misses(cell, replace(good, checking=101.0)) == ["checking"]
    assert rates.misses(cell, replace(good, size=100_001)) == ["size"]
    assert rates.misses(replace(cell, n=1000), replace(good, proving=10.0)) == ["outliers"]
    assert rates.misses(replace(cell, wrong=95), replace(good, labels=0.0, proving=9.0)) == []
    assert rates.misses(replace(cell, beta=3.0), replace(good, labels=0.0)) == []
    assert "missed: labels" in rates.line(cell, replace(good, labels=0.94))


def test_a_cell_that_is_there_is_not_measured_again(rate, tmp_path, monkeypatch, capsys):
    results, cell = tmp_path / "new" / "consensus.json", rates.Cell(n=20, wrong=50)
    measured = list[int]()
    monkeypatch.setattr(rates, "CELLS", (cell,))
    monkeypatch.setattr(rates, "rate_of", lambda _, count: measured.append(count) or rate)

    rates.main(2, "20,50", results)
    rates.main(2, "", results)
    rates.main(3, "20", results)
    rates.main(2, "100", results)

    assert measured == [2, 3]
    assert json.loads(results.read_text("utf-8"))[cell.name]["commit"] == rates.commit()
    assert capsys.readouterr().out.count(cell.name) == 3
