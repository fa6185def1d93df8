from __future__ import annotations

import math
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from commands import checked
from flint import acb, acb_mat, arb, arb_mat, ctx

from certreg.equilibrium import line_boxes
from certreg.equilibrium.line_boxes import (
    BallMatrix,
    BoxedLine,
    Reality,
    RootBox,
    all_different,
    are_distinct,
    boxed,
    proved_root,
    tightened,
)
from certreg.equilibrium.torques import at_most_four, macaulay_matrix
from certreg.errors import ContradictionError
from certreg.exact.balls import exact_matrix, radius_bits
from certreg.geometry.so3 import davenport_matrix

C = [[3, 1, -2], [7, 2, 5], [0, -1, 4]]


def boxes_of(K, vectors) -> list[BoxedLine | None]:
    return [boxed(BallMatrix(K), v, real=True) for v in vectors]


def four(K) -> list[BoxedLine]:
    vectors = np.linalg.eigh(np.array(K, dtype=float))[1].T.tolist()
    return [checked(line) for line in boxes_of(exact_matrix(K, 0), vectors)]


def test_the_four_boxes_are_disjoint_real_and_narrow():
    lines = four(davenport_matrix(C))

    assert all(line.is_real for line in lines)
    assert all_different(lines)
    assert all(radius_bits(c) < -90 for line in lines for c in line.box.coordinates)


def test_the_box_holds_the_root_of_higher_precision():
    for line in four(davenport_matrix(C)):
        finer = line.within(600).box
        assert all(radius_bits(c) < -600 for c in finer.coordinates)
        pairs = zip(line.box.coordinates, finer.coordinates, strict=True)
        assert all(a.overlaps(b) for a, b in pairs)


def test_the_same_root_twice_is_not_two_roots():
    first, *others = four(davenport_matrix(C))

    assert not all_different([first, first])
    assert not all_different([first, *others, first])  # and not beside each other


def test_one_coordinate_that_is_not_real_is_enough():
    real, within, imaginary = acb(1, arb(0, 1e-9)), acb(arb(2, 1e-9)), acb(0, 1)

    assert RootBox(coordinates=(real, imaginary, within), bits=128).reality is Reality.NOT_REAL
    assert RootBox(coordinates=(real, within), bits=128).reality is Reality.UNKNOWN


def test_a_point_far_from_every_root_leads_to_one_or_to_none_but_never_to_a_false_box():
    K = davenport_matrix(C)
    values = np.linalg.eigvalsh(np.array(K, dtype=float))
    rng = np.random.default_rng(0)
    for q in rng.normal(size=(50, 4)).tolist():
        (line,) = boxes_of(exact_matrix(K, 0), [q])
        if line is not None:
            level = 2 * line.system.form.level(line.quaternion)
            distance = np.abs(values - float(level.mid())).min()
            assert distance < 1e-12 + float(level.rad())


@pytest.mark.parametrize("exponent", [3, 6, 9, 12, 40])
def test_close_roots_are_told_apart_with_exact_data(exponent):
    """Values 1, 0.3, 0.3 - gap, gap - 1.6, axes turned by an exact quarter in two planes."""
    unit = 10**exponent
    K = [[10 * unit, 0, 0, 0], [0, 3 * unit, 0, 0], [0, 0, 3 * unit - 10, 0], [0, 0, 0, -16 * unit]]
    K[0][0], K[0][3], K[3][0], K[3][3] = -3 * unit, 13 * unit, 13 * unit, -3 * unit
    s = 0.5**0.5
    vectors = [[s, 0, 0, s], [0, 1, 1e-3 * 0, 0], [0, 0, 1, 0], [s, 0, 0, -s]]
    lines = boxes_of(exact_matrix(K, (10 * unit).bit_length()), vectors)

    assert all_different([checked(line) for line in lines])


def test_a_continuum_gives_no_box_at_any_precision():
    K = [[3, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0], [0, 0, 0, -1]]
    vectors = [[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0.6, 0.8, 0], [0.01, 0.5, 0.1, 0.2]]
    boxes = boxes_of(exact_matrix(K, 2), vectors)

    assert boxes[0] is not None
    assert boxes[1:] == [None, None, None]


class Square:
    """x^2 = c in one unknown."""

    def __init__(self, c):
        self.c = c

    def values(self, x):
        return type(x)([[x[0, 0] * x[0, 0] - self.c]])

    def jacobian(self, x):
        return type(x)([[2 * x[0, 0]]])


def test_a_root_that_is_not_real_is_proved_not_to_be():
    box = proved_root(Square(-2), acb_mat([[acb(0, 1.414)]]))

    assert box is not None
    assert box.reality is Reality.NOT_REAL
    assert proved_root(Square(-2), arb_mat([[1.4]])) is None


