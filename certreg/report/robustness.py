"""How far the points may be off, in words: proved, sufficient, not sharp."""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from certreg.registration import AnyRegistration, Robustness


def robustness_words(registration: AnyRegistration) -> str:
    """How far points may be off, proved, in one line."""
    found = registration.robustness
    if found is None:
        return "not proved"
    return (
        f"no optimum turns by more than {found.angle:g} degrees as long as every target point is "
        f"off by less than {length_below(found.target)}; points of both clouds, "
        f"{length_below(found.both)} (sufficient, not sharp)"
        f"{meanwhile_words(registration, found)}"
    )


def meanwhile_words(registration: AnyRegistration, found: Robustness) -> str:
    """How far a free scale moves meanwhile; nothing of others."""
    if not registration.problem.scaled:
        return ""
    target, both = map(_range, (found.scale_target, found.scale_both))
    return f"; meanwhile the scale stays {target}; with points of both clouds off, {both}"


def _range(scales: tuple[float, float] | None) -> str:
    """Two numbers in six digits, rounded outwards."""
    if scales is None:
        return "within no proved bound"
    low, high = (
        Context(prec=6, rounding=rounding).create_decimal_from_float(end)
        for end, rounding in zip(scales, (ROUND_FLOOR, ROUND_CEILING), strict=True)
    )
    return f"between {low:g} and {high:g}"


def length_below(length: float) -> str:
    """A length in three digits, rounded down."""
    return f"{Context(prec=3, rounding=ROUND_FLOOR).create_decimal_from_float(length):g}"
