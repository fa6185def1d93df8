"""`verify` and `report` beside clouds whose pairs have bounds: what is the same, and the remedy."""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg as run
from commands import write_csv

import certreg
from certreg.errors import InvalidProblemError
from certreg.verify import Clouds

if TYPE_CHECKING:
    from pathlib import Path

RNG = np.random.default_rng(4)
X, N = RNG.normal(size=(2, 12, 3))
Y = X + RNG.uniform(-0.02, 0.02, X.shape)
OTHER_BOUND = "REFUSED: the certified bound is 0.05, given is 0.06: give --max-residual 0.05\n"
ONE_BOUND = (
    "REFUSED: the certified bound of row 4 (from 0) is {}, given is {} (1 of 12 bounds differ): "
    "give --max-residual {}\n"
)
PLANES = ("--normals", "n.npy")
TURNS = ("--rotation-only", "--objective", "truncated")
NO_BOUND = (
    "REFUSED: the certificate was made with --max-residual 0.05, given is none: give "
    "--max-residual 0.05\n"
)
TURNED = (
    "REFUSED: the certificate was made with --rotation-only --objective truncated --max-residual"
)
SIZED = (
    "REFUSED: the certificate was made with --scale symmetric --max-residual 0.05, given is "
    "--max-residual"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place: Path = tmp_path_factory.mktemp("bound")
    write_csv(place / "x.csv", X.tolist())
    write_csv(place / "y.csv", Y.tolist())
    np.save(place / "n.npy", N)
    for name, fifth in (("bounds.txt", 0.05), ("others.txt", 0.06)):
        text = "".join(f"{fifth if row == 4 else 0.05}\n" for row in range(12))
        (place / name).write_text(text, "utf-8")
    (place / "weights.txt").write_text("2\n" * 12, "utf-8")
    (place / "unequal.txt").write_text("1\n2\n" * 6, "utf-8")
    np.save(place / "m.npy", np.where(np.arange(12)[:, np.newaxis] == 7, -2.0 * N, N))
    clouds = place / "x.csv", place / "y.csv", "--max-residual", "0.05"
    run("certify", *clouds, "--out", place / "points")
    run("certify", *clouds, "--normals", place / "n.npy", "--out", place / "planes")
    run("certify", *clouds, *TURNS, "--out", place / "turns")
    run("certify", *clouds, "--sigma", "0.01", "--out", place / "noisy")
    run("certify", *clouds, "--weights", place / "weights.txt", "--out", place / "weighed")
    run("certify", *clouds, "--weights", place / "unequal.txt", "--out", place / "unequal")
    run("certify", *clouds, "--scale", "symmetric", "--out", place / "sizes")
    run("certify", *clouds[:3], place / "others.txt", "--out", place / "others")
    run("certify", *clouds[:2], "--out", place / "all")
    return place


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize(
    ("kind", "options", "said"),
    [
        ("points", ("--max-residual", "0.05"), "VERIFIED"),
        ("points", ("--max-residual", "bounds.txt"), "VERIFIED"),
        ("points", ("--max-residual", "0.06"), OTHER_BOUND),
        ("points", ("--max-residual", "others.txt"), ONE_BOUND.format(0.05, 0.06, 0.05)),
        (
            "others",
            ("--max-residual", "0.05"),
            ONE_BOUND.format(0.06, 0.05, "FILE, as for certify"),
        ),
        (
            "points",
            ("--max-residual", "0.05", "--weights", "weights.txt"),
            "REFUSED: the certified weight is 1.0, given is 2.0: leave --sigma and --weights out\n",
        ),
        (
            "points",
            ("--max-residual", "0.05", "--weights", "unequal.txt"),
            "the certified weight of row 1 (from 0) is 1.0, given is 2.0 (6 of 12 weights differ)",
        ),
        (
            "noisy",
            ("--max-residual", "0.05", "--sigma", "0.02"),
            "REFUSED: the certified weight is 10000.0, given is 2500.0: give --sigma 0.01\n",
        ),
        (
            "weighed",
            ("--max-residual", "0.05"),
            "weight is 2.0, given is 1.0: give --sigma or --weights, as for certify\n",
        ),
        (
            "unequal",
            ("--max-residual", "0.05"),
            "(6 of 12 weights differ): give --weights FILE, as for certify\n",
        ),
        (
            "points",
            ("--max-residual", "0.05", "--normals", "n.npy"),
            "REFUSED: the certificate has no springs, some are given: leave them out\n",
        ),
        ("points", (), NO_BOUND),
        (
            "points",
            ("--max-residual", "0.05", *TURNS),
            "given is --rotation-only --objective truncated --max-residual 0.05: leave --rotation-",
        ),
        (
            "others",
            (),
            "made with --max-residual FILE, given is none: give --max-residual FILE\n",
        ),
        (
            "sizes",
            ("--max-residual", "0.05", "--scale", "asymmetric"),
            "give --scale symmetric, leave --scale asymmetric out\n",
        ),
        (
            "sizes",
            ("--max-residual", "0.06", "--scale", "symmetric"),
            OTHER_BOUND,
        ),
        ("sizes", ("--max-residual", "0.05"), f"{SIZED} 0.05: give --scale symmetric\n"),
        (
            "sizes",
            ("--max-residual", "0.06"),
            f"{SIZED} 0.06: give --scale symmetric --max-residual 0.05\n",
        ),
        ("sizes", ("--max-residual", "others.txt"), f"{SIZED} FILE: give --scale symmetric --max-"),
        (
            "all",
            ("--max-residual", "0.05"),
            "made with no such option, given is --max-residual 0.05: leave --max-residual out\n",
        ),
        ("planes", ("--max-residual", "0.05", *PLANES), "VERIFIED"),
        ("planes", ("--max-residual", "0.06", *PLANES), OTHER_BOUND),
        (
            "planes",
            ("--max-residual", "0.05", "--normals", "m.npy"),
            "of row 7 (from 0) is not the given one (1 of 12 springs differ): give --springs KIND",
        ),
        (
            "planes",
            ("--max-residual", "0.05"),
            "REFUSED: the certificate has a spring for each pair, none is given: give --springs K",
        ),
        ("planes", PLANES, NO_BOUND),
        ("turns", ("--max-residual", "0.05", *TURNS), "VERIFIED"),
        ("turns", ("--max-residual", "0.06", *TURNS), OTHER_BOUND),
        (
            "turns",
            ("--max-residual", "0.05"),
            f"{TURNED} 0.05, given is --max-residual 0.05: give --r",
        ),
        ("turns", TURNS[:1], f"{TURNED} 0.05, given is --rotation-only: give --objective truncat"),
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


def test_of_other_points_nothing_else_is_told(folder: Path):
    path, bound = folder / "points" / "certificate.json", ("--max-residual", "0.05")
    found = run("verify", path, folder / "y.csv", folder / "x.csv", *bound)
    assert found.out == "REFUSED: the certificate is about other points\n"
    few = (folder / "x.csv").read_text("utf-8").splitlines()[:11]
    (folder / "few.csv").write_text("\n".join(few), "utf-8")
    found = run("verify", path, folder / "few.csv", folder / "few.csv", *bound)
    assert found.out == "REFUSED: the certificate is about 12 pairs, given are 11\n"


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
    assert OTHER_BOUND.strip() in refused.err


def test_of_clouds_without_numbers_of_pairs_the_checker_tells_alone(folder: Path):
    doubles = (array("d", cloud.ravel().tolist()) for cloud in (X, Y))
    bare = Clouds(*doubles, model="--max-residual")
    told = certreg.verify(folder / "points" / "certificate.json", bare).words
    assert told.startswith("the certified bounds or weights are others, or not given")


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
