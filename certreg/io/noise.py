"""Which noise a pair of clouds has, where their files have columns `sigma` or `weight`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, NamedTuple, Protocol, TypeVar

from certreg.io.streams import refused
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

Numbers = TypeVar("Numbers")
Read_co = TypeVar("Read_co", covariant=True)
REMEDY = "keep one of them, or give --sigma, --weights or --ignore-weights"


class Noisy(Protocol[Read_co]):
    """A cloud that was read; numbers of its rows, None where it has none."""

    @property
    def sigma(self) -> Read_co | None:
        """Standard deviations."""
        ...

    @property
    def weights(self) -> Read_co | None:
        """Weights."""
        ...


class ColumnNoise(NamedTuple, Generic[Numbers]):
    """Standard deviations, weights, or neither, one for each pair; and what to tell the user."""

    sigma: Numbers | None
    weights: Numbers | None
    notes: tuple[str, ...]


def noise_of_columns(
    source: Noisy[Numbers], target: Noisy[Numbers], files: tuple[Path, Path]
) -> ColumnNoise[Numbers]:
    """The one column of both clouds, already paired, that says how sure a pair is.

    Two of them are refused: which one holds, or whether both add up, no file says. Raises
    InvalidFileError.
    """
    sides = zip((source, target), files, strict=True)
    found = [
        (name, numbers, file)
        for cloud, file in sides
        for name, numbers in (("sigma", cloud.sigma), ("weight", cloud.weights))
        if numbers is not None
    ]
    if not found:
        return ColumnNoise(None, None, ())
    if len(found) > 1:
        stated = " and ".join(f"{name} of {shown(file)}" for name, _, file in found)
        raise refused(
            found[1][2], f"columns {stated}: which one holds? {REMEDY}", column=found[1][0]
        )
    ((name, numbers, file),) = found
    note = f"{shown(file)}: column {name} is used as "
    if name == "sigma":
        note += "the standard deviation of each pair (--ignore-weights: leave it)"
        return ColumnNoise(numbers, None, (note,))
    note += "the weight of each pair (--ignore-weights: leave it)"
    return ColumnNoise(None, numbers, (note,))
