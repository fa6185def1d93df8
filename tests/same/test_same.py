"""`make same` covers all kinds of problems, and sees whatever differs in what is made of them."""

from __future__ import annotations

import ast
import copy
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from same.compare import MEANT, compared, lines
from same.fields import Bounds, Stated, read_bounds
from same.problems import KINDS, problems
from same.recorded import Recorder, plain

HERE = Path(__file__).resolve().parent
GOLDEN = HERE.parent / "golden"
COUNTS = {
    "points": 15,
    "weights": 30,
    "planes": 22,
    "weighted planes": 15,
    "lines": 22,
    "covariances": 22,
    "information": 10,
    "factors": 10,
    "mixed": 22,
    "points, rotation": 14,
    "weights, rotation": 14,
    "points, asymmetric": 14,
    "weights, asymmetric": 14,
    "points, symmetric": 14,
    "weights, symmetric": 14,
    "points, asymmetric rotation": 14,
    "weights, asymmetric rotation": 14,
    "points, symmetric rotation": 14,
    "weights, symmetric rotation": 14,
    "points, wrong pairs": 21,
    "planes, wrong pairs": 15,
    "lines, wrong pairs": 10,
    "covariances, wrong pairs": 10,
    "mixed, wrong pairs": 10,
    "points, asymmetric, wrong pairs": 10,
    "points, symmetric, wrong pairs": 10,
    "points, rotation, truncated": 12,
    "many pairs": 6,
    "many planes": 4,
    "planar": 12,
    "collinear": 10,
    "symmetric": 12,
    "repeated eigenvalues": 12,
    "tiny": 8,
    "huge": 8,
    "far from the origin": 12,
    "one to four pairs": 32,
    "free translations": 8,
    "poor fit": 40,
    "many solved": 5,
    "many springs solved": 6,
    "many certified": 5,
    "many simulated": 6,
    "breaking": 6,
    "list": 2,
}
SEEN: dict[str, Any] = {
    "certify": {
        "headline": "CERTIFIED: the global optimum.",
        "document": {"rmse": 0.1, "notes": [], "pose": {"rotation": [[0.1, 0.2]]}},
    },
    "certificate": {"digest": "0a1b"},
    "command": {"exit code": 0},
}


def test_there_are_600_problems_of_all_kinds():
    made = [name.partition("/")[0] for name, _ in problems()]

    assert {kind: made.count(kind) for kind in KINDS} == COUNTS
    assert len(made) == sum(COUNTS.values()) == 600
    assert {name.partition("/")[0] for name, _ in problems(quick=True)} == COUNTS.keys()


def test_all_that_can_be_said_of_a_problem_is_said_of_some():
    statements, losses, sizes, calls = set[str](), set[str](), set[int](), set[str]()
    for _, problem in problems():
        statements |= {
            f"{key} {v}" if isinstance(v, str) else key for key, v in problem.statement.items()
        }
        losses |= {*problem.loss}
        sizes.add(len(problem.source))
        calls.add(problem.call)

    springs = {"weights", "sigma", "normals", "directions", "covariances", "information", "factors"}
    motions = {"rotation_only", "scale asymmetric", "scale symmetric", "damping"}
    assert statements == springs | motions
    assert losses == {"max_residual", "objective"}
    assert sizes >= {1, 2, 3, 4, 5000}
    assert len(calls) == 7


def test_both_sides_get_the_same_doubles():
    for (name, one), (other_name, other) in zip(
        problems(quick=True), problems(quick=True), strict=True
    ):
        assert name == other_name
        assert one.source.tobytes() + one.target.tobytes() == other.source.tobytes() + (
            other.target.tobytes()
        )


def imported(path: Path) -> set[str]:
    """The modules that a file imports, those for types alone too."""
    nodes = list(ast.walk(ast.parse(path.read_text("utf-8"))))
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    return names | {node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)}


def test_the_problems_come_from_numpy_and_seeds_alone():
    roots = {name.partition(".")[0] for name in imported(HERE / "problems.py")}

    assert roots - sys.stdlib_module_names == {"numpy"}


@pytest.mark.parametrize(
    "path",
    [*HERE.glob("*.py"), *(path for path in GOLDEN.glob("*.py") if path.stem != "net_inside")],
    ids=lambda path: path.stem,
)
def test_what_users_see_is_recorded_by_public_names(path: Path):
    inner = {name for name in imported(path) if name.startswith("certreg.")}

    assert inner == set()


