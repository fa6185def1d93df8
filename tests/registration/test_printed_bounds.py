"""What was proved of a number holds of the printed one: tests on both sides of a decimal."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from test_consensus import certified
from test_truncated_results import certified as certified_rotation

from certreg.exact.dyadic import root_above
from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.registration.pair_words import ranges_words
from certreg.registration.weakly_constrained import WeakShift, weak_shift_words
from certreg.report.pairs import pairs_summary
from certreg.report.summary import registration_summary
from certreg.results import Limits

if TYPE_CHECKING:
    from certreg.registration.labelled import TruncatedRegistration


CLOUD = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])])
LONGER = np.vstack([np.diag([4.0, 2.0, 1.0]), -np.diag([4.0, 2.0, 1.0])])  # off by 1, twice
LINE = np.outer([1.0, 2.0, -3.0], [0.0, 0.0, 1.0])
TINY = Fraction(1, 10**30)


def test_a_bound_on_residuals_is_printed_as_it_was_given():
    """The identity brings all six pairs within 1; that none brings more than 5 is of less."""
    result = certified(CLOUD, LONGER, 0.9999996)

    assert result.upper == 5
    assert "no rigid motion brings more than 5 of the 6 pairs within 0.9999996;" in result.headline


@pytest.fixture(scope="module", params=["unique", "circle"])
def least(request: pytest.FixtureRequest) -> TruncatedRegistration:
    """Certified, of one single rotation and of a circle."""
    cloud = CLOUD[:4] if request.param == "unique" else LINE
    result = certified_rotation(cloud, cloud)
    assert result.unique == (request.param == "unique")
    return result


def valued(result: TruncatedRegistration, minimum: Fraction, objective: Fraction) -> Any:
    """With other numbers proved of its cost."""
    worth = replace(checked(result.verdict.worth), minimum=minimum, objective=objective)
    return replace(result, verdict=replace(result.verdict, weigh=lambda: worth))


@pytest.mark.slow
@pytest.mark.parametrize(("off", "told"), [(-TINY, "1.99999"), (0, "2"), (TINY, "2.00000")])
def test_no_smaller_cost_than_the_proved_minimum_is_denied(
    least: TruncatedRegistration, off: Fraction, told: str
):
    """The cost of the rotation itself, 3 here, is more: a smaller one is not ruled out."""
    line = valued(least, 2 + off, Fraction(3)).headline

    end = ", and" if least.unique else "; one single rotation is not proved"
    assert f"no rotation has a smaller truncated cost than {told}{end}" in line


@pytest.mark.slow
@pytest.mark.parametrize(("off", "told"), [(-TINY, "2.00000"), (0, "2"), (TINY, "2.00001")])
def test_a_cost_that_is_proved_in_part_is_at_most_the_printed_one(
    least: TruncatedRegistration, off: Fraction, told: str
):
    open_ = replace(least, labels=("undecided", *least.labels[1:]))

    assert valued(open_, Fraction(0), 2 + off).headline.startswith(
        f"PARTLY PROVED: the truncated cost is at most {told}, and less than "
    )


@pytest.mark.parametrize(
    ("share", "told"),
    [
        (math.nextafter(2.0**-24, 0.0), "6.0e-8"),  # 5.96...e-8
        (root_above(Fraction(12, 10**9) ** 2 - TINY), "1.2e-8"),
        (root_above(Fraction(12, 10**9) ** 2 + TINY), "1.3e-8"),
        (root_above(Fraction(1201, 10**11) ** 2), "1.3e-8"),
    ],
)
def test_springs_that_are_changed_by_the_printed_share_leave_a_shift_free(share: float, told: str):
    words = weak_shift_words([WeakShift(direction=np.eye(3)[0], share=share)])

    assert f"changed by as little as {told} of their size would leave it free" in words


@pytest.mark.parametrize("scales", [(0.1, 0.2), (1.0, 1.0), (2 / 3, 4 / 3), (1e-9, 12345678.9)])
def test_the_scales_that_are_open_are_between_the_printed_ones(scales: tuple[float, float]):
    for low, high in (scales, (math.nextafter(scales[0], 0.0), math.nextafter(scales[1], 9e9))):
        _, least, _, most = ranges_words([(low, high)]).split()

        assert Fraction(least) <= Fraction(low)
        assert Fraction(most) >= Fraction(high)


@pytest.mark.parametrize(
    ("limits", "told"),
    [
        (
            Limits(max_gap=1.23456749e-3, max_angle=0.0123456749),
            "within 0.00123456749 of the range of energies and 0.0123456749 radians",
        ),
        (Limits(max_gap=0.5, max_angle=3.0), "within 0.5 of the range of energies and 3 radians"),
    ],
)
def test_limits_are_printed_as_they_were_given(limits: Limits, told: str):
    found = certify(RegistrationProblem(CLOUD, LONGER), relaxation=False, simulation=False)
    found = replace(found, limits=limits)

    assert f"Certified means here {told} of the optimum." in registration_summary(found)


@pytest.mark.slow
def test_limits_of_truncated_squares_are_printed_as_they_were_given(least: TruncatedRegistration):
    fit = replace(least.fit, limits=Limits(max_gap=1.23456749e-3, max_angle=0.0123456749))
    words = pairs_summary(replace(least, fit=fit))

    assert "Certified means here within 0.00123456749 of the range of costs" in words
    assert (" and 0.0123456749 radians of the optimum." in words) == least.unique
