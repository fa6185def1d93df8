"""Many problems at once: the answers of each alone, and no claim that doubles cannot make."""

from __future__ import annotations

import functools
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import reference_stationary
from commands import checked
from reference_engine import reference
from strategies import ZOO, Specimen, random_problem, random_rotation

from certreg import equilibria
from certreg.dynamics.batch import bodies_of
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.states import start_at_rest
from certreg.equilibrium import batch as instances
from certreg.equilibrium.batch import Solutions, exactly, solve_many
from certreg.equilibrium.stability import Oscillations, linearised_spectrum
from certreg.errors import InvalidProblemError
from certreg.geometry.so3 import davenport_matrix, rotation_matrix
from certreg.native.layout import plain, symmetric
from certreg.native.library import loaded_library
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.equilibrium.equilibrium_set import EquilibriumSet
    from certreg.native.stationary import StationaryPoses
    from certreg.objective.classification import Classification

ARRAYS = ("quaternions", "translations", "rmse", "unstable", "margins", "decided", "eigenvalues")


def stacked(problems: list[RegistrationProblem]) -> dict[str, Any]:
    return {
        "sources": np.array([p.source for p in problems]),
        "targets": np.array([p.target for p in problems]),
        "weights": np.array([p.weights for p in problems]),
    }


def some(count: int, *, n: int = 20, **options: float) -> dict[str, Any]:
    rng = np.random.default_rng(count + n)
    return stacked([random_problem(rng, n=n, noise=0.1, **options) for _ in range(count)])


def problem_of(given: dict[str, Any], k: int) -> RegistrationProblem:
    return RegistrationProblem(
        given["sources"][k], given["targets"][k], weights=given["weights"][k]
    )


def assert_identical(one: Solutions, other: Solutions) -> None:
    for name in ARRAYS:
        assert np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True), name


def assert_same(
    found: Solutions, k: int, expected: EquilibriumSet, problem: RegistrationProblem
) -> None:
    """Row by row to rounding, which grows as the eigenvalues come near to each other."""
    near = 1e-13 / found.margins[k]
    means = [
        np.average(c, axis=0, weights=problem.weights) for c in (problem.source, problem.target)
    ]
    size = np.ptp(problem.target, axis=0).max()
    reach = sum(np.abs(mean).max() for mean in means) + size
    assert found.eigenvalues is not None
    for row, one in enumerate(expected.components):
        assert one.eigenvalues is not None
        assert one.rmse is not None
        translation = means[1] - one.rotation @ means[0]
        assert found.quaternions[k, row] == pytest.approx(one.quaternion_wxyz, abs=near)
        assert found.translations[k, row] == pytest.approx(translation, abs=near * reach)
        assert found.rmse[k, row] == pytest.approx(one.rmse, rel=1e-12, abs=1e-14 * size)
        assert found.unstable[k, row] == one.unstable_eigenvalues == row
        assert found.eigenvalues[k, row] == pytest.approx(one.eigenvalues, rel=1e-6, abs=1e-9)


# The same as one by one --------------------------------------------------------------------------


@pytest.mark.one_in(4)
@pytest.mark.parametrize("points", [3, 4, 20, 100, 10_000])
@pytest.mark.parametrize("offset", [0.0, 1e8, 1e13])
def test_many_are_solved_as_each_alone(points, offset):
    rng = np.random.default_rng(points)
    problems = [
        random_problem(rng, n=points, noise=noise, offset=offset, decades=4.0)
        for noise in (1e-3, 0.1, 3.0)
    ]

    found = solve_many(**stacked(problems), spectrum=True, damping=1.7)

    assert found.decided.all()
    for k, one in enumerate(problems):
        expected = exactly(one.source, one.target, weights=one.weights, damping=1.7)
        assert_same(found, k, expected, one)


