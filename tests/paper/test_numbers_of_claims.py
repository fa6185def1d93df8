"""Each number in the words of a claim is the one it is said to be: all measured ones differ."""

from __future__ import annotations

import csv
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from certreg.paper import derivation, documents, monte_carlo
from certreg.paper.claims import MEASURED
from certreg.paper.verdicts import in_doubles

if TYPE_CHECKING:
    from pathlib import Path

ROWS = {row.number: row for row in derivation.paper_claims()}


def pose(k: int, right: int, wide: int, zero: int) -> SimpleNamespace:
    """The pose k of all, with eigenvalues of the 12 and of the 18 to the right, zeros of the 18."""
    return SimpleNamespace(
        balance=(k + 1) * 1e-15,
        angle=(3 * k + 2) * 1e-11,
        half_turn_error=(k + 1) * 1e-12,
        arccos_angle=170.0 + k / 4,
        intrinsic=np.array([2.0] * right + [-1.0] * (12 - right), dtype=complex),
        ambient=np.array([3.0] * wide + [0.0] * zero + [-1.0] * (18 - wide - zero), dtype=complex),
    )


def found(k: int, *, count: int | None, unique: bool, signs: list[tuple[int, int, int]]) -> Any:
    return SimpleNamespace(
        count=count,
        unique=unique,
        least_inertia=(0.25, 0.0, 0.125)[k],
        pair_errors=tuple((10 * k + j + 1) * 1e-13 for j in range(6)),
        poses=[pose(4 * k + j, *each) for j, each in enumerate(signs)],
    )


PAPERS = [(0, 0, 6), (1, 1, 6), (2, 2, 6), (3, 3, 6)]
EQUILIBRIA = [
    found(0, count=4, unique=True, signs=PAPERS),
    found(1, count=None, unique=False, signs=[(0, 0, 5), (0, 1, 6), (2, 2, 6), (3, 3, 6)]),
    found(2, count=4, unique=True, signs=[(0, 0, 6), (1, 0, 6), (2, 2, 4), (3, 3, 6)]),
]


def moved(k: int, **given: Any) -> SimpleNamespace:
    """The simulation k: each number in a range of its own, so that none stands for another."""
    numbers = {
        "steps": (100, 900, 300, 500)[k],
        "stopped": (True, True, False, True)[k],
        "diverged": (False, False, True, False)[k],
        "closed_form_error": (1.0, 1.5, 2.0, 1.25)[k],
        "error": (11.0, 14.0, 12.0, 11.5)[k],
        "distance": (0.5, 21.0, float("nan"), 0.75)[k],
        "first_rise": (3e-6, 5e-6, -1e-6, 4e-6)[k],
        "predicted_rise": (3e-6, 5e-6, -1e-6, 4e-6 - 2e-9)[k],
        "rises": (7, 9, 4, 6)[k],
        "potential_rises": (31, 32, 33, 34)[k],
        "midpoint_at_rest": k != 2,
        "midpoint_rise": (0.0, 1e-3, 1e-3, -1.0)[k],
    }
    return SimpleNamespace(**(numbers | given))


OBSERVED: Any = SimpleNamespace(
    setup=SimpleNamespace(damping=2.5),
    comparisons=[
        SimpleNamespace(objective=a * 1e-15, rate=b * 1e-14, dissipation=c * 1e-13)
        for a, b, c in ((1, 2, 5), (3, 4, 1), (2, 7, 4))
    ],
    equilibria=EQUILIBRIA,
    simulations=[moved(k) for k in range(4)],
    turns=[
        SimpleNamespace(
            torques=np.array([[1e-16, 3e-16], [2e-16, -8e-16], [-1e-15, 1e-15]]) * scale,
            unstable=np.array([1, one, 1]),
            angles=np.zeros(3),
        )
        for scale, one in ((1.0, 1), (4.0, 2))
    ],
    balance_sums=((0, 0), (0, 0)),
)

