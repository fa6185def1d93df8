"""Springs that break: every inequality on both sides of equality, in small integers."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.equilibrium import breaking
from certreg.equilibrium.breaking import (
    Labels,
    SpringSet,
    _agree,
    _eigenline,
    _Residuals,
    _roots,
    _splits,
    energy_is_at_least,
)
from certreg.errors import UndecidedError
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.results import ComponentKind

LITTLE = Fraction(1, 10**30)
AXES = np.concatenate([np.eye(3), -np.eye(3)])


def test_roots_are_the_integers_next_to_a_square_root():
    for k in range(40):
        low, high = _roots(k)

        assert low**2 <= k <= high**2
        assert (low + 1) ** 2 > k
        assert k == 0 or (high - 1) ** 2 < k


def test_two_springs_agree_where_their_lengths_differ_by_less_than_their_bounds():
    """Over all small lengths: on a line, where they are integers, and on diagonals."""
    for a, b, i, j, across in product(range(5), range(5), range(3), range(3), (0, 1)):
        rows: Any = SimpleNamespace(
            sources=[(1, 2, 3), (1 + a, 2 + across, 3)],
            targets=[(-1, 0, 0), (-1, b, 0)],
            bounds=[i, j],
        )
        square = a * a + across
        places = 10**40
        root = Fraction(math.isqrt(square * places**2), places)
        apart = abs(root - b)

        assert _agree(rows, 0, 1) == (apart < i + j), (a, b, i, j, across)


LINE = [(3, 0, 0), (-3, 0, 0), (0, 5, 0)], [(1, 0, 0), (-1, 0, 0), (0, 2, 0)]
BENT = [(1, 1, 0), (-1, -1, 0), (0, 1, 2)], [(1, 2, 3), (-1, -2, -3), (1, 1, 1)]


def residuals(
    points: Any, q: tuple[int, ...], sin2: Fraction | None, energy: Fraction, exponent: int = 0
) -> _Residuals:
    sources, targets = points
    rows: Any = SimpleNamespace(
        weights=[1, 1, 4], sources=sources, targets=targets, bounds=[7, 8, 9], exponent=exponent
    )
    line: Any = SimpleNamespace(quaternion=q, sin2=sin2)
    return _Residuals(rows, (0, 1), line, energy)


TURN = (1, 1, 0, 0)  # |q|^2 = 2, and the mass is 2: lengths are times 4


def test_along_a_continuum_a_residual_is_between_difference_and_sum_of_the_lengths():
    of, back = (residuals(points, TURN, None, Fraction(100)) for points in (LINE, LINE[::-1]))

    assert of.between(0) == back.between(0) == (8, 16, 28)
    assert of.between(2) == back.between(2) == (12, 28, 36)
    bent = residuals(BENT, TURN, None, Fraction(100))
    x, y = (4 * math.sqrt(k) for k in (2, 14))
    assert bent.between(0) == (14 - 6, 6 + 15, 28)
    assert bent.between(0)[0] <= y - x
    assert x + y <= bent.between(0)[1]
    same = residuals((BENT[0], BENT[0]), TURN, None, Fraction(100))
    assert same.between(0)[0] == 0


@pytest.mark.parametrize(
    ("energy", "exponent", "longest"),
    [
        (Fraction(4), 0, 8),
        (Fraction(4) + LITTLE, 0, 9),
        (Fraction(4) - LITTLE, 0, 8),
        (Fraction(4), 2, 4),
        (Fraction(4), -2, 16),
        (Fraction(64), 0, 16),
    ],
)
def test_along_a_continuum_no_spring_of_the_set_has_more_than_its_energy(
    energy: Fraction, exponent: int, longest: int
):
    """sqrt(E / w) times 4; not of a spring that is broken."""
    of = residuals(LINE, TURN, None, energy, exponent)

    assert of.between(0)[1] == longest
    assert of.between(2)[1] == 28


@pytest.mark.parametrize(
    ("sin2", "slack"),
    [
        (Fraction(0), 0),
        (Fraction(1, 36), 2),
        (Fraction(1, 36) + LITTLE, 3),
        (Fraction(1, 36) - LITTLE, 2),
        (LITTLE, 1),
    ],
)
def test_at_a_rotation_a_residual_is_known_up_to_what_its_error_turns(sin2: Fraction, slack: int):
    one = residuals(LINE, (1, 0, 0, 0), sin2, Fraction(1))

    assert one.between(0) == (4 - slack, 4 + slack, 14)
    halved = residuals(LINE, TURN, sin2 / 4, Fraction(1))
    assert halved.between(0) == (8 - slack, 8 + slack, 28)
    bent = residuals(BENT, (1, 0, 0, 0), Fraction(0), Fraction(1))
    assert bent.between(0) == (6, 7, 14)  # (2 (1 + 9))^(1/2) = 6.3


def objective_of(*lengths: float) -> Isotropic:
    return Isotropic(exact_moments(RegistrationProblem(AXES, AXES * lengths)))


OBJECTIVE = objective_of(3.0, 2.0, 1.0)  # K = diag(12, 0, -4, -8); the spread is 6 + 28


def test_the_least_energy_is_at_least_itself_and_no_more():
    assert energy_is_at_least(OBJECTIVE, Fraction(10))
    assert energy_is_at_least(OBJECTIVE, 10 - LITTLE)
    assert not energy_is_at_least(OBJECTIVE, 10 + LITTLE)


@pytest.mark.parametrize("lengths", [(3.0, 2.0, 1.0), (2.0**200, 2.0, 1.0), (1e30, 1.0, 1e-30)])
def test_eigenvalues_are_split_where_none_is(lengths: tuple[float, ...]):
    objective = objective_of(*lengths)
    bits = objective.eigenspaces.bits - objective.shift + 1
    values = sorted((objective.davenport[i][i] for i in range(4)), reverse=True)
    for k, value in enumerate(values):
        middle = value * Fraction(2) ** bits
        if middle.denominator == 1:
            assert not any(_splits(objective, int(middle), above) for above in range(5))
        for beside, above in ((math.ceil(middle) + 1, k), (math.floor(middle) - 1, k + 1)):
            assert [_splits(objective, beside, n) for n in range(5)] == [
                n == above for n in range(5)
            ]


def fake() -> Any:
    return SimpleNamespace(alignment=lambda _: Fraction(5), squared_residual=lambda _: Fraction(4))


def test_an_eigenspace_is_known_where_its_error_is_smaller_than_both_gaps():
    q, axis = (1, 0, 0, 0), ComponentKind.of_multiplicity(1)
    made = _eigenline(fake(), q, 1, 0, (Fraction(9), Fraction(2)))

    assert (made.error, made.sin2, made.kind, made.index) == (2, Fraction(4, 9), axis, 0)
    assert _eigenline(fake(), q, 2, 1, (Fraction(9), None)).sin2 is None
    assert _eigenline(fake(), q, 1, 1, (Fraction(9), None)).sin2 == Fraction(4, 16)
    assert _eigenline(fake(), q, 1, 1, (None, Fraction(2))).sin2 == Fraction(4, 9)
    assert _eigenline(fake(), q, 4, 0, (None, None)).sin2 is None
    for upper, lower in ((7, None), (None, 3), (9, 3), (7, 2)):
        ends: Any = tuple(None if end is None else Fraction(end) for end in (upper, lower))
        with pytest.raises(UndecidedError):
            _eigenline(fake(), q, 1, 0, ends)
    assert _eigenline(fake(), q, 1, 0, (7 + LITTLE, 3 - LITTLE)).sin2 is not None


def labels(
    monkeypatch, spans: list[tuple[int, int]], sin2: Any = Fraction(0), **fields: Any
) -> Any:
    """Of two springs that hold and one that is broken, all with the bound 5."""
    given: list[Any] = []

    def residuals(*arguments: Any) -> Any:
        given.append(arguments[3])
        return SimpleNamespace(between=lambda row: (*spans[row], 5))

    monkeypatch.setattr(breaking, "_Residuals", residuals)
    of: Any = SimpleNamespace(
        problem=SimpleNamespace(n=3),
        rows=None,
        unbroken=(0, 1),
        objective=SimpleNamespace(energy=lambda _: fields.get("energy", Fraction(0))),
        _most=Fraction(10),
    )
    line: Any = SimpleNamespace(quaternion=None, error=Fraction(1, 4), sin2=sin2)
    found = SpringSet._labels(of, line)
    assert given in ([], [fields.get("energy", Fraction(0)) + Fraction(1, 2)])
    return found


SPANS = [(low, high) for low in (4, 5, 6) for high in (4, 5, 6) if low <= high]


@pytest.mark.parametrize("continuum", [False, True])
def test_labels_are_proved_strictly_on_their_side_and_refuted_on_the_other(monkeypatch, continuum):
    for spans in product(SPANS, repeat=3):
        found = labels(monkeypatch, list(spans), None if continuum else Fraction(0))
        right = [high < 5 for _, high in spans[:2]] + [spans[2][0] > 5]
        wrong = [low > 5 for low, _ in spans[:2]] + [spans[2][1] < 5]
        if any(wrong):
            assert found is None
            continue
        doubtful = tuple(row for row in range(3) if not right[row])
        near = any(spans[row][0] < spans[row][1] for row in doubtful)
        open_verdict = Labels.TOO_NEAR if near else Labels.TIED
        if continuum:
            open_verdict = Labels.CONTINUUM

        assert found == (open_verdict if doubtful else Labels.PROVED, doubtful)


def test_springs_hold_nowhere_with_all_the_energy_that_breaks_them(monkeypatch):
    right, top = [(1, 2), (1, 2), (6, 7)], Fraction(21, 2)

    assert labels(monkeypatch, right, energy=top) is None
    assert labels(monkeypatch, right, energy=top + LITTLE) is None
    assert labels(monkeypatch, right, energy=top - LITTLE) is not None
