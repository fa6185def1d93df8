"""A problem with general springs: its kinds, its digest, its notes, what is refused; of ICP."""

from __future__ import annotations

import copy
import hashlib
import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from spring_families import Cell, instance, statement, uniform_rotation

import certreg
from certreg.errors import InvalidProblemError
from certreg.problem.moments import exact_moments, floating_moments

PLANES = statement(instance(Cell("plane", 7, 0.1), 1))


@pytest.fixture(name="planes", scope="module")
def _planes() -> certreg.RegistrationProblem:
    return certreg.RegistrationProblem(**PLANES)


def test_a_normal_is_the_first_column_of_its_factor(planes: certreg.RegistrationProblem) -> None:
    assert planes.factors is not None
    assert planes.springs is not None

    assert (planes.factors[:, [0, 1, 3]] == PLANES["normals"]).all()
    assert not planes.factors[:, [2, 4, 5]].any()
    assert (planes.springs.kind, planes.springs.ranks) == ("plane", (0, 7, 0, 0))


def test_the_digest_is_of_both_clouds_and_the_factors(planes: certreg.RegistrationProblem) -> None:
    factors = np.zeros((7, 6))
    factors[:, [0, 1, 3]] = PLANES["normals"]
    numbers = [*PLANES["source"].ravel(), *PLANES["target"].ravel(), *factors.ravel()]
    stated = b"certreg-springs/1\0" + struct.pack(f"<Q{len(numbers)}d", 7, *numbers)

    assert planes.data_bytes() == stated
    assert planes.digest() == hashlib.sha256(stated).hexdigest()
    assert copy.deepcopy(planes).digest() == planes.digest()
    assert planes.damped(2.0).digest() == planes.digest()


@pytest.mark.parametrize("read", [exact_moments, floating_moments, lambda p: p.weights])
def test_nobody_takes_springs_for_weights(planes: certreg.RegistrationProblem, read) -> None:
    with pytest.raises(InvalidProblemError, match="a matrix for every pair and not a weight"):
        read(planes)


def test_blocks_of_springs_and_of_weights_are_not_confused(
    planes: certreg.RegistrationProblem,
) -> None:
    weighted = certreg.RegistrationProblem(PLANES["source"], PLANES["target"])

    assert planes.block(slice(2, 5)).springs.shape == (3, 6)
    assert weighted.springs is None
    assert weighted.factors is None
    with pytest.raises(InvalidProblemError, match="not a weight"):
        assert planes.block(slice(0, 2)).weights is None
    assert weighted.block(slice(0, 2)).springs.shape == (2,)


RNG = np.random.default_rng(5)
X, Y, N = (RNG.standard_normal((6, 3)) for _ in range(3))
N /= np.linalg.norm(N, axis=1, keepdims=True)
ROOTS = RNG.standard_normal((6, 3, 3))
SPD = ROOTS @ ROOTS.transpose(0, 2, 1)
NAN = np.nan


class Table:
    """As a data frame of pandas."""

    def __init__(self, rows: np.ndarray, columns: list, labels: str = "") -> None:
        self.rows, self.columns = rows, columns
        if labels:
            self.index = np.array(list(labels))

    def __getitem__(self, name: object) -> np.ndarray:
        return self.rows[:, self.columns.index(name)]

    def to_numpy(self) -> np.ndarray:
        return self.rows


def _springs(factors: np.ndarray | None) -> np.ndarray:
    """(n, 3, 3), W of every L."""
    assert factors is not None
    full = np.zeros((len(factors), 3, 3))
    full[:, [0, 1, 1, 2, 2, 2], [0, 0, 1, 0, 1, 2]] = factors
    return full @ full.transpose(0, 2, 1)


def _changed(array: np.ndarray, place: tuple[int, ...] | int, value: object) -> np.ndarray:
    other = array.copy()
    other[place] = value
    return other


