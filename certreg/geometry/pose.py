"""Pose: a rigid motion y = R x + t."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pose(Brief):
    """The motion that takes the source to the target: `y = rotation @ x + translation`.

    rotation: (3, 3), a rotation matrix up to the rounding of its entries.
    translation: (3,), in the user's unit.
    quaternion_wxyz: (4,), unit, scalar first, first nonzero entry positive.
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    quaternion_wxyz: NDArray[np.float64]

    def __repr__(self) -> str:
        numbers = (self.quaternion_wxyz, self.translation)
        turn, shift = (", ".join(f"{x:.6g}" for x in each.tolist()) for each in numbers)
        return f"<Pose: quaternion_wxyz ({turn}), translation ({shift})>"

    @property
    def T_target_source(self) -> NDArray[np.float64]:
        """The 4x4 homogeneous matrix that takes source coordinates to target coordinates."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation
        matrix[:3, 3] = self.translation
        return matrix

    def apply(self, points: ArrayLike) -> NDArray[np.float64]:
        """The moved points (N, 3)."""
        return np.asarray(points, dtype=np.float64) @ self.rotation.T + self.translation

    def as_scipy(self) -> Any:
        """The rotation as `scipy.spatial.transform.Rotation` (SciPy must be installed)."""
        from scipy.spatial.transform import Rotation  # pyright: ignore[reportMissingTypeStubs]

        return Rotation.from_quat(self.quaternion_wxyz, scalar_first=True)
