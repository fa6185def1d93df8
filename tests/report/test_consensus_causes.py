"""Beside the labels: a cause for each remedy, and why an angle is not bounded."""

from __future__ import annotations

import html
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from strategies import random_rotation

import certreg
from certreg.exact.dyadic import double_above
from certreg.geometry.pose import Pose
from certreg.registration.ambiguity import NEARLY_AMBIGUOUS
from certreg.report.cards import AMBER, GREEN
from certreg.report.pair_page import PairsReport
from certreg.report.pairs import degrees_from, turned_degrees
from certreg.report.reload import report_of
from certreg.report.viewer import Names
from certreg.results import Absent

VECTORS = Path(__file__).parents[2] / "vectors"
BOUND = 0.05
WIDE = (
    "  proved angle      not bounded: for bounds as wide as these no angle below 180 degrees is "
    "proved\n"
)


def on_line(noise: float, **options: Any) -> Any:
    """Twelve pairs on a line, four of them wrong."""
    rng = np.random.default_rng(5)
    along = [0.25, 0.0, 0.0] if not noise else [0.1, 0.2, 0.3]  # on it exactly, and all but
    source = np.outer(np.arange(-6.0, 6.0), along)
    target = source @ random_rotation(rng).T + noise * rng.standard_normal((12, 3))
    target[8:] += rng.uniform(1.0, 2.0, (4, 3))
    return certreg.certify(source, target, max_residual=BOUND, **options)


def page_of(found: Any) -> str:
    return words_of(PairsReport.of(found))


def told_degrees(found: Any) -> str:
    told = turned_degrees(found)
    assert isinstance(told, str)
    return told


def words_of(report: Any) -> str:
    text = re.sub(r"(?s)<(style|svg)>?.*?</\1>", " ", report.html().decode())
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", text)).split())


@pytest.mark.parametrize("model", [{}, {"scale": "asymmetric"}])
def test_on_a_line_the_angle_is_told_to_be_unbounded_and_a_cause_stands_before_the_remedy(model):
    found = on_line(0.005, **model)
    text, page = str(found), page_of(found)
    why = re.findall(r"proved angle +not bounded: (.*)", text)[0]

    assert re.fullmatch(
        r"these pairs lie 0\.00\d+ from a line \(root mean square\), beside bounds of 0\.05: turns "
        "about it are not ruled out",
        why,
    )
    assert f"Angle not bounded {why}" in page
    for told in (text, page):
        assert told.index(NEARLY_AMBIGUOUS) < told.index("What to do: ")


@pytest.mark.parametrize(
    ("noise", "options", "against", "code"),
    [
        (0.005, {}, "THE ROTATION IS NEARLY AMBIGUOUS", 0),
        (0.005, {"scale": "asymmetric"}, "THE ROTATION IS NEARLY AMBIGUOUS", 0),
        (0.0, {}, "THE POSE IS NOT UNIQUE", 3),
    ],
)
def test_the_first_line_is_no_stronger_than_that_of_the_pairs_alone(noise, options, against, code):
    found = on_line(noise, **options)
    block, rows = found.problem.points, found.inliers
    alone = certreg.certify(block.source[rows], block.target[rows], **options)

    assert alone.exit_code == found.exit_code == code
    assert found.labels_unique
    assert str(found).startswith(f"CERTIFIED, BUT {against}: no ")
    assert found.to_dict()["consensus"]["headline"] == found.headline
    assert AMBER in found._repr_html_()
    assert GREEN not in found._repr_html_()
    page, report = page_of(found), PairsReport.of(found)
    assert not report.values(Names.of({}, 12))["good"]
    assert f"CERTIFIED, BUT {against} " in page
    assert f"The fit {against.lower()} " in page
    assert "no warning" not in page.split("The fit")[1][:200]


def test_a_turn_that_the_noise_leaves_open_and_one_point_are_told_first():
    block = certified_cube().problem.points
    source, target = block.source * [1.0, 0.15, 0.15], block.target * [0.15, 0.15, 1.0]
    loose: Any = certreg.certify(source, target, max_residual=BOUND, sigma=0.3)
    assert loose.headline == (
        "CERTIFIED, BUT THE ROTATION IS HARDLY DETERMINED: one rigid motion brings all 12 pairs "
        "within 0.05: no outliers."
    )
    source, target = block.source.copy(), block.target.copy()
    source[:9], target[:9] = source[0], target[0]
    target[9:] += np.diag([30.0, 40.0, 50.0])
    point: Any = certreg.certify(source, target, max_residual=BOUND)
    assert point.headline.startswith("CERTIFIED, BUT THE POSE IS NOT UNIQUE: no rigid motion ")
    assert (point.lower, point.exit_code) == (9, 3)


