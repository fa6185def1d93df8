"""`verify` and `report` beside clouds whose pairs have bounds: what is the same, and the remedy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg as run
from commands import write_csv

import certreg
from certreg.errors import InvalidProblemError

if TYPE_CHECKING:
    from pathlib import Path

RNG = np.random.default_rng(4)
X, N = RNG.normal(size=(2, 12, 3))
Y = X + RNG.uniform(-0.02, 0.02, X.shape)
OTHER_WEIGHTS = "REFUSED: the certified bounds or weights are others, or not given: as for certify"
OTHER_SPRINGS = "REFUSED: the certified bounds or springs are others, or not given: as for certify"
PLANES = ("--normals", "n.npy")
TURNS = ("--rotation-only", "--objective", "truncated")
NO_BOUND = "REFUSED: the certificate has --max-residual: give the same"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place: Path = tmp_path_factory.mktemp("bound")
    write_csv(place / "x.csv", X.tolist())
    write_csv(place / "y.csv", Y.tolist())
    np.save(place / "n.npy", N)
    (place / "bounds.txt").write_text("0.05\n" * 12, "utf-8")
    (place / "weights.txt").write_text("2\n" * 12, "utf-8")
    clouds = place / "x.csv", place / "y.csv", "--max-residual", "0.05"
    run("certify", *clouds, "--out", place / "points")
    run("certify", *clouds, "--normals", place / "n.npy", "--out", place / "planes")
    run("certify", *clouds, *TURNS, "--out", place / "turns")
    return place


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize(
    ("kind", "options", "said"),
    [
        ("points", ("--max-residual", "0.05"), "VERIFIED"),
        ("points", ("--max-residual", "bounds.txt"), "VERIFIED"),
        ("points", ("--max-residual", "0.06"), OTHER_WEIGHTS),
        ("points", ("--max-residual", "0.05", "--weights", "weights.txt"), OTHER_WEIGHTS),
        ("points", (), NO_BOUND),
        ("points", ("--max-residual", "0.05", *TURNS), "REFUSED: the certificate has --max-resid"),
        ("planes", ("--max-residual", "0.05", *PLANES), "VERIFIED"),
        ("planes", ("--max-residual", "0.06", *PLANES), OTHER_SPRINGS),
        ("planes", ("--max-residual", "0.05", "--directions", "n.npy"), OTHER_SPRINGS),
        ("planes", ("--max-residual", "0.05"), "REFUSED: the certificate is about another number"),
        ("planes", PLANES, NO_BOUND),
        ("turns", ("--max-residual", "0.05", *TURNS), "VERIFIED"),
        ("turns", ("--max-residual", "0.06", *TURNS), "REFUSED: the certified bounds are other on"),
        ("turns", ("--max-residual", "0.05"), "REFUSED: the certificate has --rotation-only --obj"),
        ("turns", TURNS[:1], "REFUSED: the certificate has --rotation-only --objective truncated"),
    ],
)
def test_bounds_are_what_a_certificate_is_about(
    folder: Path, kind: str, options: tuple[Any, ...], said: str
):
    given = [folder / one if str(one).endswith(("txt", "npy")) else one for one in options]
    clouds = folder / "x.csv", folder / "y.csv"
    found = run("verify", folder / kind / "certificate.json", *clouds, *given)

    assert found.code == (said != "VERIFIED")
    assert said in found.out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--max-residual", "0.05"), "give SOURCE and TARGET, or neither"),
        (("x.csv", "y.csv", "--objective", "truncated"), "--objective goes with --max-residual"),
        (
            ("x.csv", "y.csv", "--max-residual", "0.05", "--any-weight"),
            "--any-weight goes without --max-residual: give the --sigma that was certified",
        ),
        (("x.csv", "y.csv", "--max-residual", "no.txt"), "no.txt: neither a number nor a file"),
        (("x.csv", "y.csv", "--max-residual", "0"), "--max-residual is 0.0: a bound must be"),
    ],
)
def test_what_does_not_go_together_is_refused_in_one_line(
    folder: Path, options: tuple[str, ...], said: str
):
    given = [folder / one if one.endswith("csv") else one for one in options]
    found = run("verify", folder / "points" / "certificate.json", *given)

    assert found.code == 2
    assert said in found.err


@pytest.mark.slow
def test_a_report_is_made_beside_the_same_clouds_alone(folder: Path):
    asked = "report", folder / "planes" / "certificate.json", folder / "x.csv", folder / "y.csv"
    given = "--normals", folder / "n.npy", "--max-residual"
    assert run(*asked, *given, "0.05", "--out", folder / "r.html").code == 0
    refused = run(*asked, *given, "0.06", "--out", folder / "r.html")
    assert refused.code == 1
    assert OTHER_SPRINGS in refused.err


@pytest.mark.slow
def test_python_takes_the_same(folder: Path):
    problem = certreg.RegistrationProblem(X, Y, normals=N)
    path = folder / "planes" / "certificate.json"
    assert certreg.verify(path, problem, max_residual=0.05).proved
    assert certreg.verify(path, problem, max_residual=[0.05] * 12).proved
    assert not certreg.verify(path, problem, max_residual=0.06).proved
    turned = certreg.RegistrationProblem(X, Y, rotation_only=True)
    told: dict[str, Any] = {"max_residual": 0.05, "objective": "truncated"}
    assert certreg.verify(folder / "turns" / "certificate.json", turned, **told).proved
    refused: tuple[tuple[Any, dict[str, Any], str], ...] = (
        (problem, {"objective": "truncated"}, "objective is 'truncated': give 'consensus' or 'tr"),
        (problem, {"max_residual": 0.05, "objective": "least"}, "objective is 'least': give 'con"),
        (problem, {"max_residual": -1.0}, "max_residual is -1.0: a bound must be finite and > 0"),
        (None, {"max_residual": 0.05}, "max_residual goes with a problem: give the points"),
    )
    for given, options, words in refused:
        with pytest.raises(InvalidProblemError, match=words):
            certreg.verify(path, given, **options)
