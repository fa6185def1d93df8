"""Both machines that step bodies: the compiled library, and the generated Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from certreg.native.compiler import CompilationError, find_compiler
from certreg.native.evaluator import evaluator
from certreg.native.library import loaded_library

if TYPE_CHECKING:
    from certreg.native import loops


def engine(name: str) -> loops.Engine:
    """Skips the test where there is no compiler; C that does not compile is a failure."""
    if name == "evaluator":
        return evaluator()
    try:
        find_compiler()
    except CompilationError as error:
        pytest.skip(str(error))
    return loaded_library()
