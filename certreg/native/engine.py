"""The engine of this process: compiled code where there is one, Python elsewhere."""

from __future__ import annotations

import logging
import warnings
from functools import cache
from typing import TYPE_CHECKING

from certreg.errors import SlowSimulationWarning
from certreg.native.evaluator import evaluator
from certreg.native.kernels import MissingLibraryError
from certreg.native.library import loaded_library

if TYPE_CHECKING:
    from certreg.native.library import Library
    from certreg.native.loops import Engine

LOG = logging.getLogger(__name__)


@cache
def current_engine() -> Engine:
    """The engine of this process; warns once where it is the slow one."""
    try:
        library = loaded_library()
    except MissingLibraryError as error:
        LOG.info("in Python: %s", error)
        message = f"{error}: simulating in Python, same results but much slower"
        warnings.warn(message, SlowSimulationWarning, stacklevel=2)
        return evaluator()
    LOG.info("%s", library.words)
    return library


def compiled_engine() -> Library:
    """The engine of bodies that Python does not move. Raises MissingLibraryError."""
    try:
        return loaded_library()
    except MissingLibraryError as error:
        words = "the motion on general springs, or with a free scale, needs the compiled library"
        raise MissingLibraryError(f"{words}: {error}") from error
