"""Clouds and weights from files, and clouds to files. Strict: what is read is what was meant."""

from __future__ import annotations

import csv
from array import array
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import InvalidFileError
from certreg.files import write_atomically
from certreg.io.npy import read_array, write_array
from certreg.io.text import (
    TEXT_FORMATS,
    Points,
    ignored_note,
    pair_by_label,
    read_numbers,
    read_points,
)
from certreg.problem import RegistrationProblem
from certreg.settings import DEFAULT_DAMPING
from certreg.verify import shown

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

BINARY_FORMATS = (".npy",)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cloud:
    """Points read from a file: (N, 3), labels if the file has them, names of columns not read."""

    path: Path
    points: NDArray[np.float64]
    labels: tuple[str, ...] | None
    ignored: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pair:
    """Two clouds in correspondence, row i with row i, after pairing by label."""

    source: Cloud
    target: Cloud

    @property
    def notes(self) -> list[str]:
        """What the user should know about how the files were read."""
        notes = (ignored_note(c.path, c.ignored) for c in (self.source, self.target))
        return [note for note in notes if note is not None]


def read_cloud(path: str | os.PathLike[str]) -> Cloud:
    """A cloud from a .csv, .txt or .npy file. Raises InvalidFileError: file, place, remedy."""
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix in TEXT_FORMATS:
        return _cloud(file, read_points(file))
    if suffix in BINARY_FORMATS:
        points = read_array(file)
        if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
            message = f"{file}: holds an array of shape {points.shape}: expected (N, 3) with N >= 1"
            raise InvalidFileError(message)
        return Cloud(path=file, points=points, labels=None, ignored=())
    known = " ".join((*TEXT_FORMATS, *BINARY_FORMATS))
    message = f"{file}: the format {suffix or '(none)'} is not known: use one of {known}"
    raise InvalidFileError(message)


def read_pair(source: str | os.PathLike[str], target: str | os.PathLike[str]) -> Pair:
    """Two clouds in correspondence: by label where both files have labels, else by row."""
    first, second = read_cloud(source), read_cloud(target)
    if first.labels is not None and second.labels is not None:
        ordered = pair_by_label(_as_points(first), _as_points(second))
        return Pair(source=first, target=_cloud(second.path, ordered))
    if len(first.points) != len(second.points):
        message = (
            f"{first.path} has {len(first.points)} points, {second.path} has "
            f"{len(second.points)}: without labels in both files row i pairs with row i, "
            "so both need the same number"
        )
        raise InvalidFileError(message)
    return Pair(source=first, target=second)


def read_problem(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    *,
    sigma: float | None = None,
    weights: str | os.PathLike[str] | None = None,
    damping: float = DEFAULT_DAMPING,
) -> tuple[RegistrationProblem, Pair]:
    """The problem that two cloud files state, and how they were read."""
    pair = read_pair(source, target)
    numbers = None if weights is None else read_weights(weights)
    if numbers is not None and len(numbers) != len(pair.source.points):
        message = (
            f"{weights}: holds {len(numbers)} weights, {source} has {len(pair.source.points)} "
            "points: give one weight per row of the source"
        )
        raise InvalidFileError(message)
    problem = RegistrationProblem(
        pair.source.points, pair.target.points, sigma=sigma, weights=numbers, damping=damping
    )
    return problem, pair


def read_weights(path: str | os.PathLike[str]) -> NDArray[np.float64]:
    """One weight per row of the source, from .npy or from text with one number a line."""
    file = Path(path)
    if file.suffix.lower() in BINARY_FORMATS:
        weights = read_array(file)
        if weights.ndim != 1:
            message = f"{file}: holds an array of shape {weights.shape}: expected (N,)"
            raise InvalidFileError(message)
    else:
        weights = np.array(read_numbers(file), dtype=np.float64)
    if len(weights) == 0:
        message = f"{file}: holds no weights: give one number per row of the source"
        raise InvalidFileError(message)
    if (weights < 0).any():
        row = int(np.argmax(weights < 0))
        message = f"{file}: weight {row} (counting from 0) is {weights[row]}: weights must be >= 0"
        raise InvalidFileError(message)
    if not weights.any():
        message = f"{file}: all weights are zero: give a positive weight to the points that count"
        raise InvalidFileError(message)
    return weights


def write_cloud(
    path: str | os.PathLike[str], points: NDArray[np.float64], labels: tuple[str, ...] | None
) -> None:
    """Write a cloud as .csv (labels kept), .txt or .npy; text round-trips every double."""
    file = Path(path)
    suffix = file.suffix.lower()
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        row = int(np.argmin(finite))
        message = (
            f"{file}: row {row} (counting from 0) would be {points[row].tolist()}, beyond the "
            "doubles: change the unit of length"
        )
        raise InvalidFileError(message)
    if suffix == ".npy":
        write_array(file, points)
        return
    if suffix not in TEXT_FORMATS:
        message = f"{file}: the format {suffix or '(none)'} cannot be written: use .csv .txt .npy"
        raise InvalidFileError(message)
    separator = "," if suffix == ".csv" else " "
    rows = [separator.join(map(repr, row)) for row in points.tolist()]
    if suffix == ".csv":
        names = None if labels is None else [_quoted(file, label) for label in labels]
        rows = rows if names is None else [f"{n},{r}" for n, r in zip(names, rows, strict=True)]
        rows.insert(0, "x,y,z" if labels is None else "label,x,y,z")
    write_atomically(file, ("\n".join(rows) + "\n").encode())


def _quoted(file: Path, label: str) -> str:
    """A label as a field of a .csv file; refused where the reader would not give it back."""
    kept = label == label.strip() and "\n\ufeff" not in label
    kept = kept and label == label.encode(errors="ignore").decode()
    if not kept or len(label) > csv.field_size_limit():
        message = (
            f"{file}: the label '{shown(label)}' cannot be written: use labels of Unicode text "
            "without spaces at their ends"
        )
        raise InvalidFileError(message)
    return '"' + label.replace('"', '""') + '"' if set(label) & set(',"\r\n\ufeff') else label


def _cloud(file: Path, points: Points) -> Cloud:
    coordinates = np.array(points.coordinates, dtype=np.float64).reshape(-1, 3)
    return Cloud(path=file, points=coordinates, labels=points.labels, ignored=points.ignored)


def _as_points(cloud: Cloud) -> Points:
    return Points(array("d", cloud.points.tobytes()), cloud.labels, cloud.ignored)
