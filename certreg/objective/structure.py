"""The structure of an objective: what its searches and its proofs rest on."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from certreg.problem.support import Cell


class Structure(enum.StrEnum):
    """What kind of function of the rotation is minimised.

    It follows from the declared terms and motion, never from coefficients: springs whose matrices
    happen to be equal are quartic all the same.
    """

    LINEAR = "linear"  # |q|^2 times a quadratic form: its critical lines are eigenspaces
    QUARTIC = "quartic"  # any quartic in the quaternion

    @classmethod
    def of(cls, cell: Cell) -> Structure:
        """That of a declared problem."""
        return cls.QUARTIC if cell.springs else cls.LINEAR
