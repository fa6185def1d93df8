"""What the last bits of results depend on beside versions: compiled code or not, and processors.

The compiled code gives the same bits in each of its variants. Python in its place need not give
those. NumPy, its linear algebra and the system's functions choose their code by the processor.
Each is known by a digest of what it makes of given numbers, so that a manifest says which it was.
"""

from __future__ import annotations

import hashlib
import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.library import library_if_any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import ArrayLike, NDArray

    Reals = NDArray[np.float64]

COUNT = 1000  # of arguments: functions that round otherwise differ in one of some hundred
SIZES = (3, 4, 9, 40)  # of matrices: small ones have code of their own
DIGITS = 12


@cache
def arithmetic() -> dict[str, str]:
    """What computes in this process, by name; milliseconds, once.

    Raises VariantError where the environment names a variant that is not there.
    """
    numbers = np.random.default_rng(1).uniform(0.01, 3.0, COUNT)
    return {
        "kernels": "python" if library_if_any() is None else "compiled",
        "numpy_bits": _digest(_of_numpy(numbers)),
        "linear_algebra_bits": _digest(_of_linear_algebra(numbers)),
        "libm_bits": _digest(_of_the_system(numbers)),
    }


def _of_numpy(numbers: Reals) -> Iterator[ArrayLike]:
    for name in ("sin", "cos", "arccos", "arctan", "exp", "log", "log1p", "cbrt", "tanh"):
        yield getattr(np, name)(numbers / 3.0)
    for name in ("hypot", "arctan2", "power", "divide"):
        yield getattr(np, name)(numbers, numbers[::-1])
    rows = numbers.reshape(-1, 4)
    yield from (np.sum(numbers), rows.sum(axis=0), rows.sum(axis=1), np.var(numbers))
    yield np.einsum("ij,ik->jk", rows, rows)


def _of_linear_algebra(numbers: Reals) -> Iterator[ArrayLike]:
    rows = numbers[:900].reshape(-1, 3)
    yield from (rows.T @ rows, rows @ rows[:3], numbers @ numbers, np.linalg.norm(rows))
    for size in SIZES:
        matrix = np.resize(numbers, (size, size)) + np.eye(size)
        symmetric = matrix @ matrix.T
        yield from (symmetric, np.linalg.inv(matrix), np.linalg.solve(matrix, matrix.T))
        yield from (
            *np.linalg.eigh(symmetric),
            *np.linalg.svd(matrix),
            np.linalg.cholesky(symmetric),
        )


def _of_the_system(numbers: Reals) -> Iterator[ArrayLike]:
    given: list[float] = numbers.tolist()
    for function in (math.sin, math.cos, math.exp, math.log, math.atan, math.gamma):
        yield np.array([function(x) for x in given])
    yield np.array([x**y for x, y in zip(given, given[::-1], strict=True)])


def _digest(results: Iterable[ArrayLike]) -> str:
    whole = hashlib.sha256()
    for result in results:
        whole.update(np.asarray(result, dtype="<f8").tobytes())
    return whole.hexdigest()[:DIGITS]
