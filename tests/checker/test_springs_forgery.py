"""No forged certificate of general springs is accepted that is false."""

from __future__ import annotations

import json
import random
import time
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from springs_certified import certified
from springs_forgeries import dumped, holds, minimum_of, mutations, spurious_minima

from certreg.certificate.squares import sos_body
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.optimum import find_optimum

checker = import_module("certreg.verify")
CELLS = [("plane", 7, 0.1), ("plane", 20, 0.1), ("aniso", 3, 0.1), ("mixed", 6, 0.1)]
SECONDS = 2.0


def accepted(document) -> bool:
    start = time.process_time()
    outcome = checker.check(dumped(document))
    assert time.process_time() - start < SECONDS
    return outcome.verified


def clouds_of(*arrays):
    return checker.Clouds(*(tuple(np.asarray(array).ravel()) for array in arrays))


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("count", [80, pytest.param(500, marks=pytest.mark.long)])
@pytest.mark.parametrize("cell", CELLS, ids=str)
def test_a_mutated_certificate_is_refused_unless_it_is_true(cell, count):
    case = certified(*cell)
    best, document = minimum_of(case), json.loads(case.certificate.to_json())
    assert holds(document, case, best)
    forged = mutations(document, random.Random(count))
    passed = [one for one in (next(forged) for _ in range(count)) if accepted(one)]

    assert len(passed) < count / 5  # weaker claims, other lengths of the pose
    assert all(holds(one, case, best) for one in passed)


@pytest.mark.slow
@pytest.mark.parametrize("count", [5, pytest.param(100, marks=pytest.mark.long)])
def test_a_stable_wrong_pose_is_never_certified_as_the_optimum(count):
    offered = 0
    for seed in range(10 * count):
        case = certified.__wrapped__("plane", 7, 0.1, seed)
        found = find_optimum(case.objective)
        for wrong in spurious_minima(case):
            assert case.objective.energy(wrong) > case.objective.energy(found.quaternion)
            body = sos_body(case.objective, replace(found, quaternion=wrong))
            above = case.objective.energy(wrong) - case.objective.energy(found.quaternion)
            assert body is None or (body.gap > above and body.claims.unique is not True)
            document = json.loads(case.certificate.to_json())
            document["proof"]["pose"] = list(wrong)
            assert not accepted(document)
            if body is not None:  # a large gap, and no more
                document.update(body.to_fields())
                assert accepted(document)
                document["claims"]["gap"] = [above.numerator, -above.denominator.bit_length()]
                assert not accepted(document)
            offered += 1
            if offered == count:
                return
    pytest.fail(f"only {offered} wrong poses")


def test_a_bit_of_the_data_is_bound_by_the_digest():
    case = certified("plane", 20, 0.1)
    document = json.loads(case.certificate.to_json())
    for row, column in ((0, 0), (7, 1), (19, 3)):
        factors = case.problem.factors.copy()
        factors[row, column] *= -1.0  # a wrong sign bit in an L
        problem = RegistrationProblem(case.problem.source, case.problem.target, factors=factors)
        other = json.loads(dumped(document))
        other["problem"]["data"] = None
        clouds = clouds_of(problem.source, problem.target, factors)

        assert "digest" in checker.check(dumped(other), clouds).reason
        other["problem"]["digest"] = problem.digest()
        assert not checker.check(dumped(other), clouds).verified


def test_a_proof_of_some_of_the_planes_is_none_of_all():
    """A dropped quadratic: the sum of squares is of another objective."""
    case = certified("plane", 20, 0.1)
    part = RegistrationProblem(
        case.problem.source[1:], case.problem.target[1:], factors=case.problem.factors[1:]
    )
    document = json.loads(case.certificate.to_json())
    document["problem"] = {**document["problem"], "data": None, "digest": part.digest(), "n": 19}
    clouds = clouds_of(part.source, part.target, part.factors)

    assert "do not prove" in checker.check(dumped(document), clouds).reason


@pytest.mark.slow
def test_hostile_sizes_end_in_time():
    case = certified("plane", 20, 0.1)
    document = json.loads(case.certificate.to_json())
    huge = 10**4200
    for part, value in (
        ("pose", [huge, huge - 1, -huge, 3]),
        ("gram", [huge] * 20 + [0]),
        ("gram", [2**256 - 1] * 20 + [256]),
        ("level", huge),
        ("mu", huge),
        ("unit", -32768),
        ("unit", 32768),
        ("symmetry", [huge] * 6),
    ):
        accepted({**document, "proof": {**document["proof"], part: value}})
    wide = 10.0 ** np.random.default_rng(1).uniform(-100, 100, (2000, 12))
    clouds = clouds_of(wide[:, :3], wide[:, 3:6], wide[:, 6:])
    problem = RegistrationProblem(wide[:, :3], wide[:, 3:6], factors=wide[:, 6:])
    document["problem"] = {"data": None, "digest": problem.digest(), "n": 2000}
    start = time.process_time()
    outcome = checker.check(dumped(document), clouds)

    assert not outcome.verified
    assert time.process_time() - start < SECONDS
