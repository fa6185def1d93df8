"""No forged certificate of consensus is accepted that a motion contradicts.

Of small problems so many motions are known that no claim can escape them: for every set of pairs
that which brings the largest residual, in bounds, as low as it can be. What each meets is certain
to a billionth of a bound.
"""

from __future__ import annotations

import copy
import json
import random
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from consensus_forgeries import met_by, rotation, staged, stepped

from certreg.certificate.producing_consensus import ConsensusProver, consensus_certificate
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem

checker = import_module("certreg.verify")
Document = dict[str, Any]
SURE = 1e-9  # of a bound
ROUNDS = 60  # of reweighting, towards the least largest residual


@dataclass(frozen=True)
class Known:
    """A certificate, the rows that each motion meets, and motions to take as another witness."""

    document: Document
    met: frozenset[frozenset[int]]
    witnesses: tuple[Document, ...]
    points: tuple[Any, Any, Any]


def fitted(x: Any, y: Any, w: Any) -> tuple[Any, Any]:
    """The least squares of each problem, by singular values [Kabsch1976]."""
    share = (w / w.sum(axis=1, keepdims=True))[:, :, None]
    a, b = (share * x).sum(axis=1, keepdims=True), (share * y).sum(axis=1, keepdims=True)
    U, _, V = np.linalg.svd(np.swapaxes(share * (y - b), 1, 2) @ (x - a))
    U[:, :, 2] *= np.linalg.det(U @ V)[:, None]
    R = U @ V
    return R, (b - a @ np.swapaxes(R, 1, 2))[:, 0]


def motions(x: Any, y: Any, bounds: Any) -> tuple[Any, Any]:
    """For every set of three pairs or more, that of its least largest residual, nearly."""
    n = len(x)
    sets = [s for k in range(3, n + 1) for s in combinations(range(n), k)]
    inside = np.zeros((len(sets), n))
    for row, s in zip(inside, sets, strict=True):
        row[list(s)] = 1.0
    w, x, y = inside / bounds**2, np.broadcast_to(x, (len(sets), n, 3)), y[None]
    found = []
    for _ in range(ROUNDS):
        R, t = fitted(x, y, w)
        found.append((R, t))
        off = np.linalg.norm(y - x @ np.swapaxes(R, 1, 2) - t[:, None], axis=2) / bounds
        w = w * np.maximum(off, 1e-6)
        w /= w.max(axis=1, keepdims=True)
    R, t = (np.concatenate([pair[k] for pair in found[::6]]) for k in (0, 1))
    return R, t


@cache
def known(seed: int) -> Known:
    """Two motions that share pairs, noise near the bound, a mirror image and a pair at random."""
    rng = np.random.default_rng(seed)
    x = rng.integers(-8, 9, (8, 3)).astype(float)
    if seed % 3 == 0:
        x[:5, 2] = 0.0
    q = rng.standard_normal(4)
    first, second = np.eye(3), rotation(q / np.linalg.norm(q) + [6.0 * (seed % 2), 0, 0, 0])
    y = x @ first.T + rng.uniform(-0.6, 0.6, (8, 3))
    y[4:7] = x[4:7] @ second.T + [0.5, 0.25, -0.5] + rng.uniform(-0.5, 0.5, (3, 3))
    y[6 + seed % 2] = x[6 + seed % 2] * [1, 1, -1]
    bounds = rng.choice([0.5, 0.75, 1.0], 8)
    Rs, ts = motions(x, y, bounds)
    off = np.linalg.norm(y - x @ np.swapaxes(Rs, 1, 2) - ts[:, None], axis=2) / bounds
    sure = off < 1.0 - SURE
    best = np.argsort(-sure.sum(axis=1), kind="stable")
    prover = ConsensusProver(bounded(RegistrationProblem(x, y), bounds), effort=0.3)
    made = [prover.prove(Rs[k], ts[k]) for k in (best[0], best[len(best) // 3])]
    documents = [
        json.loads(consensus_certificate(prover.problem, one, None).to_json())
        for one in made
        if one is not None
    ]
    # A row at its bound may be met or not: it counts neither way.
    met = frozenset(
        frozenset(np.flatnonzero(row).tolist())
        for row, near in zip(sure, np.abs(off - 1.0) < SURE, strict=True)
        if not near.any()
    )
    witnesses = tuple(document["witness"] for document in documents)
    return Known(documents[seed % len(documents)], met, witnesses, (x, y, bounds))


def contradicted(document: Document, case: Known) -> bool:
    """Whether a known motion is against a claim."""
    claims, K = document["claims"], len(met_by(document["witness"], case.points))
    inside = {i for i, letter in enumerate(claims["labels"]) if letter == "i"}
    outside = {i for i, letter in enumerate(claims["labels"]) if letter == "o"}
    return any(
        len(met) > claims["upper"] or (len(met) >= K and (not inside <= met or met & outside))
        for met in case.met
    )


def forged(case: Known, rng: random.Random) -> Document:
    """Other claims, another witness, other stages, steps, groups or weights."""
    document = copy.deepcopy(case.document)
    for _ in range(rng.choice((1, 1, 2, 3))):
        way = rng.choice((claimed, claimed, within, within, within, witnessed, framed, framed))
        way(document, case, rng)
    return document


def within(document: Document, case: Known, rng: random.Random) -> None:
    rng.choice((staged, staged, stepped))(document["stages"], len(case.points[0]), rng)


def claimed(document: Document, case: Known, rng: random.Random) -> None:
    claims, n = document["claims"], len(case.points[0])
    if rng.random() < 0.3:
        claims["upper"] += rng.choice((-1, -1, 1, 2))
        return
    labels = list(claims["labels"])
    for k in rng.sample(range(n), rng.choice((1, 2, n))):
        labels[k] = rng.choice("io?")
    claims["labels"] = "".join(labels)


def framed(document: Document, case: Known, rng: random.Random) -> None:
    """A row is struck by a step without proof, or left out by a stage, and labelled so."""
    stages, n, row = document["stages"], len(case.points[0]), rng.randrange(len(case.points[0]))
    if not stages:
        return
    letter = rng.choice("io")
    if letter == "i":
        stages.insert(rng.randint(1, len(stages)), [stages[0][0], row, []])
    else:
        known_groups = [group for step in stages[0][2] for group in step[1:]]
        few = rng.sample(known_groups, min(len(known_groups), rng.randrange(3)))
        stages[0][2].insert(0, copy.deepcopy([row, *few]))
        document["claims"]["upper"] = n
    labels = document["claims"]["labels"]
    document["claims"]["labels"] = "?" * row + letter + "?" * (len(labels) - row - 1)


def witnessed(document: Document, case: Known, rng: random.Random) -> None:
    document["witness"] = copy.deepcopy(rng.choice(case.witnesses))
    place = rng.randrange(4)
    document["witness"]["quaternion"][place] += rng.choice((0, 0, 1 << 40, 1 << 56, -(1 << 58)))


@pytest.mark.slow
@pytest.mark.parametrize("count", [75, pytest.param(6000, marks=pytest.mark.long)])
def test_a_forged_consensus_is_refused_unless_no_motion_contradicts_it(count: int):
    rng, passed, false = random.Random(count), 0, 0
    for k in range(count):
        case = known(k % (6 if count < 1000 else 60))
        assert not contradicted(case.document, case)
        document = forged(case, rng)
        false += contradicted(document, case)
        outcome = checker.check(json.dumps(document).encode())
        if outcome.verified:
            passed += 1
            assert not contradicted(document, case), (document, k)

    assert false > count / 5
    assert passed > count / 25
