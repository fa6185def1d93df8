"""The tracker on systems that have nothing to do with registration."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from certreg.equilibrium.tracking import PathStatus, TrackerSettings, statuses_of, track

GAMMA = np.exp(0.7j)


class Polynomials:
    """One polynomial in one unknown for each path: coefficients, highest first."""

    def __init__(self, *coefficients):
        self.coefficients = [np.asarray(c, dtype=complex) for c in coefficients]

    def evaluate(self, which, x):
        rows = [self.coefficients[k] for k in which]
        values = [np.polyval(c, z) for c, z in zip(rows, x[:, 0], strict=True)]
        slopes = [np.polyval(np.polyder(c), z) for c, z in zip(rows, x[:, 0], strict=True)]
        return np.array(values)[:, None], np.array(slopes)[:, None, None]


def roots_of_unity(degree):
    return np.exp(2j * np.pi * np.arange(degree) / degree)[:, None]


def followed(target, settings=None):
    degree = len(target) - 1
    start = Polynomials(*[[1, *[0] * (degree - 1), -1]] * degree)
    return track(start, Polynomials(*[target] * degree), roots_of_unity(degree), GAMMA, settings)


def test_all_roots_of_a_polynomial_of_degree_seven_are_found():
    wanted = np.array([1, -2, 3 + 1j, 3 - 1j, 0.1, 0.2, -5j])
    found = followed(np.poly(wanted))

    assert set(statuses_of(found.codes)) == {PathStatus.REGULAR}
    assert np.abs(found.points - wanted).min(axis=0).max() < 1e-10
    assert np.abs(found.points - wanted).min(axis=1).max() < 1e-10


def test_a_double_root_is_two_singular_ends_and_the_third_is_regular():
    found = followed(np.poly([1.0, 1.0, -2.0]))

    assert sorted(s.name for s in statuses_of(found.codes)) == ["REGULAR", "SINGULAR", "SINGULAR"]
    assert sorted(np.round(found.points[:, 0].real, 5)) == [-2.0, 1.0, 1.0]


def test_a_path_to_infinity_is_called_diverged():
    """x^3 - 1 to x - 2: two of three roots go to infinity."""
    found = followed(np.array([0.0, 0.0, 1.0, -2.0]))

    assert sorted(s.name for s in statuses_of(found.codes)) == ["DIVERGED", "DIVERGED", "REGULAR"]


def test_a_path_that_runs_out_of_rounds_is_called_lost():
    found = followed(np.poly([1.0, 2.0, 3.0]), TrackerSettings(max_rounds=1))

    assert set(statuses_of(found.codes)) == {PathStatus.LOST}


def test_a_gamma_that_runs_into_a_singularity_is_called_lost_and_another_is_not():
    """Real gamma: x^2 - 1 to x^2 + 1 passes through x^2 = 0 at t = 1/2."""
    start, target = (Polynomials(*[[1, 0, c]] * 2) for c in (-1, 1))
    real = track(start, target, roots_of_unity(2), 1.0)
    bent = track(start, target, roots_of_unity(2), GAMMA)

    assert PathStatus.REGULAR not in statuses_of(real.codes)
    assert set(statuses_of(bent.codes)) == {PathStatus.REGULAR}
    assert sorted(np.round(bent.points[:, 0], 12), key=np.imag) == [-1j, 1j]


class Quartics:
    """Critical points of a quartic form f on the 3-sphere: grad f = l q with a . q = 1."""

    def __init__(self, forms, chart):
        """forms: (paths, 4, 4, 4, 4), symmetric."""
        self.forms, self.chart = forms, chart

    def evaluate(self, which, x):
        q, level = x[:, :4], x[:, 4:]
        cubic = np.einsum("mijkl,mk,ml->mij", self.forms[which], q, q)
        jacobian = np.zeros((len(x), 5, 5), dtype=complex)
        jacobian[:, :4, :4] = 3 * cubic - level[..., None] * np.eye(4)
        jacobian[:, :4, 4], jacobian[:, 4, :4] = -q, self.chart
        values = np.empty_like(x)
        values[:, :4] = np.einsum("mij,mj->mi", cubic, q) - level * q
        values[:, 4] = q @ self.chart - 1
        return values, jacobian


def test_a_quartic_form_on_the_sphere_has_its_forty_critical_points():
    """From sum a_i q_i^4, whose critical lines are known: q_i^2 = 1/a_i on each set of axes."""
    rng = np.random.default_rng(5)
    raw = rng.normal(size=(4, 4, 4, 4))
    form = np.mean([raw.transpose(p) for p in itertools.permutations(range(4))], axis=0)
    weights = np.array([1.0, 1.3, 0.8, 1.1])
    simple = np.zeros((4, 4, 4, 4))
    simple[range(4), range(4), range(4), range(4)] = weights
    chart = rng.normal(size=4) + 1j * rng.normal(size=4)
    starts = []
    for size in range(1, 5):
        for axes in itertools.combinations(range(4), size):
            for signs in itertools.product([1, -1], repeat=size - 1):
                q = np.zeros(4, dtype=complex)
                q[list(axes)] = np.array([1, *signs]) / np.sqrt(weights[list(axes)])
                scale = chart @ q
                starts.append([*(q / scale), 1 / scale**2])
    assert len(starts) == 40

    copies = [np.repeat(f[None], 40, axis=0) for f in (simple, form)]
    start, target = (Quartics(f, chart) for f in copies)
    found = track(start, target, np.array(starts), GAMMA, TrackerSettings().careful())

    assert set(statuses_of(found.codes)) == {PathStatus.REGULAR}
    distance = np.abs(found.points[:, None] - found.points[None]).max(axis=-1)
    assert (distance + np.eye(40)).min() > 1e-4
    values, _ = target.evaluate(np.arange(40), found.points)
    assert np.abs(values).max() < 1e-9 * np.abs(found.points).max() ** 3


def test_statuses_are_sentences_and_are_never_dropped():
    found = followed(np.poly([1.0, 1.0, -2.0, 5.0]))

    assert len(statuses_of(found.codes)) == len(found.points) == 4
    assert all(status.value.endswith(".") for status in PathStatus)


@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-8])
def test_a_pair_of_close_roots_is_told_apart_or_called_singular(gap):
    found = followed(np.poly([0.3, 0.3 + gap, -0.9]))
    ends = np.sort(found.points[:, 0].real)

    if set(statuses_of(found.codes)) == {PathStatus.REGULAR}:
        assert np.abs(ends - np.sort([0.3, 0.3 + gap, -0.9])).max() < 0.1 * gap
