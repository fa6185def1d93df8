"""The pass over the points: its sums, the moments from them, and the pose in floating point."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strategies
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

import certreg
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.geometry.so3 import angle_between, rotation_matrix
from certreg.objective.isotropic import Isotropic
from certreg.problem import floating_sums as sums
from certreg.problem.floating_sums import CloudPair, compiled, floating_sums
from certreg.problem.moments import exact_moments, floating_moments, moments_of_clouds
from certreg.registration import closed_form

ROOT = Path(__file__).parents[2]
UNIT = Fraction(1, 2**53)
ONE = 2**160
PASSES: dict[str, Any] = {"NumPy": sums._plain, "C": compiled()}
PASSES = {name: one_pass for name, one_pass in PASSES.items() if one_pass is not None}
SIZES = [1, 7, 8, 9, 255, 256, 257, 700]


def clouds(n, seed=0, *, weighted=True, single=False, offset=0.0):
    rng = np.random.default_rng(seed)
    kind = np.float32 if single else np.float64
    x, y = ((rng.normal(size=(n, 3)) + offset).astype(kind) for _ in range(2))
    weights: Any = rng.uniform(0.1, 2.0, size=n) if weighted else None
    origin = offset + rng.normal(size=6)
    return CloudPair(source=x, target=y, weights=weights, origin=origin)


def exact_sums(given_):
    """The 23 sums and those of the absolute terms, of rounded deviations, in fractions."""
    x = given_.source.astype(float) - given_.origin[:3]
    y = given_.target.astype(float) - given_.origin[3:]
    w = np.ones(given_.n) if given_.weights is None else given_.weights.astype(float)
    value, size = [0] * 23, [0] * 23
    for a, *places in zip(w.tolist(), x.tolist(), y.tolist(), strict=True):
        m = whole(a)
        p, q = ([whole(e) for e in place] for place in places)
        terms = [ONE * ONE, sum(e * e for e in q), *(ONE * e for e in p), *(ONE * e for e in q)]
        terms += [p[i] * p[j] for i in range(3) for j in range(i, 3)]
        terms += [e * f for e in q for f in p]
        for k, term in enumerate(terms):
            value[k] += m * term
            size[k] += abs(m * term)
    return [Fraction(v, ONE**3) for v in value], [Fraction(v, ONE**3) for v in size]


def whole(number):
    """A double in units of 2^-160, far below the last bit of any that is drawn here."""
    numerator, denominator = number.as_integer_ratio()
    assert denominator <= ONE
    return numerator * (ONE // denominator)


# The sums ----------------------------------------------------------------------------------------


@pytest.mark.one_in(4)
@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("weighted", [True, False])
def test_every_sum_is_within_260_units_of_its_terms(n, weighted):
    given_ = clouds(n, n, weighted=weighted, offset=100.0)
    value, size = exact_sums(given_)

    for name, one_pass in PASSES.items():
        found, negative = one_pass(given_)
        assert not negative, name
        for row, exact, terms in zip(found.tolist(), value, size, strict=True):
            assert abs(Fraction(row[0]) + Fraction(row[1]) - exact) <= 260 * UNIT * terms, name


def test_blocks_lose_nothing_however_many_there_are():
    # Next to 2^52 a double is whole: plain sums lose what 32 points add, 0.4, in all 512 blocks.
    # Only in the blocks of the two large numbers may something be lost: 510 times 0.013 at most.
    n = 1 << 17
    x = np.full((n, 3), 0.013)
    x[0], x[-1] = 2.0**52, -(2.0**52)
    given_ = CloudPair(source=x, target=x, weights=None, origin=np.zeros(6))
    exact = float(Fraction(0.013) * (n - 2))

    for one_pass in PASSES.values():
        found = one_pass(given_)[0].sum(axis=1)
        assert found[2:8] == pytest.approx(np.full(6, exact), rel=0.0, abs=510 * 0.013)


@pytest.mark.slow
@settings(max_examples=25)
@given(st.integers(0, 2**32), st.integers(1, 300), st.booleans())
def test_compiled_and_plain_sums_agree_within_their_bounds(seed, n, single):
    given_ = clouds(n, seed, single=single)
    _, size = exact_sums(given_)
    tables = [one_pass(given_)[0].sum(axis=1) for one_pass in PASSES.values()]

    bound = np.array([float(521 * UNIT * s) for s in size])
    assert (np.abs(tables[0] - tables[-1]) <= bound).all()


def layouts(x, y, w):
    """The same numbers in other places of memory."""
    n = len(x)
    wide = np.full((2, n, 5), np.nan)
    wide[:, :, 1:4] = x, y
    doubled = np.full((2, 2 * n, 3), np.nan)
    doubled[:, ::2] = x, y
    packed = np.zeros((2, n), dtype=[("tag", "u1"), ("point", x.dtype, (3,))])
    packed["point"] = x, y
    spread = np.full(2 * n, np.nan)
    spread[::2] = w
    yield "columns", x.T.copy().T, y.T.copy().T, w
    yield "wider rows", wide[0, :, 1:4].astype(x.dtype), wide[1, :, 1:4].astype(x.dtype), w
    yield "parts of rows", *np.asarray(wide, dtype=x.dtype)[:, :, 1:4], w
    yield "every second row", *np.asarray(doubled, dtype=x.dtype)[:, ::2], w
    yield "every second of a column", *(np.repeat(a.T, 2, axis=1)[:, ::2].T for a in (x, y)), w
    yield "unaligned", packed["point"][0], packed["point"][1], w
    yield "backwards", x[::-1].copy()[::-1], y[::-1].copy()[::-1], w
    yield "columns backwards", *(a[:, ::-1].copy()[:, ::-1] for a in (x, y)), w
    yield "one of each", x, y.T.copy().T, w
    yield "weights in places", x, y, spread[::2]


@pytest.mark.parametrize("name", PASSES)
@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("n", [3, 8, 700])
def test_the_place_in_memory_changes_no_bit(name, single, n):
    given_ = clouds(n, 5, single=single)
    expected = PASSES[name](given_)[0]
    for layout, x, y, w in layouts(given_.source, given_.target, given_.weights):
        other = CloudPair(source=x, target=y, weights=w, origin=given_.origin)

        assert (PASSES[name](other)[0] == expected).all(), layout


@pytest.mark.parametrize("name", PASSES)
def test_a_float_is_the_double_of_its_value(name):
    given_ = clouds(1000, 2, single=True)
    weights = np.asarray(given_.weights, dtype=np.float32)
    for kind in (np.float64, np.dtype(">f4"), np.dtype(">f8")):
        x, y, w = (a.astype(kind) for a in (given_.source, given_.target, weights))
        wide = CloudPair(source=x, target=y, weights=w, origin=given_.origin)
        narrow = CloudPair(
            source=given_.source, target=given_.target, weights=weights, origin=given_.origin
        )

        assert (PASSES[name](wide)[0] == PASSES[name](narrow)[0]).all()


@pytest.mark.parametrize("name", PASSES)
@pytest.mark.parametrize("rows", [True, False])
def test_every_second_float_is_a_weight_and_no_double(name, rows):
    """Floats eight bytes apart stand where doubles would; the points beside them are doubles."""
    given_ = clouds(700, 4)
    pairs = np.asarray(given_.weights, dtype=np.float32).repeat(2)
    pairs[1::2] = 3.0
    places = [a if rows else a.T.copy().T for a in (given_.source, given_.target)]
    narrow, wide = (
        CloudPair(source=places[0], target=places[1], weights=w, origin=given_.origin)
        for w in (pairs[::2], pairs[::2].astype(float))
    )

    assert (PASSES[name](narrow)[0] == PASSES[name](wide)[0]).all()


@pytest.mark.parametrize("points", [10, 4096, 300_000])
def test_threads_change_no_bit(points, monkeypatch):
    small_chunks(monkeypatch)
    given_ = clouds(points, 3)
    one, two, many = (floating_sums(given_, threads=k) for k in (1, 2, 5))

    for other in (two, many):
        for name in ("mass", "source", "target", "scatter", "cross", "spread"):
            assert (np.asarray(getattr(one, name)) == getattr(other, name)).all()


def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Chunks so small that there are many."""
    monkeypatch.setattr(sums, "COMPILED_POINTS", 0)
    monkeypatch.setattr(sums, "CHUNK_POINTS", 1000)


