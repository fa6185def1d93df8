"""Numbers at the ends of the doubles: signs, counts and words stay true."""

from __future__ import annotations

import numpy as np
import pytest

import certreg
from certreg import RegistrationProblem
from certreg.results import Optimality


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
