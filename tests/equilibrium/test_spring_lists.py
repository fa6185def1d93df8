"""All equilibria of general springs: proved to be all, or what could not be told apart in words."""

from __future__ import annotations

import functools
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from types import SimpleNamespace
from typing import Any, cast

import degenerate_springs
import numpy as np
import pytest
import spring_families
from commands import checked
from flint import acb, fmpz

from benchmarks.rates import spring_lists
from certreg import RegistrationProblem
from certreg.equilibrium.critical_set import Completeness, Critical
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.equilibrium.homotopy import proved_list
from certreg.equilibrium.line_boxes import BallQuartic, all_different, boxed, index_of
from certreg.equilibrium.line_set import (
    PRIMES,
    Finiteness,
    _rank_is_below,
    at_most_forty,
    infinitely_many,
    line_set,
    plane,
)
from certreg.equilibrium.methods import compare, search
from certreg.equilibrium.paths import critical_lines
from certreg.errors import ContradictionError
from certreg.objective.isotropic import Isotropic
from certreg.objective.normalisation import levelled_exactly, norm_fourth
from certreg.objective.quartics import MONOMIALS, gradient
from certreg.objective.springs import Springs
from certreg.problem.moments import exact_moments
from certreg.results import Guarantee

CLOUDS = (degenerate_springs.POINTS, np.asarray(degenerate_springs.isotropic().target))
HOMOTOPY = import_module("certreg.equilibrium.homotopy")
RANKS = import_module("certreg.equilibrium.line_set")


@functools.cache
def objective(name):
    """Of a degenerate configuration by name, or of a random problem by the number of its cell."""
    if isinstance(name, str):
        return Springs.of(degenerate_springs.NAMED[name]())
    made = spring_families.instance(spring_families.LISTED[name], 0)
    return Springs.of(RegistrationProblem(**spring_families.statement(made)))


@functools.cache
def listed(name) -> Any:
    return checked(search(objective(name), "homotopy").critical)


@pytest.mark.one_in(4)
@pytest.mark.parametrize(
    "cell", range(len(spring_families.LISTED)), ids=map(str, spring_families.LISTED)
)
def test_of_random_springs_all_forty_lines_are_proved_and_the_euler_sum_is_0(cell):
    found = listed(cell)

    assert found.completeness is Completeness.LINES
    assert len(found.components) + 2 * found.pairs == 40
    assert len(found.components) >= 4
    assert sum((-1) ** index for index in found.indices) == 0
    assert {0, 1, 2, 3} <= set(found.indices)
    assert found.guarantee is Guarantee.ENCLOSED
    values = [part.value for part in found.components]
    assert values == sorted(values)


def test_the_listed_rotations_are_critical_to_57_digits():
    found = listed(3)
    for part in found.components:
        q = part.quaternion
        slope = gradient(objective(3).quartic, q)
        along = sum(a * b for a, b in zip(q, slope, strict=True))
        across = max(
            abs(s * sum(c * c for c in q) - along * c) for s, c in zip(slope, q, strict=True)
        )
        assert across < abs(along) << 192 >> 175


# springs: ranks of the plane and h(7), lines told apart, real ones among them; None: no bound of 40
TABLE = {
    "wall": ((35, 60), Finiteness.SYMMETRIC, 0),
    "two walls": ((45, 40), Finiteness.FORTY, 40),
    "corner": ((45, 40), Finiteness.FORTY, 40),
    "sphere": ((45, 40), Finiteness.FORTY, 13),
    "cylinder": ((45, 40), Finiteness.FORTY, 37),
    "screw": ((44, 40), Finiteness.COMPLEX, None),
    "logarithm": ((44, 40), Finiteness.COMPLEX, None),
    "collinear": ((26, 76), Finiteness.SYMMETRIC, 0),
    "isotropic": ((28, 68), Finiteness.FOUR, None),
    "shared two": ((43, 40), Finiteness.COMPLEX, None),
    "shared three": ((45, 40), Finiteness.FORTY, 40),
    "five planes": ((41, 44), Finiteness.COMPLEX, None),
    "two lines": ((26, 76), Finiteness.SYMMETRIC, 0),
}


