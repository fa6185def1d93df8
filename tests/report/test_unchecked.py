"""Nothing is called exact that was not checked, and no more is said than is proved."""

from __future__ import annotations

import functools
import html
import json
import math
import re
import shutil
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg

from certreg.certificate.bounds import PoseBounds
from certreg.certificate.envelope import KINDS
from certreg.dynamics.integrators import SimulationSettings
from certreg.report import reload
from certreg.report.reload import STORED, WEAKER, WITHOUT_POSE, _weaker

if TYPE_CHECKING:
    from collections.abc import Callable


SURVEY = ("survey_source.csv", "survey_target.csv")
SENTENCE = re.compile(
    r'<li><p>(?P<words>[^<]*)</p><p class="rests-on"><span class="how (?P<how>\w+)'
)
OWN = "From the state in the certificate, within "
TRUE_ANYWHERE = "the exact motion can end nowhere but at the optimum, whatever the damping."


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("survey")
    data = Path(__file__).parents[2] / "certreg" / "data"
    assert certreg("certify", *(data / name for name in SURVEY), "--out", out).code == 0
    return out


@pytest.fixture
def folder(written: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(written, tmp_path, dirs_exist_ok=True))


def edited(file: Path, change: Callable[[Any], None]) -> None:
    document = json.loads(file.read_bytes())
    change(document)
    file.write_text(json.dumps(document), "utf-8")


def known(page: Path) -> dict[str, str]:
    """What a page says is known, and how it says that it is."""
    found = SENTENCE.findall(page.read_text("utf-8"))
    return {html.unescape(re.sub(r"\s+", " ", words)): how for words, how in found}


def said(page: Path, part: str) -> tuple[str, str]:
    """The one sentence that holds some words, and how it is known."""
    (match,) = [(words, how) for words, how in known(page).items() if part in words]
    return match


def forged_state(document: Any) -> None:
    """A turn of 20 degrees off the certified pose, at rest: in the basin, and no run's end."""
    half = np.radians(10.0)
    w, x, y, z = np.array(document["pose"], dtype=float) / np.linalg.norm(
        np.array(document["pose"], dtype=float)
    )
    a, b = np.cos(half), np.sin(half)
    turned = np.array([a * w - b * x, a * x + b * w, a * y + b * z, a * z - b * y])
    document["basin"] = {
        "quaternion": [int(entry) for entry in np.round(turned * 2**50)],
        "angular_velocity": [0, 0, 0, 0],
    }


@pytest.mark.slow
def test_a_report_made_with_the_simulation_says_that_its_end_is_the_state(folder: Path):
    words, how = said(folder / "report.html", OWN)

    assert how == "exact"
    assert words.endswith(TRUE_ANYWHERE)
    after, how = said(folder / "report.html", "the state in which")
    assert after.startswith("That is the state in which the simulation for this page (splitting,")
    assert how == "numerical"


@pytest.mark.slow
def test_a_forged_state_is_named_and_no_simulation_is_said_to_end_there(folder: Path):
    edited(folder / "certificate.json", forged_state)
    assert certreg("verify", folder / "certificate.json").code == 0  # it is in the basin
    assert certreg("report", folder / "certificate.json").code == 0
    words, how = said(folder / "report.html", OWN)

    assert words == f"{OWN}21° of its pose and turning by at most 0 radians per unit of time, " + (
        TRUE_ANYWHERE
    )
    assert how == "exact"
    after, how = said(folder / "report.html", "the state in which")
    assert after.startswith("That is not the state in which the simulation for this page")
    assert how == "numerical"
    assert "body ended" not in (folder / "report.html").read_text("utf-8")


def test_a_trajectory_of_another_damping_is_never_called_exact(folder: Path, monkeypatch):
    few = SimulationSettings(max_steps=1000)  # a million lead no farther
    monkeypatch.setattr(reload, "Asked", functools.partial(reload.Asked, settings=few))
    edited(folder / "certificate.json", lambda d: d["about"].update(damping=1e9))
    run = certreg("report", folder / "certificate.json")
    page = folder / "report.html"

    assert run.code == 0
    assert "computed anew, with damping 1e+09 and integrator splitting" in run.err
    words, how = said(page, "roads lead to the same rotation")
    assert "simulation for this page (splitting, damping 1e+09) does not: it ended" in words
    assert how == "numerical"
    assert said(page, "That is not the state in which")[1] == "numerical"
    exact = [words for words, how in known(page).items() if how == "exact"]
    assert not any("simulation" in words or "ended" in words for words in exact)
    assert any(words.startswith(OWN) for words in exact)  # of the state, true under any damping


@pytest.mark.slow
def test_an_edited_result_changes_no_report_and_no_judgement(folder: Path, data: Path):
    pair = [data / name for name in SURVEY]
    before = (folder / "report.html").read_bytes()
    judged = certreg("assess", *pair, "--pose", folder)

    def boast(document: Any) -> None:
        document["rmse"] = document["objective"] = 0.0
        document["optimality"] |= {"gap_bound": 0.0, "angle_bound_rad": 0.0}

    edited(folder / "result.json", boast)
    assert certreg("report", folder / "certificate.json").code == 0
    assert (folder / "report.html").read_bytes() == before
    assert certreg("assess", *pair, "--pose", folder) == judged

    def flip(document: Any) -> None:
        document["pose"] |= {"quaternion_wxyz": [1.0, 0, 0, 0]}
        document["pose"] |= {"rotation": np.eye(3).tolist()}

    edited(folder / "result.json", flip)
    wrong = certreg("assess", *pair, "--pose", folder)
    assert wrong.code == 1
    assert not wrong.out.startswith(("OPTIMAL", "NEAR-OPTIMAL"))
    moved = certreg("apply", folder, pair[0], "--out", folder / "moved.csv")
    assert "unchecked: certreg assess judges it" in moved.out


TINY, PROVED = Fraction(1, 1 << 200), Fraction(1, 3)
MOST = Fraction(WEAKER) * PROVED


def bounds(gap: Fraction, angle: float | None) -> PoseBounds:
    return PoseBounds(
        least_gap=Fraction(0), greatest_gap=gap, angle_upper=angle, least_range_squared=Fraction(1)
    )


@pytest.mark.parametrize(
    ("gap", "angle", "weaker"),
    [
        (PROVED, 0.5, False),
        (MOST, WEAKER * 0.5, False),
        (MOST + TINY, 0.5, True),
        (PROVED, math.nextafter(WEAKER * 0.5, math.inf), True),
        (PROVED, None, True),
    ],
)
def test_a_certificate_that_proves_far_less_is_told_from_one_that_does_not(
    gap: Fraction, angle: float | None, weaker
):
    assert _weaker(bounds(gap, angle), bounds(PROVED, 0.5)) is weaker
    assert _weaker(bounds(gap, angle), bounds(PROVED, None)) is (gap > MOST)
    assert not _weaker(bounds(gap, angle), None)


def test_each_kind_of_certificate_is_read_again_or_has_no_pose():
    assert STORED.keys().isdisjoint(WITHOUT_POSE)
    assert STORED.keys() | WITHOUT_POSE.keys() == KINDS.keys()
