"""Two clouds in correspondence: which row of one belongs to which row of the other."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import late
from certreg.errors import InvalidFileError
from certreg.io.cloud import Cloud, RowNumbers
from certreg.io.clouds import read_cloud
from certreg.io.columns import notes_on
from certreg.io.labels import (
    Match,
    are_short,
    classes_note,
    named_by_rows,
    require_same_order,
    rows_by_label,
    unused_labels_note,
)
from certreg.io.streams import is_standard_input, refused
from certreg.results import Brief
from certreg.verify import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.io import pairs as paired
    from certreg.io import trajectories
else:  # for a file of pairs, and for two of poses
    paired = late("certreg.io.pairs")
    trajectories = late("certreg.io.trajectories")


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
        raise InvalidFileError(
            "standard input holds one cloud: give a file for the other", path=Path(source)
        )
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
        raise refused(
            bare.path, "has no labels to match: name a column label, or give pairs", column="label"
        )
    elif sizes[0] != sizes[1]:
        raise InvalidFileError(
            f"{shown(first.path)} has {sizes[0]} points, {shown(second.path)} has {sizes[1]}: "
            "without labels in both files row i pairs with row i, so both need the same number",
            path=second.path,
            value=sizes[1],
            limit=sizes[0],
        )
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


def require_same_rows(source: Cloud, target: Cloud) -> None:
    """That rows which are to pair in order do not name the same points in another order.

    By the names that were read, or the numbers of large files. Raises InvalidFileError.
    """
    files = (source.path, target.path)
    require_same_order(source.identifiers, target.identifiers, files)
    if source.numbers is None and target.numbers is None:
        return
    here, there = (c.numbers or RowNumbers.of(c.identifiers) for c in (source, target))
    if here is not None and there is not None:
        _require_same(here, there, files)


def _require_same(source: RowNumbers, target: RowNumbers, files: tuple[Path, Path]) -> None:
    row = source.first_other(target)
    if row is None or source.sum != target.sum:
        return
    names = [shown(file) for file in files]
    here, there = source.column[row].item(), target.column[row].item()
    raise InvalidFileError(
        f"{names[0]} and {names[1]} number the same points in another order: point {row} (counting "
        f"from 0) is {here:.16g} and {there:.16g}, and files this large are not paired by "
        "label: give pairs, or sort both by it",
        path=files[1],
        row=row,
        value=there,
        limit=here,
    )
