"""What is minimised, or counted, over the pairs of a problem: the loss, with its bounds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from certreg.problem.support import Loss
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Squares(Brief):
    """The least squares over all pairs: sum w |r|^2, or r^T W r where there are springs."""

    kind: ClassVar[Loss] = Loss.SQUARES
    bounds: ClassVar[NDArray[np.float64]] = np.array(np.inf)  # every pair counts


@dataclass(frozen=True, slots=True, eq=False)
class Consensus(Brief):
    """One motion shall bring as many pairs as possible within their bounds.

    A motion (R, t) meets pair i where |y_i - R x_i - t| <= bounds[i]; where the scale is free, a
    motion (s, R, t), s > 0, where |y_i - s R x_i - t| <= bounds[i]. Weights and springs are those
    of the least squares over the pairs that are met, and change no bound.

    bounds: (N,), > 0, in the unit of the clouds; where the scale is free, in that of the target.
    """

    bounds: NDArray[np.float64]
    kind: ClassVar[Loss] = Loss.CONSENSUS


@dataclass(frozen=True, slots=True, eq=False)
class Truncated(Brief):
    """The least sum of min(|y - R x|^2 / bound^2, 1) over all pairs.

    A pair within its bound counts by how near it is to it, one beyond it as 1.

    bounds: (N,), > 0, in the unit of the clouds.
    """

    bounds: NDArray[np.float64]
    kind: ClassVar[Loss] = Loss.TRUNCATED


@dataclass(frozen=True, slots=True, eq=False)
class Breaking(Brief):
    """The least sum of min(w |y - R x - t|^2, w bound^2): a spring breaks beyond its bound.

    bounds: (N,), > 0, in the unit of the clouds.
    """

    bounds: NDArray[np.float64]
    kind: ClassVar[Loss] = Loss.BREAKING


PairLoss = Squares | Consensus | Truncated | Breaking
SQUARES = Squares()
