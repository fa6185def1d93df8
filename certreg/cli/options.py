"""Exit codes, and options that commands share: clouds, pairs, noise, read into a problem."""

from __future__ import annotations

import functools
import math
import re
import sys
import threading
import warnings
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.types import FloatParamType

from certreg._loading import late
from certreg.errors import CertregError, NotCompiledWarning
from certreg.report.markup import printable
from certreg.results import MAX_ANGLE, MAX_GAP, Limits

if TYPE_CHECKING:
    from certreg.io import labels
    from certreg.io import pairing as io_pairing
    from certreg.io import problems as io_problems
    from certreg.io import springs as io_springs
    from certreg.io.pairing import Pairing
    from certreg.io.springs import SpringSource
    from certreg.problem import motion, support
    from certreg.registration import exit_codes, simulation
    from certreg.report import document
else:
    # These load NumPy, and are loaded where they are needed: `certreg verify` does without.
    document = late("certreg.report.document")
    exit_codes = late("certreg.registration.exit_codes")
    io_pairing = late("certreg.io.pairing")
    io_problems = late("certreg.io.problems")
    io_springs = late("certreg.io.springs")
    labels = late("certreg.io.labels")
    motion = late("certreg.problem.motion")
    simulation = late("certreg.registration.simulation")
    support = late("certreg.problem.support")


EXIT_CODES = """
\b
Exit codes: 0 done and proved
            1 refused, or two roads disagree
            2 bad usage or input
            3 certified, but the optimum is not unique
            4 solved, but too little is proved to call it certified, or the fit is not what
              --require-fit and --max-rmse ask; simulate: not converged
"""
OPTIMAL = "optimal"  # the damping of the fastest decay
SIGMA_OR_WEIGHTS = "--sigma and --weights exclude each other: give one"
PATIENCE = 1.0  # seconds before a long run says that it is at work
SPRING_FILES = ("normals", "directions", "covariances", "information", "factors")
CERTIFICATE = "certificate.json"  # as `certify --out` calls it
RIGID = {"scale": "none", "rotation_only": False}  # where nothing is typed
CLOUD = click.Path(dir_okay=False, path_type=Path)
FOLDER = click.Path(file_okay=False, path_type=Path)
DECIMAL_COMMA = re.compile(r"\s*([-+]?\d*),(\d+(?:[eE][-+]?\d+)?)\s*")


class DecimalNumber(FloatParamType):
    """A number."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The double; fails with what to type instead of a decimal comma."""
        _refuse_comma(self, value, param, ctx)
        return super().convert(value, param, ctx)


class NumberRange(click.FloatRange):
    """A number within limits."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The double; fails with what to type instead of a decimal comma."""
        _refuse_comma(self, value, param, ctx)
        return float(super().convert(value, param, ctx))


def _refuse_comma(
    kind: click.ParamType[Any], value: Any, param: click.Parameter | None, ctx: click.Context | None
) -> None:
    """A comma may also part thousands, so that no number is read into it."""
    found = DECIMAL_COMMA.fullmatch(value) if isinstance(value, str) else None
    if found is not None:
        pointed = f"{found[1]}.{found[2]}"
        kind.fail(f"'{value}' has a comma: with a decimal point type {pointed}", param, ctx)


NUMBER = DecimalNumber()
FROM_ZERO = NumberRange(min=0.0)


def refuse_if(broken: object, words: str) -> None:
    """Nothing, unless the options that were given do not go together."""
    if broken:
        raise click.UsageError(words)


def certificate_argument(command: Callable[..., Any]) -> Callable[..., Any]:
    """CERTIFICATE: a file, or a folder that `certify --out` wrote."""

    def file_of(context: click.Context, parameter: click.Parameter, value: Path) -> Path:
        if not value.is_dir():
            return value
        if not (value / CERTIFICATE).is_file():
            raise click.BadParameter(
                f"{printable(value)}: a folder without {CERTIFICATE}: give a folder that certify "
                "--out wrote, or the file of a certificate",
                context,
                parameter,
            )
        return value / CERTIFICATE

    place = click.Path(path_type=Path)
    return click.argument("certificate", type=place, callback=file_of)(command)


