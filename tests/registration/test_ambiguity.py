"""A small margin is an alarm where the noise may turn the answer over, and a note where not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from strategies import random_rotation

from certreg.problem.problem import RegistrationProblem
from certreg.registration import headlines as listed
from certreg.registration.ambiguity import NEARLY_AMBIGUOUS, PAIRS_IN_DOUBT
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.enumeration import equilibria
from certreg.registration.headlines import headline_of
from certreg.registration.outlying import independent_rows
from certreg.report.lines import warnings
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.summary import registration_summary

TURN = random_rotation(np.random.default_rng(3))


def strip(noise, *, n=60, seed=0, **options):
    """A scan 100 long and 1 wide, and what is seen of it."""
    rng = np.random.default_rng([n, seed])
    source = np.column_stack([np.linspace(0, 100, n), rng.uniform(-0.5, 0.5, (2, n)).T])
    target = source @ TURN.T + noise * rng.standard_normal((n, 3))
    return RegistrationProblem(source, target, **options)


def proof(problem):
    return certify(problem, relaxation=False, simulation=False)


@pytest.mark.parametrize("options", [{}, {"sigma": 0.002}])
def test_a_strip_that_is_wider_than_its_noise_is_certified_with_a_note(options):
    registration = proof(strip(0.002, **options))
    note = "the margin is small: the next equilibrium, 180 degrees away, costs only 0.0"

    assert headline_of(registration) is listed.CERTIFIED
    assert [words for words in warnings(registration, "") if words.startswith(note)]
    assert NEARLY_AMBIGUOUS not in registration_summary(registration)
    assert "turn the answer over" not in registration_summary(registration).split("warning")[0]
    assert "The margin is small: " in str(registration.equilibria)
    judged = assess(registration.problem, registration.pose.rotation, registration.pose.translation)
    assert "The margin is small: " in judged.words
    assert NEARLY_AMBIGUOUS not in judged.words


def test_a_fit_better_than_sigma_says_makes_no_smaller_noise_of_it():
    """The residuals alone would rule the other pose out; sigma, 400 times them, does not."""
    assert proof(strip(0.005)).equilibria.next_ruled_out
    assert not proof(strip(0.005, sigma=2.0)).equilibria.next_ruled_out


@pytest.mark.parametrize("options", [{}, {"sigma": 1.0}])
def test_a_strip_that_is_narrower_than_its_noise_is_nearly_ambiguous(options):
    registration = proof(strip(1.0, **options))

    assert headline_of(registration) is listed.NEARLY_AMBIGUOUS
    assert NEARLY_AMBIGUOUS in registration_summary(registration)
    assert NEARLY_AMBIGUOUS in str(registration.equilibria)
    assert not any("margin is small" in words for words in warnings(registration, ""))


@pytest.mark.parametrize("options", [{}, {"sigma": 0.002}])
def test_what_the_noise_rules_out_wrong_pairs_may_have_turned_over(options):
    clean = strip(0.002, **options)
    target = clean.target.copy()
    target[7] += 0.1
    problem = RegistrationProblem(clean.source, target, **options)
    registration = proof(problem)
    summary = registration_summary(registration)
    judged = assess(registration, registration.pose)

    assert "outlier-rows" in [code.value for code in registration.fit.codes]
    assert headline_of(registration) is listed.NEARLY_AMBIGUOUS
    assert PAIRS_IN_DOUBT in summary
    assert "unique, but the poor fit may have turned the answer over" in summary
    assert PAIRS_IN_DOUBT in str(equilibria(problem))
    assert PAIRS_IN_DOUBT in judged.words
    assert judged.headline.endswith("; the poor fit may have turned the answer over.")
    for told in (summary, judged.words):
        assert "margin is small" not in told
        assert NEARLY_AMBIGUOUS not in told
    assert "rule the other pose out" not in summary
    assert f">{PAIRS_IN_DOUBT}<" in html_page(Report.of(registration)).decode()


def test_a_sigma_somewhat_too_small_casts_no_doubt_on_the_pairs():
    found = proof(strip(0.002, sigma=0.001))

    assert [code.value for code in found.fit.codes] == ["chi2"]
    assert found.equilibria.next_ruled_out
    assert not found.equilibria.pairs_in_doubt


def test_a_sigma_that_is_too_small_rules_nothing_out():
    assert equilibria(strip(1.0, sigma=1e-6)).nearly_ambiguous


def test_what_differs_at_rounding_is_not_ruled_out():
    rod = np.linspace(0, 1, 20)[:, np.newaxis] * [1.0, 0.0, 0.0]
    rod[:, 1] = 1e-13 * (-1.0) ** np.arange(20)
    exact = equilibria(RegistrationProblem(rod, rod))

    assert exact.components[0].energy == 0.0
    assert exact.nearly_ambiguous
    rod[:, 1] *= 1e3
    assert not equilibria(RegistrationProblem(rod, rod)).nearly_ambiguous


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("given", [False, True])
@pytest.mark.parametrize("n", [4, 30])
def test_what_the_noise_rules_out_is_not_the_truth(n, given):
    """Over noises from far below the width to far above it."""
    rng, clear, turned = np.random.default_rng(5), 0, 0
    for seed in range(40):
        noise = 10.0 ** rng.uniform(-5.0, 1.0)
        found = equilibria(strip(noise, n=n, seed=seed, sigma=noise if given else None))
        off = math.degrees(math.acos((np.trace(found.components[0].rotation @ TURN.T) - 1) / 2))
        clear += found.next_ruled_out
        turned += off > 90.0
        assert off < 90.0 or not found.next_ruled_out
    assert min(clear, turned) > 0


def test_weights_count_as_so_many_rows():
    weights = np.array([1.0] * 3 + [1e-3] * 27 + [0.0])
    cloud = np.random.default_rng(1).standard_normal((31, 3))

    def rows(**options):
        return independent_rows(RegistrationProblem(cloud, cloud, **options))

    assert rows(weights=weights) == pytest.approx(weights.sum() ** 2 / (weights @ weights))
    assert rows(weights=1e-300 * weights) == pytest.approx(rows(weights=weights))
    assert rows() == 31.0
    assert rows(sigma=np.linspace(1.0, 9.0, 31)) == 31.0
