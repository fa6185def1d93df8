"""Eigenspaces are told apart with bits to spare, and with no more than the checker takes."""

from __future__ import annotations

from math import isqrt

import pytest

from certreg.exact.spaces import (
    MAX_BITS,
    START_BITS,
    Resolution,
    Space,
    _narrowest_gap,
    resolved,
)
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


@pytest.mark.parametrize("noise", [0, 1, -3])
def test_a_representative_is_a_half_turn_where_only_rounding_reaches_the_identity(noise: int):
    """The span of x + y and z, with a few last places of w."""
    bits, root = START_BITS, isqrt(1 << 2 * START_BITS - 1)
    space = Space(values=(0, 0), vectors=((noise, root, root, 0), (-noise, 0, 0, 1 << bits)))
    found = Resolution(spaces=(space,), bits=bits, pose_bits=64)
    expected = (0, 0, 0, 1 << 64)

    assert all(abs(a - b) <= 8 for a, b in zip(found.quaternions[0], expected, strict=True))


def test_a_representative_is_nearest_to_the_identity_where_a_member_reaches_it():
    """The span of w + x and y: of all unit members (w + x) / sqrt 2 has the largest w."""
    bits, root = START_BITS, isqrt(1 << 2 * START_BITS - 1)
    space = Space(values=(0, 0), vectors=((-root, -root, 0, 0), (0, 0, 1 << bits, 0)))
    (found,) = Resolution(spaces=(space,), bits=bits, pose_bits=64).quaternions

    assert found[0] == found[1]
    assert abs(found[0] - isqrt(1 << 127)) <= 1
    assert found[2:] == (0, 0)


@pytest.mark.parametrize("gap", [0, 7000, 12000, 13000])
def test_what_cannot_be_told_apart_ends_within_the_integers_that_the_checker_takes(gap: int):
    found = resolved(spaces_apart(gap))

    assert found.bits == MAX_BITS > START_BITS
    assert found.pose_bits <= found.bits
    for quaternion in found.quaternions:
        assert all(len(str(abs(entry))) <= DIGITS_MAX for entry in quaternion)
    assert len(str(1 << MAX_BITS + 2)) <= DIGITS_MAX


def test_the_narrowest_gap_is_that_of_neighbours_and_a_space_alone_fills_the_scale():
    def gap(*values: int) -> int:
        return _narrowest_gap(tuple(Space(values=(v,), vectors=((1,),)) for v in values), 5)

    assert gap(10, 7, 1) == gap(20, 14, 11) == 3
    assert gap(4, 4) == 1
    assert gap(4) == 32
