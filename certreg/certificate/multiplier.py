"""From a proposed multiplier to a proved bound: nu I - K > 0 by exact elimination.

If nu I - K is positive definite then tr(R(q)^T C) = q^T K q / |q|^2 < nu for every rotation R(q).
A solver's nu lies on either side of the largest eigenvalue, so it is rounded outwards until exact
arithmetic accepts it.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from certreg.exact import Dyadic, dyadic_above, is_positive_definite, power_of_two
from certreg.geometry import davenport_matrix
from certreg.objective import alignment
from certreg.settings import MultiplierSettings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.problem import ExactMoments


def proved_multiplier(
    moments: ExactMoments, proposal: Fraction, *, settings: MultiplierSettings | None = None
) -> Dyadic | None:
    """A short dyadic nu just above the proposal with nu I - K > 0, proved; in units of tr(R^T C).

    The proposal itself, rounded up, then moved out by growing steps relative to the largest entry
    of K. None means not proved, not disproved: the proposal is far too small.
    """
    settings = settings or MultiplierSettings()
    start, scale = max(proposal, Fraction(0)), _scale(moments)
    first = scale * power_of_two(-settings.first_step_bits)
    steps = (first * power_of_two(settings.growth_bits * k) for k in range(settings.attempts))
    for step in (Fraction(0), *steps):
        nu = dyadic_above(start + step, settings.bound_bits)
        if proves_multiplier(moments, nu.value):
            return nu
    return None


def proves_multiplier(moments: ExactMoments, nu: Fraction) -> bool:
    """Whether nu I - K is positive definite, exactly: nu lies above every tr(R^T C).

    False means that nu is not above the largest eigenvalue of K.
    """
    davenport = davenport_matrix(moments.cross)
    in_units = nu / moments.cross_unit
    return is_positive_definite(
        [
            [
                (in_units.numerator if i == j else 0) - in_units.denominator * entry
                for j, entry in enumerate(row)
            ]
            for i, row in enumerate(davenport)
        ]
    )


def multiplier_gap(moments: ExactMoments, q: Sequence[int], nu: Dyadic) -> Fraction:
    """2 (nu - v), v = q^T K q / |q|^2: more than objective(R(q)) - minimum if nu is proved.

    The objective at the best translation is spread - 2 v, and the minimum exceeds spread - 2 nu.
    """
    return 2 * (nu.value - alignment(moments, q))


def _scale(moments: ExactMoments) -> Fraction:
    """The size of K, in units of tr(R^T C); positive even where K is zero."""
    largest = max(abs(entry) for row in davenport_matrix(moments.cross) for entry in row)
    return largest * moments.cross_unit or moments.spread or moments.cross_unit
