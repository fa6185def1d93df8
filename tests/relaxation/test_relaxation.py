"""The relaxation states the right program, solves it at any scale, and is never called a bound."""

from __future__ import annotations

import ast
import functools
import itertools
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import commands
import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from syntax import nodes

import certreg
from certreg import RegistrationProblem
from certreg.certificate.isotropic import (
    FIRST_STEP_BITS,
    MULTIPLIER_BITS,
    STEP_GROWTH_BITS,
    STEPS,
    multiplier_gap,
    proved_multiplier,
    proves_multiplier,
)
from certreg.exact.dyadic import Dyadic, dyadic_above, power_of_two
from certreg.exact.elimination import rank
from certreg.geometry.so3 import quadratic_form, rotation_matrix, squared_norm
from certreg.objective.isotropic import Isotropic
from certreg.problem.lifting import lift
from certreg.problem.moments import exact_moments
from certreg.relaxation import conic, cvxpy_models
from certreg.relaxation.conic import RelaxationStatus
from certreg.relaxation.qcqp import (
    RelaxationForm,
    homogeneous,
    quadratic_program,
    quaternion_program,
    rotation_program,
    rotation_quadratics,
)
from certreg.relaxation.shor import relax

PACKAGE = Path(certreg.__file__).parent
ACCURACY = 1e-7  # of value and multiplier, relative to the largest entry of C

small = st.integers(-9, 9)
quaternions = st.tuples(small, small, small, small).filter(any)
matrices = st.tuples(*[st.tuples(small, small, small)] * 3)


def rational_rotation(q):
    norm = squared_norm(q)
    return [[Fraction(entry, norm) for entry in row] for row in rotation_matrix(q)]


def upper(A):
    return [A[i][j] for i, j in itertools.combinations_with_replacement(range(len(A)), 2)]


# The programs, exactly


def test_the_21_quadratics_span_20_dimensions():
    quadratics = [upper(A) for A in rotation_quadratics()]

    assert len(quadratics) == 21
    assert rank(quadratics) == 20


def test_no_other_quadratic_vanishes_on_the_rotations():
    """The r r^T of rotations span 35 of the 55 dimensions of symmetric matrices: 55 - 35 = 20."""
    members = [q for q in itertools.product((-1, 0, 1, 2), repeat=4) if any(q)]
    vectors = [homogeneous(rotation_matrix(q), unit=squared_norm(q)) for q in members]
    modulus = 1_000_003  # a rank modulo a prime is at most the rank: enough for >= 35
    rows = [[r[i] * r[j] % modulus for i in range(10) for j in range(i + 1)] for r in vectors]

    assert rank_modulo(rows, modulus) == 35


def rank_modulo(rows, modulus):
    found = 0
    for column in range(len(rows[0])):
        pivot = next((row for row in rows if row[column]), None)
        if pivot is None:
            continue
        rows.remove(pivot)
        inverse = pow(pivot[column], -1, modulus)
        rows = [
            [(a - row[column] * inverse * b) % modulus for a, b in zip(row, pivot, strict=True)]
            for row in rows
        ]
        found += 1
    return found


@given(quaternions)
def test_every_quadratic_vanishes_on_every_rational_rotation(q):
    r = homogeneous(rotation_matrix(q), unit=squared_norm(q))  # the rotation, times its unit

    assert [quadratic_form(A, r) for A in rotation_quadratics()] == [0] * 21


@given(quaternions)
def test_the_quadratics_of_handedness_and_no_others_refuse_a_reflection(q):
    mirrored = homogeneous([[-e for e in row] for row in rotation_matrix(q)], unit=squared_norm(q))
    values = [quadratic_form(A, mirrored) for A in rotation_quadratics()]

    assert values[:12] == [0] * 12
    assert any(values[12:])


@given(quaternions, matrices)
def test_columns_and_rows_refuse_what_is_not_orthogonal(q, error):
    unit = squared_norm(q)  # the common denominator: all are homogeneous
    R = [
        [a + unit * b for a, b in zip(*rows, strict=True)]
        for rows in zip(rotation_matrix(q), error, strict=True)
    ]
    gram = [sum(R[k][i] * R[k][j] for k in range(3)) for i in range(3) for j in range(3)]
    orthogonal = gram == [unit**2 * entry for entry in (1, 0, 0, 0, 1, 0, 0, 0, 1)]
    values = [quadratic_form(A, homogeneous(R, unit=unit)) for A in rotation_quadratics()]

    assert orthogonal == (not any(values[:6])) == (not any(values[6:12]))


