"""Label sets that no optimum has are disproved; that of the optimum never is."""

from __future__ import annotations

from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.certificate import truncated
from certreg.certificate.truncated import disproves_labels
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.verify import PRODUCTS, UNITS

AXES = np.vstack([np.eye(3), -np.eye(3)]) * [3.0, 2.0, 1.0]


@pytest.fixture(scope="module")
def problem() -> RegistrationProblem:
    target = AXES.copy()
    target[5] = [1.0, 1.0, 0.0]
    return bounded(RegistrationProblem(AXES, target, rotation_only=True), 0.5, Loss.TRUNCATED)


def test_the_labels_of_the_optimum_are_not_disproved(problem: RegistrationProblem):
    assert not disproves_labels(problem, [True] * 5 + [False], [2, 0, 0, 0])


def test_fewer_pairs_and_pairs_that_no_rotation_brings_together_are(problem: RegistrationProblem):
    assert disproves_labels(problem, [True] * 4 + [False] * 2, [1, 0, 0, 0])
    assert disproves_labels(problem, [True] * 6, [1, 0, 0, 0])


def test_all_sets_but_one_are_disproved_beside_the_optimum(problem: RegistrationProblem):
    sets = product([True, False], repeat=6)

    left = [each for each in sets if not disproves_labels(problem, each, [1, 0, 0, 0])]
    assert left == [(True,) * 5 + (False,)]


def test_beside_a_poor_rotation_little_is_disproved(problem: RegistrationProblem):
    assert not disproves_labels(problem, [True] * 4 + [False] * 2, [0, 1, 0, 0])


@pytest.mark.parametrize(
    ("bound", "disproved"),
    [(np.nextafter(6.0, 5.0), False), (6.0, False), (np.nextafter(6.0, 7.0), True)],
)
def test_labels_of_a_rotation_that_costs_as_much_are_not_disproved(bound: float, disproved):
    """Two pairs fit a rotation that leaves the third out: it costs 1, as three thirds do.

    A third is no number of 64 bits: rounded down, three of them are less than 1.
    """
    source = np.array([[-3.0, 0.0, 0.0], [0.0, -3.0, 0.0], [10.0, 0.0, 0.0]])
    points = RegistrationProblem(source, source + 2.0, rotation_only=True)
    problem = bounded(points, bound, Loss.TRUNCATED)
    turn = np.array([[1, -2, 2], [-2, 1, 2], [-2, -2, -1]]) / 3
    off = np.linalg.norm(source @ turn.T - source - 2.0, axis=1)

    np.testing.assert_allclose(off[:2], 0.0, atol=1e-12)
    assert off[2] > bound
    assert disproves_labels(problem, [True, True, False], [1, 0, 0, 0]) is disproved


ONE = 1 << UNITS
IDENTITY = [1, 0, 0, 0]


def disproved(monkeypatch, forms: list[list[int]], within: list[bool], q: list[int]) -> bool:
    """For pairs whose costs are these forms, in units, by diagonals."""
    full = [[d[i] * (i == j) for i, j in PRODUCTS] for d in forms]
    rows = list(range(len(forms)))
    monkeypatch.setattr(truncated, "bounded_pairs", lambda *_: (rows, None))
    monkeypatch.setattr(truncated, "form_of", lambda row: (full[row], None))
    fake: Any = SimpleNamespace(n=len(forms), data_bytes=bytes)
    return disproves_labels(fake, within, q)


@pytest.mark.parametrize("least", [0, 1000])
def test_a_cost_is_rounded_up_and_six_units_more(monkeypatch, least: int):
    """At (1, 1, 0, 0) the first pair costs least + 1/2: with both roundings least + 7."""
    first = [least, least + 1, least, least]

    def at(second: int) -> bool:
        return disproved(monkeypatch, [first, [second] * 4], [True, False], [1, 1, 0, 0])

    assert at(ONE - 14)
    assert not at(ONE - 13)


def test_where_all_pairs_are_left_out_a_rotation_that_saves_one_unit_disproves(monkeypatch):
    def at(cost: int) -> bool:
        return disproved(monkeypatch, [[cost] * 4, [ONE] * 4], [False, False], IDENTITY)

    assert at(ONE - 7)
    assert not at(ONE - 6)
    assert not at(2 * ONE)
