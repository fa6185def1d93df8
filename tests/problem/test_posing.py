"""The pose by one call into C: that of the long way, where nothing stands against it."""

from __future__ import annotations

import ctypes
import math
from itertools import chain
from typing import Any

import numpy as np
import pytest
import strategies
from hypothesis import given, settings
from hypothesis import strategies as st

import certreg
from certreg.errors import CertregError
from certreg.geometry.so3 import davenport_matrix
from certreg.native.library import library_if_any
from certreg.problem import posing
from certreg.problem.posing import floating_pose
from certreg.registration import closed_form

pytestmark = pytest.mark.skipif(library_if_any() is None, reason="no compiled library")
NEAR = 1e-13  # radians, and of the clouds' size: both ways lose less
CLOUD = np.random.default_rng(1).normal(size=(40, 3))


def the_long_way(monkeypatch: Any) -> None:
    monkeypatch.setattr(closed_form, "floating_pose", lambda *_, **__: None)


def answer(*arrays: Any) -> Any:
    """The pose, or the refusal in words."""
    try:
        return certreg.register(*arrays)
    except CertregError as error:
        return f"{type(error).__name__}: {error}"


def agree(one: Any, other: Any, size: float, near: float = NEAR) -> bool:
    if isinstance(one, str) or isinstance(other, str):
        return one == other
    turned = np.abs(one.quaternion_wxyz - other.quaternion_wxyz).max()
    flat = np.abs(one.rotation - other.rotation).max()
    return max(turned, flat) < near and bool(
        (np.abs(one.translation - other.translation) <= near * size).all()
    )


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(strategies.problems())
def test_over_the_whole_zoo_both_ways_give_one_answer(problem):
    arrays = (problem.source, problem.target, problem.weights)
    found, short = floating_pose(*arrays), answer(*arrays)
    near = NEAR
    if found is not None and found.gap > found.error:
        near = max(NEAR, 4.0 * found.error / found.gap)
    with pytest.MonkeyPatch.context() as patch:
        the_long_way(patch)
        size = max(np.abs(problem.source).max(), np.abs(problem.target).max())

        assert agree(short, answer(*arrays), size, near)


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 99), st.sampled_from([1, 2, 3, 7, 31, 32, 33, 65, 256, 300]), st.booleans())
def test_every_layout_gives_the_same_pose(seed, n, weighted):
    rng = np.random.default_rng(seed)
    x, y = rng.normal(size=(2, n, 3)).astype(np.float32)
    w = rng.uniform(0.1, 2.0, size=n) if weighted else None
    wide = np.zeros((2 * n, 5))
    wide[::2, 1:4] = x
    poses = [answer(a, y.astype(float), w) for a in (x, x.astype(float), wide[::2, 1:4])]
    poses.append(answer(np.asfortranarray(x.astype(float)), y, w))

    for pose in poses:
        assert agree(pose, poses[0], 10.0, 1e-6 if n < 4 else NEAR)


def few_far(x: Any) -> Any:
    """Many points, of which those that are looked at first are far from all others."""
    many = np.tile(x, (10, 1))
    many[:: len(many) // 32] += 1e6
    return many


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda x, _: (np.where(x == x.max(), np.nan, x), None), "not a number"),
        (lambda x, _: (np.where(x == x.max(), np.inf, x), None), "infinite"),
        (lambda x, _: (x * 1e150, None), "squares beyond the doubles"),
        (lambda x, _: (x * 1e-150, None), "squares below them"),
        (lambda x, _: (few_far(x), None), "a mean far from that of a few points"),
        (lambda x, w: (x, w * -1.0), "weights below zero"),
        (lambda x, w: (x, w * 0.0), "no weight"),
        (lambda x, _: (x.astype(np.float16), None), "a type that is not read"),
    ],
)
def test_what_is_unusual_is_left_to_the_long_way(change, why):
    x, w = change(CLOUD, np.ones(len(CLOUD)))

    assert floating_pose(x, np.array(x, dtype=float), w) is None, why


def test_an_ordinary_pair_is_not_left_to_the_long_way():
    found = floating_pose(CLOUD, CLOUD + 1.0, np.ones(len(CLOUD)))

    assert found is not None
    assert found.pose.translation == pytest.approx([1.0] * 3)
    assert 0.0 < found.error < 1e-9 * found.gap


