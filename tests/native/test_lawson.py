"""Lawson's iteration in C: weights that refute in integers, poses that fit, as NumPy finds them."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np
import pytest

from benchmarks.rates.consensus_labels import Cell
from certreg.certificate.consistency import ConsistentPairs
from certreg.certificate.infeasibility_weights import SIZES, WEIGHT_MAX
from certreg.native.library import library_if_any
from certreg.relaxation import edge_rows
from certreg.relaxation.paired_rows import Poses, fitted, paired_rows, squared_ratios

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.relaxation.paired_rows import PairedRows, Reals

checker = import_module("certreg.verify")
CELL = Cell(n=60, wrong=50)
LAWSON_STEPS = 80  # FIT_STEPS of native/lawson.c

pytestmark = pytest.mark.skipif(library_if_any() is None, reason="no compiled code")


def problem_of(seed: int):
    return CELL.problem(CELL.instance(seed))


def right_rows(made) -> list[int]:
    return np.flatnonzero(~made.wrong).tolist()


def plain_fits(pairs: PairedRows, inside: NDArray[np.bool_]) -> tuple[Poses, Reals]:
    """The poses of least largest ratio that were met, and the last weights: in NumPy."""
    weights = inside / inside.sum(axis=1, keepdims=True)
    largest = np.full(len(inside), np.inf)
    rotations, translations = np.zeros((len(inside), 3, 3)), np.zeros((len(inside), 3))
    open_sets = np.arange(len(inside))
    for _ in range(LAWSON_STEPS):
        now = weights[open_sets]
        poses = fitted(pairs, now * pairs.precisions)
        ratios = squared_ratios(pairs, poses)
        tops = np.where(inside[open_sets], ratios, 0.0).max(axis=1)
        better = tops < largest[open_sets]
        place = open_sets[better]
        largest[place] = tops[better]
        rotations[place], translations[place] = poses.rotations[better], poses.translations[better]
        lower = (now * ratios).sum(axis=1)
        now *= np.sqrt(ratios)
        totals = now.sum(axis=1)
        go_on = (tops > 1.0) & (lower <= 1.0) & (totals > 0.0)
        open_sets = open_sets[go_on]
        if not len(open_sets):
            break
        weights[open_sets] = now[go_on] / totals[go_on, np.newaxis]
    return Poses(rotations, translations), weights


def refuted_exactly(problem, group, row: int) -> bool:
    """The checker's own test of a group, in integers."""
    content = problem.data_bytes()[len(checker.CONSENSUS) + 8 :]
    rows, _ = checker.bounded_rows(content, problem.n)
    picked = [rows[i] for i in (row, *group.rows)]
    squares, bound, K = checker.weighed(picked, group.weights)
    A = [[-2 * k for k in line] for line in K]
    return checker.definite(checker.raised(A, squares - bound))


@pytest.mark.parametrize("seed", range(6))
def test_a_refutation_holds_in_integers_and_is_found_where_numpy_finds_one(seed: int):
    problem, rng = problem_of(seed), np.random.default_rng(seed)
    points, kinds, right = (
        ConsistentPairs.of(problem).points(),
        set[bool](),
        right_rows(CELL.instance(seed)),
    )
    for _ in range(20):
        row, *rows = rng.choice(CELL.n, rng.integers(3, 40), replace=False).tolist()
        if rng.random() < 0.5:  # most of them are right
            rows = [i for i in rows if i in right] or rows
        group, known = points.refutation(row, rows), points._refutation(row, rows)

        assert (group is None) == (known is None)
        kinds.add(group is None)
        if group is not None and known is not None:
            assert set(group.rows) <= set(rows)
            assert len(set(group.rows)) == len(group.rows) == len(known.rows)
            assert all(0 <= weight <= WEIGHT_MAX + 1 for weight in group.weights)
            assert refuted_exactly(problem, group, row)
    assert False in kinds


def test_a_few_rows_do_where_many_were_given():
    points = ConsistentPairs.of(problem_of(0)).points()
    group = points.refutation(0, range(1, CELL.n))

    assert group is not None
    assert len(group.rows) in SIZES


def test_rows_that_one_motion_meets_are_not_refuted():
    made = CELL.instance(3)
    points = ConsistentPairs.of(Cell(n=60, wrong=50, beta=9.0).problem(made)).points()
    first, *others = right_rows(made)

    assert points.refutation(first, others) is None
    assert points._refutation(first, others) is None


@pytest.mark.parametrize("far", [0.0, 1e6])
@pytest.mark.parametrize("seed", range(4))
def test_poses_of_least_largest_ratio_are_those_of_numpy(seed: int, far: float):
    """Their ratios, and so whether the sets fit; and weights alike."""
    made, rng = CELL.instance(seed), np.random.default_rng(seed)
    right = right_rows(made)
    bounds = rng.uniform(0.8, 1.5, CELL.n) * CELL.beta * CELL.sigma
    pairs = paired_rows(made.source + far, made.target - far, bounds)
    sets = np.zeros((9, CELL.n), dtype=bool)
    for k, row in enumerate(sets):
        row[right[: 1 + 3 * k]] = True
        row[rng.integers(CELL.n)] = k % 2 == 1 or row[0]
    sets[:, right[0]] = True
    found = edge_rows.lawson_fits(pairs, sets)
    poses, weights = plain_fits(pairs, sets)
    known = np.where(sets, squared_ratios(pairs, poses), 0.0).max(axis=1)

    np.testing.assert_allclose(found.largest, known, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found.weights.sum(axis=1), 1.0)
    np.testing.assert_allclose(found.weights, weights, rtol=1e-4, atol=1e-9)
    assert (found.largest <= 1.0).any()
    assert (found.largest > 1.0).any()
