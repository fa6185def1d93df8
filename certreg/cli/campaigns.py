"""Commands over many registrations, on this machine or a cluster."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from certreg.campaign.listing import read_listing
from certreg.campaign.pairs import RESULTS, TABLES, PairCampaign, Tally, write_pair_results
from certreg.campaign.runner import Campaign, completed, in_order, run
from certreg.campaign.store import CERTIFICATES, occupied
from certreg.campaign.table import SUMMARY, require_parquet
from certreg.campaign.workers import Workers, workers_at
from certreg.cli.options import (
    CLOUD,
    EXIT_CODES,
    FOLDER,
    fit_options,
    limit_options,
    model_options,
    refuse_if,
)
from certreg.cli.progress import Progress
from certreg.cli.writing import require_folder_apart
from certreg.cli.wrong_pairs import WrongPairs, consensus_options
from certreg.errors import InvalidFileError
from certreg.registration.exit_codes import FitDemands, worst
from certreg.report.markup import printable
from certreg.results import Limits

if TYPE_CHECKING:
    from pathlib import Path


SHORT_OF = {  # statuses of pairs that are not fully proved
    "labels-not-proved": "registered with the most pairs proved, but not each label",
    "partly-proved": "registered, but neither the optimum nor each label is proved",
    "certified-not-unique": "certified, but not unique",
    "bounded": "not certified: bounded",
    "not-certified": "not certified",
    "certified": "certified, but not as good as was asked",
}
REMEDY = '; "remedy" beside it says what to do'


@click.command(epilog=EXIT_CODES)
@click.argument("manifest", type=CLOUD)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="A dask scheduler whose workers do the work: who reaches it can run code there.",
)
@click.option("--out", type=FOLDER, help="Folder for results, certificates and a table.")
@click.option("--parquet", is_flag=True, help="With --out: the table as Parquet, too.")
@model_options
@consensus_options
@limit_options
@fit_options
def batch(
    manifest: Path,
    *,
    scheduler: str | None,
    out: Path | None,
    parquet: bool,
    model: dict[str, Any],
    wrong: WrongPairs | None,
    max_gap: float,
    max_angle: float,
    demands: FitDemands,
) -> int:
    """Certify the pairs listed in MANIFEST, a .csv file: one line of JSON for each.

    Columns source and target name the clouds, relative to MANIFEST; name, sigma, weights, pairs,
    match, damping, scale, rotation_only (yes or no), max_residual, objective and effort are
    optional; --scale, --rotation-only, --max-residual (a number), --objective and --effort are for
    rows that say nothing there. A pair that cannot be registered gives an error in its
    place. With --out, run the same command again to go on with what was interrupted, mended or
    changed.
    """
    refuse_if(parquet and out is None, "--parquet goes with --out")
    listing = read_listing(manifest)
    if listing.ignored:
        names = ", ".join(map(printable, listing.ignored))
        click.echo(f"note: {printable(manifest)}: columns not read: {names}", err=True)
    limits = Limits(max_gap=max_gap, max_angle=max_angle)
    only = "yes" if model["rotation_only"] else "no"
    defaults = {"scale": str(model["scale"]), "rotation_only": only}
    if wrong is not None:
        defaults |= wrong.columns()
    campaign = PairCampaign(
        listing=listing,
        certificates=out is not None,
        limits=limits,
        demands=demands,
        defaults=defaults,
    )
    if out is None:
        tally = _streamed(campaign, scheduler)
    else:
        tally = _kept(campaign, scheduler, out, parquet=parquet)
    _tell(tally, listing.count, kept=out is not None)
    _tell_short(tally, listing.count)
    return worst(tally.codes)


def _tell(tally: Tally, count: int, *, kept: bool) -> None:
    """Says on stderr which pairs failed or are warned of; the first by name if lines are kept."""
    warned = "has a warning" if tally.poor.count == 1 else "have a warning"
    said = {
        "error": (tally.errors, "could not be registered", ""),
        "warning": (tally.poor, warned, REMEDY),
    }
    for kind, (told, what, then) in said.items():
        if told.count:
            for words in told.first if kept else ():
                click.echo(f"{kind}: {printable(words)}", err=True)
            more = ", of which the first are above" * (kept and told.count > len(told.first))
            total = f"{told.count} of {count} pairs {what}{more}"
            click.echo(f'certreg: {total}: look for "{kind}" in the results{then}', err=True)


def _tell_short(tally: Tally, count: int) -> None:
    """Says on stderr how many pairs are not fully proved, by what is proved of them, and which."""
    for status, told in tally.short.items():
        more = ["..."] * (told.count > len(told.first))
        names = ", ".join([*map(printable, told.first), *more])
        are = "is" if told.count == 1 else "are"
        total = f"{told.count} of {count} pairs {are} {SHORT_OF[status]}"
        click.echo(f"certreg: {total}: {names}", err=True)


def _streamed(campaign: PairCampaign, scheduler: str | None) -> Tally:
    """All pairs, their lines printed in the order of the list."""
    manifest, tally = campaign.manifest(), Tally()
    tasks = campaign.tasks(done=())
    with workers_at(scheduler) as workers, Progress(manifest.count, items="pairs") as progress:
        for result in in_order(completed(tasks, workers, manifest.versions)):
            for line, entry in campaign.results(result.content):
                click.echo(line, nl=False)
                tally.add(entry)
                progress.advance(1)
    return tally


def _kept(campaign: PairCampaign, scheduler: str | None, out: Path, *, parquet: bool) -> Tally:
    """All pairs, their results in a folder, where those of an earlier run are kept."""
    _require_kept(campaign, out)
    with at_work(campaign, out, scheduler, parquet=parquet, items="pairs") as (workers, progress):
        run(campaign, out, workers, progress.observer())
        tally = write_pair_results(campaign, out, parquet=parquet)
    count, place = campaign.listing.count, printable(out)
    click.echo(f"{count - tally.errors.count} of {count} pairs registered: {place}/{RESULTS}")
    click.echo(f"Table: {place}/{SUMMARY}, certificates: {place}/{CERTIFICATES}")
    return tally


def _require_kept(campaign: PairCampaign, out: Path) -> None:
    """That no row reads a table that an earlier run left, and this one makes anew."""
    left = [name for name in TABLES if (out / name).exists()]
    if left:
        require_folder_apart(out, left, campaign.inputs())


@contextmanager
def at_work(
    campaign: Campaign,
    out: Path,
    scheduler: str | None,
    *,
    parquet: bool,
    items: str = "instances",
) -> Generator[tuple[Workers, Progress]]:
    """The folder of a campaign, its workers, and a bar over its items."""
    if parquet:
        require_parquet()
    manifest = campaign.manifest()
    with (
        occupied(out, manifest),
        workers_at(scheduler) as workers,
        Progress(manifest.count, items=items) as progress,
        resumable(out),
    ):
        yield workers, progress


@contextmanager
def resumable(out: Path) -> Generator[None]:
    """Says on Ctrl-C, and where a file cannot be written, that nothing is lost."""
    try:
        yield
    except (KeyboardInterrupt, InvalidFileError) as error:
        start = "\n" if isinstance(error, KeyboardInterrupt) else ""  # below the ^C of a terminal
        kept = f"{start}{printable(out)}: what is done is kept: run the same to go on"
        click.echo(kept, err=True)
        raise
