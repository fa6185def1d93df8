"""The page of a free scale, or without a translation: complete, and no stronger than its proof."""

from __future__ import annotations

import base64
import html
import re
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import certreg
from certreg import RegistrationProblem
from certreg.errors import RefusedCertificateError
from certreg.exact.decimals import at_least, at_most
from certreg.exact.dyadic import Dyadic
from certreg.report.pages import html_page, report_on
from certreg.report.pose_words import motion_words
from certreg.report.reload import report_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


RNG = np.random.default_rng(3)
SOURCE = RNG.normal(size=(9, 3))
TARGET = 2.0 * SOURCE[:, [1, 2, 0]] + [4.0, 5.0, 6.0] + 0.01 * RNG.normal(size=(9, 3))
AXES = np.array([s * row for row in np.eye(3) for s in (1.0, -1.0)])
MODELS: dict[str, dict[str, Any]] = {
    "asymmetric": {"scale": "asymmetric"},
    "symmetric": {"scale": "symmetric"},
    "rotation": {"rotation_only": True},
    "both": {"scale": "asymmetric", "rotation_only": True},
}
IN_SPACE = ("turns, moves", "Centre", "Translation", "translations", "shifts", "by its translation")
OF_A_SCENE = ("three.js", "Play", "Push it", "chart", "JavaScript")
BIAS = {
    "asymmetric": "noise in the source makes it too small; noise in the target does not",
    "symmetric": "right where both clouds have the same relative noise, too large with noise in "
    "the target alone",
}
UNTESTED = "no test is made for outlying rows, shuffled rows or a mirror image"


@cache
def registered(model: str) -> Any:
    return certreg.certify(RegistrationProblem(SOURCE, TARGET, **MODELS[model]))


def stretched(factors: Sequence[float], **options: Any) -> Any:
    """Six points on the axes; the target is stretched along each by one of the factors."""
    problem = RegistrationProblem(AXES, AXES * factors, scale="asymmetric")
    return certreg.certify(problem, relaxation=False, **options)


def words_of(page: bytes) -> str:
    """What stands on a page, without style and tags, in one line."""
    text = re.sub(r"(?s)<style>.*?</style>", "", page.decode())
    return " ".join(html.unescape(re.sub(r"(?s)<[^>]*>", " ", text)).split())


def told(registration: Any) -> str:
    return words_of(html_page(report_on(registration)))


@pytest.mark.parametrize("model", ["asymmetric", "symmetric", "both"])
def test_the_scale_is_told_with_its_proved_interval_and_what_noise_does_to_it(model: str):
    found = registered(model)
    page, low_high = told(found), found.to_dict()["pose"]["scale_interval"]
    low, high = at_least(low_high[0], 17), at_most(low_high[1], 17)

    assert f"Scale {found.pose.scale:.9g} {found.problem.scale}: target over source" in page
    assert f"Scale ≥ {low} at most {high}, of every optimum" in page
    assert f"The scale of every optimum is at least {low} and at most {high}" in page
    assert f"the matrix has it in its rotation: {found.pose.scale!r} " in page
    bias = BIAS[found.problem.scale]
    assert f"Of the scale: {bias}." in page
    assert f"that noise leaves the scale alone: {bias};" in page


@pytest.mark.parametrize("model", list(MODELS))
def test_which_tests_are_not_made_is_said_beside_the_fit_and_among_what_is_not_claimed(model: str):
    page = told(registered(model))

    assert page.count(UNTESTED) == 2
    assert "raise no warning" not in page
    assert "The fit not tested" in page


@pytest.mark.parametrize("model", ["rotation", "both"])
def test_without_a_translation_there_is_no_word_of_one(model: str):
    page = (
        told(registered(model))
        .replace("without a translation", "")
        .replace("Without a translation", "")
    )
    page = page.replace("with the translation of the matrix", "")

    assert [word for word in IN_SPACE if word in page] == []
    assert ", about the origin: the sum of weighted squared distances" in page


