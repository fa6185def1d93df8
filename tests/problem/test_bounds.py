"""Bounds of residuals: one for all, one for each pair, or one line of what is wrong."""

from __future__ import annotations

import hashlib
import itertools
import math
from typing import Any

import numpy as np
import pytest

import certreg
from certreg.errors import InvalidProblemError
from certreg.problem.bounds import bounded, checked_bounds
from certreg.problem.losses import Squares
from certreg.problem.motion import Scale
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import PREFIXES, Cell, Loss, supported

HAS_BOUNDS = "the pairs of this problem have bounds: give the one that it was made of"
CLOUD = np.vstack([np.diag([3.0, 2.0, 1.0]), [1.0, 1.0, 1.0]])


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


SMALL = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]]  # in a box of diagonal 5
LARGE = [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 12.0]]  # 13


@pytest.mark.parametrize(
    ("source", "target", "scale", "half"),
    [
        (SMALL, LARGE, "none", 2.5),
        (LARGE, SMALL, "none", 2.5),
        (SMALL, LARGE, "asymmetric", 6.5),
        (LARGE, SMALL, "asymmetric", 2.5),
    ],
)
def test_a_bound_is_below_half_the_diameter_of_the_smaller_cloud(source, target, scale, half):
    """Of the target where the scale is free; of several bounds the least."""
    problem, below = RegistrationProblem(source, target, scale=scale), math.nextafter(half, 0.0)
    for bounds in (half, [half, 99.0, half], [99.0, half, 99.0]):
        least = " at least" if isinstance(bounds, list) else ""
        with pytest.raises(InvalidProblemError, match=f"is {half}{least}, not below") as refused:
            bounded(problem, bounds)
        assert (refused.value.value, refused.value.limit) == (half, half)
    for narrow in (below, [below, 99.0, 99.0], [99.0, 99.0, below]):
        assert bounded(problem, narrow).bounds.min() == below


def test_a_cloud_of_one_point_is_refused_and_one_that_repeats_a_point_is_not():
    one, two = [SMALL[1]] * 3, [SMALL[1], SMALL[1], SMALL[2]]
    for source, target, name in ((one, SMALL, "source"), (SMALL, one, "target")):
        with pytest.raises(InvalidProblemError, match=f"^all {name} points are one"):
            bounded(RegistrationProblem(source, target), 1.0)
    assert bounded(RegistrationProblem(two, SMALL), 1.0).n == 3


@pytest.mark.parametrize("scale", ["none", "asymmetric", "symmetric"])
def test_a_problem_with_bounds_is_one_of_the_same_arrays_and_a_digest_of_its_own(scale: str):
    problem = RegistrationProblem(2.0 * CLOUD, CLOUD, weights=[1.0, 2.0, 3.0, 4.0], scale=scale)
    kind = {"none": "", "asymmetric": "-similarity", "symmetric": "-similarity-symmetric"}[scale]

    found = bounded(problem, [0.125, 0.25, 0.25, 0.5])

    head = f"certreg-consensus{kind}/1\0".encode() + (4).to_bytes(8, "little")
    numbers = [*np.ravel(2.0 * CLOUD), *np.ravel(CLOUD), 1, 2, 3, 4, 0.125, 0.25, 0.25, 0.5]
    assert found.data_bytes() == head + np.array(numbers, dtype="<f8").tobytes()
    assert found.digest() == hashlib.sha256(found.data_bytes()).hexdigest() != problem.digest()
    assert found.source is problem.source
    assert found.of_rows(range(4)).digest() == found.under(Squares()).digest() == problem.digest()


def test_bounds_stand_before_the_factors_of_springs():
    problem = RegistrationProblem(CLOUD, CLOUD, normals=np.ones((4, 3)))
    factors = problem.block(slice(None)).springs

    found = bounded(problem, 0.25)

    head = b"certreg-consensus-springs/1\0" + (4).to_bytes(8, "little")
    numbers = [*np.ravel(CLOUD), *np.ravel(CLOUD), *[0.25] * 4, *factors.ravel()]
    assert found.data_bytes() == head + np.array(numbers, dtype="<f8").tobytes()


@pytest.mark.parametrize("loss", [Loss.CONSENSUS, Loss.TRUNCATED, Loss.BREAKING])
def test_a_problem_with_bounds_is_no_least_squares(loss: Loss):
    turned = loss is Loss.TRUNCATED
    found = bounded(RegistrationProblem(CLOUD, CLOUD, rotation_only=turned), 0.25, loss)

    for asked in (certreg.certify, certreg.equilibria, certreg.simulate):
        with pytest.raises(InvalidProblemError, match=HAS_BOUNDS):
            asked(found)
    with pytest.raises(InvalidProblemError, match=HAS_BOUNDS):
        certreg.assess(found, np.eye(4))
    assert (found.under(Squares()).bounds == np.inf).all()


def test_a_certificate_is_verified_beside_the_problem_that_it_is_about():
    cloud = np.vstack([CLOUD, [[2.0, 1.0, 0.5], [5.0, 5.0, 5.0]]])
    moved = cloud + np.eye(1, 6, -5).T * 3.0
    result: Any = certreg.certify(cloud, moved, max_residual=0.25)

    assert certreg.verify(result.certificate, result.problem).proved
    assert not certreg.verify(result.certificate, result.problem.under(Squares())).proved


def test_every_cell_that_is_supported_has_a_prefix_of_its_own():
    cells = [Cell(*of) for of in itertools.product((False, True), Scale, (False, True), Loss)]

    held = {cell for cell in cells if supported(cell)}
    assert held == set(PREFIXES)
    assert len(set(PREFIXES.values())) == len(PREFIXES)
