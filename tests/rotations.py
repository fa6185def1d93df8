"""Rotations near one another, for the tests."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from certreg.equilibrium.equilibrium_set import unit_double


def hat(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def turned(R, phi):
    """R exp([phi]) by the series, for small phi."""
    A = hat(phi)
    return R @ (np.eye(3) + A + A @ A / 2 + A @ A @ A / 6)


def saddle_start(found, index, angle, axis):
    """At rest beside the saddle of that index: turned off it by an angle about an axis."""
    q = unit_double(found.quaternions[index])
    R = Rotation.from_quat(q, scalar_first=True) * Rotation.from_rotvec(angle * np.asarray(axis))
    return np.array([*[0.0] * 3, *R.as_matrix().ravel(), *[0.0] * 6])
