"""Numbers on the command line: a decimal comma is answered by the number to type."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NoReturn, Protocol

import click
from click.types import FloatParamType

if TYPE_CHECKING:

    class _Failing(Protocol):
        def fail(
            self, message: str, param: click.Parameter | None, ctx: click.Context | None
        ) -> NoReturn: ...


DECIMAL_COMMA = re.compile(r"\s*([-+]?\d*),(\d+(?:[eE][-+]?\d+)?)\s*")


class DecimalNumber(FloatParamType):
    """A number."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The double; fails with what to type instead of a decimal comma."""
        _refuse_comma(self, value, param, ctx)
        return super().convert(value, param, ctx)


class NumberRange(click.FloatRange):
    """A number within limits."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The double; fails with what to type instead of a decimal comma."""
        _refuse_comma(self, value, param, ctx)
        return float(super().convert(value, param, ctx))


NUMBER = DecimalNumber()
FROM_ZERO = NumberRange(min=0.0)


def _refuse_comma(
    kind: _Failing, value: Any, param: click.Parameter | None, ctx: click.Context | None
) -> None:
    """A comma may also part thousands, so that no number is read into it."""
    found = DECIMAL_COMMA.fullmatch(value) if isinstance(value, str) else None
    if found is not None:
        pointed = f"{found[1]}.{found[2]}"
        kind.fail(f"'{value}' has a comma: with a decimal point type {pointed}", param, ctx)
