"""Equilibria of the body with a free scale: counts and indices beside the linearised motion."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks.rates import scaled_equilibria
from certreg.equilibrium.breathing import LOST_SCALE, breathing_equilibria
from certreg.errors import DegenerateProblemError
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.results import OUT_OF_RANGE

AXES = np.array([s * row for row in np.eye(3) for s in (1.0, -1.0)])


def of_axes(diagonal: list[float]) -> Isotropic:
    """Six points: C = 2 diag(d), Sxx = 6."""
    return Isotropic(exact_moments(RegistrationProblem(AXES, AXES * diagonal)))


@pytest.mark.slow
def test_counts_and_indices_are_those_of_the_linearised_motion():
    found = scaled_equilibria.counted(50)

    assert found.equilibria == 200
    assert found.miscounted == found.misindexed == found.moving == 0


def test_a_wrong_index_is_seen(monkeypatch):
    def rigid(objective):
        found = breathing_equilibria(objective)
        turned = [replace(e, morse_index=e.component) for e in found.inside_out]
        return replace(found, inside_out=tuple(turned))

    monkeypatch.setattr(scaled_equilibria, "breathing_equilibria", rigid)

    assert scaled_equilibria.counted(5).misindexed


@pytest.mark.parametrize(
    ("diagonal", "scales", "inside_out"),
    [
        ([4, 3, 2], [3], [-5 / 3, -1, -1 / 3]),
        ([4, 2, 1], [7 / 3, 1 / 3], [-5 / 3, -1]),
        ([4, 3, -2], [5 / 3, 1, 1 / 3], [-3]),
    ],
)
def test_one_two_and_three_equilibria(diagonal, scales, inside_out):
    found = breathing_equilibria(of_axes(diagonal))

    assert found.count == len(scales)
    assert [each.scale for each in found.upright] == pytest.approx(scales, rel=1e-15)
    assert [each.morse_index for each in found.upright] == list(range(len(scales)))
    assert [each.scale for each in found.inside_out] == pytest.approx(inside_out, rel=1e-15)
    assert [each.morse_index for each in found.inside_out] == list(range(len(inside_out)))
    assert found.inside_out[0].stable


TURNS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])  # no turn, and half turns


@pytest.mark.parametrize("diagonal", [[4, 3, 2], [4, 3, -2], [0.25, 0.125, 0.0625]])
def test_each_scale_and_energy_is_that_of_the_points_at_its_turn(diagonal):
    """At a turn diag(r): s = sum d r / 3, and V = 2 sum (d - s r)^2."""
    scales = TURNS @ diagonal / 3
    energies = 2 * ((diagonal - scales[:, np.newaxis] * TURNS) ** 2).sum(axis=1)
    found = breathing_equilibria(of_axes(diagonal))
    for parts, places in (
        (found.upright, [k for k in np.argsort(-scales) if scales[k] > 0]),
        (found.inside_out, [k for k in np.argsort(scales) if scales[k] < 0]),
    ):
        assert [part.scale for part in parts] == pytest.approx(scales[places], rel=1e-15)
        assert [part.energy for part in parts] == pytest.approx(energies[places], rel=1e-14)


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (Fraction(0), LOST_SCALE),
        (Fraction(-1, 2), LOST_SCALE),
        (Fraction(1, 10**400), OUT_OF_RANGE),
        (Fraction(10**400), OUT_OF_RANGE),
    ],
)
def test_a_scale_whose_digits_no_double_holds_is_not_told(value: Fraction, reason):
    """Of an eigenvalue that is proved to be positive; its digits are rounded."""
    exact = of_axes([4, 3, 2])
    objective: Any = SimpleNamespace(
        moments=exact.moments,
        classification=exact.classification,
        davenport=exact.davenport,
        eigenvalues=(value, *exact.eigenvalues[1:]),
    )
    (found,) = breathing_equilibria(objective).upright

    assert found.scale is None
    assert found.stated("scale") == reason


def test_an_eigenvalue_zero_is_no_equilibrium():
    found = breathing_equilibria(of_axes([2, 1, 1]))

    assert (found.signs.positive, found.signs.zero, found.signs.negative) == (1, 1, 2)
    assert len(found.upright) == 1
    assert [each.kind.dimension for each in found.inside_out] == [1]


def test_a_continuum_has_no_count():
    found = breathing_equilibria(of_axes([1, 1, -1]))  # 1, 1, 1, -3

    assert found.signs.positive == 3
    assert found.count is None
    assert not breathing_equilibria(of_axes([0, 0, 0])).upright


def test_a_continuum_beside_a_point_has_no_count():
    found = breathing_equilibria(of_axes([3, 3, -1]))  # 5, 1, 1, -7

    assert [each.kind.dimension for each in found.upright] == [0, 1]
    assert found.count is None


def test_a_continuum_inside_out_leaves_the_count_of_the_others():
    found = breathing_equilibria(of_axes([1, 1, 1]))  # 3, -1, -1, -1

    assert found.count == 1
    assert [each.kind.dimension for each in found.inside_out] == [2]


def test_a_source_in_one_point_has_no_scale():
    problem = RegistrationProblem(np.ones((4, 3)), np.arange(12.0).reshape(4, 3))
    with pytest.raises(DegenerateProblemError, match="coincide"):
        breathing_equilibria(Isotropic(exact_moments(problem)))
