"""Equilibria of random general springs: counted as the exact theory has them, and as drawn."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from test_reproduce import SCHEMA

from certreg.campaign.table import records_bytes
from certreg.objective.springs import Springs
from certreg.paper import equilibrium_maps as mapping
from certreg.paper.equilibrium_maps import (
    SIZES,
    SPRING_CELLS,
    RunEnd,
    SpringCell,
    SpringCounts,
    SpringObservation,
    generator,
    measured,
    observed,
    spring_counts,
    spring_problem,
    spring_rows,
    wilson,
)
from certreg.paper.map_figures import counts_drawing, spring_drawings
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.optimum import find_optimum

FEW = [cell for cell in SPRING_CELLS if cell.points in {4, 7, 20} and cell.noise in {0.1, 1.0}]


@pytest.fixture(scope="module")
def counts() -> tuple[SpringCounts, ...]:
    return tuple(measured(cell, 0, 3) for cell in FEW)


def test_there_is_a_family_for_planes_lines_and_covariances():
    assert set(SIZES) == set(mapping.SPRINGS) == set(mapping.FAMILY_WORDS)
    ranks = {"plane": (8, 0, 0), "line": (0, 8, 0), "covariance": (0, 0, 8)}
    for family, expected in ranks.items():
        cell = SpringCell(family=family, points=8, noise=0.1)
        springs = spring_problem(generator(cell, 0, 0), cell).springs
        assert springs is not None
        assert springs.ranks[1:] == expected


def test_counts_are_even_and_four_at_least_and_some_wrong_ones_are_stable(counts):
    listed = [seen for each in counts for seen in each.listed]

    assert {seen.equilibria % 2 for seen in listed} == {0}
    assert min(seen.equilibria for seen in listed) >= 4
    assert max(seen.equilibria for seen in listed) <= 40
    assert all(0 <= seen.spurious < seen.stable for seen in listed)
    assert all(2 * seen.stable <= seen.equilibria for seen in listed)  # as many of odd index
    assert sum(each.trapping for each in counts) > 0


def test_every_run_ends_somewhere_and_only_where_there_is_a_trap_at_a_wrong_pose(counts):
    for each in counts:
        assert sum(each.ended(end) for end in RunEnd) == len(each.listed)
        assert each.ended(RunEnd.SPURIOUS) <= each.trapping
        assert each.ended(RunEnd.NOT_LISTED) == 0
    ends = {seen.ended for each in counts for seen in each.listed}
    assert RunEnd.OPTIMUM in ends


def test_six_planes_without_noise_have_what_the_derivation_says():
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    seen = observed(RegistrationProblem(corners, np.zeros((6, 3)), normals=np.abs(corners)))

    assert (seen.listed, seen.equilibria, seen.stable, seen.spurious) == (True, 40, 8, 0)
    assert seen.ended is not RunEnd.SPURIOUS  # all eight are exact fits


def test_released_near_a_stable_spurious_equilibrium_the_body_ends_there():
    """The 18 planes of the derivations, given turned by the half turn about z and a little more."""
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    held = [(3.0 * c, n) for c in corners for n in np.eye(3) if not c @ n]
    points = np.concatenate([corners, [c for c, _ in held]])
    normals = np.concatenate([np.abs(corners), [n for _, n in held]])
    c, s = math.cos(math.pi - 0.3), math.sin(math.pi - 0.3)
    turned = points @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    seen = observed(RegistrationProblem(turned, points, normals=normals))

    assert (seen.listed, seen.equilibria, seen.stable, seen.spurious) == (True, 40, 4, 3)
    assert seen.ended is RunEnd.SPURIOUS
    assert 1 <= seen.place <= 3


def test_one_wall_is_not_counted():
    points = np.random.default_rng(0).standard_normal((9, 3))
    seen = observed(RegistrationProblem(points, points, normals=np.tile([0.0, 0.0, 1.0], (9, 1))))

    assert seen == SpringObservation(listed=False)


def test_the_minima_are_those_that_the_search_for_the_optimum_knows():
    cell = SpringCell(family="plane", points=6, noise=0.1)
    problem = spring_problem(generator(cell, 0, 1), cell)
    found = find_optimum(Springs.of(problem))

    assert observed(problem).stable >= len(found.minima) >= 1


def test_an_instance_does_not_depend_on_how_many_are_made_and_the_noise_alone_differs():
    cell = SpringCell(family="line", points=4, noise=0.1)
    few, more = measured(cell, 3, 1), measured(cell, 3, 2)
    loud = spring_problem(generator(replace(cell, noise=1.0), 3, 0), replace(cell, noise=1.0))
    still = spring_problem(generator(cell, 3, 0), cell)

    assert few.seen[0] == more.seen[0]
    assert np.array_equal(loud.source, still.source)
    assert not np.array_equal(loud.target, still.target)


def test_wilsons_interval_holds_the_share_and_is_right_where_it_is_known():
    assert wilson(0, 0) == (0.0, 1.0)
    assert wilson(0, 10)[0] == 0.0
    assert wilson(10, 10)[1] == pytest.approx(1.0)
    low, high = wilson(50, 100)  # centre 1/2: half the width is z / (2 sqrt(n + z^2))
    half = mapping.Z95 / (2.0 * math.sqrt(100.0 + mapping.Z95**2))
    assert (low, high) == pytest.approx((0.5 - half, 0.5 + half))


def test_the_table_and_the_document_say_the_same(counts):
    rows = list(spring_rows(counts))
    listed = list(csv.DictReader(io.StringIO(records_bytes(spring_rows(counts)).decode())))

    schema = {"$schema": SCHEMA["$schema"], **SCHEMA["properties"]["springs"]}
    assert Draft202012Validator(schema).is_valid(rows)
    assert [row["family"] for row in listed] == [row["family"] for row in rows]
    assert [int(row["equilibria_most"]) for row in listed] == [r["equilibria_most"] for r in rows]
    for name in ("stable_spurious", "ended_wrong"):
        low, high = (sum(row[f"{name}_{side}"] for row in rows) for side in ("low", "high"))
        assert low <= sum(row[name] / row["listed"] for row in rows) <= high


@pytest.mark.long
def test_a_cell_of_which_nothing_is_listed_has_no_numbers(counts):
    nothing = replace(counts[0], seen=(SpringObservation(listed=False),) * 3)
    (row,) = spring_rows([nothing])

    assert (row["listed"], row["equilibria_least"], row["stable_most"]) == (0, None, None)
    assert (row["ended_wrong_low"], row["ended_wrong_high"]) == (0.0, 1.0)
    (first, second) = spring_drawings([nothing, *counts[1:]])
    assert "3 of" in first.caption
    assert "left out" in first.caption
    assert second.name == "springs-ends"


def test_the_figures_tell_the_range_that_was_seen(counts):
    counted = counts_drawing(counts)
    known = np.concatenate([each.counted for each in counts])
    words = [text.get_text() for axes in counted.figure.axes for text in axes.texts]

    assert f"these have {known.min()} to {known.max()}, always" in counted.caption
    assert words.count("4") >= 6  # the isotropic row
    assert spring_drawings(()) == ()


def test_every_cell_is_measured_and_progress_is_told(monkeypatch):
    told: list[tuple[str, int, int]] = []

    def progress(stage: str, done: int, total: int) -> None:
        told.append((stage, done, total))

    monkeypatch.setattr(mapping, "SPRING_CELLS", FEW[:2])
    monkeypatch.setattr(mapping, "measured", lambda cell, seed, runs: SimpleNamespace(cell=cell))

    found = spring_counts(0, None, progress)

    assert [each.cell for each in found] == FEW[:2]
    assert told == [("springs", 0, 2), ("springs", 1, 2), ("springs", 2, 2)]
