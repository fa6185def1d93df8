"""The inequality of native/certifying.c, alone: whatever is proposed, what it proves is true."""

from __future__ import annotations

import ctypes
import subprocess
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from engines import c_compiler
from hypothesis import given, settings
from hypothesis import strategies as st

from certreg.exact.elimination import is_positive_definite
from certreg.native.kernels import GENERATED, HERE
from certreg.verify import multiplicities

pytestmark = pytest.mark.slow
HARNESS = """
#include "certifying.c"
static int128 joined(const uint64_t *x) { return (int128)((uint128)x[1] << 64 | x[0]); }
int try_proof(const uint64_t *entries, const int64_t *q, const uint64_t *half, uint64_t *delta)
{
    int128 matrix[16], found = 0;
    for (int i = 0; i < 16; i++)
        matrix[i] = joined(entries + 2 * i);
    const int answer = proved(matrix, q, joined(half), &found);
    delta[0] = (uint64_t)found, delta[1] = (uint64_t)((uint128)found >> 64);
    return answer;
}
int try_distinct(const uint64_t *entries)
{
    wide cross[9];
    for (int i = 0; i < 9; i++)
        cross[i] = product(widened(joined(entries + 2 * i)), widened((int128)1 << 100));
    return distinct(cross);
}
void try_quotient(const uint64_t *x, const uint64_t *y, int up, int64_t *to)
{
    put(quotient((dyadic){joined(x), 0}, (dyadic){joined(y), 0}, up), to);
}
"""


@pytest.fixture(scope="module")
def code(tmp_path_factory) -> Any:
    folder = tmp_path_factory.mktemp("certifying")
    (folder / "harness.c").write_text(HARNESS, encoding="utf-8")
    options = ("-std=gnu11", "-O1", "-w", "-Wno-psabi", "-fPIC", "-shared")
    found = (f"-I{HERE}", f"-I{GENERATED}", str(folder / "harness.c"), "-o", str(folder / "it.so"))
    subprocess.run([*c_compiler(), *options, *found, "-lm"], check=True, capture_output=True)
    return ctypes.CDLL(str(folder / "it.so"))


def words(numbers) -> Any:
    """Of 128 bits each, low first."""
    given_ = [(int(x) >> shift) & (2**64 - 1) for x in numbers for shift in (0, 64)]
    return (ctypes.c_uint64 * len(given_))(*given_)


def proof(code: Any, matrix, q, half: int) -> int | None:
    """delta, where it is proved."""
    found = (ctypes.c_uint64 * 2)()
    entries = words([matrix[i][j] for i in range(4) for j in range(4)])
    answer = code.try_proof(entries, (ctypes.c_int64 * 4)(*q), words([half]), found)
    return found[0] | found[1] << 64 if answer else None


def is_true(matrix, q, half: int, delta: int) -> bool:
    """(v + delta - half) I - K + half q q^T / n > 0, by the definition."""
    n = sum(c * c for c in q)
    v = sum(q[i] * matrix[i][j] * q[j] for i in range(4) for j in range(4))
    level = v + (delta - half) * n
    rows = [
        [level * (i == j) - n * matrix[i][j] + half * q[i] * q[j] for j in range(4)]
        for i in range(4)
    ]
    return is_positive_definite(rows)


@settings(max_examples=60)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1.0, 1e-3, 1e-9, 1e-12]),
    st.sampled_from([0.0, 0.0, 1e-15, 1e-12, 1e-8, 1e-3, 0.5]),
    st.floats(0.05, 1.2),
)
def test_what_is_proved_is_true_of_every_matrix_that_is_so_rounded(code, seed, gap, off, share):
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.normal(size=(4, 4)))[0]
    values = np.array([1.0, 1.0 - gap, -0.3, -0.9])
    doubles = (axes * values) @ axes.T
    matrix = [[int(doubles[min(i, j), max(i, j)] * 2.0**106) for j in range(4)] for i in range(4)]
    unit = axes[:, 0] + off * rng.normal(size=4)
    q = [int(entry) for entry in np.rint(unit / np.linalg.norm(unit) * 2.0**52)]
    half = max(1, int(share * gap / 2 * 2.0**106))
    delta = proof(code, matrix, q, half)

    if delta is None:
        assert off > 0 or share > 0.9 or gap < 1e-9
        return
    for lost in (0, 1, rng.integers(0, 2, size=(4, 4))):
        upper = np.triu(np.broadcast_to(lost, (4, 4)))
        added = (np.maximum(upper, upper.T) * (2**60 - 1)).tolist()
        exact = [[(matrix[i][j] << 60) + added[i][j] for j in range(4)] for i in range(4)]
        assert is_true(exact, q, half << 60, delta << 60)


