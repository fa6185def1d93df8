"""Both machines that step bodies: the compiled library, and Python."""

from __future__ import annotations

import os

import pytest
from reference_engine import Reference, reference

from build_kernels import NoCompilerError, find_compiler
from certreg.native.kernels import BUILT, PYTHON, VARIANT, MissingLibraryError, record_of, runnable
from certreg.native.library import Library, loaded_library


def engine(name: str) -> Library | Reference:
    """Skips the test where nothing could be compiled; C that is wrong ends the session."""
    if name == "evaluator":
        return reference()
    try:
        return loaded_library()
    except MissingLibraryError as error:
        if os.environ.get(VARIANT) != PYTHON and not record_of(BUILT).why:
            raise
        pytest.skip(str(error))


def libraries_of_all_variants() -> list[Library]:
    """The library of each variant that this processor runs, the widest last."""
    engine("library")
    with pytest.MonkeyPatch.context() as patch:
        loaded: list[Library] = []
        for name in runnable(record_of(BUILT), BUILT):
            patch.setenv(VARIANT, name)
            loaded.append(loaded_library.__wrapped__())
    return loaded


def c_compiler() -> tuple[str, ...]:
    """The command of this machine's compiler; skips the test where there is none."""
    try:
        return find_compiler().command
    except NoCompilerError as error:
        pytest.skip(str(error))
