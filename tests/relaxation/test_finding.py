"""The optimum of general springs is found, the best of several minima, to many bits."""

from __future__ import annotations

import functools
import sys
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
import spring_families

from benchmarks.rates import spring_minima
from certreg import RegistrationProblem
from certreg.equilibrium.paths import PathsOutcome
from certreg.equilibrium.quartics import FloatingQuartic
from certreg.geometry.so3 import (
    angle_between,
    body_frame,
    dot,
    quaternion_of_rotation,
    squared_norm,
)
from certreg.native.paths import critical_point_near
from certreg.objective.levelling import levelled_exactly, norm_fourth
from certreg.objective.quartics import MONOMIALS
from certreg.objective.springs import Springs
from certreg.relaxation import optimum as optimum_module
from certreg.relaxation import refining
from certreg.relaxation.conic import RelaxationStatus
from certreg.relaxation.optimum import (
    CONSTANT_WORDS,
    MOST_MINIMA,
    TIGHT_WORDS,
    find_optimum,
    optimum_of,
)
from certreg.relaxation.refining import POSE_BITS, refined


@functools.cache
def springs(family, n, noise, seed=0):
    made = getattr(spring_families, family)(np.random.default_rng(seed), n, noise)
    return Springs.of(RegistrationProblem(made.source, made.target, **made.springs))


@functools.cache
def found(family, n, noise, seed=0) -> Any:
    return find_optimum(springs(family, n, noise, seed))


def test_where_the_relaxation_is_tight_no_path_is_tracked():
    optimum = found("plane", 20, 0.1)

    assert (optimum.words, optimum.lines) == (TIGHT_WORDS, None)
    assert optimum.relaxation.rank == 1
    assert optimum.minima == (optimum.quaternion,)


def test_six_planes_have_several_optima_and_the_best_of_all_minima_is_the_answer():
    optimum = found("plane", 6, 0.05)
    energies = [springs("plane", 6, 0.05).energy(q) for q in optimum.minima]

    assert optimum.lines.outcome is PathsOutcome.FOUND
    assert len(optimum.minima) > 1
    for p, q in combinations(optimum.minima, 2):
        assert dot(p, q) ** 2 < (1 - 1e-6) * squared_norm(p) * squared_norm(q)
    assert energies == sorted(energies)
    assert optimum.words.endswith(f"They led to the best of {len(optimum.minima)} local minima.")


@pytest.mark.parametrize(("family", "n", "noise"), [("plane", 20, 0.1), ("plane", 6, 0.05)])
def test_quaternions_are_critical_to_ninety_bits(family, n, noise):
    """The exact gradient over the size of F; the curvature is above 2^-8 of it here."""
    optimum = found(family, n, noise)
    for q in optimum.minima:
        norm, size = squared_norm(q), 1 << optimum.levelled.bits
        slopes = [dot(c, optimum.levelled.gradient(q)) for c in zip(*body_frame(q), strict=True)]
        assert abs(norm - (1 << 2 * POSE_BITS)) < 1 << POSE_BITS + 4
        assert max(map(abs, slopes)) << 94 < size * norm**2


def test_a_constant_energy_is_told():
    assert optimum_of([3 * int(c) for c in norm_fourth()]).words == CONSTANT_WORDS


def test_refining_stops_where_the_hessian_is_flat():
    """w^4 + x^4 + y^4 near z: of order four, so that doubles know no step."""
    flat = levelled_exactly([10**9 * (k in (0, 20, 30)) for k in range(35)])

    q = refined(flat, (1e-3, 0.0, 0.0, 1.0))

    assert abs(squared_norm(q) - (1 << 2 * POSE_BITS)) < 1 << POSE_BITS + 4
    assert abs(q[3]) > q[0]


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("cell", spring_minima.CELLS, ids=str)
def test_no_better_minimum_is_on_the_complete_list(cell):
    """One of the instances of `make rates NAME=spring_minima`, which has several minima."""
    outcome = spring_minima.outcome_of(cell, seed=1)

    assert outcome.complete
    assert not outcome.missed


@pytest.mark.slow
def test_a_minimum_that_is_missed_is_seen(monkeypatch):
    """The worst, given out for the best: six planes are met exactly at several poses."""
    (cell,) = [c for c in spring_minima.CELLS if (c.family, c.noise) == ("plane", 0.05)]
    whole = spring_minima.find_optimum

    def worst(objective):
        right = whole(objective)
        return replace(right, quaternion=right.minima[-1])

    monkeypatch.setattr(spring_minima, "find_optimum", worst)
    outcome = spring_minima.outcome_of(cell, seed=1)

    assert outcome.several
    assert outcome.missed
    assert outcome.excess > 0
    assert outcome.by_descent > 0


def of_factors(source, target, factors):
    rows = [factors] * len(source)
    return Springs.of(RegistrationProblem(source, target, factors=rows))


