"""The methods for equilibria agree: by eigenspaces, by elimination, by continuation."""

from __future__ import annotations

import dataclasses
from importlib import import_module
from itertools import permutations

import numpy as np
import pytest
import strategies
from commands import certreg, checked, write_csv

import certreg as package
from certreg.equilibrium import methods
from certreg.equilibrium.critical_set import Completeness
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.equilibrium.four_paths import HomotopyStatus, continuation
from certreg.equilibrium.groebner import eliminate, fibres
from certreg.equilibrium.line_boxes import BallMatrix, all_different, boxed
from certreg.equilibrium.methods import FINDERS, compare, search
from certreg.errors import ContradictionError, InvalidProblemError, UndecidedError
from certreg.exact.balls import exact_matrix
from certreg.geometry.so3 import davenport_matrix, dot
from certreg.objective.isotropic import Isotropic
from certreg.objective.structure import Structure
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.enumeration import enumerated
from certreg.report.encoding import encoded
from certreg.report.methods import methods_fields, methods_summary
from certreg.results import Guarantee

HOMOTOPY = import_module("certreg.equilibrium.homotopy")
GROEBNER = import_module("certreg.equilibrium.groebner")
ANGLE = 1e-10  # radians, between the rotations by two methods


def met(K):
    """What it is when all paths were lost and lie at one point."""
    ends = continuation(K)
    same = np.repeat(ends.quaternions[:, :1], 4, axis=1)
    return dataclasses.replace(ends, quaternions=same, patterns=((),) * len(K))


def critical_sets(problem):
    """The critical set by each method."""
    objective = Isotropic(exact_moments(problem))
    return [checked(search(objective, name).critical) for name in FINDERS[Structure.LINEAR]]


def isotropic(points):
    """The objective of points on themselves."""
    return Isotropic(exact_moments(RegistrationProblem(points, points)))


def turned_apart(p, q):
    """The angle between the rotations of unit quaternions."""
    across = min(np.linalg.norm(p - q), np.linalg.norm(p + q))
    return 4 * np.arcsin(min(1.0, across / 2))


@pytest.mark.parametrize("sizes", list(permutations((3, 2, 1))))
def test_an_entry_that_is_zero_decides_no_sign_of_an_enclosed_quaternion(sizes):
    octahedron = np.vstack([np.diag(sizes), -np.diag(sizes)])  # K is diagonal: axes are critical
    by_continuation = search(isotropic(octahedron), "homotopy").critical
    assert by_continuation is not None

    units = sorted(tuple(map(abs, part.quaternion)) for part in by_continuation.components)
    assert units == sorted(part.quaternion for part in by_continuation.components)
    assert [sum(map(bool, unit)) for unit in units] == [1] * 4


@pytest.mark.slow
@pytest.mark.parametrize(
    "first", [0, *(pytest.param(k, marks=pytest.mark.long) for k in range(50, 1000, 50))]
)
def test_a_thousand_random_instances_agree_by_all_methods_with_four_equilibria_each(first: int):
    moments = [
        exact_moments(
            strategies.random_problem(np.random.default_rng(k), noise=10.0 ** (k % 5 - 3))
        )
        for k in range(first, first + 50)
    ]
    K = [davenport_matrix(m.cross) for m in moments]
    shifts = [max(abs(e) for row in rows for e in row).bit_length() for rows in K]
    doubles = np.array(
        [[[e / (1 << s) for e in row] for row in rows] for rows, s in zip(K, shifts, strict=True)]
    )
    ends = continuation(doubles)

    assert set(ends.outcomes) == {HomotopyStatus.FOUND}
    for k, each in enumerate(moments):
        spectral = [unit_double(v) for v in Isotropic(each).eigenvectors]
        parts = fibres(eliminate(each.cross, K[k]), 60)
        algebraic = [[float(c.mid()) for c in part.vectors[0]] for part in parts]
        balls = exact_matrix(K[k], shifts[k])
        tracked = ends.quaternions[k].tolist()
        lines = [checked(boxed(BallMatrix(balls), q, real=True)) for q in tracked]
        assert [part.dimension for part in parts] == [0, 0, 0, 0]
        assert all_different(lines)
        for p, q, r in zip(spectral, algebraic, ends.quaternions[k], strict=True):
            assert turned_apart(p, np.array(q)) < ANGLE
            assert turned_apart(p, r) < ANGLE


