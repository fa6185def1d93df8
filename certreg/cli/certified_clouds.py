"""[SOURCE TARGET] that a certificate must be about: how they are read, paired and weighed."""

from __future__ import annotations

import functools
from array import array
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from certreg._loading import late
from certreg.cli.options import (
    CLOUD,
    NUMBER,
    RIGID,
    SIGMA_OR_WEIGHTS,
    model_options,
    pairing_options,
    refuse_if,
    spring_options,
)
from certreg.cli.wrong_pairs import certified_bounds
from certreg.io.text import TEXT_FORMATS, read_clouds
from certreg.verify import INLINE_MAX, Clouds

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.certificate import checking
    from certreg.io import pairing as io_pairing
    from certreg.io import problems
    from certreg.io.pairing import Pairing
    from certreg.problem.problem import RegistrationProblem
else:
    # These load NumPy, and are loaded where they are needed: `certreg verify` does without.
    checking = late("certreg.certificate.checking")
    io_pairing = late("certreg.io.pairing")
    problems = late("certreg.io.problems")


def bound_clouds(*, lightly: bool) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """[SOURCE TARGET] that a certificate must be about, and how their rows pair and weigh.

    Read into the argument `clouds`; None where they are not given. lightly: text without NumPy, and
    of a noise no more than the weights is kept.
    """

    def decorated(command: Callable[..., Any]) -> Callable[..., Any]:
        @click.argument("paths", type=CLOUD, nargs=-1, metavar="[SOURCE TARGET]")
        @click.option(
            "--sigma", type=NUMBER, help="With SOURCE TARGET: the noise that was certified."
        )
        @click.option(
            "--weights", type=CLOUD, help="With SOURCE TARGET: the weights that were certified."
        )
        @click.option(
            "--any-weight",
            is_flag=True,
            help="With SOURCE TARGET: whatever weight was certified, if all pairs have the same.",
        )
        @pairing_options
        @spring_options
        @model_options
        @certified_bounds
        @functools.wraps(command)
        def wrapped(
            *args: Any, paths: tuple[Path, ...], any_weight: bool, pairing: Any, **options: Any
        ) -> Any:
            noise = {name: options.pop(name) for name in ("sigma", "weights")}
            springs, model, wrong = (options.pop(name) for name in ("springs", "model", "wrong"))
            refuse_if(
                not paths and model != RIGID,
                "--scale and --rotation-only go with SOURCE TARGET: the certificate has its own",
            )
            _require_fitting(paths, noise, pairing or springs or wrong, any_weight=any_weight)
            refuse_if(
                any_weight and (springs or wrong) is not None,
                f"--any-weight goes without {'springs' if wrong is None else '--max-residual'}: "
                "give the --sigma that was certified",
            )
            clouds, pair, notes = None, None, list[str]()
            if paths and (springs or wrong) is not None:
                chosen = {} if springs is None else {"springs": springs}
                pairing = pairing or io_pairing.BY_LABEL
                clouds, pair = problems.read_problem(*paths, **noise, pairing=pairing, **chosen)
                notes = pair.notes
            elif paths:
                clouds, notes = _clouds_to_bind(*paths, **noise, pairing=pairing, lightly=lightly)
            for note in notes:
                click.echo(f"note: {note}", err=True)
            if clouds is not None:
                clouds = _of_any_weight(clouds) if any_weight else clouds
                clouds = _of_model(clouds, **model)
            if wrong is not None and pair is not None:
                clouds = checking.bounded_clouds(clouds, wrong.bounds(pair), wrong.objective)
            return command(*args, clouds=clouds, **options)

        return wrapped

    return decorated


def _require_fitting(
    paths: tuple[Path, ...], noise: dict[str, Any], further: object, *, any_weight: bool
) -> None:
    """That what is said of clouds goes together, and with clouds."""
    given = [name for name, value in noise.items() if value is not None]
    refuse_if(
        any_weight and (given or not paths),
        "--any-weight goes with SOURCE TARGET, without --sigma and --weights",
    )
    refuse_if(
        len(paths) not in {0, 2} or ((given or further is not None) and not paths),
        "give SOURCE and TARGET, or neither; the options go with them",
    )
    refuse_if(len(given) > 1, SIGMA_OR_WEIGHTS)


def _of_any_weight(clouds: RegistrationProblem | Clouds) -> Clouds:
    bare = isinstance(clouds, Clouds)
    refuse_if(  # its digest is of the weights, too
        not bare and clouds.n > INLINE_MAX,
        f"--any-weight is for {INLINE_MAX} points at most: give --sigma",
    )
    if not bare or clouds.weights is not None:
        raise click.UsageError(
            "--any-weight: a column of the clouds tells the weights: add --ignore-weights"
        )
    return replace(clouds, any_weight=True)


def _of_model(
    clouds: RegistrationProblem | Clouds, *, scale: str, rotation_only: bool
) -> RegistrationProblem | Clouds:
    """The same clouds, of a motion with or without scale and translation; NumPy is not loaded."""
    if isinstance(clouds, Clouds):
        words = [f"--scale {scale}"] if scale != "none" else []
        return replace(clouds, model=" ".join(words + ["--rotation-only"] * rotation_only))
    return clouds.modelled(scale, rotation_only=rotation_only)


def _clouds_to_bind(
    source: Path,
    target: Path,
    *,
    sigma: float | None,
    weights: Path | None,
    pairing: Pairing | None,
    lightly: bool,
) -> tuple[RegistrationProblem | Clouds, list[str]]:
    """What a certificate must be about, and notes; NumPy is loaded only where it is needed."""
    files = (source, target) if weights is None else (source, target, weights)
    if lightly and pairing is None and all(file.suffix.lower() in TEXT_FORMATS for file in files):
        return read_clouds(source, target, sigma=sigma, weights=weights)
    problem, pair = problems.read_problem(
        source, target, sigma=sigma, weights=weights, pairing=pairing or io_pairing.BY_LABEL
    )
    weighed = sigma is not None or weights is not None or pair.weighed
    if weighed or problem.n > INLINE_MAX:
        return problem, pair.notes
    # as with text clouds: a certificate of another weight is told which
    points = problem.block(slice(None))
    source_doubles = array("d", points.source.tobytes())
    return Clouds(source_doubles, array("d", points.target.tobytes())), pair.notes
