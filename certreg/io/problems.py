"""The problem that files state: clouds, weights and springs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg.errors import InvalidFileError
from certreg.io.columns import noise_of_columns
from certreg.io.pairing import BY_LABEL, Pair, Pairing, read_pair
from certreg.io.row_values import numbers_of
from certreg.io.springs import NO_SPRINGS, SpringSource, read_springs
from certreg.problem.arrays import first_row
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


NONE: dict[str, Any] = {}


def read_problem(  # noqa: PLR0913 - one for each option of the commands, each by name
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    *,
    sigma: float | None = None,
    weights: str | os.PathLike[str] | None = None,
    damping: float | None = None,
    pairing: Pairing = BY_LABEL,
    springs: SpringSource | str = NO_SPRINGS,
) -> tuple[RegistrationProblem, Pair]:
    """The problem that two cloud files state, and how they were read.

    Parameters
    ----------
    source, target
        Files, as `read_cloud` takes them.
    sigma
        Standard deviation of the noise, one for all.
    weights
        A file with one weight per row of the source's file; they go with their rows, whatever the
        pairing. Without sigma and weights a column `sigma` or `weight` of one of the clouds is
        used, and noted.
    damping
        As of `RegistrationProblem`.
    pairing
        Which rows belong together; by label, where both clouds have labels, if nothing is given.
    springs
        General springs by columns of the target's file: "plane", "line" or "full"; of several kinds
        and of other files a `certreg.io.springs.SpringSource`.

    Returns
    -------
    tuple[RegistrationProblem, Pair]
        The problem, and the pair with its notes.

    Raises
    ------
    InvalidFileError, InvalidProblemError
        File, place, remedy.
    """
    bare = sigma is None and weights is None
    pair = read_pair(source, target, pairing, noise=bare)
    numbers = None if weights is None else _paired_weights(weights, source, pair)
    rows, pair = read_springs(springs, source, target, pair)
    return problem_of(pair, sigma=sigma, weights=numbers, damping=damping, springs=rows)


def problem_of(
    pair: Pair,
    *,
    sigma: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    damping: float | None = None,
    springs: Mapping[str, Any] = NONE,
) -> tuple[RegistrationProblem, Pair]:
    """The problem of a pair, and the pair with notes on its springs and on noise in a column.

    sigma, weights: one number, or one for each pair. springs: rows for each pair, by kind.
    """
    if sigma is None and weights is None:
        noise = noise_of_columns(pair.source, pair.target, (pair.source.path, pair.target.path))
        pair = replace(pair, further=(*pair.further, *noise.notes))
        sigma, weights = noise.sigma, noise.weights
    problem = RegistrationProblem(
        pair.source.points,
        pair.target.points,
        sigma=sigma,
        weights=weights,
        damping=damping,
        **springs,
    )
    return problem, replace(pair, further=(*pair.further, *problem.notes))


def _paired_weights(
    weights: str | os.PathLike[str], source: str | os.PathLike[str], pair: Pair
) -> NDArray[np.float64]:
    """One weight per pair, from a file with one per row of the source."""
    numbers, n = read_weights(weights), pair.sizes[0]
    if len(numbers) != n:
        raise InvalidFileError(
            f"{weights}: holds {len(numbers)} weights, {source} has {n} "
            "points: give one weight per row of the source",
            path=Path(weights),
            value=len(numbers),
            limit=n,
        )
    return numbers if pair.source_rows is None else numbers[pair.source_rows]


def read_weights(path: str | os.PathLike[str]) -> NDArray[np.float64]:
    """One weight per row of the source, from .npy or from text with one number a line."""
    file = Path(path)
    weights = numbers_of(file)
    if weights.ndim != 1:
        raise InvalidFileError(
            f"{file}: holds an array of shape {weights.shape}: expected (N,)",
            path=file,
            value=weights.shape,
        )
    if len(weights) == 0:
        raise InvalidFileError(
            f"{file}: holds no weights: give one number per row of the source",
            path=file,
            value=0,
            limit=1,
        )
    row = first_row(weights, lambda block: block < 0)
    if row is not None:
        raise InvalidFileError(
            f"{file}: weight {row} (counting from 0) is {weights[row]}: weights must be >= 0",
            path=file,
            row=row,
            value=float(weights[row]),
            limit=0.0,
        )
    if first_row(weights, lambda block: block > 0) is None:
        raise InvalidFileError(
            f"{file}: all weights are zero: give a positive weight to the points that count",
            path=file,
            value=0.0,
        )
    return weights
