"""Springs that break: rest poses with just their labels, beside all sets in floating point."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from strategies import random_rotation

from certreg.equilibrium import breaking
from certreg.equilibrium.breaking import (
    Eigenline,
    Labels,
    RestPose,
    SpringSet,
    _eigenline,
    _Residuals,
    _roots,
    consistent_springs,
    eigenlines,
    label_sets,
)
from certreg.errors import InvalidProblemError, UndecidedError
from certreg.geometry.so3 import rotation_matrix
from certreg.objective.isotropic import Isotropic
from certreg.problem.bounds import bounded
from certreg.problem.lifting import exact_springs
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.results import ComponentKind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray


ENOUGH = 10_000  # sets
CLEAR = 1e-7  # in the unit of the clouds: far above the rounding of doubles


def mixed(seed: int, n: int = 7, bound: float = 0.6) -> RegistrationProblem:
    """Points of which four are moved with some noise, the others anyhow; weights and bounds."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(n, 3))
    y = x @ random_rotation(rng).T + rng.normal(size=3) + 0.05 * rng.normal(size=(n, 3))
    y[4:] = y[:4].mean(axis=0) + rng.normal(size=(n - 4, 3))
    problem = RegistrationProblem(x, y, weights=rng.uniform(0.5, 2.0, size=n))
    return bounded(problem, bound * rng.uniform(0.8, 1.2, size=n), Loss.BREAKING)


def all_rest_poses(problem: RegistrationProblem, least: int = 3) -> list[RestPose]:
    return [pose for of in label_sets(problem, least, ENOUGH) for pose in of.rest_poses()]


def unit_matrix(pose: RestPose) -> NDArray[np.float64]:
    q = np.array([float(Fraction(k, 1 << 90)) for k in pose.quaternion])
    return np.array(rotation_matrix((q / np.linalg.norm(q)).tolist()))


def motion_of(problem: RegistrationProblem, pose: RestPose) -> tuple[NDArray, NDArray]:
    """R and t, the latter from the means of the springs that hold."""
    rows, R = list(pose.unbroken), unit_matrix(pose)
    w = problem.weights[rows]
    mean_x, mean_y = (w @ p[rows] / w.sum() for p in (problem.source, problem.target))
    return R, mean_y - R @ mean_x


def energy(problem: RegistrationProblem, R: NDArray, t: NDArray) -> float:
    """V by its definition."""
    x, y, w = problem.source, problem.target, problem.weights
    square = ((y - x @ R.T - t) ** 2).sum(axis=1)
    return float(w @ np.minimum(square, problem.bounds**2))


def by_all_sets(problem: RegistrationProblem) -> Iterator[tuple[tuple[int, ...], int, float]]:
    """Every set of three or more, its four eigenlines by NumPy, and those with its labels.

    Left out where doubles tell no eigenline or label: closer than CLEAR to the next, or a bound.
    """
    x, y, w = problem.source, problem.target, problem.weights
    basis = np.eye(4)
    for size in range(3, problem.n + 1):
        for rows in map(list, combinations(range(problem.n), size)):
            u = x[rows] - w[rows] @ x[rows] / w[rows].sum()
            v = y[rows] - w[rows] @ y[rows] / w[rows].sum()
            C = (w[rows, None] * v).T @ u
            q, R = basis, [np.array(rotation_matrix(e.tolist())) for e in basis]
            K = np.diag([float((r * C).sum()) for r in R])
            for i, j in combinations(range(4), 2):  # by polarisation of tr(R(q)^T C)
                both = np.array(rotation_matrix((q[i] + q[j]).tolist()))
                K[i, j] = K[j, i] = (float((both * C).sum()) - K[i, i] - K[j, j]) / 2.0
            values, vectors = np.linalg.eigh(K)
            for index, line in enumerate(vectors.T[::-1]):
                if (np.sort(np.abs(values - values[3 - index]))[1]) < CLEAR:
                    continue
                turn = np.array(rotation_matrix(line.tolist()))
                t = w[rows] @ (y[rows] - x[rows] @ turn.T) / w[rows].sum()
                room = problem.bounds - np.linalg.norm(y - x @ turn.T - t, axis=1)
                if np.flatnonzero(room > 0).tolist() == rows and np.abs(room).min() > CLEAR:
                    yield tuple(rows), index, energy(problem, turn, t)


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(6))
def test_the_list_is_what_all_sets_give_in_floating_point(seed):
    problem = mixed(seed, bound=(0.4, 0.8)[seed % 2])
    found = sorted((p.unbroken, p.index, float(p.energy)) for p in all_rest_poses(problem))
    expected = sorted(by_all_sets(problem))

    assert found
    assert [each[:2] for each in found] == [each[:2] for each in expected]
    np.testing.assert_allclose([e for *_, e in found], [e for *_, e in expected], rtol=1e-9)


