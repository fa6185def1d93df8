"""What is said of listed equilibria of general springs: which is the best, and by which margin."""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest

from certreg.registration.equilibria import (
    NOT_LISTED_WHOLE,
    NOT_SEPARATED,
    SAME_ENERGY,
    TIED,
    _margin,
    _optimal,
)
from certreg.results import Guarantee

RANGE, TINY = Fraction(10), Fraction(1, 1 << 200)


def listed(*values: int | Fraction, tied: int = 1, **known: Any) -> Any:
    """A list of equilibria of these energies; known: of the last."""
    parts = [
        SimpleNamespace(value=Fraction(value), index=0, guarantee=Guarantee.ENCLOSED)
        for value in values
    ]
    complete = known.pop("complete", True)
    vars(parts[-1]).update(known)
    return SimpleNamespace(components=parts, tied=tied, complete=complete)


@pytest.mark.parametrize(
    ("values", "tied", "margin"),
    [
        ((1, 2, 5), 1, 0.25),
        ((-3, -1, 0, 7), 1, 0.2),
        ((1, 2), 1, 1.0),
        ((1, 2, 5), 0, None),
        ((1, 1, 5), 2, None),
        ((1,), 1, None),
        ((1, 1 - TINY, 5), 1, 0.0),  # of the same energy in all digits that are listed
    ],
)
def test_the_margin_is_a_share_of_all_energies_that_are_listed(
    values: tuple[int | Fraction, ...], tied: int, margin: float | None
):
    assert _margin(listed(*values, tied=tied)) == margin


@pytest.mark.parametrize(
    ("excess", "known", "expected"),
    [
        (Fraction(0), {}, True),
        (Fraction(0), {"tied": 2}, TIED),
        (Fraction(0), {"tied": 0}, TIED),
        (Fraction(0), {"complete": False}, NOT_LISTED_WHOLE),
        (Fraction(0), {"complete": False, "guarantee": Guarantee.NUMERICAL}, NOT_SEPARATED),
        (Fraction(0), {"index": 1}, False),
        (Fraction(0), {"index": None, "complete": False}, NOT_LISTED_WHOLE),
        (SAME_ENERGY * RANGE, {"complete": False}, NOT_LISTED_WHOLE),
        (SAME_ENERGY * RANGE, {"tied": 2}, TIED),
        (SAME_ENERGY * RANGE + TINY, {"complete": False}, False),
        (SAME_ENERGY * RANGE + TINY, {"tied": 2}, False),
        (
            SAME_ENERGY * RANGE + TINY,
            {"complete": False, "guarantee": Guarantee.NUMERICAL},
            NOT_SEPARATED,
        ),
    ],
)
def test_one_is_the_best_only_where_all_are_listed_and_none_ties(
    excess: Fraction, known: dict[str, Any], expected
):
    """Not the best is one from which the energy falls, or that is clearly above another."""
    assert _optimal(listed(3, **known), 0, excess, RANGE) is expected


@pytest.mark.parametrize("tied", [0, 1, 2, 3])
def test_beyond_those_that_may_be_the_best_none_is(tied: int):
    """However little their energies differ: that was decided in more digits."""
    critical = listed(3, 3, 3 + TINY, tied=tied)
    said = [_optimal(critical, place, Fraction(0), RANGE) for place in range(3)]

    assert (
        said
        == {
            0: [TIED, TIED, TIED],
            1: [True, False, False],
            2: [TIED, TIED, False],
            3: [TIED, TIED, TIED],
        }[tied]
    )
