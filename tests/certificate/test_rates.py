"""Samples of the large ones: a few of the problems of which `make rates` takes many."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import spring_families as families
from mpmath import mpf, sqrt, workdps
from strategies import random_problem

from benchmarks.rates import consensus_labels as rates
from benchmarks.rates import planted_consensus, scale_bounds, truncated_rotations, turned_springs
from benchmarks.rates.hard_instances import FAMILIES, outcome
from benchmarks.rates.mapped_clouds import Run, size, turn, write_clouds
from benchmarks.rates.spring_certificates import BARELY, WELL, Rate, rate_of
from certreg import RegistrationProblem, verify
from certreg.certificate.blockwise import check_on_sums
from certreg.certificate.consistency import RigidPairs
from certreg.dynamics.integrators import SimulationSettings
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED
from certreg.registration.simulation import simulate
from certreg.results import Optimality
from certreg.verify import check


@pytest.mark.one_in(4)
@pytest.mark.parametrize("cell", [c for c in families.CELLS if c.n < 20], ids=str)
def test_the_first_problem_of_each_small_cell_is_certified_unique(cell):
    rate = rate_of(cell, 1)

    assert rate.good, str(rate)


def test_a_cell_is_missed_by_one_problem_in_five_hundred_that_is_not():
    cell = families.CELLS[0]

    def rate(*, unique=500, refused=0, angle=WELL, of=cell):
        return Rate(
            cell=of,
            count=500,
            unique=unique,
            refused=refused,
            angle=angle,
            milliseconds=1.0,
            kinds={},
        )

    assert rate().good
    assert rate(unique=499).good
    assert not rate(unique=498).good
    assert not rate(refused=1).good
    assert rate(angle=BARELY).good  # of seven planes
    assert not rate(angle=2 * BARELY).good
    assert not rate(angle=BARELY, of=families.Cell("plane", 8, 0.1)).good
    assert str(rate(unique=498)).startswith("MISSED plane N=7")


@pytest.fixture(scope="module")
def rate():
    return rates.rate_of(rates.Cell(n=20, wrong=50), 2, checked=1)


def test_labels_of_small_problems_are_proved_and_checked(rate):
    assert (rate.labels, rate.outliers, rate.best) == (1.0, 1.0, 1.0)
    assert 0 < rate.size < rates.MOST_BYTES
    assert rate.checking > 0.0


def test_what_is_not_as_it_must_be_is_named(rate):
    cell = rates.Cell(n=100, wrong=80)
    good = replace(
        rate, gnc=2.0, proving=2.0, together=20.0, checking=100.0, labels=0.95, outliers=0.5
    )

    assert rates.misses(cell, good) == []
    assert rates.misses(cell, replace(good, labels=0.94)) == ["labels"]
    assert rates.misses(cell, replace(good, proving=2.1)) == ["proving"]
    assert rates.misses(cell, replace(good, together=20.1)) == ["together"]
    assert rates.misses(cell, replace(good, checking=101.0)) == ["checking"]
    assert rates.misses(cell, replace(good, size=100_001)) == ["size"]
    assert rates.misses(replace(cell, n=1000), replace(good, proving=10.0)) == ["outliers"]
    assert rates.misses(replace(cell, wrong=95), replace(good, labels=0.0, proving=9.0)) == []
    assert rates.misses(replace(cell, beta=3.0), replace(good, labels=0.0)) == []
    assert "missed: labels" in rates.line(cell, replace(good, labels=0.94))


def test_a_cell_that_is_there_is_not_measured_again(rate, tmp_path, monkeypatch, capsys):
    results, cell = tmp_path / "new" / "consensus.json", rates.Cell(n=20, wrong=50)
    measured = list[int]()
    monkeypatch.setattr(rates, "CELLS", (cell,))
    monkeypatch.setattr(rates, "rate_of", lambda _, count: measured.append(count) or rate)

    rates.main(2, "20,50", results)
    rates.main(2, "", results)
    rates.main(3, "20", results)
    rates.main(2, "100", results)

    assert measured == [2, 3]
    assert json.loads(results.read_text("utf-8"))[cell.name]["commit"] == rates.commit()
    assert capsys.readouterr().out.count(cell.name) == 3


FEW = planted_consensus.INSTANCES // 4000


@pytest.mark.slow
@pytest.mark.parametrize("count", [FEW, pytest.param(40 * FEW, marks=pytest.mark.long)])
def test_no_planted_pair_is_struck_and_the_checker_agrees(count: int):
    first = 1 if count == FEW else 0

    assert [
        fault for seed in range(first, first + count) for fault in planted_consensus.faults(seed)
    ] == []


def test_a_graph_that_loses_a_neighbour_at_its_bound_is_seen(monkeypatch):
    honest = RigidPairs.near

    def strict(pairs):
        pairs.bounds = pairs.bounds * (1.0 - 1e-6)
        return honest(pairs)

    assert list(planted_consensus.faults(3)) == []
    monkeypatch.setattr(RigidPairs, "near", strict)
    assert any(
        "no neighbours" in fault for k in (1, 3, 5, 7) for fault in planted_consensus.faults(k)
    )


SAMPLE = scale_bounds.PROBLEMS // 500


@pytest.mark.slow
@pytest.mark.parametrize("count", [SAMPLE, pytest.param(5 * SAMPLE, marks=pytest.mark.long)])
def test_scales_and_poses_are_those_of_the_reference_and_each_certificate_is_accepted(count):
    tally = scale_bounds.counted(0, count)

    assert tally.good
    assert 0 < tally.scale < 1e-15  # the scale is rounded to a double
    assert 0 < tally.width < 1e-20


def test_the_reference_knows_a_scale_that_is_exact():
    problem = replace(scale_bounds.random_problem(1), rotation_only=True)
    best = scale_bounds.reference(replace(problem, target=-4.0 * problem.source[:, [1, 0, 2]]))

    assert abs(best.scale - 4) < mpf(10) ** -50
    turn = np.array([[0, -1, 0], [-1, 0, 0], [0, 0, -1]])
    assert np.abs(best.rotation - turn).max() < 1e-50


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("error", ["scale", "rotation", "translation"])
def test_a_reference_that_is_off_by_little_is_seen(monkeypatch, error):
    honest = scale_bounds.reference

    def off(problem):
        best = honest(problem)
        with workdps(scale_bounds.DIGITS):
            moved = {
                "scale": best.scale * (1 + mpf("1.2e-14")),
                "rotation": best.rotation + 1.2e-14,
                "translation": best.translation + 1.2e-14 * best.coordinates,
            }
        return replace(best, **{error: moved[error]})

    monkeypatch.setattr(scale_bounds, "reference", off)
    tally = scale_bounds.counted(1, 1)

    assert not tally.good
    assert getattr(tally, error) > scale_bounds.ERROR
    assert tally.outside == (error == "scale")


def test_intervals_that_are_wide_or_beside_the_scale_are_seen():
    best = scale_bounds.reference(scale_bounds.random_problem(1))
    with workdps(scale_bounds.DIGITS):
        scale = Fraction(str(best.scale))
        root = Fraction(str(sqrt(best.scale)))
    step = scale * Fraction(1, 10**20)
    for low, high, wide, outside in (
        (scale - step / 4, scale + step / 4, False, 0),
        (scale - step, scale + step, True, 0),
        (scale + step / 4, scale + step / 2, False, 1),
        (root, root, False, 1),
    ):
        tally = scale_bounds.Tally()
        scale_bounds.compare_interval(low, high, best, tally)
        assert (tally.width > scale_bounds.WIDTH, tally.outside) == (wide, outside)
        assert tally.good == (not wide and not outside)


@pytest.mark.slow
def test_what_the_checker_refuses_is_counted(tmp_path):
    line = scale_bounds.certified(scale_bounds.random_problem(1), scale_bounds.Tally())
    forged = json.loads(line)
    forged["claims"]["gap"][1] -= 1
    path = tmp_path / "all.jsonl"
    path.write_bytes(b"\n".join([line, json.dumps(forged).encode(), b"", line, b""]))

    assert scale_bounds.accepted(path) == 2


@pytest.mark.slow
def test_a_pose_that_is_not_the_rigid_one_is_counted(monkeypatch):
    honest = scale_bounds.Problem.stated

    def stated(problem, scale):
        moved = replace(problem, target=problem.target[::-1]) if scale == "none" else problem
        return honest(moved, scale)

    monkeypatch.setattr(scale_bounds.Problem, "stated", stated)
    tally = scale_bounds.counted(1, 1)

    assert (tally.unlike_rigid, tally.good) == (1, False)


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, pytest.param(40, marks=pytest.mark.long)])
def test_random_problems_are_proved_and_forgeries_are_refused(count: int):
    trials = truncated_rotations.usual(count)

    assert truncated_rotations.faults(trials) == []
    assert all(one.forgeries[0] >= 14 for one in trials[:1])
    assert all(one.excess is not None for one in trials[:1])
    assert "exhaustive searches: " in truncated_rotations.table(trials)


def test_what_must_not_be_is_told():
    good = truncated_rotations.Trial(
        name="a", proved=True, boxes=1, search=0.1, check=0.1, excess=0.0, forgeries=(1, 0)
    )
    bad = replace(good, proved=False, search=11.0, excess=0.01, forgeries=(1, 1))
    ends = ("not proved", "too slow", "not the least", "a forgery was accepted")

    assert truncated_rotations.faults([good, bad]) == [f"a: {end}" for end in ends]


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_certified_optimum_is_that_of_descents_and_accepted_by_the_checker_alone(seed: int):
    assert turned_springs.optimum_missed(seed) == ""


def test_another_optimum_of_the_descents_is_seen(monkeypatch: pytest.MonkeyPatch):
    least = turned_springs.least

    def changed(cost: float, at: object) -> tuple[float, object]:
        return cost * (1 + 1e-11), at

    monkeypatch.setattr(turned_springs, "least", lambda *given: changed(*least(*given)))

    assert "SciPy finds" in turned_springs.optimum_missed(0)


@pytest.mark.long
def test_the_noise_is_estimated_with_the_right_degrees_of_freedom():
    """With 4 counted as 7, as with a translation, the mean would be above 1.15 for planes."""
    factors = np.array([turned_springs.variance_factor(seed) for seed in range(60)])
    error = factors.std(ddof=1) / np.sqrt(len(factors))

    assert abs(factors.mean() - 1.0) < 3 * error
    assert error < 0.06


@pytest.mark.slow
@pytest.mark.parametrize("count", [4, pytest.param(12, marks=pytest.mark.long)])
def test_certificates_whose_claims_are_false_are_refused(count: int):
    made = [(seed, turned_springs.forged(seed)) for seed in range(count)]
    false = [document for seed, document in made if turned_springs.is_false(document, seed)]

    assert len(false) >= 2 * count // 3
    assert not any(check(json.dumps(document).encode()).verified for document in false)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__)
def test_what_is_certified_ends_so_and_the_simulation_converges(family):
    found = outcome(family, 0)

    assert found.sound
    assert found.converged
    assert found.status is not Optimality.NOT_CERTIFIED


def test_a_code_that_is_not_that_of_the_proof_is_seen():
    found = outcome(FAMILIES[1], 0)

    assert found.code == DONE
    assert not replace(found, code=NOT_CERTIFIED).sound
    assert not replace(found, converged=False, why="").sound


def test_where_no_damping_is_best_none_is_advised():
    """A mirrored prism: doubles do not tell the two best poses apart, and no motion would."""
    k = 7
    angles = 2 * np.pi * np.arange(k) / k
    ring = 20.0 * np.stack([np.cos(angles), np.sin(angles), np.zeros(k)], axis=1)
    source = np.vstack([ring, ring + np.array([0.0, 0.0, 400.0])])
    target = source[:, [1, 2, 0]] * np.array([1.0, 1.0, -1.0])
    few = SimulationSettings(max_steps=2000)
    stuck: Any = simulate(RegistrationProblem(source, target), "splitting", settings=few)
    slow = random_problem(np.random.default_rng(1)).damped(1e-3)
    advised: Any = simulate(slow, "splitting", settings=few)

    assert not stuck.converged
    assert not any("far from the best one" in note for note in stuck.notes)
    assert not advised.converged
    assert any("try --damping optimal" in note for note in advised.notes)


POINTS = 1_050_000  # more than a certificate holds
MEGABYTES = 45  # of the 50 that both files have; 16 are the stacks of two threads


@pytest.mark.long
def test_mapped_clouds_are_certified_in_less_memory_than_they_take(tmp_path):
    files = write_clouds(tmp_path, POINTS)
    run = Run.of(*files, tmp_path / "certificate.json", MEGABYTES)

    assert run.n == POINTS
    assert run.status == "CERTIFIED"
    assert np.abs(run.rotation - turn()).max() < 1e-3
    assert sum(file.stat().st_size for file in files) > MEGABYTES << 20

    content = (tmp_path / "certificate.json").read_bytes()
    mapped = RegistrationProblem(*(np.load(file, mmap_mode="r") for file in files))
    assert len(content) < 2000
    assert "give SOURCE and TARGET" in verify(content).words
    assert check_on_sums(content, mapped).verified


def test_the_size_is_what_the_disk_allows():
    assert size(1000.0, 8.0) == 8.0
    assert size(8.0, 8.0) == 3.0
