"""Certificates of all equilibria: what is produced, how it is read, and what is never listed."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from importlib import resources
from types import SimpleNamespace
from typing import Any

import degenerate_springs
import jsonschema
import numpy as np
import pytest
from spring_families import LISTED, Cell, instance, statement

from benchmarks.rates import list_certificates
from certreg import RegistrationProblem
from certreg.certificate import listing
from certreg.certificate.checking import verify
from certreg.certificate.envelope import Certificate
from certreg.certificate.listing import list_body, springs_list_certificate
from certreg.equilibrium.paths import critical_lines
from certreg.errors import InvalidFileError
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below
from certreg.geometry.so3 import squared_norm
from certreg.objective.springs import Springs
from certreg.problem.motion import Motion
from certreg.report.reload import report_of

SCHEMAS = resources.files("certreg") / "report" / "schemas"


@cache
def made(cell: Cell, seed: int = 0) -> Any:
    problem = RegistrationProblem(**statement(instance(cell, seed)))
    objective = Springs.of(problem)
    lines = critical_lines(objective.floating_quartic()[0])
    return problem, objective, springs_list_certificate(problem, objective, lines)


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("cell", LISTED[1:3], ids=str)
def test_the_list_of_a_random_problem_is_proved(cell):
    problem, _, certificate = made(cell)
    verdict = verify(certificate, problem)
    indices = certificate.body.claims.indices

    assert verdict.proved
    assert f"Rotations at equilibrium: {len(indices)}, no others." in " ".join(verdict.theorems)
    assert sum((-1) ** k for k in indices) == 0
    assert {*indices} == {0, 1, 2, 3}


@pytest.mark.slow
def test_the_rates_of_one_instance():
    assert list_certificates.rates(LISTED[4], 1).startswith("1 of 1 accepted")


def test_a_certificate_is_read_as_it_was_written():
    _, _, certificate = made(LISTED[1])
    document = json.loads(certificate.to_json())
    loaded: Any = Certificate.load(json.dumps(document).encode())

    assert loaded.body == certificate.body
    assert json.loads(loaded.to_json()) == document
    assert len(json.dumps(document["proof"])) < 5000


def test_a_list_claims_all_that_its_boxes_prove(monkeypatch):
    """In a chart along an axis, which makes no sum of coefficients larger.

    The checker accepts each number as it stands, and refuses the next one that says more.
    """
    problem, objective, _ = made(LISTED[3])
    monkeypatch.setattr(listing, "_charts", lambda: np.array([[2, 0, 0, 0]]))
    lines = critical_lines(objective.floating_quartic()[0])
    certificate: Any = springs_list_certificate(problem, objective, lines)
    claims = certificate.body.claims

    assert verify(certificate).proved
    for name, step in (("gap", -1), ("second", 1), ("sin2_half_angle", -1)):
        mantissa, exponent = getattr(claims, name).pair
        more = replace(claims, **{name: Dyadic(mantissa=mantissa + step, exponent=exponent)})
        odd = replace(certificate, body=replace(certificate.body, claims=more))
        assert verify(odd).words == f"claims.{name} is not proved"


def test_the_best_of_a_list_is_unique_where_the_bounds_of_its_energies_are_apart(monkeypatch):
    """With W >= max f - min f, an energy is off by less than 30 W |a|^2/|q|^2."""
    chart, lines = (0, 2, 0, 0), ((1, 2, 2), (0, 0, 0))
    norms = [4 * (256 + 9), 4 * 256]  # |q|^2 of q = a (2^4, line)
    own, other = (30 * Fraction(1, 8) * Fraction(4, norm) for norm in norms)
    quartic = SimpleNamespace(integers=(7, -5))  # 24 F but for its mean: W = 12 / 12 units
    charted: Any = SimpleNamespace(chart=chart, quartic=quartic)
    monkeypatch.setattr(listing, "_indices", lambda *_: (0, 0))

    def claims(best: Fraction, second: Fraction) -> Any:
        energies = dict(zip(norms, (best, second), strict=True))
        objective: Any = SimpleNamespace(
            energy=lambda q: energies[squared_norm(q)], unit=Fraction(1, 8), motion=Motion()
        )
        return listing._claimed(objective, charted, 4, list(lines), []).claims

    best, little = Fraction(5), Fraction(1, 10**20)
    for step in (-little, 0, little):
        found = claims(best, best + own + other + step)
        assert found.unique is (True if step > 0 else None)
        assert found.gap == dyadic_above(own, listing.GAP_BITS)
        assert found.second == dyadic_below(best + own + step, listing.SECOND_BITS)
        angle = dyadic_above(Fraction(3 * 4, norms[0]), listing.GAP_BITS)
        assert found.sin2_half_angle == (angle if step > 0 else None)
    assert claims(best, best + little).gap == dyadic_above(other - little, listing.GAP_BITS)


def test_a_certificate_has_the_form_of_its_schema():
    schema = json.loads((SCHEMAS / "certreg-springs-list-1.json").read_bytes())
    validator = jsonschema.Draft202012Validator(schema)
    document = json.loads(made(LISTED[1])[2].to_json())

    validator.validate(document)
    for part, entry in (("claims", "second"), ("claims", "indices"), ("proof", "lines")):
        assert not validator.is_valid({**document, part: {**document[part], entry: 1.5}})


def test_no_report_is_made_of_a_list(tmp_path):
    path = tmp_path / "list.json"
    made(LISTED[1])[2].save(path)

    with pytest.raises(InvalidFileError, match="kind springs-list, which `certreg verify` tells"):
        report_of(path)


def test_where_lines_are_not_all_apart_there_is_no_list():
    """One wall: a continuum."""
    points = instance(Cell("plane", 20, 0.05), 0).source
    problem = RegistrationProblem(points, points + 0.25, normals=[[1.0, 2.0, 2.0]] * 20)
    objective = Springs.of(problem)
    lines = critical_lines(objective.floating_quartic()[0])

    assert springs_list_certificate(problem, objective, lines) is None
    assert list_body(objective, lines).words == lines.outcome.value


@pytest.mark.long
def test_multiple_and_infinitely_many_lines_are_never_listed():
    listed: list[str] = []
    for name, problem in degenerate_springs.NAMED.items():
        objective = Springs.of(problem())
        lines = critical_lines(objective.floating_quartic()[0])
        certificate = springs_list_certificate(problem(), objective, lines)
        if certificate is not None:
            assert verify(certificate, problem()).proved
            listed.append(name)

    assert sorted(listed) == ["corner", "shared three", "two walls"]
