"""Commands as a user runs them, in this process, and clouds to run them on."""

from __future__ import annotations

import contextlib
import io
import json
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar
from unittest import mock

import pytest

from certreg.cli.main import run
from certreg.native.library import library_if_any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


NEEDED = "needs the compiled library"
T = TypeVar("T")


@dataclass(frozen=True)
class Run:
    code: int
    out: str
    err: str

    @property
    def document(self) -> Any:
        """What `--json` printed; NaN and Infinity are not JSON."""
        return strict_json(self.out)


def certreg(*arguments: object) -> Run:
    """`certreg ARGUMENTS`; an exception that would be a traceback is raised here.

    The test is skipped where there is no compiled library, and the command needs it.
    """
    out, err = io.StringIO(), io.StringIO()
    code: Any = None
    with (
        mock.patch.object(sys, "argv", ["certreg", *map(str, arguments)]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        try:
            code = run()
        except SystemExit as stop:
            code = stop.code
    if NEEDED in err.getvalue() and library_if_any() is None:
        pytest.skip(err.getvalue())
    return Run(code, out.getvalue(), err.getvalue())


def checked(value: T | None) -> T:
    """A value that must be there."""
    assert value is not None
    return value


def strict_json(text: str | bytes) -> Any:
    def refuse(constant: str) -> NoReturn:
        message = f"{constant} is not JSON"
        raise ValueError(message)

    return json.loads(text, parse_constant=refuse)


def write_csv(
    path: Path, points: Sequence[Sequence[float]], labels: Sequence[str] | None = None
) -> Path:
    """A cloud as another program would write it."""
    rows = [",".join(map(repr, map(float, point))) for point in points]
    if labels is not None:
        rows = ["label,x,y,z", *(f"{n},{row}" for n, row in zip(labels, rows, strict=True))]
    path.write_text("\n".join(rows) + "\n", "utf-8")
    return path
