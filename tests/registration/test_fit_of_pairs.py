"""The least squares over the pairs within: what was asked of all goes to them, and is told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rotated_pairs import BOUND as TURNED
from rotated_pairs import rotated_pairs
from scipy.spatial.transform import Rotation

import certreg
from certreg.dynamics.integrators import SimulationSettings
from certreg.registration import linear
from certreg.registration.labelled import ConsensusRegistration, TruncatedRegistration
from certreg.registration.row_names import RowNames
from certreg.relaxation.shor import relax
from certreg.results import Absent

BOUND, SIGMA, WRONG, N = 0.05, 0.003, 5, 16
RNG = np.random.default_rng(2)
X = RNG.uniform(size=(N, 3))
TURN = Rotation.from_rotvec([0.4, -0.9, 0.3]).as_matrix()
Y = X @ TURN.T + [0.2, 0.1, -0.4] + SIGMA * RNG.standard_normal((N, 3))
Y[:WRONG] = Y[::-1][:WRONG]  # wrong ones first: no row of the fit has its own number
NORMALS = Rotation.from_quat(RNG.standard_normal((N, 4))).as_matrix()[:, 0]
MET = list(range(WRONG, N))
LEFT_OUT = "with --max-residual it is taken only where it is named"


def certified(**options: Any) -> ConsensusRegistration:
    result = certreg.certify(X, Y, max_residual=BOUND, **options)
    assert isinstance(result, ConsensusRegistration)
    assert list(result.found.met) == MET
    return result


def alone(**options: Any) -> Any:
    """The same least squares, of a user who knew which pairs are right."""
    return certreg.certify(X[MET], Y[MET], relaxation=False, simulation=False, **options)


@pytest.mark.parametrize(
    "options",
    [
        {"sigma": SIGMA},
        {"sigma": np.linspace(SIGMA, 2.0 * SIGMA, N)},
        {"sigma": SIGMA, "scale": "asymmetric"},
        {"covariances": np.tile(SIGMA**2 * np.eye(3), (N, 1, 1))},
        {"sigma": SIGMA, "normals": NORMALS},
        {"damping": 3.0},
        {"robustness_angle": 2.0},
    ],
)
def test_the_fit_is_that_of_these_pairs_alone(options: dict[str, Any]):
    rows = {name: value[MET] if np.ndim(value) else value for name, value in options.items()}
    told, own = certified(**options).to_dict(), alone(**rows).to_dict()

    same = ("pose", "fit", "damping", "robustness", "optimality", "springs")
    for one in told["fit"]["worst"]:
        one["row"] = MET.index(one["row"])
    for name in same:
        assert told[name] == own[name], name
        reasons = [
            {place: why for place, why in document["reasons"].items() if place.startswith(name)}
            for document in (told, own)
        ]
        assert reasons[0] == reasons[1]
    noise = "given" if "sigma" in options or "covariances" in options else "estimated"
    assert told["pose"]["covariance_scale"] == noise


@pytest.fixture
def solvers(monkeypatch) -> list[str]:
    """The solvers that were asked for; the relaxation is solved without CVXPY, which loads long."""
    asked: list[str] = []

    def relaxed(objective: Any, solver: str | None) -> Any:
        asked.append(str(solver))
        return relax(objective)

    monkeypatch.setattr(linear, "relax", relaxed)
    return asked


def test_a_problem_of_some_pairs_keeps_all_but_the_others():
    stated: tuple[dict[str, Any], ...] = (
        {"weights": np.arange(N)},
        {"normals": NORMALS},
        {"scale": "symmetric"},
    )
    for options in stated:
        problem = certreg.RegistrationProblem(X, Y, damping=2.0, **options)
        some = problem.of_rows([3, 1])
        assert np.array_equal(some.source, X[[3, 1]])
        assert np.array_equal(some.target, Y[[3, 1]])
        assert (some.damping, some.damping_given, some.noise_given) == (2.0, True, False)
        assert (some.scale, some.springs and some.springs.kind) == (
            problem.scale,
            problem.springs and problem.springs.kind,
        )
        if problem.factors is None or some.factors is None:
            assert np.array_equal(some.weights, problem.weights[[3, 1]])
        else:
            assert np.array_equal(some.factors, problem.factors[[3, 1]])
    assert certreg.RegistrationProblem(X, Y, sigma=2.0).of_rows([0]).noise_given
    assert not certreg.RegistrationProblem(X, Y).of_rows([0]).damping_given


def test_relaxation_and_simulation_are_taken_where_they_are_named(solvers):
    assert "relaxation (SDP)" not in str(certified())
    plain = certified().to_dict()
    assert plain["relaxation"] is plain["simulation"] is None
    assert plain["reasons"]["relaxation"].startswith(LEFT_OUT)
    assert plain["reasons"]["simulation"].startswith(LEFT_OUT)
    for simulation in ("midpoint", SimulationSettings(step=0.01)):
        named = certified(relaxation="SCS", simulation=simulation)
        assert "  relaxation (SDP)  rank 1, " in str(named)
        assert "  simulation        " in str(named)
        told = named.to_dict()
        assert told["relaxation"]["solver"] == "CLARABEL"
        assert told["relaxation"]["angle_to_pose_deg"] < 1e-3
        assert told["simulation"]["converged"]
        assert told["simulation"]["in_certified_basin"]
    assert solvers == ["SCS"] * 2
    assert certified(robustness_angle=None).to_dict()["robustness"] is None


@pytest.mark.slow
def test_so_it_is_of_truncated_squares(solvers):
    given = rotated_pairs(np.random.default_rng(3), 12, 0.5)
    model: dict[str, Any] = {"rotation_only": True, "objective": "truncated"}
    asked = {"damping": 2.0, "relaxation": "SCS", "simulation": "euler"}
    result = certreg.certify(given.source, given.target, max_residual=TURNED, **model, **asked)
    assert isinstance(result, TruncatedRegistration)
    told = result.to_dict()
    assert told["damping"] == 2.0
    assert told["simulation"]["integrator"] == "euler"
    assert told["relaxation"]["solver"] == "CLARABEL"
    assert told["robustness"]["angle_deg"] == 5.0
    assert solvers == ["SCS"]
    assert told["consensus"] is None
    assert result.least is result
    assert certified().least == Absent("the most pairs were sought, not the least truncated cost")
    assert "`truncated`" in told["reasons"]["consensus"]
    assert "no bound" not in str(told["reasons"])


@pytest.mark.parametrize("springs", [{}, {"normals": NORMALS}])
def test_how_sure_the_pose_is_is_told(springs: dict[str, Any]):
    given, unknown = str(certified(sigma=SIGMA, **springs)), str(certified(**springs))
    for text in (given, unknown):
        assert all(f"\n  {name} +/- " in text for name in ("centre", "rotation", "translation"))
        assert (
            "\n  robustness        of the least squares: every optimum stays within 5 degrees"
            in text
        )
    assert "from the residuals" not in given
    assert "\n  chi-squared       " in given
    assert "from the residuals" in unknown
    assert "chi-squared" not in unknown


def test_rows_of_the_fit_are_called_as_in_the_clouds():
    target = Y.copy()
    target[9] += [0.03, 0.0, 0.0]  # within the bound, and far for the noise
    result = certreg.certify(X, target, max_residual=BOUND)
    warnings = [one.text for one in result.fit.fit.warnings]  # pyright: ignore[reportAttributeAccessIssue]
    assert any("row 9, counting from 0, does not fit" in text for text in warnings), warnings
    assert result.to_dict()["fit"]["worst"][0]["row"] == 9


@pytest.mark.parametrize(
    ("about", "words"),
    [
        ({}, "rows 0, 2 and 1 other"),
        ({"rows": [7, 8, 9]}, "rows 7, 9 and 1 other"),
        ({"rows": [7, 8, 9], "labels": ["a", "b", "c"]}, "rows 7 (a), 9 (c) and 1 other"),
        ({"rows": [7, 8], "labels": ["a", "b"]}, "rows 0, 2 and 1 other"),
        ({"rows": [7, True, 9], "labels": "abc"}, "rows 0, 2 and 1 other"),
        ({"rows": {"7": 1}, "labels": [1, 2, 3]}, "rows 0, 2 and 1 other"),
    ],
)
def test_rows_are_named_by_what_a_certificate_holds_for_each(about: dict[str, Any], words: str):
    assert RowNames.of(about, 3).words([0, 2], 3) == words
