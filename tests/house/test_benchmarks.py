"""The benchmarks: bounds that fail, peers that are right, documents that keep to their schema."""

from __future__ import annotations

import copy
import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree as ET

import mpmath
import numpy as np
import pytest
from jsonschema import Draft202012Validator

from benchmarks import __main__ as command
from benchmarks import accuracy, comparing, plots, tables
from benchmarks.clouds import random_clouds, random_problem
from benchmarks.measuring import Figure, Quantity, Series, exponent, fastest
from benchmarks.peers import PEERS, Peer, presence
from benchmarks.reference import angle, angle_of_matrix, optimal_quaternion
from benchmarks.run import LATEST, SCHEMA, Run, read
from certreg.geometry.so3 import rotation_matrix

ROOT = Path(__file__).parents[2]
VALIDATOR = Draft202012Validator(json.loads(SCHEMA.read_text("utf-8")))
NAMES = [peer.name for peer in PEERS]


def figure(value: float, **bounds: Any) -> Figure:
    return Figure(what="a ratio", value=Quantity(value, "x"), **bounds)


@pytest.fixture
def small_run(monkeypatch: pytest.MonkeyPatch) -> Run:
    """A run of two measurements, one of which misses its bound."""
    monkeypatch.setattr("benchmarks.run.presences", lambda: [presence(PEERS[0]), presence(GONE)])
    lines = {"certreg": {10: 1e-6, 100: 1e-5}, "SciPy": {10: 1e-4, 100: 1e-4}}
    series = Series(what="one registration", size="points", lines=lines)
    beside = {"certreg": Quantity(1e-16, "rad"), "SciPy": Quantity(math.inf, "rad")}
    angles = [
        Figure(what=case, value=Quantity(1e-16, "rad"), bound=1e-14, beside=beside)
        for case in plots.CASES
    ]
    run = Run()
    run.measure(
        {
            "comparing": SimpleNamespace(
                __doc__="One.", measure=lambda: [series, figure(9.0, least=10.0)]
            ),
            "accuracy": SimpleNamespace(__doc__="Two.", measure=lambda: angles),
        }  # pyright: ignore[reportArgumentType]
    )
    return run


GONE = Peer(name="Gone", package="gone", call="gone()", prepare=lambda *_: __import__("gone_peer"))


@pytest.mark.parametrize(
    ("value", "bounds", "passed"),
    [
        (2.0, {}, None),
        (2.0, {"bound": 2.0}, True),
        (2.1, {"bound": 2.0}, False),
        (2.0, {"least": 2.0}, True),
        (1.9, {"least": 2.0}, False),
        (1.0, {"least": 0.95, "bound": 1.05}, True),
        (1.1, {"least": 0.95, "bound": 1.05}, False),
        (math.nan, {"bound": 2.0}, False),
        (math.nan, {"least": 2.0}, False),
        (math.inf, {"bound": 2.0}, False),
    ],
)
def test_a_figure_keeps_its_bounds_or_misses_them(value, bounds, passed):
    assert figure(value, **bounds).passed is passed


def test_the_exponent_is_the_power_of_the_size():
    assert exponent({n: 3.0 * n**1.25 for n in (10, 100, 1000, 5000)}) == pytest.approx(1.25)
    assert exponent(dict.fromkeys((10, 100), 7.0)) == 0.0


def test_works_are_timed_in_turn():
    calls: list[str] = []

    times = fastest(lambda: calls.append("a"), lambda: calls.append("b"), rounds=3, seconds=0.0)

    assert re.fullmatch("(a+b+){3}", "".join(calls))
    assert min(times) > 0


def test_every_peer_that_is_installed_finds_the_optimal_rotation():
    """SciPy and NumPy always are."""
    source, target = random_clouds(50, noise=0.1, seed=3)
    reference = optimal_quaternion(source, target, np.ones(50))
    installed = [peer for peer in PEERS if not presence(peer).absent]

    assert {peer.name for peer in installed} >= {"SciPy", "NumPy"}
    for peer in installed:
        assert angle_of_matrix(peer.prepare(source, target)(), reference) < 1e-12, peer.name


