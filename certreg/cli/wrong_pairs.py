"""Options for pairs that may be wrong: the bound on residuals, what is sought, how hard."""

from __future__ import annotations

import functools
import logging
import math
import re
import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from certreg._loading import late
from certreg.cli.options import NUMBER
from certreg.errors import InvalidProblemError
from certreg.report.markup import printable

if TYPE_CHECKING:
    from certreg.io import row_values as io_bounds
    from certreg.io.pairing import Pair
    from certreg.problem import bounds as problem_bounds
    from certreg.problem import budget as problem_effort
else:
    # These load NumPy, and are loaded where they are needed.
    io_bounds = late("certreg.io.row_values")
    problem_bounds = late("certreg.problem.bounds")
    problem_effort = late("certreg.problem.budget")


SEARCH = "certreg.registration.consensus"  # the logger that tells what was found
PROOF = "certreg.certificate.producing_consensus"  # that tells how far a proof is, again and again
PATIENCE = 1.0  # seconds before anything is said
AGAIN = 5.0  # seconds between two words of a proof


def consensus_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--max-residual X|FILE] [--objective NAME] [--effort N], made one argument `wrong`."""

    @click.option(
        "--max-residual",
        metavar="X|FILE",
        help="Pairs may be wrong: how far apart the two points of a right pair are at most, in the "
        "clouds' unit, whatever their spring; or a file, one number per row of SOURCE. The most "
        "pairs that one motion brings within are sought, and which they are is proved.",
    )
    @click.option(
        "--objective",
        type=click.Choice(["consensus", "truncated"]),
        help="With --max-residual: the number of pairs within (the default), or the sum of "
        "min((residual / X)^2, 1), with --rotation-only.",
    )
    @click.option(
        "--effort",
        type=NUMBER,
        metavar="N",
        help="With --max-residual: a factor on all budgets of search and proof.  [default: 1]",
    )
    @functools.wraps(command)
    def wrapped(
        *args: Any,
        max_residual: str | None,
        objective: str | None,
        effort: float | None,
        **options: Any,
    ) -> Any:
        if max_residual is None and (objective or effort) is not None:
            raise click.UsageError("--objective and --effort go with --max-residual")
        wrong = None
        if max_residual is not None:
            wrong = WrongPairs(max_residual, 1.0 if effort is None else effort, objective)
        with _told_on_terminal(), _named_as_typed(max_residual):
            return command(*args, wrong=wrong, **options)

    return wrapped


def certified_bounds(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--max-residual X|FILE] [--objective NAME] of a certificate, made one argument `wrong`."""

    @click.option(
        "--max-residual",
        metavar="X|FILE",
        help="With SOURCE TARGET: the bounds on residuals that were certified.",
    )
    @click.option(
        "--objective",
        type=click.Choice(["consensus", "truncated"]),
        help="With --max-residual: what was certified.",
    )
    @functools.wraps(command)
    def wrapped(*args: Any, max_residual: str | None, objective: str | None, **options: Any) -> Any:
        if max_residual is None and objective is not None:
            raise click.UsageError("--objective goes with --max-residual")
        wrong = None if max_residual is None else WrongPairs(max_residual, 1.0, objective)
        with _named_as_typed(max_residual):
            return command(*args, wrong=wrong, **options)

    return wrapped


@dataclass(frozen=True, slots=True)
class WrongPairs:
    """That pairs may be wrong: the bound as it was typed, a number or a file; and what is asked."""

    max_residual: str
    effort: float
    objective: str | None

    def asked(self, pair: Pair) -> dict[str, Any]:
        """The arguments of `certify` of the pairs."""
        bounds = self.bounds(pair)
        return {"max_residual": bounds, "objective": self.objective, "effort": self.effort}

    def bounds(self, pair: Pair) -> Any:
        """One number, or one for each of the pairs."""
        number = _number(self.max_residual)
        if isinstance(number, float):
            return number
        if not Path(self.max_residual).is_file():
            raise click.UsageError(f"--max-residual {printable(self.max_residual)}: {number}")
        return io_bounds.read_bounds(Path(self.max_residual), pair)

    def columns(self) -> dict[str, str]:
        """The same as columns of a list of pairs, of which each has its own rows."""
        number = _number(self.max_residual)
        if isinstance(number, str):
            raise click.UsageError(
                f"--max-residual {printable(self.max_residual)}: give a number; files of bounds go "
                "in a column max_residual of MANIFEST, one for each pair"
            )
        problem_bounds.checked_bounds(number, 1)
        told = {"max_residual": repr(number), "objective": self.objective}
        told["effort"] = (
            None if self.effort == 1.0 else repr(problem_effort.checked_effort(self.effort))
        )
        return {name: value for name, value in told.items() if value is not None}


def _number(text: str) -> float | str:
    """What was typed, if that is a number; else why it is none, nor the name of a file."""
    try:
        return NUMBER.convert(text, None, None)
    except click.BadParameter as error:
        return error.message if "comma" in error.message else "neither a number nor a file"


@contextmanager
def _named_as_typed(max_residual: str | None) -> Generator[None]:
    """Says what is wrong with bounds by the name of the option, and of the file if it is one."""
    try:
        yield
    except InvalidProblemError as error:
        if max_residual is None or error.array not in {"max_residual", "effort"}:
            raise
        file = f" {printable(max_residual)}" if isinstance(_number(max_residual), str) else ""
        said = re.sub("^effort", "--effort", str(error))
        raise InvalidProblemError(
            said.replace("max_residual", f"--max-residual{file}"),
            array=error.array,
            row=error.row,
            value=error.value,
            limit=error.limit,
        ) from error


class _Patient(logging.Handler):
    """Says on stderr how far a search has come, once it takes longer than a second."""

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self._begun = time.monotonic()
        self._said = -math.inf

    def emit(self, record: logging.LogRecord) -> None:
        now = time.monotonic()
        often = record.name == PROOF and now - self._said < AGAIN
        if now - self._begun > PATIENCE and not often:
            self._said = now
            click.echo(record.getMessage(), err=True)


@contextmanager
def _told_on_terminal() -> Generator[None]:
    """While a search runs, what it has found is said, to a terminal only."""
    if not sys.stderr.isatty():
        yield
        return
    handler = _Patient()
    logs = {log: log.level for log in map(logging.getLogger, (SEARCH, PROOF))}
    for log in logs:
        log.addHandler(handler)
        log.setLevel(logging.INFO)
    try:
        yield
    finally:
        for log, level in logs.items():
            log.removeHandler(handler)
            log.setLevel(level)