def pairing_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--pairs FILE | --match all|common] ..., made one argument; None where all is by default."""

    @click.option("--pairs", type=CLOUD, help="File of pairs: a row of SOURCE, a row of TARGET.")
    @click.option("--one-to-one", is_flag=True, help="With --pairs: refuse a row that comes again.")
    @click.option(
        "--match",
        type=click.Choice(["all", "common"]),
        default="all",
        show_default=True,
        help="Labels in one cloud only: refuse them, or leave them out.",
    )
    @click.option(
        "--ignore-weights",
        is_flag=True,
        help="Leave columns sigma and weight of the clouds unread.",
    )
    @functools.wraps(command)
    def wrapped(
        *args: Any,
        pairs: Path | None,
        one_to_one: bool,
        match: str,
        ignore_weights: bool,
        **options: Any,
    ) -> Any:
        refuse_if(
            one_to_one and pairs is None,
            "--one-to-one goes with --pairs: labels and rows are one to one anyway",
        )
        refuse_if(
            pairs is not None and match == "common",
            "--pairs and --match common exclude each other: give one",
        )
        if pairs is None and match == "all" and not ignore_weights:
            return command(*args, pairing=None, **options)
        pairing = io_pairing.Pairing(
            pairs=pairs,
            match=labels.Match(match),
            one_to_one=one_to_one,
            ignore_weights=ignore_weights,
        )
        return command(*args, pairing=pairing, **options)

    return wrapped


def spring_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--springs KIND] ... [--normals FILE] ..., made one argument `springs`; None for none."""

    @click.option(
        "--springs",
        "columns",
        type=click.Choice(["plane", "line", "full"]),
        multiple=True,
        help="Springs by columns of TARGET: nx,ny,nz, dx,dy,dz, or cxx,cxy,cxz,cyy,cyz,czz.",
    )
    @_springs_file("--normals", "Point to plane: nx,ny,nz, by row of TARGET; .csv or .npy.")
    @_springs_file("--directions", "Point to line: dx,dy,dz.")
    @_springs_file("--covariances", "Of the noise of each pair: xx,xy,xz,yy,yz,zz.")
    @_springs_file("--information", "Their inverses: xx,xy,xz,yy,yz,zz.")
    @_springs_file("--factors", "Springs L L^T: l11,l21,l22,l31,l32,l33, or lx,ly,lz.")
    @functools.wraps(command)
    def wrapped(*args: Any, columns: tuple[str, ...], **options: Any) -> Any:
        given = {kind: options.pop(kind) for kind in SPRING_FILES}
        files = {kind: path for kind, path in given.items() if path is not None}
        springs = (
            io_springs.SpringSource(columns=columns, files=files) if columns or files else None
        )
        return command(*args, springs=springs, **options)

    return wrapped


def model_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--scale KIND] [--rotation-only], made one argument `model`."""

    @click.option(
        "--scale",
        type=click.Choice(["none", "asymmetric", "symmetric"]),
        default="none",
        show_default=True,
        help="Estimate the scale: asymmetric (Umeyama; noise in SOURCE makes it too small), or "
        "symmetric (Horn; right where both have the same relative noise, too large with noise in "
        "TARGET alone).",
    )
    @click.option("--rotation-only", is_flag=True, help="No translation: rows are directions.")
    @functools.wraps(command)
    def wrapped(*args: Any, scale: str, rotation_only: bool, **options: Any) -> Any:
        model = {"scale": motion.Scale(scale), "rotation_only": rotation_only}
        return command(*args, model=model, **options)

    return wrapped


def _springs_file(name: str, words: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    return click.option(name, type=CLOUD, help=words)


def limit_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--max-gap SHARE] [--max-angle RAD]: what must be proved of a pose to call it certified."""

    @click.option(
        "--max-gap",
        type=FROM_ZERO,
        metavar="SHARE",
        default=MAX_GAP,
        show_default=True,
        help="Certified: proved gap to the minimum, as a share of the range of energies.",
    )
    @click.option(
        "--max-angle",
        type=FROM_ZERO,
        metavar="RAD",
        default=MAX_ANGLE,
        show_default=True,
        help="Certified: proved angle to the optimum, in radians.",
    )
    @functools.wraps(command)
    def wrapped(*args: Any, max_gap: float, max_angle: float, **options: Any) -> Any:
        try:
            Limits(max_gap=max_gap, max_angle=max_angle)
        except ValueError as error:
            raise click.UsageError(f"--{error}".replace("_", "-")) from error
        return command(*args, max_gap=max_gap, max_angle=max_angle, **options)

    return wrapped