@pytest.mark.parametrize(
    ("given", "kind", "ranks", "springs"),
    [
        ({"normals": N}, "plane", (0, 6, 0, 0), N[:, :, None] * N[:, None, :]),
        ({"directions": N}, "line", (0, 0, 6, 0), np.eye(3) - N[:, :, None] * N[:, None, :]),
        ({"covariances": SPD}, "full", (0, 0, 0, 6), np.linalg.inv(SPD)),
        ({"information": SPD}, "full", (0, 0, 0, 6), SPD),
        ({"factors": np.linalg.cholesky(SPD)}, "full", (0, 0, 0, 6), SPD),
        ({"factors": N}, "plane", (0, 6, 0, 0), N[:, :, None] * N[:, None, :]),
        ({"normals": N, "sigma": 0.5}, "plane", (0, 6, 0, 0), 4 * N[:, :, None] * N[:, None, :]),
        ({"information": SPD, "weights": np.arange(6.0)}, "full", (1, 0, 0, 5), None),
    ],
)
def test_every_kind_states_its_springs(given, kind, ranks, springs) -> None:
    problem = certreg.RegistrationProblem(X, Y, **given)

    assert problem.springs is not None
    assert (problem.springs.kind, problem.springs.ranks) == (kind, ranks)
    expected = SPD * np.arange(6.0)[:, None, None] if springs is None else springs
    np.testing.assert_allclose(_springs(problem.factors), expected, rtol=1e-9, atol=1e-12)
    assert problem.factors is not None
    assert not problem.factors.flags.writeable
    assert problem.noise_given == ("sigma" in given or "covariances" in given)


def test_six_columns_are_the_entries_of_matrices_and_of_factors() -> None:
    six = SPD.reshape(6, 9)[:, [0, 1, 2, 4, 5, 8]]
    matrices: Any = SPD
    lower: Any = np.linalg.cholesky(SPD)
    rows = lower.reshape(6, 9)[:, [0, 3, 4, 6, 7, 8]]

    digests = {
        name: certreg.RegistrationProblem(X, Y, **{name: given}).digest()
        for name, given in (
            ("information", matrices),
            ("covariances", matrices),
            ("factors", lower),
        )
    }

    assert certreg.RegistrationProblem(X, Y, information=six).digest() == digests["information"]
    assert certreg.RegistrationProblem(X, Y, covariances=six).digest() == digests["covariances"]
    assert certreg.RegistrationProblem(X, Y, factors=rows).digest() == digests["factors"]


def test_of_several_kinds_each_pair_has_one_and_none_is_a_point() -> None:
    normals, directions, covariances = N.copy(), N.copy(), SPD.copy()
    normals[2:] = NAN
    directions[[0, 1, 3, 4, 5]] = NAN
    covariances[[0, 1, 2, 4, 5]] = NAN
    factors = np.full((6, 6), NAN)
    factors[5] = (2.0, 0.0, 2.0, 0.0, 0.0, 2.0)

    problem = certreg.RegistrationProblem(
        X, Y, normals=normals, directions=directions, covariances=covariances, factors=factors
    )

    planes, lines = N[:2, :, None] * N[:2, None, :], np.eye(3) - np.outer(N[2], N[2])
    rest = [lines, np.linalg.inv(SPD[3]), np.eye(3), 4.0 * np.eye(3)]
    np.testing.assert_allclose(_springs(problem.factors), [*planes, *rest], rtol=1e-9, atol=1e-12)
    assert problem.springs is not None
    assert (problem.springs.kind, problem.springs.ranks) == ("mixed", (0, 2, 1, 3))
    assert problem.springs.notes == (
        "1 pairs have no kind of spring, the first in row 4 (from 0): each is a point spring",
    )
    assert not problem.noise_given


def test_one_pair_alone_is_a_problem() -> None:
    problem = certreg.RegistrationProblem(X[:1], Y[:1], normals=N[:1])

    assert (problem.n, problem.springs and problem.springs.kind) == (1, "plane")


ONE = "counting from 0"


@pytest.mark.parametrize(
    ("given", "words", "row"),
    [
        ({"normals": _changed(N, 3, 0.0)}, "normals row 3 .* a direction needs a length", 3),
        ({"directions": _changed(N, 1, 0.0)}, "directions row 1 .* needs a length", 1),
        ({"normals": _changed(N, 4, NAN)}, "normals row 4 .* is NaN", 4),
        ({"normals": _changed(N, (4, 1), NAN)}, "normals row 4 .* must be finite", 4),
        ({"normals": _changed(N, (2, 0), np.inf)}, "normals row 2 .* must be finite", 2),
        ({"normals": N[:5]}, r"normals has shape \(5, 3\): expected \(6, 3\)", None),
        ({"normals": SPD}, "normals has shape", None),
        ({"information": N}, r"information has shape .* \(6, 3, 3\) or \(6, 6\)", None),
        ({"covariances": _changed(SPD, 2, np.diag([1, 1, 0]))}, "row 2 .* rank below 3", 2),
        ({"covariances": _changed(SPD, 2, np.diag([1, 1, -1]))}, "row 2 .* below zero", 2),
        ({"information": _changed(SPD, 5, np.diag([1, 1, -1e-6]))}, "row 5 .* below zero", 5),
        ({"information": _changed(SPD, (1, 0, 1), 7.0)}, "row 1 .* not symmetric", 1),
        ({"information": _changed(SPD, 0, 1e300)}, "row 0 .* outside the doubles", 0),
        ({"factors": SPD}, "factors row 0 .* entries above its diagonal", 0),
        ({"factors": np.zeros((6, 6))}, "all springs are zero", None),
        ({"normals": N, "directions": N}, "row 0 .* has normals and directions", 0),
        ({"normals": N, "sigma": 1e-320}, "normals row 0 .* outside the doubles", 0),
        ({"normals": N * 1e-300, "sigma": 1e300}, "normals row 0 .* outside the doubles", 0),
        ({"directions": np.full((6, 3), 1.7e308)}, "directions row 0 .* outside the doubles", 0),
        ({"normals": N, "sigma": -1.0}, "sigma is -1.0", None),
        ({"normals": N, "weights": np.zeros(6)}, "all weights are zero", None),
        ({"normals": N.astype(str)}, "normals has entries of type", None),
        ({"normals": SimpleNamespace(points=Y)}, "has no normals", None),
        ({"normals": SimpleNamespace(points=Y, normals=np.zeros((0, 3)))}, "has none", None),
    ],
)
def test_bad_springs_are_one_line_that_names_the_row(given, words, row) -> None:
    with pytest.raises(InvalidProblemError, match=words) as caught:
        certreg.RegistrationProblem(X, Y, **given)

    assert "\n" not in str(caught.value)
    assert caught.value.row == row
    assert row is None or ONE in str(caught.value)


