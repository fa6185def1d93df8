"""The command line: `certreg COMMAND`. Thin: it reads, calls, prints, and sets the exit code.

Only click and the standard library are imported here, so that `--help` and `verify` load no
numerical library; everything else is imported by the command that needs it.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from certreg import __version__
from certreg.errors import (
    CertregError,
    ContradictionError,
    RefusedCertificateError,
    UndecidedError,
)
from certreg.options import (
    CLOUD,
    FOLDER,
    cloud_options,
    pairing_options,
    printable,
    warnings_as_notes,
)

if TYPE_CHECKING:
    from certreg.io.clouds import Pairing
    from certreg.problem import RegistrationProblem
    from certreg.verify import Clouds

PACKAGES = (
    *("numpy", "scipy", "sympy", "casadi", "python-flint"),
    *("click", "cvxpy-base", "clarabel"),
)
DONE, REFUSED, MISUSED, NOT_UNIQUE, NOT_CERTIFIED = 0, 1, 2, 3, 4
EXIT_CODES = """
\b
Exit codes: 0 done and proved
            1 refused, or two roads disagree
            2 bad usage or input
            3 certified, but the optimum is not unique
            4 solved, but not certified, or the simulation did not converge
"""


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
    except (ContradictionError, RefusedCertificateError) as error:
        click.echo(f"certreg: {printable(error)}", err=True)
        sys.exit(REFUSED)
    except UndecidedError as error:
        click.echo(f"certreg: {printable(error)}", err=True)
        sys.exit(NOT_CERTIFIED)
    except CertregError as error:
        click.echo(f"certreg: {printable(error)}", err=True)
        sys.exit(MISUSED)
    except BrokenPipeError:
        sys.exit(DONE)
    except OSError as error:
        click.echo(f"certreg: the output cannot be written ({error.strerror})", err=True)
        sys.exit(MISUSED)
    except MemoryError:
        click.echo("certreg: not enough memory for this input: use fewer points", err=True)
        sys.exit(MISUSED)
    sys.exit(code if isinstance(code, int) else DONE)


@cli.command(epilog=EXIT_CODES)
@cloud_options
@click.option("--no-relaxation", is_flag=True, help="Leave the semidefinite relaxation out.")
@click.option("--no-simulation", is_flag=True, help="Leave the simulation out.")
@click.option("--out", type=FOLDER, help="Folder to write to.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def certify(
    problem: RegistrationProblem,
    source: Path,
    target: Path,
    *,
    no_relaxation: bool,
    no_simulation: bool,
    out: Path | None,
    as_json: bool,
) -> int:
    """Register SOURCE to TARGET and certify the result."""
    from certreg.pipeline import certify as run
    from certreg.report.document import dumps, result_document
    from certreg.report.folder import write_folder
    from certreg.report.summary import registration_summary
    from certreg.results import Optimality

    about = {"certreg": __version__, "source": source.name, "target": target.name}
    registration = run(
        problem, relaxation=not no_relaxation, simulation=not no_simulation, about=about
    )
    path = None if out is None else write_folder(registration, out)
    if as_json:
        document = result_document(registration, None if path is None else str(path))
        click.echo(dumps(document))
    else:
        click.echo(registration_summary(registration))
        if path is not None:
            place = printable(path)
            click.echo(f"\nCertificate: {place}  (re-check it: certreg verify {place})")
    trajectory = registration.solution.trajectory
    if trajectory is not None and not trajectory.converged:
        return NOT_CERTIFIED
    return {
        Optimality.CERTIFIED: DONE,
        Optimality.CERTIFIED_NOT_UNIQUE: NOT_UNIQUE,
        Optimality.NOT_CERTIFIED: NOT_CERTIFIED,
    }[registration.status]


@cli.command()
@cloud_options
@click.option(
    "--pose",
    "pose_file",
    required=True,
    type=CLOUD,
    help="4x4 text matrix, JSON, or 'w x y z tx ty tz'.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def assess(
    problem: RegistrationProblem, source: Path, target: Path, *, pose_file: Path, as_json: bool
) -> int:
    """Judge a pose that any other tool returned. Exit code 0 if it is optimal, else 1."""
    from certreg.assessment import assess as run
    from certreg.io.poses import read_pose
    from certreg.report.document import assessment_document, dumps
    from certreg.report.summary import assessment_summary
    from certreg.results import PoseVerdict

    del source, target
    pose = read_pose(pose_file)
    assessment = run(problem, pose.turn, pose.translation)
    click.echo(
        dumps(assessment_document(assessment)) if as_json else assessment_summary(assessment)
    )
    return DONE if assessment.verdict is PoseVerdict.OPTIMAL else REFUSED


@cli.command()
@cloud_options
@click.option(
    "--method",
    type=click.Choice(["spectral", "groebner", "homotopy", "all"]),
    default="spectral",
    show_default=True,
    help="Eigenspaces; exact elimination; proved continuation; all three, compared.",
)
@click.option("--out", type=CLOUD, help="File for a certificate of the count: at most four.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def equilibria(
    problem: RegistrationProblem,
    source: Path,
    target: Path,
    *,
    method: str,
    out: Path | None,
    as_json: bool,
) -> int:
    """All equilibria of the registration dynamics, with their stability."""
    from certreg.pipeline import equilibria as run
    from certreg.pipeline import equilibrium_roads, road_equilibria
    from certreg.report.document import dumps, equilibria_document
    from certreg.report.roads import roads_summary
    from certreg.report.summary import equilibria_words

    del source, target
    roads = equilibrium_roads(problem) if method == "all" else None
    found = run(problem, method) if roads is None else road_equilibria(problem, roads.roads[0])
    if out is not None:
        _write_count(problem, out)
    if as_json:
        click.echo(dumps(equilibria_document(found, roads)))
    else:
        click.echo(equilibria_words(found))
        if roads is not None:
            click.echo(f"\n{roads_summary(roads)}")
    if not found.complete:
        return NOT_CERTIFIED
    return DONE if found.classification.unique else NOT_UNIQUE


def _write_count(problem: RegistrationProblem, out: Path) -> None:
    """A certificate that there are at most four equilibria, checked, or the reason for none."""
    from certreg.pipeline import certified_count

    certificate = certified_count(problem)
    if certificate is None:
        click.echo(f"note: {printable(out)} not written: there are infinitely many", err=True)
        return
    certificate.save(out)
    place = printable(out)
    click.echo(f"note: certificate of the count: {place} (certreg verify {place})", err=True)


@cli.command(epilog=EXIT_CODES)
@cloud_options
@click.option(
    "--integrator",
    type=click.Choice(["euler", "midpoint", "splitting"]),
    default="euler",
    show_default=True,
)
@click.option("--step", type=float, help="Largest step, in the time unit of the springs.")
@click.option("--out", type=CLOUD, help="File to write the trajectory to: .npz.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def simulate(
    problem: RegistrationProblem,
    source: Path,
    target: Path,
    *,
    integrator: str,
    step: float | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Release the damped body at rest and see where it ends. Exit code 0 converged, 4 not."""
    from certreg.files import write_atomically
    from certreg.io.npy import trajectory_bytes
    from certreg.pipeline import simulated
    from certreg.report.document import dumps, simulation_document
    from certreg.report.summary import simulation_summary

    del source, target
    if step is not None and not 0.0 < step < float("inf"):
        message = f"--step is {step}: give a finite number above 0"
        raise click.UsageError(message)
    end = simulated(problem, integrator, step=step)
    if out is not None:
        write_atomically(out, trajectory_bytes(end.trajectory))
    document = simulation_document(end)
    click.echo(dumps(document) if as_json else simulation_summary(end, document["energy"]))
    return DONE if end.trajectory.converged else NOT_CERTIFIED


