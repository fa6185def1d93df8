"""Errors carry evidence: what the message tells a reader, the fields tell a program."""

from __future__ import annotations

import ast
import inspect
import pickle
import sys
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cloud_files
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from syntax import nodes

import certreg
from certreg import RegistrationProblem, errors
from certreg.campaign import runner, store, workers
from certreg.campaign.table import require_parquet
from certreg.certificate.coq import find_coqc
from certreg.dynamics.batch import bodies_of
from certreg.equilibrium.batch import solve_many
from certreg.errors import (
    CampaignError,
    CertregError,
    DegenerateProblemError,
    InvalidFileError,
    InvalidProblemError,
    MissingToolError,
    OutOfRangeError,
)
from certreg.exact.decimals import at_most
from certreg.io.clouds import read_cloud
from certreg.io.poses import read_pose
from certreg.io.problems import read_problem, read_weights

if TYPE_CHECKING:
    from collections.abc import Callable

PACKAGE = Path(certreg.__file__).parent
KINDS = [
    kind
    for _, kind in inspect.getmembers(errors, inspect.isclass)
    if issubclass(kind, CertregError) and kind.__module__ == errors.__name__
]
CLOUD = np.arange(30.0).reshape(10, 3) ** 1.5


def raised(kind: type[CertregError], act: Callable[..., Any], *args: Any) -> Any:
    with pytest.raises(kind) as caught:
        act(*args)
    return caught.value


def evidence(error: CertregError) -> dict[str, Any]:
    """The fields that say something."""
    return {name: value for name, value in vars(error).items() if given_(value)}


def given_(value: object) -> bool:
    return value is not None and not (isinstance(value, tuple) and value == ())


def fields(kind: type[CertregError]) -> dict[str, inspect.Parameter]:
    parameters = list(inspect.signature(kind.__init__).parameters.values())[2:]
    return {one.name: one for one in parameters if one.kind is not one.VAR_KEYWORD}


# What every error promises ------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_fields_are_named_documented_and_empty_unless_given(kind):
    for name, parameter in fields(kind).items() if kind is not CertregError else ():
        assert parameter.kind is parameter.KEYWORD_ONLY
        assert f"{name}:" in (inspect.getdoc(kind) or "") or name == "verdict"
        if name != "verdict":
            assert not given_(getattr(kind("words"), name))


# RefusedCertificateError holds a verdict: a campaign sends its text alone.
TRAVELLING = [kind for kind in KINDS if kind.__name__ != "RefusedCertificateError"]


@pytest.mark.parametrize("kind", TRAVELLING, ids=lambda kind: kind.__name__)
def test_the_fields_travel_between_processes(kind):
    names = [name for name in fields(kind) if name != "verdict"] if kind is not CertregError else []
    words = {name: (f"of {name}",) for name in names}
    again = pickle.loads(pickle.dumps(kind("words", **words)))  # noqa: S301 - our own bytes

    assert str(again) == "words"
    assert vars(again) == words


def calls(folder: Path) -> list[tuple[str, str, set[str]]]:
    """Every error that a folder makes: where, of which kind, with which fields."""
    names = {kind.__name__ for kind in KINDS}
    made: list[tuple[str, str, set[str]]] = []
    for path in sorted(folder.rglob("*.py")):
        for node in nodes(path.read_text("utf-8")):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
                continue
            if node.func.id in names:
                words = {str(word.arg) for word in node.keywords}
                made.append((f"{path.name}:{node.lineno}", node.func.id, words))
    return made


@pytest.mark.slow
def test_readers_and_problems_never_refuse_without_evidence():
    made = calls(PACKAGE / "io") + calls(PACKAGE / "problem")

    assert len(made) > 60
    assert [place for place, _, words in made if not words] == []


@pytest.mark.slow
def test_no_field_is_there_for_nothing():
    used = {(kind, field) for _, kind, words in calls(PACKAGE) for field in words}
    declared = {(kind.__name__, name) for kind in KINDS if kind is not CertregError
                for name in fields(kind)}  # fmt: skip

    assert declared - used == set()


# The fields, one by one ---------------------------------------------------------------------------


@given(
    name=st.sampled_from(["source", "target", "weights", "sigma"]),
    row=st.integers(0, 9),
    axis=st.integers(0, 2),
    bad=st.sampled_from([np.nan, np.inf, -np.inf]),
)
def test_a_number_that_is_not_finite_is_found_by_array_and_row(name, row, axis, bad):
    arrays: dict[str, Any] = {"source": CLOUD.copy(), "target": CLOUD.copy()}
    flat = name in {"weights", "sigma"}
    arrays[name] = arrays.get(name, np.ones(10))
    arrays[name][(row,) if flat else (row, axis)] = bad
    error = raised(InvalidProblemError, lambda: RegistrationProblem(**arrays))

    assert (error.array, error.row) == (name, row)
    assert np.array_equal(error.value, arrays[name][row], equal_nan=True)


