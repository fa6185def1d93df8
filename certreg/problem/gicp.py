"""The springs of generalised ICP, which depend on the rotation, frozen at one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.geometry.given import given_pose
from certreg.geometry.pose_matrix import why_no_rotation
from certreg.problem.attributes import SIX_OF_NINE, checked_rows, held_rows, require
from certreg.problem.factors import covariance_factors, lower_triangles, symmetric_matrices
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

FLAT = (
    "is flat in both clouds along one direction, to rounding: the sum of the two covariances has "
    "a rank below 3; add a share of their size along the normals, as GICP does (1e-3)"
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrozenInformation(Brief):
    """Spring matrices (N, 3, 3) that were made at one rotation (3, 3); an array for NumPy."""

    matrices: NDArray[np.float64]
    rotation: NDArray[np.float64]

    def __array__(self, dtype: Any = None, *, copy: bool | None = None) -> NDArray[Any]:
        """The matrices, where NumPy asks for an array."""
        matrices = np.asarray(self.matrices, dtype=dtype)
        return matrices.copy() if copy else matrices

    def __len__(self) -> int:
        return len(self.matrices)

    @property
    def spring_note(self) -> str:
        """What a result says of such springs."""
        cosine = (float(np.trace(self.rotation)) - 1.0) / 2.0
        angle = math.degrees(math.acos(max(-1.0, min(1.0, cosine))))
        turn = f"a turn by {angle:.6g} degrees" if angle else "R = I"
        return (
            f"the matrices are those of GICP, frozen at one rotation ({turn}): what is proved is "
            "about them, not about those of another rotation"
        )

    def of_rows(self, rows: NDArray[np.int64]) -> FrozenInformation:
        """Those of some pairs."""
        return FrozenInformation(matrices=self.matrices[rows], rotation=self.rotation)


def gicp_information(cov_source: Any, cov_target: Any, rotation: Any) -> FrozenInformation:
    """The spring matrices of generalised ICP at a rotation R: (C_target + R C_source R^T)^-1.

    GICP weighs a pair by its residual under the noise of both points. That of the source turns with
    R, so these are no springs of one problem; frozen at a rotation, as at each step of GICP, they
    are. A result says so.

    Parameters
    ----------
    cov_source, cov_target
        Covariances of the points of each pair, each in the frame of its cloud: (N, 3, 3) or (N, 6),
        or clouds that have them (Open3D, small_gicp), row i with row i.
    rotation
        R, from source to target: a matrix, a quaternion with the scalar first, or a pose, of any
        kind that `assess` takes.

    Returns
    -------
    FrozenInformation
        For `RegistrationProblem(source, target, information=...)`; (N, 3, 3) for NumPy.

    Raises
    ------
    InvalidProblemError
        Where a sum has a rank below 3, with its row; where the rotation is none.

    Examples
    --------
    >>> flat = np.diag([1.0, 1.0, 0.001])
    >>> np.asarray(gicp_information([flat], [flat], np.eye(3))).round(3)[0].diagonal().tolist()
    [0.5, 0.5, 500.0]
    """
    turn = given_pose(rotation)
    fault = why_no_rotation(turn.turn)
    if fault is not None:
        raise InvalidProblemError(f"rotation: {fault}", array="rotation")
    here, there = _square(cov_source, "cov_source"), _square(cov_target, "cov_target")
    if len(here) != len(there):
        raise InvalidProblemError(
            f"cov_source has {len(here)} matrices, cov_target {len(there)}: one each per pair",
            array="cov_target",
            value=len(there),
            limit=len(here),
        )
    sums = there + turn.rotation @ here @ turn.rotation.T
    even = (sums + sums.transpose(0, 2, 1)) / 2.0
    found = covariance_factors(even.reshape(-1, 9)[:, SIX_OF_NINE])
    require("cov_source", sums, (found.ranks == 3) & ~found.indefinite, FLAT)
    lower = lower_triangles(found.lower)
    return FrozenInformation(matrices=lower @ lower.transpose(0, 2, 1), rotation=turn.rotation)


def _square(given: Any, name: str) -> NDArray[np.float64]:
    """(n, 3, 3) covariances. Raises InvalidProblemError with the row."""
    array = held_rows(given, "covariances")
    rows = checked_rows(array, "covariances", len(array), several=False, called=name)
    return symmetric_matrices(rows)
