"""Records of doubles that Python and C share, as NumPy types whose parts have names.

The layout is generated once, with the C that reads and writes it: generated/layout.h has the
offsets, generated/layout.json what the types here are made of. Of a symmetric matrix the upper
triangle is kept: 11 12 13 22 23 33.
"""

from __future__ import annotations

import json
from array import array
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from certreg.native.kernels import GENERATED

RecordType = np.dtype[np.void]
Records = NDArray[np.void]
DOUBLE = np.dtype(np.float64)
UPPER = np.array((0, 1, 2, 1, 3, 4, 2, 4, 5))  # of the nine entries of a symmetric matrix


def record_types(layout: Mapping[str, Mapping[str, Any]]) -> dict[str, RecordType]:
    """A structured type for each record: its parts are arrays of doubles, or earlier records."""
    types: dict[str, RecordType] = {}
    for name, parts in layout.items():
        fields: list[Any] = [
            (part, types[of]) if isinstance(of, str) else (part, DOUBLE, tuple(of))
            for part, of in parts.items()
        ]
        types[name] = np.dtype(fields)
    return types


_LAYOUTS = [
    json.loads((GENERATED / name).read_text("utf-8"))
    for name in ("layout.json", "breathing_layout.json", "spring_layout.json")
]
_TYPES = record_types({name: parts for each in _LAYOUTS for name, parts in each.items()})
MATRIX_STATE = _TYPES["matrix_state"]  # c, R, v, omega: the order of [Yang2020]
QUATERNION_STATE = _TYPES["quaternion_state"]  # c, q, v, omega
BODY = _TYPES["body"]  # per unit of mass: cross, inertia, inertia_inverse, spread, damping
ENERGIES = _TYPES["energies"]  # per unit of mass: translation, rotation, potential, alignment
STEP = _TYPES["step"]  # h
SPLITTING_STEP = _TYPES["splitting_step"]  # h, decay exp(-mu h), impulse (1 - exp(-mu h)) / mu
MATRIX_SAMPLE = _TYPES["matrix_sample"]  # time, state, energies
QUATERNION_SAMPLE = _TYPES["quaternion_sample"]
SPRING_BODY = _TYPES["spring_body"]  # of general springs, per unit of mass
SPRING_ENERGIES = _TYPES["spring_energies"]  # per unit of mass: translation, rotation, potential
SPRING_SAMPLE = _TYPES["spring_sample"]  # time, state (with a quaternion), energies
BREATHING_STATE = _TYPES["breathing_state"]  # c, q, scale, v, omega, growth
BREATHING_ENERGIES = _TYPES["breathing_energies"]  # as ENERGIES, with that of the scale
BREATHING_SAMPLE = _TYPES["breathing_sample"]  # time, state, energies
BASIN = _TYPES["basin"]  # quaternions by descending eigenvalue; their gaps l1 - lk over the mass
MEANS = _TYPES["means"]  # source, target
SPREADS = _TYPES["spreads"]  # source, target, centred_target
SUMS = _TYPES["sums"]  # of native/sums.h
EXACT_SUMS = _TYPES["exact_sums"]  # of native/exact.h


def named(numbers: Any, record: RecordType) -> Records:
    """Doubles (..., k) as records (...) of k: the same memory where they are contiguous."""
    doubles = np.ascontiguousarray(numbers, dtype=DOUBLE)
    if doubles.shape[-1:] != (width(record),):
        raise ValueError(f"numbers of shape {doubles.shape}: expected (..., {width(record)})")
    return doubles.view(record)[..., 0]


def record_of(numbers: Sequence[float], record: RecordType, shape: tuple[int, ...] = ()) -> Records:
    """One record, of this shape, of so many numbers: a list is read faster here than by NumPy."""
    doubles = array("d", numbers)
    if len(doubles) * doubles.itemsize != record.itemsize:
        raise ValueError(f"{len(doubles)} numbers: expected {width(record)}")
    return np.ndarray(shape, record, doubles)


def plain(records: NDArray[Any]) -> NDArray[np.float64]:
    """Records (...) of k doubles as doubles (..., k): the same memory where they are contiguous."""
    doubles = np.ascontiguousarray(records).view(DOUBLE)
    return doubles.reshape(*records.shape, width(records.dtype))


def width(record: np.dtype[Any]) -> int:
    """How many doubles a record has."""
    return record.itemsize // DOUBLE.itemsize


def symmetric(upper: NDArray[np.float64]) -> NDArray[np.float64]:
    """Symmetric matrices (..., 3, 3) from their upper triangles (..., 6)."""
    return upper.take(UPPER, axis=-1).reshape(*upper.shape[:-1], 3, 3)
