"""Certified similarities beside Umeyama's closed form in other libraries.

On random problems of ordinary size all must agree to 1e-9: the scale relative to itself, the shift
to the largest coordinate, the rotation entry by entry. Then the same far from the origin and at
extreme sizes, where it is counted who fails. What is not installed is left out, and named.
"""

from __future__ import annotations

import sys
import warnings
from collections import Counter
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from strategies import random_rotation

from certreg import RegistrationProblem, Similarity, certify, register
from certreg.results import Optimality

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Cloud = NDArray[np.float64]
    Peer = Callable[[Cloud, Cloud], Any]

PROBLEMS = 1000  # of each family
AGREE = 1e-9


def problem(rng: np.random.Generator) -> tuple[Cloud, Cloud]:
    """Sizes 1e-3 to 1e3, scales 1e-2 to 1e2, noise from 0 to 300 %, every fifth mirrored."""
    n, size = int(rng.integers(4, 40)), 10.0 ** rng.uniform(-3, 3)
    scale, noise = 10.0 ** rng.uniform(-2, 2), rng.choice([0.0, 1e-3, 0.1, 1.0, 3.0])
    x = size * rng.normal(size=(n, 3)) * rng.uniform(0.2, 1.0, 3)
    y = scale * x @ random_rotation(rng).T
    if rng.random() < 0.2:
        y = y * [1.0, 1.0, -1.0]
    y = y + noise * scale * size * rng.normal(size=(n, 3))
    return x, y + 10.0 * scale * size * rng.normal(size=3)


def far(rng: np.random.Generator) -> tuple[Cloud, Cloud]:
    """Both clouds 1e8 of their sizes from the origin."""
    x, y = problem(rng)
    return tuple(c + 1e8 * c.std() * rng.normal(size=3) for c in (x, y))  # type: ignore[return-value]


def large(rng: np.random.Generator) -> tuple[Cloud, Cloud]:
    """Sizes around 1e160."""
    x, y = problem(rng)
    return x * 1e160, y * 1e160


def small(rng: np.random.Generator) -> tuple[Cloud, Cloud]:
    """Sizes around 1e-160."""
    x, y = problem(rng)
    return x * 1e-160, y * 1e-160


def unlike(rng: np.random.Generator) -> tuple[Cloud, Cloud]:
    """A target 1e200 times as large as the source."""
    x, y = problem(rng)
    return x * 1e-100, y * 1e100


FAMILIES = {
    "ordinary": problem,
    "1e8 of its size away": far,
    "times 1e160": large,
    "times 1e-160": small,
    "1e200 times as large": unlike,
}


def of_skimage() -> Peer:
    """`transform.SimilarityTransform`."""
    transform = import_module("skimage.transform")
    return lambda x, y: transform.estimate_transform("similarity", x, y).params


def of_evo() -> Peer:
    """`core.geometry.umeyama_alignment(with_scale=True)`."""
    geometry = import_module("evo.core.geometry")
    return lambda x, y: _matrix(*geometry.umeyama_alignment(x.T, y.T, with_scale=True))


def of_open3d() -> Peer:
    """`TransformationEstimationPointToPoint(with_scaling=True)`."""
    o3d = import_module("open3d")
    estimation = o3d.pipelines.registration.TransformationEstimationPointToPoint(with_scaling=True)

    def posed(x: Cloud, y: Cloud) -> Any:
        clouds = [o3d.geometry.PointCloud(o3d.utility.Vector3dVector(c)) for c in (x, y)]
        rows = np.arange(len(x), dtype=np.int32)
        pairs = o3d.utility.Vector2iVector(np.column_stack([rows, rows]))
        return estimation.compute_transformation(*clouds, pairs)

    return posed


def of_certreg() -> Peer:
    """`certreg.register`, which proves nothing."""
    return lambda x, y: register(x, y, scale="asymmetric").as_matrix()


PEERS = {
    "scikit-image": of_skimage,
    "evo": of_evo,
    "Open3D": of_open3d,
    "certreg.register": of_certreg,
}


def _matrix(R: Cloud, t: Cloud, s: float) -> Cloud:
    return np.vstack([np.column_stack([s * R, t]), [0.0, 0.0, 0.0, 1.0]])


def off(best: Similarity, found: Any, x: Cloud, y: Cloud) -> float:
    """How far a 4x4 is from the certified one: of scale, rotation and translation the largest.

    The translation is judged at the source's mean, relative to the target's largest coordinate.
    """
    matrix = np.asarray(found, dtype=float)
    if not np.isfinite(matrix).all():
        return np.inf
    linear = matrix[:3, :3] / best.scale
    mean = x.mean(axis=0)
    there = (matrix[:3, :3] @ mean + matrix[:3, 3]) - (best.scale * best.rotation @ mean)
    shift = np.abs(there - best.translation).max() / np.abs(y).max()
    return float(max(np.abs(linear - best.rotation).max(), shift))


def main() -> int:
    """Count, for every library and family, how often it agrees; 1 if it does not where it must."""
    peers: dict[str, Peer] = {}
    for name, load in PEERS.items():
        try:
            peers[name] = load()
        except ImportError as error:
            sys.stdout.write(f"{name}: not installed here ({error})\n")
    wrong = 0
    for family, draw in FAMILIES.items():
        rng, off_by, certified = np.random.default_rng(21), Counter[str](), 0
        for _ in range(PROBLEMS):
            x, y = draw(rng)
            best = RegistrationProblem(x, y, scale="asymmetric")
            found = certify(best, relaxation=False, simulation=False)
            certified += found.status is Optimality.CERTIFIED
            for name, peer in peers.items():
                off_by[name] += not _error(peer, found.pose, x, y) <= AGREE
        sys.stdout.write(f"{family}: {certified} of {PROBLEMS} certified\n")
        for name in peers:
            sys.stdout.write(f"  {name}: {off_by[name]} off by more than {AGREE:g}\n")
            wrong += family == "ordinary" and off_by[name] > 0
    return int(wrong > 0)


def _error(peer: Peer, best: Any, x: Cloud, y: Cloud) -> float:
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            return off(best, peer(x, y), x, y)
    except Exception:  # noqa: BLE001 - of other libraries, each its own: it is a failure
        return np.inf


if __name__ == "__main__":
    sys.exit(main())