@pytest.mark.slow
def test_of_a_continuum_of_optima_some_are_found_and_the_words_do_not_count_them_as_all():
    """One wall: turns about its normal cost nothing."""
    rng = np.random.default_rng(0)
    optimum = find_optimum(
        of_factors(rng.normal(size=(20, 3)), rng.normal(size=(20, 3)), (0, 0, 0, 0, 0, 1))
    )

    assert optimum.lines is not None
    assert optimum.lines.outcome is not PathsOutcome.FOUND
    assert optimum.words.startswith(optimum.lines.outcome.value)
    assert optimum.words.endswith("local minima that were met.")
    assert len(optimum.minima) == MOST_MINIMA
    values = [optimum.levelled.value(q) / squared_norm(q) ** 2 for q in optimum.minima]
    assert np.ptp(values) < 1e-12 * (1 << optimum.levelled.bits)


def test_a_minimum_of_order_four_is_reached_as_far_as_doubles_go():
    """A sphere without noise: the Hessian at the optimum is zero."""
    rng = np.random.default_rng(0)
    points, rotation = spring_families.directions(rng, 20), spring_families.uniform_rotation(rng)
    normals = points @ rotation.T
    made = RegistrationProblem(points, normals, normals=normals)
    optimum = find_optimum(Springs.of(made))
    q = np.array([entry / 2**POSE_BITS for entry in optimum.quaternion])

    assert optimum.words == TIGHT_WORDS
    assert angle_between(q, quaternion_of_rotation(rotation)) < 1e-4


def test_without_the_relaxation_s_solver_all_paths_are_tracked(monkeypatch):
    monkeypatch.setitem(sys.modules, "clarabel", None)
    optimum: Any = find_optimum(springs("plane", 20, 0.1))

    assert optimum.relaxation.status is RelaxationStatus.UNAVAILABLE
    assert optimum.lines.outcome is PathsOutcome.FOUND
    assert optimum.quaternion == pytest.approx(found("plane", 20, 0.1).quaternion, rel=1e-25)


def test_a_value_above_the_relaxation_s_is_not_taken_for_tight(monkeypatch):
    """As where squares of degree four leave a gap: rank one may be chance."""
    objective, whole = springs("plane", 20, 0.1), optimum_module.relax_quartic

    def lower(*arguments):
        right: Any = whole(*arguments)
        return replace(right, value=right.value - 2e-6)

    monkeypatch.setattr(optimum_module, "relax_quartic", lower)
    optimum = find_optimum(objective)

    assert optimum.lines is not None
    assert optimum.quaternion == found("plane", 20, 0.1).quaternion


def test_without_compiled_code_the_same_quaternion_is_found(monkeypatch):
    monkeypatch.setattr(refining, "critical_point_near", lambda *_: None)
    optimum = find_optimum(springs("plane", 20, 0.1))

    assert optimum.quaternion == pytest.approx(found("plane", 20, 0.1).quaternion, abs=1 << 6)


def test_newton_in_doubles_keeps_to_what_is_near_and_not_singular():
    """At 0.05 and at 0.5 radians from a minimum; at curvatures 1, 1 and 1e-7 or 1e-9."""
    optimum = found("plane", 20, 0.1)
    rest, q = (
        optimum.levelled.rest,
        np.array([entry / 2**POSE_BITS for entry in optimum.quaternion]),
    )
    w, x, y, z = q.tolist()
    turned = np.array((-x, w, z, -y))
    near = critical_point_near(rest, np.cos(0.025) * q + np.sin(0.025) * turned)

    assert near is not None
    assert near.quaternion == pytest.approx(q.tolist(), abs=1e-15)
    inverse = np.linalg.inv(FloatingQuartic.of(rest).curvatures(q[np.newaxis])[2][0])
    assert np.array(near.inverse) == pytest.approx(inverse, rel=1e-9, abs=1e-9)
    assert critical_point_near(rest, np.cos(0.25) * q + np.sin(0.25) * turned) is None
    for least, known in ((1e-7, True), (1e-9, False)):
        flat = np.zeros(35)
        flat[[MONOMIALS.index((i, i, 3, 3)) for i in range(3)]] = (1.0, 1.0, least)
        assert (critical_point_near(flat, (0.0, 0.0, 0.0, 1.0)) is not None) == known


def test_descents_begin_at_minima_alone_where_all_lines_are_known():
    optimum = found("plane", 6, 0.05)
    form = FloatingQuartic.of(optimum.levelled.rest)
    starts = optimum_module._starts(form, optimum.lines)

    assert len(starts) == len(optimum.minima)
    assert (np.linalg.eigvalsh(form.curvatures(starts)[2]) > 0).all()


def test_where_newton_does_not_arrive_a_descent_leads_there(monkeypatch):
    nowhere = refining.Refined((1 << POSE_BITS, 0, 0, 0), 1.0)
    monkeypatch.setattr(optimum_module, "newton", lambda *_: nowhere)
    optimum = find_optimum(springs("plane", 20, 0.1))

    assert optimum.words == TIGHT_WORDS
    assert optimum.quaternion == pytest.approx(found("plane", 20, 0.1).quaternion, abs=1 << 6)
