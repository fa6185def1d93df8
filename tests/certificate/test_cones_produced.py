"""Certificates by cones: what is produced, from where, and a small sample of all rates."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib import resources
from typing import TYPE_CHECKING, Any, NoReturn

import jsonschema
import numpy as np
import pytest
from exact_springs import choi_lam

from benchmarks.rates import cone_certificates
from benchmarks.rates.cone_certificates import case, document_of
from certreg import RegistrationProblem
from certreg.certificate import cones as producer
from certreg.certificate.checking import verify
from certreg.certificate.cones import SpringsConesBody, cones_body, springs_certificate
from certreg.certificate.envelope import Certificate
from certreg.certificate.squares import SpringsSosBody, sos_body
from certreg.errors import NotCompiledWarning
from certreg.native.kernels import MissingLibraryError
from certreg.objective.springs import Springs
from certreg.relaxation.optimum import find_optimum

if TYPE_CHECKING:
    from certreg.relaxation.optimum import Found


SCHEMAS = resources.files("certreg") / "report" / "schemas"


def certificate_of(problem: RegistrationProblem) -> Any:
    objective = Springs.of(problem)
    return springs_certificate(problem, objective, find_optimum(objective))


@pytest.mark.slow
def test_where_squares_fail_cones_are_cut_and_the_certificate_says_so():
    problem = choi_lam()
    certificate = certificate_of(problem)

    assert isinstance(certificate.body, SpringsConesBody)
    assert certificate.about["cones"] == producer.FINE_WORDS
    assert certificate.body.growth == 0
    assert verify(certificate, problem).proved


def test_where_squares_prove_the_optimum_unique_no_cone_is_cut():
    certificate = certificate_of(case("plane 20", 0).problem)

    assert isinstance(certificate.body, SpringsSosBody)
    assert "cones" not in certificate.about


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", ["plane 7", "choi-lam", "two optima", "flat 9"])
def test_a_certificate_is_read_as_it_was_written(name):
    made = case(name, 0)
    loaded: Any = Certificate.load(json.dumps(made.document).encode())

    assert document_of(made.problem, loaded.body) == made.document
    assert loaded.body.gap == loaded.body.delta.value > 0
    assert len(json.dumps(made.document["proof"])) < 2000


@pytest.mark.one_in(3)
@pytest.mark.parametrize("name", ["plane 7", "choi-lam", "two optima", "flat 9"])
def test_a_certificate_has_the_form_of_its_schema(name):
    schema = json.loads((SCHEMAS / "certreg-springs-cones-1.json").read_bytes())
    validator, document = jsonschema.Draft202012Validator(schema), case(name, 0).document

    validator.validate(document)
    for part, entry in (("claims", "gap"), ("proof", "caps"), ("proof", "mu")):
        other = {**document, part: {**document[part], entry: 1.5}}
        assert not validator.is_valid(other)


def test_choi_and_lam_with_random_planes():
    assert "unique by cones 1, by squares 0 of 1" in cone_certificates.perturbed_rates(1)


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("name", ["plane 6", "line 3"])
def test_of_tied_optima_a_gap_is_proved_and_no_uniqueness(name):
    told = cone_certificates.minimal_rates(name, 2, checked=1)

    assert told.startswith("gap 2 of 2, unique {None: 2}; 1 of 1 accepted")


@pytest.mark.slow
def test_local_minima_are_refused_and_left_for_the_optimum():
    assert (
        cone_certificates.spurious_rates(2)
        == "2 of 2 refused; 2 times the optimum is found from there"
    )


@pytest.mark.slow
def test_no_forgery_is_accepted_that_is_false():
    assert cone_certificates.forgery_rates(25, ("plane 20",)).startswith("25 forgeries")


def test_a_false_claim_is_seen_to_be_false():
    """The oracle of the forgeries: each of its three questions is asked."""
    made = case("plane 20", 0)
    document = json.loads(json.dumps(made.document))
    assert cone_certificates.is_true(document, made)
    for entry, value in (("unique", False), ("gap", [-1, 0])):
        assert not cone_certificates.is_true(
            {**document, "claims": {**document["claims"], entry: value}}, made
        )
    pose = [entry + (1 << 60) for entry in document["proof"]["pose"]]
    assert not cone_certificates.is_true(
        {**document, "proof": {**document["proof"], "pose": pose}}, made
    )


@pytest.mark.parametrize("squares", [0, 1])
def test_without_compiled_code_squares_prove_what_they_can_and_cones_are_said_to_need_it(
    squares: int, monkeypatch: pytest.MonkeyPatch
):
    """Squares that leave open whether the optimum is unique; and none."""

    def refusing(task: str) -> NoReturn:
        raise MissingLibraryError(f"{task} needs the compiled library")

    def undecided(objective: Springs, found: Found) -> SpringsSosBody | None:
        body = sos_body(objective, found) if squares else None
        return body and replace(body, claims=replace(body.claims, unique=None))

    made = case("plane 20", 0)
    monkeypatch.setattr("certreg.native.cones.little_library_for", refusing)
    monkeypatch.setattr("certreg.certificate.cones.sos_body", undecided)
    with pytest.warns(NotCompiledWarning, match="a proof by cones of rotations needs the comp"):
        proved = springs_certificate(made.problem, made.objective, find_optimum(made.objective))

    assert (proved is not None) == squares


def test_a_symmetry_that_moves_the_optimum_makes_it_not_unique():
    made = case("flat 9", 0)

    assert made.unique is False
    assert made.document["proof"]["symmetry"] is not None


def test_an_energy_that_is_constant_is_proved_to_be():
    problem = RegistrationProblem(np.ones((1, 3)), np.ones((1, 3)), factors=[[1, 0, 0, 0, 0, 0]])
    objective = Springs.of(problem)

    proposal: Any = cones_body(objective, [(1, 0, 0, 0)])

    assert proposal.words == producer.CONSTANT_WORDS
    outcome = cone_certificates.outcome_of(document_of(problem, proposal.body))
    assert outcome.worth.share == 0


def test_what_the_budget_does_not_allow_is_not_claimed(monkeypatch):
    made = case("flat 9", 0)
    monkeypatch.setattr(producer, "BUDGET", 20_000)
    coarse: Any = cones_body(made.objective, made.minima)
    monkeypatch.setattr(producer, "BUDGET", 100)
    nothing = cones_body(made.objective, made.minima)

    assert (coarse.words, nothing.words) == (producer.COARSE_WORDS, producer.NOTHING_WORDS)
    assert nothing.body is None
    assert coarse.body.gap < made.objective.oscillation / 10**6
