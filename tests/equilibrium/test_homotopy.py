from __future__ import annotations

import numpy as np
import pytest
import strategies

from certreg.equilibrium import four_paths
from certreg.equilibrium.four_paths import HomotopyStatus, continuation
from certreg.equilibrium.tracking import LOST, REGULAR, SINGULAR, TrackerSettings
from certreg.geometry.so3 import davenport_matrix
from certreg.problem.moments import exact_moments


def davenports(count, seed=0):
    C = np.random.default_rng(seed).normal(size=(count, 3, 3))
    return np.array([davenport_matrix(c.tolist()) for c in C])


def near_degenerate(gap, seed):
    """Symmetric, values 1, 0.3, 0.3 - gap, gap - 1.6 in a random frame."""
    rng = np.random.default_rng(seed)
    frame = np.linalg.qr(rng.normal(size=(4, 4)))[0]
    return frame @ np.diag([1, 0.3, 0.3 - gap, gap - 1.6]) @ frame.T


@pytest.mark.slow
def test_a_thousand_random_instances_have_four_roots_each_and_none_is_silently_wrong():
    K = davenports(1000)
    found = continuation(K)

    assert set(found.outcomes) == {HomotopyStatus.FOUND}
    assert set(found.patterns) == {(1, 1, 1, 1)}
    sizes = np.linalg.norm(K, axis=(1, 2))[:, None]
    assert np.abs(found.values * sizes - np.linalg.eigvalsh(K)[:, ::-1]).max() < 1e-12
    overlaps = np.abs(found.quaternions @ found.quaternions.transpose(0, 2, 1))
    assert np.abs(overlaps - np.eye(4)).max() < 1e-10


@pytest.mark.slow
def test_lost_paths_are_tried_again_with_another_gamma(monkeypatch):
    K = davenports(1000)
    hasty = TrackerSettings(max_rounds=12)
    again = continuation(K, tracker=hasty)
    monkeypatch.setattr(four_paths, "ATTEMPTS", 1)
    once = continuation(K, tracker=hasty)

    missing = [outcome is HomotopyStatus.INCOMPLETE for outcome in once.outcomes]
    assert 0 < sum(missing) < 1000
    assert sum(o is HomotopyStatus.INCOMPLETE for o in again.outcomes) < sum(missing)
    assert (again.attempts > 1).tolist() == missing


@pytest.mark.slow
def test_what_is_tried_again_is_told_of_its_last_attempt_and_the_others_of_their_first(monkeypatch):
    """Two of five lose their paths: one at the first attempt, one at two."""
    K, followed, calls = davenports(5), four_paths._followed, list[int]()
    usual = continuation(K)

    def losing(scaled, *arguments):
        ends = followed(scaled, *arguments)
        calls.append(len(scaled))
        lost = {5: [1, 3], 2: [1], 1: []}[len(scaled)]
        ends.codes[lost, 2], ends.conditions[lost, 2] = LOST, np.inf
        return ends

    monkeypatch.setattr(four_paths, "_followed", losing)
    found = continuation(K)

    assert calls == [5, 2, 1]
    assert found.attempts.tolist() == [1, 2, 1, 3, 1]
    assert set(found.outcomes) == {HomotopyStatus.FOUND}
    assert (found.codes == REGULAR).all()
    assert np.isfinite(found.conditions).all()
    assert np.abs(found.values - usual.values).max() < 1e-13
    assert np.array_equal(found.conditions[::2], usual.conditions[::2])


