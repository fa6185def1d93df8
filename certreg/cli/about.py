"""Commands about certreg itself: its generated code, and what it runs on."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

import click

from certreg import __version__
from certreg._loading import ORIGINS, late, refusal, unloaded
from certreg.cli.options import FOLDER
from certreg.registration.exit_codes import DONE
from certreg.report.markup import printable

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.native import kernels
    from certreg.native import library as native_library
    from certreg.registration import c_sources
else:
    kernels = late("certreg.native.kernels")
    native_library = late("certreg.native.library")
    c_sources = late("certreg.registration.c_sources")


@click.command()
@click.option("--out", type=FOLDER, required=True, help="Folder to write to.")
def codegen(out: Path) -> int:
    """Write the generated C of the dynamics with its header and a test program, to embed."""
    for path in c_sources.write_sources(out):
        click.echo(path)
    return DONE


@click.command()
def info() -> int:
    """Versions of what certreg runs on."""
    lines = {
        "certreg": __version__,
        "Python": f"{platform.python_version()} ({platform.python_implementation()})",
        "system": f"{platform.system()} {platform.machine()}",
        **{origin.name: _stated_version(name) for name, origin in ORIGINS.items()},
        "simulation": _engine(),
        "checker": "exact integers of Python itself",
    }
    for name, words in lines.items():
        click.echo(f"{name:12} {words}")
    return DONE


def _stated_version(name: str) -> str:
    """The version of a library in `ORIGINS` that is installed, or what it comes with."""
    origin = ORIGINS[name]
    try:
        return version(origin.name)
    except PackageNotFoundError:
        brought = "" if origin.extra is None else f" (extra `{origin.extra}`)"
        return f"not installed{brought}"


def _engine() -> str:
    try:
        return native_library.loaded_library().words  # asked for here: it loads NumPy
    except kernels.MissingLibraryError as error:
        return f"in Python: {error}"
    except kernels.VariantError:
        raise
    except Exception as error:  # noqa: BLE001 - whatever stops NumPy: the list is for such machines
        library = unloaded(error) or "numpy"
        return f"none: {printable(refusal(library, error, 'it'))}"
