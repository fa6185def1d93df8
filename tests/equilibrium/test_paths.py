"""The 40 paths: all critical lines of a quartic, told apart, and what became of each path."""

from __future__ import annotations

import functools
from itertools import product

import numpy as np
import pytest

from certreg.equilibrium import paths
from certreg.equilibrium.paths import LINES, PathsOutcome, critical_lines
from certreg.equilibrium.quartics import FloatingQuartic, descended
from certreg.equilibrium.tracking import LOST, REGULAR, TrackerSettings
from certreg.objective.normalisation import levelled, levelled_exactly, norm_fourth
from certreg.objective.quartics import MONOMIALS, gradient, hessian, value


def random_quartic(seed):
    return np.random.default_rng(seed).normal(size=len(MONOMIALS))


def diagonal(a):
    """The sum of a_i q_i^4."""
    quartic = np.zeros(len(MONOMIALS))
    quartic[[MONOMIALS.index((i,) * 4) for i in range(4)]] = a
    return quartic


@functools.cache
def random_lines(seed):
    return critical_lines(random_quartic(seed))


def test_derivatives_in_doubles_are_those_of_the_polynomial():
    quartic, q = random_quartic(0), np.random.default_rng(1).normal(size=(3, 4))
    form = FloatingQuartic.of(quartic)
    for row, found, second in zip(q, form.values(q), form.hessians(q), strict=True):
        assert found == pytest.approx(value(quartic.tolist(), row), rel=1e-13)
        assert second == pytest.approx(
            np.array(hessian(quartic.tolist(), row)), rel=1e-12, abs=1e-12
        )


@pytest.mark.parametrize("seed", range(3))
def test_every_end_is_a_critical_line_and_real_ones_obey_the_count_of_morse(seed):
    found = random_lines(seed)
    form = FloatingQuartic.of(random_quartic(seed))
    assert found.outcome is PathsOutcome.FOUND
    for q in found.points:
        slope = np.array(gradient(random_quartic(seed).tolist(), q))
        assert np.abs(slope - (q.conj() @ slope) * q).max() < 1e-10  # q is of norm 1
    signs = np.sign(np.linalg.det(form.curvatures(found.quaternions)[2]))
    assert len(found.quaternions) >= 4
    assert signs.sum() == 0  # the Euler characteristic of the rotations
    assert np.all(np.diff(form.values(found.quaternions)) >= 0)


def test_the_known_lines_are_found_again_40_real_ones_and_8_minima():
    """Of sum a_i q_i^4 with a > 0 the lines of full support are the minima."""
    quartic = diagonal((1.0, 0.9, 0.7, 0.6))
    found = critical_lines(quartic)
    form = FloatingQuartic.of(quartic)
    curvatures = np.linalg.eigvalsh(form.curvatures(found.quaternions)[2])

    assert (found.outcome, len(found.quaternions)) == (PathsOutcome.FOUND, LINES)
    assert (curvatures[:, 0] > 0).sum() == 8


def test_lines_do_not_change_with_scale_and_level():
    there = critical_lines(1e90 * random_quartic(1) + 3e92 * norm_fourth()).quaternions

    assert there == pytest.approx(random_lines(1).quaternions, abs=1e-9)


def test_a_continuum_is_told():
    """(R_33 - 0.3)^2: critical wherever R_33 is 0.3, 1 or -1."""
    squares = {(0, 0): 0.7, (3, 3): 0.7, (1, 1): -1.3, (2, 2): -1.3}  # R_33 - 0.3 |q|^2
    quartic = np.zeros(len(MONOMIALS))
    for (one, a), (other, b) in product(squares.items(), repeat=2):
        quartic[MONOMIALS.index(tuple(sorted((*one, *other))))] += a * b
    found = critical_lines(quartic)

    assert found.outcome is not PathsOutcome.FOUND
    assert not len(found.quaternions)


def test_a_constant_has_no_lines_to_track():
    found = critical_lines(0.1 * norm_fourth())

    assert (found.outcome, len(found.points), len(found.codes)) == (PathsOutcome.CONSTANT, 0, 0)


