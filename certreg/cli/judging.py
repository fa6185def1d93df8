"""Commands about answers that are there already: a certificate, a pose."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from certreg.cli.certified_clouds import bound_clouds
from certreg.cli.options import CLOUD, certificate_argument, cloud_options, json_option
from certreg.cli.progress import note
from certreg.cli.writing import WritingCommand, require_apart
from certreg.cli.wrong_pairs import WrongPairs, consensus_options
from certreg.errors import InvalidFileError
from certreg.geometry.given import GivenPose, given_pose
from certreg.geometry.pose_matrix import why_no_rotation
from certreg.io.atomic import write_atomically
from certreg.io.clouds import read_cloud
from certreg.io.poses import read_result_pose
from certreg.io.row_values import read_inliers
from certreg.io.written_clouds import write_cloud
from certreg.problem.bounds import bounded
from certreg.problem.support import Loss
from certreg.registration.assessment import judged
from certreg.registration.certification import certify
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED, REFUSED
from certreg.registration.findings import GOOD
from certreg.registration.headlines import NO_ROTATION
from certreg.registration.label_assessment import judged_labels
from certreg.report.document import dumps
from certreg.report.file_names import REPORT
from certreg.report.judged_pose import assessment_document, assessment_summary
from certreg.report.markup import printable
from certreg.report.pages import html_page
from certreg.report.reload import certified_pose, report_of
from certreg.results import PoseVerdict
from certreg.verify import Clouds, shown

if TYPE_CHECKING:
    from certreg.io.pairing import Pair
    from certreg.problem.problem import RegistrationProblem


OF_SOME = (
    "the pose was fitted to the pairs within a bound alone, and is judged here on all that are "
    "given (--pairs FILE takes some)"
)
CHECKED_BESIDE = (
    "it was fitted to the pairs within a bound alone, and certreg verify checks the certificate"
)

line_option = click.option(
    "--line",
    type=click.IntRange(min=1),
    metavar="N",
    help="Of a TUM or KITTI file: the line with the pose, counted from 1.",
)


def _something_is_judged(command: Callable[..., Any]) -> Callable[..., Any]:
    """That there is a pose or labels, said before the clouds are read."""

    @functools.wraps(command)
    def wrapped(*args: Any, pose_file: Path | None, labels_file: Path | None, **more: Any) -> Any:
        if pose_file is None and labels_file is None:
            raise click.UsageError("Missing option '--pose', or '--labels' with '--max-residual'.")
        return command(*args, pose_file=pose_file, labels_file=labels_file, **more)

    return wrapped


@click.command()
@_something_is_judged
@cloud_options
@click.option(
    "--pose",
    "pose_file",
    type=click.Path(path_type=Path),
    help="4x4 or 3x4 matrix (text, .npy), JSON, a line 'w x y z tx ty tz', TUM or KITTI, a "
    "certificate, or a folder that certify wrote.",
)
@line_option
@click.option(
    "--labels",
    "labels_file",
    type=CLOUD,
    help="Instead of --pose: which pairs are right, one 0 or 1 (outlier or inlier) per row of "
    "SOURCE, or fit.csv of certify --max-residual. Can one motion bring these within "
    "--max-residual, and are they the most? With --objective truncated: has an optimum just these "
    "within?",
)
@consensus_options
@json_option
def assess(
    problem: RegistrationProblem,
    pair: Pair,
    *,
    pose_file: Path | None,
    line: int | None,
    labels_file: Path | None,
    wrong: WrongPairs | None,
    as_json: bool,
) -> int:
    """Judge a pose, or labels, of any other tool.

    Exit code 0 if the pose is (near) optimal, one motion meets the pairs, or the optimum has just
    these, 4 not decided, else 1.
    """
    if labels_file is not None and wrong is not None and pose_file is None and line is None:
        return _told_of_labels(problem, pair, labels_file, wrong, as_json=as_json)
    if pose_file is not None and labels_file is None and wrong is not None:
        raise click.UsageError(
            "--pose is judged on all pairs, and --max-residual is for --labels: leave it out, and "
            "give the pairs that are right alone (--pairs FILE)"
        )
    if pose_file is None or labels_file is not None:
        raise click.UsageError(
            "give --pose, or --labels and --max-residual: a pose or labels are judged"
        )
    pose = read_result_pose(pose_file, line)
    if pose.of_some:
        note(f"{pose_file}: {OF_SOME}")
    registration = certify(problem, relaxation=False, simulation=False, about=pair.about)
    assessment = judged(registration, pose)
    click.echo(
        dumps(assessment_document(assessment)) if as_json else assessment_summary(assessment)
    )
    if assessment.verdict is PoseVerdict.BOUNDED:
        return NOT_CERTIFIED
    return DONE if assessment.verdict in GOOD else REFUSED


def _told_of_labels(
    problem: RegistrationProblem, pair: Pair, file: Path, wrong: WrongPairs, *, as_json: bool
) -> int:
    bounds = wrong.bounds(pair)
    labels = read_inliers(file, pair)
    pairs = bounded(problem, bounds, Loss.of(wrong.objective, bounds))
    kept = judged_labels(pairs, labels, effort=wrong.effort, about=pair.about)
    click.echo(dumps(kept.to_dict()) if as_json else str(kept))
    return kept.exit_code


@click.command(cls=WritingCommand)
@click.argument("result", type=click.Path(path_type=Path))
@click.argument("cloud", type=CLOUD)
@click.option("--out", required=True, type=CLOUD, help="File to write: .csv, .txt, .ply or .npy.")
@line_option
@click.option("--scaled", is_flag=True, help="Take a scale out of a matrix: [s R | t].")
def apply(result: Path, cloud: Path, *, out: Path, line: int | None, scaled: bool) -> int:
    """Move CLOUD by the pose in RESULT: a result file or folder, or any pose file.

    What is no rotation (a reflection, a scaling) is refused; a scale that stands beside the
    rotation, as in a result of --scale, is applied.
    """
    pose, told = _pose_to_apply(result, line)
    pose = pose.scaled_apart() if scaled else pose
    fault = why_no_rotation(pose.turn)
    if fault is not None:
        similar = " (--scaled moves by a similarity)" if "scales by" in fault else ""
        raise InvalidFileError(
            f"{shown(result)}: {NO_ROTATION.said(fault=fault)}{similar}", path=result
        )
    scale = "" if pose.scale is None else f", scaled by {pose.scale:.15g}"
    points = read_cloud(cloud, noise=False)
    if points.ignored:
        left = f"columns not moved and not written: {printable(', '.join(points.ignored))}"
        click.echo(f"note: {printable(cloud)}: {left}", err=True)
    write_cloud(out, points.points, points.labels, move=pose.apply)
    header = _header_words(out, labelled=points.labels is not None)
    click.echo(f"{len(points.points)} points written to {printable(out)}{scale}{header}")
    click.echo(told)
    return DONE


def _pose_to_apply(result: Path, line: int | None) -> tuple[GivenPose, str]:
    """The pose in a file, and a sentence on what it is worth.

    A certificate holds a rotation alone: the translation is that of the points in it.
    """
    pose = read_result_pose(result, line)
    if pose.translation is not None:
        told = CHECKED_BESIDE if pose.of_some else "certreg assess judges it"
        return pose, f"The pose is as {printable(result)} has it, unchecked: {told}."
    found = given_pose(certified_pose(result))
    return found, f"The pose is computed anew from {printable(result)}, which the checker accepts."


def _header_words(out: Path, *, labelled: bool) -> str:
    """The header of what was written, if it has one; or that its labels are left out."""
    if out.suffix.lower() == ".csv":
        return f" (header: {'label,' if labelled else ''}x,y,z)"
    return " without their labels: a .csv file keeps them" if labelled else ""


@click.command(
    cls=WritingCommand,
    epilog="Exit code 0 when the report was written, 1 if the checker refuses, else 2.",
)
@certificate_argument
@bound_clouds(lightly=False)
@click.option("--out", type=CLOUD, help="File to write; default: report.html beside CERTIFICATE.")
def report(
    certificate: Path,
    *,
    clouds: RegistrationProblem | Clouds | None,
    out: Path | None,
) -> int:
    """One HTML file that shows the registration and its proof, for any browser, offline.

    CERTIFICATE, a file or the folder that certify --out wrote, is checked first. All else is
    computed anew: the motion with the damping and the integrator that it names. More than a million
    points are not in it: give SOURCE and TARGET. Where they are given it must be about exactly
    these, as for `certreg verify`.
    """
    place = certificate.with_name(REPORT) if out is None else out
    require_apart(place, [certificate])
    write_atomically(place, html_page(report_of(certificate, clouds, noted=note)))
    click.echo(f"{printable(place)}: open it in a browser; it needs no network")
    return DONE
