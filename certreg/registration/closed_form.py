"""The best pose of two clouds in floating point: fast, and not certified.

Two classical closed forms of the rotation, independent of each other and of the exact methods:
they propose, and are compared with what is proved.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from certreg._loading import late
from certreg.errors import DegenerateProblemError, InvalidProblemError, OutOfRangeError
from certreg.exact.decimals import at_most
from certreg.geometry.pose import Pose
from certreg.geometry.similarity import Similarity
from certreg.geometry.so3 import (
    canonical,
    davenport_matrix,
    is_reflection,
    quaternion_of_rotation,
    rotation_matrix,
)
from certreg.problem.arrays import cloud_array, finite_doubles, real_numbers
from certreg.problem.attributes import (
    SpringArguments,
    require_known,
    warn_of_unused,
    warn_of_unused_noise,
)
from certreg.problem.budget import checked_threads
from certreg.problem.fast_pose import FloatingPose, floating_pose
from certreg.problem.moments import Moments, davenport_error, moments_of_clouds
from certreg.problem.motion import Scale, checked_rotation_only, checked_scale
from certreg.problem.problem import RegistrationProblem, require_as_many
from certreg.problem.row_labels import require_same_labels
from certreg.problem.springs import require_one_noise, weights_of_sigma
from certreg.problem.support import Cell, require_supported

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.registration import equilibria

    BestScale = Callable[[float, float, float], float]
else:
    equilibria = late("certreg.registration.equilibria")


# Of tr(R^T C), Sxx and Syy: tr(R^T C) / Sxx [Umeyama1991], or sqrt(Syy / Sxx) [Horn1987]. The
# rotation is the same.
BEST_SCALES: Mapping[Scale, BestScale] = {
    Scale.ASYMMETRIC: lambda alignment, source, _: max(0.0, alignment) / source,
    Scale.SYMMETRIC: lambda _, source, target: math.sqrt(target / source),
}
LARGEST_TURN = 1e-3  # radians by which rounding may turn a pose before it is refused


def register(  # noqa: PLR0913 - each is one question, and has its usual answer
    source: Any,
    target: Any,
    weights: ArrayLike | None = None,
    *,
    sigma: ArrayLike | None = None,
    threads: int = 1,
    scale: str = Scale.NONE,
    rotation_only: bool = False,
    **springs: Unpack[SpringArguments],
) -> Pose | Similarity:
    """The pose that takes `source` to `target`, row i to row i, in floating point: not certified.

    For those who need only the pose, fast: one pass over the points, with no copy of them, then
    Horn's closed form [Horn1987]. `certreg.certify` proves its pose, and finds all equilibria.

    Parameters
    ----------
    source, target
        (N, 3) in one unit of length. Arrays of float64 and float32 are read where they stand, with
        any strides: slices, transposes of 3xN arrays (`cloud.T`), arrays that are mapped from
        files.
    weights
        (N,), >= 0; None: all are one.
    sigma
        Instead of weights, one number or (N,), as for a problem: the weight is 1/sigma^2.
    threads
        How many; the pose is the same to the bit for every number of them.
    scale
        "none"; "asymmetric" or "symmetric", as for a problem: a similarity is found, by the same
        sums.
    rotation_only
        Whether there is no translation, as between directions: the sums are about the origin.
    **springs
        `normals`, `directions`, `covariances`, `information` or `factors`, as for a problem: the
        best pose is then found from exact sums, in a millisecond or a few, and is not proved.

    Returns
    -------
    Pose | Similarity
        In doubles; a `Similarity` where a scale was asked for.

    Raises
    ------
    InvalidProblemError
        For arrays that are no clouds in correspondence, sigma beside weights, a number of threads
        below 1, another word for the scale, and a free scale beside springs.
    DegenerateProblemError
        Where rounding may turn the pose by more than 1e-3 rad: above all where the best rotation is
        not unique, as for points on one line. Of springs where a shift or a turn is undetermined,
        or hardly determined.
    OutOfRangeError
        Where no double can hold the scale.

    Examples
    --------
    >>> pose = register([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[5, 0, 0], [5, 1, 0], [3, 0, 0]])
    >>> pose.translation.round(9)
    array([5., 0., 0.])
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 2, 0]]
    >>> round(register(corners, [[0, 0, 0], [3, 0, 0], [0, 6, 0]], scale="asymmetric").scale, 9)
    3.0
    """
    threads = checked_threads(threads)
    if springs:
        require_known(springs, SpringArguments, "register")
    on_springs = bool(springs) and any(value is not None for value in springs.values())
    kind, about_origin = checked_scale(scale), checked_rotation_only(rotation_only)
    require_supported(Cell(springs=on_springs, scale=kind, rotation_only=about_origin))
    noisy = sigma is not None or weights is not None
    if not noisy:
        warn_of_unused_noise(source, target, depth=1)
    if on_springs:
        own = weights if noisy else 1.0
        problem = RegistrationProblem(
            source, target, sigma=sigma, weights=own, rotation_only=about_origin, **springs
        )
        return equilibria.spring_pose(problem)
    x = _readable(cloud_array(source, "source"), "source")
    y = _readable(cloud_array(target, "target"), "target")
    require_as_many(len(x), len(y))
    require_same_labels(source, target=target, sigma=sigma, weights=weights)
    if target is not y:
        warn_of_unused(target, len(y), depth=1)
    if sigma is not None:
        require_one_noise(sigma, weights)
        weights = weights_of_sigma(sigma, len(x))
    w = None if weights is None else _readable(real_numbers(weights, "weights"), "weights")
    if w is not None and w.shape != (len(x),):
        raise InvalidProblemError(
            f"weights has shape {w.shape}: expected ({len(x)},), one per point",
            array="weights",
            value=w.shape,
            limit=(len(x),),
        )
    best = BEST_SCALES.get(kind)
    found = floating_pose(x, y, w, about_origin=about_origin)
    if found is not None and _is_told(found.gap, found.error):
        return found.pose if best is None else _scaled_by_sums(found, best)
    moments = moments_of_clouds(x, y, w, threads=threads, about_origin=about_origin)
    return _by_moments(moments, best)


def _by_moments(moments: Moments, best: BestScale | None) -> Pose | Similarity:
    quaternion = _optimal_quaternion(moments)
    rotation = np.array(rotation_matrix(tuple(quaternion.tolist())))
    here, there = moments.source_centroid, moments.target_centroid
    rigid = Pose(rotation=rotation, translation=there - rotation @ here, quaternion_wxyz=quaternion)
    if best is None:
        return rigid
    spreads = float(np.trace(moments.source_scatter)), moments.target_spread
    # sums are over 2^b for the target, 2^a for the source, so their quotients over 2^(b - a)
    exponent = moments.target_exponent - moments.source_exponent
    quotient = best(float(np.sum(rotation * moments.cross_covariance)), *spreads)
    with np.errstate(over="ignore"):
        scale = float(np.ldexp(quotient, exponent))
    if math.isinf(scale) or scale == 0.0 < quotient:
        raise OutOfRangeError(
            "the scale exceeds the range of doubles: change the unit of length of one cloud",
            value=scale,
        )
    return _similarity(rigid, scale, here, there)


def _scaled_by_sums(found: FloatingPose, best: BestScale) -> Similarity:
    alignment = float(np.sum(found.pose.rotation * found.cross_covariance))
    return _similarity(found.pose, best(alignment, *found.spreads), *found.means)


def _similarity(
    rigid: Pose, scale: float, here: NDArray[np.float64], there: NDArray[np.float64]
) -> Similarity:
    """With the translation that takes one mean to the other."""
    return Similarity(
        rotation=rigid.rotation,
        translation=there - scale * (rigid.rotation @ here),
        quaternion_wxyz=rigid.quaternion_wxyz,
        scale=scale,
    )


def _optimal_quaternion(moments: Moments) -> NDArray[np.float64]:
    """The unit eigenvector (4,) of the largest eigenvalue of the Davenport matrix K.

    If e bounds what its eigenvalues are off, sin(theta / 2) <= e / (l1 - l2 - e) for the angle
    theta of the pose [Davis1970].
    """
    davenport = np.array(davenport_matrix(moments.cross_covariance.tolist()))
    values, vectors = np.linalg.eigh(davenport)
    gap = float(values[-1] - values[-2])
    error = davenport_error(moments.rounding, float(np.linalg.norm(davenport)))
    if not _is_told(gap, error):
        raise DegenerateProblemError(
            "floating point does not tell the rotation: the two largest eigenvalues of the "
            f"Davenport matrix are {gap:.3g} apart, and rounding may move them by "
            f"{at_most(error)}; certreg.certify decides exactly whether the best "
            "rotation is unique",
            value=gap,
            limit=error,
        )
    return canonical(vectors[:, -1])


def _is_told(gap: float, error: float) -> bool:
    """Whether rounding turns the pose by less than `LARGEST_TURN`."""
    return 2.0 * error < LARGEST_TURN * (gap - error)


def _readable(array: NDArray[Any], name: str) -> NDArray[Any]:
    """The array, if every entry of its type is a double; else its values, if they all are."""
    floating = array.dtype.kind == "f" and array.dtype.itemsize <= 8
    return array if floating else finite_doubles(array, name)


def horn(cross_covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit quaternion (4,) of largest eigenvalue of the Davenport matrix of C [Horn1987].

    Where the largest eigenvalue is repeated this is an arbitrary one of the optima.
    """
    davenport = np.array(davenport_matrix(cross_covariance.tolist()))
    return canonical(np.linalg.eigh(davenport)[1][:, -1])


def arun(cross_covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same rotation (4,) from the singular value decomposition of C [Arun1987].

    With the determinant rule of [Umeyama1991]: without it a mirrored cloud returns a reflection.
    """
    u, _, vt = np.linalg.svd(cross_covariance)
    rotation = u @ vt
    if is_reflection(rotation):
        rotation = (u * (1.0, 1.0, -1.0)) @ vt
    return quaternion_of_rotation(rotation)
