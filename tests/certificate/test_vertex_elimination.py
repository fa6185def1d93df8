"""What strikes a pair: groups of few rows, which may share some, and what the checker says."""

from __future__ import annotations

import json
from importlib import import_module
from itertools import combinations

import numpy as np
import pytest
from reference_graphs import PlainThinned, linked

from benchmarks.rates.consensus_labels import Cell
from certreg.certificate import proof_stages, vertex_elimination
from certreg.certificate.consensus import RIGID
from certreg.certificate.consistency import ConsistentPairs, ExactRows
from certreg.certificate.infeasibility_weights import PointRows
from certreg.certificate.producing_consensus import ConsensusProver, consensus_certificate
from certreg.certificate.proof_stages import Stager
from certreg.certificate.vertex_elimination import transversal
from certreg.native.bitset_graph import colours, mask_of, rows_of
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.registration.consensus import proved_consensus

checker = import_module("certreg.verify")
SHARING = Cell(n=30, wrong=50)  # the 20th of these problems has a row whose groups share rows
SHARING_SEED = 19


@pytest.fixture(scope="module")
def shared():
    problem = SHARING.problem(SHARING.instance(SHARING_SEED))
    found = proved_consensus(problem, ConsensusProver(problem), 1.0)
    assert found is not None
    return problem, json.loads(consensus_certificate(problem, found, None).to_json())


def groups_of(document):
    return document["stages"][0][2][-1][1:]


def test_groups_of_one_row_may_share_rows(shared):
    _, document = shared
    rows = [row for group in groups_of(document) for row in group[0]]

    assert len(set(rows)) < len(rows)
    assert "?" not in document["claims"]["labels"]
    assert checker.check(json.dumps(document).encode()).verified


def test_the_last_group_cannot_be_left_out(shared):
    """It was sought because some rows met all groups before it."""
    _, document = shared
    less = json.loads(json.dumps(document))
    del less["stages"][0][2][-1][-1]
    outcome = checker.check(json.dumps(less).encode())

    assert not outcome.verified
    assert "is not struck" in outcome.reason


def test_a_group_is_of_few_rows():
    cell = Cell(n=100, wrong=50)
    problem = cell.problem(cell.instance(2))
    points = ConsensusProver(problem).graph.points
    group = points.refutation(0, range(1, 100))

    assert group is not None
    assert 2 <= len(group.rows) <= 8
    assert len(group.weights) == len(group.rows) + 1


def test_pairs_that_a_motion_meets_are_not_refuted():
    cell = Cell(n=40, wrong=0, beta=9.0)
    problem = cell.problem(cell.instance(0))

    assert ConsensusProver(problem).graph.points.refutation(0, range(1, 40)) is None


@pytest.mark.parametrize("seed", range(3))
def test_a_transversal_is_found_iff_there_is_one(seed):
    rng = np.random.default_rng(seed)
    for _ in range(40):
        sets = [
            mask_of(rng.choice(8, size=rng.integers(1, 4), replace=False).tolist())
            for _ in range(rng.integers(0, 6))
        ]
        for most in range(4):
            there = any(
                all(mask_of(chosen) & mask for mask in sets)
                for size in range(most + 1)
                for chosen in combinations(range(8), size)
            )
            found = transversal(sets, most)

            assert (found is not None) == there
            if found is not None:
                assert found.bit_count() <= most
                assert all(found & mask for mask in sets)


def test_rows_with_too_few_neighbours_fall_one_after_the_other():
    near = [0b00010, 0b00101, 0b11010, 0b10100, 0b01100]  # a path 0-1-2, then the triangle 2-3-4

    assert linked(near, 0b11111, 3, 0b11111) == 0b11100
    assert linked(near, 0b11110, 3, near[0]) == 0b11100
    assert linked(near, 0b11111, 4, 0b11111) == 0
    assert linked(near, 0b11111, 2, 0b11111) == 0b11111


def test_colours_are_no_fewer_than_a_clique_has_rows():
    near = [0b00010, 0b00101, 0b11010, 0b10100, 0b01100]

    assert colours(0b11100, near, 5) == 3
    assert colours(0b11111, near, 5) == 3
    assert colours(0b11111, near, 1) == 2
    assert colours(0, near, 0) == 0


