"""Radii and angles beside the inequalities that prove them: they hold there, and hardly above."""

from __future__ import annotations

import math
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.certificate import radius
from certreg.certificate.angle_bound import turn_about
from certreg.certificate.radius import (
    _weight_and_lever,
    growth_radius,
    isotropic_radius,
    sines,
)
from certreg.exact.dyadic import Dyadic
from certreg.problem.problem import RegistrationProblem
from certreg.problem.stiffness import spring_moments

WIDER = 1 + Fraction(1, 2**21)  # of what is rounded to 24 bits
PLACES = 10**60


def roots(value: Fraction) -> tuple[Fraction, Fraction]:
    low = math.isqrt(value.numerator * PLACES**2 // value.denominator)
    return Fraction(low, PLACES), Fraction(low + 1, PLACES)


@pytest.mark.parametrize("degrees", [1e-6, 0.1, 30.0, 60.0, 89.9, 90.0])
def test_sines_are_below_those_of_the_angle_and_close(degrees: float):
    half, sine = (one.value for one in sines(degrees))
    exact = Fraction(math.sin(math.radians(degrees) / 2))

    assert half <= exact <= half * WIDER
    low, high = roots(1 - half**2)
    assert sine <= 2 * half * high
    assert sine * (1 + Fraction(3, 2**61)) >= 2 * half * low


@pytest.mark.parametrize("degrees", [0.0, -1.0, 90.00000000000001, math.nan])
def test_no_other_angle_has_sines(degrees: float):
    with pytest.raises(ValueError, match="more than 0, and at most 90"):
        sines(degrees)


def moments_of(source: int, target: int, mass: int, exponent: int = 0) -> Any:
    def diagonal(trace: int) -> list[list[int]]:
        return [[trace - 2, 7, 7], [7, 1, 7], [7, 7, 1]]

    return SimpleNamespace(
        source_scatter=diagonal(source),
        target_scatter=diagonal(target),
        source_exponent=exponent,
        target_exponent=exponent + 1,
        weight_exponent=2,
        mass=mass,
    )


@pytest.mark.parametrize("shift", [-70, -3, 0, 40, 90])
@pytest.mark.parametrize("sin2", [Fraction(0), Fraction(1, 50), Fraction(1, 20)])
@pytest.mark.parametrize("mass", [1, 10**6])
def test_the_radius_of_one_weight_per_pair_is_the_largest_that_is_proved(
    shift: int, sin2: Fraction, mass: int
):
    """x r <= beta of moves of the target, (x + y) r + m r^2 <= beta of both."""
    g = Dyadic(mantissa=5, exponent=shift)
    made = isotropic_radius(
        moments_of(9, 50, mass), separation=g, sin2_half_angle=sin2, degrees=60.0
    )
    assert made is not None
    assert (made.sin_half_angle, made.separation) == (sines(60.0)[0], g)
    x, y, m = 3 * 4, roots(Fraction(50))[0] * 4 * 2, 4 * mass
    tangent = roots(sin2 / (1 - sin2))[0]
    beta = g.value * (sines(60.0)[1].value - 2 * tangent) / 2
    target, both = made.target.value, made.both.value

    assert x * target <= beta < x * target * WIDER
    assert (x + y) * both + m * both**2 <= beta
    wider = both * WIDER
    assert (x + y) * wider + m * wider**2 > beta


def test_points_that_stay_keep_no_optimum_that_is_known_too_badly(monkeypatch):
    """sin a = 1/2 and a0 = 2 tan = 1/2: equality, with nothing left."""
    monkeypatch.setattr(
        radius,
        "sines",
        lambda _: (Dyadic(mantissa=1, exponent=-2), Dyadic(mantissa=1, exponent=-1)),
    )

    def made(sin2: Fraction) -> Any:
        g = Dyadic(mantissa=1, exponent=0)
        return isotropic_radius(
            moments_of(9, 50, 1), separation=g, sin2_half_angle=sin2, degrees=30.0
        )

    little = Fraction(1, 10**15)
    assert made(Fraction(1, 17)) is None
    assert made(Fraction(1, 17) + little) is None
    assert made(Fraction(1, 17) - little) is not None


@pytest.mark.parametrize("value", [Fraction(0), Fraction(1, 10**9), Fraction(25), Fraction(10**9)])
@pytest.mark.parametrize("delta", [Fraction(0), Fraction(1, 9)])
@pytest.mark.parametrize(("weight", "lever"), [(4, 9), (3, 10**4)])
def test_the_radius_of_general_springs_is_the_largest_that_is_proved(
    monkeypatch, value: Fraction, delta: Fraction, weight: int, lever: int
):
    monkeypatch.setattr(radius, "_weight_and_lever", lambda _: (Fraction(weight), Fraction(lever)))
    mu, s = Fraction(2), sines(60.0)[0].value
    moments: Any = None
    made = growth_radius(moments, mu=mu, delta=delta, value=value, degrees=60.0)
    assert made is not None
    k, w, fit = (roots(Fraction(square))[1] for square in (lever, weight, value))
    left = mu * s - delta / s

    def proves_target(r: Fraction) -> bool:
        return 4 * k * w * r < left or 4 * w * r * (fit + w * r) <= left * s

    def proves_both(r: Fraction) -> bool:
        m = 2 * w * r
        form = 8 * w**2 * r**2 + (8 * k * w * (1 + s) + 4 * w * fit) * r
        return form < left or 4 * m * (fit + m) <= left * s

    assert proves_target(made.target.value)
    assert not proves_target(made.target.value * WIDER)
    assert proves_both(made.both.value)
    assert not proves_both(made.both.value * WIDER)
    assert made.sin_half_angle == sines(60.0)[0]


def test_no_radius_is_proved_without_growth_or_of_a_point(monkeypatch):
    lever = Fraction(9)
    monkeypatch.setattr(radius, "_weight_and_lever", lambda _: (Fraction(4), lever))
    s = sines(60.0)[0].value
    moments: Any = None
    numbers: dict[str, Any] = {"value": Fraction(1), "degrees": 60.0}

    def made(delta: Fraction) -> Any:
        return growth_radius(moments, mu=Fraction(2), delta=delta, **numbers)

    assert made(2 * s * s) is None
    assert made(2 * s * s + 1) is None
    assert made(2 * s * s - Fraction(1, 10**20)) is not None
    lever = Fraction(0)
    assert made(Fraction(0)) is None


def test_weight_and_lever_are_the_sums_over_the_springs():
    rng = np.random.default_rng(2)
    x, y = rng.integers(-9, 9, size=(2, 6, 3)) / 4.0
    factors = np.tril(rng.integers(-3, 4, size=(6, 3, 3)) / 2.0)
    moments = spring_moments(RegistrationProblem(x, y, factors=factors))
    w = [sum(Fraction(float(e)) ** 2 for e in L.ravel()) for L in factors]
    rows = [[Fraction(float(e)) for e in row] for row in x]
    means = [sum(a * r[j] for a, r in zip(w, rows, strict=True)) / sum(w) for j in range(3)]
    lever = sum(
        a * sum((r[j] - means[j]) ** 2 for j in range(3)) for a, r in zip(w, rows, strict=True)
    )

    assert _weight_and_lever(moments) == (sum(w), lever)


def admitted(A: np.ndarray, c: float, rng: np.random.Generator, count: int) -> np.ndarray:
    """(k, 4): quaternions p, |p| = 1, with p^T A p >= c, many of them at c."""
    values, vectors = np.linalg.eigh(A)
    p = rng.standard_normal((count, 4)) * rng.choice([1.0, 0.1, 0.01], (count, 4))
    p[:, 3] = np.abs(p[:, 3]) + 0.1
    room = (values[3] - c) * p[:, 3] ** 2
    spent = ((c - values[:3]) * p[:, :3] ** 2).sum(axis=1)
    p[:, :3] *= np.sqrt(np.minimum(room / np.maximum(spent, 1e-300), 1e6))[:, np.newaxis]
    p /= np.linalg.norm(p, axis=1)[:, np.newaxis]
    return p @ vectors.T


@pytest.mark.parametrize("seed", range(12))
def test_the_angle_holds_and_is_reached_nearly(seed: int):
    rng = np.random.default_rng(seed)
    vectors = np.linalg.qr(rng.standard_normal((4, 4)))[0]
    A = vectors @ np.diag([-0.9, *rng.uniform(-0.8, 0.4, 2), 1.0]) @ vectors.T
    c = float(rng.uniform(0.8, 0.98))
    u = vectors[:, 3] + rng.choice([0.0, 0.01, 0.1]) * rng.standard_normal(4)
    u /= np.linalg.norm(u)
    reach = turn_about(c, A, u)
    assert reach is not None

    s = float(reach.sin2_half_angle.value)
    p = admitted(A, c, rng, 10_000)
    assert (np.einsum("ki,ij,kj->k", p, A, p) >= c - 1e-9).all()
    turned = 1.0 - (p @ u) ** 2
    assert turned.max() < s
    assert turned.max() > 0.8 * s - 1e-9
    t = float(reach.tau.value)
    matrix = (c - t * (1.0 - s)) * np.eye(4) - A + t * np.outer(u, u)
    assert np.linalg.eigvalsh(matrix)[0] > 0.0


def test_no_angle_is_told_where_all_rotations_are_admitted():
    A = np.diag([1.0, 0.2, 0.1, 0.0])
    assert turn_about(-0.1, A, np.eye(4)[0]) is None
    assert turn_about(0.15, A, np.eye(4)[0]) is None
    assert turn_about(0.5, A, np.eye(4)[1]) is None


def test_an_eigenvector_has_the_angle_of_two_eigenvalues():
    A = np.diag([1.0, 0.2, 0.1, 0.0])
    reach = turn_about(0.9, A, np.eye(4)[0])
    assert reach is not None
    assert float(reach.sin2_half_angle.value) == pytest.approx(0.1 / 0.8, rel=2e-3)
