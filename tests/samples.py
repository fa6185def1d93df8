"""How many examples a property takes: in `make test` a third of those in `make test-long`."""

from __future__ import annotations

from hypothesis import settings

WHOLE = 100  # what the profiles of the long samples take where a test does not say how many


def examples(count: int) -> settings:
    """A property takes so many examples in the long samples, and a third of them in `make test`."""
    whole = settings().max_examples >= WHOLE
    return settings(max_examples=count if whole else count // 3)