@pytest.mark.parametrize("scale", [1e-300, 1e-150, 1e150, 1e300])
def test_units_change_nothing_but_lengths(scale):
    given = some(5)
    power = 2.0 ** np.floor(np.log2(scale))

    plain = solve_many(**given, spectrum=True)
    scaled = solve_many(
        given["sources"] * power, given["targets"] * power, weights=given["weights"], spectrum=True
    )

    lengths = {"translations": scaled.translations / power, "rmse": scaled.rmse / power}
    assert_identical(plain, replace(scaled, **lengths))


def test_residuals_of_clouds_that_fit_exactly_are_rounding():
    rng = np.random.default_rng(0)
    x = rng.integers(-99, 99, size=(40, 30, 3)).astype(float)

    found = solve_many(x, x[:, :, [1, 2, 0]] + 7.0)

    assert np.abs(found.rmse[:, 0]).max() <= 1e-12  # of 200
    assert found.rmse[:, 1:].min() > 1.0


def test_a_weight_of_zero_leaves_a_point_out():
    given = some(9)
    given["weights"][:, -1] = 0.0
    without = {name: array[:, :-1] for name, array in given.items()}

    one, other = solve_many(**without), solve_many(**given)

    for name in ("quaternions", "translations", "rmse", "margins"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-11), name
    assert (
        np.abs(one.rmse - solve_many(given["sources"], given["targets"]).rmse).min() > 1e-4
    )  # it was counted, else


def test_one_cloud_for_all_is_that_cloud_in_each():
    given = some(11)
    source, weights = given["sources"][0], given["weights"][0]
    repeated = np.repeat(source[np.newaxis], 11, axis=0)

    shared = solve_many(source, given["targets"], weights=weights, spectrum=True)
    single = solve_many(
        repeated,
        given["targets"],
        weights=np.repeat(weights[np.newaxis], 11, axis=0),
        spectrum=True,
    )

    assert_identical(shared, single)


@pytest.mark.slow
def test_no_instance_depends_on_its_neighbours_or_on_the_number_of_threads():
    given = some(1043, n=5)
    whole = solve_many(**given, spectrum=True, threads=1)

    for threads in (2, 3):
        assert_identical(whole, solve_many(**given, spectrum=True, threads=threads))
    chosen = np.random.default_rng(0).permutation(1043)[:50]
    few = solve_many(**{name: array[chosen] for name, array in given.items()}, spectrum=True)
    for k, one in enumerate(chosen):
        assert_identical(few.part(slice(k, k + 1)), whole.part(slice(one, one + 1)))


@pytest.mark.slow
def test_the_evaluator_finds_the_same(monkeypatch):
    given = some(600, n=7, decades=3.0, offset=10.0)
    by_engine = solve_many(**given, spectrum=True)
    monkeypatch.setattr(instances, "library_for", lambda _: reference())

    found = solve_many(**given, spectrum=True)

    assert (found.decided == by_engine.decided).all()
    assert (found.unstable == by_engine.unstable).all()
    near = 1e-13 / found.margins
    for name in ("quaternions", "translations"):
        difference = np.abs(getattr(found, name) - getattr(by_engine, name)).max(axis=(1, 2))
        assert (difference <= 30.0 * near).all(), name
    assert found.rmse == pytest.approx(by_engine.rmse, rel=1e-11)


@pytest.mark.parametrize("machine", [loaded_library, reference])
def test_residuals_and_ratios_are_what_they_are_called(machine):
    found = machine().stationary_poses(instances.clouds(**some(70)))
    entries: Any = np.moveaxis(found.cross.reshape(-1, 3, 3), 0, -1)
    K = np.moveaxis(np.array(davenport_matrix(entries)), -1, 0)

    L, V = found.values[:, np.newaxis], found.vectors.mT
    moved = np.linalg.norm(K @ V - V * L, axis=(1, 2))
    skew = np.linalg.norm(V.mT @ V - np.eye(4), axis=(1, 2))
    sizes = np.linalg.norm(K, axis=(1, 2)) + np.linalg.norm(L, axis=(1, 2))
    rounding = 40.0 * instances.ROUNDING * sizes  # of a residual that is rounding itself

    assert (np.abs(found.residual - moved - skew * sizes) <= rounding).all()
    assert found.residual.min() > 1e-17
    assert (np.diff(found.ratios, axis=2) >= 0.0).all()


