"""Label sets that no optimum has are disproved; that of the optimum never is."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from certreg.certificate.label_sets import disproves_labels
from certreg.problem import RegistrationProblem, TruncatedProblem

AXES = np.vstack([np.eye(3), -np.eye(3)]) * [3.0, 2.0, 1.0]


@pytest.fixture(scope="module")
def problem() -> TruncatedProblem:
    target = AXES.copy()
    target[5] = [1.0, 1.0, 0.0]
    return TruncatedProblem(RegistrationProblem(AXES, target, rotation_only=True), 0.5)


def test_the_labels_of_the_optimum_are_not_disproved(problem: TruncatedProblem):
    assert not disproves_labels(problem, [True] * 5 + [False], [2, 0, 0, 0])


def test_fewer_pairs_and_pairs_that_no_rotation_brings_together_are(problem: TruncatedProblem):
    assert disproves_labels(problem, [True] * 4 + [False] * 2, [1, 0, 0, 0])
    assert disproves_labels(problem, [True] * 6, [1, 0, 0, 0])


def test_all_sets_but_one_are_disproved_beside_the_optimum(problem: TruncatedProblem):
    sets = product([True, False], repeat=6)

    left = [each for each in sets if not disproves_labels(problem, each, [1, 0, 0, 0])]
    assert left == [(True,) * 5 + (False,)]


def test_beside_a_poor_rotation_little_is_disproved(problem: TruncatedProblem):
    assert not disproves_labels(problem, [True] * 4 + [False] * 2, [0, 1, 0, 0])
