"""Shifts that the springs hardly resist: said at once, with how little that rests on."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from springs_certified import moved_springs

from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.weak_shifts import HARDLY, weak_shift_words, weak_shifts
from certreg.report.document import result_document

STAMP = "CERTIFIED, BUT A SHIFT IS HARDLY RESISTED: "
AXIS = np.array([2.0, -1.0, 2.0]) / 3


def springs_of(normals: list[list[float]]) -> Springs:
    points = np.random.default_rng(0).integers(-9, 10, (len(normals), 3)).astype(float)
    return Springs.of(RegistrationProblem(points, points, normals=normals))


def one_across(e: float) -> list[list[float]]:
    """Eight normals across the last axis, and one of length e along it: tr S = 8 + e^2."""
    return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] * 4 + [[0.0, 0.0, e]]


def corridor(share: float) -> RegistrationProblem:
    """A cloud, and planes whose normals are across `AXIS` but for a share of them."""
    rng = np.random.default_rng(5)
    source, normals = rng.normal(size=(2, 60, 3))
    normals -= np.outer(normals @ AXIS, AXIS)
    normals /= np.linalg.norm(normals, axis=1)[:, np.newaxis]
    normals += share * np.outer(rng.choice([-1.0, 1.0], 60), AXIS)
    target = source + 0.01 * rng.normal(size=(60, 3))
    return RegistrationProblem(source, target, normals=normals)


@cache
def registered(share: float) -> Any:
    return certify(corridor(share))


def test_the_limit_is_met_from_inside_and_not_from_outside():
    squared = 8 * HARDLY**2 / (1 - HARDLY**2)  # e^2 with e^2 = HARDLY^2 (8 + e^2)
    inside = outside = math.sqrt(squared)
    while Fraction(inside) ** 2 > squared:
        inside = math.nextafter(inside, 0.0)
    while Fraction(outside) ** 2 <= squared:
        outside = math.nextafter(outside, 1.0)

    (found,) = weak_shifts(springs_of(one_across(inside)))
    assert found.direction.tolist() == [0.0, 0.0, 1.0]
    assert found.share == pytest.approx(float(HARDLY), rel=1e-12)
    assert weak_shifts(springs_of(one_across(outside))) == ()


def test_a_share_that_is_the_limit_is_called_weak():
    """tr S = 10^12, of which 1 resists: 999999^2 + 1414^2 + 24^2 + 5^2 + 1 + 1."""
    across = [[0.0, length, 0.0] for length in (1414.0, 24.0, 5.0, 1.0)]
    for last, weak in ((1.0, 1), (math.nextafter(1.0, 2.0), 0)):
        springs = springs_of([[999999.0, 0.0, 0.0], *across, [0.0, 0.0, last]])
        assert len(weak_shifts(springs)) == weak


def test_springs_changed_by_the_share_leave_the_shift_free_exactly():
    e = 2.0**-30
    springs = springs_of(one_across(e))
    (found,) = weak_shifts(springs)

    assert springs.free_translations == ()
    assert springs_of(one_across(0.0)[:-1]).free_translations == ((0, 0, 1),)
    changed, size = e, math.sqrt(8 + e**2)  # root of the sums of squares: only one is changed
    assert changed / size <= found.share <= changed / size * (1 + 1e-14)


def test_the_share_is_the_next_double_above_the_exact_one():
    """Nearest ones are below it half of the time."""
    for k in range(1, 40):
        e = k * 2.0**-31
        (found,) = weak_shifts(springs_of(one_across(e)))
        squared = Fraction(e) ** 2 / (8 + Fraction(e) ** 2)

        assert Fraction(found.share) ** 2 >= squared
        assert Fraction(math.nextafter(found.share, 0.0)) ** 2 < squared


def test_a_free_shift_is_not_called_weak_and_one_beside_it_is():
    free = springs_of(one_across(0.0)[:-1])
    both = springs_of([[1.0, 0.0, 0.0]] * 8 + [[0.0, 2.0**-30, 0.0]])

    assert weak_shifts(free) == ()
    (found,) = weak_shifts(both)
    assert found.direction.tolist() == [0.0, 1.0, 0.0]


def test_two_weak_shifts_are_told_together():
    found = weak_shifts(
        springs_of([[1.0, 0.0, 0.0]] * 8 + [[0.0, 2.0**-30, 0.0], [0.0, 0.0, 2.0**-40]])
    )

    assert weak_shift_words(found) == (
        "a shift along (0, 0, 1), (0, 1, 0) or any mix of them is resisted by next to nothing: "
        "springs changed by as little as 3.3e-10 of their size would leave it free"
    )


@pytest.mark.parametrize("share", [0.0, 1e-8])
def test_the_first_line_says_that_a_shift_is_resisted_by_next_to_nothing(share: float):
    found = registered(share)
    first = str(found).splitlines()[0]

    assert first.startswith(f"{STAMP}the global optimum of exactly these numbers")
    assert "a shift along (0.667, -0.333, 0.667) is resisted by next to nothing: " in first
    flat = "the springs hardly resist a move of the pose: to first order it is undetermined"
    assert flat in str(found)
    assert "What to do: add pairs with springs across what is undetermined" in str(found)
    (told,) = result_document(found)["springs"]["weak_translations"]
    assert told["direction"] == pytest.approx(AXIS.tolist(), abs=1e-7)
    assert told["share"] < (1e-15 if not share else 1.1e-8)


def test_above_the_limit_the_uncertainty_says_it():
    found = registered(1e-4)

    assert str(found).startswith("CERTIFIED: ")
    assert found.covariance.centre_sigma > 5.0
    assert result_document(found)["springs"]["weak_translations"] == []


def test_a_pose_that_is_judged_there_is_told_so_too():
    found = registered(0.0)
    judged = assess(found, found)

    assert judged.headline.startswith("OPTIMAL TO ROUNDING, BUT A SHIFT IS HARDLY RESISTED: ")
    assert not judged.green


def test_limits_of_ones_own_do_not_hide_it():
    found = certify(corridor(0.0), max_gap=1e-30)

    lines = str(found).splitlines()
    assert lines[0].startswith("BOUNDED: ")
    assert lines[1].startswith(
        "A shift along (0.667, -0.333, 0.667) is resisted by next to nothing"
    )


def test_a_motion_notes_the_shift_that_is_hardly_resisted():
    """A certificate of the list says that it ends at the optimum, and not that it is near."""
    (note,) = moved_springs(corridor(2.0**-60)).notes

    assert note.startswith("a shift along (0.667, -0.333, 0.667) is resisted by next to nothing: ")
    rest = "along it the body may be at rest (slower than the tolerance) far from the optimum"
    assert note.endswith(f" would leave it free: {rest}")
