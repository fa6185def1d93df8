"""No move of the points within the proved radius turns the optimum further.

    make rates NAME=radius_moves ARGS="[COUNT]"

So many moves, 10,000 unless told.

Eight families of springs, and each problem with one weight per pair beside; moves of 0.999 of the
radius, every point by as much: at random, and along turns about an axis, of the target and of both
clouds. Half of the turns are about the axis in which the objective curves least.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import spring_families as families

from certreg import RegistrationProblem, certify, register
from certreg.certificate.cones import springs_certificate
from certreg.objective.springs import Springs
from certreg.relaxation.optimum import find_optimum
from certreg.verify import check

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.random import Generator
    from numpy.typing import NDArray


COUNT = 10_000
DEGREES = 5.0
SHARE = 0.999
CELLS = tuple(
    families.Cell(*each)
    for each in (
        ("plane", 8, 0.1),
        ("plane", 20, 0.05),
        ("line", 10, 0.05),
        ("aniso", 10, 0.1),
        ("gicp", 20, 0.1),
        ("lidar", 10, 1.0),
        ("mixed", 20, 0.1),
        ("wall", 20, 0.1),
    )
)
MOVES = 20  # of each problem: half of them for springs, half for one weight per pair


def turn(first: Any, second: Any) -> float:
    """Degrees between two rotations by quaternions of any length."""
    p, q = (np.asarray(each, float) for each in (first, second))
    cosine = abs(p @ q) / math.sqrt((p @ p) * (q @ q))
    return math.degrees(2.0 * math.acos(min(1.0, cosine)))


def moves(made: families.Instance, rng: Generator) -> Iterator[NDArray[np.float64]]:
    """(N, 3) unit moves in the target's frame: at random, and along turns."""
    turned = (made.source - made.source.mean(axis=0)) @ made.rotation.T
    least = np.linalg.svd(turned)[2][0]  # about the longest axis points hardly move
    for kind in range(MOVES // 4):
        axis = least if kind % 2 else rng.standard_normal(3)
        off = np.cross(axis, turned) if kind % 3 else rng.standard_normal(turned.shape)
        yield off / np.maximum(np.linalg.norm(off, axis=1, keepdims=True), 1e-300)


def moved(made: families.Instance, off: NDArray[np.float64], x: float, y: float) -> Any:
    """The instance with source and target points off by so much, against each other."""
    source = made.source - SHARE * x * off @ made.rotation
    return replace(made, source=source, target=made.target + SHARE * y * off)


def turns(cell: families.Cell, seed: int) -> Iterator[float]:
    """Degrees by which moves within the radius turn the optimum."""
    made, rng = families.instance(cell, seed), np.random.default_rng(seed)
    problem = RegistrationProblem(**families.statement(made))
    objective = Springs.of(problem)
    found = find_optimum(objective)
    own: Any = springs_certificate(problem, objective, found, robustness_angle=DEGREES)
    bare: Any = certify(made.source, made.target, relaxation=False, simulation=False).certificate
    for certificate, body in ((own, own.body), (bare, bare.body)):
        outcome = check(certificate.to_json())
        assert outcome.verified, outcome.reason
        if body.radius is None:
            continue
        target, both = float(body.radius.target.value), float(body.radius.both.value)
        for off in moves(made, rng):
            for x, y in ((0.0, target), (both, both)):
                yield turn(
                    body.quaternion, _optimum(moved(made, off, x, y), springs=body is own.body)
                )


def _optimum(made: families.Instance, *, springs: bool) -> Any:
    if not springs:
        return register(made.source, made.target).quaternion_wxyz
    problem = RegistrationProblem(**families.statement(made))
    return find_optimum(Springs.of(problem)).quaternion


def main(count: int = COUNT) -> int:
    """Print the violations and the largest turns; 1 if there are any."""
    found, seed = list[float](), 0
    while len(found) < count:
        for cell in CELLS:
            found += turns(cell, seed)
        seed += 1
    worse = sum(one > DEGREES for one in found)
    sys.stdout.write(
        f"{len(found)} moves of {SHARE} of the radius for {DEGREES:g} degrees: {worse} turned the "
        f"optimum further; the largest turn {max(found):.3f} degrees\n"
    )
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:2])))
