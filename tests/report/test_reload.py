"""What a report made of a certificate says: no more than that certificate proves."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from certreg.certificate.bounds import PoseBounds
from certreg.certificate.envelope import KINDS
from certreg.report.reload import STORED, WEAKER, WITHOUT_POSE, _weaker

TINY, OWN = Fraction(1, 1 << 200), Fraction(1, 3)
MOST = Fraction(WEAKER) * OWN


def bounds(gap: Fraction, angle: float | None) -> PoseBounds:
    return PoseBounds(
        least_gap=Fraction(0), greatest_gap=gap, angle_upper=angle, least_range_squared=Fraction(1)
    )


@pytest.mark.parametrize(
    ("gap", "angle", "weaker"),
    [
        (OWN, 0.5, False),
        (MOST, WEAKER * 0.5, False),
        (MOST + TINY, 0.5, True),
        (OWN, math.nextafter(WEAKER * 0.5, math.inf), True),
        (OWN, None, True),
    ],
)
def test_a_certificate_that_proves_far_less_is_told_from_one_that_does_not(
    gap: Fraction, angle: float | None, weaker
):
    assert _weaker(bounds(gap, angle), bounds(OWN, 0.5)) is weaker
    assert _weaker(bounds(gap, angle), bounds(OWN, None)) is (gap > MOST)
    assert not _weaker(bounds(gap, angle), None)


def test_each_kind_of_certificate_is_read_again_or_has_no_pose():
    assert STORED.keys().isdisjoint(WITHOUT_POSE)
    assert STORED.keys() | WITHOUT_POSE.keys() == KINDS.keys()