@cli.command()
@click.argument("certificate", type=CLOUD)
@click.argument("clouds", type=CLOUD, nargs=-1, metavar="[SOURCE TARGET]")
@click.option("--sigma", type=float, help="With SOURCE TARGET: the noise that was certified.")
@click.option("--weights", type=CLOUD, help="With SOURCE TARGET: the weights that were certified.")
@pairing_options
def verify(
    certificate: Path,
    clouds: tuple[Path, ...],
    *,
    sigma: float | None,
    weights: Path | None,
    pairing: Pairing | None,
) -> int:
    """Re-check a certificate in exact arithmetic: VERIFIED, or REFUSED with the reason.

    With SOURCE and TARGET it must also be about exactly those points, paired as they were.
    """
    from certreg.certificate.checking import verify as check

    told = sigma is not None or weights is not None or pairing is not None
    if len(clouds) not in {0, 2} or (told and not clouds):
        message = "give SOURCE and TARGET, or neither; the options go with them"
        raise click.UsageError(message)
    given, notes = None, list[str]()
    if clouds:
        given, notes = _clouds_to_bind(*clouds, sigma=sigma, weights=weights, pairing=pairing)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    verdict = check(certificate, given)
    for theorem in verdict.theorems:
        click.echo(theorem)
    click.echo("VERIFIED" if verdict.proved else f"REFUSED: {verdict.words}")
    return DONE if verdict.proved else REFUSED


