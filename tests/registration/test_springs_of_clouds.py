"""Clouds that hold normals: used where they are asked for, told of where they are not."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import certreg
from certreg.errors import DegenerateProblemError, InvalidProblemError, UnusedSpringsWarning
from certreg.geometry.pose import Pose

if TYPE_CHECKING:
    from collections.abc import Callable

RNG = np.random.default_rng(11)
X, N = RNG.normal(size=(2, 20, 3))
N /= np.linalg.norm(N, axis=1)[:, np.newaxis]
Y = X[:, [1, 2, 0]] + 0.01 * RNG.normal(size=X.shape)
HELD = SimpleNamespace(points=Y, normals=N)
METHODS = SimpleNamespace(  # as small_gicp has it
    points=lambda: np.column_stack([Y, np.ones(20)]),
    normals=lambda: np.column_stack([N, np.zeros(20)]),
    covs=list,
)
WORDS = r"target has normals, which are not used: each pair is a point spring\. normals=target uses"
TURN = np.eye(3)[[1, 2, 0]]


@pytest.mark.parametrize(
    "call",
    [
        lambda target: certreg.RegistrationProblem(X, target),
        lambda target: certreg.certify(X, target, relaxation=False, simulation=False),
        lambda target: certreg.register(X, target),
        lambda target: certreg.assess(X, target, TURN),
    ],
)
@pytest.mark.parametrize("target", [HELD, METHODS])
def test_normals_of_the_target_that_nobody_asked_for_are_told_of_where_the_user_called(
    call: Callable[[Any], Any], target: Any
):
    with pytest.warns(UnusedSpringsWarning, match=WORDS) as told:
        call(target)

    assert [one.filename for one in told] == [__file__]


def test_where_they_are_used_or_points_alone_are_given_nothing_is_told():
    table = SimpleNamespace(points=Y, normals=N[:5])  # of faces: as many as points they are not
    computed = SimpleNamespace(vertices=Y, vertex_normals=N)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert certreg.certify(X, HELD, normals=HELD).problem.springs is not None
        for target in (HELD.points, table, computed, SimpleNamespace(points=Y, normals=[])):
            certreg.register(X, target)
        certreg.register(SimpleNamespace(points=X, normals=N), Y)


def test_a_pair_keeps_them_and_says_who_uses_them():
    paired = certreg.pair(X, HELD)
    source, target = paired

    assert paired.notes == ["target: has normals, which certify(..., normals=target) uses"]
    assert certreg.certify(source, target, normals=target).problem.factors is not None
    with pytest.warns(UnusedSpringsWarning):
        certreg.certify(source, target, relaxation=False, simulation=False)
    with pytest.raises(InvalidProblemError, match=r"^pair takes no normals: give them to certify"):
        certreg.pair(X, Y, normals=N)


def test_register_takes_springs_and_finds_the_pose_that_certify_proves():
    found = certreg.register(X, HELD, normals=HELD)
    proved = certreg.certify(X, Y, normals=N).pose
    weighed = certreg.register(X, Y, np.arange(1.0, 21.0), normals=N)

    assert isinstance(found, Pose)
    assert np.abs(found.rotation - proved.rotation).max() < 1e-15
    assert np.abs(found.translation - proved.translation).max() < 1e-15
    assert np.abs(weighed.rotation - found.rotation).max() > 1e-6
    assert np.abs(certreg.register(X, Y).rotation - found.rotation).max() > 1e-6


@pytest.mark.parametrize(
    ("normals", "words"),
    [
        (np.tile([0.0, 0.0, 1.0], (20, 1)), "rotation about the normal .* no spring resists"),
        (
            N * [1.0, 1.0, 0.0],
            r"^no spring resists a shift along \(0, 0, 1\); certreg",
        ),
        (N * [1.0, 1.0, 1e-9], r"a shift along \(0, 0, 1\) is resisted by next to nothing"),
    ],
)
def test_register_refuses_springs_that_leave_the_pose_open(normals: Any, words: str):
    with pytest.raises(DegenerateProblemError, match=words):
        certreg.register(X, Y, normals=normals)


def test_register_refuses_a_turn_that_is_undetermined_to_first_order():
    ball = X / np.linalg.norm(X, axis=1)[:, np.newaxis]

    with pytest.raises(
        DegenerateProblemError, match=r"order; certreg.certify says what is proved of it$"
    ):
        certreg.register(ball, ball, normals=ball)


def test_assess_takes_the_clouds_and_their_springs():
    judged = certreg.assess(X, Y, TURN, normals=N)
    same = certreg.assess(certreg.RegistrationProblem(X, Y, normals=N), TURN)

    assert (judged.headline, judged.shift_upper) == (same.headline, same.shift_upper)
    moved = certreg.assess(X, Y, (TURN, [0.1, 0.0, 0.0]), normals=N, sigma=0.01)
    assert (moved.shift_upper or 0.0) > 0.09


def test_assess_refuses_what_states_no_problem_or_two():
    problem: Any = certreg.RegistrationProblem(X, Y)
    with pytest.raises(InvalidProblemError, match=r"^normals beside a problem, which states it"):
        certreg.assess(problem, TURN, normals=N)
    with pytest.raises(InvalidProblemError, match=r"or assess\(source, target, pose\); found a nd"):
        certreg.assess(X, TURN)
    with pytest.raises(InvalidProblemError, match="found the two the other way round"):
        certreg.assess(TURN, problem)
