"""Certificates of kind "count": true ones pass, forged ones are refused."""

from __future__ import annotations

import copy
import itertools
import json
import random
import subprocess
import sys
from importlib import import_module
from typing import TYPE_CHECKING

import certificates as oracle
import numpy as np
import pytest
import strategies
from commands import certreg, checked, write_csv
from hypothesis import given
from hypothesis import strategies as st

from certreg.certificate.checking import check_own
from certreg.certificate.count import count_certificate
from certreg.geometry.so3 import rotation_matrix
from certreg.registration.enumeration import certified_count

if TYPE_CHECKING:
    from pathlib import Path

checker = import_module("certreg.verify")
small = st.integers(-5, 5)
GOOD = json.loads(checked(count_certificate(strategies.ZOO[0].problem)).to_json())


def refused(certificate) -> bool:
    outcome = checker.check(oracle.dump(certificate))
    assert outcome.verified == (outcome.reason == "") == bool(outcome.theorems)
    assert outcome.reason.isascii()
    return not outcome.verified


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_exactly_the_finite_sets_get_a_certificate_that_the_checker_accepts(specimen):
    certificate = certified_count(specimen.problem)

    assert (certificate is not None) == (specimen.pattern == (1, 1, 1, 1))
    if certificate is not None:
        verdict = check_own(certificate, specimen.problem)
        assert verdict.proved
        assert any("At most four" in theorem for theorem in verdict.theorems)


@pytest.mark.parametrize("seed", range(20))
def test_random_problems_are_certified_and_about_no_others(seed):
    problem = strategies.random_problem(np.random.default_rng(seed), noise=0.3, decades=4)
    certificate = count_certificate(problem)
    other = strategies.random_problem(np.random.default_rng(seed + 100))

    assert certificate is not None
    assert check_own(certificate, problem).proved
    assert not check_own(certificate, other).proved


@pytest.mark.slow
@given(st.lists(small, min_size=4, max_size=4), st.lists(small, min_size=9, max_size=9))
def test_the_checkers_coefficients_are_those_of_the_torques_of_R(q, entries):
    C = [entries[:3], entries[3:6], entries[6:]]
    R = [list(row) for row in rotation_matrix(q)]
    total = [0] * 6
    for i, j in checker.PAIRS:
        column = checker.torques(checker.rotation_coefficient(i, j), C)
        total = [t + q[i] * q[j] * c for t, c in zip(total, column, strict=True)]

    assert total == checker.torques(R, C)


@given(st.lists(st.lists(st.integers(-9, 9), min_size=3, max_size=3), min_size=3, max_size=3))
def test_full_rank_modulo_a_number_is_full_rank(rows):
    determinant = oracle.determinant(rows)
    for modulus in (2, 3, 4, 6, 7, 101, 2**61 - 1):
        if checker.has_rank(rows, 3, modulus):
            assert determinant % modulus != 0
        elif modulus in {2, 3, 7, 101}:
            assert determinant % modulus == 0


@pytest.mark.slow
def test_no_proof_passes_where_the_equilibria_form_a_continuum():
    """Whatever the chart and the modulus: the theorem would be false."""
    random.seed(3)
    for specimen in strategies.ZOO:
        if specimen.pattern == (1, 1, 1, 1):
            continue
        content = oracle.problem_bytes(
            specimen.source, specimen.target, np.ones(len(specimen.source))
        )
        certificate = copy.deepcopy(GOOD)
        certificate["problem"] = oracle.stated_problem(content, len(specimen.source))
        for _ in range(30):
            certificate["proof"] = {
                "chart": [random.randint(-99, 99) for _ in range(4)],
                "modulus": random.randint(2, 2**64 - 1),
            }
            assert refused(certificate), specimen.name


def test_every_part_is_needed_and_nothing_else_is_taken():
    assert not refused(GOOD)
    for path in [*itertools.chain([(k,) for k in GOOD]), *[("proof", k) for k in GOOD["proof"]]]:
        less = copy.deepcopy(GOOD)
        part = less
        for step in path[:-1]:
            part = part[step]
        del part[path[-1]]
        assert refused(less), path
        if path != ("about",):
            for value in (None, True, 1.5, "x", [], {}, [1, 2, 3, 4.0], -1, [10**4000] * 5):
                part[path[-1]] = value
                assert refused(less), (path, value)
    for key in ("pose", "optimality", "sdp", "basin"):
        assert refused(GOOD | {key: None})
    assert refused(GOOD | {"kind": "isotropic"})


@pytest.mark.parametrize("at_most", [-4, 0, 1, 2, 3])
def test_fewer_than_four_are_not_proved(at_most):
    assert refused(GOOD | {"claims": {"at_most": at_most}})


def test_with_a_half_turn_only_a_chart_that_sees_it_proves_the_count():
    """C = diag(-18, -8, -2): the optimum is at w = 0."""
    source = np.array(strategies.AXES)
    content = oracle.problem_bytes(source, -source, np.ones(6))
    certificate = GOOD | {"problem": oracle.stated_problem(content, 6)}

    assert refused(certificate | {"proof": {"chart": [1, 0, 0, 0], "modulus": 2**61 - 1}})
    assert not refused(certificate | {"proof": {"chart": [1, 2, 4, 8], "modulus": 2**61 - 1}})


@pytest.mark.slow
def test_the_command_writes_a_certificate_that_the_checker_accepts_alone(data, tmp_path: Path):
    out = tmp_path / "count.json"
    run = certreg(
        "equilibria", data / "survey_source.csv", data / "survey_target.csv", "--out", out
    )
    alone = subprocess.run(
        [sys.executable, "-I", "-S", str(checker.__file__), str(out)],
        capture_output=True,
        text=True,
        check=False,
        encoding="utf-8",
    )

    assert run.code == 0
    assert "certificate of the count" in run.err
    assert alone.returncode == 0
    assert alone.stdout.splitlines()[-1] == "VERIFIED"
    assert "At most four rotations" in alone.stdout


def test_the_command_says_why_there_is_no_certificate_of_a_continuum(tmp_path: Path):
    square = write_csv(tmp_path / "square.csv", strategies.SQUARE)
    run = certreg("equilibria", square, square, "--out", tmp_path / "count.json")

    assert run.code == 0
    assert "infinitely many" in run.err
    assert not (tmp_path / "count.json").exists()
