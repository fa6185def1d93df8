"""What general springs leave undetermined, exactly, and in words.

A shift along the kernel of sum W costs nothing at any rotation. A turn costs nothing where it is a
continuous symmetry of the energy: R -> exp(s [a]) R exp(s [b]), a in the target's frame, b in the
source's. Fixed by it are the rotations with a + R b = 0; unless |a| = |b| there are none, and then
every optimum is moved, so that it is not the only one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from math import hypot
from typing import TYPE_CHECKING

import numpy as np

from certreg.exact.elimination import nullspace
from certreg.geometry.so3 import dot
from certreg.registration.loose_turns import axes_words, axis_words
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.objective.springs import Springs

AXIS = "target's axis"
GROUP = 6  # the dimension of the symmetries of an energy that is the same at every rotation


@dataclass(frozen=True, slots=True, kw_only=True)
class Freedom(Brief):
    """What the springs leave undetermined.

    translations: directions of shifts that no spring resists, linearly independent integers.
    symmetry: a basis of the turns (a, b) along which the energy is constant, six integers each.
    """

    translations: tuple[tuple[int, ...], ...]
    symmetry: tuple[tuple[int, ...], ...]

    @classmethod
    def of(cls, objective: Springs) -> Freedom:
        """Of the springs of an objective."""
        shifts = tuple(tuple(map(int, shift)) for shift in objective.free_translations)
        return cls(translations=shifts, symmetry=objective.symmetry)

    @property
    def flat(self) -> bool:
        """Whether every rotation fits equally."""
        return len(self.symmetry) == GROUP

    @property
    def moves_optimum(self) -> bool:
        """Whether a symmetry surely moves every optimum. False means not proved, not disproved."""
        pairs = combinations_with_replacement(self.symmetry, 2)
        return any(dot(g[:3], h[:3]) != dot(g[3:], h[3:]) for g, h in pairs)

    @property
    def target_axis(self) -> tuple[int, ...] | None:
        """The target's axis about which every turn is free; None without one."""
        return self._alone(slice(3, 6), slice(0, 3))

    @property
    def source_axis(self) -> tuple[int, ...] | None:
        """The source's axis about which every turn is free; None without one."""
        return self._alone(slice(0, 3), slice(3, 6))

    def _alone(self, none: slice, some: slice) -> tuple[int, ...] | None:
        """The turns of which one half vanishes: a line of them at most, but where all are free."""
        if self.flat or not self.symmetry:
            return None
        columns = list(zip(*(one[none] for one in self.symmetry), strict=True))
        shares = nullspace(columns, len(self.symmetry))
        if not shares:
            return None
        halves = list(zip(*(one[some] for one in self.symmetry), strict=True))
        return tuple(dot(shares[0], entries) for entries in halves)

    def shifts(self) -> list[list[float]]:
        """The free translations as unit vectors."""
        return [_unit(shift).tolist() for shift in self.translations]

    def shift_words(self) -> str:
        """That a shift is free, and along what; empty where none is."""
        if not self.translations:
            return ""
        along = axes_words([_unit(one) for one in self.translations])
        return f"no spring resists a shift along {along}"

    def turn_words(self) -> str:
        """Which turns are free; empty where none is known to be."""
        if self.flat:
            return "every rotation fits equally"
        own, other = self.target_axis, self.source_axis
        axes = [self._name(own)] if own else []
        axes += [f"the source's axis {axis_words(_unit(other))}"] if other else []
        if axes:
            return f"rotation about {' and about '.join(axes)} is undetermined"
        if self.moves_optimum:
            return "a turn of the source together with one of the target changes nothing"
        return ""

    def _name(self, axis: Sequence[int]) -> str:
        """The normal, where all springs are planes of one direction: the only one they resist."""
        kind = "normal" if len(self.translations) == 2 else AXIS
        return f"the {kind} {axis_words(_unit(axis))}"

    def words(self) -> str:
        """All that is free; empty where nothing is known to be."""
        return ", and ".join(filter(None, (self.turn_words(), self.shift_words())))


def _unit(axis: Sequence[int]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    largest = max(map(abs, axis))
    entries = [entry / largest for entry in axis]
    length = hypot(*entries)
    return np.array([entry / length for entry in entries])
