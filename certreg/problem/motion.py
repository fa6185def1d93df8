"""The motion: shift or not, scale or not, with its two objectives; and how it is damped."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar

from certreg.errors import InvalidProblemError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


T = TypeVar("T")
Count = TypeVar("Count", int, float)  # floats: of rows of unequal weights
DEFAULT_DAMPING = math.sqrt(8.0)  # critical damping of every mode of noise-free data: 2 sqrt(2)
MIN_DAMPING, MAX_DAMPING = 1e-150, 1e150  # their squares, in the spectrum, are doubles


@dataclass(frozen=True, slots=True)
class Unknown:
    """What a motion finds. count: how many numbers it is."""

    name: str
    count: int

    @property
    def plural(self) -> str:
        """Of its name."""
        return f"{self.name}s"


ROTATION, TRANSLATION = Unknown("rotation", 3), Unknown("translation", 3)
SCALE = Unknown("scale", 1)


class Scale(StrEnum):
    """Whether the scale is free, and what the best one minimises.

    NONE: it is 1.
    ASYMMETRIC: s >= 0 of least sum w |y - s R x - t|^2 [Umeyama1991]. Noise in the source makes it
        smaller, by the factor Sxx / (Sxx + noise); noise in the target does not change it.
    SYMMETRIC: s > 0 of least sum w |y - s R x - t|^2 / s, which is sqrt(Syy / Sxx) [Horn1987]:
        right where both clouds have the same relative noise, too large with noise in the target
        alone.
    """

    NONE = "none"
    ASYMMETRIC = "asymmetric"
    SYMMETRIC = "symmetric"

    @property
    def free(self) -> bool:
        """Whether it is found."""
        return bool(SCALES[self])

    @property
    def divides(self) -> bool:
        """Whether the squares are minimised over the scale, and are not the least ones then."""
        return self is Scale.SYMMETRIC


SCALES: Mapping[Scale, tuple[Unknown, ...]] = {  # what is found of each
    Scale.NONE: (),
    Scale.ASYMMETRIC: (SCALE,),
    Scale.SYMMETRIC: (SCALE,),
}


class MotionArguments(TypedDict):
    """A motion as users name it."""

    scale: Scale
    rotation_only: bool


@dataclass(frozen=True, slots=True)
class Motion:
    """How the source may move: it turns; it shifts, or not; its scale is free, or not.

    translations: how many numbers of a translation are found, 3 or 0.
    """

    scale: Scale = Scale.NONE
    translations: int = TRANSLATION.count

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """What is found: rotation, translation, scale, in this order."""
        return (ROTATION, *[TRANSLATION] * bool(self.translations), *SCALES[self.scale])

    def centred(self, sums: Iterable[int], *first: slice) -> list[int]:
        """Sums over points with those of first order: 0 where nothing shifts, about the origin."""
        found = list(sums)
        for place in first if not self.translations else ():
            found[place] = [0] * len(found[place])
        return found

    @property
    def axes(self) -> range:
        """Along which of three it shifts."""
        return range(self.translations)

    @property
    def scales(self) -> int:
        """How many numbers of a scale are found."""
        return sum(unknown.count for unknown in SCALES[self.scale])

    @property
    def parameters(self) -> int:
        """How many numbers of a pose are found: the only place where they are counted."""
        return sum(unknown.count for unknown in self.unknowns)

    @property
    def rigid(self) -> bool:
        """Whether it turns and shifts, and no more: a rigid body in space."""
        return self == Motion()

    def degrees(self, observations: Count) -> Count:
        """Of freedom of so many residuals, all parameters counted; below zero of too few."""
        return observations - self.parameters

    def parameters_given(self, *, translation: bool) -> int:
        """Of a pose that is judged: those of the best translation for it do not count."""
        return self.parameters - (0 if translation else self.translations)

    @property
    def arguments(self) -> MotionArguments:
        """What a user gives for it, and what a certificate states of it."""
        return {"scale": self.scale, "rotation_only": not self.translations}

    @property
    def options(self) -> str:
        """What to type for such a problem, as the checker says it."""
        scale = [f"--scale {self.scale.value}"] * self.scales
        return " ".join([*scale, *["--rotation-only"] * (not self.translations)])

    @property
    def words(self) -> tuple[str, ...]:
        """What it has that others have not, or has not."""
        scale = [f"{self.scale.value} scale"] * self.scales
        return (*scale, *["rotation only"] * (not self.translations))

    def entries(self, table: Iterable[tuple[Unknown, T]]) -> list[T]:
        """What a table has of the unknowns that are found, in its order."""
        own = self.unknowns
        return [entry for unknown, entry in table if unknown in own]

    def lacking(self, table: Iterable[tuple[Unknown, T]]) -> list[T]:
        """What it has of those that are not."""
        own = self.unknowns
        return [entry for unknown, entry in table if unknown not in own]


def checked_motion(scale: Any, rotation_only: Any) -> Motion:
    """A motion as users name it; raises InvalidProblemError for others."""
    return Motion(checked_scale(scale), 0 if checked_rotation_only(rotation_only) else 3)


def checked_scale(scale: Any) -> Scale:
    """A scale by its name; raises InvalidProblemError for others."""
    try:
        return Scale(scale)
    except ValueError as error:
        raise InvalidProblemError(
            f"scale is {scale!r}: give {', '.join(map(repr, map(str, Scale)))}",
            array="scale",
            value=scale,
        ) from error


def checked_rotation_only(rotation_only: Any) -> bool:
    """True or False; raises InvalidProblemError for others."""
    if not isinstance(rotation_only, bool):
        raise InvalidProblemError(
            f"rotation_only is {rotation_only!r}: give True or False",
            array="rotation_only",
            value=rotation_only,
        )
    return rotation_only


def checked_damping(damping: Any) -> float:
    """A damping mu > 0 as a double; raises InvalidProblemError for anything else."""
    try:
        value = float(damping)
    except (TypeError, ValueError, OverflowError):
        value = math.nan
    if isinstance(damping, str) or not MIN_DAMPING <= value <= MAX_DAMPING:
        message = f"damping is {damping!r}: it must be a positive finite number, 1e-150 to 1e150"
        raise InvalidProblemError(
            message, array="damping", value=damping, limit=(MIN_DAMPING, MAX_DAMPING)
        )
    return value