@pytest.mark.slow
def test_without_compiled_code_the_ends_are_the_same(monkeypatch):
    monkeypatch.setattr(paths, "quartic_paths", lambda *_: None)
    found = critical_lines(random_quartic(0))

    assert found.outcome is PathsOutcome.FOUND
    assert found.quaternions == pytest.approx(random_lines(0).quaternions, abs=1e-9)
    overlaps = np.abs(found.points.conj() @ random_lines(0).points.T).max(axis=1)
    assert overlaps == pytest.approx(np.ones(LINES), abs=1e-12)


def test_an_end_in_doubt_is_polished_and_judged_in_numpy(monkeypatch):
    monkeypatch.setattr(paths, "CLEAR_CONDITION", 0.0)
    found = critical_lines(random_quartic(1))

    assert found.outcome is PathsOutcome.FOUND
    assert found.points == pytest.approx(random_lines(1).points, abs=1e-9)


def test_ends_that_meet_are_told(monkeypatch):
    """As if two paths had gone to the same line."""
    usual = paths._followed

    def meeting(*arguments):
        tracked = usual(*arguments)
        tracked.points[1] = 2j * tracked.points[0]
        return tracked

    monkeypatch.setattr(paths, "_followed", meeting)
    found = critical_lines(random_quartic(1))

    assert found.outcome is PathsOutcome.INCOMPLETE
    assert (found.codes == REGULAR).all()


def test_where_paths_are_lost_all_are_tried_again_and_it_is_said_if_that_does_not_help():
    found = critical_lines(random_quartic(0), tracker=TrackerSettings(max_rounds=3))

    assert found.outcome is PathsOutcome.INCOMPLETE
    assert found.attempts <= paths.ATTEMPTS
    assert LOST in found.codes


def test_one_attempt_more_is_enough_where_the_first_lost_a_path(monkeypatch):
    usual, starts = paths._followed, list[int]()

    def losing(*arguments):
        tracked = usual(*arguments)
        starts.append(len(starts))
        tracked.codes[3] = LOST if len(starts) == 1 else tracked.codes[3]
        return tracked

    monkeypatch.setattr(paths, "_followed", losing)
    found = critical_lines(random_quartic(0))

    assert (found.outcome, found.attempts, starts) == (PathsOutcome.FOUND, 2, [0, 1])
    assert found.quaternions == pytest.approx(random_lines(0).quaternions, abs=1e-9)


def test_no_step_of_a_descent_goes_up():
    form = FloatingQuartic.of(random_quartic(2))
    starts = np.random.default_rng(0).normal(size=(300, 4))
    starts /= np.linalg.norm(starts, axis=1, keepdims=True)
    ends = descended(form, starts)

    assert (ends.values <= form.values(starts)).all()
    assert np.abs(form.curvatures(ends.points)[1]).max() < 1e-12


def test_descents_from_all_ends_reach_the_minima_and_leave_saddles():
    quartic = random_quartic(2)
    form, found = FloatingQuartic.of(quartic), random_lines(2)
    curvatures = np.linalg.eigvalsh(form.curvatures(found.quaternions)[2])
    minima = found.quaternions[curvatures[:, 0] > 0]
    ends = descended(form, found.points.real)

    assert (ends.curvatures > 0).all()
    overlaps = np.abs(ends.points @ minima.T)
    assert np.abs(overlaps.max(axis=1) - 1).max() < 1e-12
    assert (found.codes == REGULAR).all()


def test_levels_are_exact_on_integers_and_agree_with_doubles():
    quartic = [10**40 * k + 7**k for k in range(35)]
    exact, floating = levelled_exactly(quartic), levelled([float(c) for c in quartic])
    q = (3, -1, 4, 1)
    full = sum(
        c * np.prod([q[i] for i in m], dtype=object)
        for c, m in zip(quartic, MONOMIALS, strict=True)
    )

    assert exact.value(q) + 24 * exact.level * 27**2 == 24 * full
    assert exact.rest * float(exact.scale) == pytest.approx(
        floating.rest * floating.scale, rel=1e-12
    )
    assert 0.5 <= np.abs(exact.rest).max() <= 1.0
    assert levelled_exactly([6 * int(c) for c in norm_fourth()]).is_constant
    assert not levelled(0.1 * norm_fourth()).rest.any()
