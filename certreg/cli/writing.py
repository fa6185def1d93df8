"""Commands that write a file, which is never one that they read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import click

from certreg.errors import InvalidFileError
from certreg.io import is_standard_input
from certreg.report import printable

if TYPE_CHECKING:
    from collections.abc import Iterable


class WritingCommand(click.Command):
    """A command with `--out FILE`: no other file that it is given may be the same one."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command, once it is sure that nothing it reads is overwritten."""
        out = ctx.params.get("out")
        if out is not None:
            require_apart(out, _files_of(ctx))
        return super().invoke(ctx)


def _files_of(context: click.Context) -> list[Path]:
    """All files that the command was given to read."""
    given = [value for name, value in context.params.items() if name != "out"]
    several = (cast("tuple[Any, ...]", v) if isinstance(v, tuple) else (v,) for v in given)
    listed = [each for values in several for each in values]
    bounds = context.params.get("max_residual")  # a number or a file, as it was typed
    files = [each for each in listed if isinstance(each, Path) and not is_standard_input(each)]
    return files if bounds is None else [*files, Path(bounds)]


def require_apart(out: Path, files: Iterable[Path]) -> None:
    """That a place to write to is none of the files, under whatever name. Raises InvalidFileError.

    A file that is written is put together beside its place, so that it would replace what was read.
    """
    for file in files:
        if _same(out, file):
            words = f"would overwrite {printable(file)}, which is read: give --out another name"
            raise InvalidFileError(f"{printable(out)}: {words}", path=out)


def _same(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except (OSError, ValueError):  # one of them is not there, or can be no file
        return False
