"""Sentences of a page and a summary that a hostile reader found stronger than what is proved."""

from __future__ import annotations

import html
import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from strategies import ZOO

from certreg import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.enumeration import equilibria
from certreg.report.equilibria import count_words
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.scene_words import component_words
from certreg.report.summary import registration_summary
from certreg.results import Limits

if TYPE_CHECKING:
    from certreg.registration.result import Registration


RNG = np.random.default_rng(5)
SOURCE = RNG.normal(size=(12, 3))
TARGET = SOURCE + 0.1 * RNG.normal(size=(12, 3))
TETRAHEDRON = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])


def proof(source, target, *, relaxation: bool = False, **options) -> Registration:
    problem = RegistrationProblem(np.array(source), np.array(target), **options)
    return certify(problem, relaxation=relaxation, simulation=False)


def page(registration: Registration) -> str:
    words = re.sub(r"<[^>]*>", " ", html_page(Report.of(registration)).decode())
    return html.unescape(re.sub(r"\s+", " ", words))


@pytest.fixture(scope="module")
def usual() -> str:
    return page(proof(SOURCE, TARGET))


def test_not_every_push_ends_an_unstable_pose(usual: str):
    """What is pushed along a stable direction comes back: audit, "immediately leaves"."""
    assert "smallest push" not in usual
    assert "there are pushes, however small, after which a body leaves it" in usual


def test_nothing_is_claimed_of_other_poses_beyond_the_bounds(usual: str):
    assert "no pose fits these numbers better" not in usual
    assert "the bounds hold for this one, with the translation of the matrix" in usual


@pytest.mark.slow
def test_a_pose_that_is_only_bounded_is_not_the_best_motion(usual: str):
    bounded = replace(proof(SOURCE, TARGET), limits=Limits(max_gap=0.0))

    assert "The best motion turns" in usual
    assert "The best motion" not in page(bounded)
    assert "The pose below turns" in page(bounded)


def test_an_rmse_is_not_said_to_be_another_where_no_digit_differs():
    words = page(proof(1e-100 * SOURCE, TARGET))
    (fit,) = re.findall(r"It is not the best, (.*?), and unstable", words)

    assert re.fullmatch(r"though its RMSE is [\d.]+, as the optimum's is, in these digits", fit)


def test_where_every_rotation_fits_a_translation_still_may_not():
    registration = proof(np.ones((5, 3)), TARGET[:5])

    assert "every rotation is an equilibrium" in str(registration.equilibria)
    assert " Every rotation is an equilibrium, and every one is optimal: every" in page(
        registration
    )


def test_of_many_optima_no_method_leads_to_the_one():
    registration = proof(TETRAHEDRON, -TETRAHEDRON, relaxation=True)  # all turn by 180 degrees
    summary, words = registration_summary(registration), page(registration)

    assert "is one of them that turns the source least" in summary
    assert "degrees from the nearest optimum" in summary
    assert "the same rotation" not in words
    assert "Independent roads lead to an optimum, not always the same: " in words


def test_the_pose_of_many_optima_turns_the_least_but_for_what_is_said():
    """Of the turns of a line onto one nearly opposite the least is half a turn less 2e-5."""
    off = 2e-5
    line = np.outer([-1.0, 1.0, 0.5], [1.0, 0.0, 0.0])
    registration = proof(line, np.outer(line[:, 0], [-math.cos(off), math.sin(off), 0.0]))
    told = registration_summary(registration)
    found = math.degrees(2 * math.acos(abs(registration.pose.quaternion_wxyz[0])))
    least = 180 - math.degrees(off)

    assert "one of them that turns the source least, to within 0.002 degrees." in told
    assert 1e-3 < found - least < 2e-3


def test_a_noise_that_hides_the_next_equilibrium_does_not_make_it_as_likely():
    octahedron = np.vstack([np.diag([2.0, 1, 1]), -np.diag([2.0, 1, 1])])
    registration = proof(octahedron, octahedron * [1, 1, -0.5], sigma=0.5)
    summary = registration_summary(registration)

    assert "as likely as" not in summary
    assert "five standard deviations of the sigma given rule out no turn" in summary


def test_an_assessment_says_what_is_nearly_ambiguous():
    octahedron = np.vstack([np.diag([2.0, 1, 1]), -np.diag([2.0, 1, 1])])
    problem = RegistrationProblem(octahedron, octahedron * [1, 1, -(1 - 1e-9)])

    judged = assess(problem, np.eye(3), np.zeros(3))
    assert judged.headline.startswith("OPTIMAL TO ROUNDING")
    assert judged.words.endswith(
        "A very different pose costs little more beside the range of energies: do not rely on "
        "the rotation."
    )


def test_a_mirror_image_is_not_said_to_be_paired_at_random():
    summary = registration_summary(proof(SOURCE, SOURCE * [1, 1, -1.0]))
    first = summary.splitlines()[0]

    assert "the target fits a mirror image of the source better" in first
    assert first.endswith("are two swapped?")
    assert "random" not in summary


def test_clouds_that_are_alike_in_extent_are_not_said_to_have_one_shape():
    rng = np.random.default_rng(0)
    shuffled = rng.permutation(SOURCE)  # of the same extent, whatever its shape
    summary = registration_summary(proof(SOURCE, shuffled))

    assert "(an estimate: more than one in 1000 would explain as much)" in summary
    assert "have one shape" not in summary
    assert "though the clouds are about as long and wide" in summary


def test_what_a_certificate_does_not_claim_is_not_said_to_be_unproved():
    """Its delta and mu may prove an angle that it does not claim: the checker says so below."""
    registration = proof(SOURCE, TARGET)
    bounds = registration.bounds
    assert bounds is not None
    words = page(replace(registration, bounds=replace(bounds, angle_upper=None)))

    assert "Every global optimum is within" in words  # the checker, of delta and mu
    assert "no angle to the one optimum is claimed" in words
    assert "not bounded" not in words


def test_why_a_reflection_came_back_is_asked_and_not_asserted():
    judged = assess(RegistrationProblem(SOURCE, TARGET), np.diag([1.0, 1, -1]), np.zeros(3))

    assert judged.words.endswith("or is the target mirrored?")
    turned = assess(
        RegistrationProblem(TETRAHEDRON, TETRAHEDRON), np.diag([1.0, -1, -1]), [0, 0, 0]
    )
    assert "degrees from a projective plane of index-1 equilibria" in turned.headline


OCTAHEDRON = np.vstack([np.eye(3), -np.eye(3)])


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_the_optimum_is_not_counted_as_spurious(specimen):
    found = equilibria(specimen.problem)
    words, unique = count_words(found), specimen.pattern[0] == 1

    assert ("optimum and " in words) == unique
    assert ("infinitely many optima and " in words or "every one is optimal" in words) != unique
    assert ("infinitely many spurious" in words) == (found.spurious is None)


def test_the_page_of_a_unique_optimum_among_a_continuum_counts_them_apart():
    words = page(proof(OCTAHEDRON, OCTAHEDRON))

    assert "There is one optimum and infinitely many spurious equilibria: one pose of" in words


def test_a_body_comes_back_to_the_optimum_where_its_motion_is_defined():
    found = equilibria(RegistrationProblem(np.diag([3.0, 2, 1]), np.diag([3.0, 2, 1])))
    first, *others = found.components
    line = replace(found, components=(replace(first, unstable_eigenvalues=None), *others))
    said = [component_words(one, 0) for one in (found, line)]

    assert said[0].endswith("the energy rises, and the body comes back.")
    assert said[1] == said[0].replace(", and the body comes back", "")
