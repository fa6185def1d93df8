"""Warnings of pairs that may be wrong: one rule for first lines, colours, --require-fit, batch."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from campaign_work import InProcess
from commands import certreg as run
from commands import strict_json, write_csv
from jsonschema import Draft202012Validator

import certreg
from certreg.problem.arrays import diameter
from certreg.registration.misfits import FitCode
from certreg.registration.pair_warnings import WIDE, few_warning, poor_warning, reason_against
from certreg.report.cards import AMBER, GREEN
from certreg.report.pages import report_on
from certreg.report.viewer import Names

if TYPE_CHECKING:
    from pathlib import Path

SCHEMA = json.loads(
    (files("certreg.report") / "schemas" / "certreg-result-1.json").read_text("utf-8")
)
CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
CUBE = np.vstack([CUBE, 0.5 * CUBE[:4]])
SIZE = diameter(CUBE)
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # boxes stay as large
TURNED = ("--rotation-only", "--objective", "truncated")
MODELS = {"most": (), "scaled": ("--scale", "asymmetric"), "turned": TURNED}
OPTIONS: dict[str, dict[str, Any]] = {
    "most": {},
    "scaled": {"scale": "asymmetric"},
    "turned": {"rotation_only": True, "objective": "truncated"},
}


def certified(model: str, bound: float, source: Any = CUBE, target: Any = None) -> Any:
    """Of a cube and some points in it, turned."""
    seen = source @ TURN.T if target is None else target
    return certreg.certify(source, seen, max_residual=bound, **OPTIONS[model])


@pytest.mark.parametrize(
    ("met", "n", "few"),
    [(3, 3, True), (4, 39, False), (4, 40, True), (6, 60, True), (7, 999, False)],
)
def test_few_pairs_are_told_what_helps(met, n, few):
    warning = few_warning(met, n)

    assert (warning is not None) is few
    if warning is not None:
        assert warning.remedy == "give more pairs, or a smaller bound if right pairs keep it"


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("share", "wide"), [(WIDE * 1.001, True), (WIDE * 0.999, False)])
def test_a_wide_bound_is_said_everywhere(model, share, wide):
    found = certified(model, share * SIZE)
    report = report_on(found)
    page = report.html().decode()

    assert found.exit_code == 0
    assert found.headline.startswith(f"CERTIFIED{', BUT THE BOUND IS WIDE' * wide}: ")
    assert [one.code for one in found.warnings] == [FitCode.WIDE_BOUND] * wide
    assert found.good is report.values(Names.of({}, len(CUBE)))["good"] is not wide
    assert ("an inlier may well be a wrong pair" in page) == wide
    assert ('<span class="mark open">the bound is wide</span>' in page) == wide
    assert ("Give a smaller bound, if right pairs keep it." in page) == wide
    assert ("What to do: give a smaller bound, if right pairs keep it." in str(found)) == wide
    assert (AMBER in found._repr_html_(), GREEN in found._repr_html_()) == (wide, not wide)
    assert ("Warning: the bound is " in found._repr_html_()) == wide
    told = found.to_dict()
    Draft202012Validator(SCHEMA).validate(told)
    assert [one["code"] for one in told["fit"]["warnings"]] == ["wide-bound"] * wide


@pytest.mark.parametrize("model", MODELS)
def test_fit_and_batch_heed_it(model, tmp_path: Path, monkeypatch):
    monkeypatch.setattr("certreg.cli.campaigns.workers_at", lambda _: InProcess(1))
    clouds = write_csv(tmp_path / "a.csv", CUBE.tolist()), tmp_path / "b.csv"
    write_csv(clouds[1], (CUBE @ TURN.T).tolist())
    fields = {"most": ",,", "scaled": "asymmetric,,", "turned": ",truncated,yes"}[model]
    bounds = {"wide": 0.3 * SIZE, "tight": 0.1 * SIZE}
    rows = [f"{name},a.csv,b.csv,{bound},{fields}" for name, bound in bounds.items()]
    header = "name,source,target,max_residual,scale,objective,rotation_only"
    (tmp_path / "list.csv").write_text("\n".join([header, *rows, ""]), "utf-8")

    asked = "certify", *clouds, *MODELS[model], "--max-residual"
    codes = [run(*asked, bound, "--require-fit").code for bound in bounds.values()]
    assert codes == [4, 0]
    assert run(*asked, bounds["wide"]).code == 0
    for demand, expected in ((), [0, 0]), (("--require-fit",), [4, 0]):
        told = run("batch", tmp_path / "list.csv", "--out", tmp_path / "o", *demand)
        lines = (tmp_path / "o" / "results.jsonl").read_bytes().splitlines()
        with (tmp_path / "o" / "summary.csv").open(encoding="utf-8") as stream:
            table = list(csv.DictReader(stream))
        assert [strict_json(line)["exit_code"] for line in lines] == expected
        assert [row["warnings"] for row in table] == ["wide-bound", ""]
        assert "wide: the bound is " in told.err
        assert "tight: " not in told.err


@pytest.mark.parametrize("share", [0.0, 0.499999, 0.5, 1.0, None])
@pytest.mark.parametrize("model", MODELS)
def test_a_fit_that_explains_less_than_half_is_poor_where_no_test_says_it(
    model, share, monkeypatch
):
    fit = certified(model, 0.1).fit
    monkeypatch.setattr(type(fit), "fit", replace(fit.fit, explained=share))
    told = poor_warning(fit)

    assert (told is not None) == (model != "most" and share is not None and share < 0.5)
    assert reason_against(fit, () if told is None else (told,)) == (told and "THE FIT IS POOR")
    if told is not None and share is not None:
        assert told.text.startswith(f"of the target's spread the fit explains {100 * share:.3g} %")


def test_what_a_test_says_of_the_pairs_within_is_in_the_first_line():
    source = np.random.default_rng(7).uniform(-1.0, 1.0, (30, 3))
    target = 1.05 * source @ TURN.T + [1.0, 2.0, 3.0]
    found = certified("most", 0.1, source, target)

    assert str(found.fit).startswith("CERTIFIED OPTIMUM, BUT ")
    reason = str(found.fit).split(", BUT ")[1].split(":")[0]
    assert found.headline.startswith(f"CERTIFIED, BUT {reason}: ")
    assert not found.good


@pytest.mark.parametrize("model", MODELS)
def test_one_wide_bound_of_many_is_warned_of(model):
    bounds = np.where(np.arange(len(CUBE)) == 3, 0.3, 0.1) * SIZE
    found: Any = certreg.certify(CUBE, CUBE @ TURN.T, max_residual=bounds, **OPTIONS[model])

    assert [one.code for one in found.warnings] == [FitCode.WIDE_BOUND]
    assert "the bound is 30 % of the cloud's size" in str(found)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_with_a_free_scale_a_bound_is_wide_beside_the_target_alone(size):
    for share, wide in ((WIDE * 1.001, True), (WIDE * 0.999, False)):
        found = certified("scaled", share * SIZE, size * CUBE, CUBE @ TURN.T)
        assert [one.code for one in found.warnings] == [FitCode.WIDE_BOUND] * wide


@pytest.mark.parametrize("turned", [False, True])
def test_of_a_known_scale_a_bound_is_wide_beside_the_smaller_cloud(turned):
    far = np.where(np.arange(len(CUBE)) < 3, 3.0, 1.0)[:, np.newaxis] * CUBE  # three are wrong
    clouds = (far, CUBE @ TURN.T) if turned else (CUBE, far @ TURN.T)
    found = certified("most", WIDE * 1.001 * SIZE, *clouds)

    assert diameter(far) > 2.0 * SIZE
    assert FitCode.WIDE_BOUND in [one.code for one in found.warnings]


@pytest.mark.parametrize(
    ("source", "begun", "code"),
    [
        pytest.param(np.eye(3), "PARTLY PROVED: ", 4, marks=pytest.mark.long),
        (np.eye(3)[[2, 2, 2]], "CERTIFIED, NOT UNIQUE: ", 3),
    ],
)
def test_directions_that_are_one_fix_no_rotation(source, begun, code):
    found = certified("turned", 0.1, source, np.eye(3)[[2, 2, 2]])

    assert str(found).startswith(begun)
    assert found.exit_code == code
    assert found.warnings == ()
