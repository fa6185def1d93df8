"""Wrong pairs where the scale is unknown: what is found and proved, and how it is said."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import certreg
from certreg.certificate.consensus import NONE, OPEN
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.exact.dyadic import Dyadic
from certreg.registration.labelled import ConsensusRegistration
from certreg.registration.pair_words import ranges_words
from certreg.report.pages import html_page
from certreg.report.reload import report_of

DATA = Path(__file__).parent / "data"
BOUND = 0.05
SCHEMA = Path(certreg.__file__).parent / "report" / "schemas" / "certreg-result-1.json"


def wrong_pairs(seed, n=20, wrong=6, *, scale=2.5, noise=0.005):
    """Clouds of which the last pairs are wrong, and how many are right."""
    rng = np.random.default_rng(seed)
    source = rng.uniform(size=(n, 3)) / scale
    turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    target = scale * source @ turn.T + rng.uniform(-1, 1, 3) + rng.uniform(-noise, noise, (n, 3))
    target[n - wrong :] = target.mean(axis=0) + rng.uniform(-0.8, 0.8, (wrong, 3))
    return source, target


def certified(source, target, bound: Any = BOUND, scale="asymmetric", **options) -> Any:
    result = certreg.certify(source, target, max_residual=bound, scale=scale, **options)
    assert isinstance(result, ConsensusRegistration)
    assert result.scale_interval is not None
    assert result.verdict is not None
    assert result.verdict.proved
    return result


@pytest.mark.parametrize("scale", ["asymmetric", "symmetric"])
@pytest.mark.parametrize(
    ("n", "met", "true"),
    [
        (10, 7, 2.18528322243109),
        pytest.param(100, 10, 3.86667896, marks=pytest.mark.long),
    ],
)
def test_published_pairs_are_proved_without_their_scale(n, met, true, scale):
    source, target = (certreg.load(DATA / f"outliers_{n}_{k}.csv") for k in ("source", "target"))
    result = certified(source, target, 5e-5, scale)
    low, high = result.scale_interval

    assert (result.lower, result.upper, result.labels_unique, result.exit_code) == (
        met,
        met,
        True,
        0,
    )
    assert result.headline.startswith(
        f"CERTIFIED: no motion of any scale brings more than {met} of the {n} pairs within 5e-05, "
        f"and only these {met}. "
    )
    assert abs(result.pose.scale - true) < 1e-8
    assert low < true < high < low * 1.001
    assert (result.residuals[result.inliers] <= 5e-5).all()
    assert result.undecided_scales == ()


def test_the_text_the_document_and_the_page_say_the_scale(tmp_path):
    source, target = wrong_pairs(1)
    result = certified(source, target, about={"labels": [f"P{k}" for k in range(20)]})
    text, document = str(result), result.to_dict()
    folder = tmp_path / "found"
    result.save(folder)
    page = (folder / "report.html").read_text("utf-8")
    low, high = result.scale_interval

    assert f"  scale             {result.pose.scale!r}  (asymmetric; target over source)" in text
    assert "Every motion that brings these 14 within has a scale from 2." in text
    assert low < 2.5 < high
    assert document["pose"]["scale"] == result.pose.scale
    assert document["consensus"]["scale_interval"] == [low, high]
    assert document["consensus"]["undecided_scales"] == []
    jsonschema.validate(document, json.loads(SCHEMA.read_bytes()))
    assert "Every motion that brings these 14 within has a scale from 2." in page
    assert "No motion with a scale brings more than 14 within." in page
    assert f"{result.pose.scale:.9g}" in page
    assert "Lengths, where the scale is free (<code>scaled_lengths</code>)" in page
    assert "Weights that refute pairs at every scale (<code>scaled_refutation</code>)" in page
    assert json.loads((folder / "pose.json").read_text("utf-8"))["scale"] == result.pose.scale
    assert "scale" in result._repr_html_()


def test_two_motions_of_other_scales_leave_both_ranges_open():
    """Six pairs at the scale 1, six at 2: each is a maximum."""
    rng = np.random.default_rng(5)
    source = rng.uniform(-1, 1, (12, 3))
    target = source + np.array([1.0, 2.0, 3.0])
    target[6:] = 2.0 * source[6:] @ Rotation.from_rotvec([0.3, -1.2, 0.4]).as_matrix().T
    result = certified(source, target, 0.01)
    text, document = str(result), result.to_dict()

    assert (result.lower, result.upper, result.exit_code) == (6, 6, 3)
    assert set(result.labels) == {"undecided"}
    assert result.second == 6
    other = 1.0 if abs(result.pose.scale - 2.0) < 0.01 else 2.0
    assert any(low <= other <= high for low, high in result.undecided_scales)
    assert not any(low <= result.pose.scale <= high for low, high in result.undecided_scales)
    assert " With scales from " in result.headline
    rest = "it is not proved which 6 are met; with all others no motion brings any other 6 within."
    assert result.headline.endswith(rest)
    assert rest in text
    assert document["consensus"]["undecided_scales"] == [list(k) for k in result.undecided_scales]
    for theorem in ("Not proved: which 6 pairs or more", "With any other scale: these 6 and only"):
        assert any(theorem in words for words in result.verdict.theorems)


@pytest.fixture(scope="module")
def drawn() -> Any:
    """Pairs drawn at random, of which three are met, with scales that are all undecided."""
    source, target = np.random.default_rng(7).uniform(-1, 1, (2, 6, 3))
    return certified(source, target, 0.3)


def test_where_these_pairs_are_met_is_said_of_no_other_scale(drawn):
    ((low, high),) = drawn.undecided_scales

    assert drawn.lower == 3
    assert low < drawn.scale_interval[0] < drawn.scale_interval[1] < high
    assert drawn.headline.endswith(
        " it is not proved which 3 are met; with all others no motion brings 3 within."
    )
    assert drawn.headline in str(drawn)
    assert drawn.to_dict()["consensus"]["headline"] == drawn.headline


@pytest.mark.parametrize(
    ("begin", "end", "states", "elsewhere"),
    [
        (0, 0, "=?=", False),
        (1, 0, "=?=", True),
        (0, -1, "=?=", True),
        (1, -1, "-?-", False),
        (0, None, "=?", False),
        (1, None, "=?", True),
    ],
)
def test_pairs_are_met_elsewhere_where_a_range_begins_too_late_or_ends_too_soon(
    drawn, begin, end, states, elsewhere
):
    """The range that is undecided is that in which these pairs are met, but for 2^-200."""
    body: Any = drawn.certificate.body
    unit = Fraction(1, 1 << 200)
    ends = [body.scale_lower.value + begin * unit]
    ends += [] if end is None else [body.scale_upper.value + end * unit]
    dyadics = [*(Dyadic(mantissa=int(value / unit), exponent=-200) for value in ends), None]
    pieces = tuple(replace(body.pieces[0], end=end) for end in dyadics)

    assert replace(body, pieces=pieces, states=states).met_elsewhere is elsewhere


def test_targets_near_each_other_are_met_by_a_source_that_shrinks():
    """All of the heap at any small scale: more than the three pairs that keep their lengths."""
    rng = np.random.default_rng(2)
    source = rng.uniform(-1, 1, (9, 3))
    target = 3.0 * source + 5.0
    target[4:] = np.array([20.0, 0.0, 0.0]) + rng.uniform(-0.02, 0.02, (5, 3))
    result = certified(source, target, 0.1)
    low, high = result.scale_interval

    assert result.labels == ("outlier",) * 4 + ("inlier",) * 5
    assert (low, high > 0.0, high < 1.0) == (0.0, True, True)


def test_pairs_that_repeat_one_source_point_have_no_scale():
    rng = np.random.default_rng(4)
    source, target = np.zeros((6, 3)), np.zeros((6, 3))
    source[4:], target[4:] = rng.uniform(5, 9, (2, 2, 3))

    with pytest.raises(DegenerateProblemError) as refused:
        certified(source, target, 0.1, weights=[1.0] * 4 + [0.0] * 2)
    assert str(refused.value) == (
        "of the pairs that were met (rows 0, 1, 2 and 2 others) all source points with weight lie "
        "at one point: they tell no asymmetric scale; leave the scale out, or leave pairs that "
        "repeat a point out"
    )


def test_some_ranges_of_scale_are_named_and_many_counted():
    assert ranges_words([(0.0, 0.5)]) == "from 0 to 0.5"
    assert ranges_words([(0.5, 0.75), (2.0, math.inf)]) == "from 0.5 to 0.75 and from 2 on"
    many = ranges_words([(float(k), k + 0.5) for k in range(4)])
    assert many == "from 0 to 0.5, from 1 to 1.5 and in 2 other ranges"


@pytest.mark.parametrize(("low", "high"), [(2.5, 3.25), (0.1, 0.7)])
@pytest.mark.parametrize("inwards", [-1, 0, 1])
def test_proved_ranges_of_scale_are_rounded_outwards_to_the_next_doubles(
    drawn, low: float, high: float, inwards: int
):
    off = Fraction(inwards, 1 << 80)
    least, most = (
        Dyadic(mantissa=int(value * 2**80), exponent=-80)
        for value in (Fraction(low) + off, Fraction(high) - off)
    )
    body = replace(drawn.certificate.body, scale_lower=least, scale_upper=most)
    piece, *_ = drawn.found.pieces
    told = replace(
        drawn,
        certificate=replace(drawn.certificate, body=body),
        found=replace(
            drawn.found,
            pieces=tuple(replace(piece, end=end) for end in (least, most, None)),
            states=NONE + OPEN + NONE,
        ),
    )
    beyond = np.nextafter(low, 0.0).item(), np.nextafter(high, 9.0).item()
    outside = (low, high) if inwards >= 0 else beyond

    assert told.scale_interval == outside
    assert told.undecided_scales == (outside,)


def test_undecided_scales_may_have_no_end(drawn):
    piece, *_ = drawn.found.pieces
    all_open = replace(drawn.found, pieces=(replace(piece, end=None),), states=OPEN)

    assert replace(drawn, found=all_open).undecided_scales == ((0.0, math.inf),)


def test_a_certificate_alone_makes_the_report_and_says_no_more(tmp_path):
    source, target = wrong_pairs(7)
    result = certified(source, target, scale="symmetric")
    path = tmp_path / "certificate.json"
    result.certificate.save(path)
    page = html_page(report_of(path)).decode()

    assert "Every motion that brings these 14 within has a scale from 2." in page


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"rotation_only": True}, "inliers are counted for motions with a translation"),
        ({"max_residual": 2.0}, "not below half the diameter of the target, "),
        ({"objective": "truncated"}, "truncated"),
    ],
)
def test_what_is_refused_is_refused_in_one_line(change, words):
    source, target = wrong_pairs(1)
    options = {"max_residual": BOUND, "scale": "asymmetric"} | change

    with pytest.raises(InvalidProblemError, match=words) as refused:
        certreg.certify(source, target, **options)
    assert "\n" not in str(refused.value)


def test_labels_are_not_judged_with_a_scale():
    source, target = wrong_pairs(1)

    with pytest.raises(InvalidProblemError) as refused:
        certreg.assess(
            source, target, labels=[1] * 14 + [0] * 6, max_residual=BOUND, scale="asymmetric"
        )
    assert str(refused.value) == (
        "labels are judged for a rigid motion alone: with --scale let certify "
        "prove labels (certreg certify SOURCE TARGET --scale NAME --max-residual X --out FOLDER), "
        "and compare yours with the column `proved` of FOLDER/fit.csv"
    )


def test_a_scale_that_is_known_is_proved_as_a_rigid_motion_is():
    source, target = wrong_pairs(9)
    free = certified(source, target)
    rigid = certreg.certify(2.5 * source, target, max_residual=BOUND)

    assert isinstance(rigid, ConsensusRegistration)
    assert free.labels == rigid.labels