def test_nothing_is_said_against_a_pose_that_is_fixed():
    found = certified_cube()
    assert found.against is None
    assert found.good
    assert GREEN in found._repr_html_()


def test_an_exact_line_is_called_one():
    found = on_line(0.0)
    text, page = str(found), page_of(found)

    cause = "Not unique: the source points are collinear: turning the body about its own line"
    assert "not bounded: these pairs lie on a line, and turns about it are not ruled out" in text
    for told in (text, page):
        assert told.index(cause) < told.index("What to do: ")


def test_where_a_cloud_is_wide_no_line_is_blamed():
    found = certified_cube()
    body = replace(found.certificate.body, reach=None)
    bare = replace(found, certificate=replace(found.certificate, body=body))

    assert WIDE in str(bare)
    assert "Angle not bounded for bounds as wide as these" in page_of(bare)


def test_the_angle_that_is_told_is_no_less_than_the_one_that_is_proved():
    found = certified_cube()
    told, reach = told_degrees(found), found.certificate.body.reach

    half = np.radians(float(told)) / 2.0
    assert np.sin(half) ** 2 >= double_above(reach.sin2_half_angle.value)
    assert f"at most {told} degrees from this rotation to that of any motion" in str(found)
    assert f"≤ {told}°" in page_of(found)
    assert Fraction(told) < 45


def test_the_angle_is_from_the_pose_shown_also_where_the_certificate_is_about_another():
    """That of this certificate is 43.41 degrees from the least squares, which the report shows."""
    report = report_of(VECTORS / "accept-consensus-springs-reach-of-the-pose.json")
    found = report.registration
    told, reach = float(told_degrees(found)), found.certificate.body.reach
    q = np.array(found.certificate.body.fit["proof"]["pose"], dtype=float)
    apart = 2.0 * np.arccos(abs(q @ found.pose.quaternion_wxyz) / np.linalg.norm(q))
    proved = np.degrees(apart + 2.0 * np.arcsin(np.sqrt(float(reach.sin2_half_angle.value))))

    assert np.degrees(apart) == pytest.approx(43.41, abs=0.01)
    assert proved <= told <= proved + 1e-4
    page = words_of(report)
    assert (
        f"at most {told_degrees(found)} degrees from the rotation of the pose given below to that"
        in page
    )
    assert "degrees of R, that of the pose below." in page
    assert "degrees from that of the least squares" not in page
    assert "CERTIFIED, BUT THE POSE IS NOT CERTIFIED" in page


def test_an_angle_to_another_rotation_is_added_to_what_is_proved_from_that():
    """90 degrees apart, and 60 more; 180 bound nothing."""
    pose = Pose.from_matrix(np.eye(4))

    assert degrees_from(pose, (1, 0, 0, 1), Fraction(1, 4), digits=9) == "150.000001"
    assert degrees_from(pose, (3, 0, 0, 0), Fraction(1, 4), digits=9) == "60.0000001"
    assert degrees_from(pose, (1, 0, 0, 1), Fraction(1, 2), digits=9) is None


def test_the_angle_of_truncated_squares_is_from_the_rotation_shown():
    rng = np.random.default_rng(6)
    source = rng.uniform(-1.0, 1.0, (12, 3))
    target = source[:, [1, 2, 0]] + rng.uniform(-0.01, 0.01, (12, 3))
    found: Any = certreg.certify(
        source, target, max_residual=BOUND, objective="truncated", rotation_only=True
    )
    w, x, y, z = found.certificate.body.quaternion
    turned = replace(found.certificate.body, quaternion=(w, x, y, z + w))
    other: Any = replace(found, certificate=replace(found.certificate, body=turned))

    assert float(told_degrees(found)) < 1e-3
    assert float(told_degrees(other)) > 10.0
    assert turned_degrees(replace(found, certificate=None)) == Absent("nothing is proved")


def certified_cube() -> Any:
    rng = np.random.default_rng(6)
    source = rng.uniform(-1.0, 1.0, (12, 3))
    target = source[:, [1, 2, 0]] + rng.uniform(-0.01, 0.01, (12, 3))
    return certreg.certify(source, target, max_residual=BOUND)
