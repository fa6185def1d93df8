"""A poor fit is said in the first line, JSON, page and table, and asked for by options."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from campaign_work import InProcess
from commands import certreg, write_csv

from certreg.problem.problem import RegistrationProblem
from certreg.registration import headlines as listed
from certreg.registration.certification import certify
from certreg.registration.exit_codes import FitDemands
from certreg.registration.headlines import headline_of
from certreg.report.document import result_document
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.reload import report_of
from certreg.report.summary import registration_summary
from certreg.results import Limits

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.registration.result import Registration

CLOUD = np.random.default_rng(1).standard_normal((12, 3))
NOISY = CLOUD + 0.01 * np.random.default_rng(2).standard_normal((12, 3))
MISTYPED = NOISY + 9.0 * np.outer(np.arange(12) == 5, [0.0, 1.0, 0.0])
LABELS = [f"<b>P{k}\x1b[31m" for k in range(12)]


def proof_of(target: object, labels: list[str] | None = None, **options: object) -> Registration:
    problem = RegistrationProblem(CLOUD, target, **options)  # pyright: ignore[reportArgumentType]
    about = {} if labels is None else {"labels": labels}
    return certify(problem, relaxation=False, simulation=False, about=about)


@pytest.fixture(scope="module")
def poor() -> Registration:
    return proof_of(MISTYPED, LABELS)


@pytest.fixture(scope="module")
def good() -> Registration:
    return proof_of(NOISY)


def test_the_first_line_says_that_the_fit_is_poor_and_why(poor, good):
    words = registration_summary(poor)
    stamp = "CERTIFIED OPTIMUM, BUT THE FIT IS POOR: row 5 (<b>P5\\x1b[31m)"

    assert headline_of(poor) is listed.POOR_FIT
    assert not headline_of(poor).good
    assert words.startswith(stamp)
    assert "proved gap" in words
    assert words.count("not fit the best pose of the others") == 1
    assert headline_of(good) is listed.CERTIFIED
    assert "warning" not in registration_summary(good)


@pytest.mark.parametrize(
    ("scale", "words"),
    [
        (1.0 + 1e-8, "larger than the source by 1e-08 of its size (0.01 ppm)"),
        (1.0 + 2e-5, "larger than the source by 2e-05 of its size (20 ppm)"),
        (0.9998, "smaller than the source by 0.0002 of its size (200 ppm)"),
        (1.05, "1.05 times as large as the source"),
    ],
)
def test_a_good_fit_that_a_scale_makes_better_is_not_called_poor(scale: float, words: str):
    noise = 1e-4 * abs(scale - 1.0) * np.random.default_rng(2).standard_normal((12, 3))
    registration = proof_of(scale * CLOUD + noise)
    first = registration_summary(registration).splitlines()[0]

    assert headline_of(registration) is listed.SCALE_FITS
    assert first.startswith(f"CERTIFIED OPTIMUM, BUT A SCALE FITS BETTER: taken as {words}, ")
    assert "100.00" not in registration_summary(registration)


@pytest.mark.parametrize("scale", [0.8, 1.2, 1000.0])
def test_another_size_is_a_poor_fit(scale: float):
    assert headline_of(proof_of(scale * NOISY)) is listed.POOR_FIT


def test_a_scale_beside_another_warning_is_a_poor_fit():
    both = proof_of(1.05 * CLOUD, sigma=1e-5)

    assert [code.value for code in both.fit.codes] == ["scale", "chi2"]
    assert headline_of(both) is listed.POOR_FIT


def test_what_is_proved_comes_before_what_is_likely(poor):
    bounded = replace(poor, limits=Limits(max_gap=0.0))

    assert headline_of(bounded) is listed.BOUNDED
    assert "  warning           row 5" in registration_summary(bounded)


def test_further_warnings_stand_below_the_numbers():
    words = registration_summary(proof_of(MISTYPED, sigma=0.01))

    assert "  warning           the residuals are" in words


def test_the_document_holds_the_fit(poor, good):
    fit, quiet = (result_document(one)["fit"] for one in (poor, good))

    assert [warning["code"] for warning in fit["warnings"]] == ["outlier-rows"]
    assert (fit["worst"][0]["row"], fit["worst"][0]["label"]) == (5, LABELS[5])
    assert quiet["warnings"] == []
    assert "label" not in quiet["worst"][0]
    assert quiet["explained"] > 0.999
    assert fit["explained"] < 0.5
    assert result_document(good)["reasons"]["fit.chi2"].startswith("no noise was given")


def test_the_page_warns_and_escapes(poor, good):
    page, quiet = (html_page(Report.of(one)).decode() for one in (poor, good))

    assert '<p class="stamp open">CERTIFIED OPTIMUM, BUT THE FIT IS POOR</p>' in page
    assert "<b>P5" not in page.split("<script")[0]
    assert "FIT IS POOR" not in quiet


def test_the_page_of_a_certificate_alone_says_the_same(poor, tmp_path: Path):
    path = tmp_path / "certificate.json"
    assert poor.certificate is not None
    poor.certificate.save(path)

    report: Any = report_of(path)
    assert report.verdict_words[0] == registration_summary(poor).splitlines()[0]


def test_demands_are_met_exactly_up_to_themselves(poor, good):
    rmse = good.rmse or 0.0

    def unmet(one: Registration, **demands: Any) -> list[str]:
        return FitDemands(**demands).unmet(one.rmse, warned=bool(one.fit.warnings))

    assert poor.exit_code == good.exit_code == 0
    assert not unmet(poor)
    assert unmet(poor, require_fit=True)
    assert not unmet(good, require_fit=True)
    assert not unmet(good, max_rmse=rmse)
    assert unmet(good, max_rmse=float(np.nextafter(rmse, 0.0)))
    assert unmet(replace(good, rmse=None), max_rmse=1e308)
    both: dict[str, Any] = {"require_fit": True, "max_rmse": rmse / 2}
    assert unmet(good, **both) == [f"the RMSE is {rmse:.6g}, more than {rmse / 2!r}"]
    for limit in (np.nextafter(rmse, 0.0), rmse * (1.0 - 1e-9), rmse * (1.0 - 1e-5)):
        (words,) = unmet(good, max_rmse=float(limit))
        told = float(words.split()[3].removesuffix(","))
        assert limit < told == pytest.approx(rmse, rel=1e-5)
    assert unmet(replace(poor, rmse=None), **both) == [
        "the fit has warnings",
        f"the RMSE is beyond doubles, more than {rmse / 2!r}",
    ]


@pytest.fixture
def clouds(tmp_path: Path) -> list[Path]:
    arrays = {"source": CLOUD, "target": NOISY, "wrong": MISTYPED}
    return [write_csv(tmp_path / f"{name}.csv", array.tolist()) for name, array in arrays.items()]


@pytest.mark.slow
def test_the_command_line_asks_for_a_fit(clouds):
    source, target, wrong = clouds
    quick = ("--no-relaxation", "--no-simulation")

    assert certreg("certify", source, wrong, *quick).code == 0
    asked = certreg("certify", source, wrong, *quick, "--require-fit")
    assert (asked.code, asked.err) == (4, "certreg: the fit has warnings: exit code 4\n")
    assert certreg("certify", source, target, *quick, "--require-fit", "--max-rmse", "1").code == 0
    larger = certreg("certify", source, target, *quick, "--max-rmse", "1e-9")
    assert larger.code == 4
    assert "more than 1e-09" in larger.err
    for nonsense in ("-1", "nan", "inf"):
        assert certreg("certify", source, target, "--max-rmse", nonsense).code == 2


@pytest.mark.slow
def test_a_list_names_its_poor_pairs(clouds, tmp_path: Path, monkeypatch):
    monkeypatch.setattr("certreg.cli.campaigns.workers_at", lambda _: InProcess(1))
    listing = tmp_path / "list.csv"
    listing.write_text(
        "name,source,target\nfine,source.csv,target.csv\nbad,source.csv,wrong.csv\n", "utf-8"
    )
    run = certreg("batch", listing, "--out", tmp_path / "out")
    with (tmp_path / "out" / "summary.csv").open(encoding="utf-8") as stream:
        table = list(csv.DictReader(stream))
    lines = (tmp_path / "out" / "results.jsonl").read_text("utf-8").splitlines()
    fine, bad = (json.loads(line) for line in lines)

    assert run.code == 0
    assert run.err.splitlines()[0].startswith("warning: bad: row 5, counting from 0, does not fit")
    assert 'certreg: 1 of 2 pairs has a warning: look for "warning" in the results' in run.err
    assert [row["warnings"] for row in table] == ["", "outlier-rows"]
    assert float(table[1]["explained"]) == bad["fit"]["explained"]
    assert [float(table[0][f"q{axis}"]) for axis in "wxyz"] == fine["pose"]["quaternion_wxyz"]
    assert [float(table[0][f"t{axis}"]) for axis in "xyz"] == fine["pose"]["translation"]
    assert certreg("batch", listing, "--require-fit").code == 4


@pytest.mark.slow
def test_what_is_asked_of_the_fit_may_change_when_a_campaign_goes_on(
    clouds, tmp_path: Path, monkeypatch
):
    monkeypatch.setattr("certreg.cli.campaigns.workers_at", lambda _: InProcess(1))
    listing, out = tmp_path / "list.csv", tmp_path / "out"
    listing.write_text(
        "name,source,target\nfine,source.csv,target.csv\nbad,source.csv,wrong.csv\n", "utf-8"
    )

    def codes(*options: str) -> tuple[int, list[int], list[str]]:
        run = certreg("batch", listing, "--out", out, *options)
        lines = [
            json.loads(line) for line in (out / "results.jsonl").read_text("utf-8").splitlines()
        ]
        with (out / "summary.csv").open(encoding="utf-8") as stream:
            table = [row["exit_code"] for row in csv.DictReader(stream)]
        return run.code, [line["exit_code"] for line in lines], table

    first = codes()
    monkeypatch.setattr("certreg.campaign.pairs.certify", None)  # nothing is computed again
    bytes_then = (out / "results.jsonl").read_bytes()

    assert first == (0, [0, 0], ["0", "0"])
    assert codes("--require-fit") == (4, [0, 4], ["0", "4"])
    assert codes("--max-rmse", "1e-9") == (4, [4, 4], ["4", "4"])
    assert codes() == first
    assert (out / "results.jsonl").read_bytes() == bytes_then
    other = certreg("batch", listing, "--out", out, "--max-gap", "1e-7")
    assert (other.code, "another campaign stands there" in other.err) == (2, True)
