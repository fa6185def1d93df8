"""What to do about a warning, why much is explained beside it, and colours that do not alarm."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from commands import checked

from certreg.problem.bounds import MOST_PAIRS
from certreg.problem.problem import RegistrationProblem
from certreg.registration.ambiguity import NEARLY_AMBIGUOUS
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.misfits import PROVE_WRONG
from certreg.report.cards import registration_card
from certreg.report.document import result_document
from certreg.report.judged_pose import assessment_summary
from certreg.report.lines import OF_PRINTED, number
from certreg.report.overview import ABOVE, Overview
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.pose_facts import SAME
from certreg.report.remedies import (
    FIX_TURN,
    GIVE_SIGMA,
    SINGLE_OUT,
    TELL_APART,
    WIDEN,
    causes,
    remedies,
)
from certreg.report.summary import registration_summary
from certreg.report.viewer import FAR_MEDIANS, FAR_SIGMAS, Names, colours_end, scene_document
from certreg.results import Limits

RNG = np.random.default_rng(11)
CLOUD = RNG.standard_normal((30, 3)) * [3.0, 2.0, 1.0]
NOISE = 0.01 * RNG.standard_normal((30, 3))
GOOD = CLOUD + NOISE
NAMES = Names(source="a", target="b", labels=None)


def moved(*rows: int) -> np.ndarray:
    return GOOD + 5.0 * np.isin(np.arange(30), rows)[:, None]


def proved(source: object, target: object, **options: object):
    problem = RegistrationProblem(source, target, **options)  # pyright: ignore[reportArgumentType]
    return certify(problem, relaxation=False, simulation=False)


CASES = {  # a spoilt target, its sigma, and the whole of what is advised
    "mm": (1000.0 * GOOD, None, "if the units differ, multiply the target by 0.001 and certify"),
    "m": (0.001 * GOOD, None, "if the units differ, multiply the target by 1000 and certify again"),
    "scale": (
        1.25 * GOOD,
        None,
        r"if the sizes may differ, certify with --scale, or multiply the target by 0\.80\d+",
    ),
    "row": (moved(5), None, "check row 5; if it is wrong, mend it or leave it out, and certify"),
    "rows": (
        moved(5, 7),
        None,
        r"check rows \d, \d; if they are wrong, mend them or leave them out",
    ),
    "three": (moved(5, 7, 9), None, r"check rows \d, \d, \d; if they are wrong"),
    "more": (moved(5, 7, 9, 11), None, "check these rows; if they are wrong, mend them or leave"),
    "rolled": (np.roll(GOOD, 1, axis=0), None, "check that row k of both clouds is one pair, or"),
    "mirrored": (GOOD * [1, 1, -1], None, "check the signs and the order of the axes in both"),
    "sigma": (
        CLOUD + 10.0 * NOISE,
        0.01,
        r"check the pairs, and whether .* one rigid shape; if the noise may be larger, give \d",
    ),
    "poor": (RNG.standard_normal((30, 3)), None, "check the pairs, and whether both clouds show"),
}


@pytest.mark.parametrize("case", CASES)
def test_each_warning_says_what_may_be_done(case: str):
    target, sigma, words = CASES[case]
    fit = proved(CLOUD, target, **({} if sigma is None else {"sigma": sigma})).fit
    (remedy, *_) = [warning.remedy for warning in fit.warnings]

    assert re.match(words, remedy)
    assert remedy.startswith(("check ", "if "))  # no cause is known: advice has a condition
    assert not remedy.endswith(".")


@pytest.mark.parametrize("n", [MOST_PAIRS, MOST_PAIRS + 1])
def test_bounds_are_advised_where_labels_can_be_proved(n: int):
    """Of as many pairs as `bounded` takes, and not of one more."""
    far = 5.0 * (np.arange(n) == 5)[:, None]
    (told,) = proved(np.resize(CLOUD, (n, 3)), np.resize(GOOD, (n, 3)) + far).fit.warnings

    assert told.remedy.startswith("check row 5; if it is wrong, mend it or leave it out, and cert")
    assert told.remedy.endswith(PROVE_WRONG) == (n <= MOST_PAIRS)


def test_the_factor_advised_makes_the_scale_one():
    fit = proved(CLOUD, 1.25 * GOOD).fit
    factor = float(fit.warnings[0].remedy.split("target by ")[1].split()[0])

    assert factor * checked(fit.best_scale) == pytest.approx(1.0, abs=1e-5)
    assert not proved(CLOUD, factor * 1.25 * GOOD).fit.warnings


def test_it_stands_in_text_page_card_json_and_assessment():
    poor = proved(CLOUD, moved(5))
    (remedy,) = [warning.remedy for warning in poor.fit.warnings]
    line = f"What to do: {remedy}."
    page = html_page(Report.of(poor)).decode().split("<main>")[0]

    assert remedies(poor) == [f"{remedy}."]
    assert f"\n{line}\n" in registration_summary(poor)
    assert f"<b>What to do:</b> C{remedy[1:]}." in page
    assert line in registration_card(poor)
    assert result_document(poor)["fit"]["warnings"][0]["remedy"] == remedy
    assert line in assessment_summary(assess(poor.problem, poor.pose))
    assert "What to do" not in registration_summary(proved(CLOUD, GOOD))


def test_a_rotation_that_hardly_stands_has_advice_too():
    thin = CLOUD * [1.0, 1e-3, 1e-3]
    near = proved(thin, thin + 5.0 * NOISE)
    known = proved(thin, thin + 5.0 * NOISE, sigma=0.05)
    page = html_page(Report.of(near)).decode()

    assert near.equilibria.nearly_ambiguous
    assert remedies(near) == [f"{GIVE_SIGMA}{TELL_APART}."]
    assert remedies(known) == [f"{TELL_APART}."]
    assert (
        "<h1>A very different pose costs little more beside the range of energies: do not rely "
        "on the rotation.</h1>" in page
    )
    assert '<p class="lead">Proved: the global optimum of exactly these numbers' in page


@pytest.mark.parametrize("model", [{"rotation_only": True}, {"scale": "asymmetric"}])
def test_sigma_is_no_remedy_where_no_noise_rules_a_pose_out(model: dict):
    thin = CLOUD * [1.0, 1e-3, 1e-3]
    near = proved(thin, thin + 5.0 * NOISE, **model)

    assert near.equilibria.nearly_ambiguous
    assert remedies(near) == [f"{TELL_APART}."]
    assert causes(near) == [NEARLY_AMBIGUOUS]


def test_a_cause_stands_beside_each_remedy_of_a_rotation_that_hardly_stands():
    thin = CLOUD * [1.0, 1e-3, 1e-3]
    line = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])

    assert causes(proved(thin, thin + 5.0 * NOISE)) == [NEARLY_AMBIGUOUS]
    (cause,) = causes(proved(line, line))
    assert cause == (
        "Not unique: the source points are collinear: turning the body about its own line changes "
        "nothing."
    )
    assert causes(proved(CLOUD, GOOD, sigma=10.0)) == []  # the headline says it
    assert causes(proved(CLOUD, GOOD)) == []


def test_a_loose_turn_has_advice_too():
    loose = proved(CLOUD, GOOD, sigma=10.0)

    line = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])

    assert remedies(loose) == [f"{FIX_TURN}."]
    assert remedies(proved(line, line)) == [f"{SINGLE_OUT}."]


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("row", ": most rows fit, the warning is of the others"),
        ("sigma", "; the residuals are small beside the spread, and large beside sigma"),
        ("mirrored", "; a mirror image explains more"),
        ("poor", ""),
    ],
)
def test_a_poor_fit_that_explains_much_says_why(case: str, words: str):
    target, sigma, _ = CASES[case]
    poor = proved(CLOUD, target, **({} if sigma is None else {"sigma": sigma}))
    (told,) = [fact for fact in Overview.of(poor).fit if fact.name == "Explained"]

    assert told.words.endswith(f"best scale){words}")
    assert f"(R squared, with the best scale){words}\n" in registration_summary(poor)


def test_colours_end_at_what_a_sound_fit_does_not_have():
    good, given = proved(CLOUD, GOOD), proved(CLOUD, GOOD, sigma=0.01)
    worst, ratio = good.fit.worst[0].residual, checked(good.fit.largest_over_median_residual)

    assert colours_end(good)["words"] == "6 × the median"
    assert colours_end(good)["end"] == pytest.approx(FAR_MEDIANS * worst / ratio)
    assert colours_end(good)["end"] > worst
    assert colours_end(given) == {"end": pytest.approx(0.01 * FAR_SIGMAS), "words": "10 σ"}
    assert colours_end(proved(CLOUD, moved(5))) == {"end": None, "words": "the largest"}
    assert colours_end(proved(CLOUD, 1000.0 * GOOD)) == {"end": None, "words": "the largest"}
    uneven = proved(CLOUD, GOOD, sigma=np.linspace(0.01, 0.02, 30))
    assert colours_end(uneven)["words"] == "6 × the median"


def test_one_rmse_is_told_where_all_are_rounding():
    line = np.linspace(0.0, 1.0, 12)[:, None] * [1.0, 2.0, 3.0]
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    exact = proved(line, line @ turn.T + 1.0)
    scene = scene_document(exact, NAMES)
    (told,) = [fact for fact in Overview.of(exact).fit if fact.name == "RMSE"]

    assert scene["rounded"]
    assert scene["components"][0]["rmse"] == told.value == number(exact.rmse)
    assert told.words == "in the unit of the clouds, at rounding"
    page = html_page(Report.of(exact)).decode().split("<script")[0]
    assert page.count(told.value) == 3  # fit, pose at rest, how wrong the worst is
    assert number(exact.equilibria.components[0].rmse) not in page
    assert "times the optimum" not in page
    assert told.value not in {number(exact.equilibria.components[0].rmse), "0.000000"}
    assert OF_PRINTED in registration_summary(exact)
    assert OF_PRINTED not in registration_summary(proved(CLOUD, GOOD))
    bounded = replace(proved(CLOUD, GOOD), limits=Limits(max_gap=0.0))
    best = checked(bounded.equilibria.components[0].rmse)
    assert math.isclose(
        float(scene_document(bounded, NAMES)["components"][0]["rmse"]), best, abs_tol=1e-6
    )


def test_a_small_margin_has_a_remedy_and_no_green_word_beside_it():
    thin = CLOUD * [1.0, 0.02, 0.02]
    narrow, sound = proved(thin, thin + 0.01 * NOISE), proved(CLOUD, GOOD)
    told = Overview.of(narrow)

    assert narrow.equilibria.narrow
    assert not narrow.equilibria.nearly_ambiguous
    assert remedies(narrow) == [f"{WIDEN}."]
    assert (told.mark.kind, told.mark.words) == ("open", "see the warning above")
    assert told.tests.endswith(ABOVE)
    assert (Overview.of(sound).mark.kind, Overview.of(sound).mark.words) == ("good", "no warning")


def test_colours_end_at_ten_sigma_or_beyond_it_at_the_largest():
    """One wrong row pulls others off by more than ten sigma: it is to be told from them."""
    wrong = proved(CLOUD, moved(5), sigma=0.01)
    far = wrong.fit.worst[0].residual / 0.01
    worst = proved(CLOUD, GOOD, sigma=0.01).fit.worst[0].residual

    assert colours_end(wrong) == {"end": None, "words": f"the largest, {far:.3g} σ"}
    inside = proved(CLOUD, GOOD, sigma=worst / FAR_SIGMAS * 1.000001)
    outside = proved(CLOUD, GOOD, sigma=worst / FAR_SIGMAS * 0.999999)
    assert colours_end(inside)["words"] == "10 σ"
    assert colours_end(outside) == {"end": None, "words": "the largest, 10 σ"}


@pytest.mark.slow
def test_a_length_has_the_unit_of_the_target_where_the_clouds_may_have_two():
    other, same = proved(CLOUD, 1000.0 * GOOD), proved(CLOUD, GOOD)

    assert "(weighted, unit of the target)" in registration_summary(other)
    assert "(weighted, unit of the clouds)" in registration_summary(same)
    assert "(weighted, unit of the target)" in assessment_summary(assess(other.problem, other.pose))
    units = [scene_document(one, NAMES)["unit"] for one in (other, same)]
    assert units == ["unit of the target", "unit of the clouds"]
    assert [Overview.of(one).fit[0].words for one in (other, same)] == [
        "in the unit of the target",
        "in the unit of the clouds",
    ]


def test_the_rmse_of_a_bounded_pose_is_said_to_be_that_of_the_printed_one():
    bounded = replace(proved(CLOUD, GOOD), limits=Limits(max_gap=0.0))

    assert Overview.of(bounded).fit[0].words == "in the unit of the clouds, of the pose as printed"


def test_a_deviation_that_is_not_known_for_the_same_reason_says_so_once():
    loose = Overview.of(proved(CLOUD, GOOD, sigma=10.0)).pose.facts
    told = {fact.name: fact.words for fact in loose}

    assert told["Rotation ±"].startswith("not known: the turn about ")
    assert told["Translation ±"] == SAME


def test_the_numbers_of_a_pose_stay_on_their_line_in_a_card():
    lines = registration_card(proved(CLOUD, GOOD)).splitlines()
    style = {line.split(">")[2].split("<")[0]: line for line in lines if line.startswith("<tr>")}

    for name in ("rotation (wxyz)", "translation"):
        assert '<div style="overflow-x:auto;white-space:pre">' in style[name]
    assert "<div" not in style["explained"]
