"""Certificates of truncated squares: made, accepted, and of the form that is published."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rotated_pairs import rotated_pairs

from certreg.certificate.checking import verify
from certreg.certificate.truncated import truncated_certificate
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.relaxation.rotation_boxes import BoxSearch, search_boxes

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def stated(source, target, bounds) -> RegistrationProblem:
    return bounded(RegistrationProblem(source, target, rotation_only=True), bounds, Loss.TRUNCATED)


def solved(problem: RegistrationProblem) -> BoxSearch:
    return search_boxes(problem.source, problem.target, problem.bounds)


def produced(problem: RegistrationProblem, found: BoxSearch):
    return truncated_certificate(problem, found.quaternion, found.labels, found.gap)


@pytest.fixture(scope="module")
def problem() -> RegistrationProblem:
    given = rotated_pairs(np.random.default_rng(7), 20, 0.5)
    return stated(given.source, given.target, given.bounds)


@pytest.fixture(scope="module")
def certificate(problem: RegistrationProblem):
    return produced(problem, solved(problem))[0]


@pytest.mark.slow
def test_labels_and_the_angle_are_proved(problem: RegistrationProblem, certificate):
    found, verdict = solved(problem), verify(certificate)

    assert verdict.proved
    assert verdict.worth is not None
    assert verdict.worth.angle is not None
    assert certificate.body.claims.labels == "".join(map(str, found.labels))
    assert certificate.body.claims.unique
    assert verdict.worth.angle < 1e-6
    assert verdict.worth.share < 1e-8
    assert float(verdict.worth.objective) == pytest.approx(found.cost, abs=1e-12)
    assert found.cost - 1e-8 < float(verdict.worth.minimum) <= found.cost


@pytest.mark.slow
def test_equal_optima_have_open_labels_and_no_angle():
    x = np.eye(3)
    tie = stated(np.vstack([x, x]), np.vstack([x @ TURN.T, x @ TURN]), 0.25)

    made, verdict = produced(tie, solved(tie))

    assert verdict.proved
    assert made is not None
    assert made.body.claims.labels == "??1??1"
    assert made.body.claims.sin2_half_angle is None


@pytest.mark.slow
def test_a_circle_of_optima_is_certified_without_an_angle():
    x = np.outer([1.0, 2.0, -3.0], [0.0, 0.0, 1.0])
    line = stated(x, x, 0.25)

    made, verdict = produced(line, solved(line))

    assert verdict.proved
    assert made is not None
    assert (made.body.claims.labels, made.body.claims.unique) == ("111", False)


@pytest.mark.slow
def test_labels_that_are_wrong_are_never_certified(problem: RegistrationProblem):
    found = solved(problem)
    forged = replace(found, labels=np.where(np.arange(problem.n) == 3, 1, 0) ^ found.labels)

    made, verdict = produced(problem, forged)

    assert made is None
    assert not verdict.proved
    assert "too many boxes" in verdict.words


@pytest.mark.slow
def test_a_gap_that_is_too_small_is_widened(problem: RegistrationProblem):
    found = solved(problem)
    off = found.quaternion + np.array([1e-5, -2e-5, 1e-5, 0.0])

    made, verdict = produced(problem, replace(found, quaternion=off))

    assert verdict.proved
    assert made is not None
    assert made.body.gap > problem.n * 2.0**-30
