"""The file of a certificate of consensus: its form, read and written again."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from certreg.certificate.checking import verify
from certreg.certificate.envelope import Certificate
from certreg.certificate.producing_consensus import ConsensusProver, consensus_certificate
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem

ROOT = Path(__file__).parents[2]
VECTORS = sorted((ROOT / "vectors").glob("*-consensus*.json"))
TRUE = [path for path in VECTORS if path.name.startswith("accept")]
SCHEMA = json.loads(
    (ROOT / "certreg" / "report" / "schemas" / "certreg-consensus-1.json").read_bytes()
)
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


@pytest.mark.parametrize("path", TRUE, ids=lambda path: path.stem)
def test_an_accepted_vector_has_the_form_of_the_schema_and_is_read_as_it_was_written(path):
    document = json.loads(path.read_bytes())
    loaded = Certificate.load(path)

    VALIDATOR.check_schema(SCHEMA)
    VALIDATOR.validate(document)
    assert json.loads(loaded.to_json()) == document
    assert Certificate.load(loaded.to_json()).body == loaded.body


def test_what_the_checker_calls_no_number_row_or_list_has_not_the_form_of_the_schema():
    strange = {
        "refuse-consensus-group-of-a-row-twice",
        "refuse-consensus-group-of-a-weight-below-0",
        "refuse-consensus-group-of-no-row",
        "refuse-consensus-label-of-another-letter",
        "refuse-consensus-pair-of-one-row",
        "refuse-consensus-stage-number-true",
        "refuse-consensus-stage-of-two-entries",
        "refuse-consensus-stages-in-an-object",
        "refuse-consensus-step-of-a-row-below-0",
        "refuse-consensus-step-without-a-row",
        "refuse-consensus-with-a-pose",
        "refuse-consensus-witness-of-five-numbers",
    }
    spoilt = {
        path.stem for path in VECTORS if not VALIDATOR.is_valid(json.loads(path.read_bytes()))
    }

    assert strange <= spoilt
    assert not spoilt & {path.stem for path in TRUE}


def test_pairs_that_fit_without_any_error_are_proved_as_others_are():
    """No group of them is refuted: their residuals, and so all weights, become 0."""
    rng = np.random.default_rng(0)
    source = rng.integers(-6, 7, (12, 3)).astype(float)
    target = source + np.array([5.0, -3.0, 2.0])
    target[6:] = target[6:][rng.permutation(6)]
    problem = bounded(RegistrationProblem(source, target), 0.5)

    found = ConsensusProver(problem).prove(np.eye(3), np.array([5.0, -3.0, 2.0]))

    assert found is not None
    assert verify(consensus_certificate(problem, found, None).to_json()).proved