@pytest.mark.slow
def test_every_way_is_timed_on_the_same_clouds():
    lines = comparing.times_of((10,), threads=1)

    assert next(iter(lines)) == comparing.OURS
    assert set(lines) >= {comparing.SUMS, comparing.READING, comparing.PROOF, "SciPy", "NumPy"}
    assert all(times.keys() == {10} and times[10] > 0 for times in lines.values())


def test_a_ratio_is_to_the_fastest_library_and_claimed_on_one_core_only():
    """NumPy is faster than both, and no library that registers."""
    times = {"certreg": 1.0, "reading once": 0.5, "NumPy": 2.0, "SciPy": 40.0, "gtsam": 3.0}
    for bounded, passed in ((True, [False, True]), (False, [None, None])):
        found = list(comparing._ratios(times, "here", bounded=bounded))
        assert [each.passed for each in found] == passed
        assert [each.value for each in found] == [Quantity(3.0, "x"), Quantity(40.0, "x")]
        assert "gtsam" in found[0].what


@pytest.mark.slow
def test_one_core_is_one_core():
    """Of the process that measures: what it loads sees one, and starts no more threads."""
    words = "from benchmarks import comparing as c; c.tie_to_one_core(); print(c._cores())"
    script = [sys.executable, "-c", words]
    done = subprocess.run(
        script, cwd=ROOT, capture_output=True, text=True, check=True, encoding="utf-8"
    )

    assert int(done.stdout) == (1 if hasattr(os, "sched_setaffinity") else os.cpu_count())


def test_a_peer_is_absent_with_a_reason_and_never_dropped():
    assert presence(GONE).as_json()["absent"] == "No module named 'gone_peer'"
    assert {each["name"] for each in read()["peers"]} == set(NAMES)


def test_a_peer_that_answers_wrongly_is_not_timed():
    wrong = Peer(name="Wrong", package="numpy", call="", prepare=lambda *_: lambda: np.eye(3))

    with pytest.raises(AssertionError, match="Wrong does not find the rotation"):
        presence(wrong)


def test_the_peers_to_install_are_those_that_are_measured():
    """NumPy and SciPy are in the lock files; all others are pinned."""
    text = (ROOT / "benchmarks" / "peers.txt").read_text("utf-8")
    pinned = set(re.findall(r"^([a-z0-9-]+)==[\d.]+(?:  #.*)?$", text, re.MULTILINE))

    assert pinned == {peer.package for peer in PEERS} - {"numpy", "scipy"}


def test_the_reference_is_the_optimum_and_angles_are_angles():
    """Both ways to an angle, at a turn that is known, far below a double's rounding, too."""
    problem = random_problem(20, seed=1)
    reference = optimal_quaternion(problem.source, problem.target, problem.weights)
    q = np.array([float(entry) for entry in reference])
    turn = np.array([1.0, 0.0, 0.0, 1e-7])  # half the angle, about the vertical
    w, z = turn[0], turn[3]
    turned = [w * q[0] - z * q[3], w * q[1] - z * q[2], w * q[2] + z * q[1], w * q[3] + z * q[0]]
    matrix = np.array(rotation_matrix(turned)) / np.dot(turned, turned)

    assert angle(q.tolist(), reference) < 2e-16
    assert angle(turned, reference) == pytest.approx(2e-7, rel=1e-8)
    assert angle_of_matrix(matrix, reference) == pytest.approx(2e-7, rel=1e-7)
    assert angle_of_matrix(np.diag([1.0, -1.0, -1.0]), mpmath.matrix([1, 0, 0, 0])) == math.pi


