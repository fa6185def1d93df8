"""A free scale where all pairs are wrong: the proof ends soon, and fits into a certificate."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from certreg.certificate import producing_consensus as made
from certreg.certificate.producing_consensus import consensus_certificate
from certreg.certificate.staging import length_of
from certreg.errors import UndecidedError
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.registration.consensus import proved_consensus
from certreg.verify import check


def all_wrong(n: int, seed: int = 1) -> RegistrationProblem:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1.0, 1.0, (2, n, 3))
    return bounded(RegistrationProblem(*points, scale="asymmetric"), 0.06)


def searched(problem: RegistrationProblem) -> Any:
    found = proved_consensus(problem, made.ConsensusProver(problem), 1.0)
    assert found is not None
    return found


@pytest.mark.parametrize("n", [16, pytest.param(100, marks=pytest.mark.long)])
@pytest.mark.slow
def test_what_is_proved_where_pairs_agree_by_chance_is_accepted(n: int):
    problem = all_wrong(n)
    found = searched(problem)
    outcome = check(consensus_certificate(problem, found, None).line())

    assert outcome.verified, outcome.reason
    assert len(found.met) <= found.upper < n


@pytest.mark.slow
def test_cutting_ends_where_ever_more_ranges_stay_open(monkeypatch):
    problem = all_wrong(20)
    monkeypatch.setattr(made, "MOST_OPEN", 2)
    few = searched(problem)
    monkeypatch.setattr(made, "MOST_OPEN", 8)
    more = searched(problem)

    assert few.states.count("?") <= 4
    assert len(few.pieces) <= len(more.pieces)
    assert more.upper <= few.upper
    for found in (few, more):
        assert check(consensus_certificate(problem, found, None).line()).verified


@pytest.mark.slow
def test_stages_of_all_ranges_together_are_no_longer_than_they_may_be(monkeypatch):
    problem = all_wrong(20)
    whole = searched(problem)
    length = sum(length_of(piece.stages) for piece in whole.pieces)
    monkeypatch.setattr(made, "MOST", length - 1)
    short = searched(problem)

    assert len(short.pieces) <= len(whole.pieces)
    assert whole.upper <= short.upper
    assert sum(length_of(piece.stages) for piece in short.pieces) < length
    assert check(consensus_certificate(problem, short, None).line()).verified


@pytest.mark.slow
def test_a_proof_that_no_certificate_holds_is_undecided(monkeypatch):
    problem = all_wrong(12)
    found = searched(problem)
    monkeypatch.setattr(made, "MOST", 3)

    with pytest.raises(UndecidedError, match="12 pairs with a free scale is longer than a certif"):
        consensus_certificate(problem, found, None)
