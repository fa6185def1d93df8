"""A number is one: as an attribute, in JSON, in text, on a page; and who counts parameters."""

from __future__ import annotations

import ast
import json
import re
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jsonschema
import numpy as np
import pytest
from commands import strict_json
from laws.zoo import ALL, GENERIC, free, named
from syntax import nodes

import certreg
from certreg.problem.motion import Motion, Scale
from certreg.problem.support import Loss
from certreg.report.lines import number
from certreg.results import Absent

if TYPE_CHECKING:
    from laws.zoo import Specimen

SCHEMA = json.loads((files("certreg.report") / "schemas" / "certreg-result-1.json").read_bytes())
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


@pytest.mark.parametrize(**named(ALL))
def test_the_document_holds_the_attributes_and_has_the_form_of_its_schema(one: Specimen):
    result, fit = one.result, one.fit
    document: Any = strict_json(json.dumps(result.to_dict(), allow_nan=False))
    pose = document["pose"]

    VALIDATOR.validate(document)
    assert document["n"] == one.n
    assert pose["rotation"] == result.pose.rotation.tolist()
    assert pose["translation"] == result.pose.translation.tolist()
    assert pose["quaternion_wxyz"] == result.pose.quaternion_wxyz.tolist()
    assert (document["objective"], document["rmse"]) == (fit.objective, fit.rmse)
    assert document["digest"] == result.problem.digest()
    assert document["theorems"] == list(result.verdict.theorems)
    assert document["optimality"]["status"] == fit.status.value
    assert document["optimality"]["unique"] == fit.unique
    worst = [(each["row"], each["distance"]) for each in document["residuals"]]
    distances = result.residuals
    assert [distance for _, distance in worst] == sorted(distances.tolist(), reverse=True)[:10]
    assert [distances[row] for row, _ in worst] == [distance for _, distance in worst]
    assert {each["row"] for each in document["fit"]["worst"]} <= set(one.rows.tolist())
    assert (document["springs"] is not None) is one.cell.springs
    if one.cell.scaled:
        assert pose["scale"] == result.pose.scale
    if one.cell.loss is not Loss.SQUARES:
        assert document[one.cell.loss.value]["labels"] == list(result.labels)
        assert document[one.cell.loss.value]["headline"] == result.headline
    else:
        assert result.stated("labels").reason == "all pairs count: none is labelled"


PRESENT = ("problem", "pose", "fit", "residuals", "rmse", "objective", "certificate", "verdict")
MAYBE = ("covariance", "equilibria", "robustness", "trajectory")


@pytest.mark.parametrize(**named(GENERIC))
def test_no_attribute_is_missing_and_what_is_none_says_why(one: Specimen):
    for name in PRESENT:
        assert getattr(one.result, name) is not None, name
    for name in MAYBE:
        stated = one.result.stated(name)
        assert isinstance(stated, Absent) is (getattr(one.result, name) is None), name


@pytest.mark.parametrize(**named(GENERIC))
def test_deviations_are_those_of_the_observations_that_the_parameters_leave(one: Specimen):
    fit, pose = one.fit, one.result.to_dict()["pose"]
    W = one.matrices[one.rows]
    ranks = np.linalg.matrix_rank(W / np.linalg.norm(W, axis=(1, 2))[:, None, None], tol=1e-9)
    degrees = int(ranks.sum()) - len(free(one))

    assert fit.degrees_of_freedom == degrees
    if fit.covariance is None:
        return
    assert fit.covariance.variance_factor == pytest.approx(fit.objective / degrees, rel=1e-9)
    assert pose["uncertainty"]["degrees_of_freedom"] == degrees
    assert np.shape(pose["covariance"]) == (6 + one.cell.scaled,) * 2
    assert ("scale" in pose["uncertainty"]) is one.cell.scaled
    if fit.fit.chi2:
        assert fit.fit.chi2.dof == degrees
        assert fit.fit.chi2.value == pytest.approx(fit.objective, rel=1e-9)


@pytest.mark.parametrize(**named(GENERIC))
def test_text_and_card_say_these_numbers(one: Specimen):
    result, text = one.result, str(one.result)
    digits = [*result.pose.quaternion_wxyz.tolist(), *result.pose.translation.tolist()]
    spoken = [entry for entry in digits if entry]

    assert all(repr(entry) in text for entry in spoken)
    assert number(one.fit.rmse) in text
    assert result.headline.split(":")[0] in text
    assert result.headline.split(":")[0].split(",")[0] in result._repr_html_()
    assert result.summary() == text
    assert len(repr(result)) <= 200
    if one.cell.scaled:
        assert repr(result.pose.scale) in text
    told = one.fit.covariance is not None and not one.fit.fit.warnings
    assert ("rotation +/-" in text) is told
    assert ("translation +/-" in text) is (told and not one.cell.rotation_only)
    assert ("scale +/-" in text) is (told and one.cell.scaled)


FITTED = sorted(  # those first whose noise is known; of truncated squares no fit is told
    (one for one in GENERIC if one.cell.loss is not Loss.TRUNCATED),
    key=lambda one: not {"sigma", "covariances"} & one.options.keys(),
)


def counted(one: Specimen) -> dict[str, Any]:
    """What rests on the number of parameters; of the symmetric scale the first alone.

    Points beside covariances have no noise that is known, and no +-.
    """
    result = one.changed().result
    fit = result if one.cell.loss is Loss.SQUARES else result.fit
    found: dict[str, Any] = {"degrees": fit.degrees_of_freedom}
    if one.cell.scale is Scale.SYMMETRIC or fit.covariance is None:
        return found
    document = {name: part for name, part in result.to_dict().items() if name != "timings_ms"}
    found["document"] = str(document)
    if fit.fit.chi2:
        return {**found, "chi2": (fit.fit.chi2.dof, fit.fit.chi2.p)}
    sigmas = fit.covariance.rotation_sigma, fit.covariance.translation_sigma
    return {**found, "+-": str(sigmas), "matrix": str(fit.covariance.matrix)}


@pytest.mark.parametrize(**named(FITTED))
def test_parameters_are_counted_by_the_motion_alone(one: Specimen, monkeypatch: pytest.MonkeyPatch):
    """One more changes degrees of freedom, +-, chi-squared, covariance and JSON in every cell."""
    right = counted(one)
    count: Any = Motion.parameters
    monkeypatch.setattr(Motion, "parameters", property(lambda self: count.fget(self) + 1))
    wrong = counted(one)

    assert right.keys() == wrong.keys()
    assert [name for name in right if right[name] == wrong[name]] == []
    assert right["degrees"] == wrong["degrees"] + 1


@pytest.mark.slow
def test_nobody_else_subtracts_parameters():
    """No 3 n - 6 and no 3 n - 7: what is left of observations is said by the motion."""
    package = Path(certreg.__file__).parent
    wings = ("problem", "registration", "report")
    sources = [file for wing in wings for file in (package / wing).glob("*.py")]
    found = [
        f"{file.name}: {ast.unparse(node)}"
        for file in sources
        if file.name != "motion.py"
        for node in nodes(file.read_text("utf-8"))
        if isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.Sub)
        and re.search(r"^[67]$|\bparameters$", ast.unparse(node.right))
    ]

    assert len(sources) > 100
    assert found == []
