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
from math import isqrt
from typing import TYPE_CHECKING

from certreg._loading import cached_property
from certreg.errors import DegenerateProblemError
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below, power_of_two
from certreg.problem.moments import ExactMoments, trace
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.problem.motion import Motion, Scale

ROOT_BITS = 240  # of a root: its bounds are 2^-239 apart, far within what bounds a scale below
SCALE_BITS = 96  # of the bounds of a scale: 2^-95 = 2.5e-29 of it, below 1e-20


@dataclass(frozen=True)
class Scaling(Brief):
    """The scale of a problem that has one. source, target: Sxx > 0 and Syy, in objective units."""

    kind: Scale
    source: Fraction
    target: Fraction

    @classmethod
    def of(cls, moments: ExactMoments, motion: Motion) -> Scaling | None:
        """Of the moments of a problem; None where its scale is not free.

        Raises DegenerateProblemError where no scale is better than others.
        """
        kind = motion.scale
        if not kind.free:
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
            if spread == 0 and (name == "source" or kind.divides):
                raise DegenerateProblemError(
                    f"all {name} points with weight lie {place}: they tell no {kind.value} scale; "
                    "leave the scale out",
                    rank=0,
                )
        return cls(kind, source, target)

    @property
    def symmetric(self) -> bool:
        """Whether the scale is the symmetric one, whatever the rotation."""
        return self.kind.divides

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
        """How far `energy` may be below the true one; 0 for the asymmetric scale."""
        return 2 * (self._mean[1] - self._mean[0]) if self.symmetric else Fraction(0)

    def best(self, alignment: Fraction) -> Fraction:
        """The best scale; of a symmetric one a number just below it."""
        if self.symmetric:
            return self._ratio[0]
        return max(alignment, Fraction(0)) / self.source

    def energy(self, alignment: Fraction) -> Fraction:
        """The objective with the best scale, >= 0; of a symmetric one at most `slack` less."""
        if self.symmetric:
            return 2 * max(self._mean[0] - alignment, Fraction(0))
        return self.target - max(alignment, Fraction(0)) ** 2 / self.source

    def energy_at(self, alignment: Fraction, scale: Fraction, shifted: Fraction) -> Fraction:
        """The objective at any scale; shifted: M |t - best t|^2, the cost of the translation."""
        squares = self.target - 2 * scale * alignment + scale**2 * self.source + shifted
        return squares / scale if self.symmetric else squares

    def least_range(self, alignment: Fraction, squares: Fraction) -> Fraction:
        """The square of a number that the range of energies over all rotations is not below.

        squares: F^2 of Davenport's matrix K, of trace 0; alignment: of some rotation, at most l1.
        Asymmetric: the range is l1^2 / Sxx, as some rotation has a <= 0, and l1^2 >= F^2 / 12, the
        least being at eigenvalues (l, l, l, -3 l). Symmetric: 2 (l1 - l4) >= 2 F.
        """
        if self.symmetric:
            return 4 * squares
        return (max(max(alignment, Fraction(0)) ** 2, squares / 12) / self.source) ** 2

    def gap(self, alignment: Fraction, delta: Fraction) -> Fraction:
        """What the objective at a rotation exceeds the minimum by, at most, if l1 < a + delta.

        (l1^2 - a^2) / Sxx < delta (2 a + delta) / Sxx, which is true of a >= 0 alone; or 2 delta.
        """
        if self.symmetric:
            return 2 * delta
        return delta * (2 * alignment + delta) / self.source

    def interval(self, alignment: Fraction, delta: Fraction) -> tuple[Dyadic, Dyadic]:
        """Bounds of the best scale at the optimum, of few bits, if a <= l1 < a + delta."""
        low, high = self._ratio
        if not self.symmetric:
            low, high = alignment / self.source, (alignment + delta) / self.source
        return dyadic_below(low, SCALE_BITS), dyadic_above(high, SCALE_BITS)


def root_bounds(value: Fraction) -> tuple[Fraction, Fraction]:
    """Numbers at most 2^-(ROOT_BITS - 1) of themselves apart, with the root of value between."""
    n, d = value.numerator, value.denominator
    places = ROOT_BITS - (n.bit_length() - d.bit_length()) // 2
    floor = (n << 2 * places) // d if places >= 0 else n // (d << -2 * places)
    low = isqrt(floor)
    return low * power_of_two(-places), (low + 1) * power_of_two(-places)
