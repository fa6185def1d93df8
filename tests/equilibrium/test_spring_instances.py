"""Many problems of general springs at once: the equilibria that each has by itself."""

from __future__ import annotations

import functools
from importlib import import_module
from typing import Any

import degenerate_springs
import numpy as np
import pytest
import spring_families
from scipy.optimize import least_squares

import certreg
from certreg import RegistrationProblem, solve_many_springs
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.equilibrium.methods import search
from certreg.equilibrium.paths import PathsOutcome
from certreg.errors import InvalidProblemError
from certreg.geometry.so3 import rotation_matrix
from certreg.objective.springs import Springs
from certreg.results import Guarantee

EACH = 2  # problems of a family
CELLS = [cell for cell in spring_families.LISTED if cell.noise > 0.0 and cell.n > 3]
PATHS = import_module("certreg.equilibrium.paths")


def arrays(made) -> tuple[Any, Any, dict[str, Any]]:
    """Source, target and springs of several instances, as arrays."""
    springs = {name: np.array([one.springs[name] for one in made]) for name in made[0].springs}
    return np.array([one.source for one in made]), np.array([one.target for one in made]), springs


@functools.cache
def instances(cell):
    return [spring_families.instance(cell, seed) for seed in range(EACH)]


def listed_alone(one) -> Any:
    """The proved list of one instance, by itself."""
    problem = RegistrationProblem(one.source, one.target, **one.springs)
    return search(Springs.of(problem), "homotopy").critical


@pytest.mark.one_in(4)
@pytest.mark.parametrize("cell", CELLS, ids=map(str, CELLS))
def test_many_have_the_equilibria_that_each_has_by_itself(cell):
    source, target, springs = arrays(instances(cell))

    found = solve_many_springs(source, target, **springs)

    for k, one in enumerate(instances(cell)):
        alone = listed_alone(one)
        here = slice(found.counts[k])
        assert found.outcomes[k] is PathsOutcome.FOUND
        assert list(alone.indices) == found.indices[k, here].tolist()
        energies = np.array([float(part.value) for part in alone.components])
        assert np.abs(found.energies[k, here] - energies).max() < 1e-12 * np.ptp(energies)
        quaternions = np.array([unit_double(part.quaternion) for part in alone.components])
        overlaps = np.abs(quaternions @ found.quaternions[k, here].T)
        assert np.abs(overlaps.max(axis=1) - 1.0).max() < 1e-14  # in any order: energies may tie
    assert not found.decided.any()
    assert found.guarantee is Guarantee.NUMERICAL
    assert np.isnan(found.energies[found.indices == -1]).all()


def turned(start, turn):
    """The unit quaternion along start (1, turn)."""
    w, v = start[0], start[1:]
    q = np.concatenate([[w - v @ turn], v + w * turn + np.cross(v, turn)])
    return q / np.linalg.norm(q)


def descended(one, start):
    """Half of SciPy's least energy from a rotation: the distances of the points to their planes."""
    q, t, cost = start / np.linalg.norm(start), np.zeros(3), np.inf
    for _ in range(3):  # about the end of the one before: half turns from a start are far out

        def distances(x, q=q):
            rotation = np.array(rotation_matrix(turned(q, x[:3]).tolist()))
            rest = one.target - one.source @ rotation.T - x[3:]
            return (one.springs["normals"] * rest).sum(axis=1)

        end = least_squares(distances, np.concatenate([np.zeros(3), t]), method="lm")
        q, t, cost = turned(q, end.x[:3]), end.x[3:], end.cost
    return cost


@pytest.mark.slow
def test_all_minima_that_descent_finds_are_listed_and_every_listed_one_is_found():
    """SciPy's descent knows nothing of quartics and paths."""
    one = spring_families.instance(spring_families.Cell("plane", 7, 0.05), 3)
    source, target, springs = arrays([one])
    found = solve_many_springs(source, target, **springs)
    rng = np.random.default_rng(0)
    minima = found.indices[0] == 0
    near = found.quaternions[0, minima] + 0.01 * rng.normal(size=(minima.sum(), 4))

    ends = [2.0 * descended(one, start) for start in (*rng.normal(size=(20, 4)), *near)]

    apart = np.abs(found.energies[0, minima] - np.array(ends)[:, np.newaxis])
    assert (apart.min(axis=1) < 1e-9).all()
    assert set(apart.argmin(axis=1)) == set(range(minima.sum()))


def test_what_is_proved_of_each_stands_beside_the_rows():
    source, target, springs = arrays(instances(CELLS[1]))

    found = solve_many_springs(source, target, prove=True, **springs)

    assert found.decided.all()
    assert found.guarantee is Guarantee.ENCLOSED
    for k, proved in enumerate(found.lists or ()):
        assert proved.complete
        assert list(proved.indices) == found.indices[k, : found.counts[k]].tolist()
        best = found.quaternions[k, 0] - unit_double(proved.components[0].quaternion)
        assert np.abs(best).max() < 1e-15


def test_a_list_that_is_not_complete_is_not_called_decided():
    wall = degenerate_springs.NAMED["wall"]()
    source, target = (np.asarray(cloud) for cloud in (wall.source, wall.target))

    found = solve_many_springs(source, target, prove=True, factors=wall.factors)

    assert not found.decided.any()
    assert found.guarantee is Guarantee.NUMERICAL
    assert found.outcomes[0] is not PathsOutcome.FOUND


def test_an_energy_that_is_constant_has_no_rows():
    everywhere = solve_many_springs(
        np.zeros((1, 3, 3)), np.ones((1, 3, 3)), factors=np.ones((3, 6)), prove=True
    )

    assert everywhere.outcomes == (PathsOutcome.CONSTANT,)
    assert everywhere.counts.tolist() == [0]
    assert everywhere.decided.all()


