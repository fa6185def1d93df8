"""The parts of long work, told as they are done: to the log, and to whoever asked."""

from __future__ import annotations

import itertools
import logging
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    Progress = Callable[[int, int], object]

LOG = logging.getLogger(__name__)


def logged(name: str) -> None:
    """Say to the log that a part is done."""
    LOG.debug("%s: done", name)


def counted(progress: Progress | None, total: int) -> Callable[[str], None]:
    """A function to be called with the name of each part that is done; progress: as of `certify`.

    >>> done = counted(print, 2)
    >>> done("relaxation")
    1 2
    """
    numbers = itertools.count(1)

    def done(name: str) -> None:
        logged(name)
        if progress is not None:
            progress(next(numbers), total)

    return done