@pytest.mark.parametrize("bound", [1.0, 1.0 - 2.0**-52])
def test_lengths_on_the_edge_of_the_bounds_are_decided_exactly(bound):
    """Multiples of one length: |a - b| is 2 at most, exactly where the bounds' sum is 2."""
    source = [[0, 0, 0], [4, 0, 0], [0, 8, 0], [0, 0, 16], [1, 1, 1]]
    target = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 19], [1, 1, 1]]
    problem = bounded(RegistrationProblem(source, target), bound)
    near, exact = ConsistentPairs.of(problem).near(), ExactRows(problem)

    assert [list(rows_of(mask)) for mask in near] == [
        [j for j in range(5) if j != i and exact.agree(i, j)] for i in range(5)
    ]
    assert ((near[0] >> 1 & 1), (near[0] >> 2 & 1)) == ((1, 1) if bound == 1.0 else (0, 0))
    assert not near[0] >> 3 & 1
    assert ConsistentPairs(problem).near(RIGID).integers == near.integers


def test_pairs_that_a_rigid_motion_may_meet_are_those_of_scales_from_one_to_one():
    for seed in range(20):
        points = np.random.default_rng(seed).normal(size=(2, 40, 3)).round(seed % 3)
        problem = bounded(RegistrationProblem(*points), 0.5)
        near = ConsistentPairs.of(problem).near()

        assert near.integers == ConsistentPairs(problem).near(RIGID).integers


@pytest.mark.parametrize(("bound", "met"), [(1.0, [0, 1, 2]), (1.0 - 2.0**-52, [0, 1])])
def test_residuals_on_the_bound_are_decided_exactly(bound, met):
    source = [[0, 0, 0], [4, 0, 0], [0, 8, 0], [0, 0, 16]]
    target = [[0, 0, 0], [4, 0, 0], [0, 9, 0], [0, 0, 19]]
    problem = bounded(RegistrationProblem(source, target), bound)
    witness = ConsensusProver(problem).prove(np.eye(3), np.zeros(3))

    if len(met) < 3:
        assert witness is None
    else:
        assert witness is not None
        assert list(witness.met) == met


def test_what_is_asked_for_first_is_less_and_agrees_with_all(shared):
    problem, _ = shared
    prover = ConsensusProver(problem)
    found = proved_consensus(problem, prover, 1.0)
    assert found is not None

    brief = prover.witnessed(found.witness, whole=False)

    assert brief is not None
    assert brief.labels == found.labels
    table = prover.graph.near.table
    assert np.array_equal(table, table.T)
    assert [mask_of(np.flatnonzero(row).tolist()) for row in table] == ([*prover.graph.near])


@pytest.mark.slow
@pytest.mark.parametrize("cell", [Cell(n=60, wrong=80), Cell(n=100, wrong=90), Cell(n=90, wrong=0)])
def test_labels_are_those_of_rows_struck_in_python(cell, monkeypatch):
    """Undecided ones, too; rows that colours strike in the same order."""
    problems = [cell.problem(cell.instance(seed)) for seed in range(6)]
    compiled = [proved_consensus(problem, ConsensusProver(problem), 1.0) for problem in problems]
    monkeypatch.setattr(vertex_elimination, "Thinned", PlainThinned)
    monkeypatch.setattr(PointRows, "refutation", PointRows._refutation)
    for problem, found in zip(problems, compiled, strict=True):
        plain = proved_consensus(problem, ConsensusProver(problem), 1.0)

        assert found is not None
        assert plain is not None
        assert (plain.labels, plain.upper) == (found.labels, found.upper)
        strikes = [
            [(stage.least, strike.struck) for strike in stage.strikes]
            for stage in (plain.pieces[0].stages[0], found.pieces[0].stages[0])
        ]
        assert strikes[0] == strikes[1]


def test_no_pairs_are_struck_together_for_a_witness_that_is_far_from_the_best(monkeypatch):
    """Three pairs are met, and all others open: seconds, of hundreds of pairs; asked for, it is."""
    cell, parted = Cell(n=60, wrong=90), list[int]()
    prover = ConsensusProver(cell.problem(cell.instance(0)))
    monkeypatch.setattr(proof_stages.Assuming, "run", lambda _: False)
    monkeypatch.setattr(
        proof_stages.Parting, "run", lambda self, _: parted.append(self._thinning.least)
    )
    met = [0, 1, 2]
    for whole, stages in ((False, []), (True, [3])):
        Stager(prover.graph, met, whole).first([], (1 << 60) - 1)

        assert parted == stages
