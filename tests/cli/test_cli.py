"""Every command keeps its contract: exit codes, JSON, files, words."""

from __future__ import annotations

import copy
import json
import math
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import click
import numpy as np
import pytest
from click.testing import CliRunner
from commands import certreg, strict_json, write_csv
from jsonschema import Draft202012Validator
from scipy.spatial.transform import Rotation
from strategies import BENT, LINE, ZOO, random_problem, random_rotation

import certreg as package
from certreg import RegistrationProblem
from certreg.cli import certified_clouds, registering
from certreg.cli import main as cli
from certreg.io.problems import read_problem
from certreg.registration import agreement, linear, squares
from certreg.registration import examples as demo
from certreg.registration.headlines import CERTIFIED
from certreg.results import Ruling, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray


CHECKER = Path(package.__file__).parent / "verify.py"
COMMANDS = (
    *("demo", "certify", "assess", "verify", "report", "equilibria", "simulate"),
    *("apply", "batch", "reproduce", "derive", "codegen", "info"),
)
FILES = [
    "certificate.json",
    "fit.csv",
    "pose.json",
    "pose.txt",
    "report.html",
    "result.json",
    "trajectory.npz",
]


@dataclass(frozen=True)
class Packaged:
    """A packaged pair, and the RMSE of its four equilibria as published with the data."""

    name: str
    source: str
    target: str
    n: int
    rmse: tuple[float, ...]

    def paths(self, data: Path) -> tuple[Path, Path]:
        return data / self.source, data / self.target


SURVEY = Packaged(
    "survey",
    "survey_source.csv",
    "survey_target.csv",
    4,
    (5.838987, 719.674350, 2284.899842, 2395.550956),
)
HEAD = Packaged(
    "head",
    "head_colin27.csv",
    "head_fsaverage.csv",
    338,
    (4.533814, 137.047215, 157.314223, 174.541110),
)
ABETA = Packaged(
    "abeta",
    "abeta_2beg_model01.csv",
    "abeta_2beg_model02.csv",
    130,
    (1.483978, 16.990655, 25.524941, 27.351661),
)
PACKAGED = (SURVEY, HEAD, ABETA)
each_pair = pytest.mark.parametrize("pair", PACKAGED, ids=lambda pair: pair.name)
each_specimen = pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)


# The contract of `--json` ------------------------------------------------------------------------


@cache
def validator(schema: str) -> Any:
    """Of the published schema with that name: the only contract."""
    file = files("certreg.report") / "schemas" / f"{schema.replace('/', '-')}.json"
    return Draft202012Validator(json.loads(file.read_text("utf-8")))


def nulls(value: Any, path: str = "") -> Iterator[str]:
    """The dotted path of every null."""
    if value is None:
        yield path
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from nulls(inner, f"{path}.{key}" if path else key)
    if isinstance(value, list):
        for k, inner in enumerate(value):
            yield from nulls(inner, f"{path}[{k}]")


NOTED = {"pose.uncertainty", "pose.covariance"}  # a value of noise alone, where the fit holds more


def keeps(document: Any, schema: str) -> None:
    """The document is as its schema says, with a reason in words for all nulls, a note of few."""
    assert document["schema"] == schema
    assert [error.message for error in validator(schema).iter_errors(document)] == []
    assert set(document["reasons"]) - set(nulls(document)) <= NOTED
    assert set(nulls(document)) <= set(document["reasons"])
    assert all(len(words.split()) > 1 for words in document["reasons"].values())


def test_a_null_without_a_reason_is_seen(data: Path):
    document = certreg("equilibria", *SURVEY.paths(data), "--json").document
    reasons = document["reasons"]

    assert list(nulls({"a": [1.0, 2], "b": None, "c": {"d": [None, 1]}})) == ["b", "c.d[0]"]
    keeps(document, "certreg-equilibria/1")
    assert reasons
    for spoilt in ({}, {**reasons, "more": "no such null"}, dict.fromkeys(reasons, "word")):
        with pytest.raises(AssertionError):
            keeps({**document, "reasons": spoilt}, "certreg-equilibria/1")
    with pytest.raises(ValueError, match="NaN"):
        strict_json('{"a": NaN}')


# Help, versions, and a process of its own --------------------------------------------------------


def test_help_names_every_command_and_every_exit_code():
    shown = certreg("--help")

    assert shown.code == 0
    assert all(f"  {command} " in shown.out for command in COMMANDS)
    assert [int(c) for c in re.findall(r"^ +(?:Exit codes: )?(\d) ", shown.out, re.MULTILINE)] == [
        0,
        1,
        2,
        3,
        4,
    ]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command: str):
    result = CliRunner().invoke(cli.cli, [command, "--help"])

    assert result.exit_code == 0
    assert result.output.startswith(f"Usage: cli {command}")


def test_an_unknown_command_is_bad_usage():
    assert certreg("frobnicate").code == 2
    assert certreg().code == 2


def test_info_names_the_versions_it_runs_on():
    shown = certreg("info")

    assert shown.code == 0
    for version in (package.__version__, np.__version__, sys.version.split()[0]):
        assert version in shown.out


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("there", [True, False])
def test_python_m_certreg_is_the_same_command(tmp_path: Path, *, there: bool):
    line, bent = write_csv(tmp_path / "a.csv", LINE), write_csv(tmp_path / "b.csv", BENT)

    def spawn(*arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-W", "error", "-m", "certreg", *map(str, arguments)],
            capture_output=True,
            text=True,
            check=False,
            cwd=CHECKER.parents[1],
            encoding="utf-8",
        )

    run = spawn("equilibria", line, bent if there else tmp_path / "nowhere.csv")  # no solver

    if there:
        assert (run.returncode, run.stderr) == (3, "")
        assert run.stdout == certreg("equilibria", line, bent).out
    else:
        assert (run.returncode, run.stdout) == (2, "")
        assert re.fullmatch(r"certreg: \S+nowhere\.csv: [^\n]+\n", run.stderr)


# certify -----------------------------------------------------------------------------------------


@each_pair
def test_the_packaged_pairs_are_certified_with_their_four_equilibria(data: Path, pair: Packaged):
    run = certreg("certify", *pair.paths(data), "--json")
    document = run.document
    components = document["equilibria"]["components"]

    assert (run.code, run.err) == (0, "")
    keeps(document, "certreg-result/1")
    assert document["n"] == pair.n
    assert document["optimality"]["status"] == "certified"
    assert document["optimality"]["unique"] is True
    assert [round(c["rmse"], 6) for c in components] == list(pair.rmse)
    assert document["equilibria"]["pattern"] == [1, 1, 1, 1]
    assert [c["morse_index"] for c in components] == [0, 1, 2, 3]
    assert [c["unstable_eigenvalues"] for c in components] == [0, 1, 2, 3]
    assert [sum(re > 0 for re, _ in c["eigenvalues"]) for c in components] == [0, 1, 2, 3]
    assert [c["optimal"] for c in components] == [True, False, False, False]
    angles = [c["angle_to_optimum_deg"] for c in components]
    assert angles == pytest.approx([0, 180, 180, 180], abs=1e-9)


