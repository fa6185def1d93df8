"""Lists of critical lines: which are tried, kept and the best, on both sides of each limit."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from certreg.equilibrium import line_boxes
from certreg.equilibrium.line_boxes import MOST_BITS, index_of
from certreg.equilibrium.line_set import DOUBTFUL_PLANES, PLANES, PRIMES, at_most_forty, plane
from certreg.equilibrium.paths import REAL
from certreg.equilibrium.tracking import REGULAR, SINGULAR

HOMOTOPY = import_module("certreg.equilibrium.homotopy")
RANKS = import_module("certreg.equilibrium.line_set")


@dataclass
class Level:
    """A line of an energy, whose ball is 2^-bits wide once its box was tightened to so many."""

    energy: Fraction
    exact: bool = False
    bits: int = 0
    tried: list[int] = field(default_factory=list)
    precisions: list[int] = field(default_factory=list)
    quaternion: tuple[int, ...] = ()

    def within(self, bits: int) -> Level:
        assert len(self.tried) < 9, "a tie is never told"
        self.tried.append(bits)
        self.bits = bits
        return self

    @property
    def system(self) -> Any:
        return SimpleNamespace(form=SimpleNamespace(level=self._level))

    def _level(self, _: Any) -> arb:
        self.precisions.append(ctx.prec)
        ball = arb(self.energy.numerator) / arb(self.energy.denominator)
        return ball if self.exact else ball + arb(0, 2.0**-self.bits)


def least(*lines: Level) -> list[int]:
    return HOMOTOPY._least(lines)


@pytest.mark.parametrize(
    ("apart", "tried"),
    [(100, [192]), (300, [192, 384]), (700, [192, 384, 768]), (1000, [192, 384, 768])],
)
def test_the_least_energy_is_told_with_as_many_bits_as_it_takes(apart: int, tried: list[int]):
    for order in (1, -1):
        lines = [Level(Fraction(1)), Level(1 + Fraction(1, 1 << apart))][::order]
        first = 0 if order == 1 else 1

        assert least(*lines) == ([0, 1] if apart == 1000 else [first])
        for line in lines:
            assert line.tried == tried
            assert line.precisions == [2 * bits for bits in tried]


def test_a_tie_is_told_after_the_last_number_of_bits(monkeypatch):
    monkeypatch.setattr(HOMOTOPY, "TIE_BITS", 384)
    for apart, tied in ((300, [0]), (700, [0, 1])):
        lines = [Level(Fraction(1)), Level(1 + Fraction(1, 1 << apart))]

        assert least(*lines) == tied
        assert lines[1].tried == [192, 384]


def test_those_that_tie_are_the_least_and_others_are_asked_for_no_more_bits():
    high, *equal = [Level(Fraction(2)), Level(Fraction(1)), Level(Fraction(1))]

    assert least(high, *equal) == [1, 2]
    assert high.tried == [192]
    assert least(*[Level(Fraction(1), exact=True) for _ in range(3)]) == [0, 1, 2]


def test_one_line_is_the_least_as_it_is():
    alone = Level(Fraction(1))

    assert least() == []
    assert least(alone) == [0]
    assert alone.tried == []


Tried = list[tuple[list[complex], bool]]


def proved_of(points: Any, codes: list[int], tried: Tried, *, real: Any = bool) -> list[Any]:
    """Boxes of ends, where a real one is found if `real` says so of the first entry of its end."""

    def boxed(_: Any, q: list[complex], *, real_line: bool) -> Any:
        tried.append((q, real_line))
        found = real(q[0]) if real_line else True
        return SimpleNamespace(q=q, is_real=real_line) if found else None

    ends: Any = SimpleNamespace(points=np.array(points), codes=np.array(codes))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(HOMOTOPY, "boxed", lambda *q, real: boxed(*q, real_line=real))
        patched.setattr(HOMOTOPY, "all_different", lambda _: True)
        return HOMOTOPY.proved_lines(None, ends)


def some_real(count: int) -> Any:
    points = np.random.default_rng(3).normal(size=(count, 4))
    return (points / np.linalg.norm(points, axis=1, keepdims=True)).astype(complex)


@pytest.mark.parametrize(("singular", "tried"), [(0, 12), (8, 12), (9, 3)])
def test_ends_that_are_singular_are_tried_where_they_are_few(singular: int, tried: int):
    codes = [SINGULAR] * singular + [REGULAR] * (12 - singular)
    seen = Tried()
    found = proved_of(some_real(12), codes, seen)

    assert len(found) == len(seen) == tried
    assert all(line.is_real for line in found)


def test_an_end_is_tried_as_real_first_where_doubles_tell_no_imaginary_part():
    below = np.nextafter(REAL, 0.0)
    points = [[1, 0, 0, 1j * part] for part in (0.0, below)] + [[0, 1, 0, 1j * REAL]]
    points += [[0, 0, 1, 0.0]]
    tried = Tried()
    found = proved_of(points, [REGULAR] * 4, tried)

    assert [line.is_real for line in found] == [True, True, False, False]
    assert [real for _, real in tried] == [True, True, False, True, False]
    assert tried[1][0] == [1.0, 0.0, 0.0, 0.0]
    assert tried[2][0] == points[2]


def test_a_line_is_kept_where_it_is_another_than_each_before_it(monkeypatch):
    """Of four the third is not told from the first."""
    names = iter("ABCD")
    monkeypatch.setattr(HOMOTOPY, "boxed", lambda *_, real: next(names))
    monkeypatch.setattr(HOMOTOPY, "all_different", lambda lines: not {"A", "C"} <= {*lines})
    ends: Any = SimpleNamespace(points=some_real(4), codes=np.full(4, REGULAR))

    assert HOMOTOPY.proved_lines(None, ends) == ["A", "B", "D"]


@pytest.mark.parametrize("needed", [256, 300, 1024, MOST_BITS, MOST_BITS + 1])
def test_an_index_is_proved_with_up_to_the_most_bits(monkeypatch, needed: int):
    tried = list[int]()

    def signs(_: Any) -> int | None:
        tried.append(ctx.prec)
        assert len(tried) < 9, "no number of bits is the last"
        return 2 if ctx.prec >= needed else None

    monkeypatch.setattr(line_boxes, "negative_eigenvalues", signs)
    system = SimpleNamespace(form=SimpleNamespace(curvature=lambda _: None))
    line: Any = SimpleNamespace(system=system, quaternion=(), box=SimpleNamespace(bits=256))
    line.within = lambda bits: SimpleNamespace(**{**vars(line), "box": SimpleNamespace(bits=bits)})

    assert index_of(line) == (2 if needed <= MOST_BITS else None)
    assert tried == [bits for bits in (256, 512, 1024, 2048) if bits < 2 * needed]


@pytest.mark.parametrize(("next_dimension", "last"), [(40, PLANES), (41, DOUBTFUL_PLANES + 1)])
def test_planes_are_tried_to_the_last_where_the_next_dimension_is_forty(
    monkeypatch, next_dimension: int, last: int
):
    degrees, planes = list[int](), list[int]()

    def dimension(_: Any, degree: int, __: int) -> int:
        degrees.append(degree)
        return 40 if degree == 7 else next_dimension

    def misses(_: Any, t: int, prime: int) -> bool:
        planes.append(t)
        return prime == PRIMES[1] and t == PLANES - 1

    monkeypatch.setattr(RANKS, "_dimension", dimension)
    monkeypatch.setattr(RANKS, "_misses", misses)
    found = at_most_forty(np.ones(35, dtype=int).tolist())

    assert degrees == [7, 8, 7, 8]
    assert planes == [*range(last)] * 2
    if last == PLANES:
        assert found is not None
        assert (found.plane, found.prime) == (plane(PLANES - 1), PRIMES[1])
    else:
        assert found is None
