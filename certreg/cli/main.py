"""The command line: `certreg COMMAND`. Thin: it reads, calls, prints, and sets the exit code.

Only click and the standard library are imported here, so that `--help` and `verify` load no
numerical library; everything else is imported by the command that needs it.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from certreg import __version__
from certreg.cli.campaigns import batch
from certreg.cli.derivations import codegen, derive, info
from certreg.cli.dynamics import equilibria, simulate
from certreg.cli.judging import apply, assess, report, verify
from certreg.cli.options import EXIT_CODES, warnings_as_notes
from certreg.cli.registering import certify, demo
from certreg.cli.reproducing import reproduce
from certreg.errors import CertregError
from certreg.registration import DONE, MISUSED, code_of_error
from certreg.report import printable

if TYPE_CHECKING:
    from typing import NoReturn


@click.group(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog=EXIT_CODES,
)
@click.version_option(__version__, prog_name="certreg")
def cli() -> None:
    """Certified registration of corresponding 3D point clouds.

    Finds the rigid motion that takes SOURCE to TARGET, all other equilibria of the registration
    dynamics, and a certificate of global optimality that anyone can check.
    """


COMMANDS = (
    *(certify, assess, verify, report, equilibria, simulate, apply, batch),
    *(demo, reproduce, derive, codegen, info),
)
for command in COMMANDS:
    cli.add_command(command)


def main() -> NoReturn:
    """Run the command line; bad input is one line on stderr, never a traceback."""
    try:
        with warnings_as_notes():
            code = cli.main(prog_name="certreg", standalone_mode=False)
    except click.exceptions.Abort:
        click.echo("interrupted", err=True)
        sys.exit(130)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except CertregError as error:
        click.echo(f"certreg: {printable(error)}", err=True)
        sys.exit(code_of_error(error))
    except BrokenPipeError:
        sys.exit(DONE)
    except OSError as error:
        click.echo(f"certreg: the output cannot be written ({error.strerror})", err=True)
        sys.exit(MISUSED)
    except MemoryError:
        click.echo("certreg: not enough memory for this input: use fewer points", err=True)
        sys.exit(MISUSED)
    sys.exit(code if isinstance(code, int) else DONE)
