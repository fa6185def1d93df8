"""[--json]: one JSON object on standard output, also where there is no result to tell."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import click

from certreg._loading import late
from certreg.errors import CertregError

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.registration import exit_codes
    from certreg.report import document
else:
    # These load NumPy, and are loaded where they are needed.
    exit_codes = late("certreg.registration.exit_codes")
    document = late("certreg.report.document")


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
            code = exit_codes.code_of_error(error)
            if as_json and code != exit_codes.MISUSED:
                click.echo(document.dumps(document.error_document(error, code)))
            raise

    return wrapped
