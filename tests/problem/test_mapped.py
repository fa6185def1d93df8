"""Clouds that stay in their files: the same problem, read-only, without their size in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import strategies
from scipy.spatial.transform import Rotation

from certreg import RegistrationProblem
from certreg.errors import InvalidProblemError
from certreg.problem import arrays as stating
from certreg.problem.arrays import BLOCK_POINTS, mapped_file
from certreg.problem.exact_sums import SumMethod, sums_by

if TYPE_CHECKING:
    from pathlib import Path

MANY = BLOCK_POINTS + 1000  # more than one block


def saved(folder: Path, name: str, array: np.ndarray, mode: str = "r") -> np.ndarray:
    np.save(folder / name, array)
    return np.load(folder / name, mmap_mode=mode)  # type: ignore[arg-type]


def mapped_problem(folder: Path, problem: RegistrationProblem) -> RegistrationProblem:
    return RegistrationProblem(
        saved(folder, "source.npy", problem.source),
        saved(folder, "target.npy", problem.target),
        weights=saved(folder, "weights.npy", problem.weights),
    )


@pytest.fixture(scope="module")
def cloud():
    return strategies.random_problem(np.random.default_rng(4), n=MANY)


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_a_mapped_problem_is_the_same_problem(tmp_path, cloud):
    mapped = mapped_problem(tmp_path, cloud)

    for array in (mapped.source, mapped.target, mapped.weights):
        assert mapped_file(array) is not None
        assert not array.flags.writeable
    assert mapped.digest() == cloud.digest()
    assert mapped.data_bytes() == cloud.data_bytes()
    assert sums_by(SumMethod.BY_EXPONENT, mapped) == sums_by(SumMethod.LIMBS, cloud)


@pytest.mark.parametrize("mode", ["r+", "c"])
def test_an_array_that_could_be_written_to_is_copied(tmp_path, mode):
    array = saved(tmp_path, "source.npy", np.eye(3), mode)
    problem = RegistrationProblem(array, np.eye(3))
    array[0, 0] = 7.0

    assert problem.source[0, 0] == 1.0


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("dtype", ["<f4", ">f8", "<i4", "<f2"])
def test_a_mapped_array_of_another_type_gives_the_problem_of_its_values(tmp_path, dtype):
    rng = np.random.default_rng(6)
    points = rng.integers(-100, 100, size=(50, 3)).astype(dtype)
    mapped = RegistrationProblem(saved(tmp_path, "source.npy", points), points)
    plain = RegistrationProblem(points.astype(float), points.astype(float))

    assert mapped.source.dtype == points.dtype
    assert mapped.digest() == plain.digest()
    assert sums_by(SumMethod.BY_EXPONENT, mapped) == sums_by(SumMethod.INTEGERS, plain)


@pytest.mark.usefixtures("compiled")
def test_columns_and_rows_backwards_may_be_mapped(tmp_path):
    table = np.arange(70.0).reshape(10, 7)
    mapped = saved(tmp_path, "table.npy", table)
    problem = RegistrationProblem(mapped[::-1, 2:5], mapped[:, :3])
    plain = RegistrationProblem(table[::-1, 2:5].copy(), table[:, :3].copy())

    assert mapped_file(problem.source) is not None
    assert problem.digest() == plain.digest()
    assert sums_by(SumMethod.BY_EXPONENT, problem) == sums_by(SumMethod.BY_EXPONENT, plain)


def test_a_mapped_zero_with_a_sign_is_a_plain_zero(tmp_path):
    signed = saved(tmp_path, "signed.npy", -0.0 * np.ones((2, 3)))

    plain = RegistrationProblem(np.zeros((2, 3)), np.eye(2, 3))
    assert RegistrationProblem(signed, np.eye(2, 3)).digest() == plain.digest()


@pytest.mark.parametrize(
    ("row", "words"), [(np.nan, "row 66000"), (np.inf, "row 66000"), (None, r"\(N, 3\)")]
)
def test_bad_mapped_points_are_refused_with_what_and_where(tmp_path, cloud, row, words):
    points = cloud.source.copy()
    points[66000, 1] = 0.0 if row is None else row
    points = points.T.copy() if row is None else points
    mapped = saved(tmp_path, "bad.npy", points)

    with pytest.raises(InvalidProblemError, match=words):
        RegistrationProblem(mapped, cloud.target)


def test_bad_mapped_weights_are_refused_with_what_and_where(tmp_path, cloud):
    weights = np.ones(MANY)
    weights[66000] = -1.0

    for values, words in ((weights, r"weights\[66000\] is -1.0"), (0.0 * weights, "all weights")):
        mapped = saved(tmp_path, "weights.npy", values)
        with pytest.raises(InvalidProblemError, match=words):
            RegistrationProblem(cloud.source, cloud.target, weights=mapped)


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize(
    ("name", "value"), [("source", np.nan), ("target", np.inf), ("weights", -1)]
)
def test_a_file_that_is_spoilt_meanwhile_is_noticed(tmp_path, cloud, name, value):
    mapped = mapped_problem(tmp_path, cloud)
    writable = np.load(tmp_path / f"{name}.npy", mmap_mode="r+")
    writable[66000] = value

    for method in SumMethod:
        with pytest.raises(InvalidProblemError, match="was changed"):
            sums_by(method, mapped)


@pytest.mark.parametrize("block", [1, 5, 1 << 16])
@pytest.mark.parametrize(
    ("name", "value"), [("source", np.nan), ("target", np.inf), ("weights", -1.0)]
)
def test_the_row_that_was_spoilt_meanwhile_is_named(tmp_path, monkeypatch, name, value, block):
    problem = strategies.random_problem(np.random.default_rng(5), n=12)
    mapped = mapped_problem(tmp_path, problem)
    writable = np.load(tmp_path / f"{name}.npy", mmap_mode="r+")
    writable[7] = value
    monkeypatch.setattr(stating, "BLOCK_POINTS", block)

    with pytest.raises(InvalidProblemError, match="was changed") as refusal:
        sums_by(SumMethod.LIMBS, mapped)
    assert (refusal.value.array, refusal.value.row) == (name, 7)


def test_equal_weights_take_the_place_of_one():
    given: list[dict[str, Any]] = [{}, {"sigma": 0.5}, {"weights": 4.0}]
    for options in given:
        problem = RegistrationProblem(np.eye(5, 3), np.eye(5, 3), **options)

        assert problem.weights.shape == (5,)
        assert problem.weights.strides == (0,)
        assert not problem.weights.flags.writeable


class NamesItself:
    """As the arrays of Cython that lend their memory: their base is themselves."""

    def __init__(self, array: np.ndarray) -> None:
        self.array, self.base = array, self
        self.__array_interface__ = array.__array_interface__


def test_an_owner_that_names_itself_is_no_file():
    array = np.asarray(NamesItself(np.eye(3)))
    assert isinstance(array.base, NamesItself)
    assert mapped_file(array) is None
    turn = Rotation.from_rotvec([0.0, 0.0, 1.0]).as_matrix()
    assert RegistrationProblem(turn, np.eye(3)).n == 3