@pytest.mark.parametrize("name", PASSES)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_is_none_in_its_sum(name, bad):
    for place in range(7):
        given_ = clouds(500, 4)
        arrays = (given_.source, given_.target, np.asarray(given_.weights).reshape(-1, 1))
        arrays[place // 3][311, place % 3] = bad
        found = PASSES[name](given_)[0].sum(axis=1)

        assert not np.isfinite(found[[2, 3, 4, 5, 6, 7, 0][place]])


@pytest.mark.parametrize("name", PASSES)
def test_a_negative_weight_is_seen_wherever_it_stands(name):
    for row in (0, 7, 255, 256, 499):
        given_ = clouds(500, 4)
        np.asarray(given_.weights)[row] = -1e-300

        assert PASSES[name](given_)[1]


# Moments -----------------------------------------------------------------------------------------


def distance_to_exact(problem, found):
    """The largest error of an entry of C, and the bound on it, as fractions."""
    m = exact_moments(problem)
    unit = Fraction(2) ** (found.weight_exponent + found.source_exponent + found.target_exponent)
    rows = zip(found.cross_covariance.tolist(), m.cross, strict=True)
    errors = [
        abs(Fraction(a) - m.cross_unit * e / unit)
        for row, entries in rows
        for a, e in zip(row, entries, strict=True)
    ]
    return max(errors), Fraction(found.rounding)


@pytest.mark.slow
@given(strategies.problems())
def test_rounding_bounds_the_error_over_the_whole_zoo(problem):
    found = floating_moments(problem)
    assume(found.rounding > 1e-250)  # below, products of weights 300 decades apart underflow
    error, bound = distance_to_exact(problem, found)

    assert error <= bound


@pytest.mark.parametrize("far", [1e9, 30.0])
@pytest.mark.parametrize("seed", range(6))
def test_an_origin_far_from_the_mean_costs_no_digits(seed, far):
    # The first points, whose mean is the first origin, are far away and weigh next to nothing.
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(640, 3))
    x[::20] += far
    weights = np.ones(640)
    weights[::20] = 1e-30
    y = x @ strategies.random_rotation(rng).T
    problem = certreg.RegistrationProblem(x, y, weights=weights)
    found = floating_moments(problem)
    size = np.sqrt(np.trace(found.source_scatter) * found.target_spread)

    assert distance_to_exact(problem, found)[0] <= 2e-15 * size
    assert found.rounding <= 4e-13 * size


