"""Certificates of many problems: each is what the slow way claims, and the checker accepts it."""

from __future__ import annotations

import json
from fractions import Fraction
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from engines import engine
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import ZOO, problems

import certreg
from certreg.certificate.checking import verify
from certreg.certificate.isotropic import produce
from certreg.certificate.many import _angles
from certreg.errors import CertregError, InvalidFileError, InvalidProblemError
from certreg.exact.dyadic import dyadic_above, half_angle_bound
from certreg.geometry.so3 import rotation_matrix
from certreg.native.library import ProvedOptima
from certreg.objective.isotropic import Isotropic
from certreg.problem.many import ManyPairs
from certreg.problem.moments import exact_moments
from certreg.verify import Clouds, check

many = import_module("certreg.certificate.many")
RNG = np.random.default_rng(7)
SOURCES = RNG.normal(size=(12, 9, 3))
TARGETS = SOURCES[:, :, [1, 2, 0]] + 0.01 * RNG.normal(size=SOURCES.shape) + 5.0
SPOILT = np.where(SOURCES[3, 2, 1] == SOURCES, np.nan, SOURCES)
WEIGHTS = RNG.uniform(0.1, 9.0, size=(12, 9))
BUT_ONE = np.array([*[1.0] * 8, 0.0])  # weights that are alike up to the last row


def compiled_or_skipped() -> Any:
    return engine("library")


def proved(source: Any, target: Any, weights: Any = 1.0) -> ProvedOptima:
    """What compiled code proves of one problem."""
    pairs = ManyPairs.of(source, target, weights)
    clouds = (pairs.source, pairs.target, pairs.weights)
    return compiled_or_skipped().prove_optima(clouds, pairs.sizes, pairs.starts)


def is_proved(source: Any, target: Any, weights: Any = 1.0) -> bool:
    return bool(proved(source, target, weights).proved[0])


def accepted(certificates) -> bool:
    return all(check(line).verified for line in certificates.lines())


@pytest.mark.parametrize(
    "weights", [None, 3.0, BUT_ONE, BUT_ONE[::-1], WEIGHTS[0], WEIGHTS, list(WEIGHTS)]
)
def test_every_line_is_accepted_by_the_checker_and_claims_one_optimum(weights):
    found = certreg.certify_many(SOURCES, TARGETS, weights=weights)

    assert len(found) == 12
    assert accepted(found)
    assert found.unique.all()
    assert (found.angles < 1e-13).all()
    assert (found.gaps < 1e-26).all()
    for k in (0, 11):
        w = np.ones(9) if weights is None else np.broadcast_to(weights, (12, 9))[k]
        pose = certreg.register(SOURCES[k], TARGETS[k], weights=w)
        np.testing.assert_allclose(found.poses[k], pose.as_matrix(), atol=1e-13)


def test_nothing_is_left_to_the_slow_way_where_compiled_code_does_it():
    compiled_or_skipped()

    assert certreg.certify_many(SOURCES, TARGETS, weights=WEIGHTS)._others == {}


@pytest.mark.slow
@settings(max_examples=25)
@given(problems())
def test_claims_are_those_of_the_slow_way_for_problems_of_every_kind(problem):
    try:
        expected = produce(problem, Isotropic(exact_moments(problem)))
    except CertregError:
        return
    found = certreg.certify_many([problem.source], [problem.target], weights=[problem.weights])
    one = found[0]

    assert one is not None
    assert expected is not None
    assert check(one.line()).verified
    claims, others = one.body.claims, expected.body.claims
    assert one.digest == problem.digest()
    assert (claims.unique, claims.pattern) == (others.unique, others.pattern)
    assert claims.unstable == others.unstable
    assert found.unique[0] == others.unique
    assert Fraction(found.gaps[0]) >= claims.gap.value
    assert (claims.sin2_half_angle is None) == (others.sin2_half_angle is None)
    if claims.sin2_half_angle is not None:
        assert np.sin(found.angles[0] / 2) ** 2 >= float(claims.sin2_half_angle.value)


def test_small_integers_are_proved_in_compiled_code_where_there_are_four_equilibria_alone():
    for one in ZOO:
        assert is_proved([one.source], [one.target]) == (one.pattern == (1, 1, 1, 1)), one.name


@pytest.mark.parametrize("specimen", ZOO, ids=lambda one: one.name)
def test_every_pattern_is_certified_among_others(specimen):
    n = len(specimen.source)
    sources, targets = [SOURCES[0][:n], specimen.source], [TARGETS[0][:n], specimen.target]
    found = certreg.certify_many(sources[1:], targets[1:])
    one = found[0]

    assert one is not None
    assert one.body.claims.pattern == specimen.pattern
    assert verify(one).proved
    assert accepted(found)
    assert found.unique[0] == (specimen.pattern[0] == 1)
    assert np.isnan(found.angles[0]) == (specimen.pattern[0] != 1)


