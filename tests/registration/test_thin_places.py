"""Places that few inputs reach: each with the least that reaches it."""

from __future__ import annotations

import io
import struct
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from commands import write_csv

from certreg import RegistrationProblem, certify, read_problem
from certreg.campaign.runner import (
    _changed_words,  # pyright: ignore[reportPrivateUsage]
)
from certreg.cli.campaigns import resumable
from certreg.equilibrium.methods import Search
from certreg.errors import InvalidFileError, UndecidedError
from certreg.exact.dyadic import rational_root_above
from certreg.geometry.given import given_pose
from certreg.io.scans import LEAST_HEADER, RECORDS, parse_las
from certreg.problem.random_instances import gaussian_instances
from certreg.registration import enumeration
from certreg.registration.enumeration import enumerated
from certreg.registration.rounding import rounding_cost
from certreg.registration.slips import Slipped

if TYPE_CHECKING:
    from certreg.registration.result import Registration

AXES = np.array([[3, 0, 0], [-3, 0, 0], [0, 2, 0], [0, -2, 0], [0, 0, 1], [0, 0, -1]], float)
LINE = np.outer(np.arange(4.0), [1.0, 2.0, 2.0])
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


def proof(source: object, target: object) -> Registration:
    return certify(source, target, relaxation=False, simulation=False)  # type: ignore[arg-type]


@pytest.mark.parametrize("scale", [1000.0, 2.0**-9, 7.0])
def test_of_many_optima_a_scaled_matrix_costs_what_its_rotation_does(scale: float):
    """The pose is written as the one given, where several are optimal: but without its scale."""
    registration = proof(LINE + 5.0, LINE + 5.0)
    one, other = (
        Slipped.of(registration, given_pose(k * np.eye(3), np.zeros(3))).cost for k in (1.0, scale)
    )

    assert one > 0
    assert other == one


def test_what_rounding_a_quaternion_and_its_shift_costs_is_the_sum_in_the_text():
    """|e|^2 / |q|^2 of the range of energies, and M |c|^2: half an ulp each.

    The centroid moves by the shift's rounding, and by at most 2 sin(a / 2) of its length with the
    turn: the square of two is at most twice the sum of theirs.
    """
    registration = proof(AXES + np.array([4.0, 0.0, 0.0]), AXES)
    objective = registration.solution.objective
    halves = [Fraction(np.spacing(abs(x))) / 2 for x in (1.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0)]
    sine, shift = (sum(h * h for h in some) for some in (halves[:4], halves[4:]))
    ranged = rational_root_above(2 * objective.least_range_squared)
    away = 2 * (shift + 4 * sine * 16)

    cost = rounding_cost(objective, IDENTITY, np.array([4.0, 0.0, 0.0]))

    assert cost == ranged * sine + 6 * away


def test_of_what_has_changed_the_first_is_named_and_the_others_are_counted():
    names: dict[str, None] = dict.fromkeys(["a.json", "b.json", "c.json"])
    end = ": changed since the last run: computed anew"

    assert _changed_words(names) == f"a.json and 2 more{end}"
    assert _changed_words(dict.fromkeys(["a.json"])) == f"a.json{end}"


@pytest.mark.parametrize(
    ("error", "begun"), [(KeyboardInterrupt(), "\n"), (InvalidFileError("no disk", path=None), "")]
)
def test_what_is_kept_is_told_below_the_mark_of_an_interrupt(
    error: BaseException, begun: str, capsys: pytest.CaptureFixture[str]
):
    with pytest.raises(type(error)), resumable(Path("out")):
        raise error

    assert capsys.readouterr().err == f"{begun}out: what is done is kept: run the same to go on\n"


def test_a_search_that_comes_to_no_list_is_undecided_for_its_reason(
    monkeypatch: pytest.MonkeyPatch,
):
    def none(_: object, name: str) -> Search:
        return Search(method=name, critical=None, reason="two paths met", seconds=0.0)

    monkeypatch.setattr(enumeration, "search", none)
    with pytest.raises(UndecidedError, match=r"^two paths met$") as raised:
        enumerated(RegistrationProblem(AXES, AXES), "homotopy")

    assert raised.value.method == "homotopy"


def test_no_instances_are_none_of_the_shape_asked_for():
    instances = gaussian_instances(np.random.default_rng(1), points=5, count=0)

    assert instances.sources.shape == instances.targets.shape == (0, 5, 3)


@pytest.mark.parametrize("column", ["sigma", "weight"])
def test_noise_goes_with_the_rows_that_labels_bring_in_order(tmp_path: Path, column: str):
    names, noise = ["a", "b", "c", "d"], [1.0, 2.0, 4.0, 8.0]
    source = write_csv(tmp_path / "source.csv", AXES[:4].tolist(), names)
    rows = [f"{n},{k},0,0,{s}" for k, (n, s) in enumerate(zip(names, noise, strict=True))]
    target = tmp_path / "target.csv"
    target.write_text("\n".join([f"label,x,y,z,{column}", *rows[::-1]]) + "\n", encoding="utf-8")

    problem, _ = read_problem(source, target)

    expected = np.array(noise) if column == "weight" else np.array(noise) ** -2.0
    assert problem.weights.tolist() == expected.tolist()


def las(size: int, start: int, records: int, held: int) -> str:
    """What is said of a file with these numbers in its header."""
    head = bytearray(held)
    head[:4] = b"LASF"
    struct.pack_into("<HII", head, 94, size, start, records)
    with pytest.raises(InvalidFileError) as refused:
        parse_las(io.BytesIO(bytes(head)), Path("a.las"))
    return str(refused.value)


@pytest.mark.parametrize(
    ("numbers", "sound"),
    [
        ((LEAST_HEADER, 300, 0, 300), True),
        ((LEAST_HEADER - 1, 300, 0, 300), False),
        ((300, 300, 0, 300), True),
        ((301, 300, 0, 301), False),
        ((LEAST_HEADER, 301, 0, 300), False),
        ((LEAST_HEADER, LEAST_HEADER + RECORDS, 1, 300), True),
        ((LEAST_HEADER, LEAST_HEADER + RECORDS - 1, 1, 300), False),
        ((LEAST_HEADER, LEAST_HEADER + RECORDS, 2, 300), False),
    ],
)
def test_the_numbers_of_a_las_header_lie_within_the_file(
    numbers: tuple[int, int, int, int], *, sound: bool
):
    """One that is sound so far is refused later: of a version that there is not."""
    pytest.importorskip("laspy")

    assert ("its header and its size differ" in las(*numbers)) == (not sound)


def test_a_las_file_has_all_bytes_of_the_least_header():
    pytest.importorskip("laspy")

    assert "no header of LAS" in las(LEAST_HEADER, LEAST_HEADER, 0, LEAST_HEADER - 1)
    assert "no header of LAS" not in las(LEAST_HEADER, LEAST_HEADER, 0, LEAST_HEADER)
