"""Commands about one registration: certify it, and see the packaged ones."""

from __future__ import annotations

import shlex
import sys
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from certreg import __version__
from certreg._loading import late
from certreg.cli.options import (
    EXIT_CODES,
    FOLDER,
    NUMBER,
    cloud_options,
    fit_options,
    json_option,
    limit_options,
    refuse_if,
)
from certreg.cli.writing import WritingCommand
from certreg.cli.wrong_pairs import WrongPairs, consensus_options
from certreg.registration.certification import certify as certified
from certreg.registration.examples import STORIES, differences, tell
from certreg.registration.exit_codes import DONE, REFUSED, FitDemands, code_of_demands
from certreg.registration.robustness import ROBUSTNESS_ANGLE
from certreg.report.file_names import FILES, REPORT
from certreg.report.markup import printable
from certreg.verify import shown

if TYPE_CHECKING:
    from certreg.io.pairing import Pair
    from certreg.problem.problem import RegistrationProblem
    from certreg.report import document, folder, pair_fields, summary
else:
    document = late("certreg.report.document")
    folder = late("certreg.report.folder")
    pair_fields = late("certreg.report.pair_fields")
    summary = late("certreg.report.summary")


@click.command(cls=WritingCommand, files=FILES, epilog=EXIT_CODES)
@cloud_options
@limit_options
@fit_options
@consensus_options
@click.option("--no-relaxation", is_flag=True, help="Leave the semidefinite relaxation out.")
@click.option(
    "--solver",
    metavar="NAME",
    help="Of the relaxation: one that CVXPY finds installed, SCS for example. Default: Clarabel, "
    "without CVXPY; with --max-residual no relaxation.",
)
@click.option(
    "--no-simulation",
    is_flag=True,
    help="Leave the simulation out. With general springs there is none.",
)
@click.option(
    "--integrator",
    type=click.Choice(["euler", "midpoint", "splitting"]),
    help="Of the simulation. Default: splitting; with --scale asymmetric midpoint, the only one; "
    "with --max-residual no simulation.",
)
@click.option(
    "--robustness-angle",
    type=NUMBER,
    metavar="DEG",
    default=ROBUSTNESS_ANGLE,
    show_default=True,
    help="Prove how far the points may be off with the optimum within this angle, at most 90.",
)
@click.option("--out", type=FOLDER, help="Folder to write to.")
@json_option
def certify(
    problem: RegistrationProblem,
    pair: Pair,
    *,
    no_relaxation: bool,
    solver: str | None,
    no_simulation: bool,
    integrator: str | None,
    max_gap: float,
    max_angle: float,
    robustness_angle: float,
    demands: FitDemands,
    wrong: WrongPairs | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Register SOURCE to TARGET and certify the result."""
    refuse_if(
        no_relaxation and solver is not None,
        "--solver goes with the relaxation, which --no-relaxation leaves out",
    )
    about = {"certreg": __version__, **pair.about}
    asked: dict[str, Any] = {} if wrong is None else wrong.asked(pair)
    result: Any = certified(
        problem,
        relaxation=solver or not no_relaxation,
        simulation=not no_simulation and (integrator or True),
        about=about,
        max_gap=max_gap,
        max_angle=max_angle,
        robustness_angle=robustness_angle,
        **asked,
    )
    path = None
    if out is not None:
        path = folder.write_folder(result, out, notes=pair.notes)
    if as_json:
        stated = pair_fields.document_of(result, path and str(path), notes=pair.notes)
        click.echo(document.dumps(stated))
    else:
        click.echo(result.summary())
        if path is not None:
            _tell_files(path)
    warned = bool((result.fit if wrong is None else result).warnings)
    unmet = demands.unmet(result.rmse, warned=warned)
    for words in unmet:
        click.echo(f"certreg: {words}: exit code 4", err=True)
    return code_of_demands(result.exit_code, unmet)


def _tell_files(certificate: Path) -> None:
    """Where the certificate and the page are, and what to type to check it again."""
    place, page = printable(certificate), certificate.with_name(REPORT)
    click.echo(f"\nCertificate: {place}  (re-check it: certreg verify {shlex.quote(place)})")
    if page.exists():
        click.echo(f"Report: {printable(page)}  (open it in a browser)")


@click.command(epilog="Exit code 0 when every problem came out as told, else 1.")
@click.option(
    "--out",
    type=FOLDER,
    default=Path("certreg-demo"),
    show_default=True,
    help="Folder to write to.",
)
def demo(out: Path) -> int:
    """The main job on packaged real data: survey, electrodes, protein."""
    code = DONE
    for story in STORIES:
        registration = tell(story)
        path = folder.write_folder(registration, out / story.name)
        click.echo(
            f"=== {story.title}\n\n{story.told}\n\n{summary.registration_summary(registration)}\n"
        )
        for difference in differences(story, registration):
            click.echo(f"NOT AS TOLD: {difference}", err=True)
            code = REFUSED
        click.echo(f"  certificate: {path}")
        if path is not None:
            click.echo(f"  report:      {path.with_name(REPORT)}\n")
    certificate = shlex.quote(shown(out / STORIES[0].name / "certificate.json"))
    program = shlex.quote(shown(Path(str(files("certreg") / "verify.py"))))
    click.echo(
        "Every certificate above was accepted by the checker. Check them yourself:\n"
        f"  {_own_name()} verify {certificate}\n"
        "or, with nothing but Python, anywhere:\n"
        f"  python3 -I -S {program} {certificate}"
    )
    return code


def _own_name() -> str:
    """What to type to run this program again: `python -m certreg` runs a file that cannot run."""
    program = sys.argv[0]
    if Path(program).name == "__main__.py":
        return f"{shlex.quote(shown(sys.executable))} -m certreg"
    return shlex.quote(shown(program))
