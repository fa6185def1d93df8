"""`certreg equilibria` for general springs: table, JSON, poses, exit codes."""

from __future__ import annotations

import json
from importlib.resources import files

import degenerate_springs
import jsonschema
import numpy as np
import pytest
import spring_families
from commands import certreg, write_csv

from certreg import RegistrationProblem, equilibria
from certreg.errors import InvalidProblemError

SCHEMA = json.loads(
    (files("certreg") / "report/schemas/certreg-equilibria-1.json").read_text("utf-8")
)
SEVEN, SIX = (spring_families.LISTED[k] for k in (2, 0))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Seven planes, six planes, and a sphere, as files."""
    place = tmp_path_factory.mktemp("springs")
    for name, cell in (("seven", SEVEN), ("six", SIX)):
        made = spring_families.instance(cell, 0)
        write_csv(place / f"{name}-a.csv", made.source.tolist())
        write_csv(place / f"{name}-b.csv", made.target.tolist())
        np.save(place / f"{name}.npy", made.springs["normals"])
    sphere = degenerate_springs.sphere()
    write_csv(place / "sphere-a.csv", np.asarray(sphere.source).tolist())
    write_csv(place / "sphere-b.csv", np.asarray(sphere.target).tolist())
    np.save(place / "sphere.npy", degenerate_springs.SPHERE)
    return place


@pytest.fixture(scope="module")
def answers(folder):
    """What is printed of each, as text and as JSON."""
    return {name: [listed(folder, name), listed(folder, name, "--json")] for name in NAMES}


NAMES = ("seven", "six", "sphere")


def listed(folder, name, *more):
    clouds = (folder / f"{name}-a.csv", folder / f"{name}-b.csv")
    return certreg("equilibria", *clouds, "--normals", folder / f"{name}.npy", *more)


@pytest.mark.slow
def test_all_equilibria_are_told_with_what_is_stable(answers):
    text, document = answers["seven"]
    found = document.document["equilibria"]

    assert (text.code, document.code) == (0, 0)
    assert f"exactly {found['count_real']}, of which {found['stable']} stable." in text.out
    assert "the Euler sum of the indices is 0" in text.out
    assert "not every stable one is the optimum" in text.out
    assert (found["pattern"], found["count_complex"], found["finite"]) == (None, 40, True)
    assert found["spurious"] == found["count"] - 1
    assert [part["optimal"] for part in found["components"]].count(True) == 1
    assert sum(part["stable"] for part in found["components"]) == found["stable"]
    energies = [part["energy"] for part in found["components"]]
    assert energies == sorted(energies)


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("name", NAMES)
def test_the_document_is_as_its_schema_says(answers, name):
    document = answers[name][1].document

    jsonschema.validate(document, SCHEMA)
    assert "equilibria.pattern" in document["reasons"]


def test_where_several_are_as_good_the_list_is_complete_and_the_best_not_decided(answers):
    text, document = answers["six"]
    found = document.document["equilibria"]
    tied = [part["optimal"] for part in found["components"]].count(None)

    assert text.code == 4
    assert found["complete"]
    assert tied > 1
    assert f"the first {tied} have the same energy" in text.out
    assert found["spurious"] is None


@pytest.mark.usefixtures("compiled")
def test_what_could_not_be_told_apart_is_said_and_not_counted(answers):
    text, document = answers["sphere"]
    found = document.document["equilibria"]

    assert text.code == 4
    assert "not proved complete): not counted; 3 proved to be isolated" in text.out
    assert "13 of them were proved to be apart" in text.out
    assert "not separated" in text.out
    assert [found[name] for name in ("count", "count_real", "count_complex", "stable")] == [
        None
    ] * 4
    assert found["finite"] is True
    assert [part["separated"] for part in found["components"]] == [False, True, True, True]
    assert found["components"][0]["stable"] is None


@pytest.mark.slow
def test_poses_are_written_in_the_order_of_the_list(folder, tmp_path):
    run = listed(folder, "seven", "--json", "--poses", tmp_path)
    parts = run.document["equilibria"]["components"]
    written = sorted(tmp_path.glob("pose-*.txt"))

    assert f"{len(parts)} poses written" in run.err
    assert len(written) == len(parts)
    for path, part in zip(written, parts, strict=True):
        matrix = np.loadtxt(path)
        assert matrix[:3, :3].tolist() == part["rotation"]
        assert matrix[:3, 3].tolist() == part["translation"]


@pytest.mark.parametrize("name", ["pose-1.txt", "pose-my-important.txt", "notes.md"])
def test_a_folder_that_holds_files_is_refused_and_left_as_it_is(folder, tmp_path, name):
    kept = tmp_path / name
    kept.write_text("mine\n", "utf-8")
    run = listed(folder, "seven", "--poses", tmp_path, "--out", folder / "no-list.json")

    assert run.code == 2
    assert run.err == f"certreg: {tmp_path}: holds other files: choose a new folder, or empty it\n"
    assert run.out == ""
    assert list(tmp_path.iterdir()) == [kept]
    assert kept.read_text("utf-8") == "mine\n"
    assert not (folder / "no-list.json").exists()


def test_poses_of_one_weight_per_pair_are_written_too(tmp_path):
    cloud = write_csv(tmp_path / "a.csv", degenerate_springs.POINTS.tolist())
    moved = write_csv(tmp_path / "b.csv", degenerate_springs.POINTS[:, [1, 2, 0]].tolist())
    run = certreg("equilibria", cloud, moved, "--json", "--poses", tmp_path / "p")
    first = np.loadtxt(tmp_path / "p" / "pose-1.txt")

    assert len(list((tmp_path / "p").iterdir())) == 4
    assert first[:3, :3].tolist() == run.document["equilibria"]["components"][0]["rotation"]
    assert first @ [3, 1, -2, 1] == pytest.approx([1, -2, 3, 1])


@pytest.mark.slow
def test_a_certificate_of_the_list_is_written_and_verified(folder, tmp_path):
    run = listed(folder, "seven", "--out", tmp_path / "list.json")
    verdict = certreg("verify", tmp_path / "list.json")

    assert "certificate of the list" in run.err
    assert (run.code, verdict.code) == (0, 0)
    assert "VERIFIED" in verdict.out


@pytest.mark.slow
def test_where_the_list_is_in_doubt_no_certificate_is_written(folder, tmp_path):
    run = listed(folder, "sphere", "--out", tmp_path / "list.json")

    assert "not written: the list is not proved complete" in run.err
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("how", [["--json"], pytest.param([], marks=pytest.mark.long)])
def test_all_methods_are_held_against_each_other(folder, how):
    run = listed(folder, "seven", "--method", "all", *how)
    if not how:
        assert "The roads homotopy, groebner agree" in run.out
        return
    roads = run.document["roads"]

    jsonschema.validate(run.document, SCHEMA)
    assert [road["method"] for road in roads] == ["homotopy", "groebner"]
    assert roads[0]["indices"] == roads[1]["indices"]
    assert run.document["agreement"]["rotation_deg"] < 1e-15


def test_eigenspaces_are_refused(folder):
    run = listed(folder, "seven", "--method", "spectral")

    assert run.code == 2
    assert "have no eigenspaces" in run.err


@pytest.mark.slow
def test_in_python_the_same_text_and_document(answers):
    made = spring_families.instance(SEVEN, 0)
    found = equilibria(RegistrationProblem(**spring_families.statement(made)))
    text, document = answers["seven"]

    assert str(found) + "\n" == text.out
    assert found.to_dict() == document.document
    assert repr(found) == "<SpringEquilibria: 22, 4 stable; enclosed, complete>"
    assert "exactly 22" in found._repr_html_()
    with pytest.raises(InvalidProblemError, match="have no eigenspaces"):
        equilibria(RegistrationProblem(**spring_families.statement(made)), "spectral")