@each_pair
def test_the_summary_tells_the_same_in_words(data: Path, pair: Packaged):
    run = certreg("certify", *pair.paths(data))

    assert (run.code, run.err) == (0, "")
    assert run.out.startswith(f"{CERTIFIED.said()}\n")
    assert "exactly four equilibria" in run.out
    assert all(f"{rmse:.6f}" in run.out for rmse in pair.rmse)


@pytest.mark.parametrize(
    ("shift", "warned"), [((0.0, 0.0, 0.0), False), ((0.1, 0.2, 0.3), False), ((1e9, 0, 0), True)]
)
def test_a_rounding_is_warned_of_only_where_it_moves_the_cloud(tmp_path: Path, shift, warned):
    line = np.outer([0.0, 1.0, 3.0], [1.0, 2.0, 3.0])  # exactly: a perfect fit, and not unique
    source = line + np.array([100.0, 200.0, 301.0])
    target = line[:, [1, 2, 0]] + np.array(shift)
    run = certreg(
        "certify",
        write_csv(tmp_path / "a.csv", source.tolist()),
        write_csv(tmp_path / "b.csv", target.tolist()),
    )

    assert ("move the origin to the clouds" in run.out) is warned


@pytest.mark.slow
def test_the_reported_pose_is_the_one_that_scipy_finds(data: Path):
    for pair in PACKAGED:
        problem, _ = read_problem(*pair.paths(data))
        R, t = scipy_pose(problem)
        pose = certreg("certify", *pair.paths(data), "--json").document["pose"]

        assert pose["rotation"] == pytest.approx(R, abs=1e-14)
        assert pose["translation"] == pytest.approx(t, abs=1e-10)


WORDS = {
    "mirrored tall": "mirror image",
    "mirrored tetrahedron": "mirror image",
    "collinear source": "the source points are collinear",
    "collinear target": "the target points are collinear",
    "two points": "the source points are collinear",
    "coincident source": "all source points with weight coincide",
    "coincident target": "all target points with weight coincide",
    "one point": "all source points with weight coincide",
    "cancelling octahedron": "the correspondences cancel out",
}


FLIPPED = {name for name in (one.name for one in ZOO) if name.startswith("mirrored")}


def test_every_row_of_the_classification_is_in_the_zoo():
    assert len({specimen.pattern for specimen in ZOO}) == 8
    assert set(WORDS) == {specimen.name for specimen in ZOO if specimen.pattern[0] > 1}


@pytest.mark.one_in(4)
@each_specimen
def test_every_row_of_the_classification_ends_with_its_code_and_its_words(specimen, tmp_path: Path):
    source = write_csv(tmp_path / "source.csv", specimen.source)
    target = write_csv(tmp_path / "target.csv", specimen.target)
    unique = specimen.pattern[0] == 1

    run, told = certreg("certify", source, target, "--json"), certreg("certify", source, target)
    document = run.document

    assert run.code == told.code == (0 if unique else 3)
    assert run.err == told.err == ""
    keeps(document, "certreg-result/1")
    assert document["equilibria"]["pattern"] == list(specimen.pattern)
    assert document["equilibria"]["finite"] is (specimen.pattern == (1, 1, 1, 1))
    assert document["optimality"]["unique"] is unique
    assert document["optimality"]["status"] == "certified" if unique else "certified-not-unique"
    assert (document["optimality"]["angle_bound_rad"] is None) is not unique
    poor = "mirrored" in {warning["code"] for warning in document["fit"]["warnings"]}
    assert poor == (specimen.name in FLIPPED)
    stamp = "CERTIFIED OPTIMUM, BUT THE FIT IS POOR: " if poor else "CERTIFIED: "
    assert told.out.startswith(stamp if unique else "CERTIFIED, BUT NOT UNIQUE: ")
    if not unique:
        assert WORDS[specimen.name] in told.out
        assert WORDS[specimen.name] in document["optimality"]["ambiguity"]


def test_out_writes_three_files_that_agree(data: Path, tmp_path: Path):
    run = certreg("certify", *SURVEY.paths(data), "--json", "--out", tmp_path / "new" / "folder")
    folder = tmp_path / "new" / "folder"
    printed, written = run.document, strict_json((folder / "result.json").read_bytes())

    assert sorted(path.name for path in folder.iterdir()) == FILES
    keeps(printed, "certreg-result/1")
    assert printed["certificate"] == str(folder / "certificate.json")
    assert {**printed, "timings_ms": 0} == {**written, "timings_ms": 0}
    matrix = np.loadtxt(folder / "pose.txt")
    assert matrix.shape == (4, 4)
    assert matrix[:3, :3].tolist() == printed["pose"]["rotation"]
    assert matrix[:3, 3].tolist() == printed["pose"]["translation"]
    assert matrix[3].tolist() == [0, 0, 0, 1]


