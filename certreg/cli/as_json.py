"""[--json]: one JSON object on standard output, also where there is no result to tell."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import click

# These load NumPy, and are loaded where they are needed.
from certreg import registration, report
from certreg.errors import CertregError

if TYPE_CHECKING:
    from collections.abc import Callable


def json_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--json], the argument `as_json`; why the question has no answer is one object, too.

    Bad usage or input, code 2, is a line on standard error alone: nothing was asked yet.
    """

    @click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
    @functools.wraps(command)
    def wrapped(*args: Any, as_json: bool, **options: Any) -> Any:
        try:
            return command(*args, as_json=as_json, **options)
        except CertregError as error:
            code = registration.code_of_error(error)
            if as_json and code != registration.MISUSED:
                click.echo(report.dumps(report.error_document(error, code)))
            raise

    return wrapped