def test_every_pose_is_at_rest_with_the_spectrum_of_the_derived_jacobian():
    given = some(6)
    found = solve_many(**given, spectrum=True, damping=0.9)
    assert found.eigenvalues is not None

    for k in range(6):
        moving = rigid_body(exact_moments(problem_of(given, k)), 0.9)
        for row, q in enumerate(found.quaternions[k]):
            turned = np.array(rotation_matrix(q.tolist())).ravel()
            state = np.concatenate([np.zeros(3), turned, np.zeros(6)])
            assert np.abs(moving.rate(state)).max() <= 1e-13
            spectrum_there = np.linalg.eigvals(moving.intrinsic_jacobian(state))
            distances = np.abs(spectrum_there[:, np.newaxis] - found.eigenvalues[k, row])
            assert distances.min(axis=0).max() <= 1e-6  # sqrt of rounding: double eigenvalues
            assert (spectrum_there.real > 0).sum() == found.unstable[k, row]


@pytest.mark.one_in(3)
@pytest.mark.parametrize("scale", [1e-140, 1.0, 1e140])
def test_a_batch_has_the_body_and_the_start_of_each_problem(scale):
    given = some(30, n=6, decades=2.0, scale=scale)
    found = bodies_of(**given, damping=0.7)

    for k in range(30):
        one = exact_moments(problem_of(given, k))
        moving = rigid_body(one, 0.7)
        finer = int(found.length_exponents[k]) - moving.length_exponent
        assert finer in {0, 1}  # each takes a power of two next to the radius
        units = 4.0 ** (finer * np.array([1.0] * 15 + [-1.0] * 6 + [1.0, 0.0]))
        numbers = plain(found.records)[k]
        assert numbers * units == pytest.approx(moving.parameters, rel=1e-11, abs=1e-14)
        start = start_at_rest(one, moving.length_exponent)
        assert found.starts["c"][k] * 2.0**finer == pytest.approx(start[:3], abs=1e-14)
        gaps = solved_gaps(moving.cross_covariance)
        assert found.basins["gaps"][k] * 4.0**finer == pytest.approx(gaps, abs=1e-14)


def solved_gaps(cross: NDArray[np.float64]) -> NDArray[np.float64]:
    values = np.linalg.eigvalsh(np.array(davenport_matrix(cross.tolist())))[::-1]
    return values[0] - values


@pytest.mark.parametrize("damping", [1e-3, 1.0, np.sqrt(8.0), 1e3])
def test_oscillations_are_those_of_each_equilibrium(damping):
    ratios = np.random.default_rng(1).normal(size=(50, 3)) * 10.0

    found = Oscillations.of(ratios, damping)

    for k, row in enumerate(ratios.tolist()):
        expected = linearised_spectrum(row, 1.0, damping)
        assert expected is not None
        assert np.array_equal(found.eigenvalues[k], expected)
        assert found.growing[k] == (expected.real > 0).sum()


# Never a claim that is wrong ---------------------------------------------------------------------


def integer_turn(rng: np.random.Generator, size: int) -> NDArray[np.float64]:
    """A rotation times an integer, so that its entries are integers."""
    q = [int(entry) for entry in rng.integers(-size, size + 1, size=4)]
    return np.array(rotation_matrix(q if any(q) else [1, 2, 3, 4]), dtype=float)


def disguised(specimen: Specimen, rng: np.random.Generator) -> RegistrationProblem:
    """The same row of the classification, exactly, in coordinates that make doubles round."""
    x, y = np.array(specimen.source), np.array(specimen.target)
    size = int(rng.choice([3, 100, 1000]))
    shifts = rng.integers(-(10**9), 10**9, size=(2, 3)) * rng.choice([0.0, 1.0, 3.0])
    return RegistrationProblem(
        x @ integer_turn(rng, size).T + shifts[0],
        y @ integer_turn(rng, size).T + shifts[1],
        weights=np.full(len(x), rng.integers(1, 10**6) / 8.0),
    )


