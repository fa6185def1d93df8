"""The roads to the equilibria agree: by eigenspaces, by elimination, by continuation."""

from __future__ import annotations

import dataclasses
from importlib import import_module

import numpy as np
import pytest
import strategies
from commands import certreg, checked, write_csv

import certreg as package
from certreg.equilibrium.groebner import eliminate, fibres
from certreg.equilibrium.homotopy import HomotopyStatus, continuation
from certreg.equilibrium.krawczyk import EigenBalls, are_distinct, proved_root
from certreg.equilibrium.methods import Method, UndecidedRoad, agreement_of, all_roads, road
from certreg.equilibrium.spectral import spectrum, unit_double
from certreg.errors import ContradictionError, UndecidedError
from certreg.exact.balls import exact_matrix
from certreg.geometry.so3 import davenport_matrix
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.report.roads import roads_fields, roads_summary
from certreg.results import Guarantee

# `equilibria` is a submodule and a function, and the function wins
HOMOTOPY = import_module("certreg.equilibrium.homotopy")
GROEBNER = import_module("certreg.equilibrium.groebner")
ANGLE = 1e-10  # radians, between the rotations of two roads


def met(K):
    """What it is when all paths were lost and lie at one point."""
    ends = continuation(K)
    same = np.repeat(ends.quaternions[:, :1], 4, axis=1)
    outcomes = (HomotopyStatus.INCOMPLETE,) * len(K)
    return dataclasses.replace(ends, quaternions=same, outcomes=outcomes)


def turned_apart(p, q):
    """The angle between the rotations of unit quaternions."""
    across = min(np.linalg.norm(p - q), np.linalg.norm(p + q))
    return 4 * np.arcsin(min(1.0, across / 2))


def test_a_thousand_random_instances_agree_on_all_roads_with_four_equilibria_each():
    moments = [
        exact_moments(
            strategies.random_problem(np.random.default_rng(k), noise=10.0 ** (k % 5 - 3))
        )
        for k in range(1000)
    ]
    K = [davenport_matrix(m.cross) for m in moments]
    shifts = [max(abs(e) for row in rows for e in row).bit_length() for rows in K]
    doubles = np.array(
        [[[e / (1 << s) for e in row] for row in rows] for rows, s in zip(K, shifts, strict=True)]
    )
    ends = continuation(doubles)

    assert set(ends.outcomes) == {HomotopyStatus.FOUND}
    for k, each in enumerate(moments):
        spectral = [unit_double(v) for v in spectrum(each).basis.vectors]
        parts = fibres(eliminate(each.cross), 60)
        algebraic = [[float(c.mid()) for c in part.vectors[0]] for part in parts]
        balls = exact_matrix(K[k], shifts[k])
        tracked = ends.quaternions[k].tolist()
        systems = [EigenBalls(balls, q) for q in tracked]
        boxes = [checked(proved_root(s, s.start(q))) for s, q in zip(systems, tracked, strict=True)]
        assert [part.dimension for part in parts] == [0, 0, 0, 0]
        assert are_distinct(boxes)
        for p, q, r in zip(spectral, algebraic, ends.quaternions[k], strict=True):
            assert turned_apart(p, np.array(q)) < ANGLE
            assert turned_apart(p, r) < ANGLE


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_every_row_is_the_same_on_both_exact_roads_and_not_contradicted_by_the_third(specimen):
    found = all_roads(exact_moments(specimen.problem))

    assert [r.found.classification.pattern for r in found.roads] == [specimen.pattern] * 3
    assert [r.doubt is None for r in found.roads[:2]] == [True, True]
    assert (found.roads[2].doubt is None) == (specimen.pattern == (1, 1, 1, 1))
    assert found.angle < 1e-25


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("seed", range(5))
def test_near_degeneracy_is_decided_exactly_and_the_homotopy_is_right_or_says_so(gap, seed):
    """Values with a relative gap in a random frame, rounded to doubles: still four equilibria."""
    rng = np.random.default_rng(seed)
    U, V = (strategies.random_rotation(rng) for _ in range(2))
    source = np.diag([1.0, 0.5, 0.5 - gap])
    problem = RegistrationProblem(
        np.vstack([source, -source]) @ U.T, np.vstack([np.eye(3), -np.eye(3)]) @ V.T
    )
    found = all_roads(exact_moments(problem))

    assert [r.found.classification.pattern for r in found.roads[:2]] == [(1, 1, 1, 1)] * 2
    assert found.angle < ANGLE
    third = found.roads[2] if len(found.roads) > 2 else found.undecided[0]
    decided = not isinstance(third, UndecidedRoad) and third.doubt is None
    assert decided or (third.reason if isinstance(third, UndecidedRoad) else third.doubt)
    if gap >= 1e-6:
        assert decided


@pytest.mark.parametrize("method", ["spectral", "groebner", "homotopy", "all"])
def test_the_public_function_gives_the_same_set_on_every_road(method):
    problem = strategies.random_problem(np.random.default_rng(3), noise=0.1)
    found, known = package.equilibria(problem, method=method), package.equilibria(problem)

    enclosed = method == "homotopy"
    assert found.guarantee is (Guarantee.ENCLOSED if enclosed else Guarantee.EXACT)
    assert found.complete
    for a, b in zip(found.components, known.components, strict=True):
        assert (a.energy, a.rmse, a.morse_index) == (b.energy, b.rmse, b.morse_index)
        assert np.array_equal(a.rotation, b.rotation)
        assert np.array_equal(checked(a.eigenvalues), checked(b.eigenvalues))


