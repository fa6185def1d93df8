"""The published JSON Schemas hold of every document of every kind of problem, and of few others."""

from __future__ import annotations

import json
from contextlib import contextmanager
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import pytest
from commands import certreg, strict_json, write_csv
from jsonschema import Draft202012Validator
from strategies import ZOO

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SHOWN = ("result", "pose", "assessment", "certificate", "equilibria", "simulation", "count")
KINDS = (*SHOWN, "roads")
SCHEMAS = (*SHOWN, "error", "reproduction")
each_specimen = pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)


@cache
def validator(kind: str) -> Any:
    kind = "equilibria" if kind == "roads" else kind
    text = (files("certreg.report") / "schemas" / f"certreg-{kind}-1.json").read_text("utf-8")
    return Draft202012Validator(json.loads(text))


@cache
def looking_first_at(kind: str, key: str) -> Any:
    """The same schema in another order: what is wrong at this key is seen before all else."""
    schema = validator(kind).schema
    properties = {key: schema["properties"][key]} | schema["properties"]
    first = {"required": schema["required"], "properties": properties}
    return Draft202012Validator(first | {name: schema[name] for name in schema.keys() - first})


def documents(folder: Path, source: Path, target: Path) -> dict[str, Any]:
    """All documents of one pair; no simulation where there is none."""
    found = {
        "result": certreg("certify", source, target, "--json", "--out", folder).document,
        "pose": strict_json((folder / "pose.json").read_bytes()),
        "equilibria": certreg("equilibria", source, target, "--json").document,
        "assessment": certreg(
            "assess", source, target, "--pose", folder / "pose.txt", "--json"
        ).document,
        "certificate": strict_json((folder / "certificate.json").read_bytes()),
    }
    roads = ("--method", "all", "--out", folder / "count.json", "--json")
    found["roads"] = certreg("equilibria", source, target, *roads).document
    if (folder / "count.json").exists():
        found["count"] = strict_json((folder / "count.json").read_bytes())
    simulated = certreg("simulate", source, target, "--json")
    if simulated.out:
        found["simulation"] = simulated.document
    return found


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("good")
    axes = ZOO[0]
    source = write_csv(folder / "a.csv", axes.source)
    return documents(folder / "out", source, write_csv(folder / "b.csv", axes.target))


@pytest.mark.one_in(3)
@pytest.mark.parametrize("kind", SCHEMAS)
def test_a_schema_is_one_of_draft_2020_12(kind: str):
    Draft202012Validator.check_schema(validator(kind).schema)
    assert validator(kind).schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert validator(kind).schema["title"] == f"certreg-{kind}/1"


def test_all_eight_kinds_of_equilibrium_set_are_in_the_zoo():
    assert len({specimen.pattern for specimen in ZOO}) == 8


@pytest.mark.slow
@pytest.mark.one_in(4)
@each_specimen
def test_every_document_of_the_zoo_is_valid(specimen, tmp_path: Path):
    source = write_csv(tmp_path / "a.csv", specimen.source)
    target = write_csv(tmp_path / "b.csv", specimen.target)

    for kind, document in documents(tmp_path / "out", source, target).items():
        assert [error.message for error in validator(kind).iter_errors(document)] == [], kind


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("pair", ["survey", "head", "abeta"])
def test_the_documents_of_real_data_are_valid(pair: str, data: Path, tmp_path: Path):
    source, target = sorted(data.glob(f"{pair}_*.csv"))[:2]
    if pair == "survey":
        source, target = data / "survey_source.csv", data / "survey_target.csv"

    found = documents(tmp_path, source, target)

    assert found.keys() == set(KINDS)
    for kind, document in found.items():
        assert [error.message for error in validator(kind).iter_errors(document)] == [], kind


def test_a_pose_far_off_and_one_that_is_none_are_valid_assessments(data: Path, tmp_path: Path):
    pair = data / "survey_source.csv", data / "survey_target.csv"
    for name, pose in {"far": "1 0 0 0 0 0 0", "none": "[[1,2,3],[4,5,6],[7,8,9]]"}.items():
        file = tmp_path / name
        file.write_text(pose, "utf-8")
        run = certreg("assess", *pair, "--pose", file, "--json")
        if run.code == 1:
            assert validator("assessment").is_valid(run.document)


