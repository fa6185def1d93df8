"""What a verified certificate is said to be worth: each number on the screen brackets the truth."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from fractions import Fraction
from functools import partial
from importlib import import_module

import certificates as oracle
import numpy as np
import pytest
from checker_boundaries import (
    AXES,
    changed,
    energy_of,
    form,
    loosely,
    stated,
    upward_value,
)

checker = import_module("certreg.verify")

ROUNDING = Fraction(1, 10**12)
NUMBER = r"(\d[\d.]*(?:e[+-]\d+)?)"
WORDS = {
    "mass": rf"Sum of weights: {NUMBER}; ",
    "energy": rf"best translation: {NUMBER}; both rounded up\.",
    "gap": rf"exceeds the global minimum by less than {NUMBER} ",
    "minimum": rf"So the minimum is at least {NUMBER}; ",
    "length": rf"is below {NUMBER}\.",
    "share": rf"This gap is less than {NUMBER} of the range of energies",
    "degrees": rf"Every global optimum is within {NUMBER} degrees of R\.",
}


def printed(outcome) -> dict[str, Fraction]:
    """The numbers in the sentences, of those that are there."""
    words = "\n".join(outcome.theorems)
    found = {name: re.search(pattern, words) for name, pattern in WORDS.items()}
    return {name: Fraction(match[1]) for name, match in found.items() if match}


def eigenvalues(K) -> tuple[Fraction, Fraction]:
    """The least and the largest, up to ROUNDING of the largest entry."""
    size = max(abs(entry) for row in K for entry in row) or Fraction(1)
    values = np.linalg.eigvalsh([[float(entry / size) for entry in row] for row in K])
    return Fraction(float(values[0])) * size, Fraction(float(values[3])) * size


def assert_true(certificate, source, target, weights) -> dict[str, Fraction]:
    """Every printed number holds of the points, by sums over them and brackets of eigenvalues."""
    outcome = checker.check(oracle.dump(certificate))
    assert outcome.verified, outcome.reason
    told, worth, words = printed(outcome), outcome.worth, "\n".join(outcome.theorems)
    w = [Fraction(float(each)) for each in weights]
    q = certificate["pose"]
    energy = energy_of(q, np.asarray(source, dtype=float), np.asarray(target, dtype=float), w)
    K = oracle.rotation_form(oracle.exact_moments(source, target, weights)[1])
    v, (least, most) = form(K, q) / sum(c * c for c in q), eigenvalues(K)
    excess, spread = 2 * (most - v), 2 * (most - least)  # of R; of all rotations
    error = spread * ROUNDING

    assert (worth.weight, worth.objective) == (sum(w), energy)
    assert sum(w) <= told["mass"] <= sum(w) * (1 + Fraction(1, 10**11))
    assert energy <= told["energy"] <= energy * (1 + Fraction(1, 10**11))
    assert told["minimum"] <= worth.minimum <= max(energy - excess, 0) + error
    assert told["gap"] >= worth.gap >= excess - error
    assert told["length"] ** 2 * sum(w) >= worth.gap
    assert ("share" in told) == (0 < worth.share < 1)
    assert ("This gap bounds nothing" in words) == (worth.share >= 1)
    assert told.get("share", worth.share) >= worth.share
    if spread:
        assert worth.gap <= worth.share * (spread + error) <= Fraction(142, 100) * worth.gap
    assert ("degrees" in told) == (worth.angle is not None)
    assert ("No angle is bounded" in words) == (worth.angle is None and worth.share > 0)
    if worth.angle is not None:
        (d, e), (m, f) = (certificate["optimality"][name] for name in ("delta", "mu"))
        half, sin2 = float(worth.angle) / 2, float(Fraction(d, m) * Fraction(2) ** (e - f))
        assert math.sin(half) >= math.sqrt(sin2) * (1 - 1e-9)
        assert float(told["degrees"]) >= math.degrees(2 * half) * (1 - 1e-12)
    return told


@pytest.mark.slow
def test_every_number_brackets_the_truth_of_random_problems():
    for seed in range(20):
        source, target, weights = oracle.random_problem(seed, n=4 + seed % 3, noise=0.1 * seed)
        weights = weights * 10.0 ** (seed % 7 - 3)
        told = assert_true(
            oracle.produce(source, target, weights), source, target, weights.tolist()
        )

        assert told["share"] < 1e-6
        assert told["degrees"] < 1e-3


@pytest.mark.one_in(3)
@pytest.mark.parametrize("ratio", [1e-150, 1e-100, 1e-15, 1e15, 1e100, 1e150])
def test_clouds_of_very_different_size_are_bounded_or_told_that_they_are_not(ratio):
    source, target, weights = oracle.random_problem(7, n=6)
    target = target * ratio
    good = oracle.produce(source, target, weights)
    exact = {name: m * Fraction(2) ** e for name, (m, e) in good["optimality"].items()}

    assert assert_true(good, source, target, weights)["share"] < 1e-6
    size = (
        Fraction(float(np.abs(target).max() * np.abs(source).max())) * 10**6
    )  # above all energies
    vague = stated(good, exact["delta"] + upward_value(size), Fraction(0))
    assert "share" not in assert_true(vague, source, target, weights)


@pytest.mark.parametrize("offset", [1e8, 1e15, 1e16])
def test_clouds_far_from_the_origin_have_their_energies_as_they_are(offset):
    source, target, weights = oracle.random_problem(8, n=6)
    source, target = 9 * source + offset, 9 * target - 3 * offset
    certificate = oracle.produce(source, target, weights)

    assert_true(certificate, source, target, weights)


@pytest.mark.parametrize("name", ["generic", "mirrored octahedron", "antipodes", "octahedron"])
def test_every_number_holds_of_exact_patterns(name):
    pattern, source, target = oracle.PATTERNS[name]
    certificate = oracle.produce(source, target, pattern=pattern)
    words = "\n".join(checker.check(oracle.dump(certificate)).theorems)

    assert_true(certificate, source, target, [1] * len(source))
    assert ("The range of energies is 0" in words) == (pattern == [4])


def test_an_angle_just_above_two_digits_of_a_degree_is_rounded_up():
    """1.2 degrees, and 1e-13 of it more: 180/pi in the sentence must not be below the true one."""
    pi = Fraction(314159265358979323846264338327950288419, 10**38)
    content = oracle.dump(oracle.produce(AXES, AXES))
    worth = checker.check(content).worth
    for part, degrees in ((1 - Fraction(1, 10**10), "1.2"), (1 + Fraction(1, 10**13), "1.3")):
        near = replace(worth, angle=Fraction(12, 10) * pi / 180 * part)
        stated = checker.parse(content)
        words = stated._words(partial(replace, near), [1, 1, 1, 1], solid=True, equal=True)

        assert f"within {degrees}e+0 degrees" in " ".join(words)


def test_a_vacuous_certificate_says_that_it_bounds_nothing_and_is_refused_where_more_is_asked():
    weights = [2.0**-1000] * 6
    tiny = oracle.with_problem(
        oracle.produce(AXES, AXES), oracle.problem_bytes(AXES, AXES, weights)
    )
    huge = changed(loosely(oracle.produce(AXES, AXES), Fraction(1)), delta=[1, 32768])
    half_turn = changed(loosely(tiny, Fraction(1, 2**980)), pose=[0, 0, 0, 1])
    for certificate in (half_turn, changed(huge, gap=[2, 32768])):
        content = oracle.dump(certificate)
        words = "\n".join(checker.check(content).theorems)
        assert "This gap bounds nothing" in words
        assert "No angle is bounded" in words
        for limits in ({"share": Fraction(1)}, {"angle": Fraction(3)}):
            assert not checker.check(content, None, limits).verified
    assert_true(half_turn, AXES, AXES, weights)


def test_the_least_delta_that_is_asked_for_is_what_the_limit_says():
    """1e-3 and 1e-5 on either side of what delta proves; the limit is a decimal number."""
    good = oracle.produce(AXES, AXES)
    for share, verified in ((Fraction(1, 1000), True), (Fraction(1, 100000), False)):
        loose = loosely(good, upward_value(Fraction(79196, 10**8)))  # about 1e-5 of 2 F = 79.196
        content = oracle.dump(loose)
        assert checker.check(content, None, {"share": share}).verified == verified
