"""The pages of general springs: what the picture holds, and what is said to be proved."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from springs_certified import certified

from certreg import certify
from certreg.problem.problem import RegistrationProblem
from certreg.report.page import Report
from certreg.report.picture import springs_picture
from certreg.report.rest_sections import still_picture


def registered(family: str, n: int) -> Any:
    return certify(certified(family, n, 0.1).problem)


@pytest.fixture(scope="module")
def planes() -> Any:
    return registered("plane", 20)


@pytest.fixture(scope="module")
def mixed() -> Any:
    return registered("mixed", 6)


def corners(picture: Any) -> np.ndarray:
    return np.array([points.split() for points in picture.pieces], float).reshape(-1, 4, 2)


def test_every_plane_has_a_piece_about_its_target(planes):
    picture: Any = springs_picture(planes)
    pieces, rings = corners(picture), np.array(picture.rings, float)

    assert pieces.mean(axis=1) == pytest.approx(rings, abs=0.11)
    assert "squares are pieces" in still_picture(planes)[1]
    assert "strokes" not in still_picture(planes)[1]


def test_a_spring_ends_in_the_plane_whose_piece_is_drawn(planes):
    """In the plane of the picture the foot is the target and some of both sides of the piece."""
    picture: Any = springs_picture(planes)
    pieces, rings = corners(picture), np.array(picture.rings, float)
    feet = np.array(picture.springs, float)[:, :2]
    for piece, ring, foot in zip(pieces, rings, feet, strict=True):
        sides = np.stack([piece[1] - piece[0], piece[3] - piece[0]])
        if abs(np.linalg.det(sides)) > 1.0:  # it is not seen from its edge
            assert np.abs(np.linalg.solve(sides.T, foot - ring)).max() < 10.0


def test_of_mixed_springs_planes_are_squares_lines_are_strokes_and_others_have_no_piece(mixed):
    picture: Any = springs_picture(mixed)
    ranks = mixed.problem.springs.ranks
    strokes = [piece for piece in corners(picture) if (piece[0] == piece[3]).all()]

    assert len(picture.pieces) == ranks[1] + ranks[2]
    assert len(strokes) == ranks[2]
    assert "squares and strokes are pieces" in still_picture(mixed)[1]


def test_the_page_says_how_many_of_many_pairs_it_draws(planes, monkeypatch):
    assert "evenly chosen" not in still_picture(planes)[1]
    monkeypatch.setattr("certreg.report.picture.ON_PAGE", 7)
    monkeypatch.setattr("certreg.report.rest_sections.ON_PAGE", 7)
    text = Report.of(planes).html().decode()

    assert '<p class="note">7 of 20 pairs, evenly chosen. The target as rings' in text
    assert "dots; 7 of 20 pairs, evenly chosen</title>" in text
    assert text.count("<polygon") == 7


def test_full_springs_have_no_piece_and_no_words_of_planes():
    found = registered("aniso", 3)
    picture: Any = springs_picture(found)

    assert picture.pieces == ()
    assert "plane" not in still_picture(found)[1]


def test_what_is_proved_names_its_theorems_and_the_robustness(planes):
    text = Report.of(planes).html().decode()
    table = text[text.index('id="proof"') : text.index("Not claimed")]

    assert "Every optimum stays within 5 degrees of the certified rotation" in table
    for name in ("quartic_relaxation", "growth_form", "growth_radius", "spring_translation"):
        assert f"<code>{name}</code>" in table
    assert "spring_caps" not in table


@pytest.mark.slow
def test_of_one_wall_nothing_is_said_of_robustness():
    rng = np.random.default_rng(3)
    x, y = rng.standard_normal((2, 12, 3))
    wall: Any = certify(RegistrationProblem(x, y, normals=np.tile([0.0, 0.0, 1.0], (12, 1))))
    text = Report.of(wall).html().decode()

    assert "as long as every target point" not in text
    assert "it names no single rotation" in text
    assert not re.search(r"\de\+0\d", text[: text.index('id="digits"')])
