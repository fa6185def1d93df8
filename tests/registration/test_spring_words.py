"""Every configuration of general springs that leaves something open: what is said of it, exactly.

All data are integers, so that what is degenerate is exactly so.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED, NOT_UNIQUE
from certreg.report.overview import Overview
from certreg.results import Limits, PoseVerdict

Array = NDArray[np.float64]

SPHERE = [
    (1, 2, 2),
    (2, -1, 2),
    (-2, 1, 2),
    (2, 2, -1),
    (-1, -2, 2),
    (3, 0, 0),
    (0, 3, 0),
    (2, 1, -2),
]
CIRCLE = [(3, 4), (-4, 3), (5, 0), (0, -5), (-3, -4), (4, -3), (-5, 0), (4, 3)]


def cloud(n: int, seed: int = 0) -> Array:
    """Integers, so that every sum is exact."""
    return np.random.default_rng(seed).integers(-9, 10, (n, 3)).astype(float)


def factors_of(matrix: Array, n: int) -> Array:
    """The same diagonal W of squares for every pair, as factors."""
    a, b, c = np.sqrt(np.diag(matrix))
    return np.tile([a, 0.0, b, 0.0, 0.0, c], (n, 1))


@dataclass(frozen=True, eq=False)
class Case:
    """A configuration, and what must be said of it.

    springs: of the problem. said: parts of the summary. unique: of the pose; the exit code follows.
    free: shifts. symmetry: turns.
    """

    source: Array
    target: Array
    springs: dict[str, Any]
    said: tuple[str, ...]
    unique: bool | None = True
    free: int = 0
    symmetry: int = 0

    @property
    def code(self) -> int:
        """The exit code."""
        return {True: DONE, False: NOT_UNIQUE, None: NOT_CERTIFIED}[self.unique]


UNIQUE = "CERTIFIED: the global optimum, and unique, to within the proved bounds."
SEVERAL = "CERTIFIED, BUT NOT UNIQUE: "
OPEN = ("BOUNDED: within ", "is not decided.")
FEW = (
    "The ranks of the springs add up to 5 (a plane 1, a line 2, a full spring 3): a pose that fits "
    "exactly needs six at least to be determined to first order."
)
UNDETERMINED = "is undetermined to first order"


def shared(*squares: float) -> dict[str, Any]:
    """The same diagonal W for 20 pairs."""
    return {"factors": factors_of(np.diag(squares), 20)}


def walls() -> dict[str, Case]:
    """Of planes in one, two, three directions."""
    x, rng = cloud(20), np.random.default_rng(1)
    y = x + rng.integers(-1, 2, x.shape)
    wall = np.tile([0.0, 0.0, 1.0], (20, 1))
    two, corner = wall.copy(), wall.copy()
    two[::2] = corner[::3] = (1.0, 0.0, 0.0)
    corner[1::3] = (0.0, 1.0, 0.0)
    one_wall = (
        SEVERAL,
        "rotation about the normal (0, 0, 1) is undetermined",
        "no spring resists a shift along (1, 0, 0), (0, 1, 0) or any mix of them",
    )
    two_walls = (
        "CERTIFIED, BUT A SHIFT IS FREE: the best rotation, and unique, to within the "
        "proved bounds; no spring resists a shift along (0, 1, 0)."
    )
    return {
        "one wall": Case(x, y, {"normals": wall}, one_wall, unique=False, free=2, symmetry=1),
        "two wall directions": Case(x, y, {"normals": two}, (two_walls,), unique=False, free=1),
        "corner": Case(x, y, {"normals": corner}, (UNIQUE,)),
        "isotropic": Case(x, y, shared(1, 1, 1), (UNIQUE,)),
        "shared 1 1 4": Case(x, y, shared(1, 1, 4), (UNIQUE,)),
        "shared 1 4 9": Case(x, y, shared(1, 4, 9), (UNIQUE,)),
        "five planes": Case(
            x[:5], y[:5], {"normals": cloud(5, 3)}, (*OPEN, UNDETERMINED, FEW), unique=None
        ),
        "two lines": Case(
            x[:2],
            y[:2],
            {"directions": np.eye(3)[:2]},
            (SEVERAL, "rotation about the target's axis (0, 0, 1) and"),
            unique=False,
            symmetry=2,
        ),
        "collinear": Case(
            np.outer(np.arange(1, 7), [1.0, 2.0, 2.0]),
            y[:6],
            {"factors": factors_of(np.eye(3), 6)},
            (
                SEVERAL,
                "rotation about the target's axis ",
                " and about the source's axis (0.333, 0.667, 0.667) is undetermined.",
            ),
            unique=False,
            symmetry=2,
        ),
    }


def surfaces() -> dict[str, Case]:
    """That slide on themselves."""
    ball = np.array(SPHERE, dtype=float)
    tube = np.array([(a, b, h) for h, (a, b) in enumerate(CIRCLE)], dtype=float)
    thread = np.array([(-b, a, 2.0) for a, b in CIRCLE])
    flat = "The rotation is undetermined to first order: the energy does not curve at the pose."
    sliding = (
        SEVERAL,
        "no spring resists a shift along (0, 0, 1)",
        "Whether one rotation alone is optimal is not decided.",
        "undetermined to first order",
    )
    return {
        "sphere": Case(ball, ball, {"normals": ball}, (*OPEN, flat), unique=None),
        "cylinder": Case(
            tube, tube, {"normals": tube * [1.0, 1.0, 0.0]}, sliding, unique=False, free=1
        ),
        "screw": Case(tube, tube, {"normals": thread}, (*OPEN, UNDETERMINED), unique=None),
    }


def cases() -> dict[str, Case]:
    """By name."""
    return walls() | surfaces()


NAMES = list(cases())


@cache
def certified(name: str) -> Any:
    case = cases()[name]
    return certify(RegistrationProblem(case.source, case.target, **case.springs))


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("name", NAMES)
def test_a_degenerate_configuration_gets_exactly_its_words(name: str):
    case, registration = cases()[name], certified(name)
    text = str(registration)

    assert [words for words in case.said if words not in text] == []
    assert registration.unique is case.unique
    assert registration.exit_code == case.code
    freedom = registration.solution.freedom
    assert len(freedom.translations) == case.free
    assert len(freedom.symmetry) == case.symmetry


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", [name for name in NAMES if cases()[name].unique is not True])
def test_where_one_pose_is_not_proved_to_be_optimal_nothing_calls_it_unique(name: str):
    registration = certified(name)
    text = str(registration).replace("the best rotation, and unique,", "")

    assert "and unique" not in text
    assert "the one optimum" not in text
    assert registration.to_dict()["optimality"]["unique"] is not True


@pytest.mark.slow
def test_where_no_squares_reach_the_gap_is_told_and_nothing_is_called_unique():
    """Choi and Lam's form: nonnegative, no sum of squares, with seven zeros."""
    data = files("certreg") / "data"
    clouds = [
        np.loadtxt(str(data / f"choi_lam_{side}.csv"), delimiter=",", skiprows=1)
        for side in ("source", "target")
    ]
    columns = clouds[1][:, 3:]
    factors = np.zeros((len(columns), 6))
    factors[:, [0, 1, 3]] = columns
    problem = RegistrationProblem(clouds[0], clouds[1][:, :3], factors=factors)
    registration: Any = certify(problem)
    text = str(registration)

    assert registration.exit_code == NOT_CERTIFIED
    assert registration.to_dict()["optimality"]["method"] == "cones"
    assert registration.unique is None
    assert "7 local minima were met that differ by no more than the proved gap." in text
    assert "not tight: its value is 16.9 % of the objective below it" in text
    assert "and unique" not in text


