"""The claims of the book, proved once in a session: by the derivations that the package finds.

`make test` proves a twelfth of them; all are proved by the pages and in `make test-long`.
"""

from __future__ import annotations

import dataclasses
from functools import cache
from typing import Any

from certreg.paper import derivation
from derivations import book

HEAVY = {"breathing_motion", "growth_form", "quartic_relaxation", "spring_caps", "spring_motion"}
TAKEN = [name for name in book.names()[2::12] if name not in HEAVY]  # by `make test`


def taken_as_proved(name: str) -> Any:
    """What stands for the outcome of a claim that is proved elsewhere."""
    return dataclasses.replace(outcome(TAKEN[0]), claim=book.claim(name))


@cache
def outcome(name: str) -> Any:
    """What became of a claim (kernel.ClaimOutcome)."""
    (found,) = derivation.outcomes([name])
    return found
