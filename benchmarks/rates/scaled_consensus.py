"""How many labels of random problems with wrong pairs and a free scale are proved.

    make rates NAME=scaled_consensus ARGS="[COUNT]"

COUNT problems of each cell, 20 unless told, of the law of `consensus_labels` with the source
divided by a scale between e^-2 and e^2. Each certificate is read by the checker. Times are of the
processor, medians of milliseconds.
"""

from __future__ import annotations

import sys
import time
from importlib import import_module
from statistics import median
from typing import Any

import numpy as np

import certreg
from benchmarks.rates.consensus_labels import Cell

checker = import_module("certreg.verify")
COUNT = 20
CELLS = tuple(Cell(n=n, wrong=wrong) for n in (20, 50, 100) for wrong in (0, 50, 80))
LARGEST = 2.0  # logarithm of a scale
HEAD = f"{'cell':34}{'labels':>8}{'outliers':>10}{'scale in':>10}{'ms':>8}{'check ms':>10}"


def row(cell: Cell, count: int) -> str:
    """Of the table; scale in: how often the true scale is in the proved interval."""
    labels, struck, unmet, inside = 0, 0, 0, 0
    seconds, checking = list[float](), list[float]()
    for seed in range(count):
        made = cell.instance(seed)
        scale = float(np.exp(np.random.default_rng(seed).uniform(-LARGEST, LARGEST)))
        bound = cell.beta * cell.sigma
        start = time.process_time()
        found: Any = certreg.certify(
            made.source / scale, made.target, scale="asymmetric", max_residual=bound
        )
        seconds.append(time.process_time() - start)
        text = found.certificate.to_json()
        start = time.process_time()
        outcome = checker.check(text)
        checking.append(time.process_time() - start)
        if not outcome.verified:
            raise AssertionError(outcome.reason)
        low, high = found.scale_interval
        labels += found.labels_unique
        inside += low < scale < high
        unmet += cell.n - found.lower
        struck += found.labels.count("outlier")
    share = struck / unmet if unmet else 1.0
    times = f"{1e3 * median(seconds):8.0f}{1e3 * median(checking):10.0f}"
    return f"{cell.name:34}{labels / count:8.0%}{share:10.2%}{inside / count:10.0%}{times}"


def main(count: int = COUNT) -> None:
    """Print the table."""
    sys.stdout.write(f"{HEAD}\n")
    for cell in CELLS:
        sys.stdout.write(f"{row(cell, count)}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(int((*sys.argv[1:2], COUNT)[0]))
