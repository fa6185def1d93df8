"""Clouds that are already in memory: arrays, data frames, objects of other libraries."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.io.cloud import Cloud
from certreg.io.clouds import read_cloud
from certreg.io.columns import NOISE, axes_of
from certreg.io.labels import Match
from certreg.io.pairing import Pair, Pairing, pair_of
from certreg.io.problems import problem_of
from certreg.io.springs import columns_of, read_spring_table, springs_of_pairs, titles_of
from certreg.io.streams import is_standard_input
from certreg.problem.arrays import (
    cloud_array,
    data_frame,
    finite_doubles,
    mapped_file,
    per_point,
    real_numbers,
)
from certreg.problem.attributes import (
    SpringArguments,
    held_rows,
    require_known,
    unused_springs,
    warn_of_unused,
)
from certreg.problem.row_labels import LABEL, labels_of, require_same_labels

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.problem.problem import RegistrationProblem


class ProblemOptions(SpringArguments, total=False):
    """What states a problem beside its clouds, as in `RegistrationProblem`."""

    sigma: ArrayLike | None
    weights: ArrayLike | None
    damping: float | None
    scale: str
    rotation_only: bool


def load(path: str | os.PathLike[str]) -> Cloud:
    """A cloud from a file: points, labels, sigma or weights, normals where the file has them.

    Parameters
    ----------
    path
        The formats are those of the command line.

    Returns
    -------
    Cloud
        For `pair` and `certify`.

    Raises
    ------
    InvalidFileError
        File, place, remedy.

    Examples
    --------
    >>> from importlib.resources import files
    >>> cloud = load(files("certreg") / "data" / "survey_source.csv")
    >>> cloud.points.shape, len(cloud.labels)
    ((4, 3), 4)
    """
    cloud = read_cloud(path)
    large = mapped_file(cloud.points) is not None
    return cloud if large or is_standard_input(path) else _with_springs(cloud)


def _with_springs(cloud: Cloud) -> Cloud:
    """With normals and covariances, where columns of the file tell them."""
    titles = titles_of(cloud.path)
    for kind in ("normals", "covariances"):
        if columns_of(titles, kind) is not None:
            table = read_spring_table(cloud.path, kind)
            ignored = tuple(
                one for one in cloud.ignored if one.strip().lower() not in table.columns
            )
            cloud = replace(cloud, ignored=ignored, **{kind: table.rows})
    return cloud


def pair(source: Any, target: Any, *, match: str = "all", **springs: Any) -> Pair:
    """Two clouds in correspondence: by label where both have labels, else row i with row i.

    Parameters
    ----------
    source, target
        Files, clouds of `certreg.load`, arrays (N, 3) of any library, or data frames, whose labels
        are a column `label`, else an index that is not 0, 1, 2, ...
    match
        "all", or "common" to leave out labels that are in one cloud only.
    **springs
        None: `certify` takes them.

    Returns
    -------
    Pair
        Both clouds when unpacked, and what the user should know in `notes`.

    Raises
    ------
    InvalidFileError, InvalidProblemError
        As the commands do.

    Examples
    --------
    >>> first, second = pair([[0, 0, 0], [1, 0, 0]], [[5, 0, 0], [5, 1, 0]])
    >>> first.points.shape
    (2, 3)
    """
    require_known(springs, ProblemOptions, "pair")
    if springs:
        raise InvalidProblemError(
            f"pair takes no {', '.join(springs)}: give them to certify(source, target, ...), which "
            "pairs the clouds itself; a row of springs goes with its row of the target",
            array=next(iter(springs)),
        )
    try:
        pairing = Pairing(match=Match(match))
    except ValueError as error:
        raise InvalidProblemError(
            f"match is {match!r}: give 'all' or 'common'", array="match", value=match
        ) from error
    first, second = cloud_of(source, "source"), cloud_of(target, "target")
    return pair_of(*_named_alike(source, target, first, second), pairing)


def stated_problem(  # noqa: PLR0913 - one for each argument of a problem
    source: Any,
    target: Any,
    *,
    sigma: Any = None,
    weights: Any = None,
    damping: float | None = None,
    scale: str = "none",
    rotation_only: bool = False,
    depth: int = 2,
    **springs: Any,
) -> tuple[RegistrationProblem, Pair]:
    """The problem of two clouds as `pair` takes them, and how they were paired.

    sigma, weights: a number, or one for each row of the source; they go with their rows.
    springs: as of `RegistrationProblem`, or files, with a row for each row of the target.
    depth: how many calls are between the user and here.
    """
    require_same_labels(source, sigma=sigma, weights=weights)
    require_same_labels(target, called="target", **springs)
    paired = pair(source, target)
    rows = springs_of_pairs(springs, (source, target), paired)
    if not rows:
        warn_of_unused(target, paired.sizes[1], depth=depth)
    problem, paired = problem_of(
        paired,
        sigma=_of_pairs(sigma, paired, "sigma"),
        weights=_of_pairs(weights, paired, "weights"),
        damping=damping,
        springs=rows,
    )
    return problem.modelled(scale, rotation_only=rotation_only), paired


def _of_pairs(values: Any, paired: Pair, name: str) -> Any:
    """One number for each pair, of those for each row of the source; a single number as it is."""
    if values is None or paired.source_rows is None:
        return values
    array = per_point(values, name, paired.sizes[0])
    return values if np.ndim(values) == 0 else array[paired.source_rows]


def cloud_of(given: Any, name: str) -> Cloud:
    """A cloud of whatever a user holds; name: of the argument, for errors."""
    if isinstance(given, Cloud):
        return given
    if isinstance(given, str) or hasattr(given, "__fspath__"):
        return read_cloud(given)
    if data_frame(given):
        return _of_frame(given, name)
    labels = labels_of(given)
    texts = None if labels is None else tuple(map(str, labels.values))
    array = cloud_array(given, name)
    return Cloud(
        path=Path(name),
        points=finite_doubles(array, name),
        labels=texts if labels is not None and labels.certain else None,
        ignored=(),
        identifiers=texts,
        **_held_springs(given, len(array)),
    )


def _held_springs(given: Any, n: int) -> dict[str, Any]:
    """The normals or covariances of an object, to stay beside its points."""
    kind = unused_springs(given, n)
    return {} if kind is None else {kind: held_rows(given, kind)}


def _of_frame(frame: Any, name: str) -> Cloud:
    """A cloud of a data frame, its columns named as those of a .csv file."""
    columns: list[Any] = list(frame.columns)
    plain = [one.strip().lower() if isinstance(one, str) else "" for one in columns]
    axes = axes_of(plain)
    points = (
        cloud_array(frame, name)
        if axes is None
        else np.column_stack([real_numbers(frame[columns[axis]], name) for axis in axes])
    )
    labels = labels_of(frame)
    texts = None if labels is None else tuple(str(one).strip() for one in labels.values)
    noise = {key: _column(frame, columns[plain.index(key)], key) for key in NOISE if key in plain}
    read = {*(axes or ()), *(plain.index(key) for key in (*NOISE, LABEL) if key in plain)}
    ignored = () if axes is None else (str(c) for k, c in enumerate(columns) if k not in read)
    return Cloud(
        path=Path(name),
        points=finite_doubles(points, name),
        labels=texts if labels is not None and labels.certain else None,
        ignored=tuple(ignored),
        identifiers=texts,
        sigma=noise.get("sigma"),
        weights=noise.get("weight"),
    )


def _column(frame: Any, column: str, name: str) -> NDArray[np.float64]:
    return finite_doubles(real_numbers(frame[column], name), name)


def _named_alike(source: Any, target: Any, first: Cloud, second: Cloud) -> tuple[Cloud, Cloud]:
    """Both clouds; labels dropped that one of two objects has by accident, as `RowLabels` says.

    An index that nobody chose names rows only where the other has the same in another order.
    """
    here, there = labels_of(source), labels_of(target)
    if here is None or there is None or here.certain == there.certain:
        return first, second
    if here.first_other(there) is None:
        return first, second
    return (
        replace(first, labels=first.identifiers),
        replace(second, labels=second.identifiers),
    )
