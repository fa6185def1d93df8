"""What is called as good, optimal or near on general springs: each bound on both sides."""

from __future__ import annotations

import math
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.registration import landscape, valley
from certreg.registration.findings import FINE_PROOF, verdict_of
from certreg.registration.landscape import (
    BALANCED,
    SLACK,
    AssessmentSettings,
    quartic_place,
    quartic_rounding_cost,
)
from certreg.registration.quartic import QuarticSolution
from certreg.registration.valley import LEVEL, NEAR, TIE, SimulatedSprings
from certreg.results import PoseVerdict

LITTLE = Fraction(1, 10**30)
SAME, TINY = Fraction(0), Fraction(1, 10**25)


def asked(kind: type, name: str, /, **fields: Any) -> Any:
    """A property of something with these fields."""
    return getattr(kind, name).fget(SimpleNamespace(**fields))


def test_a_rest_of_springs_is_as_good_at_the_best_or_level_with_it_or_tied(monkeypatch: Any):
    def as_good(near: Any = None, *, symmetry: tuple[int, ...] = (), **fields: Any) -> Any:
        monkeypatch.setattr(valley, "equilibrium_near", lambda *_: near)
        objective = SimpleNamespace(
            oscillation=fields.pop("oscillation", 1), symmetry=symmetry, energy=lambda _: 0
        )
        found = SimpleNamespace(quaternion=None, levelled=None)
        run = {"at_best": False, "excess": 1.0, "_quaternion": None, "found": found} | fields
        prop = vars(SimulatedSprings)["as_good"]
        return prop.func(SimpleNamespace(objective=objective, **run))

    def near(angle: float, *, ties: bool = False, is_worse: bool = False) -> Any:
        return SimpleNamespace(angle=angle, ties=ties, is_worse=is_worse)

    at, past = NEAR, math.nextafter(NEAR, 1.0)
    assert as_good(at_best=True) is True
    assert as_good(oscillation=0) is True
    for symmetry, level in (((), TIE), ((1,), LEVEL)):
        assert as_good(near(1.0), excess=level, symmetry=symmetry) is True
        above = math.nextafter(level, 1.0)
        assert as_good(near(1.0), excess=above, symmetry=symmetry) is None
    assert as_good(near(at, ties=True)) is True
    assert as_good(near(past, ties=True)) is None
    assert as_good(near(at, is_worse=True)) is False
    assert as_good(near(at)) is None


def test_a_pose_on_springs_is_judged_by_each_bound_on_both_sides():
    settings: Any = SimpleNamespace(near_optimal_gap=0.25, near_optimal_angle=0.125)

    def verdict(
        gap: Fraction,
        own: Fraction = SAME,
        *,
        least: Fraction = SAME,
        within: bool = True,
        **more: Any,
    ) -> PoseVerdict:
        bounds = SimpleNamespace(greatest_gap=gap, least_gap=least, meet=lambda *_, **__: within)
        fields = {"away": None, "is_elsewhere": False, "rounding_cost": TINY}
        fields |= {
            "place": SimpleNamespace(energy_range=1, rest=None),
            "unique": None,
            "is_near": lambda _: True,
        } | more
        return verdict_of(
            SimpleNamespace(bounds=bounds, proof_gap=own, **fields),  # pyright: ignore[reportArgumentType]
            settings,
        )

    def at(*, here: bool) -> Any:
        return SimpleNamespace(energy_range=1, rest=SimpleNamespace(here=here))

    fine, quarter = Fraction(FINE_PROOF), Fraction(1, 4)
    assert verdict(TINY) is PoseVerdict.OPTIMAL
    assert verdict(TINY + LITTLE**2) is PoseVerdict.NEAR_OPTIMAL
    assert verdict(fine, fine) is PoseVerdict.OPTIMAL
    assert verdict(fine + LITTLE, fine + LITTLE) is PoseVerdict.NEAR_OPTIMAL
    assert verdict(TINY, within=False) is PoseVerdict.NEAR_OPTIMAL
    assert verdict(quarter) is PoseVerdict.NEAR_OPTIMAL
    assert verdict(quarter, is_near=lambda _: False) is PoseVerdict.BOUNDED
    assert verdict(quarter + LITTLE) is PoseVerdict.NOT_AN_EQUILIBRIUM
    assert verdict(quarter, is_elsewhere=True) is PoseVerdict.NOT_AN_EQUILIBRIUM
    assert verdict(quarter, away=0.125) is PoseVerdict.NEAR_OPTIMAL
    assert verdict(quarter, away=math.nextafter(0.125, 1)) is PoseVerdict.NOT_AN_EQUILIBRIUM
    worse: dict[str, Any] = {"place": at(here=True), "is_elsewhere": True}
    assert verdict(quarter, least=LITTLE, **worse) is PoseVerdict.SPURIOUS_EQUILIBRIUM
    assert verdict(quarter, least=SAME, **worse) is PoseVerdict.NOT_AN_EQUILIBRIUM
    worse["place"] = at(here=False)
    assert verdict(quarter, least=LITTLE, **worse) is PoseVerdict.NOT_AN_EQUILIBRIUM


