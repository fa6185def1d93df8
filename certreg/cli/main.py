"""The command line: `certreg COMMAND`. Thin: it reads, calls, prints, and sets the exit code.

The module of a command is imported when the command is run. Here, in `options` and in `verifying`
only click, the standard library and modules as light are imported, so that `--help` and `verify`
load no numerical library.
"""

from __future__ import annotations

import atexit
import gc
import sys
import traceback
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple, NoReturn

import click

from certreg import __version__
from certreg._loading import refusal, unloaded
from certreg.cli.memory import LOADING, LOADING_ALL, require_loadable
from certreg.cli.options import EXIT_CODES, warnings_as_notes
from certreg.cli.output import shelter_streams
from certreg.errors import CertregError
from certreg.registration.exit_codes import DEFECT, DONE, INTERRUPTED, MISUSED, code_of_error
from certreg.report.markup import printable


class Entry(NamedTuple):
    """A command of the list: its module within `certreg.cli`, and the first sentence of its help.

    The command is the function of the module that has the name of the command.
    """

    module: str
    help: str


SELDOM = 100_000  # new objects before a collection: libraries make as many that stay, 10 MB
COMMANDS = {
    "certify": Entry("registering", "Register SOURCE to TARGET and certify the result."),
    "demo": Entry(
        "registering", "The main job on packaged real data: survey, electrodes, protein."
    ),
    "assess": Entry("judging", "Judge a pose, or labels, of any other tool."),
    "apply": Entry(
        "judging", "Move CLOUD by the pose in RESULT: a result file or folder, or any pose file."
    ),
    "report": Entry(
        "judging",
        "One HTML file that shows the registration and its proof, for any browser, offline.",
    ),
    "verify": Entry(
        "verifying",
        "Re-check a certificate in exact arithmetic: VERIFIED, or REFUSED with the reason.",
    ),
    "equilibria": Entry(
        "dynamics", "All equilibria of the registration dynamics, with their stability."
    ),
    "simulate": Entry("dynamics", "Release the damped body at rest and see where it ends."),
    "batch": Entry(
        "campaigns",
        "Certify the pairs listed in MANIFEST, a .csv file: one line of JSON for each.",
    ),
    "reproduce": Entry(
        "reproducing", "Every experiment and figure of the paper, and its claims with verdicts."
    ),
    "derive": Entry("derivations", "Prove the derivations anew: every claim, or the ones named."),
    "codegen": Entry(
        "about",
        "Write the generated C of the dynamics with its header and a test program, to embed.",
    ),
    "info": Entry("about", "Versions of what certreg runs on."),
}

LIGHT = {"verify"}  # load no numerical library
SOLVING = {"certify", "demo", "batch", "reproduce"}  # load the solver of the relaxation, too


class LazyGroup(click.Group):
    """A group that imports a command when it is run, not when it is listed.

    The list is made, and names are completed, from the table: `commands` holds stand-ins with name
    and help.
    """

    def __init__(
        self, name: str | None = None, *, entries: Mapping[str, Entry], **options: Any
    ) -> None:
        listed = {name: click.Command(name, help=entry.help) for name, entry in entries.items()}
        super().__init__(name, commands=listed, **options)
        self._entries = entries

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does, but with the command itself, imported now."""
        name, listed, rest = super().resolve_command(ctx, args)
        return name, listed and self._imported(args[0]), rest

    def _imported(self, name: str) -> click.Command:
        if name not in LIGHT:
            solves = name in SOLVING and "--no-relaxation" not in sys.argv
            require_loadable(LOADING_ALL if solves else LOADING)
        module = import_module(f"certreg.cli.{self._entries[name].module}")
        return getattr(module, name)


@click.group(
    cls=LazyGroup,
    entries=COMMANDS,
    context_settings={"help_option_names": ["--help", "-h"]},  # the first is named in usage
    epilog=EXIT_CODES,
)
@click.version_option(__version__, prog_name="certreg")
def cli() -> None:
    """Certified registration of corresponding 3D point clouds.

    Finds the rigid motion that takes SOURCE to TARGET, all other equilibria of the registration
    dynamics, and a certificate of global optimality that anyone can check.
    """


@cache
def _collect_seldom() -> None:
    """Look for cycles of garbage less often, and not at the end: a tenth of a small `certify`."""
    gc.set_threshold(SELDOM)
    atexit.register(gc.freeze)


def main() -> NoReturn:
    """Run the command line, as a program; a defect of certreg's own is a traceback, code 70."""
    try:
        code = run()
    except Exception:  # noqa: BLE001 - the code that Python ends with, 1, is a verdict here
        traceback.print_exc()
        code = DEFECT
    sys.exit(code)


def run() -> int:
    """The exit code of the command line; bad input is one line on stderr, never a traceback."""
    _collect_seldom()
    try:
        shelter_streams()
        with warnings_as_notes():
            code = cli.main(prog_name="certreg", standalone_mode=False)
    except click.exceptions.Abort:
        click.echo("interrupted", err=True)
        return INTERRUPTED
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except CertregError as error:
        click.echo(f"certreg: {printable(error)}", err=True)
        return code_of_error(error)
    except Exception as error:
        words = _fault(error)
        if words is None:
            raise  # a defect of certreg's own
        click.echo(f"certreg: {words}", err=True)
        return MISUSED
    return code if isinstance(code, int) else DONE


def _fault(error: Exception) -> str | None:
    """In one line, a fault of the machine and of what is installed; None of certreg's own."""
    if isinstance(error, MemoryError):
        return "not enough memory for this input: use fewer points"
    library = unloaded(error)
    if library is not None:
        return printable(refusal(library, error, "this command"))
    if isinstance(error, OSError):
        return f"the output cannot be written ({error.strerror})"
    return None