@pytest.mark.parametrize("far", [1e20, 1e40])
def test_each_pass_takes_fifteen_digits_from_the_distance_of_the_origin(far):
    """An origin 1e40 away is 1e25 away in the next pass, 1e10 in the third, near in the last."""
    rng = np.random.default_rng(6)
    x = rng.normal(size=(640, 3))
    x[::20] += far * rng.uniform(0.5, 2.0, (32, 3))
    weights = rng.uniform(0.5, 2.0, 640)
    weights[::20] = 1e-200
    y = rng.normal(size=(640, 3))
    problem = certreg.RegistrationProblem(x, y, weights=weights)
    found = floating_moments(problem)
    size = np.sqrt(np.trace(found.source_scatter) * found.target_spread)

    assert distance_to_exact(problem, found)[0] <= 2e-15 * size


@pytest.mark.parametrize("far", ["source", "target"])
def test_an_origin_far_from_the_mean_of_one_cloud_costs_no_digits(far):
    rng = np.random.default_rng(4)
    x, y = rng.normal(size=(2, 640, 3))
    weights = np.ones(640)
    weights[::20] = 1e-30
    (x if far == "source" else y)[::20] += 1e9
    problem = certreg.RegistrationProblem(x, y, weights=weights)
    found = floating_moments(problem)
    size = np.sqrt(np.trace(found.source_scatter) * found.target_spread)

    assert distance_to_exact(problem, found)[0] <= 2e-15 * size


@pytest.mark.parametrize("wide", ["source", "target"])
def test_points_further_apart_than_the_doubles_keep_their_digits(wide):
    rng = np.random.default_rng(7)
    x, y = rng.normal(size=(2, 40, 3))
    points = x if wide == "source" else y
    points[:] = 1e307 * points - 1.2e308
    points[::3] *= -1.0
    problem = certreg.RegistrationProblem(x, y)
    found = floating_moments(problem)
    error, bound = distance_to_exact(problem, found)

    assert error <= bound < 1e-11 * np.abs(found.cross_covariance).max()


