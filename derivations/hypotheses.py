r"""Hypotheses that several claims make: R is a rotation, |q| = 1, J > 0, points about their mean.

And the matrices that they are made of.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import sympy

from certreg.geometry.so3 import rotation_matrix

from .hypothesis import (
    Hypothesis,
    Point,
    Standing,
    equation,
    invertible,
    nonnegative_by,
    positive_by,
    vanishing,
)
from .moments import MomentCloud, PointCloud, inertia_of
from .notation import Array, Matrix, diagonal, matrix, quaternion, rotation, scalar, symmetric

IDENTITY = sympy.eye(3)
SPECTRAL = (
    "The spectral theorem: a real symmetric matrix has an orthonormal basis of eigenvectors, and "
    "over unit vectors its quadratic form is largest exactly at those of the largest eigenvalue."
)


def orthogonality(R: Any) -> Array:
    """R^T R - I, which vanishes where R is a rotation."""
    return R.T * R - IDENTITY


def cofactor_matrix(A: Any) -> Array:
    """The cofactors of a 3x3 matrix as polynomials: A^T cof(A) = det(A) I."""
    return Matrix(3, 3, lambda i, j: A.cofactor(i, j, method="berkowitz"))


def inverted(formula: Any, inverses: Mapping[Any, sympy.Symbol]) -> Any:
    """A formula with a symbol u in the place of each quotient 1/n; u n - 1 vanishes.

    inverses: n -> u. A quotient that is not named stays, and no check takes it.
    """
    quotients = {n**-power: u**power for n, u in inverses.items() for power in (1, 2)}
    return formula.xreplace(quotients)


def moments(points: PointCloud) -> MomentCloud:
    """The moments of points that are written out, as sums over them."""
    return MomentCloud(
        mass=points.mass,
        source_scatter=points.total([x * x.T for x in points.sources]),
        target_scatter=points.total([y * y.T for y in points.targets]),
        cross=points.total([y * x.T for x, y in zip(points.sources, points.targets, strict=True)]),
    )


def rotation_of(name: str, standing: Standing = Standing.ASSUMED) -> Hypothesis:
    """The matrix of that name is a rotation."""
    R = matrix(name)

    def turned(point: Point) -> Mapping[sympy.Symbol, Fraction]:
        q = [point[R[0, 0]], point[R[0, 1]], point[R[0, 2]], point[R[1, 0]]]
        q = q if any(q) else [Fraction(1), *q[1:]]
        norm = sum((entry * entry for entry in q), start=Fraction(0))
        entries = [entry / norm for row in rotation_matrix(tuple(q)) for entry in row]
        return dict(zip(R, entries, strict=True))

    return vanishing(
        rf"${name}$ is a rotation, ${name}^{{\mathsf T}}{name} = I$.",
        orthogonality(R),
        standing=standing,
        prepare=turned,
    )


def unit_of(name: str, standing: Standing = Standing.ASSUMED) -> Hypothesis:
    """The quaternion of that name has norm one: q_w^2 = 1 - q_x^2 - q_y^2 - q_z^2."""
    w, *rest = quaternion(name)

    def projected(point: Point) -> Mapping[sympy.Symbol, Fraction]:
        size = sum((point[s] ** 2 for s in rest), start=Fraction(0))
        parts = {s: 2 * point[s] / (1 + size) for s in rest}
        return parts | {w: (1 - size) / (1 + size)}

    value = 1 - sum(entry**2 for entry in rest)
    return equation(rf"$|{name}| = 1$.", w, 2, value, standing=standing, prepare=projected)


def about_mean(n: int, side: str) -> Hypothesis:
    """N points written out, of one side, x or y, are taken about their mean."""
    cloud = PointCloud.of_size(n)
    points = cloud.sources if side == "x" else cloud.targets
    return vanishing(
        rf"The points ${side}$ are taken about their mean: $\sum m\,{side} = 0$.",
        cloud.total(points),
        solves=tuple(points[-1]),
    )


def eigenpair(K: Array, vector_name: str, value_name: str) -> Hypothesis:
    """K q = v q, with these names for q and v."""
    q, v = quaternion(vector_name), scalar(value_name)
    return vanishing(
        rf"$K {vector_name} = {value_name} {vector_name}$: it is an eigenvector.",
        K * q - v * q,
        standing=Standing.CASE,
        solves=tuple(sorted(K.free_symbols, key=str)),
    )


AT_Q = eigenpair(symmetric("K", 4), "q", "v")
AT_P = eigenpair(symmetric("K", 4), "p", "u")
DIFFERENT = invertible(
    r"The eigenvalues are different, $u \ne v$.",
    scalar("u") - scalar("v"),
    scalar("gap_inverse"),
    standing=Standing.CASE,
)


def _on_the_circle(point: Point) -> Mapping[sympy.Symbol, Fraction]:
    c, s = scalar("c"), scalar("s")
    return {c: (1 - point[s] ** 2) / (1 + point[s] ** 2), s: 2 * point[s] / (1 + point[s] ** 2)}


CIRCLE = equation(
    r"$c^2 + s^2 = 1$: cosine and sine of an angle.",
    scalar("c"),
    2,
    1 - scalar("s") ** 2,
    prepare=_on_the_circle,
)
ROTATION = rotation_of("R")
WHERE_ROTATION = rotation_of("R", Standing.CASE)
UNIT = unit_of("q")
CENTRED = {(n, side): about_mean(n, side) for n in (3, 4) for side in "xy"}
SOURCES_CENTRED = (CENTRED[3, "x"], CENTRED[4, "x"])
BOTH_CENTRED = tuple(CENTRED.values())

DAMPED = positive_by(r"$\mu > 0$.", scalar("mu"))
UNDRIVEN = nonnegative_by(r"$\mu \ge 0$.", scalar("mu"))
STEPPED = positive_by("$h > 0$.", scalar("h"))
MASSIVE = positive_by("The mass $M$ is positive.", scalar("M"))
SOLID = r"$J \succ 0$: three of the points are not collinear."
INERTIA_INVERSE = invertible(SOLID, symmetric("J"), symmetric("I"))


def _spread(point: Point) -> Mapping[sympy.Symbol, Fraction]:
    return {s: abs(point[s]) + 1 for s in diagonal("d").diagonal()}


_PRINCIPAL = inertia_of(diagonal("d"))
PRINCIPAL = positive_by(SOLID, [_PRINCIPAL[k, k] for k in range(3)], prepare=_spread)


def masses_of(n: int) -> Hypothesis:
    """The masses of n points written out are positive."""
    return positive_by("Masses are positive.", list(PointCloud.of_size(n).masses))


MASSES = {n: masses_of(n) for n in (3, 4)}
WEIGHTS = {
    n: nonnegative_by("Masses are not negative.", list(PointCloud.of_size(n).masses))
    for n in (3, 4)
}


def matched() -> Hypothesis:
    """R is R(q): |q|^2 R and the matrix of quadratic entries are the same."""
    R, q = matrix("R"), quaternion()

    def made(point: Point) -> Mapping[sympy.Symbol, Fraction]:
        values = [point[entry] for entry in q]
        values = values if any(values) else [Fraction(1), *values[1:]]
        norm = sum((entry * entry for entry in values), start=Fraction(0))
        turned = [entry / norm for row in rotation_matrix(tuple(values)) for entry in row]
        return dict(zip([*q, *R], [*values, *turned], strict=True))

    difference = sum(entry**2 for entry in q) * R - rotation(q)
    return vanishing("$R = R(q)$.", difference, standing=Standing.CASE, prepare=made)


def balanced(standing: Standing = Standing.CASE) -> Hypothesis:
    """R^T C is symmetric, as it is at an equilibrium."""
    R, C = matrix("R"), matrix("C")
    return vanishing(
        r"At an equilibrium: $R^{\mathsf T} C$ is symmetric.",
        R.T * C - C.T * R,
        standing=standing,
        solves=tuple(C),
    )


def definite(matrix_of_symbols: Array, point: Point) -> bool:
    """Whether a symmetric matrix of polynomials is positive definite at a point: its minors."""
    at = {symbol: sympy.Rational(str(value)) for symbol, value in point.items()}
    values = Matrix(matrix_of_symbols).xreplace(at)
    return all(values[:k, :k].det() > 0 for k in range(1, values.rows + 1))


def semidefinite(matrix_of_symbols: Array, point: Point) -> bool:
    """Whether a symmetric matrix of polynomials is positive semidefinite at a point.

    Exactly if every coefficient of det(x I + A) is nonnegative.
    """
    at = {symbol: sympy.Rational(str(value)) for symbol, value in point.items()}
    values = Matrix(matrix_of_symbols).xreplace(at)
    signed = (-values).charpoly().all_coeffs()  # det(x I + A)
    return all(coefficient >= 0 for coefficient in signed)