@pytest.mark.parametrize("beside", [-LITTLE, Fraction(0), LITTLE])
def test_minima_are_near_up_to_the_proved_gap(beside: Fraction):
    energies = {"best": Fraction(2), "next": Fraction(5, 2) + beside, "far": Fraction(9)}
    certificate = SimpleNamespace(body=SimpleNamespace(gap=Fraction(1, 2)))
    fields: dict[str, Any] = {
        "least": Fraction(2),
        "objective": SimpleNamespace(energy=energies.__getitem__),
    }

    def near(minima: list[str], certificate: Any = certificate) -> int:
        found = SimpleNamespace(minima=minima)
        return asked(QuarticSolution, "near_minima", certificate=certificate, found=found, **fields)

    assert near(["best", "next", "far"]) == (1 if beside > 0 else 2)
    assert near(["far"]) == 1
    assert near(["best", "next"], None) == 1


def cost_of(monkeypatch: Any, half: Any, sine: Fraction, away: Fraction) -> Fraction:
    """Of a turn and a shift of these sizes, squared, beside half a Hessian."""
    monkeypatch.setattr(landscape, "rounding_errors", lambda *_: (sine, away))
    near = SimpleNamespace(half_hessian=lambda _: np.asarray(half, dtype=float))
    registration: Any = SimpleNamespace(
        pose=SimpleNamespace(rotation=None, quaternion_wxyz=None, translation=None),
        solution=SimpleNamespace(near=near, centre=()),
    )
    given: Any = SimpleNamespace(is_matrix=True, translation=())
    return quartic_rounding_cost(registration, given)


@pytest.mark.parametrize("k", range(6))
def test_a_rounding_costs_its_turn_and_its_shift_by_the_stiffest_of_either(monkeypatch: Any, k):
    """(2 sqrt(S) + 2 pi/6 sqrt(T))^2, where |d| = 2 and sin(a/2) = 1/2."""
    sizes = [1.0] * 6
    sizes[k] = 9.0
    shift, turn = (6.0, 1.0) if k < 3 else (2.0, 3.0)
    cost = cost_of(monkeypatch, np.diag(sizes), Fraction(1, 4), Fraction(4))

    assert float(cost) == pytest.approx(SLACK * (shift + turn * math.pi / 3) ** 2, rel=1e-14)


def test_the_stiffest_direction_may_be_any_mix(monkeypatch: Any):
    """((1, 2), (2, 4)) takes (1, 2) to 5 times itself."""
    block = np.diag([0.0, 0.0, 1.0])
    block[:2, :2] = [[1.0, 2.0], [2.0, 4.0]]
    half = np.kron(np.eye(2), block)

    cost = cost_of(monkeypatch, half, Fraction(0), Fraction(1))
    assert float(cost) == pytest.approx(SLACK * 5.0, rel=1e-14)
    cost = cost_of(monkeypatch, half, Fraction(1, 2), Fraction(0))
    assert float(cost) == pytest.approx(SLACK * 5.0 * (math.pi / 2) ** 2, rel=1e-14)


@pytest.mark.parametrize("sine", [Fraction(1), Fraction(4)])
def test_a_turn_is_half_a_turn_at_most(monkeypatch: Any, sine: Fraction):
    cost = cost_of(monkeypatch, np.eye(6), sine, Fraction(0))

    assert float(cost) == pytest.approx(SLACK * math.pi**2, rel=1e-14)


@pytest.mark.parametrize("beyond", [math.inf, math.nan])
def test_beyond_the_doubles_no_cost_of_a_rounding_is_allowed(monkeypatch: Any, beyond: float):
    half = np.eye(6)
    half[4, 4] = beyond

    assert cost_of(monkeypatch, half, Fraction(1, 4), Fraction(4)) == 0


@pytest.mark.parametrize("slope", [BALANCED, math.nextafter(BALANCED, 1.0)])
@pytest.mark.parametrize("angle", [1e-3, math.nextafter(1e-3, 1.0)])
@pytest.mark.parametrize("shifted", [Fraction(1, 2**20), Fraction(1, 2**20) + LITTLE])
def test_a_pose_is_at_an_equilibrium_within_the_angle_the_shift_and_the_slope(
    monkeypatch: Any, slope: float, angle: float, shifted: Fraction
):
    near = SimpleNamespace(angle=angle, slope=slope, index=1, is_worse=True)
    monkeypatch.setattr(landscape, "equilibrium_near", lambda *_: near)
    objective = SimpleNamespace(oscillation=1, translation_energy=lambda *_: shifted)
    found = SimpleNamespace(levelled=None)
    solution: Any = SimpleNamespace(
        objective=objective, found=found, least=0, unique_rotation=None, quaternion=None
    )
    pose: Any = SimpleNamespace(quaternion=None, translation=None)
    bounds: Any = SimpleNamespace(least_range_squared=Fraction(1))
    settings = AssessmentSettings(equilibrium_shift=2.0**-10)

    rest = quartic_place(solution, pose, bounds, None, settings).rest
    assert (rest is None) == (slope > BALANCED or angle > 1e-3 or shifted > Fraction(1, 2**20))