@pytest.mark.parametrize(
    ("values", "coranks", "pattern"),
    [
        ((1.0, 0.5, 0.5, -2.0), (0, 1, 1, 0), (1, 2, 1)),
        ((1.0, 0.5, 0.5, -2.0), (0, 2, 2, 0), None),  # two ends of a space of three
        ((1.0, 0.5, 0.5, -2.0), (0, 1, 0, 0), None),
        ((0.5, 0.5, 0.5, -1.5), (2, 2, 2, 0), (3, 1)),
        ((0.5, 0.5, 0.5, -1.5), (1, 1, 1, 0), None),
        ((1.0, 0.5, 0.5 - 2e-9, -2.0), (0, 1, 1, 0), None),
        ((1.0, 0.5, 0.5 - 5e-10, -2.0), (0, 1, 1, 0), (1, 2, 1)),
    ],
)
def test_as_many_ends_share_a_value_as_its_space_has_dimensions(values, coranks, pattern):
    """m ends belong to a space of m dimensions, whose Jacobian has the corank m - 1."""
    ends = four_paths.FourEnds(
        quaternions=np.eye(4)[None],
        values=np.array([values]),
        codes=np.array([[SINGULAR if corank else REGULAR for corank in coranks]], dtype=np.int8),
        coranks=np.array([coranks], dtype=np.int8),
        conditions=np.ones((1, 4)),
    )

    assert four_paths._shared(ends, 0) == pattern


def test_the_same_seed_gives_the_same_paths_and_another_the_same_roots(monkeypatch):
    K = davenports(5)
    one, same = continuation(K), continuation(K)
    monkeypatch.setattr(four_paths, "SEED", four_paths.SEED + 1)
    other = continuation(K)

    assert np.array_equal(one.quaternions, same.quaternions)
    assert np.abs(one.values - other.values).max() < 1e-13
    assert not np.array_equal(one.conditions, other.conditions)


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_every_row_is_reported_as_what_it_is(specimen):
    cross = exact_moments(specimen.problem).cross
    found = continuation(np.array(davenport_matrix(cross), dtype=float)[None])

    assert found.patterns == (specimen.pattern,)
    expected = HomotopyStatus.FOUND if specimen.pattern == (1,) * 4 else HomotopyStatus.CONTINUUM
    assert found.outcomes == (expected,)


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_near_degeneracy_is_resolved_or_flagged(gap):
    """Whatever is called FOUND is right; nothing else is called so."""
    K = np.array([near_degenerate(gap, seed) for seed in range(40)])
    found = continuation(K)
    values, vectors = np.linalg.eigh(K)

    sizes = np.linalg.norm(K, axis=(1, 2))
    for k, outcome in enumerate(found.outcomes):
        if outcome is HomotopyStatus.FOUND:
            assert np.abs(found.values[k] * sizes[k] - values[k][::-1]).max() < 1e-10 + gap / 10
            overlaps = np.abs(found.quaternions[k] @ vectors[k][:, ::-1])
            assert np.abs(overlaps - np.eye(4)).max() < 1e-3
    regular = sum(outcome is HomotopyStatus.FOUND for outcome in found.outcomes)
    assert regular == 40 if gap > 1e-4 else regular > 20 if gap > 1e-7 else True
    if gap == 1e-12:
        assert set(found.outcomes) == {HomotopyStatus.CONTINUUM}


@pytest.mark.slow
def test_shorter_steps_after_a_failure_find_what_the_same_steps_do_not():
    K = np.array([near_degenerate(1e-6, seed) for seed in range(40)])
    stubborn = continuation(K, tracker=TrackerSettings(care=1.0))
    careful = continuation(K)

    missing = [
        sum(outcome is HomotopyStatus.INCOMPLETE for outcome in found.outcomes)
        for found in (stubborn, careful)
    ]
    assert missing[1] == 0 < missing[0]


def test_two_paths_that_end_at_the_same_root_are_not_called_complete(monkeypatch):
    monkeypatch.setattr(four_paths, "SAME_ROOT", 1.6)  # 92 degrees: every pair counts as one
    monkeypatch.setattr(four_paths, "ATTEMPTS", 2)
    ends = continuation(davenports(1))

    assert ends.outcomes == (HomotopyStatus.INCOMPLETE,)
    assert ends.attempts.tolist() == [2]