def test_a_bad_row_is_named_beyond_the_first_block() -> None:
    n = (1 << 16) + 7
    normals = np.ones((n, 3))
    normals[n - 2] = 0.0

    with pytest.raises(InvalidProblemError, match=f"row {n - 2} ") as caught:
        certreg.RegistrationProblem(np.zeros((n, 3)), np.zeros((n, 3)), normals=normals)
    assert caught.value.row == n - 2


def test_notes_tell_of_lengths_and_of_matrices_that_are_singular_to_rounding() -> None:
    long = _changed(N, 2, 3.0 * N[2])
    dyads = N[:, :, None] * N[:, None, :]

    lengths = certreg.RegistrationProblem(X, Y, normals=long).springs
    singular = certreg.RegistrationProblem(X, Y, information=dyads).springs

    assert lengths is not None
    assert lengths.notes == (
        "normals: 1 are not of length 1, the first in row 2 (from 0): springs count by its square",
    )
    assert singular is not None
    assert singular.kind == "plane"
    assert len(singular.notes) == 1
    assert "singular to rounding" in singular.notes[0]
    unit = certreg.RegistrationProblem(X, Y, normals=N).springs
    assert unit is not None
    assert unit.notes == ()


def test_what_the_source_holds_is_refused_with_the_reason() -> None:
    source = SimpleNamespace(points=X, normals=N, covariances=SPD)
    target = SimpleNamespace(points=Y, normals=-N[::-1], covariances=SPD[::-1])

    for given in (source, source.normals, N.copy()):
        with pytest.raises(InvalidProblemError, match="turn with the rotation that is sought"):
            certreg.RegistrationProblem(source, target, normals=given)
    with pytest.raises(InvalidProblemError, match="gicp_information"):
        certreg.RegistrationProblem(source, target, covariances=source)
    alike = SimpleNamespace(points=Y, normals=N.copy())
    with pytest.raises(InvalidProblemError, match="normals are of the source"):
        certreg.RegistrationProblem(source, alike, normals=source)
    assert certreg.RegistrationProblem(source, alike, normals=alike).springs is not None
    assert certreg.RegistrationProblem(source, target, normals=target).springs is not None
    assert certreg.RegistrationProblem(source, source, normals=source).springs is not None


def test_objects_and_tables_are_taken_as_they_are() -> None:
    plain = certreg.RegistrationProblem(X, Y, normals=N).digest()
    full = certreg.RegistrationProblem(X, Y, covariances=SPD).digest()
    padded = np.zeros((6, 4, 4))
    padded[:, :3, :3] = SPD
    small = SimpleNamespace(  # as small_gicp has it: methods, and a fourth coordinate
        points=lambda: np.column_stack([Y, np.ones(6)]),
        normals=lambda: np.column_stack([N, np.zeros(6)]),
        covs=lambda: list(padded),
    )
    tensors = SimpleNamespace(point=SimpleNamespace(positions=Y, normals=N))  # of Open3D
    table = Table(np.column_stack([Y, N]), ["x", "y", "z", "NX", "ny", " nz"], "abcdef")

    for target in (SimpleNamespace(vertices=Y, vertex_normals=N), small, tensors, table):
        assert certreg.RegistrationProblem(X, target, normals=target).digest() == plain
    assert certreg.RegistrationProblem(X, small, covariances=small).digest() == full
    unnamed = Table(N, [0, 1, 2])
    assert certreg.RegistrationProblem(X, Y, normals=unnamed).digest() == plain
    with pytest.raises(InvalidProblemError, match="without the columns cxx,"):
        certreg.RegistrationProblem(X, table, covariances=table)
    with pytest.raises(InvalidProblemError, match="rows pair in order"):
        certreg.RegistrationProblem(table, Y, normals=Table(table.rows, table.columns, "fedcba"))


