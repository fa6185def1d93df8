"""Numbers at the ends of the doubles: bounds, labels, signs, counts and words stay true."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from commands import certreg as run
from rotated_pairs import BOUND, rotated_pairs

import certreg
from certreg import RegistrationProblem
from certreg.errors import InvalidProblemError
from certreg.problem.arrays import apart, diameter, lengths
from certreg.registration.pair_angles import angles_between, widest_angles
from certreg.results import Optimality

ROTATIONS: dict[str, Any] = {"rotation_only": True, "objective": "truncated"}
PAIRS = rotated_pairs(np.random.default_rng(3), 12, 0.5)
LABELS = np.where(PAIRS.true, "inlier", "outlier").tolist()


def test_lengths_are_those_of_the_usual_sizes_times_any_power_of_two():
    rows = np.random.default_rng(0).standard_normal((20, 3))
    usual = np.linalg.norm(rows, axis=1)

    for exponent in (-1000, -600, 0, 600, 1000):
        unit = 2.0**exponent
        assert (lengths(rows * unit) == usual * unit).all()
        assert (apart(rows * unit, -rows * unit) == 2.0 * usual * unit).all()
    assert lengths(np.zeros((1, 3))) == 0.0
    assert diameter(np.array([[-1.7e308, 0.0, 0.0], [1.7e308, 0.0, 0.0]])) == np.inf


def test_angles_do_not_depend_on_the_unit():
    x, y = PAIRS.source, PAIRS.target
    bounds = np.full(len(x), BOUND)
    usual = angles_between(x, y), widest_angles(x, y, bounds)

    for unit in (2.0**-1000, 2.0**-600, 2.0**600, 2.0**1000):
        here = angles_between(x * unit, y * unit), widest_angles(x * unit, y * unit, bounds * unit)
        assert all((a == b).all() for a, b in zip(here, usual, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("size", [2.0**-1000, 2.0**-650, 2.0**650, 2.0**1000])
def test_labels_of_rotations_are_those_of_any_unit(size: float, tmp_path):
    source, target = PAIRS.source * size, PAIRS.target * size
    result: Any = certreg.certify(source, target, max_residual=BOUND * size, **ROTATIONS)

    assert list(result.labels) == LABELS
    assert ((result.residuals <= BOUND * size) == PAIRS.true).all()
    result.report(str(tmp_path / "a.html"))
    assert "CERTIFIED" in str(result)
    assert result.to_dict()["truncated"]["labels"] == LABELS


@pytest.mark.slow
@pytest.mark.parametrize("size", [2.0**-650, 2.0**650])
def test_labels_of_motions_are_those_of_any_unit(size: float, tmp_path):
    source, target = PAIRS.source * size, PAIRS.target * size
    result: Any = certreg.certify(source, target, max_residual=BOUND * size)

    assert list(result.labels) == LABELS
    result.report(str(tmp_path / "a.html"))
    assert str(result).startswith("CERTIFIED")
    kept = certreg.assess(source, target, labels=PAIRS.true, max_residual=BOUND * size)
    assert kept.headline.startswith("CONSISTENT")


@pytest.mark.parametrize("size", [1e-320, 1e-300, 1e300, 1e307])
@pytest.mark.parametrize("scale", ["none", "asymmetric"])
def test_sizes_that_the_checker_refuses_are_refused_first(size: float, scale: str):
    source, target = PAIRS.source * size, PAIRS.target * size

    with pytest.raises(InvalidProblemError, match="in a unit in which they are nearer to 1"):
        certreg.certify(source, target, max_residual=0.5 * size, scale=scale)


@pytest.mark.parametrize("bound", ["1e300", "1e308"])
def test_an_endless_bound_is_refused_in_one_line(bound: str, tmp_path):
    np.savetxt(tmp_path / "a.csv", PAIRS.source, "%.17g", ",")
    np.savetxt(tmp_path / "b.csv", PAIRS.target, "%.17g", ",")
    options = ("--max-residual", bound, "--rotation-only", "--objective", "truncated")
    told = run("certify", tmp_path / "a.csv", tmp_path / "b.csv", *options)

    assert (told.code, told.out) == (2, "")
    assert told.err.startswith("certreg: --max-residual is 1e+30")
    assert told.err.count("\n") == 1


def test_half_a_tiny_diameter_is_not_called_0():
    tiny = 1e-200 * PAIRS.source

    with pytest.raises(InvalidProblemError, match=r"diameter of the smaller cloud, \d.*e-200"):
        certreg.certify(tiny, tiny, max_residual=1e-199)


def test_the_problem_of_a_result_with_bounds_is_not_certified_as_one_without():
    found: Any = certreg.certify(PAIRS.source, PAIRS.target, max_residual=BOUND)

    words = "the pairs of this problem have bounds: give the one that it was made of"
    with pytest.raises(InvalidProblemError, match=words):
        certreg.certify(found.problem)


def certified(problem):
    return certreg.certify(problem, relaxation=False, simulation=False)


TINY_GAPS = [
    (
        [[1, 0, 1e-300], [0, 1, 0], [0, 0, 1]],
        [[0, 1, 0], [0, 0, 1], [1, -1e-300, 0]],
    ),
    (
        [[1, 1e-300, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
        [[1, 1e-300, 0], [-1, 0, 0], [0, 2, 0], [0, -2, 0], [0, 0, -1], [0, 0, 1]],
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(("source", "target"), TINY_GAPS)
def test_signs_and_witnesses_do_not_underflow(source, target):
    registration = certified(RegistrationProblem(source, target))

    assert registration.status is Optimality.CERTIFIED
    assert registration.equilibria.margin.relative > 0.0
    for component in registration.equilibria.components:
        assert (component.witness is None) == component.optimal
        if component.eigenvalues is not None:
            unstable = (component.eigenvalues.real > 0).sum()
            assert unstable == component.unstable_eigenvalues


def test_eigenvalues_are_given_only_where_their_digits_are_right():
    """A rod of width e: its inertia has condition e^-2, rounding e^-2 ulps."""
    reference = None
    for width in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7):
        rod = np.array([[-1.0, 0, 0], [0, width, 0], [1, 0, 0], [0.5, 0, width]])
        component = certreg.equilibria(RegistrationProblem(rod, rod)).components[1]
        if component.eigenvalues is None:
            assert width <= 1e-5
            continue
        reference = reference or component.eigenvalues[0].real
        assert component.eigenvalues[0].real == pytest.approx(reference, rel=2e-4)


def test_weights_three_hundred_decades_apart_are_no_contradiction():
    source, target = [[1 + 2**-52, 0, 0], [0, 1, -1]], [[-1, 1, 1], [-1, -1, -1]]
    registration = certified(RegistrationProblem(source, target, weights=[5e-324, 1.0]))

    assert registration.status is Optimality.BOUNDED  # the rounding of t outweighs one pair
    assert not registration.equilibria.classification.unique


@pytest.mark.slow
def test_numbers_too_long_for_a_certificate_end_in_words_or_a_certificate():
    big, small = 2.0**1020, 5e-324
    source = [[big, 0, 0], [-big, 0, 0], [0, 0, 0], [0, small, 0], [small, 0, 0], [-small, 0, 0]]
    target = [[big, 0, 0], [-big, 0, 0], [small, 0, 0], [0, 0, 0], [0, small, 0], [0, -small, 0]]
    weights = [big, big, small, small, small, small]
    registration = certified(RegistrationProblem(source, target, weights=weights))

    assert registration.status is not Optimality.CERTIFIED_NOT_UNIQUE


@pytest.mark.slow
def test_magnitudes_of_all_kinds_never_end_in_a_traceback():
    rng = np.random.default_rng(4)
    values = np.array([5e-324, 1e-300, 1e-100, 1.0, 1e100, 1e300, 0.0, -1.0])
    for _ in range(30):
        n = int(rng.integers(1, 6))
        problem = RegistrationProblem(
            rng.choice(values, size=(n, 3)),
            rng.choice(values, size=(n, 3)),
            weights=rng.choice(values[:6], size=n),
        )
        registration = certified(problem)
        assert registration.verdict is None or registration.verdict.proved