@pytest.mark.slow
@given(st.integers(0, 2**32), st.sampled_from([-150, 0, 150]), st.integers(1, 40))
@example(33, -150, 2)  # whose weights are all below a half: over a power of two of their own
def test_scaling_and_order_and_shift_change_nothing_but_rounding(seed, decades, n):
    rng = np.random.default_rng(seed)
    x, y = rng.normal(size=(2, n, 3))
    w = rng.uniform(0.1, 1.0, size=n)
    base, scale, order = (
        moments_of_clouds(x, y, w),
        2.0 ** round(decades * 3.32),
        rng.permutation(n),
    )
    shift = np.round(2.0**20 * rng.normal(size=3)) / 2.0**20
    scaled = moments_of_clouds(x * scale, y * scale, w)
    sorted_ = moments_of_clouds(x[order], y[order], w[order])
    moved = moments_of_clouds(np.round(x * 2.0**20) / 2.0**20 + shift, y, w)
    plain = moments_of_clouds(np.round(x * 2.0**20) / 2.0**20, y, w)

    def exponent(m):
        return m.source_exponent + m.target_exponent + m.weight_exponent

    def C(m):
        return np.ldexp(m.cross_covariance, exponent(m))

    def bound(m):
        return np.ldexp(m.rounding, exponent(m))

    unscaled = np.ldexp(scaled.cross_covariance, exponent(scaled) - 2 * round(decades * 3.32))
    assert np.abs(unscaled - C(base)).max() <= 2 * bound(base)
    assert np.abs(C(sorted_) - C(base)).max() <= 2 * bound(base)
    assert np.abs(C(moved) - C(plain)).max() <= 2 * bound(plain)


@pytest.mark.parametrize("n", [50, 5000])  # whose origin is the mean, or that of a sample
def test_equal_weights_in_the_place_of_one_are_weights(n):
    given_ = clouds(n, 8)
    one = moments_of_clouds(given_.source, given_.target, np.broadcast_to(np.array(0.3), n))
    all_ = moments_of_clouds(given_.source, given_.target, np.full(n, 0.3))
    C = np.ldexp(one.cross_covariance, one.weight_exponent)

    assert np.abs(C - all_.cross_covariance).max() <= 2 * all_.rounding


# The pose ----------------------------------------------------------------------------------------


def pair(n=1000, seed=1, scale=1.0, offset=0.0):
    rng = np.random.default_rng(seed)
    R = strategies.random_rotation(rng)
    x = rng.normal(size=(n, 3))
    y = x @ R.T + rng.normal(size=3) + 0.01 * rng.normal(size=(n, 3))
    return (x + offset) * scale, (y + offset) * scale, rng.uniform(0.5, 2.0, size=n)


@pytest.mark.parametrize("n", [3, 10, 1000, 5000])
@pytest.mark.parametrize(("scale", "offset"), [(1.0, 0.0), (1e-150, 0.0), (1e150, 0.0), (1.0, 1e8)])
def test_the_pose_is_the_certified_one(n, scale, offset):
    x, y, w = pair(n, scale=scale, offset=offset)
    pose = certreg.register(x, y, w)
    problem = certreg.RegistrationProblem(x, y, weights=w)
    found = Isotropic(exact_moments(problem))
    exact = np.array(found.quaternions[0], dtype=float)
    middle = pose.rotation @ (w @ x / w.sum()) + pose.translation

    assert angle_between(exact / np.linalg.norm(exact), pose.quaternion_wxyz) <= 2e-14
    assert np.allclose(middle, w @ y / w.sum(), rtol=1e-12, atol=1e-12 * scale)
    assert np.allclose(pose.rotation, rotation_matrix(tuple(pose.quaternion_wxyz)), atol=1e-15)


