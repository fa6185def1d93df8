"""The best scale and what it costs, as functions of the alignment a = tr(R^T C), exactly.

With the best translation, sum w |y - s R x - t|^2 is W(s) = Syy - 2 s a + s^2 Sxx. The asymmetric
scale minimises W over s >= 0: s = max(0, a) / Sxx, W = Syy - max(0, a)^2 / Sxx [Umeyama1991]. The
symmetric one minimises W / s over s > 0: s = sqrt(Syy / Sxx), W / s = 2 sqrt(Sxx Syy) - 2 a, where
source and target may change their roles [Horn1987]. Both fall as a rises: the best rotations are
those of scale 1. Proof: claim `scale_elimination`; at rest, `breathing_equilibria`.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf, isqrt
from typing import TYPE_CHECKING, ClassVar, TypeVar

from certreg._loading import cached_property
from certreg.errors import DegenerateProblemError
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below, power_of_two
from certreg.problem.moments import ExactMoments, trace
from certreg.problem.motion import Scale
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Mapping

    from certreg.problem.motion import Motion

Real = TypeVar("Real", Fraction, float)
ROOT_BITS = 240  # of a root: its bounds are 2^-239 apart, far within what bounds a scale below
SCALE_BITS = 96  # of the bounds of a scale: 2^-95 = 2.5e-29 of it, below 1e-20


@dataclass(frozen=True)
class Scaling(Brief):
    """The asymmetric scale. source, target: Sxx > 0 and Syy, in objective units."""

    source: Fraction
    target: Fraction
    kind: ClassVar[Scale] = Scale.ASYMMETRIC
    telling: ClassVar[tuple[str, ...]] = ("source",)  # clouds whose points are not all at one
    symmetric: ClassVar[bool] = False
    upright: ClassVar[float] = 0.0  # the least alignment of which `gap` is true

    @staticmethod
    def of(moments: ExactMoments, motion: Motion) -> Scaling | None:
        """Of the moments of a problem; None where its scale is not free.

        Raises DegenerateProblemError where no scale is better than others.
        """
        made = SCALINGS.get(motion.scale)
        if made is None:
            return None
        place = "at one point" if motion.translations else "at the origin"
        weights = moments.weight_exponent
        source, target = (
            Fraction(trace(scatter), moments.mass) * power_of_two(weights + 2 * exponent)
            for scatter, exponent in (
                (moments.source_scatter, moments.source_exponent),
                (moments.target_scatter, moments.target_exponent),
            )
        )
        for name, spread in (("source", source), ("target", target)):
            if spread == 0 and name in made.telling:
                raise DegenerateProblemError(
                    f"all {name} points with weight lie {place}: they tell no {made.kind} scale; "
                    "leave the scale out",
                    rank=0,
                )
        return made(source, target)

    @property
    def slack(self) -> Fraction:
        """How far `energy` may be below the true one; 0 for the asymmetric scale."""
        return Fraction(0)

    def best(self, alignment: Fraction) -> Fraction:
        """The best scale; of a symmetric one a number just below it."""
        return max(alignment, Fraction(0)) / self.source

    def energy(self, alignment: Fraction) -> Fraction:
        """The objective with the best scale, >= 0; of a symmetric one at most `slack` less."""
        return self.target - max(alignment, Fraction(0)) ** 2 / self.source

    def energy_at(self, alignment: Fraction, scale: Fraction, shifted: Fraction) -> Fraction:
        """The objective at any scale; shifted: M |t - best t|^2, the cost of the translation."""
        squares = self.target - 2 * scale * alignment + scale**2 * self.source + shifted
        return squares / self.divisor(scale)

    def divisor(self, scale: Real) -> Real | int:  # noqa: ARG002 - the symmetric one is
        """What the squares at a scale are over."""
        return 1

    def lost(self, alignment: Fraction, best: Fraction) -> Fraction:
        """What a rotation costs more than another, exactly."""
        return self.energy(alignment) - self.energy(best)

    def least_range(self, alignment: Fraction, squares: Fraction) -> Fraction:
        """The square of a number that the range of energies over all rotations is not below.

        squares: F^2 of Davenport's matrix K, of trace 0; alignment: of some rotation, at most l1.
        Asymmetric: the range is l1^2 / Sxx, as some rotation has a <= 0, and l1^2 >= F^2 / 12, the
        least being at eigenvalues (l, l, l, -3 l). Symmetric: 2 (l1 - l4) >= 2 F.
        """
        return (max(max(alignment, Fraction(0)) ** 2, squares / 12) / self.source) ** 2

    def gap(self, alignment: Fraction, delta: Fraction) -> Fraction:
        """What the objective at a rotation exceeds the minimum by, at most, if l1 < a + delta.

        (l1^2 - a^2) / Sxx < delta (2 a + delta) / Sxx, which is true of a >= 0 alone; or 2 delta.
        """
        return delta * (2 * alignment + delta) / self.source

    def interval(self, alignment: Fraction, delta: Fraction) -> tuple[Dyadic, Dyadic]:
        """Bounds of the best scale at the optimum, of few bits, if a <= l1 < a + delta."""
        low, high = self._bounds(alignment, delta)
        return dyadic_below(low, SCALE_BITS), dyadic_above(high, SCALE_BITS)

    def _bounds(self, alignment: Fraction, delta: Fraction) -> tuple[Fraction, Fraction]:
        return alignment / self.source, (alignment + delta) / self.source


@dataclass(frozen=True)
class SymmetricScaling(Scaling):
    """The symmetric scale, whatever the rotation. source, target: Sxx, Syy > 0."""

    kind: ClassVar[Scale] = Scale.SYMMETRIC
    telling: ClassVar[tuple[str, ...]] = ("source", "target")
    symmetric: ClassVar[bool] = True
    upright: ClassVar[float] = -inf

    @cached_property
    def _ratio(self) -> tuple[Fraction, Fraction]:
        """Bounds of sqrt(Syy / Sxx)."""
        return root_bounds(self.target / self.source)

    @cached_property
    def _mean(self) -> tuple[Fraction, Fraction]:
        """Bounds of sqrt(Sxx Syy)."""
        return root_bounds(self.target * self.source)

    @property
    def slack(self) -> Fraction:
        """How far `energy` may be below the true one."""
        return 2 * (self._mean[1] - self._mean[0])

    def best(self, alignment: Fraction) -> Fraction:  # noqa: ARG002
        """A number just below the best scale."""
        return self._ratio[0]

    def energy(self, alignment: Fraction) -> Fraction:
        """The objective, >= 0, at most `slack` less."""
        return 2 * max(self._mean[0] - alignment, Fraction(0))

    def divisor(self, scale: Real) -> Real | int:
        """The scale."""
        return scale

    def lost(self, alignment: Fraction, best: Fraction) -> Fraction:
        """What a rotation costs more than another, exactly."""
        return 2 * (best - alignment)

    def least_range(self, alignment: Fraction, squares: Fraction) -> Fraction:  # noqa: ARG002
        """The square of 2 F."""
        return 4 * squares

    def gap(self, alignment: Fraction, delta: Fraction) -> Fraction:  # noqa: ARG002
        """2 delta."""
        return 2 * delta

    def _bounds(self, alignment: Fraction, delta: Fraction) -> tuple[Fraction, Fraction]:  # noqa: ARG002
        return self._ratio


SCALINGS: Mapping[Scale, type[Scaling]] = {made.kind: made for made in (Scaling, SymmetricScaling)}


def root_bounds(value: Fraction) -> tuple[Fraction, Fraction]:
    """Numbers at most 2^-(ROOT_BITS - 1) of themselves apart, with the root of value between."""
    n, d = value.numerator, value.denominator
    places = ROOT_BITS - (n.bit_length() - d.bit_length()) // 2
    floor = (n << 2 * places) // d if places >= 0 else n // (d << -2 * places)
    low = isqrt(floor)
    return low * power_of_two(-places), (low + 1) * power_of_two(-places)
