"""The page of wrong pairs: complete, and no stronger than its proof."""

from __future__ import annotations

import html
import re
import sys
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import certreg
from certreg.errors import InvalidFileError
from certreg.report.pair_page import PairsReport
from certreg.report.pair_picture import pairs_picture, residual_chart
from certreg.report.reload import report_of

if TYPE_CHECKING:
    from pathlib import Path


BOUND = 0.05


@cache
def result(*, twins: bool = False, named: bool = False) -> Any:
    rng = np.random.default_rng(3)
    source = rng.uniform(size=(16, 3))
    target = source[:, [1, 2, 0]] + rng.uniform(-0.005, 0.005, (16, 3))
    target[10:] = (source[10:] if twins else rng.uniform(-2, 2, (6, 3))) + [0.3, 0.2, -0.4]
    if twins:
        source, target = source[4:], target[4:]
    about = {"labels": [f"P{row}" for row in range(len(source))]} if named else None
    return certreg.certify(source, target, max_residual=BOUND, about=about)


def words_of(found: Any) -> str:
    """What stands on its page, without style, pictures and tags, in one line."""
    text = PairsReport.of(found).html().decode()
    text = re.sub(r"(?s)<(style|svg)>?.*?</\1>", " ", text)
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", text)).split())


def test_the_page_says_what_is_proved():
    found = result()
    page = words_of(found)
    assert found.labels_unique
    assert found.headline.removeprefix("CERTIFIED: n") in page
    for words in (
        "Within bounds 10 of 16 by one motion",
        "No motion more than 10 within",
        "Labels 10 inliers, 6 outliers, 0 undecided in every motion that brings 10 within",
        "° from this rotation to that of any motion that brings these 10 within",
        "The pose is fitted by least squares to the 10 pairs that are met.",
        "The largest residual of a met pair is ",
        "One rigid motion brings 10 of the 16 pairs within their bounds: the witness, tested in",
        "No rigid motion brings more than 10 within.",
        "Of the 16 pairs 10 are inliers and 6 are outliers in every motion that brings 10 within.",
        " degrees from the rotation of the pose given below to that of any motion that brings ",
        "The least squares over these 10 pairs: certified.",
        "That an inlier is a right pair: only that every motion that meets as many meets it, too.",
        "How many pairs the other motion meets: a search found it, and none is proved to be best.",
        "Anything of the names in the certificate, and where the points come from.",
        "it loads nothing, runs nothing and sends nothing.",
        "On springs that break",
        "points, weights and bounds",
    ):
        assert words in page, words
    assert "What is undecided" not in page
    assert "script-src 'none'" in html.unescape(PairsReport.of(found).html().decode())


def test_the_page_says_what_is_undecided_and_the_other_motion():
    found = result(twins=True, named=True)
    page = words_of(found)
    assert found.lower == 6
    assert found.second == 6
    assert (
        "Of 12 pairs nothing is proved: no test showed that a motion that meets 6 pairs must leave "
        "them out, or must meet them. What is a little beyond its bound may be met by another "
        "motion that is as good."
    ) in page
    assert (
        "Another motion fits 6 of the other 6 pairs (found, not proved to be the most): a second "
        "body, or an agreement by chance."
    ) in page
    assert " P3 " in page


def test_every_section_has_its_title_and_its_columns():
    page = words_of(result(twins=True))

    for title in (
        "Residuals against the bounds",
        "The other motion",
        "row residual over its bound",
    ):
        assert title in page
    assert (
        "Each pair is a spring that breaks beyond its bound; the bounds begin wide and shrink to "
        "those given."
    ) in words_of(result())


def test_a_pose_that_breaks_its_own_consensus_is_said(monkeypatch):
    monkeypatch.setattr(type(result()), "broken", (1, 2))
    assert (
        "It leaves rows 1, 2, counting from 0, beyond the bound, though one motion, the witness "
        "in the certificate, meets all of them."
    ) in words_of(result())


def test_many_undecided_pairs_are_listed_in_part(monkeypatch):
    page = sys.modules["certreg.report.pair_page"]
    monkeypatch.setattr(page, "MOST_ROWS", 5)
    monkeypatch.setattr(page, "MOST_MOVED", 1)
    words = words_of(result(twins=True))
    assert "The 5 nearest to their bounds are listed." in words
    assert "On springs that break" not in words


def test_every_pair_is_drawn_once_in_its_colour(monkeypatch):
    found = result()
    picture = pairs_picture(found)
    assert picture is not None
    assert [(g.word, g.count, len(g.dots)) for g in picture.groups] == [
        ("inlier", 10, 10),
        ("outlier", 6, 6),
        ("undecided", 0, 0),
    ]
    chart = residual_chart(found)
    bound = next(float(mark.place) for mark in chart.marks if mark.strong)
    inliers, outliers, _ = chart.groups
    assert all(float(y) > bound for _, y in inliers.dots)
    assert all(float(y) < bound for _, y in outliers.dots)
    monkeypatch.setattr("certreg.report.pair_picture.MOST", 8)
    thinned = pairs_picture(found)
    assert thinned is not None
    assert thinned.words.endswith("by label; 8 of 16 pairs")


def test_the_report_is_made_anew_of_the_certificate_alone(tmp_path: Path):
    found = result(named=True)
    found.save(tmp_path)
    report = report_of(tmp_path / "certificate.json")
    assert isinstance(report, PairsReport)
    again: Any = report.registration
    assert (again.labels, again.upper, again.second) == (found.labels, found.upper, found.second)
    assert np.array_equal(again.pose.T_target_source, found.pose.T_target_source)
    assert words_of(again) == words_of(found)
    assert not report.weak
    weak = "This certificate proves far less of the least-squares pose than can be proved."
    assert weak not in report.html().decode()
    assert weak in replace(report, weak=True).html().decode()


def test_no_report_is_made_of_a_certificate_without_a_least_squares(tmp_path: Path):
    kept = result().certificate
    bare = replace(kept, body=replace(kept.body, fit=None, reach=None))
    bare.save(tmp_path / "bare.json")
    words = "bare.json: holds no least squares, or no points: there is no pose to report"
    with pytest.raises(InvalidFileError, match=words):
        report_of(tmp_path / "bare.json")


def test_the_report_and_the_card(tmp_path: Path):
    found = result()
    path = found.report(tmp_path / "report.html")
    assert path.read_bytes() == PairsReport.of(found).html()
    card = found._repr_html_()
    assert "10 found, at most 10 (proved)" in card
    assert "10 inliers, 6 outliers, 0 undecided" in card