def test_a_peer_that_refuses_or_overflows_has_no_angle():
    def refuses(*_):
        raise RuntimeError("no")

    source, target = random_clouds(5)
    reference = optimal_quaternion(source, target, np.ones(5))
    answers: list[Any] = [refuses, lambda *_: lambda: np.full((3, 3), np.nan), lambda *_: lambda: 0]
    for prepare in answers:
        peer = Peer(name="", package="", call="", prepare=prepare)
        assert accuracy._peer_error(peer, source, target, reference) == math.inf


def test_the_committed_run_is_valid_and_whole():
    run = read()

    assert [error.message for error in VALIDATOR.iter_errors(run)] == []
    assert set(run["figures"]) | set(run["series"]) <= set(command.MEASUREMENTS)
    for row in run["series"].values():
        for line in (line for series in row for line in series["lines"]):
            assert len(line["sizes"]) == len(line["seconds"])
            assert line["sizes"] == sorted(set(line["sizes"]))


def test_the_committed_run_tells_of_every_bound_that_was_missed():
    run = read()

    found = [(name, each) for name, row in run["figures"].items() for each in row]
    missed = [f"{name}: {each['what']}" for name, each in found if each["passed"] is False]
    assert run["missed"] == missed
    for _, each in found:
        sides = (each["bound"], each["least"])
        quantity = Quantity(math.nan if each["value"] is None else each["value"], each["unit"])
        again = Figure(what=each["what"], value=quantity, bound=sides[0], least=sides[1])
        assert again.passed is each["passed"]


def test_a_run_is_written_as_its_schema_says(small_run, tmp_path):
    small_run.write(tmp_path / "run.json")
    document = read(tmp_path / "run.json")

    assert [error.message for error in VALIDATOR.iter_errors(document)] == []
    assert document["missed"] == ["comparing: a ratio"]
    assert document["peers"][1] == {
        "name": "Gone",
        "package": "gone",
        "call": "gone()",
        "version": None,
        "absent": "No module named 'gone_peer'",
    }


def test_the_schema_is_one_of_draft_2020_12():
    Draft202012Validator.check_schema(VALIDATOR.schema)


@pytest.mark.one_in(4)
@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("schema",), "certreg-benchmarks/2"),
        (("date",), "yesterday"),
        (("seconds",), -1),
        (("commit",), {"id": "main", "changed": False}),
        (("machine", "memory"), "much"),
        (("machine", "more"), 1),
        (("load", "start"), [1.0]),
        (("versions", "numpy"), 2),
        (("peers",), []),
        (("peers", 0, "version"), None),
        (("peers", 1, "version"), "1.0"),
        (("figures", "comparing"), []),
        (("figures", "comparing", 0, "passed"), "no"),
        (("figures", "accuracy", 0, "beside", "SciPy"), 1.0),
        (("series", "comparing", 0, "size"), "metres"),
        (("series", "comparing", 0, "lines", 0, "seconds"), [0.0, 1.0]),
        (("series", "comparing", 0, "lines", 0, "sizes"), [1.5]),
    ],
)
def test_what_is_wrong_is_not_valid(small_run, path, value):
    document = json.loads(json.dumps(small_run.document()))
    assert VALIDATOR.is_valid(document)
    wrong: Any = copy.deepcopy(document)
    part = wrong
    for step in path[:-1]:
        part = part[step]
    part[path[-1]] = value

    assert not VALIDATOR.is_valid(wrong)


def test_the_ratios_are_those_of_the_times(small_run):
    series = small_run.document()["series"]["comparing"][0]

    assert tables.ratios(series).splitlines() == [
        "| points | 10 | 10² |",
        "| :-- | --: | --: |",
        "| **certreg** | 1 µs | 10 µs |",
        "| SciPy | 100× | 10× |",
    ]
    assert "100x      10x" in str(small_run.series["comparing"][0])


