from __future__ import annotations

import itertools
import math
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st
from rotations import turned

import certreg
from certreg import RegistrationProblem
from certreg.equilibrium import equilibrium_set
from certreg.equilibrium.critical_set import Completeness, Critical, CriticalSet, by_eigenspaces
from certreg.equilibrium.stability import DIGITS, Curvature, _oscillator, _signed, spring_ratios
from certreg.exact.eigenbasis import integer_eigenbasis
from certreg.geometry.so3 import (
    angle_between,
    davenport_matrix,
    dot,
    quaternion_from_matrix,
    quaternion_of_rotation,
    rotation_matrix,
)
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments, floating_moments
from certreg.registration.closed_form import arun, horn
from certreg.results import Guarantee

PATTERNS = sorted({s.pattern for s in strategies.ZOO})


def centred(problem):
    w = problem.weights[:, None]
    x = problem.source - (w * problem.source).sum(0) / w.sum()
    y = problem.target - (w * problem.target).sum(0) / w.sum()
    return w, x, y


@pytest.mark.slow
@given(strategies.problems())
def test_forces_and_torques_balance_point_by_point_at_every_component(problem):
    w, x, y = centred(problem)
    # the rounding of the centring is relative to the coordinates as they were given
    scale = w.sum() * np.abs(problem.source).max() * np.abs(problem.target).max()

    for component in certreg.equilibria(problem).components:
        torque = np.cross(x, w * (y @ component.rotation)).sum(axis=0)
        assert np.abs(torque).max() <= 1e-12 * scale


@pytest.mark.slow
@given(strategies.problems())
def test_components_are_mutually_orthogonal_eigenspaces_that_fill_the_space(problem):
    basis = np.hstack([c.basis for c in certreg.equilibria(problem).components])

    assert np.abs(basis.T @ basis - np.eye(4)).max() < 1e-14