def test_each_quadratic_is_seen_refusing_a_matrix():
    r = homogeneous([[1, 2, 4], [3, 5, 7], [6, 8, 9]])

    assert all(quadratic_form(A, r) != 0 for A in rotation_quadratics())


@given(quaternions, matrices)
def test_both_objectives_are_the_trace_of_the_rotation_and_the_cross_covariance(q, C):
    R = rational_rotation(q)
    trace = sum(R[i][j] * C[i][j] for i in range(3) for j in range(3))
    by_quaternion, by_rotation = quaternion_program(C), rotation_program(C)
    r = homogeneous(R)

    assert quadratic_form(by_quaternion.objective, q) == trace * squared_norm(q)
    assert quadratic_form(by_rotation.objective, r) == by_rotation.multiple * trace
    assert quadratic_form(by_quaternion.normalisation, q) == squared_norm(q)
    assert quadratic_form(by_rotation.normalisation, r) == 1


def test_the_rotation_form_is_the_energy_up_to_a_constant():
    moments = exact_moments(strategies.random_problem(np.random.default_rng(0), noise=0.3))
    C = [[entry * moments.cross_unit for entry in row] for row in moments.cross]
    q = (3, -1, 4, 1)
    form = quadratic_form(rotation_program(C).objective, homogeneous(rational_rotation(q)))

    assert Isotropic(moments).energy(q) == moments.spread - form


@pytest.mark.parametrize("form", RelaxationForm)
def test_all_matrices_are_symmetric_and_the_constants_are_integers(form):
    program = quadratic_program(form, [[1, 2, 3], [4, 5, 6], [7, 8, 10]])

    for A in (program.objective, program.normalisation, *program.quadratics):
        assert len(A) == program.size
        assert [list(row) for row in zip(*A, strict=True)] == [list(row) for row in A]
        assert all(isinstance(entry, int) for row in A for entry in row)


# The solver


def solve(form, C) -> Any:
    """The solution, its numbers taken to be there: where one is missing the test fails."""
    return conic.solve(form, C, largest=True)


def relaxed(moments, form: str = RelaxationForm.QUATERNION, **options) -> Any:
    """The relaxation, its numbers taken to be there."""
    return relax(Isotropic(moments), form, **options)


def scaled_matrix(rng):
    C = rng.normal(size=(3, 3))
    return C / np.abs(C).max()


@functools.cache
def statement(form):
    return cvxpy_models.statement(form)


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("form", RelaxationForm)
@pytest.mark.parametrize("seed", range(8))
def test_the_direct_call_gives_what_cvxpy_gives(form, seed):
    C = scaled_matrix(np.random.default_rng(seed))
    said = statement(form)
    said.data.value = C
    reference = said.problem.solve(solver="CLARABEL")
    found = solve(form, C)

    assert said.problem.is_dcp(dpp=True)
    assert found.status is RelaxationStatus.SOLVED
    assert found.value == pytest.approx(reference, abs=ACCURACY)
    multiplier = float(said.problem.constraints[0].dual_value)
    assert found.multiplier == pytest.approx(multiplier, abs=ACCURACY)
    assert np.abs(found.matrix - said.matrix.value).max() < 1e-5


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("form", RelaxationForm)
@pytest.mark.parametrize("solver", ["SCS", "clarabel"])
def test_a_solver_that_is_named_gives_what_clarabel_gives_directly(form, solver):
    """SCS splits, where Clarabel follows the central path: one is a witness of the other."""
    C = scaled_matrix(np.random.default_rng(11))
    direct, found = solve(form, C), cvxpy_models.solve_stated(statement(form), C, solver)

    assert (found.status, found.said) == (RelaxationStatus.SOLVED, "optimal")
    assert found.value == pytest.approx(direct.value, abs=ACCURACY)
    assert found.multiplier == pytest.approx(direct.multiplier, abs=ACCURACY)
    assert np.abs(found.matrix - direct.matrix).max() < 1e-5


@pytest.mark.slow
def test_the_named_solver_of_certify_stands_in_the_result(data):
    clouds = (data / "survey_source.csv", data / "survey_target.csv")
    run = commands.certreg("certify", *clouds, "--no-simulation", "--solver", "scs", "--json")
    relaxation = run.document["relaxation"]

    assert (run.code, relaxation["solver"], relaxation["status"]) == (0, "SCS", "optimal")
    assert relaxation["rank"] == 1
    assert relaxation["angle_to_pose_deg"] < 1e-3


