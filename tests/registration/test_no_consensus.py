"""What is said where a problem has no answer: the true cause, and a remedy that is one."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import certreg
from certreg.errors import InvalidProblemError, UndecidedError
from certreg.exact.decimals import at_least, at_most
from certreg.registration.truncated import nothing_turned

RNG = np.random.default_rng(4)
CLOUD = RNG.uniform(-1.0, 1.0, (12, 3))
AWAY = CLOUD + np.array([9.0, 0.0, 0.0])
TILT = np.array([[2.0, 1.0, 2.0], [-2.0, 2.0, 1.0], [-1.0, -2.0, 2.0]]) / 3.0
ONE = np.tile([1.0, 2.0, 3.0], (12, 1))
TRUNCATED: dict[str, Any] = {"rotation_only": True, "objective": "truncated"}


def certified(source: Any, target: Any, bound: Any, **options: Any) -> Any:
    return certreg.certify(source, target, max_residual=bound, **options)


def refusal(source: Any, target: Any, bound: Any, **options: Any) -> str:
    """The one line."""
    with pytest.raises((InvalidProblemError, UndecidedError)) as refused:
        certified(source, target, bound, **options)
    return str(refused.value)


@pytest.mark.parametrize("model", [{}, {"scale": "asymmetric"}, {"scale": "symmetric"}])
@pytest.mark.parametrize("bound", [1e-6, 0.1, 10.0])
def test_a_cloud_of_one_point_is_refused_whatever_the_bound(bound: float, model):
    for name, source, target in (("source", ONE, CLOUD), ("target", CLOUD, ONE)):
        words = refusal(source, target, bound, **model)

        assert words.startswith(f"all {name} points are one, which tells no rotation from another")
        assert "bound" not in words


def test_a_bound_that_every_rotation_keeps_is_refused():
    sizes = np.linalg.norm(CLOUD, axis=1)
    most = 2.0 * float(sizes.max())
    words = refusal(CLOUD, CLOUD, 1.001 * most, **TRUNCATED)

    assert f"the points of any pair farther apart than {at_most(most, 6)}: each pair" in words
    assert certified(CLOUD, CLOUD, 0.999 * most, **TRUNCATED).exit_code == 0
    one = np.where(np.arange(12) == 3, 0.999, 1.001) * 2.0 * sizes  # of one pair it says something
    assert certified(CLOUD, CLOUD, one, **TRUNCATED).labels_unique
    assert "farther apart" in refusal(CLOUD, CLOUD, (2.002 * sizes).tolist(), **TRUNCATED)


def test_the_bound_that_is_advised_is_taken():
    words = refusal(CLOUD, 2.0 * CLOUD, 50.0, **TRUNCATED)
    limit = float(re.findall(r"farther apart than (\S+):", words)[0])

    assert certified(CLOUD, 2.0 * CLOUD, 0.99 * limit, **TRUNCATED).inliers.size


def test_points_at_the_origin_are_turned_by_no_rotation():
    words = refusal(0.0 * CLOUD, 0.0 * CLOUD, 0.1, **TRUNCATED)

    assert words == "all points are at the origin, where no rotation moves them: give other points"


def test_lengths_that_differ_are_not_said_to_differ_by_more_than_rounding_leaves():
    """Of lengths 3 and 8, each rounded, no more is known than that they differ by almost 5."""
    words = refusal(3.0 * np.eye(3), 8.0 * np.eye(3), 0.1, **TRUNCATED)

    assert "that differ by 4.99 or more." in words


def test_pairs_whose_lengths_differ_are_within_at_no_rotation():
    words = refusal(CLOUD, AWAY, 0.1, **TRUNCATED)
    least = np.abs(np.linalg.norm(CLOUD, axis=1) - np.linalg.norm(AWAY, axis=1))

    assert words.startswith("no rotation brings a pair within its bound: the two points of each")
    assert f"that differ by {at_least(least.min())} or more." in words
    assert "leave out --rotation-only and --objective truncated;" in words


def test_clouds_in_two_units_are_told_of_the_scale():
    words = refusal(CLOUD, 1000.0 * CLOUD, 0.01)

    assert words.startswith(
        "no rigid motion brings 3 pairs within their bounds: no three of them keep their "
        "distances from each other."
    )
    assert "give --scale asymmetric" in words
    scaled = certified(CLOUD, 1000.0 * CLOUD, 0.01, scale="asymmetric")
    assert scaled.exit_code == 0


def test_with_a_free_scale_it_is_not_advised():
    words = refusal(CLOUD, RNG.uniform(-1.0, 1.0, (12, 3)), 1e-6, scale="asymmetric")

    assert words == (
        "no motion with a scale was found that brings 3 pairs within their bounds: all may be "
        "wrong; if right ones may be farther off, give wider bounds, else more --effort"
    )


def test_where_only_rounding_hides_a_rotation_none_is_said_to_be_ruled_out():
    source, target = CLOUD, CLOUD @ TILT.T
    sizes = [np.hypot.reduce(points, axis=1) for points in (source, target)]
    rounded = np.abs(sizes[0] - sizes[1]) > 1e-17
    words = refusal(source[rounded], target[rounded], 1e-17, effort=0.01, **TRUNCATED)

    assert words == (
        "no rotation was found that brings a pair within its bound: give more --effort, or "
        "wider bounds if right pairs may be farther off"
    )


def test_where_one_pair_may_be_within_its_bound_it_is_not_said_that_none_is():
    """Of lengths 1 and 2 beside 1.5: off by 0.5 each, and bounds on both sides of that."""
    for bounds, said in (
        ((0.6, 0.4), "no rotation was found that"),
        ((0.4, 0.6), "no rotation was found that"),
        ((0.5, 0.4), "no rotation was found that"),
        ((0.5 - 2.5 * 2.0**-48, 0.4), "no rotation was found that"),  # at what rounding leaves
        ((0.5 - 2.6 * 2.0**-48, 0.4), "no rotation brings a pair within its bound"),
        ((0.4, 0.49), "no rotation brings a pair within its bound"),
    ):
        problem: Any = SimpleNamespace(
            source=np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]),
            target=np.array([[0.0, 0.0, 1.5], [1.5, 0.0, 0.0]]),
            bounds=np.array(bounds),
        )

        assert nothing_turned(problem).startswith(said), bounds
