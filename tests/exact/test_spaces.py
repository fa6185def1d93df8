"""Eigenspaces are told apart with bits to spare, and with no more than the checker takes."""

from __future__ import annotations

import pytest

from certreg.exact.spaces import MAX_BITS, START_BITS, Space, resolved
from certreg.verify import DIGITS_MAX

SPARE = 32  # bits: the rounding of all the rotations of a run takes 20


def spaces_apart(gap: int):
    """Four axes whose neighbouring values differ by 2^-gap; one value where gap is 0."""

    def spaces_at(bits: int) -> tuple[Space, ...]:
        unit, step = 1 << bits, ((1 << bits) >> gap) if gap else 0
        rows = [tuple(unit * (i == k) for i in range(4)) for k in range(4)]
        return tuple(Space(values=(-k * step,), vectors=(row,)) for k, row in enumerate(rows))

    return spaces_at


@pytest.mark.parametrize("gap", [1, 30, 31, 32, 33, 47, 48, 100, 1000, 5000])
def test_a_pose_keeps_bits_to_spare_below_what_narrow_gaps_lose(gap: int):
    """A gap of 2^-g costs g bits of a vector, and a proof of it g more; below that is rounding."""
    found = resolved(spaces_apart(gap))

    assert found.bits >= found.pose_bits + gap + SPARE - 1
    assert found.pose_bits >= gap
    assert found.bits <= MAX_BITS


@pytest.mark.parametrize("gap", [0, 7000, 12000])
def test_what_cannot_be_told_apart_ends_within_the_integers_that_the_checker_takes(gap: int):
    found = resolved(spaces_apart(gap))

    assert found.bits == MAX_BITS > START_BITS
    for quaternion in found.quaternions:
        assert all(len(str(abs(entry))) <= DIGITS_MAX for entry in quaternion)
    assert len(str(1 << MAX_BITS + 2)) <= DIGITS_MAX
