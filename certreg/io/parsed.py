"""What a reader that is no reader of text makes of a file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from certreg.io.row_numbers import RowNumbers


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Parsed:
    """Points (N, 3) and what is told of them, as in a cloud."""

    points: NDArray[np.float64]
    ignored: tuple[str, ...] = ()
    labels: tuple[str, ...] | None = None
    identifiers: tuple[str, ...] | None = None
    numbers: RowNumbers | None = None
    sigma: NDArray[np.float64] | None = None
    weights: NDArray[np.float64] | None = None
    times: NDArray[np.float64] | None = None  # seconds, ascending, of the poses of a trajectory
    notes: tuple[str, ...] = ()
    further: dict[str, NDArray[Any]] = field(default_factory=dict[str, Any])  # columns asked for
