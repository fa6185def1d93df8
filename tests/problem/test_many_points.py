"""Certificates of many points: the file in pieces, checked in blocks by a second method."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

import certreg
from certreg import RegistrationProblem
from certreg.certificate import blockwise, checking, envelope
from certreg.certificate.blockwise import check_in_blocks, check_on_sums
from certreg.certificate.count import count_certificate
from certreg.certificate.envelope import PIECE, file_pieces
from certreg.errors import RefusedCertificateError
from certreg.exact.dyadic import Dyadic
from certreg.problem.exact_sums import SumMethod, fastest_method, second_method, sums_by
from certreg.registration.squares import solve
from certreg.results import Optimality, Ruling
from certreg.verify import check, moments

CHECKS = (check_in_blocks, check_on_sums)
texts = st.text(max_size=20) | st.sampled_from(['"data": null', '"data": ', "null", '"'])


def random_problem(**options) -> RegistrationProblem:
    return strategies.random_problem(np.random.default_rng(2), **options)


@pytest.mark.slow
@given(st.binary(max_size=20), texts, st.dictionaries(texts, texts | st.none(), max_size=3))
def test_a_file_in_pieces_is_the_json_of_its_document(data, kind, about):
    def document(text):
        return {"about": about, "kind": kind, "problem": {"data": text, "n": 1}, "sdp": {"nu": 1}}

    for content, text in ((data, base64.b64encode(data).decode()), (None, None)):
        whole = json.dumps(document(text), sort_keys=True, indent=1) + "\n"
        assert b"".join(file_pieces(document(None), content)) == whole.encode()


def test_data_larger_than_a_piece_is_encoded_as_one():
    data = np.random.default_rng(0).bytes(2 * PIECE + 5)

    *_, last = written = list(file_pieces({"data": None}, data))
    assert len(written) == 5
    assert json.loads(b"".join(written)) == {"data": base64.b64encode(data).decode()}
    assert last.endswith(b'"\n}\n')


@pytest.mark.slow
@given(strategies.problems())
def test_sums_by_either_way_are_the_moments_of_the_checker(problem):
    """The table is filled from i <= j, over one power of two; of y with y it has squares only."""
    places = [(i, j) for i in range(7) for j in range(i, 7 if i < 4 else i + 1)]
    m, e = moments(problem.data_bytes()[26:], problem.n)
    expected = [m[i][j] * Fraction(2) ** e for i, j in places]

    for table in (blockwise._added_moments, blockwise._table_of_sums):
        found, unit = table(problem)
        assert [found[i][j] * Fraction(2) ** unit for i, j in places] == expected


@pytest.mark.slow
@given(strategies.problems())
def test_many_points_are_accepted_with_the_theorems_that_the_checker_finds(problem):
    certificate = solve(problem).certificate
    counted = count_certificate(problem)
    for made in (certificate, counted):
        if made is not None:
            content, bare = made.to_json(), replace(made, inline=None).to_json()
            told = check(content)
            assert told.verified
            for way in CHECKS:
                for found in (way(content, problem), way(bare, problem)):
                    assert (found, found.theorems) == (told, told.theorems)


@pytest.mark.parametrize("way", CHECKS)
def test_a_certificate_of_other_points_or_of_too_strong_a_claim_is_refused(way):
    problem = random_problem()
    certificate = solve(problem).certificate
    assert certificate is not None
    moved = problem.target.copy()
    moved[3, 1] = np.nextafter(moved[3, 1], 9.0)
    body = certificate.body
    half = replace(body, claims=replace(body.claims, gap=body.claims.gap.shifted(-1)))
    low = replace(body, delta=Dyadic(mantissa=1, exponent=-4000))
    forged = {
        "other points": (certificate, RegistrationProblem(problem.source, moved)),
        "another number": (certificate, random_problem(n=19)),
        "2 delta": (replace(certificate, body=half), problem),
        "delta and mu": (replace(certificate, body=low), problem),
        "not canonical": (replace(certificate, inline=bytes(26 + 56 * 20)), problem),
        "the digest is not theirs": (
            replace(certificate, inline=random_problem(noise=1.0).data_bytes()),
            problem,
        ),
    }
    for words, (claimed, about) in forged.items():
        outcome = way(claimed.to_json(), about)
        assert not outcome.verified
        assert words in outcome.reason


@pytest.mark.usefixtures("compiled")
def test_its_own_certificate_of_many_points_is_checked_on_sums_by_another_method(monkeypatch):
    problem = random_problem(n=checking.PYTHON_POINTS + 1)
    methods: list[SumMethod] = []

    def noted(method, problem):
        methods.append(method)
        return sums_by(method, problem)

    monkeypatch.setattr(blockwise, "sums_by", noted)
    monkeypatch.setattr(checking, "check", None)
    registration = certreg.certify(problem, relaxation=False, simulation=False)

    assert methods == [second_method(problem)]
    assert methods != [fastest_method(problem)]
    assert SumMethod.INTEGERS not in methods
    assert registration.status is Optimality.CERTIFIED
    assert registration.certificate is not None
    assert registration.verdict is not None
    assert check(registration.certificate.to_json()).theorems == registration.verdict.theorems


def test_sums_that_err_are_refused_by_the_other_method(monkeypatch):
    problem = random_problem(n=checking.PYTHON_POINTS + 1)

    def wrong(method, about):
        found = sums_by(method, about)
        return replace(found, integers=(*found.integers[:7], *found.integers[8:], 0))

    monkeypatch.setattr(blockwise, "sums_by", wrong)
    with pytest.raises(RefusedCertificateError):
        certreg.certify(problem, relaxation=False, simulation=False)


@pytest.mark.parametrize("way", CHECKS)
@pytest.mark.parametrize("part", ["source", "target", "weights"])
def test_a_file_that_is_changed_during_a_check_is_noticed(tmp_path, monkeypatch, way, part):
    arrays = {name: getattr(random_problem(n=50), name) for name in ("source", "target", "weights")}
    for name, array in arrays.items():
        np.save(tmp_path / f"{name}.npy", array)
    x, y, w = (np.load(tmp_path / f"{name}.npy", mmap_mode="r") for name in arrays)
    problem = RegistrationProblem(x, y, weights=w)
    certificate = solve(problem).certificate
    assert certificate is not None
    content = certificate.to_json()
    assert way(content, problem).verified
    name = "_added_moments" if way is check_in_blocks else "_table_of_sums"
    table = getattr(blockwise, name)

    def meanwhile(problem):
        np.load(tmp_path / f"{part}.npy", mmap_mode="r+")[17] += 1.0
        return table(problem)

    monkeypatch.setattr(blockwise, name, meanwhile)
    outcome = way(content, problem)
    assert not outcome.verified
    assert "changed while they were read" in outcome.reason


def test_beyond_the_inline_limit_a_certificate_needs_its_points(monkeypatch, tmp_path):
    problem = random_problem(n=40)
    monkeypatch.setattr(envelope.CertificateBody, "INLINE", 39)
    monkeypatch.setattr(checking, "INLINE_MAX", 39)
    certificate = solve(problem).certificate
    assert certificate is not None
    certificate.save(tmp_path / "certificate.json")

    assert certificate.data is None
    assert (tmp_path / "certificate.json").stat().st_size < 2000
    alone = certreg.verify(tmp_path / "certificate.json")
    assert alone.ruling is Ruling.REFUTED
    assert "give SOURCE and TARGET" in alone.words
    monkeypatch.setattr(checking, "check", None)  # it would hold all points at once
    assert certreg.verify(tmp_path / "certificate.json", problem).proved
