"""The 60 cells of data, motion and loss: a small problem of each, as a user declares it."""

from __future__ import annotations

import itertools
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import certreg
from certreg.errors import InvalidProblemError
from certreg.problem.motion import Scale
from certreg.problem.support import Cell, Loss

if TYPE_CHECKING:
    from collections.abc import Callable

PAIRS = 12
RNG = np.random.default_rng(40)
SOURCE = RNG.normal(size=(PAIRS, 3))
TURN = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
TURN = TURN * np.linalg.det(TURN)
NOISE = 0.01 * RNG.normal(size=(PAIRS, 3))
AXES = RNG.normal(size=(PAIRS, 3))
AXES /= np.linalg.norm(AXES, axis=1)[:, None]
SHAPES = RNG.normal(size=(PAIRS, 3, 3))
DATA: dict[str, dict[str, Any]] = {
    "weights": {},
    "planes": {"normals": AXES},
    "lines": {"directions": AXES},
    "covariances": {"covariances": SHAPES @ SHAPES.transpose(0, 2, 1) + np.eye(3)},
}
MOTIONS: dict[str, dict[str, Any]] = {
    "pose": {},
    "rotation": {"rotation_only": True},
    "asymmetric": {"scale": "asymmetric"},
    "symmetric": {"scale": "symmetric"},
    "asymmetric rotation": {"scale": "asymmetric", "rotation_only": True},
}
LOSSES: dict[Loss, dict[str, Any]] = {
    Loss.SQUARES: {},
    Loss.CONSENSUS: {"max_residual": 0.3},
    Loss.TRUNCATED: {"max_residual": 0.3, "objective": "truncated"},
}
CELLS = list(itertools.product(DATA, MOTIONS, LOSSES))


def cell_of(data: str, motion: str, loss: Loss) -> Cell:
    """What the cell declares."""
    moves = MOTIONS[motion]
    return Cell(
        springs=data != "weights",
        scale=Scale(moves.get("scale", "none")),
        rotation_only=moves.get("rotation_only", False),
        loss=loss,
    )


def options_of(cell: Cell, data: str) -> dict[str, Any]:
    """What a user gives for the cell."""
    return {
        **(DATA[data] if cell.springs else {}),
        "scale": cell.scale,
        "rotation_only": cell.rotation_only,
        **LOSSES[cell.loss],
    }


def target_of(cell: Cell) -> Any:
    """Points that such a motion meets."""
    shift = 0.0 if cell.rotation_only else np.array([1.0, 2.0, 3.0])
    return SOURCE @ TURN.T + NOISE + shift


@cache
def certified(cell: Cell, data: str) -> Any:
    """The result of `certify` on points of the cell."""
    return certreg.certify(SOURCE, target_of(cell), **options_of(cell, data))


def refused_sentence(call: Callable[[], object]) -> str:
    """Of the error that the call ends with."""
    with pytest.raises(InvalidProblemError) as caught:
        call()
    return str(caught.value)
