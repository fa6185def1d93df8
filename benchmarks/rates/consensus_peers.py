"""Wrong pairs: how often other methods are right, and how often they say so.

    make rates NAME=consensus_peers ARGS="[COUNT]"

COUNT problems of each cell, 30 unless told, of `consensus_labels`. Right: the pose brings the right
pairs within their bounds, all but one of ten at most; the noise leaves a few outside. A peer that
returns a score says "sure" where it is as its own documentation has it; certreg where all labels
are proved. Peers are in build/peers (`make peers`, then pip install kiss-matcher there); those that
are not installed are left out.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.rates.consensus_labels import Cell
from benchmarks.rates.consensus_poses import graduated_nonconvexity
from certreg.certificate.producing_consensus import ConsensusProver
from certreg.geometry.so3 import rotation_matrix
from certreg.problem.problem import RegistrationProblem
from certreg.registration.consensus import proved_consensus

if TYPE_CHECKING:
    from benchmarks.rates.consensus_labels import OutlierInstance


Array = NDArray[np.float64]
Answer = tuple[Array, Array, bool]  # rotation, translation, whether it says that it is right
Peer = Callable[[RegistrationProblem, Array, Array, float], Answer]
COUNT = 30
CELLS = tuple(
    Cell(n=n, wrong=wrong) for n, wrong in ((50, 80), (100, 50), (100, 90), (100, 95), (500, 95))
)
RANSAC_ROUNDS = 100_000
TRUSTED = 5  # inliers of the solver from which KISS-Matcher's authors call a pose good


def certreg(problem: RegistrationProblem, _x: Array, _y: Array, _bound: float) -> Answer:
    found = proved_consensus(problem, ConsensusProver(problem), 1.0)
    if found is None:
        return np.eye(3), np.zeros(3), False
    w, x, y, z = (float(k) for k in found.witness.quaternion)
    norm = float(np.linalg.norm([w, x, y, z]))
    R = np.array(rotation_matrix((w / norm, x / norm, y / norm, z / norm)))
    *shift, exponent = found.witness.shift
    return R, np.ldexp(np.array(shift, dtype=float), exponent), found.decided


def gnc(problem: RegistrationProblem, x: Array, y: Array, _bound: float) -> Answer:
    found = graduated_nonconvexity(x, y, problem.bounds)
    return found.rotation, found.translation, False


def ransac(_problem: RegistrationProblem, x: Array, y: Array, bound: float) -> Answer:
    open3d: Any = import_module("open3d")
    registration = open3d.pipelines.registration
    open3d.utility.random.seed(0)
    rows = np.column_stack([np.arange(len(x))] * 2).astype(np.int32)
    clouds = [open3d.geometry.PointCloud(open3d.utility.Vector3dVector(p)) for p in (x, y)]
    found = registration.registration_ransac_based_on_correspondence(
        *clouds,
        open3d.utility.Vector2iVector(rows),
        bound,
        registration.TransformationEstimationPointToPoint(),
        3,
        [],
        registration.RANSACConvergenceCriteria(RANSAC_ROUNDS, 0.999),
    )
    T = np.asarray(found.transformation)
    return T[:3, :3], T[:3, 3], False


def kiss_matcher(_problem: RegistrationProblem, x: Array, y: Array, bound: float) -> Answer:
    kiss: Any = import_module("kiss_matcher")
    matcher = kiss.KISSMatcher(kiss.KISSMatcherConfig(bound))
    # `solve` alone leaves out the pruning by lengths that is half of the method.
    found = matcher.prune_and_solve(*([*p.astype(np.float32)] for p in (x, y)))
    sure = bool(found.valid) and matcher.get_num_final_inliers() >= TRUSTED
    return np.asarray(found.rotation), np.asarray(found.translation).ravel(), sure


PEERS: dict[str, tuple[Peer, str]] = {
    "GNC": (gnc, "certreg"),
    "RANSAC (Open3D)": (ransac, "open3d"),
    "KISS-Matcher": (kiss_matcher, "kiss_matcher"),
    "certreg": (certreg, "certreg"),
}


def right(made: OutlierInstance, bound: float, R: Array, t: Array) -> bool:
    """Whether a pose brings nine of ten right pairs within."""
    good = ~made.wrong
    off = made.target[good] - made.source[good] @ R.T - t
    return bool((np.linalg.norm(off, axis=1) <= bound).mean() >= 0.9)


def row(cell: Cell, name: str, peer: Peer, count: int) -> str:
    """Of the table: right, sure, sure and wrong, milliseconds of the processor."""
    good, sure, misled, times = 0, 0, 0, list[float]()
    bound = cell.beta * cell.sigma
    for seed in range(count):
        made = cell.instance(seed)
        problem = cell.problem(made)
        start = time.process_time()
        R, t, told = peer(problem, made.source, made.target, bound)
        times.append(1e3 * (time.process_time() - start))
        is_right = right(made, bound, R, t)
        good, sure, misled = good + is_right, sure + told, misled + (told and not is_right)
    shares = f"{good / count:7.0%}{sure / count:7.0%}{misled / count:12.0%}"
    return f"{cell.name:34}{name:17}{shares}{median(times):9.1f}"


def main(count: int = COUNT) -> None:
    """Print the table."""
    head = f"{'right':>7}{'sure':>7}{'sure, wrong':>12}{'ms':>9}"
    sys.stdout.write(f"{'cell':34}{'method':17}{head}\n")
    for cell in CELLS:
        for name, (peer, module) in PEERS.items():
            if find_spec(module) is not None:
                sys.stdout.write(f"{row(cell, name, peer, count)}\n")
                sys.stdout.flush()


if __name__ == "__main__":
    main(int((*sys.argv[1:2], COUNT)[0]))
