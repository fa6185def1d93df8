"""How far a long run is: a bar on stderr with rate and time left, where that is a terminal."""

from __future__ import annotations

import logging
import sys
import time
from contextlib import ExitStack
from typing import Any, Self

import click

from certreg.campaign.runner import Observer
from certreg.report.markup import printable

PATIENCE = 1.0  # seconds before a long run says that it is at work
ERASE_LINE = "\r\033[K"
CAMPAIGNS = logging.getLogger("certreg.campaign")  # what it warns of, as of no worker, is a note


class Progress(ExitStack):
    """A bar over `total` items of a kind.

    Nothing is shown within the first second, nor where stderr is no terminal.
    """

    def __init__(self, total: int, *, items: str = "instances") -> None:
        super().__init__()
        self._todo, self._items = total, items
        self.made, self.seconds = 0, 0.0  # items done since the beginning, and the time they took
        self._shown = 0
        self._start = time.monotonic()
        self._bar: Any = None

    def observer(self) -> Observer:
        """This bar, to be moved by a campaign."""
        return Observer(begun=self.begin_with, advanced=self.advance, noted=note)

    def begin_with(self, count: int) -> None:
        """So many items were done before: they say nothing of the rate."""
        if count:
            note(f"{count:,} of {self._todo:,} {self._items} were there already")
        self._todo -= count
        self._start = time.monotonic()

    def advance(self, count: int) -> None:
        """So many more items are done."""
        self.made += count
        self.seconds = time.monotonic() - self._start
        if not sys.stderr.isatty() or self.seconds < PATIENCE:
            return
        if self._bar is None:
            self._bar = self.enter_context(
                click.progressbar(range(self._todo), file=sys.stderr, item_show_func=str)
            )
            self._bar.start -= self.seconds
        rate = f"{self.made / self.seconds:,.0f} {self._items}/s"
        self._bar.update(self.made - self._shown, rate)
        self._shown = self.made

    def __enter__(self) -> Self:
        notes = _Notes(logging.WARNING)
        CAMPAIGNS.addHandler(notes)
        self.callback(CAMPAIGNS.removeHandler, notes)
        return self


class _Notes(logging.Handler):
    """What is logged, as notes."""

    def emit(self, record: logging.LogRecord) -> None:
        note(record.getMessage())


class Stages:
    """A line that names the stage of a run, and is gone at its end.

    Shown as `Progress` is: after a second, to a terminal.
    """

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._shown = False

    def at(self, stage: str, done: int = 0, total: int = 1) -> None:
        """`done` of `total` parts of a stage are done."""
        if sys.stderr.isatty() and time.monotonic() - self._start > PATIENCE:
            count = f" {done:,} of {total:,}" if total > 1 else ""
            click.echo(f"{ERASE_LINE}{stage}{count} ...", nl=False, err=True)
            self._shown = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._shown:
            click.echo(ERASE_LINE, nl=False, err=True)


def note(words: str) -> None:
    """A line on stderr about something that is odd, and does not stand in the way."""
    click.echo(f"note: {printable(words)}", err=True)
