"""Clouds in memory: paired by label or refused, whatever library they come from."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import commands
import numpy as np
import pytest

import certreg
from certreg.errors import CertregError, InvalidFileError, InvalidProblemError
from certreg.io.objects import _of_pairs, stated_problem
from certreg.problem.row_labels import RowLabels

if TYPE_CHECKING:
    from pathlib import Path

SOURCE = np.random.default_rng(7).normal(size=(6, 3))
TARGET = SOURCE[:, [1, 2, 0]] + 0.5  # a rotation and a translation, exactly
NAMES = list("abcdef")
BACK = slice(None, None, -1)


class Index(list):
    """As the index of pandas: labels of rows."""

    def tolist(self) -> list[Any]:
        return list(self)


class RangeIndex(Index):
    """As the index that pandas gives where nobody chose one."""

    start, step = 0, 1


@dataclass
class Frame:
    """As a data frame of pandas: named columns, an index, conversion to NumPy."""

    content: dict[Any, Any]
    index: Any = field(default_factory=Index)

    @property
    def columns(self) -> list[Any]:
        return list(self.content)

    def __getitem__(self, name: Any) -> Any:
        return self.content[name]

    def to_numpy(self) -> np.ndarray:
        return np.column_stack(list(self.content.values()))


@dataclass
class Column:
    """As a column of a data frame, with its index."""

    values: Any
    index: Any

    def to_numpy(self) -> np.ndarray:
        return np.asarray(self.values)

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.values, dtype=dtype)


@dataclass
class DataArray:
    """As an array of xarray, with labelled rows."""

    values: Any
    indexes: dict[str, Any]
    dims: tuple[str, ...] = ("point", "axis")

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.values, dtype=dtype)


@dataclass
class Holder:
    """Anything that holds its points under a name of its own."""

    held: dict[str, Any]

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["held"][name]
        except KeyError as error:
            raise AttributeError(name) from error


@dataclass
class Tensor:
    """As a tensor that NumPy may not read: with gradients, or on another device."""

    words: str
    kind: type[Exception] = RuntimeError

    def __array__(self, dtype=None, copy=None):
        raise self.kind(self.words)

    def detach(self) -> None: ...


class OnDevice:
    """As an array of CuPy, which is on a GPU."""

    shape = (6, 3)

    def get(self) -> Any:
        return SOURCE

    def __array__(self, *_: object, **__: object) -> Any:
        message = "Implicit conversion to a NumPy array is not allowed"
        raise TypeError(message)


def frame(points: np.ndarray, names: list[Any] | None = None, **columns: Any) -> Frame:
    content = dict(zip("xyz", points.T, strict=True))
    return Frame({**columns, **content}, Index(range(len(points)) if names is None else names))


def rows_of(pair: Any) -> np.ndarray:
    """The rows of TARGET that the rows of SOURCE were paired with."""
    first, second = pair
    assert np.array_equal(first.points, SOURCE)
    return np.array([int(np.flatnonzero((row == TARGET).all(axis=1))[0]) for row in second.points])


# The same labels in another order -----------------------------------------------------------------

ORDERS = {
    "index": (frame(SOURCE, NAMES), frame(TARGET[BACK], NAMES[BACK])),
    "column": (frame(SOURCE, label=NAMES), frame(TARGET[BACK], label=NAMES[BACK])),
    "one index that nobody chose": (
        frame(SOURCE),
        frame(TARGET[BACK], list(range(6))[BACK]),
    ),
    "numbers": (frame(SOURCE, [3, 1, 4, 5, 9, 2]), frame(TARGET[BACK], [2, 9, 5, 4, 1, 3])),
    "xarray": (
        DataArray(SOURCE, {"point": Index(NAMES)}),
        DataArray(TARGET[BACK], {"point": Index(NAMES[BACK])}),
    ),
}


@pytest.mark.parametrize("name", ORDERS)
def test_labels_in_another_order_are_paired_by_label(name):
    source, target = ORDERS[name]

    assert rows_of(certreg.pair(source, target)).tolist() == [0, 1, 2, 3, 4, 5]
    found = certreg.certify(source, target, relaxation=False, simulation=False)
    assert found.rmse == pytest.approx(0.0, abs=1e-12)


# A frame with a column of text is no array of numbers for `solve_many`.
@pytest.mark.parametrize(
    ("function", "name"),
    [
        (function, name)
        for function in (certreg.RegistrationProblem, certreg.register, certreg.solve_many)
        for name in ORDERS
        if (function, name) != (certreg.solve_many, "column")
    ],
)
def test_where_rows_pair_in_order_they_are_refused(function, name):
    with pytest.raises(InvalidProblemError, match=r"row 0 .* rows pair in order") as caught:
        function(*ORDERS[name])

    assert (caught.value.array, caught.value.row) == ("target", 0)
    assert "certreg.pair(source, target)" in str(caught.value)


def test_files_in_another_order_are_paired_or_refused_in_python_as_by_the_command(tmp_path):
    def ply(name: str, points: np.ndarray, called: str, labels: list[int]) -> Path:
        head = ["ply", "format ascii 1.0", f"element vertex {len(points)}"]
        head += [f"property double {axis}" for axis in "xyz"]
        head += [f"property int {called}", "end_header"]
        rows = [
            f"{x!r} {y!r} {z!r} {k}" for (x, y, z), k in zip(points.tolist(), labels, strict=True)
        ]
        path = tmp_path / name
        path.write_text("\n".join([*head, *rows]) + "\n", "utf-8")
        return path

    numbers = [3, 1, 4, 5, 9, 2]
    csv = (
        commands.write_csv(tmp_path / "a.csv", SOURCE.tolist(), NAMES),
        commands.write_csv(tmp_path / "b.csv", TARGET[BACK].tolist(), NAMES[BACK]),
    )
    labelled = (
        ply("a.ply", SOURCE, "label", numbers),
        ply("b.ply", TARGET[BACK], "label", numbers[BACK]),
    )
    for files in (csv, labelled):
        assert rows_of(certreg.pair(*files)).tolist() == [0, 1, 2, 3, 4, 5]
        clouds = [certreg.load(file) for file in files]
        assert rows_of(certreg.pair(*clouds)).tolist() == [0, 1, 2, 3, 4, 5]
        with pytest.raises(InvalidProblemError, match="rows pair in order"):
            certreg.RegistrationProblem(*clouds)
        run = commands.certreg("certify", *files, "--no-relaxation", "--no-simulation", "--json")
        assert run.document["rmse"] == pytest.approx(0.0, abs=1e-12)

    called = (ply("c.ply", SOURCE, "id", numbers), ply("d.ply", TARGET[BACK], "id", numbers[BACK]))
    with pytest.raises(InvalidFileError, match="the same points in another order") as caught:
        certreg.pair(*called)
    run = commands.certreg("certify", *called)
    assert (run.code, str(caught.value) in run.err) == (2, True)


def test_errors_of_pair_are_those_of_the_command(tmp_path):
    files = (
        commands.write_csv(tmp_path / "a.csv", SOURCE.tolist(), NAMES),
        commands.write_csv(tmp_path / "b.csv", TARGET.tolist(), [*NAMES[:5], "g"]),
    )
    with pytest.raises(CertregError) as caught:
        certreg.pair(*files)

    assert str(caught.value) in commands.certreg("certify", *files).err
    kept = certreg.pair(*files, match="common")
    assert len(kept.source.points) == 5
    with pytest.raises(InvalidFileError, match="label 'f' occurs 0 times in the target, which"):
        certreg.pair(frame(SOURCE, NAMES), frame(TARGET, [*NAMES[:5], "g"]))
    with pytest.raises(InvalidProblemError, match="match is 'some'"):
        certreg.pair(SOURCE, TARGET, match="some")


def test_an_index_that_nobody_chose_names_nothing(logged):
    filtered = frame(TARGET, [3, 5, 8, 9, 11, 12])

    with logged(logging.WARNING) as messages:
        found = certreg.certify(frame(SOURCE), filtered, relaxation=False, simulation=False)
    assert "target: labels not used, as source has none" in "\n".join(messages)
    assert found.rmse == pytest.approx(0.0, abs=1e-12)
    assert certreg.RegistrationProblem(frame(SOURCE), filtered).n == 6
    assert certreg.RegistrationProblem(frame(SOURCE), frame(TARGET)).n == 6


def test_labels_are_compared_as_texts_and_told_by_the_first_other_row():
    ab, ba = RowLabels(values=("a", "b")), RowLabels(values=["b", "a"])

    assert ab.first_other(RowLabels(values=["a", "b"])) is None
    assert ab.first_other(ba) == 0
    assert RowLabels(values=(1, 2)).first_other(RowLabels(values=("1", "2"))) is None
    assert ab.first_other(RowLabels(values=["a", "c"])) == 1
    assert ab.first_other(RowLabels(values=["a", "b", "c"])) == 2
    weak = RowLabels(values=["a", "c"], certain=False)
    assert ab.first_other(weak) is None
    assert RowLabels(values=["b", "a"], certain=False).first_other(ab) == 0


@pytest.mark.parametrize("sure", [(True, True), (True, False), (False, True), (False, False)])
def test_labels_of_which_one_says_little_refuse_only_the_same_ones_in_another_order(
    sure: tuple[bool, bool],
):
    here, there = sure
    ab = RowLabels(values=["a", "b"], certain=here)
    for values, row in (
        (["a", "b"], None),
        (["b", "a"], 0),
        (["a", "c"], 1 if all(sure) else None),
    ):
        assert ab.first_other(RowLabels(values=values, certain=there)) == row


def test_names_on_one_cloud_alone_refuse_nothing():
    """Of the other an index 0, 1, 2, ..., as a filtered or a plain frame has it."""
    named, plain = frame(SOURCE, NAMES), frame(SOURCE)
    counted = Frame(plain.content, RangeIndex(range(6)))

    for clouds in ((named, plain), (plain, named), (named, counted), (counted, named)):
        assert certreg.RegistrationProblem(*clouds).n == 6
    with pytest.raises(InvalidProblemError, match=r"row 0 .* is labelled 0 in source and 5 in"):
        certreg.RegistrationProblem(counted, frame(SOURCE, list(range(6))[::-1]))


def test_every_other_row_of_a_frame_is_not_paired_with_the_rows_between():
    """pandas keeps the index of `frame[::2]` as a range of step 2."""

    class Even(RangeIndex):
        step = 2

    class Odd(RangeIndex):
        start, step = 1, 2

    for each in (Even, Odd):
        each.__name__ = "RangeIndex"
    even = Frame(frame(SOURCE).content, Even(range(0, 12, 2)))
    odd = Frame(frame(SOURCE).content, Odd(range(1, 13, 2)))

    assert certreg.RegistrationProblem(even, even).n == 6
    with pytest.raises(InvalidProblemError, match=r"row 0 .* is labelled 0 in source and 1 in"):
        certreg.RegistrationProblem(even, odd)


# Numbers of rows ----------------------------------------------------------------------------------


def test_weights_go_with_the_rows_of_the_source():
    weights = np.arange(1.0, 7.0)
    problem, paired = stated_problem(*ORDERS["index"], weights=weights)

    assert np.array_equal(problem.weights, weights)
    assert np.array_equal(problem.target, TARGET)
    assert paired.about["labels"] == NAMES
    same = Column(weights, Index(NAMES))
    assert np.array_equal(stated_problem(*ORDERS["index"], weights=same)[0].weights, weights)
    with pytest.raises(InvalidProblemError, match=r"give weights\.loc\[source\.index\]"):
        stated_problem(*ORDERS["index"], weights=Column(weights, Index(NAMES[BACK])))
    with pytest.raises(InvalidProblemError, match=r"sigma\.loc"):
        certreg.RegistrationProblem(
            frame(SOURCE, NAMES), TARGET, sigma=Column(weights, Index(NAMES[BACK]))
        )
    some = certreg.pair(ORDERS["index"][0], frame(TARGET, ["g", *NAMES[1:]]), match="common")
    assert _of_pairs(weights, some, "weights").tolist() == [2, 3, 4, 5, 6]
    with pytest.raises(InvalidProblemError, match=r"weights has shape \(5,\)"):
        stated_problem(*ORDERS["index"], weights=weights[:5])


def test_columns_of_a_frame_mean_what_they_mean_in_a_csv_file():
    weighed = frame(SOURCE, weight=np.arange(1.0, 7.0), colour=["red"] * 6)
    problem, paired = stated_problem(weighed, TARGET)

    assert np.array_equal(problem.weights, np.arange(1.0, 7.0))
    assert paired.notes[0] == "source: not used: colour"
    assert stated_problem(weighed, TARGET, sigma=0.1)[0].noise_given
    surveyed = Frame({"Northing": SOURCE[:, 1], "Easting": SOURCE[:, 0], "Height": SOURCE[:, 2]})
    assert np.array_equal(certreg.pair(surveyed, TARGET).source.points, SOURCE)
    with pytest.raises(
        InvalidProblemError, match=r"Northing, Easting, Height: which are x, y, z\?"
    ):
        certreg.RegistrationProblem(surveyed, TARGET)
    nameless = Frame(dict(enumerate(SOURCE.T)))
    assert np.array_equal(certreg.RegistrationProblem(nameless, TARGET).source, SOURCE)
    turned = Frame({"z": SOURCE[:, 2], "X": SOURCE[:, 0], "y": SOURCE[:, 1]})
    assert np.array_equal(certreg.RegistrationProblem(turned, TARGET).source, SOURCE)


# Objects of other libraries -----------------------------------------------------------------------


@pytest.mark.parametrize(
    "cloud",
    [
        Holder({"points": SOURCE}),
        Holder({"vertices": SOURCE}),
        Holder({"xyz": SOURCE, "points": np.zeros(6, dtype=[("X", int)])}),
        Holder({"points": lambda: None, "vertices": SOURCE}),
        Holder({"point": Holder({"positions": Holder({"numpy": lambda: SOURCE})})}),
        DataArray(SOURCE, {}),
        SOURCE.tolist(),
    ],
    ids=["open3d", "trimesh", "laspy", "a method", "open3d tensors", "xarray", "lists"],
)
def test_points_are_found_where_a_library_holds_them(cloud):
    assert np.array_equal(certreg.RegistrationProblem(cloud, TARGET).source, SOURCE)
    assert np.array_equal(certreg.pair(cloud, TARGET).source.points, SOURCE)


@pytest.mark.parametrize(
    ("cloud", "words"),
    [
        (
            Tensor("Can't call numpy() on Tensor that requires grad.\nmore"),
            r"requires grad\.; give source\.detach\(\)\.cpu\(\)\.double\(\)\.numpy\(\)$",
        ),
        (Tensor("can't convert cuda:0 device", TypeError), r"cuda:0 device; give source\.detach"),
        (OnDevice(), r"Implicit conversion .* is not allowed; give source\.get\(\)$"),
        (SOURCE.T[:, :5], r"shape \(3, 5\): .*; transpose it: source\.T$"),
        (np.ones((6, 4)), r"shape \(6, 4\): .*give source\[:, :3\] / source\[:, 3:\]$"),
        (SOURCE.astype(object), r"entries of type object: .*source\.astype\(float\)$"),
        (SOURCE.astype(complex), r"entries of type complex128: expected real numbers$"),
        ("abc", "entries of type <U3"),
        (None, "entries of type object"),
    ],
    ids=["gradient", "device", "cupy", "rows", "homogeneous", "objects", "complex", "text", "none"],
)
def test_what_is_no_cloud_is_refused_with_what_to_type(cloud, words):
    with pytest.raises(InvalidProblemError, match=words) as caught:
        certreg.RegistrationProblem(cloud, TARGET)

    assert caught.value.array == "source"
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_frames_of_the_libraries_themselves(library):
    module = pytest.importorskip(library)
    columns = dict(zip("xyz", SOURCE.T, strict=True))
    other = dict(zip("xyz", TARGET[BACK].T, strict=True))
    source = module.DataFrame({"label": NAMES, **columns})
    target = module.DataFrame({"label": NAMES[BACK], **other})

    assert rows_of(certreg.pair(source, target)).tolist() == [0, 1, 2, 3, 4, 5]
    with pytest.raises(InvalidProblemError, match="rows pair in order"):
        certreg.RegistrationProblem(source, target)


@pytest.mark.parametrize("wide", [False, True])
def test_arrays_of_jax_are_their_numbers(*, wide: bool):
    jax = pytest.importorskip("jax")
    with jax.enable_x64(wide):
        source, target = map(jax.numpy.asarray, (SOURCE, TARGET))
        given = certreg.RegistrationProblem(source, target)
        pose = jax.numpy.asarray(certreg.register(source, target).as_matrix())
    same = certreg.RegistrationProblem(np.asarray(source), np.asarray(target))

    assert source.dtype == ("float64" if wide else "float32")
    assert given.digest() == same.digest()
    assert certreg.assess(given, pose).verdict.value.endswith("optimal")
    with pytest.raises(InvalidProblemError, match="traced array"):
        jax.jit(lambda cloud: certreg.RegistrationProblem(cloud, cloud).n)(source)


# certify of two clouds, and of many ---------------------------------------------------------------


def test_certify_takes_a_problem_or_two_clouds_and_nothing_between():
    problem = certreg.RegistrationProblem(SOURCE, TARGET, sigma=0.1, damping=2.0)
    quick: Any = {"relaxation": False, "simulation": False}
    one = certreg.certify(problem, **quick)
    two = certreg.certify(SOURCE, TARGET, sigma=0.1, damping=2.0, **quick)

    assert one.problem.digest() == two.problem.digest()
    assert (two.problem.damping, two.problem.noise_given) == (2.0, True)
    for arguments, words in (
        ((problem, TARGET), "target beside a problem"),
        ((SOURCE,), "a ndarray alone is neither"),
    ):
        with pytest.raises(InvalidProblemError, match=words):
            certreg.certify(*arguments, **quick)
    with pytest.raises(InvalidProblemError, match="sigma beside a problem"):
        certreg.certify(problem, sigma=1.0, **quick)


def test_many_problems_are_certified_in_their_order_and_told():
    problem = certreg.RegistrationProblem(SOURCE, TARGET)
    bad = (SOURCE, TARGET[:5])
    quick: Any = {"relaxation": False, "simulation": False}
    told: list[tuple[int, int | None]] = []
    found = certreg.certify_many(
        [problem, bad, (SOURCE, TARGET)],
        errors="keep",
        progress=lambda *done: told.append(done),
        **quick,
    )

    assert [type(one).__name__ for one in found] == [
        "Registration",
        "InvalidFileError",
        "Registration",
    ]
    assert told == [(1, 3), (2, 3), (3, 3)]
    with pytest.raises(CertregError) as caught:
        certreg.certify_many(iter([problem, bad]), **quick)
    assert caught.value.__notes__ == ["problem 1 (counting from 0)"]
    certreg.certify_many(iter([problem]), progress=lambda *done: told.append(done), **quick)
    assert told[-1] == (1, None)
    with pytest.raises(InvalidProblemError, match="errors is 'ignore'"):
        certreg.certify_many([], errors="ignore")  # pyright: ignore[reportCallIssue, reportArgumentType]


def test_the_logger_says_what_was_chosen_and_is_silent_unless_asked(logged, capsys):
    problem = certreg.RegistrationProblem(SOURCE, TARGET)
    with logged(logging.INFO) as messages:
        certreg.certify(problem, simulation=False)

    told = "\n".join(messages)
    assert "of the fastest decay" in told
    assert "relaxation quaternion-4 by" in told
    assert any(
        isinstance(one, logging.NullHandler) for one in logging.getLogger("certreg").handlers
    )
    assert capsys.readouterr().err == ""


def test_a_cloud_is_an_array_of_its_points(tmp_path):
    (tmp_path / "a.csv").write_text("x,y,z\n1,2,3\n4,5,6\n", "utf-8")
    cloud = certreg.load(tmp_path / "a.csv")

    assert np.asarray(cloud).tolist() == [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
    assert np.shares_memory(np.asarray(cloud), cloud.points)
    assert not np.shares_memory(np.array(cloud), cloud.points)
    assert np.asarray(cloud, dtype=np.float32).dtype == np.float32


def test_names_of_a_longer_cloud_differ_where_the_shorter_ends():
    short, long = RowLabels(values=("a", "b")), RowLabels(values=("a", "b", "c"))

    assert short.first_other(long) == long.first_other(short) == 2
    assert RowLabels(values=("a", "x", "c")).first_other(short) == 1
