"""The rotation problem, maximise tr(R^T C), as two quadratic programs: plain data.

Both ask for a vector v that maximises v^T F v subject to v^T N v = 1 and v^T A v = 0 for every A of
a list. In the quaternion form v = q (4,) and the list is empty. In the rotation form v is
r = (1, vec R) (10,), R by columns, and the list says everything of degree two that holds on
rotations, more than is needed to define them: redundant there, the quadratics make the relaxation
tighter. Source: [Briales2017], redundant rotation constraints.

All constants are integers; the objective is of the type of C. So that no halves are needed, the
quadratics and the objective of the rotation form are twice what they are named after.
"""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic

from certreg.geometry.constraints import (
    ROTATION_SIZE,
    SquareMatrix,
    homogeneous,
    rotation_quadratics,
    symmetric,
)
from certreg.geometry.so3 import T, davenport_matrix

QUATERNION_SIZE = 4


class RelaxationForm(enum.StrEnum):
    """How the rotation is written; the value is the word used in files."""

    QUATERNION = "quaternion-4"
    ROTATION = "rotation-10"


@dataclass(frozen=True, slots=True, kw_only=True)
class QuadraticProgram(Generic[T]):
    """Maximise v^T F v subject to v^T N v = 1 and v^T A v = 0 for every A of `quadratics`.

    objective: F, symmetric, with v^T F v = multiple * tr(R^T C) at the v of a rotation R.
    normalisation: N. quadratics: the A, symmetric.
    """

    size: int
    objective: SquareMatrix[T]
    multiple: int
    normalisation: SquareMatrix[int]
    quadratics: tuple[SquareMatrix[int], ...]


def quadratic_program(form: RelaxationForm, C: Sequence[Sequence[T]]) -> QuadraticProgram[T]:
    """The program of a form for a 3x3 matrix C."""
    return quaternion_program(C) if form is RelaxationForm.QUATERNION else rotation_program(C)


def quaternion_program(C: Sequence[Sequence[T]]) -> QuadraticProgram[T]:
    """Maximise q^T K(C) q subject to q^T q = 1."""
    return QuadraticProgram(
        size=QUATERNION_SIZE,
        objective=davenport_matrix(C),
        multiple=1,
        normalisation=tuple(
            tuple(int(i == j) for j in range(QUATERNION_SIZE)) for i in range(QUATERNION_SIZE)
        ),
        quadratics=(),
    )


def rotation_program(C: Sequence[Sequence[T]]) -> QuadraticProgram[T]:
    """Maximise r^T F r = 2 tr(R^T C) subject to r_0^2 = 1 and the 21 quadratics of a rotation.

    -F is the matrix Q of the energy: V_p = spread + r^T Q r at the best translation.
    """
    border: tuple[Any, ...] = homogeneous(C, unit=0)
    inner: list[tuple[Any, ...]] = [(entry, *[0] * (ROTATION_SIZE - 1)) for entry in border[1:]]
    return QuadraticProgram(
        size=ROTATION_SIZE,
        objective=(border, *inner),
        multiple=2,
        normalisation=symmetric({(0, 0): 1}, multiple=1),
        quadratics=rotation_quadratics(),
    )
