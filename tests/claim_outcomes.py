"""Every claim of the book, proved once in a session: by the derivations that the package finds."""

from __future__ import annotations

from functools import cache
from typing import Any

from certreg.paper import derivation

# A third of the time of all claims: proved in `make test-long`, by the pages and by `.ci/run`.
HEAVY = {"growth_form", "quartic_relaxation", "spring_caps", "spring_motion"}


@cache
def outcome(name: str) -> Any:
    """What became of a claim (kernel.ClaimOutcome)."""
    (found,) = derivation.outcomes([name])
    return found
