"""Sentences on general springs that few data bring about, each from data that do."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from exact_springs import two_optima

from certreg.equilibrium.paths import critical_lines
from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.covariance import OF_SPRINGS, covariance_at
from certreg.registration.freedom import Freedom
from certreg.report.pages import html_page, report_on
from certreg.results import Absent, Limits, PoseVerdict


@cache
def tied() -> Any:
    return certify(two_optima())


@cache
def seven_planes() -> Any:
    """With several local minima, and one optimum that is told from them."""
    rng = np.random.default_rng(5)
    x, normals = rng.normal(size=(2, 7, 3))
    return certify(RegistrationProblem(x, x + 0.3 * rng.normal(size=x.shape), normals=normals))


def page_of(registration: Any) -> str:
    return " ".join(html_page(report_on(registration)).decode().split())


@pytest.mark.slow
def test_of_two_optima_the_tie_is_told():
    found = tied()
    span = replace(found.bounds, greatest_gap=found.bounds.greatest_gap + 1)
    loose = replace(found, bounds=span, limits=Limits(max_gap=0.999))

    assert "and others are as good: another pose is exactly as good." in str(found)
    assert "), and others are as good: another pose is exactly as good." in str(loose)
    page = page_of(found)
    assert "Two rotations at least are optimal, exactly as good as one another." in page
    given = (
        "that the springs are right: normals, directions and covariances are taken as they are "
        "given, and so are those that an iterative method froze at the rotation of its last step;"
    )
    assert given in page
    theorems = (
        "What a translation costs with matrices of springs",
        "Cones and Bernstein coefficients",
        "Caps: curvature at a centre",
        "The growth form",
    )
    assert all(title in page for title in theorems)


def test_a_pose_at_rest_that_is_not_the_optimum_is_told_with_its_index():
    found = seven_planes()
    objective = found.solution.objective
    lines = critical_lines(objective.floating_quartic()[0])
    told = set[str]()
    for q in lines.quaternions:
        judged = assess(found, q)
        if judged.verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM:
            told.add(judged.headline.split(" from ")[1])
            stable = "a stable equilibrium" in judged.headline
            assert ("and every small turn raises the energy" in judged.words) == stable

    assert "an index-1 equilibrium." in told
    assert "a stable equilibrium, at which a local method stops, and not the optimum." in told


def test_a_pose_that_is_nowhere_near_an_equilibrium_says_so():
    judged = assess(seven_planes(), np.eye(3)[[1, 2, 0]])

    reason = "no equilibrium was met at the pose, and those of general springs are not listed"
    assert judged.stated("nearest_index") == Absent(reason)


def test_a_symmetry_of_both_sides_is_told():
    both = Freedom(translations=(), symmetry=((0, 0, 2, 0, 0, -1),))

    words = "a turn of the source together with one of the target changes nothing"
    assert both.turn_words() == words


def test_as_many_springs_as_unknowns_leave_nothing_for_the_noise():
    rng = np.random.default_rng(2)
    x, normals = rng.normal(size=(2, 6, 3))
    problem, near = RegistrationProblem(x, x, normals=normals), seven_planes().solution.near
    terms: Any = {"least": Fraction(1), "carried": lambda: True, "conditions": OF_SPRINGS}
    absent = covariance_at(problem, near, (Fraction(0),) * 3, **terms)

    words = "the springs leave no degree of freedom for the noise: give sigma, or covariances"
    assert absent == Absent(words)


@pytest.mark.slow
def test_an_angle_without_uniqueness_is_told_as_what_it_is():
    """A certificate that claims less: an angle to every optimum, and not that there is one."""
    found = seven_planes()
    certificate = found.certificate
    claims = replace(certificate.body.claims, unique=None)
    weak = replace(certificate, body=replace(certificate.body, claims=claims))
    open_ = replace(found, solution=replace(found.solution, certificate=weak))

    assert " degrees of every optimum; whether there are several is not decided." in str(open_)
    page = page_of(open_)
    assert "Every optimal rotation is within " in page
    assert "A quartic, and its sums of squares" in page
