"""`fit.csv`: every correspondence with its residual, plain and in standard deviations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.io import csv_field
from certreg.problem import row_blocks
from certreg.registration import RowNames, residual_distances

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.registration import Registration

HEADER = b"row,label,residual,standardised\n"


def residual_table(registration: Registration) -> Iterator[bytes]:
    """The table, block by block; a number is the shortest that reads back the same.

    row: of the pair, from 0; label: as far as the certificate holds labels. residual:
    |y - R x - t|, in the clouds' unit. standardised: sqrt(w) times that, over the standard
    deviation of a coordinate of weight one: 1 where sigma was given, else estimated, the root of
    the objective over 3 n - 6. Empty where no double holds it, and where a weight is zero.
    """
    problem, pose, unit = registration.problem, registration.pose, _unit(registration)
    certificate = registration.certificate
    names = RowNames.of({} if certificate is None else certificate.about, problem.n)
    yield HEADER
    for rows in row_blocks(problem.n):
        block = problem.block(rows)
        distances = residual_distances(block, pose)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            scaled = np.where(
                block.weights > 0, np.sqrt(block.weights) * distances / unit, math.nan
            )
        lines = (
            f"{row},{csv_field(names.label(row) or '')},{_cell(distance)},{_cell(share)}\n"
            for row, distance, share in zip(
                range(rows.start, rows.stop), distances.tolist(), scaled.tolist(), strict=True
            )
        )
        yield "".join(lines).encode()


def _unit(registration: Registration) -> float:
    """Standard deviation of a coordinate of weight one; NaN where nothing tells it."""
    problem, objective = registration.problem, registration.objective
    if problem.noise_given:
        return 1.0
    blocks = (problem.block(rows).weights for rows in row_blocks(problem.n))
    freedom = 3 * sum(int(np.count_nonzero(weights)) for weights in blocks) - 6
    if freedom <= 0 or objective is None or objective <= 0:
        return math.nan
    return math.sqrt(objective / freedom)


def _cell(value: float) -> str:
    return repr(value) if math.isfinite(value) else ""
