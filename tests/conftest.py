"""Fixed seeds for every property test: a failure is the same failure everywhere.

CERTREG_SEEDS=random takes others each time: every night, in the workflow.
"""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis.strategies import none
from samples import leave_cases

from certreg.errors import NotCompiledWarning
from certreg.native.kernels import MissingLibraryError
from certreg.native.library import library_if_any

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from contextlib import AbstractContextManager

settings.register_profile(
    "certreg",
    max_examples=20,  # of 100 in `make test-long`, where a test does not say how many
    derandomize=True,
    deadline=None,  # the machines are shared: no property is about time
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.register_profile("long", settings.get_profile("certreg"), max_examples=100)
settings.register_profile("random", settings.get_profile("long"), derandomize=False)
settings.load_profile(os.environ.get("CERTREG_SEEDS", "certreg"))

os.environ.setdefault("SYMPY_CACHE_SIZE", "20000")  # as derivations/__init__.py, and before it

# Of each process that a test starts, as the Makefile has it of this one (-X warn_default_encoding).
os.environ["PYTHONWARNDEFAULTENCODING"] = "1"

# As the Makefile has it: else this process and each that it starts compile all libraries anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

gc.disable()  # all that collecting makes stays: see pytest_collection_finish

DATA = Path(__file__).parent.parent / "certreg" / "data"


# Whoever asks first for one of these waits for it: all figures, equilibria counted in many cells.
SLOW_FIXTURES = {"counts", "drawn"}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What is not slow is quick: `-m quick` takes less than a minute. What is long is slow."""
    leave_cases(items)
    for item in items:
        plots = item.path.name == "plots.py"  # imports Matplotlib
        long = item.get_closest_marker("long") is not None
        if plots or long or SLOW_FIXTURES.intersection(getattr(item, "fixturenames", ())):
            item.add_marker("slow")
        elif item.get_closest_marker("slow") is None:
            item.add_marker("quick")


def pytest_collection_finish() -> None:
    """What collecting made stays to the end; tests make few cycles: garbage is rarely sought."""
    # Hypothesis 6.100 looks, once, who holds its generator: it does not see what is frozen.
    given(none())(lambda _: None)()
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)
    gc.enable()


def pytest_unconfigure() -> None:
    """Garbage is sought once more; pytest and the interpreter seek it eight times after that."""
    gc.collect()
    gc.freeze()


@pytest.fixture
def data() -> Path:
    return DATA


@pytest.fixture
def logged() -> Callable[[int], AbstractContextManager[list[str]]]:
    """`with logged(logging.INFO) as messages`: what certreg logs at this level and above."""

    @contextlib.contextmanager
    def keep(level: int) -> Generator[list[str]]:
        messages, logger = list[str](), logging.getLogger("certreg")
        handler, before = logging.Handler(), logger.level
        handler.emit = lambda record: messages.append(record.getMessage())
        logger.addHandler(handler)
        logger.setLevel(level)
        yield messages
        logger.setLevel(before)
        logger.removeHandler(handler)

    return keep


@pytest.fixture
def compiled() -> None:
    """There is a compiled library beside Python; else the test is skipped."""
    from engines import engine

    engine("library")


def _without_library() -> Generator[None]:
    """Tests of what needs the compiled library are skipped where there is none."""
    try:
        return (yield)
    except (MissingLibraryError, NotCompiledWarning) as error:
        if library_if_any() is not None:
            raise
        pytest.skip(str(error))


pytest_runtest_setup = pytest_runtest_call = pytest.hookimpl(wrapper=True)(_without_library)


def pytest_sessionstart() -> None:
    """What is compiled is of the C sources that stand here; where it is not, told once and now."""
    import build_kernels
    from certreg.native.engine import current_engine

    built = build_kernels.renewed(set_up=False)
    if built.why:
        with contextlib.suppress(build_kernels.NoCompilerError):
            build_kernels.find_compiler()
            raise pytest.UsageError(built.why)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotCompiledWarning)
        current_engine()
