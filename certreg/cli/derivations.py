"""The command that proves the derivations anew."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from certreg._loading import require
from certreg.cli.options import FOLDER, refuse_if
from certreg.paper.derivation import (
    all_hold,
    audit,
    audit_lines,
    chapters,
    chapters_text,
    claim_line,
    closing_line,
    outcomes,
    write_code,
    write_latex,
)
from certreg.registration.exit_codes import DONE, REFUSED

if TYPE_CHECKING:
    from pathlib import Path


@click.command()
@click.argument("names", nargs=-1, metavar="[CLAIM]...")
@click.option("--out", type=FOLDER, help="Folder for the LaTeX of the claims and the generated C.")
@click.option("--list", "listing", is_flag=True, help="Print the names of all claims, no more.")
def derive(names: tuple[str, ...], out: Path | None, *, listing: bool) -> int:
    """Prove the derivations anew: every claim, or the ones named. Exit code 1 if one fails.

    Each claim prints its verdict, how many steps were checked, how many mutated statements were
    refuted, how many hypotheses are needed, and the time. Then the claims of the paper, with
    theirs.
    """
    if listing:
        refuse_if(names or out is not None, "--list goes with nothing else")
        click.echo(chapters_text(chapters()))
        return DONE
    if out is not None:
        require("casadi", purpose="derive --out")
    proofs: list[Any] = []
    for outcome in outcomes(names):
        click.echo(claim_line(outcome))
        proofs.append(outcome)
    audited = [] if names else audit(proofs)
    for line in audit_lines(audited):
        click.echo(line)
    click.echo(closing_line(proofs, audited))
    if out is not None:
        write_latex(proofs, out)
        write_code(out)
    return DONE if all_hold(proofs, audited) else REFUSED