def test_nothing_is_written_without_out(data: Path, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for command in ("certify", "equilibria"):
        assert certreg(command, *SURVEY.paths(data)).code == 0
    (tmp_path / "pose.txt").write_text("1 0 0 0 0 0 0\n", "utf-8")
    assert certreg("assess", *SURVEY.paths(data), "--pose", "pose.txt").code == 1

    assert [path.name for path in tmp_path.iterdir()] == ["pose.txt"]


@pytest.mark.slow
def test_a_second_run_replaces_the_files(data: Path, tmp_path: Path):
    for pair in (HEAD, SURVEY):
        assert certreg("certify", *pair.paths(data), "--out", tmp_path).code == 0

    assert sorted(path.name for path in tmp_path.iterdir()) == FILES
    assert strict_json((tmp_path / "result.json").read_bytes())["n"] == SURVEY.n
    assert certreg("verify", tmp_path / "certificate.json", *SURVEY.paths(data)).code == 0


@pytest.mark.slow
def test_weights_and_sigma_are_those_of_the_maximum_likelihood_objective(tmp_path: Path):
    problem = random_problem(np.random.default_rng(5), n=9, noise=0.3, decades=2)
    clouds = (
        write_csv(tmp_path / "a.csv", problem.source.tolist()),
        write_csv(tmp_path / "b.csv", problem.target.tolist()),
    )
    text, binary = tmp_path / "w.txt", tmp_path / "w.npy"
    text.write_text("\n".join(map(repr, problem.weights.tolist())) + "\n", "utf-8")
    np.save(binary, problem.weights)
    runs = [certreg("certify", *clouds, "--weights", path, "--json") for path in (text, binary)]
    scaled = [certreg("certify", *clouds, *sigma, "--json") for sigma in ([], ["--sigma", "0.5"])]

    assert [run.code for run in runs + scaled] == [0] * 4
    assert runs[0].document["digest"] == runs[1].document["digest"] == problem.digest()
    R, t = scipy_pose(problem)
    residuals = problem.source @ R.T + t - problem.target
    objective = float(problem.weights @ (residuals**2).sum(axis=1))
    assert runs[0].document["objective"] == pytest.approx(objective, rel=1e-12)
    plain, noisy = (run.document for run in scaled)
    assert noisy["objective"] == pytest.approx(4 * plain["objective"], rel=1e-14)
    assert noisy["rmse"] == pytest.approx(plain["rmse"], rel=1e-14)
    assert noisy["pose"]["rotation"] == plain["pose"]["rotation"]


def test_damping_changes_the_eigenvalues_and_nothing_else(data: Path):
    documents = [
        certreg("certify", *SURVEY.paths(data), "--json", *options).document
        for options in ([], ["--damping", "0.5"])
    ]
    eigenvalues = [
        [component.pop("eigenvalues") for component in document["equilibria"]["components"]]
        for document in documents
    ]

    # s^2 + mu s + g = 0: the roots of each mode add up to -mu
    sums = [[sum(re for re, _ in spectrum) for spectrum in found] for found in eigenvalues]
    best = documents[0]["damping"]  # 2 sqrt(least eigenvalue of G beside J): the noise is small
    assert best == pytest.approx(math.sqrt(8), rel=0.01)
    assert sums[0] == pytest.approx([-6 * best] * 4)
    assert sums[1] == pytest.approx([-3.0] * 4)
    assert [document.pop("damping") for document in documents] == [best, 0.5]
    for document in documents:
        for key in ("timings_ms", "simulation", "agreement", "theorems"):
            document.pop(key)
    assert documents[0] == documents[1]


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("damping", ["1e-150", "1e150"])
def test_extreme_damping_is_answered_in_numbers_or_with_a_reason(data: Path, damping: str):
    run = certreg("certify", *SURVEY.paths(data), "--damping", damping, "--json")

    assert run.code == 0
    keeps(run.document, "certreg-result/1")


def test_columns_that_are_not_used_are_noted_once(tmp_path: Path):
    source, target = tmp_path / "a.csv", write_csv(tmp_path / "b.csv", BENT)
    source.write_text(
        "x,colour,y,z\n" + "\n".join(f"{x},red,{y},{z}" for x, y, z in BENT) + "\n", "utf-8"
    )
    run = certreg("certify", source, target)

    assert run.code == 0
    assert re.fullmatch(r"note: .*a\.csv.*colour.*\n", run.err)


def test_labels_pair_the_points_in_whatever_order(tmp_path: Path):
    names = ["p", "q", "r", "s"]
    source = write_csv(tmp_path / "a.csv", BENT, names)
    straight = write_csv(tmp_path / "b.csv", [*LINE[:3], [1, 1, 1]], names)
    turned = write_csv(tmp_path / "c.csv", [[1, 1, 1], *LINE[2::-1]], names[::-1])

    digests = {
        certreg("certify", source, target, "--json").document["digest"]
        for target in (straight, turned)
    }

    assert len(digests) == 1


# Exit codes 1, 4, 130 ----------------------------------------------------------------------------


def test_a_pose_without_a_certificate_ends_with_code_4(data: Path, tmp_path: Path, monkeypatch):
    monkeypatch.setattr(linear, "produce", lambda *_, **__: None)
    run = certreg("certify", *SURVEY.paths(data), "--json", "--out", tmp_path)
    told = certreg("certify", *SURVEY.paths(data), "--out", tmp_path)

    assert run.code == told.code == 4
    assert told.out.startswith("NOT CERTIFIED")
    keeps(run.document, "certreg-result/1")
    assert run.document["optimality"]["status"] == "not-certified"
    assert "without --out" not in run.document["reasons"]["certificate"]
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == ["fit.csv", "pose.json", "pose.txt", "result.json", "trajectory.npz"]


def test_two_methods_that_disagree_end_with_code_1(data: Path, monkeypatch):
    monkeypatch.setattr(agreement, "arun", lambda _: np.array([0.0, 1.0, 0.0, 0.0]))
    run = certreg("certify", *SURVEY.paths(data))

    assert (run.code, run.out) == (1, "")
    assert re.fullmatch(r"certreg: Arun's closed form contradicts [^\n]*\n", run.err)


def test_a_refused_certificate_of_its_own_ends_with_code_1(data: Path, tmp_path: Path, monkeypatch):
    refusal = Verdict(ruling=Ruling.REFUTED, words="because")
    monkeypatch.setattr(squares, "check_own", lambda *_: refusal)
    run = certreg("certify", *SURVEY.paths(data), "--out", tmp_path / "out")

    assert (run.code, run.out) == (1, "")
    assert re.fullmatch(r"certreg: the checker refused [^\n]*: because\n", run.err)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("error", "code"), [(KeyboardInterrupt, 130), (MemoryError, 2)])
def test_an_interrupted_run_ends_cleanly(data: Path, tmp_path: Path, monkeypatch, error, code):
    def stop(*_: object, **__: object):
        raise error

    monkeypatch.setattr(registering, "certified", stop)
    run = certreg("certify", *SURVEY.paths(data), "--out", tmp_path / "out")

    assert run.code == code
    assert run.err.strip().count("\n") == 0
    assert not (tmp_path / "out").exists()


# demo --------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_demo_comes_out_as_told(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = certreg("demo")

    assert (run.code, run.err) == (0, "")
    assert run.out.count(f"{CERTIFIED.said()}\n") == 3
    assert all(f"{rmse:.6f}" in run.out for pair in PACKAGED for rmse in pair.rmse)
    written = sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.*"))
    names = sorted(pair.name for pair in PACKAGED)
    assert written == [f"certreg-demo/{name}/{file}" for name in names for file in FILES]
    assert [demo.STORIES[k].told_rmse for k in range(3)] == [pair.rmse for pair in PACKAGED]


@pytest.mark.slow
def test_the_demo_names_commands_that_run(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    alone = next(line for line in certreg("demo").out.splitlines() if "python3 -I" in line)
    program, *arguments = shlex.split(alone)
    done = subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=False, encoding="utf-8"
    )

    assert program == "python3"
    assert (done.returncode, done.stdout.rstrip().endswith("VERIFIED")) == (0, True)


def test_the_demo_of_a_module_names_the_module(tmp_path: Path, monkeypatch):
    main_file = str(Path(package.__file__).with_name("__main__.py"))
    monkeypatch.setattr(registering, "sys", SimpleNamespace(argv=[main_file], executable="/e/py 3"))
    monkeypatch.setattr(registering, "STORIES", (demo.STORIES[0],))
    run = certreg("demo", "--out", tmp_path)

    assert f"  '/e/py 3' -m certreg verify {tmp_path}/survey/certificate.json\n" in run.out
    assert "__main__.py" not in run.out


def test_a_demo_that_comes_out_otherwise_ends_with_code_1(tmp_path: Path, monkeypatch):
    survey = replace(demo.STORIES[0], told_rmse=(5.838988, *SURVEY.rmse[1:]))
    monkeypatch.setattr(registering, "STORIES", (survey,))
    run = certreg("demo", "--out", tmp_path)

    assert run.code == 1
    assert re.fullmatch(r"NOT AS TOLD: RMSE [^\n]*5\.838988[^\n]*\n", run.err)


# equilibria --------------------------------------------------------------------------------------


@pytest.mark.one_in(4)
@each_specimen
def test_equilibria_are_those_of_certify(specimen, tmp_path: Path):
    source = write_csv(tmp_path / "source.csv", specimen.source)
    target = write_csv(tmp_path / "target.csv", specimen.target)
    whole = certreg("certify", source, target, "--json").document
    damped = ("equilibria", source, target, "--damping", whole["damping"])
    run, told = certreg(*damped, "--json"), certreg(*damped)
    document = run.document

    assert run.code == told.code == (0 if specimen.pattern[0] == 1 else 3)
    keeps(document, "certreg-equilibria/1")
    assert document["equilibria"] == whole["equilibria"]
    del whole["margin"]["hardly_determined"]  # by the noise, which equilibria do not know
    assert document["margin"] == whole["margin"]
    assert WORDS.get(specimen.name, "Equilibria (exact, complete): ") in told.out


