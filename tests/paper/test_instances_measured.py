"""What a Monte-Carlo campaign keeps of each instance: beside what the numbers are called."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from certreg.equilibrium.batch import solve_many
from certreg.paper import monte_carlo
from certreg.problem.random_instances import gaussian_instances


@pytest.fixture(scope="module")
def made():
    return gaussian_instances(np.random.default_rng(3), points=9, sigma=0.4, count=20)


def test_errors_are_those_of_the_best_pose_beside_the_true_one(made):
    solutions = solve_many(made.sources, made.targets)
    found = monte_carlo._measured(solutions, made, 700)
    best = Rotation.from_quat(solutions.quaternions[:, 0], scalar_first=True)
    off = (best.inv() * Rotation.from_matrix(made.rotations)).magnitude()
    shifts = solutions.translations[:, 0] - made.translations

    assert off.max() > 0.1
    assert found["rotation_error_rad"] == pytest.approx(off)
    assert found["translation_error"] == pytest.approx(np.linalg.norm(shifts, axis=1))
    assert found["instance"].tolist() == list(range(700, 720))
    assert (found["margin"] == solutions.margins).all()
    assert (found["rmse"] == solutions.rmse).all()
    assert (found["unstable"] == [0, 1, 2, 3]).all()


@pytest.mark.parametrize("row", [1, 2, 3])
def test_the_half_turn_error_is_that_of_the_worst_spurious_pose(made, row):
    """A spurious quaternion turned by a in its plane with the best is 2 a off half a turn."""
    solutions = solve_many(made.sources, made.targets)
    turned = solutions.quaternions.copy()
    turned[:, row] = np.cos(0.1) * turned[:, row] - np.sin(0.1) * turned[:, 0]
    found = monte_carlo._measured(replace(solutions, quaternions=turned), made, 0)

    assert found["half_turn_error_rad"] == pytest.approx(0.2)


def test_an_exception_is_listed_with_its_counts_and_its_certificate():
    arrays = {
        "instance": np.arange(5, 8),
        "unstable": np.array([[0, 1, 2, 3], [0, 2, -1, -1], [-1, -1, -1, -1]]),
        "exception": np.array([6, 7]),
        "exception_pattern": np.array([[2, 2, 0, 0], [4, 0, 0, 0]]),
        "exception_sha256": np.array([[1] * 32, [0] * 32], dtype=np.uint8),
    }

    assert list(monte_carlo._listed(arrays)) == [
        [6, "2 2", "0 2", "certificates/instance-000000006.json"],
        [7, "4", "", None],
    ]


def test_no_count_is_kept_where_doubles_do_not_decide(made):
    solutions = solve_many(made.sources, made.targets)
    decided = np.arange(20) % 3 == 0
    found = monte_carlo._measured(replace(solutions, decided=decided), made, 0)

    assert (found["unstable"][decided] == [0, 1, 2, 3]).all()
    assert (found["unstable"][~decided] == -1).all()


def block(rng: np.random.Generator, unstable: list[list[int]]) -> dict[str, np.ndarray]:
    """The arrays of a shard of as many instances as counts, no exception among them."""
    n = len(unstable)
    return {
        "instance": np.arange(n),
        "rmse": rng.random((n, 4)),
        "unstable": np.array(unstable),
        **{name: rng.normal(size=n) for name in monte_carlo.EXTREMES},
        "exception": np.zeros(0, dtype=int),
        "exception_pattern": np.zeros((0, 4), dtype=int),
        "exception_sha256": np.zeros((0, 32), dtype=np.uint8),
    }


@pytest.mark.parametrize("seed", range(3))
def test_the_totals_are_those_of_all_instances_in_whatever_shards(tmp_path, monkeypatch, seed):
    rng = np.random.default_rng(seed)
    blocks = [
        block(rng, [[0, 1, 2, 3], [0, 1, 2, 2], [0, 1, 2, 3], [0, -1, -1, -1]]),
        block(rng, [[-1, -1, -1, -1], [0, 1, 2, 3]]),
        block(rng, [[3, 2, 1, 0]]),
    ]
    shards = [monte_carlo.packed(arrays) for arrays in blocks]
    monkeypatch.setattr(monte_carlo, "contents", lambda *_: iter(shards))
    totals = monte_carlo.write_instance_results(monte_carlo.MonteCarlo(count=7, points=4), tmp_path)

    assert (totals.count, totals.regular, totals.exceptions) == (7, 3, 0)
    for name in monte_carlo.EXTREMES:
        whole = np.concatenate([arrays[name] for arrays in blocks])
        assert (totals.smallest[name], totals.largest[name]) == (whole.min(), whole.max())
