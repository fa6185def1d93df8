"""The picture of a motion on springs that break, and its table: what is drawn is what was run."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
import twin_motions
from wrong_pairs import wrong_pairs

import certreg
from certreg.report import breaking
from certreg.report.breaking import CoursePicture, breaking_course, breaking_fragment

if TYPE_CHECKING:
    from certreg.registration.breaking import SimulatedBreaking


@pytest.fixture(scope="module")
def run() -> SimulatedBreaking:
    pairs = wrong_pairs(np.random.default_rng(1), 30, 0.5)
    return certreg.simulate_breaking(pairs.source, pairs.target, max_residual=pairs.bounds)


@pytest.fixture(scope="module")
def fragment(run) -> str:
    return breaking_fragment(run)


def corners(curve: str) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in (point.split(",") for point in curve.split())]


def picture_of(run: SimulatedBreaking) -> CoursePicture:
    picture = breaking_course(run).picture
    assert picture is not None
    return picture


def test_the_fragment_is_well_formed_and_neither_loads_nor_runs_anything(fragment, run):
    page = ET.fromstring(fragment)  # noqa: S314 - of our own making

    assert page.tag == "div"
    assert run.ending in "".join(page.itertext())
    assert not {each.tag for each in page.iter()} & {"script", "img", "link", "iframe", "style"}
    assert not re.search(r"https?:|url\(|\bon\w+=", fragment)


def test_the_curves_go_from_stage_to_stage(run):
    picture = picture_of(run)
    held, bounds = picture.panels
    end, widest = run.stages[-1].time, run.stages[0].width

    assert picture.words == (
        "springs that hold, and the width of the bounds over those given, over time"
    )
    assert [held.name, bounds.name] == [
        "springs that hold",
        "bounds, over those given (logarithmic)",
    ]
    for panel, height in (
        (held, lambda stage: stage.count / 30),
        (bounds, lambda stage: math.log(stage.width) / math.log(widest)),
    ):
        drawn, before = corners(panel.curve), 0.0
        assert len(drawn) == 2 * len(run.stages)
        for stage, first, last in zip(run.stages, drawn[::2], drawn[1::2], strict=True):
            down = panel.bottom - (panel.bottom - panel.top) * height(stage)
            room = picture.right - picture.left
            expected = [(picture.left + room * t / end, down) for t in (before, stage.time)]
            np.testing.assert_allclose([first, last], expected, atol=0.051)
            before = stage.time


def test_the_marks_stand_where_their_numbers_are(run):
    held, bounds = picture_of(run).panels

    marks = {tick.words: float(tick.place) for tick in held.ticks}
    assert marks == {"0": held.bottom, "15": (held.top + held.bottom) / 2, "30": held.top}
    assert [float(tick.place) for tick in bounds.ticks] == [bounds.bottom, bounds.top]
    assert picture_of(run).times[0].words == "0"


def test_marks_that_would_touch_are_left_out():
    pairs = wrong_pairs(np.random.default_rng(3), 20, 0.05)
    run = certreg.simulate_breaking(pairs.source, pairs.target, max_residual=0.06)
    held, _ = picture_of(run).panels

    assert run.stages[-1].count == 19
    assert [tick.words for tick in held.ticks] == ["0", "20"]


def test_each_row_of_the_table_follows_from_the_one_before(run):
    course = breaking_course(run)
    held = 30

    assert course.head == ("bounds", "springs that hold", "broke", "mended", "energy", "time")
    assert course.note is None
    assert len(course.rows) == len(run.stages)
    for (width, springs, broke, mended, *_), stage in zip(course.rows, run.stages, strict=True):
        held += int(mended) - int(broke)
        assert springs == f"{held} of 30"
        assert held == stage.count
        assert float(width) == pytest.approx(stage.width, rel=1e-3)


def test_of_many_stages_some_are_shown_and_that_is_said(run, monkeypatch):
    monkeypatch.setattr(breaking, "MOST_ROWS", 3)
    course, held = breaking_course(run), 30

    assert course.note == f"3 of {len(run.stages)} stages, evenly chosen."
    assert len(course.rows) == 3
    for _, springs, broke, mended, *_ in course.rows:
        held += int(mended) - int(broke)
        assert springs == f"{held} of 30"
    assert "3 of" in breaking_fragment(run)


def test_where_nothing_moved_there_is_no_picture():
    run = certreg.simulate_breaking(twin_motions.SOURCE, twin_motions.TARGET, max_residual=1.0)
    still = replace(run, stages=(replace(run.stages[0], time=0.0),))

    assert breaking_course(still).picture is None
    assert "<svg" not in breaking_fragment(still)


@pytest.mark.parametrize("thin", [0.0, 1e-8])
def test_a_report_of_wrong_pairs_is_written_where_no_motion_can_be_simulated(thin, tmp_path):
    """A source on a line, or nearly so."""
    x = np.random.default_rng(0).normal(size=(8, 3)) * [1.0, thin, thin]
    y = x + 1.0
    y[6:] += [0.0, 3.0, 1.0]
    result = certreg.certify(certreg.RegistrationProblem(x, y), max_residual=0.1)

    assert "On springs that break" not in result.report(tmp_path / "page.html").read_text("utf-8")


def test_a_report_of_wrong_pairs_moves_springs_of_their_weights(tmp_path):
    pairs = wrong_pairs(np.random.default_rng(2), 12, 0.25)
    weights = np.linspace(1.0, 3.0, 12)
    result = certreg.certify(
        certreg.RegistrationProblem(pairs.source, pairs.target, weights=weights),
        max_residual=0.0554,
    )
    run = certreg.simulate_breaking(
        pairs.source, pairs.target, max_residual=0.0554, weights=weights
    )
    page = result.report(tmp_path / "page.html").read_text("utf-8")

    assert f"<td>{run.stages[0].energy:.6g}</td>" in page
