"""No forged list of equilibria is accepted that is false."""

from __future__ import annotations

import copy
import json
import random
import time
from fractions import Fraction
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from list_boundaries import (
    Listed,
    good,
    listed,
    other,
    remember_forty,
    six_planes,
    with_lines,
)
from springs_forgeries import dumped, mutations, number

from certreg.certificate.envelope import body_of
from certreg.problem.problem import RegistrationProblem

checker = import_module("certreg.verify")
SECONDS = 2.0
NEAR = Fraction(1, 10**17)  # sine of an angle: the true lines are known to 2^-64


@pytest.fixture
def remembering(monkeypatch: pytest.MonkeyPatch):
    """Of forms that many lists share it is decided once whether they have forty lines."""
    monkeypatch.setattr(checker, "are_forty", checker.are_forty)
    remember_forty(checker)


def accepted(document) -> bool:
    start = time.process_time()
    outcome = checker.check(dumped(document))
    assert time.process_time() - start < SECONDS
    return outcome.verified


def is_true(document, case: Listed) -> bool:
    """Whether what is claimed is true of the data of the case, whose own list is right."""
    body: Any = body_of(document)
    known = list(zip(case.quaternions, case.certificate.body.claims.indices, strict=True))
    left, energies = list(known), list[Fraction]()
    for q, index in zip(body.quaternions, body.claims.indices, strict=True):
        near = [one for one in left if sine_squared(q, one[0]) < NEAR**2]
        if len(near) != 1 or near[0][1] != index:
            return False
        left.remove(near[0])
        energies.append(case.objective.energy(near[0][0]))
    slack = case.objective.oscillation * NEAR
    least = min(energies)
    at_pose = case.objective.energy(document["proof"]["pose"])
    claims = document["claims"]
    true = not left and number(claims["gap"]) > at_pose - least - slack
    true = true and number(claims["second"]) < min(energies[1:]) + slack
    return true and (claims["unique"] is None or energies[0] == least < min(energies[1:]))


def sine_squared(p, q) -> Fraction:
    """Of the angle between two lines."""
    norms = sum(a * a for a in p) * sum(a * a for a in q)
    return 1 - Fraction(sum(a * b for a, b in zip(p, q, strict=True)) ** 2, norms)


@pytest.mark.slow
@pytest.mark.parametrize("count", [4, pytest.param(1200, marks=pytest.mark.long)])
@pytest.mark.usefixtures("remembering")
def test_a_mutated_list_is_refused_unless_it_is_true(count):
    case = listed()
    assert is_true(case.document, case)
    forged = mutations(case.document, random.Random(count))
    passed = [one for one in (next(forged) for _ in range(count)) if accepted(one)]

    assert len(passed) < count / 2  # a unit of the last place, weaker claims, another modulus
    assert all(is_true(one, case) for one in passed)


def structural(rng: random.Random, document):
    """A list of which lines are left out, doubled, swapped, turned or moved, and its claims."""

    def change(rows):
        i, j = rng.sample(range(len(rows)), 2)
        way = rng.randrange(8)
        if way == 0:
            del rows[i]
        elif way == 1:
            rows[j] = rows[i]
        elif way == 2:
            rows[j] = [(-1) ** k * entry for k, entry in enumerate(rows[i])]
        elif way == 3:
            rows[j] = [entry + rng.randrange(-3, 4) for entry in rows[i]]
        elif way == 4:
            rows[j] = [entry * (k % 2 == 0) for k, entry in enumerate(rows[j])]
        elif way == 5:
            rows[i][rng.randrange(6)] += rng.choice((-1, 1)) << rng.randrange(1, 70)
        elif way == 6:
            rows.append([entry + (1 << 60) for entry in rows[i]])
        else:
            rows[i], rows[j] = rows[j], rows[i]

    forged = with_lines(change, document)
    if rng.random() < 0.4:
        indices = forged["claims"]["indices"]
        rng.choice((rng.shuffle, lambda k: k.pop(), lambda k: k.append(0)))(indices)
    return forged


@pytest.mark.slow
@pytest.mark.parametrize("count", [6, pytest.param(600, marks=pytest.mark.long)])
@pytest.mark.usefixtures("remembering")
def test_a_list_with_lines_left_out_doubled_or_moved_is_refused_unless_it_is_true(count):
    rng, passed = random.Random(count), 0
    for k in range(count):
        case = (listed(), six_planes())[k % 2]
        forged = structural(rng, case.document)
        if accepted(forged):
            assert is_true(forged, case)
            passed += 1

    assert passed < count / 4


def test_a_list_of_other_data_is_refused():
    case = listed()
    for row, column in ((0, 0), (6, 3)):
        factors = np.array(case.problem.factors)
        factors[row, column] += 1e-9
        near = RegistrationProblem(case.problem.source, case.problem.target, factors=factors)
        document = other()
        document["problem"] = {**document["problem"], "data": None}
        arrays = (near.source, near.target, factors)
        clouds = checker.Clouds(*(tuple(np.asarray(array).ravel()) for array in arrays))

        assert "digest" in checker.check(dumped(document), clouds).reason
        document["problem"]["digest"] = near.digest()
        assert "box" in checker.check(dumped(document), clouds).reason


@pytest.mark.slow
def test_hostile_sizes_end_in_time():
    huge = 10**4200
    for entries in (
        {"bits": 256, "lines": [2**511 + k for k in range(240)]},
        {"lines": [huge] * 240},
        {"lines": [2**512 - 1 - 3 * k * (k % 2) for k in range(240)]},
        {"chart": [huge] * 4},
        {"chart": [2**16, -(2**16), 2**16 - 1, 1], "modulus": 2**62 - 57},
        {"modulus": huge},
        {"pose": [huge, huge - 1, -huge, 3]},
        {"indices": [0] * 40},
    ):
        assert not accepted(other(**entries))
    document = copy.deepcopy(good())
    wide = np.random.default_rng(1).standard_normal((2, 3, 3)) * 2.0 ** np.arange(-360, 0, 120)
    factors = np.random.default_rng(2).standard_normal((3, 6)) * 2.0 ** np.arange(-360, 360, 120)
    problem = RegistrationProblem(*wide, factors=factors)
    document["problem"] = {"data": None, "digest": problem.digest(), "n": 3}
    arrays = (problem.source, problem.target, problem.factors)
    clouds = checker.Clouds(*(tuple(np.asarray(array).ravel()) for array in arrays))
    start = time.process_time()

    assert not checker.check(json.dumps(document).encode(), clouds).verified
    assert time.process_time() - start < SECONDS
