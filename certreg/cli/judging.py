"""Commands about answers that are there already: a certificate, a pose."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from certreg.cli.options import CLOUD, cloud_options, pairing_options
from certreg.registration import DONE, REFUSED
from certreg.report import printable

if TYPE_CHECKING:
    from certreg.io import Pair, Pairing
    from certreg.problem import RegistrationProblem
    from certreg.verify import Clouds


@click.command()
@cloud_options
@click.option(
    "--pose",
    "pose_file",
    required=True,
    type=click.Path(path_type=Path),
    help="4x4 text matrix, JSON, 'w x y z tx ty tz', or a folder that certify wrote.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def assess(problem: RegistrationProblem, pair: Pair, *, pose_file: Path, as_json: bool) -> int:
    """Judge a pose that any other tool returned. Exit code 0 if it is optimal, else 1."""
    from certreg.io import read_result_pose
    from certreg.registration import assess as run
    from certreg.report import assessment_document, assessment_summary, dumps
    from certreg.results import PoseVerdict

    del pair
    pose = read_result_pose(pose_file)
    assessment = run(problem, pose.turn, pose.translation)
    click.echo(
        dumps(assessment_document(assessment)) if as_json else assessment_summary(assessment)
    )
    return DONE if assessment.verdict is PoseVerdict.OPTIMAL else REFUSED


@click.command()
@click.argument("certificate", type=CLOUD)
@click.argument("clouds", type=CLOUD, nargs=-1, metavar="[SOURCE TARGET]")
@click.option("--sigma", type=float, help="With SOURCE TARGET: the noise that was certified.")
@click.option("--weights", type=CLOUD, help="With SOURCE TARGET: the weights that were certified.")
@pairing_options
@click.option("--coq", is_flag=True, help="Let Coq decide, by the proofs in derivations/coq.")
@click.option("--out", type=CLOUD, help="With --coq: keep the file given to Coq, .v.")
def verify(
    certificate: Path,
    clouds: tuple[Path, ...],
    *,
    sigma: float | None,
    weights: Path | None,
    pairing: Pairing | None,
    coq: bool,
    out: Path | None,
) -> int:
    """Re-check a certificate in exact arithmetic: VERIFIED, or REFUSED with the reason.

    With SOURCE and TARGET it must also be about exactly those points, paired as they were.
    With --coq, Coq's kernel checks it instead, by a checker that is proved correct.
    """
    from certreg.certificate import verify as check
    from certreg.certificate import verify_with_coq

    told = sigma is not None or weights is not None or pairing is not None
    if len(clouds) not in {0, 2} or (told and not clouds):
        message = "give SOURCE and TARGET, or neither; the options go with them"
        raise click.UsageError(message)
    if out is not None and not coq:
        message = "--out goes with --coq"
        raise click.UsageError(message)
    given, notes = None, list[str]()
    if clouds:
        given, notes = _clouds_to_bind(*clouds, sigma=sigma, weights=weights, pairing=pairing)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    verdict = verify_with_coq(certificate, given, out=out) if coq else check(certificate, given)
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
    from certreg.io import TEXT_FORMATS, read_clouds
    from certreg.verify import INLINE_MAX, Clouds

    files = (source, target) if weights is None else (source, target, weights)
    if pairing is None and all(file.suffix.lower() in TEXT_FORMATS for file in files):
        return read_clouds(source, target, sigma=sigma, weights=weights)
    from array import array

    from certreg.io import BY_LABEL, read_problem

    problem, pair = read_problem(
        source, target, sigma=sigma, weights=weights, pairing=pairing or BY_LABEL
    )
    if sigma is not None or weights is not None or problem.n > INLINE_MAX:
        return problem, pair.notes
    # as with text clouds: the weights are the certificate's own
    points = problem.block(slice(None))
    sides = (array("d", side.tobytes()) for side in (points.source, points.target))
    return Clouds(*sides), pair.notes


@click.command()
@click.argument("result", type=click.Path(path_type=Path))
@click.argument("cloud", type=CLOUD)
@click.option("--out", required=True, type=CLOUD, help="File to write: .csv, .txt, .ply or .npy.")
def apply(result: Path, cloud: Path, *, out: Path) -> int:
    """Move CLOUD by the pose in RESULT: a result file or folder, or any pose file.

    What is no rotation (a reflection, a scaling) is refused.
    """
    from certreg.errors import InvalidFileError
    from certreg.io import read_cloud, read_result_pose, write_cloud
    from certreg.registration import why_no_rotation
    from certreg.results import PoseVerdict
    from certreg.settings import AssessmentSettings
    from certreg.verify import shown

    pose = read_result_pose(result)
    fault = why_no_rotation(pose.turn, AssessmentSettings().rotation_tolerance)
    if fault is not None:
        message = f"{shown(result)}: {PoseVerdict.NOT_A_ROTATION.value.upper()}. {fault}"
        raise InvalidFileError(message)
    points = read_cloud(cloud)
    write_cloud(out, points.points, points.labels, move=pose.apply)
    click.echo(f"{len(points.points)} points written to {printable(out)}")
    return DONE


@click.command(epilog="Exit code 0 when the report was written, 1 if the checker refuses, else 2.")
@click.argument("certificate", type=CLOUD)
@click.option("--out", type=CLOUD, help="File to write; default: report.html beside CERTIFICATE.")
def report(certificate: Path, *, out: Path | None) -> int:
    """One HTML file that shows the registration and its proof, for any browser, offline.

    CERTIFICATE is checked first. The simulated motion is taken from the files that certify wrote
    beside it, if they belong to it, and computed anew otherwise.
    """
    from certreg.cli.progress import note
    from certreg.errors import InvalidFileError
    from certreg.io import write_atomically
    from certreg.report import REPORT, html_page, report_of

    place = certificate.with_name(REPORT) if out is None else out
    if place.exists() and certificate.exists() and place.samefile(certificate):
        message = f"{printable(place)}: is the certificate itself: give another --out"
        raise InvalidFileError(message)
    write_atomically(place, html_page(report_of(certificate, note)))
    click.echo(f"{printable(place)}: open it in a browser; it needs no network")
    return DONE