@given(name=st.sampled_from(["weights", "sigma"]), row=st.integers(0, 9), size=st.floats(0.1, 9.0))
def test_a_negative_number_is_found_with_the_limit_that_it_misses(name, row, size):
    numbers: Any = np.ones(10)
    numbers[row] = -size
    error = raised(
        InvalidProblemError, lambda: RegistrationProblem(CLOUD, CLOUD, **{name: numbers})
    )

    assert evidence(error) == {"array": name, "row": row, "value": -size, "limit": 0.0}


def large(value: float) -> np.ndarray:
    numbers = CLOUD.copy()
    numbers[7, 1] = value
    return numbers


@pytest.mark.parametrize(
    ("act", "expected"),
    [
        (
            lambda: RegistrationProblem(CLOUD[:, :2], CLOUD),
            {"array": "source", "value": (10, 2)},
        ),
        (
            lambda: RegistrationProblem(CLOUD, CLOUD[:0]),
            {"array": "target", "value": 0, "limit": 1},
        ),
        (
            lambda: RegistrationProblem(CLOUD, CLOUD[:4]),
            {"array": "target", "value": 4, "limit": 10},
        ),
        (
            lambda: RegistrationProblem(CLOUD, CLOUD.astype(complex)),
            {"array": "target", "value": np.dtype(complex)},
        ),
        (
            lambda: RegistrationProblem(large(0.0).astype(np.int64) + 2**53 + 1, CLOUD),
            {"array": "source", "row": 0},
        ),
        (
            lambda: RegistrationProblem(CLOUD, CLOUD, sigma=-1.0),
            {"array": "sigma", "value": -1.0, "limit": 0.0},
        ),
        (
            lambda: RegistrationProblem(CLOUD, CLOUD, damping=0.0),
            {"array": "damping", "value": 0.0, "limit": (1e-150, 1e150)},
        ),
        (
            lambda: certreg.register(large(np.nan), CLOUD),
            {"array": "source", "row": 7},
        ),
        (
            lambda: certreg.register(CLOUD, CLOUD, threads=0),
            {"array": "threads", "value": 0, "limit": 1},
        ),
        (
            lambda: certreg.register(CLOUD, CLOUD, -np.ones(10)),
            {"array": "weights", "row": 0, "limit": 0.0},
        ),
    ],
)
def test_what_is_wrong_with_a_problem_is_in_the_fields(act, expected):
    assert evidence(raised(InvalidProblemError, act)).items() >= expected.items()


@pytest.mark.parametrize(
    ("source", "rank"), [(np.outer(np.arange(9.0), [1, 2, 3]), 1), (np.ones((9, 3)), 0)]
)
def test_the_rank_of_a_source_that_cannot_turn_is_told(source, rank):
    problem = RegistrationProblem(source, CLOUD[:9])

    assert evidence(raised(DegenerateProblemError, certreg.simulate, problem)) == {"rank": rank}


def test_the_problem_of_many_that_is_wrong_is_told():
    sources = np.stack([CLOUD] * 6)
    sources[4, 7, 2] = np.nan
    error = raised(InvalidProblemError, solve_many, sources, CLOUD)

    assert (error.array, error.instance, error.row) == ("sources", 4, 7)
    sources[4] = np.outer(np.arange(10.0), [1, 2, 3])
    assert raised(DegenerateProblemError, bodies_of, sources, CLOUD).instance == 4


def test_rounding_that_leaves_a_rotation_in_doubt_is_measured():
    line = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])
    error = raised(DegenerateProblemError, certreg.register, line, line)

    assert f"{error.value:.3g} apart" in str(error)
    assert f"move them by {at_most(error.limit)};" in str(error)


ROWS = [[0.5, 1.0, 2.0], [1.5, 2.0, 3.0], [2.5, 7.0, 4.0], [3.5, 4.0, 9.0]]
TEXTS = {
    "csv": "x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in ROWS),
    "txt": "".join(f"{x} {y} {z}\n" for x, y, z in ROWS),
    "xyz": "4\nwater\n" + "".join(f"O {x} {y} {z}\n" for x, y, z in ROWS),
    "ply": cloud_files.xyz_ply(ROWS, "ascii").decode(),
    "pcd": cloud_files.pcd([(axis, "F", 4, 1) for axis in "xyz"], ROWS, "ascii").decode(),
}


@pytest.mark.slow
@given(
    suffix=st.sampled_from(sorted(TEXTS)),
    row=st.integers(0, 3),
    word=st.text("ghjk", min_size=1, max_size=5),
)
def test_a_word_in_the_place_of_a_number_is_found_by_file_line_and_column(
    tmp_path_factory, suffix, row, word
):
    lines = TEXTS[suffix].splitlines(keepends=True)
    number = len(lines) - 4 + row
    word = word.strip()
    lines[number] = lines[number].replace(str(ROWS[row][2]), word)
    path = tmp_path_factory.mktemp("words") / f"a.{suffix}"
    path.write_text("".join(lines), "utf-8")
    error = raised(InvalidFileError, read_cloud, path)

    place: dict[str, object] = {"path": path, "line": number + 1, "value": word}
    titled = suffix != "xyz" and (suffix, row) != ("txt", 0)  # there it might be a header
    assert evidence(error) == (place | {"column": "z"} if titled else place)


