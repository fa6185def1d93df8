"""How often candidates reach the true pairs, and how soon.

    make rates NAME=consensus_poses ARGS="[COUNT]"

Instances of each cell, 100 unless told.

Reached: as many rows as are true, and as many as the true ones widened by those that fit beside
them. Times in ms of this process: graduated non-convexity alone, all until the best candidate, all
until the search ends by itself; median and largest.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from wrong_pairs import wrong_pairs

from certreg.relaxation.edge_rows import grown, held, widened
from certreg.relaxation.graduated_nonconvexity import candidate_of, truncated_fit
from certreg.relaxation.paired_rows import fitted, paired_rows, squared_ratios
from certreg.relaxation.proposals import candidates

COUNT = 100
CELLS = (
    *((20, wrong) for wrong in (0.0, 0.5, 0.8)),
    *((50, wrong) for wrong in (0.0, 0.5, 0.8)),
    *((100, wrong) for wrong in (0.0, 0.5, 0.8, 0.9)),
    *((500, wrong) for wrong in (0.5, 0.8, 0.9, 0.95)),
    *((1000, wrong) for wrong in (0.5, 0.8, 0.9, 0.95)),
)
LEAST = 0.99  # of the instances of a cell


def graduated_nonconvexity(source, target, bounds):
    """The pose that graduated non-convexity finds for points (N, 3), (N, 3) and bounds (N,)."""
    pairs = paired_rows(source, target, bounds)
    pose = truncated_fit(pairs)
    return candidate_of(pairs, pose, squared_ratios(pairs, pose))


def most_beside(pairs):
    """How many rows the true ones have with those that fit beside them."""
    rows = paired_rows(pairs.source, pairs.target, pairs.bounds)
    true = held(rows, fitted(rows, pairs.true * rows.precisions))
    return widened(rows, grown(rows, true)).count


def times(pairs):
    """Seconds of graduated non-convexity, until the best, until the end; with both counts."""
    given = (pairs.source, pairs.target, pairs.bounds)
    start = time.process_time()
    alone = len(graduated_nonconvexity(*given).inliers)
    middle = time.process_time()
    last, most = middle, 0
    for one in candidates(*given):
        last, most = time.process_time(), len(one.inliers)
    end = time.process_time()
    return (middle - start, last - middle, end - middle), alone, most


def told(seconds):
    return f"{np.median(seconds) * 1e3:8.2f} {max(seconds) * 1e3:7.1f}"


def main() -> int:
    """A line for each cell; 1 where too few instances reach the true pairs."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else COUNT
    worst = 1.0
    sys.stdout.write(
        "   N wrong  GNC  true  beside  GNC alone: ms   until the best    to the end\n"
    )
    for points, wrong in CELLS:
        rng = np.random.default_rng(points + round(100 * wrong))
        made = [wrong_pairs(rng, points, wrong) for _ in range(count)]
        seconds, alone, most = zip(*map(times, made), strict=True)
        true = np.array([pairs.true.sum() for pairs in made])
        beside = np.array([most_beside(pairs) for pairs in made])
        shares = [np.mean(np.array(alone) >= true)]
        shares += [np.mean(np.array(most) >= wanted) for wanted in (true, beside)]
        worst = min(worst, *shares[1:])
        columns = "".join(f"{share:6.2f}" for share in shares)
        spent = " ".join(map(told, zip(*seconds, strict=True)))
        sys.stdout.write(f"{points:5d} {wrong:4.2f}{columns} {spent}\n")
    return 0 if worst >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