@pytest.mark.one_in(4)
@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_every_row_is_the_same_by_both_exact_methods_and_not_contradicted_by_the_third(specimen):
    sets = critical_sets(specimen.problem)

    assert [each.pattern for each in sets] == [specimen.pattern] * 3
    assert [each.complete for each in sets[:2]] == [True, True]
    assert sets[2].complete == (specimen.pattern == (1, 1, 1, 1))
    assert compare(sets).angle < 1e-25


@pytest.mark.one_in(4)
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
    objective = Isotropic(exact_moments(problem))
    first, second, third = (search(objective, name) for name in FINDERS[Structure.LINEAR])

    assert [checked(each.critical).pattern for each in (first, second)] == [(1, 1, 1, 1)] * 2
    sets = [each.critical for each in (first, second, third) if each.critical is not None]
    assert compare(sets).angle < ANGLE
    decided = third.critical is not None and third.critical.complete
    assert decided or (third.reason if third.critical is None else third.critical.doubt)
    if gap >= 1e-6:
        assert decided


@pytest.mark.parametrize("method", ["spectral", "groebner", "homotopy", "all"])
def test_the_public_function_gives_the_same_set_by_every_method(method):
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
    with pytest.raises(InvalidProblemError, match="'spectral', 'groebner', 'homotopy', 'all'"):
        package.equilibria(problem, method="buchberger")


def test_a_continuum_is_numerical_and_in_doubt_by_homotopy():
    square = next(s for s in strategies.ZOO if s.name == "square").problem
    found = package.equilibria(square, method="homotopy")

    assert found.guarantee is Guarantee.NUMERICAL
    assert not found.complete
    assert "continuum" in (found.doubt or "")
    assert found.classification.pattern == (1, 2, 1)


def test_lost_paths_leave_a_method_undecided_and_are_no_list(monkeypatch):
    monkeypatch.setattr(HOMOTOPY, "continuation", met)
    problem = strategies.random_problem(np.random.default_rng(1))
    with pytest.raises(UndecidedError, match="lost"):
        enumerated(problem, "homotopy")
    found = enumerated(problem, "all")
    undecided = [each.method for each in found.searches if each.critical is None]
    assert undecided == ["homotopy"]
    assert "undecided" in methods_summary(found)
    document = encoded(methods_fields(found))
    assert document["roads"][2]["energies"] is None
    assert "lost" in document["reasons"]["roads[2].energies"]


def changed(critical, **parts):
    """A critical set with some of each component replaced."""
    components = tuple(
        dataclasses.replace(part, **{name: change(k, part) for name, change in parts.items()})
        for k, part in enumerate(critical.components)
    )
    return dataclasses.replace(critical, components=components)


def test_methods_that_disagree_are_an_error():
    first, second, third = critical_sets(
        strategies.random_problem(np.random.default_rng(4), noise=0.1)
    )
    turned = changed(second, span=lambda *_: second.components[1].span)
    span = first.components[-1].value - first.components[0].value
    shifted = changed(second, value=lambda _, part: part.value + span / 10**11)
    for forged in (turned, shifted):
        with pytest.raises(ContradictionError, match=r"spectral .* groebner"):
            compare([first, forged, third])
    nearly = changed(second, value=lambda _, part: part.value + span / 10**13)
    assert 9e-14 < compare([first, nearly]).energy < 1.1e-13
    with pytest.raises(ContradictionError, match="homotopy"):
        compare([first, second, changed(third, index=lambda k, _: (0, 1, 3, 2)[k])])


