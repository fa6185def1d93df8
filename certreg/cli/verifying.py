"""The command that re-checks a certificate: without NumPy where the clouds are text, or none."""

from __future__ import annotations

from array import array
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from certreg import io  # its names that load NumPy are asked of it where they are needed
from certreg.certificate import verify as checked
from certreg.certificate import verify_with_coq
from certreg.cli.options import CLOUD, bound_clouds
from certreg.io import TEXT_FORMATS, read_clouds
from certreg.registration import DONE, REFUSED
from certreg.verify import INLINE_MAX, Clouds

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.io import Pairing
    from certreg.problem import RegistrationProblem


@click.command()
@click.argument("certificate", type=CLOUD)
@bound_clouds
@click.option(
    "--any-weight",
    is_flag=True,
    help="With SOURCE TARGET: whatever weight was certified, as long as all pairs have the same.",
)
@click.option(
    "--max-angle",
    metavar="RAD",
    type=float,
    help="Refuse unless all optima are proved to be within this angle of the pose.",
)
@click.option(
    "--max-gap",
    metavar="SHARE",
    type=float,
    help="Refuse unless the gap is proved to be at most this share of the range of energies.",
)
@click.option("--coq", is_flag=True, help="Let Coq decide, by the proofs in derivations/coq.")
@click.option("--out", type=CLOUD, help="With --coq: keep the file given to Coq, .v.")
def verify(
    certificate: Path,
    *,
    clouds: tuple[Path, ...],
    sigma: float | None,
    weights: Path | None,
    pairing: Pairing | None,
    any_weight: bool,
    max_angle: float | None,
    max_gap: float | None,
    coq: bool,
    out: Path | None,
) -> int:
    """Re-check a certificate in exact arithmetic: VERIFIED, or REFUSED with the reason.

    With SOURCE and TARGET it must also be about exactly those points, paired and weighted as they
    were: of weight 1 without --sigma, --weights or --any-weight. With --coq, Coq's kernel
    checks it instead, by a checker that is proved correct.
    """
    if out is not None and not coq:
        message = "--out goes with --coq"
        raise click.UsageError(message)
    if coq and not (max_angle is None and max_gap is None):
        message = "--max-angle and --max-gap go without --coq, which decides on the claims alone"
        raise click.UsageError(message)
    if any_weight and (not clouds or sigma is not None or weights is not None):
        message = "--any-weight goes with SOURCE TARGET, without --sigma and --weights"
        raise click.UsageError(message)
    given, notes = None, list[str]()
    if clouds:
        given, notes = _clouds_to_bind(*clouds, sigma=sigma, weights=weights, pairing=pairing)
    if any_weight:
        if not isinstance(given, Clouds):  # its digest is of the weights, too
            message = f"--any-weight is for {INLINE_MAX} points at most: give --sigma"
            raise click.UsageError(message)
        given = replace(given, any_weight=True)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    if coq:
        verdict = verify_with_coq(certificate, given, out=out)
    else:
        verdict = checked(certificate, given, max_angle=max_angle, max_gap=max_gap)
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
    files = (source, target) if weights is None else (source, target, weights)
    if pairing is None and all(file.suffix.lower() in TEXT_FORMATS for file in files):
        return read_clouds(source, target, sigma=sigma, weights=weights)
    problem, pair = io.read_problem(
        source, target, sigma=sigma, weights=weights, pairing=pairing or io.BY_LABEL
    )
    weighed = sigma is not None or weights is not None or pair.weighed
    if weighed or problem.n > INLINE_MAX:
        return problem, pair.notes
    # as with text clouds: a certificate of another weight is told which
    points = problem.block(slice(None))
    source_doubles = array("d", points.source.tobytes())
    return Clouds(source_doubles, array("d", points.target.tobytes())), pair.notes