@given(suffix=st.sampled_from(["npy", "ply", "pcd"]), row=st.integers(0, 3))
def test_a_number_that_is_not_finite_is_found_by_file_and_row(tmp_path_factory, suffix, row):
    points = np.array(ROWS)
    points[row, 1] = np.nan
    content = {
        "npy": lambda: cloud_files.npy(points),
        "ply": lambda: cloud_files.xyz_ply(points.tolist(), "binary_little_endian"),
        "pcd": lambda: cloud_files.pcd(
            [(axis, "F", 8, 1) for axis in "xyz"], points.tolist(), "binary"
        ),
    }[suffix]()
    path = tmp_path_factory.mktemp("rows") / f"a.{suffix}"
    path.write_bytes(content)
    error = raised(InvalidFileError, read_cloud, path)

    assert (error.path, error.row) == (path, row)
    assert np.array_equal(error.value, points[row], equal_nan=True)


@pytest.mark.parametrize(
    ("name", "content", "act", "expected"),
    [
        ("a.abc", "", read_cloud, {"value": ".abc"}),
        ("a.csv", "x,y,z\n1,2\n", read_cloud, {"line": 2, "value": 2, "limit": 3}),
        ("a.csv", "1,2,3,4\n", read_cloud, {"line": 1, "value": 4, "limit": 3}),
        ("a.txt", "1\n-2\n", read_weights, {"row": 1, "value": -2.0, "limit": 0.0}),
        ("a.txt", "1 0 0 0 2 0 0 9 9", read_pose, {"column": "the pose matrix"}),
        ("a.txt", "2 0 0 0 1 1 1", read_pose, {"column": "quaternion_wxyz", "value": 2.0}),
        ("a.json", '{"translation": [1]}', read_pose, {}),
        ("a.pcd", "VERSION 0.7\nFIELDS\n", read_cloud, {"column": "DATA"}),
        ("a.pcd", "VERSION 0.7\nPOINTS\nDATA ascii\n", read_cloud, {"line": 2, "column": "POINTS"}),
        ("a.ply", "ply\nformat binary 1.0\nend_header\n", read_cloud, {"column": "format"}),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_file_is_in_the_fields(tmp_path, name, content, act, expected):
    path = tmp_path / name
    path.write_text(content, "utf-8")
    error = raised(InvalidFileError, act, path)

    assert evidence(error).items() >= ({"path": path} | expected).items()


def test_a_file_that_is_not_there_is_named():
    error = raised(InvalidFileError, read_cloud, "nowhere.csv")

    assert evidence(error) == {"path": Path("nowhere.csv")}


def test_the_label_in_the_way_is_named_with_its_file(tmp_path):
    paths = tmp_path / "a.csv", tmp_path / "b.csv"
    paths[0].write_text("label,x,y,z\np,1,2,3\nq,4,5,6\n", "utf-8")
    paths[1].write_text("label,x,y,z\np,1,2,3\nr,4,5,6\n", "utf-8")
    error = raised(InvalidFileError, read_problem, *paths)

    assert evidence(error) == {"path": paths[1], "column": "label", "value": "q", "limit": 1}


def test_the_tool_that_is_missing_is_named(monkeypatch):
    monkeypatch.setattr("shutil.which", lambda _: None)
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)

    assert evidence(raised(MissingToolError, find_coqc)) == {"tool": "coqc"}
    assert evidence(raised(MissingToolError, require_parquet)) == {"tool": "pyarrow"}


def test_the_translation_that_no_double_holds_is_given_exactly():
    far = 2.0**1023
    problem = RegistrationProblem([[far, 0, 0]], [[-far, 0, 0]])
    error = raised(OutOfRangeError, certreg.certify, problem)

    assert list(error.value) == [-(2**1024), 0, 0]


def test_a_folder_at_work_is_named(tmp_path):
    with store._locked(tmp_path):
        error = raised(CampaignError, store._locked(tmp_path).__enter__)

    assert evidence(error) == {"path": tmp_path}


def test_the_shard_on_which_workers_die_is_named():
    lost = deque([runner.Task(shard=7, function=runner.perform, arguments={})])
    error = raised(CampaignError, runner._require_hope, runner.BREAKDOWNS + 1, lost)

    assert evidence(error) == {
        "shard": 7,
        "value": runner.BREAKDOWNS + 1,
        "limit": runner.BREAKDOWNS,
    }


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_named():
    pytest.importorskip("distributed", reason="the extra `campaign` is not installed")
    error = raised(CampaignError, workers._connected, "no address", 0.1)

    assert evidence(error) == {"address": "no address"}
