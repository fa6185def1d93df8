"""How far the points may be off, in words: proved, sufficient, not sharp."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.exact.decimals import as_given, at_least, at_most

if TYPE_CHECKING:
    from certreg.registration.result import Registration
    from certreg.registration.robustness import Robustness

MEANWHILE = "; meanwhile the scale stays {target}; with points of both clouds off, {both}"


def robustness_words(registration: Registration) -> str:
    """How far points may be off, proved, in one line."""
    found = registration.robustness
    if found is None:
        return "not proved"
    return (
        f"every optimum stays within {as_given(found.angle)} degrees of the certified rotation as "
        f"long as every target point is off by less than {at_least(found.target)}; points of both "
        f"clouds, {at_least(found.both)} (sufficient, not sharp)"
        f"{meanwhile_words(found)}"
    )


def meanwhile_words(found: Robustness) -> str:
    """How far a free scale moves meanwhile; nothing of others."""
    told = {off: _range(within) for off, within in found.scales.items()}
    return MEANWHILE.format(**told) if told else ""


def _range(scales: tuple[float, float] | None) -> str:
    """Two numbers in six digits, rounded outwards."""
    if scales is None:
        return "within no proved bound"
    low, high = scales
    return f"between {at_least(low, 6)} and {at_most(high, 6)}"
