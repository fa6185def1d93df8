"""Arrays from outside as the numbers of a pose: shapes, finite values, the last row of a 4x4."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.verify import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

LAST_ROW = [0.0, 0.0, 0.0, 1.0]
REAL = "fiu"  # kinds of NumPy types


def doubles_of(values: Any, name: str) -> NDArray[np.float64]:
    """Real numbers as doubles; not copied if they are. Raises InvalidProblemError for others."""
    try:
        array = np.asarray(values)
        if array.dtype.kind == "O":  # fractions, decimals: whatever has a float
            array = array.astype(np.float64)
    except (TypeError, ValueError, RuntimeError, OverflowError) as error:
        message = f"{name} is not an array of real numbers: {shown(error)}"
        raise InvalidProblemError(message, array=name) from error
    if array.dtype.kind not in REAL:
        message = f"{name} has entries of type {array.dtype}: give real numbers"
        raise InvalidProblemError(message, array=name, value=array.dtype)
    return array.astype(np.float64, copy=False)


def split_matrix(
    matrix: NDArray[np.float64], name: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """R (3, 3), unchecked, and t (3,) of a pose matrix (4, 4) or (3, 4); name: in errors."""
    if matrix.shape not in {(4, 4), (3, 4)}:
        stack = matrix.ndim == 3 and matrix.shape[1:] in {(4, 4), (3, 4), (3, 3)}
        remedy = f"a stack of {len(matrix)}: give one of them" if stack else "give [R | t]"
        message = f"{name} must be (4, 4) or (3, 4), found shape {matrix.shape}: {remedy}"
        raise InvalidProblemError(message, array=name, value=matrix.shape, limit=(4, 4))
    if not np.isfinite(matrix).all():
        row = int(np.argmin(np.isfinite(matrix).all(axis=1)))
        values = " ".join(map(repr, matrix[row].tolist()))
        message = f"{name}, row {row} (counting from 0) is {values}: all must be finite numbers"
        raise InvalidProblemError(message, array=name, row=row, value=matrix[row].tolist())
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