def test_transposes_lists_and_whole_numbers_are_clouds():
    x = np.array([[0, 0, 0], [3, 0, 0], [0, 2, 0], [1, 1, 5]])
    pose = certreg.register(x, (x + 1).tolist())
    other = certreg.register(np.ascontiguousarray(x.T.astype(float)).T, x + 1.0)

    assert np.allclose(pose.translation, 1.0)
    assert (pose.rotation == other.rotation).all()


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda specimen: specimen.name)
def test_a_rotation_that_is_not_unique_is_refused(specimen):
    if specimen.pattern[0] == 1:
        certreg.register(specimen.source, specimen.target)
        return
    with pytest.raises(DegenerateProblemError, match=r"rounding may move.*certreg\.certify"):
        certreg.register(specimen.source, specimen.target)


@pytest.mark.parametrize(("share", "refused"), [(0.9, False), (1.1, True)])
def test_a_rotation_that_the_rounding_of_the_sums_may_turn_is_refused(share, refused):
    """The rounding that may turn it by 1e-3: 2 e < 1e-3 (gap - e), e = 3 sqrt(3) rounding."""
    x = np.vstack([np.diag([3.0, 2, 1]), -np.diag([3.0, 2, 1])])
    moments = moments_of_clouds(x, x, None, threads=1)
    gap = 20.0  # C = diag(18, 8, 2): 2 (8 + 2)
    most = 1e-3 * gap / 2.001 / (3 * np.sqrt(3))
    rounded = replace(moments, rounding=share * most)
    if not refused:
        assert closed_form._optimal_quaternion(rounded)[0] == pytest.approx(1.0)
        return
    with pytest.raises(DegenerateProblemError, match="rounding may move"):
        closed_form._optimal_quaternion(rounded)


@pytest.mark.parametrize("cloud", [[[1, 2, 3]], [[0, 0, 0], [1, 1, 1]], [[1, 1, 1]] * 5])
def test_points_on_a_line_are_refused(cloud):
    with pytest.raises(DegenerateProblemError):
        certreg.register(cloud, cloud)


@pytest.mark.slow
@given(st.integers(0, 2**32), st.integers(0, 60))
def test_a_pose_that_is_given_is_within_the_promise(seed, thin):
    # Nearly on a line, ever thinner: refused at last, and until then within 1e-3 of the exact pose.
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(12, 3)) * [1.0, 2.0**-thin, 2.0**-thin]
    x = x @ strategies.random_rotation(rng).T
    y = x @ strategies.random_rotation(rng).T
    found = Isotropic(exact_moments(certreg.RegistrationProblem(x, y)))
    try:
        pose = certreg.register(x, y)
    except DegenerateProblemError:
        assert thin > 10
        return
    exact = np.array(found.quaternions[0], dtype=float)

    assert angle_between(exact / np.linalg.norm(exact), pose.quaternion_wxyz) <= 1.001e-3
    assert thin < 20


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize(("which", "name"), [(0, "source"), (1, "target"), (2, "weights")])
@pytest.mark.parametrize("n", [10, 5000])
def test_the_row_that_is_no_number_is_named(bad, which, name, n):
    arrays = pair(n)
    arrays[which][7] = bad
    with pytest.raises(InvalidProblemError, match=f"^{name} row 7 "):
        certreg.register(*arrays)


@pytest.mark.parametrize(("which", "bad"), [(0, np.nan), (2, -1e-3)])
def test_the_row_is_counted_over_all_chunks(which, bad, monkeypatch):
    small_chunks(monkeypatch)
    arrays = pair(5000)
    arrays[which][4321] = bad
    with pytest.raises(InvalidProblemError, match=r"^(source|weights) row 4321 ") as refusal:
        certreg.register(*arrays)
    assert refusal.value.row == 4321


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda x, y, w: (x[:-1], y, w), "999 points, target has 1000"),
        (lambda x, y, w: (x.T, y, w), "transpose"),
        (lambda x, y, w: (x[:0], y[:0], w[:0]), "no points"),
        (lambda x, y, w: (x, y, w[1:]), r"weights has shape \(999,\)"),
        (lambda x, y, w: (x, y, -w), "weights row 0 .*>= 0"),
        (lambda x, y, w: (x, y, 0 * w), "all weights are zero"),
        (lambda x, y, w: (x, y, np.broadcast_to(-1.0, 1000)), "weights row 0 .*>= 0"),
        (lambda x, y, w: (x, y, np.broadcast_to(0.0, 1000)), "all weights are zero"),
        (lambda x, y, w: (x.astype(str), y, w), "real numbers"),
        (lambda x, y, w: ([[2**62 + 1] * 3] * 1000, y, w), "no double holds"),
    ],
)
def test_what_is_no_pair_of_clouds_is_refused(change, words):
    with pytest.raises(InvalidProblemError, match=words):
        certreg.register(*change(*pair()))


