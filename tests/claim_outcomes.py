"""Every claim of the book, proved once in a session: by the derivations that the package finds."""

from __future__ import annotations

from functools import cache
from typing import Any

from certreg.paper import derivation


@cache
def outcome(name: str) -> Any:
    """What became of a claim (kernel.ClaimOutcome)."""
    (found,) = derivation.outcomes([name])
    return found
