"""Commands that write files, none of which is one that they read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import click

from certreg.errors import InvalidFileError
from certreg.io.streams import is_standard_input
from certreg.report.markup import printable


class WritingCommand(click.Command):
    """A command with `--out`: a file, or a folder of `files`; none of them is one that it reads."""

    def __init__(self, name: str | None, *, files: Sequence[str] = (), **options: Any) -> None:
        super().__init__(name, **options)
        self._files = files

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command, once it is sure that nothing it reads is overwritten."""
        out = ctx.params.get("out")
        if out is not None and self._files:
            require_folder_apart(out, self._files, _files_of(ctx))
        elif out is not None:
            require_apart(out, _files_of(ctx))
        return super().invoke(ctx)


def _files_of(context: click.Context) -> list[Path]:
    """All files that the command was given to read."""
    given: dict[str, Path | str | tuple[Path | str, ...] | None] = context.params
    several = (v if isinstance(v, tuple) else (v,) for name, v in given.items() if name != "out")
    listed = (each for values in several for each in values)
    bounds = context.params.get("max_residual")  # a number or a file, as it was typed
    files = [each for each in listed if isinstance(each, Path) and not is_standard_input(each)]
    return files if bounds is None else [*files, Path(bounds)]


def require_folder_apart(folder: Path, names: Iterable[str], files: Iterable[Path]) -> None:
    """As `require_apart`, for all files that are written into a folder."""
    read = list(files)
    for name in names:
        require_apart(folder / name, read, "choose another folder")


def require_apart(
    out: Path, files: Iterable[Path], remedy: str = "give --out another name"
) -> None:
    """That a place to write to is none of the files, under whatever name. Raises InvalidFileError.

    A file that is written is put together beside its place, so that it would replace what was read.
    """
    for file in files:
        if _same(out, file):
            words = f"would overwrite {printable(file)}, which is read: {remedy}"
            raise InvalidFileError(f"{printable(out)}: {words}", path=out)


def _same(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except (OSError, ValueError):  # one of them is not there, or can be no file
        return False
