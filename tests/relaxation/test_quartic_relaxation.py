"""The relaxation of a quartic: a dual that is an identity, a value that no rotation is below."""

from __future__ import annotations

import sys
from itertools import combinations_with_replacement, product
from typing import Any

import numpy as np
import pytest

from certreg.equilibrium.quartics import FloatingQuartic, descended
from certreg.errors import MissingToolError
from certreg.objective.levelling import norm_fourth
from certreg.objective.quartics import MONOMIALS, PAIRS, value
from certreg.relaxation import conic
from certreg.relaxation.conic import RelaxationStatus
from certreg.relaxation.quartic import relax_quartic

ACCURACY = 1e-6


def random_quartic(seed):
    return np.random.default_rng(seed).normal(size=len(MONOMIALS))


@pytest.mark.parametrize("seed", range(3))
def test_the_gram_matrix_makes_the_identity_and_the_value_is_below_every_rotation(seed):
    quartic = 1e4 * random_quartic(seed) + 1e6 * norm_fourth()
    found: Any = relax_quartic(quartic)
    rng = np.random.default_rng(seed)
    for q in rng.normal(size=(4, 4)):
        products = np.array([q[i] * q[j] for i, j in PAIRS])
        left = value(quartic.tolist(), q) - found.value * (q @ q) ** 2
        assert left == pytest.approx(products @ found.gram @ products, rel=ACCURACY)
    assert np.linalg.eigvalsh(found.gram)[0] > -ACCURACY * 1e4
    form = FloatingQuartic.of(quartic)
    ends = descended(form, np.array(list(product((-1.0, 0.3, 1.0), repeat=4))))
    assert found.status is RelaxationStatus.SOLVED
    assert found.value <= ends.values.min() + ACCURACY * 1e4
    if found.rank == 1:
        best = ends.points[ends.values.argmin()]
        assert abs(best @ found.quaternion_wxyz) == pytest.approx(1.0, abs=1e-5)
        assert found.value == pytest.approx(ends.values.min(), abs=ACCURACY * 1e4)


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["SCS", "clarabel"])
def test_a_solver_that_is_named_gives_what_clarabel_gives_directly(solver):
    """The Gram matrix apart, which need not be unique."""
    direct = relax_quartic(random_quartic(0))
    found: Any = relax_quartic(random_quartic(0), solver)

    assert (found.status, found.solver_word) == (RelaxationStatus.SOLVED, "optimal")
    assert found.value == pytest.approx(direct.value, abs=ACCURACY)
    assert np.linalg.eigvalsh(found.gram)[0] > -ACCURACY
    assert found.rank == direct.rank
    products = np.array([i * j for i, j in combinations_with_replacement((1.0, 2.0, -1.0, 0.5), 2)])
    level = value(random_quartic(0).tolist(), (1.0, 2.0, -1.0, 0.5)) - found.value * 6.25**2
    assert products @ found.gram @ products == pytest.approx(level, abs=1e-5)
    assert "stated by cvxpy-base" in found.solver


def test_a_solver_that_does_not_exist_is_named():
    with pytest.raises(MissingToolError, match="CVXPY finds no solver 'NONESUCH'"):
        relax_quartic(random_quartic(0), "NONESUCH")


def test_a_solver_that_fails_or_is_missing_is_a_status_without_numbers(monkeypatch):
    monkeypatch.setattr(conic, "MAX_ITERATIONS", 1)
    failed = relax_quartic(random_quartic(0))
    monkeypatch.setitem(sys.modules, "clarabel", None)
    missing = relax_quartic(random_quartic(0))

    assert (failed.status, failed.solver_word) == (RelaxationStatus.FAILED, "MaxIterations")
    assert missing.status is RelaxationStatus.UNAVAILABLE
    assert "pip install clarabel" in missing.reason
    for found in (failed, missing):
        assert (found.value, found.gram, found.rank, found.quaternion_wxyz) == (None,) * 4
