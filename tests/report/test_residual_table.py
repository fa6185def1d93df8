"""`fit.csv` says of every pair what plain arithmetic says, and holds no formula."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from strategies import random_problem

import certreg
from certreg.io.labels import csv_field
from certreg.report.residual_table import residual_table

LABELS = ["a", "=1+1", "b,c", '"', "+A", "f", "g", "h"]


def table(problem: certreg.RegistrationProblem, about=None) -> list[dict[str, str]]:
    result = certreg.certify(problem, relaxation=False, simulation=False, about=about or {})
    content = b"".join(residual_table(result)).decode()
    assert content.endswith("\n")
    return list(csv.DictReader(io.StringIO(content, newline="")))


@pytest.fixture(scope="module")
def clouds():
    problem = random_problem(np.random.default_rng(5), n=8, noise=0.1)
    return problem.source, problem.target


def plain(clouds, weights):
    """Residuals by scipy's rotation about weighted means."""
    from scipy.spatial.transform import Rotation

    x, y = clouds
    mx, my = (np.average(c, axis=0, weights=weights) for c in (x, y))
    R = Rotation.align_vectors(y - my, x - mx, weights=weights)[0]
    return np.linalg.norm(y - my - R.apply(x - mx), axis=1)


def column(rows, name):
    return [float(row[name]) if row[name] else None for row in rows]


def test_residuals_are_over_the_sigma_that_was_given(clouds):
    sigma = np.array([0.1, 0.2, 0.1, 0.3, 0.1, 0.2, 0.1, 0.4])
    rows = table(certreg.RegistrationProblem(*clouds, sigma=sigma), {"labels": LABELS})
    expected = plain(clouds, 1 / sigma**2)

    assert [row["row"] for row in rows] == list("01234567")
    assert column(rows, "residual") == pytest.approx(expected, rel=1e-9)
    assert column(rows, "standardised") == pytest.approx(expected / sigma, rel=1e-9)


def test_without_sigma_the_residuals_tell_it_themselves(clouds):
    weights = np.array([1.0, 2, 1, 0, 3, 1, 1, 2])
    rows = table(certreg.RegistrationProblem(*clouds, weights=weights))
    residual = plain(clouds, weights)
    spread = np.sqrt((weights * residual**2).sum() / (3 * 7 - 6))
    expected = (np.sqrt(weights) * residual / spread).tolist()
    standardised = column(rows, "standardised")

    assert column(rows, "residual") == pytest.approx(residual, rel=1e-9)
    assert standardised.pop(3) is None  # of no weight
    assert standardised == pytest.approx(expected[:3] + expected[4:], rel=1e-9)
    assert {row["label"] for row in rows} == {""}


def test_labels_stand_in_their_rows_and_are_no_formulas(clouds):
    rows = table(certreg.RegistrationProblem(*clouds), {"labels": LABELS})

    assert [row["label"] for row in rows] == ["a", "'=1+1", "b,c", '"', "'+A", "f", "g", "h"]
    assert csv_field("=1+1") == "'=1+1"


def test_where_nothing_tells_the_spread_the_cells_are_empty():
    three = np.eye(3)
    exact = table(certreg.RegistrationProblem(three, three + 1.0))
    two = table(certreg.RegistrationProblem(three[:2], 2 * three[:2]))

    assert column(exact, "standardised") == [None] * 3
    assert column(two, "standardised") == [None] * 2
    assert all(value is not None for value in column(two, "residual"))