SAID = {
    "asymmetric": (
        "with a scale above 0, where the springs balance and the fit is not the best",
        (
            "the source turns, moves and changes its size: a body that breathes. The index "
            "counts the independent directions in which the energy falls; with a scale above 0 it "
            "is 0 only at the best."
        ),
        "; the certificate has both in more digits.",
        ", of every optimum; both are rounded outwards",
        "Poses, scales, energies and RMSE are rounded to doubles from at least 57 digits.",
        "that all rows belong: with a free scale no test",
        "Between which numbers the scale stays",
        "The best scale, and what it costs",
        "Where the body that breathes rests",
        "How many eigenvalues are positive",
        "in units of the springs",
        "the scale over time, from 1 to rest",
    ),
    "symmetric": (
        "The symmetric scale is the same whatever the rotation, also at these poses.",
        (
            "The symmetric scale is the same whatever the rotation: a source of that size is a "
            "rigid body. The index counts the independent turns that lower the energy: 0 only at "
            "the best."
        ),
        "Other poses at rest 3 where the springs balance and the fit is not the best",
    ),
    "rotation": (
        (
            "Each pair is joined by a spring, and the source turns about the origin as one rigid "
            "body. The index counts the independent turns that lower the energy: 0 only at the "
            "best."
        ),
    ),
    "both": (
        "the source turns about the origin and changes its size: a body that breathes",
        "without a translation no test is made",
    ),
}


@pytest.mark.parametrize("model", list(SAID))
def test_what_moves_and_what_is_known_of_it_is_said(model: str):
    page = told(registered(model))

    assert [words for words in SAID[model] if words not in page] == []


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ([[0.0, 0.0, 0.0]] * 3, "are all at the origin"),
        (
            [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [-1.0, -2.0, -3.0]],
            "are on one line through the origin",
        ),
    ],
)
def test_directions_without_a_dynamics_are_told_where_they_lie(source: Any, words: str):
    problem = RegistrationProblem(source, np.eye(3), rotation_only=True)

    assert f"The source points {words}, so the dynamics of the body is not defined." in told(
        certreg.certify(problem)
    )


def test_of_a_symmetric_scale_the_bound_is_of_the_squares_over_the_scale():
    page = told(registered("symmetric"))

    assert "the sum of weighted squared distances divided by the scale" in page
    assert "divided by the scale" not in told(registered("asymmetric"))
    assert "The symmetric scale is the same whatever the rotation" in page
    assert "Inside out" not in page
    assert "Nothing was moved: the symmetric scale minimises the energy over the scale" in page


@pytest.mark.parametrize("model", list(MODELS))
def test_the_page_runs_no_script_and_holds_the_certificate_as_a_link(model: str):
    found = registered(model)
    page = html_page(report_on(found)).decode()
    link = re.search(r'href="data:application/json;base64,([^"]+)"', page)

    assert "<script" not in page
    assert "script-src 'none'" in html.unescape(page)
    assert [word for word in OF_A_SCENE if word in words_of(page.encode())] == []
    assert link is not None
    assert base64.b64decode(link.group(1)) == found.certificate.to_json()


@pytest.mark.parametrize(
    ("factors", "count", "below", "rows"),
    [
        ((4.0, 3.0, -2.0), "exactly three with a scale above 0: the optimum and two", "one", 3),
        ((3.0, 2.0, 0.5), "exactly two with a scale above 0: the optimum and one", "two", 2),
        ((0.4, 0.4, 0.4), "exactly one with a scale above 0: the optimum alone", "", 1),
    ],
)
def test_all_poses_at_rest_are_listed_with_their_scales_and_the_states_below_0_counted(
    factors: tuple[float, ...], count: str, below: str, rows: int
):
    found = stretched(factors, simulation=False)
    page, table = told(found), html_page(report_on(found)).decode().split('id="listed"')[1]

    assert f"Poses at which a body can rest whose size is free: {count}" in page
    assert f"Inside out (scale below 0): {below}" in page
    assert table.split("</table>")[0].count("<tr>") == 1 + rows
    assert "Nothing was moved: " in page


def test_clouds_that_do_not_correspond_have_no_pose_at_rest():
    page = told(stretched((0.0, 0.0, 0.0), simulation=False))

    assert "none with a scale above 0; the body shrinks to a point" in page
    assert "0: the clouds do not correspond (the cross-covariance is zero)" in page
    assert "<table>" not in page


