"""The equilibria of the breathing body, whose size s is a state: an eigenline each.

At scale s and rotation R(q) the energy is Syy + s^2 Sxx - 2 s q^T K q, at the best translation. So
the equilibria with s != 0 are the eigenlines of K with an eigenvalue l_j other than 0, at
s_j = l_j / Sxx, with the energy Syy - l_j^2 / Sxx. Where l_j > 0 the index is that of the rigid
body, the number of eigenvalues above. Where l_j < 0 the body is inside out (s < 0) and the index is
the number of eigenvalues below. How many there are follows from the signs of the coefficients of
the characteristic polynomial of K, in integers. Proofs: derivations, breathing_equilibria,
descartes.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.errors import DegenerateProblemError
from certreg.exact.dyadic import nearest_double, power_of_two
from certreg.exact.signs import RootSigns, signs_of_eigenvalues
from certreg.problem.moments import trace
from certreg.results import OUT_OF_RANGE, Absent, Brief, ComponentKind, Explained

if TYPE_CHECKING:
    from certreg.objective.isotropic import Isotropic

LOST_SCALE = Absent("the scale is so near 0 that no digits of it are known; its sign is exact")


@dataclass(frozen=True, slots=True, kw_only=True)
class BreathingEquilibrium(Explained):
    """A connected set of rest states of the breathing body.

    component: the place of its eigenspace among those of K, largest eigenvalue first.
    scale: s_j, rounded once; its sign is exact. None where no double holds it.
    morse_index: number of independent directions in which the energy falls; of the 14 eigenvalues
    of the linearised motion as many have a positive real part, where J is not singular.
    energy: V_p at rest; None where no double holds it.
    """

    component: int
    kind: ComponentKind
    scale: float | None
    morse_index: int
    energy: float | None

    @property
    def stable(self) -> bool:
        """Whether the energy falls in no direction."""
        return self.morse_index == 0


@dataclass(frozen=True, slots=True, kw_only=True)
class BreathingEquilibria(Brief):
    """All equilibria of the breathing body with s != 0.

    signs: of the eigenvalues of K, proved. upright: those with s > 0, largest scale first;
    inside_out: those with s < 0, smallest first. Where `zero` of `signs` is not 0, the energy is
    also stationary at s = 0, where the motion is not defined: no equilibrium.
    """

    signs: RootSigns
    upright: tuple[BreathingEquilibrium, ...]
    inside_out: tuple[BreathingEquilibrium, ...]
    finite: bool

    @property
    def count(self) -> int | None:
        """The number with s > 0; None means infinitely many."""
        return self.signs.positive if self.finite else None


def source_size(objective: Isotropic) -> Fraction:
    """Sxx = sum w |x - mean|^2, exact. Raises DegenerateProblemError where it is 0."""
    moments = objective.moments
    exponent = moments.weight_exponent + 2 * moments.source_exponent
    size = Fraction(trace(moments.source_scatter), moments.mass) * power_of_two(exponent)
    if not size:
        raise DegenerateProblemError(
            "the source points coincide: no scale fits them better than another", rank=0
        )
    return size


def breathing_equilibria(objective: Isotropic) -> BreathingEquilibria:
    """All equilibria of the breathing body; raises as `source_size`."""
    size, kind = source_size(objective), objective.classification
    own = objective.moments.spread - size  # Syy
    signs = signs_of_eigenvalues(objective.davenport)
    upright, inside_out = list[BreathingEquilibrium](), list[BreathingEquilibrium]()
    for place, (above, many) in enumerate(zip(kind.indices, kind.pattern, strict=True)):
        value = objective.eigenvalues[above]
        sign = 1 if above < signs.positive else -1
        found = BreathingEquilibrium(
            component=place,
            kind=kind.kinds[place],
            scale=nearest_double(value / size) if value * sign > 0 else None,
            morse_index=above if above < signs.positive else 4 - above - many,
            energy=nearest_double(own - value**2 / size),
            absent={
                "scale": OUT_OF_RANGE if value * sign > 0 else LOST_SCALE,
                "energy": OUT_OF_RANGE,
            },
        )
        if above < signs.positive:
            upright.append(found)
        elif above >= signs.positive + signs.zero:
            inside_out.append(found)
    return BreathingEquilibria(
        signs=signs,
        upright=tuple(upright),
        inside_out=tuple(reversed(inside_out)),
        finite=all(each.kind.dimension == 0 for each in upright),
    )