def test_a_solver_that_cannot_solve_it_leaves_the_relaxation_out_and_others_are_one_line(data):
    clouds = (data / "survey_source.csv", data / "survey_target.csv")
    unfit = commands.certreg("certify", *clouds, "--no-simulation", "--solver", "SCIPY", "--json")
    unknown = commands.certreg("certify", *clouds, "--solver", "NONESUCH")
    both = commands.certreg("certify", *clouds, "--solver", "SCS", "--no-relaxation")

    assert (unfit.code, unfit.document["relaxation"]) == (0, None)
    assert "The solver did not solve the relaxation" in unfit.out
    assert (unknown.code, unknown.err.count("\n")) == (2, 1)
    assert "CVXPY finds no solver 'NONESUCH': it finds " in unknown.err
    assert both.code == 2
    assert "--no-relaxation leaves out" in both.err


@pytest.mark.parametrize("form", RelaxationForm)
@pytest.mark.parametrize("seed", range(8))
def test_the_solution_satisfies_the_optimality_conditions(form, seed):
    """Z >= 0, feasible, and of the value claimed; the multiplier makes nu I - K >= 0."""
    C = scaled_matrix(np.random.default_rng(seed))
    program = quadratic_program(form, C.tolist())
    found = solve(form, C)
    Z, F = found.matrix, np.array(program.objective)

    assert np.linalg.eigvalsh(Z)[0] > -ACCURACY
    assert (np.array(program.normalisation) * Z).sum() == pytest.approx(1, abs=ACCURACY)
    for A in program.quadratics:
        assert (np.array(A) * Z).sum() == pytest.approx(0, abs=ACCURACY)
    assert (F * Z).sum() == pytest.approx(program.multiple * found.value, abs=ACCURACY)
    if form is RelaxationForm.QUATERNION:
        slack = found.multiplier * np.eye(4) - F
        assert np.linalg.eigvalsh(slack)[0] == pytest.approx(0, abs=ACCURACY)


@pytest.mark.parametrize("form", RelaxationForm)
def test_a_solve_leaves_no_trace_in_the_next(form):
    first, other = (scaled_matrix(np.random.default_rng(seed)) for seed in (1, 2))
    before = solve(form, first)
    solve(form, other)
    after = solve(form, first)

    assert (before.value, before.multiplier) == (after.value, after.multiplier)
    assert np.array_equal(before.matrix, after.matrix)


@pytest.mark.parametrize("form", RelaxationForm)
def test_a_solver_that_fails_is_a_status_without_numbers(form, monkeypatch):
    monkeypatch.setattr(conic, "MAX_ITERATIONS", 1)
    moments = exact_moments(strategies.random_problem(np.random.default_rng(0)))
    found = relaxed(moments, form)

    assert (found.status, found.solver_word) == (RelaxationStatus.FAILED, "MaxIterations")
    assert (found.value, found.multiplier, found.rank) == (None, None, None)
    assert found.quaternion_wxyz is None
    assert found.proposal is None


def test_a_solver_that_stops_short_says_so(monkeypatch):
    monkeypatch.setattr(conic, "GAP_TOLERANCE", 1e-14)
    monkeypatch.setattr(conic, "FEASIBILITY_TOLERANCE", 1e-14)
    moments = exact_moments(strategies.random_problem(np.random.default_rng(0)))
    found = relaxed(moments, RelaxationForm.ROTATION)

    assert (found.status, found.solver_word) == (RelaxationStatus.INACCURATE, "AlmostSolved")
    assert found.value is not None


def test_a_named_solver_that_stops_short_says_so(monkeypatch):
    first, second = (SimpleNamespace(dual_value=value) for value in (3.0, 7.0 * np.eye(4)))
    asked: dict[str, Any] = {}
    solved = SimpleNamespace(
        status="optimal_inaccurate", value=2.0, constraints=[first, second], solve=asked.update
    )
    parts = SimpleNamespace(value=np.eye(4))
    program = cvxpy_models.StatedProgram(problem=solved, data=parts, matrix=parts)
    errors = SimpleNamespace(SolverError=ValueError)
    modelling = SimpleNamespace(installed_solvers=lambda: ["SCS"], error=errors)
    monkeypatch.setattr(cvxpy_models, "library", lambda *_: modelling)

    found = cvxpy_models.solve_stated(program, np.eye(3), "scs")

    assert (found.status, found.said) == (RelaxationStatus.INACCURATE, solved.status)
    assert (found.value, found.multiplier) == (2.0, 3.0)
    assert asked == {"solver": "SCS", **cvxpy_models.OPTIONS["SCS"]}