def paths_of(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield path
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from paths_of(inner, (*path, key))


@contextmanager
def changed(document: Any, path: tuple, *value: Any) -> Iterator[Any]:
    """The document with another value there, or none; afterwards it is as it was."""
    part = document
    for step in path[:-1]:
        part = part[step]
    before = dict(part)
    part.pop(path[-1], None)
    part.update(zip(path[-1:], value, strict=False))
    yield document
    part.clear()
    part.update(before)


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("kind", KINDS)
def test_no_key_may_be_missing(kind: str, good):
    free = ("about", "reasons", "timings_ms")
    for path in list(paths_of(good[kind])):
        if path and path[0] not in free[:1] and not (len(path) > 1 and path[0] in free):
            seen = looking_first_at(kind, *path[:1])
            with changed(good[kind], path) as document:
                assert seen.is_valid(document) == (path == ("radius",)), path


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("kind", KINDS)
def test_no_value_may_be_of_another_type(kind: str, good):
    free = ("about", "reasons", "timings_ms")
    for path in list(paths_of(good[kind])):
        if path and not (len(path) > 1 and path[0] in free):
            for wrong in ({"not": [1]}, [[[[]]]]):
                if path == ("about",) and isinstance(wrong, dict):
                    continue
                with changed(good[kind], path, wrong) as document:
                    assert not looking_first_at(kind, *path[:1]).is_valid(document), path


@pytest.mark.one_in(4)
@pytest.mark.parametrize(
    ("kind", "path", "value"),
    [
        ("result", ("schema",), "certreg-result/2"),
        ("result", ("n",), 0),
        ("result", ("rmse",), -1.0),
        ("result", ("digest",), "0" * 63),
        ("result", ("optimality", "unique"), False),
        ("result", ("equilibria", "pattern"), [2, 2]),
        ("result", ("equilibria", "pattern"), [1, 1, 1]),
        ("result", ("pose", "rotation"), [[1, 0], [0, 1]]),
        ("equilibria", ("equilibria", "count"), 5),
        ("assessment", ("verdict",), "fine"),
        ("assessment", ("angle_to_optimum_deg",), 181),
        ("simulation", ("step",), 0),
        ("simulation", ("steps",), 1.5),
        ("simulation", ("integrator",), "leapfrog"),
        ("certificate", ("kind",), "anisotropic"),
        ("certificate", ("more",), 1),
        ("certificate", ("claims", "more"), 1),
        ("certificate", ("claims", "gap"), [1.5, 0]),
        ("certificate", ("claims", "gap"), [0, 0]),
        ("certificate", ("claims", "gap"), [1, 0, 0]),
        ("certificate", ("claims", "unstable"), [0, 2, 1]),
        ("certificate", ("optimality", "delta"), [-1, 0]),
        ("certificate", ("optimality", "mu"), [1, 32769]),
        ("certificate", ("pose",), [1, 2, 3]),
        ("certificate", ("problem", "data"), "AAA*"),
        ("certificate", ("basin", "quaternion"), [1, 2, 3]),
        ("certificate", ("sdp", "nu"), None),
        ("roads", ("roads",), []),
        ("roads", ("agreement", "rotation_deg"), -1.0),
        ("count", ("kind",), "isotropic"),
        ("count", ("claims", "at_most"), 3),
        ("count", ("proof", "modulus"), 1),
        ("count", ("proof", "modulus"), 2**64),
        ("count", ("proof", "chart"), [1, 0, 0]),
        ("count", ("pose",), [1, 0, 0, 0]),
    ],
)
def test_what_is_wrong_is_not_valid(kind: str, path: tuple, value: Any, good):
    assert validator(kind).is_valid(good[kind])

    with changed(good[kind], path, value) as document:
        assert not validator(kind).is_valid(document)


def test_every_schema_says_what_it_describes():
    for file in (files("certreg.report") / "schemas").iterdir():
        schema = json.loads(file.read_text("utf-8"))
        assert schema["title"]
        assert schema["description"].endswith("."), file.name
