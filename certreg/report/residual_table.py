"""`fit.csv`: every correspondence with its residual, plain and in standard deviations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from certreg.io.labels import csv_field
from certreg.registration.row_names import RowNames

if TYPE_CHECKING:
    from certreg.registration.result import Registration


HEADER = b"row,label,residual,standardised\n"


def residual_table(registration: Registration) -> Iterator[bytes]:
    """The table, block by block; a number is the shortest that reads back the same.

    row: of the pair, from 0; label: as far as the certificate holds labels. residual:
    |y - R x - t|, with a free scale |y - s R x - t|, of general springs how far the pair is off
    along them, in the clouds' unit.
    standardised: sqrt(w) times that, of general springs sqrt(r^T W r), over the standard
    deviation of a coordinate of weight one: 1 where sigma was given, else estimated, the root of
    the objective over the degrees of freedom. Empty where no double holds it, and where a weight is
    zero.
    """
    unit, certificate = _unit(registration), registration.certificate
    names = RowNames.of({} if certificate is None else certificate.about, registration.problem.n)
    yield HEADER
    for rows, distances, strained in registration.residual_blocks():
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            scaled = strained / unit
        lines = (
            f"{row},{csv_field(names.label(row) or '')},{_cell(distance)},{_cell(share)}\n"
            for row, distance, share in zip(
                range(rows.start, rows.stop), distances.tolist(), scaled.tolist(), strict=True
            )
        )
        yield "".join(lines).encode()


def _unit(registration: Registration) -> float:
    """Standard deviation of a coordinate of weight one; NaN where nothing tells it."""
    objective, freedom = registration.objective, registration.degrees_of_freedom
    if registration.problem.noise_given:
        return 1.0
    if freedom <= 0 or objective is None or objective <= 0:
        return math.nan
    return math.sqrt(registration.solution.squares(objective) / freedom)


def _cell(value: float) -> str:
    return repr(value) if math.isfinite(value) else ""