def test_a_gap_that_rounding_may_close_is_refused_in_the_words_of_the_long_way(monkeypatch):
    line = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])
    short = answer(line, line)
    the_long_way(monkeypatch)

    assert short == answer(line, line)
    assert short.startswith("DegenerateProblemError")


def test_without_a_library_a_pose_takes_the_long_way(monkeypatch):
    monkeypatch.setattr(posing, "_posed", lambda: None)

    assert floating_pose(CLOUD, CLOUD, None) is None
    assert certreg.register(CLOUD, CLOUD).quaternion_wxyz[0] == pytest.approx(1.0)


def by_one_call(*arrays: Any, about_origin: int = 0) -> Any:
    """What the call writes: a pose, then what decides whether it is one."""
    content: Any = posing._Numbers()
    points = posing.CloudPoints(
        len(arrays[0]), *chain.from_iterable(map(posing.columns_of, arrays))
    )
    posing._posed()(ctypes.byref(points), ctypes.c_int(about_origin), ctypes.byref(content))
    return np.frombuffer(content)


@pytest.mark.parametrize("n", [20, 100])
def test_the_numbers_that_decide_are_what_they_are_called(n):
    rng = np.random.default_rng(n)
    x, y, w = rng.normal(size=(n, 3)) + 3.0, rng.normal(size=(n, 3)) - 2.0, rng.uniform(1, 9, n)
    a, b = (p - p[:: max(1, n // 32)].mean(axis=0) for p in (x, y))  # shifted by a few points' mean
    cross = (y - w @ y / w.sum()).T @ (w[:, None] * (x - w @ x / w.sum()))
    davenport = np.array(davenport_matrix(cross.tolist()))
    *_, second, first = np.linalg.eigvalsh(davenport)
    told = [
        *(w.sum(), (w @ a) @ (w @ a), w @ (a * a).sum(axis=1)),
        *((w @ b) @ (w @ b), w @ (b * b).sum(axis=1)),
        *(first - second, np.linalg.norm(davenport)),
    ]

    numbers = by_one_call(x, y, w)
    *found, residual = numbers[posing.DECIDING]

    np.testing.assert_allclose(found, told, rtol=1e-11)
    np.testing.assert_allclose(numbers[posing.CROSS].reshape(3, 3), cross, rtol=1e-11, atol=1e-12)
    assert 0.0 < residual < 1e-13 * told[-1]
    for mean, cloud in ((posing.SOURCE_MEAN, x), (posing.TARGET_MEAN, y)):
        np.testing.assert_allclose(numbers[mean], w @ cloud / w.sum(), rtol=1e-13)
    shown = floating_pose(x, y, w)
    assert shown is not None
    for spread, cloud in zip(shown.spreads, (x, y), strict=True):
        off = cloud - w @ cloud / w.sum()
        np.testing.assert_allclose(spread, w @ (off * off).sum(axis=1), rtol=1e-12)


def test_about_the_origin_sums_are_not_about_the_means_and_nothing_is_shifted():
    rng = np.random.default_rng(3)
    x, y, w = rng.normal(size=(30, 3)) + 3.0, rng.normal(size=(30, 3)) - 2.0, rng.uniform(1, 9, 30)
    numbers = by_one_call(x, y, w, about_origin=1)
    shown = floating_pose(x, y, w, about_origin=True)

    cross = (w[:, None] * y).T @ x
    np.testing.assert_allclose(numbers[posing.CROSS].reshape(3, 3), cross, rtol=1e-13)
    for mean in (posing.SOURCE_MEAN, posing.TARGET_MEAN, posing.TRANSLATION):
        assert numbers[mean].tolist() == [0.0] * 3
    assert shown is not None
    sizes = [w @ (cloud * cloud).sum(axis=1) for cloud in (x, y)]
    np.testing.assert_allclose(shown.spreads, sizes, rtol=1e-13)


def test_what_rounding_takes_from_the_sum_of_each_block_is_added_at_the_end():
    weights = np.r_[
        np.full(256, 2.0**60), np.full(256 * 40, 2.0**6.8)
    ]  # each block under half an ulp
    cloud = np.random.default_rng(0).normal(size=(len(weights), 3))

    mass = by_one_call(cloud, cloud, weights)[posing.DECIDING][0]

    assert abs(mass - math.fsum(weights)) <= math.ulp(mass)
    assert mass > 2.0**68 + 2.0**16
