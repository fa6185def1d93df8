"""The command that re-checks a certificate: without NumPy where the clouds are text, or none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from certreg.certificate.checking import verify as checked
from certreg.certificate.checking import verify_lines, verify_with_coq
from certreg.cli.certified_clouds import bound_clouds
from certreg.cli.options import CLOUD, NUMBER, certificate_argument, refuse_if
from certreg.cli.writing import WritingCommand
from certreg.registration.exit_codes import DONE, REFUSED

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.problem.problem import RegistrationProblem
    from certreg.verify import Clouds


@click.command(cls=WritingCommand)
@certificate_argument
@bound_clouds(lightly=True)
@click.option(
    "--max-angle",
    metavar="RAD",
    type=NUMBER,
    help="Refuse unless all optima are proved to be within this angle of the pose.",
)
@click.option(
    "--max-gap",
    metavar="SHARE",
    type=NUMBER,
    help="Refuse unless the gap is proved to be at most this share of the range of energies.",
)
@click.option(
    "--max-undecided",
    metavar="K",
    type=click.IntRange(min=0),
    help="Refuse where more than K pairs that may be wrong have no proved label.",
)
@click.option("--coq", is_flag=True, help="Let Coq decide, by the proofs in derivations/coq.")
@click.option("--out", type=CLOUD, help="With --coq: keep the file given to Coq, .v.")
def verify(
    certificate: Path,
    *,
    clouds: RegistrationProblem | Clouds | None,
    max_angle: float | None,
    max_gap: float | None,
    max_undecided: int | None,
    coq: bool,
    out: Path | None,
) -> int:
    """Re-check a certificate in exact arithmetic: VERIFIED, or REFUSED with the reason.

    CERTIFICATE is a file, or the folder that certify --out wrote. With SOURCE and TARGET it must
    also be about exactly those points, paired and weighted as they were: of weight 1 without
    --sigma, --weights or --any-weight. With --coq, Coq's kernel checks it instead, by a checker
    that is proved correct. Of a .jsonl file, with a certificate a line, the refused lines are told,
    and how many of them are verified.
    """
    refuse_if(out is not None and not coq, "--out goes with --coq")
    limits: dict[str, Any] = {
        "max_angle": max_angle,
        "max_gap": max_gap,
        "max_undecided": max_undecided,
    }
    refuse_if(
        coq and any(limit is not None for limit in limits.values()),
        "--max-angle, --max-gap, --max-undecided go without --coq: it decides on the claims",
    )
    if certificate.suffix == ".jsonl":
        refuse_if(
            coq or clouds is not None,
            "a file of many certificates goes without SOURCE TARGET and --coq",
        )
        return verify_lines(certificate, **limits)
    if coq:
        verdict = verify_with_coq(certificate, clouds, out=out)
    else:
        verdict = checked(certificate, clouds, **limits)
    click.echo(verdict)
    return DONE if verdict.proved else REFUSED
