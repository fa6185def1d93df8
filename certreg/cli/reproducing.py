"""The command about the paper: its experiments, its figures, its claims."""

from __future__ import annotations

from pathlib import Path

import click

from certreg._loading import require
from certreg.campaign.runner import run
from certreg.campaign.table import SUMMARY
from certreg.cli.campaigns import at_work
from certreg.cli.options import FOLDER
from certreg.cli.progress import Stages
from certreg.paper.documents import make_folder, texts, write_reproduction
from certreg.paper.equilibrium_maps import (
    SPRING_INSTANCES,
    RunEnd,
    SpringCampaign,
    SpringCounts,
    spring_counts,
    write_spring_results,
)
from certreg.paper.figures import paper_drawings
from certreg.paper.map_figures import spring_drawings, sweep_drawings
from certreg.paper.monte_carlo import EXCEPTIONS, MonteCarlo, write_instance_results
from certreg.paper.observations import Setup
from certreg.paper.parameter_sweeps import all_sweeps
from certreg.paper.verdicts import reproduce as reproduced
from certreg.registration.exit_codes import DONE, REFUSED
from certreg.report.markup import printable

LARGEST_RUNS = 1000  # in one process, with figures: beyond, a campaign
CAMPAIGN = "campaign"  # folder, within that of the reproduction
SPRINGS = "springs-campaign"  # beside it


@click.command(epilog="Exit code 0 when every finding is confirmed, 1 if one is not.")
@click.option(
    "--out",
    type=FOLDER,
    default=Path("certreg-reproduce"),
    show_default=True,
    help="Folder to write to.",
)
@click.option(
    "--runs",
    type=click.IntRange(min=1),
    help="Instances of either experiment; default 50 and 100, as in the paper. More than 1000: "
    "beside these, as a campaign.",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="As a campaign, on the workers of a dask scheduler: who reaches it can run code there.",
)
@click.option("--parquet", is_flag=True, help="As a campaign, its table as Parquet, too.")
@click.option(
    "--points",
    type=click.IntRange(min=3),
    default=100,
    show_default=True,
    help="Points per cloud; not stated in the paper.",
)
@click.option(
    "--noise",
    type=click.FloatRange(min=0.0),
    default=0.01,
    show_default=True,
    help="Standard deviation of the noise, in the clouds' own.",
)
@click.option(
    "--damping",
    type=click.FloatRange(min=0.0, min_open=True),
    metavar="MU",
    default=2.0,
    show_default=True,
    help="Viscous damping per mass; not stated in the paper.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@click.option(
    "--beyond",
    is_flag=True,
    help="Also maps over damping, noise, points, symmetry and start, `--runs` instances at each "
    "value, default 200: figures and maps.csv. And equilibria of planes, lines and covariances "
    "over noise and points, default 100: springs.csv, from a campaign where the runs are one.",
)
@click.option("--no-proofs", is_flag=True, help="Leave the proofs out; `certreg derive` runs them.")
def reproduce(
    out: Path,
    runs: int | None,
    points: int,
    noise: float,
    damping: float,
    seed: int,
    *,
    scheduler: str | None,
    parquet: bool,
    beyond: bool,
    no_proofs: bool,
) -> int:
    """Every experiment and figure of the paper, and its claims with verdicts.

    The claims are proved and measured anew; figures, and the verdicts as HTML, Markdown and JSON,
    go to the folder. A campaign is kept in the folder `campaign` there: begun again, it goes on.
    """
    require("matplotlib", "sympy", purpose="reproduce")
    apart = scheduler is not None or parquet or (runs or 0) > LARGEST_RUNS
    setup = Setup(
        points=points, noise=noise, damping=damping, seed=seed, runs=None if apart else runs
    )
    make_folder(out)
    springs: tuple[SpringCounts, ...] = ()
    if apart:
        count = runs or setup.equilibrium_runs
        drawn = MonteCarlo(count=count, points=points, sigma=noise, damping=damping, seed=seed)
        _run_campaign(drawn, out / CAMPAIGN, scheduler, parquet=parquet)
        if beyond:
            mapped = SpringCampaign(instances=runs or SPRING_INSTANCES, seed=seed)
            springs = _run_springs(mapped, out / SPRINGS, scheduler, parquet=parquet)
        click.echo()
    with Stages() as stages:
        made = reproduced(setup, stages.at, proofs=not no_proofs)
        sweeps = all_sweeps(seed, runs, stages.at) if beyond else ()
        if beyond and not apart:
            springs = spring_counts(seed, runs, stages.at)
        stages.at("figures")
        drawn = [*paper_drawings(made.observations)]
        drawn += [*sweep_drawings(sweeps), *spring_drawings(springs)]
        path = write_reproduction(made, drawn, out, sweeps, springs)
    for text in texts(made):
        click.echo(text)
    click.echo(f"\nFigures and verdicts: {printable(path)}")
    return DONE if made.stands else REFUSED


def _run_campaign(campaign: MonteCarlo, out: Path, scheduler: str | None, *, parquet: bool) -> None:
    """Run a campaign over random instances, begun or resumed in `out`; print what it found."""
    with at_work(campaign, out, scheduler, parquet=parquet) as (
        workers,
        progress,
    ):
        timings = run(campaign, out, workers, progress.observer())
        totals = write_instance_results(campaign, out, parquet=parquet)
    click.echo(
        f"{totals.regular:,} of {totals.count:,} random instances have four equilibria, "
        "with 0, 1, 2 and 3 unstable eigenvalues"
    )
    place = printable(out)
    if totals.exceptions:
        click.echo(
            f"{totals.exceptions:,} were decided in exact arithmetic, each with its certificate: "
            f"{place}/{EXCEPTIONS}"
        )
    if progress.made:
        rate, solving = progress.made / progress.seconds, progress.made / timings["solving"]
        click.echo(
            f"{progress.made:,} in {progress.seconds:.1f} s: {rate:,.0f} a second; without making "
            f"them {solving * workers.count:,.0f}, with {workers.count} at work"
        )
    click.echo(f"Table: {place}/{SUMMARY}")


def _run_springs(
    campaign: SpringCampaign, out: Path, scheduler: str | None, *, parquet: bool
) -> tuple[SpringCounts, ...]:
    """Run the maps of general springs, begun or resumed in `out`; print what they found."""
    with at_work(campaign, out, scheduler, parquet=parquet) as (
        workers,
        progress,
    ):
        run(campaign, out, workers, progress.observer())
        counts = write_spring_results(campaign, out, parquet=parquet)
    listed = sum(len(each.listed) for each in counts)
    wrong = sum(each.ended(RunEnd.SPURIOUS) for each in counts)
    click.echo(
        f"{listed:,} of {campaign.manifest().count:,} random instances of planes, lines and "
        f"covariances have their equilibria counted (not proved); {wrong:,} runs of these end at a "
        "stable spurious one"
    )
    click.echo(f"Table: {printable(out)}/{SUMMARY}")
    return counts
