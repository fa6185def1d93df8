"""How often general springs are certified, and unique.

    make rates NAME=spring_certificates ARGS="[COUNT [FAMILY]]"

So many problems of each cell, 500 unless told.

Of each cell of `spring_families`: the shares certified and unique, by which proof, the largest
proved angle, and by how often the checker, alone and from bytes, said so.
"""

from __future__ import annotations

import math
import sys
import time
from collections import Counter
from dataclasses import dataclass

import spring_families as families

from certreg.certificate.cones import springs_certificate
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.optimum import find_optimum
from certreg.verify import check

COUNT = 500  # of each cell
LEAST_SHARE = 0.998  # certified and unique
BARELY = 1e-6  # radians: of cells with the fewest pairs that leave one optimum
WELL = 5e-9  # of all others
FEWEST = {"plane": 7, "line": 4, "aniso": 3, "gicp": 4, "lidar": 3, "mixed": 4}


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """What became of the problems of a cell.

    unique: certified, with a proof that there is one optimum. refused: by the checker, which must
    be none. angle: the largest proved of those, radians. milliseconds: the median of finding and
    proving. kinds: of certificates.
    """

    cell: families.Cell
    count: int
    unique: int
    refused: int
    angle: float
    milliseconds: float
    kinds: dict[str, int]

    @property
    def limit(self) -> float:
        """Of the angle."""
        return BARELY if self.cell.n == FEWEST.get(self.cell.family) else WELL

    @property
    def good(self) -> bool:
        """Whether the cell is as it must be."""
        enough = self.unique >= LEAST_SHARE * self.count
        return enough and not self.refused and self.angle <= self.limit

    def __str__(self) -> str:
        share, kinds = self.unique / self.count, dict(sorted(self.kinds.items()))
        return (
            f"{'' if self.good else 'MISSED '}{self.cell}: {self.unique} of {self.count} unique "
            f"({share:.2%}), angle {self.angle:.1e} of {self.limit:.0e}, "
            f"{self.milliseconds:.1f} ms, {self.refused} refused, {kinds}"
        )


def rate_of(cell: families.Cell, count: int) -> Rate:
    """The first so many problems of a cell."""
    angles, times, kinds, refused = list[float](), list[float](), Counter[str](), 0
    for seed in range(count):
        problem = RegistrationProblem(**families.statement(families.instance(cell, seed)))
        start = time.process_time()
        objective = Springs.of(problem)
        certificate = springs_certificate(problem, objective, find_optimum(objective))
        times.append(time.process_time() - start)
        if certificate is None:
            kinds["none"] += 1
            continue
        kinds[certificate.body.KIND] += 1
        outcome = check(certificate.to_json())
        refused += not outcome.verified
        worth = outcome.worth
        if certificate.body.claims.unique and worth is not None and worth.angle is not None:
            angles.append(float(worth.angle))
    return Rate(
        cell=cell,
        count=count,
        unique=len(angles),
        refused=refused,
        angle=max(angles, default=math.nan),
        milliseconds=1e3 * sorted(times)[count // 2],
        kinds=dict(kinds),
    )


def main(count: int = COUNT, family: str = "") -> int:
    """Print a line for each cell; 1 if one is not as it must be."""
    bad = 0
    for cell in families.CELLS:
        if not family or cell.family == family:
            rate = rate_of(cell, count)
            bad += not rate.good
            sys.stdout.write(f"{rate}\n")
            sys.stdout.flush()
    sys.stdout.write(f"{bad} cells missed\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(int((*sys.argv[1:2], COUNT)[0]), (*sys.argv[2:3], "")[0]))
