"""The section of the report that lists all equilibria of general springs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from commands import checked
from test_spring_page import registered, words_of

from certreg.errors import MissingToolError
from certreg.problem.problem import RegistrationProblem
from certreg.registration import equilibria
from certreg.registration.certification import certify
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.rest_sections import Listed, is_trap, springs_listed
from certreg.report.words import ALONE, not_claimed, sentences
from certreg.results import Guarantee
from derivations.spring_counterexamples import STABLE


def springs_of(problem: RegistrationProblem) -> Any:
    """The result of `certify`."""
    return certify(problem)


def parts_of(registration: Any) -> Any:
    """The equilibria beside a result."""
    found = equilibria.listed_springs(registration.problem, registration.solution.objective)
    assert found is not None
    return found.components


@cache
def eighteen() -> Any:
    (planes,) = STABLE.clouds
    source, target, normals = (
        np.array(rows, float) for rows in (planes.source, planes.target, planes.normals)
    )
    return springs_of(RegistrationProblem(source, target, normals=normals))


@pytest.fixture(scope="module")
def forty() -> Listed:
    found = springs_listed(eighteen())
    assert found is not None
    return found


@pytest.mark.slow
def test_the_eighteen_planes_have_three_stable_equilibria_that_are_wrong_and_hold_the_body(forty):
    table = checked(forty.table)
    traps = [table.rows[k] for k in sorted(table.stressed)]

    assert "exactly 40, of which 4 stable" in forty.words
    assert [row[3] for row in traps] == ["16.000000"] * 3
    assert {row[4] for row in traps} == {"180 deg"}
    assert {row[-1] for row in traps} == {"stable, and wrong; a body comes back"}
    assert table.rows[0][-1] == "optimal; a body comes back"
    assert {row[-1] for row in table.rows if row[1] == "no"} == {""}
    assert [row[0] for row in table.rows].count("0") == 4


@pytest.mark.slow
def test_the_page_has_a_row_for_each_equilibrium_and_marks_the_traps():
    page = html_page(Report.of(eighteen()))
    body = page.decode().partition("All equilibria of these springs")[2]
    table = body.partition("</table>")[0]

    assert table.count("<tr>") == 41
    assert table.count("<strong>stable, and wrong") == 3
    assert "a body comes back" in words_of(page)
    assert "At most forty critical lines" in words_of(page)
    assert (
        "Exact: integer arithmetic and a theorem. Enclosed: each rotation alone in a box, by ball "
        "arithmetic. Numerical: computed with rounding that nobody has bounded. Each theorem has a "
        "page in the documentation; certreg derive NAME proves it anew."
    ) in words_of(page)


def test_a_problem_with_one_stable_equilibrium_has_no_trap():
    found = springs_listed(registered("plane"))

    table = checked(checked(found).table)
    assert not table.stressed
    assert [row[1] for row in table.rows].count("yes") == 1
    assert not any("stays there" in note for note in checked(found).notes)


def test_one_wall_is_not_said_to_be_listed_and_no_row_is_called_stable():
    points = np.random.default_rng(0).standard_normal((9, 3))
    wall = RegistrationProblem(points, points, normals=np.tile([0.0, 0.0, 1.0], (9, 1)))
    found = springs_listed(springs_of(wall))

    assert found is not None
    assert found.words == "Equilibria (exact): infinitely many; none proved to be isolated."
    table = checked(found.table)
    assert table.head[4] == "to row 1"
    assert {(row[0], row[1], row[-1]) for row in table.rows} == {("-", "-", "not separated")}
    assert not table.stressed


def test_where_nothing_is_listed_the_page_has_no_such_section(monkeypatch):
    monkeypatch.setattr(equilibria, "listed_springs", lambda *_: None)
    page = html_page(Report.of(registered("plane")))

    assert springs_listed(registered("plane")) is None
    assert b"All equilibria" not in page
    said = words_of(page)
    assert (
        "where else the springs balance: general springs have up to forty equilibria, or " in said
    )
    assert "or infinitely many, stable ones among them, and this page lists none;" in said


def test_without_the_library_of_the_list_the_page_is_made_and_says_what_the_list_needs(monkeypatch):
    missing = MissingToolError("the method homotopy needs python-flint, which is not installed")

    def no_list(*_: object):
        raise missing

    monkeypatch.setattr(equilibria, "listed_springs", no_list)
    said = words_of(html_page(Report.of(registered("plane"))))

    assert f"None is listed here: {missing}." in said
    assert "or infinitely many, stable ones among them, and this page lists none;" in said


@pytest.mark.slow
def test_a_complete_list_is_known_and_how_and_nothing_says_that_none_is_listed(forty):
    found = eighteen()
    (said,) = [one for one in sentences(found, None, forty) if "The list was made" in one.words]

    assert said.words.startswith("Equilibria (enclosed, complete): exactly 40, of which 4 stable.")
    assert said.words.endswith(" certreg equilibria --out writes one that does.")
    assert said.guarantee is Guarantee.ENCLOSED
    assert said.theorems == ("forty_lines",)
    assert not any("forty equilibria" in words for words in not_claimed(found, forty))


def test_of_springs_alike_in_every_way_no_certificate_of_the_list_is_promised():
    rng = np.random.default_rng(0)
    source, information = rng.standard_normal((4, 3)), np.tile(np.eye(3), (4, 1, 1))
    found = springs_of(RegistrationProblem(source, source + 0.1, information=information))
    rows = springs_listed(found)

    assert rows is not None
    (said,) = [one for one in sentences(found, None, rows) if "The list was made" in one.words]
    assert "exactly 4" in said.words
    assert "--out" not in said.words
    assert said.theorems == ("eigenvectors", "classification")


def test_a_list_that_may_not_be_whole_is_not_among_what_is_known(forty):
    found, part = eighteen(), replace(forty, complete=False)

    assert not any("The list was made" in one.words for one in sentences(found, None, part))
    (open_,) = [words for words in not_claimed(found, part) if "forty equilibria" in words]
    assert open_.startswith("that no equilibria are missing in the list above: ")


@pytest.mark.slow
def test_what_is_not_decided_is_under_what_is_not_claimed_and_not_among_what_is_exact():
    rng = np.random.default_rng(4)
    source, normals = rng.integers(-9, 10, (2, 5, 3)).astype(float)
    found = springs_of(RegistrationProblem(source, source, normals=normals))

    said = sentences(found, None, None)
    assert not any("not decided" in one.words for one in said)
    assert ALONE in not_claimed(found, None)
    assert ALONE not in not_claimed(registered("plane"), None)
    assert not_claimed(found, None)[-1].endswith(".")
    assert [one.guarantee for one in said if "add up to 5" in one.words] == [Guarantee.EXACT]


@pytest.mark.parametrize("seen", [False, None])
def test_only_what_came_back_is_said_to_have_come_back(monkeypatch, seen):
    monkeypatch.setattr(equilibria, "returns", lambda *_: seen)
    found = springs_listed(registered("plane"))

    assert found is not None
    assert checked(found.table).rows[0][-1] == "optimal"


@pytest.mark.slow
def test_a_body_released_at_a_saddle_does_not_come_back():
    found = eighteen()
    problem, objective = found.problem, found.solution.objective
    parts = parts_of(found)
    saddle = next(part for part in parts if part.morse_index == 1)

    assert equilibria.returns(problem, objective, parts[1]) is True
    assert equilibria.returns(problem, objective, saddle) is False


@pytest.mark.slow
def test_springs_on_collinear_points_have_no_motion_and_nothing_is_said_of_it():
    points = np.outer(np.arange(1.0, 7.0), [1.0, 2.0, 3.0])
    target = points + np.random.default_rng(1).standard_normal((6, 3))
    normals = np.random.default_rng(2).standard_normal((6, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    found = springs_of(RegistrationProblem(points, target, normals=normals))
    part = parts_of(eighteen())[0]

    assert equilibria.returns(found.problem, found.solution.objective, part) is None


def test_a_trap_is_a_stable_equilibrium_that_is_proved_not_to_be_optimal():
    for stable, optimal in product((None, False, True), repeat=2):
        part: Any = SimpleNamespace(stable=stable, optimal=optimal)

        assert is_trap(part) == (stable is True and optimal is False)
