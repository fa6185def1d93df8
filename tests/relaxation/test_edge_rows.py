"""Rows on the edge of their bounds: kept by a pose that is not that of least squares.

Rows of one source point ask where the centre of a ball is that holds most targets.
"""

from __future__ import annotations

import numpy as np
import pytest
from wrong_pairs import wrong_pairs

from certreg.relaxation.edge_rows import exchanged, grown, held, lawson_fits, widened
from certreg.relaxation.paired_rows import fitted, paired_rows, squared_ratios


def on_a_line(*places):
    target = np.zeros((len(places), 3))
    target[:, 0] = places
    return paired_rows(np.zeros_like(target), target, np.ones(len(places)))


def begun(pairs, rows):
    return held(pairs, fitted(pairs, np.isin(np.arange(len(pairs)), rows) * pairs.precisions))


def test_refits_gain_rows_until_there_are_no_more():
    pairs = on_a_line(0.0, 0.7, 1.2, 1.6)

    assert grown(pairs, begun(pairs, [0])).count == 4


def test_a_row_joins_that_least_squares_leaves_outside():
    pairs = on_a_line(*[0.0] * 9, 1.9)
    start = grown(pairs, begun(pairs, range(10)))

    assert (start.count, widened(pairs, start).count) == (9, 10)


def test_a_row_that_does_not_fit_stays_outside():
    pairs = on_a_line(*[0.0] * 9, 2.1)
    start = begun(pairs, range(9))

    assert exchanged(pairs, widened(pairs, start)).count == 9


def test_two_rows_come_for_one():
    pairs = on_a_line(-0.9, 0.0, 0.0, 0.0, 0.0, 1.15, 1.2)
    start = widened(pairs, grown(pairs, begun(pairs, range(5))))

    assert start.count == 5
    assert exchanged(pairs, start).within.tolist() == [False] + 6 * [True]


def test_where_no_row_is_within_its_bound_the_nearest_is_taken():
    pairs = on_a_line(0.0, 10.0, 26.0)
    start = begun(pairs, range(3))

    assert start.count == 0
    assert grown(pairs, start).within.tolist() == [False, True, False]


@pytest.mark.parametrize("seed", range(3))
def test_a_set_is_given_up_only_where_weights_show_that_it_does_not_fit(seed):
    """No pose has a weighted mean of squared ratios below that of its own least-squares pose."""
    made = wrong_pairs(np.random.default_rng(seed), 30, 0.5)
    pairs = paired_rows(made.source, made.target, made.bounds)
    sets = np.array([made.true | (np.arange(30) == row) for row in np.flatnonzero(~made.true)])
    fits = lawson_fits(pairs, sets)

    least = squared_ratios(pairs, fitted(pairs, fits.weights * pairs.precisions))
    lower = (fits.weights * least).sum(axis=1)
    fit = fits.largest <= 1.0
    np.testing.assert_allclose(fits.weights.sum(axis=1), 1.0)
    assert (fits.weights[~sets] == 0.0).all()
    assert (lower[~fit] > 1.0).all()
    reached = np.where(sets, squared_ratios(pairs, fits.poses), 0.0).max(axis=1)
    np.testing.assert_array_equal(reached, fits.largest)