@pytest.mark.parametrize("name", TABLE)
def test_ranks_are_those_of_the_table(name):
    (of_plane, dimension), _, _ = TABLE[name]
    prime = PRIMES[0]
    minors = RANKS.minors_modulo(objective(name).quartic, prime)
    restricted = minors.astype(object) @ RANKS._restriction(3) % prime

    assert RANKS._dimension(minors, 7, prime) == dimension
    table = RANKS.products(restricted.astype(np.int64), 8, variables=3)
    assert RANKS._rank(table, prime) == of_plane


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.long) if n == "screw" else n for n in TABLE],
)
def test_a_list_is_complete_or_says_what_could_not_be_told_apart(name):
    _, finiteness, apart = TABLE[name]
    found = listed(name)
    separated = found.separated + 2 * found.pairs

    assert found.finiteness is finiteness
    assert found.complete == (apart == 40 or finiteness is Finiteness.FOUR)
    if apart is not None:
        assert separated == apart
    if not found.complete:
        assert finiteness.value in found.doubt
        assert found.count_complex is None
        if separated:
            assert f"{separated} " in found.doubt


def test_the_exact_fits_of_a_logarithm_are_a_curve():
    """Turns about the axis by the angles of (3, 4, 5), (5, 12, 13): by halves of them."""
    for q in ((1, 0, 0, 0), (2, 0, 0, 1), (3, 0, 0, 2), (0, 0, 0, 1)):
        assert objective("logarithm").energy(q) == 0
    assert objective("logarithm").energy((2, 1, 0, 0)) > 0


def test_of_springs_alike_in_every_way_four_equilibria_are_all():
    found, isotropic = listed("isotropic"), Isotropic(exact_moments(RegistrationProblem(*CLOUDS)))
    theirs = checked(search(isotropic, "spectral").critical)

    assert (found.completeness, found.count_complex) == (Completeness.SPECTRAL, None)
    assert found.indices == (0, 1, 2, 3)
    for part, other in zip(found.components, theirs.components, strict=True):
        assert part.value == pytest.approx(other.value, rel=1e-30)
        assert unit_double(part.quaternion) == pytest.approx(unit_double(other.quaternion))


def test_without_one_of_the_four_they_are_not_all(monkeypatch):
    usual = HOMOTOPY.proved_lines
    monkeypatch.setattr(HOMOTOPY, "proved_lines", lambda *given: usual(*given)[1:])
    found = checked(search(objective("isotropic"), "homotopy").critical)

    assert not found.complete


def test_the_multiple_minimum_of_a_sphere_is_listed_as_not_separated():
    first, *others = listed("sphere").components

    assert (first.guarantee, first.index) == (Guarantee.NUMERICAL, None)
    assert [part.index for part in others] == [1, 2, 3]
    assert "the other 27 meet" in listed("sphere").doubt


def quartic_of(coefficients):
    """Of a few monomials."""
    return [coefficients.get(monomial, 0) for monomial in MONOMIALS]


def fourth_powers(a):
    return quartic_of({(k,) * 4: entry for k, entry in enumerate(a)})


def test_forty_real_lines_are_proved_eight_of_them_minima():
    levelled = levelled_exactly(fourth_powers((10, 9, 7, 6)))
    lines = HOMOTOPY.proved_lines(BallQuartic(levelled), critical_lines(levelled.rest))

    assert len(lines) == 40
    assert all(line.is_real for line in lines)
    assert [index_of(line) for line in lines].count(0) == 8
    assert at_most_forty(fourth_powers((10, 9, 7, 6))) is not None


def test_planes_through_a_critical_line_prove_nothing():
    """Of a sum of fourth powers every coordinate plane holds lines."""
    proof = checked(at_most_forty(fourth_powers((10, 9, 7, 6))))

    assert proof.plane != plane(0)


def test_a_bound_of_forty_is_not_proved_of_a_constant_or_a_continuum():
    """The last: two equal fourth powers in two variables and none in the others."""
    for quartic in (norm_fourth().astype(int).tolist(), fourth_powers((1, 1, 0, 0))):
        assert at_most_forty(quartic) is None
        assert infinitely_many(quartic) == 7


@pytest.mark.slow
def test_finitely_many_are_never_called_infinitely_many():
    assert infinitely_many(objective(0).quartic) is None
    assert infinitely_many(objective("sphere").quartic) is None


def test_a_rank_that_is_lost_modulo_the_first_prime_is_not_lost_over_q(monkeypatch):
    """Coefficients that vanish modulo the prime: over Q the bound stands."""
    quartic = [entry * PRIMES[0] for entry in fourth_powers((10, 9, 7, 6))]

    assert checked(at_most_forty(quartic)).prime == PRIMES[1]
    assert infinitely_many(quartic) is None
    monkeypatch.setattr(RANKS, "PRIMES", PRIMES[:1])
    assert at_most_forty(quartic) is None


