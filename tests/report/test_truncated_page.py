"""The page of truncated squares: complete, and no stronger than its proof."""

from __future__ import annotations

import html
import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from rotated_pairs import BOUND, rotated_pairs
from strategies import random_rotation

import certreg
from certreg.errors import InvalidFileError, UndecidedError
from certreg.exact.dyadic import Dyadic
from certreg.registration.pair_angles import angles_between, widest_angles
from certreg.report.pages import report_on
from certreg.report.pair_page import PairsReport
from certreg.report.pair_picture import residual_chart
from certreg.report.reload import report_of
from certreg.report.viewer import Names
from certreg.results import Limits

if TYPE_CHECKING:
    from pathlib import Path


TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
FITTED = (
    "The rotation is fitted by least squares to the 6 pairs within, each residual divided by its "
    "bound."
)
APART = (
    "at every rotation: the distances of the two points from the origin differ by more than the "
    "bound."
)
UNDECIDED = (
    "For 4 pairs it is not proved on which side of the bound the residual is at the optima: two "
    "optima differ there, or at one of them it is so near to the bound that the search does not "
    "tell."
)
pytestmark = pytest.mark.slow


@cache
def result(kind: str = "certified") -> Any:
    pairs = rotated_pairs(np.random.default_rng(3), 12, 0.5)
    twins = np.vstack([np.eye(3)] * 2), np.vstack([TURN.T, TURN])
    line = np.outer([1.0, 2.0, -3.0], [0.0, 0.0, 1.0])
    clouds = {"certified": (pairs.source, pairs.target), "twins": twins, "line": (line, line)}
    source, target = clouds[kind]
    return certreg.certify(
        source,
        target,
        max_residual=0.25 if kind == "twins" else BOUND,
        rotation_only=True,
        objective="truncated",
        about={"labels": [f"P{row}" for row in range(len(source))]},
    )


def words_of(found: Any) -> str:
    """What stands on its page, without style, pictures and tags, in one line."""
    text = PairsReport.of(found).html().decode()
    text = re.sub(r"(?s)<(style|svg)>?.*?</\1>", " ", text)
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", text)).split())


@pytest.mark.parametrize(
    "words",
    [
        "CERTIFIED",
        "o rotation has a smaller truncated cost than 6.75231, and 6 of the 12 pairs are within",
        "Truncated cost ≤ 6.75231",
        "Least cost ≥ 6.75231",
        "over all rotations; the certified one has less than 7.0e-10 more",
        "Labels 6 inliers, 6 outliers, 0 undecided at every optimum",
        "° from this rotation to any optimum",
        FITTED,
        "A pair is within its bound where the angle between its points is at most ",
        "Of the 12 pairs 6 are inliers and 6 are outliers at every optimum.",
        " degrees from the rotation of the pose given below to any optimum.",
        "The optimum is one single rotation: every other one has a larger cost.",
        "The least squares over these 6 pairs: certified.",
        "That an inlier is a right pair: only that every optimum has it within its bound.",
        "That the rotation is close to the truth: only that its truncated cost is near the least.",
        "Anything of the names in the certificate, and where the points come from.",
        "Boxes of quaternions and truncated squares",
        "A box of rotations without a better truncated cost",
        "A truncated square is above its chord",
        "it loads nothing, runs nothing and sends nothing.",
        "points, weights and bounds",
        " P3 ",
    ],
)
def test_the_page_says_what_is_proved(words: str):
    page = words_of(result())

    assert words in page
    assert "What is undecided" not in page
    assert "What to do" not in page
    assert "script-src 'none'" in html.unescape(PairsReport.of(result()).html().decode())


def test_the_costs_on_the_page_are_bounds_of_the_proved_ones():
    page, worth = words_of(result()), result().verdict.worth
    upper, lower = (
        Fraction(re.findall(f"{name} cost {sign} (\\S+)", page)[0])
        for name, sign in (("Truncated", "≤"), ("Least", "≥"))
    )

    assert lower <= worth.minimum <= worth.objective <= upper
    assert upper - lower < Fraction(1, 10**7)


def test_two_optima_are_undecided_on_the_page_and_it_says_why():
    page = words_of(result("twins"))

    for words in (
        "PARTLY PROVED",
        "What to do: Give more --effort to search further",
        "What is undecided, and why",
        UNDECIDED,
        "Angle not bounded with labels undecided, another optimum may have other pairs within thei",
    ):
        assert words in page, words
    assert "to any optimum" not in page
    assert "one single rotation" not in page


@pytest.mark.parametrize(
    ("far", "words"),
    [
        (1, "1 pair is beyond its bound"),
        (2, "2 pairs are beyond their bounds"),
    ],
)
def test_pairs_that_no_rotation_brings_within_are_counted(far: int, words: str):
    source = np.vstack([np.eye(3), -np.eye(3)])
    target = source @ TURN.T * np.where(np.arange(6) < far, 1.5, 1.0)[:, np.newaxis]
    bounds = np.arange(5.0, 11.0) / 100.0
    page = words_of(
        certreg.certify(
            source, target, max_residual=bounds, rotation_only=True, objective="truncated"
        )
    )

    least = ("3.43", "4.01")[far - 1]  # 2 asin(0.06 / 2), 2 asin(0.07 / 2)
    assert f"{words} {APART}" in page
    assert (
        f"where the angle between its points is at most {least}° to 5.73°, depending on the pair."
        in page
    )


def test_a_turn_that_nothing_fixes_is_said_with_its_cause():
    found = result("line")
    page, text = words_of(found), str(found)
    why = (
        "not bounded: of the pairs within their bounds, the source points are collinear: turning "
        "the body about its own line changes nothing"
    )

    assert why.replace(": of", " of") in page
    for words in (
        "Not unique: the source points are collinear: turning the body about its own line changes",
        "What to do: ",
    ):
        assert words in page
        assert words in text
    assert f"  proved angle      {why}" in text
    assert 'class="stamp open"' in PairsReport.of(found).html().decode()


