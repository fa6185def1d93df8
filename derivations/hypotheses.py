r"""What vanishes by hypothesis: R is a rotation, q has norm one, points are taken about their mean.

The claims name these as generators of `combination` or relations of `modulo`, so that wherever a
hypothesis is used its cofactor is multiplied out.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy

from .algebra import Relation
from .moments import MomentCloud, PointCloud
from .notation import Array, Matrix

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


def unit(q: Any) -> Relation:
    """|q| = 1 as q_w^2 = 1 - q_x^2 - q_y^2 - q_z^2."""
    w, *rest = q
    return Relation(w, 2, 1 - sum(entry**2 for entry in rest))


def inverted(formula: Any, inverses: Mapping[Any, sympy.Symbol]) -> Any:
    """A formula with a symbol u in the place of each quotient 1/n; u n - 1 vanishes.

    inverses: n -> u. A quotient that is not named stays, and no check takes it.
    """
    quotients = {n**-power: u**power for n, u in inverses.items() for power in (1, 2)}
    return formula.xreplace(quotients)


def centring(points: PointCloud) -> Array:
    """Sum m x over sum m y (6): both vanish where the points are taken about their means."""
    return Matrix.vstack(points.total(points.sources), points.total(points.targets))


def moments(points: PointCloud) -> MomentCloud:
    """The moments of points that are written out, as sums over them."""
    return MomentCloud(
        mass=points.mass,
        source_scatter=points.total([x * x.T for x in points.sources]),
        target_scatter=points.total([y * y.T for y in points.targets]),
        cross=points.total([y * x.T for x, y in zip(points.sources, points.targets, strict=True)]),
    )