def fit_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--require-fit] [--max-rmse X], made one argument `demands`: what is asked of the fit."""

    @click.option("--require-fit", is_flag=True, help="Code 4 where the fit has a warning.")
    @click.option(
        "--max-rmse",
        type=FROM_ZERO,
        metavar="X",
        help="Code 4 where the RMSE is larger, in the clouds' unit.",
    )
    @functools.wraps(command)
    def wrapped(*args: Any, require_fit: bool, max_rmse: float | None, **options: Any) -> Any:
        refuse_if(
            max_rmse is not None and not math.isfinite(max_rmse),
            f"--max-rmse is {max_rmse}: give a finite number, 0 or more",
        )
        demands = exit_codes.FitDemands(require_fit=require_fit, max_rmse=max_rmse)
        return command(*args, demands=demands, **options)

    return wrapped


def _damping(context: click.Context, parameter: click.Parameter, value: Any) -> Any:
    """The number given for the damping, the word 'optimal', or None; anything else is bad usage."""
    if value is None:
        return None
    if value.lower() == OPTIMAL:
        return OPTIMAL
    return NUMBER.convert(value, parameter, context)


def cloud_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """SOURCE TARGET, how their rows pair, noise and damping, read into `problem` and `pair`."""

    @click.argument("source", type=CLOUD)
    @click.argument("target", type=CLOUD)
    @click.option(
        "--sigma", type=NUMBER, help="Standard deviation of the noise, in the clouds' unit."
    )
    @click.option("--weights", type=CLOUD, help="File of weights, one per row of SOURCE.")
    @pairing_options
    @spring_options
    @model_options
    @click.option(
        "--damping",
        metavar="MU",
        callback=_damping,
        help="Viscous damping per mass, or 'optimal' for the fastest decay (not of general "
        "springs). Default: sqrt(8); of certify, optimal.",
    )
    @functools.wraps(command)
    def wrapped(
        *args: Any,
        source: Path,
        target: Path,
        sigma: float | None,
        weights: Path | None,
        damping: float | str | None,
        pairing: Pairing | None,
        springs: SpringSource | None,
        model: dict[str, Any],
        **options: Any,
    ) -> Any:
        refuse_if(sigma is not None and weights is not None, SIGMA_OR_WEIGHTS)
        loss = support.Loss.of(options.get("objective"), options.get("max_residual"))
        support.require_supported(support.Cell(springs=springs is not None, loss=loss, **model))
        stated, pair = io_problems.read_problem(
            source,
            target,
            sigma=sigma,
            weights=weights,
            damping=damping if isinstance(damping, float) else None,
            pairing=pairing or io_pairing.BY_LABEL,
            **({} if springs is None else {"springs": springs}),
        )
        stated = stated.modelled(**model)
        if damping == OPTIMAL and options.get("max_residual") is None:
            stated = simulation.optimally_damped(stated)  # else that of the pairs within
        for note in pair.notes:
            click.echo(f"note: {note}", err=True)
        with _patience(f"working on {stated.n} correspondences"):
            return command(*args, problem=stated, pair=pair, **options)

    return wrapped


def json_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """[--json], the argument `as_json`; why the question has no answer is one object, too.

    Bad usage or input, code 2, is a line on standard error alone: nothing was asked yet.
    """

    @click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
    @functools.wraps(command)
    def wrapped(*args: Any, as_json: bool, **options: Any) -> Any:
        try:
            return command(*args, as_json=as_json, **options)
        except CertregError as error:
            code = exit_codes.code_of_error(error)
            if as_json and code != exit_codes.MISUSED:
                click.echo(document.dumps(document.error_document(error, code)))
            raise

    return wrapped


@contextmanager
def warnings_as_notes() -> Generator[None]:
    """Warnings of certreg's own as one line on stderr each, not as a place in the source."""
    with warnings.catch_warnings():
        others = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
            if issubclass(category, NotCompiledWarning):
                click.echo(f"note: {printable(message)}", err=True)
            else:
                others(message, category, *place, **more)

        warnings.simplefilter("always", NotCompiledWarning)
        warnings.showwarning = show
        yield


@contextmanager
def _patience(doing: str) -> Generator[None]:
    """Says on stderr what is going on if it takes longer than a second, to a terminal only."""
    timer = threading.Timer(PATIENCE, lambda: click.echo(f"{doing} ...", err=True))
    if sys.stderr.isatty():
        timer.daemon = True
        timer.start()
    try:
        yield
    finally:
        timer.cancel()
