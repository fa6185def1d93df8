"""What `certify` and `assess` give for general springs, held against independent computations."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from spring_families import lidar, line, mixed, plane, statement

from certreg.equilibrium.equilibrium_set import unit_double
from certreg.equilibrium.paths import critical_lines
from certreg.errors import InvalidProblemError
from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.curvature import slope_and_curvature
from certreg.registration.simulation import optimally_damped
from certreg.relaxation.refining import refined
from certreg.results import PoseVerdict

Array = NDArray[np.float64]

FAMILIES = {"plane": plane, "line": line, "mixed": mixed, "lidar": lidar}


def problem_of(family: str, n: int = 20, s: float = 0.05, **more: Any) -> RegistrationProblem:
    given = FAMILIES[family](np.random.default_rng(7), n, s)
    return RegistrationProblem(given.source, given.target, **given.springs, **more)


@cache
def registered(family: str, **more: Any) -> Any:
    return certify(problem_of(family, **more))


def turned(rotation: Array, turn: Array) -> Array:
    """R exp([turn])."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    near = np.eye(3) + cross + cross @ cross / 2
    if angle < 1e-6:
        return rotation @ near
    sine, rest = np.sin(angle) / angle, (1 - np.cos(angle)) / angle**2
    return rotation @ (np.eye(3) + sine * cross + rest * cross @ cross)


@pytest.mark.slow
def test_the_covariance_is_that_of_many_draws_of_the_noise():
    """Planes of N = 30, s = 0.01: each draw is solved by five steps of Gauss and Newton."""
    rng, s = np.random.default_rng(3), 0.01
    given = plane(rng, 30, 0.0)
    normals, x = given.springs["normals"], given.source
    draws: list[Array] = []
    for _ in range(600):
        y = given.target + s * rng.standard_normal(x.shape)
        rotation, shift = given.rotation, given.translation
        for _ in range(3):
            rows = np.hstack([normals, np.cross(x, normals @ rotation)])
            off = np.einsum("ki,ki->k", normals, y - x @ rotation.T - shift)
            move = np.linalg.lstsq(rows, off, rcond=None)[0]
            rotation, shift = turned(rotation, move[3:]), shift + move[:3]
        apart = given.rotation.T @ rotation
        turn = [apart[2, 1] - apart[1, 2], apart[0, 2] - apart[2, 0], apart[1, 0] - apart[0, 1]]
        draws.append(np.array([*(shift - given.translation), *(np.array(turn) / 2)]))
    measured = np.cov(np.array(draws).T)

    told = certify(RegistrationProblem(x, given.target, normals=normals, sigma=s)).covariance
    assert told is not None
    assert told.matrix is not None
    scale = np.sqrt(np.diag(told.matrix))
    assert np.abs((measured - told.matrix) / scale / scale[:, None]).max() <= 0.2
    assert np.diag(measured) == pytest.approx(np.diag(told.matrix), rel=0.2)


@pytest.mark.parametrize("size", [1e-100, 1e100])
def test_normals_of_any_length_leave_the_noise_that_the_residuals_tell(size: float):
    given = plane(np.random.default_rng(7), 20, 0.05)
    clouds, normals = (given.source, given.target), given.springs["normals"]
    one, other = (certify(*clouds, normals=times * normals) for times in (1.0, size))

    assert one.covariance is not None
    assert other.covariance is not None
    assert other.covariance.rotation_sigma == pytest.approx(one.covariance.rotation_sigma)


def test_more_noise_than_was_given_is_warned_of_and_less_is_not():
    assert registered("plane", sigma=0.05).fit.warnings == ()
    warned = registered("plane", sigma=0.001)
    assert [code.value for code in warned.fit.codes] == ["chi2"]
    assert str(warned).startswith("CERTIFIED OPTIMUM, BUT THE FIT IS POOR: the residuals are ")
    assert warned.exit_code == 0


@pytest.mark.slow
def test_a_stable_wrong_pose_is_named_as_what_a_local_method_stops_at():
    given = plane(np.random.default_rng(3), 7, 0.3)
    found: Any = certify(RegistrationProblem(**statement(given)))
    levelled, objective = found.solution.found.levelled, found.solution.objective
    lines = [refined(levelled, q) for q in critical_lines(levelled.rest).points.real]
    shapes = [(q, *slope_and_curvature(objective, q)) for q in lines]
    real = [(q, curved) for q, slope, curved in shapes if np.abs(slope).max() < 1e-12]
    ends = [q for q, _ in real]
    index = [int((np.linalg.eigvalsh(curved) < 0).sum()) for _, curved in real]
    judged = [assess(found, unit_double(q)) for q in ends]

    assert index.count(0) == 3
    assert [one.nearest_index for one in judged] == index
    others = [one for one in judged if one.verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM]
    assert len(others) == len(ends) - 1
    words = "a stable equilibrium, at which a local method stops, and not the optimum"
    assert sum(words in one.headline for one in others) == index.count(0) - 1


def test_what_is_for_one_weight_per_pair_alone_says_so_in_one_line():
    with pytest.raises(InvalidProblemError, match="optimal damping is computed for") as caught:
        optimally_damped(problem_of("plane"))
    assert "\n" not in str(caught.value)
    assert registered("plane").equilibria is None
    assert registered("plane").trajectory is None