@pytest.mark.slow
@settings(max_examples=20)
@given(
    st.integers(-120, 120),
    st.integers(-120, 120),
    st.integers(-300, 300),
    st.sampled_from(["offset", "planar", "mirrored", "near tie", "far scales"]),
    st.integers(0, 2**32 - 1),
)
def test_what_compiled_code_proves_the_checker_accepts(a, b, c, kind, seed):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(6, 3))
    y = x[:, [2, 0, 1]] + 0.1 * rng.normal(size=x.shape)
    if kind == "offset":
        y = y + 1e8
    if kind == "planar":
        x[:, 2] = 0.0
    if kind == "mirrored":
        y[:, 0] = -y[:, 0]
    if kind == "near tie":
        x, y = np.eye(3), np.eye(3) + 1e-9 * rng.normal(size=(3, 3))
    if kind == "far scales":
        x[0] *= 2.0**-40
    weights = rng.uniform(0.0, 2.0, size=len(x)) * 2.0**c
    found = proved(x * 2.0**a, y * 2.0**b, weights)
    if found.proved[0]:
        certificates = certreg.certify_many([x * 2.0**a], [y * 2.0**b], weights=[weights])
        assert certificates._others == {}
        assert accepted(certificates)


def test_numbers_of_as_many_bits_as_two_limbs_hold_are_taken_and_no_more():
    x = np.array([[1.0, 0, 0], [0, 2, 0], [0, 0, 3], [1, 2, 3]])
    for bits, taken in ((108, True), (109, False)):  # 3 has two bits
        far = x.copy()
        far[0, 0] = 2.0**-bits
        assert is_proved(far, x) == taken, bits
        assert is_proved(x, far) == taken, bits
        w = np.array([2.0**-bits, 3.0, 1.0, 1.0])
        assert is_proved(x, x, w) == taken, bits
        assert accepted(certreg.certify_many([far, x], [x, far], weights=[w, w]))


@pytest.mark.slow
def test_problems_of_so_many_points_are_taken_and_no_larger_ones():
    x = np.resize(SOURCES[0], (65537, 3))
    y = np.resize(TARGETS[0], (65537, 3))

    assert is_proved(x[:-1], y[:-1])
    assert not is_proved(x, y)


def test_largest_numbers_do_not_leave_the_integers():
    """All bits of both limbs, of all factors, and many points: sums as large as they can be."""
    x = np.full((4000, 3), 2.0**110 - 2.0**57)
    x[::2, 1] *= -1.0
    x[::3, 2] *= -1.0
    x[1, 0] = 1.0
    y = x[:, [1, 2, 0]].copy()
    w = np.full(4000, 2.0**110 - 2.0**57)
    w[0] = 1.0
    assert is_proved(x, y, w)
    found = certreg.certify_many([x], [y], weights=[w])
    assert check(found[0].line()).verified  # pyright: ignore[reportOptionalMemberAccess]


def test_a_problem_that_is_not_decided_by_doubles_is_not_proved_but_certified():
    exact = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    tie = exact.copy()
    tie[0, 0] += 2.0**-52

    assert not is_proved(exact, exact)
    found = certreg.certify_many([exact, tie], [exact, exact])
    assert accepted(found)


def test_without_compiled_code_the_same_is_claimed(monkeypatch):
    expected = certreg.certify_many(SOURCES[:2], TARGETS[:2])
    monkeypatch.setattr(many, "library_if_any", lambda: None)
    found = certreg.certify_many(SOURCES[:2], TARGETS[:2])

    assert list(found._others) == [0, 1]
    assert accepted(found)
    np.testing.assert_allclose(found.poses, expected.poses, atol=1e-14)
    assert found.unique.tolist() == expected.unique.tolist()
    assert [one.digest for one in found if one] == [one.digest for one in expected if one]


def test_what_is_not_proved_is_not_claimed_and_its_line_is_refused(monkeypatch, tmp_path):
    monkeypatch.setattr(many, "library_if_any", lambda: None)
    monkeypatch.setattr(many, "produce", lambda *_: None)
    found = certreg.certify_many(SOURCES[:1], TARGETS[:1])
    found.save(tmp_path / "many.jsonl")

    assert found[0] is None
    assert found.gaps.tolist() == [np.inf]
    assert np.isnan(found.angles[0])
    assert not found.unique[0]
    assert (tmp_path / "many.jsonl").read_bytes() == b"null\n"
    assert not check(b"null\n").verified


