"""What everything below the moments may know of them: an objective, a function of the rotation.

The energy of the springs is a `Form`: quadratic in the translation, so that the best translation
can be had exactly. What is left is quadratic in the nine entries of R, so a quartic in the
quaternion, of a fixed size whatever the number of points is.

`Isotropic` is the case of one weight per correspondence, where the quartic is |q|^2 times a
quadratic form and equilibria are eigenvectors. Spring matrices per correspondence keep the ten
by ten form of this protocol and lose the eigenvectors; further labels of wrong pairs change the
sums alone; a free scale adds an unknown beside the translation. Each is another class here, made
from its own moments, and a body of certificates; trackers, proofs of roots and the relaxation ask
for no more than this protocol.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Protocol

from certreg._loading import found_late
from certreg.objective.structure import Structure

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

    from certreg.geometry.constraints import SquareMatrix
    from certreg.geometry.so3 import Matrix4, T, Vector3, Vector4
    from certreg.objective.form import Form, Reduced
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem


class Objective(Protocol):
    """The energy V after the best translation, as a function of the rotation: integers times unit.

    With F(q) = `value(q)`, homogeneous of degree four, V(R(q)) = unit * F(q) / |q|^4. Value,
    gradient and hessian use + - * alone: they run over integers, fractions, balls, floats, SymPy
    and CasADi expressions.
    """

    structure: ClassVar[Structure]

    @property
    def joint_form(self) -> Form:
        """The energy before a translation is chosen, of every motion alike."""
        ...

    @property
    def reduced(self) -> Reduced:
        """The same with the best translation, of every motion alike."""
        ...

    @property
    def unit(self) -> Fraction:
        """What 1 is worth, in units of the energy."""
        ...

    @property
    def free_translations(self) -> tuple[Vector3[Fraction], ...]:
        """Directions, linearly independent, in which a shift costs nothing at any rotation."""
        ...

    def form(self) -> SquareMatrix[int]:
        """Q, 10x10, with V(R) = unit * r^T Q r for r = (1, vec R), R by columns.

        What the relaxation, and a certificate that knows nothing of eigenvectors, reads.
        """
        ...

    def value(self, q: Sequence[T]) -> T:
        """F(q)."""
        ...

    def gradient(self, q: Sequence[T]) -> Vector4[T]:
        """The four first derivatives of F."""
        ...

    def hessian(self, q: Sequence[T]) -> Matrix4[T]:
        """The second derivatives of F."""
        ...

    def best_translation(self, q: Sequence[int]) -> Vector3[Fraction]:
        """The translation of least energy at the rotation R(q), exactly.

        One of them where `free_translations` are left.
        """
        ...


OBJECTIVES: Mapping[Structure, Callable[[], type[Isotropic | Springs]]] = {
    Structure.LINEAR: found_late("certreg.objective.isotropic", "Isotropic"),
    Structure.QUARTIC: found_late("certreg.objective.springs", "Springs"),
}


def objective_of(problem: RegistrationProblem) -> Isotropic | Springs:
    """The energy of a problem as a function of the rotation, by its structure.

    Raises DegenerateProblemError where its scale is free, and the points tell none.
    """
    return OBJECTIVES[Structure.of(problem.cell)]().of(problem)