def test_a_solver_that_is_not_installed_is_a_status(monkeypatch):
    moments = exact_moments(strategies.random_problem(np.random.default_rng(0)))
    monkeypatch.setitem(sys.modules, "clarabel", None)
    found = relaxed(moments)
    monkeypatch.undo()

    assert found.status is RelaxationStatus.UNAVAILABLE
    assert found.value is None
    assert found.reason == found.solver_word
    assert "pip install clarabel" in found.reason  # and not that it could not be loaded
    assert relaxed(moments).status is RelaxationStatus.SOLVED


@pytest.mark.parametrize("form", RelaxationForm)
def test_where_c_is_zero_a_missing_or_failing_solver_is_what_is_named(form, monkeypatch):
    moments = exact_moments(next(each.problem for each in strategies.ZOO if each.pattern == (4,)))
    assert relaxed(moments, form).status is RelaxationStatus.DEGENERATE
    with monkeypatch.context() as patched:
        patched.setattr(conic, "MAX_ITERATIONS", 1)
        assert relaxed(moments, form).status is RelaxationStatus.FAILED
    monkeypatch.setitem(sys.modules, "clarabel", None)

    assert relaxed(moments, form).status is RelaxationStatus.UNAVAILABLE


def test_a_solver_is_named_with_its_version_where_it_has_one(monkeypatch):
    assert conic.solver_name().startswith("Clarabel 0.")

    monkeypatch.setattr(conic, "SOLVER", "Nonesuch")
    assert conic.solver_name() == "Nonesuch"


def test_statuses_are_sentences():
    words = [status.value for status in RelaxationStatus]

    assert all(sentence[0].isupper() and sentence.endswith(".") for sentence in words)


@pytest.mark.slow
def test_nothing_is_printed_or_warned_and_nothing_is_loaded_before_it_is_used():
    code = (
        "import sys, numpy as np\n"
        "from certreg import RegistrationProblem\n"
        "from certreg.problem.moments import exact_moments\n"
        "from certreg.objective.isotropic import Isotropic\n"
        "from certreg.relaxation.shor import relax\n"
        "assert not {'cvxpy', 'clarabel', 'scipy'} & set(sys.modules)\n"
        "objective = Isotropic(exact_moments(RegistrationProblem(np.eye(3), np.eye(3))))\n"
        "assert relax(objective).rank == relax(objective, 'rotation-10').rank == 1\n"
        "assert 'cvxpy' not in sys.modules\n"
    )
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        check=False,
        cwd=PACKAGE.parent,
        encoding="utf-8",
    )

    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")


@pytest.mark.slow
def test_one_module_knows_the_solver_and_none_of_the_programs_knows_equilibria_or_proofs():
    """The search for the optimum of general springs takes the paths to all equilibria beside."""
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        names_them = {"cvxpy", "clarabel"} & set(re.findall(r"\w+", text))
        if path.parent.name != "relaxation" and not names_them:
            continue  # nothing of interest to parse
        names = [
            alias if isinstance(node, ast.Import) else node.module or ""
            for node in nodes(text)
            if isinstance(node, (ast.Import, ast.ImportFrom))
            for alias in [node.names[0].name]
        ]
        if path.name != "conic.py":
            assert not {name.split(".")[0] for name in names} & {"cvxpy", "clarabel"}, path
        if path.parent.name == "relaxation" and path.name != "optimum.py":
            assert not [n for n in names if n.startswith(("certreg.equilibrium", "certreg.cert"))]


# The relaxation of a problem


def truth(moments):
    """The largest eigenvalue of K to 200 bits, in units of tr(R^T C), and how far off it may be."""
    found = Isotropic(moments)
    unit = power_of_two(found.shift - found.eigenspaces.bits) * moments.cross_unit
    return found.eigenspaces.spaces[0].value * unit, (1 << 12) * unit


def suboptimality(moments, quaternion):
    """(l_1 - q^T K q) over the size of C."""
    q = lift(quaternion).integers
    largest = max(abs(entry) for row in moments.cross for entry in row) * moments.cross_unit
    return float((truth(moments)[0] - Isotropic(moments).alignment(q)) / (largest or 1))


