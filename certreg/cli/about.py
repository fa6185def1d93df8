"""Commands about certreg itself: its generated code, and what it runs on."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import TYPE_CHECKING

import click

from certreg import __version__
from certreg.cli.options import FOLDER
from certreg.native import current_engine
from certreg.registration import DONE, write_sources

if TYPE_CHECKING:
    from pathlib import Path

PACKAGES = (
    *("numpy", "scipy", "sympy", "casadi", "python-flint"),
    *("click", "cvxpy-base", "clarabel"),
)


@click.command()
@click.option("--out", type=FOLDER, required=True, help="Folder to write to.")
def codegen(out: Path) -> int:
    """Write the generated C of the dynamics with its header and a test program, to embed."""
    for path in write_sources(out):
        click.echo(path)
    return DONE


@click.command()
def info() -> int:
    """Versions of what certreg runs on."""
    click.echo(f"certreg      {__version__}")
    click.echo(f"Python       {platform.python_version()} ({platform.python_implementation()})")
    click.echo(f"system       {platform.system()} {platform.machine()}")
    for package in PACKAGES:
        click.echo(f"{package:12} {version(package)}")
    click.echo(f"simulation   {current_engine().words}")
    click.echo("checker      exact integers of Python itself")
    return DONE
