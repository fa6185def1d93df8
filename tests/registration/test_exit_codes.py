"""Exit codes: of several the one that must not be overlooked."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import pytest
from answers import answered
from commands import checked

from certreg.registration import exit_codes as codes
from certreg.registration.certification import certify
from certreg.registration.examples import STORIES, differences, stated
from certreg.registration.exit_codes import worst
from certreg.registration.headlines import HEADLINES
from certreg.results import Limits

if TYPE_CHECKING:
    from certreg.registration.headlines import Headline


def test_the_worst_code_is_the_first_of_2_1_4_3_0():
    order = [2, 1, 4, 3, 0]
    for one, other in product(order, order):
        assert worst([one, other]) == order[min(order.index(one), order.index(other))]


def test_the_codes_are_the_contract():
    named = (codes.DONE, codes.REFUSED, codes.MISUSED, codes.NOT_UNIQUE, codes.NOT_CERTIFIED)

    assert (*named, codes.DEFECT, codes.INTERRUPTED) == (0, 1, 2, 3, 4, 70, 130)


@pytest.mark.parametrize("headline", HEADLINES, ids=lambda one: one.stamp)
def test_a_headline_ends_with_the_code_of_what_it_says(headline: Headline):
    """Of `certify` 0 is what is certified, of `assess` what is at or near the optimum."""
    begun = {
        "CERTIFIED, BUT NOT UNIQUE": codes.NOT_UNIQUE,
        "CERTIFIED, BUT A SHIFT IS FREE": codes.NOT_UNIQUE,
        "CERTIFIED WITHIN THE LIMITS GIVEN, BUT NOT UNIQUE": codes.NOT_UNIQUE,
        "CERTIFIED": codes.DONE,
        "BOUNDED": codes.NOT_CERTIFIED,
        "NOT CERTIFIED": codes.NOT_CERTIFIED,
        "PROVED IN PART": codes.DONE,
        "OPTIMAL TO ROUNDING": codes.DONE,
        "NEAR-OPTIMAL": codes.DONE,
        "SPURIOUS-EQUILIBRIUM": codes.REFUSED,
        "NOT-AN-EQUILIBRIUM": codes.REFUSED,
        "NOT-A-ROTATION": codes.REFUSED,
    }
    expected = next(code for start, code in begun.items() if headline.stamp.startswith(start))

    assert headline.code == expected
    assert not headline.good or headline.stamp in {"CERTIFIED", "OPTIMAL TO ROUNDING"}


def test_one_headline_of_each_command_is_good():
    assert [one.stamp for one in HEADLINES if one.good] == ["CERTIFIED", "OPTIMAL TO ROUNDING"]


def test_a_packaged_problem_that_comes_out_otherwise_is_told_number_by_number():
    story = STORIES[0]
    registration = certify(stated(story), relaxation=False, simulation=False)
    components = registration.equilibria.components
    found = tuple(round(checked(one.rmse), 6) for one in components)

    assert list(differences(story, registration)) == []
    other = replace(story, told_rmse=(1.0, 2.0, 3.0, 4.0))
    assert list(differences(other, registration)) == [
        f"RMSE of the equilibria are {found}, told: (1.0, 2.0, 3.0, 4.0)"
    ]
    (words,) = differences(story, replace(registration, limits=Limits(max_gap=0.0)))
    assert words == "status is bounded, told: certified"


def test_each_way_in_which_a_story_differs_is_told_by_itself():
    story = STORIES[0]
    told = certify(stated(story), relaxation=False, simulation=False)

    def with_second(**values: object) -> Any:
        first, second, *others = told.equilibria.components
        parts = (first, replace(second, **values), *others)
        found = replace(told.equilibria, components=parts)
        return answered(told, equilibria=found)

    assert list(differences(story, told)) == []
    (status,) = differences(story, replace(told, verdict=None))
    assert status == "status is not-certified, told: certified"
    for wrong in ({"morse_index": 2}, {"unstable_eigenvalues": 2}, {"unstable_eigenvalues": None}):
        (index,) = differences(story, with_second(**wrong))
        assert index == f"equilibrium 1 has Morse index {wrong.get('morse_index', 1)}"
    for rmse in (719.674351, None):
        (sizes,) = differences(story, with_second(rmse=rmse))
        assert f"(5.838987, {rmse or 0.0}, " in sizes
    assert list(differences(story, with_second(rmse=719.6743504))) == []
