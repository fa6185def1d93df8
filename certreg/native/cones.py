"""Whether a quartic form in four variables is positive outside of caps, by native/cones.c."""

from __future__ import annotations

import ctypes
import enum
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from math import factorial, gcd, prod
from typing import TYPE_CHECKING

import numpy as np

from certreg.native.kernels import MissingLibraryError
from certreg.native.library import Library, little_library_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Integers = Sequence[int]

MONOMIALS = tuple(combinations_with_replacement(range(4), 4))
OVER_MULTINOMIALS = [prod(factorial(m.count(k)) for k in range(4)) for m in MONOMIALS]  # 24 over
ORTHANTS = tuple((1, *signs[::-1]) for signs in product((1, -1), repeat=3))  # bit k: e_(k+1)
SIGNS = tuple(tuple(prod(signs[k] for k in m) for m in MONOMIALS) for signs in ORTHANTS)
TASK = "a proof by cones of rotations"
COEFFICIENT_BITS = 124  # the bend of three fits in 128; as in the checker
WORD_BYTES = 16


class ConesEnding(enum.Enum):
    """How a search ended, in the order of the enum of cones.h."""

    POSITIVE = "positive outside of the caps"
    NOT_POSITIVE = "not positive at a point outside of the caps"
    BUDGET = "more cones than allowed"
    DEEP = "a cone became too small"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConeSearch:
    """What a search found: a proposal, as caps and vertices are in doubles.

    seen: cones looked at. deepest: cuts of the smallest one. vertex: where the form is not
    positive, if that is how it ended.
    """

    ending: ConesEnding
    seen: int
    deepest: int
    vertex: tuple[float, ...] | None = None


class _Search(ctypes.Structure):
    _fields_ = (
        ("orthants", ctypes.c_char_p),
        ("caps", ctypes.c_void_p),
        ("cap_count", ctypes.c_int64),
        ("budget", ctypes.c_int64),
        ("seen", ctypes.c_int64),
        ("deepest", ctypes.c_int64),
        ("vertex", ctypes.c_double * 4),
    )


def search_cones(quartic: Integers, caps: NDArray[np.float64], *, budget: int) -> ConeSearch:
    """Look for a cover by cones on each of which the form is positive, or which lie in a cap.

    quartic: its 35 coefficients, without multinomials. caps: (k, 5), a unit vector each and the
    squared sine of the angle that the cap reaches to. Raises MissingLibraryError where there is no
    compiled code.
    """
    return search_by(little_library_for(TASK), quartic, caps, budget)


def search_by(
    library: Library, quartic: Integers, caps: NDArray[np.float64], budget: int
) -> ConeSearch:
    """That by one library. Raises MissingLibraryError where it has no integers of 128 bits."""
    rows = bernstein_on_orthants(quartic)
    words = [entry.to_bytes(WORD_BYTES, "little", signed=True) for row in rows for entry in row]
    given = np.ascontiguousarray(caps, dtype=float).reshape(-1, 5)
    search = _Search(b"".join(words), given.ctypes.data, len(given), budget)
    number: int = library.handle.certreg_cones(ctypes.byref(search))
    if number == len(ConesEnding):
        raise MissingLibraryError(f"{TASK} needs integers of 128 bits")
    ending = list(ConesEnding)[number]
    vertex = tuple(search.vertex) if ending is ConesEnding.NOT_POSITIVE else None
    return ConeSearch(ending=ending, seen=search.seen, deepest=search.deepest, vertex=vertex)


def bernstein_on_orthants(quartic: Integers) -> list[list[int]]:
    """8 x 35: Bernstein coefficients on each orthant, over a common factor and rounded down."""
    common = [entry * factor for entry, factor in zip(quartic, OVER_MULTINOMIALS, strict=True)]
    shared = gcd(*quartic) or 1
    common = [entry // shared for entry in common]
    places = max(entry.bit_length() for entry in common) - COEFFICIENT_BITS
    common = [entry << max(-places, 0) for entry in common]
    return [
        [sign * entry >> max(places, 0) for sign, entry in zip(signs, common, strict=True)]
        for signs in SIGNS
    ]
