"""Three methods to the exact sums give the same integers, whatever the numbers are."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from samples import examples

from certreg import RegistrationProblem
from certreg.errors import CertregError
from certreg.native import library as native
from certreg.native import sums as compiled_sums
from certreg.native.kernels import MissingLibraryError
from certreg.problem import exact_sums
from certreg.problem.exact_sums import (
    EMPTY,
    FACTORS,
    UPPER,
    WEIGHTED,
    SumMethod,
    fastest_method,
    second_method,
    sums_by,
)
from certreg.problem.moments import exact_moments, moments_of

finite = st.floats(allow_nan=False, allow_infinity=False, allow_subnormal=True)
LARGEST, LEAST = np.finfo(float).max, 5e-324
MANY = 5000  # points: more than the accumulators for few take


@st.composite
def wild_problems(draw):
    """Any finite doubles at all, or doubles of scales from 1e-150 to 1e150 beside each other."""
    n = draw(st.integers(1, 9))
    if draw(st.booleans()):
        source, target = (draw(arrays(np.float64, (n, 3), elements=finite)) for _ in range(2))
        weights = np.abs(draw(arrays(np.float64, n, elements=finite)))
    else:
        rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
        span = draw(st.sampled_from([0, 3, 40, 150]))
        source, target, weights = (
            rng.normal(size=size) * 10.0 ** rng.integers(-span, span + 1, size=size)
            for size in ((n, 3), (n, 3), n)
        )
        weights = np.abs(weights)
    weights[0] = weights[0] or 1.0
    return RegistrationProblem(source, target, weights=weights)


def by_definition(problem):
    """The 28 sums in fractions, point by point."""
    x, y = (
        [[Fraction(v) for v in row] for row in side.tolist()]
        for side in (problem.source, problem.target)
    )
    points = [*zip([Fraction(w) for w in problem.weights.tolist()], x, y, strict=True)]
    return [
        sum(w for w, _, _ in points),
        *(sum(w * p[i] for w, p, _ in points) for i in range(3)),
        *(sum(w * q[i] for w, _, q in points) for i in range(3)),
        *(sum(w * q[i] * p[j] for w, p, q in points) for i in range(3) for j in range(3)),
        *(sum(w * p[i] * p[j] for w, p, _ in points) for i, j in UPPER),
        *(sum(w * q[i] * q[j] for w, _, q in points) for i, j in UPPER),
    ]


def values(found):
    a, b, c = (
        e or 0 for e in (found.source_exponent, found.target_exponent, found.weight_exponent)
    )
    return [
        k * Fraction(2) ** (c + x * a + y * b)
        for k, (x, y) in zip(found.integers, FACTORS, strict=True)
    ]


@pytest.mark.slow
@given(wild_problems())
@examples(150)
def test_every_method_gives_the_same_integers_and_they_are_those_of_the_definition(problem):
    one, *others = (sums_by(method, problem) for method in SumMethod)

    assert others == [one] * 3
    assert values(one) == by_definition(problem)


@pytest.mark.slow
@given(strategies.problems())
def test_the_integers_do_not_depend_on_how_the_points_are_divided(problem):
    rows = [slice(k, k + 1) for k in range(problem.n)]
    for one in (exact_sums._by_integers, exact_sums._by_few_limbs):
        parts = [one(problem.block(row)) for row in rows]

        assert sum(parts, start=EMPTY) == sum(reversed(parts), start=EMPTY) == WEIGHTED.of(problem)


@pytest.mark.one_in(4)
@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("step", [2, 71, 72, 73, 74, 400])
@pytest.mark.parametrize("n", [2, compiled_sums.FEW_POINTS, compiled_sums.FEW_POINTS + 1])
def test_few_points_of_near_and_of_far_exponents_have_the_sums_of_the_definition(step: int, n: int):
    """Squares span 16^36 at 2^72, the most that the accumulators of few points hold."""
    sizes = np.where(np.arange(3 * n) % 5 == 0, 2.0**-step, 1.0).reshape(n, 3)
    source, target = (4.0 - 2.0**-51) * sizes, -(4.0 - 2.0**-51) * sizes[::-1]
    source[1] = 0.0
    problem = RegistrationProblem(source, target, weights=np.full(n, 4.0 - 2.0**-51))

    assert sums_by(SumMethod.BY_EXPONENT, problem) == sums_by(SumMethod.INTEGERS, problem)


@pytest.mark.one_in(4)
@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize(
    ("source", "weight"),
    [
        (LARGEST, LARGEST),
        (4.0 - 2.0**-51, 4.0 - 2.0**-51),  # 2^56 - 8 in the compiled loop: the largest there is
        (2.0**-51 - 4.0, 4.0 - 2.0**-51),
        (-LARGEST, 1.0),
        (4.0 - 2.0**-51, 1.0),
        (2.0**-51 - 4.0, 2.0**1023),
        (-LARGEST, 2.0**-1022),
        (LEAST, 2.0**-1023),  # below the normal numbers
        (LEAST, LEAST),
        (-LEAST, LARGEST),
        (2.0**-1022, 1.0 - 2.0**-53),
        (-0.0, 1.0),
    ],
)
def test_accumulators_do_not_overflow_where_all_numbers_are_extreme(source, weight):
    n = 40_000  # more than one portion of the compiled loop, and five of the limbs
    problem = RegistrationProblem(np.full((n, 3), source), np.full((n, 3), LARGEST), weights=weight)
    one = RegistrationProblem(np.full((1, 3), source), np.full((1, 3), LARGEST), weights=weight)
    expected = [n * value for value in values(sums_by(SumMethod.INTEGERS, one))]

    for method in (SumMethod.BY_EXPONENT, SumMethod.FIXED_POINT, SumMethod.LIMBS):
        assert values(sums_by(method, problem)) == expected


@pytest.mark.slow
def test_many_points_of_many_scales_on_threads_sum_up_to_the_same_integers(monkeypatch):
    rng = np.random.default_rng(8)
    problem = strategies.random_problem(rng, n=20_011, offset=1e6, decades=9.0)
    expected = sums_by(SumMethod.INTEGERS, problem)
    monkeypatch.setattr("certreg.problem.arrays.BLOCK_POINTS", 1000)
    monkeypatch.setattr(exact_sums, "LIMB_POINTS", 777)

    assert [sums_by(method, problem, threads=3) for method in SumMethod] == [expected] * len(
        SumMethod
    )


def test_products_of_the_largest_limbs_do_not_round():
    rng = np.random.default_rng(9)
    n = exact_sums.LIMB_POINTS
    source, target, weights = (rng.uniform(0.9, 1.0, size) for size in ((n, 3), (n, 3), n))
    problem = RegistrationProblem(source, target, weights=weights)

    assert sums_by(SumMethod.LIMBS, problem) == sums_by(SumMethod.INTEGERS, problem)


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("row", [0, 7, -1])
def test_one_other_weight_among_powers_of_two_counts(row):
    source, target = np.random.default_rng(3).normal(size=(2, MANY, 3))
    weights = np.full(MANY, 0.25)
    weights[row] = 0.5
    problem = RegistrationProblem(source, target, weights=weights)

    assert sums_by(SumMethod.BY_EXPONENT, problem) == sums_by(SumMethod.INTEGERS, problem)


@pytest.mark.usefixtures("compiled")
def test_points_without_weights_count_nothing():
    points = np.random.default_rng(3).normal(size=(MANY, 3))
    found = compiled_sums.sums_by_exponent(native.loaded_library(), points, points, np.zeros(MANY))

    assert not any(found.integers)
    assert found.lowest[2] is None


@pytest.mark.parametrize("weight", [1.0, 0.1, 3e-200])
def test_one_weight_for_all_points_counts_for_each(weight, monkeypatch):
    clouds = np.random.default_rng(3).normal(size=(2, 20, 3))
    problem = RegistrationProblem(*clouds, weights=weight)
    monkeypatch.setattr(exact_sums, "LIMB_POINTS", 8)

    assert sums_by(SumMethod.LIMBS, problem) == sums_by(SumMethod.INTEGERS, problem)


@pytest.mark.parametrize("n", [1, 7, 8, 9, 15, 16, 17])
def test_every_point_counts_wherever_a_part_of_limbs_ends(n, monkeypatch):
    problem = strategies.random_problem(np.random.default_rng(n), n=n)
    monkeypatch.setattr(exact_sums, "LIMB_POINTS", 8)

    assert sums_by(SumMethod.LIMBS, problem) == sums_by(SumMethod.INTEGERS, problem)


def test_limbs_are_used_where_they_are_said_to_be(monkeypatch):
    """Otherwise that method could be the one of integers, and agreement would say nothing."""
    rng = np.random.default_rng(1)
    monkeypatch.setattr(exact_sums, "_by_integers", None)

    for scale in (1e-150, 1.0, 1e150):
        assert sums_by(SumMethod.LIMBS, strategies.random_problem(rng, n=300, scale=scale))


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("fast", [True, False])
def test_the_method_is_chosen_by_the_number_of_points_and_what_is_compiled(fast, monkeypatch):
    monkeypatch.setattr(native.Library, "multiplies_digits", fast)
    sizes = (
        exact_sums.FEW_POINTS - 1,
        exact_sums.FIXED_POINTS - 1,
        exact_sums.FIXED_POINTS,
        exact_sums.MANY_POINTS - 1,
        exact_sums.MANY_POINTS,
    )
    problems = [RegistrationProblem(np.eye(size, 3), np.eye(size, 3)) for size in sizes]
    integers, limbs = SumMethod.INTEGERS, SumMethod.LIMBS
    exponents, fixed = SumMethod.BY_EXPONENT, SumMethod.FIXED_POINT
    first, second = (fixed, exponents) if fast else (exponents, fixed)

    chosen = [fastest_method(problem) for problem in problems]
    assert chosen == [integers, exponents, first, first, first]
    others = [second_method(problem) for problem in problems]
    assert others == [integers, fixed, second, second, second]
    monkeypatch.setattr(exact_sums, "_compiled", lambda: None)
    chosen = [fastest_method(problem) for problem in problems]
    assert chosen == [*[integers] * 4, limbs]
    assert {second_method(problem) for problem in problems} == {integers}


@pytest.mark.usefixtures("compiled")
def test_what_does_not_fit_into_fixed_point_is_never_added_up_twice_by_exponents(monkeypatch):
    """The second opinion would be the first one otherwise."""
    problem = strategies.random_problem(np.random.default_rng(2), n=exact_sums.FIXED_POINTS)
    source = problem.source.copy()
    source[-1] *= 2.0**-200
    wide = RegistrationProblem(source, problem.target)
    monkeypatch.setattr(native.Library, "multiplies_digits", True)

    assert fastest_method(problem) is SumMethod.FIXED_POINT
    assert fastest_method(wide) is SumMethod.BY_EXPONENT
    assert second_method(wide) is SumMethod.FIXED_POINT
    expected = sums_by(SumMethod.BY_EXPONENT, wide)
    monkeypatch.setattr(exact_sums, "sums_by_exponent", None)
    assert sums_by(SumMethod.FIXED_POINT, wide) == expected


@pytest.mark.usefixtures("compiled")
def test_a_block_that_does_not_fit_goes_by_limbs_among_others_that_do(monkeypatch):
    rng = np.random.default_rng(6)
    source, target = rng.normal(size=(2, 3 * exact_sums.FIXED_POINTS, 3))
    source[-1] *= 2.0**-200
    problem = RegistrationProblem(source, target)
    expected = sums_by(SumMethod.INTEGERS, problem)
    monkeypatch.setattr("certreg.problem.arrays.BLOCK_POINTS", exact_sums.FIXED_POINTS)
    monkeypatch.setattr(native.Library, "multiplies_digits", True)
    parts, by_limbs = [], exact_sums._by_limbs

    def noted(block):
        parts.append(len(block.weights))
        return by_limbs(block)

    monkeypatch.setattr(exact_sums, "_by_limbs", noted)

    assert fastest_method(problem) is SumMethod.FIXED_POINT
    assert sums_by(SumMethod.FIXED_POINT, problem) == expected
    assert parts == [exact_sums.FIXED_POINTS]


def test_without_integers_of_128_bits_there_is_no_compiled_method(monkeypatch):
    def refused(*_):
        raise MissingLibraryError("no integers of 128 bits")

    monkeypatch.setattr(exact_sums, "sums_by_exponent", refused)
    exact_sums._compiled.cache_clear()
    try:
        assert exact_sums._compiled() is None
    finally:
        exact_sums._compiled.cache_clear()


@pytest.mark.usefixtures("compiled")
def test_exact_moments_of_many_points_are_those_of_integers():
    problem = strategies.random_problem(np.random.default_rng(5), n=exact_sums.MANY_POINTS)

    assert fastest_method(problem) is not SumMethod.INTEGERS
    assert exact_moments(problem) == moments_of(
        sums_by(SumMethod.INTEGERS, problem), problem.n, problem.motion
    )


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("method", ["sums_by_exponent", "sums_in_fixed_point"])
@pytest.mark.parametrize("bad", [np.inf, -np.inf, np.nan])
def test_the_compiled_sums_refuse_what_is_not_finite(bad, method):
    points = np.ones((4, 3))
    points[2, 1] = bad
    for source, target, weights in (
        (points, np.ones((4, 3)), np.ones(4)),
        (np.ones((4, 3)), points, np.ones(4)),
        (np.ones((4, 3)), np.ones((4, 3)), points[:, 1]),
    ):
        with pytest.raises(ValueError, match="not finite"):
            getattr(compiled_sums, method)(native.loaded_library(), source, target, weights)


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("method", ["sums_by_exponent", "sums_in_fixed_point"])
def test_the_compiled_sums_refuse_arrays_that_do_not_belong_together(method):
    for shapes in (((4, 3), (3, 3), (4,)), ((4, 2), (4, 2), (4,)), ((3, 3), (3, 3), (4,))):
        with pytest.raises(ValueError, match="expected"):
            getattr(compiled_sums, method)(native.loaded_library(), *map(np.ones, shapes))


@pytest.mark.usefixtures("compiled")
def test_a_failure_in_a_thread_ends_the_sums(monkeypatch):
    def fails(*_):
        raise CertregError("as planned")

    monkeypatch.setattr(exact_sums, "sums_by_exponent", fails)
    problem = strategies.random_problem(np.random.default_rng(5), n=30)
    with pytest.raises(CertregError, match="as planned"):
        sums_by(SumMethod.BY_EXPONENT, problem)