def nudged(problem: RegistrationProblem, rng: np.random.Generator) -> RegistrationProblem:
    """One coordinate changed by a little, down to its last bit."""
    source = problem.source.copy()
    i, k = rng.integers(len(source)), rng.integers(3)
    size = np.abs(source).max() * 2.0 ** -float(rng.integers(10, 54))
    source[i, k] += size
    return RegistrationProblem(source, problem.target, weights=problem.weights)


@functools.cache
def exactly_known(problem: RegistrationProblem) -> Isotropic:
    return Isotropic(exact_moments(problem))


@functools.cache
def adversaries() -> tuple[tuple[RegistrationProblem, ...], ...]:
    """Degenerate problems and neighbours of such, by number of points; each exact in doubles."""
    rng = np.random.default_rng(7)
    found: dict[int, list[RegistrationProblem]] = {}
    for specimen in ZOO:
        for _ in range(30):
            one = disguised(specimen, rng)
            found.setdefault(one.n, []).extend([one, nudged(one, rng), nudged(one, rng)])
    for _ in range(60):  # ever nearer to a line
        x = np.outer(rng.integers(-99, 99, size=6), [1.0, 2.0, 3.0]) + rng.integers(-9, 9, size=3)
        x += rng.integers(-9, 9, size=(6, 3)) * 2.0 ** -float(rng.integers(1, 44))
        found.setdefault(6, []).append(RegistrationProblem(x, rng.integers(-99, 99, size=(6, 3))))
    return tuple(tuple(group) for group in found.values())


def rows_are_right(found: Solutions, k: int, exact: Isotropic) -> bool:
    """Whether each row is nearer to the exact eigenvector of its index than to all others."""
    basis = np.array(
        [[float(Fraction(e, 1 << exact.eigenspaces.bits)) for e in v] for v in exact.eigenvectors]
    )
    along = np.abs(found.quaternions[k] @ basis.T)
    return bool((along.argmax(axis=1) == np.arange(4)).all() and along.diagonal().min() > 0.8)


def judged(claims: Any = solve_many) -> dict[str, int]:
    """How many claims there are over all adversaries, right and wrong."""
    counts = {"decided": 0, "undecided": 0, "wrong": 0, "generic": 0, "uncounted": 0}
    for group in adversaries():
        found = claims(**stacked(list(group)))
        for k, one in enumerate(group):
            exact = exactly_known(one)
            kind: Classification = exact.classification
            counts["generic"] += kind.finite and kind.inertia_definite
            counts["decided" if found.decided[k] else "undecided"] += 1
            if not found.decided[k]:
                counts["wrong"] += bool((found.unstable[k] >= 0).any())
                continue
            right = kind.finite and kind.inertia_definite and rows_are_right(found, k, exact)
            counted = [n for n in found.unstable[k].tolist() if n >= 0]
            expected = [row for row, n in enumerate(found.unstable[k].tolist()) if n >= 0]
            counts["uncounted"] += len(counted) < 4
            counts["wrong"] += not right or counted != expected
    return counts


@pytest.mark.slow
def test_what_is_decided_is_never_wrong():
    counts = judged()

    assert counts["wrong"] == 0
    assert counts["undecided"] > 500  # the adversaries are adversaries
    assert counts["decided"] > counts["generic"] // 2  # and doubles still say something


@pytest.mark.slow
def test_without_its_bound_a_decision_would_be_wrong(monkeypatch):
    """The same judge, and a bound that is a thousandth of what is proved."""

    proved = instances.Bounds.of

    def bold(found: StationaryPoses, points: int) -> instances.Bounds:
        bounds = proved(found, points)
        return replace(bounds, eigenvalue=bounds.eigenvalue / 1000.0)

    monkeypatch.setattr(instances.Bounds, "of", bold)

    assert judged()["wrong"] > 0


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("machine", [loaded_library, reference])
def test_eigenvalues_are_as_near_as_the_bound_says(machine):
    for group in adversaries():
        given = instances.clouds(**stacked(list(group)))
        found = machine().stationary_poses(given)
        bound = instances.Bounds.of(found, given.sources.shape[1]).eigenvalue
        for k, one in enumerate(group):
            if bound[k] == np.inf:  # a coincident cloud
                continue
            exact = exactly_known(one)
            exponents = found.exponents[k].sum()
            scale = exact.moments.total_weight * Fraction(2) ** int(exponents)
            for value, expected in zip(found.values[k].tolist(), exact.eigenvalues, strict=True):
                assert abs(Fraction(value) - expected / scale) <= Fraction(float(bound[k]))


