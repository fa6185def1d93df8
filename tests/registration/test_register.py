"""`register` beside SciPy: with a scale, without a translation, of one vector."""

from __future__ import annotations

import warnings
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import scipy.spatial.transform as scipy_transform
from strategies import random_rotation

import certreg
from certreg import RegistrationProblem, Similarity, register
from certreg.errors import (
    CertregError,
    DegenerateProblemError,
    InvalidProblemError,
    OutOfRangeError,
)
from certreg.results import Optimality, PoseVerdict

if TYPE_CHECKING:
    from collections.abc import Callable

NEAR = 1e-12  # of the scale, the rotation and the clouds' size


def drawn(seed: int) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 40))
    x = 10.0 ** rng.uniform(-3, 3) * rng.normal(size=(n, 3))
    y = 10.0 ** rng.uniform(-2, 2) * (x @ random_rotation(rng).T + rng.normal(size=3) * x.std())
    noise = rng.choice([0.0, 0.1, 3.0]) * y.std() * rng.normal(size=y.shape)
    return x, y + noise, rng.uniform(0.1, 3.0, n)


@pytest.mark.slow
def test_sigma_means_what_it_means_for_a_problem():
    x, y, sigma = drawn(7)
    normals = random_rotation(np.random.default_rng(7))[np.arange(len(x)) % 3]
    stated = RegistrationProblem(x, y, sigma=sigma)
    several: list[dict[str, Any]] = [{}, {"scale": "asymmetric"}, {"rotation_only": True}]
    for options in several:
        found, expected = (
            register(x, y, sigma=sigma, **options),
            register(x, y, stated.weights, **options),
        )
        assert np.array_equal(found.T_target_source, expected.T_target_source)
    of_planes = register(x, y, sigma=sigma, normals=normals)
    certified = certreg.certify(x, y, sigma=sigma, normals=normals, simulation=False)
    assert np.abs(of_planes.rotation - certified.pose.rotation).max() < NEAR
    assert np.abs(register(x, y, sigma=0.3).rotation - register(x, y).rotation).max() < NEAR


@pytest.mark.parametrize("normals", [None, [[0, 0, 1], [0, 1, 0], [1, 0, 0], [1, 1, 1]]])
def test_what_is_no_sigma_is_refused_as_for_a_problem(normals: Any):
    x = np.diag([1.0, 2.0, 3.0, 4.0])[:, :3]
    for sigma, weights in ((1.0, [1.0] * 4), (0.0, None), ([1.0] * 3, None), (np.nan, None)):
        given: dict[str, Any] = {"sigma": sigma, "weights": weights, "normals": normals}
        with pytest.raises(InvalidProblemError) as of_a_problem:
            RegistrationProblem(x, x, **given)
        with pytest.raises(InvalidProblemError) as refused:
            register(x, x, **given)
        assert str(refused.value) == str(of_a_problem.value)


@pytest.mark.parametrize("name", ["foo", "weigths"])
@pytest.mark.parametrize("value", [None, [1.0] * 4])
def test_a_keyword_that_no_function_knows_is_named_as_python_names_it(name: str, value: Any):
    x = np.diag([1.0, 2.0, 3.0, 4.0])[:, :3]
    problem = RegistrationProblem(x, x)
    calls: dict[str, tuple[Callable[..., object], tuple[Any, ...]]] = {
        "register": (register, (x, x)),
        "certify": (certreg.certify, (x, x)),
        "pair": (certreg.pair, (x, x)),
        "assess": (certreg.assess, (x, x, np.eye(4))),
    }
    of_a_problem = {
        "certify": (certreg.certify, (problem,)),
        "assess": (certreg.assess, (problem, np.eye(4))),
    }
    for function, (call, given) in (*calls.items(), *of_a_problem.items()):
        with pytest.raises(TypeError) as refused:
            call(*given, **{name: value})
        assert str(refused.value) == f"{function}() got an unexpected keyword argument {name!r}"


def test_a_keyword_of_a_problem_that_no_pose_depends_on_is_none_of_register():
    x = np.diag([1.0, 2.0, 3.0, 4.0])[:, :3]
    with pytest.raises(
        TypeError, match=r"register\(\) got an unexpected keyword argument 'damping'"
    ):
        register(x, x, damping=2.0)  # pyright: ignore[reportCallIssue]


@pytest.mark.parametrize("unit", [1e-100, 1e100])
def test_no_size_leaves_the_doubles(unit: float):
    x, y, w = drawn(4)
    for scale in ("asymmetric", "symmetric"):
        plain = register(x, y, w, scale=scale)
        found = register(x / unit, y * unit, w, scale=scale)
        assert isinstance(plain, Similarity)
        assert isinstance(found, Similarity)
        assert abs(found.scale / (plain.scale * unit * unit) - 1.0) < NEAR
        assert np.abs(found.rotation - plain.rotation).max() < NEAR


