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
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, ClassVar, Literal

from certreg._loading import cached_property
from certreg.exact.dyadic import nearest_or_zero
from certreg.geometry.so3 import Matrix4, T, Vector3, Vector4, rotation_matrix, squared_norm
from certreg.objective import quartics
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.geometry.constraints import SquareMatrix
    from certreg.objective.form import Reduced
    from certreg.objective.structure import Structure


class Objective(Brief):
    """The energy V after the best translation, as a function of the rotation: integers times unit.

    With F(q) = `value(q)`, homogeneous of degree four, V(R(q)) = unit * F(q) / |q|^4. Value,
    gradient and hessian use + - * alone: they run over integers, fractions, balls, floats, SymPy
    and CasADi expressions.
    """

    structure: ClassVar[Structure]

    @cached_property
    @abstractmethod
    def reduced(self) -> Reduced:
        """The energy at any scale with the best translation."""

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

    def best_scale(self, q: Sequence[int]) -> Fraction:
        """The scale that is best at fixed rotation; 1 where it is not free."""
        del q
        return Fraction(1)

    def best_translation(
        self, q: Sequence[int], scale: Fraction | Literal[1] | None = None
    ) -> Vector3[Fraction]:
        """The translation of least energy at the rotation R(q) and a scale, exactly.

        scale: None for the best one. One of them where some shift costs nothing.
        """
        stretch = self.best_scale(q) if scale is None else scale
        return self.reduced.best_translation(*_placed(q, stretch))

    def rounded_translation(
        self, q: Sequence[int], scale: Fraction | Literal[1] = 1
    ) -> list[float]:
        """The same, each entry rounded once, and infinite beyond the doubles."""
        return [nearest_or_zero(entry) for entry in self.best_translation(q, scale)]

    def translation_energy(
        self, q: Sequence[int], translation: Sequence[Fraction], scale: Fraction | Literal[1] = 1
    ) -> Fraction:
        """What a translation adds to the energy at a scale: d^T S d, d from the best one."""
        return self.reduced.translation_energy(translation, *_placed(q, scale))


def _placed(q: Sequence[int], scale: Fraction | Literal[1]) -> tuple[tuple[int, ...], int]:
    """(1, vec s R(q)) in integers, and what they are over."""
    stretch, over = scale.numerator, squared_norm(q) * scale.denominator
    columns = zip(*rotation_matrix(q), strict=True)
    return (over, *[stretch * entry for column in columns for entry in column]), over
