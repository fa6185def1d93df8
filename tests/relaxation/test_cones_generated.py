"""The committed cones are what CVXPY makes of the statements, and say what the programs say."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import cvxpy
import numpy as np
import pytest
from scipy.sparse import csc_matrix

from certreg.objective.quartics import MONOMIALS, PAIRS
from certreg.relaxation import cvxpy_models
from certreg.relaxation.cones import CONES_FILE, GENERATED, Columns, cones_of
from certreg.relaxation.conic import called
from certreg.relaxation.qcqp import RelaxationForm, quadratic_program
from derivations import cones as chain

PROGRAMS = [*RelaxationForm, "quartic"]


@pytest.fixture(scope="module")
def rng():
    return np.random.default_rng(3)


def csc(columns: Columns) -> csc_matrix:
    """SciPy's of the same, as it reads the three arrays."""
    return csc_matrix((columns.data, columns.indices, columns.indptr), shape=columns.shape)


def triangle(matrix):
    """By columns, times sqrt(2) off the diagonal."""
    return np.array(
        [
            matrix[i, j] * (1.0 if i == j else np.sqrt(2.0))
            for j in range(len(matrix))
            for i in range(j + 1)
        ]
    )


@pytest.mark.slow
def test_generating_anew_gives_the_committed_bytes():
    assert chain.cone_files() == {CONES_FILE: (GENERATED / CONES_FILE).read_bytes()}
    assert [path.name for path in GENERATED.iterdir()] == [CONES_FILE]


@pytest.mark.slow
def test_another_statement_gives_other_bytes(monkeypatch):
    norm = cvxpy_models.norm_fourth()
    monkeypatch.setattr(cvxpy_models, "norm_fourth", lambda: -norm)

    assert chain.cone_files()[CONES_FILE] != (GENERATED / CONES_FILE).read_bytes()


@pytest.mark.slow
def test_what_the_numbers_would_not_hold_is_refused():
    x, p = cvxpy.Variable(3), cvxpy.Parameter(3)
    inside = cvxpy.diag(x) >> 0
    refused: dict[str, tuple[Any, list[Any]]] = {
        "a constraint depends on the parameter": (cvxpy.sum(x), [x[0] == p[0], inside]),
        "the cost is not linear": (p @ x + cvxpy.sum(x), [inside]),
        "not of equalities and one matrix": (p @ x, [x[0] >= 1, inside]),
    }
    for words, (cost, constraints) in refused.items():
        problem = cvxpy.Problem(cvxpy.Minimize(cost), constraints)
        with pytest.raises(ValueError, match=words):
            chain._numbers(problem, p)
    right = cvxpy.Problem(cvxpy.Minimize(p @ x), [x[0] == 1, inside])
    assert chain._numbers(right, p)["size"] == 3


@pytest.mark.parametrize("form", RelaxationForm)
def test_the_matrix_of_a_rotation_meets_the_cones_at_the_objective(form, rng):
    """x: the upper triangle of v v^T by rows, v = q or (1, vec R)."""
    cones, C = cones_of(form), rng.normal(size=(3, 3))
    w, x, y, z = q = (quaternion := rng.normal(size=4)) / np.linalg.norm(quaternion)
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    v = q if form is RelaxationForm.QUATERNION else np.array([1.0, *R.T.ravel()])
    Z = np.outer(v, v)
    unknowns = Z[np.triu_indices(len(v))]

    slack = cones.right - csc(cones.rows) @ unknowns
    assert np.abs(slack[: cones.equalities]).max() < 1e-12
    assert slack[cones.equalities :] == pytest.approx(triangle(Z))
    assert -(cones.cost @ C.ravel()) @ unknowns == pytest.approx((R * C).sum())
    assert cones.equalities == 1 + len(quadratic_program(form, C.tolist()).quadratics)


def test_the_moments_of_a_quaternion_meet_the_cones_at_the_quartic(rng):
    cones, quartic = cones_of("quartic"), rng.normal(size=35)
    q = (quaternion := rng.normal(size=4)) / np.linalg.norm(quaternion)
    products = np.array([q[i] * q[j] for i, j in PAIRS])
    unknowns = np.array([np.prod(q[list(monomial)]) for monomial in MONOMIALS])

    slack = cones.right - csc(cones.rows) @ unknowns
    assert slack[0] == pytest.approx(0, abs=1e-12)
    assert slack[1:] == pytest.approx(triangle(np.outer(products, products)))
    assert cones.cost @ quartic @ unknowns == pytest.approx(quartic @ unknowns)


@pytest.mark.parametrize("program", PROGRAMS)
def test_every_entry_is_there_once_and_no_zero_is_written(program):
    cones = cones_of(program)

    assert cones.rows.has_canonical_format
    assert csc(cones.rows).has_canonical_format  # which SciPy finds out itself
    assert 0.0 not in cones.rows.data
    assert csc(cones.curvature).nnz == 0
    assert cones.curvature.shape == (len(cones.cost), len(cones.cost))
    assert cones.rows.shape == (len(cones.right), len(cones.cost))
    assert len(cones.right) == cones.equalities + cones.size * (cones.size + 1) // 2


def test_entries_in_any_order_are_those_of_scipy(rng):
    shape, dense = (5, 7), np.where(rng.random((5, 7)) < 0.3, rng.normal(size=(5, 7)), 0.0)
    dense[:, 2] = 0.0
    entries = [(int(i), int(j), float(dense[i, j])) for i, j in np.argwhere(dense)]
    found, expected = Columns.of(entries[::-1], shape), csc_matrix(dense)

    assert np.array_equal(csc(found).toarray(), dense)
    assert found.indptr == expected.indptr.tolist()
    assert found.indices == expected.indices.tolist()
    assert found.data == expected.data.tolist()


def test_clarabel_answers_as_with_the_matrices_of_scipy(rng):
    """Bit for bit: it reads the same numbers."""
    cones = cones_of(RelaxationForm.QUATERNION)
    cost = cones.cost @ rng.normal(size=9)
    alike = replace(cones, rows=csc(cones.rows), curvature=csc(cones.curvature))

    assert called(alike, cost).x == called(cones, cost).x
