"""Two rows that are struck together: the same turns in doubles as in the checker's integers."""

from __future__ import annotations

from importlib import import_module
from itertools import combinations
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks.rates.consensus_labels import Cell
from certreg.certificate import clique_refutation, edge_elimination
from certreg.certificate.clique_refutation import Assuming, CliqueAvoiding
from certreg.certificate.consensus import Group, Strike
from certreg.certificate.consistency import ConsistentPairs
from certreg.certificate.edge_elimination import Parting, sets_of, turned
from certreg.certificate.producing_consensus import ConsensusProver, consensus_certificate
from certreg.certificate.vertex_elimination import GraphThinning
from certreg.native.bitset_graph import mask_of, rows_of
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.registration.consensus import proved_consensus

checker = import_module("certreg.verify")


def integer_rows(problem):
    content = problem.data_bytes()[len(checker.CONSENSUS) + 8 :]
    return checker.bounded_rows(content, problem.n)[0]


def compared(problem, e, f, rows):
    """How many pairs of rows doubles leave open, of those that the checker takes."""
    turns = turned(ConsistentPairs.of(problem).points(), e, f, rows)
    if turns is None:
        return 1
    exact = checker.turned(integer_rows(problem), e, f, mask_of(rows))
    own = [mask_of([row for row, there in zip(rows, one, strict=True) if there]) for one in turns]
    quarter = checker.QUARTER
    assert own == [exact[4 * (m % quarter) + m // quarter] for m in range(4 * quarter)]
    assert sets_of(turns, rows, 0) == set(exact)
    assert sets_of(turns, rows, 2) == {mask for mask in exact if mask.bit_count() >= 2}
    return 0


@pytest.mark.parametrize("size", [1.0, 2.0**-300, 2.0**300])
@pytest.mark.parametrize("sigma", [0.0, 1e-9, 0.03])
def test_doubles_have_the_turns_of_the_checker_or_none(size: float, sigma: float):
    rng, left_open = np.random.default_rng(5), 0
    x = rng.uniform(-1.0, 1.0, (8, 3))
    y = x[:, [1, 2, 0]] * [1, 1, rng.choice([-1, 1])] + rng.normal(0.0, sigma, (8, 3))
    problem = bounded(RegistrationProblem(size * x, size * y), size * (0.01 + sigma))
    for e, f in ((0, 1), (1, 0), (3, 5), (7, 2)):
        left_open += compared(problem, e, f, [k for k in range(8) if k not in (e, f)])

    assert left_open == 0


def test_rows_that_are_near_or_along_the_axis_of_frames_are_not_told():
    source = [[0, 0, 0], [0.1, 0, 0], [17, 29, 43], [0, 9, 0], [0, 0, 1e-150]]
    points = ConsistentPairs.of(bounded(RegistrationProblem(source, source), 1.0)).points()
    fine = ConsistentPairs.of(bounded(RegistrationProblem(source, source), 1e-200)).points()

    assert turned(points, 0, 1, [2, 3]) is None
    assert turned(points, 0, 2, [1, 3]) is None
    assert turned(fine, 0, 4, [1, 3]) is None
    assert turned(points, 0, 3, [1, 2]) is not None


def test_where_a_row_is_on_the_edge_of_a_turn_doubles_tell_nothing():
    """At phi = 0 it is off by 4: its bound is 3, and 1/32 of 32 is added."""
    source = [[0, 0, 0], [0, 0, 64], [32, 0, 0]]
    target = [[0, 0, 0], [0, 0, 64], [32, 0, 4]]
    bounds = np.array([2.0**-60, 2.0**-60, 3.0])
    problem = bounded(RegistrationProblem(source, target), bounds)
    wider = bounded(RegistrationProblem(source, target), bounds + 1e-6)

    assert turned(ConsistentPairs.of(problem).points(), 0, 1, [2]) is None
    assert compared(wider, 0, 1, [2]) == 0


def twins(rng, count):
    """So many pairs under one motion, as many that are mirrored, all bounds 0.02."""
    x = rng.uniform(-1.0, 1.0, (2 * count, 3))
    y = x.copy()
    y[count:, 2] *= -1.0
    return bounded(RegistrationProblem(x, y), 0.02)


def test_mirror_images_are_struck_that_no_single_row_is():
    """They agree in all lengths, so they are a clique as large as that of the motion."""
    problem = twins(np.random.default_rng(2), 9)
    prover, everything, within = ConsensusProver(problem), (1 << 18) - 1, (1 << 9) - 1
    thinning = GraphThinning(prover.graph, everything, 9, within)
    thinning.run()
    before, one = thinning.left.alive, Parting(thinning)
    while one.run():
        thinning.run()
    found = prover.prove(np.eye(3), np.zeros(3))

    assert before == everything
    assert thinning.left.alive == within
    assert all(isinstance(strike.struck, tuple) for strike in thinning.strikes)
    assert found is not None
    assert found.labels == "i" * 9 + "o" * 9
    assert checker.check(consensus_certificate(problem, found, None).to_json()).verified


def test_no_pair_is_struck_where_two_motions_meet_as_many():
    rng = np.random.default_rng(3)
    x = rng.uniform(-1.0, 1.0, (16, 3))
    y = x.copy()
    y[8:] = x[8:][:, [1, 2, 0]]
    problem = bounded(RegistrationProblem(x, y), 0.02)
    near = ConsensusProver(problem).graph.near
    thinning = GraphThinning(ConsensusProver(problem).graph, (1 << 16) - 1, 8, (1 << 8) - 1)
    thinning.run()
    while Parting(thinning).run():
        thinning.run()

    assert thinning.left.alive == (1 << 16) - 1
    assert all(thinning.left.near[i] & 255 == near[i] & 255 for i in range(8))
    assert all(thinning.left.near[i] >> 8 == near[i] >> 8 for i in range(8, 16))


@pytest.fixture(scope="module")
def few():
    """Five right pairs of a hundred."""
    cell = Cell(n=100, wrong=95)
    problem = cell.problem(cell.instance(3))
    prover = ConsensusProver(problem)
    found = proved_consensus(problem, prover, 1.0)
    assert found is not None
    return problem, found, prover


def test_where_few_pairs_are_right_rows_fall_that_stayed(few):
    problem, found, prover = few
    alone, parted = (
        GraphThinning(prover.graph, (1 << problem.n) - 1, len(found.met), mask_of(found.met))
        for _ in range(2)
    )
    alone.run()
    parted.run()
    one = Parting(parted)
    while one.run():
        parted.run()

    assert sum(isinstance(strike.struck, tuple) for strike in parted.strikes) > 50
    assert 2 * parted.left.alive.bit_count() < alone.left.alive.bit_count()
    assert found.labels.count("?") <= (parted.left.alive & ~mask_of(found.met)).bit_count()
    assert checker.check(consensus_certificate(problem, found, None).to_json()).verified


def test_a_row_falls_where_each_clique_of_its_neighbours_is_refuted(few):
    problem, found, prover = few
    near, met, every = prover.graph.near, mask_of(found.met), (1 << problem.n) - 1
    thinning = GraphThinning(prover.graph, every, len(found.met), met)
    thinning.run()
    before, one = len(thinning.strikes), Assuming(thinning)
    while one.run():
        thinning.run()
    steps = [strike.to_fields() for strike in thinning.strikes]

    def left(steps):
        used = checker.Thinning(
            integer_rows(problem), [*near], every, len(found.met), [10**9], rigid=True
        )
        return used.after(steps)

    groups = [k for k, step in enumerate(steps) if k >= before and len(step) > 2]
    assert groups
    assert left(steps) == thinning.left.alive
    assert one.given_up == 0
    with pytest.raises(checker.RefusalError):
        left([*steps[: groups[0]], steps[groups[0]][:-1], *steps[groups[0] + 1 :]])


def test_cliques_are_found_without_groups_and_not_searched_without_end():
    near = [mask & ~(1 << i) for i, mask in enumerate([0b11111] * 5)]
    search, lazy = CliqueAvoiding(near, 1000), CliqueAvoiding(near, 3)

    assert search.clique(0b11111, [], 5) == 0b11111
    assert search.clique(0b11111, [0b11], 4) in {0b11110, 0b11101}
    assert search.clique(0b11111, [0b11], 5) is None
    assert search.choices > 0
    assert lazy.clique(0b11111, [0b11, 0b110], 4) is None
    assert lazy.choices == 0


def test_turns_are_not_tried_without_end(few):
    problem, found, _ = few
    near = ConsensusProver(problem, effort=0.0).graph
    thinning = GraphThinning(near, (1 << problem.n) - 1, len(found.met), mask_of(found.met))
    thinning.run()
    while Parting(thinning).run():
        thinning.run()
    used = checker.Thinning(
        integer_rows(problem), [*near.near], (1 << problem.n) - 1, len(found.met), [10**9]
    )  # not rigid: without turns

    left = used.after([strike.to_fields() for strike in thinning.strikes])
    assert left == thinning.left.alive
    assert set(rows_of(left)) >= {k for k, label in enumerate(found.labels) if label != "o"}


def test_no_more_pairs_are_struck_than_a_certificate_may_hold(few, monkeypatch):
    problem, found, prover = few
    monkeypatch.setattr(edge_elimination, "MOST_STRUCK", 10)
    thinning = GraphThinning(prover.graph, (1 << problem.n) - 1, len(found.met), mask_of(found.met))
    thinning.run()
    one = Parting(thinning)
    while one.run():
        thinning.run()

    assert sum(isinstance(strike.struck, tuple) for strike in thinning.strikes) == 10


def test_no_more_groups_are_made_than_a_certificate_may_hold(few, monkeypatch):
    problem, found, prover = few
    monkeypatch.setattr(clique_refutation, "MOST_IN_ALL", 1)
    less = prover.witnessed(found.witness)

    assert less.labels.count("o") <= found.labels.count("o")
    assert checker.check(consensus_certificate(problem, less, None).to_json()).verified


def test_stages_that_make_a_certificate_too_long_are_left_out(monkeypatch):
    cell = Cell(n=100, wrong=95)
    problem = cell.problem(cell.instance(5))  # labels stay open: a second stage tells the maximum
    prover = ConsensusProver(problem)
    found = proved_consensus(problem, prover, 1.0)
    assert found is not None
    monkeypatch.setattr("certreg.certificate.producing_consensus.MOST", 0)
    less = prover.witnessed(found.witness)

    assert less is not None
    assert len(less.pieces[0].stages) == 1 < len(found.pieces[0].stages)
    assert less.upper > found.upper
    assert checker.check(consensus_certificate(problem, less, None).to_json()).verified


@pytest.mark.parametrize("refuted", [3, 2])
def test_a_row_falls_only_where_no_clique_is_left_however_soon_the_search_is_given_up(refuted):
    """Six rows that all agree, four to be met: with the last one three of the five others are."""
    struck = list[tuple[set[int], ...]]()

    def refutation(_: int, rows: list[int]) -> Group:
        return Group(rows=tuple(rows[:refuted]), weights=(1,) * (refuted + 1))

    def strike(one: Strike) -> None:
        struck.append(tuple(set(group.rows) for group in one.groups))

    for choices in range(120):
        points = SimpleNamespace(refutation=refutation)
        thinning: Any = SimpleNamespace(
            graph=SimpleNamespace(effort=choices / clique_refutation.MOST_CHOICES, points=points),
            left=SimpleNamespace(
                near=SimpleNamespace(integers=[0b111111 & ~(1 << i) for i in range(6)]),
                alive=0b111111,
                beside=lambda _: 0b11111,
            ),
            closed=False,
            least=4,
            open_rows=lambda: [5],
            strike=strike,
        )
        struck.clear()
        one = Assuming(thinning)

        assert one.run() == bool(struck) == (not one.given_up)
        for groups in struck:
            assert all(
                any(group <= set(clique) for group in groups)
                for clique in combinations(range(5), 3)
            ), choices
    assert struck