def test_that_a_body_never_collapses_is_said_to_be_proved_where_it_is_alone():
    proved, open_ = told(stretched((4.0, 3.0, -2.0))), told(stretched((0.4, 0.4, 0.4)))
    theorem = "A body with little energy does not collapse"

    assert "Proved: the exact motion never comes to the scale 0" in proved
    assert theorem in proved
    assert "Not proved that the exact motion never comes to the scale 0" in open_
    assert theorem not in open_


def test_the_motion_is_told_and_drawn_with_its_scale():
    found = registered("asymmetric")
    moved = html_page(report_on(found)).decode().split('id="moved"')[1].split("</section>")[0]

    assert moved.count("<polyline") == 2
    assert f"{found.trajectory.scales[-1]:.6g} at the end, from 1; that of the optimum" in moved
    turned = html_page(report_on(registered("rotation"))).decode().split('id="moved"')[1]
    assert turned.split("</section>")[0].count("<polyline") == 1


@pytest.mark.one_in(4)
@pytest.mark.parametrize("model", list(MODELS))
def test_the_report_is_made_again_from_the_certificate(model: str, tmp_path: Path):
    found = registered(model)
    path, heard = found.save(tmp_path), list[str]()
    again = report_of(path, noted=heard.append).html()

    assert words_of(again) == words_of((tmp_path / "report.html").read_bytes())
    assert len(heard) == 1
    still = "no motion is computed anew: the symmetric scale is that of no springs"
    assert (heard[0] == still) is (model == "symmetric")


def weaker(found: Any, file: Path, **claims: Any) -> Path:
    """The certificate of a registration, which claims less."""
    body = found.certificate.body
    less = replace(found.certificate, body=replace(body, claims=replace(body.claims, **claims)))
    file.write_bytes(less.to_json())
    return file


def test_the_interval_on_the_page_is_the_one_that_the_certificate_given_proves(tmp_path: Path):
    file = tmp_path / "wide.json"
    wide = {"scale_lower": Dyadic.of_pair([1, 0]), "scale_upper": Dyadic.of_pair([3, 0])}
    page = words_of(report_of(weaker(registered("asymmetric"), file, **wide)).html())

    assert "Scale ≥ 1 at most 3, of every optimum" in page
    assert "is at least 1 and at most 3;" in page


def test_a_certificate_that_proves_little_is_called_no_better_than_it_is(tmp_path: Path):
    file = weaker(registered("asymmetric"), tmp_path / "weak.json", gap=Dyadic.of_pair([1, 0]))
    page = words_of(report_of(file).html())

    assert not page.startswith("Certified")
    assert "exceeds the minimum by at most 1.01" in page


def test_a_certificate_that_claims_too_narrow_an_interval_gives_no_page(tmp_path: Path):
    forged = weaker(
        registered("asymmetric"), tmp_path / "f.json", scale_lower=Dyadic.of_pair([3, 0])
    )

    with pytest.raises(RefusedCertificateError, match="REFUSED"):
        report_of(forged)


def test_labels_are_only_text():
    hostile = "</td><script>document.title='owned'</script>"
    problem = RegistrationProblem(SOURCE, TARGET, scale="asymmetric")
    labels = [hostile, *map(str, range(8))]
    found = certreg.certify(problem, simulation=False, about={"labels": labels})

    assert "<script>document" not in html_page(report_on(found)).decode()


def test_a_motion_is_told_as_a_turn_a_scale_and_a_shift():
    sizes = {model: motion_words(registered(model)) for model in MODELS}

    assert sizes["asymmetric"].startswith("The best motion turns the source by 120° about the axis")
    assert re.search(r"\), scales it by 1\.99855 and shifts it by \(", sizes["asymmetric"])
    assert re.search(r"\) and scales it by [\d.]+\.$", sizes["both"])
    assert "scales" not in sizes["rotation"]
    assert "shifts" not in sizes["rotation"]


def test_nothing_but_a_scale_scales_the_source():
    found = certreg.certify(
        RegistrationProblem(AXES, 2.0 * AXES, scale="asymmetric", rotation_only=True),
        simulation=False,
    )

    assert motion_words(found) == "The best motion turns nothing and scales the source by 2."
