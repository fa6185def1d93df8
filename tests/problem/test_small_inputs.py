"""What is said of inputs in rare cases: columns of frames, rows behind a block, single numbers."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from certreg.errors import InvalidProblemError
from certreg.problem import arrays, floating_sums, moments
from certreg.problem.arrays import as_doubles, cloud_array
from certreg.problem.floating_sums import CloudPair
from certreg.problem.problem import RegistrationProblem
from certreg.problem.row_labels import RowLabels, require_same_labels

POINTS = np.random.default_rng(7).standard_normal((7, 3))


class Table:
    """As a data frame: columns of any names, in any order."""

    def __init__(self, *columns: tuple[Any, Any]) -> None:
        self.pairs = columns

    @property
    def columns(self) -> list[Any]:
        return [name for name, _ in self.pairs]

    def __getitem__(self, name: Any) -> Any:
        return next(values for key, values in self.pairs if key == name)

    def to_numpy(self) -> np.ndarray:
        return np.column_stack([values for _, values in self.pairs])


def table(*names: Any) -> Table:
    return Table(*((name, np.full(2, float(k))) for k, name in enumerate(names)))


def test_columns_of_a_frame_are_x_y_z_in_any_case_and_order():
    for names, order in (
        (("x", "y", "z"), [0, 1, 2]),
        (("z", "label", "X ", " Y"), [2, 3, 0]),
        ((0, 1, 2), [0, 1, 2]),
        (((1, 2), None, 3.5), [0, 1, 2]),
    ):
        assert cloud_array(table(*names), "source")[0].tolist() == order


@pytest.mark.parametrize(
    "names",
    [("a", "b", "c"), (0, 1, "z"), ("x", "X", "y", "z"), (0, 1, 2, 3), ("x", "y")],
    ids=str,
)
def test_columns_of_a_frame_that_could_be_others_are_refused(names: tuple[Any, ...]):
    with pytest.raises(InvalidProblemError, match="which are x, y, z") as caught:
        cloud_array(table(*names), "target")

    assert (caught.value.array, caught.value.value) == ("target", list(names))


def test_the_shape_says_what_to_type():
    for shape, hint in (
        ((3, 5), "; transpose it: source.T"),
        ((3, 4), "; transpose it: source.T"),
        ((5, 4), "; of homogeneous coordinates give source[:, :3] / source[:, 3:]"),
        ((4, 4), "; of homogeneous coordinates give source[:, :3] / source[:, 3:]"),
        ((5, 2), "; of points in the plane give np.pad(source, ((0, 0), (0, 1)))"),
        ((3, 2), "; of points in the plane give np.pad(source, ((0, 0), (0, 1)))"),
        ((2, 2), "; of points in the plane give np.pad(source, ((0, 0), (0, 1)))"),
        ((2, 5), ""),
        ((5, 3, 1), ""),
    ):
        with pytest.raises(InvalidProblemError) as caught:
            cloud_array(np.zeros(shape), "source")
        assert str(caught.value).endswith(f"expected (N, 3), one point per row{hint}")


def test_the_largest_integers_are_not_taken_for_the_next_power_of_two():
    for kind, value, kept in (
        (np.int64, 2**63 - 1, False),
        (np.int64, 2**63 - 1024, True),
        (np.int64, -(2**63), True),
        (np.uint64, 2**64 - 1, False),
        (np.uint64, 2**64 - 2048, True),
        (np.uint64, 2**63, True),
    ):
        assert as_doubles(np.array([value], dtype=kind))[1].tolist() == [kept]


@pytest.mark.parametrize("block", [2, 3, 100])
def test_a_row_that_no_double_holds_is_named_wherever_its_block_begins(
    monkeypatch: pytest.MonkeyPatch, block: int
):
    monkeypatch.setattr(arrays, "BLOCK_POINTS", block)
    integers = np.zeros((7, 3), dtype=np.int64)
    integers[5, 1] = 2**53 + 1
    numbers = POINTS.copy()
    numbers[5, 1] = np.nan
    for points, words in ((integers, "no double holds"), (numbers, r"row 5 \(counting from 0\)")):
        with pytest.raises(InvalidProblemError, match=words) as caught:
            RegistrationProblem(points, POINTS)
        assert caught.value.row == 5


def test_a_single_sigma_has_no_row():
    for sigma, place, row in ((-1.0, "sigma is -1.0", None), ([1.0] * 6 + [0.0], "sigma[6] is", 6)):
        with pytest.raises(InvalidProblemError) as caught:
            RegistrationProblem(POINTS, POINTS, sigma=sigma)
        assert str(caught.value).startswith(place)
        assert (caught.value.row, caught.value.limit) == (row, 0.0)


def test_the_least_of_weights_is_told_and_of_coordinates_there_is_none():
    for name, least, limit in (("weights", 0.0, 0.0), ("source", -np.inf, None)):
        values = np.array([1.0, np.nan])
        with pytest.raises(InvalidProblemError) as caught:
            moments._require_numbers(name, values, least=least)
        assert (caught.value.row, caught.value.limit) == (1, limit)
        assert ("and >= 0" in str(caught.value)) == (limit == 0.0)


@pytest.mark.parametrize(("threads", "pools"), [(1, []), (2, [2]), (3, [3])])
def test_one_thread_is_no_pool(monkeypatch: pytest.MonkeyPatch, threads: int, pools: list[int]):
    made: list[int] = []

    def pool(count: int) -> ThreadPoolExecutor:
        made.append(count)
        return ThreadPoolExecutor(count)

    monkeypatch.setattr(floating_sums, "ThreadPoolExecutor", pool)
    monkeypatch.setattr(floating_sums, "CHUNK_POINTS", 3)
    clouds = CloudPair(source=POINTS, target=POINTS, weights=None, origin=np.zeros(6))
    floating_sums.floating_sums(clouds, threads=threads)
    assert made == pools

    monkeypatch.setattr(floating_sums, "CHUNK_POINTS", 7)  # one chunk needs no second thread
    floating_sums.floating_sums(clouds, threads=threads)
    assert made == pools


def test_the_first_row_that_is_named_otherwise_is_told_from_either_side():
    source = RowLabels(values=("a", "b", "c"))
    for values, row in ((("a", "b"), 2), (("a", "b", "c", "d"), 3), (("a", "x", "c"), 1)):
        assert source.first_other(RowLabels(values=values)) == row
        assert RowLabels(values=values).first_other(source) == row
    unsure = RowLabels(values=("a", "c", "d"), certain=False)
    assert source.first_other(unsure) is None
    assert unsure.first_other(source) is None


class Series:
    """As a column of a data frame with an index."""

    def __init__(self, *index: Any) -> None:
        self.index = np.array(index)

    def to_numpy(self) -> np.ndarray:
        return np.zeros(len(self.index))


def test_rows_that_are_labelled_otherwise_are_told_on_both_sides():
    for here, there, told in (
        ("abc", "abd", ("c", "d")),
        ("abc", "ab", ("c", None)),
        ("ab", "abc", (None, "c")),
    ):
        with pytest.raises(InvalidProblemError) as caught:
            require_same_labels(Series(*here), weights=Series(*there))
        assert f"is labelled {told[0]!r} in source and {told[1]!r} in weights" in str(caught.value)
        assert (caught.value.limit, caught.value.value) == told
        assert str(caught.value).endswith("give weights.loc[source.index]")


@pytest.mark.parametrize("block", [2, 100])
def test_weights_are_equal_where_each_is_that_of_the_first(
    monkeypatch: pytest.MonkeyPatch, block: int
):
    monkeypatch.setattr(arrays, "BLOCK_POINTS", block)
    for weights, equal in (
        ([3.0], True),
        ([3.0] * 5, True),
        ([2.0, 3.0, 3.0, 3.0, 3.0], False),
        ([3.0, 3.0, 3.0, 3.0, 2.0], False),
    ):
        points = POINTS[: len(weights)]
        problem = RegistrationProblem(points, points, weights=np.array(weights))
        assert problem.equally_weighted == equal
