"""Bounds of residuals: one for all, one for each pair, or one line of what is wrong."""

from __future__ import annotations

import numpy as np
import pytest

from certreg.errors import InvalidProblemError
from certreg.problem.bounds import checked_bounds


def test_one_bound_is_that_of_all():
    assert checked_bounds(0.5, 3).tolist() == [0.5, 0.5, 0.5]


def test_every_pair_has_its_own():
    assert checked_bounds([1, 2, 3], 3).tolist() == [1.0, 2.0, 3.0]


def test_the_bounds_are_nobody_elses():
    given = np.array([1.0, 2.0])
    bounds = checked_bounds(given, 2)
    given[0] = 7.0

    assert bounds.tolist() == [1.0, 2.0]
    assert not bounds.flags.writeable
    assert not checked_bounds(1.0, 2).flags.writeable


@pytest.mark.parametrize(
    ("given", "row", "words"),
    [
        (0.0, None, "max_residual is 0.0: a bound must be finite and > 0"),
        (-1, None, "max_residual is -1: a bound must be finite and > 0"),
        (float("nan"), None, "max_residual is nan: a bound must be finite and > 0"),
        ([1.0, 1.0, 0.0], 2, r"max_residual\[2\] is 0.0: a bound must be finite"),
        ([1.0, float("inf"), 0.0], 1, r"max_residual\[1\] is inf: a bound must be finite"),
        ([1.0, 2.0], None, r"max_residual has shape \(2,\): give one number, or \(3,\), one for"),
        ([[1.0], [2.0], [3.0]], None, r"max_residual has shape \(3, 1\): give one number"),
        ("far", None, "max_residual has entries of type"),
    ],
)
def test_what_bounds_nothing_is_refused_with_its_row(given: object, row: int | None, words: str):
    with pytest.raises(InvalidProblemError, match=words) as refused:
        checked_bounds(given, 3)

    assert refused.value.row == row
    assert refused.value.array == "max_residual"
