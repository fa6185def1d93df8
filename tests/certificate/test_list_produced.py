"""Certificates of all equilibria: what is produced, how it is read, and what is never listed."""

from __future__ import annotations

import json
from functools import cache
from importlib import resources
from typing import Any

import degenerate_springs
import jsonschema
import pytest
from spring_families import LISTED, Cell, instance, statement

from benchmarks.rates import list_certificates
from certreg import RegistrationProblem
from certreg.certificate import Certificate, list_body, springs_list_certificate, verify
from certreg.equilibrium import critical_lines
from certreg.errors import InvalidFileError
from certreg.objective import Springs
from certreg.problem import spring_moments
from certreg.report import report_of

SCHEMAS = resources.files("certreg") / "report" / "schemas"


@cache
def made(cell: Cell, seed: int = 0) -> Any:
    problem = RegistrationProblem(**statement(instance(cell, seed)))
    objective = Springs(spring_moments(problem))
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
    objective = Springs(spring_moments(problem))
    lines = critical_lines(objective.floating_quartic()[0])

    assert springs_list_certificate(problem, objective, lines) is None
    assert list_body(objective, lines).words == lines.outcome.value


@pytest.mark.long
def test_multiple_and_infinitely_many_lines_are_never_listed():
    listed: list[str] = []
    for name, problem in degenerate_springs.NAMED.items():
        objective = Springs(spring_moments(problem()))
        lines = critical_lines(objective.floating_quartic()[0])
        certificate = springs_list_certificate(problem(), objective, lines)
        if certificate is not None:
            assert verify(certificate, problem()).proved
            listed.append(name)

    assert sorted(listed) == ["corner", "shared three", "two walls"]
