"""The engine of this process: compiled code where there is one; elsewhere Python runs the C.

There only a rigid body moves, slower by a factor of hundreds, with the same numbers up to rounding:
`Evaluator.run` does what the loops in C do, in the same order (`runs`).
"""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import NotCompiledWarning
from certreg.native.kernels import GENERATED, MissingLibraryError
from certreg.native.library import Library, checked, library_for, loaded_library
from certreg.native.runs import run_in_python
from certreg.native.signatures import Signature, generated
from certreg.native.tape import Tape, tapes_of

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.native.loops import Batch, Engine, Log, Rules

LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Evaluator:
    """The generated functions of a rigid body, each a tape."""

    calls: dict[str, _Call]

    @property
    def words(self) -> str:
        """What it is, for `certreg info`."""
        return "Python (no compiled code)"

    def evaluate(self, name: str, *arguments: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """The results of one generated function, flat. Raises ValueError for other sizes."""
        return self.calls[name](*arguments)

    def run(self, batch: Batch, rules: Rules, log: Log | None = None) -> None:
        """Integrate every body of a batch, one after another."""
        run_in_python(self, batch, rules, log)


@dataclass(frozen=True, slots=True)
class _Call:
    """One function with the sizes of what it takes and gives."""

    name: str
    tape: Tape
    shape: Signature

    def __call__(self, *arguments: NDArray[Any]) -> tuple[NDArray[np.float64], ...]:
        """The results for one set of numbers."""
        given = checked(self.name, self.shape, arguments)
        try:  # Python's own numbers are four times as fast as NumPy's, one by one
            results = self.tape.run([array.tolist() for array in given])
        except (ZeroDivisionError, ValueError):  # infinity, or none: a result like any other in C
            with np.errstate(all="ignore"):
                results = self.tape.run([list(array) for array in given])
        return tuple(np.array(result) for result in results)


@cache
def evaluator() -> Evaluator:
    """The evaluator of this process, of the body on springs of one weight per pair."""
    return Evaluator(calls_of(GENERATED / "dynamics.c"))


def calls_of(*sources: Path) -> dict[str, _Call]:
    """The functions of generated C, by name."""
    shapes = generated()
    tapes = (tape for source in sources for tape in tapes_of(source.read_text("utf-8")))
    return {name: _Call(name, tape, shapes[name]) for name, tape in tapes}


@cache
def current_engine() -> Engine:
    """The engine of this process; warns once where it is the slow one."""
    try:
        library = loaded_library()
    except MissingLibraryError as error:
        LOG.info("in Python: %s", error)
        message = f"{error}: simulating in Python, same results but much slower"
        warnings.warn(message, NotCompiledWarning, stacklevel=2)
        return evaluator()
    LOG.info("%s", library.words)
    return library


def compiled_engine() -> Library:
    """The engine of bodies that Python does not move. Raises MissingLibraryError."""
    return library_for("the motion on general springs, or with a free scale,")