def test_a_plot_shows_the_numbers_of_the_document_and_names_every_line(small_run):
    series = small_run.document()["series"]["comparing"][0]

    (axes,) = plots.cost(series).axes

    drawn = [np.asarray(line.get_xydata()).tolist() for line in axes.lines]
    for line in series["lines"]:
        assert [list(pair) for pair in zip(line["sizes"], line["seconds"], strict=True)] in drawn
    assert {text.get_text() for text in axes.texts} >= {"certreg", "SciPy"}
    assert axes.get_xscale() == axes.get_yscale() == "log"


def test_an_answer_that_is_none_has_no_mark(small_run):
    (axes,) = plots.accuracy(small_run.document()).axes

    assert [text.get_text() for text in axes.get_yticklabels()] == ["SciPy", "certreg"]
    errors = [np.asarray(line.get_xdata()) for line in axes.lines if line.get_marker() != "None"]
    assert len(errors) == len(plots.CASES)
    for each in errors:
        assert np.array_equal(each, [math.nan, 1e-16], equal_nan=True)


def test_names_in_a_column_do_not_overlap():
    heights = [0.5, 0.5, 0.52, 0.9, 0.1, 0.51]

    placed = plots.spread(heights, gap=0.05)

    assert min(np.diff(sorted(placed))) >= 0.05 - 1e-12
    assert placed[3:5] == [0.9, 0.1]
    crowd = [0, 1, 2, 5]  # a stack stands where its names would be
    assert np.mean([placed[k] for k in crowd]) == pytest.approx(
        np.mean([heights[k] for k in crowd])
    )


@pytest.mark.long
def test_the_drawings_are_svg_without_a_date(small_run, tmp_path):
    document = small_run.document()

    written = plots.write(document, tmp_path)

    assert [path.name for path in written] == ["cost-against-points.svg", "accuracy.svg"]
    assert plots.drawings(document) == {path.stem: path.read_bytes() for path in written}
    for path in written:
        assert ET.fromstring(path.read_bytes()).tag.endswith("svg")  # noqa: S314 (our own file)


@pytest.mark.slow
@pytest.mark.parametrize("drawn", [False, pytest.param(True, marks=pytest.mark.long)])
def test_the_page_is_made_from_the_committed_run(drawn: bool, monkeypatch: pytest.MonkeyPatch):  # noqa: FBT001
    """Every cell runs; the tables hold every peer, absent or not, and every claim.

    The figures are drawn where the documentation is built, too.
    """
    if not drawn:
        plain = {name: b"<svg/>" for name, _ in plots.figures(read())}
        monkeypatch.setattr(plots, "drawings", lambda _: plain)
    page = (ROOT / "docs" / "benchmarks.md").read_text("utf-8")
    names: dict[str, Any] = {}
    shown: list[Any] = []
    for cell in re.findall(r"```\{code-cell\} ipython3\n:tags:[^\n]*\n(.*?)```", page, re.DOTALL):
        *lines, last = cell.strip().splitlines()
        exec("\n".join(lines), names)  # noqa: S102 (our own page)
        shown.append(eval(last, names))  # noqa: S307 (the same)
    text = "\n".join(each.data for each in shown)

    assert len(shown) == len(re.findall("code-cell", page))
    assert all(f"| {name} | " in text for name in NAMES)
    claims = sum(f["passed"] is not None for row in read()["figures"].values() for f in row)
    assert len(re.findall(r"\| (?:kept|\*\*missed\*\*) \|$", text, re.MULTILINE)) == claims
    assert str(LATEST.relative_to(ROOT)) in page


@pytest.mark.slow
def test_a_bound_that_is_missed_is_the_exit_code(monkeypatch, capsys):
    good, bad = figure(11.0, least=10.0), figure(9.0, least=10.0)
    for found, code in ((good, 0), (bad, 1)):
        module = SimpleNamespace(__doc__="One.", measure=lambda found=found: [found])
        monkeypatch.setattr(command, "MEASUREMENTS", {"one": module})
        monkeypatch.setattr("sys.argv", ["benchmarks"])

        assert command.main() == code
    assert "missed: one: a ratio" in capsys.readouterr().out