def test_dimensions_are_asked_for_up_to_the_highest_degree(monkeypatch):
    degrees = list[int]()

    def forty(_: Any, degree: int, __: int) -> int:
        degrees.append(degree)
        return 40

    monkeypatch.setattr(RANKS, "_dimension", forty)
    assert infinitely_many(fourth_powers((10, 9, 7, 6))) is None
    assert degrees == [7, 8, 9, 10]


def test_a_double_line_is_never_boxed():
    """w^4 + 2 x^4 has none with y or z, where it is flat: the line e_3 is critical and multiple."""
    levelled = levelled_exactly(fourth_powers((1, 2, 0, 0)))

    assert boxed(BallQuartic(levelled), [0.0, 0.0, 1.0, 0.0], real=True) is None


def test_boxes_of_one_line_are_not_different():
    levelled = levelled_exactly(fourth_powers((10, 9, 7, 6)))
    quartic = BallQuartic(levelled)
    one, again, other = (
        checked(boxed(quartic, q, real=True))
        for q in ([1.0, 1e-9, 0.0, 0.0], [1.0, 0.0, 1e-9, 0.0], [0.0, 1.0, 0.0, 0.0])
    )

    assert not all_different([one, again])
    assert all_different([one, other])


def test_a_line_counts_once_where_two_paths_end_at_it(monkeypatch):
    """As if the path to a real line had gone astray: the list is not complete."""
    usual = HOMOTOPY.critical_lines

    def astray(quartic):
        found = usual(quartic)
        first, second, *_ = np.flatnonzero(np.linalg.norm(found.points.imag, axis=1) < 1e-9)
        found.points[first] = found.points[second]
        return found

    monkeypatch.setattr(HOMOTOPY, "critical_lines", astray)
    found: Any = checked(search(objective(3), "homotopy").critical)

    assert not found.complete
    assert found.finiteness is Finiteness.FORTY
    assert len(found.components) == len(listed(3).components) - 1


def test_an_energy_that_is_constant_has_every_rotation():
    springs = Springs.of(
        RegistrationProblem(np.zeros((2, 3)), np.eye(3)[:2], factors=np.eye(6)[[0, 0]])
    )
    found = checked(search(springs, "homotopy").critical)

    assert found.completeness is Completeness.CONSTANT
    assert found.pattern == (4,)


def by_elimination(name) -> Any:
    return checked(search(objective(name), "groebner").critical)


SAMPLE = [pytest.param(k, marks=pytest.mark.long) for k in (0, 2, 6)]


@pytest.mark.slow
@pytest.mark.parametrize("cell", [11, *SAMPLE])
def test_elimination_finds_the_same_equilibria_without_paths_and_boxes(cell, monkeypatch):
    by_paths = listed(cell)
    monkeypatch.setattr(HOMOTOPY, "critical_lines", None)
    found = by_elimination(cell)
    agreement = compare([by_paths, found])

    assert found.completeness is Completeness.LINES
    assert (found.pairs, found.tied) == (by_paths.pairs, by_paths.tied)
    assert agreement.angle < 1e-18
    assert agreement.energy < 1e-30


def test_elimination_says_why_it_has_no_list():
    for name, finiteness in (("wall", Finiteness.SYMMETRIC), ("isotropic", Finiteness.FOUR)):
        made = search(objective(name), "groebner")
        assert made.critical is None
        assert finiteness.value in checked(made.reason)


@pytest.mark.slow
def test_elimination_knows_that_lines_meet():
    made = search(objective("sphere"), "groebner")

    assert made.critical is None
    assert "the dimension 40, counted with multiplicity" in checked(made.reason)


def test_equal_energies_in_another_order_agree_and_another_rotation_does_not():
    found = listed(0)
    swapped = replace(
        found, components=(found.components[1], found.components[0], *found.components[2:])
    )
    turned = replace(found.components[0], span=((1 << 192, 0, 0, 0),))

    assert found.tied > 1
    assert compare([found, swapped]).angle < 1e-25
    for other in (
        replace(found, components=(turned, *found.components[1:])),
        replace(found, components=found.components[:-1]),
        replace(found, components=(*found.components[:-1], replace(found.components[-1], index=0))),
    ):
        with pytest.raises(ContradictionError):
            compare([found, other])


@pytest.mark.slow
def test_rates_of_lists_are_those_of_the_script():
    rate = spring_lists.rate_of(spring_families.LISTED[10], 2)

    assert (rate.complete, rate.wrong) == (2, 0)
    assert "2 of 2 proved complete" in str(rate)


