"""How far the points may be off, in words: proved, sufficient, not sharp."""

from __future__ import annotations

from decimal import ROUND_FLOOR, Context
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from certreg.registration import AnyRegistration


def robustness_words(registration: AnyRegistration) -> str:
    """How far points may be off, proved, in one line."""
    found = registration.robustness
    if found is None:
        return "not proved"
    return (
        f"no optimum turns by more than {found.angle:g} degrees as long as every target point is "
        f"off by less than {length_below(found.target)}; points of both clouds, "
        f"{length_below(found.both)} (sufficient, not sharp)"
    )


def length_below(length: float) -> str:
    """A length in three digits, rounded down."""
    return f"{Context(prec=3, rounding=ROUND_FLOOR).create_decimal_from_float(length):g}"
