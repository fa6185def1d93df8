"""The certificate of every cell: accepted by the file alone, refused where a number is another."""

from __future__ import annotations

import base64
import copy
import json
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jsonschema
import pytest
from laws.zoo import ALL, GENERIC, named

import certreg
from certreg.certificate.envelope import Certificate
from certreg.report.reload import report_of
from certreg.verify import check

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from laws.zoo import Specimen

PACKAGE = Path(certreg.__file__).parent
LESS = {"gap", "sin2_half_angle", "sdp_gap", "scale_upper"}  # claims that bound from above
MORE = {"scale_lower"}


def document_of(one: Specimen) -> Any:
    return json.loads(one.result.certificate.to_json())


@pytest.mark.slow
def test_the_checker_alone_accepts_each_and_names_the_one_that_is_forged(tmp_path: Path):
    """One file with a certificate a line; the line that is changed is found."""
    lines = [json.dumps(document_of(one)) for one in ALL]
    forged = document_of(ALL[7])
    forged["problem"]["n"] += 1
    told = [checked_alone(tmp_path, lines), checked_alone(tmp_path, [*lines, json.dumps(forged)])]

    assert [code for code, _ in told] == [0, 1]
    assert f"{len(ALL)} of {len(ALL)}" in told[0][1]
    assert f"line {len(ALL) + 1}" in told[1][1]


def checked_alone(folder: Path, lines: list[str]) -> tuple[int, str]:
    """Exit code and words of the file alone, with nothing but the standard library."""
    path = folder / "certificates.jsonl"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    command = [sys.executable, "-I", "-S", str(PACKAGE / "verify.py"), str(path)]
    told = subprocess.run(command, capture_output=True, check=False, encoding="utf-8")
    assert told.stderr == ""
    return told.returncode, told.stdout


@pytest.mark.parametrize(**named(ALL))
def test_it_is_accepted_of_its_problem_and_has_the_form_of_its_schema(one: Specimen):
    certificate = one.result.certificate
    document = document_of(one)
    name = "certificate" if document["kind"] == "isotropic" else document["kind"]
    schema = json.loads((PACKAGE / "report" / "schemas" / f"certreg-{name}-1.json").read_bytes())

    assert certreg.verify(certificate, one.result.problem).proved
    jsonschema.Draft202012Validator(schema).validate(document)
    assert not jsonschema.Draft202012Validator(schema).is_valid({**document, "more": 1})
    assert Certificate.load(certificate.to_json()) == certificate
    assert certificate.digest == one.result.problem.digest()


def forgeries(document: Any) -> Iterator[tuple[str, Callable[[Any], object]]]:
    """Changes of one number each, by name."""
    yield "digest", lambda d: d["problem"].update(digest="0" * len(d["problem"]["digest"]))
    yield "n", lambda d: d["problem"].update(n=d["problem"]["n"] + 1)
    yield "data", lambda d: d["problem"].update(data=_flipped(d["problem"]["data"]))
    for name, claim in document["claims"].items():
        if name in LESS | MORE and claim is not None and claim[0] > 0:
            yield name, lambda d, name=name: _moved(d["claims"], name)
    if document["claims"].get("unique") is False:
        yield "unique", lambda d: d["claims"].update(unique=True)
    if "upper" in document["claims"]:
        yield "upper", lambda d: d["claims"].update(upper=d["claims"]["upper"] - 1)
    if "pattern" in document["claims"]:
        yield "pattern", lambda d: d["claims"]["pattern"].append(1)
    for part in (document, document.get("proof") or {}):
        if "pose" in part:
            yield "pose", lambda d, here=part is document: _turned(d if here else d["proof"])


def _flipped(data: str) -> str:
    content = bytearray(base64.b64decode(data))
    content[-9] ^= 1  # of the last number but one: no header
    return base64.b64encode(content).decode()


def _moved(claims: Any, name: str) -> None:
    """To next to nothing of the bound; half as much again of what is bounded from below."""
    mantissa, exponent = claims[name]
    claims[name] = [mantissa, exponent - 60] if name in LESS else [3 * mantissa, exponent - 1]


def _turned(part: Any) -> None:
    w, x, y, z = part["pose"]
    part["pose"] = [f"-{x}".replace("--", "") if isinstance(x, str) else -x, w, z, y]


@pytest.mark.parametrize(**named(ALL))
def test_it_is_refused_where_one_number_is_another(one: Specimen):
    document = document_of(one)
    assert check(json.dumps(document).encode()).verified
    names = []
    for name, change in forgeries(document):
        forged = copy.deepcopy(document)
        change(forged)
        assert not check(json.dumps(forged).encode()).verified, name
        names.append(name)
    assert len(names) >= 4


@pytest.mark.parametrize(**named(GENERIC))
def test_of_other_data_it_proves_nothing(one: Specimen):
    target = one.given.target.copy()
    target[-1, 2] *= 1.0 + 2.0**-52
    other = one.changed(target=target).problem
    document = document_of(one)
    document["problem"]["data"] = None

    assert not certreg.verify(one.result.certificate, other).proved
    assert not check(json.dumps(document).encode()).verified
    assert certreg.verify(json.dumps(document).encode(), one.result.problem).proved


@pytest.mark.parametrize(**named(GENERIC))
def test_claims_are_no_less_than_what_the_pose_is_off(one: Specimen):
    """The gap that is claimed and the bound of the angle, beside those of the checker's numbers."""
    verdict: Any = certreg.verify(one.fit.certificate, one.fit.problem)
    body = one.fit.certificate.body

    assert body.claims.unique is True
    assert verdict.worth.angle < Fraction(1, 10**9)
    assert verdict.worth.share < Fraction(1, 10**9)
    assert float(verdict.worth.objective) == pytest.approx(one.fit.objective, rel=1e-12)


@pytest.mark.parametrize(**named(GENERIC))
def test_a_folder_holds_it_all_and_is_read_again(one: Specimen, tmp_path: Path):
    saved = one.result.save(tmp_path)
    assert saved is not None
    again = report_of(saved)

    assert certreg.verify(tmp_path).proved
    assert Certificate.load(saved) == one.result.certificate
    if not {"sigma", "covariances"} & one.options.keys():  # of which no certificate knows a size
        assert (tmp_path / "report.html").read_bytes() == again.html()
    page = (tmp_path / "report.html").read_text("utf-8")
    assert one.result.problem.digest() in page
    assert all(repr(entry) in page for entry in one.result.pose.quaternion_wxyz.tolist())
    pose = json.loads((tmp_path / "pose.json").read_text("utf-8"))
    assert pose["quaternion_wxyz"] == one.result.pose.quaternion_wxyz.tolist()
    assert pose["T_target_source"] == one.result.pose.as_matrix().tolist()
