"""The springs of generalised ICP, frozen at a rotation."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from spring_families import uniform_rotation

import certreg
from certreg.errors import InvalidProblemError

RNG = np.random.default_rng(3)
ROOTS = RNG.standard_normal((2, 6, 3, 3))
HERE, THERE = ROOTS @ ROOTS.transpose(0, 1, 3, 2)
TURN = uniform_rotation(RNG)
X, Y = RNG.standard_normal((2, 6, 3))


def test_springs_are_the_inverse_of_both_covariances_in_the_frame_of_the_target() -> None:
    frozen = certreg.gicp_information(HERE, THERE, TURN)

    sums = THERE + np.einsum("ij,njk,lk->nil", TURN, HERE, TURN)
    np.testing.assert_allclose(np.asarray(frozen) @ sums, np.tile(np.eye(3), (6, 1, 1)), atol=1e-9)
    assert (np.asarray(frozen) == np.asarray(frozen).transpose(0, 2, 1)).all()
    assert len(frozen) == 6


def test_the_result_says_at_which_rotation_they_are_frozen() -> None:
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

    problem = certreg.RegistrationProblem(
        X, Y, information=certreg.gicp_information(HERE, THERE, quarter)
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
    source, target = (SimpleNamespace(points=c, covariances=s) for c, s in ((X, HERE), (Y, THERE)))
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