def test_a_comparison_tells_the_worst_of_all_and_holds_no_unknown_index_against_a_list():
    first, second, third = critical_sets(
        strategies.random_problem(np.random.default_rng(4), noise=0.1)
    )
    span = first.components[-1].value - first.components[0].value
    nearly = changed(second, value=lambda _, part: part.value + span / 10**13)
    unknown = changed(third, index=lambda *_: None)

    assert 9e-14 < compare([first, nearly, unknown]).energy < 1.1e-13
    assert compare([first, nearly, unknown]).angle == compare([first, unknown, nearly]).angle


def test_a_disagreement_tells_the_angle_in_degrees_and_its_limit_in_radians():
    first, second, _ = critical_sets(strategies.random_problem(np.random.default_rng(4), noise=0.1))
    turned = changed(second, span=lambda *_: second.components[1].span)
    with pytest.raises(ContradictionError, match="rotations up to 180 degrees apart") as caught:
        compare([first, turned])

    assert caught.value.value == pytest.approx(np.pi)
    assert (caught.value.limit, caught.value.methods) == (1e-10, ("spectral", "groebner"))


def test_a_list_in_doubt_may_only_take_neighbours_together():
    first, *_ = critical_sets(strategies.random_problem(np.random.default_rng(4), noise=0.1))
    other, _, doubtful = critical_sets(strategies.ZOO[4].problem)
    with pytest.raises(ContradictionError, match="disagree"):
        compare([first, other])
    assert compare([first, doubtful]).angle == 0.0
    with pytest.raises(ContradictionError, match="disagree"):
        compare([other, dataclasses.replace(first, completeness=None, doubt="in doubt")])


def test_a_value_that_differs_is_seen_where_there_is_only_one():
    first, *_ = critical_sets(strategies.ZOO[-1].problem)  # every rotation is optimal
    assert first.pattern == (4,)
    with pytest.raises(ContradictionError, match="disagree"):
        compare([first, changed(first, value=lambda _, part: part.value + 1)])


@pytest.mark.parametrize(
    ("coarse", "fine", "merged"),
    [
        ((2, 2), (1, 1, 1, 1), True),
        ((1, 3), (1, 2, 1), True),
        ((4,), (1, 3), True),
        ((1, 2, 1), (1, 2, 1), True),
        ((2, 2), (1, 2, 1), False),
        ((1, 3), (3, 1), False),
        ((2, 1, 1), (1, 1, 2), False),
        ((1, 1, 2), (2, 2), False),
    ],
)
def test_a_pattern_is_merged_from_another_where_its_borders_are_borders_there(coarse, fine, merged):
    assert methods._merges(coarse, fine) == merged


def unit_spans(found):
    """The largest difference of a span's entries from an orthonormal one's, in its last places."""
    unit, off = 1 << 2 * found.bits, 0
    for part in found.components:
        for i, v in enumerate(part.span):
            for j, u in enumerate(part.span):
                off = max(off, abs(dot(v, u) - unit * (i == j)))
    return off >> found.bits


@pytest.mark.parametrize("specimen", strategies.ZOO[::3], ids=lambda s: s.name)
def test_spans_are_orthonormal_in_the_bits_that_they_state(specimen):
    for found in critical_sets(specimen.problem):
        assert unit_spans(found) < 1 << (12 if found.complete else found.bits - 45)


