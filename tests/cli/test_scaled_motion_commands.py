"""`equilibria`, `simulate` and `certify` with a free scale: what they tell, write and refuse."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg, strict_json, write_csv
from jsonschema import Draft202012Validator

import certreg as package
from certreg.errors import InvalidProblemError
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.quick
SCALED = ("--scale", "asymmetric")
SOURCE = np.array([s * row for row in np.eye(3) for s in (1.0, -1.0)])  # Sxx = 6, K of C = 2 D
TARGETS = {  # D, eigenvalues of K / 2: the sums of d with an even number of signs changed
    1: (1.0, 1.0, 0.9),  # 2.9, -0.9, -0.9, -1.1; two coincide
    2: (3.0, 2.0, 0.5),  # 5.5, 0.5, -1.5, -4.5
    3: (4.0, 3.0, -2.0),  # 5, 3, 1, -9
}


def clouds(folder: Path, factors: tuple[float, ...]) -> tuple[Path, Path]:
    target = (SOURCE * factors).tolist()
    return write_csv(folder / "a.csv", SOURCE.tolist()), write_csv(folder / "b.csv", target)


def check_schema(kind: str, document: Any) -> None:
    text = (files("certreg.report") / "schemas" / f"certreg-{kind}-1.json").read_text("utf-8")
    Draft202012Validator(json.loads(text)).validate(document)


@pytest.mark.parametrize("count", TARGETS)
def test_there_are_one_two_or_three_equilibria_each_with_its_scale(tmp_path: Path, count: int):
    pair, d = clouds(tmp_path, TARGETS[count]), TARGETS[count]
    a, b, c = d
    sums = sorted((a + b + c, a - b - c, b - a - c, c - a - b), reverse=True)
    scales = [2.0 * value / 6.0 for value in sums]
    run = certreg("equilibria", *pair, *SCALED, "--json")
    found = strict_json(run.out)["equilibria"]

    assert run.code == 0
    check_schema("equilibria", strict_json(run.out))
    assert (found["count"], found["spurious"]) == (count, count - 1)
    assert [one["scale"] for one in found["components"]] == pytest.approx(scales[:count])
    assert [one["morse_index"] for one in found["components"]] == list(range(count))
    below = sorted(set(np.round(scales[count:], 12)))
    assert [one["scale"] for one in found["inside_out"]] == pytest.approx(below)
    assert found["inside_out"][0]["stable"]
    told = certreg("equilibria", *pair, *SCALED, "--poses", tmp_path / "poses")
    assert "Inside out (scale below 0): " in told.out
    poses = [np.loadtxt(path) for path in sorted((tmp_path / "poses").iterdir())]
    assert [np.cbrt(np.linalg.det(pose[:3, :3])) for pose in poses] == pytest.approx(scales[:count])


def test_the_symmetric_scale_is_that_of_all_four(tmp_path: Path):
    run = certreg("equilibria", *clouds(tmp_path, TARGETS[2]), "--scale", "symmetric", "--json")
    found = strict_json(run.out)["equilibria"]

    check_schema("equilibria", strict_json(run.out))
    assert found["count"] == 4
    scale = np.sqrt(2.0 * (9.0 + 4.0 + 0.25) / 6.0)
    assert [one["scale"] for one in found["components"]] == pytest.approx([scale] * 4)
    assert found["inside_out"] is None
    squares = 2.0 * (9.0 + 4.0 + 0.25) + scale**2 * 6.0 - 2.0 * scale * 11.0
    assert found["components"][0]["rmse"] == pytest.approx(np.sqrt(squares / 6.0))


def test_the_released_body_grows_to_the_optimum_and_its_size_is_kept_above_zero(tmp_path: Path):
    pair, out = clouds(tmp_path, TARGETS[2]), tmp_path / "t.npz"
    run = certreg("simulate", *pair, *SCALED, "--json", "--out", out)
    document, kept = strict_json(run.out), np.load(out)

    assert run.code == 0
    check_schema("simulation", document)
    assert document["scale"]["initial"] == 1.0
    assert document["scale"]["final"] == pytest.approx(11.0 / 6.0, rel=1e-3)
    assert document["scale"]["never_collapses"] is True
    assert kept["states"].shape == (len(kept["times"]), 18)
    assert kept["scales"][-1] == document["scale"]["final"]
    words = certreg("simulate", *pair, *SCALED).out
    assert "Proved: the exact motion never comes to the scale 0" in words
    larger = certreg("simulate", *clouds(tmp_path, (0.4, 0.4, 0.4)), *SCALED).out
    assert "Not proved that the exact motion never comes to the scale 0" in larger


@pytest.mark.usefixtures("compiled")
@pytest.mark.slow
def test_certify_lists_and_simulates_with_a_free_scale(tmp_path: Path):
    pair = clouds(tmp_path, TARGETS[3])
    run = certreg("certify", *pair, *SCALED, "--json", "--out", tmp_path / "o")
    document = strict_json(run.out)

    assert run.code == 0
    check_schema("result", document)
    assert document["equilibria"]["count"] == 3
    assert document["simulation"]["converged"] is True
    assert document["simulation"]["integrator"] == "midpoint"
    assert (tmp_path / "o" / "trajectory.npz").exists()
    words = certreg("certify", *pair, *SCALED).out
    assert "exactly three with a scale above 0: the optimum and two spurious" in words
    assert "degrees from the optimum, at the scale 1.666" in words
    symmetric = certreg("certify", *pair, "--scale", "symmetric").out
    assert "simulation        left out: the symmetric scale minimises" in symmetric


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ("simulate", "--scale", "asymmetric", "--integrator", "euler"),
            "by the midpoint rule alone",
        ),
        (
            ("certify", "--scale", "asymmetric", "--integrator", "splitting"),
            "by the midpoint rule alone",
        ),
        (("simulate", "--scale", "symmetric"), "take the asymmetric one"),
        (("equilibria", "--scale", "symmetric", "--method", "all"), "take 'spectral'"),
        (("equilibria", "--scale", "asymmetric", "--out", "c.json"), "has no certificate"),
    ],
)
def test_what_there_is_not_with_a_free_scale_is_refused_in_one_line(
    tmp_path: Path, arguments: tuple[str, ...], words: str
):
    command, *options = arguments
    run = certreg(command, *clouds(tmp_path, TARGETS[2]), *options)

    assert run.code == 2
    assert words in run.err


def test_in_python_the_same_is_returned_and_shown():
    problem = RegistrationProblem(SOURCE, SOURCE * TARGETS[2], scale="asymmetric")
    found: Any = package.equilibria(problem)
    moved: Any = package.simulate(problem)

    assert repr(found) == "<ScaledEquilibria: 2; exact>"
    assert "exactly two with a scale above 0" in str(found)
    assert found.to_dict()["equilibria"]["count"] == 2
    assert moved.to_dict()["scale"]["optimum"] == pytest.approx(11.0 / 6.0)
    for one in (found, moved):
        assert "scale" in one._repr_html_()
    with pytest.raises(InvalidProblemError, match="the midpoint rule alone"):
        package.simulate(problem, "splitting")
    with pytest.raises(InvalidProblemError, match="take 'spectral'"):
        package.equilibria(problem, "homotopy")
    nothing: Any = package.equilibria(
        RegistrationProblem(SOURCE, np.zeros((6, 3)), scale="asymmetric")
    )
    assert (nothing.count, nothing.unique) == (0, False)
    assert "none with a scale above 0" in str(nothing)


def test_a_body_without_a_translation_turns_and_grows_about_the_origin(tmp_path: Path):
    pair = clouds(tmp_path, TARGETS[2])
    both = certreg("simulate", *pair, *SCALED, "--rotation-only", "--json")
    alone = certreg("simulate", *pair, "--rotation-only", "--json")

    assert strict_json(both.out)["converged"] is strict_json(alone.out)["converged"] is True
