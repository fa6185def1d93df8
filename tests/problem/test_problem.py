from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from certreg.errors import InvalidProblemError
from certreg.exact.dyadic import sigma_of_weight, weight_of_sigma
from certreg.problem import arrays as stating
from certreg.problem.lifting import FEW, Lifted, lift
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import NEUTRAL, PREFIXES

CLOUD = [[0.0, 0, 0], [1, 0, 0], [0, 2, 0]]
finite = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.slow
@given(arrays(np.float64, st.integers(1, 6), elements=finite))
def test_lifting_keeps_every_double_exactly(values):
    lifted = lift(values)

    exact = [Fraction(2) ** lifted.exponent * m for m in lifted.integers]
    assert exact == [Fraction(v) for v in values.tolist()]
    many = lift(np.tile(values, FEW + 1))  # by NumPy's calls, not one by one
    assert many == Lifted(integers=lifted.integers * (FEW + 1), exponent=lifted.exponent)


@given(arrays(np.float64, 4, elements=st.integers(-1000, 1000).map(float)))
def test_lifting_finds_the_shortest_integers(values):
    lifted = lift(values)

    assert not any(lifted.integers) or any(m % 2 for m in lifted.integers)


@given(st.floats(1e-150, 1e150))
def test_the_weight_is_the_double_nearest_to_the_inverse_square(sigma):
    exact = 1 / Fraction(sigma) ** 2
    weight = weight_of_sigma(sigma)

    neighbours = (np.nextafter(weight, 0.0), np.nextafter(weight, np.inf))
    assert all(abs(Fraction(weight) - exact) <= abs(Fraction(float(n)) - exact) for n in neighbours)


@given(st.integers(1, 10**6), st.integers(-40, 40))
def test_a_sigma_of_few_digits_is_found_from_its_weight(digits, exponent):
    sigma = float(f"{digits}e{exponent}")

    assert sigma_of_weight(weight_of_sigma(sigma)) == sigma


def test_a_weight_of_no_sigma_has_none():
    """Sigmas above 1/2 are 2^-53 apart, and their weights four units of the last place."""
    weights = [4.0 - k * 2.0**-51 for k in range(20)]

    assert [sigma_of_weight(w) is None for w in weights].count(True) == 15
    assert all(weight_of_sigma(s) == w for w in weights if (s := sigma_of_weight(w)) is not None)
    assert sigma_of_weight(math.inf) is sigma_of_weight(0.0) is sigma_of_weight(1e301) is None


def test_the_naive_weight_would_miss_it():
    sigmas = np.random.default_rng(0).uniform(0.001, 10, size=400).tolist()

    assert sum(weight_of_sigma(s) != 1 / (s * s) for s in sigmas) > 40


def test_the_digest_is_that_of_the_documented_bytes():
    problem = RegistrationProblem([[1.0, 2, 3]], [[4.0, 5, -0.0]])

    doubles = np.array([1, 2, 3, 4, 5, 0, 1], dtype="<f8").tobytes()
    expected = PREFIXES[NEUTRAL] + (1).to_bytes(8, "little") + doubles
    assert problem.data_bytes() == expected


def test_the_digest_does_not_see_the_sign_of_zero_but_every_other_bit():
    plain = RegistrationProblem(CLOUD, CLOUD)
    signed = RegistrationProblem(np.array(CLOUD) * np.array([1, 1, -1.0]), CLOUD)
    other = np.array(CLOUD)
    other[2, 1] = np.nextafter(2.0, 3.0)

    assert plain.digest() == signed.digest()
    assert plain.digest() != RegistrationProblem(other, CLOUD).digest()
    assert plain.digest() != RegistrationProblem(CLOUD, CLOUD, weights=[1, 1, 2]).digest()