@pytest.mark.slow
@pytest.mark.one_in(12)
@pytest.mark.parametrize("seed", range(24))
def test_of_points_in_whole_numbers_too_the_list_is_what_all_sets_give(seed):
    """With ties, continua and planar clouds among them."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 8))
    x, y = rng.integers(-3, 4, size=(2, n, 3)).astype(float)
    x[:, 2] *= seed % 3 > 0
    problem = bounded(RegistrationProblem(x, y), rng.integers(2, 8, size=n) / 2, Loss.BREAKING)
    found = {
        (pose.unbroken, pose.index): (pose, float(pose.energy)) for pose in all_rest_poses(problem)
    }
    expected = {each[:2]: each[2] for each in by_all_sets(problem)}

    assert expected.keys() <= found.keys()
    for key, (pose, height) in found.items():
        if key in expected:
            assert pose.labels is Labels.PROVED
            assert height == pytest.approx(expected[key], rel=1e-9)
        else:  # nothing that doubles tell apart: its labels, or its eigenline
            R, t = motion_of(problem, pose)
            off = np.linalg.norm(y - x @ R.T - t, axis=1) - problem.bounds
            assert pose.kind is not ComponentKind.POINT or np.abs(off).min() < CLEAR


def turned(R: NDArray, t: NDArray, step: NDArray) -> tuple[NDArray, NDArray]:
    half = np.concatenate([[1.0], step[:3] / 2.0])
    return R @ np.array(rotation_matrix((half / np.linalg.norm(half)).tolist())), t + step[3:]


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("seed", range(2))
def test_energy_slope_and_index_are_those_of_the_truncated_cost(seed):
    problem, h = mixed(seed, bound=0.8), 1e-4
    steps = h * np.eye(6)
    for pose in all_rest_poses(problem):
        R, t = motion_of(problem, pose)

        def at(step: NDArray, R: NDArray = R, t: NDArray = t) -> float:
            return energy(problem, *turned(R, t, step))

        here = at(np.zeros(6))
        assert here == pytest.approx(float(pose.energy), rel=1e-12)
        slopes = [(at(s) - at(-s)) / (2 * h) for s in steps]
        np.testing.assert_allclose(slopes, 0.0, atol=1e-5)
        hessian = np.array(
            [[at(a + b) - at(a - b) - at(b - a) + at(-a - b) for a in steps] for b in steps]
        ) / (4 * h * h)
        assert (np.linalg.eigvalsh(hessian) < 0.0).sum() == pose.index


def fitted(problem: RegistrationProblem, held: NDArray) -> tuple[NDArray, NDArray]:
    """The motion of least squares of some rows [Arun1987]."""
    x, y = problem.source[held], problem.target[held]
    w = problem.weights[held]
    m = w / w.sum()
    u, _, v = np.linalg.svd(((y - m @ y).T * w) @ (x - m @ x))
    R = (u * [1, 1, np.linalg.det(u @ v)]) @ v
    return R, m @ y - R @ (m @ x)


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(3))
def test_a_descent_from_anywhere_ends_in_a_minimum_of_the_list(seed):
    problem = mixed(seed, bound=0.7)
    minima = {p.unbroken for p in all_rest_poses(problem) if p.index == 0}
    x, y = problem.source, problem.target
    ends = set[tuple[int, ...]]()
    for rows in combinations(range(problem.n), 3):
        (R, t), held = fitted(problem, np.array(rows)), np.zeros(problem.n, bool)
        while True:
            inside = np.linalg.norm(y - x @ R.T - t, axis=1) < problem.bounds
            if inside.sum() < 3 or (inside == held).all():
                break
            held, before = inside, energy(problem, R, t)
            R, t = fitted(problem, held)
            assert energy(problem, R, t) <= before + 1e-12
        if inside.sum() >= 3:
            ends.add(tuple(np.flatnonzero(held).tolist()))

    assert len(ends) > 1
    assert ends <= minima


def coarse(objective: Isotropic) -> Eigenline:
    """The optimum, from a quaternion that is 2^-10 off towards the next eigenline."""
    first, second, *_ = objective.eigenvectors
    w, x, y, z = (a + (b >> 10) for a, b in zip(first, second, strict=True))
    upper, lower, *_ = objective.eigenvalues
    return _eigenline(objective, (w, x, y, z), 1, 0, (None, (upper + lower) / 2))


@pytest.mark.parametrize("seed", range(3))
def test_an_eigenline_is_within_its_bound_which_is_at_most_twice_as_wide(seed):
    objective = Isotropic.of(mixed(seed))
    line = coarse(objective)
    p, u = line.quaternion, objective.eigenvectors[0]
    along = sum(a * b for a, b in zip(p, u, strict=True))
    norms = sum(a * a for a in p) * sum(a * a for a in u)
    off = 1 - Fraction(along**2, norms)

    assert line.sin2 is not None
    assert 0 < off <= line.sin2 < 4.01 * off
    assert abs(objective.eigenvalues[0] - objective.alignment(p)) <= line.error
    assert all(each.sin2 is not None and each.sin2 < 2.0**-150 for each in eigenlines(objective))


@pytest.mark.parametrize("seed", range(3))
def test_residuals_at_the_exact_rotation_are_between_bounds_of_a_coarse_one(seed):
    problem, rows = mixed(seed), (0, 1, 2, 3)
    springs = SpringSet(problem, rows)
    fine, rough = eigenlines(springs.objective)[0], coarse(springs.objective)
    moved = 0.0
    for i in range(problem.n):
        (low, high, bound), (below, above, limit) = (
            _Residuals(exact_springs(problem), rows, line, Fraction(0)).between(i)
            for line in (fine, rough)
        )
        ends = [Fraction(end, bound) for end in (low, high)]
        wide = [Fraction(end, limit) for end in (below, above)]
        assert wide[0] < ends[0] < ends[1] < wide[1]
        moved = max(moved, abs(float(ends[0] - sum(wide) / 2)))
    assert moved > 1e-4


def test_a_far_point_moves_by_twice_the_sine_of_half_the_angle():
    """A turn about z takes (4096, 0, 0) by 2 sin(a/2) 4096 off, and the bound is no wider."""
    problem = bounded(
        RegistrationProblem([*STAY, [4096, 0, 0]], [*STAY, [4096, 0, 0]]), 1, Loss.BREAKING
    )
    turned = Eigenline(
        quaternion=(1000, 0, 0, 1),
        kind=ComponentKind.POINT,
        index=0,
        sin2=Fraction(1, 1000**2 + 1),
        error=Fraction(0),
    )
    low, high, bound = _Residuals(
        exact_springs(problem), (0, 1, 2, 3), turned, Fraction(0)
    ).between(4)

    assert low <= 0
    assert high / bound == pytest.approx(2 * 2 * 4096 / 1000, rel=1e-3)


# Labels, exactly ----------------------------------------------------------------------------------

STAY = [[0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 0, 5]]


def one_off(bound: float) -> list[RestPose]:
    """Four points that stay, and one whose target is 1 away."""
    problem = RegistrationProblem([*STAY, [7, 1, 2]], [*STAY, [8, 1, 2]])
    found = SpringSet(bounded(problem, bound, Loss.BREAKING), (0, 1, 2, 3)).rest_poses()
    return [pose for pose in found if pose.index == 0]


def test_a_residual_on_its_bound_is_a_tie_and_next_to_it_it_is_decided():
    (tie,) = one_off(1.0)
    (broken,) = one_off(np.nextafter(1.0, 0.0))

    assert (tie.labels, tie.doubtful) == (Labels.TIED, (4,))
    assert (broken.labels, broken.doubtful) == (Labels.PROVED, ())
    assert one_off(np.nextafter(1.0, 2.0)) == []  # the fifth spring holds, too


def test_a_residual_on_its_bound_at_an_irrational_rotation_is_too_near_to_be_told():
    x = np.array([[0, 0, 0], [0, 0, 2], [4, 3, 1], [9, 9, 9.0]])
    problem = bounded(RegistrationProblem(x, x), 2.0, Loss.BREAKING)
    (near,) = [p for p in SpringSet(problem, (0, 1, 2)).rest_poses() if p.index == 1]

    assert (near.labels, near.doubtful) == (Labels.TOO_NEAR, (0, 1))


def rod(other: list[float]) -> RestPose:
    """Three points on a line that stay, and one elsewhere whose target is at `other`."""
    line = [[-3, 0, 0], [0, 0, 0], [3, 0, 0]]
    problem = RegistrationProblem([*line, [0, 2, 0]], [*line, other])
    first, *_ = SpringSet(bounded(problem, 0.5, Loss.BREAKING), (0, 1, 2)).rest_poses()
    return first


def test_a_continuum_is_decided_only_where_no_rotation_mends_a_spring():
    open_, broken = rod([0, 0, 2]), rod([0, 0, 4])

    assert open_.kind is broken.kind is ComponentKind.CIRCLE
    assert (open_.labels, open_.doubtful) == (Labels.CONTINUUM, (3,))
    assert (broken.labels, broken.doubtful, broken.index) == (Labels.PROVED, (), 0)


@pytest.mark.parametrize("far", [2, 5])
@pytest.mark.parametrize("place", [-1, 0, 1])
def test_along_a_continuum_a_spring_is_broken_beyond_the_difference_of_its_radii(
    far: int, place: int
):
    """About the line the source's end is 3 from it, the target's `far`: they meet to |3 - far|."""
    line, nearest = [[-3, 0, 0], [0, 0, 0], [3, 0, 0]], float(abs(3 - far))
    bound = np.nextafter(nearest, nearest + place) if place else nearest
    for ends in ([[0, 3, 0], [0, 0, far]], [[0, 0, 3], [0, -far, 0]]):
        problem = RegistrationProblem([*line, ends[0]], [*line, ends[1]])
        springs = SpringSet(bounded(problem, [0.5, 0.5, 0.5, bound], Loss.BREAKING), (0, 1, 2))
        (first,) = [pose for pose in springs.rest_poses() if pose.index == 0]

        proved = place < 0
        assert first.kind is ComponentKind.CIRCLE
        assert first.labels is (Labels.PROVED if proved else Labels.CONTINUUM)
        assert first.doubtful == (() if proved else (3,))


@pytest.mark.parametrize(
    ("far", "near", "expected"),
    [
        (2.5, np.nextafter(1.0, 2.0), (Labels.PROVED, ())),
        (2.5, 1.0, (Labels.CONTINUUM, (2, 3))),  # on the bound, all along
        (2.5, np.nextafter(1.0, 0.0), None),  # the two are broken all along
        (np.nextafter(2.0, 3.0), 1.5, (Labels.PROVED, ())),
        (2.0, 1.5, (Labels.CONTINUUM, (0, 1))),  # all energy there is, 4, as that of one
    ],
)
@pytest.mark.parametrize("weight", [1.0, 3.0, 0.75])
def test_along_a_continuum_a_spring_of_the_set_holds_within_its_radii_and_the_energy(
    far: float, near: float, expected: tuple[Labels, tuple[int, ...]] | None, weight: float
):
    """The target is on a line: two springs stay 1 long, the energy is 4 weights at the optima."""
    source = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]
    target = [[2, 0, 0], [-2, 0, 0], [0, 0, 0], [0, 0, 0]]
    stated = RegistrationProblem(source, target, weights=[weight] * 4)
    problem = bounded(stated, [far, far, near, near], Loss.BREAKING)
    found = [pose for pose in SpringSet(problem, (0, 1, 2, 3)).rest_poses() if not pose.index]

    assert [(pose.labels, pose.doubtful) for pose in found] == ([expected] if expected else [])
    assert all(pose.energy == 4 * weight for pose in found)


def test_along_a_continuum_the_energy_counts_with_twice_its_error():
    """As above: two springs have all energy, of which 4 is known, and of another line 4.9."""
    source = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]
    target = [[2, 0, 0], [-2, 0, 0], [0, 0, 0], [0, 0, 0]]
    problem = bounded(RegistrationProblem(source, target), [2.2, 2.2, 1.5, 1.5], Loss.BREAKING)
    springs = SpringSet(problem, (0, 1, 2, 3))
    first, *_ = eigenlines(springs.objective)

    for error, doubtful in ((Fraction(42, 100), ()), (Fraction(421, 1000), (0, 1))):
        found = springs._labels(replace(first, error=error))  # 2.2^2 = 4 + 2 * 0.42
        assert found is not None
        assert found[1] == doubtful


@pytest.mark.parametrize("inside", [-1, 0, 1])
def test_a_set_is_dropped_where_its_energy_less_twice_its_error_is_not_below_breaking_it(inside):
    springs = SpringSet(mixed(0, bound=0.3), (0, 1, 2, 3))
    line = coarse(springs.objective)
    energy = springs.objective.energy(line.quaternion)
    springs.__dict__["_most"] = energy - 2 * line.error + inside * Fraction(1, 1 << 80)

    assert line.error > 0
    assert (springs._labels(line) is None) == (inside <= 0)


@pytest.mark.slow
def test_labels_do_not_change_with_the_unit_and_the_origin():
    rng = np.random.default_rng(5)
    x, y = rng.integers(-8, 9, size=(2, 6, 3)).astype(float)
    y[:4] = x[:4] @ np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]).T

    def seen(factor: float, shift: float) -> list[tuple[Any, ...]]:
        problem = RegistrationProblem((x + shift) * factor, (y - shift) * factor)
        poses = all_rest_poses(bounded(problem, 3.0 * factor, Loss.BREAKING))
        return [(p.unbroken, p.index, p.labels, p.energy / Fraction(factor) ** 2) for p in poses]

    def plain(poses: list[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
        return [(a, b, c, round(float(e), 9)) for a, b, c, e in poses]

    assert len(seen(1.0, 0.0)) > 3
    assert plain(seen(2.0**-300, 0.0)) == plain(seen(1.0, 0.0))
    assert plain(seen(1.0, 2.0**40)) == plain(seen(1.0, 0.0))


def test_a_root_is_between_the_integers_next_to_it():
    for square in range(200):
        low, high = _roots(square)
        assert low**2 <= square <= high**2
        assert high - low == (low**2 != square)


# Sets ---------------------------------------------------------------------------------------------


def test_two_springs_whose_lengths_differ_by_both_bounds_never_hold_together():
    def near(length: float) -> bool:
        source = [[0, 0, 0], [3, 0, 0], [0, 4, 0]]
        target = [[0, 0, 0], [length, 0, 0], [0, 4, 0]]
        springs = bounded(RegistrationProblem(source, target), [0.5, 0.25, 0.25], Loss.BREAKING)
        return bool(consistent_springs(springs)[0] & 0b10)

    assert [near(3.75), near(np.nextafter(3.75, 0)), near(2.25), near(np.nextafter(2.25, 9))] == [
        *(False, True),
        *(False, True),
    ]


@pytest.mark.slow
def test_sets_that_never_hold_are_not_the_end_of_others():
    problem = mixed(0, bound=0.8)
    refuted = [
        rows
        for size in (3, 4)
        for rows in combinations(range(problem.n), size)
        if SpringSet(problem, rows).never_holds
    ]
    listed = [set(of.unbroken) for of in label_sets(problem, 3, ENOUGH)]

    assert refuted
    assert not [rows for rows in refuted if any(set(rows) <= each for each in listed)]


@pytest.mark.slow
def test_with_a_larger_least_the_list_is_the_part_of_so_many_springs():
    problem = mixed(3, bound=0.8)
    whole = all_rest_poses(problem)

    for least in (4, 5, 6):
        part = [pose for pose in whole if len(pose.unbroken) >= least]
        assert sorted(p.unbroken for p in all_rest_poses(problem, least)) == sorted(
            p.unbroken for p in part
        )


def test_a_budget_of_sets_is_kept():
    problem = mixed(0, bound=0.8)
    needed = sum(1 for _ in label_sets(problem, 3, ENOUGH))

    with pytest.raises(UndecidedError, match=f"more than {needed - 1} sets of springs may hold"):
        list(label_sets(problem, 3, needed - 1))


def test_a_search_without_an_end_is_given_up(monkeypatch):
    problem = mixed(0, bound=0.8)
    monkeypatch.setattr(breaking, "BRANCHES_A_SET", 0)

    with pytest.raises(UndecidedError, match="sets of springs may hold together"):
        list(label_sets(problem, 3, ENOUGH))


# The problem --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "bound", "words"),
    [
        ({"weights": [1, 0, 1, 1]}, 1.0, r"weights\[1\] is 0: such a spring neither pulls nor"),
        ({"normals": STAY}, 1.0, "springs that break have one weight each .*: leave out normals"),
        ({"scale": "asymmetric"}, 1.0, "move a rigid body: leave out --scale"),
        ({}, 0.0, "max_residual is 0.0: a bound must be finite and > 0"),
    ],
)
def test_what_is_no_problem_of_springs_that_break_is_refused(options, bound, words):
    given: dict[str, Any] = dict(options)
    if "normals" in given:
        given["normals"] = np.array(given["normals"]) + 1.0
    problem = RegistrationProblem(np.array(STAY) + 1.0, STAY, **given)
    with pytest.raises(InvalidProblemError, match=words):
        bounded(problem, bound, Loss.BREAKING)
