"""Pairs with bounds: each exact inequality on both sides of equality, in small integers."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.certificate import cones, many, squares
from certreg.certificate.cones import RANGES, CappedMinimum, _curvature, _width
from certreg.certificate.consensus import (
    ConsensusSimilarityBody,
    Piece,
    ScaledWitness,
    ScaleRange,
    Witness,
)
from certreg.certificate.consistency import ConsistentPairs, ExactRows, _at_most
from certreg.certificate.joint_feasibility import is_refuted
from certreg.certificate.listing import SECOND_BITS, _below, quaternion_product
from certreg.certificate.many import _angles
from certreg.certificate.producing_consensus import ProvedConsensus, reach_of
from certreg.certificate.proof_stages import Stager
from certreg.certificate.vertex_elimination import GraphThinning, transversal
from certreg.exact.dyadic import Dyadic, double_above, dyadic_above, dyadic_below, half_angle_bound
from certreg.exact.elimination import rank
from certreg.geometry.so3 import rotation_matrix
from certreg.objective.normalisation import MONOMIALS, levelled_exactly
from certreg.problem.bounds import bounded
from certreg.problem.losses import Consensus
from certreg.problem.problem import RegistrationProblem
from certreg.verify import OPEN, SAME

LITTLE = Fraction(1, 10**30)
PLACES = 10**40
LENGTHS = list(product(range(5), range(5), range(3), range(3), (0, 1)))


def root(square: Fraction) -> Fraction:
    """Within 1e-40, and exact of perfect squares."""
    return Fraction(math.isqrt(square.numerator * PLACES**2 // square.denominator), PLACES)


def pair(a: int, b: int, i: int, j: int, across: int) -> list[tuple[int, ...]]:
    return [(1, 2, 3, -1, 0, 0, i), (1 + a, 2 + across, 3, -1, b, 0, j)]


def exact_rows(rows: list[tuple[int, ...]], exponent: int = 0) -> Any:
    return SimpleNamespace(rows=rows, exponent=exponent)


def test_two_pairs_agree_where_their_lengths_differ_by_their_bounds_at_most():
    for case in LENGTHS:
        a, b, i, j, across = case
        apart = abs(root(Fraction(a * a + across)) - b)

        assert ExactRows.agree(exact_rows(pair(*case)), 0, 1) == (apart <= i + j), case


@pytest.mark.parametrize("d", [0, 1, 2, 3])
def test_two_pairs_agree_up_to_their_bounds_where_their_lengths_are_irrational(d: int):
    for A, B in product([(0, 0, 0), (1, 1, 0), (2, 1, 1), (1, 1, 1), (3, 1, 0)], repeat=2):
        rows = [(0,) * 7, (*A, *B, d)]
        apart = abs(root(Fraction(sum(k * k for k in A))) - root(Fraction(sum(k * k for k in B))))

        assert ExactRows.agree(exact_rows(rows), 0, 1) == (apart <= d), (A, B)


def test_two_pairs_agree_between_two_scales():
    for case in LENGTHS:
        a, b, i, j, across = case
        length = root(Fraction(a * a + across))
        for low, high in (
            (Fraction(1, 2), Fraction(2)),
            (Fraction(0), Fraction(1)),
            (Fraction(2), None),
        ):
            agree = ExactRows.agree(exact_rows(pair(*case)), 0, 1, ScaleRange(low, high))
            over = high is None or b <= high * length + i + j

            assert agree == (low * length <= b + i + j and over), case


def test_a_root_is_at_most_another_and_a_length():
    for A, B, d in product(range(12), range(12), range(4)):
        assert _at_most(Fraction(A), Fraction(B), d) == (root(Fraction(A)) <= root(Fraction(B)) + d)


TURN = (1, 1, 0, 0)  # a quarter about x: (a, b, c) to (a, -c, b)


@pytest.mark.parametrize(("exponent", "shift"), [(0, 0), (3, 1), (1, 3), (-2, -1)])
def test_a_motion_meets_pairs_up_to_their_bounds(exponent: int, shift: int):
    """(8, 16, 32) is turned to (8, -32, 16) and moved by (8, 0, 0): off by (2, 3, 6)."""
    rows = exact_rows([(8, 16, 32, 18, -29, 22, bound) for bound in (6, 7, 8)], exponent)
    witness: Any = SimpleNamespace(
        quaternion=TURN,
        shift=(int(8 * 2.0 ** (exponent - shift)), 0, 0, shift),
        scale=Fraction(1),
    )

    assert ExactRows.met_by(rows, witness, [0, 1, 2]) == [1, 2]
    assert ExactRows.met_by(rows, witness, [2, 0]) == [2]
    assert ExactRows.met_by(rows, witness, []) == []


@pytest.mark.parametrize("factor", [Fraction(3), Fraction(1, 2), Fraction(5, 4)])
def test_a_scaled_motion_meets_pairs_up_to_their_bounds(factor: Fraction):
    n, d = factor.numerator, factor.denominator
    far = (8 * n // d + 2, -32 * n // d + 3, 16 * n // d + 6)
    rows = [(8, 16, 32, *far, bound) for bound in (6, 7, 8)]
    witness: Any = SimpleNamespace(
        quaternion=TURN,
        shift=(0, 0, 0, 0),
        scale=factor,
    )

    assert ExactRows.met_by(exact_rows(rows), witness, [0, 1, 2]) == [1, 2]


def test_two_pairs_are_refuted_by_weights_where_their_lengths_differ_by_more_than_both_bounds():
    """Of lengths a and b and equal weights: (a - b)^2 / 2 > 2 e^2."""
    for a, b, e in product(range(7), range(7), range(1, 4)):
        rows = [(0, 0, 0, 5, 1, 0, e), (a, 0, 0, 5, 1 + b, 0, e)]
        assert is_refuted(rows, [1, 1]) == ((a - b) ** 2 > 4 * e * e), (a, b, e)
        assert is_refuted(rows, [3, 3]) == ((a - b) ** 2 > 4 * e * e)


@pytest.mark.parametrize("signs", [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])
def test_four_pairs_are_refuted_where_the_best_fit_is_worse_than_their_bounds(signs):
    source = [(2, 0, 1), (-2, 1, 0), (0, 2, -1), (3, -3, 2)]
    target = (np.array([(5, 1, 0), (-4, 2, 2), (1, 5, 1), (2, -3, 7)]) * signs).tolist()
    weights = [2, 3, 1, 1]
    x, y, w = (np.array(part, dtype=float) for part in (source, target, weights))
    x, y = (p - w @ p / w.sum() for p in (x, y))
    values = np.linalg.svd((y * w[:, None]).T @ x)
    d = values[1] * [1, 1, np.sign(np.linalg.det(values[0] @ values[2]))]
    least = (w[:, None] * (x * x + y * y)).sum() - 2 * d.sum()
    for bounds in product((1, 2, 3), repeat=4):
        rows = [(*p, *q, e) for p, q, e in zip(source, target, bounds, strict=True)]
        allowed = sum(k * e * e for k, e in zip(weights, bounds, strict=True))

        assert is_refuted(rows, weights) == (least > allowed), bounds


def test_a_transversal_is_found_where_there_is_one():
    masks = [1, 2, 3, 5, 6, 9]
    for count in range(4):
        for sets in product(masks, repeat=count):
            sizes = [row.bit_count() for row in range(16) if all(row & mask for mask in sets)]
            for most in range(4):
                found = transversal(list(sets), most)

                assert (found is not None) == (min(sizes) <= most)
                assert found is None or all(found & mask for mask in sets)
                assert found is None or found.bit_count() <= most


def test_a_thinning_is_closed_without_open_rows_or_with_too_few():
    for alive, clique, least in product(range(8), range(8), range(4)):
        left = SimpleNamespace(alive=alive)
        of: Any = SimpleNamespace(left=left, clique=clique, least=least)
        flag: Any = GraphThinning.closed
        closed = flag.fget(of)

        assert closed == (alive & ~clique == 0 or alive.bit_count() < least)


@pytest.mark.parametrize("whole", [False, True])
def test_no_motion_meets_more_than_the_least_number_with_too_few_rows_left(whole):
    for met, proves_from, rows in product((1, 2, 3), range(1, 8), (3, 5, 6)):
        asked = list[int]()

        def stage(
            stages: list[Any], _: int, least: int, __: int, most: int = proves_from, asked=asked
        ) -> int:
            asked.append(least)
            stages.append(least)
            return (1 << least - (least > most)) - 1

        stager: Any = SimpleNamespace(met=list(range(met)), stage=stage)
        stages: list[Any] = [0]
        alive = (1 << rows) - 1
        upper = Stager.upper(stager, stages, alive, whole=whole)
        true = max(met, min(proves_from, rows))
        first = met if met >= proves_from else rows

        assert upper == (true if whole else min(first, rows))
        assert stages == ([0] if upper == rows else [0, upper + 1])
        assert not asked or asked[0] == met + 1


def test_a_number_below_is_below_for_either_sign():
    for value in (Fraction(1, 3), Fraction(5), Fraction(2, 7) * 10**30):
        assert _below(value) == dyadic_below(value, SECOND_BITS)
        assert -_below(-value).value == dyadic_above(value, SECOND_BITS).value
        assert _below(-value).value <= -value
    assert _below(Fraction(0)).pair == [0, 0]


@pytest.mark.parametrize("curvature", [None, Fraction(0), Fraction(2)])
def test_a_minimum_in_a_cap_is_lower_by_slope_over_curvature(curvature: Any):
    minimum = CappedMinimum(
        quaternion=(1, 0, 0, 0), value=Fraction(7), slope=Fraction(3), curvature=curvature
    )

    assert minimum.floor == (Fraction(11, 2) if curvature else 7)


def test_the_width_of_a_quartic_is_above_its_range():
    rng = np.random.default_rng(1)
    for _ in range(3):
        quartic = rng.integers(-9, 10, size=35).tolist()
        integers = levelled_exactly(quartic).integers
        sizes = [
            RANGES[tuple(sorted((m.count(k) for k in range(4)), reverse=True))] for m in MONOMIALS
        ]

        expected = sum(abs(e) * s for e, s in zip(integers, sizes, strict=True)) / 24
        assert _width(quartic) == expected


def test_the_range_of_a_monomial_is_as_wide_as_said_or_little_less():
    """On the unit sphere x^a y^b ... is at most the product of (a/4)^(a/2); its square is rational.

    At least 0, or, where a power is odd, as much below it. Only of q_i^3 q_j, whose range is
    no rational number, a larger one is said.
    """
    for powers, said in RANGES.items():
        sides = 2 if any(k % 2 for k in powers) else 1
        square = sides**2 * math.prod((Fraction(k, 4) ** k for k in powers), start=Fraction(1))

        assert said**2 == square * (Fraction(4, 3) if 3 in powers else 1)


def test_a_turn_moves_every_rotation_where_no_quaternion_stands_still():
    """Where q -> a q + q b has a determinant other than 0; of a alone, of b alone, of both."""
    for turns in product((-1, 0, 2), repeat=6):
        a, b = (0, *turns[:3]), (0, *turns[3:])
        columns = [
            [k + m for k, m in zip(quaternion_product(a, e), quaternion_product(e, b), strict=True)]
            for e in np.eye(4, dtype=int).tolist()
        ]

        assert squares._moves_all(turns) == (rank(columns) == 4)


def test_a_curvature_is_proved_a_little_below_the_least_eigenvalue():
    def curvature(*diagonal: int, over: int = 2, width: Fraction = Fraction(3)) -> Any:
        bend = [[k * (i == j) for j in range(3)] for i, k in enumerate(diagonal)]
        return _curvature(bend, over, width)

    found = curvature(3, 5, 4)
    assert Fraction(3, 2) * (1 - Fraction(2, 2**10)) < found < Fraction(3, 2)
    assert found == Fraction(0.5 * (1 - 2.0**-10)) * 3
    assert curvature(0, 5, 4) is curvature(-3, 5, 4) is None
    assert curvature(3, 5, 4, width=Fraction(0)) is None


def test_a_curvature_that_is_too_small_or_found_too_large_is_none(monkeypatch):
    bend = [[3, 0, 0], [0, 5, 0], [0, 0, 4]]
    least = 0.5 * (1 - 2.0**-10)
    monkeypatch.setattr(cones, "LEAST_CURVATURE", least)
    assert _curvature(bend, 2, Fraction(3)) is None
    monkeypatch.setattr(cones, "LEAST_CURVATURE", math.nextafter(least, 0.0))
    assert _curvature(bend, 2, Fraction(3)) is not None
    monkeypatch.setattr(np.linalg, "eigvalsh", lambda _: np.array([0.51]))
    assert _curvature(bend, 2, Fraction(3)) is None


def piece(state: str, end: int | None) -> tuple[str, Piece]:
    return state, Piece(end=None if end is None else Dyadic(mantissa=end, exponent=0), stages=())


def test_pairs_are_met_elsewhere_where_their_scales_are_in_no_open_range():
    def elsewhere(low: int, high: int, *pieces: tuple[str, Piece]) -> bool:
        body = SimpleNamespace(
            scales=(Fraction(low), Fraction(high)),
            pieces=[piece for _, piece in pieces],
            states="".join(state for state, _ in pieces),
        )
        kind: Any = ConsensusSimilarityBody.met_elsewhere
        return kind.fget(body)

    pieces = piece(SAME, 2), piece(OPEN, 5), piece(SAME, None)
    for low, high in product(range(1, 7), repeat=2):
        assert elsewhere(low, high, *pieces) == (not (low >= 2 and high <= 5))
        last = piece(SAME, 3), piece(OPEN, None)
        assert elsewhere(low, high, *last) == (low < 3)
        assert not elsewhere(low, high, piece("x", 3), piece(OPEN, None))
        two = piece(OPEN, 2), piece(SAME, 3), piece(OPEN, None)
        assert elsewhere(low, high, *two) == (low < 3 and high > 2)
        assert elsewhere(low, high, piece(SAME, None))


def test_angles_of_many_are_those_of_one(monkeypatch):
    steep = [0.75, 0.875, 0.9375, 0.99609375, 1.0 - 2.0**-31]
    values = [0.0, 1e-300, 0.25, 0.5, *steep, 1.0, 2.0]
    monkeypatch.setattr(many, "_doubles", np.array)
    optima: Any = SimpleNamespace(sine=values)

    assert _angles(optima).tolist() == [half_angle_bound(Fraction(sine)) for sine in values]


def test_a_motion_meets_exactly_the_pairs_up_to_their_bounds_whatever_doubles_say():
    """Each is off by (2, 3, 6), of length 7; doubles are off by 1e-11 of the rotated points."""
    q = (1, 2, 3, 4)
    source = 30 * np.random.default_rng(5).integers(-9999, 9999, (40, 3))
    turn = np.array(rotation_matrix(q))
    target = source @ turn.T // 30 + [2, 3, 6]
    bounds = np.array([7.0, math.nextafter(7.0, 0.0)] * 20)
    problem = bounded(RegistrationProblem(source, target), bounds)
    witness = Witness(quaternion=q, shift=(0, 0, 0, 0))

    assert (source @ turn.T % 30 == 0).all()
    assert ConsistentPairs.of(problem).met_by(witness) == list(range(0, 40, 2))


def met_in_fractions(problem: RegistrationProblem, witness: Witness) -> list[int]:
    """By the definition."""
    block, norm = problem.block(slice(None)), sum(k * k for k in witness.quaternion)
    turn = [[Fraction(k, norm) for k in row] for row in rotation_matrix(list(witness.quaternion))]
    *shift, exponent = witness.shift
    x, y, bounds = (part.tolist() for part in (block.source, block.target, problem.bounds))
    met = list[int]()
    for place, (here, there, bound) in enumerate(zip(x, y, bounds, strict=True)):
        square = Fraction(0)
        for own, to, moved in zip(turn, there, shift, strict=True):
            turned = witness.scale * sum(a * Fraction(b) for a, b in zip(own, here, strict=True))
            square += (Fraction(to) - turned - moved * Fraction(2) ** exponent) ** 2
        if square <= Fraction(bound) ** 2:
            met.append(place)
    return met


@pytest.mark.parametrize("unit", [-300, -3, 0, 40, 300])
@pytest.mark.parametrize("far", [0, 30])
@pytest.mark.parametrize("scale", ["none", "asymmetric"])
def test_who_is_met_is_who_the_fractions_say_is_met(unit: int, far: int, scale: str):
    """Bounds from one a thousandth below the residual to three times it, in any unit."""
    rng = np.random.default_rng(unit + far + 400)
    q, shift = (3, -1, 4, 2), (5 << far, -7, 11 << far)
    source, off = rng.normal(size=(2, 42, 3))
    witness: Witness = Witness(quaternion=q, shift=(*shift, unit - 3))
    if scale == "asymmetric":
        witness = ScaledWitness(quaternion=q, shift=witness.shift, factor=Dyadic.of_pair([3, -1]))
    moved = float(witness.scale) * source @ np.array(rotation_matrix(q)).T / 30
    moved += [math.ldexp(k, -3) for k in shift]
    target = moved + off
    found = np.linalg.norm(target - moved, axis=1)
    bounds = found * np.tile([0.999, 1 - 1e-15, 1.0, 1 + 1e-15, 1.001, 1.5, 3.0], 6)
    points = RegistrationProblem(np.ldexp(source, unit), np.ldexp(target, unit), scale=scale)
    problem = points.under(Consensus(np.ldexp(bounds, unit)))
    met = ConsistentPairs.of(problem).met_by(witness)

    assert met == met_in_fractions(problem, witness)
    assert set(range(5, 42, 7)) <= set(met)
    assert set(range(0, 42, 7)).isdisjoint(met)


ULP = 2.0**-52
EDGES = [  # a shift, then points and a bound that doubles would judge wrongly
    ((-3, 0, 0, -53), (-ULP / 2, 0, 0), (1 + ULP, 0, 0), 1 + 3 * ULP),  # two ties rounded up
    ((1, 1, 0, 0), (0, 0, 0), (0, 0, 0), math.sqrt(2)),  # the root, rounded up
    ((0, 0, 0, 0), (0, 0, 0), (0, 0, 0), 5e-324),  # beside a size of 4 it is lost
]


@pytest.mark.parametrize(("shift", "x", "y", "bound"), EDGES)
def test_a_pair_is_met_at_a_bound_of_which_rounding_shows_less(shift, x, y, bound):
    others = np.array([[4.0, 0, 0], [0, 4, 0]]) if bound < 1 else np.zeros((2, 3))
    points = RegistrationProblem(np.vstack([[x], others]), np.vstack([[y], others]))
    for least in (bound, math.nextafter(bound, 0.0)):
        problem = points.under(Consensus(np.full(3, least)))
        witness = Witness(quaternion=(1, 0, 0, 0), shift=shift)
        met = ConsistentPairs.of(problem).met_by(witness)

        assert met == met_in_fractions(problem, witness)
        assert (0 in met) == (least == bound or bound < 1)


def test_a_met_row_is_an_inlier_where_fewer_rows_than_are_met_are_left_without_it():
    for lefts in product((2, 3, 4), repeat=3):

        def stage(_: Any, alive: int, least: int, clique: int, row: int, lefts=lefts) -> int:
            assert least == 3
            assert not (alive | clique) >> row & 1
            return (1 << lefts[row]) - 1

        stager: Any = SimpleNamespace(met=[0, 1, 2], graph=SimpleNamespace(effort=1.0), stage=stage)
        sure = sum((left < 3) << row for row, left in enumerate(lefts))

        assert Stager.inliers(stager, [], 0b111111) == sure
        assert Stager.inliers(stager, [], 0b1111111) == 0


def test_of_two_proofs_the_better_one_meets_more_then_labels_more_then_has_the_lower_bound():
    """By all three numbers in that order, over every two of small ones."""
    cases = list(product((2, 3), ("io?", "i??", "???"), (3, 4)))
    for one, other in product(cases, repeat=2):
        better = [
            (one[0], -one[1].count("?"), -one[2]),
            (other[0], -other[1].count("?"), -other[2]),
        ]
        first, second = (
            ProvedConsensus(None, tuple(range(met)), labels, upper, (), "")  # type: ignore[arg-type]
            for met, labels, upper in (one, other)
        )

        assert (first.worth > second.worth) == (better[0] > better[1]), (one, other)


@pytest.mark.parametrize("level", [Fraction(k, 8) for k in range(-4, 45, 3)])
def test_motions_turn_from_the_first_eigenvector_by_two_eigenvalues_and_a_millionth(level):
    """2 K = diag(5, 1, 0, -6): p^T 2 K p >= c asks for sin^2 of at most (5 - c) / (5 - 1)."""
    first, second = Fraction(5), Fraction(1)
    reach = reach_of(np.diag([2.5, 0.5, 0.0, -3.0]), float(level), 8.0, (7, 0, 0, 0))
    least = (first - level) / (first - second)
    if not second < level < first:
        assert reach is None
        return
    assert reach is not None

    s, t = reach.sin2_half_angle.value, 8 * reach.tau.value
    assert least < s < least * (1 + Fraction(1, 10**5))
    assert t * s > first - level
    assert t * (1 - s) < level - second


@pytest.mark.parametrize(("least", "most"), [(-1115, -1040), (-1070, -990), (-40, 10), (970, 1030)])
def test_gaps_of_many_are_no_less_than_twice_what_is_proved_and_next_to_it(least: int, most: int):
    rng = np.random.default_rng(5)
    mantissas = rng.integers(2**31, 2**32, 400)
    delta = np.stack([mantissas, rng.integers(least, most, 400)], axis=1)
    optima: Any = SimpleNamespace(delta=delta)

    for gap, (mantissa, exponent) in zip(many._gaps(optima).tolist(), delta.tolist(), strict=True):
        above = double_above(2 * Fraction(mantissa) * Fraction(2) ** exponent)
        assert above <= gap <= math.nextafter(above, math.inf)
