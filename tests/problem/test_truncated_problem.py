"""What states a problem of truncated squares over rotations, and what is refused in one line."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np
import pytest

from certreg.errors import InvalidProblemError
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss

POINTS = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]


def points(**options: Any) -> RegistrationProblem:
    stated: dict[str, Any] = {"rotation_only": True} | options
    return RegistrationProblem(POINTS, POINTS, **stated)


def test_the_bytes_are_prefix_n_points_weights_and_bounds():
    problem = bounded(points(), [0.5, 0.25, 1.0], Loss.TRUNCATED)
    numbers = [*np.ravel(POINTS), *np.ravel(POINTS), 1.0, 1.0, 1.0, 0.5, 0.25, 1.0]

    head = b"certreg-truncated-rotation/1\0" + (3).to_bytes(8, "little")
    assert problem.data_bytes() == head + np.array(numbers, dtype="<f8").tobytes()
    assert problem.digest() == hashlib.sha256(problem.data_bytes()).hexdigest()


def test_bounds_are_a_part_of_the_problem():
    digests = {bounded(points(), bound, Loss.TRUNCATED).digest() for bound in (0.5, 0.25)}

    assert len(digests | {points().digest()}) == 3


@pytest.mark.parametrize(
    ("options", "bound", "words"),
    [
        ({"rotation_only": False}, 1.0, r"without a translation for now: .*give --rotation-only"),
        ({"scale": "symmetric"}, 1.0, "squares go without a free scale: leave out --scale"),
        ({"weights": [1.0, 2.0, 1.0]}, 1.0, r"weights\[1\] is 2.0: the bounds weigh the pairs"),
        ({"sigma": 0.5}, 1.0, "sigma is given: the bounds weigh the pairs here, leave sigma out"),
        ({"sigma": 1.0}, 1.0, "sigma is given: the bounds weigh"),
        ({}, [1.0, 0.0, 1.0], r"max_residual\[1\] is 0.0"),
        ({}, [1.0, 2e-101, 1.0], r"row 1 \(counting from 0\) is 1e100 bounds away"),
    ],
)
def test_what_states_no_such_problem_is_refused(options, bound, words: str):
    with pytest.raises(InvalidProblemError, match=words):
        bounded(points(**options), bound, Loss.TRUNCATED)


def test_two_pairs_are_too_few():
    two = RegistrationProblem(POINTS[:2], POINTS[:2], rotation_only=True)

    with pytest.raises(InvalidProblemError, match="2 pairs: truncated squares take 3 to 100000"):
        bounded(two, 1.0, Loss.TRUNCATED)
