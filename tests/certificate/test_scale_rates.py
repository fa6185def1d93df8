"""A sample of `make rates NAME=scale_bounds`."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from mpmath import mpf, sqrt, workdps

from benchmarks.rates import scale_bounds

SAMPLE = scale_bounds.PROBLEMS // 500


@pytest.mark.slow
@pytest.mark.parametrize("count", [SAMPLE, pytest.param(5 * SAMPLE, marks=pytest.mark.long)])
def test_scales_and_poses_are_those_of_the_reference_and_each_certificate_is_accepted(count):
    tally = scale_bounds.counted(0, count)

    assert tally.good
    assert 0 < tally.scale < 1e-15  # the scale is rounded to a double
    assert 0 < tally.width < 1e-20


def test_the_reference_knows_a_scale_that_is_exact():
    problem = replace(scale_bounds.random_problem(1), rotation_only=True)
    best = scale_bounds.reference(replace(problem, target=-4.0 * problem.source[:, [1, 0, 2]]))

    assert abs(best.scale - 4) < mpf(10) ** -50
    turn = np.array([[0, -1, 0], [-1, 0, 0], [0, 0, -1]])
    assert np.abs(best.rotation - turn).max() < 1e-50


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("error", ["scale", "rotation", "translation"])
def test_a_reference_that_is_off_by_little_is_seen(monkeypatch, error):
    honest = scale_bounds.reference

    def off(problem):
        best = honest(problem)
        with workdps(scale_bounds.DIGITS):
            moved = {
                "scale": best.scale * (1 + mpf("1.2e-14")),
                "rotation": best.rotation + 1.2e-14,
                "translation": best.translation + 1.2e-14 * best.coordinates,
            }
        return replace(best, **{error: moved[error]})

    monkeypatch.setattr(scale_bounds, "reference", off)
    tally = scale_bounds.counted(1, 1)

    assert not tally.good
    assert getattr(tally, error) > scale_bounds.ERROR
    assert tally.outside == (error == "scale")


def test_intervals_that_are_wide_or_beside_the_scale_are_seen():
    best = scale_bounds.reference(scale_bounds.random_problem(1))
    with workdps(scale_bounds.DIGITS):
        scale = Fraction(str(best.scale))
        root = Fraction(str(sqrt(best.scale)))
    step = scale * Fraction(1, 10**20)
    for low, high, wide, outside in (
        (scale - step / 4, scale + step / 4, False, 0),
        (scale - step, scale + step, True, 0),
        (scale + step / 4, scale + step / 2, False, 1),
        (root, root, False, 1),
    ):
        tally = scale_bounds.Tally()
        scale_bounds.compare_interval(low, high, best, tally)
        assert (tally.width > scale_bounds.WIDTH, tally.outside) == (wide, outside)
        assert tally.good == (not wide and not outside)


@pytest.mark.slow
def test_what_the_checker_refuses_is_counted(tmp_path):
    line = scale_bounds.certified(scale_bounds.random_problem(1), scale_bounds.Tally())
    forged = json.loads(line)
    forged["claims"]["gap"][1] -= 1
    path = tmp_path / "all.jsonl"
    path.write_bytes(b"\n".join([line, json.dumps(forged).encode(), b"", line, b""]))

    assert scale_bounds.accepted(path) == 2


@pytest.mark.slow
def test_a_pose_that_is_not_the_rigid_one_is_counted(monkeypatch):
    honest = scale_bounds.Problem.stated

    def stated(problem, scale):
        moved = replace(problem, target=problem.target[::-1]) if scale == "none" else problem
        return honest(moved, scale)

    monkeypatch.setattr(scale_bounds.Problem, "stated", stated)
    tally = scale_bounds.counted(1, 1)

    assert (tally.unlike_rigid, tally.good) == (1, False)