def test_factors_in_a_file_stay_there_and_are_the_same_problem(tmp_path) -> None:
    rows = np.linalg.cholesky(SPD).reshape(6, 9)[:, [0, 3, 4, 6, 7, 8]]
    np.save(tmp_path / "factors.npy", rows)
    mapped = np.load(tmp_path / "factors.npy", mmap_mode="r")

    problem = certreg.RegistrationProblem(X, Y, factors=mapped)

    assert problem.mapped
    assert problem.digest() == certreg.RegistrationProblem(X, Y, factors=rows).digest()
    assert not certreg.RegistrationProblem(X, Y, factors=mapped, sigma=2.0).mapped


CLOUDS = np.random.default_rng(3)
SHAPES = CLOUDS.standard_normal((2, 6, 3, 3))
HERE, THERE = SHAPES @ SHAPES.transpose(0, 1, 3, 2)
TURN = uniform_rotation(CLOUDS)
SEEN, FOUND = CLOUDS.standard_normal((2, 6, 3))


def test_springs_are_the_inverse_of_both_covariances_in_the_frame_of_the_target() -> None:
    frozen = certreg.gicp_information(HERE, THERE, TURN)

    sums = THERE + np.einsum("ij,njk,lk->nil", TURN, HERE, TURN)
    np.testing.assert_allclose(np.asarray(frozen) @ sums, np.tile(np.eye(3), (6, 1, 1)), atol=1e-9)
    assert (np.asarray(frozen) == np.asarray(frozen).transpose(0, 2, 1)).all()
    assert len(frozen) == 6


def test_the_result_says_at_which_rotation_they_are_frozen() -> None:
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

    problem = certreg.RegistrationProblem(
        SEEN, FOUND, information=certreg.gicp_information(HERE, THERE, quarter)
    )

    assert problem.springs is not None
    assert problem.springs.kind == "full"
    assert problem.springs.notes[0].startswith(
        "the matrices are those of GICP, frozen at one rotation (a turn by 90 degrees): "
    )
    assert not problem.noise_given


def test_no_turn_is_called_the_identity() -> None:
    assert "(R = I)" in certreg.gicp_information(HERE, THERE, np.eye(3)).spring_note


def test_clouds_with_covariances_and_poses_of_any_kind_are_taken() -> None:
    pose = np.eye(4)
    pose[:3, :3] = TURN
    source, target = (
        SimpleNamespace(points=c, covariances=s) for c, s in ((SEEN, HERE), (FOUND, THERE))
    )
    six = THERE.reshape(6, 9)[:, [0, 1, 2, 4, 5, 8]]

    plain = np.asarray(certreg.gicp_information(HERE, THERE, TURN))

    assert (np.asarray(certreg.gicp_information(source, target, pose)) == plain).all()
    assert (np.asarray(certreg.gicp_information(HERE, six, (TURN, np.zeros(3)))) == plain).all()


FLAT = np.diag([1.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("here", "there", "turn", "words"),
    [
        ([np.eye(3), FLAT], [np.eye(3), FLAT], np.eye(3), "cov_source row 1 .* is flat in both"),
        ([np.eye(3), FLAT], [np.eye(3)], np.eye(3), "cov_source has 2 matrices, cov_target 1"),
        ([np.eye(3)], [np.eye(3)], -np.eye(3), "rotation: The matrix is a reflection"),
        ([np.eye(3) * np.nan], [np.eye(3)], np.eye(3), "cov_source row 0 .* is NaN"),
        ([np.eye(3)], [np.triu(np.ones((3, 3)))], np.eye(3), "cov_target row 0 .* not symmetric"),
        ([np.eye(2)], [np.eye(3)], np.eye(3), "cov_source has shape"),
        ([-np.eye(3)], [np.eye(3)], np.eye(3), "cov_source row 0"),
    ],
)
def test_what_makes_no_springs_is_refused_with_its_row(here, there, turn, words) -> None:
    with pytest.raises(InvalidProblemError, match=words) as caught:
        certreg.gicp_information(here, there, turn)

    assert "\n" not in str(caught.value)
