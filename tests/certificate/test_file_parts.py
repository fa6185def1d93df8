"""Files of all kinds are read by one derivation: forged at any place, they are refused there."""

from __future__ import annotations

import copy
import json
import math
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jsonschema
import numpy as np
import pytest

from certreg.certificate.checking import verify
from certreg.certificate.consensus import Stage
from certreg.certificate.envelope import BODIES, LINE, Certificate, body_of
from certreg.certificate.file_parts import MisreadError, form_of
from certreg.certificate.producing_consensus import ConsensusProver, consensus_certificate
from certreg.errors import InvalidFileError
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.results import Brief
from certreg.verify import DIGITS_MAX, EXPONENT_MAX, RefusalError, parse

if TYPE_CHECKING:
    from collections.abc import Iterator

    Place = tuple[str | int, ...]


VECTORS = Path(__file__).parents[2] / "vectors"
REFUSED = r"^the certificate: is no certificate \((.*)\): give a file that certreg wrote$"
OTHERS = {"about", "fit", "data"}  # of formats of their own
LISTS = {"stages", "pieces"}  # whose entries the checker reads where it proves
OPTIONAL = {"basin", "radius", "reach", "sdp"}  # objects that may be null
WRONG = (
    True,
    0,
    -1,
    0.5,
    "x",
    None,
    [],
    [1],
    [0, 0],
    [0, EXPONENT_MAX + 1],
    [[]],
    [None],
    {},
    {"more": None},
)
ENVELOPE = {"format", "kind", "problem"}


@cache
def accepted(kind: str) -> list[dict[str, Any]]:
    documents = (json.loads(path.read_bytes()) for path in sorted(VECTORS.glob("accept-*.json")))
    return [document for document in documents if document["kind"] == kind]


def places(value: Any, within: Place = ()) -> Iterator[Place]:
    """Of everything in an object or a list."""
    for name, part in value.items() if isinstance(value, dict) else enumerate(value):
        if name not in OTHERS:
            yield (*within, name)
            if isinstance(part, dict | list):
                yield from places(part, (*within, name))


@cache
def cases(kind: str) -> list[tuple[dict[str, Any], Place]]:
    """A certificate for each place that a kind has; all entries of a list are one place."""
    found = {
        tuple("" if isinstance(name, int) else name for name in place): (document, place)
        for document in accepted(kind)
        for place in places(document)
    }
    return list(found.values())


def at(document: Any, place: Place) -> Any:
    for name in place:
        document = document[name]
    return document


def changed(document: dict[str, Any], place: Place, value: Any) -> dict[str, Any]:
    copied = copy.deepcopy(document)
    at(copied, place[:-1])[place[-1]] = value
    return copied


def words(place: Place) -> str:
    return "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in place).lstrip(".")


def fault(content: str) -> str | None:
    """What is said to be wrong with a file; None where it is read."""
    try:
        Certificate.load(content.encode())
    except InvalidFileError as error:
        return re.sub(REFUSED, r"\1", str(error))
    return None


def well_formed(content: str) -> bool:
    """Whether the checker reads it."""
    try:
        parse(content.encode())
    except RefusalError:
        return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("kind", BODIES)
def test_what_is_read_is_written_again_byte_for_byte(kind):
    for document in accepted(kind):
        line = LINE.encode(document).encode() + b"\n"

        assert Certificate.load(line).line() == line


@pytest.mark.parametrize("kind", BODIES)
def test_a_value_of_a_wrong_type_is_refused_at_its_place(kind):
    for document, place in cases(kind):
        said = fault(json.dumps(changed(document, place, 0.5))) or ""
        named, wrong, _ = said.partition(" is not ")

        assert wrong
        assert words(place).startswith(named)


@pytest.mark.slow
@pytest.mark.parametrize("kind", BODIES)
def test_what_the_checker_cannot_read_is_refused(kind):
    """What it reads, too, where it is stages, which it looks at later, or null in part."""
    for document, place in cases(kind):
        for value in WRONG:
            content = json.dumps(changed(document, place, value))
            read, later = fault(content) is None, LISTS & {*place}
            in_part = value is None and place[0] in OPTIONAL

            assert read == well_formed(content) or (not read and (later or in_part))


