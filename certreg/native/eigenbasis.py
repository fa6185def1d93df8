"""The eigenbasis of a symmetric 4x4 matrix in fixed point, by native/eigenbasis.c.

Where it answers, a tenth of the time that Jacobi's rotations take in Python's integers.
"""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Sequence

from certreg.native.library import little_library

FIXED_BITS = 192  # behind the point
WORD_BYTES, FIXED_WORDS = 8, 4  # CERTREG_FIXED_WORDS, as in native/eigenbasis.h
_SIZE = WORD_BYTES * FIXED_WORDS
_Found, _NUMBERS = ctypes.c_char * (20 * _SIZE), struct.Struct(f"{_SIZE}s" * 20)


def fixed_eigenbasis(
    matrix: Sequence[Sequence[int]], shift: int = FIXED_BITS
) -> tuple[tuple[int, ...], tuple[tuple[int, ...], ...]] | None:
    """Eigenvalues, descending, and unit eigenvectors; all with `FIXED_BITS` fractional bits.

    The largest entry of the matrix, over 2^shift, is from 1/2 to 1. Errors are of some units in the
    last places, over the least difference of values. None where there is no compiled code, or the
    values are so close that it leaves the matrix to others.
    """
    library = little_library()
    if library is None:
        return None
    (a, b, c, d), (_, e, f, g), (_, _, h, i), (*_, j) = matrix
    upper, up, number = (a, b, c, d, e, f, g, h, i, j), FIXED_BITS - shift, int.from_bytes
    upper = [entry << up for entry in upper] if up >= 0 else [entry >> -up for entry in upper]
    given = b"".join([entry.to_bytes(_SIZE, "little", signed=True) for entry in upper])
    found = _Found()
    if not library.handle.certreg_eigenbasis(given, found):
        return None
    parts = _NUMBERS.unpack(found.raw)
    n = tuple([number(part, "little", signed=True) for part in parts])
    return n[:4], (n[4:8], n[8:12], n[12:16], n[16:])
