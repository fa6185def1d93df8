"""Each verb of each cell of the table, as it is typed: an answer, or the table's sentence."""

from __future__ import annotations

import csv
import itertools
import json
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple

import jsonschema
import numpy as np
import pytest
from campaign_work import InProcess
from commands import certreg as command
from commands import strict_json, write_csv
from laws.cells import CELLS, DATA, LOSSES, SOURCE, cell_of, options_of, target_of

import certreg
from certreg.errors import InvalidProblemError
from certreg.problem.support import Cell, Loss, Verb, refusal, supported

if TYPE_CHECKING:
    from pathlib import Path

    from commands import Run

    Key = tuple[str, str, Loss]


class Question(NamedTuple):
    """A command about a problem, and the verb of the table that it asks for."""

    arguments: tuple[str, ...]
    verb: Verb


SOLVED: dict[str, Question] = {
    "equilibria": Question(("equilibria",), Verb.CERTIFY),  # by the first method that there is
    "simulate": Question(("simulate",), Verb.MIDPOINT),  # by the first integrator
    "optimal damping": Question(("simulate", "--damping", "optimal"), Verb.DAMPING),
    **{
        verb.value: Question(("equilibria", "--method", verb.value), verb)
        for verb in (Verb.SPECTRAL, Verb.GROEBNER, Verb.HOMOTOPY, Verb.ALL_METHODS)
    },
    **{
        verb.value: Question(("simulate", "--integrator", verb.value), verb)
        for verb in (Verb.MIDPOINT, Verb.SPLITTING, Verb.EULER)
    },
}
# On springs what is asked for by its name takes half a second, or is what is asked for by none.
NAMED = [Verb.GROEBNER, Verb.ALL_METHODS, Verb.HOMOTOPY, Verb.MIDPOINT]
SQUARES = [key for key in CELLS if key[2] is Loss.SQUARES]
ON_SPRINGS = [key for key in SQUARES if cell_of(*key).springs and supported(cell_of(*key))]
ANSWERED, ASKED = 142, 440  # a cell or a verb that opens changes this knowingly


@pytest.fixture(name="clouds", scope="module")
def _clouds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cells")
    write_csv(folder / "source.csv", SOURCE.tolist())
    for name, cell in (("moved", Cell()), ("turned", Cell(rotation_only=True))):
        write_csv(folder / f"{name}.csv", target_of(cell).tolist())
    for rows in DATA.values():
        for name, values in rows.items():
            upper = values if values.ndim == 2 else values[(slice(None), *np.triu_indices(3))]
            np.save(folder / f"{name}.npy", upper)
    np.savetxt(folder / "pose.txt", np.eye(4))
    np.savetxt(folder / "labels.csv", np.ones(len(SOURCE)), "%d")
    return folder


def fields_of(key: Key) -> dict[str, str]:
    """What a user gives for a cell, by the columns of a list."""
    data, _, _ = key
    cell, given = cell_of(*key), options_of(cell_of(*key), data)
    return {
        "source": "source.csv",
        "target": "turned.csv" if cell.rotation_only else "moved.csv",
        **{name: f"{name}.npy" for name in DATA[data]},
        "scale": cell.scale.value,
        "rotation_only": "yes" if cell.rotation_only else "",
        **{name: str(given[name]) for name in ("max_residual", "objective") if name in given},
    }


def typed(key: Key, folder: Path) -> list[str]:
    """The same as arguments of a command."""
    fields = fields_of(key)
    paths = [str(folder / fields.pop(name)) for name in ("source", "target")]
    alone = ["--rotation-only"] if fields.pop("rotation_only") else []
    options = [
        (f"--{name.replace('_', '-')}", str(folder / text) if name in DATA[key[0]] else text)
        for name, text in fields.items()
    ]
    return [*paths, *alone, *itertools.chain.from_iterable(options)]


@cache
def validator(name: str) -> Any:
    schema = files("certreg.report") / "schemas" / f"{name.replace('/', '-')}.json"
    return jsonschema.Draft202012Validator(json.loads(schema.read_bytes()))


def refused_by_the_table(run: Run, cell: Cell, verb: Verb) -> bool:
    refused = refusal(cell, verb)
    return refused is not None and (run.code, run.out, run.err) == (
        2,
        "",
        f"certreg: {refused.sentence}\n",
    )


def answered(run: Run) -> bool:
    """By one document of the form that it names."""
    document = run.document
    validator(document["schema"]).validate(document)
    return run.code == 0


