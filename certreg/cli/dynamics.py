"""Commands about the dynamics: its equilibria, and a simulated motion."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Any

import click

from certreg.cli.options import (
    CLOUD,
    EXIT_CODES,
    FOLDER,
    NUMBER,
    cloud_options,
    json_option,
    refuse_if,
)
from certreg.cli.writing import WritingCommand
from certreg.dynamics.trajectory import Record
from certreg.io.atomic import require_vacant, write_atomically, write_together
from certreg.registration.enumeration import LISTS, Enumeration, certified, equilibrium_poses
from certreg.registration.enumeration import equilibria as listed
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED
from certreg.registration.simulation import simulate as run
from certreg.report.document import dumps
from certreg.report.markup import printable
from certreg.results import Absent

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.io.pairing import Pair
    from certreg.problem.problem import RegistrationProblem


LIST_CODES = """
\b
Exit codes: 0 all are listed, proved, and one of them alone is optimal
            1 refused, or two methods disagree
            2 bad usage or input
            3 all are told, proved, and several are optimal
            4 the list is not proved complete, or which is the best is not decided
"""
TRAJECTORY = ".npz"  # the one format of a trajectory


@click.command(cls=WritingCommand, epilog=LIST_CODES)
@cloud_options
@click.option(
    "--method",
    type=click.Choice(["spectral", "groebner", "homotopy", "all"]),
    help="Eigenspaces; exact elimination; proved continuation; all there are, compared. Default: "
    "spectral, of general springs homotopy.",
)
@click.option(
    "--out",
    type=CLOUD,
    help="File for a certificate: at most four; of general springs, that these are all.",
)
@click.option("--poses", type=FOLDER, help="New or empty folder for the 4x4 pose of each.")
@json_option
def equilibria(
    problem: RegistrationProblem,
    pair: Pair,
    *,
    method: str | None,
    out: Path | None,
    poses: Path | None,
    as_json: bool,
) -> int:
    """All equilibria of the registration dynamics, with their stability."""
    del pair
    if poses is not None:
        require_vacant(poses)
    refuse_if(
        problem.motion.scales and out is not None,
        f"--out {printable(out)}: with a free scale the number of equilibria has no "
        "certificate: leave it out",
    )
    found: Any = listed(problem, method)
    if out is not None:
        _write_certificate(problem, found.enumeration, out)
    if poses is not None:
        _write_poses(found.enumeration, poses)
    click.echo(dumps(found.to_dict()) if as_json else str(found))
    return found.exit_code


def _write_certificate(
    problem: RegistrationProblem, enumeration: Enumeration[Any], out: Path
) -> None:
    """A certificate of the number or of the list, checked, or the reason for none."""
    made, place = certified(problem, enumeration), printable(out)
    if isinstance(made, Absent):
        click.echo(f"note: {place} not written: {made.reason}", err=True)
        return
    made.save(out)
    typed, subject = shlex.quote(place), LISTS[enumeration.objective.structure].subject
    click.echo(f"note: certificate of the {subject}: {place} (certreg verify {typed})", err=True)


def _write_poses(enumeration: Enumeration[Any], folder: Path) -> None:
    """One file of four rows for each equilibrium, in the order of the list."""
    poses, place = equilibrium_poses(enumeration), printable(folder)
    if not poses:
        click.echo(f"note: no poses written to {place}: no equilibrium is listed", err=True)
        return
    folder.mkdir(parents=True, exist_ok=True)
    digits = len(str(len(poses)))
    files = {
        folder / f"pose-{number:0{digits}}.txt": _rows(pose.T_target_source.tolist())
        for number, pose in enumerate(poses, start=1)
    }
    write_together(files, obsolete=())
    click.echo(f"note: {len(files)} poses written to {place}, by ascending energy", err=True)


def _rows(matrix: list[list[float]]) -> bytes:
    return ("\n".join(" ".join(map(repr, row)) for row in matrix) + "\n").encode()


@click.command(cls=WritingCommand, epilog=EXIT_CODES)
@cloud_options
@click.option(
    "--integrator",
    type=click.Choice(["euler", "midpoint", "splitting"]),
    help="Default: euler; with --springs midpoint, as euler is for one weight per pair, and with "
    "--scale asymmetric, where there is no other.",
)
@click.option("--step", type=NUMBER, help="Largest step, in the time unit of the springs.")
@click.option(
    "--out", type=CLOUD, help="File to write the trajectory to, .npz: times, states, energies."
)
@json_option
def simulate(
    problem: RegistrationProblem,
    pair: Pair,
    *,
    integrator: str | None,
    step: float | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Release the damped body at rest and see where it ends. Exit code 0 converged, 4 not."""
    del pair
    refuse_if(
        step is not None and not 0.0 < step < float("inf"),
        f"--step is {step}: give a finite number above 0",
    )
    refuse_if(
        out is not None and out.suffix.lower() != TRAJECTORY,
        f"--out {printable(out)}: a trajectory is written as {TRAJECTORY}: end the name so",
    )
    trajectory = run(problem, integrator, step=step)
    text = dumps(trajectory.to_dict()) if as_json else str(trajectory)
    if out is not None:
        write_atomically(out, Record.of(problem, trajectory).to_bytes())
    for note in trajectory.notes:
        click.echo(f"note: {note}", err=True)
    click.echo(text)
    if out is not None and not as_json:
        click.echo(f"Trajectory: {len(trajectory.times)} states written to {printable(out)}")
    return DONE if trajectory.converged else NOT_CERTIFIED
