"""What is left of an energy with the best translation: an objective, a function of the rotation.

The energy of the springs is a `Form`: quadratic in the translation, so that the best translation
can be had exactly. What is left is quadratic in the nine entries of R, so a quartic in the
quaternion, of a fixed size whatever the number of points is.

`Isotropic` is the case of one weight per correspondence, where the quartic is |q|^2 times a
quadratic form and equilibria are eigenvectors. `Springs` have a matrix per correspondence: the ten
by ten form stays, and the eigenvectors go. Each is a class of its own, made from its own moments.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, ClassVar

from certreg._loading import cached_property
from certreg.objective import quartics
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from certreg.geometry.constraints import SquareMatrix
    from certreg.geometry.so3 import Matrix4, T, Vector4
    from certreg.objective.structure import Structure


class Objective(Brief):
    """The energy V after the best translation, as a function of the rotation: integers times unit.

    With F(q) = `value(q)`, homogeneous of degree four, V(R(q)) = unit * F(q) / |q|^4. Value,
    gradient and hessian use + - * alone: they run over integers, fractions, balls, floats, SymPy
    and CasADi expressions.
    """

    structure: ClassVar[Structure]

    @property
    @abstractmethod
    def unit(self) -> Fraction:
        """What 1 is worth, in units of the energy."""

    @abstractmethod
    def form(self) -> SquareMatrix[int]:
        """Q, 10x10, with V(R) = unit * r^T Q r for r = (1, vec R), R by columns."""

    @cached_property
    def quartic(self) -> tuple[int, ...]:
        """The 35 coefficients of F, in the order of `quartics.MONOMIALS`."""
        return quartics.quartic_of_form(self.form())

    def value(self, q: Sequence[T]) -> T:
        """F(q)."""
        return quartics.value(self.quartic, q)

    def gradient(self, q: Sequence[T]) -> Vector4[T]:
        """The four first derivatives of F."""
        return quartics.gradient(self.quartic, q)

    def hessian(self, q: Sequence[T]) -> Matrix4[T]:
        """The second derivatives of F."""
        return quartics.hessian(self.quartic, q)
