"""The sums over points whose springs are matrices: exact by methods that agree, near in doubles."""

from __future__ import annotations

import numpy as np
import pytest
from engines import libraries_of_all_variants
from hypothesis import given, settings
from hypothesis import strategies as st

from certreg.exact.dyadic import power_of_two
from certreg.native.library import library_if_any, loaded_library
from certreg.native.sums import springs_by_exponent, springs_by_limbs
from certreg.objective.springs import Springs
from certreg.problem import floating_stiffness
from certreg.problem.arrays import row_blocks
from certreg.problem.exact_sums import SumMethod, fastest_method, second_method, sums_by
from certreg.problem.floating_stiffness import floating_spring_moments
from certreg.problem.problem import RegistrationProblem
from certreg.problem.stiffness import spring_moments

COMPILED = (SumMethod.BY_EXPONENT, SumMethod.LIMBS)
EXPONENTS = st.integers(-1074, 1023)
compiled = pytest.mark.skipif(library_if_any() is None, reason="nothing is compiled")


def of(seed, n, *, planes=False, scales=(1.0, 1.0, 1.0), decades=0.0):
    rng = np.random.default_rng(seed)
    widths = (3, 3, 6)
    arrays = [
        scale * rng.normal(size=(n, width)) * 10.0 ** rng.uniform(-decades, 0.0, size=(n, width))
        for scale, width in zip(scales, widths, strict=True)
    ]
    if planes:
        arrays[2][:, [2, 4, 5]] = 0.0
    return RegistrationProblem(arrays[0], arrays[1], factors=arrays[2])


@pytest.mark.one_in(4)
@compiled
@pytest.mark.parametrize("method", COMPILED)
@pytest.mark.parametrize(
    "problem",
    [
        of(1, 1),
        of(2, 20),
        of(3, 257, planes=True),
        of(4, 700, scales=(1e8, 1e-3, 1e-20)),
        of(5, 40, scales=(1e150, 1e150, 1.0)),
        of(6, 40, scales=(1e-150, 1e-150, 1e5)),
        of(7, 60, decades=40.0),
        of(8, 60, decades=290.0),
        of(9, 300, decades=70.0),
    ],
)
def test_compiled_code_finds_the_integers_that_python_finds(method, problem):
    assert sums_by(method, problem) == sums_by(SumMethod.INTEGERS, problem)


@pytest.mark.slow
@compiled
@settings(max_examples=30)
@given(st.lists(st.tuples(EXPONENTS, *[st.integers(-(2**53), 2**53)] * 12), min_size=1, max_size=3))
def test_numbers_of_all_sizes_are_summed_exactly(rows):
    numbers = np.array([[np.ldexp(float(m), e - 53) for m in row] for e, *row in rows])
    numbers[0, 6] = 1.0  # of springs that are all zero no problem is made
    problem = RegistrationProblem(numbers[:, :3], numbers[:, 3:6], factors=numbers[:, 6:])
    want = sums_by(SumMethod.INTEGERS, problem)

    assert [sums_by(method, problem) for method in COMPILED] == [want, want]


@pytest.mark.one_in(4)
@compiled
@pytest.mark.parametrize("method", COMPILED)
@pytest.mark.parametrize("size", [2.0, 4.0])
def test_the_largest_mantissas_and_a_full_block_do_not_overflow(method, size):
    rows = next(row_blocks(10**9)).stop
    ones = np.full((rows, 9), np.nextafter(size, 0.0))
    one, many = (
        RegistrationProblem(ones[:n, :3], ones[:n, :3], factors=ones[:n, 3:]) for n in (1, rows)
    )
    want = sums_by(SumMethod.INTEGERS, one)
    found = sums_by(method, many)

    assert found.integers == tuple(rows * k for k in want.integers)
    assert found.weight_exponent == want.weight_exponent


@compiled
def test_every_variant_gives_the_same_integers():
    block = of(11, 300, scales=(3.0, 1e-4, 7.0)).block(slice(300))
    points = (block.source, block.target, block.springs)
    found = [springs_by_limbs(library, *points) for library in libraries_of_all_variants()]

    assert found[0] is not None
    assert found == [found[0]] * len(found)