def test_complex_arithmetic_alone_does_not_call_a_root_real():
    box = proved_root(Square(2), acb_mat([[acb(1.414, 1e-9)]]))

    assert box is not None
    assert box.reality is Reality.UNKNOWN
    assert checked(proved_root(Square(2), arb_mat([[1.414]]))).reality is Reality.REAL


def test_a_double_root_is_never_proved():
    assert proved_root(Square(0), arb_mat([[1e-9]])) is None


class Slope:
    """A function of one unknown with this slope everywhere."""

    def __init__(self, slope):
        self.slope = slope

    def values(self, x):
        return type(x)([[self.slope * x[0, 0]]])

    def jacobian(self, x):
        return type(x)([[self.slope]])


def test_a_box_whose_image_touches_its_edge_proves_nothing():
    """Newton's step is 2^-64 upwards, the box five times as wide, the image four times as wide."""
    step, touching = arb(2) ** -64, 0
    with ctx.workprec(128):
        for nudge in range(64):  # so that balls, whose radii have 30 bits, come out at the edge
            k = (arb(8) / 10).mid() - arb(nudge) * arb(2) ** -33
            slope = (1 - k).mid()
            image = 1 + step + (1 - slope) * arb(0, 5 * step)
            box = arb(1, 5 * step)
            inside = line_boxes._krawczyk(
                Slope(slope), arb_mat([[1]]), arb_mat([[1]]), arb_mat([[-step]])
            )
            touching += box.contains(image) and not box.contains_interior(image)

            assert (inside is not None) == box.contains_interior(image)
    assert touching


def test_without_the_interior_condition_a_box_without_root_would_pass(monkeypatch):
    """x^2 = -2 has no real root; each ball passes if containment is not asked for."""
    assert proved_root(Square(-2), arb_mat([[1.0]]), max_bits=256) is None
    monkeypatch.setattr("builtins.all", lambda _: True)
    assert proved_root(Square(-2), arb_mat([[1.0]])) is not None


def test_the_matrix_of_the_count_has_full_rank_exactly_where_the_values_are_distinct():
    assert at_most_four(C) is not None
    assert at_most_four([[0] * 3] * 3) is None
    assert at_most_four([[2, 0, 0], [0, 2, 0], [0, 0, 1]]) is None
    half_turn = at_most_four([[-1, 0, 0], [0, -2, 0], [0, 0, -3]])
    assert half_turn is not None
    assert half_turn.chart != (1, 0, 0, 0)
    assert len(macaulay_matrix(C, (1, 0, 0, 0))) == 10


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("order", [(0, 1, 2), (1, 2, 0), (2, 0, 1)])
@pytest.mark.parametrize("kind", ["axes", "turns"])
def test_the_count_is_proved_where_an_equilibrium_lies_in_the_planes_of_few_charts(
    kind, order, sign
):
    """Eigenvectors e_i + e_j and e_i - e_j for two imaginary units, or for 1 and one of them."""
    plane = ((1, 0, 2 * sign), (0, 5, 0), (2 * sign, 0, 1))
    about = ((2, 0, 0), (0, 2, -3 * sign), (0, 3 * sign, -2))
    C = plane if kind == "axes" else about
    turned = [[C[i][j] for j in order] for i in order]

    assert at_most_four(turned) is not None


def test_balls_keep_exact_integers_exact():
    big = 3**500
    matrix = exact_matrix([[big, 1], [1, -big]], 10)

    assert matrix[0, 0].is_exact()
    assert matrix[0, 0] * 1024 - arb(big) in (0, arb(0)) or radius_bits(matrix[0, 0]) < -1000


def test_a_proved_root_that_is_lost_is_told_with_the_bits_that_were_asked_for(monkeypatch):
    line, *_ = four(davenport_matrix(C))
    asked = list[tuple[int, int]]()

    def lost(*_: object, start_bits: int, max_bits: int) -> None:
        asked.append((start_bits, max_bits))

    monkeypatch.setattr(line_boxes, "proved_root", lost)
    with pytest.raises(ContradictionError, match="smaller box") as caught:
        tightened(line.system, line.box, 600)

    assert asked == [(1200, 4800)]
    assert (caught.value.methods, caught.value.limit) == (("homotopy",), 600)


def test_a_box_that_is_small_enough_is_kept_as_it_is():
    line, *_ = four(davenport_matrix(C))
    system, box = line.system, line.box
    widest = max(radius_bits(ball) for ball in box.coordinates)

    assert tightened(system, box, -widest - 1) is box
    assert tightened(system, box, -widest) is not box


def test_where_every_point_is_a_root_no_box_holds_exactly_one():
    """The image of a box is the box, which is not its interior."""

    class Nothing:
        def values(self, x: Any) -> Any:
            return 0 * x

        def jacobian(self, x: Any) -> Any:
            return arb_mat(x.nrows(), x.nrows())

    x, one = arb_mat(2, 1, [0, 0]), arb_mat(2, 2, 1)

    assert line_boxes._krawczyk(Nothing(), x, one, 0 * x) is None


