"""States of moving bodies: records with named parts; at rest, and with rotation matrices."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry.so3 import rotation_matrices
from certreg.native.layout import BREATHING_STATE, MATRIX_STATE, QUATERNION_STATE, Records, plain

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.problem.moments import ExactMoments

NO_TURN, NO_TURN_QUATERNION = np.eye(3).ravel().tolist(), (1.0, 0.0, 0.0, 0.0)
# Rotations over which the stiffest mode is looked for: those of the cube.
CUBE = np.array(
    [
        *np.eye(4).tolist(),
        *(np.array(signs) / 2.0 for signs in product((1.0,), *[(1.0, -1.0)] * 3)),
        *(
            [math.sqrt(0.5) * (k == i) + s * math.sqrt(0.5) * (k == j) for k in range(4)]
            for i, j in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
            for s in (1.0, -1.0)
        ),
    ]
)


def with_matrices(states: Records) -> Records:
    """States (...) of any body as records MATRIX_STATE: with rotation matrices, without a scale."""
    if states.dtype == MATRIX_STATE:
        return states
    turned = np.empty(states.shape, dtype=MATRIX_STATE)
    matrices = rotation_matrices(states["q"].reshape(-1, 4))
    turned["R"] = matrices.reshape(*states.shape, 3, 3)
    for part in ("c", "v", "omega"):
        turned[part] = states[part]
    return turned


def state_at_rest(rotation: ArrayLike, c: ArrayLike = (0.0, 0.0, 0.0)) -> NDArray[np.float64]:
    """The state (18,) at rest with a rotation, the centres of mass together unless c is given."""
    state = np.zeros((), dtype=MATRIX_STATE)
    state["c"], state["R"] = c, rotation
    return plain(state)


def state_of(
    q: Sequence[float] | NDArray[np.float64],
    c: Sequence[float] = (0.0, 0.0, 0.0),
    *,
    scale: float | None = None,
) -> Records:
    """The state () at rest with a quaternion and a c, and a scale where that is a state."""
    state = np.zeros((), dtype=QUATERNION_STATE if scale is None else BREATHING_STATE)
    state["q"], state["c"] = q, c
    if scale is not None:
        state["scale"] = scale
    return state


def start_at_rest(moments: ExactMoments, length_exponent: int) -> NDArray[np.float64]:
    """The start of [Yang2020], (18,): the source where it was given, R = I, no velocity."""
    return state_at_rest(np.eye(3), centres_apart(moments, length_exponent))


def centres_apart(moments: ExactMoments, length_exponent: int) -> list[float]:
    """The source's centre of mass where it was given minus the target's, over 2^length_exponent."""
    a, b = moments.source_exponent, moments.target_exponent
    least = min(a, b)
    x, y = a - least, b - least
    pairs = zip(moments.source_sum, moments.target_sum, strict=True)
    apart = [(here << x) - (there << y) for here, there in pairs]
    return in_doubles(apart, least - length_exponent, moments.mass)


def in_doubles(entries: Iterable[int], places: int, over: int) -> list[float]:
    """The integers times 2^places, over an integer, each rounded once."""
    if places >= 0:
        return [(entry << places) / over for entry in entries]
    over <<= -places
    return [entry / over for entry in entries]
