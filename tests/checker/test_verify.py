"""The checker proves what is true, in numbers to be trusted, and refuses any stronger claim."""

from __future__ import annotations

import ast
import copy
import itertools
import json
import math
import os
import struct
import subprocess
import sys
from array import array
from dataclasses import FrozenInstanceError, dataclass, replace
from decimal import ROUND_FLOOR, Decimal
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import ClassVar

import certificates as oracle
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from samples import examples

checker = import_module("certreg.verify")  # `certreg.verify` itself is a function of the package
FILE = Path(checker.__file__ or "")
GENERIC = oracle.random_problem(seed=3)
UNEQUAL = "the certified weights are unequal: give --weights FILE"


@pytest.fixture(scope="module")
def generic():
    return oracle.produce(*GENERIC)


def verdict(certificate, clouds=None):
    return checker.check(oracle.dump(certificate), clouds)


def changed(certificate, **parts):
    """A copy with other claims, other optimality numbers or another pose."""
    certificate = copy.deepcopy(certificate)
    for name, value in parts.items():
        place = next(
            (part for part in (certificate["claims"], certificate["optimality"]) if name in part),
            certificate,
        )
        place[name] = value
    return certificate


def clouds_of(source, target, weights=None):
    flat = [array("d", np.ravel(cloud).astype(float)) for cloud in (source, target)]
    return checker.Clouds(*flat, None if weights is None else array("d", weights))


def without_data(certificate):
    problem = {**certificate["problem"], "data": None}
    return {**certificate, "problem": problem}


def run(*arguments, code=0):
    """The file alone, isolated, without site packages and with an empty environment."""
    command = [sys.executable, "-I", "-S", str(FILE), *map(str, arguments)]
    done = subprocess.run(
        command, capture_output=True, text=True, env={}, check=False, timeout=60, encoding="utf-8"
    )
    assert "Traceback" not in done.stderr
    assert done.returncode == code, done.stdout + done.stderr
    return done


# --- What is true is verified --------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", oracle.PATTERNS)
def test_every_kind_of_equilibrium_set_is_verified_and_its_pattern_is_the_only_one(name):
    pattern, source, target = oracle.PATTERNS[name]
    certificate = oracle.produce(source, target, pattern=pattern)

    assert oracle.holds(certificate)
    assert verdict(certificate).verified
    for length in (1, 2, 3, 4):
        for other in itertools.product((1, 2, 3, 4), repeat=length):
            forged = changed(certificate, pattern=list(other), unique=False, unstable=None)
            assert verdict(forged).verified == (list(other) == pattern)


@pytest.mark.parametrize("name", oracle.PATTERNS)
def test_unstable_directions_are_proved_where_three_moving_points_are_not_collinear(name):
    pattern, source, target = oracle.PATTERNS[name]
    certificate = oracle.produce(source, target, pattern=pattern)
    indices = [sum(pattern[:k]) for k in range(len(pattern))]
    solid = np.linalg.matrix_rank(np.array(source) - np.mean(source, axis=0)) > 1

    outcome = verdict(changed(certificate, unstable=indices))

    assert outcome.verified == solid
    assert solid or "claims.unstable" in outcome.reason
    assert verdict(changed(certificate, unstable=None)).verified


def test_points_of_weight_zero_do_not_make_a_cloud_noncollinear():
    source = [[1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 1, 0]]
    certificate = oracle.produce(source, source, [1, 1, 1, 0], pattern=[2, 2])

    assert verdict(certificate).verified
    assert not verdict(changed(certificate, unstable=[0, 2])).verified


@pytest.mark.slow
def test_multiplicities_follow_from_the_signed_singular_values_in_any_position():
    rotations = [rotation_numerator(q) for q in ((1, 0, 0, 0), (1, 2, -1, 3), (5, -1, 2, 0))]
    for d in itertools.product(range(-3, 4), repeat=3):
        for U, V in itertools.product(rotations, repeat=2):
            C = (U @ np.diag(d) @ V.T).tolist()
            signed = sorted(map(abs, d), reverse=True)
            signed[2] *= 1 if np.prod(d) >= 0 else -1
            a, b, c = signed
            values = sorted([a + b + c, a - b - c, b - a - c, c - a - b], reverse=True)
            expected = [len(list(group)) for _, group in itertools.groupby(values)]

            assert checker.multiplicities(C) == expected


