"""Arrays from outside as the numbers of a pose: shapes, finite values, how near to a rotation."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.verify import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

ROTATION_TOLERANCE = 1e-4  # |R^T R - I|: admits 4x4 matrices printed with five decimals
ROUNDED_DEFECT = 0.1  # two decimals give 2 * 0.015 + 0.015^2 at most
UNNOTED_DEFECT = 1e-12  # |R^T R - I| of a matrix of doubles: its own rounding


def rotation_defect(matrix: NDArray[np.float64]) -> float:
    """The largest entry of |R^T R - I| of a matrix (3, 3); infinite or NaN beyond the doubles."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.abs(matrix.T @ matrix - np.eye(3)).max())


def why_no_rotation(
    matrix: NDArray[np.float64], tolerance: float = ROTATION_TOLERANCE
) -> str | None:
    """Why a matrix (3, 3) or quaternion (4,) is no rotation, in words; None if it is one.

    tolerance: what the digits that are not printed may make of a rotation.
    """
    if matrix.shape == (4,):
        norm = math.hypot(*matrix.tolist())
        if abs(norm - 1.0) <= tolerance:
            return None
        return f"The quaternion has norm {norm:.6g}, not 1: it is not a rotation."
    defect = rotation_defect(matrix)
    stretch = np.linalg.svd(matrix, compute_uv=False)
    reflected = bool(np.linalg.slogdet(matrix)[0] < 0)
    if defect <= tolerance and not reflected:
        return None
    if defect <= tolerance:
        return (
            "The matrix is a reflection (determinant -1), not a rotation: no rigid motion does "
            "that. "
            "Does the tool that returned it lack the determinant rule, or is the target mirrored?"
        )
    scale = math.sqrt(stretch[0]) * math.sqrt(stretch[-1])  # what is left of R^T R: their ratio - 1
    alike = stretch[-1] > 0 and stretch[0] / stretch[-1] - 1 <= tolerance
    if alike and abs(scale - 1.0) > tolerance:  # else it may be no more than what digits make
        return (
            f"The matrix scales by {scale:.6g}{' and reflects' * reflected}: it is "
            "not a rotation. Divide the scale out if a similarity was meant, and try again."
        )
    return _why_not_orthogonal(defect, stretch)


def _why_not_orthogonal(defect: float, stretch: NDArray[np.floating[Any]]) -> str:
    if stretch[0] == 0.0:
        return "The matrix is not orthogonal: every entry of it is 0. It is not a rotation."
    remedy = "Give more digits, or the quaternion."
    if not defect <= ROUNDED_DEFECT:
        remedy = (
            "Rounding to two decimals does not do that: is it another matrix, or are rows missing?"
        )
    return (
        f"The matrix is not orthogonal (R^T R is off by {defect:.2g}, singular values "
        f"{stretch[0]:.6g} to {stretch[-1]:.6g}): it is not a rotation. {remedy}"
    )


LAST_ROW = [0.0, 0.0, 0.0, 1.0]
REAL = "fiu"  # kinds of NumPy types


def doubles_of(values: Any, name: str) -> NDArray[np.float64]:
    """Real numbers as doubles; not copied if they are. Raises InvalidProblemError for others."""
    try:
        array = np.asarray(values)
        if array.dtype.kind == "O":  # fractions, decimals: whatever has a float
            array = array.astype(np.float64)
    except (TypeError, ValueError, RuntimeError, OverflowError) as error:
        raise InvalidProblemError(
            f"{name} is not an array of real numbers: {shown(error)}", array=name
        ) from error
    if array.dtype.kind not in REAL:
        raise InvalidProblemError(
            f"{name} has entries of type {array.dtype}: give real numbers",
            array=name,
            value=array.dtype,
        )
    return array.astype(np.float64, copy=False)


def split_matrix(
    matrix: NDArray[np.float64], name: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """R (3, 3), unchecked, and t (3,) of a pose matrix (4, 4) or (3, 4); name: in errors."""
    if matrix.shape not in {(4, 4), (3, 4)}:
        stack = matrix.ndim == 3 and matrix.shape[1:] in {(4, 4), (3, 4), (3, 3)}
        remedy = f"a stack of {len(matrix)}: give one of them" if stack else "give [R | t]"
        raise InvalidProblemError(
            f"{name} must be (4, 4) or (3, 4), found shape {matrix.shape}: {remedy}",
            array=name,
            value=matrix.shape,
            limit=(4, 4),
        )
    if not np.isfinite(matrix).all():
        row = int(np.argmin(np.isfinite(matrix).all(axis=1)))
        values = " ".join(map(repr, matrix[row].tolist()))
        raise InvalidProblemError(
            f"{name}, row {row} (counting from 0) is {values}: all must be finite numbers",
            array=name,
            row=row,
            value=matrix[row].tolist(),
        )
    if len(matrix) == 4 and matrix[3].tolist() != LAST_ROW:
        raise InvalidProblemError(
            f"{name}: {last_row_fault(matrix)}", array=name, row=3, value=matrix[3].tolist()
        )
    return matrix[:3, :3].copy(), matrix[:3, 3].copy()


def last_row_fault(matrix: NDArray[np.float64]) -> str:
    """What is wrong with a matrix (4, 4) whose last row is not 0 0 0 1, and the remedy."""
    row = " ".join(f"{entry:.6g}" for entry in matrix[3].tolist())
    transposed = matrix[:, 3].tolist() == LAST_ROW
    remedy = "transpose it" if transposed else "give the 3x4 matrix [R | t], or mend that row"
    return f"the last row of the pose matrix must be 0 0 0 1, found {row}: {remedy}"