def test_an_unknown_method_is_refused_with_the_known_ones():
    problem = strategies.random_problem(np.random.default_rng(3))
    with pytest.raises(ValueError, match="'spectral', 'groebner', 'homotopy' and 'all'"):
        package.equilibria(problem, method="buchberger")


def test_a_continuum_is_numerical_and_in_doubt_by_homotopy():
    square = next(s for s in strategies.ZOO if s.name == "square").problem
    found = package.equilibria(square, method="homotopy")

    assert found.guarantee is Guarantee.NUMERICAL
    assert not found.complete
    assert "continuum" in (found.doubt or "")
    assert found.classification.pattern == (1, 2, 1)


def test_lost_paths_are_an_undecided_road_and_no_list(monkeypatch):
    monkeypatch.setattr(HOMOTOPY, "continuation", met)
    moments = exact_moments(strategies.random_problem(np.random.default_rng(1)))
    with pytest.raises(UndecidedError, match="lost"):
        road(moments, Method.HOMOTOPY)
    found = all_roads(moments)
    assert [each.method for each in found.undecided] == [Method.HOMOTOPY]
    assert "undecided" in roads_summary(found)
    reasons: dict[str, str] = {}
    fields = roads_fields(found, reasons)
    assert fields["roads"][2]["energies"] is None
    assert "lost" in reasons["roads[2].energies"]


def test_roads_that_disagree_are_an_error():
    moments = exact_moments(strategies.random_problem(np.random.default_rng(4), noise=0.1))
    first, second, third = all_roads(moments).roads
    turned = dataclasses.replace(second.found.basis, vectors=(second.found.basis.vectors[1],) * 4)
    shifted = dataclasses.replace(
        second.found.basis, values=tuple(v + (1 << 160) for v in second.found.basis.values)
    )
    for basis in (turned, shifted):
        forged = dataclasses.replace(second, found=dataclasses.replace(second.found, basis=basis))
        with pytest.raises(ContradictionError, match=r"spectral .* groebner"):
            agreement_of([first, forged, third])
    with pytest.raises(ContradictionError, match="homotopy"):
        agreement_of([first, second, dataclasses.replace(third, indices=(0, 1, 3, 2))])
    other = all_roads(exact_moments(strategies.ZOO[4].problem)).roads[0]
    with pytest.raises(ContradictionError, match="disagree"):
        agreement_of([first, other])
    doubtful = dataclasses.replace(all_roads(exact_moments(strategies.ZOO[4].problem)).roads[2])
    assert agreement_of([first, doubtful]).angle == 0.0
    with pytest.raises(ContradictionError, match="disagree"):
        agreement_of([other, dataclasses.replace(first, doubt="in doubt")])


@pytest.fixture
def survey(data):
    return data / "survey_source.csv", data / "survey_target.csv"


def test_the_command_shows_all_roads_in_one_table(survey):
    run = certreg("equilibria", *survey, "--method", "all")

    assert run.code == 0
    table = run.out[run.out.index("road") :].splitlines()
    assert table[0].split() == ["road", "solutions", "energies", "index", "time", "guarantee"]
    for line, name, guarantee in zip(
        table[1:4],
        ("spectral", "groebner", "homotopy"),
        ("exact", "exact", "enclosed"),
        strict=True,
    ):
        assert line.split()[0] == name
        assert "4 points" in line
        assert "136.3750636 2071724.683" in line
        assert line.split()[-1] == guarantee
        assert "0 1 2 3" in line
    assert "agree: rotations to" in table[4]


def test_the_command_writes_the_roads_as_json(survey):
    run = certreg("equilibria", *survey, "--method", "all", "--json")

    assert run.code == 0
    assert [r["method"] for r in run.document["roads"]] == ["spectral", "groebner", "homotopy"]
    assert run.document["agreement"]["rotation_deg"] < 1e-8
    assert run.document["equilibria"]["guarantee"] == "exact"
    assert all(r["indices"] == [0, 1, 2, 3] for r in run.document["roads"])


def test_the_command_fails_loudly_where_roads_disagree(survey, monkeypatch):
    monkeypatch.setattr(GROEBNER, "fibres", lambda found, bits: fibres(found, bits)[::-1])
    run = certreg("equilibria", *survey, "--method", "all")

    assert run.code == 1
    assert "disagree" in run.err
    assert run.out == ""


def test_a_list_in_doubt_ends_with_code_four(tmp_path):
    square = write_csv(tmp_path / "square.csv", strategies.SQUARE)
    run = certreg("equilibria", square, square, "--method", "homotopy")

    assert run.code == 4
    assert "not proved complete" in run.out
    document = certreg("equilibria", square, square, "--method", "homotopy", "--json").document
    assert document["equilibria"]["complete"] is False
    assert "continuum" in document["reasons"]["equilibria.complete"]
    assert certreg("equilibria", square, square, "--method", "all").code == 0


def test_an_undecided_road_ends_with_code_four_and_one_line(survey, monkeypatch):
    monkeypatch.setattr(HOMOTOPY, "continuation", met)
    run = certreg("equilibria", *survey, "--method", "homotopy")

    assert run.code == 4
    assert run.err.count("\n") == 1
    assert run.out == ""
