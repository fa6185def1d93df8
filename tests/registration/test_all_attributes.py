"""What every registration has, of whatever data, motion and loss: no attribute is missing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import certreg
from certreg.results import Absent

CLOUD = np.random.default_rng(5).normal(size=(12, 3))
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
KINDS: dict[str, dict[str, Any]] = {
    "weights": {},
    "rotation": {"rotation_only": True},
    "scale": {"scale": "asymmetric"},
    "springs": {"normals": np.roll(CLOUD, 1, axis=0)},
    "consensus": {"max_residual": 0.1},
    "consensus of a scale": {"max_residual": 0.1, "scale": "asymmetric"},
    "consensus of springs": {"max_residual": 0.1, "normals": np.roll(CLOUD, 1, axis=0)},
    "truncated": {"max_residual": 0.1, "objective": "truncated", "rotation_only": True},
}
PRESENT = ("problem", "pose", "fit", "residuals", "rmse", "objective", "certificate", "verdict")
MAYBE = ("covariance", "equilibria", "robustness", "trajectory")


@pytest.fixture(scope="module", params=KINDS)
def found(request: pytest.FixtureRequest) -> Any:
    noise = 1e-3 * np.random.default_rng(6).normal(size=CLOUD.shape)
    return certreg.certify(
        CLOUD, CLOUD @ TURN.T + noise, relaxation=False, simulation=False, **KINDS[request.param]
    )


def test_what_no_registration_is_without(found: Any):
    for name in PRESENT:
        assert getattr(found, name) is not None, name
    assert found.exit_code == 0
    assert found.headline in found.summary()


def test_what_may_be_missing_says_why(found: Any):
    for name in MAYBE:
        value = getattr(found, name)
        stated = found.stated(name)
        assert isinstance(stated, Absent) is (value is None), name