@pytest.mark.one_in(4)
@each_specimen
def test_what_is_numerical_is_not_called_exact(specimen, tmp_path: Path):
    source = write_csv(tmp_path / "source.csv", specimen.source)
    target = write_csv(tmp_path / "target.csv", specimen.target)
    run = certreg("equilibria", source, target, "--method", "homotopy")
    headline = run.out.splitlines()[0]

    doubtful = "(numerical, not proved complete): the search " in headline
    assert doubtful is ("(numerical" in headline)
    ends = (", and there may be more.", " could not tell any two rotations apart.")
    assert doubtful is headline.endswith(ends)
    unique = specimen.pattern[0] == 1
    assert run.code == (4 if doubtful else 0 if unique else 3)
    for claim in ("exactly", "infinitely many", "Not unique: ", "the optimum is not unique"):
        assert not (doubtful and claim in run.out)
    assert doubtful is ("Ambiguity margin: not known" in run.out)
    assert ("(numerical, " in headline) is (specimen.pattern != (1, 1, 1, 1))


def test_each_option_of_pairing_works_alone(tmp_path: Path):
    """As the clouds without what it leaves out."""
    rows = [(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3), (1, 1, 1)]

    def cloud(name: str, *columns: str, more: Sequence[str] = ()) -> Path:
        lines = [",".join([c for c in ("label", "weight") if c in columns] + ["x", "y", "z"])]
        for k, (x, y, z) in enumerate(rows):
            own = {"label": f"p{k}", "weight": str(1 + k)}
            lines.append(",".join([*(own[c] for c in columns), f"{y},{z},{x + k / 10}"]))
        path = tmp_path / name
        path.write_text("\n".join([*lines, *more]) + "\n", "utf-8")
        return path

    def found(*arguments: object) -> Any:
        run = certreg("equilibria", *arguments, "--json")
        assert run.code == 0, run.err
        return run.document["equilibria"]

    source = write_csv(tmp_path / "source.csv", rows)
    bare, weighted = cloud("bare.csv"), cloud("weighted.csv", "weight")
    assert found(source, weighted, "--ignore-weights") == found(source, bare)
    assert found(source, weighted) != found(source, bare)
    named = write_csv(tmp_path / "named.csv", rows, [f"p{k}" for k in range(5)])
    longer = cloud("longer.csv", "label", more=["p9,7,7,7"])
    assert found(named, longer, "--match", "common") == found(source, bare)
    assert certreg("equilibria", named, longer).code == 2


@pytest.mark.parametrize("method", ["groebner", "homotopy"])
def test_one_method_shows_the_columns_of_all(data: Path, method: str):
    def rows(chosen: str) -> dict[str, list[str]]:
        out = certreg("equilibria", *SURVEY.paths(data), "--method", chosen).out
        lines = [re.split("  +", line.strip()) for line in out.partition("\n\n")[2].splitlines()]
        return {line[0]: line for line in lines}

    one, every = rows(method), rows("all")
    assert one["road"] == every["road"]
    assert one[method][:4] + one[method][5:] == every[method][:4] + every[method][5:]


# verify ------------------------------------------------------------------------------------------


def alone(*arguments: object) -> subprocess.CompletedProcess[str]:
    """The checker as a stranger runs it: nothing installed, no environment."""
    command = [sys.executable, "-I", "-S", str(CHECKER), *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, text=True, check=False, env={}, encoding="utf-8"
    )