@pytest.mark.parametrize("form", RelaxationForm)
@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_value_rank_and_rotation_are_those_of_the_row(form, specimen):
    moments = exact_moments(specimen.problem)
    found = relaxed(moments, form)
    m = specimen.pattern[0]

    degenerate = specimen.pattern == (4,)
    assert found.status is (RelaxationStatus.DEGENERATE if degenerate else RelaxationStatus.SOLVED)
    assert found.rank == (m if form is RelaxationForm.QUATERNION else m * (m + 1) // 2)
    assert abs(Fraction(found.value) - truth(moments)[0] / found.unit) < ACCURACY
    assert suboptimality(moments, found.quaternion_wxyz) < ACCURACY
    assert np.linalg.norm(found.quaternion_wxyz) == pytest.approx(1, abs=1e-14)
    assert next(entry for entry in found.quaternion_wxyz if entry) > 0


@pytest.mark.parametrize("form", RelaxationForm)
def test_the_optimal_rotations_span_as_many_dimensions_as_the_rank_of_the_rotation_form(form):
    """m of the quaternions, m (m + 1) / 2 of the vectors (1, vec R): exactly, by integers."""
    for m in (1, 2, 3, 4):
        members = [q + (0,) * (4 - m) for q in itertools.product(range(-1, 2), repeat=m) if any(q)]
        if form is RelaxationForm.ROTATION:
            members = [homogeneous(rotation_matrix(q), unit=squared_norm(q)) for q in members]
        assert rank_modulo([list(v) for v in members], 101) == (
            m if form is RelaxationForm.QUATERNION else m * (m + 1) // 2
        )


@pytest.mark.parametrize("form", RelaxationForm)
@pytest.mark.parametrize("exponent", [-565, -300, 300, 664])  # 1e-170 to 1e200
def test_a_power_of_two_as_scale_changes_the_unit_and_nothing_else(form, exponent):
    problem = strategies.random_problem(np.random.default_rng(3), noise=0.1)
    x, y = (np.ldexp(np.round(np.ldexp(p, 20)), -20) for p in (problem.source, problem.target))
    here = relaxed(exact_moments(RegistrationProblem(x, y)), form)
    factor = 2.0**exponent
    there = relaxed(exact_moments(RegistrationProblem(x * factor, y * factor)), form)

    assert (there.value, there.multiplier, there.rank) == (here.value, here.multiplier, here.rank)
    assert np.array_equal(there.quaternion_wxyz, here.quaternion_wxyz)
    assert there.unit == here.unit * Fraction(2) ** (2 * exponent)


@pytest.mark.slow
@hypothesis_settings(max_examples=60)
@given(strategies.problems(), st.sampled_from(RelaxationForm))
def test_every_problem_is_solved_to_the_accuracy_of_the_solver(problem, form):
    moments = exact_moments(problem)
    found = relaxed(moments, form)

    assert found.status in {RelaxationStatus.SOLVED, RelaxationStatus.DEGENERATE}
    assert abs(Fraction(found.value) - truth(moments)[0] / found.unit) < ACCURACY
    assert suboptimality(moments, found.quaternion_wxyz) < ACCURACY


def test_only_the_quaternion_form_has_a_multiplier():
    moments = exact_moments(strategies.random_problem(np.random.default_rng(0)))

    assert relaxed(moments).multiplier is not None
    assert relaxed(moments, "rotation-10").multiplier is None


def test_an_unknown_form_is_refused():
    moments = exact_moments(strategies.random_problem(np.random.default_rng(0)))

    with pytest.raises(ValueError, match=r"matrix-9.*quaternion-4, rotation-10"):
        relaxed(moments, "matrix-9")


# The proved multiplier


@pytest.mark.slow
@hypothesis_settings(max_examples=60)
@given(strategies.problems())
def test_the_proved_multiplier_is_above_the_largest_eigenvalue_and_bounds_the_gap(problem):
    moments = exact_moments(problem)
    found = relaxed(moments)
    largest, error = truth(moments)
    nu = proved_multiplier(Isotropic(moments), found.proposal)

    assert nu is not None
    assert nu.value > largest - error
    assert nu.mantissa.bit_length() <= MULTIPLIER_BITS + 1
    q = lift(found.quaternion_wxyz).integers
    gap = multiplier_gap(Isotropic(moments), q, nu)
    minimum = Isotropic(moments).energy(Isotropic(moments).quaternions[0])
    assert Isotropic(moments).energy(q) - minimum < gap
    assert gap <= Fraction(1, 10**6) * (moments.spread or found.unit)


@pytest.mark.slow
@given(strategies.problems(), st.integers(-180, 0), st.booleans())
def test_no_number_below_the_largest_eigenvalue_is_ever_proved(problem, exponent, above):
    moments = exact_moments(problem)
    largest, error = truth(moments)
    distance = Fraction(2) ** exponent * (largest or 1)
    nu = largest + distance if above else largest - distance

    if distance > error:
        assert proves_multiplier(Isotropic(moments), nu) == above
    proved = proved_multiplier(Isotropic(moments), nu)
    assert proved is None or proved.value > largest - error


@pytest.mark.parametrize("decades", [2, 5, 8, 12, 60])
@pytest.mark.parametrize("side", [1, -1])
def test_the_multiplier_is_the_first_step_of_all_that_is_proved(decades: int, side: int):
    objective = Isotropic(exact_moments(strategies.random_problem(np.random.default_rng(1))))
    best = objective.alignment(objective.quaternions[0])
    proposal = best + side * best / 10**decades
    first = objective.size * power_of_two(-FIRST_STEP_BITS)
    steps = [Fraction(0), *(first * power_of_two(STEP_GROWTH_BITS * k) for k in range(STEPS))]
    numbers = [dyadic_above(proposal + step, MULTIPLIER_BITS) for step in steps]
    expected = next((nu for nu in numbers if proves_multiplier(objective, nu.value)), None)

    assert proved_multiplier(objective, proposal) == expected


def test_the_gap_is_the_energy_above_what_the_multiplier_leaves_for_the_minimum():
    moments = exact_moments(strategies.random_problem(np.random.default_rng(0), noise=1.0))
    nu, q = Dyadic(mantissa=12345, exponent=-3), (1, -2, 3, 4)

    left = moments.spread - 2 * nu.value
    assert multiplier_gap(Isotropic(moments), q, nu) == Isotropic(moments).energy(q) - left


def test_where_c_is_zero_the_gap_is_small_beside_the_spread_however_far_the_coordinates():
    """A single source point at 1e100, targets spread over 1e-100: all that varies is tiny."""
    source = np.full((4, 3), 1e100)
    target = np.array(strategies.TETRAHEDRON) * 1e-100
    moments = exact_moments(RegistrationProblem(source, target))
    found = relaxed(moments)
    nu = proved_multiplier(Isotropic(moments), found.proposal)

    assert found.status is RelaxationStatus.DEGENERATE
    assert nu is not None
    assert (
        0
        < multiplier_gap(Isotropic(moments), (1, 0, 0, 0), nu)
        < Fraction(1, 10**6) * moments.spread
    )


def test_a_proposal_far_too_small_is_not_proved_and_one_too_large_is_taken():
    moments = exact_moments(strategies.random_problem(np.random.default_rng(0)))
    largest, _ = truth(moments)

    assert proved_multiplier(Isotropic(moments), largest / 2) is None
    assert proved_multiplier(Isotropic(moments), -largest) is None
    generous = proved_multiplier(Isotropic(moments), 2 * largest)
    assert generous is not None
    assert 2 * largest <= generous.value <= 2 * largest * (1 + Fraction(1, 2**38))


@pytest.mark.slow
def test_what_the_solver_returns_is_below_the_truth_in_a_considerable_share_of_runs():
    """Why value and multiplier are not called bounds."""
    rng = np.random.default_rng(0)
    value, multiplier, runs = 0, 0, 60
    for _ in range(runs):
        moments = exact_moments(
            strategies.random_problem(rng, noise=float(rng.choice([0, 0.1, 1])))
        )
        found = relaxed(moments)
        largest, _ = truth(moments)
        value += Fraction(found.value) * found.unit < largest
        multiplier += found.proposal < largest

    assert value > runs // 4
    assert multiplier > runs // 4


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ((1.0, 0.0, 0.0, 0.0), 1),
        ((1.0, 0.99e-4, 1e-6, 0.0), 1),
        ((1.0, 1.01e-4, 0.99e-4, -1e-9), 2),
        ((1.0, 0.2, 1.01e-4, 1.01e-4), 4),
        ((0.25, 0.25, 0.25, 0.25), 4),
    ],
)
def test_the_rank_counts_eigenvalues_above_a_share_of_the_largest(values, expected, scale):
    """Whatever the unit of Z: 1e-4, far above the solver's tolerance of 1e-8."""
    turn = np.linalg.qr(np.random.default_rng(7).normal(size=(4, 4)))[0]
    matrix = scale * (turn * values) @ turn.T

    assert conic.rank_and_quaternion(matrix, lambda top: top)[0] == expected