WORDS = {
    "1": "relative difference at 9 random states: at most 3·10⁻¹⁵",
    "2": "points, at 9 random states: relative difference at most 7·10⁻¹⁴",
    "3": "on rotations, 9 random states: relative difference at most 5·10⁻¹³; at the shear ",
    "4b": "3 of 4 runs of the implicit midpoint rule came to rest",
    "5": "at the 12 equilibria, eliminated exactly from the torque, the sum over the points leaves "
    "at most 2·10⁻¹⁴ of its terms",
    "6a": "unique in 2 of 3 runs, decided exactly; on the tetrahedron and its mirror image not ",
    "6b": "3 of 3 runs have Horn's rotation among the equilibria, to 3·10⁻¹⁰°",
    "7": "three in 2 of 3 runs; 1, 2 and 0 on the three counterexamples",
    "8a": "2 of 3 runs have exactly four equilibria",
    "8b": "18 pairs, and 9 times to the closed form: 180° to 2·10⁻¹¹°. The paper's arccos formula "
    "rounds: off by up to 1·10¹°, and by 2·10²° at the optimum",
    "9b": "in doubles the torque is below 3·10⁻¹⁵, with 1 and 2 unstable eigenvalue at each of 3 "
    "angles",
    "10": "8 of 9 spurious equilibria have an eigenvalue in the right half-plane",
    "11": "1 of 3 runs count 0, 1, 2, 3, of the 12 intrinsic",
    "12": "six of the 18 are zero at 10 of 12 equilibria; at the optimum 12 are in the left "
    "half-plane and 6 are zero in 2 of 3 runs",
    "13a": "2 of 4 runs of the implicit midpoint rule: V falls in every step; dV/dt is as told to "
    "5·10⁻¹³",
    "13b": "V rises in the first step of 3 of 4 runs, by -1 to 5 millionths, as told to 2·10⁻⁹; in "
    "4 to 9 steps of each run",
    "14": "J ≻ 0 in 2 of 3 runs, least over largest eigenvalue at least 0.00; three points on a "
    "line: not definite",
    "15a": "2 of 3 simulations that come to rest do so at the optimum, after 400 steps in the "
    "median; started at the saddle the body stays, 180° off, after 0 steps",
    "15b": "μ = 2.5: 3 of 4 runs come to rest; μ = 0.005: ",
    "15d": "2 of 3 simulations that come to rest do so at the optimum",
    "15e": "2 of 3 runs: an eigenvalue of the 18 has a positive real part",
}


@pytest.mark.parametrize("number", WORDS)
def test_the_numbers_in_the_words_are_those_measured(number: str):
    example = ROWS[number].counterexample
    clouds = [in_doubles(cloud) for cloud in (example.clouds if example else ())]

    assert WORDS[number] in MEASURED[number](OBSERVED, clouds).words


def test_the_document_counts_and_spreads_each_measurement_under_its_name():
    assert documents._simulations(OBSERVED) == {
        "runs": 4,
        "stopped": 3,
        "diverged": 1,
        "at_optimum": 2,
        "energy_rose_in_first_step": 3,
        "steps": {"min": 100, "median": 400.0, "max": 900},
        "closed_form_error_deg": {"min": 1.0, "median": 1.375, "max": 2.0},
        "simulation_error_deg": {"min": 11.0, "median": 11.75, "max": 14.0},
        "simulation_to_closed_form_deg": {"min": 0.5, "median": 0.75, "max": 21.0},
    }
    assert documents._equilibria(OBSERVED) == {
        "runs": 3,
        "four": 2,
        "unique_optimum": 2,
        "pattern_0123": 1,
        "exceptions": [
            {"run": 1, "count": None, "unstable": [0, 0, 2, 3]},
            {"run": 2, "count": 4, "unstable": [0, 1, 2, 3]},
        ],
        "half_turn_error_deg": {"min": 2e-12, "median": 7e-12, "max": 1.2e-11},
        "arccos_error_deg": {"min": 7.25, "median": 8.5, "max": 9.75},
    }


def test_the_table_of_instances_has_each_number_under_its_heading(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Each column of two instances is of a decade of its own."""
    rng, names = np.random.default_rng(5), ("margin", "rotation_error_rad", "translation_error")
    decades = {name: 10.0**k for k, name in enumerate((*names, "half_turn_error_rad"))}
    arrays: dict[str, Any] = {
        "instance": np.array([0, 1]),
        "rmse": rng.uniform(1e6, 2e6, (2, 4)),
        "unstable": np.array([[0, 1, 2, 3], [3, 1, 2, 0]]),
        **{name: decade * rng.uniform(1.0, 2.0, 2) for name, decade in decades.items()},
        "exception": np.array([1]),
        "exception_pattern": np.array([[1, 1, 1, 1]]),
        "exception_sha256": np.zeros((1, 32), dtype=np.uint8),
    }
    shard = monte_carlo.packed(arrays)
    monkeypatch.setattr(monte_carlo, "contents", lambda *_: iter([shard]))
    monte_carlo.write_instance_results(monte_carlo.MonteCarlo(count=2, points=4), tmp_path)
    with (tmp_path / "summary.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))

    for k, row in enumerate(rows):
        assert [float(row[f"rmse_{j}"]) for j in range(4)] == arrays["rmse"][k].tolist()
        assert [int(row[f"unstable_{j}"]) for j in range(4)] == arrays["unstable"][k].tolist()
        assert {name: float(row[name]) for name in decades} == {
            name: float(arrays[name][k]) for name in decades
        }
        assert int(row["exact"]) == k
