"""Counterexamples as certified problems: the clouds of the audit, and the checker's word."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import pytest

from certreg.certificate.checking import verify
from certreg.certificate.count import count_certificate
from certreg.errors import InvalidProblemError
from certreg.objective.classification import classify
from certreg.paper import derivation
from certreg.paper import verdicts as certifying
from certreg.paper.claims import Evidence
from certreg.paper.verdicts import ClaimVerdict, certified_clouds, in_integers
from certreg.problem.moments import exact_moments

ROWS = {row.number: row for row in derivation.paper_claims()}
REFUTED = [number for number, row in ROWS.items() if row.counterexample]
each_refuted = pytest.mark.parametrize("number", REFUTED)
PATTERNS = {
    **{number: [[1, 1, 1, 1]] for number in REFUTED},
    "6a": [[3, 1]],
    "6c": [[3, 1]],
    "7": [[3, 1], [2, 1, 1], [4]],
    "9a": [[1, 1, 1, 1], [1, 1, 1, 1], [2, 1, 1]],
    "9c": [[1, 3]],
    "9d": [[1, 2, 1]],
}


def documents(certified) -> list[dict]:
    return [json.loads(content) for content in certified.files.values()]


@each_refuted
def test_every_cloud_is_certified_with_the_pattern_that_refutes_the_claim(number: str):
    found = certified_clouds(ROWS[number])

    assert len(found) == len(ROWS[number].counterexample.clouds)
    assert [documents(each)[0]["claims"]["pattern"] for each in found] == PATTERNS[number]
    for each in found:
        assert each.verdict.proved
        for content in each.files.values():
            assert verify(content).proved
            assert not verify(content.replace(b'"format"', b'"former"')).proved


@each_refuted
def test_the_points_are_the_counterexamples_own_in_another_unit(number: str):
    for cloud, certified in zip(
        ROWS[number].counterexample.clouds, certified_clouds(ROWS[number]), strict=True
    ):
        block = certified.problem.block(slice(None))
        source, target = ([Fraction(e) for e in a.ravel()] for a in (block.source, block.target))
        own = [Fraction(e) for point in (*cloud.source, *cloud.target) for e in point]
        (unit,) = {a / b for a, b in zip(source + target, own, strict=True) if b}

        assert source + target == [unit * e for e in own]
        assert classify(exact_moments(certified.problem)) == cloud.classification


def test_the_bound_on_the_number_stands_beside_the_pattern_where_there_are_four():
    for number in REFUTED:
        for certified, pattern in zip(
            certified_clouds(ROWS[number]), PATTERNS[number], strict=True
        ):
            kinds = [document["kind"] for document in documents(certified)]
            assert kinds == ["isotropic", "count"][: 1 + (pattern == [1, 1, 1, 1])]


def test_the_words_say_how_far_the_papers_start_is_from_the_optimum():
    (at_saddle,), (stopped,) = certified_clouds(ROWS["15a"]), certified_clouds(ROWS["15c"])

    assert "one optimum, 180° from R = I" in at_saddle.words
    assert "one optimum, 179.9999° from R = I" in stopped.words


def test_a_true_claim_has_no_certified_cloud():
    assert certified_clouds(ROWS["1"]) == ()


def test_coordinates_that_no_unit_makes_doubles_are_refused():
    cloud = ROWS["12"].counterexample.clouds[0]
    far = replace(cloud, target=((2**53 + 1, 0, 0), *cloud.target[1:]))

    with pytest.raises(InvalidProblemError, match="no double"):
        in_integers(far)


def test_a_claim_whose_certificate_is_refused_is_not_confirmed(monkeypatch):
    right = certifying.produce

    def forged(problem, found, about):
        certificate = right(problem, found, about=about)
        assert certificate is not None
        body = certificate.body
        return replace(certificate, body=replace(body, claims=replace(body.claims, unique=True)))

    monkeypatch.setattr(certifying, "produce", forged)
    row = ROWS["6a"]
    agreeing = Evidence(words="measured", agrees=True)
    claim = ClaimVerdict(row=row, proof=None, evidence=agreeing, certified=certified_clouds(row))

    assert not claim.stands
    monkeypatch.setattr(certifying, "produce", lambda *_, **__: None)
    assert not replace(claim, certified=certified_clouds(row)).stands


def test_a_refusal_of_the_second_certificate_is_the_verdict(monkeypatch):
    def forged(problem):
        made = count_certificate(problem)
        assert made is not None
        return replace(made, body=replace(made.body, modulus=2))

    monkeypatch.setattr(certifying, "count_certificate", forged)

    (certified,) = certified_clouds(ROWS["12"])

    assert not certified.verdict.proved