def test_a_file_holds_a_certificate_a_line_of_the_points_as_they_were(tmp_path):
    source = SOURCES[:3].copy()
    found = certreg.certify_many(source, TARGETS[:3])
    source[:] = 0.0
    found.save(tmp_path / "many.jsonl")
    lines = (tmp_path / "many.jsonl").read_bytes().splitlines()

    assert [check(line).verified for line in lines] == [True] * 3
    first = Clouds(tuple(SOURCES[0].ravel()), tuple(TARGETS[0].ravel()))
    assert [check(line, first).verified for line in lines] == [True, False, False]
    document = json.loads(lines[2])
    assert lines[2].decode() == json.dumps(document, sort_keys=True, separators=(",", ":"))


def test_a_file_of_many_is_not_taken_for_one(tmp_path):
    for read in (certreg.verify, certreg.Certificate.load):
        with pytest.raises(InvalidFileError, match="holds a certificate a line: let `certreg ver"):
            read(tmp_path / "many.jsonl")


def test_negative_zero_is_zero():
    x = np.array([[-0.0, 0, 0], [0, 2, 0], [0, -0.0, 3], [1, 2, 3]])

    assert accepted(certreg.certify_many(x, x))


def test_clouds_of_different_sizes_and_of_one_for_all():
    sizes = (4, 9, 6)
    ragged = [SOURCES[k][:n] for k, n in enumerate(sizes)]
    targets = [TARGETS[k][:n] for k, n in enumerate(sizes)]
    weights = [WEIGHTS[k][:n] for k, n in enumerate(sizes)]
    found = certreg.certify_many(ragged, targets, weights=weights)

    assert [one.n for one in found if one] == list(sizes)
    assert accepted(found)
    shared = certreg.certify_many(SOURCES[0], TARGETS, weights=WEIGHTS[0])
    assert len(shared) == 12
    assert accepted(shared)
    only_weights = certreg.certify_many(SOURCES[0], TARGETS[0], weights=WEIGHTS)
    assert len(only_weights) == 12
    assert accepted(only_weights)


def test_progress_is_told_and_one_certificate_taken_by_its_number(monkeypatch):
    monkeypatch.setattr(many, "PORTION", 5)
    told: list[tuple[int, int | None]] = []
    found = certreg.certify_many(SOURCES, TARGETS, progress=lambda *done: told.append(done))

    assert told == [(5, 12), (10, 12), (12, 12)]
    last, same = found[-1], found[11]
    assert last is not None
    assert last == same
    with pytest.raises(IndexError):
        found[12]


def test_a_certificate_is_taken_by_its_number_from_either_end():
    line = np.arange(9.0)[:, None] * [1.0, 2.0, 2.0]  # not proved in compiled code
    found = certreg.certify_many([SOURCES[0], line], [TARGETS[0], line])

    for last, first in zip((found[-1], found[-2]), (found[1], found[0]), strict=True):
        assert last is not None
        assert first is not None
        assert last.to_json() == first.to_json()
    for number in (2, -3):
        with pytest.raises(IndexError):
            found[number]
    with pytest.raises(TypeError, match="slice"):
        found[:1]  # pyright: ignore[reportArgumentType]


def test_poses_are_the_exact_ones_to_the_rounding_of_the_coordinates():
    """In doubles R has errors of a few 1e-16 an entry, and the mean of the source is 3.7e8."""
    far = np.array([3e8, -1e8, 2e8])
    sources, targets = SOURCES + far, TARGETS + 1e-3 * far
    found = certreg.certify_many(sources, targets)

    for k, line in enumerate(found.lines()):
        q = [Fraction(entry) for entry in json.loads(line)["pose"]]
        R = [[entry / sum(c * c for c in q) for entry in row] for row in rotation_matrix(q)]
        x, y = (
            [Fraction(sum(map(Fraction, column)), 9) for column in cloud[k].T.tolist()]
            for cloud in (sources, targets)
        )
        moved = [sum(a * b for a, b in zip(row, x, strict=True)) for row in R]
        shift = [float(a - b) for a, b in zip(y, moved, strict=True)]
        turn = np.array([[float(entry) for entry in row] for row in R])
        np.testing.assert_allclose(found.poses[k][:3, :3], turn, rtol=0.0, atol=1e-15)
        np.testing.assert_allclose(found.poses[k][:3, 3], shift, rtol=0.0, atol=1e-15 * 6e8)