def _clouds_to_bind(
    source: Path,
    target: Path,
    *,
    sigma: float | None,
    weights: Path | None,
    pairing: Pairing | None,
) -> tuple[RegistrationProblem | Clouds, list[str]]:
    """What a certificate must be about, and notes; NumPy is loaded only where it is needed."""
    from certreg.io.text import TEXT_FORMATS, read_clouds
    from certreg.verify import Clouds

    files = (source, target) if weights is None else (source, target, weights)
    if pairing is None and all(file.suffix.lower() in TEXT_FORMATS for file in files):
        return read_clouds(source, target, sigma=sigma, weights=weights)
    from array import array

    from certreg.io.clouds import BY_LABEL, read_problem

    problem, pair = read_problem(
        source, target, sigma=sigma, weights=weights, pairing=pairing or BY_LABEL
    )
    if sigma is not None or weights is not None:
        return problem, pair.notes
    # as with text clouds: the weights are the certificate's own
    points = (array("d", side.tobytes()) for side in (problem.source, problem.target))
    return Clouds(*points), pair.notes


@cli.command()
@click.argument("result", type=click.Path(path_type=Path))
@click.argument("cloud", type=CLOUD)
@click.option("--out", required=True, type=CLOUD, help="File to write: .csv, .txt, .ply or .npy.")
def apply(result: Path, cloud: Path, *, out: Path) -> int:
    """Move CLOUD by the pose in RESULT: a result file or folder, or any pose file."""
    from certreg.io.clouds import read_cloud, write_cloud
    from certreg.io.poses import read_result_pose

    pose, points = read_result_pose(result), read_cloud(cloud)
    write_cloud(out, pose.apply(points.points), points.labels)
    click.echo(f"{len(points.points)} points written to {printable(out)}")
    return DONE


@cli.command(epilog="Exit code 0 when every problem came out as told, else 1.")
@click.option(
    "--out",
    type=FOLDER,
    default=Path("certreg-demo"),
    show_default=True,
    help="Folder to write to.",
)
def demo(out: Path) -> int:
    """The main job on packaged real data: survey, electrodes, protein."""
    from certreg.demo import STORIES, differences, tell
    from certreg.report.folder import write_folder
    from certreg.report.summary import registration_summary
    from certreg.verify import shown

    code = DONE
    for story in STORIES:
        registration = tell(story)
        path = write_folder(registration, out / story.name)
        click.echo(f"=== {story.title}\n\n{story.told}\n\n{registration_summary(registration)}\n")
        for difference in differences(story, registration):
            click.echo(f"NOT AS TOLD: {difference}", err=True)
            code = REFUSED
        click.echo(f"  certificate: {path}\n")
    click.echo("Every certificate above was accepted by the checker. Check them yourself:")
    certificate = shown(out / STORIES[0].name / "certificate.json")
    click.echo(f"  {shown(sys.argv[0])} verify {certificate}")
    click.echo("or, with nothing but Python, anywhere:")
    click.echo(f"  python3 -I -S {shown(Path(__file__).with_name('verify.py'))} {certificate}")
    return code


@cli.command()
@click.argument("names", nargs=-1, metavar="[CLAIM]...")
@click.option("--out", type=FOLDER, help="Folder for the LaTeX of the claims and the generated C.")
def derive(names: tuple[str, ...], out: Path | None) -> int:
    """Prove the derivations anew: every claim, or the ones named. Exit code 1 if one fails.

    Each claim prints its verdict, how many steps were checked, how many mutated statements were
    refuted, and the time. Then the claims of the paper, with theirs.
    """
    from certreg import derivation
    from certreg.report.claims import audit_lines, claim_line, closing_line

    found: list[Any] = []
    for outcome in derivation.outcomes(names):
        click.echo(claim_line(outcome))
        found.append(outcome)
    audited = [] if names else derivation.audit(found)
    for line in audit_lines(audited):
        click.echo(line)
    click.echo(closing_line(found, audited))
    if out is not None:
        derivation.write_latex(found, out)
        derivation.write_code(out)
    return DONE if derivation.all_hold(found, audited) else REFUSED


@cli.command()
@click.option("--out", type=FOLDER, required=True, help="Folder to write to.")
def codegen(out: Path) -> int:
    """Write the generated C of the dynamics with its header and a test program, to embed."""
    from certreg.embedding import write_sources

    for path in write_sources(out):
        click.echo(path)
    return DONE


@cli.command()
def info() -> int:
    """Versions of what certreg runs on."""
    import platform
    from importlib.metadata import version

    from certreg.native.engine import engine

    click.echo(f"certreg      {__version__}")
    click.echo(f"Python       {platform.python_version()} ({platform.python_implementation()})")
    click.echo(f"system       {platform.system()} {platform.machine()}")
    for package in PACKAGES:
        click.echo(f"{package:12} {version(package)}")
    click.echo(f"simulation   {engine().words}")
    click.echo("checker      exact integers of Python itself")
    return DONE
