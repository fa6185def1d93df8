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
from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from typing import TYPE_CHECKING, Any, Generic

from certreg.geometry import T, davenport_matrix

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

SquareMatrix = tuple[tuple[T, ...], ...]
Monomials = dict[tuple[int, int], int]  # (i, j): the coefficient of r_i r_j

QUATERNION_SIZE, ROTATION_SIZE = 4, 10
CYCLES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


class Form(enum.StrEnum):
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


def quadratic_program(form: Form, C: Sequence[Sequence[T]]) -> QuadraticProgram[T]:
    """The program of a form for a 3x3 matrix C."""
    return quaternion_program(C) if form is Form.QUATERNION else rotation_program(C)


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
        normalisation=_symmetric({(0, 0): 1}, multiple=1),
        quadratics=rotation_quadratics(),
    )


def homogeneous(R: Sequence[Sequence[T]], unit: Any = 1) -> tuple[T, ...]:
    """The vector r = (unit, vec R), R by columns; unit = |q|^2 goes with the multiple |q|^2 R(q).

    >>> homogeneous(((1, 2, 3), (4, 5, 6), (7, 8, 9)))
    (1, 1, 4, 7, 2, 5, 8, 3, 6, 9)
    """
    return (unit, *(R[i][j] for j, i in product(range(3), repeat=2)))


def rotation_quadratics() -> tuple[SquareMatrix[int], ...]:
    """The 21 matrices A with r^T A r = 0 for the r of every rotation; they span 20 dimensions.

    6 of R^T R = I, 6 of R R^T = I, 9 of handedness. The one dependence: the diagonals of the first
    two have the same sum, |R|^2 = 3.
    """
    polynomials = (*_orthonormal_columns(), *_orthonormal_rows(), *_handedness())
    return tuple(_symmetric(polynomial) for polynomial in polynomials)


def _orthonormal_columns() -> Iterator[Monomials]:
    """The entries of R^T R - I on and above the diagonal."""
    for a, b in combinations_with_replacement(range(3), 2):
        yield {(0, 0): -int(a == b)} | {(_place(k, a), _place(k, b)): 1 for k in range(3)}


def _orthonormal_rows() -> Iterator[Monomials]:
    """The entries of R R^T - I on and above the diagonal."""
    for a, b in combinations_with_replacement(range(3), 2):
        yield {(0, 0): -int(a == b)} | {(_place(a, k), _place(b, k)): 1 for k in range(3)}


def _handedness() -> Iterator[Monomials]:
    """The entries of a x b - c for the columns a, b, c in each cyclic order."""
    for (a, b, c), (i, j, k) in product(CYCLES, repeat=2):
        yield {
            (_place(j, a), _place(k, b)): 1,
            (_place(k, a), _place(j, b)): -1,
            (0, _place(i, c)): -1,
        }


def _place(row: int, column: int) -> int:
    """Where R[row][column] stands in r."""
    return 1 + 3 * column + row


def _symmetric(polynomial: Monomials, multiple: int = 2) -> SquareMatrix[int]:
    """The symmetric matrix A with r^T A r = multiple * polynomial(r)."""
    matrix = [[0] * ROTATION_SIZE for _ in range(ROTATION_SIZE)]
    for (i, j), coefficient in polynomial.items():
        if i == j:
            matrix[i][i] += multiple * coefficient
        else:
            matrix[i][j] += multiple * coefficient // 2
            matrix[j][i] += multiple * coefficient // 2
    return tuple(tuple(row) for row in matrix)