@pytest.mark.parametrize("listed", [np.array, list])
@pytest.mark.parametrize(("problem", "row"), [(0, 8), (1, 0)])
def test_a_number_that_is_none_is_told_by_the_problem_and_its_row(listed, problem, row):
    sources = SOURCES[:3].copy()
    sources[problem, row, 1] = np.nan

    with pytest.raises(InvalidProblemError, match=rf"sources\[{problem}\] row {row} "):
        certreg.certify_many(listed(sources), TARGETS[:3])


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"sources": SOURCES[:, :, :2]}, r"sources have the shape \(12, 9, 2\)"),
        ({"targets": TARGETS[:5]}, "sources are of 12 problems, targets of 5"),
        ({"targets": TARGETS[:, :5]}, "problem 0 has 9 source points and 5 target points"),
        ({"sources": SPOILT}, r"sources\[3\] row 2 \(counting from 0\) is .*nan"),
        ({"weights": -WEIGHTS}, "the weights of problem 0 are not all >= 0"),
        ({"weights": WEIGHTS * (np.arange(12) != 4)[:, None]}, "the weights of problem 4"),
        ({"weights": WEIGHTS[:5]}, "weights are of 5 problems of 9 points, the clouds of 12"),
        ({"weights": WEIGHTS[:, :5]}, "weights are of 12 problems of 5 points"),
        ({"weights": [[1.0, 2.0], [1.0]]}, "weights are of 2 problems of 1 to 2 points"),
        ({"sources": [SOURCES[0], SOURCES[1][:0]]}, r"sources\[1\] has no points"),
        ({"sources": []}, r"sources have the shape \(0,\)"),
        ({"sigma": 1.0}, "sigma beside sources and targets, whose certificates take weights alone"),
        ({"errors": "keep"}, "errors beside sources and targets"),
    ],
)
def test_what_does_not_state_problems_is_one_clear_error(changed, words):
    given_ = {"sources": SOURCES, "targets": TARGETS, **changed}
    sources, targets = given_.pop("sources"), given_.pop("targets")
    with pytest.raises(InvalidProblemError, match=words):
        certreg.certify_many(sources, targets, **given_)


def test_rows_that_are_not_there_are_not_read():
    library = compiled_or_skipped()
    pairs = ManyPairs.of(SOURCES[0], TARGETS[0])
    clouds = (pairs.source, pairs.target, pairs.weights)

    last = 2**63 - 1  # and beyond it a sum would be negative
    wrong = ((10, [0, 0, 0]), (9, [0, 1, 0]), (9, [-1, 0, 0]), (0, [0, 0, 0]), (9, [0, last, 0]))
    for size, start in (*wrong, (last, [1, 1, 1])):
        with pytest.raises(ValueError, match="rows that are not there"):
            library.prove_optima(clouds, np.array([size]), np.array([start]))


@pytest.mark.slow
def test_a_forged_proof_is_refused_by_the_checker():
    """Stronger claims than the proof's, and another problem's quaternion."""
    found = certreg.certify_many(SOURCES[:2], TARGETS[:2])
    optima = found._optima
    for name, change in (
        ("delta", lambda delta: np.subtract(delta, [0, 40])),
        ("mu", lambda mu: np.add(mu, [0, 2])),
        ("sine", lambda sine: np.subtract(sine, [0, 2])),
        ("quaternions", lambda q: q[::-1]),
    ):
        parts = {field: getattr(optima, field) for field in ProvedOptima.__dataclass_fields__}
        forged = ProvedOptima(**{**parts, name: change(parts[name])})
        lines = list(_with(found, forged).lines())
        assert not any(check(line).verified for line in lines), name


def _with(found, optima):
    parts = {field: getattr(found, field) for field in found.__dataclass_fields__}
    return type(found)(**{**parts, "_optima": optima})


@pytest.mark.parametrize("power", [-560, -530, 0, 500])
def test_gaps_are_not_below_what_is_claimed_at_the_ends_of_the_doubles(power):
    """Of lengths 2^power a gap is 2^(2 power + 30) or so: below the least double, and above all."""
    found = certreg.certify_many(SOURCES * 2.0**power, TARGETS * 2.0**power, weights=2.0**120)
    claims = [one.body.claims.gap.value for one in found if one is not None]

    assert len(claims) == len(found)
    for gap, claim in zip(found.gaps.tolist(), claims, strict=True):
        assert gap == np.inf or Fraction(gap) >= claim
        assert gap < np.inf or claim > 2**1023


def test_angles_up_to_half_a_turn_are_those_of_the_bound_of_one():
    sines = [Fraction(k, 40) ** 9 for k in range(1, 40)]
    sines = [dyadic_above(one, 32) for sine in sines for one in (sine, 1 - sine)]
    optima = ProvedOptima.none(len(sines))
    optima.sine[:] = [sine.pair for sine in sines]

    bounds = [half_angle_bound(sine.value) for sine in sines]
    np.testing.assert_allclose(_angles(optima), bounds, rtol=1e-15)