@compiled
@pytest.mark.parametrize("method", [springs_by_exponent, springs_by_limbs])
def test_compiled_code_refuses_what_is_not_finite_and_other_shapes(method):
    points, factors = np.ones((4, 3)), np.ones((4, 6))
    broken = factors.copy()
    broken[2, 3] = np.nan
    with pytest.raises(ValueError, match="not finite"):
        method(loaded_library(), points, points, broken)
    with pytest.raises(ValueError, match="expected"):
        method(loaded_library(), points, points[:3], factors)


@compiled
def test_blocks_of_a_mapped_file_add_up_to_the_same_integers(tmp_path, monkeypatch):
    whole = of(9, 300)
    mapped = []
    for name in ("source", "target", "factors"):
        np.save(tmp_path / f"{name}.npy", getattr(whole, name))
        mapped.append(np.load(tmp_path / f"{name}.npy", mmap_mode="r"))
    monkeypatch.setattr("certreg.problem.arrays.BLOCK_POINTS", 64)
    problem = RegistrationProblem(*mapped[:2], factors=mapped[2])
    want = spring_moments(whole)

    assert spring_moments(problem) == want
    for method in COMPILED:
        assert sums_by(method, problem) == sums_by(SumMethod.INTEGERS, whole)


@compiled
def test_points_of_too_many_sizes_for_limbs_go_by_exponents_and_then_by_integers():
    problem = of(12, 1100, decades=290.0)

    assert fastest_method(problem) is SumMethod.BY_EXPONENT
    assert fastest_method(of(12, 1100)) is SumMethod.LIMBS
    block = problem.block(slice(1100))
    points = (block.source, block.target, block.springs)
    assert springs_by_limbs(loaded_library(), *points) is None


@compiled
@pytest.mark.parametrize("n", [3, 20, 1100])
def test_the_second_method_is_another_one(n):
    problem = of(10, n)

    assert fastest_method(problem) is not second_method(problem) or n < 6


ROUNDING = 1e-12  # of the largest entry of the form; 1000 points


def problem_of(n=1000, *, scale=1.0, stiff=1.0, offset=0.0, seed=3):
    rng = np.random.default_rng(seed)
    source, target = (scale * (rng.normal(size=(n, 3)) + offset) for _ in range(2))
    return RegistrationProblem(source, target, factors=stiff * rng.normal(size=(n, 6)))


def worst_entry(problem):
    """The largest difference of both forms, over the largest entry of the exact one."""
    found = floating_spring_moments(problem)
    objective = Springs.of(problem)
    one = max(abs(entry) for row in objective.form() for entry in row)
    exact = np.array([[entry / one for entry in row] for row in objective.form()])
    own = power_of_two(found.weight_exponent + 2 * found.length_exponent)
    worth = float(objective.unit * one / own)
    return np.abs(found.form / worth - exact).max() / np.abs(exact).max()


@pytest.mark.parametrize(
    "problem",
    [
        problem_of(),
        problem_of(7),
        problem_of(300, offset=1e4),
        problem_of(scale=1e200),
        problem_of(scale=1e-200),
        problem_of(stiff=1e-150),
        problem_of(scale=1e-150, stiff=1e150),
    ],
)
def test_the_form_is_near_the_exact_one(problem):
    assert worst_entry(problem) < ROUNDING


def test_numpy_finds_the_same(monkeypatch):
    want = floating_spring_moments(problem_of()).sums
    monkeypatch.setattr(floating_stiffness, "library_if_any", lambda: None)

    np.testing.assert_allclose(floating_spring_moments(problem_of()).sums, want, rtol=1e-9)


def test_a_few_first_points_far_from_the_rest_do_not_matter():
    problem = problem_of(2000)
    source, target = problem.source.copy(), problem.target.copy()
    source[::62] += 1e9  # all that the first origin is made of
    target[::62] -= 1e9
    factors = np.array(problem.factors)
    factors[::62] = 0.0

    assert worst_entry(RegistrationProblem(source, target, factors=factors)) < ROUNDING


@pytest.mark.skipif(library_if_any() is None, reason="nothing is compiled")
def test_one_pass_is_enough_for_most(monkeypatch):
    passes = []
    summed = floating_stiffness._summed
    monkeypatch.setattr(
        floating_stiffness, "_summed", lambda *given: passes.append(1) or summed(*given)
    )
    floating_spring_moments(problem_of(offset=1e3))

    assert len(passes) == 1