@pytest.fixture(scope="module")
def survey(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the certified survey."""
    folder = tmp_path_factory.mktemp("survey")
    data = CHECKER.parent / "data"
    assert certreg("certify", *SURVEY.paths(data), "--out", folder).code == 0
    return folder


def forgeries(certificate: bytes) -> dict[str, bytes]:
    """The certificate with one claim stronger than what it proves, each in turn."""
    document = json.loads(certificate)

    def stronger(**claims: Any) -> bytes:
        forged = copy.deepcopy(document)
        forged["claims"].update(claims)
        return json.dumps(forged, sort_keys=True).encode()

    claims = document["claims"]
    forged = {
        "gap": stronger(gap=[claims["gap"][0] - 1, claims["gap"][1]]),
        "no gap at all": stronger(gap=[0, 0]),
        "negative gap": stronger(gap=[-1, 0]),
        "pattern": stronger(pattern=[1, 1, 2] if claims["pattern"] != [1, 1, 2] else [1] * 4),
    }
    if claims["basin"] is None:
        forged["basin"] = stronger(basin=True)
    sdp = claims["sdp_gap"]
    forged["sdp"] = stronger(sdp_gap=[sdp[0] - 1, sdp[1]] if sdp else [1, 0])
    angle = claims["sin2_half_angle"]
    tighter = [angle[0] - 1, angle[1]] if angle else [1, -1]
    forged["angle"] = stronger(sin2_half_angle=tighter)
    counts = claims["unstable"] or [-1] * len(claims["pattern"])  # none is claimed: any is stronger
    forged["unstable"] = stronger(unstable=[count + 1 for count in counts])
    if not claims["unique"]:
        forged["unique"] = stronger(unique=True)
    return forged


@pytest.mark.slow
@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.long)])
def test_the_checker_alone_accepts_the_certificate_and_refuses_a_stronger_claim(
    data: Path, survey: Path, tmp_path: Path, every: int
):
    certificate = survey / "certificate.json"
    plain, bound = alone(certificate), certreg("verify", certificate, *SURVEY.paths(data))

    assert (plain.returncode, plain.stderr) == (0, "")
    assert plain.stdout.endswith("\nVERIFIED\n")
    assert bound.out == plain.stdout
    assert certreg("verify", certificate).out == plain.stdout
    forged = tmp_path / "forged.json"
    for name, content in [*forgeries(certificate.read_bytes()).items()][::every]:
        forged.write_bytes(content)
        refused = alone(forged)
        assert refused.returncode == 1, name
        assert re.fullmatch(r"REFUSED: [^\n]+\n", refused.stdout), name


@pytest.mark.slow
@pytest.mark.one_in(4)
@each_specimen
def test_no_certificate_of_the_zoo_survives_a_stronger_claim(specimen, tmp_path: Path):
    source = write_csv(tmp_path / "source.csv", specimen.source)
    target = write_csv(tmp_path / "target.csv", specimen.target)
    certreg("certify", source, target, "--out", tmp_path)
    certificate = tmp_path / "certificate.json"
    assert certreg("verify", certificate, source, target).code == 0

    for name, content in forgeries(certificate.read_bytes()).items():
        certificate.write_bytes(content)
        run = certreg("verify", certificate)
        assert (run.code, run.out[:9]) == (1, "REFUSED: "), name


@pytest.mark.slow
def test_verify_binds_the_certificate_to_the_points(data: Path, survey: Path, tmp_path: Path):
    certificate, (source, target) = survey / "certificate.json", SURVEY.paths(data)
    lines = target.read_text("utf-8").splitlines()
    shuffled, moved = tmp_path / "shuffled.csv", tmp_path / "moved.csv"
    shuffled.write_text("\n".join([lines[0], *reversed(lines[1:])]) + "\n", "utf-8")
    moved.write_text("\n".join(lines).replace("3039.947", "3039.948") + "\n", "utf-8")
    assert moved.read_text("utf-8") != target.read_text("utf-8")

    assert certreg("verify", certificate, source, target).code == 0
    assert certreg("verify", certificate, source, shuffled).code == 0
    refused = certreg("verify", certificate, source, moved)
    assert refused.code == 1
    assert re.fullmatch(r"REFUSED: [^\n]*points[^\n]*\n", refused.out)
    assert certreg("verify", certificate, target, source).code == 1
    assert certreg("verify", certificate, *HEAD.paths(data)).code == 1


@pytest.mark.parametrize(
    "options", [("--sigma", "0.1"), ("--weights", "w.csv"), ("--pairs", "p.csv")]
)
@pytest.mark.parametrize("command", ["verify", "report"])
def test_options_of_clouds_without_clouds_are_bad_usage(
    command: str, options: tuple[str, str], survey: Path
):
    run = certreg(command, survey / "certificate.json", *options)

    assert run.code == 2
    assert "give SOURCE and TARGET, or neither" in run.err


def test_verify_reads_clouds_of_numpy(data: Path, survey: Path, tmp_path: Path):
    problem, _ = read_problem(*SURVEY.paths(data))
    source, target, moved = (tmp_path / f"{name}.npy" for name in ("a", "b", "c"))
    np.save(source, problem.source)
    np.save(target, problem.target)
    np.save(moved, problem.target + [[1e-9, 0, 0]] * 4)
    certificate = survey / "certificate.json"

    accepted = certreg("verify", certificate, source, target)
    refused = certreg("verify", certificate, source, moved)

    assert accepted.code == 0
    assert accepted.out == certreg("verify", certificate).out
    assert refused.code == 1
    assert refused.out.startswith("REFUSED: ")


@pytest.mark.slow
def test_verify_takes_the_noise_or_the_weights_that_were_certified(tmp_path: Path):
    problem = random_problem(np.random.default_rng(6), n=5, noise=0.1)
    weights = tmp_path / "w.txt"
    weights.write_text("1\n2\n3\n4\n5\n", "utf-8")
    suffixes = {".csv": write_csv, ".npy": lambda path, points: np.save(path, np.array(points))}
    for suffix, write in suffixes.items():
        clouds = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
        for path, points in zip(clouds, (problem.source, problem.target), strict=True):
            write(path, points.tolist())
        for right, wrong in (
            (["--sigma", "0.3"], ["--sigma", "0.31"]),
            (["--weights", weights], ["--sigma", "0.3"]),
        ):
            assert certreg("certify", *clouds, *right, "--out", tmp_path).code == 0
            certificate = tmp_path / "certificate.json"
            assert certreg("verify", certificate, *clouds, *right).code == 0
            one = "the certified weight is 11.111111111111112, not {}: give --sigma 0.3\n"
            several = "the certified weights are unequal: give --weights FILE\n"
            needed = one if "--sigma" in right else several
            for given, missed in (((), "1"), (wrong, "as given")):
                words = "REFUSED: " + needed.format(missed)
                refused = certreg("verify", certificate, *clouds, *given)
                assert (refused.code, refused.out) == (1, words)
                unmade = certreg("report", certificate, *clouds, *given)
                assert (unmade.code, unmade.out) == (1, "")
                assert unmade.err.endswith(words.replace("\n", ": there is nothing to report\n"))
            both = certreg("verify", certificate, *clouds, "--sigma", "1", "--weights", weights)
            assert (both.code, both.out) == (2, "")
            any_weight = certreg("verify", certificate, *clouds, "--any-weight")
            assert any_weight.code == (0 if "--sigma" in right else 1)
            assert certreg("report", certificate, *clouds, "--any-weight").code == any_weight.code


def test_verify_refuses_bounds_that_are_larger_than_asked(data: Path, survey: Path, tmp_path: Path):
    certificate = survey / "certificate.json"
    whole = certreg("verify", certificate).out
    for option, few, many, name, units in (
        ("--max-angle", "1e-30", "1e-5", "angle", (r" rad \(\S+e-\d+ degrees\)", " rad")),
        ("--max-gap", "1e-60", "1e-6", "share", ("", "")),
    ):
        for clouds in ((), SURVEY.paths(data)):
            assert certreg("verify", certificate, *clouds, option, many).out == whole
            refused = certreg("verify", certificate, *clouds, option, few)
            assert refused.code == 1
            words = rf"REFUSED: proved bound on the {name}: \S+e-\d+{units[0]}; asked for: {few}"
            assert re.fullmatch(words + units[1] + "\n", refused.out), refused.out
        for nonsense in ("nan", "-1"):
            wrong = certreg("verify", certificate, option, nonsense)
            assert (wrong.code, wrong.out) == (2, "")
        assert certreg("verify", certificate, option, "1", "--coq").code == 2
    for wrong in (("--any-weight",), (*SURVEY.paths(data), "--any-weight", "--sigma", "1")):
        run = certreg("verify", certificate, *wrong)
        assert (run.code, run.out) == (2, "")
        assert "--any-weight goes with SOURCE TARGET, without --sigma" in run.err
    assert certreg("verify", certificate, *SURVEY.paths(data), "--any-weight").out == whole


@pytest.mark.slow
def test_any_weight_is_refused_where_the_weights_are_in_the_digest_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    problem = random_problem(np.random.default_rng(6), n=5, noise=0.1)
    clouds = tmp_path / "a.npy", tmp_path / "b.npy"
    for path, points in zip(clouds, (problem.source, problem.target), strict=True):
        np.save(path, np.array(points))
    assert certreg("certify", *clouds, "--out", tmp_path).code == 0
    certificate = tmp_path / "certificate.json"
    for most, code in ((5, 0), (4, 2)):
        monkeypatch.setattr(certified_clouds, "INLINE_MAX", most)
        run = certreg("verify", certificate, *clouds, "--any-weight")
        assert run.code == code, run.err
    assert "--any-weight is for 4 points at most: give --sigma" in run.err


def test_verify_refuses_what_is_no_certificate_and_misses_what_is_not_there(
    data: Path, survey: Path, tmp_path: Path
):
    junk = tmp_path / "junk.json"
    for content in (b"", b"{}", b"\xff\xfe\x00", b"[" * 100_000, b'{"format": NaN}', b"null"):
        junk.write_bytes(content)
        run = certreg("verify", junk)
        assert (run.code, run.out[:9]) == (1, "REFUSED: ")
        assert run.out.count("\n") == 1
    missing = certreg("verify", tmp_path / "nowhere.json")
    assert (missing.code, missing.out) == (2, "")
    assert re.fullmatch(r"[^\n]*nowhere\.json[^\n]*\n", missing.err)
    certificate = survey / "certificate.json"
    assert certreg("verify", certificate, data / SURVEY.source).code == 2
    assert certreg("verify", certificate, data / SURVEY.source, tmp_path / "no.csv").code == 2
    assert certreg("verify", certificate, data / SURVEY.source, tmp_path / "no.npy").code == 2


# assess ------------------------------------------------------------------------------------------


def scipy_pose(problem: RegistrationProblem) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The optimum as SciPy finds it."""
    w = problem.weights / problem.weights.sum()
    x, y = w @ problem.source, w @ problem.target
    turn = Rotation.align_vectors(problem.target - y, problem.source - x, weights=w)[0]
    R = turn.as_matrix()
    return R, y - R @ x


def homogeneous(R: NDArray[np.float64], t: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.vstack([np.column_stack([R, t]), [0.0, 0.0, 0.0, 1.0]])


def assess(data: Path, pair: Packaged, pose: NDArray[np.float64], tmp_path: Path) -> tuple:
    file = tmp_path / "given.txt"
    np.savetxt(file, pose, fmt="%.17g")
    arguments = ("assess", *pair.paths(data), "--pose", file)
    run, told = certreg(*arguments, "--json"), certreg(*arguments)
    assert run.code == told.code
    assert run.err == told.err == ""
    keeps(run.document, "certreg-assessment/1")
    assert told.out.startswith(run.document["headline"])
    assert run.document["words"] in told.out
    assert run.document["headline"].startswith(run.document["verdict"].upper())
    assert "the global optimum, and" not in told.out
    assert "no other" not in told.out
    return run.code, run.document, told.out


def spurious_pose(data: Path, pair: Packaged, index: int) -> NDArray[np.float64]:
    problem, _ = read_problem(*pair.paths(data))
    R = package.equilibria(problem).components[index].rotation
    return homogeneous(R, problem.target.mean(axis=0) - R @ problem.source.mean(axis=0))


@pytest.mark.slow
def test_the_flipped_survey_is_the_worst_rotation_there_is(data: Path, tmp_path: Path):
    code, document, told = assess(data, SURVEY, spurious_pose(data, SURVEY, 3), tmp_path)

    assert (code, document["verdict"]) == (1, "spurious-equilibrium")
    assert "degrees from the index-3 equilibrium: the worst rotation there is" in told
    assert document["nearest"]["morse_index"] == 3
    assert document["nearest"]["angle_deg"] < 1e-9
    assert document["angle_to_optimum_deg"] == pytest.approx(180)
    assert document["rmse"] == pytest.approx(2395.550956, abs=1e-6)
    gap = 4 * (2395.550956**2 - 5.838987**2)
    assert document["gap_lower"] == pytest.approx(gap, rel=1e-8)
    assert document["gap_upper"] == pytest.approx(gap, rel=1e-8)
    assert document["gap_lower"] <= document["gap_upper"]


@pytest.mark.slow
@pytest.mark.one_in(3)
@each_pair
def test_each_spurious_equilibrium_is_recognised(data: Path, tmp_path: Path, pair: Packaged):
    for index in (1, 2, 3):
        code, document, told = assess(data, pair, spurious_pose(data, pair, index), tmp_path)

        assert (code, document["verdict"]) == (1, "spurious-equilibrium")
        assert document["nearest"]["morse_index"] == index
        assert document["rmse"] == pytest.approx(pair.rmse[index], abs=1e-6)
        assert f"unstable in {index} direction" in told
        assert ("the worst rotation there is" in told) is (index == 3)


@each_pair
def test_the_pose_of_scipy_is_optimal_with_proved_bounds(
    data: Path, tmp_path: Path, pair: Packaged
):
    problem, _ = read_problem(*pair.paths(data))
    code, document, told = assess(data, pair, homogeneous(*scipy_pose(problem)), tmp_path)
    spread = 4 * pair.n * pair.rmse[3] ** 2

    assert code == 0  # its last digits are not always the best ones
    assert document["verdict"] in {"optimal", "near-optimal"}
    assert (document["verdict"] == "optimal") == told.startswith("OPTIMAL TO ROUNDING: within ")
    rounded = document["gap_upper"] <= document["rounding_cost"]
    assert (document["verdict"] == "optimal") == rounded
    assert 0 <= document["gap_lower"] <= document["gap_upper"] <= 1e-20 * spread
    assert document["angle_to_optimum_deg"] <= document["angle_upper_deg"] < 1e-9
    assert document["rmse"] == pytest.approx(pair.rmse[0], abs=1e-6)


@pytest.mark.slow
def test_a_random_rotation_is_no_equilibrium(data: Path, tmp_path: Path):
    rng = np.random.default_rng(7)
    for pair in PACKAGED:
        problem, _ = read_problem(*pair.paths(data))
        R, t = random_rotation(rng), rng.normal(size=3)
        code, document, told = assess(data, pair, homogeneous(R, t), tmp_path)
        residuals = problem.source @ R.T + t - problem.target

        assert (code, document["verdict"]) == (1, "not-an-equilibrium")
        assert document["objective"] == pytest.approx(float((residuals**2).sum()), rel=1e-9)
        assert "lowers the energy" in told


def test_the_optimal_rotation_at_another_place_is_no_equilibrium(data: Path, tmp_path: Path):
    problem, _ = read_problem(*SURVEY.paths(data))
    R, t = scipy_pose(problem)
    code, document, told = assess(data, SURVEY, homogeneous(R, t + np.array([0, 500, 0])), tmp_path)

    assert (code, document["verdict"]) == (1, "not-an-equilibrium")
    assert document["gap_lower"] == pytest.approx(4 * 500**2, rel=1e-9)
    assert "the centroids 500 apart" in told


def test_a_pose_a_little_off_is_near_optimal(data: Path, tmp_path: Path):
    problem, _ = read_problem(*HEAD.paths(data))
    R, t = scipy_pose(problem)
    R = R @ Rotation.from_rotvec([0, 0, 1e-4]).as_matrix()
    code, document, told = assess(data, HEAD, homogeneous(R, t), tmp_path)

    assert (code, document["verdict"]) == (0, "near-optimal")
    assert told.startswith("NEAR-OPTIMAL: within 0.00573 degrees, at most ")
    assert document["gap_upper"] > document["rounding_cost"]
    assert document["angle_to_optimum_deg"] == pytest.approx(math.degrees(1e-4), rel=1e-6)
    assert 0 < document["gap_lower"] <= document["gap_upper"]


@pytest.mark.one_in(4)
@pytest.mark.parametrize(
    ("turn", "told"), [(179.79, "179.8"), (179.94, "179.9"), (179.4, "179.4"), (12.3456, "12.35")]
)
def test_an_angle_is_not_rounded_to_half_a_turn_that_it_is_not(
    data: Path, tmp_path: Path, turn: float, told: str
):
    optimum = certreg("certify", *SURVEY.paths(data), "--json").document["pose"]
    axis = Rotation.from_rotvec([0.0, 0.0, math.radians(turn)])
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(optimum["rotation"]) @ axis.as_matrix()
    np.savetxt(tmp_path / "pose.txt", matrix, fmt="%.17g")
    run = certreg("assess", *SURVEY.paths(data), "--pose", tmp_path / "pose.txt")

    assert f"angle to optimum   {told} degrees" in run.out
    assert f"{told} degrees away" in run.out


def test_a_folder_of_certify_is_a_pose(data: Path, survey: Path):
    run = certreg("assess", *SURVEY.paths(data), "--pose", survey)

    assert (run.code, run.err) == (0, "")
    assert run.out.startswith("OPTIMAL")


def test_an_inverse_pose_is_told_as_such(data: Path, tmp_path: Path):
    R, t = scipy_pose(read_problem(*SURVEY.paths(data))[0])
    _, right, _ = assess(data, SURVEY, homogeneous(R, t), tmp_path)
    _, wrong, told = assess(data, SURVEY, homogeneous(R.T, -R.T @ t), tmp_path)

    assert right["hint"] is None
    assert wrong["hint"].startswith(f"Its inverse is {right['verdict']}")
    assert wrong["hint"] in told


@pytest.mark.slow
def test_what_is_no_rotation_is_called_so(data: Path, tmp_path: Path):
    problem, _ = read_problem(*SURVEY.paths(data))
    R, t = scipy_pose(problem)
    sheared = R @ np.array([[1, 0.2, 0], [0, 1, 0], [0, 0, 1]])
    for matrix, word in (
        (R @ np.diag([1, 1, -1.0]), "determinant -1"),
        (1.001 * R, "scales by 1.001"),
        (-1.001 * R, "scales by 1.001 and reflects"),
        (sheared, "not orthogonal"),
        (0 * R, "not orthogonal"),
    ):
        code, document, told = assess(data, SURVEY, homogeneous(matrix, t), tmp_path)

        assert (code, document["verdict"]) == (1, "not-a-rotation")
        assert word in told
        assert document["objective"] is None


@pytest.mark.slow
@pytest.mark.one_in(4)
@each_specimen
def test_assess_answers_every_row_of_the_classification(specimen, tmp_path: Path):
    source = write_csv(tmp_path / "source.csv", specimen.source)
    target = write_csv(tmp_path / "target.csv", specimen.target)
    certreg("certify", source, target, "--out", tmp_path)
    own = certreg("assess", source, target, "--pose", tmp_path / "pose.txt", "--json")

    assert own.code == 0
    keeps(own.document, "certreg-assessment/1")
    assert own.document["verdict"] == "optimal"
    assert own.document["headline"].startswith("OPTIMAL TO ROUNDING")
    assert ("not the only one" in own.document["words"]) is (specimen.pattern[0] > 1)


# Forms of a pose ---------------------------------------------------------------------------------


def lines(rows: Any) -> str:
    return "\n".join(" ".join(map(repr, row)) for row in rows) + "\n"


def pose_forms(folder: Path) -> dict[str, str]:
    """The certified pose in every form that a tool might write."""
    result = json.loads((folder / "result.json").read_text("utf-8"))
    pose = result["pose"]
    R, t, q = pose["rotation"], pose["translation"], pose["quaternion_wxyz"]
    T = np.loadtxt(folder / "pose.txt").tolist()
    return {
        "4x4 text": lines(T),
        "4x4 text with commas": lines(T).replace(" ", ", "),
        "4x4 text with a comment": "# from a tool\n\n" + lines(T).replace(" ", "\t"),
        "4x4 text of Windows": "\ufeff" + lines(T).replace("\n", "\r\n"),
        "3x4 text": lines(T[:3]),
        "7 numbers": lines([[*q, *t]]),
        "7 numbers of -q": lines([[*(-c for c in q), *t]]),
        "JSON 4x4": json.dumps(T),
        "JSON 3x4": json.dumps(T[:3]),
        "JSON T_target_source": json.dumps({"T_target_source": T}),
        "JSON matrix": json.dumps({"rotation": R, "translation": t}),
        "JSON quaternion": json.dumps({"quaternion_wxyz": q, "translation": t}),
        "JSON of Windows": "\ufeff" + json.dumps({"pose": {"rotation": R, "translation": t}}),
        "result": (folder / "result.json").read_text("utf-8"),
    }


@pytest.mark.slow
def test_every_form_of_a_pose_is_read(data: Path, survey: Path, tmp_path: Path):
    for name, text in pose_forms(survey).items():
        file = tmp_path / "pose"
        file.write_text(text, "utf-8")
        run = certreg("assess", *SURVEY.paths(data), "--pose", file, "--json")

        assert (run.code, run.err) == (0, ""), name
        assert run.document["verdict"] == "optimal", name


WRONG_POSES = {
    "empty": ("", "(4, 4)"),
    "blank": ("\n \n", "(4, 4)"),
    "commas only": (",,,\n", "(4, 4)"),
    "six numbers": ("1 0 0 0 0 0\n", "(4, 4)"),
    "3x3": ("1 0 0\n0 1 0\n0 0 1\n", "3x3 matrix"),
    "ragged": ("1 0 0 0\n0 1 0\n0 0 1 0\n0 0 0 1\n", "numbers"),
    "words": ("one two\n", "'one'"),
    "NaN": ("nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "finite"),
    "NaN quaternion": ("nan 0 0 0 0 0 0\n", "norm nan"),
    "infinite translation": ("1 0 0 0 inf 0 0\n", "finite"),
    "column vectors": ("1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n", "transpose it"),
    "last row": ("1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 2\n", "found 5 6 7 2"),
    "last row scaled": ("1 0 0 3\n0 1 0 4\n0 0 1 5\n0 0 0 2\n", "found 0 0 0 2"),
    "last row lost": ("1 0 0 3\n0 1 0 4\n0 0 1 5\n0 0 1 1\n", "found 0 0 1 1: give the 3x4"),
    "scalar last": ("0.5 0.5 0.5 0.6 0 0 0\n", "scalar first"),
    "zero quaternion": ("0 0 0 0 0 0 0\n", "norm 0"),
    "JSON cut short": ('{"rotation": [[1', "JSON"),
    "JSON without a pose": ('{"translation": [0, 0, 0]}', "rotation"),
    "JSON without a translation": ('{"rotation": [[1,0,0],[0,1,0],[0,0,1]]}', "translation"),
    "JSON with a number for a matrix": ('{"T_target_source": 5}', "pose matrix"),
    "JSON with nothing for a matrix": ('{"T_target_source": null}', "pose matrix"),
    "JSON with words for a matrix": ('{"T_target_source": "abc"}', "pose matrix"),
    "JSON with NaN": (
        '{"rotation": [[NaN,0,0],[0,1,0],[0,0,1]], "translation": [0,0,0]}',
        "finite",
    ),
    "JSON with a huge integer": ("[[1" + "0" * 400 + ",0,0,0],[0,1,0,0],[0,0,1,0]]", "numbers"),
    "JSON too deep": ("[" * 10_000, "JSON"),
    "JSON list": ("[1, 2, 3]", "numbers"),
    "JSON empty list": ("[]", "(4, 4)"),
    "binary": ("\x00\x01\x02", "matrix"),
    "a certificate": ('{"claims": {}, "pose": [1, 0, 0, 0]}', "translation"),
    "huge": ("1 " * 600_000, "larger than"),
}


@pytest.mark.parametrize("name", WRONG_POSES)
def test_a_wrong_pose_file_is_one_clear_line(data: Path, tmp_path: Path, name: str):
    text, word = WRONG_POSES[name]
    file = tmp_path / "given.pose"
    file.write_text(text, "utf-8")
    run = certreg("assess", *SURVEY.paths(data), "--pose", file)

    assert (run.code, run.out) == (2, "")
    assert re.fullmatch(r"certreg: \S+given\.pose: [^\n]{1,300}\n", run.err), run.err
    assert ("transpose" in run.err) is (word == "transpose it")
    assert word in run.err


def test_a_pose_file_that_is_not_there_is_named(data: Path, tmp_path: Path):
    missing = certreg("assess", *SURVEY.paths(data), "--pose", tmp_path / "nowhere.txt")

    assert (missing.code, missing.out) == (2, "")
    assert re.fullmatch(r"certreg: \S+nowhere\.txt: [^\n]+\n", missing.err)
    assert certreg("assess", *SURVEY.paths(data), "--pose", tmp_path).code == 2
    assert certreg("assess", *SURVEY.paths(data)).code == 2


# apply -------------------------------------------------------------------------------------------


def rmse(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return float(np.sqrt(((a - b) ** 2).sum(axis=1).mean()))


@pytest.mark.slow
def test_apply_moves_a_cloud_onto_the_optimum(data: Path, survey: Path, tmp_path: Path):
    source, target = SURVEY.paths(data)
    problem, pair = read_problem(source, target)
    binary = tmp_path / "source.npy"
    np.save(binary, problem.source)
    R, t = np.loadtxt(survey / "pose.txt")[:3, :3], np.loadtxt(survey / "pose.txt")[:3, 3]
    for result in (survey, survey / "result.json", survey / "pose.txt"):
        for cloud, out in ((source, "moved.csv"), (source, "moved.txt"), (binary, "moved.npy")):
            moved = tmp_path / out
            run = certreg("apply", result, cloud, "--out", moved)
            points = read_problem(moved, moved)[0].source

            assert (run.code, run.err) == (0, "")
            header = f"{moved} (header: label,x,y,z)\n"
            dropped = f"{moved} without their labels: a .csv file keeps them\n"
            told = {"moved.csv": header, "moved.txt": dropped, "moved.npy": f"{moved}\n"}
            assert run.out.startswith(f"4 points written to {told[out]}")
            assert out != "moved.csv" or moved.read_text("utf-8").startswith("label,x,y,z\n")
            assert points == pytest.approx(problem.source @ R.T + t, abs=1e-9)
            assert rmse(points, problem.target) == pytest.approx(SURVEY.rmse[0], abs=1e-6)
            assert certreg("certify", moved, target, "--json").document["rmse"] == pytest.approx(
                SURVEY.rmse[0], abs=1e-6
            )
    assert read_problem(tmp_path / "moved.csv", target)[1].source.labels == pair.source.labels


@pytest.mark.parametrize(("column", "value"), [("sigma", "0"), ("weight", "-1")])
def test_apply_moves_points_whatever_their_columns_of_noise_hold(
    tmp_path: Path, column: str, value: str
):
    (tmp_path / "pose.txt").write_text("1 0 0 1\n0 1 0 2\n0 0 1 3\n", "utf-8")
    (tmp_path / "a.csv").write_text(f"x,y,z,{column}\n1,2,3,{value}\n4,5,6,1\n", "utf-8")
    run = certreg("apply", tmp_path / "pose.txt", tmp_path / "a.csv", "--out", tmp_path / "b.csv")

    told = f"note: {tmp_path / 'a.csv'}: columns not moved and not written: {column}\n"
    assert (run.code, run.err) == (0, told)
    moved = np.loadtxt(tmp_path / "b.csv", delimiter=",", skiprows=1)
    assert moved.tolist() == [[2.0, 4.0, 6.0], [5.0, 7.0, 9.0]]


def test_apply_asks_for_a_place_it_can_write(data: Path, survey: Path, tmp_path: Path):
    source = data / SURVEY.source

    def refused(out: Path, *words: str, result: Path = survey, cloud: Path = source):
        run = certreg("apply", result, cloud, "--out", out)
        assert (run.code, run.out) == (2, "")
        assert re.fullmatch(r"certreg: [^\n]+\n", run.err)
        assert all(word in run.err for word in words)
        assert not out.exists()

    refused(tmp_path / "moved.stl", "moved.stl", ".csv .txt .ply .npy")
    refused(tmp_path / "no" / "such" / "moved.csv", "moved.csv", "cannot be written")
    refused(tmp_path / "a.csv", "result.json", result=tmp_path)
    refused(tmp_path / "a.csv", "nowhere.csv", cloud=tmp_path / "nowhere.csv")
    assert certreg("apply", survey, source).code == 2


NO_ROTATIONS = {
    "a reflection (determinant -1)": np.diag([1.0, 1.0, -1.0, 1.0]),
    "scales by 2:": np.diag([2.0, 2.0, 2.0, 1.0]),
    "not orthogonal": np.diag([1.0, 1.0, 3.0, 1.0]),
}


@pytest.mark.parametrize("words", NO_ROTATIONS)
def test_apply_refuses_what_is_no_rotation_in_the_words_of_assess(
    data: Path, tmp_path: Path, words: str
):
    pose, out = tmp_path / "pose.txt", tmp_path / "moved.csv"
    np.savetxt(pose, NO_ROTATIONS[words])
    clouds = SURVEY.paths(data)
    run = certreg("apply", pose, clouds[0], "--out", out)
    assessed = certreg("assess", *clouds, "--pose", pose)

    assert (run.code, run.out) == (2, "")
    told = run.err.removeprefix(f"certreg: {pose}: ").partition(" (--scaled")[0]
    assert assessed.out.startswith(told.rstrip())
    assert run.err.startswith(f"certreg: {pose}: NOT-A-ROTATION: ")
    assert assessed.out.startswith("NOT-A-ROTATION: ")
    assert words in assessed.out
    assert not out.exists()


def test_apply_refuses_points_that_leave_the_doubles(survey: Path, tmp_path: Path):
    far = tmp_path / "far.npy"
    np.save(far, [[1.7e308, 1.7e308, 1.7e308], [-1.7e308, 1.7e308, 1.7e308]])
    turn = tmp_path / "turn.txt"
    turn.write_text(
        "0.9238795325112867 0 0 0.3826834323650898 0 0 0\n", "utf-8"
    )  # 45 degrees about z
    for name in ("out.npy", "out.csv"):
        run = certreg("apply", turn, far, "--out", tmp_path / name)

        assert (run.code, run.out) == (2, "")
        assert re.fullmatch(rf"certreg: \S+{name}: [^\n]*row \d[^\n]*\n", run.err)
        assert not (tmp_path / name).exists()


def test_click_is_the_runner_of_every_command():
    assert isinstance(cli.cli, click.Group)
    assert sorted(cli.COMMANDS) == sorted(COMMANDS)
    assert cli.cli.get_command(click.Context(cli.cli), "frobnicate") is None


@pytest.mark.parametrize("width", [20, 40, 80, 200])
@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_of_commands_says_what_the_commands_say(name: str, width: int):
    _, command, _ = cli.cli.resolve_command(click.Context(cli.cli), [name])

    assert command is not None
    assert command.name == name
    assert cli.cli.commands[name].get_short_help_str(width) == command.get_short_help_str(width)
