"""Registration with wrong pairs: what is found, what is proved, and how it is said."""

from __future__ import annotations

import itertools
import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import certreg
from certreg.certificate.envelope import Certificate
from certreg.errors import InvalidFileError, InvalidProblemError, UndecidedError
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.registration.consensus import LABELS
from certreg.registration.labelled import ConsensusRegistration
from certreg.registration.pair_warnings import few_warning
from certreg.report.pair_page import PairsReport

BOUND = 0.05


def wrong_pairs(seed, n=20, wrong=6, *, noise=0.005):
    """Clouds of which the last pairs are wrong, and how many are right."""
    rng = np.random.default_rng(seed)
    source = rng.uniform(size=(n, 3))
    turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    target = source @ turn.T + rng.uniform(-1, 1, 3) + rng.uniform(-noise, noise, (n, 3))
    target[n - wrong :] = target.mean(axis=0) + rng.uniform(-0.8, 0.8, (wrong, 3))
    return source, target


def certified(source, target, bound: Any = BOUND, **options) -> ConsensusRegistration:
    result = certreg.certify(source, target, max_residual=bound, **options)
    assert isinstance(result, ConsensusRegistration)
    return result


def relabelled(result: ConsensusRegistration, found: Any) -> ConsensusRegistration:
    """As if that were proved."""
    inliers, labels = np.array(found.met), tuple(LABELS[letter] for letter in found.labels)
    return replace(result, found=found, inliers=inliers, labels=labels)


