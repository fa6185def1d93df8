"""Equilibria of the body with a free scale: counts and indices beside the linearised motion."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product
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


def test_scale_index_and_energy_are_those_of_eigenvalues_that_are_known():
    """Of all diagonal C of small integers: continua, too. The index counts what is farther off."""
    for a, b, c in product(range(-2, 3), repeat=3):
        values = (a + b + c, a - b - c, b - a - c, c - a - b)  # of K, over 2; Sxx is 6
        spread = 2 * (a * a + b * b + c * c)
        found = breathing_equilibria(of_axes([a, b, c]))
        for listed, sign in ((found.upright, 1), (found.inside_out, -1)):
            sizes = [sign * value for value in values]
            expected = sorted({size for size in sizes if size > 0}, reverse=True)

            assert [each.scale for each in listed] == pytest.approx(
                [sign * size / 3 for size in expected], rel=1e-15
            )
            assert [each.energy for each in listed] == pytest.approx(
                [spread - 2 * size * size / 3 for size in expected], rel=1e-14, abs=1e-14
            )
            assert [each.kind.dimension + 1 for each in listed] == list(map(sizes.count, expected))
            assert [each.morse_index for each in listed] == [
                sum(size > own for size in sizes) for own in expected
            ]
        positive = [value for value in values if value > 0]
        alone = len(positive) == len(set(positive))
        assert found.count == (len(positive) if alone else None)


@pytest.mark.parametrize(
    ("value", "scale"),
    [
        (Fraction(1, 2), 1 / 12),
        (Fraction(0), LOST_SCALE),
        (Fraction(-1, 2), LOST_SCALE),
        (Fraction(1, 2**1100), OUT_OF_RANGE),
    ],
)
def test_a_scale_whose_sign_is_not_that_of_its_eigenvalue_is_lost(value, scale):
    """As far as the fixed point tells; the count and the sign stay as they are proved."""
    own = of_axes([4, 3, 2])
    odd: Any = SimpleNamespace(
        moments=own.moments,
        classification=own.classification,
        davenport=own.davenport,
        eigenvalues=(value, *own.eigenvalues[1:]),
    )

    assert breathing_equilibria(odd).upright[0].stated("scale") == scale
    odd.eigenvalues = (*own.eigenvalues[:3], -value)
    mirrored = -scale if isinstance(scale, float) else scale
    assert breathing_equilibria(odd).inside_out[0].stated("scale") == mirrored


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
