"""Certificates of wrong pairs with a free scale: their form, their budget, what is never struck."""

from __future__ import annotations

import json
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

from certreg.certificate import producing_consensus as made
from certreg.certificate.checking import verify
from certreg.certificate.consensus import ScaleRange
from certreg.certificate.consistency import ConsistentPairs
from certreg.certificate.envelope import Certificate
from certreg.certificate.producing_consensus import ConsensusProver, consensus_certificate
from certreg.certificate.proof_stages import Stager, length_of
from certreg.certificate.vertex_elimination import Graph
from certreg.errors import UndecidedError
from certreg.geometry.so3 import rotation_matrix
from certreg.problem.bounds import bounded
from certreg.problem.losses import Consensus
from certreg.problem.problem import RegistrationProblem
from certreg.registration.consensus import proved_consensus
from certreg.verify import check

checker = import_module("certreg.verify")
ROOT = Path(__file__).parents[2]
TRUE = sorted((ROOT / "vectors").glob("accept-scaled-pairs*.json"))
SCHEMA = json.loads(
    (ROOT / "certreg" / "report" / "schemas" / "certreg-consensus-similarity-1.json").read_bytes()
)
EDGE = 1e-9  # of a bound: how far inside of it planted residuals are


@pytest.mark.parametrize("path", TRUE, ids=lambda path: path.stem)
def test_an_accepted_vector_has_the_form_of_the_schema_and_is_read_as_it_was_written(path):
    document, loaded = json.loads(path.read_bytes()), Certificate.load(path)

    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.Draft202012Validator(SCHEMA).validate(document)
    assert json.loads(loaded.to_json()) == document
    assert Certificate.load(loaded.to_json()).body == loaded.body


def planted(seed):
    """A problem, rows that a motion with a scale meets, residuals on their bounds; its scale."""
    rng = np.random.default_rng([seed, 22])
    met, others = int(rng.integers(4, 10)), int(rng.integers(1, 8))
    n, scale = met + others, float(2.0 ** rng.uniform(-30, 30))
    x = rng.uniform(-1, 1, (n, 3)) * rng.choice([1.0, 1.0, 1e-2, 0.0], 3) + rng.uniform(-9, 9, 3)
    if np.ptp(x, axis=0).max() == 0.0:
        x[:, 0] = rng.uniform(-1, 1, n)
    q = rng.standard_normal(4)
    R = np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))
    bounds = scale * 10.0 ** rng.uniform(-3, -0.5) * rng.choice([1.0, 0.6, 0.3], n)
    ways = rng.standard_normal((n, 3))
    ways *= ((1.0 - EDGE) * bounds / np.linalg.norm(ways, axis=1))[:, None]
    y = scale * x @ R.T + scale * rng.uniform(-3, 3, 3)
    y[met:] = y[met:].mean(axis=0) + scale * rng.uniform(-1, 1, (others, 3))
    y += ways
    order = rng.permutation(n)
    problem = RegistrationProblem(x[order], y[order], scale="asymmetric")
    return problem.under(Consensus(bounds[order])), np.flatnonzero(order < met).tolist(), scale


@pytest.mark.parametrize("count", [8, pytest.param(2000, marks=pytest.mark.long)])
def test_no_pair_of_a_planted_consensus_is_struck_in_a_piece_that_holds_its_scale(count):
    for seed in range(count):
        problem, rows, scale = planted(seed)
        pairs, s = ConsistentPairs.of(problem), Fraction(scale)
        mine, n = sum(1 << i for i in rows), problem.n
        content = problem.data_bytes()
        own, _ = checker.bounded_rows(content[content.index(b"\0") + 9 :], n)
        for low, high in (
            (s, s),
            (s / 2, s * 2),
            (Fraction(0), s),
            (s, None),
            (s * 15 / 16, s * 17 / 16),
        ):
            scales = ScaleRange(low, high)
            edges = pairs.near(scales)
            graph = Graph(edges, pairs.points(scales), 0.3)
            stages = []
            left, _ = Stager(graph, rows).first(stages, (1 << n) - 1, 0 if seed % 2 else mine)
            one = max(low.denominator, 1 if high is None else high.denominator)
            ends = [int(end * one) for end in (low, high) if end]
            scaled = checker.scaled(own, 1, one)
            near = [*checker.graphs(scaled, ends)][low > 0]
            thin = checker.ScaledThinning(
                scaled,
                [*near],
                (1 << n) - 1,
                len(rows),
                [checker.LOOKS_MAX],
                low=int(low * one),
                high=None if high is None else int(high * one),
            )

            assert near == edges.integers, seed
            assert left & mine == mine, seed
            assert thin.after(stages[0].to_fields()[2]) == left, seed


def test_a_proof_is_accepted_whatever_motion_is_its_witness():
    for seed in range(4):
        problem, rows, _ = planted(seed)
        x, y = problem.source[rows], problem.target[rows]
        prover = ConsensusProver(problem, effort=0.2)
        turn, _, factor = _similarity(x, y)
        shift = y.mean(axis=0) - factor * turn @ x.mean(axis=0)
        for scale in (factor, factor * 1.3):
            found = prover.prove(turn, shift, scale)
            if found is not None:
                made = consensus_certificate(problem, found, None)
                assert verify(made.to_json()).proved, (seed, verify(made.to_json()))


def _similarity(x, y):
    """The rotation, its error and the scale of least squares [Umeyama1991]."""
    a, b = x - x.mean(axis=0), y - y.mean(axis=0)
    U, S, V = np.linalg.svd(b.T @ a)
    signs = np.array([1.0, 1.0, np.linalg.det(U @ V)])
    return U * signs @ V, S, float((S * signs).sum() / (a * a).sum())


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


@pytest.mark.long
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


@pytest.mark.long
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