def twins(seed=0, n=12):
    """Two motions that meet half of the pairs each."""
    rng = np.random.default_rng(seed)
    source = rng.uniform(size=(n, 3))
    turn = Rotation.from_rotvec([0.3, -1.2, 0.4]).as_matrix()
    target = source.copy()
    target[n // 2 :] = source[n // 2 :] @ turn.T + [0.5, -0.3, 0.2]
    return source, target


def test_every_label_is_proved_and_said():
    source, target = wrong_pairs(1)
    result = certified(source, target)
    assert result.headline == (
        "CERTIFIED: no rigid motion brings more than 14 of the 20 pairs within 0.05, and only "
        "these 14. The other 6 are outliers in EVERY such motion."
    )
    assert result.labels == ("inlier",) * 14 + ("outlier",) * 6
    assert (result.lower, result.upper, result.labels_unique, result.exit_code) == (14, 14, True, 0)
    assert result.verdict.proved
    assert (result.residuals[:14] <= BOUND).all()
    assert result.inliers.tolist() == list(range(14))
    assert repr(result) == (
        "<ConsensusRegistration: 14 of 20 pairs within their bounds; labels proved>"
    )
    text = str(result)
    assert text.startswith(result.headline)
    assert "  within bounds     14 found, at most 14 (proved)\n" in text
    assert "  labels            14 inliers, 6 outliers, 0 undecided\n" in text
    assert "  least squares     of these 14: CERTIFIED" in text
    assert " degrees from this rotation to that of any motion that brings these 14 within" in text
    assert "  proved angle      at most " in text
    assert "  largest residual  0.0" in text


def test_one_wrong_pair_is_said_in_the_singular():
    source, target = wrong_pairs(2, n=8, wrong=1)
    assert certified(source, target).headline == (
        "CERTIFIED: no rigid motion brings more than 7 of the 8 pairs within 0.05, and only these "
        "7. The other pair is an outlier in EVERY such motion."
    )


def test_no_outliers():
    source, target = wrong_pairs(3, n=6, wrong=0)
    bounds = np.full(6, BOUND)
    bounds[2] = 0.04
    result = certified(source, target, bounds)
    assert result.headline == (
        "CERTIFIED: one rigid motion brings all 6 pairs within their bounds: no outliers."
    )
    assert result.exit_code == 0
    assert result.second is None


def test_two_motions_are_not_one():
    source, target = twins()
    result = certified(source, target, 1e-3)
    assert not result.labels_unique
    assert result.lower == 6
    assert result.second == 6
    assert result.exit_code == (3 if result.upper == 6 else 4)
    assert "another motion    fits 6 of the other pairs (found, not proved)" in str(result)
    assert (
        "give more --effort to search and to prove harder, or smaller bounds if those are true."
    ) in str(result)
    if result.upper == 6:
        assert result.headline.startswith(
            "MAXIMUM PROVED, LABELS NOT: no rigid motion brings more than 6 of the 12 pairs within "
            "0.001; which 6 is not proved. 0 pairs are outliers in every motion that brings 6; 12 "
            "undecided (rows 0, 1, 2, 3, 4 and 7 others, counting from 0)."
        )


def test_mirrored_pairs_are_outliers():
    source, target = wrong_pairs(5, n=14, wrong=0)
    mirrored = source * [1.0, 1.0, -1.0]
    target = target.copy()
    shift = target.mean(axis=0) - mirrored.mean(axis=0)
    target[9:] = (mirrored + shift)[9:]
    result = certified(source, target)
    assert result.labels_unique
    assert set(result.labels[9:]) == {"outlier"}


def test_partial_proofs_are_said_as_such():
    result = certified(*wrong_pairs(1))
    found, problem = result.found, result.problem
    partly = replace(found, labels="i" * 2 + "?" * 12 + "o" * 6, upper=16)
    assert _headline(problem, partly) == (
        "PARTLY PROVED: 14 of 20 pairs found within 0.05; proved: not more than 16. 6 pairs are "
        "outliers, 2 pairs inliers in every motion that reaches 14; 12 undecided (rows 2, 3, 4, 5, "
        "6 and 7 others, counting from 0)."
    )
    one = replace(found, labels="i" + "?" * 18 + "o", upper=14)
    assert _headline(problem, one) == (
        "MAXIMUM PROVED, LABELS NOT: no rigid motion brings more than 14 of the 20 pairs within "
        "0.05; which 14 is not proved. 1 pair is an outlier, one pair an inlier in every motion "
        "that brings 14; 18 undecided (rows 1, 2, 3, 4, 5 and 13 others, counting from 0)."
    )
    none = replace(found, labels="?" * 20, upper=20)
    share = (
        100
        * BOUND
        / min(np.linalg.norm(np.ptp(points, axis=0)) for points in (problem.source, problem.target))
    )
    assert _headline(problem, none) == (
        f"NOT PROVED: 14 of 20 pairs found within 0.05; proved: not more than 20. The bound is "
        f"{share:.2g} % of the cloud's size: so many pairs agree by chance that none is proved an "
        "outlier."
    )
    codes = [relabelled(result, each).exit_code for each in (found, one, partly, none)]
    assert codes == [0, 3, 4, 4]
    for each in (found, one, partly, none):
        told = f"  within bounds     14 found, at most {each.upper} (proved)\n"
        assert told in str(relabelled(result, each))


def _headline(problem, found):
    from certreg.registration.pair_words import headline
    from certreg.registration.row_names import RowNames

    return headline(problem, found, RowNames(None), None)


def test_few_pairs_are_said_to_agree_by_chance_perhaps():
    rng = np.random.default_rng(1)
    wrong = certified(rng.uniform(size=(40, 3)), rng.uniform(size=(40, 3)), 0.06)
    words = "so few pairs, 4 of 40, may agree by chance, even where all pairs are wrong"
    assert wrong.headline.startswith(
        "CERTIFIED, BUT SO FEW PAIRS MAY AGREE BY CHANCE: no rigid motion brings more than 4 of "
    )
    assert [one.text for one in wrong.pair_warnings] == [words]
    assert f"\n  warning           {words}" in str(wrong)
    assert wrong.to_dict()["consensus"]["warnings"] == [words]
    assert f"Warning: {words}" in wrong._repr_html_()
    assert f"{words[1:]}." in PairsReport.of(wrong).html().decode()


@pytest.mark.parametrize(
    ("met", "n", "few"),
    [
        *[(3, 3, True), (3, 20, True), (4, 4, False), (4, 39, False), (4, 40, True)],
        *[(5, 49, False), (5, 50, True), (6, 60, True), (7, 70, False), (7, 1000, False)],
    ],
)
def test_few_pairs_are_three_or_a_tenth_of_all_up_to_six(met, n, few):
    assert (few_warning(met, n) is not None) is few


def test_a_least_squares_pose_that_breaks_its_own_consensus_is_told():
    # Two pairs are off by the bound to one side, so the mean of the others lies outside of it.
    source = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
    target = source + np.array([0.0, 0.0, 0.099])
    target[0, 2] = -0.099
    result = certified(source, target, 0.1)
    assert result.lower == 8
    assert result.broken
    text = str(result)
    assert (
        "of row 0, counting from 0: beyond the bound at the least-squares pose, though one" in text
    )
    assert "motion brings all 8 within, the witness:" in text
    moved = source @ result.witness.rotation.T + result.witness.translation
    assert (np.linalg.norm(target - moved, axis=1) <= 0.1 + 1e-12).all()


def test_the_document_and_the_files(tmp_path):
    result = certified(*wrong_pairs(1))
    path = result.save(tmp_path / "out")
    assert path is not None
    document = json.loads((tmp_path / "out" / "result.json").read_text("utf-8"))
    assert document["consensus"] == {
        "lower": 14,
        "upper": 14,
        "labels_unique": True,
        "labels": list(result.labels),
        "second": None if result.second is None else {"size": result.second},
        "headline": result.headline,
        "warnings": [],
    }
    assert document["n"] == 20
    assert document["digest"] == result.problem.digest()
    table = (tmp_path / "out" / "fit.csv").read_text("utf-8").splitlines()
    assert table[0] == "row,label,residual,bound,proved"
    assert [line.rsplit(",", 1)[1] for line in table[1:]] == list(result.labels)
    assert certreg.verify(path).proved
    kept = Certificate.load(path)
    assert kept == result.certificate
    assert kept.body.to_fields() == result.certificate.body.to_fields()
    (tmp_path / "file").write_text("", "utf-8")
    with pytest.raises(InvalidFileError, match="cannot be made a folder"):
        result.save(tmp_path / "file")


def test_no_document_says_that_nothing_was_written():
    document = certified(*wrong_pairs(2, n=8, wrong=1)).to_dict()
    assert document["certificate"] is None
    assert document["reasons"]["certificate"] == "nothing is written without --out"
    assert "consensus" not in document["reasons"]
    assert document["reasons"]["consensus.second"] == (
        "no other motion was found that meets three of the other pairs"
    )


def test_offsets_and_sizes_do_not_change_what_is_proved():
    source, target = wrong_pairs(4, n=12, wrong=4)
    labels = certified(source, target).labels
    assert certified(source + 1e8, target - 1e8).labels == labels
    for size in (1e-6, 1e6):
        assert certified(size * source, size * target, size * BOUND).labels == labels


def test_rows_may_come_twice():
    source, target = wrong_pairs(1)
    other = np.vstack([target, target[:3] + 0.4])
    labels = certified(np.vstack([source, source[:3]]), other).labels
    assert labels[20:] == ("outlier",) * 3


def test_nothing_that_fits_is_undecided():
    rng = np.random.default_rng(0)
    with pytest.raises(
        UndecidedError,
        match="no rigid motion brings 3 pairs within their bounds: no three of them keep their ",
    ):
        certified(rng.uniform(size=(4, 3)), 9 * rng.uniform(size=(4, 3)), 1e-6)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"n": 2}, "max_residual needs 3 to 4096 pairs, there are 2"),
        ({"bound": 5.0}, "not below half the diameter of the smaller cloud"),
        ({"bound": 0.0}, "max_residual is 0"),
        (
            {"rotation_only": True},
            "inliers are counted for motions with a translation: leave out --rotation-only",
        ),
        ({"effort": 0}, "effort is 0: give a number above 0"),
        ({"effort": "much"}, "effort is 'much': give a number above 0"),
    ],
)
def test_what_is_refused_is_refused_in_one_line(change, words):
    source, target = wrong_pairs(1)
    n, bound = change.pop("n", 20), change.pop("bound", BOUND)
    with pytest.raises(InvalidProblemError, match=words):
        certified(source[:n], target[:n], bound, **change)


def test_pairs_without_weight_have_no_least_squares():
    source, target = wrong_pairs(1)
    weights = np.repeat([0.0, 1.0], [14, 6])
    words = (
        "of the pairs that were met (rows 0, 1, 2 and 11 others) all weights are zero: no "
        "correspondence counts, so every pose is as good; give one of them more than 0"
    )
    with pytest.raises(InvalidProblemError, match=re.escape(words)):
        certified(source, target, weights=weights)


def test_weights_are_of_the_fit_alone():
    source, target = wrong_pairs(1)
    weights = np.linspace(1.0, 2.0, 20)
    result = certified(source, target, weights=weights)
    alone = certreg.register(source[:14], target[:14], weights=weights[:14])
    assert np.allclose(result.pose.rotation, alone.rotation, atol=1e-12)
    assert result.labels_unique


def test_a_problem_knows_its_bounds():
    source, target = wrong_pairs(1)
    problem = bounded(RegistrationProblem(source, target), BOUND)
    assert problem.n == 20
    assert problem.of_rows([0, 5]).n == 2
    assert len(problem.data_bytes()) == len(b"certreg-consensus/1\0") + 8 + 64 * 20
