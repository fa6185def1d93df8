"""The rotation of least truncated squares is found, with the labels of all that are as good."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from rotated_pairs import rotated_pairs

from certreg.relaxation.rotation_boxes import BoundedPairs, search_boxes

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def best_of_all_fits(pairs: BoundedPairs) -> float:
    """The least cost over the fits of all sets of pairs: an optimum is the fit of its labels."""
    least, all_ = float(pairs.n), range(pairs.n)
    for size in range(1, pairs.n + 1):
        for rows in combinations(all_, size):
            chosen = np.isin(all_, rows)
            squares = pairs.squares(pairs.fit(chosen)[np.newaxis])[0]
            least = min(least, float(np.minimum(squares, 1.0).sum()))
    return least


@pytest.mark.slow
@pytest.mark.parametrize("wrong", [0.0, 0.4, 0.7])
def test_the_cost_is_that_of_an_exhaustive_search(wrong: float):
    given = rotated_pairs(np.random.default_rng(5), 9, wrong)
    found = search_boxes(given.source, given.target, given.bounds)
    pairs = BoundedPairs.of(given.source, given.target, given.bounds)

    assert found.complete
    assert found.cost == pytest.approx(best_of_all_fits(pairs), abs=1e-9)


def test_the_residuals_are_those_of_the_rotation():
    x = np.random.default_rng(1).normal(size=(5, 3))
    y, quarter = x @ TURN.T + 0.25, np.array([[2.0, 0.0, 0.0, 2.0]])
    pairs = BoundedPairs.of(x, y, np.full(5, 0.5))

    assert pairs.squares(quarter)[0] == pytest.approx(0.75)


def test_a_residual_in_a_box_keeps_to_its_slope():
    rng, half = np.random.default_rng(2), 0.25
    x, y = rng.normal(size=(2, 20, 3))
    pairs = BoundedPairs.of(x, y, np.ones(20))
    q = np.array([1.0, 0.5, -0.25, 0.75])
    near = q + half * rng.uniform(-1.0, 1.0, (200, 4)) * [0.0, 1.0, 1.0, 1.0]
    moved = np.abs(np.sqrt(pairs.squares(near)) - np.sqrt(pairs.squares(q[np.newaxis])))

    assert (moved <= half * pairs.slopes / np.linalg.norm(q)).all()
    assert (moved > 0.3 * half * pairs.slopes / np.linalg.norm(q)).any()


def test_labels_that_differ_between_equal_optima_are_open():
    x = np.eye(3)
    source, target = np.vstack([x, x]), np.vstack([x @ TURN.T, x @ TURN])

    found = search_boxes(source, target, np.full(6, 0.25))

    assert found.cost == pytest.approx(2.0, abs=1e-12)
    assert found.labels.tolist() == [-1, -1, 1, -1, -1, 1]
    assert not found.complete


def test_a_small_effort_leaves_labels_open():
    given = rotated_pairs(np.random.default_rng(3), 20, 0.5)

    few = search_boxes(given.source, given.target, given.bounds, effort=1e-4)

    assert not few.complete
    assert (few.labels == -1).any()
    assert few.gap > 1.0


@pytest.mark.slow
def test_bounds_of_a_millionth_of_the_points_are_no_hindrance():
    rng = np.random.default_rng(4)
    x = rng.normal(size=(12, 3))
    noisy = x @ TURN.T + 1e-7 * rng.normal(size=(12, 3))

    found = search_boxes(x, noisy, np.full(12, 5e-7))

    assert found.complete
    assert found.labels.tolist() == [1] * 12