@pytest.mark.slow
@pytest.mark.parametrize("kind", BODIES)
def test_a_key_that_is_missing_or_too_many_is_refused(kind):
    optional = set[str]()
    for document, place in [*cases(kind), (accepted(kind)[0], ("kind",))]:
        copied = copy.deepcopy(document)
        part = at(copied, place[:-1])
        if isinstance(part, dict):
            del part[place[-1]]
            said = fault(json.dumps(copied))
            optional |= {str(place[-1])} if said is None else set()
            assert (said is None) == well_formed(json.dumps(copied))
            assert said is None or "must have exactly the keys " in said
            more = changed(document, (*place[:-1], "more"), 0)
            assert "must have exactly the keys " in (fault(json.dumps(more)) or "")
    assert optional <= {"radius", "reach", "rotation_only", "springs"}


@pytest.mark.parametrize("kind", BODIES)
def test_no_number_is_not_a_number_or_of_no_end(kind):
    for document, place in cases(kind):
        if isinstance(at(document, place), int):
            content = json.dumps(changed(document, place, "@"))
            huge = content.replace('"@"', "9" * (DIGITS_MAX + 1))

            assert fault(content.replace('"@"', "NaN")) == (
                "the certificate is not JSON in UTF-8 of a sane depth"
            )
            assert fault(huge) == f"an integer has more than {DIGITS_MAX} digits"
        if place[0] not in ENVELOPE:
            with pytest.raises(MisreadError, match=" is not "):
                body_of(changed(document, place, math.nan))


@pytest.mark.parametrize("content", ["[]", "null", "1", '"x"', "{}", '{"kind": "count"}'])
def test_what_is_no_object_of_a_kind_is_refused(content):
    assert fault(content) in {
        "the certificate is not an object",
        "the certificate must have exactly the keys about format kind problem",
    }


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ([3, 9], "the certificate is not a list of 3 entries"),
        ([3, 9, [], 0], "the certificate is not a list of 3 entries"),
        ([3, 9, 0], "[2] is not a list"),
        ([3, 9, [[4], []]], "[2][1] is not a list of 1 or more entries"),
        ([3, 9, [[True]]], "[2][0][0] is not an integer"),
        ([3, 9, [[[4, 5, 6]]]], "[2][0][0] is not a list of integers of the right length"),
        ([3, 9, [[4, [[5], [6]], [[7]]]]], "[2][0][2] is not a list of 2 entries"),
        ([3, 9, [[4, [[5], [6], [7]]]]], "[2][0][1] is not a list of 2 entries"),
        ([3, 9, [[4, [[5], 6]]]], "[2][0][1][1] is not a list of integers of the right length"),
    ],
)
def test_a_row_is_refused_at_its_entry(row, said):
    with pytest.raises(MisreadError, match=f"^{re.escape(said)}$"):
        Stage.from_fields(row)
    steps = [[4], [[5, 6]], [7, [[1], [2, 3]], [[], [1]]]]
    assert Stage.from_fields([3, 9, steps]).to_fields() == [3, 9, steps]


@pytest.mark.parametrize("hint", [float, list[int], tuple[str, int], int | float, Brief])
def test_a_type_outside_of_the_vocabulary_is_refused(hint):
    with pytest.raises(TypeError, match=r"no entry of a file is .*: give the field a type that"):
        form_of(hint)


ROOT = Path(__file__).parents[2]
CONSENSUS_VECTORS = sorted((ROOT / "vectors").glob("*-consensus*.json"))
TRUE = [path for path in CONSENSUS_VECTORS if path.name.startswith("accept")]
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
        path.stem
        for path in CONSENSUS_VECTORS
        if not VALIDATOR.is_valid(json.loads(path.read_bytes()))
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
