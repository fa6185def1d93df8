"""Registration by truncated squares: what is found, what is proved, and how it is said."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg as run
from commands import write_csv
from rotated_pairs import BOUND, rotated_pairs

import certreg
from certreg.errors import InvalidProblemError, UndecidedError
from certreg.registration.labelled import TruncatedRegistration
from certreg.results import Limits

if TYPE_CHECKING:
    from pathlib import Path


TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
LIMIT, TINY = 0.1, Fraction(1, 1 << 200)
MODEL: dict[str, Any] = {"rotation_only": True, "objective": "truncated"}


def certified(source, target, bound: Any = BOUND, **options) -> TruncatedRegistration:
    result = certreg.certify(source, target, max_residual=bound, **MODEL, **options)
    assert isinstance(result, TruncatedRegistration)
    return result


@pytest.fixture(scope="module")
def given():
    return rotated_pairs(np.random.default_rng(3), 12, 0.5)


@pytest.fixture(scope="module")
def result(given) -> TruncatedRegistration:
    return certified(given.source, given.target)


@pytest.mark.slow
def test_labels_and_rotation_are_proved_and_said(result: TruncatedRegistration, given):
    words = np.where(given.true, "inlier", "outlier")

    assert result.labels == tuple(words.tolist())
    assert result.headline == (
        "CERTIFIED: no rotation has a smaller truncated cost than 6.75231, and 6 of the 12 pairs "
        "are within their bounds there. The other 6 are outliers at EVERY optimum."
    )
    assert (result.exit_code, result.unique, result.labels_unique) == (0, True, True)
    assert repr(result) == "<TruncatedRegistration: cost 6.75231; 6 of 12 inliers>"
    assert ((result.residuals <= BOUND) == given.true).all()
    squares = np.minimum((result.residuals / BOUND) ** 2, 1.0)
    assert result.cost == pytest.approx(squares.sum(), rel=1e-12)
    assert result.gap is not None
    assert 0.0 < result.gap < 1e-8
    assert "6 inliers, 6 outliers, 0 undecided" in str(result)
    assert "truncated cost    6.75231045" in str(result)
    assert f"{gap_told(str(result)):.1e} (proved)" in result._repr_html_()


@pytest.mark.slow
@pytest.mark.parametrize("n", [4, 5, 8])
def test_a_gap_that_is_told_is_no_less_than_the_one_that_is_proved(n: int):
    pairs = rotated_pairs(np.random.default_rng(n), n, 0.0)
    result = certified(pairs.source, pairs.target)
    partly = replace(result, labels=("undecided",) * n)

    assert result.gap is not None
    for text in (str(result), partly.headline):
        assert result.gap <= gap_told(text) < 1.1 * result.gap


def gap_told(text: str) -> float:
    return float(re.findall(r"less than (\S+) ", text)[0])


@pytest.mark.slow
def test_one_pair_is_said_to_be_one(result: TruncatedRegistration):
    labels = ("outlier", "inlier", *["undecided"] * 10)
    few = replace(result, labels=labels)
    only = replace(result, labels=("outlier", *["inlier"] * 11))

    assert " 1 of the 12 pairs is within its bound at every optimum, 1 at none; 10 " in few.headline
    assert only.headline.endswith(
        "11 of the 12 pairs are within their bounds there. The other pair is an outlier at EVERY "
        "optimum."
    )
    assert "  labels            1 inlier, 1 outlier, 10 undecided\n" in str(few)


@pytest.mark.slow
def test_no_outliers_are_said(given):
    source = given.source
    result = certified(source, source @ TURN.T)

    assert result.headline.endswith("and all 12 pairs are within their bounds there: no outliers.")


@pytest.mark.long
@pytest.mark.slow
def test_a_circle_of_optima_is_certified_but_not_unique():
    line = np.outer([1.0, 2.0, -3.0], [0.0, 0.0, 1.0])
    result = certified(line, line)

    assert result.exit_code == 3
    assert result.headline == (
        "CERTIFIED, NOT UNIQUE: no rotation has a smaller truncated cost than 0; one single "
        "rotation is not proved. All 3 pairs are within their bounds at every optimum: no outliers."
    )


@pytest.mark.slow
def test_two_optima_leave_labels_undecided():
    x = np.eye(3)
    result = certified(np.vstack([x, x]), np.vstack([x @ TURN.T, x @ TURN]), 0.25)

    assert result.exit_code == 4
    assert result.headline.startswith("PARTLY PROVED: the truncated cost is at most 2.00001, ")
    assert result.headline.endswith(
        " above the least. 2 of the 6 pairs are within their bounds at every optimum, 0 at none; "
        "4 undecided (rows 0, 1, 3, 4, counting from 0)."
    )
    assert (
        "give more --effort to search further, or other bounds if pairs are near to theirs"
        in str(result)
    )


@pytest.mark.slow
def test_what_the_checker_does_not_accept_is_not_proved(result: TruncatedRegistration):
    refused = replace(result, certificate=None, labels=("undecided",) * 12)

    assert refused.headline == "NOT PROVED: a rotation of truncated cost 6.75231 was found."
    assert refused.exit_code == 4
    assert "no bound is proved" in str(refused)
    reasons = refused.to_dict()["reasons"]
    assert reasons["truncated.gap"] == reasons["certificate"] == result.verdict.words


@pytest.mark.slow
def test_a_limit_that_is_not_proved_is_not_called_certified(given):
    result = certified(given.source, given.target, max_angle=1e-12)

    assert result.exit_code == 4
    assert result.headline.endswith("at every optimum, 6 at none; 0 undecided.")
    every = certified(given.source, given.source @ TURN.T, max_angle=1e-12)
    assert " above the least. All 12 pairs are within their bounds at every " in every.headline


@pytest.mark.slow
@pytest.mark.parametrize(
    ("share", "angle", "unique", "certified"),
    [
        (Fraction(LIMIT), Fraction(LIMIT), True, True),
        (Fraction(1, 10), Fraction(1, 10), True, True),  # the double 0.1 is more
        (Fraction(LIMIT) + TINY, Fraction(0), True, False),
        (Fraction(0), Fraction(LIMIT) + TINY, True, False),
        (Fraction(0), None, True, False),
        (Fraction(LIMIT), None, False, True),
        (Fraction(LIMIT) + TINY, None, False, False),
    ],
)
def test_a_gap_and_an_angle_up_to_the_limits_are_certified_and_none_beyond(
    result: TruncatedRegistration, share, angle, unique, certified
):
    """Of optima that are not unique no angle is asked for."""
    worth, certificate = result.verdict.worth, result.certificate
    assert worth is not None
    assert certificate is not None
    claims = replace(certificate.body.claims, unique=unique)
    told = replace(
        result,
        certificate=replace(certificate, body=replace(certificate.body, claims=claims)),
        verdict=replace(result.verdict, weigh=lambda: replace(worth, share=share, angle=angle)),
        fit=replace(result.fit, limits=Limits(max_gap=LIMIT, max_angle=LIMIT)),
    )

    assert told.certified is certified
    assert told.exit_code == ((0 if unique else 3) if certified else 4)
    assert told.headline.startswith("CERTIFIED") is certified
    assert not replace(told, labels=("undecided", *told.labels[1:])).certified


def test_no_pair_within_is_undecided():
    x = np.eye(3)

    with pytest.raises(
        UndecidedError,
        match="no rotation brings a pair within its bound: the two points of each are at ",
    ):
        certified(x, 3.0 * x, 0.01)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            {"max_residual": None},
            "objective is 'truncated': it goes with max_residual, give that, too",
        ),
        ({"objective": "least"}, "objective is 'least': give 'consensus' or 'truncated'"),
        ({"rotation_only": False}, "truncated squares go without a translation for now: leave"),
    ],
)
def test_what_is_no_such_problem_is_refused_in_one_line(options, words: str):
    stated: dict[str, Any] = MODEL | {"max_residual": 0.1} | options

    with pytest.raises(InvalidProblemError, match=words):
        certreg.certify(np.eye(3), np.eye(3), **stated)


@pytest.mark.slow
def test_the_command_writes_what_it_proves(given, tmp_path: Path):
    source = write_csv(tmp_path / "a.csv", given.source)
    target = write_csv(tmp_path / "b.csv", given.target)
    options = ("--max-residual", str(BOUND), "--objective", "truncated")

    told = run("certify", source, target, *options, "--rotation-only", "--out", tmp_path / "out")
    verified = run("verify", tmp_path / "out" / "certificate.json")
    refused = run("certify", source, target, *options)
    table = (tmp_path / "out" / "fit.csv").read_text("utf-8").splitlines()

    assert (told.code, verified.code, refused.code) == (0, 0, 2)
    assert told.out.startswith("CERTIFIED: no rotation has a smaller truncated cost")
    assert verified.out.rstrip().endswith("VERIFIED")
    assert "give --rotation-only" in refused.err
    assert table[0] == "row,label,residual,bound,proved"
    assert len(table) == 13


@pytest.mark.long
def test_a_bound_that_holds_by_chance_is_warned_of(given):
    wide = certified(given.source, given.target, 1.7)
    narrow = certified(given.source, given.target)
    words = "of the cloud's size: so many pairs agree by chance that an inlier may well be a wrong"

    assert words in str(wide)
    assert (
        "warning           of the target's spread the fit explains 19.5 %: wrong pairs may be "
        in str(wide)
    )
    assert [one.code.value for one in wide.warnings] == ["wide-bound", "poor-fit"]
    poor = wide.warnings[1]
    assert poor.text.endswith("19.5 %: wrong pairs may be among those within, or noise is large")
    assert poor.remedy == "check the pairs within, or give a smaller bound if right pairs keep it"
    assert not narrow.warnings
    assert f"least squares     of these {len(wide.inliers)}: " in str(wide)
    assert words not in str(narrow)
    assert "\n  rotation +/-      " in str(narrow)
    assert " (of these 6; explained " in str(narrow)
    assert "\n  least squares     of these 6: CERTIFIED: the global optimum, and unique" in str(
        narrow
    )
    assert "\n  robustness        of the least squares: every optimum stays" in str(narrow)


@pytest.mark.parametrize(("gap", "worth"), [(0.5, None), (None, SimpleNamespace()), (None, None)])
def test_without_a_gap_or_without_a_cost_nothing_is_called_proved(gap: Any, worth: Any):
    fields = {"gap": gap, "verdict": SimpleNamespace(worth=worth), "cost": 6.75}
    found = SimpleNamespace(labels=(), certified=True, **fields)

    assert vars(TruncatedRegistration)["headline"].fget(found) == (
        "NOT PROVED: a rotation of truncated cost 6.75 was found."
    )
