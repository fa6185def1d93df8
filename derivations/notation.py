"""Symbols with the paper's names, and the few operations on vectors that its equations use.

Vectors are 3x1 SymPy matrices. Symbols are real; those that are positive say so where it matters.
"""

from __future__ import annotations

import re
from itertools import permutations
from math import prod
from typing import Any

import sympy
from sympy.combinatorics.permutations import Permutation

from certreg.geometry.so3 import body_frame, rotation_matrix

Array = Any  # a SymPy matrix of symbols: its own types do not pass a type checker
Matrix: Any = sympy.Matrix


_OF_AN_ENTRY = re.compile(r"_(\d+|[wxyz])$")


def scalar(name: str) -> sympy.Symbol:
    """A real symbol, which is not an entry of a vector or a matrix."""
    if _OF_AN_ENTRY.search(name):
        raise ValueError(f"{name} is the name of an entry of a vector or a matrix: see `entry`")
    return sympy.Symbol(name, real=True)


def entry(name: str, *indices: int | str) -> sympy.Symbol:
    """The real symbol of one entry of the vector or matrix of that name."""
    if len(indices) > 1 and not set(indices) <= set(range(11)):
        raise ValueError(f"{name}: an index is at most 10, or A_1,11 would be A_11,1")
    return sympy.Symbol(f"{name}_{''.join(map(str, indices))}", real=True)


def vector(name: str) -> Array:
    """A 3-vector of symbols name_1, name_2, name_3."""
    return Matrix([entry(name, k) for k in (1, 2, 3)])


def matrix(name: str, size: int = 3) -> Array:
    """A general matrix of symbols name_11, name_12, ..., 3x3 unless told."""
    return Matrix(size, size, lambda i, j: entry(name, i + 1, j + 1))


def symmetric(name: str, size: int = 3) -> Array:
    """A symmetric matrix of symbols, 3x3 unless told."""
    return Matrix(size, size, lambda i, j: entry(name, min(i, j) + 1, max(i, j) + 1))


def diagonal(name: str) -> Array:
    """A diagonal 3x3 matrix of the symbols name_1, name_2, name_3."""
    return sympy.diag(*vector(name))


def quaternion(name: str = "q") -> Array:
    """A quaternion (w, x, y, z) of symbols, 4x1."""
    return Matrix([entry(name, k) for k in "wxyz"])


def hat(a: Any) -> Array:
    """The skew-symmetric matrix that takes b to the cross product of a and b."""
    x, y, z = a
    return Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def vee(A: Any) -> Array:
    """The axial vector (A_32 - A_23, A_13 - A_31, A_21 - A_12) / 2, which is a for [a]x."""
    A = Matrix(A)
    return Matrix([A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]]) / 2


def rotation(q: Any) -> Array:
    """|q|^2 R(q), from the shipped function."""
    return Matrix(rotation_matrix(tuple(q)))


def body(q: Any) -> Array:
    """The 4x3 matrix L(q), from the shipped function."""
    return Matrix(body_frame(tuple(q)))


def left_product(a: Any) -> Array:
    """The 4x4 matrix that takes a quaternion q to the product a * q: the columns are a and L(a)."""
    return Matrix.hstack(Matrix(a), body(a))


def right_product(b: Any) -> Array:
    """The 4x4 matrix that takes a quaternion q to the product q * b."""
    w, x, y, z = b
    return Matrix([[w, -x, -y, -z], [x, w, z, -y], [y, -z, w, x], [z, y, -x, w]])


def determinant(A: Any) -> Any:
    """The determinant by Leibniz's formula: a signed sum of products, not multiplied out."""
    A = Matrix(A)
    return sum(
        (
            Permutation(list(columns)).signature() * prod(A[i, j] for i, j in enumerate(columns))
            for columns in permutations(range(A.rows))
        ),
        start=sympy.Integer(0),
    )


def square(v: Any) -> Any:
    """The sum of squares of the entries."""
    return sum((x**2 for x in v), start=sympy.Integer(0))


def inner(A: Any, B: Any) -> Any:
    """The sum of products of entries, which is the trace of A^T B."""
    return sum((a * b for a, b in zip(A, B, strict=True)), start=sympy.Integer(0))


def gradient(function: Any, variables: Any) -> Array:
    """The column of partial derivatives."""
    return Matrix([sympy.diff(function, variable) for variable in variables])


def jacobian(values: Any, variables: Any) -> Array:
    """The matrix of partial derivatives, one row for each value."""
    return Matrix(list(values)).jacobian(Matrix(list(variables)))
