"""Steps, units and notes of a run: beside what they are defined by, on both sides of each limit."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from rotations import saddle_start
from strategies import ZOO, random_problem

from certreg.dynamics import integrators, trajectory
from certreg.dynamics.batch import bodies_of, simulate_many
from certreg.dynamics.body import (
    SMALLEST_BARRIER,
    SMALLEST_INERTIA,
    basins_of,
    certified_basin,
    clearly_thick,
    exponent_of,
    require_thick,
)
from certreg.dynamics.integrators import (
    EULER_STEP,
    SimulationSettings,
    spring_ratios,
    step_parameters,
)
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.simulation import optimal_damping, simulate
from certreg.dynamics.states import start_at_rest, state_at_rest
from certreg.errors import DegenerateProblemError
from certreg.geometry.so3 import rotation_matrix
from certreg.native.layout import BODY, symmetric
from certreg.native.loops import Integrator
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

ANY_STEP = SimulationSettings(least_step=0.0)


def objective_of(problem: RegistrationProblem) -> Isotropic:
    return Isotropic(exact_moments(problem))


def steps_of(objective, damping, integrator, settings=ANY_STEP):
    moving = rigid_body(objective.moments, damping)
    basin = certified_basin(objective, moving.length_exponent)
    records = moving.record[None], basin.record[None]
    return step_parameters(integrator, *records, settings)[0]


@pytest.mark.parametrize("damping", [0.05, 0.5, 2.8, 10.0, 1e3])
@pytest.mark.parametrize("noise", [0.01, 1.0])
def test_an_euler_step_is_at_most_a_quarter_of_the_largest_stable_one(damping, noise):
    """I + h A contracts a mode s where h < -2 Re(s) / |s|^2; at the optimum, all of them."""
    objective = objective_of(random_problem(np.random.default_rng(3), noise=noise))
    moving = rigid_body(objective.moments, damping)
    basin = certified_basin(objective, moving.length_exponent)
    turn = np.array(rotation_matrix(basin.optimum.tolist()))
    modes = np.linalg.eigvals(moving.intrinsic_jacobian(state_at_rest(turn)))
    largest = (-2.0 * modes.real / np.abs(modes) ** 2).min()
    h = steps_of(objective, damping, Integrator.EULER)["h"]

    assert 0.0 < h <= min(EULER_STEP, largest / 4)
    assert h == EULER_STEP or h > largest / 200


@pytest.mark.parametrize(
    ("integrator", "most"), [(Integrator.MIDPOINT, 1000.0), (Integrator.SPLITTING, 1.0)]
)
@pytest.mark.parametrize("share", [0.3, 0.99, 3.0, 999.0, 5000.0])
def test_a_step_that_is_given_is_taken_up_to_so_many_of_the_integrators_own(
    integrator, most, share
):
    objective = objective_of(random_problem(np.random.default_rng(3), noise=0.3))
    own = steps_of(objective, 2.0, integrator)["h"]
    given = SimulationSettings(step=float(share * own))

    assert steps_of(objective, 2.0, integrator, given)["h"] == pytest.approx(min(share, most) * own)


@pytest.mark.parametrize("integrator", Integrator)
@pytest.mark.parametrize(("share", "shorter"), [(0.99, False), (2500.0, True)])
def test_a_step_that_is_not_taken_as_given_is_told(integrator, share, shorter):
    objective = objective_of(random_problem(np.random.default_rng(3), noise=0.3))
    given = float(share * steps_of(objective, 2.0, integrator)["h"])
    run = simulate(objective, 2.0, integrator, settings=SimulationSettings(step=given))
    told = f"The step {given:.6g} is longer than {integrator.value} takes here: {run.step:.6g} was"

    assert (run.step < 0.9 * given) == shorter
    assert any(note.startswith(told) for note in run.notes) == shorter
    assert repr(run) == f"<Trajectory: CONVERGED after {run.steps} steps of {integrator.value}>"


LARGEST_SHARE = 1e-5 / 0.25  # of 1 / mu and mu / stiffness: a quarter of that is the least step


@pytest.mark.parametrize(
    ("damping", "widths", "size", "words"),
    [
        (1.001 / LARGEST_SHARE, (1.0, 1.0), 1.0, r"the damping 2.5e\+04 is so large"),
        (0.999 * 2 * LARGEST_SHARE, (1.0, 1.0), 1.0, "the damping 7.99e-05 is so small"),
        (2.8, (1e-4, 1e-4), 1.0, r"nearly collinear .* about its line is 2e-08 of that across it"),
        (2.8, (1.0, 1.0), 1e5, "the target is so much larger than the source"),
    ],
)
def test_what_makes_explicit_euler_too_slow_is_named(damping, widths, size, words):
    cloud = np.vstack([np.diag([1.0, *widths]), -np.diag([1.0, *widths])])
    target = size * np.vstack([np.eye(3), -np.eye(3)]) if widths[0] < 1.0 else size * cloud
    objective = objective_of(RegistrationProblem(cloud, target))
    with pytest.raises(DegenerateProblemError, match=words):
        simulate(objective, damping)


def test_of_many_bodies_the_one_that_is_too_stiff_is_named_with_its_own_numbers():
    round_cloud = np.vstack([np.eye(3), -np.eye(3)])
    thin = round_cloud * [1.0, 1e-4, 1e-4]
    bodies = bodies_of(np.array([round_cloud, thin]), np.array([round_cloud] * 2))
    with pytest.raises(DegenerateProblemError, match=r"is 2e-08 of that across it") as caught:
        simulate_many(bodies, Integrator.EULER)
    assert caught.value.instance == 1


def test_a_damping_is_taken_just_inside_what_explicit_euler_bears():
    cloud = np.vstack([np.eye(3), -np.eye(3)])
    objective = objective_of(RegistrationProblem(cloud, cloud))
    for damping in (0.999 / LARGEST_SHARE, 1.001 * 2 * LARGEST_SHARE):
        few = SimulationSettings(max_steps=1)
        assert simulate(objective, damping, settings=few).step == pytest.approx(1e-5, rel=2e-3)


def test_a_lost_state_is_tried_with_a_256th_of_the_step_and_no_less(monkeypatch):
    steps = []

    class Losing:
        def run(self, batch, rules, log=None):
            steps.append(float(batch.steps["h"][0]))

    monkeypatch.setattr(integrators, "current_engine", Losing)
    bodies = bodies_of(np.diag([1.0, 2.0, 3.0]), np.diag([1.0, 2.0, 3.0]))
    simulate_many(bodies)

    assert steps == [steps[0] / 2**k for k in range(9)]


def test_what_the_documentation_says_of_defaults_is_so():
    settings = SimulationSettings()

    assert (EULER_STEP, settings.speed_tolerance) == (0.01, 1e-4)  # [Yang2020]
    assert (settings.rest_angle, settings.first_perturbation) == (1e-3, 1e-3)
    assert (settings.max_steps, settings.least_step, settings.threads) == (1_000_000, 1e-5, 1)
    assert state_at_rest(np.eye(3)).tolist() == [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, *[0] * 6]


@pytest.mark.parametrize("damping", [1e-3, 2.0, 50.0])
def test_a_splitting_step_has_the_decay_and_the_impulse_of_its_length(damping):
    objective = objective_of(random_problem(np.random.default_rng(3), noise=0.3))
    step = steps_of(objective, damping, Integrator.SPLITTING)
    h = float(step["h"])
    moving = rigid_body(objective.moments, damping)
    basin = certified_basin(objective, moving.length_exponent)
    stiffest = spring_ratios(moving.record[None], basin.record[None]).max()

    assert h == pytest.approx(0.8 * math.sqrt(2.0 / max(2.0, stiffest)))
    assert step["decay"] == pytest.approx(math.exp(-damping * h))
    assert step["impulse"] == pytest.approx((1.0 - math.exp(-damping * h)) / damping)


@pytest.mark.parametrize("power", [-401, -40, -3, 5, 60, 399])
def test_the_unit_of_length_changes_nothing_that_moves(power):
    """Clouds times a power of two: body, basin, start and ways are the same doubles."""
    plain = random_problem(np.random.default_rng(5), offset=3.0, noise=0.2)
    scaled = RegistrationProblem(
        np.ldexp(plain.source, power), np.ldexp(plain.target, power), weights=plain.weights
    )
    one, other = objective_of(plain), objective_of(scaled)
    body, large = rigid_body(one.moments, 2.0), rigid_body(other.moments, 2.0)
    basin = certified_basin(one, body.length_exponent)
    grown = certified_basin(other, large.length_exponent)

    assert large.length_exponent == body.length_exponent + power
    assert 0.25 <= body.spread < 4.0
    for name in BODY.names or ():
        assert (large.record[name] == body.record[name]).all(), name
    assert (grown.gaps == basin.gaps).all()
    starts = [start_at_rest(o.moments, b.length_exponent) for o, b in ((one, body), (other, large))]
    assert (starts[0] == starts[1]).all()
    assert optimal_damping(other) == optimal_damping(one)


@pytest.mark.parametrize("power", [-300, 0, 300])
def test_the_bodies_of_a_batch_are_in_a_unit_near_their_size(power):
    problem = random_problem(np.random.default_rng(5), offset=3.0, noise=0.2)
    bodies = bodies_of(np.ldexp(problem.source, power), np.ldexp(problem.target, power))
    (spread,) = bodies.records["spread"]

    assert 0.25 <= spread <= 4.0
    assert abs(int(bodies.length_exponents[0]) - power) <= 3


def test_basins_are_given_down_to_the_smallest_barrier():
    values = np.array([[1.0, 0.0, -0.5, -0.5]])
    unit = np.full((1, 1), SMALLEST_BARRIER)

    assert (basins_of(np.eye(4)[None], values, 1.001 * unit)["gaps"][:, 1:] > 0.0).all()
    with pytest.raises(DegenerateProblemError, match="instance 0 differ"):
        basins_of(np.eye(4)[None], values, 0.999 * unit)
    assert SMALLEST_BARRIER * 1e-3**2 * 1e-12 > 2.0**-1022  # squares of angles, and their rounding


@pytest.mark.parametrize(("kick", "told"), [(0.49, False), (0.51, True)])
def test_kicks_are_told_of_from_half_a_radian_on(kick, told):
    objective = objective_of(random_problem(np.random.default_rng(5)))
    start = saddle_start(objective, 1, 0.0, [1.0, 0.0, 0.0])
    settings = SimulationSettings(first_perturbation=kick)
    run = simulate(objective, 2.8, Integrator.SPLITTING, start=start, settings=settings)

    assert run.escapes == 1
    most = math.ceil(math.degrees(kick))
    assert any(f"up to {most} degrees" in note for note in run.notes) == told
    assert any("1 kicks" in note for note in run.notes) == told


def test_kicks_add_up_to_what_each_of_them_turned():
    """0.03 and then ten times that, 0.3, and then one radian, the largest: 1.33 radians."""
    objective = objective_of(random_problem(np.random.default_rng(5)))
    start = saddle_start(objective, 1, 0.0, [1.0, 0.0, 0.0])
    slow = SimulationSettings(first_perturbation=0.03, max_steps=2, speed_tolerance=1e3)
    run = simulate(objective, 1e4, Integrator.SPLITTING, start=start, settings=slow)
    total = sum([0.03, 0.3, 1.0][: run.escapes])

    assert run.escapes >= 2
    assert (total > 0.5) == any(f"{math.degrees(total):.0f} degrees" in n for n in run.notes)


@pytest.mark.parametrize("specimen", ZOO[::2], ids=lambda s: s.name)
def test_a_rate_is_given_where_the_optimum_is_unique(specimen):
    objective = objective_of(specimen.problem)
    if not objective.classification.inertia_definite:
        return
    run = simulate(objective, 2.0, Integrator.SPLITTING)

    assert (run.predicted_rate is not None) == objective.classification.unique
    if run.predicted_rate is None:
        assert run.decay_rate is None
        assert run.stated("decay_rate") is run.stated("predicted_rate") is run.moving.NO_RATE


@pytest.mark.parametrize("rate", [0.2, 1.5])
def test_the_measured_rate_is_half_the_slope_of_the_energy_in_its_tail(rate):
    """Of an energy that falls twice as fast before a thousandth is left, and rests at rounding."""
    objective = objective_of(random_problem(np.random.default_rng(5), noise=0.0))
    body = rigid_body(objective.moments, 2.0)
    basin = certified_basin(objective, body.length_exponent)
    turn = np.array(rotation_matrix(basin.optimum.tolist()))
    least = float(body.energies(state_at_rest(turn))["potential"])
    times = np.arange(400.0) * 0.05 / rate
    knee = math.log(1000.0) / (4.0 * rate)
    above = np.exp(-4.0 * rate * np.minimum(times, knee) - 2.0 * rate * np.maximum(0, times - knee))
    high = (least + body.spread * np.maximum(above, 0.9e-13)) - least

    assert trajectory._decay_rate(times, high, body.spread) == pytest.approx(rate, rel=1e-3)
    first = int(np.argmax(above < 1e-3))  # four samples make a line
    assert trajectory._decay_rate(times[: first + 3], high[: first + 3], body.spread) is None
    assert trajectory._decay_rate(times[: first + 4], high[: first + 4], body.spread) is not None


def test_a_source_is_thick_where_its_determinant_says_so_and_else_by_its_eigenvalues():
    """What the quick look accepts LAPACK accepts; both sides of either limit."""
    rng = np.random.default_rng(6)
    quick = 0
    for thin in (1e-15, 0.9e-14, 1.1e-14, 1e-12, 1e-10, 4e-10, 1e-3, 1.0):
        for _ in range(8):
            turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            full = turn @ np.diag([thin, 1.0, rng.uniform(1.0, 2.0)]) @ turn.T
            upper = full[np.triu_indices(3)].tolist()
            least = float(np.linalg.eigvalsh(symmetric(np.array(upper)))[0])
            quick += clearly_thick(upper)

            assert not clearly_thick(upper) or least > 1e-11
            if least > SMALLEST_INERTIA:
                require_thick(upper)
            else:
                with pytest.raises(DegenerateProblemError, match="nearly collinear"):
                    require_thick(upper)
    assert 16 <= quick < 40


@pytest.mark.parametrize("places", [-70, 0, 90])
def test_an_exponent_is_that_of_the_reduced_fraction(places):
    rng = np.random.default_rng(7)
    for _ in range(50):
        dividend, divisor = (int(k) for k in rng.integers(1, 1 << 40, size=2))
        mean = Fraction(dividend, divisor) * Fraction(2) ** places
        lengths = (mean.numerator.bit_length(), mean.denominator.bit_length())

        assert exponent_of(dividend, divisor, places) == lengths[0] - lengths[1]
