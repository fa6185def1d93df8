"""A pose file that says two things is refused; what rounding makes of one thing is not."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path

import numpy as np
import pytest

from certreg.errors import InvalidFileError
from certreg.io.poses import ROTATION_TOLERANCE, parse_pose


def stated(apart: float) -> bytes:
    """A quarter turn as a quaternion, and a rotation that is turned further by a small angle."""
    c, s = math.cos(math.pi / 2 + apart), math.sin(math.pi / 2 + apart)
    half = math.sqrt(0.5)
    document = {
        "quaternion_wxyz": [half, 0.0, 0.0, half],
        "rotation": [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
        "translation": [1.0, 2.0, 3.0],
    }
    return json.dumps(document).encode()


@pytest.mark.parametrize("apart", [0.0, 0.99 * ROTATION_TOLERANCE])
def test_rotation_and_quaternion_that_agree_are_one_pose(apart: float):
    pose = parse_pose(io.BytesIO(stated(apart)), Path("pose.json"))

    assert pose.quaternion is not None
    assert np.allclose(pose.rotation, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)


@pytest.mark.parametrize("apart", [1.01 * ROTATION_TOLERANCE, 0.1, math.pi, -1.01e-4])
def test_rotation_and_quaternion_that_disagree_are_refused(apart: float):
    with pytest.raises(InvalidFileError, match="are two different rotations: keep one") as caught:
        parse_pose(io.BytesIO(stated(apart)), Path("pose.json"))

    assert caught.value.limit == ROTATION_TOLERANCE == 1e-4
    assert str(caught.value).startswith("pose.json: ")
