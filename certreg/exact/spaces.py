"""Linear spaces of quaternions, to as many bits as it takes to tell their values apart.

For a function on quaternions that is constant on each of finitely many linear spaces, known to be
distinct: eigenspaces, fibres of an elimination, single roots. Whatever yields them to any number of
bits is asked until the values are well apart, however close they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

from certreg._loading import cached_property
from certreg.results import Brief

IntegerQuaternion = tuple[int, int, int, int]

START_BITS = 192  # two sweeps from doubles; a second pass for relative gaps below 2^-32
POSE_BITS = 96  # proved angle about 2^-94 where the gap is of the order of the values
GUARD_BITS = 32  # more than the rounding of all the rotations of a run
MAX_BITS = 12288  # 3,700 digits: the checker takes integers of up to 4,300
AXIS_BITS = (
    32  # a square of 2^-32 of the unit tells an axis that a space reaches from one it misses
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Space(Brief):
    """A space of quaternions with one value, in fixed point.

    vectors: orthonormal. values: at each of them, equal but for the last places.
    """

    values: tuple[int, ...]
    vectors: tuple[tuple[int, ...], ...]

    @property
    def value(self) -> int:
        """The mean of the values, rounded down."""
        count = len(self.values)
        return sum(self.values) // count if count > 1 else self.values[0]


@dataclass(frozen=True, kw_only=True)
class Resolution(Brief):
    """Spaces by descending value, told apart.

    bits: fractional bits of vectors and values. pose_bits: to which a quaternion of a space is
    worth writing down: the fewer, the closer the values.
    """

    spaces: tuple[Space, ...]
    bits: int
    pose_bits: int

    @cached_property
    def quaternions(self) -> tuple[IntegerQuaternion, ...]:
        """The member of each space nearest to the identity, else to a half turn, in integers.

        A space whose turns are all within 2^-15 of a half turn counts as one of half turns.
        """
        return (self.first, *map(self._representative, self.spaces[1:]))

    @cached_property
    def first(self) -> IntegerQuaternion:
        """The one of the space of the largest value."""
        return self._representative(self.spaces[0])

    def _representative(self, space: Space) -> IntegerQuaternion:
        vectors = space.vectors
        if len(vectors) == 1:
            combined = list(vectors[0])
        else:
            reach = [sum(v[axis] * v[axis] for v in vectors) for axis in range(4)]
            axis = 0 if reach[0] >> (2 * self.bits - AXIS_BITS) else reach.index(max(reach))
            combined = [sum(v[axis] * v[k] for v in vectors) >> self.bits for k in range(4)]
        norm = math.isqrt(sum([entry * entry for entry in combined]))
        half = norm >> 1
        q = [((entry << self.pose_bits) + half) // norm for entry in combined]
        sign = next(1 if entry > 0 else -1 for entry in q if entry)
        return (sign * q[0], sign * q[1], sign * q[2], sign * q[3])


def resolved(spaces_at: Callable[[int], tuple[Space, ...]]) -> Resolution:
    """Spaces that can be had to any number of bits, to as many as it takes."""
    bits = START_BITS
    while True:
        spaces = spaces_at(bits)
        lost = bits - _narrowest_gap(spaces, bits).bit_length()
        pose_bits = POSE_BITS + lost
        needed = pose_bits + lost + GUARD_BITS
        if needed <= bits or bits >= MAX_BITS:
            return Resolution(spaces=spaces, bits=bits, pose_bits=min(pose_bits, bits))
        bits = min(max(needed, 2 * bits), MAX_BITS)


def _narrowest_gap(spaces: tuple[Space, ...], bits: int) -> int:
    """The least difference of neighbouring values, in fixed point; full scale if alone."""
    gaps = [upper - lower for upper, lower in pairwise([space.value for space in spaces])]
    return max(1, min(gaps, default=1 << bits))
