"""How far motions that meet pairs turn from any rotation: as far as is said, and hardly less."""

from __future__ import annotations

import numpy as np
import pytest

from certreg.certificate.angle_bound import turn_about


def admitted(A: np.ndarray, c: float, rng: np.random.Generator, count: int) -> np.ndarray:
    """(k, 4): quaternions p, |p| = 1, with p^T A p >= c, many of them at c."""
    values, vectors = np.linalg.eigh(A)
    p = rng.standard_normal((count, 4)) * rng.choice([1.0, 0.1, 0.01], (count, 4))
    p[:, 3] = np.abs(p[:, 3]) + 0.1
    room = (values[3] - c) * p[:, 3] ** 2
    spent = ((c - values[:3]) * p[:, :3] ** 2).sum(axis=1)
    p[:, :3] *= np.sqrt(np.minimum(room / np.maximum(spent, 1e-300), 1e6))[:, np.newaxis]
    p /= np.linalg.norm(p, axis=1)[:, np.newaxis]
    return p @ vectors.T


@pytest.mark.parametrize("seed", range(12))
def test_the_angle_holds_and_is_reached_nearly(seed: int):
    rng = np.random.default_rng(seed)
    vectors = np.linalg.qr(rng.standard_normal((4, 4)))[0]
    A = vectors @ np.diag([-0.9, *rng.uniform(-0.8, 0.4, 2), 1.0]) @ vectors.T
    c = float(rng.uniform(0.8, 0.98))
    u = vectors[:, 3] + rng.choice([0.0, 0.01, 0.1]) * rng.standard_normal(4)
    u /= np.linalg.norm(u)
    reach = turn_about(c, A, u)
    assert reach is not None

    s = float(reach.sin2_half_angle.value)
    p = admitted(A, c, rng, 10_000)
    assert (np.einsum("ki,ij,kj->k", p, A, p) >= c - 1e-9).all()
    turned = 1.0 - (p @ u) ** 2
    assert turned.max() < s
    assert turned.max() > 0.8 * s - 1e-9
    t = float(reach.tau.value)
    matrix = (c - t * (1.0 - s)) * np.eye(4) - A + t * np.outer(u, u)
    assert np.linalg.eigvalsh(matrix)[0] > 0.0


def test_no_angle_is_told_where_all_rotations_are_admitted():
    A = np.diag([1.0, 0.2, 0.1, 0.0])
    assert turn_about(-0.1, A, np.eye(4)[0]) is None
    assert turn_about(0.15, A, np.eye(4)[0]) is None
    assert turn_about(0.5, A, np.eye(4)[1]) is None


def test_an_eigenvector_has_the_angle_of_two_eigenvalues():
    A = np.diag([1.0, 0.2, 0.1, 0.0])
    reach = turn_about(0.9, A, np.eye(4)[0])
    assert reach is not None
    assert float(reach.sin2_half_angle.value) == pytest.approx(0.1 / 0.8, rel=2e-3)