@pytest.mark.parametrize("dtype", ["<i8", "<i4", "<u2", "<f2", ">f8"])
def test_many_points_of_any_type_are_those_of_their_values(dtype):
    values = np.random.default_rng(2).integers(0, 100, size=(2, 5000, 3)).astype(dtype)
    x, y = values.astype(float)
    found, plain = moments_of_clouds(*values), moments_of_clouds(x, y)

    assert (found.cross_covariance == plain.cross_covariance).all()
    assert (found.source_centroid == plain.source_centroid).all()


@pytest.mark.parametrize("points", [5, 5000])
@pytest.mark.parametrize("threads", [0, -1, "2", 1.0, None, True])
def test_a_number_of_threads_that_is_none_is_refused(threads, points):
    with pytest.raises(InvalidProblemError, match=f"^threads is {threads!r}: it must be"):
        certreg.register(*pair(points), threads=threads)


def test_minus_zero_is_no_negative_weight():
    x, y, w = pair()
    w[3] = -0.0

    assert np.isfinite(certreg.register(x, y, w).rotation).all()


def test_a_mapped_file_is_registered_as_the_array(tmp_path):
    x, y, w = pair(5000)
    poses = [certreg.register(x, y, w)]
    for order in (np.ascontiguousarray, np.asfortranarray):
        paths = [tmp_path / name for name in ("x.npy", "y.npy")]
        for path, points in zip(paths, (x, y), strict=True):
            np.save(path, order(points))
        mapped = [np.load(path, mmap_mode="r") for path in paths]
        poses.append(certreg.register(mapped[0], mapped[1], w, threads=2))

    assert all((pose.rotation == poses[0].rotation).all() for pose in poses)


@pytest.mark.slow
def test_without_compiled_code_the_pose_is_the_same_within_rounding(tmp_path):
    script = (
        "import numpy as np, certreg, certreg.problem.floating_sums as s;"
        "rng = np.random.default_rng(0);"
        "x = rng.normal(size=(5000, 3)); y = x[:, [1, 2, 0]] + 0.1 * rng.normal(size=(5000, 3));"
        "print(s.compiled() is None, *certreg.register(x, y).quaternion_wxyz.tolist())"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": str(ROOT), "CERTREG_VARIANT": "python"},
        capture_output=True,
        text=True,
        check=True,
        encoding="utf-8",
    )
    without, *numbers = done.stdout.split()
    rng = np.random.default_rng(0)
    x = rng.normal(size=(5000, 3))
    ours = certreg.register(x, x[:, [1, 2, 0]] + 0.1 * rng.normal(size=(5000, 3))).quaternion_wxyz
    plain = np.array(numbers, dtype=float)

    assert (without, done.stderr) == ("True", "")
    assert angle_between(ours, plain) <= 2e-14


@pytest.mark.parametrize("n", [3, 40, 700])
@pytest.mark.parametrize(("offset", "scale"), [(0, 1), (1e6, 1), (0, 1e-150), (0, 1e150)])
def test_rounding_is_no_less_than_what_its_proof_adds_up(n, offset, scale):
    """Three times 260 u sqrt(sum w |x|^2 sum w |y|^2), about origins: never less than about means.

    Errors seen are a thousandth of that, so no comparison with them would miss a constant.
    """
    rng = np.random.default_rng(n)
    problem = strategies.random_problem(rng, n=n, offset=offset, scale=scale, decades=6.0)
    found, exact = floating_moments(problem), exact_moments(problem)
    unit = Fraction(2) ** (exact.weight_exponent + 2 * exact.source_exponent) / exact.mass
    source = unit * sum(exact.source_scatter[k][k] for k in range(3))
    product = source * (exact.spread - source)
    square = Fraction(2) ** (
        2 * (found.source_exponent + found.target_exponent + found.weight_exponent)
    )

    assert Fraction(found.rounding) ** 2 * square >= (3 * 260 * UNIT) ** 2 * product
    assert found.rounding < 1.0