@pytest.mark.slow
@pytest.mark.parametrize(("data", "motion", "loss"), CELLS)
def test_a_cell_is_certified_verified_reported_and_assessed_or_refused(
    data: str, motion: str, loss: Loss, clouds: Path, tmp_path: Path
) -> None:
    key = (data, motion, loss)
    cell, given = cell_of(*key), typed(key, clouds)
    out, page = tmp_path / "out", tmp_path / "report.html"
    run = command("certify", *given, "--out", out, "--json")
    pose = ("--pose", out if out.exists() else clouds / "pose.txt")
    judged = pose if loss is Loss.SQUARES else ("--labels", clouds / "labels.csv")
    assess = command("assess", *given, *judged, "--json")
    if not supported(cell):
        assert refused_by_the_table(run, cell, Verb.CERTIFY)
        assert refused_by_the_table(assess, cell, Verb.CERTIFY)
        assert not out.exists()
        return

    assert answered(run)
    verified = command("verify", out, *given)
    assert (verified.code, "VERIFIED" in verified.out) == (0, True)
    assert command("report", out, *given, "--out", page).code == 0
    assert run.document["digest"] in page.read_text("utf-8")
    if supported(cell, Verb.LABELS):
        assert answered(assess)
    else:
        assert refused_by_the_table(assess, cell, Verb.LABELS)


def asked_of(cell: Cell) -> dict[str, Verb]:
    """The questions about a cell that are asked here, and their verbs."""
    certified = {"certify": Verb.CERTIFY, "batch": Verb.CERTIFY, "certify_many": Verb.CERTIFY}
    if cell.loss is not Loss.SQUARES:
        return certified | {"assess": Verb.LABELS}
    return certified | {"assess": Verb.CERTIFY} | {name: one.verb for name, one in SOLVED.items()}


def test_the_table_answers_as_many_questions_as_documented() -> None:
    answers = [
        supported(cell, verb)
        for cell in itertools.starmap(cell_of, CELLS)
        for verb in asked_of(cell).values()
    ]
    assert (sum(answers), len(answers)) == (ANSWERED, ASKED)


def about(key: Key, name: str, folder: Path) -> tuple[Run, Cell, Verb]:
    """The answer to a question of SOLVED, and what the table is asked about it."""
    one = SOLVED[name]
    return command(*one.arguments, *typed(key, folder), "--json"), cell_of(*key), one.verb


@pytest.mark.slow
@pytest.mark.parametrize(("data", "motion", "loss"), SQUARES)
def test_equilibria_and_motions_of_a_cell_are_answered_or_refused(
    data: str, motion: str, loss: Loss, clouds: Path
) -> None:
    key = (data, motion, loss)
    for name in SOLVED:
        if key in ON_SPRINGS and name in NAMED:
            continue
        run, cell, verb = about(key, name, clouds)
        assert answered(run) if supported(cell, verb) else refused_by_the_table(run, cell, verb)


@pytest.mark.long
@pytest.mark.parametrize("name", NAMED)
@pytest.mark.parametrize("key", ON_SPRINGS)
def test_what_is_asked_for_by_its_name_is_answered_on_springs(
    key: Key, name: str, clouds: Path
) -> None:
    run, _, _ = about(key, name, clouds)
    assert answered(run)


@pytest.mark.slow
def test_a_list_of_every_cell_is_certified_or_refused_row_by_row(
    clouds: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("certreg.cli.campaigns.workers_at", lambda _: InProcess(1))
    rows = [fields_of(key) for key in CELLS]
    listed, out = clouds / "cells.csv", tmp_path / "out"
    with listed.open("w", encoding="utf-8", newline="") as stream:
        names = dict.fromkeys(itertools.chain.from_iterable(rows))
        writer = csv.DictWriter(stream, list(names), restval="")
        writer.writeheader()
        writer.writerows(rows)
    run = command("batch", listed, "--out", out)
    entries = [strict_json(line) for line in (out / "results.jsonl").read_bytes().splitlines()]

    assert run.code == 2
    for key, entry in zip(CELLS, entries, strict=True):
        cell = cell_of(*key)
        if refused := refusal(cell):
            assert entry["error"]["message"] == refused.sentence
            continue
        assert command("verify", out / entry["certificate"], *typed(key, clouds)).code == 0


@pytest.mark.slow
@pytest.mark.parametrize(("data", "motion", "loss"), CELLS)
def test_many_problems_of_a_cell_are_certified_or_refused(
    data: str, motion: str, loss: Loss
) -> None:
    cell, options = cell_of(data, motion, loss), options_of(cell_of(data, motion, loss), data)
    asked: dict[str, Any] = {name: options.pop(name) for name in LOSSES[loss]}
    asked["simulation"] = False
    clouds = (SOURCE, target_of(cell))
    each: list[Any] = []
    each += certreg.certify_many([clouds], errors="keep", **options, **asked)
    if supported(cell._replace(loss=Loss.SQUARES)):  # else there is no such problem
        stated = certreg.RegistrationProblem(*clouds, **options)
        each += certreg.certify_many([stated], errors="keep", **asked)
    for one in each:
        if refused := refusal(cell):
            assert (type(one), str(one)) == (InvalidProblemError, refused.sentence)
        else:
            assert certreg.verify(one.certificate).proved