# Recording ----------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", ["lines/10", "one to four pairs/0", "points, wrong pairs/0"])
def test_a_record_holds_digests_exit_codes_first_lines_and_no_times(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (problem,) = (problem for other, problem in problems(quick=True) if other == name)
    told = Recorder(HERE.parents[1], tmp_path).record(problem)

    assert told["certify"]["headline"].startswith("CERTIFIED")
    assert len(told["certificate"]["digest"]) == len(told["command"]["certificate"]["digest"]) == 64
    assert told["command"]["exit code"] in {0, 3}
    assert told["verify"]["ruling"] == "proved"
    assert told["command"]["stdout"]["schema"] == told["certify"]["document"]["schema"]
    assert "timings_ms" not in str(told)
    assert str(tmp_path) not in str(told)


def test_a_value_is_kept_with_all_its_digits_and_without_times():
    value = {"a": np.array([0.1]), "timings_ms": {"compute": 3.0}, "b": (True, None, 1 + 2j)}

    assert plain(value) == {"a": [0.1], "b": [True, None, "complex"]}


# Comparing ----------------------------------------------------------------------------------------


def held(change: Any, bounds: Bounds | None = None) -> tuple[bool, str]:
    """Whether a change of the second of two records passes, and what is printed of it."""
    names = ("planes/0", "planes/1", "lines/0")
    base, head = ({name: copy.deepcopy(SEEN) for name in names} for _ in range(2))
    change(head["planes/1"])
    found = compared(base, head, bounds)
    return found.passes, "\n".join(lines(found))


def test_two_records_that_are_the_same_pass():
    assert held(lambda _: None) == (True, "3 problems: all identical")


@pytest.mark.parametrize(
    ("field", "planted", "told"),
    [
        ("certificate.digest", "0a1c", "'0a1b' was, '0a1c' is"),
        ("command.exit code", 3, "planes/1: 0 was, 3 is"),
        (
            "certify.document.rmse",
            math.nextafter(0.1, 1.0),
            "moved by 1.4e-17, a share of 1.4e-16",
        ),
        ("certify.document.pose.rotation", [[0.2, 0.1]], "a share of 5.0e-01"),
        ("certify.document.rmse", None, "1 other"),
        ("certify.headline", "CERTIFIED: the global minimum.", "minimum.' is"),
        ("certify.document.notes", ["a note"], "1 other"),
        ("certify.document.pose", {"rotation": [[0.1]]}, "1 other"),
    ],
)
def test_whatever_differs_is_no_pass(field: str, planted: Any, told: str):
    *places, last = field.split(".")

    def plant(document: Any) -> None:
        for place in places:
            document = document[place]
        document[last] = planted

    passes, page = held(plant)
    assert not passes
    assert page.startswith("planes\n")
    assert field in page
    assert told in page
    assert page.endswith("1 of 3 problems differ; fields that may not: 1")


def test_a_field_that_is_missing_is_no_pass_and_a_new_one_is_only_told():
    gone = held(lambda document: document["certify"]["document"].pop("rmse"))
    new = held(lambda document: document["certify"]["document"].update(scale=2.0))

    assert not gone[0]
    assert "certify.document.rmse: 1 gone" in gone[1]
    assert new[0]
    assert "new  certify.document.scale: 1 new" in new[1]


def test_what_is_meant_passes_for_the_problems_that_it_is_of():
    def plant(document: Any) -> None:
        document["certify"]["document"]["rmse"] = 0.1 + 1e-13

    def stated(**given: Any) -> Bounds:
        return Bounds((Stated(("*.rmse",), "another sum", **given),))

    assert held(plant, stated(share=1e-11))[0]
    assert "another sum" in held(plant, stated(share=1e-11, paths=("planes/*",)))[1]
    assert not held(plant, stated(share=1e-14))[0]
    assert not held(plant, stated(changes=True, paths=("lines/*",)))[0]


def test_the_list_of_what_is_meant_can_be_read():
    assert all(entry.reason for entry in read_bounds(MEANT).fields)


def test_records_of_other_problems_are_not_compared():
    with pytest.raises(SystemExit, match="one side has 1 problems, the other 2"):
        compared({"planes/0": SEEN}, {"planes/0": SEEN, "planes/1": SEEN})
