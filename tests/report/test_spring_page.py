"""The page, the documents and the files of general springs: complete, and true of springs."""

from __future__ import annotations

import base64
import html
import json
import re
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from spring_families import line, plane

from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.report.document import dumps, pose_document, result_document
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.reload import report_of

if TYPE_CHECKING:
    from pathlib import Path


OF_ONE_WEIGHT = (  # what is true of one weight per pair alone
    *("eigenvalue", "Davenport", "weighted squared distances", "mbiguity margin", "three.js"),
    *("can rest", "growing mode", "spread", "best scale", "Worst rotation", "closed form"),
    *("mirror", "shuffled", "the motion", "simulat", "points and weights"),
)


@cache
def registered(kind: str) -> Any:
    rng = np.random.default_rng(2)
    given = {"plane": plane, "line": line, "walls": plane}[kind](rng, 15, 0.02)
    springs: dict[str, Any] = dict(given.springs)
    if kind == "walls":
        springs["normals"] = np.eye(3)[np.arange(15) % 2]
    return certify(RegistrationProblem(given.source, given.target, **springs))


def words_of(page: bytes) -> str:
    """What stands on a page, without style and tags."""
    text = re.sub(r"(?s)<style>.*?</style>", "", page.decode())
    return re.sub(r"(?s)<[^>]*>", " ", text)


@pytest.mark.one_in(3)
@pytest.mark.parametrize("kind", ["plane", "line", "walls"])
def test_the_page_says_nothing_that_is_true_of_one_weight_per_pair_alone(kind: str):
    words = words_of(html_page(Report.of(registered(kind))))

    assert [each for each in OF_ONE_WEIGHT if each in words] == []
    assert "SHA-256 of the points and springs" in words
    assert "exceeds the minimum by at most" in words
    assert "The pairs that are farthest off along their springs" in words
    assert "off along the springs" in words


def test_the_page_runs_no_script_and_holds_the_certificate_as_a_link():
    found = registered("plane")
    page = html_page(Report.of(found)).decode()
    link = re.search(r'href="data:application/json;base64,([^"]+)"', page)

    assert "<script" not in page
    assert "script-src 'none'" in html.unescape(page)
    assert link is not None
    assert base64.b64decode(link.group(1)) == found.certificate.to_json()


@pytest.mark.parametrize("kind", ["plane", "line", "walls"])
def test_the_result_follows_its_schema_and_every_null_has_its_reason(kind: str):
    from importlib.resources import files

    text = (files("certreg.report") / "schemas" / "certreg-result-1.json").read_text("utf-8")
    document = json.loads(dumps(result_document(registered(kind))))
    faults = list(Draft202012Validator(json.loads(text)).iter_errors(document))

    assert faults == []
    assert document["springs"]["kind"] == ("line" if kind == "line" else "plane")
    assert document["optimality"]["method"] == "sos-4"
    assert document["equilibria"] is None
    assert document["simulation"] is None
    for path in ("equilibria", "simulation", "agreement.closed_form_deg", "fit.explained"):
        assert document["reasons"][path]
    assert json.loads(dumps(pose_document(registered(kind))))["T_target_source"]


@pytest.mark.slow
def test_the_files_of_a_folder_are_written_and_its_report_is_made_again(tmp_path: Path):
    found = registered("plane")
    path = found.save(tmp_path)
    names = {"certificate.json", "fit.csv", "pose.json", "pose.txt", "report.html", "result.json"}

    assert {each.name for each in tmp_path.iterdir()} == names
    assert path is not None
    again = report_of(path)
    assert words_of(again.html())[:2000] == words_of((tmp_path / "report.html").read_bytes())[:2000]
    header, first, *_ = (tmp_path / "fit.csv").read_text("utf-8").splitlines()
    assert header == "row,label,residual,standardised"
    assert float(first.split(",")[2]) == pytest.approx(found.residuals[0])
