"""Forms of degree four are shown to be positive by cones: in C, and in Python by the same cuts."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from reference_cones import search_in_python

from certreg.native import kernels
from certreg.native.cones import (
    MONOMIALS,
    ConesEnding,
    bernstein_on_orthants,
    search_by,
    search_cones,
)
from certreg.native.library import Library
from certreg.native.signatures import generated, opened

ONE = 10**12
BUDGET = 20_000
NO_CAPS = np.empty((0, 5))


def form(**terms: int) -> list[int]:
    """Of monomials as wwxy=3, times ONE."""
    places = {"".join("wxyz"[k] for k in m): place for place, m in enumerate(MONOMIALS)}
    found = [0] * len(MONOMIALS)
    for name, entry in terms.items():
        found[places["".join(sorted(name, key="wxyz".index))]] += entry * ONE
    return found


def plus_level(quartic: list[int], level: float) -> list[int]:
    """The form plus level |q|^4."""
    square = form(**{a * 2 + b * 2: 1 for a, b in product("wxyz", repeat=2) if a <= b})
    twice = [
        entry * (1 if len(set(m)) == 1 else 2) for entry, m in zip(square, MONOMIALS, strict=True)
    ]
    return [a + int(level * b) for a, b in zip(quartic, twice, strict=True)]


def times_square(matrix: Any) -> list[int]:
    """|q|^2 q^T A q of a symmetric matrix of integers."""
    found = [0] * len(MONOMIALS)
    for i, j, k in product(range(4), repeat=3):
        found[MONOMIALS.index(tuple(sorted((i, j, k, k))))] += int(matrix[i][j]) * ONE
    return found


def value(quartic: list[int], q: Any) -> float:
    return (
        sum(k * np.prod([q[i] for i in m]) for k, m in zip(quartic, MONOMIALS, strict=True)) / ONE
    )


def random_form(seed: int) -> list[int]:
    rng = np.random.default_rng(seed)
    return [int(entry) for entry in rng.normal(size=len(MONOMIALS)) * ONE]


# Choi and Lam: nonnegative, no sum of squares; zero at (1, 1, 1, 1), e_2 and five more.
CHOI_LAM = form(wwww=1, xxyy=1, yyzz=1, xxzz=1, wxyz=-4)
AT_ONE = times_square(np.diag([0, 1, 1, 1]))  # zero at (1, 0, 0, 0) alone


def libraries() -> list[Library]:
    """Each variant that was built and that this processor runs."""
    built = kernels.record_of(kernels.BUILT)
    names = kernels.runnable(built, kernels.BUILT) if not built.why else []
    handles = [opened(kernels.BUILT / built.variants[name]) for name in names]
    return [Library(handle, "one variant", generated()) for handle in handles]


def test_a_form_that_is_no_sum_of_squares_is_seen_to_be_positive():
    assert search_cones(plus_level(CHOI_LAM, 1e-6), NO_CAPS, budget=BUDGET).ending is (
        ConesEnding.POSITIVE
    )


def test_where_a_form_is_negative_a_point_is_named():
    for quartic in (plus_level(CHOI_LAM, -1e-6), *map(random_form, range(5))):
        found = search_cones(quartic, NO_CAPS, budget=BUDGET)

        assert found.ending is ConesEnding.NOT_POSITIVE
        assert value(quartic, found.vertex) < 0


def test_a_form_may_be_negative_inside_of_a_cap_and_nowhere_else():
    quartic = plus_level(AT_ONE, -0.0025)  # negative where the sine to e_0 is below 1/20
    inside, less = (np.array([[1.0, 0.0, 0.0, 0.0, sine**2]]) for sine in (0.1, 0.049))

    assert search_cones(quartic, inside, budget=BUDGET).ending is ConesEnding.POSITIVE
    assert search_cones(quartic, less, budget=BUDGET).ending is not ConesEnding.POSITIVE
    assert search_cones(quartic, -inside * (1, 0, 0, 0, -1), budget=BUDGET).ending is (
        ConesEnding.POSITIVE
    )


def test_a_cone_across_a_cap_and_its_mirror_image_is_in_neither():
    """All vertices of the orthant make 60 degrees with +-(1, 1, 1, 1)/2, its middle 0."""
    quartic = plus_level(form(), -1.0)
    wide = np.array([[-0.5, 0.5, 0.5, 0.5, 0.76]])

    assert search_cones(quartic, wide, budget=BUDGET).ending is not ConesEnding.POSITIVE


def test_what_is_hardly_positive_on_a_plane_ends_in_the_budget():
    first, second = np.array([3, -1, 0, 0]), np.array([0, 0, 3, -1])
    plane = times_square(np.outer(first, first) + np.outer(second, second))

    found = search_cones(plus_level(plane, 1e-9), NO_CAPS, budget=1000)

    assert found.ending is ConesEnding.BUDGET


def test_a_form_with_a_zero_is_not_seen_to_be_positive():
    axis = np.array([3, 1, 1, 1])  # no vertex of a cone
    zero = times_square(12 * np.eye(4) - np.outer(axis, axis))

    assert value(zero, axis) == 0
    assert search_cones(zero, NO_CAPS, budget=BUDGET).ending is not ConesEnding.POSITIVE
    assert search_cones(plus_level(zero, 1e-9), NO_CAPS, budget=BUDGET).ending is (
        ConesEnding.POSITIVE
    )


def cases() -> list[tuple[list[int], np.ndarray]]:
    cap = np.array([[1.0, 0.0, 0.0, 0.0, 1e-4]])
    return [
        (plus_level(CHOI_LAM, 1e-3), NO_CAPS),
        (plus_level(AT_ONE, -5e-5), cap),
        *[(plus_level(random_form(seed), 6.0), NO_CAPS) for seed in range(3)],
    ]


@pytest.mark.one_in(3)
@pytest.mark.parametrize(("quartic", "caps"), cases())
def test_every_variant_and_python_cut_the_same_cones(quartic, caps):
    found = [search_by(one, quartic, caps, BUDGET) for one in libraries()]

    expected = search_in_python(quartic, caps, BUDGET)
    assert expected.ending is ConesEnding.POSITIVE
    assert expected.seen > 20
    assert all(one == expected for one in found)


def test_both_keep_within_the_budget():
    quartic = plus_level(CHOI_LAM, 1e-6)
    expected = search_in_python(quartic, NO_CAPS, 500)

    assert (expected.ending, expected.seen) == (ConesEnding.BUDGET, 501)
    assert all(search_by(one, quartic, NO_CAPS, 500) == expected for one in libraries())


def test_coefficients_are_rounded_down_to_124_bits():
    quartic = [1 << 200, *[-1] * 34]
    first, *rest = bernstein_on_orthants(quartic)[0]

    assert first == 24 << 200 >> 81
    assert first.bit_length() == 124
    assert rest == [-1] * 34
    assert set(bernstein_on_orthants(quartic)[7]) == {first, -1, 0}  # odd ones turn


def test_a_common_factor_is_of_no_matter():
    quartic = plus_level(CHOI_LAM, 0.25)
    small = [entry // (ONE // 4) for entry in quartic]

    assert bernstein_on_orthants(small) == bernstein_on_orthants(quartic)
    assert search_cones(small, NO_CAPS, budget=BUDGET).ending is ConesEnding.POSITIVE
