"""Bad input ends in one clear line, degenerate input in a clear answer; never in any rotation."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Run, certreg, write_csv
from golden.bad_files import ARRAY, BAD, CSV, POINTS, USAGE, Bad
from scipy.spatial.transform import Rotation
from strategies import BENT, LINE, random_problem

import certreg as package
from certreg import CertregError, RegistrationProblem
from certreg.errors import InvalidProblemError, OutOfRangeError
from certreg.results import Optimality

# Through Python ----------------------------------------------------------------------------------


class Cloud:
    def __init__(self, points: Any) -> None:
        self.points = points


NOT_A_PROBLEM: dict[str, tuple[Any, Any, dict[str, Any], str]] = {
    "no points": (np.empty((0, 3)), np.empty((0, 3)), {}, "source has no points"),
    "an empty list": ([], [], {}, r"source has shape \(0,\)"),
    "another number of points": (POINTS, POINTS[:3], {}, "source has 4 points, target has 3"),
    "transposed": (ARRAY.T, ARRAY.T, {}, "transpose it"),
    "planar points": (ARRAY[:, :2], ARRAY[:, :2], {}, r"expected \(N, 3\)"),
    "one point as a vector": ([1.0, 2, 3], [1.0, 2, 3], {}, r"expected \(N, 3\)"),
    "a stack of clouds": (ARRAY[None], ARRAY[None], {}, r"expected \(N, 3\)"),
    "ragged rows": ([[1, 2, 3], [4, 5]], POINTS, {}, "source is not an array of numbers"),
    "nothing": (None, POINTS, {}, "source has entries of type object"),
    "NaN": (np.where(ARRAY == 2, np.nan, ARRAY), POINTS, {}, r"source row 2 .* finite"),
    "infinity": (POINTS, np.where(ARRAY == 3, -np.inf, ARRAY), {}, r"target row 3 .* finite"),
    "complex numbers": (ARRAY + 0j, POINTS, {}, "source has entries of type complex"),
    "words": ([["1", "2", "3"]], [[1, 2, 3]], {}, "source has entries of type <U1"),
    "objects": (ARRAY.astype(object), POINTS, {}, "source has entries of type object"),
    "booleans": (ARRAY > 0, POINTS, {}, "source has entries of type bool"),
    "dates": (ARRAY.astype("M8[s]"), POINTS, {}, "source has entries of type datetime64"),
    "a masked array": (np.ma.masked_equal(ARRAY, 3), POINTS, {}, "drop the masked rows"),
    "a cloud of words": (Cloud([["a", "b", "c"]]), POINTS, {}, "source has entries of type"),
    "integers beyond 2^53": (ARRAY.astype(int) + 2**53 + 1, POINTS, {}, "no double holds exactly"),
    "the largest integer": (np.full((4, 3), 2**63 - 1), POINTS, {}, "no double holds exactly"),
    "sigma and weights": (POINTS, POINTS, {"sigma": 1, "weights": [1] * 4}, "give one"),
    "sigma of 0": (POINTS, POINTS, {"sigma": 0}, "must be > 0"),
    "a negative sigma": (POINTS, POINTS, {"sigma": [1, 1, -2, 1]}, r"sigma\[2\] is -2"),
    "a sigma of NaN": (POINTS, POINTS, {"sigma": math.nan}, "sigma .* finite"),
    "a sigma of 1e-170": (POINTS, POINTS, {"sigma": 1e-170}, "change the unit of length"),
    "a sigma of 1e200": (POINTS, POINTS, {"sigma": 1e200}, "change the unit of length"),
    "a sigma of words": (POINTS, POINTS, {"sigma": "abc"}, "sigma has entries of type"),
    "too few sigmas": (POINTS, POINTS, {"sigma": [1, 1]}, r"sigma has shape \(2,\)"),
    "zero weights": (POINTS, POINTS, {"weights": [0] * 4}, "all weights are zero"),
    "a negative weight": (POINTS, POINTS, {"weights": [1, -1e-9, 1, 1]}, r"weights\[1\] is -1e-09"),
    "a weight of NaN": (
        POINTS,
        POINTS,
        {"weights": [1, 1, 1, math.nan]},
        "weights row 3 .* finite",
    ),
    "a weight of infinity": (POINTS, POINTS, {"weights": math.inf}, "weights .* finite"),
    "too many weights": (POINTS, POINTS, {"weights": [1] * 5}, r"weights has shape \(5,\)"),
    "masked weights": (POINTS, POINTS, {"weights": np.ma.masked_equal([1, 2, 1, 1], 2)}, "masked"),
    "no damping": (POINTS, POINTS, {"damping": 0}, "damping is 0"),
    "negative damping": (POINTS, POINTS, {"damping": -1.0}, r"damping is -1\.0"),
    "a damping of NaN": (POINTS, POINTS, {"damping": math.nan}, "damping is nan"),
    "a damping of infinity": (POINTS, POINTS, {"damping": math.inf}, "damping is inf"),
    "a damping of words": (POINTS, POINTS, {"damping": "2"}, "damping is '2'"),
}


@pytest.mark.parametrize("name", NOT_A_PROBLEM)
def test_what_is_no_problem_is_refused_in_one_line(name: str):
    source, target, options, words = NOT_A_PROBLEM[name]
    with pytest.raises(InvalidProblemError, match=words) as caught:
        RegistrationProblem(source, target, **options)

    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, CertregError)


# Through the command line ------------------------------------------------------------------------


def run_on(tmp_path: Path, bad: Bad, command: str = "certify") -> Run:
    files = dict(bad.files)
    for side in ("source", "target"):
        if not any(Path(name).stem == side for name in files):
            files[f"{side}.csv"] = CSV
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    sides = [next(n for n in files if Path(n).stem == side) for side in ("source", "target")]
    options = [option.format(tmp=tmp_path) for option in bad.options]
    if command == "certify" and "--out" not in options:
        options += ["--out", str(tmp_path / "out")]
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    run = certreg(command, *(tmp_path / name for name in bad.arguments or sides), *options)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    return run


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_clear_line_and_nothing_is_written(tmp_path: Path, name: str):
    run = run_on(tmp_path, BAD[name])

    assert (run.code, run.out) == (2, "")
    assert re.fullmatch(r"certreg: [^\n]{10,500}\n", run.err), run.err
    assert run.err.strip().isprintable()
    for words in BAD[name].says:
        assert words in run.err


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", [name for name in BAD if "--out" not in BAD[name].options])
def test_every_command_that_reads_clouds_refuses_the_same(tmp_path: Path, name: str):
    bad = BAD[name]
    pose = tmp_path / "pose.txt"
    pose.write_text("1 0 0 0 0 0 0\n", "utf-8")
    for command, options in (("equilibria", ()), ("assess", ("--pose", str(pose)))):
        more = Bad(bad.files, bad.says, (*bad.options, *options), bad.arguments)
        run = run_on(tmp_path, more, command)

        assert (run.code, run.out) == (2, "")
        assert re.fullmatch(r"certreg: [^\n]+\n", run.err)


@pytest.mark.parametrize("name", USAGE)
def test_bad_usage_is_told_with_the_usage(tmp_path: Path, name: str):
    options, words = USAGE[name]
    run = run_on(tmp_path, Bad({}, (), options))

    assert (run.code, run.out) == (2, "")
    assert run.err.startswith("Usage: certreg certify ")
    assert words in run.err.splitlines()[-1]


def test_a_folder_is_no_cloud_and_one_cloud_is_no_pair(tmp_path: Path):
    source = write_csv(tmp_path / "source.csv", POINTS)
    for arguments in ((tmp_path, source), (source, tmp_path), (source,), ()):
        run = certreg("certify", *arguments)

        assert (run.code, run.out) == (2, "")
        assert run.err.startswith("Usage: certreg certify ")


def test_a_demo_into_an_unwritable_place_is_one_clear_line(tmp_path: Path):
    (tmp_path / "file").write_text("kept", "utf-8")
    run = certreg("demo", "--out", tmp_path / "file" / "out")

    assert (run.code, run.out) == (2, "")
    assert re.fullmatch(r"certreg: [^\n]*file[^\n]*: choose another place\n", run.err)
    assert (tmp_path / "file").read_text("utf-8") == "kept"


# Degenerate, but not bad: a clear answer ---------------------------------------------------------


AMBIGUOUS = {
    "collinear": (LINE, LINE, "the source points are collinear"),
    "nearly all on a line": ([*LINE, LINE[0]], [*LINE, LINE[0]], "the source points are collinear"),
    "one point": ([[1, 2, 3]], [[1, 2, 3]], "a single point does not tell a rotation"),
    "two points": (LINE[:2], LINE[:2], "the source points are collinear"),
    "coincident points": ([[1, 2, 3]] * 4, POINTS, "all source points with weight coincide"),
    "the origin only": ([[0, 0, 0]] * 3, [[0, 0, 0]] * 3, "coincide"),
    "mirrored symmetric": (
        [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
        [[1, 1, -1], [1, -1, 1], [-1, 1, 1], [-1, -1, -1]],
        "mirror image",
    ),
}


@pytest.mark.parametrize("name", AMBIGUOUS)
def test_an_ambiguous_problem_is_never_answered_as_if_it_were_not(tmp_path: Path, name: str):
    source, target, words = AMBIGUOUS[name]
    result = package.certify(RegistrationProblem(source, target))
    run = certreg(
        "certify", write_csv(tmp_path / "a.csv", source), write_csv(tmp_path / "b.csv", target)
    )

    assert run.code == 3
    assert words in run.out
    assert result.status is Optimality.CERTIFIED_NOT_UNIQUE
    assert not result.equilibria.classification.unique
    assert result.bounds is not None
    assert result.bounds.angle_upper is None
    assert result.equilibria.margin.relative == 0.0
    assert np.linalg.det(result.pose.rotation) == pytest.approx(1)
    assert result.verdict is not None
    assert any("NOT unique" in theorem for theorem in result.verdict.theorems)


def test_points_without_weight_do_not_make_a_problem_unique():
    result = package.certify(RegistrationProblem(BENT, BENT, weights=[1, 1, 0, 0]))

    assert result.status is Optimality.CERTIFIED_NOT_UNIQUE
    ambiguity = result.equilibria.classification.ambiguity
    assert ambiguity is not None
    assert "the source points are collinear" in ambiguity.value


def test_reflected_clouds_get_the_best_rotation_not_a_reflection(tmp_path: Path):
    problem = random_problem(np.random.default_rng(11), n=12, noise=0.0)
    mirrored = problem.source * [1, 1, -1]
    clouds = (
        write_csv(tmp_path / "a.csv", problem.source.tolist()),
        write_csv(tmp_path / "b.csv", mirrored.tolist()),
    )
    run = certreg("certify", *clouds, "--json")
    R = np.array(run.document["pose"]["rotation"])
    oracle = Rotation.align_vectors(
        mirrored - mirrored.mean(axis=0), problem.source - problem.source.mean(axis=0)
    )[0]

    assert run.code == 0
    assert np.linalg.det(R) == pytest.approx(1)
    assert pytest.approx(oracle.as_matrix(), abs=1e-12) == R
    assert run.document["rmse"] > 0.1


@pytest.mark.one_in(4)
@pytest.mark.parametrize("suffix", [".csv", ".npy"])
@pytest.mark.parametrize("scale", [1e200, 1e-170, 1e300, 1e-300])
def test_scale_changes_neither_the_rotation_nor_the_proof(
    tmp_path: Path, scale: float, suffix: str
):
    plain = random_problem(np.random.default_rng(12), n=10, noise=0.1)
    expected = package.certify(plain)
    assert expected.rmse is not None
    clouds = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    for path, points in zip(clouds, (plain.source * scale, plain.target * scale), strict=True):
        if suffix == ".npy":
            np.save(path, points)
        else:
            write_csv(path, points.tolist())
    run, told = certreg("certify", *clouds, "--json"), certreg("certify", *clouds)
    document, reasons = run.document, run.document["reasons"]

    assert run.code == told.code == 0
    assert np.array(document["pose"]["rotation"]) == pytest.approx(
        expected.pose.rotation, abs=1e-14
    )
    assert document["rmse"] / scale == pytest.approx(expected.rmse, rel=1e-13)
    for field_name in ("objective", "margin.eigenvalue_gap", "equilibria.components[3].energy"):
        assert reasons[field_name] == "no double holds the value: change the unit of length"
    assert "equilibria.components[0].rmse" not in reasons
    assert "equilibria.components[3].eigenvalues" not in reasons
    assert document["equilibria"]["components"][3]["rmse"] / scale == pytest.approx(
        expected.equilibria.components[3].rmse, rel=1e-13
    )
    assert "(beyond doubles)" in told.out


def test_clouds_of_far_apart_scales_are_answered():
    """The rotation is right; rounding the translation alone costs more than any rotation."""
    plain = random_problem(np.random.default_rng(13), n=10, noise=0.1)
    expected = package.certify(plain).pose.rotation
    for a, b in ((1e-150, 1e150), (1e150, 1e-150), (1e-300, 1e300)):
        result = package.certify(
            RegistrationProblem(plain.source * a, plain.target * b),
            relaxation=False,
            simulation=False,
        )

        assert result.status is Optimality.BOUNDED
        assert result.pose.rotation == pytest.approx(expected, abs=1e-13)


def test_a_translation_that_no_double_holds_is_refused(tmp_path: Path):
    source = np.array(BENT) * 1e300 + 1.7e308
    target = np.array(BENT) * 1e300 - 1.7e308  # each fits a double, the way between them does not
    with pytest.raises(OutOfRangeError, match="change the unit of length"):
        package.certify(RegistrationProblem(source, target))
    run = certreg(
        "certify",
        write_csv(tmp_path / "a.csv", source.tolist()),
        write_csv(tmp_path / "b.csv", target.tolist()),
    )

    assert (run.code, run.out) == (2, "")
    assert re.fullmatch(r"certreg: [^\n]*change the unit of length[^\n]*\n", run.err)


@pytest.mark.one_in(4)
@pytest.mark.parametrize(
    "array",
    [
        np.asfortranarray(ARRAY / 7),
        (ARRAY / 7).astype(">f8"),
        ARRAY.astype(np.float32),
        ARRAY.astype(int),
    ],
    ids=["fortran", "big-endian", "float32", "int"],
)
def test_any_real_npy_file_gives_the_answer_of_its_numbers(tmp_path: Path, array):
    bent = np.array(BENT)
    np.save(tmp_path / "a.npy", array)
    np.save(tmp_path / "b.npy", bent)
    write_csv(tmp_path / "a.csv", array.astype(float).tolist())
    runs = [
        certreg("certify", tmp_path / f"a{suffix}", tmp_path / "b.npy", "--json")
        for suffix in (".csv", ".npy")
    ]

    assert [run.code for run in runs] == [0, 0]
    assert runs[0].document["digest"] == runs[1].document["digest"]
    assert RegistrationProblem(array, bent).digest() == runs[0].document["digest"]


def test_a_file_name_does_not_steer_the_terminal(tmp_path: Path):
    name = tmp_path / "s\x1b[31m.bad"
    name.write_text("1,2,3\n", "utf-8")
    run = certreg("certify", name, name)

    assert run.code == 2
    assert "\x1b" not in run.err
    assert "\\x1b[31m" in run.err
