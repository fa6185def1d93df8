"""No move of the points takes the scale out of its proved range."""

from __future__ import annotations

import math
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.exact.dyadic import Dyadic
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.scale_range import (
    moved_scale,
    moved_symmetric_scale,
    proved_scales,
    spreads_of,
)


def scales(x, y, w):
    x, y = x - w @ x / w.sum(), y - w @ y / w.sum()
    values = np.linalg.svd((y * w[:, None]).T @ x)
    d = values[1] * [1, 1, np.sign(np.linalg.det(values[0] @ values[2]))]
    own, other = (np.sum(w[:, None] * p * p) for p in (x, y))
    return float(d.sum() / own), float(np.sqrt(other / own))


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("moves", [(0.0, 0.1), (0.1, 0.0), (0.05, 0.3)])
def test_no_move_takes_the_scale_out_of_its_range(seed, moves):
    rng = np.random.default_rng([seed, 9])
    x, w = rng.normal(size=(8, 3)), rng.uniform(0.2, 3.0, size=8)
    y = 3.0 * x + 0.2 * rng.normal(size=(8, 3))
    moments = exact_moments(RegistrationProblem(x, y, weights=w))
    level, spreads = Isotropic(moments).eigenvalues[0], spreads_of(moments)
    slack = level / 10**12
    by = tuple(map(Fraction, moves))
    found = moved_scale(level - slack, level + slack, spreads, *by)
    symmetric = moved_symmetric_scale(spreads, *by)
    assert found is not None
    assert symmetric is not None

    for grows in (True, False, None, None):
        a, b = (outwards(rng, p, r, grows) for p, r in zip((x, y), moves, strict=True))
        if grows is not None:
            a = outwards(rng, x, moves[0], not grows)
        one, other = scales(x + a, y + b, w)
        assert found[0] <= one <= found[1]
        assert symmetric[0] <= other <= symmetric[1]


def outwards(rng, points, length, grows):
    """Moves of that length: away from the mean, to it, or anywhere."""
    d = points - points.mean(axis=0) if grows is not None else rng.normal(size=points.shape)
    d = d / np.linalg.norm(d, axis=1, keepdims=True)
    return length * d * (-1.0 if grows is False else 1.0)


@pytest.mark.parametrize("own", [Fraction(2), Fraction(1, 3), Fraction(4)])
@pytest.mark.parametrize("other", [Fraction(3), Fraction(5, 7), Fraction(9)])
def test_of_points_that_stay_the_range_holds_the_scale_itself(own: Fraction, other: Fraction):
    """Also where its roots are no fractions."""
    still, spreads = (Fraction(0), Fraction(0)), (Fraction(3), own, other)
    found, symmetric = (
        moved_scale(own, own, spreads, *still),
        moved_symmetric_scale(spreads, *still),
    )

    assert found is not None
    assert symmetric is not None
    assert found[0] <= 1 <= found[1]
    assert symmetric[0] ** 2 * own <= other <= symmetric[1] ** 2 * own
    assert found[1] - found[0] < Fraction(1, 1 << 60)
    assert symmetric[1] - symmetric[0] < Fraction(1, 1 << 58)


def test_of_spreads_whose_roots_are_integers_the_range_is_that_of_the_claim():
    """m = 2 * 9 dx + 2 * 3 dy + 4 dx dy, of M = 4, Sxx = 9, Syy = 81."""
    spreads, dx, dy = (Fraction(4), Fraction(9), Fraction(81)), Fraction(1, 2), Fraction(1, 3)
    m = 18 * dx + 6 * dy + 4 * dx * dy

    assert moved_scale(Fraction(20), Fraction(21), spreads, dx, dy) == (
        (20 - m) / (3 + 2 * dx) ** 2,
        (21 + m) / (3 - 2 * dx) ** 2,
    )
    assert moved_scale(m / 2, m, spreads, dx, dy) == (0, 2 * m / (3 - 2 * dx) ** 2)
    assert moved_symmetric_scale(spreads, dx, dy) == (
        (9 - 2 * dy) / (3 + 2 * dx),
        (9 + 2 * dy) / (3 - 2 * dx),
    )
    assert moved_symmetric_scale(spreads, dx, Fraction(5)) == (0, 19 / (3 - 2 * dx))


def test_where_the_source_may_shrink_to_a_point_there_is_no_bound():
    spreads = (Fraction(1), Fraction(4), Fraction(4))

    assert moved_scale(Fraction(6), Fraction(6), spreads, Fraction(2), Fraction(0)) is None
    assert moved_scale(Fraction(6), Fraction(6), spreads, Fraction(1999, 1000), Fraction(0))
    assert moved_symmetric_scale(spreads, Fraction(2), Fraction(0)) is None
    assert (
        moved_symmetric_scale((Fraction(1), Fraction(4), Fraction(0)), *[Fraction(0)] * 2) is None
    )


@pytest.mark.parametrize("kind", ["asymmetric", "symmetric"])
@pytest.mark.parametrize("moves", [(Fraction(0), Fraction(1, 10)), (Fraction(1, 7), Fraction(0))])
def test_a_range_of_scales_is_rounded_outwards_to_the_next_doubles(
    kind: str, moves: tuple[Fraction, Fraction]
):
    points = np.diag([3.0, 2.0, 1.0])
    moments = exact_moments(RegistrationProblem(points, points))
    spreads, tiny = spreads_of(moments), Fraction(1, 1 << 70)
    level = spreads[1]
    scales = [Dyadic(mantissa=(1 << 70) + sign, exponent=-70) for sign in (-1, 1)]
    body: Any = SimpleNamespace(
        scale=kind, claims=SimpleNamespace(scale_lower=scales[0], scale_upper=scales[1])
    )
    exact = (
        moved_symmetric_scale(spreads, *moves)
        if kind == "symmetric"
        else moved_scale(level * (1 - tiny), level * (1 + tiny), spreads, *moves)
    )
    found = proved_scales(body, moments, source=moves[0], target=moves[1])

    assert exact is not None
    assert found is not None
    assert Fraction(found[0]) <= exact[0] < Fraction(math.nextafter(found[0], 9.0))
    assert Fraction(math.nextafter(found[1], 0.0)) < exact[1] <= Fraction(found[1])
    assert proved_scales(body, moments, source=Fraction(9), target=Fraction(0)) is None
