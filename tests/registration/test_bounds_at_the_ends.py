"""Pairs with bounds at the ends of the doubles: the same answers, or a refusal in one line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from commands import certreg as run
from rotated_pairs import BOUND, rotated_pairs

import certreg
from certreg.errors import InvalidProblemError
from certreg.problem.arrays import apart, diameter, lengths
from certreg.registration.pair_angles import angles_between, widest_angles

ROTATIONS: dict[str, Any] = {"rotation_only": True, "objective": "truncated"}
PAIRS = rotated_pairs(np.random.default_rng(3), 12, 0.5)
LABELS = np.where(PAIRS.true, "inlier", "outlier").tolist()


def test_lengths_are_those_of_the_usual_sizes_times_any_power_of_two():
    rows = np.random.default_rng(0).standard_normal((20, 3))
    usual = np.linalg.norm(rows, axis=1)

    for exponent in (-1000, -600, 0, 600, 1000):
        unit = 2.0**exponent
        assert (lengths(rows * unit) == usual * unit).all()
        assert (apart(rows * unit, -rows * unit) == 2.0 * usual * unit).all()
    assert lengths(np.zeros((1, 3))) == 0.0
    assert diameter(np.array([[-1.7e308, 0.0, 0.0], [1.7e308, 0.0, 0.0]])) == np.inf


def test_angles_do_not_depend_on_the_unit():
    x, y = PAIRS.source, PAIRS.target
    bounds = np.full(len(x), BOUND)
    usual = angles_between(x, y), widest_angles(x, y, bounds)

    for unit in (2.0**-1000, 2.0**-600, 2.0**600, 2.0**1000):
        here = angles_between(x * unit, y * unit), widest_angles(x * unit, y * unit, bounds * unit)
        assert all((a == b).all() for a, b in zip(here, usual, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("size", [2.0**-1000, 2.0**-650, 2.0**650, 2.0**1000])
def test_labels_of_rotations_are_those_of_any_unit(size: float, tmp_path):
    source, target = PAIRS.source * size, PAIRS.target * size
    result: Any = certreg.certify(source, target, max_residual=BOUND * size, **ROTATIONS)

    assert list(result.labels) == LABELS
    assert ((result.residuals <= BOUND * size) == PAIRS.true).all()
    result.report(str(tmp_path / "a.html"))
    assert "CERTIFIED" in str(result)
    assert result.to_dict()["truncated"]["labels"] == LABELS


@pytest.mark.slow
@pytest.mark.parametrize("size", [2.0**-650, 2.0**650])
def test_labels_of_motions_are_those_of_any_unit(size: float, tmp_path):
    source, target = PAIRS.source * size, PAIRS.target * size
    result: Any = certreg.certify(source, target, max_residual=BOUND * size)

    assert list(result.labels) == LABELS
    result.report(str(tmp_path / "a.html"))
    assert str(result).startswith("CERTIFIED")
    kept = certreg.assess(source, target, labels=PAIRS.true, max_residual=BOUND * size)
    assert kept.headline.startswith("CONSISTENT")


@pytest.mark.parametrize("size", [1e-320, 1e-300, 1e300, 1e307])
@pytest.mark.parametrize("scale", ["none", "asymmetric"])
def test_sizes_that_the_checker_refuses_are_refused_first(size: float, scale: str):
    source, target = PAIRS.source * size, PAIRS.target * size

    with pytest.raises(InvalidProblemError, match="in a unit in which they are nearer to 1"):
        certreg.certify(source, target, max_residual=0.5 * size, scale=scale)


@pytest.mark.parametrize("bound", ["1e300", "1e308"])
def test_an_endless_bound_is_refused_in_one_line(bound: str, tmp_path):
    np.savetxt(tmp_path / "a.csv", PAIRS.source, "%.17g", ",")
    np.savetxt(tmp_path / "b.csv", PAIRS.target, "%.17g", ",")
    options = ("--max-residual", bound, "--rotation-only", "--objective", "truncated")
    told = run("certify", tmp_path / "a.csv", tmp_path / "b.csv", *options)

    assert (told.code, told.out) == (2, "")
    assert told.err.startswith("certreg: --max-residual is 1e+30")
    assert told.err.count("\n") == 1


def test_half_a_tiny_diameter_is_not_called_0():
    tiny = 1e-200 * PAIRS.source

    with pytest.raises(InvalidProblemError, match=r"diameter of the smaller cloud, \d.*e-200"):
        certreg.certify(tiny, tiny, max_residual=1e-199)


def test_the_problem_of_a_result_with_bounds_is_not_certified_as_one_without():
    found: Any = certreg.certify(PAIRS.source, PAIRS.target, max_residual=BOUND)

    words = "the pairs of this problem have bounds: give the one that it was made of"
    with pytest.raises(InvalidProblemError, match=words):
        certreg.certify(found.problem)
