"""Paths of the critical lines of a quartic, in C; see paths.c."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.native.library import MANY, Library, library_for, library_if_any

if TYPE_CHECKING:
    from numpy.typing import NDArray


REACHED, STUCK = range(2)  # as in paths.h


class PathRules(ctypes.Structure):
    """The steps of a path, as `TrackerSettings` of equilibrium/tracking.py explains them."""

    _fields_ = (
        *((name, ctypes.c_double) for name in ("first_step", "predictor_bound", "predictor_aim")),
        *((name, ctypes.c_double) for name in ("corrector_bound", "least_growth", "most_growth")),
        *((name, ctypes.c_double) for name in ("shrink", "least_step", "endgame", "polished")),
        *((name, ctypes.c_int64) for name in ("max_rounds", "polishings")),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathEnds:
    """Where the paths ended.

    points: (paths, 5), q and l, |q| = 1. codes: (paths,), REACHED or STUCK. changes: of the last
    Newton step there, relative. conditions: of the Jacobian there. rounds: (paths,).
    """

    points: NDArray[np.complex128]
    codes: NDArray[np.int8]
    changes: NDArray[np.float64]
    conditions: NDArray[np.float64]
    rounds: NDArray[np.int64]

    def of(self, problem: int) -> PathEnds:
        """Those of one problem of many."""
        return PathEnds(**{name: getattr(self, name)[problem] for name in _ARRAYS})


_ARRAYS = tuple(PathEnds.__annotations__)


def quartic_paths(
    quartic: NDArray[np.float64],
    a: NDArray[np.complex128],
    roots: NDArray[np.complex128],
    rules: PathRules,
    library: Library | None = None,
) -> PathEnds | None:
    """The ends of the paths from sum a_i q_i^4 to a quartic (35,).

    a: (4,). roots: (paths, 5), q and l of the start. library: None for the one of this process.
    None where there is no compiled code.
    """
    library = library or library_if_any()
    if library is None:
        return None
    return many_quartic_paths(np.atleast_2d(quartic), a, roots, rules, library).of(0)


def many_quartic_paths(
    quartics: NDArray[np.float64],
    a: NDArray[np.complex128],
    roots: NDArray[np.complex128],
    rules: PathRules,
    library: Library | None = None,
) -> PathEnds:
    """As `quartic_paths`, to many quartics (problems, 35): arrays (problems, paths, ...).

    Raises MissingLibraryError where there is no compiled code.
    """
    library = library or library_for(MANY)
    given = [np.ascontiguousarray(quartics, dtype=np.float64)]
    given += [np.ascontiguousarray(array, dtype=np.complex128) for array in (a, roots)]
    if given[0].shape[1:] != (35,) or given[1].shape != (4,) or roots.shape[1:] != (5,):
        raise ValueError("a quartic has 35 coefficients, its start 4, a point 5 entries")
    several = (len(quartics), len(roots))
    ends = PathEnds(
        points=np.empty((*several, 5), dtype=np.complex128),
        codes=np.empty(several, dtype=np.int8),
        changes=np.empty(several),
        conditions=np.empty(several),
        rounds=np.empty(several, dtype=np.int64),
    )
    library.handle.certreg_many_quartic_paths(
        ctypes.c_int64(len(quartics)),
        _address(given[0]),
        _address(given[1]),
        ctypes.c_int64(len(roots)),
        _address(given[2]),
        ctypes.byref(rules),
        *[_address(getattr(ends, name)) for name in _ARRAYS],
    )
    return ends


@dataclass(frozen=True, slots=True)
class NearbyPoint:
    """A critical point in doubles: its unit quaternion, and the inverse Hessian in rotation angle.

    quaternion: 4 numbers. inverse: 3 rows.
    """

    quaternion: tuple[float, ...]
    inverse: tuple[tuple[float, ...], ...]


_Quaternion, _Inverse = ctypes.c_double * 4, ctypes.c_double * 9


def critical_point_near(quartic: NDArray[np.float64], start: Sequence[float]) -> NearbyPoint | None:
    """What Newton's method finds from a unit start.

    quartic: (35,), contiguous. None where it does not converge at once, the Hessian is nearly
    singular, or there is no compiled code.
    """
    library = library_if_any()
    if library is None:
        return None
    q, inverse = _Quaternion(*start), _Inverse()
    if not library.handle.certreg_quartic_newton(_address(quartic), q, inverse):
        return None
    return NearbyPoint(tuple(q), tuple(tuple(inverse[k : k + 3]) for k in (0, 3, 6)))


def _address(array: NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