def test_the_angle_of_a_comparison_is_that_of_the_rotations():
    """A quaternion turned by a turns its rotation by 2 a."""
    first, second, _ = critical_sets(strategies.random_problem(np.random.default_rng(4), noise=0.1))
    spans = [part.span[0] for part in second.components]

    def beside(k, _):
        return (tuple(a + b // 10**12 for a, b in zip(spans[k], spans[k - 1], strict=True)),)

    found = compare([first, changed(second, span=beside)])
    assert found.angle == pytest.approx(2e-12, rel=1e-3, abs=0.0)


def test_a_list_in_doubt_has_the_energies_of_the_continuum():
    for specimen in strategies.ZOO[4:8]:
        known, _, doubtful = critical_sets(specimen.problem)
        values = [part.value for part in known.components]
        for a, b in zip(values, [part.value for part in doubtful.components], strict=True):
            assert abs(a - b) <= (values[-1] - values[0]) / 10**8


@pytest.mark.parametrize("cut", [1, 40, 60])
@pytest.mark.parametrize("order", [1, -1])
def test_lists_of_different_precision_are_compared_in_the_coarser_one(cut, order):
    first, second, _ = critical_sets(strategies.ZOO[4].problem)
    coarse = dataclasses.replace(
        changed(second, span=lambda _, part: tuple(tuple(e >> cut for e in v) for v in part.span)),
        bits=second.bits - cut,
    )
    last_place = 2.0 ** -min(first.bits, coarse.bits)

    assert compare([first, coarse][::order]).angle <= 100 * last_place


def test_a_list_is_as_sure_as_its_least_sure_component():
    found, *_ = critical_sets(strategies.random_problem(np.random.default_rng(4)))
    assert found.guarantee is Guarantee.EXACT
    for place in range(4):
        sureness = [Guarantee.NUMERICAL if k == place else Guarantee.EXACT for k in range(4)]
        doubtful = changed(found, guarantee=lambda k, _, sureness=sureness: sureness[k])
        assert doubtful.guarantee is Guarantee.NUMERICAL


def test_a_list_has_a_proof_of_completeness_or_a_doubt_and_not_both():
    found = critical_sets(strategies.random_problem(np.random.default_rng(4)))
    assert [each.completeness for each in found] == list(Completeness)[:3]
    assert [each.doubt for each in found] == [None] * 3
    for wrong in ({"completeness": None}, {"doubt": "in doubt"}):
        with pytest.raises(ValueError, match="proved to be complete"):
            dataclasses.replace(found[0], **wrong)


@pytest.fixture
def survey(data):
    return data / "survey_source.csv", data / "survey_target.csv"


def test_the_command_shows_all_methods_in_one_table(survey):
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


def test_the_command_writes_the_methods_as_json(survey):
    run = certreg("equilibria", *survey, "--method", "all", "--json")

    assert run.code == 0
    assert [r["method"] for r in run.document["roads"]] == ["spectral", "groebner", "homotopy"]
    assert run.document["agreement"]["rotation_deg"] < 1e-8
    assert run.document["equilibria"]["guarantee"] == "exact"
    assert all(r["indices"] == [0, 1, 2, 3] for r in run.document["roads"])


def test_the_command_fails_loudly_where_methods_disagree(survey, monkeypatch):
    monkeypatch.setattr(
        GROEBNER, "fibres", lambda elimination, bits: fibres(elimination, bits)[::-1]
    )
    run = certreg("equilibria", *survey, "--method", "all")

    assert run.code == 1
    assert "disagree" in run.err
    assert run.out == ""


def test_a_list_in_doubt_ends_with_code_four(tmp_path):
    square = write_csv(tmp_path / "square.csv", strategies.SQUARE)
    run = certreg("equilibria", square, square, "--method", "homotopy")

    assert run.code == 4
    assert "not proved complete" in run.out
    assert run.out.count("continuum") == 1  # said of the equilibria, not again below the table
    document = certreg("equilibria", square, square, "--method", "homotopy", "--json").document
    assert document["equilibria"]["complete"] is False
    assert "continuum" in document["reasons"]["equilibria.complete"]
    for number, part in enumerate(document["equilibria"]["components"]):
        assert part["morse_index"] is part["unstable_eigenvalues"] is None
        for name in ("morse_index", "unstable_eigenvalues", "optimal"):
            assert "continuum" in document["reasons"][f"equilibria.components[{number}].{name}"]
    assert "best found" in run.out
    assert "optimal" not in run.out
    assert certreg("equilibria", square, square, "--method", "all").code == 0


def test_an_undecided_method_ends_with_code_four_and_one_line(survey, monkeypatch):
    monkeypatch.setattr(HOMOTOPY, "continuation", met)
    run = certreg("equilibria", *survey, "--method", "homotopy")

    assert run.code == 4
    assert run.err.count("\n") == 1
    assert run.out == ""