@pytest.mark.parametrize("points", [4, 1000])
@pytest.mark.parametrize("thin", [1.0, 1e-3])
def test_the_bounds_are_what_their_proof_adds_up(points, thin):
    """Line by line of the module's proof; errors seen are far smaller, and show no constant."""
    rng = np.random.default_rng(points)
    turn = np.array(rotation_matrix((0.5, -0.1, 0.7, 0.5)))
    sources = rng.normal(size=(3, points, 3)) * [1.0, thin, thin] @ turn.T
    found = instances.stationary_poses(
        instances.clouds(sources, sources + 0.1 * rng.normal(size=sources.shape), None)
    )
    bounds, u = instances.Bounds.of(found, points), 2.0**-53
    g = (points + 8) * u / (1 - (points + 8) * u)
    for k in range(3):
        square, other = (float(found.spreads[name][k]) for name in ("source", "target"))
        entries: Any = found.cross[k].reshape(3, 3)
        size = np.linalg.norm(davenport_matrix(entries))
        formed = np.sqrt(3) * 5 * g * np.sqrt(square * other)
        own = 40 * u * (size + np.linalg.norm(found.values[k]))
        B = formed + found.residual[k] + own
        minors = np.linalg.eigvalsh(symmetric(found.scatter[k]))
        e = minors[0] * minors[1] + minors[0] * minors[2] + minors[1] * minors[2]
        j = e / square - 2 * 5 * g * square
        off = (2 * B + 2**8 * u * size * (1 + np.sqrt(2 * square / j))) / j

        assert B <= bounds.eigenvalue[k] <= 1.002 * B
        assert off * (1 - 1e-6) <= bounds.ratio[k] <= 1.01 * off


def test_the_bounds_are_those_of_as_many_points_as_there_are(monkeypatch):
    seen, proved = [], instances.Bounds.of

    def watched(found: StationaryPoses, points: int) -> instances.Bounds:
        seen.append(points)
        return proved(found, points)

    monkeypatch.setattr(instances.Bounds, "of", watched)
    solve_many(**some(2, n=7))
    solve_many(np.eye(5, 3), np.eye(5, 3))
    assert seen == [7, 5]


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_what_is_not_generic_is_left_undecided(specimen):
    found = solve_many(specimen.source, specimen.target)

    assert found.decided.tolist() == [specimen.pattern == (1, 1, 1, 1)]
    assert (found.unstable >= 0).all() == found.decided[0]
    assert exactly(specimen.source, specimen.target).classification.pattern == specimen.pattern


def test_unstable_eigenvalues_are_counted_from_the_spectrum(monkeypatch):
    """With the Hessian's sign turned round, as many grow as did not: nothing follows the index."""

    class Turned:
        def stationary_poses(self, clouds: Any) -> StationaryPoses:
            found = loaded_library().stationary_poses(clouds)
            return replace(found, ratios=-found.ratios[:, :, ::-1])

    monkeypatch.setattr(instances, "library_for", lambda _: Turned())

    assert (solve_many(**some(40)).unstable == [3, 2, 1, 0]).all()


def test_a_count_that_rounding_could_change_is_not_given(monkeypatch):
    class Flat:
        def stationary_poses(self, clouds: Any) -> StationaryPoses:
            found = loaded_library().stationary_poses(clouds)
            ratios = found.ratios.copy()
            ratios[:, 2, 1] = 1e-14
            return replace(found, ratios=ratios)

    monkeypatch.setattr(instances, "library_for", lambda _: Flat())

    assert (solve_many(**some(40)).unstable == [0, 1, -1, 3]).all()