def test_a_problem_is_a_copy_that_nobody_can_change():
    source = np.array(CLOUD)
    problem = RegistrationProblem(source, source)
    source[0, 0] = 7.0

    assert problem.source[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        problem.source[0, 0] = 1.0
    with pytest.raises(AttributeError):
        problem.damping = 3.0  # type: ignore[misc]


def test_clouds_of_other_libraries_are_taken_by_their_points_or_vertices():
    class PointCloud:
        points = CLOUD

    class Mesh:
        vertices = CLOUD

    class Sampled(PointCloud):
        vertices = CLOUD[:2]

    expected = RegistrationProblem(CLOUD, CLOUD).digest()
    assert RegistrationProblem(PointCloud(), Mesh()).digest() == expected
    assert RegistrationProblem(Sampled(), Mesh()).digest() == expected


def test_sigma_per_point_gives_a_weight_per_point():
    problem = RegistrationProblem(CLOUD, CLOUD, sigma=[0.5, 1.0, 2.0])

    assert problem.weights.tolist() == [4.0, 1.0, 0.25]
    assert problem.noise_given


def test_a_weight_of_zero_takes_a_point_out():
    a = RegistrationProblem([*CLOUD, [9.0, 9, 9]], [*CLOUD, [5.0, 1, 2]], weights=[1, 1, 1, 0])
    from certreg.problem.moments import exact_moments

    with_zero, without = exact_moments(a), exact_moments(RegistrationProblem(CLOUD, CLOUD))
    assert with_zero.cross_unit * with_zero.cross[0][0] == without.cross_unit * without.cross[0][0]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"source": [], "target": []}, r"shape \(0,\)"),
        ({"source": np.empty((0, 3)), "target": np.empty((0, 3))}, "no points"),
        ({"source": [[0.0, 1]], "target": CLOUD}, r"\(N, 3\)"),
        ({"source": np.zeros((3, 5)), "target": CLOUD}, "transpose"),
        ({"source": CLOUD[:2], "target": CLOUD}, "source has 2 points, target has 3"),
        ({"source": [[0.0, np.nan, 0], *CLOUD[1:]], "target": CLOUD}, "row 0"),
        ({"source": CLOUD, "target": [*CLOUD[:2], [0.0, np.inf, 0]]}, "target row 2"),
        ({"source": [["1", "2", "3"]] * 3, "target": CLOUD}, "real numbers"),
        ({"source": np.array(CLOUD) * 1j, "target": CLOUD}, "real numbers"),
        ({"source": [[True, False, True]] * 3, "target": CLOUD}, "real numbers"),
        ({"source": [[2**60 + 1, 0, 0]] * 3, "target": CLOUD}, "no double holds"),
        ({"source": np.ma.array(CLOUD, mask=np.eye(3, dtype=bool)), "target": CLOUD}, "masked"),
        ({"sigma": 1.0, "weights": [1, 1, 1]}, "give one"),
        ({"weights": [0.0, 0, 0]}, "all weights are zero"),
        ({"weights": [1.0, -1, 1]}, r"weights\[1\] is -1.0"),
        ({"weights": [1.0, 1]}, "one per point"),
        ({"weights": [1.0, np.nan, 1]}, "row 1"),
        ({"sigma": 0.0}, "must be > 0"),
        ({"sigma": [1.0, -2, 1]}, r"sigma\[1\]"),
        ({"sigma": 1e-170}, "outside the doubles"),
        ({"sigma": 1e200}, "outside the doubles"),
        ({"damping": 0.0}, "positive finite"),
        ({"damping": float("nan")}, "positive finite"),
        ({"damping": 1e200}, "1e-150 to 1e150"),
        ({"damping": "2"}, "positive finite"),
        ({"sigma": -1}, "sigma is -1.0"),
        ({"sigma": math.nan}, "sigma is nan: a standard deviation must be finite"),
    ],
)
def test_bad_input_is_refused_with_what_where_and_remedy(arguments, words):
    with pytest.raises(InvalidProblemError, match=words) as refusal:
        RegistrationProblem(**({"source": CLOUD, "target": CLOUD} | arguments))
    assert "\n" not in str(refusal.value)


LONG = np.arange(36.0).reshape(12, 3)
FAULT = 7  # the row


def spoilt(array: np.ndarray, value: float) -> np.ndarray:
    array = array.copy()
    array[FAULT] = value
    return array


@pytest.mark.parametrize(("inside", "outside"), [(1e-150, 9.99e-151), (1e150, 1.001e150)])
def test_dampings_are_taken_where_their_squares_are_doubles(inside, outside):
    problem = RegistrationProblem(CLOUD, CLOUD, damping=inside)

    assert problem.damping == problem.damped(inside).damping == inside
    with pytest.raises(InvalidProblemError, match="1e-150 to 1e150"):
        problem.damped(outside)
    with pytest.raises(InvalidProblemError, match="1e-150 to 1e150"):
        RegistrationProblem(CLOUD, CLOUD, damping=outside)


@pytest.mark.parametrize("block", [1, 5, 1 << 16])
@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("source", spoilt(LONG, np.nan)),
        ("target", spoilt(LONG, -np.inf)),
        ("source", spoilt(LONG.astype(np.int64), 2**60 + 1)),
        ("weights", spoilt(np.ones(12), -1.0)),
        ("weights", spoilt(np.ones(12), np.inf)),
        ("sigma", spoilt(np.ones(12), 0.0)),
    ],
)
def test_the_row_at_fault_is_named_wherever_blocks_begin(name, values, block, monkeypatch):
    monkeypatch.setattr(stating, "BLOCK_POINTS", block)
    given: dict[str, Any] = {"source": LONG, "target": LONG, name: values}
    with pytest.raises(InvalidProblemError) as refusal:
        RegistrationProblem(**given)

    error = refusal.value
    assert (error.array, error.row) == (name, FAULT)
    assert repr(error.value) == repr(values[FAULT].tolist())
    told = re.findall(r"row (\d+)|\w\[(\d+)\]", str(error))
    expected = [] if "no double holds" in str(error) else [FAULT]
    assert [int(row or entry) for row, entry in told] == expected