@pytest.mark.parametrize("times", [1.0, 2.0])
def test_the_margin_is_that_of_the_eigenvalues(times: float):
    """C = b diag(18, 8, 2): eigenvalues b (28, 8, -12, -24), and energies twice as far apart.

    The best is 28 (b - 1)^2, not 0 where the target is larger.
    """
    cloud = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])])
    found = certreg.equilibria(RegistrationProblem(cloud, times * cloud))
    energies = 28.0 * (times - 1.0) ** 2 + times * np.array([0.0, 40.0, 80.0, 104.0])

    assert found.margin.eigenvalue_gap == pytest.approx(20.0 * times)
    assert found.margin.relative == pytest.approx(20.0 / 52.0)
    assert [c.energy for c in found.components] == pytest.approx(energies, abs=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_difference_too_small_for_doubles_keeps_its_sign(sign):
    assert equilibrium_set._nonzero(sign, 10**400) == sign * 5e-324
    assert equilibrium_set._nonzero(sign * 3, 4) == sign * 0.75
    assert equilibrium_set._nonzero(0, 10**400) == 0.0


@pytest.mark.parametrize("g", [1e-2, 1e-8, 1e-14, 1e-30, -1e-14, -3.0, 0.0])
def test_the_slow_root_of_an_oscillator_has_all_its_digits(g):
    """s^2 + mu s + g = 0 with two real roots: their product is g, their sum -mu."""
    fast, slow = _oscillator(g, 2.8)

    assert fast * slow == pytest.approx(g, rel=1e-15, abs=0.0)
    assert (fast + slow).real == pytest.approx(-2.8, rel=1e-15)
    assert abs(fast) > abs(slow)


@pytest.mark.parametrize(("margin", "near"), [(0.999e-3, True), (1e-3, False), (0.0, True)])
def test_an_optimum_is_nearly_ambiguous_below_a_thousandth_of_the_range(margin, near):
    found = certreg.equilibria(strategies.ZOO[0].problem)
    narrow = replace(found, margin=replace(found.margin, relative=margin))
    several = certreg.equilibria(strategies.ZOO[-1].problem)

    assert narrow.nearly_ambiguous == near
    assert several.margin.relative == several.margin.eigenvalue_gap == 0.0
    assert not several.nearly_ambiguous


def test_rates_that_rounding_would_drown_are_not_given():
    """G = diag(1, 1, 10^-e) and J = diag(1, 10^-c, 10^-c): the digits left are 16 - c - e - c."""

    def rates(c: int, e: int) -> list[float] | None:
        at = Curvature(values=np.array([1.0, 1.0, 10.0**-e]), directions=np.eye(3))
        return spring_ratios([at], np.diag([1.0, 10.0**-c, 10.0**-c]))[0]

    assert rates(2, 2) == pytest.approx([1.0, 1.0, 100.0])
    assert rates(4, 2) == pytest.approx([1.0, 100.0, 10_000.0])
    assert rates(4, 8) is None
    assert rates(9, 9) is None


@pytest.mark.slow
@given(strategies.problems())
def test_energy_rises_with_the_index_and_the_optimum_comes_first(problem):
    found = certreg.equilibria(problem)
    rmse = [c.rmse for c in found.components if c.rmse is not None]
    indices = [c.morse_index for c in found.components]

    assert rmse == sorted(rmse)
    assert len(rmse) == len(indices)
    assert indices == sorted(set(indices))
    assert [c.optimal for c in found.components] == [True] + [False] * (len(indices) - 1)


@pytest.mark.slow
@given(strategies.problems())
def test_spurious_components_are_half_a_turn_from_the_optimum(problem):
    angles = [np.degrees(c.angle_to_optimum) for c in certreg.equilibria(problem).components]

    assert angles[0] == 0.0
    assert np.allclose(angles[1:], 180.0, rtol=0, atol=1e-12)


def test_every_pair_of_the_four_equilibria_is_half_a_turn_apart():
    problem = strategies.random_problem(np.random.default_rng(8), noise=0.5)
    quaternions = [c.quaternion_wxyz for c in certreg.equilibria(problem).components]

    for p, q in itertools.combinations(quaternions, 2):
        assert abs(np.degrees(angle_between(p, q)) - 180) < 1e-13


@pytest.mark.slow
@given(strategies.problems(), st.integers(0, 2**32 - 1))
def test_energies_do_not_change_under_a_common_rigid_motion(problem, seed):
    """A rotation by quarter turns and a swap of signs: exact in doubles."""
    rng = np.random.default_rng(seed)
    signs = rng.choice([-1.0, 1.0], size=3)
    permutation = np.eye(3)[rng.permutation(3)] * signs
    permutation *= np.round(np.linalg.det(permutation))
    moved = RegistrationProblem(
        problem.source @ permutation.T, problem.target @ permutation.T, weights=problem.weights
    )

    for a, b in zip(
        certreg.equilibria(problem).components, certreg.equilibria(moved).components, strict=True
    ):
        assert (a.energy, a.rmse, a.kind, a.morse_index) == (
            b.energy,
            b.rmse,
            b.kind,
            b.morse_index,
        )


@pytest.mark.parametrize("pattern", PATTERNS, ids=str)
def test_energy_is_the_sum_of_weighted_squared_distances_at_the_pose(pattern):
    problem = next(s for s in strategies.ZOO if s.pattern == pattern).problem
    w, x, y = centred(problem)

    for component in certreg.equilibria(problem).components:
        direct = (w * (y - x @ component.rotation.T) ** 2).sum()
        assert component.energy == pytest.approx(direct, rel=1e-13, abs=1e-13)
        assert component.rmse == pytest.approx(np.sqrt(direct / w.sum()), rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("pattern", PATTERNS, ids=str)
def test_the_whole_component_has_the_same_energy(pattern):
    problem = next(s for s in strategies.ZOO if s.pattern == pattern).problem
    w, x, y = centred(problem)
    rng = np.random.default_rng(1)

    for component in certreg.equilibria(problem).components:
        coefficients = rng.normal(size=component.basis.shape[1])
        q = component.basis @ (coefficients / np.linalg.norm(coefficients))
        from certreg.geometry.so3 import rotation_matrix

        R = np.array(rotation_matrix(q.tolist()))
        assert (w * (y - x @ R.T) ** 2).sum() == pytest.approx(component.energy, abs=1e-12)


def linearisation(problem, R, damping):
    """The 12x12 Jacobian by differences of forces summed point by point: no moments, no K."""
    w, x, y = centred(problem)
    J = sum(m * (v @ v * np.eye(3) - np.outer(v, v)) for m, v in zip(w[:, 0], x, strict=True))
    mass = w.sum()

    def motion(state):
        c, phi, v, omega = state[:3], state[3:6], state[6:9], state[9:]
        Q = turned(R, phi)
        force = 2 * w * (y - x @ Q.T - c) - damping * w * (np.cross(omega, x) @ Q.T + v)
        torque = np.cross(x, force @ Q).sum(axis=0)
        return np.concatenate(
            [
                v,
                omega,
                force.sum(axis=0) / mass,
                np.linalg.solve(J, torque - np.cross(omega, J @ omega)),
            ]
        )

    step = 1e-5
    columns = [(motion(step * e) - motion(-step * e)) / (2 * step) for e in np.eye(12)]
    return np.array(columns).T


@pytest.mark.parametrize("damping", [0.3, 2.0, np.sqrt(8)])
def test_the_twelve_eigenvalues_are_those_of_the_point_wise_dynamics(damping):
    problem = strategies.random_problem(np.random.default_rng(4), n=7, noise=0.3)
    problem = RegistrationProblem(problem.source, problem.target, damping=damping)

    for component in certreg.equilibria(problem).components:
        expected = np.linalg.eigvals(linearisation(problem, component.rotation, damping))
        found = component.eigenvalues
        assert found is not None
        assert (found.real > 1e-9).sum() == component.unstable_eigenvalues == component.morse_index
        distance = np.abs(expected[:, None] - found[None, :])
        # each has a partner; defective double eigenvalues move by the root of the difference error
        assert distance.min(axis=0).max() < 1e-4
        assert distance.min(axis=1).max() < 1e-4


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_unstable_eigenvalues_are_as_many_as_the_index_in_every_row(specimen):
    found = certreg.equilibria(specimen.problem)
    for component in found.components:
        assert (component.eigenvalues is None) != found.classification.inertia_definite
        if component.eigenvalues is not None:
            zeros = (component.eigenvalues == 0).sum()
            assert (component.eigenvalues.real > 0).sum() == component.unstable_eigenvalues
            assert zeros == component.kind.dimension


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_the_curvature_is_the_hessian_of_the_energy_at_every_component(specimen):
    """G = 2 tr(R^T C) I - R^T C - C^T R, in orthonormal directions."""
    w, x, y = centred(specimen.problem)
    C = (w * y).T @ x
    objective = Isotropic(exact_moments(specimen.problem))
    critical = by_eigenspaces(objective)
    unit = float(objective.moments.cross_unit) * 2.0**objective.shift
    frame = equilibrium_set._Frame.of(critical, objective)
    for k, part in enumerate(critical.components):
        aligned = equilibrium_set.rotation_double(part.quaternion).T @ C
        hessian = 2 * np.trace(aligned) * np.eye(3) - aligned - aligned.T
        found = equilibrium_set._curvature(frame, k)

        assert np.abs(unit * found.matrix - hessian).max() <= 1e-13 * max(1.0, np.abs(C).max())
        assert np.abs(found.directions.T @ found.directions - np.eye(3)).max() < 1e-14


def test_gaps_below_the_doubles_keep_their_signs():
    """C = diag(1, 10^-400, 9 10^-400): the relative margin is below the least double."""
    cloud = np.diag([1.0, 1e-200, 3e-200])
    cloud = np.vstack([cloud, -cloud])
    found = certreg.equilibria(RegistrationProblem(cloud, cloud))

    assert 0.0 < found.margin.relative < 1e-300
    assert [c.witness is None for c in found.components] == [True, False, False, False]


@pytest.mark.slow
@given(strategies.problems())
def test_turning_about_the_witness_lowers_the_energy(problem):
    w, x, y = centred(problem)
    scale = float(np.abs(x).max() * np.abs(y).max())
    if not 1e-200 < scale < 1e200:
        return
    C = (y * (w / w.max())).T @ x / scale

    for component in certreg.equilibria(problem).components:
        assert (component.witness is None) == component.optimal
        if component.witness is None or certreg.equilibria(problem).margin.relative < 1e-6:
            continue
        assert np.linalg.norm(component.witness) == pytest.approx(1.0)
        before = np.trace(component.rotation.T @ C)
        after = np.trace(turned(component.rotation, 1e-2 * component.witness).T @ C)
        assert after > before


@given(st.lists(st.integers(-(10**9), 10**9), min_size=9, max_size=9), st.sampled_from([128, 400]))
def test_the_eigenbasis_satisfies_its_equation_to_its_last_bits(entries, bits):
    K = davenport_matrix([entries[:3], entries[3:6], entries[6:]])
    basis = integer_eigenbasis(K, bits)

    for k, (value, vector) in enumerate(zip(basis.values, basis.vectors, strict=True)):
        for row, entry in zip(K, vector, strict=True):
            residual = (dot(row, vector) << bits) - (value * entry << basis.shift)
            assert abs(residual) < 1 << (bits + basis.shift + 10)
        for other in basis.vectors[:k]:
            assert abs(dot(vector, other)) < 1 << (bits + 8)


@pytest.mark.parametrize("exponent", [20, 60, 150, 400])
def test_nearly_equal_eigenvalues_are_told_apart_however_close(exponent):
    """d2 + d3 = 2^-exponent relative: double precision sees one eigenvalue beyond 2^-52."""
    tiny = 2.0**-exponent
    axes = np.array(strategies.AXES)
    mirrored = axes * [1, 1, -1]
    source = np.vstack([axes, [[0, tiny, 0], [0, -tiny, 0]]])
    target = np.vstack([mirrored, [[0, 1, 0], [0, -1, 0]]])
    source[2:4, 1], target[2:4, 1] = [1.0, -1.0], [1.0, -1.0]  # C = diag(18, 2 + 2 tiny, -2)
    problem = RegistrationProblem(source, target)

    found = certreg.equilibria(problem)
    assert found.classification.pattern == (1, 1, 1, 1)
    assert found.margin.relative == pytest.approx(2 * tiny / 20, rel=1e-6)
    assert certreg.certify(problem).status.value == "certified"


@pytest.mark.one_in(4)
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("mirrored", [False, True])
def test_horn_and_arun_agree_with_each_other_and_with_the_spectrum(seed, mirrored):
    rng = np.random.default_rng(seed)
    problem = strategies.random_problem(rng, noise=0.1)
    if mirrored:
        problem = RegistrationProblem(problem.source * [1, 1, -1], problem.target)
    moments = floating_moments(problem)
    optimum = certreg.equilibria(problem).components[0].quaternion_wxyz
    margin = certreg.equilibria(problem).margin.relative

    assert angle_between(horn(moments.cross_covariance), optimum) < 1e-14 / margin
    assert angle_between(arun(moments.cross_covariance), optimum) < 1e-14 / margin


def test_without_the_determinant_rule_a_mirrored_cloud_would_give_a_reflection():
    specimen = next(s for s in strategies.ZOO if s.name == "mirrored axes")
    C = floating_moments(specimen.problem).cross_covariance
    u, _, vt = np.linalg.svd(C)

    assert np.linalg.det(u @ vt) == pytest.approx(-1.0)
    assert arun(C).shape == (4,)


def test_the_representative_of_a_continuum_is_the_least_rotation():
    """Collinear source along x, target along x: every turn about x fits, the identity is least."""
    line = [[0.0, 0, 0], [1, 0, 0], [3, 0, 0]]
    component = certreg.equilibria(RegistrationProblem(line, line)).components[0]

    assert np.array_equal(component.rotation, np.eye(3))


def test_quaternions_and_matrices_go_back_and_forth():
    rng = np.random.default_rng(2)
    for _ in range(50):
        R = strategies.random_rotation(rng)
        for found in (quaternion_from_matrix, quaternion_of_rotation):
            q = found(R)

            assert np.abs(np.array(rotation_matrix(q.tolist())) - R).max() < 1e-14
            assert next(entry for entry in q if entry) > 0.0


def test_half_turns_have_quaternions():
    for q in ([0.0, 0.6, -0.8, 0.0], [0.0, 0.0, 0.6, 0.8], [0.0, 0.0, 0.0, 1.0], [0.5] * 4):
        R = np.array(rotation_matrix(q))

        assert quaternion_of_rotation(R) == pytest.approx(q, abs=1e-15)


def test_the_working_precision_grows_only_where_it_must():
    generic = exact_moments(strategies.random_problem(np.random.default_rng(0)))

    assert Isotropic(generic).eigenspaces.bits == 192


def test_signs_are_told_where_no_ratio_is_within_rounding_of_zero():
    least = 4.0 * (2.0**-20) * DIGITS

    def signed(*ratios: float) -> list[float] | None:
        gaps = np.sign(np.array(ratios))
        return _signed(list(ratios), SimpleNamespace(values=gaps), 2.0**-20)  # pyright: ignore[reportArgumentType]

    past = math.nextafter(least, 1e9)
    assert signed(-4.0, -past, past) == [-4.0, -past, past]
    assert signed(-4.0, -past, 0.0) == [-4.0, -past, 0.0]
    assert signed(-4.0, -least, past) is None
    assert signed(-4.0, -past, least) is None
    assert signed(-past, least, 4.0) is None
    assert signed(-4.0, -3.0, -least) is None


@pytest.mark.parametrize("parts", [*itertools.permutations(Guarantee)])
def test_a_set_is_as_sure_as_its_least_sure_component(parts: tuple[Guarantee, ...]):
    components = tuple(
        Critical(
            quaternion=(1, 0, 0, 0), span=(), value=Fraction(0), index=None, guarantee=guarantee
        )
        for guarantee in parts
    )
    for some in (components, components[:2]):
        found = CriticalSet(
            method="any", components=some, bits=0, completeness=Completeness.CONSTANT
        )
        assert found.guarantee is Guarantee(min(part.guarantee.value for part in some))