@pytest.mark.slow
def test_forty_boxes_without_the_ranks_are_no_complete_list(monkeypatch):
    module = import_module("certreg.equilibrium.line_set")
    monkeypatch.setattr(module, "at_most_forty", lambda _: None)
    found: Any = checked(search(objective(3), "homotopy").critical)

    assert (found.finiteness, found.complete) == (Finiteness.UNDECIDED, False)
    assert len(found.components) + 2 * found.pairs == 40
    assert (found.count_complex, found.tied) == (None, 0)


def test_a_line_and_its_conjugate_are_one_pair():
    levelled = levelled_exactly(objective(3).quartic)
    quartic, ends = BallQuartic(levelled), critical_lines(levelled.rest).points
    q = ends[np.argmax(np.linalg.norm(ends.imag, axis=1))]
    pair = [checked(boxed(quartic, each.tolist(), real=False)) for each in (q, q.conj())]

    assert not all_different(pair)
    assert not any(line.is_real for line in pair)


def twins_of_springs(off: float) -> Springs:
    """Half a turn of the source about z exchanges pairs of one target each, but for one number."""
    rng = np.random.default_rng(0)
    x, y, normals = rng.integers(-5, 6, (3, 6, 3)).astype(float)
    y[0], normals[0] = [0.0, 3.0, 1.0], [1.0, 2.0, -1.0]
    target = np.vstack([y, y])
    target[0, 0] = off
    source = np.vstack([x, x * [-1.0, -1.0, 1.0]])
    stated = RegistrationProblem(source, target, normals=np.vstack([normals, normals]))
    return Springs.of(stated)


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [20, 100, 400])
def test_the_first_of_a_list_is_the_best_however_little_the_next_costs_more(exponent: int):
    """The sign of the number says which of two rotations, half a turn apart, is the better one."""
    one, other = (proved_list(twins_of_springs(sign * 2.0**-exponent)) for sign in (1, -1))
    first, second = (unit_double(part.quaternion) for part in one.components[:2])

    assert (one.tied, other.tied) == (1, 1)
    np.testing.assert_allclose(unit_double(other.components[0].quaternion), second, atol=1e-4)
    np.testing.assert_allclose(unit_double(other.components[1].quaternion), first, atol=1e-4)


@pytest.mark.slow
def test_two_of_one_energy_tie():
    assert proved_list(twins_of_springs(0.0)).tied == 2


def test_a_rank_over_the_rationals_is_not_that_of_one_prime():
    """Multiples of the largest primes below 2^62 vanish modulo these."""
    found, prime = list[int](), 1 << 62
    while len(found) < 3:
        prime -= 1
        if fmpz(prime).is_prime():
            found.append(prime)
    first, second, third = found
    for entry, zero in ((first, False), (first * second, False), (0, True)):
        table = np.array([[1, 1], [1, 1 + entry]], dtype=object)
        assert _rank_is_below(table, 2) is zero
    assert not _rank_is_below(np.array([[first * second * third]], dtype=object), 1)
    assert _rank_is_below(np.array([[3, 6], [1, 2]], dtype=object), 2)


@pytest.mark.parametrize(("complete", "tied"), [(True, 2), (False, 0)])
def test_how_many_tie_is_told_of_a_whole_list_alone(complete, tied: int):
    part = Critical(
        quaternion=(1, 0, 0, 0),
        span=((1, 0, 0, 0),),
        value=Fraction(0),
        index=0,
        guarantee=Guarantee.ENCLOSED,
    )
    pairs = 18 if complete else 17
    found = line_set("one", [part] * 4, finiteness=Finiteness.FORTY, pairs=pairs, tied=2)

    assert (found.complete, found.tied) == (complete, tied)
    for many, finiteness in ((4, Finiteness.COMPLEX), (3, Finiteness.FORTY), (4, Finiteness.FOUR)):
        listed = line_set("one", [part] * many, finiteness=finiteness, pairs=18, tied=1)
        assert not listed.complete
    four = [
        line_set("one", [part] * k, finiteness=Finiteness.FOUR, pairs=(4 - k) // 2, tied=1)
        for k in (4, 2)
    ]
    assert [each.complete for each in four] == [True, False]


def test_a_line_and_its_conjugate_are_found_twice():
    line, other = (
        SimpleNamespace(is_real=False, quaternion=(acb(1), acb(0, sign), acb(2, sign), acb(0)))
        for sign in (1, -1)
    )
    third = SimpleNamespace(is_real=False, quaternion=(acb(1), acb(0, 2), acb(2, 1), acb(0)))

    assert all_different(cast("Any", [line]))
    assert not all_different(cast("Any", [line, other]))
    assert all_different(cast("Any", [line, third]))
