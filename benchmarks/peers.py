"""The tools that certreg is measured beside: each called as its documentation says, at its fastest.

A peer gets the clouds in the layout that it likes best, and that conversion is not timed. What is
timed is one call, from points to the rotation, as a function that can be called again and again.
The packages are in `peers.txt`; one that cannot be imported is listed as absent, with the reason.
"""

# pyright: reportMissingImports=false
# Peers are no dependencies: `make lint` runs where they are not installed.

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Cloud = NDArray[np.float64]  # (N, 3), contiguous
    Registration = Callable[[], NDArray[np.float64]]  # (3, 3), from source to target


@dataclass(frozen=True, slots=True, kw_only=True)
class Peer:
    """One way to register two clouds with one tool.

    package: as the index names it. call: what is timed, for the reader.
    prepare: takes source and target; raises ImportError where the tool is not there.
    library: a call that somebody ships, not formulas written for this comparison.
    most: points; more would take too much memory beside the others.
    """

    name: str
    package: str
    call: str
    prepare: Callable[[Cloud, Cloud], Registration]
    library: bool = True
    most: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Presence:
    """Whether a peer is here: its version, or why it is absent."""

    peer: Peer
    version: str | None
    absent: str | None

    def as_json(self) -> dict[str, Any]:
        """All of it, for a file."""
        peer = self.peer
        return {
            "name": peer.name,
            "package": peer.package,
            "call": peer.call,
            "version": self.version,
            "absent": self.absent,
        }


def _scipy(source: Cloud, target: Cloud) -> Registration:
    from scipy.spatial.transform import Rotation

    def register() -> Any:
        moved = target - target.mean(axis=0), source - source.mean(axis=0)
        return Rotation.align_vectors(*moved)[0].as_matrix()

    return register


def _numpy(source: Cloud, target: Cloud) -> Registration:
    """Two passes, as one writes it with care. Matrix products make means faster than `mean`."""
    share = np.full(len(source), 1.0 / len(source))

    def register() -> Any:
        return kabsch((target - share @ target).T @ (source - share @ source))

    return register


def _numpy_raw(source: Cloud, target: Cloud) -> Registration:
    """One pass: sums of raw products, the means taken off afterwards. Loses digits at an offset."""
    share = np.full(len(source), 1.0 / len(source))

    def register() -> Any:
        means = np.outer(share @ target, share @ source)
        return kabsch(target.T @ source - len(source) * means)

    return register


def _gtsam(source: Cloud, target: Cloud) -> Registration:
    """`Align(a, b)` takes 3×N matrices and gives the pose that takes b to a."""
    import gtsam

    a, b = target.T, source.T
    return lambda: gtsam.Pose3.Align(a, b).rotation().matrix()


def _open3d(source: Cloud, target: Cloud) -> Registration:
    """Tensors share the memory of the arrays; Open3D sums in all threads it finds."""
    import open3d as o3d

    pairs = o3d.core.Tensor.from_numpy(np.arange(len(source), dtype=np.int64))
    clouds = [
        o3d.t.geometry.PointCloud(o3d.core.Tensor.from_numpy(points)) for points in (source, target)
    ]
    estimation = o3d.t.pipelines.registration.TransformationEstimationPointToPoint()
    return lambda: estimation.compute_transformation(*clouds, pairs).numpy()[:3, :3]


def _open3d_legacy(source: Cloud, target: Cloud) -> Registration:
    import open3d as o3d

    clouds = [
        o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points)) for points in (source, target)
    ]
    numbers = np.arange(len(source), dtype=np.int32)
    pairs = o3d.utility.Vector2iVector(np.column_stack([numbers, numbers]))
    estimation = o3d.pipelines.registration.TransformationEstimationPointToPoint()
    return lambda: estimation.compute_transformation(*clouds, pairs)[:3, :3]


def _skimage(source: Cloud, target: Cloud) -> Registration:
    """`from_estimate` is its newer name; `estimate_transform` is there in old and new versions."""
    from skimage.transform import estimate_transform

    return lambda: estimate_transform("euclidean", source, target).params[:3, :3]


def _trimesh(source: Cloud, target: Cloud) -> Registration:
    """Faster than `registration.procrustes`, above all on contiguous 3×N arrays."""
    from trimesh.transformations import superimposition_matrix

    columns = np.ascontiguousarray(source.T), np.ascontiguousarray(target.T)
    return lambda: superimposition_matrix(*columns)[:3, :3]


def _opencv(source: Cloud, target: Cloud) -> Registration:
    """A similarity: with the scale it has a seventh unknown, and the same rotation."""
    import cv2

    return lambda: cv2.estimateAffine3D(source, target, force_rotation=True)[0][:, :3]


PEERS = (
    Peer(
        name="SciPy",
        package="scipy",
        call="centred, then Rotation.align_vectors",
        prepare=_scipy,
    ),
    Peer(
        name="Open3D",
        package="open3d",
        call="t.pipelines.registration.TransformationEstimationPointToPoint",
        prepare=_open3d,
    ),
    Peer(
        name="Open3D, legacy",
        package="open3d",
        call="pipelines.registration.TransformationEstimationPointToPoint",
        prepare=_open3d_legacy,
        most=10**6,  # it needs copies of all points, and is not the faster of the two there
    ),
    Peer(name="gtsam", package="gtsam", call="Pose3.Align on matrices", prepare=_gtsam),
    Peer(
        name="scikit-image",
        package="scikit-image",
        call='transform.estimate_transform("euclidean")',
        prepare=_skimage,
    ),
    Peer(
        name="trimesh",
        package="trimesh",
        call="transformations.superimposition_matrix on 3×N arrays",
        prepare=_trimesh,
    ),
    Peer(
        name="OpenCV",
        package="opencv-python-headless",
        call="estimateAffine3D(force_rotation=True)",
        prepare=_opencv,
    ),
    Peer(
        name="NumPy",
        package="numpy",
        call="centred, one matrix product, SVD",
        prepare=_numpy,
        library=False,
    ),
    Peer(
        name="NumPy, raw sums",
        package="numpy",
        call="one matrix product of raw coordinates, SVD",
        prepare=_numpy_raw,
        library=False,
    ),
)


def presences() -> list[Presence]:
    """Every peer, tried on four points; one that is installed but wrong raises AssertionError."""
    return [presence(peer) for peer in PEERS]


def presence(peer: Peer) -> Presence:
    """Whether a peer can be called here. What it needs beside its package may be missing, too."""
    source = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]])
    turn = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    try:
        register = peer.prepare(source, source @ turn.T + 5.0)
        found = version(peer.package)
    except (ImportError, PackageNotFoundError) as error:
        return Presence(peer=peer, version=None, absent=_reason(error))
    assert np.allclose(register(), turn, atol=1e-9), f"{peer.name} does not find the rotation"
    return Presence(peer=peer, version=found, absent=None)


def _reason(error: ImportError) -> str:
    if isinstance(error, PackageNotFoundError):
        return f"no package {error.args[0]} is installed"
    return str(error).partition("\n")[0]


def kabsch(products: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rotation (3, 3) nearest to sum (y - mean)(x - mean)^T, by its singular values."""
    left, _, right = np.linalg.svd(products)
    left[:, 2] *= np.sign(np.linalg.det(left) * np.linalg.det(right))
    return left @ right
