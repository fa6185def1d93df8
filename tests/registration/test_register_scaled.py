"""`register` with a scale, and without a translation, beside what is certified and beside SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.spatial.transform as scipy_transform
from strategies import random_rotation

import certreg
from certreg import Pose, RegistrationProblem, Similarity, register
from certreg.errors import (
    CertregError,
    DegenerateProblemError,
    InvalidProblemError,
    OutOfRangeError,
)
from certreg.registration import closed_form

NEAR = 1e-12  # of the scale, the rotation and the clouds' size
MODELS = [(s, only) for s in ("none", "asymmetric", "symmetric") for only in (False, True)]


def drawn(seed: int) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 40))
    x = 10.0 ** rng.uniform(-3, 3) * rng.normal(size=(n, 3))
    y = 10.0 ** rng.uniform(-2, 2) * (x @ random_rotation(rng).T + rng.normal(size=3) * x.std())
    noise = rng.choice([0.0, 0.1, 3.0]) * y.std() * rng.normal(size=y.shape)
    return x, y + noise, rng.uniform(0.1, 3.0, n)


def agree(found: Any, best: Any, x: Any, y: Any) -> bool:
    scales = [getattr(pose, "scale", 1.0) for pose in (found, best)]
    moved = np.abs(found.apply(x) - best.apply(x)).max() / max(np.ptp(y), np.abs(y).max())
    return bool(
        type(found) is type(best)
        and abs(scales[0] / scales[1] - 1.0) < NEAR
        and np.abs(found.rotation - best.rotation).max() < NEAR
        and moved < 10 * NEAR
    )


@pytest.mark.one_in(4)
@pytest.mark.parametrize(("scale", "only"), MODELS)
@pytest.mark.parametrize("long", [False, True])
def test_it_is_the_certified_pose_by_either_way(monkeypatch, scale: str, only: bool, long: bool):  # noqa: FBT001
    if long:
        monkeypatch.setattr(closed_form, "floating_pose", lambda *_, **__: None)
    for seed in range(12):
        x, y, w = drawn(seed)
        problem = RegistrationProblem(x, y, weights=w, scale=scale, rotation_only=only)
        best = certreg.certify(problem, relaxation=False, simulation=False).pose
        found = register(x, y, w, scale=scale, rotation_only=only)

        assert agree(found, best, x, y), seed
        assert isinstance(found, Pose if scale == "none" else Similarity)
        assert not only or found.translation.tolist() == [0.0] * 3


def test_a_rotation_alone_is_scipys():
    for seed in range(20):
        x, y, w = drawn(seed)
        turn = scipy_transform.Rotation.align_vectors(y, x, weights=w)[0]

        found = register(x, y, w, rotation_only=True)
        assert np.abs(found.rotation - turn.as_matrix()).max() < 1e-9


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


def test_general_springs_take_no_scale_and_no_translation():
    cloud = np.random.default_rng(1).normal(size=(8, 3))
    normals = cloud / np.linalg.norm(cloud, axis=1)[:, None]
    for scale in ("symmetric", "asymmetric"):
        with pytest.raises(InvalidProblemError, match=r"one weight per pair|not yet with a free"):
            register(cloud, cloud, normals=normals, scale=scale)

    moved = register(cloud, cloud + 1.0, normals=normals[::-1])
    turned = register(cloud, cloud + 1.0, normals=normals[::-1], rotation_only=True)
    assert moved.translation.tolist() != [0.0] * 3
    assert turned.translation.tolist() == [0.0] * 3
    best = certreg.certify(cloud, cloud + 1.0, normals=normals[::-1], rotation_only=True).pose
    assert (turned.quaternion_wxyz == best.quaternion_wxyz).all()