def test_the_residual_has_all_the_terms_of_its_formula():
    """By the same formula in NumPy: both round, so the medians of many are compared."""
    rng = np.random.default_rng(0)
    sources = rng.normal(size=(1000, 6, 3))
    targets = sources + 0.3 * rng.normal(size=sources.shape)
    found = instances.stationary_poses(instances.clouds(sources, targets, None))
    entries: Any = np.moveaxis(found.cross.reshape(-1, 3, 3), 0, -1)
    davenport = np.moveaxis(np.array(davenport_matrix(entries)), -1, 0)
    expected = reference_stationary._residual(davenport, found.values, found.vectors)

    assert np.median(found.residual) == pytest.approx(np.median(expected), rel=0.05, abs=0.0)


@pytest.mark.parametrize("thin", [1.0, 1e-2, 1e-4])
def test_ratios_of_a_body_that_fits_exactly_are_two_within_their_bounds(thin):
    """G = 2 J there. Small moments of inertia multiply what rounding does, and so the bound."""
    rng = np.random.default_rng(4)
    turn = np.array(rotation_matrix((0.5, -0.1, 0.7, 0.5)))
    sources = rng.normal(size=(200, 8, 3)) * [1.0, thin, thin] @ turn.T
    given = instances.clouds(sources, sources, None)
    found = instances.stationary_poses(given)
    bound = instances.Bounds.of(found, 8).ratio
    off = np.abs(found.ratios[:, 0] - 2.0).max(axis=1)

    assert (off <= bound).all()
    assert (bound < 1.0).all()


def test_subnormal_weights_and_clouds_of_far_sizes_leave_no_double():
    rng = np.random.default_rng(6)
    x = rng.normal(size=(7, 3))
    y = x @ random_rotation(rng).T + 0.1 * rng.normal(size=(7, 3))
    usual, light = solve_many(x, y), solve_many(x, y, weights=np.full(7, 2.0**-1040))
    far = solve_many(1e-200 * x, 1e200 * y)

    assert np.allclose(light.quaternions, usual.quaternions, rtol=0.0, atol=1e-13)
    assert np.allclose(light.rmse, usual.rmse, rtol=1e-12)
    assert np.allclose(far.rmse, 1e200 * np.sqrt(y.var(axis=0).sum()), rtol=1e-12)


def test_each_instance_is_decided_by_the_bound_of_its_own():
    """Far from the origin a cloud is small beside its coordinates, and so is what it bounds."""
    rng = np.random.default_rng(3)
    cube = np.array([[a, b, c] for a in (1.0, -1) for b in (1.0, -1) for c in (1.0, -1)])
    far = rng.normal(size=(8, 3)) + 1e7
    turned = cube @ random_rotation(rng).T  # three equal eigenvalues, but for rounding
    found = solve_many(np.array([far, turned]), np.array([far, cube]))

    assert found.decided.tolist() == [True, False]


@pytest.mark.parametrize("larger", [1e-3, 1e3])
@pytest.mark.parametrize("damping", [0.7, 2.8])
def test_rates_are_in_the_time_of_the_springs_where_clouds_differ_in_size(larger, damping):
    rng = np.random.default_rng(4)
    x = rng.normal(size=(9, 3))
    y = larger * (x @ random_rotation(rng).T + 0.1 * rng.normal(size=(9, 3)))
    (many,) = checked(solve_many(x, y, damping=damping, spectrum=True).eigenvalues)
    one = equilibria(RegistrationProblem(x, y, damping=damping))
    alone = exactly(x, y, damping=damping)
    for rates, known, found in zip(many, one.components, alone.components, strict=True):
        assert np.abs(rates - known.eigenvalues).max() < 1e-9 * np.abs(rates).max()
        assert np.array_equal(checked(found.eigenvalues), checked(known.eigenvalues))