@pytest.mark.parametrize("place", [1, 2, 3])
def test_the_block_is_definite_just_inside_of_its_bound_and_not_just_outside(code, place):
    """With q along the axis w the block is diagonal, and rounded to 2^42 of the matrix."""
    first, second = 2**99, 2**98
    for extra, answer in ((2**42, True), (2**42 - 1, False), (0, False), (-(2**60), False)):
        half, odd = divmod(first - second - 8 - extra, 2)
        others = [-second, -first]
        others.insert(place - 1, second)
        matrix = np.diag(np.array([first - odd, *others], dtype=object))
        delta = proof(code, matrix.tolist(), (2**52, 0, 0, 0), half)
        assert (delta is not None) == answer, extra


@pytest.mark.parametrize("lower", [1, 2, 3])
def test_a_block_with_two_negative_directions_is_not_definite(code, lower):
    values = [2**99] * 4
    values[0], values[lower] = 2**98, -(2**99)
    matrix = np.diag(np.array(values, dtype=object)).tolist()

    assert proof(code, matrix, (2**52, 0, 0, 0), 2**60) is None


def test_a_quaternion_that_is_shorter_than_its_unit_is_not_taken(code):
    matrix = np.diag(np.array([2**106, 0, 0, -(2**106)], dtype=object)).tolist()
    least = 2**52 - 2

    assert proof(code, matrix, (2**52, 0, 0, 0), 2**104) == 1
    assert proof(code, matrix, (least, 0, 0, 0), 2**104) is not None
    assert proof(code, matrix, (2**52 - 5, 0, 0, 0), 2**104) is None


@pytest.mark.parametrize("scale", [1, 2**60 - 1])
@pytest.mark.parametrize(
    ("cross", "pattern"),
    [
        ([[18, 0, 0], [0, 8, 0], [0, 0, 2]], [1, 1, 1, 1]),
        ([[18, 0, 0], [0, 8, 0], [0, 0, -2]], [1, 1, 1, 1]),
        ([[0, -3, 0], [1, 0, 0], [0, 0, 0]], [1, 1, 1, 1]),
        ([[1, 2, 3], [4, 5, 6], [7, 8, -10]], [1, 1, 1, 1]),
        ([[4, 0, 0], [0, 4, 0], [0, 0, 1]], [1, 2, 1]),
        ([[4, 0, 0], [0, 1, 0], [0, 0, 1]], [1, 1, 2]),
        ([[0, -5, 0], [5, 0, 0], [0, 0, 5]], [1, 3]),
        ([[4, 0, 0], [0, 1, 0], [0, 0, -1]], [2, 1, 1]),
        ([[1, 2, 3], [2, 4, 6], [3, 6, 9]], [2, 2]),
        ([[0, 0, 0], [0, 0, 0], [0, 0, 0]], [4]),
    ],
)
def test_four_equilibria_are_proved_of_distinct_singular_values_alone(code, cross, pattern, scale):
    scaled = [[scale * entry for entry in row] for row in cross]

    assert multiplicities(scaled) == pattern
    told = code.try_distinct(words([entry for row in scaled for entry in row]))
    assert bool(told) == (pattern == [1, 1, 1, 1])


@settings(max_examples=100)
@given(st.integers(1, 2**122), st.integers(1, 2**126), st.booleans())
def test_quotients_are_rounded_outwards_to_short_mantissas(code, above, below, up):
    found = (ctypes.c_int64 * 2)()
    code.try_quotient(words([above]), words([below]), int(up), found)
    exact = Fraction(above, below)
    value = found[0] * Fraction(2) ** found[1]

    assert 0 < found[0] < 2**32
    assert value >= exact if up else value <= exact
    assert abs(value - exact) <= exact / 2**30
