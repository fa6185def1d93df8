"""Lengths of rows at the ends of the doubles, where squares overflow or vanish."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]


def lengths(rows: Reals) -> Reals:
    """(N,) of (N, k): infinite only where a length is beyond the doubles.

    Each row is divided by a power of two first, which changes no bit of its length.
    """
    exponents = np.frexp(np.abs(rows).max(axis=1))[1]
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        return np.ldexp(
            np.linalg.norm(np.ldexp(rows, -exponents[:, np.newaxis]), axis=1), exponents
        )


def apart(rows: Reals, others: Reals) -> Reals:
    """(N,), how far each row is from the other; infinite only beyond the doubles."""
    with np.errstate(over="ignore"):
        return lengths(others - rows)


def diameter(points: Reals) -> float:
    """The diagonal of the box around points, at least their diameter; infinite as above."""
    return float(apart(points.min(axis=0)[np.newaxis], points.max(axis=0)[np.newaxis])[0])