@pytest.mark.parametrize(("share", "decided"), [(0.49, True), (0.51, False)])
def test_eigenvalues_are_told_apart_by_twice_the_bound_of_each(share, decided, monkeypatch):
    """Two neighbours may both be off by the bound, and towards each other."""
    proved = instances.Bounds.of

    def wide(found: StationaryPoses, points: int) -> instances.Bounds:
        least = (found.values[:, :-1] - found.values[:, 1:]).min(axis=1)
        return replace(proved(found, points), eigenvalue=share * least)

    monkeypatch.setattr(instances.Bounds, "of", wide)

    assert (solve_many(**some(8)).decided == decided).all()


@pytest.mark.parametrize("name", ["sources", "targets"])
def test_squares_that_could_underflow_leave_a_problem_undecided(name):
    given = some(8)
    assert solve_many(**given).decided.all()
    assert solve_many(**given).eigenvalues is None  # unless asked for
    given[name][:, 0] = 1e100  # the scale of a cloud is that of its farthest point
    given["weights"][:, 0] = 0.0

    assert not solve_many(**given).decided.any()


def test_modes_that_no_double_holds_are_not_counted():
    given = some(40)
    given["sources"] *= 1e160
    given["targets"] *= 1e-170

    found = solve_many(**given)

    assert found.decided.all()
    assert (found.unstable == -1).all()


# What is refused ---------------------------------------------------------------------------------


def test_what_is_not_finite_is_named_by_its_number_among_all(monkeypatch):
    monkeypatch.setattr(instances, "PORTION", 3)
    given = some(8, n=4)
    given["targets"][7, 2, 1] = np.nan

    with pytest.raises(InvalidProblemError, match="targets of instance 7, row 2,") as error:
        solve_many(**given)
    assert error.value.instance == 7


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", ["sources", "targets"])
@pytest.mark.parametrize("machine", [loaded_library, reference])
def test_what_is_not_finite_is_named(name, value, machine, monkeypatch):
    monkeypatch.setattr(instances, "library_for", lambda _: machine())
    given = some(700, n=4)
    given[name][611, 2, 1] = value

    with pytest.raises(InvalidProblemError, match=rf"{name} of instance 611, row 2, .*finite"):
        solve_many(**given)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"sources": np.zeros((5, 4, 2))}, r"sources have the shape \(5, 4, 2\)"),
        ({"targets": np.zeros((5, 3, 3))}, "sources have 4 points and targets 3"),
        ({"targets": np.zeros((6, 4, 3))}, "sources are of 5 instances, other arrays of 6"),
        ({"sources": np.zeros((5, 0, 3))}, r"sources have the shape \(5, 0, 3\)"),
        ({"sources": np.zeros((0, 4, 3))}, r"sources have the shape \(0, 4, 3\)"),
        ({"sources": [[1.0], [1.0, 2.0]]}, "sources are not an array of numbers"),
        ({"sources": np.zeros((5, 4, 3), dtype=complex)}, "sources have entries of type complex"),
        ({"weights": np.ones(3)}, r"weights have the shape \(1, 3\): give \(count, 4\) or \(4,\)"),
        ({"weights": np.ones((2, 4))}, "weights are of 2 instances, other arrays of 5"),
        ({"weights": [1.0, -1.0, 1.0, 1.0]}, "weights of instance 0 are not finite numbers >= 0"),
        ({"weights": np.eye(5, 4)}, "weights of instance 4 are .* all of them are zero"),
        ({"weights": [1.0, np.nan, 1.0, 1.0]}, "weights of instance 0"),
        ({"weights": [1.0, np.inf, 1.0, 1.0]}, "weights of instance 0"),
        ({"damping": 0.0}, "damping is 0.0"),
        ({"damping": np.nan}, "damping is nan"),
        ({"threads": 0}, "threads is 0"),
        ({"threads": "2"}, "threads is '2'"),
    ],
)
def test_what_states_no_problem_is_refused(change, words):
    with pytest.raises(InvalidProblemError, match=words):
        solve_many(**{**some(5, n=4), **change})