def test_the_numbers_do_not_depend_on_threads_or_portions(monkeypatch):
    batch = import_module("certreg.equilibrium.line_batch")
    source, target, springs = arrays(instances(CELLS[2]))
    monkeypatch.setattr(batch, "PORTION", 1)
    calls = list[tuple[int, int]]()

    def told(*done):
        calls.append(done)

    one = solve_many_springs(source, target, threads=1, progress=told, **springs)
    monkeypatch.setattr(batch, "PORTION", 64)
    two = solve_many_springs(source, target, threads=2, **springs)

    for name in ("counts", "quaternions", "translations", "energies", "indices"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
    assert calls == [(1, EACH), (EACH, EACH)]


def test_lost_paths_are_followed_again_by_the_road_of_one(monkeypatch):
    source, target, springs = arrays(instances(CELLS[1]))
    usual = solve_many_springs(source, target, **springs)
    many = PATHS.many_quartic_paths

    def losing(*arguments):
        ends = many(*arguments)
        ends.codes[0, 5] = 1
        return ends

    monkeypatch.setattr(PATHS, "many_quartic_paths", losing)
    again = solve_many_springs(source, target, **springs)

    assert again.found.all()
    assert np.nanmax(np.abs(usual.energies - again.energies)) < 1e-12


def test_offsets_and_units_of_any_size_change_nothing_but_the_unit():
    source, target, springs = arrays(instances(CELLS[2]))
    near = solve_many_springs(source, target, **springs)
    far = solve_many_springs(source + 1e6, target - 1e6, **springs)
    tiny = solve_many_springs(source * 2.0**-300, target * 2.0**-300, **springs)

    assert near.indices.tolist() == far.indices.tolist() == tiny.indices.tolist()
    assert np.nanmax(np.abs(near.energies - far.energies)) < 1e-7
    assert (near.energies * 2.0**-600)[0, 1] == pytest.approx(tiny.energies[0, 1], rel=1e-9)
    assert np.nanmax(np.abs(tiny.translations * 2.0**300 - near.translations)) < 1e-12


def test_springs_of_all_problems_and_of_each_mean_the_same():
    cell = CELLS[2]
    made = instances(cell)
    source, target, springs = arrays(made)
    shared = made[0].springs["normals"]
    each = np.broadcast_to(shared, (EACH, *shared.shape))

    one = solve_many_springs(source, target, normals=shared, weights=np.full(cell.n, 2.0))
    all_of_them = solve_many_springs(source, target, normals=each, sigma=0.5**0.5)

    assert np.nanmax(np.abs(one.energies - all_of_them.energies)) < 1e-12
    assert springs["normals"].shape == each.shape


BAD = {
    "nothing given": ({}, "no springs were given"),
    "a shape": ({"normals": np.ones((4, 3))}, r"normals have the shape \(4, 3\): give \(5, 3\)"),
    "two ways": ({"factors": np.ones((3, 3, 3))}, "can be read in two ways"),
    "words": ({"normals": [["a"] * 3] * 5}, "normals have entries of type"),
    "another count": (
        {"normals": np.ones((3, 5, 3))},
        "sources are of 2 instances, other arrays of 3",
    ),
    "no length": (
        {"normals": np.concatenate([np.ones((9, 3)), np.zeros((1, 3))]).reshape(2, 5, 3)},
        r"normals row 4 of instance 1 \(counting from 0\) is 0, 0, 0",
    ),
    "no spring": (
        {"factors": np.concatenate([np.ones((1, 5, 6)), np.zeros((1, 5, 6))])},
        "all springs of instance 1 are zero",
    ),
    "both": ({"normals": np.ones((5, 3)), "sigma": 1.0, "weights": np.ones(5)}, "both sigma"),
    "sigma": ({"normals": np.ones((5, 3)), "sigma": np.zeros(5)}, "sigma of instance 0, row 0"),
    "weights": ({"normals": np.ones((5, 3)), "weights": np.ones(4)}, "weights have the shape"),
    "text": ({"normals": np.ones((5, 3)), "weights": "a"}, "weights have entries of type"),
    "ragged": ({"normals": [[1.0, 0.0], [1.0]]}, "normals are not an array of numbers"),
}


def test_an_energy_beyond_the_doubles_is_infinite():
    rng = np.random.default_rng(2)
    x, normals = rng.normal(size=(2, 8, 3))
    found = solve_many_springs(1e200 * x, 1e200 * rng.normal(size=(8, 3)), normals=normals)

    assert found.counts[0] > 0
    assert np.isposinf(found.energies).all()


def test_no_problem_at_all_is_named():
    with pytest.raises(InvalidProblemError, match=r"targets have the shape \(0, 5, 3\)"):
        solve_many_springs(np.ones((5, 3)), np.ones((0, 5, 3)), normals=np.ones((5, 3)))


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_is_named_with_its_row_and_problem(case):
    arguments, words = BAD[case]
    n = 3 if case == "two ways" else 5
    with pytest.raises(InvalidProblemError, match=words):
        solve_many_springs(np.ones((2, n, 3)), np.zeros((2, n, 3)), **arguments)


def test_a_coordinate_that_is_not_finite_is_named():
    source = np.ones((2, 5, 3))
    source[1, 3, 0] = np.nan
    with pytest.raises(InvalidProblemError, match="sources of instance 1, row 3") as caught:
        certreg.solve_many_springs(source, np.zeros((2, 5, 3)), normals=np.ones((5, 3)))
    assert (caught.value.instance, caught.value.row) == (1, 3)