@pytest.mark.parametrize("place", [0, 2])
def test_one_coordinate_that_is_not_real_is_enough_and_a_ball_about_0_is_none(place: int):
    for part, reality in (
        (arb(1, 0.5), Reality.NOT_REAL),
        (arb(1, 1), Reality.UNKNOWN),
        (arb(0), Reality.UNKNOWN),
    ):
        balls = [acb(2, arb(0, 1)) for _ in range(3)]
        balls[place] = acb(2, part)
        assert RootBox(coordinates=tuple(balls), bits=53).reality is reality


def test_lines_are_different_where_a_minor_is_not_zero_for_certain():
    one = tuple(map(arb, (1, 2, 3, 4)))
    for last, distinct in ((arb(4.5, 0.25), True), (arb(4.5, 0.5), False), (arb(8), True)):
        assert are_distinct([one, (arb(1), arb(2), arb(3), last)]) is distinct
    assert not are_distinct([one, tuple(map(arb, (2, 4, 6, 8)))])


class Half:
    """Functions whose slope is 1/2 each: about a point the image is half as wide as the box."""

    def values(self, x: Any) -> Any:
        return x / 2

    def jacobian(self, x: Any) -> Any:
        return arb_mat(x.nrows(), x.nrows(), 1) / 2


@pytest.mark.parametrize(
    ("x", "step", "bits", "half"),
    [
        ((40, None), (None, None), 128, 40 - 64 - 1),  # beside the largest coordinate
        ((-300, None), (None, None), 128, -300 - 64 - 1),
        ((None, None), (None, None), 128, -64 - 1),  # beside 1 at zero
        ((None, None), (None, None), 127, -63 - 1),
        ((None, None), (-20, None), 128, -18 - 1),  # four times the largest step
    ],
)
def test_a_box_is_as_wide_as_its_largest_step_and_the_last_half_of_its_bits(x, step, bits, half):
    def column(exponents: tuple[int | None, ...]) -> arb_mat:
        return arb_mat(2, 1, [0 if e is None else arb(2) ** e for e in exponents])

    with ctx.workprec(bits):
        one = arb_mat(2, 2, 1)
        image = line_boxes._krawczyk(Half(), column(x), one, column(step))
        for ball in checked(image).entries():
            assert float(ball.rad() / arb(2) ** half) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize(("most", "tried"), [(128, 1), (255, 1), (256, 2), (1024, 4)])
def test_the_bits_are_doubled_up_to_the_most_and_no_further(most: int, tried: int):
    asked = list[int]()

    class Flat(Square):
        def jacobian(self, x: Any) -> Any:
            asked.append(ctx.prec)
            return arb_mat([[0]])

    assert proved_root(Flat(2), arb_mat([[1]]), start_bits=128, max_bits=most) is None
    assert asked == [128 << k for k in range(tried)]


@pytest.mark.parametrize(("root", "start"), [(3, 2.9), (-3, -3.2), (0.5, 0.4), (-0.5, -0.6)])
def test_a_box_holds_the_rational_root_beside_it_and_not_the_other(root: float, start: float):
    (ball,) = checked(proved_root(Square(root * root), arb_mat([[start]]))).coordinates

    assert ball.contains(arb(root))
    assert not ball.contains(arb(-root))


def test_the_count_is_proved_where_equilibria_lie_in_the_planes_of_the_first_four_charts():
    """K = sum of a v v^T / |v|^2; the first two v are 0 at (1, t, t^2, t^3) for t = 0, 1 and 2, 3.

    K is 4 times |v|^2 of all v, less a multiple of 1 for which its trace is 0.
    """
    vectors = [(0, 1, -1, 0), (66, -19, -19, 6), (1, 3, 3, 8)]
    assert all(np.dot(v, w) == 0 for v, w in combinations(vectors, 2))
    norms = [int(np.dot(v, v)) for v in vectors]
    whole = math.prod(norms)
    K = np.zeros((4, 4), dtype=object)
    for value, v, norm in zip((3, 5, 9), vectors, norms, strict=True):
        K += 4 * value * whole // norm * np.outer(v, v).astype(object)
    K -= K.trace() // 4 * np.eye(4, dtype=int).astype(object)
    # Davenport's matrix, solved for 4 C
    diagonal = [2 * (K[0][0] + K[k][k]) for k in (1, 2, 3)]
    C = np.diag(np.array(diagonal, dtype=object))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        both, turn = K[1 + i][1 + j], K[0][1 + k]  # C_ij + C_ji, C_ji - C_ij
        C[i][j], C[j][i] = 2 * (both - turn), 2 * (both + turn)

    assert (np.array(davenport_matrix(C.tolist()), dtype=object) == 4 * K).all()
    found = at_most_four(C.tolist())
    assert found is not None
    assert found.chart == (1, 4, 16, 64)