def rotation_numerator(q):
    """|q|^2 R(q), of integers."""
    w, x, y, z = q
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def test_the_quadratic_form_of_k_is_the_trace_objective():
    random = np.random.default_rng(5)
    for _ in range(50):
        C = random.integers(-99, 100, (3, 3))
        q = random.integers(-9, 10, 4)
        K = np.array(checker.davenport(C.tolist()))

        assert q @ K @ q == np.trace(rotation_numerator(q).T @ C)
        assert (K == K.T).all()


@pytest.mark.slow
def test_definiteness_is_that_of_all_leading_minors():
    random = np.random.default_rng(6)
    seen = set()
    for trial in range(600):
        size = 3 + trial % 2
        root = random.integers(-4, 5, (size, size - trial % 3 // 2))
        A = (root @ root.T + np.diag(random.integers(-1, 3, size))).tolist()
        expected = oracle.positive_definite([[Fraction(x) for x in row] for row in A])
        seen.add(expected)

        assert checker.positive_definite([row[i:] for i, row in enumerate(A)]) == expected

    assert seen == {True, False}
    assert not checker.positive_definite([[0] * k for k in (4, 3, 2, 1)])
    for k in range(4):  # each minor decides in turn
        diagonal = [[(1 if j != k else -1) * (i == j) for j in range(i, 4)] for i in range(4)]
        assert not checker.positive_definite(diagonal)


@pytest.mark.parametrize("magnitude", [1e-100, 1e-30, 1.0, 1e8, 1e90])
def test_moments_are_exact_at_every_magnitude(magnitude):
    source, target, weights = oracle.random_problem(seed=8, n=7)
    source, target = source * magnitude, target / magnitude
    source[0] = [5e-324, 1e308, 0.0]
    weights[3] = 0.0
    content = oracle.problem_bytes(source, target, weights)[26:]
    mass, C, S2 = oracle.exact_moments(source, target, weights)

    m, exponent = checker.moments(content, 7)

    unit = Fraction(2) ** exponent
    assert m[0][0] * unit == mass
    for j, k in itertools.product(range(3), repeat=2):
        cross = m[0][0] * m[1 + k][4 + j] - m[0][1 + k] * m[0][4 + j]
        second = m[0][0] * m[1 + min(j, k)][1 + max(j, k)] - m[0][1 + k] * m[0][1 + j]
        assert cross * unit**2 == mass * C[j][k]
        assert second * unit**2 == mass * S2[j][k]


@pytest.mark.slow
def test_moments_of_several_blocks_add_up():
    n = 2 * checker.BLOCK + 5
    random = np.random.default_rng(9)
    source, target = random.integers(-(2**20), 2**20, (2, n, 3))
    weights = random.integers(0, 2**10, n)
    a = np.column_stack([np.ones(n, dtype=int), source, target]).astype(object)

    m, exponent = checker.moments(oracle.problem_bytes(source, target, weights)[26:], n)

    for i in range(4):
        for j in range(i, 7):
            total = int((weights * a[:, i] * a[:, j]).sum())
            assert m[i][j] * Fraction(2) ** exponent == total


@pytest.mark.parametrize("block", [1, 2, 3, 6])
def test_moments_are_the_same_however_the_points_are_split(monkeypatch, block):
    """The numbers, and so the powers of two, are others in every block."""
    source, target, weights = oracle.random_problem(seed=4, n=7)
    scales = 2.0 ** np.arange(-60, 80, 20)
    content = oracle.problem_bytes(source / scales[:, None], target * scales[:, None] ** 2, scales)
    whole, exponent = checker.moments(content[26:], 7)
    monkeypatch.setattr(checker, "BLOCK", block)
    m, other = checker.moments(content[26:], 7)

    assert np.unique(weights * scales).size == 7
    for i, j in itertools.combinations_with_replacement(range(7), 2):
        assert m[i][j] * Fraction(2) ** other == whole[i][j] * Fraction(2) ** exponent


@pytest.mark.slow
@pytest.mark.parametrize("count", [8, pytest.param(40, marks=pytest.mark.long)])
def test_optimality_is_decided_as_by_the_definition(count: int):
    """Near the threshold of delta, for poses that are optimal, almost and not at all."""
    random = np.random.default_rng(10)
    seen = []
    for seed in range(count):
        source, target, weights = oracle.random_problem(seed, n=5, noise=0.5)
        _, C, _ = oracle.exact_moments(source, target, weights)
        K = oracle.rotation_form(C)
        values, vectors = np.linalg.eigh(np.array(K, dtype=float))
        q = [
            round(c * 2**30)
            for c in vectors[:, 3] + random.choice([0, 1e-6, 1e-2, 1]) * random.normal(size=4)
        ]
        common = math.lcm(*(Fraction(entry).denominator for row in K for entry in row))
        exact = [[int(entry * common) for entry in row] for row in K]
        form = sum(K[i][j] * q[i] * q[j] for i in range(4) for j in range(4))
        norm = sum(c * c for c in q)
        for power in range(-60, 8, 2):
            delta = Fraction(2) ** power
            mu = Fraction(float(values[3] - values[2])) * Fraction(int(random.integers(0, 5)), 4)
            expected = oracle.positive_definite(oracle.optimality_matrix(K, q, delta, mu))
            seen.append(expected)

            one = math.lcm(common, delta.denominator, mu.denominator)
            level = int((form + (delta - mu) * norm) * one)
            assert checker.proves_level(exact, one // common, q, level, int(mu * one)) == expected

    assert 0.2 < np.mean(seen) < 0.8


@pytest.mark.slow
def test_a_certificate_is_verified_at_every_scale_of_lengths_and_weights():
    source, target, weights = GENERIC
    for a, b, c in [(1e-100, 1e-100, 1e-50), (1e90, 1e-90, 1e10), (1e70, 1e70, 1e70), (1, 1e-7, 3)]:
        assert verdict(oracle.produce(source * a, target * b, weights * c)).verified


def test_a_certificate_of_clouds_far_from_the_origin_is_verified():
    source, target, weights = GENERIC

    assert verdict(oracle.produce(source + 1e8, target - 1e9, weights)).verified


@pytest.mark.slow
@pytest.mark.parametrize("n", [10_000, pytest.param(100_000, marks=pytest.mark.long)])
def test_a_hundred_thousand_points_are_verified(n: int):
    assert verdict(oracle.produce_quickly(*oracle.random_problem(seed=1, n=n))).verified


def test_the_quaternion_may_have_any_length_and_either_sign(generic):
    for factor in (-1, 3, -(2**200)):
        assert verdict(changed(generic, pose=[factor * c for c in generic["pose"]])).verified


# --- What is claimed too strongly is refused, what is claimed weakly passes ----------------------


def in_small_steps(dyadic, step):
    """The dyadic changed by `step` units of 2^-60 of itself."""
    return [(dyadic[0] << 60) + step, dyadic[1] - 60]


@pytest.mark.parametrize("claim", ["gap", "sin2_half_angle"])
def test_a_bound_is_refused_when_smaller_by_one_unit_and_passes_when_larger(generic, claim):
    exact = generic["claims"][claim]

    refused = verdict(changed(generic, **{claim: in_small_steps(exact, -1)}))

    assert not refused.verified
    assert claim in refused.reason
    assert refused.theorems == ()
    assert verdict(changed(generic, **{claim: in_small_steps(exact, 0)})).verified
    assert verdict(changed(generic, **{claim: in_small_steps(exact, 1)})).verified
    assert verdict(changed(generic, **{claim: [1, 1000]})).verified
    for wrong in ([0, 0], [-1, 0], [-(10**50), 5]):
        assert claim in verdict(changed(generic, **{claim: wrong})).reason


def test_weaker_claims_pass(generic):
    for weaker in ({"sin2_half_angle": None}, {"unique": False}, {"unstable": None}):
        assert verdict(changed(generic, **weaker)).verified


def test_an_angle_is_refused_without_mu(generic):
    loose = changed(generic, mu=[0, 0], delta=[1, 10], gap=[1, 11])

    assert "sin2_half_angle" in verdict(loose).reason
    assert verdict(changed(loose, sin2_half_angle=None)).verified


@pytest.mark.parametrize("name", ["mirrored octahedron", "collinear source", "antipodes"])
def test_uniqueness_is_refused_where_the_optimum_is_not_unique(name):
    pattern, source, target = oracle.PATTERNS[name]
    certificate = oracle.produce(source, target, pattern=pattern)

    assert "unique" in verdict(changed(certificate, unique=True)).reason


@pytest.mark.slow
def test_any_other_count_of_unstable_directions_is_refused(generic):
    for other in itertools.product(range(4), repeat=4):
        forged = changed(generic, unstable=list(other))
        assert verdict(forged).verified == (list(other) == [0, 1, 2, 3])


def test_delta_must_be_positive_and_mu_not_negative(generic):
    source, target, weights = GENERIC
    _, C, _ = oracle.exact_moments(source, target, weights)
    q, K = generic["pose"], oracle.rotation_form(C)
    for delta, mu in (([0, 0], [0, 0]), ([-1, -80], [0, 0]), ([1, 20], [-1, -3])):
        assert "delta > 0, mu >= 0" in verdict(changed(generic, delta=delta, mu=mu)).reason
    # Without its sign a negative mu would pass: the matrix is positive definite all the same.
    assert oracle.positive_definite(
        oracle.optimality_matrix(K, q, Fraction(2**20), Fraction(-1, 8))
    )


def test_a_pose_that_is_not_optimal_is_refused(generic):
    source, target, weights = GENERIC
    _, C, _ = oracle.exact_moments(source, target, weights)
    _, vectors = np.linalg.eigh(np.array(oracle.rotation_form(C), dtype=float))
    w, x, y, z = generic["pose"]
    others = [[round(c * 2**60) for c in vectors[:, k]] for k in range(3)]
    for pose in (*others, [w, -x, -y, -z], [x, w, y, z], [w, x, y, z + 2**30], [1, 0, 0, 0]):
        assert "optimal" in verdict(changed(generic, pose=pose)).reason
    assert "other than 0" in verdict(changed(generic, pose=[0, 0, 0, 0])).reason


def test_the_true_optimum_is_where_the_exhaustive_search_finds_it(generic):
    """No rotation of a fine net has an objective smaller than the certified one."""
    source, target, weights = GENERIC
    mass = weights.sum()
    x, y = source - weights @ source / mass, target - weights @ target / mass
    C = (y * weights[:, None]).T @ x
    quaternions = np.random.default_rng(12).normal(size=(2000, 4))
    best = max(np.trace(rotation_numerator(q).T @ C) / (q @ q) for q in quaternions)
    q = np.array(generic["pose"], dtype=float)

    assert np.trace(rotation_numerator(q).T @ C) / (q @ q) >= best


# --- The points -----------------------------------------------------------------------------------


def test_a_certificate_holding_its_points_is_about_these_points_only(generic):
    source, target, weights = GENERIC
    moved = source.copy()
    moved[7, 2] = np.nextafter(moved[7, 2], 9)

    assert verdict(generic, clouds_of(source, target, weights)).verified
    for untold in (clouds_of(source, target), clouds_of(source, target, np.ones(20))):
        assert UNEQUAL in verdict(generic, untold).reason
    assert verdict(oracle.produce(source, target), clouds_of(source, target)).verified
    for other in (
        clouds_of(moved, target),
        clouds_of(target, source),
        clouds_of(source, target[::-1]),
        clouds_of(source[:19], target[:19]),
        clouds_of(source, target[:19]),
        clouds_of(source, target, weights[:19]),
        clouds_of(source, target, []),
    ):
        assert "about" in verdict(generic, other).reason


def test_a_digest_stands_for_points_given_elsewhere(generic):
    source, target, weights = GENERIC
    short = without_data(generic)

    assert "holds no points" in verdict(short).reason
    assert verdict(short, clouds_of(source, target, weights)).verified
    assert "digest" in verdict(short, clouds_of(source, target)).reason
    assert "digest" in verdict(short, clouds_of(target, source, weights)).reason
    assert "number of points" in verdict(short, clouds_of(source[1:], target[1:])).reason
    certificate = without_data(oracle.produce(source, target))
    assert verdict(certificate, clouds_of(source, target)).verified


def test_one_other_weight_between_equal_ones_is_seen():
    source, target, _ = GENERIC
    for place in (1, len(source) // 2, len(source) - 2):
        weights = np.full(len(source), 4.0)
        weights[place] = 2.0
        certificate = oracle.produce(source, target, weights)
        alone = clouds_of(source, target)

        assert "NOT all of one weight" in verdict(certificate).theorems[0]
        for clouds in (alone, replace(alone, any_weight=True)):
            assert UNEQUAL in verdict(certificate, clouds).reason


def test_minus_zero_is_zero_in_given_points_and_refused_in_the_certificate():
    source = np.array(oracle.OCTAHEDRON, dtype=float)
    negative = np.where(source == 0, -0.0, source)
    certificate = oracle.produce(source, source, pattern=[1, 3])
    content = bytearray(oracle.problem_bytes(source, source, [1] * 6))
    place = 26 + 8 * 1  # y of the first point
    assert content[place : place + 8] == struct.pack("<d", 0.0)
    content[place : place + 8] = struct.pack("<d", -0.0)

    assert verdict(certificate, clouds_of(negative, negative)).verified
    assert verdict(without_data(certificate), clouds_of(negative, source)).verified
    assert "-0.0" in verdict(oracle.with_problem(certificate, bytes(content))).reason


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", [0, 7, 70, 130])
def test_numbers_that_are_not_finite_are_refused(generic, wrong, place):
    numbers = np.concatenate([np.ravel(part) for part in GENERIC])
    numbers[place] = wrong
    content = oracle.problem_bytes(numbers[:60], numbers[60:120], numbers[120:])

    assert "finite" in verdict(oracle.with_problem(generic, content)).reason
    given_points = clouds_of(numbers[:60], numbers[60:120], numbers[120:])
    certificate = without_data(oracle.with_problem(generic, content))
    assert "finite" in verdict(certificate, given_points).reason


def test_weights_are_not_negative_and_not_all_zero(generic):
    source, target, weights = GENERIC
    negative = np.where(np.arange(20) == 4, -weights, weights)
    for wrong, reason in ((negative, "negative"), (0 * weights, "no weight")):
        content = oracle.problem_bytes(source, target, wrong)
        assert reason in verdict(oracle.with_problem(generic, content)).reason


def test_points_given_on_a_big_endian_machine_are_turned_around(generic, monkeypatch):
    source, target, weights = GENERIC
    native = clouds_of(source, target, weights)
    assert verdict(generic, native).verified
    monkeypatch.setattr(sys, "byteorder", "big" if sys.byteorder == "little" else "little")

    assert not verdict(generic, native).verified  # it has turned what needed no turning


# --- The words ------------------------------------------------------------------------------------


def test_each_theorem_is_told_in_words_with_its_numbers(generic):
    words = "\n".join(verdict(generic).theorems)

    for part in (
        "n = 20 pairs, NOT all of one weight",
        generic["problem"]["digest"],
        "exceeds the global minimum by less than",
        "degrees of R",
        "The global optimum is unique",
        "three noncollinear points",
        "unstable directions: 0, 1, 2, 3",
        "`about`",
    ):
        assert part in words
    assert words.isascii()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("mirrored, elongated", "NOT unique: the optima form a circle"),
        ("mirrored octahedron", "NOT unique: the optima form a projective plane"),
        ("antipodes", "NOT unique: the optima form all rotations"),
        ("octahedron", "one rotation, a projective plane; unstable directions: 0, 1"),
        ("collinear source", "the dynamics is not defined"),
    ],
)
def test_an_optimum_that_is_not_unique_is_told_so(name, words):
    pattern, source, target = oracle.PATTERNS[name]

    assert words in "\n".join(verdict(oracle.produce(source, target, pattern=pattern)).theorems)


@pytest.mark.slow
@given(st.integers(1, 10**400), st.integers(1, 10**400), st.integers(2, 25))
@examples(200)
def test_bounds_are_rounded_up_to_the_next_decimal(numerator, denominator, digits):
    value = Fraction(numerator, denominator)

    shown = checker.rounded(value, digits)

    assert value <= Fraction(shown) < value * (1 + Fraction(1, 10 ** (digits - 1)))
    assert Fraction(f"{shown:.{digits - 1}e}") == Fraction(shown)
    below = Fraction(checker.rounded(value, digits, ROUND_FLOOR))
    assert below <= value < below * (1 + Fraction(1, 10 ** (digits - 1)))


@pytest.mark.parametrize("beside", [-math.inf, 0.0, math.inf])
@pytest.mark.parametrize("value", [0.1, 0.123456789, 2.5, 1e-7, 1234567.0, 123456789.0])
def test_a_range_in_words_holds_the_range(value: float, beside: float):
    number = Fraction(math.nextafter(value, beside) if beside else value)
    low, high = (Fraction(word) for word in checker.between(number, number).split()[1::2])

    assert low <= number <= high <= low * (1 + Fraction(1, 10**7))
    assert checker.between(number, None) == f"from {checker.between(number, number).split()[1]} on"


@pytest.mark.slow
@given(st.integers(1, 10**400), st.integers(1, 10**400))
@examples(100)
def test_a_root_is_rounded_up(numerator, denominator):
    value = Fraction(numerator, denominator)

    root = checker.root_up(numerator, denominator)

    assert value < root**2 <= value * (1 + Fraction(1, 10**18))


def said_of(certificate, delta, mu):
    """The sentences with another delta and mu, as if proved; of K = diag(3, 1, -1, -3)."""
    stated = replace(checker.parse(oracle.dump(certificate)), delta=delta, mu=mu, pose=(1, 0, 0, 0))
    C = [[(2 - i) * (i == j) for j in range(3)] for i in range(3)]
    one = delta.denominator * mu.denominator
    worth = stated._worth(Fraction(16), 90 * one, C, one, one)
    return stated._words(lambda: worth, [1, 1, 1, 1], solid=True, equal=True)


def test_the_printed_gap_and_angle_are_upper_bounds_of_any_size(generic):
    for exponent in (-19000, -2000, -100, -20, -5, -2, -1):
        delta, mu = Fraction(2) ** exponent, Fraction(1)
        words = list(said_of(generic, delta, mu))
        gap, angle = (next(w for w in words if key in w) for key in ("exceeds", "degrees of R"))
        printed = Fraction(gap.split("less than ")[1].split()[0])
        degrees = Decimal(angle.split("within ")[1].split()[0])

        assert 2 * delta <= printed <= Fraction(11, 10) * 2 * delta
        half = float(degrees) * math.pi / 360
        if exponent > -900:
            assert math.sin(min(half, math.pi / 2)) ** 2 > float(delta)
        assert Fraction(degrees) ** 2 < Fraction(175, 100) * 13132 * delta * (
            2 if exponent > -5 else 1
        )
    for s, bounded in (
        (Fraction(71, 100), True),
        (Fraction(72, 100), False),
    ):  # 2 root = 3.13, 3.21
        words = " ".join(said_of(generic, s, Fraction(1)))
        assert ("degrees of R" in words) == bounded
        assert ("No angle is bounded" in words) != bounded


# --- The seam of kinds ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Weighed(checker.Statement):
    """A kind for the tests alone: it claims a mass, and a radius if it likes."""

    kind = "weighed"
    keys: ClassVar = {
        "": "about claims format kind problem",
        "claims?": "mass radius?",
        "problem": "data digest n unit?",
    }
    prefix = b"certreg-weighed/1\0"

    n: int
    digest: str
    data: str | None
    mass: int | None
    radius: int | None

    def prove(self, m, e, *, equal):
        checker.require(self.mass in (None, m[0][0] * Fraction(2) ** e), "claims.mass is wrong")
        return checker.Outcome(equal, tell=lambda: (f"{self.mass} {self.radius}",))


def weighed(claims, prefix=Weighed.prefix, **more):
    content = prefix + oracle.problem_bytes(oracle.OCTAHEDRON, oracle.OCTAHEDRON, [1] * 6)[18:]
    problem = {**oracle.stated_problem(content, 6), **more}
    kept = {"about": {}, "format": checker.FORMAT, "kind": "weighed"}
    return {**kept, "claims": claims, "problem": problem}


@pytest.mark.parametrize(
    ("certificate", "said"),
    [
        (weighed({"mass": 6}), "6 None"),
        (weighed({"mass": 6, "radius": 3}, unit=2), "6 3"),
        (weighed(None), "None None"),
        (weighed({"mass": 7}), "claims.mass is wrong"),
        (weighed({"radius": 3}), "claims must have exactly the keys mass radius?"),
        (weighed({"mass": 6, "radius?": 3}), "claims must have exactly the keys mass radius?"),
        (weighed({"mass": 6, "radius": "3"}), "radius is of a wrong type"),
        (weighed({"mass": 6}, sdp=2), "problem must have exactly the keys data digest n unit?"),
        (weighed({"mass": 6}, b"certreg-problem/1\0"), "data is not canonical, or not of n points"),
    ],
)
def test_a_further_kind_is_one_class_in_the_table_with_keys_and_prefix_of_its_own(
    monkeypatch, certificate, said
):
    unknown = verdict(certificate)
    monkeypatch.setitem(checker.KINDS, "weighed", Weighed)
    outcome = verdict(certificate)

    assert not unknown.verified
    assert outcome.verified == said.endswith(("None", "3"))
    assert "".join(outcome.theorems) + outcome.reason == said


def test_a_certificate_is_parsed_once_and_never_changed(generic):
    stated = checker.parse(oracle.dump(generic))
    before = repr(stated)

    doubles = checker.bound_doubles(stated, None)
    stated.prove(*checker.moments(doubles, stated.n), equal=False)

    assert repr(stated) == before
    with pytest.raises(FrozenInstanceError):
        stated.n = 3


# --- The command ----------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_file_runs_alone_in_an_empty_environment(generic, tmp_path):
    path = tmp_path / "certificate.json"
    path.write_bytes(oracle.dump(generic))
    forged = tmp_path / "forged.json"
    forged.write_bytes(oracle.dump(changed(generic, gap=[1, -400])))

    lines = run(path).stdout.splitlines()

    assert lines[-1] == "VERIFIED"
    assert tuple(lines[:-1]) == verdict(generic).theorems
    assert run(forged, code=1).stdout.startswith("REFUSED: claims.gap")


@pytest.mark.slow
def test_the_file_imports_nothing_but_the_standard_library():
    names = {
        node.module if isinstance(node, ast.ImportFrom) else alias.name
        for node in ast.walk(ast.parse(FILE.read_text(encoding="utf-8")))
        if isinstance(node, (ast.Import, ast.ImportFrom))
        for alias in node.names
    }

    assert "hashlib" in names
    assert {str(name).split(".")[0] for name in names} <= sys.stdlib_module_names


def test_an_optimum_that_is_not_unique_is_verified_with_exit_code_zero(tmp_path):
    pattern, source, target = oracle.PATTERNS["mirrored octahedron"]
    path = tmp_path / "certificate.json"
    path.write_bytes(oracle.dump(oracle.produce(source, target, pattern=pattern)))

    assert checker.main([str(path)]) == 0


def test_exit_code_two_is_for_files_and_usage(generic, tmp_path, capsys):
    path = tmp_path / "certificate.json"
    path.write_bytes(oracle.dump(generic))
    for arguments in (
        [],
        ["--unknown"],
        [str(tmp_path / "missing.json")],
        [str(tmp_path)],
        ["nul\0byte"],
        [str(path), str(path)],
    ):
        assert checker.main(arguments) == 2, arguments
        printed = capsys.readouterr()
        assert printed.err
        assert not printed.out


def test_help_is_not_an_error(capsys):
    assert checker.main(["--help"]) == 0
    assert "usage" in capsys.readouterr().err


@pytest.mark.slow
def test_a_malformed_certificate_is_refused_with_exit_code_one(tmp_path):
    path = tmp_path / "certificate.json"
    for content in (b"", b"{}", b"\xff\xfe", b"[" * 10**5):
        path.write_bytes(content)
        assert checker.main([str(path)]) == 1
    with path.open("wb") as file:
        file.truncate(checker.FILE_MAX + 1)
    assert checker.main([str(path)]) == 1


@pytest.mark.slow
def test_the_outcome_says_the_same_in_every_language_setting(generic, tmp_path):
    path = tmp_path / "certificate.json"
    generic = {**generic, "about": {"name": "\u001b[31m \u2028 \ud800 intruder"}}
    path.write_bytes(json.dumps(generic).encode())
    environment = {**os.environ, "LC_ALL": "C", "PYTHONIOENCODING": "ascii"}

    done = subprocess.run(
        [sys.executable, str(FILE), str(path)], capture_output=True, env=environment, check=True
    )

    assert done.stdout.splitlines()[-1] == b"VERIFIED"
    assert b"intruder" not in done.stdout
