"""Sentences on general springs that few data bring about, each from data that do."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import spring_families
from commands import checked
from exact_springs import two_optima
from springs_certified import moved_springs

import certreg
from certreg import RegistrationProblem
from certreg.equilibrium.paths import critical_lines
from certreg.errors import InvalidFileError, InvalidProblemError, OutOfRangeError
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.covariance import OF_SPRINGS, covariance_at
from certreg.registration.enumeration import enumerated, equilibrium_poses
from certreg.registration.unobservable import Freedom
from certreg.report.equilibria import Rests, spring_rests
from certreg.report.pages import html_page, report_on
from certreg.report.reload import report_of
from certreg.report.rest_sections import springs_listed
from certreg.report.springs import springs_words
from certreg.results import Absent, Limits, PoseVerdict

if TYPE_CHECKING:
    from certreg.registration.enumeration import Enumeration
    from certreg.registration.equilibria import SpringEquilibria
    from certreg.registration.valley import SimulatedSprings


VECTORS = Path(__file__).parents[2] / "vectors"
SIX, SEVEN = (spring_families.instance(spring_families.LISTED[k], 0) for k in (0, 2))


def problem_of(made: spring_families.Instance) -> RegistrationProblem:
    return RegistrationProblem(**spring_families.statement(made))


def searched(found: Enumeration[SpringEquilibria]) -> Rests:
    """What is said of a list with the searches for it."""
    return spring_rests(replace(found.equilibria, enumeration=found))


@cache
def six() -> Enumeration[SpringEquilibria]:
    """Six planes: several rotations fit exactly."""
    return enumerated(problem_of(SIX))


@cache
def circles() -> Enumeration[SpringEquilibria]:
    """Two optima, alone, and other equilibria on circles: no method has a complete list."""
    return enumerated(two_optima(), "all")


@cache
def wall() -> SimulatedSprings:
    """Two shifts and a turn are free; the body is 0.5 from the wall.

    Of the optima, which are a continuum, the one that is found is far from where this body ends.
    """
    source = np.random.default_rng(10).normal(size=(10, 3))
    normals = np.tile([0.0, 0.0, 1.0], (10, 1))
    return moved_springs(
        RegistrationProblem(source, source + np.array([3, 0, 0.5]), normals=normals)
    )


@cache
def trapped() -> SimulatedSprings:
    """Seven planes, with the source put at a stable equilibrium that is not the optimum."""
    found = enumerated(problem_of(SEVEN)).equilibria
    pose = next(each.pose for each in found.components[1:] if each.stable)
    moved = SEVEN.source @ pose.rotation.T + pose.translation
    return moved_springs(RegistrationProblem(moved, SEVEN.target, normals=SEVEN.springs["normals"]))


# --- motions


@pytest.mark.slow
def test_a_body_that_rests_elsewhere_is_told_with_how_far_it_is_and_how_much_higher():
    told = str(trapped())

    words = (
        "The body is at rest (slower than the tolerance) at another equilibrium: springs hold it "
        "there, and a better rotation was found."
    )
    assert told.startswith(words)
    assert " degrees from the best rotation found, 0.0014 of the energy's range above it" in told


def test_along_what_no_spring_resists_the_body_is_told_to_coast():
    shift, turn = wall().notes

    coasts = "a body that moves that way coasts until damping has stopped it"
    assert shift.startswith("no spring resists a shift along ")
    assert turn.startswith("rotation about the normal (0, 0, 1) is undetermined: ")
    assert shift.endswith(f": {coasts}")
    assert turn.endswith(f": {coasts}")


def test_of_many_optima_the_end_is_told_to_be_as_good_as_the_one_that_was_found():
    told = str(wall())

    rest = "The body is at rest (slower than the tolerance) at a rotation as good as the best found"
    assert told.startswith(f"{rest}.\n")
    away = " degrees from the best rotation found, and as good to within the tolerance\n"
    assert away in told
    words = (
        "Not proved that from its last state the exact motion ends at the optimum: no list of "
        "equilibria could be proved complete."
    )
    assert told.endswith(words)


@pytest.mark.slow
def test_the_rates_of_a_motion_on_general_springs_are_told_to_be_missing():
    reasons = trapped().to_dict()["reasons"]

    assert reasons["predicted_rate"] == reasons["decay_rate"] == "not computed for general springs"


# --- lists of equilibria


def test_a_method_that_is_none_of_general_springs_is_refused_by_those_there_are():
    words = "have no eigenspaces: take 'homotopy' or 'all'$"
    with pytest.raises(InvalidProblemError, match=words):
        enumerated(problem_of(SIX), "spectral")
    with pytest.raises(InvalidProblemError, match="method is 'newton': give 'homotopy'"):
        enumerated(problem_of(SIX), "newton")


@pytest.mark.slow
def test_of_several_that_are_as_good_none_is_called_the_optimum():
    found = six().equilibria
    reasons = searched(six()).document()["reasons"]

    words = (
        "Not decided which is best: the first 2 have the same energy, as far as 300 digits tell."
    )
    assert str(found).endswith(words)
    tied = "as good as another equilibrium, as far as 300 digits tell"
    assert [each.stated("optimal") for each in found.components[:2]] == [Absent(tied)] * 2
    assert reasons["equilibria.spurious"] == "which are the best is not decided"
    certified: Any = certreg.certify(problem_of(SIX))
    rows = checked(checked(springs_listed(certified)).table).rows
    assert [row[-1].split("; ")[0] for row in rows[:3]] == ["may be optimal"] * 2 + [""]


def test_what_general_springs_do_not_have_is_said_in_the_document():
    reasons = searched(six()).document()["reasons"]

    absent = "defined for one weight per pair: general springs have no eigenvalues"
    assert reasons["equilibria.pattern"] == absent
    linear = "the motion on general springs is not linearised in this version"
    assert reasons["equilibria.components[0].eigenvalues"] == linear


def test_where_no_list_is_complete_the_methods_are_not_compared():
    told = searched(circles()).words()
    reasons = searched(circles()).document()["reasons"]

    assert "  road      solutions  index 0 1 2 3  time" in told
    assert reasons["agreement.rotation_deg"] == "no list was proved complete"


def test_where_a_list_is_in_doubt_no_equilibrium_is_called_the_optimum():
    found = circles().equilibria.components
    better = "the list is not proved complete: a better rotation may be missing"
    merged = "not proved to be one equilibrium: it may be several, or none"

    assert [each.stated("optimal") for each in found[:3]] == [Absent(better)] * 2 + [False]
    assert {each.stated("optimal") for each in found if not each.separated} == {Absent(merged)}


def test_springs_that_are_one_weight_per_pair_have_four_equilibria_each_proved_in_a_box():
    told = str(enumerated(full_springs(0)).equilibria)

    assert "exactly 4, of which 1 stable." in told
    assert (
        " Each is proved to be alone in a box around it; the Euler sum of the indices is 0, "
        "as that of all must be." in told
    )


# --- others


def full_springs(planes: int) -> RegistrationProblem:
    """Six springs that are alike in all directions, but for the first, which are planes."""
    x, y = np.random.default_rng(1).normal(size=(2, 6, 3))
    factors = np.zeros((6, 6))
    factors[:, [0, 2, 5]] = 1.0
    factors[:planes] = 0.0
    factors[:planes, [0, 1, 3]] = y[:planes]
    return RegistrationProblem(x, x + 0.1 * y, factors=factors)


def test_springs_of_several_ranks_are_counted_by_their_kinds():
    certified: list[Any] = [certreg.certify(full_springs(planes)) for planes in (2, 5)]
    told = [springs_words(each) for each in certified]

    assert told == ["2 planes, 4 full springs", "5 planes, 1 full spring"]


def test_an_equilibrium_that_no_doubles_can_place_is_refused_with_the_remedy():
    """At the optimum nothing moves; a half turn moves the mean to the other side of the origin."""
    source = 1.5e308 + 1e300 * np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3], [1, 1, 4]])
    words = (
        "the translation of a pose exceeds the range of doubles: "
        "change the unit of length of both clouds"
    )
    with pytest.raises(OutOfRangeError, match=words):
        equilibrium_poses(enumerated(RegistrationProblem(source, source)))


def test_no_report_is_made_of_a_list_of_equilibria(tmp_path):
    certificate = trapped().listed
    assert certificate is not None
    certificate.save(tmp_path / "list.json")

    words = ", which `certreg verify` tells in words: give the certificate.json that certify wrote"
    with pytest.raises(InvalidFileError, match=words):
        report_of(tmp_path / "list.json")


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
