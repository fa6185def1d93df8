"""How much of a sample `make test` takes: a fifth of a property's examples, one case in k.

`make test-long` takes the rest. What is asked of a case is the same in both.
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from hypothesis import settings

if TYPE_CHECKING:
    from collections.abc import Iterable

    import pytest

WHOLE = 100  # what the profiles of the long samples take where a test does not say how many


def examples(count: int) -> settings:
    """A property takes so many examples in the long samples, and a fifth of them in `make test`."""
    whole = settings().max_examples >= WHOLE
    return settings(max_examples=count if whole else count // 5)


def leave_cases(items: Iterable[pytest.Item]) -> None:
    """Of the cases of a test that is marked `one_in(k)` all but one in k are long."""
    families: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("one_in") and not item.get_closest_marker("long"):
            families.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for name, family in families.items():
        (mark,) = family[0].iter_markers("one_in")
        taken = drawn(name, len(family), *mark.args)
        for k in set(range(len(family))) - taken:
            family[k].add_marker("long")


def drawn(name: str, cases: int, one_in: int) -> set[int]:
    """The cases of a test that `make test` takes: ever the same, of another test others."""
    return set(random.Random(name).sample(range(cases), -(-cases // one_in)))