@pytest.mark.slow
def test_of_five_planes_the_energy_itself_is_the_better_bound():
    rng = np.random.default_rng(4)
    source, normals = rng.integers(-9, 10, (2, 5, 3)).astype(float)
    found: Any = certify(RegistrationProblem(source, source, normals=normals))
    words, told = str(found), Overview.of(found).proved

    assert found.bounds.greatest_gap < 1e-25 * (found.objective or 1.0) + 1e-25
    assert "proved by         the energy itself, which is a sum of squares" in words
    assert found.to_dict()["optimality"]["method"] == "energy"
    assert "the energy itself, which is a sum of squares" in [fact.value for fact in told]
    assert FEW in words


def test_five_planes_that_cannot_be_met_may_single_one_pose_out():
    """So of fewer than six springs nothing is said but of a pose that fits exactly."""
    axes = np.array([[0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0]], dtype=float)
    target = axes * [[2.0], [2.0], [2.0], [2.0], [1.0]]
    met, missed = (
        certify(RegistrationProblem(axes, y, normals=np.abs(axes))) for y in (axes, target)
    )

    assert missed.unique is True
    assert "add up to" not in str(missed)
    assert met.unique is None
    assert FEW in str(met)


@pytest.mark.slow
def test_six_planes_are_not_called_too_few():
    rng = np.random.default_rng(4)
    source, normals = rng.integers(-9, 10, (2, 6, 3)).astype(float)

    assert "add up to" not in str(certify(RegistrationProblem(source, source, normals=normals)))


def test_a_pose_is_judged_where_it_is_not_decided_whether_others_are_as_good():
    found = certified("sphere")
    near = np.eye(3), np.array([1e-4, 0.0, 0.0])
    optimal, judged = assess(found, np.eye(4)), assess(found, *near)

    assert optimal.headline.startswith("OPTIMAL TO ROUNDING: at most ")
    assert " above the minimum (proved); whether several poses attain that is not decided." in (
        optimal.headline
    )
    assert judged.verdict is PoseVerdict.BOUNDED
    assert judged.headline.startswith("BOUNDED: at most ")
    words = ") above the minimum (proved); whether an optimum is near is not decided."
    assert judged.headline.endswith(words)
    why = (
        "Not called near-optimal: whether one rotation alone is optimal is not decided, and no "
        "angle to an optimum is proved: where little is at stake, a pose far from every optimum "
        "costs as little."
    )
    assert judged.words.startswith(why)
    assert judged.unexplained is None


def test_what_is_missing_to_call_a_pose_certified_is_said():
    registration = certified("sphere")
    tight = replace(registration, limits=Limits(max_gap=1e-300))

    within = "Not called certified, though within 1e-06 of the range of energies: whether one pose "
    assert f"{within}is optimal is open." in str(registration)
    asked = "that asks for a proof that it is within 1e-300 of the range of energies"
    assert f"{asked}, and of whether one pose is optimal." in str(tight)
