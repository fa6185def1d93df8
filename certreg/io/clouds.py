"""Clouds and weights from files. Strict: what is read is what was meant."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from certreg._loading import found_late, late
from certreg.errors import InvalidFileError
from certreg.io.labels import (
    Match,
    are_short,
    classes_note,
    named_by_rows,
    rows_by_label,
    unused_labels_note,
)
from certreg.io.noise import noise_of_columns
from certreg.io.optional import unknown_format
from certreg.io.row_numbers import RowNumbers, require_same_rows
from certreg.io.springs import NO_SPRINGS, read_springs
from certreg.io.standard_input import is_standard_input, standard_input
from certreg.io.streams import reading
from certreg.io.text import TEXT_FORMATS, notes_on, parse_points, read_numbers
from certreg.problem import (
    RegistrationProblem,
    first_row,
    remedy_of_shape,
)
from certreg.results import Brief
from certreg.verify import shown

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from certreg.io import npy, trajectories
    from certreg.io import pairs as paired
    from certreg.io.parsed import Parsed
    from certreg.io.springs import SpringSource

    Parser = Callable[[BinaryIO, Path], Parsed]
else:  # for arrays in files, for a file of pairs, and for two of poses
    npy = late("certreg.io.npy")
    paired = late("certreg.io.pairs")
    trajectories = late("certreg.io.trajectories")

PARSERS: dict[str, Callable[[], Parser]] = {  # each is loaded where a file has its ending
    ".ply": found_late("certreg.io.ply", "parse_ply"),
    ".pcd": found_late("certreg.io.pcd", "parse_pcd"),
    ".npz": found_late("certreg.io.npz", "parse_npz"),
    ".stl": found_late("certreg.io.stl", "parse_stl"),
    ".cif": found_late("certreg.io.cif", "parse_cif"),
    **dict.fromkeys((".las", ".laz"), found_late("certreg.io.scans", "parse_las")),
    ".e57": found_late("certreg.io.scans", "parse_e57"),
    ".tum": found_late("certreg.io.trajectories", "parse_tum"),
    ".kitti": found_late("certreg.io.trajectories", "parse_kitti"),
}
FORMATS = (*TEXT_FORMATS, ".npy", *PARSERS)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cloud(Brief):
    """Points read from a file: (N, 3), labels if the file has them, names of columns not read.

    Points of a large .npy or binary .ply file are mapped from it: they stay there, as doubles or
    floats, and nobody may change the file meanwhile.
    """

    path: Path
    points: NDArray[np.float64]
    labels: tuple[str, ...] | None
    ignored: tuple[str, ...]
    identifiers: tuple[str, ...] | None = None  # labels, or what a column not read calls the points
    numbers: RowNumbers | None = None  # what names the rows of a large file, in their place
    sigma: NDArray[np.float64] | None = None  # of the column of this name: one for each point
    weights: NDArray[np.float64] | None = None  # of the column `weight`
    normals: NDArray[np.float64] | None = None  # of nx, ny, nz, where `load` was asked for all
    covariances: NDArray[np.float64] | None = None  # (N, 6), of cxx, cxy, cxz, cyy, cyz, czz
    times: NDArray[np.float64] | None = None  # seconds, of a trajectory: they pair rows
    notes: tuple[str, ...] = ()  # on how the file was read

    def __array__(self, dtype: Any = None, *, copy: bool | None = None) -> NDArray[Any]:
        """The points, where NumPy asks for an array."""
        points = np.asarray(self.points, dtype=dtype)
        return points.copy() if copy else points


@dataclass(frozen=True, slots=True, kw_only=True)
class Pairing:
    """How rows are to be paired: as a file says, or by label (all, or those in common).

    one_to_one: whether a file of pairs may name no row twice. ignore_weights: whether columns
    `sigma` and `weight` of the clouds are left unread.
    """

    pairs: Path | None = None
    match: Match = Match.ALL
    one_to_one: bool = False
    ignore_weights: bool = False


NORMALS = {"nx", "ny", "nz"}  # as columns call them
BY_LABEL = Pairing()
NONE: dict[str, Any] = {}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pair(Brief):
    """Two clouds in correspondence, row i with row i, and the rows of the files that they were."""

    source: Cloud
    target: Cloud
    source_rows: NDArray[np.int64] | None  # None: all, in their order
    sizes: tuple[int, int]  # of the files
    target_rows: NDArray[np.int64] | None = None
    left_out: tuple[int, int] = (0, 0)  # how many rows of them are in no pair
    further: tuple[str, ...] = ()  # notes: rows in several pairs, a column of weights

    def __iter__(self) -> Iterator[Cloud]:
        """Source and target, to be unpacked."""
        return iter((self.source, self.target))

    @property
    def weighed(self) -> bool:
        """Whether a column of one of the files says how sure a pair is."""
        sides = self.source, self.target
        return any(c.sigma is not None or c.weights is not None for c in sides)

    @property
    def about(self) -> dict[str, Any]:
        """What a certificate may say of the files, unproved: names, and labels if not too many."""
        about: dict[str, Any] = {"source": self.source.path.name, "target": self.target.path.name}
        labels = self.source.labels or self.target.labels
        rows = self.source_rows, self.target_rows
        if labels is None and rows[0] is not None and rows[1] is not None:
            labels = named_by_rows(rows[0], rows[1])
        return about if labels is None or not are_short(labels) else about | {"labels": [*labels]}

    @property
    def notes(self) -> list[str]:
        """What the user should know about how the files were read."""
        sides = self.source, self.target
        notes = [note for c in sides for note in notes_on(c.path, c.notes, c.ignored)]
        if self.source_rows is None:
            labelled = self.source.labels is not None, self.target.labels is not None
            notes += unused_labels_note(labelled, (self.source.path, self.target.path))
        n = len(self.source.points)
        if self.left_out != (0, 0):
            first, second = self.left_out
            names = shown(self.source.path), shown(self.target.path)
            notes.append(f"{n} pairs; left out: {first} of {names[0]}, {second} of {names[1]}")
        kinds = {"normals": self.target.normals, "covariances": self.target.covariances}
        notes += [
            f"{shown(self.target.path)}: has {kind}, which certify(..., {kind}=target) uses"
            for kind, rows in kinds.items()
            if rows is not None
        ]
        if {column.strip().lower() for column in self.target.ignored} >= NORMALS:
            words = "has normals, which --springs plane uses, in Python normals="
            notes.append(f"{shown(self.target.path)}: {words}")
        return [*notes, *self.further]


def read_cloud(path: str | os.PathLike[str], *, noise: bool = True) -> Cloud:
    """A cloud from a file.

    Parameters
    ----------
    path
        Of any of FORMATS, told by its ending, or `-` for standard input.
    noise
        Whether columns `sigma` and `weight` are read, too.

    Returns
    -------
    Cloud
        Points, labels and noise, where the file has them.

    Raises
    ------
    InvalidFileError
        File, place, remedy.
    """
    if is_standard_input(path):
        return parse_cloud(*standard_input(), noise=noise)
    file = Path(path)
    if file.suffix.lower() not in FORMATS:
        raise unknown_format(file, FORMATS)
    with reading(file) as stream:
        return parse_cloud(stream, file, noise=noise)


def parse_cloud(stream: BinaryIO, file: Path, *, noise: bool = True) -> Cloud:
    """A cloud from a stream; `file` tells the format, one of FORMATS, and the name in errors."""
    suffix = file.suffix.lower()
    if suffix in TEXT_FORMATS:
        text = parse_points(stream, file, noise=noise)
        return Cloud(
            path=file,
            points=np.array(text.coordinates, dtype=np.float64).reshape(-1, 3),
            labels=text.labels,
            ignored=text.ignored,
            identifiers=text.identifiers,
            sigma=None if text.sigma is None else np.array(text.sigma),
            weights=None if text.weights is None else np.array(text.weights),
            notes=text.notes,
        )
    if suffix in PARSERS:
        return _of_parsed(PARSERS[suffix]()(stream, file), file, noise=noise)
    points = npy.parse_array(stream, file)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        what = f"holds an array of shape {points.shape}"
        remedy = remedy_of_shape(points.shape, "array")
        message = f"{shown(file)}: {what}: expected (N, 3) with N >= 1{remedy}"
        raise InvalidFileError(message, path=file, value=points.shape)
    return Cloud(path=file, points=points, labels=None, ignored=())


def _of_parsed(read: Parsed, file: Path, *, noise: bool) -> Cloud:
    """A cloud with its noise checked, or named among what is not used."""
    columns = {"sigma": read.sigma, "weight": read.weights}
    given = {name: values for name, values in columns.items() if values is not None}
    kept = {name: _checked_noise(file, name, given[name]) for name in given if noise}
    return Cloud(
        path=file,
        points=read.points,
        labels=read.labels,
        ignored=read.ignored if noise else (*read.ignored, *given),
        identifiers=read.identifiers,
        numbers=read.numbers,
        times=read.times,
        sigma=kept.get("sigma"),
        weights=kept.get("weight"),
        notes=read.notes,
    )


def _checked_noise(file: Path, name: str, values: NDArray[Any]) -> NDArray[np.float64]:
    """Noise in doubles: finite, of sigma > 0, of weights >= 0."""
    numbers = npy.doubles(file, values)
    row = first_row(numbers, lambda block: block <= 0 if name == "sigma" else block < 0)
    if row is not None:
        what = f"{name} {row} (counting from 0) is {numbers[row]}: "
        what += "give a standard deviation > 0" if name == "sigma" else "weights must be >= 0"
        message = f"{shown(file)}: {what}"
        raise InvalidFileError(message, path=file, row=row, column=name, value=float(numbers[row]))
    return numbers


def read_pair(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    pairing: Pairing = BY_LABEL,
    *,
    noise: bool = True,
) -> Pair:
    """Two clouds in correspondence: by the pairing, by label if both have them, else by row.

    noise: whether columns `sigma` and `weight` are read, unless the pairing ignores them.
    """
    if is_standard_input(source) and is_standard_input(target):
        message = "standard input holds one cloud: give a file for the other"
        raise InvalidFileError(message, path=Path(source))
    noise = noise and not pairing.ignore_weights
    return pair_of(read_cloud(source, noise=noise), read_cloud(target, noise=noise), pairing)


def pair_of(first: Cloud, second: Cloud, pairing: Pairing = BY_LABEL) -> Pair:
    """Two clouds in correspondence, as `read_pair`."""
    sizes = len(first.points), len(second.points)
    further = classes_note((first.path, second.path), first.labels, second.labels)
    if further:
        first, second = replace(first, labels=None), replace(second, labels=None)
    rows: tuple[Sequence[int] | NDArray[np.int64], ...]
    if pairing.pairs is not None:
        pairs = paired.read_pairs(pairing.pairs, sizes, one_to_one=pairing.one_to_one)
        rows = tuple(pairs.T)
        further += paired.repeated_rows_note(pairing.pairs, pairs)
    elif first.labels is not None and second.labels is not None:
        files = (first.path, second.path)
        rows = rows_by_label(first.labels, second.labels, pairing.match, files=files)
    elif first.times is not None and second.times is not None:
        timed = trajectories.rows_by_time(first.times, second.times, (first.path, second.path))
        rows, further = (timed.source, timed.target), (*further, timed.note)
    elif pairing.match is Match.COMMON:
        bare = first if first.labels is None else second
        message = f"{shown(bare.path)}: has no labels to match: name a column label, or give pairs"
        raise InvalidFileError(message, path=bare.path, column="label")
    elif sizes[0] != sizes[1]:
        message = (
            f"{shown(first.path)} has {sizes[0]} points, {shown(second.path)} has {sizes[1]}: "
            "without labels in both files row i pairs with row i, so both need the same number"
        )
        raise InvalidFileError(message, path=second.path, value=sizes[1], limit=sizes[0])
    else:
        require_same_rows(first, second)
        return Pair(source=first, target=second, source_rows=None, sizes=sizes, further=further)
    here, there = (np.asarray(side, dtype=np.int64) for side in rows)
    return Pair(
        source=_taken(first, here),
        target=_taken(second, there),
        source_rows=here,
        target_rows=there,
        sizes=sizes,
        left_out=(sizes[0] - len(np.unique(here)), sizes[1] - len(np.unique(there))),
        further=further,
    )


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
        and of other files a `certreg.io.SpringSource`.

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
    told = () if problem.springs is None else problem.springs.notes
    return problem, replace(pair, further=(*pair.further, *told))


def _paired_weights(
    weights: str | os.PathLike[str], source: str | os.PathLike[str], pair: Pair
) -> NDArray[np.float64]:
    """One weight per pair, from a file with one per row of the source."""
    numbers, n = read_weights(weights), pair.sizes[0]
    if len(numbers) != n:
        message = (
            f"{weights}: holds {len(numbers)} weights, {source} has {n} "
            "points: give one weight per row of the source"
        )
        raise InvalidFileError(message, path=Path(weights), value=len(numbers), limit=n)
    return numbers if pair.source_rows is None else numbers[pair.source_rows]


def read_weights(path: str | os.PathLike[str]) -> NDArray[np.float64]:
    """One weight per row of the source, from .npy or from text with one number a line."""
    file = Path(path)
    if file.suffix.lower() == ".npy":
        weights = npy.read_array(file)
        if weights.ndim != 1:
            message = f"{file}: holds an array of shape {weights.shape}: expected (N,)"
            raise InvalidFileError(message, path=file, value=weights.shape)
    else:
        weights = np.array(read_numbers(file), dtype=np.float64)
    if len(weights) == 0:
        message = f"{file}: holds no weights: give one number per row of the source"
        raise InvalidFileError(message, path=file, value=0, limit=1)
    row = first_row(weights, lambda block: block < 0)
    if row is not None:
        message = f"{file}: weight {row} (counting from 0) is {weights[row]}: weights must be >= 0"
        raise InvalidFileError(message, path=file, row=row, value=float(weights[row]), limit=0.0)
    if first_row(weights, lambda block: block > 0) is None:
        message = f"{file}: all weights are zero: give a positive weight to the points that count"
        raise InvalidFileError(message, path=file, value=0.0)
    return weights


def _taken(cloud: Cloud, rows: NDArray[np.int64]) -> Cloud:
    """The rows of a cloud, in the order given."""
    order: list[int] = rows.tolist()
    kept = cloud.labels
    labels = None if kept is None else tuple(kept[row] for row in order)
    return replace(
        cloud,
        points=cloud.points[rows],
        labels=labels,
        identifiers=labels,
        sigma=None if cloud.sigma is None else cloud.sigma[rows],
        weights=None if cloud.weights is None else cloud.weights[rows],
        times=None if cloud.times is None else cloud.times[rows],
        normals=None if cloud.normals is None else cloud.normals[rows],
        covariances=None if cloud.covariances is None else cloud.covariances[rows],
    )
