"""A cloud from a file. Strict: what is read is what was meant."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from certreg._loading import found_late, late
from certreg.io.cloud import Cloud
from certreg.io.optional import unknown_format
from certreg.io.streams import is_standard_input, reading, refused, standard_input
from certreg.io.text import TEXT_FORMATS, parse_points
from certreg.problem.arrays import first_row, remedy_of_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.io import npy

    Parser = Callable[[BinaryIO, Path], Cloud]
else:  # for arrays in files
    npy = late("certreg.io.npy")

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
        return _with_noise(PARSERS[suffix]()(stream, file), noise=noise)
    points = npy.parse_array(stream, file)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        what = f"holds an array of shape {points.shape}"
        remedy = remedy_of_shape(points.shape, "array")
        raise refused(file, f"{what}: expected (N, 3) with N >= 1{remedy}", value=points.shape)
    return Cloud(path=file, points=points)


def _with_noise(read: Cloud, *, noise: bool) -> Cloud:
    """A cloud with its noise checked, or named among what is not used."""
    columns = {"sigma": read.sigma, "weight": read.weights}
    given = {name: values for name, values in columns.items() if values is not None}
    if not noise:
        return replace(read, sigma=None, weights=None, ignored=(*read.ignored, *given))
    kept = {name: _checked_noise(read.path, name, values) for name, values in given.items()}
    return replace(read, sigma=kept.get("sigma"), weights=kept.get("weight"))


def _checked_noise(file: Path, name: str, values: NDArray[Any]) -> NDArray[np.float64]:
    """Noise in doubles: finite, of sigma > 0, of weights >= 0."""
    numbers = npy.doubles(file, values)
    row = first_row(numbers, lambda block: block <= 0 if name == "sigma" else block < 0)
    if row is not None:
        what = f"{name} {row} (counting from 0) is {numbers[row]}: "
        what += "give a standard deviation > 0" if name == "sigma" else "weights must be >= 0"
        raise refused(file, f"{what}", row=row, column=name, value=float(numbers[row]))
    return numbers