def test_a_scale_that_no_double_holds_is_refused():
    x, y, w = drawn(4)
    for scale in ("asymmetric", "symmetric"):
        for unit in (1e-165, 1e160):
            with pytest.raises(OutOfRangeError, match="the scale exceeds the range of doubles"):
                register(x / unit, y * unit, w, scale=scale)


def test_what_rounding_does_not_tell_is_refused_with_a_scale_as_without():
    line = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])
    cloud = np.random.default_rng(1).normal(size=(5, 3))
    for x, y in ((line, line), (np.ones((4, 3)), cloud[:4]), (cloud, np.zeros((5, 3)))):
        for scale in ("asymmetric", "symmetric"):
            with pytest.raises(CertregError) as caught:
                register(x, y, scale=scale)
            assert isinstance(caught.value, DegenerateProblemError)


@pytest.mark.parametrize("wrong", [{"scale": "free"}, {"rotation_only": 1}, {"scale": None}])
def test_another_word_is_refused(wrong: dict[str, Any]):
    cloud = np.random.default_rng(1).normal(size=(5, 3))
    with pytest.raises(InvalidProblemError):
        register(cloud, cloud, **wrong)


FIXED = 2.0**106  # of the infinite weight: see docs/howto/similarity.md
DOCUMENTED = {  # target, source, weights
    "noise": (
        [[0, 1, 0], [0, 1, 1], [0, 1, 1]],
        [[1, 0, 0], [1, 1.1, 0], [1, 0.9, 0]],
        None,
    ),
    "a vector of length zero": ([[0, 1, 0], [0, 0, 0], [0, 0, 1]], np.eye(3), None),
    "weights": ([[0, 1, 0], [0, 1, 1]], [[1, 0, 0], [1, 1.1, 0]], [1.0, 100.0]),
    "one weight is zero": (np.eye(3)[[1, 2, 0]], np.eye(3) * [1, 2, 3], [1.0, 2.0, 0.0]),
}


def certified(target: Any, source: Any, weights: Any = None) -> Any:
    return certreg.certify(
        np.array(source, dtype=float),
        np.array(target, dtype=float),
        weights=weights,
        rotation_only=True,
        relaxation=False,
        simulation=False,
    )


@pytest.mark.parametrize("name", DOCUMENTED)
def test_documented_cases_are_reproduced_and_certified(name: str):
    target, source, weights = DOCUMENTED[name]
    turn = scipy_transform.Rotation.align_vectors(target, source, weights=weights)[0]
    found = certified(target, source, weights)

    assert found.status is Optimality.CERTIFIED
    assert np.abs(found.pose.rotation - turn.as_matrix()).max() < 1e-12
    assert certreg.assess(found, turn).verdict in {PoseVerdict.OPTIMAL, PoseVerdict.NEAR_OPTIMAL}
    assert found.pose.translation.tolist() == [0.0] * 3


def test_one_vector_alone_is_certified_not_unique():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        turn = scipy_transform.Rotation.align_vectors([[0, 1, 0]], [[1, 0, 0]])[0]
    found = certified([[0, 1, 0]], [[1, 0, 0]])

    assert found.status is Optimality.CERTIFIED_NOT_UNIQUE
    assert np.allclose(found.pose.rotation @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    assert certreg.assess(found, turn).verdict is PoseVerdict.OPTIMAL


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("noise", [0.0, 0.1, 3.0])
def test_a_finite_weight_stands_for_an_infinite_one(noise: float):
    """The bounds of the page hold, and the rotation is SciPy's, for 40 sets of vectors."""
    for seed in range(40):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 8))
        source = rng.normal(size=(n, 3)) * 10.0 ** rng.uniform(-2, 2, (n, 1))
        target = source @ random_rotation(rng).T + noise * np.abs(source).max() * rng.normal(
            size=(n, 3)
        )
        weights = np.r_[np.inf, rng.uniform(0.1, 3.0, n - 1)]
        x, y = (np.linalg.norm(c, axis=1) for c in (source, target))
        most = float(np.sum(weights[1:] * (x + y)[1:] ** 2))
        finite = np.r_[FIXED * most / (4.0 * x[0] * y[0]), weights[1:]]
        found = certified(target, source, finite)
        scipy = scipy_transform.Rotation.align_vectors(target, source, weights=weights)[0]

        assert found.status is Optimality.CERTIFIED
        assert found.certificate.body.gap < Fraction(most) / 10**20
        assert np.abs(found.pose.rotation - scipy.as_matrix()).max() < 1e-11
        aimed = found.pose.rotation @ source[0] / x[0] - target[0] / y[0]
        assert np.abs(aimed).max() < 4e-16 + 2.0**-52