def test_the_report_is_made_anew_of_the_certificate_alone(tmp_path: Path):
    found = result()
    path = found.save(tmp_path)
    report = report_of(path)

    assert isinstance(report, PairsReport)
    again: Any = report.registration
    assert (again.labels, again.gap, again.exit_code) == (found.labels, found.gap, 0)
    assert again.cost == pytest.approx(found.cost, rel=1e-12)
    assert report.html() == (tmp_path / "report.html").read_bytes()
    assert found.report(tmp_path / "own.html").read_bytes() == report.html()


def test_of_what_is_not_proved_there_is_no_report(tmp_path: Path):
    open_one = replace(result(), certificate=None, labels=("undecided",) * 12)

    with pytest.raises(InvalidFileError, match="there is no certificate to report"):
        open_one.report(tmp_path / "report.html")
    result().save(tmp_path)
    open_one.save(tmp_path)
    assert not (tmp_path / "report.html").exists()


def test_a_limit_that_is_not_proved_is_named():
    found = result()
    strict = replace(found, fit=replace(found.fit, limits=Limits(max_angle=1e-12)))
    unmet = "Not called certified: that asks for a proof that it is within 1e-06 of the range of "

    assert strict.exit_code == 4
    assert unmet in str(strict)
    assert unmet in words_of(strict)
    assert "costs and 1e-12 radians of the optimum." in str(strict)


def test_every_pair_is_in_the_chart_once():
    groups = residual_chart(result()).groups

    assert [(one.told, len(one.dots)) for one in groups] == [
        ("6 inliers", 6),
        ("6 outliers", 6),
        ("0 undecided", 0),
    ]
    assert report_on(result()).html() == PairsReport.of(result()).html()


def test_a_pair_is_within_its_bound_just_up_to_its_widest_angle():
    rng = np.random.default_rng(7)
    n = 400
    source, target = rng.standard_normal((2, n, 3)) * rng.uniform(0.1, 3.0, (2, n, 1))
    bounds = rng.uniform(0.05, 4.0, n)
    turned = source @ random_rotation(rng).T
    inside = np.linalg.norm(target - turned, axis=1) <= bounds
    most = widest_angles(source, target, bounds)
    sizes = [np.linalg.norm(points, axis=1) for points in (source, target)]

    assert (inside == (angles_between(turned, target) <= most)).all()
    assert 40 < inside.sum() < 360
    assert (np.isnan(most) == (np.abs(sizes[0] - sizes[1]) > bounds)).all()
    assert ((most == np.pi) == (sizes[0] + sizes[1] <= bounds)).all()


def test_a_pair_of_no_length_has_no_angle():
    zero, one = np.zeros((1, 3)), np.eye(3)[:1]

    assert np.isnan(angles_between(zero, one)).all()
    assert widest_angles(zero, one, np.ones(1)) == np.pi
    assert np.isnan(widest_angles(zero, one, np.full(1, 0.5)))


def of_gap_alone(certificate: Any, gap: int) -> Any:
    """What is claimed where nothing but a gap is."""
    kept, small = certificate.body.claims, Dyadic(mantissa=gap, exponent=0)
    return replace(kept, gap=small, labels="?" * 12, sin2_half_angle=None, unique=False)


def test_a_certificate_that_proves_little_is_reported_as_no_more(tmp_path: Path):
    found = result()
    kept = found.certificate
    claims = of_gap_alone(kept, 3)
    path = tmp_path / "weak.json"
    replace(kept, body=replace(kept.body, claims=claims)).save(path)
    page = report_of(path).html().decode()

    assert "The truncated cost is at most 6.75232, and less than 3 above the least." in page
    assert 'class="stamp open">PARTLY PROVED' in page
    assert "What is undecided, and why" in page


def test_a_certificate_whose_rotation_meets_nothing_has_no_report(tmp_path: Path):
    kept = result().certificate
    claims = of_gap_alone(kept, 13)
    w, x, y, z = kept.body.quaternion
    path = tmp_path / "far.json"
    replace(kept, body=replace(kept.body, quaternion=(-x, w, -z, y), claims=claims)).save(path)

    with pytest.raises(UndecidedError) as refused:
        report_of(path)
    assert str(refused.value) == (
        "the rotation of the certificate brings no pair within its bound: there is no pair to fit "
        "it to"
    )


def test_that_not_all_angles_are_listed_is_said(monkeypatch):
    assert "nearest to their bounds are listed" not in words_of(result())
    monkeypatch.setattr("certreg.report.pair_page.NEAREST", 5)

    words = words_of(result())
    listed = (
        "nearest to their bounds are listed; the residuals and labels of all are in fit.csv, "
        "which certify --out writes, the labels in the JSON, too (truncated.labels)."
    )
    assert f"Of the 12 pairs the 5 {listed}" in words
    assert " angle largest allowed residual over its bound " in words
    assert "Angles and residuals against the bounds" in words


def test_the_pairs_nearest_to_their_bounds_are_listed_on_either_side(monkeypatch):
    monkeypatch.setattr("certreg.report.pair_page.NEAREST", 8)
    found = result()
    listed = (
        PairsReport.of(found)
        .values(Names.of(found.certificate.about, 12))["sections"][0]
        .table.rows
    )
    away = np.maximum(found.residuals / BOUND, BOUND / found.residuals)
    nearest = np.argsort(away)[:8].tolist()

    assert [int(one[0]) for one in listed] == nearest
    assert {found.labels[row] for row in nearest} == {"inlier", "outlier"}
